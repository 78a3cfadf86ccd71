// meshoptimizer of today, where Debian's is older: meshopt_simplifyWithUpdate of the npm package, in
// WebAssembly, so its CPU seconds are above those of native code; levels are what counts here.
//
//   npm install --prefix build/bench/node meshoptimizer      (once; this file is run from there)
//   node meshoptimizer.mjs meshopt_today|meshopt_today_chained INPUT.ply PREFIX COUNT...
//
// INPUT is a binary PLY with double coordinates (bench_convert); lines and files as of harness.hpp.
import fs from 'node:fs';

let simplifier;
try {
  simplifier = (await import('meshoptimizer')).MeshoptSimplifier;
} catch {
  process.stderr.write('meshopt_today is not installed, left out\n');
  process.exit(0);
}
await simplifier.ready;

const [method, input, prefix, ...rest] = process.argv.slice(2);
const counts = rest.map(Number).sort((a, b) => b - a);

function read(path) {
  const bytes = fs.readFileSync(path);
  let at = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const header = bytes.subarray(0, at).toString();
  const number = (element) => Number(new RegExp(`element ${element} (\\d+)`).exec(header)[1]);
  const positions = new Float32Array(3 * number('vertex'));
  const triangles = new Uint32Array(3 * number('face'));
  for (let i = 0; i < positions.length; i++, at += 8) positions[i] = bytes.readDoubleLE(at);
  for (let i = 0; i < triangles.length; i++, at += 4) {
    if (i % 3 === 0) at++; // the list's length, always three
    triangles[i] = bytes.readUInt32LE(at);
  }
  return { positions, triangles };
}

function write({ positions, triangles }, path) {
  const number = new Map();
  for (const v of triangles) if (!number.has(v)) number.set(v, number.size);
  const header = Buffer.from(
    'ply\nformat binary_little_endian 1.0\n' +
      `element vertex ${number.size}\nproperty double x\nproperty double y\nproperty double z\n` +
      `element face ${triangles.length / 3}\nproperty list uchar int vertex_indices\nend_header\n`,
  );
  const body = Buffer.alloc(24 * number.size + (13 * triangles.length) / 3);
  let at = 0;
  for (const v of number.keys())
    for (let k = 0; k < 3; k++) at = body.writeDoubleLE(positions[3 * v + k], at);
  triangles.forEach((v, i) => {
    if (i % 3 === 0) at = body.writeUInt8(3, at);
    at = body.writeUInt32LE(number.get(v), at);
  });
  fs.writeFileSync(path, Buffer.concat([header, body]));
}

const mesh = read(input);
let state = null;
let seconds = 0;
for (const count of counts) {
  if (!state || !method.endsWith('_chained')) {
    state = { positions: mesh.positions.slice(), triangles: mesh.triangles.slice() };
    seconds = 0;
  }
  const started = process.cpuUsage();
  const none = new Float32Array(0);
  const result = simplifier.simplifyWithUpdate(
    state.triangles, state.positions, 3, none, 0, [], null, 3 * count, 1e9, [],
  );
  state.triangles = state.triangles.slice(0, result[0]);
  const spent = process.cpuUsage(started);
  seconds += (spent.user + spent.system) / 1e6;
  const path = `${prefix}_${count}.ply`;
  write(state, path);
  console.log([method, count, state.triangles.length / 3, seconds.toFixed(4), '', path].join(','));
}
