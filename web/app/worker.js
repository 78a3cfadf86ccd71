// What runs beside the page: scree as WebAssembly (createScree is Emscripten's, web/wasm/session.c the C side) and the
// distances of the 3D view. One script, of which the page starts several workers. In: {id, do, ...}; out: {id, result},
// {id, error} or {progress: [phase, fraction]}.
import { Tree, distanceField } from '../src/distance.js';
import { equipment } from './equipment.js';

let module = null; // compiled, for every instance
let session = null; // the instance that keeps scans, or a pour
let said = [];

async function inflate(packed) {
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

function instance(hear = {}) {
  return globalThis.createScree({
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then((made) => done(made));
      return {};
    },
    print: (line) => said.push(line),
    printErr: (line) => said.push(line),
    report: (phase, fraction) => postMessage({ progress: [phase, fraction] }),
    ...hear,
  });
}

// A function of session.c that answers a scree_status.
function call(name, ...values) {
  const types = values.map((value) => (typeof value === 'string' || value === null ? 'string' : 'number'));
  if (session.ccall(name, 'number', types, values)) throw new Error(session.ccall('web_error', 'string', [], []));
}

const ask = (name, kind, ...values) => session.ccall(name, kind, values.map((value) => (typeof value === 'string' ? 'string' : 'number')), values);

function take(path) {
  const bytes = session.FS.readFile(path);
  session.FS.unlink(path);
  return bytes;
}

const folder = '/choice';
function prepareFolder() {
  for (const path of [folder, `${folder}/levels`]) if (!session.FS.analyzePath(path).exists) session.FS.mkdir(path);
}

// What is chosen and the levels to show: what the report's modules take.
function chosen(count) {
  prepareFolder();
  const { choice } = settings;
  call('web_write_choice', folder, choice.command, 0);
  const json = take(`${folder}/choice.json`), provenance = take(`${folder}/provenance.json`);
  const levels = [];
  for (let i = 0; i < count; i++) {
    const name = ask('web_name', 'string', i);
    const path = `${folder}/levels/${name}.levels`;
    call('web_write_levels', i, path);
    levels.push([name, take(path)]);
  }
  return { json, provenance, levels, memory: session.HEAPU8.length };
}

function pourCall(name, ...values) {
  if (ask(name, 'number', ...values)) throw new Error(ask('web_pour_error', 'string'));
}

// A scree_mesh in the module's memory: positions, triangles, their counts.
function surfaceOf(address) {
  const [positions, triangles, vertexCount, triangleCount] = new Uint32Array(session.HEAPU8.buffer, address, 4);
  return {
    points: Float32Array.from(new Float64Array(session.HEAPU8.buffer, positions, 3 * vertexCount)),
    triangles: new Uint32Array(session.HEAPU8.buffer, triangles, 3 * triangleCount).slice(),
  };
}

const settings = { choice: null, scans: 0 };
const trees = new Map();

