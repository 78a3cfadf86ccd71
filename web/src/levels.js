// The file of levels of one object (docs/reference/formats.md): the scan, a fine level, and the collapses from it down.
// Positions are integers on a grid: metres = low + step * integer. A level is rebuilt from the fine one for every
// position of the slider: vertices follow their chain of collapses, triangles whose corners fall together are dropped.
import { Tree, distanceField } from './distance.js';
import { Reader, decodeMesh, decodeVertices } from './packed.js';

const measureNames = ['triangle_count', 'area', 'volume', 'length', 'width', 'height', 'moment_1', 'moment_2', 'moment_3', 'sphericity', 'convexity'];

export class Levels {
  constructor(id) {
    const reader = new Reader(id, 40);
    this.low = reader.reals(3);
    this.step = reader.real();
    this.scanCount = reader.u32();
    this.trace = Array.from({ length: reader.u32() }, () => {
      const [count, area, volume, error, worst] = reader.reals(5);
      return { count, area, volume, error, worst };
    });
    this.measures = Array.from({ length: reader.u32() }, () => {
      const values = reader.reals(measureNames.length);
      return Object.fromEntries(measureNames.map((name, i) => [name, values[i]]));
    });
    const base = reader.mesh();
    const count = reader.u32();
    const pairs = reader.buffer();
    const moves = reader.buffer();
    this.packedScan = reader.mesh();
    this.base = decodeMesh(base);
    this.baseCount = base.triangleCount;
    this.shownScanCount = this.packedScan.triangleCount || this.baseCount;
    this.pairs = new Uint32Array(decodeVertices(pairs, count, 8));
    this.place(new Uint16Array(decodeVertices(moves, count, 8)), count);
    this.root = new Uint32Array(base.vertexCount);
    this.frame();
  }

  // Where each collapse puts the vertex that it keeps, and how many triangles are left behind it.
  place(moves, count) {
    const now = Uint16Array.from(this.base.points);
    this.placed = new Uint16Array(3 * count);
    this.counts = new Uint32Array(count + 1);
    this.counts[0] = this.baseCount;
    for (let i = 0; i < count; i++) {
      const kept = this.pairs[2 * i];
      for (let k = 0; k < 3; k++) this.placed[3 * i + k] = now[3 * kept + k] += moves[4 * i + k];
      this.counts[i + 1] = this.counts[i] - moves[4 * i + 3];
    }
  }

  // The middle and size of the object, and half its box, in steps of the grid.
  frame() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const { points } = this.base;
    for (let i = 0; i < points.length; i++) {
      low[i % 3] = Math.min(low[i % 3], points[i]);
      high[i % 3] = Math.max(high[i % 3], points[i]);
    }
    this.centre = low.map((x, k) => (x + high[k]) / 2);
    this.half = low.map((x, k) => (high[k] - x) / 2);
    this.size = 2 * Math.hypot(...this.half) || 1;
  }

  // Where there is none in the page, the fine level.
  scan() {
    if (!this.packedScan.triangleCount) return this.base;
    this.decodedScan ??= decodeMesh(this.packedScan);
    return this.decodedScan;
  }

  // The distances of a level's surface from the scan's (distanceField). Who has a worker measures there instead.
  static async measure(levels, mesh, most) {
    levels.tree ??= new Tree(levels.scan());
    return distanceField(mesh, levels.tree, most);
  }
  field(mesh, most) {
    return Levels.measure(this, mesh, most);
  }

  // How many collapses lead to the first level with at most `count` triangles.
  stepsTo(count) {
    let low = 0, high = this.counts.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.counts[middle] <= count) high = middle;
      else low = middle + 1;
    }
    return low;
  }

  level(steps) {
    const { base, pairs, placed, root } = this;
    const points = Float32Array.from(base.points);
    for (let v = 0; v < root.length; v++) root[v] = v;
    for (let i = 0; i < steps; i++) for (let k = 0; k < 3; k++) points[3 * pairs[2 * i] + k] = placed[3 * i + k];
    for (let i = steps - 1; i >= 0; i--) root[pairs[2 * i + 1]] = root[pairs[2 * i]];
    const triangles = new Uint32Array(3 * this.counts[steps]);
    let used = 0;
    for (let t = 0; t < base.triangles.length; t += 3) {
      const a = root[base.triangles[t]], b = root[base.triangles[t + 1]], c = root[base.triangles[t + 2]];
      if (a === b || b === c || c === a) continue;
      triangles[used] = a;
      triangles[used + 1] = b;
      triangles[used + 2] = c;
      used += 3;
    }
    return { points, triangles: triangles.subarray(0, used) };
  }
}
