// The section of one scene (result.json with scene.yaml, docs/reference/formats.md): its bodies and walls to play, what its
// sensors read beside them, and of a heap its angle.
import { holds } from './packed.js';
import { Skeleton, capital, said, unitText, words } from './page.js';
import { Pile, PilePlayer, Quaternion, Vector3 } from './pile.js';
import { Plot, span, svg } from './plot.js';
import { element, folded, known, number, saveButton, table, whole } from './text.js';

const sparkWidth = 96, sparkHeight = 20;

// A small curve without axes; answers its mark, which is moved along x.
function spark(host, times, values) {
  const there = values.filter(known), low = Math.min(...there), high = Math.max(...there), end = times.at(-1) || 1;
  const points = values.map((v, i) => (known(v) ? `${(sparkWidth * times[i]) / end},${sparkHeight - 1 - ((sparkHeight - 2) * (v - low)) / (high - low || 1)}` : '')).filter(Boolean);
  host.replaceChildren();
  const made = svg('svg', host, { width: sparkWidth, height: sparkHeight, role: 'img', 'aria-label': `from ${number(there[0], 3)} to ${number(there.at(-1), 3)}` });
  svg('polyline', made, { points: points.join(' '), fill: 'none', stroke: 'currentColor' });
  return svg('rect', made, { y: 0, width: 1, height: sparkHeight, fill: 'var(--accent)' });
}

export class SceneSection {
  constructor(host, folder) {
    const { scene } = folder, [pile] = scene.piles, isHeap = pile && scene.verdict === 'answered';
    Object.assign(this, { scene, host, pile: isHeap ? pile : null, now: [], series: Object.fromEntries(scene.columns.map(({ name, values }) => [name, values])) });
    this.name = folder.folder.split('/').filter(Boolean).pop();
    this.page = new Skeleton(host, { title: scene.title && scene.title !== 'angle of repose' ? scene.title : scene.shapes.map(({ family, name }) => family ?? name).slice(0, 3).join(', '), kind: pile ? 'angle of repose' : 'scene', date: folder.provenance?.started, told: scene });
    this.addPlayer(folder);
    if (isHeap) this.tellHeap();
    else this.tellNumbers();
    this.page.tellNext();
    const places = holds(this.piles.get('scene')) ? new Pile(this.piles.get('scene')) : null;
    if (isHeap) this.page.grid('Where the angle comes from', [this.methods(), places && this.fromTheSide(places)]);
    this.page.grid(isHeap ? 'How it came about' : 'What the sensors read', [...this.sensorCharts(), ...this.tables(), this.motion(),
      this.over('Rotation', 'mean rotation, rad/s', [{ name: 'rotation', key: 'mean_rotation', unit: ' rad/s' }]), this.over('Particles', 'particles', [['inside', 'inside'], ['went out', 'left'], ['waiting', 'waiting']].map(([name, key]) => ({ name, key })))], 9);
    this.tellSensors();
    if (places && this.player.view) this.player.show(places, scene.shapes);
    else if (this.player.view) this.player.lack();
  }

  addPlayer(folder) {
    this.piles = new Map(folder.piles);
    this.player = new PilePlayer(element('div', null, this.page.picture), {
      picture: document.getElementById(folder.scene_picture), label: 'The scene in 3D', plays: !this.pile, told: (time) => this.toldAt(time),
      onTime: (time) => {
        const now = performance.now(); // charts follow at most some twenty times a second
        if (now - (this.marked ?? 0) < 50 && time < this.player.pile.end) return;
        this.marked = now;
        if (!this.page.host.matches(':has(.plot:hover)')) this.page.pointer.show('time', time);
      },
    });
  }

  // ---- a heap ----