const tasks = {
  async load({ packed }) {
    module = await WebAssembly.compile(await inflate(packed));
    session = await instance();
    return {
      version: ask('web_version', 'string'),
      tolerances: Object.fromEntries(['mean_distance', 'hausdorff', 'inertia', 'widths', 'thickness'].map((name) => [name, ask('web_default_tolerance', 'number', name)])),
    };
  },

  // The file is read, checked, repaired and decimated: {name, log}.
  async open({ file, name, unit }) {
    said = [];
    session.FS.writeFile(name, new Uint8Array(await file.arrayBuffer()), { canOwn: true });
    try {
      call('web_open', name, unit);
    } finally {
      session.FS.unlink(name);
    }
    try {
      call('web_decimate', settings.scans);
    } catch (error) {
      ask('web_close', null, settings.scans);
      throw error;
    }
    settings.scans++;
    return { name: ask('web_name', 'string', settings.scans - 1), log: said };
  },

  close({ index }) {
    ask('web_close', null, index);
    settings.scans--;
  },

  choose({ choice }) {
    settings.choice = choice;
    ask('web_tolerance', null, 0, 0);
    for (const [name, share] of Object.entries(choice.tolerances)) ask('web_tolerance', null, name, share);
    call('web_choose', choice.rule, choice.weight);
    return chosen(settings.scans);
  },

  // The mesh of a level and what it weighs there.
  level({ index, count, ending, density }) {
    const path = `level.${ending}`;
    call('web_write_level', index, count, path, 'level.mass.json', density);
    return { mesh: take(path), mass: take('level.mass.json') };
  },

  report() {
    prepareFolder();
    for (let i = 0; i < settings.scans; i++) call('web_write_levels', i, `${folder}/levels/${ask('web_name', 'string', i)}.levels`);
    call('web_write_choice', folder, settings.choice.command, 1);
    return { report: take(`${folder}/report.html`), csv: take(`${folder}/choice.csv`), json: take(`${folder}/choice.json`) };
  },

  // A call of the program, in an instance of its own that is gone afterwards. files: [[path, Blob or bytes]].
  async program({ words, files = [], wanted = [] }) {
    const out = [], complaints = [];
    const program = await instance({ print: (line) => out.push(line), printErr: (line) => complaints.push(line) });
    for (const [path, content] of files) program.FS.writeFile(path, content instanceof Blob ? new Uint8Array(await content.arrayBuffer()) : content);
    const code = program.callMain(words);
    return { code, out, complaints, files: wanted.map((path) => (program.FS.analyzePath(path).exists ? program.FS.readFile(path) : null)) };
  },

  // Begins a pour. shapes: [{bytes of a PLY, unit in m, share}]; values: of the sliders.
  pour({ shapes, container, values }) {
    const { template, fields, tube } = equipment[container];
    shapes.forEach(({ bytes, unit, share }, i) => {
      session.FS.writeFile(`shape-${i}.ply`, bytes);
      pourCall('web_pour_add', `shape-${i}.ply`, unit, share);
    });
    pourCall('web_pour_begin', template);
    const size = ask('web_pour_size', 'number');
    if (Number.isNaN(size)) throw new Error(ask('web_pour_error', 'string'));
    for (const [field, value] of Object.entries(fields(values, size))) pourCall('web_pour_set', field, String(value));
    pourCall('web_pour_start');
    const walls = Array.from({ length: ask('web_pour_walls', 'number') }, (_, i) => ({
      endless: Boolean(tube) || ask('web_pour_wall_is_endless', 'number', i) > 0, mesh: surfaceOf(ask('web_pour_wall', 'number', i)),
    }));
    return { walls, tube: tube && { sides: tube, width: ask('web_pour_width', 'number') }, step: ask('web_pour_step', 'number'), surfaces: shapes.map((_, i) => surfaceOf(ask('web_pour_mesh', 'number', i))) };
  },

  // Goes on to a time, but no longer than so many ms of the clock.
  advance({ until, ms }) {
    const begin = performance.now();
    let end = '';
    while (!end && ask('web_pour_time', 'number') < until && performance.now() - begin < ms) {
      pourCall('web_pour_advance', 20);
      end = ask('web_pour_end', 'string');
    }
    const entered = ask('web_pour_look', 'number');
    if (entered < 0) throw new Error('out of memory');
    const poses = new Float64Array(session.HEAPU8.buffer, ask('web_pour_poses', 'number'), 7 * (ask('web_pour_walls', 'number') + entered)).slice();
    const shapeOf = Uint32Array.from({ length: entered }, (_, body) => ask('web_pour_shape_of', 'number', body));
    return { poses, entered, shapeOf, end, left: ask('web_pour_left', 'number'), time: ask('web_pour_time', 'number'), energy: ask('web_pour_energy', 'number') };
  },

  // Distances of a level to a scan that was told before, or is now.
  field({ scan, surface, mesh, most }) {
    if (surface) {
      trees.clear(); // one scan is looked at
      trees.set(scan, new Tree(surface));
    }
    return distanceField(mesh, trees.get(scan), most);
  },
};

async function answer({ data }) {
  try {
    postMessage({ id: data.id, result: await tasks[data.do](data) });
  } catch (error) {
    const inside = error instanceof WebAssembly.RuntimeError ? 'scree failed inside; load the page anew: ' : '';
    postMessage({ id: data.id, error: `${inside}${error.message ?? error}` });
  }
}

// One after the other: a file is not opened before the module is there.
let last = Promise.resolve();
onmessage = (event) => {
  last = last.then(() => answer(event));
};
