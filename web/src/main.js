// Fills the page from the data in it. Everything that comes from files is set as text.
import './page.css';
import { CalibrationSection } from './calibrate.js';
import { ChoiceSection } from './choice.js';
import { ClumpSection } from './clump.js';
import { decoderReady } from './packed.js';
import { setShapeColors } from './pile.js';
import { SceneSection } from './scene.js';
import { StudySection } from './study.js';
import { element, number, table } from './text.js';

const data = JSON.parse(document.getElementById('data').textContent);
const page = document.getElementById('page');

function originOf(object) {
  if (object.sample)
    return `${object.file}: built in, ${number(object.sample.resolution_m * 1000)} mm between vertices, noise ${number(object.sample.noise_m * 1000)} mm, seed ${object.sample.seed}`;
  return `${object.file}: ${object.format}, 1 unit = ${number(object.unit_m)} m, XXH3-128 ${object.checksum}`;
}

function provenanceRows(folder) {
  const rows = [];
  const add = (what, value) => value !== null && value !== undefined && rows.push({ what, value: String(value) });
  const first = folder.choice?.[0] ?? folder.clump?.[0];
  const run = folder.provenance ?? folder.scene ?? {};
  add('results', folder.folder);
  add('scree', run.version ?? first?.version);
  add('command', run.command ?? first?.command);
  if (folder.study) {
    add('study', `${folder.study.name}: design ${folder.study.design}, decimation ${folder.study.method}, seed ${folder.study.seed}`);
    add('runs made by', `scree ${folder.study.version}, ${folder.study.workers ? `${folder.study.workers} workers at work, ` : ''}${number(folder.study.seconds_spent, 3)} s of processor time`);
  }
  if (folder.calibration) add('scree', folder.calibration.version);
  if (folder.calibration) add('seed', folder.calibration.seed);
  add('started', run.started);
  if (run.elapsed_s !== undefined) add('time', `${number(run.elapsed_s, 3)} s, ${number(run.processor_s, 3)} s of processor time, ${run.threads} threads`);
  if (run.processor) add('machine', `${run.processor}, ${run.processors} processors; ${run.system}`);
  for (const object of [...(folder.choice?.filter((entry) => !entry.set) ?? []), ...(folder.clump ?? [])]) add(`input ${object.name}`, originOf(object));
  for (const shape of folder.scene?.shapes ?? []) add(`shape ${shape.name}`, shape.source);
  add('page made by', `scree ${data.version}`);
  return rows;
}

async function fill() {
  await decoderReady;
  setShapeColors(data.shapeColors);
  for (const folder of data.folders) {
    const host = element('section', null, page);
    if (folder.choice) new ChoiceSection(host, folder);
    if (folder.clump) new ClumpSection(host, folder);
    if (folder.scene) new SceneSection(host, folder);
    if (folder.study) new StudySection(host, folder);
    if (folder.calibration) new CalibrationSection(host, folder);
    element('h2', 'How this was made', host);
    table(host, [{ head: 'what', value: (row) => row.what }, { head: 'value', value: (row) => row.value }],
      provenanceRows(folder), 'provenance.csv', 'Version, command, inputs, machine and times').classList.add('texts');
  }
  const objects = data.folders.flatMap((folder) => folder.choice?.filter((entry) => !entry.set) ?? []);
  document.querySelectorAll('body > img').forEach((picture) => picture.remove()); // of piles shown in 3D
  if (objects.length === 1) document.title = `${objects[0].name}: scree report`;
}

const wait = document.getElementById('wait');
try {
  await fill();
  wait.remove();
  document.body.dataset.ready = 'true';
} catch (error) {
  wait.textContent = `This page cannot be shown in full: ${error.message}`;
  document.body.dataset.ready = 'failed';
  throw error;
}