  tellHeap() {
    const { page, pile: p } = this, mm = (v) => number(1000 * v, 3), half = 1.645 * p.volume_se_deg;
    page.plain('Angle of repose', p.volume_deg.toFixed(1), '°', `± ${half.toFixed(1)}°, 90 %`, 'by volume and centroid, one heap', 'main full');
    page.plain('Height', mm(p.height), 'mm', '', `${number(p.height / p.particle_size, 2)} particles; highest point ${mm(p.peak)} mm`);
    page.plain('Foot radius', known(p.base_radius) ? mm(p.base_radius) : '–', 'mm', '', `farthest ${mm(p.run_out)} mm`);
    page.plain('Packing', number(p.packing_fraction, 2), '', '', 'share of solid');
    for (const [name, angle, known, note] of this.ways().slice(1)) page.plain(`By ${name}`, angle.toFixed(1), '°', known ? `± ${known.toFixed(1)}°` : '', note);
  }

  // How the angle is read: [by what, angle, half of its interval, note]
  ways() {
    const { sectors: s, cone, silhouettes: o, volume_deg: volume, volume_se_deg: error } = this.pile, half = (deviation, count) => (known(deviation) && count > 1 ? (1.645 * deviation) / Math.sqrt(count) : null);
    return [['volume and centroid', volume, 1.645 * error, ''], ['silhouettes', o.angle_deg, half(o.sd_deg, o.count), 'as a camera sees it'], ['sectors', s.angle_deg, half(s.sd_deg, s.count), `${s.count} of ${s.total} directions`],
      ['a cone', cone.angle_deg, null, known(cone.rms) ? `misses by ${number(1000 * cone.rms, 2)} mm` : '']].filter(([, angle]) => known(angle));
  }

  methods() {
    const ways = this.ways(), [low, high] = span(ways.flatMap(([, v, e]) => [v - (e ?? 0), v + (e ?? 0)]), 0.15);
    const plot = new Plot(this.page.pointer, { h: 48 + 40 * ways.length, l: 14, t: 4, x: [low, high], y: [0, 1], noy: true, xl: 'angle of repose, °', label: ways.map(([name, v]) => `${name} ${v.toFixed(1)}°`).join('; ') });
    ways.forEach(([name, v, e], i) => {
      const y = 14 + 40 * i, cls = i ? 'c0' : 'c1';
      plot.at(18, y + 3, name, i ? 's' : 'b').at(404, y + 3, `${v.toFixed(1)}°${e ? ` ± ${e.toFixed(1)}°` : ''}`, i ? '' : 'b', 'end');
      if (e) plot.hbar(y + 15, v - e, v + e, cls);
      plot.mark(plot.X(v), y + 15, cls, { r: 4.5 });
    });
    return (host) => plot.put(host, said(this.pile.finding), 'Flanks are read at 20 to 80 % of the height. Compare like with like: a photograph with the silhouettes. Bars: 90 %.');
  }

  // All particles at the end, across and up, with the cone of the same volume and angle.
  fromTheSide(places) {
    const { pile: p, page } = this, at = places.momentAt(places.end), where = new Vector3(), turn = new Quaternion(), points = [];
    for (let body = 0; body < places.bodyCount; body++) if (places.pose(body, at, where, turn)) points.push([1000 * where.x, 1000 * where.z]);
    if (!points.length || points.length > 3000) return null;
    const slope = Math.tan((p.volume_deg * Math.PI) / 180), radius = 1000 * Math.cbrt((3 * p.envelope_volume) / (Math.PI * slope)), middle = points.reduce((sum, [x]) => sum + x, 0) / points.length;
    const [left, right] = span([...points.map(([x]) => x), middle - radius, middle + radius], 0.05), top = 1.15 * Math.max(...points.map(([, z]) => z), radius * slope), h = Math.max(140, Math.min(300, 60 + (352 * top) / (right - left)));
    const plot = new Plot(page.pointer, { h, x: [left, right], y: [0, Math.max(top, ((h - 54) * (right - left)) / 352)], xl: 'across, mm', yl: 'height, mm', label: `Particles from the side, with the cone of ${p.volume_deg.toFixed(1)}° of the same volume` });
    for (const [x, z] of points) plot.dot(x, z, 'c1 faint', { r: Math.max(2, (500 * p.particle_size * 352) / (right - left)) });
    plot.line([middle - radius, middle, middle + radius], [0, radius * slope, 0], 'c2').text(middle + radius / 2, (radius * slope) / 2, `${p.volume_deg.toFixed(1)}°`, 'b t2', 'start', 10, -14);
    return (host) => plot.put(host, 'From the side, with the cone of the same volume', 'Each dot a particle. The tip is blunt and the foot thin: flank methods see neither.');
  }

