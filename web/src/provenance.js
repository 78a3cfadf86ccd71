// How results were made: version, command, inputs, machine and times, as a table.
import { folded, number, table } from './text.js';

function originOf(object) {
  if (object.sample)
    return `${object.file}: built in, ${number(object.sample.resolution_m * 1000)} mm between vertices, noise ${number(object.sample.noise_m * 1000)} mm, seed ${object.sample.seed}`;
  return `${object.file}: ${object.format}, 1 unit = ${number(object.unit_m)} m, XXH3-128 ${object.checksum}`;
}

function rowsOf(folder, version) {
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
  add('page made by', version && `scree ${version}`);
  return rows;
}

export function tellProvenance(host, folder, version) {
  table(folded(host, 'How this was made'), [{ head: 'what', value: (row) => row.what }, { head: 'value', value: (row) => row.value }],
    rowsOf(folder, version), 'provenance.csv', 'Version, command, inputs, machine and times').classList.add('texts');
}
