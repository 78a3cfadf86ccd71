// The skeleton that all kinds of results share: title, state, the sentence that answers, what would mislead, a picture
// beside a few numbers, the next step; then charts in grids, tables, and how it was made.
import { Pointer } from './plot.js';
import { element, folded, number, table } from './text.js';

const signs = { answered: '✓', 'not reached': '✗', 'not enough': '○' };
const classes = { answered: '', 'not reached': 'no', 'not enough': 'few' };

// What the program says, as a page has it: signs for +-, deg and -.
export const said = (text) => (text ?? '').replaceAll(' +- ', ' ± ').replace(/(\d) deg\b/g, '$1°').replace(/(^|[\s(])-(?=\d)/g, '$1−').replace(/m2\b/g, 'm²').replace(/m3\b/g, 'm³');
export const words = (name) => name.split('.').at(-1).replaceAll('_', ' ');
export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
export const unitText = (unit) => (unit === 'deg' ? '°' : unit ? `\u00a0${said(unit)}` : '');
export const axisName = (name, unit) => `${words(name)}${unit ? `, ${unit === 'deg' ? '°' : said(unit)}` : ''}`;
// Of a number that is known to within the spread.
export const decimals = (spread) => (spread > 0 && Number.isFinite(spread) ? Math.max(0, Math.min(9, 1 - Math.floor(Math.log10(spread)))) : 3);
export const fixed = (value, spread) => (Number.isFinite(value) && value !== null ? value.toFixed(decimals(spread)).replace('-', '−') : '–');

// Numbers with their units and uncertainties stand out.
function emphasised(host, text) {
  const pattern = /(?<![\p{L}\d.\-_:])[−+±]?(?:\d[\d,]*\.\d+(?:e-?\d+)?|\d[\d,]*(?: to \d[\d,]*)?(?=[ °]?(?:°|%|mm|m|kg|s|W|N|J|triangles|±)(?!\p{L})))(?:°| ?%| (?:mm|m|kg\/s|kg|s|W|N|J|triangles)(?!\p{L}))?(?: ± [\d.]+(?:°| (?:mm|m|kg\/s|kg|s)(?!\p{L}))?)?(?: \([−\d][^()]*\))?/gu;
  let from = 0;
  for (const found of text.matchAll(pattern)) {
    const length = found[0].replace(/[.,]$/, '').length;
    host.append(text.slice(from, found.index));
    element('em', text.slice(found.index, found.index + length), host);
    from = found.index + length;
  }
  host.append(text.slice(from));
}

export class Skeleton {
  // told: {verdict, state, sentence, but, next}; wide: the picture takes more of the width
  constructor(host, { title, kind, date, told, wide = false }) {
    this.host = element('div', null, host, { class: `report ${classes[told.verdict] ?? ''}` });
    this.pointer = new Pointer();
    const line = element('div', null, this.host, { class: 'line' });
    element('span', title, line, { class: 'title' });
    element('span', kind, line);
    if (date) element('span', date.slice(0, 16).replace('T', ' ').replace(/Z?$/, ' UTC'), line, { class: 'date' });
    if (told.state) element('p', `${signs[told.verdict] ?? ''} ${capital(said(told.state))}`, this.host, { class: 'state' });
    this.answer = element('div', null, this.host, { class: 'answer' });
    emphasised(element('h1', null, this.answer), said(told.sentence));
    if (told.but) element('p', said(told.but), this.answer, { class: 'but' });
    const hero = element('div', null, this.host, { class: `hero ${wide ? 'wide' : ''}` });
    this.picture = element('div', null, hero, { class: 'pic' });
    this.side = element('div', null, hero, { class: 'side' });
    this.next = told.next;
    this.hero = hero;
  }

  // value with its unit, what it is known to, and a few words; size: main, half or full; bad: it is off
  tile(name, value, unit, known, note, size = '', bad = false) {
    this.tiles ??= element('dl', null, this.side, { class: 'tiles' });
    const tile = element('div', null, this.tiles, { class: `tile ${size}` });
    element('dt', name, tile);
    const shown = element('dd', null, tile), number = element('span', value, shown, { class: 'v' });
    if (unit === '°') number.append(unit);
    else if (unit) element('small', unit.trim(), number);
    if (known) element('span', known, shown, { class: 'e' });
    if (note) element('span', note, shown, { class: bad === null ? 'nt' : bad ? 'nt bad' : 'nt good' });
    return tile;
  }
  plain(name, value, unit, known, note, size) { return this.tile(name, value, unit, known, note, size, null); }

  tellNext() {
    if (!this.next) return;
    const line = element('p', null, this.side, { class: 'next' });
    element('strong', 'Next: ', line);
    line.append(said(this.next));
  }

  // A grid of charts, each a function of its host; more than two rows are folded.
  grid(title, charts, most = 6) {
    const all = charts.filter(Boolean);
    if (!all.length) return;
    element('h2', title, this.host);
    const grid = element('div', null, this.host, { class: 'grid' });
    all.slice(0, most).forEach((chart) => chart(grid));
    if (all.length <= most) return;
    const more = element('details', null, this.host);
    element('summary', `${all.length - most} more`, more);
    const rest = element('div', null, more, { class: 'grid' });
    all.slice(most).forEach((chart) => chart(rest));
  }
}

export function tellProvenance(host, folder, version, more = []) {
  const run = folder.provenance ?? {}, origin = folder.calibration ?? folder.study ?? folder.scene ?? {};
  const first = folder.choice?.[0] ?? folder.clump?.[0];
  const sample = (o) => `${o.file}: built in, ${number(o.sample.resolution_m * 1000)} mm between vertices, noise ${number(o.sample.noise_m * 1000)} mm, seed ${o.sample.seed}`;
  const source = (o) => (o.sample ? sample(o) : `${o.file}: ${o.format}, 1 unit = ${number(o.unit_m)} m, XXH3-128 ${o.checksum}`);
  const rows = [
    ['Results', folder.folder], ['Command', run.command ?? origin.command ?? first?.command],
    ['Made', [run.started ?? origin.started, origin.ended && `to ${origin.ended}`].filter(Boolean).join(' ')],
    ['By', [`scree ${run.version ?? origin.version ?? first?.version}`, run.processor ?? origin.machine, run.processors && `${run.processors} processors`, run.system].filter(Boolean).join(', ')],
    ['Cost', run.elapsed_s !== undefined && `${number(run.elapsed_s, 3)} s, ${number(run.processor_s, 3)} s of processor time, ${run.threads} threads`],
    ...more,
    ...[...(folder.choice?.filter((entry) => !entry.set) ?? []), ...(folder.clump ?? [])].map((o) => [`Input ${o.name}`, source(o)]),
    ...(origin.inputs ?? []).map((file) => [`Input ${file.path}`, `XXH3-128 ${file.checksum}`]),
    ...(folder.scene?.shapes ?? []).map((shape) => [`Shape ${shape.name}`, shape.source]),
    ['Page made by', version && `scree ${version}`],
  ].filter(([, value]) => value);
  table(folded(host, 'How this was made', false), [{ head: 'what', value: (row) => row[0] }, { head: 'value', value: (row) => row[1] }],
    rows, 'provenance.csv', 'Version, command, inputs, machine and times').classList.add('texts');
}