  // ---- any scene ----

  tellNumbers() {
    const { page, scene: { book: b, columns, piles } } = this;
    if (piles.length) page.plain('Bodies', whole(b.inside_count), '', '', `of ${whole(b.entered_count)} that came in`);
    const read = columns.filter((c) => c.name.includes('.') && known(c.mean) && c.greatest !== c.least && !piles.some((p) => c.name.startsWith(`${p.name}.`)));
    const telling = ['mass_rate', 'mass', 'count', 'power', 'force_z', 'torque', 'speed'].reverse(), rank = (c) => telling.indexOf(c.name.split('.')[1]);
    const firsts = [...new Map([...read].sort((a, b) => rank(a) - rank(b)).map((c) => [c.name.split('.')[0], c])).values()]; // of each sensor what tells most
    if (!piles.length) {
      page.plain('Came in', whole(b.entered_count), '', `${number(b.entered_mass, 4)} kg`, '', 'main half');
      page.plain('Inside at the end', whole(b.inside_count), '', `${number(b.inside_mass, 4)} kg`, '', 'main half');
      page.plain('Went out', whole(b.left_count), '', `${number(b.left_mass, 4)} kg`);
    }
    for (const c of firsts.slice(0, 5)) page.plain(c.name.replace('.', ': ').replaceAll('_', ' '), number(c.mean, 4), unitText(c.unit), known(c.sd) ? `± ${number(c.sd, 2)}, standard deviation` : '', `mean${c.from > 0 ? ` from ${number(c.from, 3)} s` : ''}; at the end ${number(c.last, 3)}`);
    page.plain('Energy unaccounted for', number(100 * Math.abs(b.ledger), 2), '%', '', 'of all that was turned over');
  }

  toldAt(time) {
    const { series, scene } = this, found = series.time.findIndex((t) => t > time + 1e-9), i = found < 0 ? series.time.length - 1 : Math.max(0, found - 1);
    if (i < 0) return '';
    this.now.forEach(({ name, cell, mark }) => {
      cell.textContent = known(series[name][i]) ? number(series[name][i], 4) : '–';
      mark.setAttribute('x', sparkWidth * (series.time[i] / (series.time.at(-1) || 1)));
    });
    const phase = scene.phases[series.phase?.[i]];
    return `${phase ? `phase ${phase}, ` : ''}${whole(series.inside[i])} inside, ${whole(series.left[i])} out, highest speed ${number(series.highest_speed[i], 3)} m/s`;
  }

  // When what is measured of a heap begins to mean something: once its cylinder rises.
  get heapFrom() {
    const lift = this.scene.phases.indexOf('lift'), at = lift < 0 ? -1 : this.series.phase?.findIndex((phase) => phase >= lift);
    return at > 0 ? this.series.time[at] : 0;
  }

