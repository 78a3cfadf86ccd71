/** scree for JavaScript: each function is one call of the program. Lengths, areas, volumes in SI units. */

/** The unit of a file's coordinates: asked for, never guessed. */
export type Unit = 'm' | 'cm' | 'mm' | 'um' | 'inch' | 'ft' | 'km';
/** A path, or the bytes of an STL, PLY, OBJ or OFF file. */
export type Scan = string | Uint8Array;
export type MeshFormat = 'stl' | 'ply' | 'obj' | 'off' | '3mf';

export interface ScanOptions {
  unit: Unit;
  /** What the scan is called in results and errors; default: the file's name, or "scan". */
  name?: string;
}

export interface Check {
  usable: boolean;
  /** One sentence. */
  verdict: string;
  triangle_count: number;
  vertex_count: number;
  shell_count: number;
  /** Along x, y and z, m. */
  size: [number, number, number];
  /** m3; null where it is unknown. */
  volume: number | null;
  /** How many of each, by name. */
  defects: Record<string, number>;
}
export interface Checked {
  file: string;
  checksum: string | null;
  format: string;
  unit_m: number;
  facet_count: number;
  check: Check;
}

export interface Level {
  rp: number;
  triangle_count: number;
  /** m2 */
  area: number;
  /** m3 */
  volume: number;
  eps_s: number;
}
export interface Curve {
  triangle_count: number;
  area: number;
  volume: number;
  levels: Level[];
}

export type Rule = 'recommended' | 'robust' | 'paper';
export type ErrorName =
  'area' | 'volume' | 'hausdorff' | 'mean_distance' | 'inertia' | 'size' | 'thickness' | 'thinnest' | 'convexity' | 'normals';

export interface Pick {
  rp: number;
  triangle_count: number;
  area: number;
  volume: number;
}
export interface Choice {
  file: string;
  /** Of the scan. */
  triangle_count: number;
  /** The rule that was asked for. */
  default: Rule;
  recommended?: Pick & { errors: Partial<Record<ErrorName, number>>; limited_by: ErrorName };
  robust: Pick;
  paper: Pick;
  /** The answer in sentences. */
  answer: string[];
  warnings: string[];
}
export interface ChoiceOptions extends ScanOptions {
  rule?: Rule;
  /** Shares that the recommended level keeps, as { mean_distance: 0.003 }; null: any. */
  tolerances?: Partial<Record<ErrorName, number | null>>;
}

export interface Measures {
  area: number;
  volume: number;
  closed: boolean;
  centroid: [number, number, number];
  inertia: [number[], number[], number[]];
  principal_moments: [number, number, number];
  dimensions: [number, number, number];
  sphericity: number;
  convexity: number;
}

/** What is wrong with a scan, and whether it can serve as a particle. */
export function check(scan: Scan, options: ScanOptions): Promise<Checked>;
/** A closed surface of it; `mesh` is a file of the format asked for. */
export function repair(scan: Scan, options: ScanOptions & { format?: MeshFormat }): Promise<{ mesh: Uint8Array; report: unknown }>;
/** Area, volume and criterion against the number of triangles. */
export function curve(scan: Scan, options: ScanOptions): Promise<Curve>;
/** How many triangles the scan needs. */
export function choose(scan: Scan, options: ChoiceOptions): Promise<Choice>;
/** The level of at most so many triangles, or of a share of them, as a file of the format asked for. */
export function simplify(scan: Scan, options: ScanOptions & ({ triangles: number } | { reduction: number }) & { format?: MeshFormat }): Promise<Uint8Array>;
/** Area, volume, inertia, dimensions, descriptors of shape. */
export function measure(scan: Scan, options: ScanOptions): Promise<Measures>;

/** Any call of the program, on files in memory. */
export function run(words: string[], files?: Record<string, Uint8Array>): Promise<{
  code: number;
  output: string;
  messages: string;
  /** A file that the call wrote; null where it did not. */
  file(path: string): Uint8Array | null;
}>;

/** What a call could not do, in the program's sentence. */
export class ScreeError extends Error {}
