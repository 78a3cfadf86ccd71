// The section of one choice: table of the objects, and for the object picked the answer beside its mesh at every level
// and the scan, the curves, and the tables.
import { Levels } from './levels.js';
import { Skeleton, capital, words } from './page.js';
import { holds } from './packed.js';
import { Plot } from './plot.js';
import { element, folded, number, percent, rpText, saveButton, table, whole } from './text.js';
import { View, link, mostEdgeTriangles, rampBar } from './view.js';

const mm = 1000;
const shownSamples = 24000; // small triangles that carry the distance colours
const shownErrors = ['mean_distance', 'hausdorff', 'thickness', 'thinnest', 'inertia', 'widths'];
const errorWords = { mean_distance: 'mean distance', hausdorff: 'greatest distance', thickness: 'distance over walls', thinnest: 'thinnest walls' };
const wordsOf = (error) => errorWords[error] ?? words(error);

const pickOf = (object) => object[object.default];
const rules = {
  recommended: 'the coarsest level that keeps a tolerance on each of several errors against the scan',
  paper: 'the least Ip on a logarithmic grid of counts, as the paper has it',
};

// 1, 2 or 5 times a power of ten, not below x.
function roundUp(x) {
  if (!(x > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].map((f) => f * power).find((f) => f >= x * (1 - 1e-9));
}

// What each error may be, as a share of the size.
function boundsOf(object) {
  const { tolerances, tolerance_lengths: lengths } = object.options, bounds = { ...tolerances };
  for (const [name, length] of Object.entries(lengths)) bounds[name] = Math.min(bounds[name] ?? Infinity, length / (object.scan?.size ?? 1));
  return bounds;
}

// The curve in the file is a selection of levels: the chosen ones are put between.
function addPicks(trace, object) {
  for (const key of ['recommended', 'robust', 'paper'].filter((name) => object[name])) {
    const { triangle_count: count, area, volume, eps_s: error, worst_eps_s: worst } = object[key];
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
    this.host.prepend(this.first); // it may stand in the head
    this.head.replaceChildren();
    this.tellAnswer(folder);
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

  tellAnswer(folder) {
    const { objects, set } = this, [first] = objects, { options } = first, many = objects.length > 1, told = many ? set : first, byErrors = first.default === 'recommended';
    const kept = objects.every((o) => !o.recommended || o.recommended.largest_over_tolerance <= 1.0001), [sentence, ...others] = told.answer;
    this.page = new Skeleton(this.head, {
      title: many ? `${objects.length} scans` : first.name, kind: 'choice of triangles', date: folder.provenance?.started, wide: !many,
      told: { verdict: byErrors && !kept ? 'not reached' : 'answered', state: byErrors ? (kept ? 'Chosen: all tolerances are kept' : 'Not reached: no level keeps all tolerances') : 'Chosen by the paper\'s criterion', sentence, but: [...others, ...told.warnings].map(capital).join(' ') },
    });
    if (many) this.tellObjects();
    else this.tellNumbers(first);
    const bounds = [...Object.entries(options.tolerances).map(([name, share]) => `${name} ${percent(share)}`), ...Object.entries(options.tolerance_lengths).map(([name, length]) => `${name} ${number(length * mm)} mm`)].join(', ');
    const area = `Ip = eps_s + ${options.weight === 1 ? '' : `${number(options.weight)} `}Nr/Nm with eps_s = |S − Sm|/Sm${options.reference === 'smooth' ? ', Sm free of scan noise' : ''} (Katagiri and Koyanaka 2020)`;
    this.how.textContent = `Chosen: ${rules[first.default]}${byErrors ? ` (${bounds}; distances as shares of sqrt(S/π))` : ''}. ${byErrors ? 'Beside it the paper\'s criterion' : 'The criterion'}: ${area}. Nr of the scan's Nm triangles are kept; Rp = Nr/Nm. Decimation: ${options.method}.`;
  }

  tellNumbers(object) {
    const { page } = this, pick = pickOf(object), { recommended } = object, bounds = boundsOf(object);
    page.picture.append(this.first);
    page.plain('Use, triangles', whole(pick.triangle_count), '', `of the scan's ${whole(object.triangle_count)}`, `Rp = ${rpText(pick.triangle_count / object.triangle_count)}`, 'main full');
    for (const name of shownErrors.filter((key) => recommended?.errors[key] !== undefined && bounds[key]))
      page.plain(capital(wordsOf(name)), number(100 * recommended.errors[name], 2), '%', `of ${percent(bounds[name])} kept`, object.limited_by === name ? 'sets the count' : '', 'half');
    if (!recommended) page.plain('Error of the area', number(100 * pick.eps_s, 2), '%', '', 'eps_s', 'half');
    page.plain('By the paper\'s criterion', whole(object.paper.triangle_count), '', 'triangles', '', 'half');
  }

  // A row for each, with how much of each tolerance it uses.
  tellObjects() {
    const { page, objects } = this, bounds = boundsOf(objects[0]), names = shownErrors.filter((key) => bounds[key] && objects.some((o) => o.recommended?.errors[key] !== undefined));
    page.side.remove();
    page.hero.classList.add('alone');
    this.pictures = [];
    const used = (name) => ({
      head: `${wordsOf(name)}, of ${percent(bounds[name])} kept`, value: (o) => o.recommended?.errors[name], text: () => '',
      draw: (o, cell) => {
        const share = (o.recommended?.errors[name] ?? NaN) / boundsOf(o)[name];
        cell.append(percent(o.recommended?.errors[name] ?? NaN));
        cell.classList.toggle('limit', o.limited_by === name);
        if (share >= 0) element('meter', null, cell, { min: 0, max: 1, value: Math.min(1, share), 'aria-label': `${percent(share)} of its tolerance` });
      },
    });
    const made = table(page.picture, [
      { head: 'shape', value: (o) => o.name, text: () => '', draw: (o, cell) => {
        const button = element('button', null, cell, { type: 'button' });
        this.pictures.push([o, button]);
        button.append(o.name);
        button.addEventListener('click', () => this.select(objects.indexOf(o)));
      } },
      { head: 'use, triangles', value: (o) => pickOf(o).triangle_count, text: (o) => whole(pickOf(o).triangle_count), draw: (_, cell) => cell.classList.add('use') },
      { head: 'of the scan\'s', value: (o) => o.triangle_count, text: (o) => whole(o.triangle_count) }, ...names.map(used),
      ...names.length ? [] : [{ head: 'error of the area', value: (o) => pickOf(o).eps_s, text: (o) => percent(pickOf(o).eps_s) }],
      { head: 'paper', value: (o) => o.paper.triangle_count, text: (o) => whole(o.paper.triangle_count) }, { head: 'robust', value: (o) => o.robust.triangle_count, text: (o) => whole(o.robust.triangle_count) },
    ], objects, 'choice.csv', 'Objects and the triangles chosen for each');
    made.classList.add('shapes', 'stack');
    made.parentNode.classList.add('objects');
    this.buttons = this.pictures.map(([, button]) => button);
    setTimeout(() => this.drawPictures(), 50);
    this.page.grid('Why these counts', [...['mean_distance', 'hausdorff'].filter((name) => names.includes(name)).map((name) => this.allErrors(name, bounds)), this.shares(names)]);
  }

  // Each shape at its level, small, in its row.
  drawPictures() {
    if (!this.levelView) return;
    for (const [object, button] of this.pictures) {
      const levels = this.levelsOf(this.objects.indexOf(object));
      if (levels) button.prepend(element('img', null, null, { src: this.levelView.thumbnail(levels.level(levels.stepsTo(pickOf(object).triangle_count)), levels), alt: '' }));
    }
    this.select(this.state.object);
  }

  // An error of all shapes against triangles, marked where they are chosen.
  allErrors(name, bounds) {
    const { objects, page } = this, curves = objects.map((o) => o.levels.filter((l) => l.errors[name] > 0 && l.triangle_count > 0).sort((a, b) => a.triangle_count - b.triangle_count));
    const flat = curves.flat().map((l) => l.errors[name]), counts = curves.flat().map((l) => l.triangle_count);
    if (flat.length < 2) return null;
    const limit = 100 * bounds[name], plot = new Plot(page.pointer, { x: [Math.min(...counts), Math.max(...counts)], y: [Math.max(100 * Math.min(...flat), limit / 100), Math.min(100 * Math.max(...flat), 100 * limit)], xlog: true, ylog: true, xl: 'triangles', yl: `${wordsOf(name)}, % of the size` });
    plot.hline(limit, 'cb', '5 3').text(plot.x[1], limit, `kept: ${percent(bounds[name])}`, 'b tb', 'end', -2, -6);
    curves.forEach((levels, i) => plot.line(levels.map((l) => l.triangle_count), levels.map((l) => 100 * l.errors[name]), `c${(i % 4) + 1} thin`));
    objects.forEach((o, i) => o.recommended?.errors[name] > 0 && plot.dot(o.recommended.triangle_count, Math.max(plot.y[0], 100 * o.recommended.errors[name]), `c${(i % 4) + 1}`, { key: o.name, r: 4.5, told: `${o.name}: ${whole(o.recommended.triangle_count)} triangles, ${wordsOf(name)} ${percent(o.recommended.errors[name])}` }));
    return (host) => plot.put(host, `${capital(wordsOf(name))} against triangles`, 'Each line a shape, its mark the count chosen.');
  }

  shares(names) {
    const { objects, page } = this;
    if (!names.length) return null;
    const plot = new Plot(page.pointer, { h: 54 + 34 * names.length, l: 14, x: [0, 105], y: [0, 1], noy: true, xl: 'share of its tolerance that is used, %', label: 'How much of each tolerance the choices use' }).vline(100, 'cb', '5 3');
    names.forEach((name, i) => {
      const y = 20 + 34 * i;
      plot.at(18, y - 1, wordsOf(name), 's');
      objects.forEach((o, k) => o.recommended?.errors[name] !== undefined && plot.mark(plot.X(Math.min(104, (100 * o.recommended.errors[name]) / boundsOf(o)[name])), y + 12, `c${(k % 4) + 1}`, { key: o.name, r: 4, told: `${o.name}: ${wordsOf(name)} ${percent(o.recommended.errors[name])} of ${percent(boundsOf(o)[name])}` }));
    });
    return (host) => plot.put(host, 'How much of each tolerance is used', 'Each mark a shape. At 100 % a tolerance is used up: it sets the count.');
  }

  // ---- the object picked ----

  build() {
    const { host } = this;
    this.first = element('div', null, host, { class: 'first' });
    this.title = element('h2', null, this.first, { class: 'object-name' });
    this.told = element('p', null, this.first, { class: 'object-told' });
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
    this.errors = folded(host, 'Errors of each level');
    this.curves = element('div', null, this.errors, { class: 'grid curves' });
    this.tables = element('div', null, host);
    const more = element('details', null, host);
    element('summary', 'By which rule', more);
    this.how = element('p', null, more, { class: 'soft' });
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
    element('span', 'Turn with mouse, finger or arrow keys; + and − move nearer and away.', controls, { class: 'soft hint' });
  }

  select(index) {
    this.state.object = index;
    const object = this.objects[index], levels = this.levelsOf(index), many = this.objects.length > 1, several = Boolean(levels && levels.trace.length > 1);
    this.buttons?.forEach((button, i) => button.setAttribute('aria-pressed', String(i === index)));
    this.title.textContent = object.name;
    this.told.textContent = many ? [...object.answer, ...object.warnings].join(' ') : '';
    this.title.hidden = this.told.hidden = !many;
    this.page.pointer.plots = this.page.pointer.plots.filter(({ group }) => group !== 'level');
    this.curves.replaceChildren();
    this.shown.hidden = !levels;
    this.missing.hidden = Boolean(levels);
    this.single.hidden = several;
    this.along.hidden = this.errors.hidden = !several;
    this.tables.replaceChildren();
    if (levels) {
      this.slider.max = levels.trace.length - 1;
      if (several) this.drawCurve(object, levels);
      if (several && object.recommended) this.drawErrors(object, levels);
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

  // Curves against triangles on logarithmic axes; a click goes to that level.
  tellAlong(levels, counts, lines, title, yl, chosen, note) {
    const flat = lines.flatMap(({ values }) => values).filter((v) => v > 0), most = Math.max(...flat);
    const plot = new Plot(this.page.pointer, { l: 66, r: 16 + 7 * Math.max(...lines.map(({ name }) => name.length)), x: [counts[0], counts.at(-1)], xlog: true, y: [Math.max(Math.min(...flat), 1e-5 * most), most], ylog: true, xl: 'triangles', yl });
    plot.vline(chosen, 'c4', '6 5').text(chosen, plot.y[1], 'chosen', 'b t4', 'start', 5, 10);
    lines.forEach(({ name, values, cls }) => plot.line(counts, values.map((v) => (v > 0 ? Math.max(v, plot.y[0]) : undefined)), cls).end(Math.max(plot.y[0], values.findLast((v) => v > 0) ?? NaN), name, `t${cls.charAt(1)}`));
    plot.follow('level', counts, lines, { unit: ' triangles', digits: 3, text: whole, pick: (i) => this.moveTo(this.rowOf(levels, counts[i])) }).put(this.curves, title, note);
  }

  drawCurve(object, levels) {
    const { weight } = object.options, { trace } = levels, counts = trace.map(({ count }) => count), ip = (error) => trace.map((row) => row[error] + (weight * row.count) / object.triangle_count);
    this.tellAlong(levels, counts, [{ name: 'eps_s', values: trace.map((row) => row.error), cls: 'c1 thin' }, { name: 'Ip', values: ip('error'), cls: 'c2' }, { name: 'Ip, worst eps_s', values: ip('worst'), cls: 'c3' }],
      'Error of the area, and the paper\'s criterion', 'eps_s, Ip', pickOf(object).triangle_count, 'Ip = eps_s + Nr/Nm; its least is the paper\'s choice. Click: the level above.');
  }

  // Each error over its tolerance against the count: what lies above 1 is not kept.
  drawErrors(object, levels) {
    const bounds = boundsOf(object), chosen = { triangle_count: object.recommended.triangle_count, errors: object.recommended.errors };
    const rows = new Map([...object.levels, chosen].filter((level) => Object.keys(level.errors).length > 2).map((level) => [level.triangle_count, level]));
    const all = [...rows.values()].sort((a, b) => a.triangle_count - b.triangle_count), names = Object.keys(bounds).filter((name) => all.every((level) => level.errors[name] > 0)).slice(0, 4);
    if (all.length < 2 || !names.length) return;
    this.tellAlong(levels, all.map((level) => level.triangle_count), [...names.map((name, i) => ({ name: wordsOf(name), values: all.map((level) => level.errors[name] / bounds[name]), cls: `c${i + 1}` })), { name: 'tolerance', values: all.map(() => 1), cls: 'c0 thin' }],
      'Errors beside their tolerances', 'error over its tolerance', object.recommended.triangle_count, `Below 1 a tolerance is kept: ${names.map((name) => `${wordsOf(name)} ${percent(bounds[name])}`).join(', ')}.`);
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
    this.page.pointer.show('level', levels.trace[row].count);
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
    const host = folded(this.tables, 'Candidate levels', false);
    const names = { recommended: 'recommended: keeps the tolerances', paper: 'paper: least Ip on the grid', robust: 'robust: least Ip, worst eps_s so far' };
    const keys = ['paper', 'robust', 'recommended'].filter((key) => object[key]);
    const rows = [
      { name: 'scan', pick: { triangle_count: object.triangle_count, area: object.area, volume: object.volume, eps_s: 0 }, measures: levels?.measures[0] },
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
      { head: 'Ip', value: (row) => row.pick.ip ?? null, text: (row) => (row.pick.ip === undefined ? '' : number(row.pick.ip, 3)) },
      { head: 'fewest, Ip within a tenth', value: (row) => row.pick.similar_fewest ?? null, text: (row) => (row.pick.similar_fewest ? whole(row.pick.similar_fewest) : '') },
      { head: 'most', value: (row) => row.pick.similar_most ?? null, text: (row) => (row.pick.similar_most ? whole(row.pick.similar_most) : '') },
      value('eps_s', (row) => row.pick.eps_s, 3),
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