  // Over time: lines of {name, key or values}, phases shaded; null where nothing changes.
  over(title, yl, lines, { log = false, note = '', from = 0 } = {}) {
    const { series, scene, page, player } = this, { time } = series;
    const all = lines.map((line) => ({ ...line, values: (line.values ?? series[line.key]).map((v, i) => (known(v) && time[i] >= from && (!log || v > 0) ? v : null)) })).filter(({ values }) => values.some(known));
    const flat = all.flatMap(({ values }) => values).filter(known), most = Math.max(...flat);
    if (time.length < 2 || new Set(flat).size < 2) return null;
    const y = log ? [Math.max(Math.min(...flat), 1e-8 * most), 2 * most] : span(flat), named = all.length > 1;
    const plot = new Plot(page.pointer, { r: named ? 92 : 14, t: scene.phases.length ? 20 : 12, x: [0, time.at(-1)], y, ylog: log, xl: 'time, s', yl, label: `${title}, over time` });
    scene.phases.forEach((phase, k) => {
      const begin = series.phase.indexOf(k), end = series.phase.lastIndexOf(k);
      if (begin < 0) return;
      const [a, b] = [plot.X(time[Math.max(0, begin - 1)]), plot.X(time[end])];
      if (k % 2) plot.box(a, b, plot.t, plot.h - plot.b, 'c0');
      if (b - a > 30) plot.at((a + b) / 2, 14, phase, 's', 'middle');
    });
    all.forEach(({ name, values }, i) => {
      plot.line(time, values.map((v) => (v !== null && v < y[0] ? undefined : v)), `c${(i % 4) + 1}`);
      if (named) plot.end(values.findLast(known), name.slice(0, 14), `t${(i % 4) + 1}`);
    });
    plot.follow('time', time, all.map(({ name, values, unit }) => ({ name: named ? name : '', values, unit: unit ?? '' })), { unit: ' s', pick: (i) => {
      player.stop();
      if (player.pile) player.goTo(Math.min(time[i], player.pile.end));
    } });
    return (host) => plot.put(host, title, note);
  }

  // Columns of each sensor by what they are and their unit, four lines a chart.
  sensorCharts() {
    const groups = new Map(), piles = this.scene.piles.map(({ name }) => name);
    for (const { name, unit } of this.scene.columns) {
      const [sensor, what, ...shape] = name.split('.');
      if (!what) continue;
      const kind = unit === 'deg' && piles.includes(sensor) ? 'angle' : what.replace(/_[xyz]$/, ''), key = `${sensor}: ${kind}`;
      if (unit === 'deg' && piles.includes(sensor) && !(this.pile && /volume_deg|silhouette_deg|sector_deg/.test(what))) continue; // spreads, and what is no angle
      if (!groups.has(key)) groups.set(key, { unit, kind, lines: [], from: piles.includes(sensor) ? this.heapFrom : 0 });
      groups.get(key).lines.push({ name: words(shape.length ? shape.join('.') : what).replace(/ deg$/, ''), key: name, unit: unitText(unit) });
    }
    return [...groups].map(([title, { unit, kind, lines, from }]) => this.over(capital(words(title.replace('.', ' '))), `${words(kind)}${unit ? `, ${unit === 'deg' ? '°' : said(unit)}` : ''}`, lines.slice(0, 4), { from, note: from && kind === 'angle' ? 'Angles are read once the cylinder rises.' : '' }));
  }

  motion() {
    return this.over('Energy of motion', 'energy, J', [{ name: 'translation', key: 'kinetic', unit: ' J' }, { name: 'rotation', key: 'rotational', unit: ' J' }], { log: true, note: 'It falls to nothing where all is at rest.' });
  }

  // Tables of bins: what stands behind their ends, by class, and by window where there are several.
  tables() {
    return (this.scene.tables ?? []).map(({ name, columns }) => {
      const ends = columns.filter((column) => /(^|_)until$/.test(column.name)), last = ends.at(-1), at = columns.indexOf(last), y = columns[at + 1];
      if (at < 1 || !y?.values.length) return null;
      const from = columns[at - 1].values, classes = columns.filter((column) => typeof column.values[0] === 'string');
      const windows = ends.length > 1 && new Set(ends[0].values).size > 1 ? [ends[0]] : [], lines = new Map(), x = [...new Set(from)].sort((a, b) => a - b);
      y.values.forEach((value, i) => {
        const line = [...classes, ...windows].map((column) => column.values[i]).filter((word) => word !== '').join(' ') || 'all';
        if (!lines.has(line)) lines.set(line, new Map());
        lines.get(line).set(from[i], value);
      });
      const log = x.at(-1) > 1000 * x[1], xs = log ? x.slice(1) : x, series = [...lines].slice(0, 4).map(([label, line]) => ({ name: label, values: xs.map((v) => line.get(v) ?? 0) }));
      if (xs.length < 2) return null;
      const what = words(last.name.replace(/_?until$/, '') || 'from'), plot = new Plot(this.page.pointer, { r: series.length > 1 ? 92 : 14, x: [xs[0], xs.at(-1)], xlog: log, y: span(series.flatMap((s) => s.values)), xl: `${what}, ${last.unit}`, yl: words(y.name) });
      series.forEach((s, i) => plot.line(xs, s.values, `c${i + 1}`).end(s.values.at(-1), series.length > 1 ? s.name.slice(0, 14) : '', `t${i + 1}`));
      return (host) => plot.follow(name, xs, series, { name: what }).put(host, name);
    });
  }

