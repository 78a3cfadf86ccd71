// The section of one choice: table of the objects, and for the object picked the answer beside its mesh at every level
// and the scan, the curves, and the tables.
import { Chart, palette } from './chart.js';
import { Levels } from './levels.js';
import { holds } from './packed.js';
import { element, folded, number, percent, rpText, saveButton, table, whole } from './text.js';
import { View, link, mostEdgeTriangles, rampBar } from './view.js';

const mm = 1000;
const shownSamples = 24000; // small triangles that carry the distance colours

const pickOf = (object) => object[object.default];
const rules = {
  recommended: 'the coarsest level that keeps a tolerance on each of several errors against the scan',
  robust: 'the least Ip over every level, with the worst error at a level or any finer one, so that an area that is right by accident does not count',
  paper: 'the least Ip on a logarithmic grid of counts, as the paper has it',
};

// 1, 2 or 5 times a power of ten, not below x.
function roundUp(x) {
  if (!(x > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].map((f) => f * power).find((f) => f >= x * (1 - 1e-9));
}

// The curve in the file is a selection of levels: the chosen ones are put between.
function addPicks(trace, object) {
  for (const key of ['recommended', 'robust', 'paper', 'smooth', 'plain'].filter((name) => object[name])) {
    const { triangle_count: count, area, volume, level_eps_s: error, eps_s: worst } = object[key];
    const at = trace.findIndex((row) => row.count >= count);
    if (at < 0 || trace[at].count === count) continue;
    trace.splice(at, 0, { count, area, volume, error, worst: key === 'robust' ? worst : Math.max(error, trace[at].worst) });
  }
}

export class ChoiceSection {
  // folder: null where it is told later
  constructor(host, folder) {
    this.state = { object: 0, row: 0, wire: true, only: false, colored: false };
    this.head = element('div', null, host);
    this.host = element('div', null, host);
    this.build();
    if (folder) this.tell(folder);
  }

  // What draws is made ready before there is something to draw.
  warm() {
    return Promise.all([this.scanView, this.levelView].map((view) => view?.warm()));
  }

  // Also another choice in place of the one told.
  tell(folder) {
    if (!this.objects) this.color(folder.choice[0].default === 'recommended'); // that level begins with its distances
    this.objects = folder.choice.filter((entry) => !entry.set);
    this.set = folder.choice.find((entry) => entry.set);
    this.ids = new Map(folder.levels);
    this.levels = new Map();
    this.buttons = null;
    this.head.replaceChildren();
    this.tellAnswer();
    if (this.objects.length > 1) this.tellObjects();
    this.select(Math.min(this.state.object, this.objects.length - 1));
  }

  color(colored) {
    this.state.colored = colored;
    this.host.querySelectorAll('[data-key=colored]').forEach((box) => (box.checked = colored));
  }

  levelsOf(index) {
    const object = this.objects[index];
    const { name } = object;
    if (!this.levels.has(name)) {
      const levels = holds(this.ids.get(name)) ? new Levels(this.ids.get(name)) : null;
      if (levels) addPicks(levels.trace, object);
      this.levels.set(name, levels);
    }
    return this.levels.get(name);
  }

  // ---- what was asked, and the answer ----

  tellAnswer() {
    const { objects, set, head: host } = this;
    const { options } = objects[0];
    const many = objects.length > 1;
    element('h1', many ? `How many triangles do these ${objects.length} scans need?` : `How many triangles does ${objects[0].name} need?`, host);
    if (many) {
      element('p', set.answer.join(' '), host, { class: 'answer' });
      this.tellWarnings(host, set.warnings);
    }
    const { tolerances, tolerance_lengths: lengths } = options;
    const kept = [...Object.entries(tolerances).map(([name, share]) => `${name} ${percent(share)}`), ...Object.entries(lengths).map(([name, length]) => `${name} ${number(length * mm)} mm`)].join(', ');
    const area = `Ip = eps_s + ${options.weight === 1 ? '' : `${number(options.weight)} `}Nr/Nm with eps_s = |S − Sm|/Sm${options.reference === 'smooth' ? ', Sm free of scan noise' : ''} (Katagiri and Koyanaka 2020)`;
    this.how.textContent = `Chosen: ${rules[objects[0].default]}${objects[0].default === 'recommended' ? ` (${kept}; distances as shares of sqrt(S/π))` : ''}. ${objects[0].default === 'recommended' ? 'Beside it the paper\'s criterion' : 'The criterion'}: ${area}. Nr of the scan's Nm triangles are kept; Rp = Nr/Nm. Decimation: ${options.method}.`;
  }

  tellWarnings(host, warnings) {
    if (!warnings.length) return;
    const list = element('ul', null, host, { class: 'warnings' });
    for (const text of warnings) element('li', text, list);
  }

  tellObjects() {
    const { head: host } = this;
    const columns = [
      { head: 'object', value: (o) => o.name },
      { head: 'scan triangles', value: (o) => o.triangle_count, text: (o) => whole(o.triangle_count) },
      { head: 'scan noise in area', value: (o) => (o.noise.found ? o.noise.fraction : null), text: (o) => (o.noise.found ? percent(o.noise.fraction) : '–') },
      ...this.objects[0].recommended ? [
        { head: 'recommended: triangles', value: (o) => o.recommended.triangle_count, text: (o) => whole(o.recommended.triangle_count) },
        { head: 'mean distance', value: (o) => o.recommended.errors.mean_distance, text: (o) => percent(o.recommended.errors.mean_distance) },
        { head: 'largest', value: (o) => o.recommended.errors.hausdorff, text: (o) => percent(o.recommended.errors.hausdorff) },
        { head: 'limited by', value: (o) => o.recommended.limited_by },
      ] : [],
      ...[['robust', 'worst error'], ['paper', 'error']].flatMap(([key, error]) => [
        { head: `${key}: triangles`, value: (o) => o[key].triangle_count, text: (o) => whole(o[key].triangle_count) },
        { head: `${key}: Rp`, value: (o) => o[key].rp, text: (o) => rpText(o[key].rp) },
        { head: `${key}: ${error}`, value: (o) => o[key].eps_s, text: (o) => percent(o[key].eps_s) },
      ]),
    ];
    element('h2', 'The choice for each', host);
    table(host, columns, this.objects, 'choice.csv', 'Objects and the triangles chosen for each');
    element('h2', 'Look at', host);
    const group = element('div', null, host, { role: 'group', 'aria-label': 'Objects', class: 'objects' });
    this.buttons = this.objects.map((object, i) => {
      const button = element('button', object.name, group, { type: 'button' });
      button.addEventListener('click', () => this.select(i));
      return button;
    });
  }

  // ---- the object picked ----

  build() {
    const { host } = this;
    this.title = element('h2', null, host, { class: 'object-name' });
    this.first = element('div', null, host, { class: 'first' });
    const told = element('div', null, this.first);
    this.answer = element('p', null, told, { class: 'answer' });
    this.warnings = element('div', null, told);
    const more = element('details', null, told);
    element('summary', 'By which rule', more);
    this.how = element('p', null, more, { class: 'soft' });
    this.shown = element('div', null, this.first);
    this.buildViews();
    this.along = element('div', null, this.shown);
    const label = element('label', 'Level: move along the curve, or click into it', this.along, { class: 'soft' });
    this.slider = element('input', null, label, { type: 'range', min: 0, max: 1, step: 1, class: 'slider' });
    this.slider.addEventListener('input', () => this.moveTo(Number(this.slider.value)));
    this.jumps = element('div', null, this.along, { class: 'controls' });
    this.single = element('p', 'The scan has one level only: there is no curve to draw.', this.shown, { hidden: '' });
    this.levelText = element('p', null, this.shown, { class: 'level-text' });
    this.missing = element('p', 'The levels of this object are not in this page, which would grow too large: it shows tables only. `scree report` of this folder alone may hold them.', host, { hidden: '' });
    this.curves = folded(host, 'Area, Ip and errors along the levels');
    this.chartHost = element('div', null, this.curves, { class: 'chart' });
    this.errorsHost = element('div', null, this.curves, { class: 'chart errors' });
    this.tables = element('div', null, host);
  }

  buildViews() {
    this.viewsHost = element('div', null, this.shown);
    const pair = element('div', null, this.viewsHost, { class: 'views' });
    const cell = () => {
      const box = element('figure', null, pair, { class: 'view' });
      return [element('div', null, box), element('figcaption', null, box)];
    };
    const [scanHost, scanLabel] = cell();
    const [levelHost, levelLabel] = cell();
    Object.assign(this, { scanLabel, levelLabel });
    try {
      this.scanView = new View(scanHost, 'The scan in 3D');
      this.levelView = new View(levelHost, 'The level under the slider in 3D');
      link(this.scanView, this.levelView);
    } catch {
      this.scanView = this.levelView = null;
      pair.remove();
      element('p', 'This browser shows no WebGL, so the 3D views of the scan and of its levels, with edges and distance colours, are left out here. The curve, the slider\'s figures and all tables are complete.', this.viewsHost, { class: 'no-webgl', role: 'note' });
      return;
    }
    const controls = element('div', null, this.viewsHost, { class: 'controls' });
    const check = (text, key) => {
      const label = element('label', null, controls);
      const box = element('input', null, label, { type: 'checkbox', 'data-key': key });
      box.checked = this.state[key];
      label.append(` ${text}`);
      box.addEventListener('change', () => {
        this.state[key] = box.checked;
        this.showLevel(0);
      });
    };
    check('edges', 'wire');
    check('only edges', 'only');
    check('distances', 'colored');
    const home = element('button', 'Turn back', controls, { type: 'button' });
    home.addEventListener('click', () => this.levelView.home());
    this.scale = element('span', null, controls, { class: 'scale', hidden: '' });
    element('span', '0', this.scale);
    rampBar(this.scale);
    this.scaleHigh = element('span', null, this.scale);
    element('p', 'Turn with mouse or finger, or with the arrow keys once a view has the focus; plus and minus move nearer and away.', this.viewsHost, { class: 'soft hint' });
  }

  select(index) {
    this.state.object = index;
    const object = this.objects[index];
    const levels = this.levelsOf(index);
    this.buttons?.forEach((button, i) => button.setAttribute('aria-pressed', String(i === index)));
    this.title.textContent = object.name;
    this.title.hidden = this.objects.length === 1;
    this.answer.textContent = object.answer.join(' ');
    this.warnings.replaceChildren();
    this.tellWarnings(this.warnings, object.warnings);
    this.chart?.remove();
    this.errorsChart?.remove();
    this.chart = this.errorsChart = null;
    const several = Boolean(levels && levels.trace.length > 1);
    this.shown.hidden = !levels;
    this.missing.hidden = Boolean(levels);
    this.single.hidden = several;
    this.along.hidden = this.curves.hidden = !several;
    this.tables.replaceChildren();
    if (levels) {
      this.slider.max = levels.trace.length - 1;
      if (several) this.drawCurve(object, levels);
      if (several && object.recommended) this.drawErrors(object);
      this.offerJumps(object, levels);
      this.tellScan(object, levels);
      this.moveTo(this.rowOf(levels, pickOf(object).triangle_count), true);
    }
    this.tellTables(object, levels);
  }

  rowOf(levels, count) {
    const at = levels.trace.findIndex((row) => row.count >= count);
    return at < 0 ? levels.trace.length - 1 : at;
  }

  drawCurve(object, levels) {
    const { weight } = object.options;
    const rp = levels.trace.map(({ count }) => count / object.triangle_count);
    const ip = (error) => levels.trace.map((row, i) => row[error] + weight * rp[i]);
    const text = (v) => number(v, 3);
    this.chart = new Chart(this.chartHost, {
      x: { label: 'Rp = Nr/Nm', values: rp, text: (v) => v.toExponential(2) },
      yLabel: 'eps_s, Ip',
      yLeast: 10 ** (Math.floor(Math.log10(Math.min(...ip('error')))) - 1), // eps_s itself falls to zero
      series: [
        { label: 'eps_s', values: levels.trace.map((row) => row.error), color: palette[0], width: 1, text },
        { label: 'Ip', values: ip('error'), color: palette[1], dash: [6, 3], text },
        { label: 'Ip, worst eps_s so far', values: ip('worst'), color: palette[2], width: 2.5, text },
      ],
      marks: () => [
        { x: pickOf(object).triangle_count / object.triangle_count, color: palette[3], dash: [6, 5], label: 'chosen' },
        { x: rp[this.state.row] },
      ],
      pick: (row) => this.moveTo(row),
    });
  }

  // Each error over its tolerance against the count: what lies above 1 is not kept.
  drawErrors(object) {
    const { tolerances, tolerance_lengths: lengths } = object.options;
    const bounds = { ...tolerances };
    for (const [name, length] of Object.entries(lengths)) bounds[name] = Math.min(bounds[name] ?? Infinity, length / object.scan.size);
    const chosen = { triangle_count: object.recommended.triangle_count, errors: object.recommended.errors };
    const rows = new Map([...object.levels, chosen].filter((level) => Object.keys(level.errors).length > 2).map((level) => [level.triangle_count, level]));
    const levels = [...rows.values()].sort((a, b) => a.triangle_count - b.triangle_count);
    const names = Object.keys(bounds).filter((name) => levels.every((level) => level.errors[name] > 0));
    if (levels.length < 2) return;
    this.errorsChart = new Chart(this.errorsHost, {
      x: { label: 'triangles', values: levels.map((level) => level.triangle_count), text: whole },
      yLabel: 'error over its tolerance',
      series: [
        ...names.map((name, i) => ({ label: `${name}, of ${percent(bounds[name])}`, values: levels.map((level) => level.errors[name] / bounds[name]), color: palette[i % palette.length], width: 2, text: (v) => number(v, 3) })),
        { label: 'tolerance', values: levels.map(() => 1), color: palette[5], dash: [6, 3], text: () => '1' },
      ],
      marks: () => [{ x: object.recommended.triangle_count, color: palette[3], dash: [6, 5], label: 'recommended' }],
      pick: (row) => this.moveTo(this.rowOf(this.levelsOf(this.state.object), levels[row].triangle_count)),
    });
  }

  offerJumps(object, levels) {
    this.jumps.replaceChildren();
    const jump = (text, row) => element('button', text, this.jumps, { type: 'button' }).addEventListener('click', () => this.moveTo(row()));
    jump('Chosen', () => this.rowOf(levels, pickOf(object).triangle_count));
    for (const [text, factor] of [['Half', 0.5], ['Twice', 2]]) {
      jump(text, () => {
        const wanted = levels.trace[this.state.row].count * factor;
        const row = this.rowOf(levels, wanted);
        return factor < 1 && levels.trace[row].count > wanted && row > 0 ? row - 1 : row;
      });
    }
    jump('Finest', () => levels.trace.length - 1);
  }

  tellScan(object, levels) {
    if (!this.scanView) return;
    const shown = levels.shownScanCount;
    this.scanLabel.textContent = shown === levels.scanCount
      ? `The scan: ${whole(shown)} triangles`
      : `The scan has ${whole(levels.scanCount)} triangles; shown is its level of ${whole(shown)}, the finest that fits into this page`;
    this.scanView.show(levels.scan(), levels, {});
  }

  moveTo(row, atOnce = false) {
    this.state.row = row;
    this.slider.value = row;
    const levels = this.levelsOf(this.state.object);
    this.steps = levels.stepsTo(levels.trace[row].count);
    this.tellLevel(levels);
    this.chart?.redraw();
    if (atOnce) return this.showLevel(0);
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      this.showLevel(150);
    });
    return undefined;
  }

  tellLevel(levels) {
    const object = this.objects[this.state.object];
    const row = levels.trace[this.state.row];
    const rp = row.count / object.triangle_count;
    const volume = Math.abs(row.volume - object.volume) / Math.abs(object.volume);
    this.levelText.textContent = `${whole(row.count)} triangles, Rp = ${number(rp, 3)}: area ${number(row.area * mm * mm, 5)} mm², off by eps_s = ${percent(row.error)}; Ip = ${number(row.error + object.options.weight * rp, 3)}, with the worst eps_s so far ${number(row.worst + object.options.weight * rp, 3)}; volume off by ${percent(volume)}.`;
    this.slider.setAttribute('aria-valuetext', `${row.count} triangles`);
  }

  // The mesh at once; the distances, which take longer, when the slider has rested for `wait` ms.
  showLevel(wait) {
    if (!this.levelView) return;
    const levels = this.levelsOf(this.state.object);
    const row = levels.trace[this.state.row];
    const mesh = levels.level(this.steps);
    const shown = mesh.triangles.length / 3;
    const { wire, only, colored } = this.state;
    const edges = shown <= mostEdgeTriangles;
    const options = { wire: wire && edges, only: only && edges };
    const notes = [`${whole(shown)} triangles`];
    if (row.count > shown) notes.push('the finest level that fits into this page');
    if ((wire || only) && !edges) notes.push(`edges are drawn up to ${whole(mostEdgeTriangles)}`);
    this.scale.hidden = !colored;
    this.mesh = mesh;
    this.levelView.show(mesh, levels, options);
    this.levelLabel.textContent = `This level: ${notes.join('; ')}`;
    document.body.dataset.shownTriangles = shown;
    delete document.body.dataset.largestDistance;
    clearTimeout(this.coloring);
    if (!colored) return;
    if (!levels.measured) this.levelLabel.textContent = `This level: ${notes.join('; ')}; measuring distances ...`;
    this.coloring = setTimeout(() => this.colorLevel(levels, mesh, options, notes), levels.measured ? wait : 30);
  }

  async colorLevel(levels, mesh, options, notes) {
    const field = await levels.field(mesh, shownSamples);
    levels.measured = true;
    if (this.mesh !== mesh) return; // another one is shown by now
    const largest = field.largest * levels.step * mm;
    // a few far points must not take the colours from all others
    const range = roundUp(Float32Array.from(field.distances).sort()[Math.floor(0.98 * field.distances.length)] * levels.step * mm);
    this.levelView.show(mesh, levels, { ...options, field, range: range / mm / levels.step });
    this.scaleHigh.textContent = `${number(range)} mm${largest > range ? ' and more' : ''}`;
    this.levelLabel.textContent = `This level: ${notes.join('; ')}; ${this.distancesOf(levels, mesh) ?? `from here to the scan: mean ${number(field.mean * levels.step * mm, 2)} mm, largest found ${number(largest, 2)} mm`}`;
    document.body.dataset.largestDistance = largest;
  }

  // What the choice found of a level, both ways between it and the scan; undefined where it did not look at it.
  distancesOf(levels, mesh) {
    const object = this.objects[this.state.object];
    const count = mesh.triangles.length / 3;
    const found = [object.recommended, ...object.levels].find((level) => level?.triangle_count === count && level.errors?.mean_distance !== undefined);
    if (!found) return undefined;
    const length = (share) => `${number(share * object.scan.size * mm, 2)} mm`;
    return `distance to the scan: mean ${length(found.errors.mean_distance)}, largest ${length(found.errors.hausdorff)}`;
  }

  // ---- tables ----

  tellTables(object, levels) {
    const host = folded(this.tables, 'Candidate levels');
    const names = { recommended: 'recommended: keeps the tolerances', cost: 'least mean distance / size + Nr/100,000', paper: 'paper: least Ip on the grid', robust: 'robust: least Ip, worst eps_s so far', smooth: 'robust, free of scan noise', plain: 'least Ip of all levels' };
    const keys = ['paper', 'robust', 'smooth', 'plain', 'recommended', 'cost'].filter((key) => object[key]);
    const rows = [
      { name: 'scan', pick: { triangle_count: object.triangle_count, area: object.area, volume: object.volume, level_eps_s: 0 }, measures: levels?.measures[0] },
      ...keys.map((key, i) => ({ name: `${names[key]}${key === object.default ? ' (chosen)' : ''}${object[`${key}_is_accident`] ? ' (an accident)' : ''}`, pick: object[key], measures: levels?.measures[i + 1] })),
    ];
    const scan = levels?.measures[0];
    const value = (head, get, digits = 4) => ({ head, value: get, text: (row) => number(get(row), digits) });
    const measured = (head, get, digits) => value(head, (row) => (row.measures ? get(row.measures) : null), digits);
    const moments = (m) => [m.moment_1, m.moment_2, m.moment_3];
    const difference = (m) => Math.hypot(...moments(m).map((x, i) => x - moments(scan)[i])) / Math.hypot(...moments(scan));
    const columns = [
      { head: 'level', value: (row) => row.name },
      { head: 'triangles', value: (row) => row.pick.triangle_count, text: (row) => whole(row.pick.triangle_count) },
      value('Rp', (row) => row.pick.triangle_count / object.triangle_count, 3),
      { head: 'Ip', value: (row) => row.pick.ip ?? null, text: (row) => (row.pick.ip === undefined || row.pick === object.cost ? '' : number(row.pick.ip, 3)) },
      { head: 'fewest, Ip within a tenth', value: (row) => row.pick.similar_fewest ?? null, text: (row) => (row.pick.similar_fewest ? whole(row.pick.similar_fewest) : '') },
      { head: 'most', value: (row) => row.pick.similar_most ?? null, text: (row) => (row.pick.similar_most ? whole(row.pick.similar_most) : '') },
      value('eps_s', (row) => row.pick.level_eps_s, 3),
      value('area / mm²', (row) => row.pick.area * mm ** 2, 6),
      value('volume / mm³', (row) => row.pick.volume * mm ** 3, 6),
      { head: 'volume error', value: (row) => Math.abs(row.pick.volume - object.volume) / Math.abs(object.volume), text: (row) => percent(Math.abs(row.pick.volume - object.volume) / Math.abs(object.volume)) },
      ...['length', 'width', 'height'].map((key) => measured(`${key} / mm`, (m) => m[key] * mm)),
      measured('inertia error', (m) => difference(m), 2),
      measured('sphericity', (m) => m.sphericity),
      measured('convexity', (m) => m.convexity),
    ];
    table(host, columns, rows, `${object.name}-candidates.csv`, `Measures of ${object.name} at the candidate levels`);
    element('p', 'Length, width and height are of the smallest box around; the inertia error is that of the three principal moments together.', host, { class: 'soft' });
    const more = element('details', null, host);
    element('summary', 'Every level of the grid', more);
    const errors = [...new Set(object.levels.flatMap((level) => Object.keys(level.errors)))];
    table(more, [
      { head: 'Rp', value: (l) => l.rp, text: (l) => rpText(l.rp) },
      { head: 'triangles', value: (l) => l.triangle_count, text: (l) => whole(l.triangle_count) },
      { head: 'reached', value: (l) => l.reached, text: (l) => (l.reached ? 'yes' : 'no') },
      { head: 'area / m2', value: (l) => l.area, text: (l) => number(l.area, 6) },
      { head: 'volume / m3', value: (l) => l.volume, text: (l) => number(l.volume, 6) },
      ...['eps_s', 'ip', 'worst_eps_s', 'robust_ip'].map((key) => ({ head: key, value: (l) => l[key], text: (l) => number(l[key], 3) })),
      ...errors.filter((key) => key !== 'area').map((key) => ({ head: `error: ${key}`, value: (l) => l.errors[key], text: (l) => number(l.errors[key], 3) })),
    ], object.levels, `${object.name}-grid.csv`, `Levels of the grid of ${object.name}`);
    if (levels) {
      const rows = () => [['triangles', 'rp', 'area_m2', 'volume_m3', 'eps_s', 'worst_eps_s'], ...levels.trace.map((r) => [r.count, r.count / object.triangle_count, r.area, r.volume, r.error, r.worst])];
      saveButton(host, 'Save the curve as CSV', `${object.name}-curve.csv`, rows);
    }
  }
}
