// scree for JavaScript. Each function is one call of the program, in an instance of its own with files in memory: what
// it answers is the program's JSON, whose fields docs/reference/formats.md has. SI units throughout.
import { readFile } from 'node:fs/promises';
import { basename } from 'node:path';
import createScree from './lib/scree_web.cjs';

export class ScreeError extends Error {}

let compiled = null;
async function instance(hear) {
  compiled ??= WebAssembly.compile(await readFile(new URL('./lib/scree_web.wasm', import.meta.url)));
  const module = await compiled;
  return createScree({
    ...hear,
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then((made) => done(made));
      return {};
    },
  });
}

export async function run(words, files = {}) {
  const out = [], complaints = [];
  const program = await instance({ print: (line) => out.push(line), printErr: (line) => complaints.push(line) });
  for (const [path, bytes] of Object.entries(files)) program.FS.writeFile(path, bytes);
  const code = program.callMain(words);
  return {
    code, output: out.join('\n'), messages: complaints.join('\n'),
    file: (path) => (program.FS.analyzePath(path).exists ? program.FS.readFile(path) : null),
  };
}

// A scan as the program gets it: the bytes, under a name.
async function scanOf(scan, options) {
  if (!options?.unit) throw new ScreeError('unit: say which unit the coordinates are in ("mm", "m", ...)');
  const name = options.name ?? (typeof scan === 'string' ? basename(scan) : 'scan');
  return [name, typeof scan === 'string' ? await readFile(scan) : scan];
}

// Runs a verb on the scan; throws its sentence where it fails, unless that code is allowed.
async function ask(verb, scan, options, words, allowed = 0) {
  const [name, bytes] = await scanOf(scan, options);
  const done = await run([verb, name, '-u', options.unit, ...words], { [name]: bytes });
  if (done.code > allowed || (done.code && !done.output)) throw new ScreeError(done.messages.replace(/^scree: /gm, ''));
  return done;
}

export async function check(scan, options) {
  const [entry] = JSON.parse((await ask('check', scan, options, ['--json'], 1)).output);
  if (entry.failure) throw new ScreeError(entry.failure);
  return entry;
}

export async function repair(scan, options) {
  const path = `repaired.${options?.format ?? 'stl'}`;
  const done = await ask('repair', scan, options, ['--json', '-o', path]);
  return { mesh: done.file(path), report: JSON.parse(done.output) };
}

export async function curve(scan, options) {
  return JSON.parse((await ask('curve', scan, options, ['--json'])).output);
}

export async function measure(scan, options) {
  return JSON.parse((await ask('measure', scan, options, ['--json'])).output)[0];
}

export async function choose(scan, options) {
  const words = ['--json'];
  const { rule, tolerances } = options ?? {};
  if (rule) words.push('--rule', rule);
  if (tolerances) words.push('-t', Object.entries(tolerances).map(([name, share]) => `${name}=${share === null ? 'none' : share}`).join(','));
  return JSON.parse((await ask('choose', scan, options, words)).output)[0];
}

export async function simplify(scan, options) {
  const path = `level.${options?.format ?? 'stl'}`;
  const { triangles, reduction } = options ?? {};
  if ((triangles === undefined) === (reduction === undefined)) throw new ScreeError('simplify: give triangles or reduction');
  const done = await ask('simplify', scan, options, triangles === undefined ? ['-r', String(reduction), '-o', path] : ['-n', String(triangles), '-o', path]);
  return done.file(path);
}