  // Every number at the moment shown, over its window, and its course; what never changes is named only.
  tellSensors() {
    const { scene, series, name, now } = this, host = folded(this.page.host, 'All numbers', false), piles = scene.piles.map((p) => `${p.name}.`);
    const read = scene.columns.filter((c) => c.name.includes('.') && c.values.some((v) => v) && (this.pile || !(c.unit === 'deg' && piles.some((p) => c.name.startsWith(p)))));
    const rest = scene.columns.filter((c) => c.name.includes('.') && !read.includes(c) && !c.values.some((v) => v));
    if (read.length) {
      const summary = (head, key) => ({ head, value: (c) => (piles.some((p) => c.name.startsWith(p)) ? null : c[key]), text: (c) => (piles.some((p) => c.name.startsWith(p)) ? '' : number(c[key], 4)) }); // a heap is told at its end
      const window = ({ from, until }) => (known(until) ? `${number(from)} to ${number(until)} s` : from > 0 ? `from ${number(from)} s on` : 'all of it'), cells = new Map();
      table(host, [
        { head: 'sensor', value: (c) => c.name, text: (c) => { const [sensor, ...what] = c.name.split('.'); return `${sensor}: ${what.join(', ').replaceAll('_', ' ')}`; } }, { head: 'unit', value: ({ unit }) => unit || '1' },
        { head: 'then', value: (c) => c.last, text: (c) => number(c.last, 4), draw: (c, cell) => cells.set(c.name, cell) },
        { head: 'course', value: () => ' ', draw: (c, cell) => now.push({ name: c.name, cell: cells.get(c.name), mark: spark(cell, series.time, c.values) }) },
        summary('mean', 'mean'), summary('sd', 'sd'), summary('least', 'least'), summary('greatest', 'greatest'), { head: 'over', value: window },
      ], read, `${name}-sensors.csv`, 'What the sensors read');
    }
    for (const [what, empty] of [['Zero throughout', ({ values }) => values.some(known)], ['Nothing to measure yet', ({ values }) => !values.some(known)]]) {
      const names = rest.filter(empty).map((c) => c.name);
      if (names.length) element('p', `${what}: ${names.join(', ')}.`, host, { class: 'soft' });
    }
    table(host, [{ head: 'what', value: (row) => row[0] }, { head: 'value', value: (row) => row[1] }], [
      ...scene.inlets.map(({ name: at, count, mass, waiting }) => [`inlet ${at}`, `${whole(count)}, ${number(mass, 5)} kg${waiting ? `, ${whole(waiting)} wait` : ''}`]),
      ...scene.outlets.map(({ name: at, count, mass }) => [at ? `outlet ${at}` : 'over the rim of the domain', `${whole(count)}, ${number(mass, 5)} kg`]),
    ], `${name}-book.csv`, 'Where bodies came in and went out');
    table(host, [
      { head: 'shape', value: (s) => s.name }, { head: 'kind', value: (s) => s.kind }, { head: 'triangles', value: (s) => s.triangle_count, text: (s) => whole(s.triangle_count) },
      { head: 'volume / mm³', value: (s) => s.volume * 1e9, text: (s) => number(s.volume * 1e9, 5) }, { head: 'size / mm', value: (s) => s.size * 1000, text: (s) => number(s.size * 1000, 4) },
    ], scene.shapes, `${name}-shapes.csv`, 'Shapes');
    const keys = Object.keys(series);
    saveButton(host, 'Save the series as CSV', `${name}-series.csv`, () => [keys, ...series.time.map((_, i) => keys.map((key) => series[key][i]))]);
  }
}
