// The section of one scene (result.json with scene.yaml, docs/reference/formats.md): its bodies and walls to play, what its
// sensors read beside them.
import { Chart, palette } from './chart.js';
import { PlayedSection, known } from './played.js';
import { counted, element, folded, number, table, whole } from './text.js';

const sparkWidth = 96, sparkHeight = 20;

// A small curve without axes; answers its mark, which is moved along x.
function spark(host, times, values) {
  const made = (tag, parent, attributes) => {
    const part = document.createElementNS('http://www.w3.org/2000/svg', tag);
    Object.entries(attributes).forEach(([key, value]) => part.setAttribute(key, value));
    parent.append(part);
    return part;
  };
  const there = values.filter(known), low = Math.min(...there), high = Math.max(...there), end = times.at(-1) || 1;
  const points = values.map((v, i) => (known(v) ? `${(sparkWidth * times[i]) / end},${sparkHeight - 1 - ((sparkHeight - 2) * (v - low)) / (high - low || 1)}` : '')).filter(Boolean);
  host.replaceChildren();
  const svg = made('svg', host, { width: sparkWidth, height: sparkHeight, role: 'img', 'aria-label': `from ${number(there[0], 3)} to ${number(there.at(-1), 3)}` });
  made('polyline', svg, { points: points.join(' '), fill: 'none', stroke: 'currentColor' });
  return made('rect', svg, { y: 0, width: 1, height: sparkHeight, fill: 'var(--accent)' });
}

// The angle of repose in all ways, or why there is none.
function angleText(pile) {
  if (!pile.heap) return `${pile.name}: there is no heap: ${pile.no_heap_because}.`;
  const ways = [['the sectors', pile.sectors.angle_deg, pile.sectors.sd_deg], ['the cone', pile.cone.angle_deg],
    ['the silhouettes', pile.silhouettes.angle_deg, pile.silhouettes.sd_deg], ['volume and centroid', pile.volume_deg, pile.volume_se_deg, ' (standard error)']];
  const angles = ways.filter(([, angle]) => known(angle)).map(([name, angle, spread, kind = '']) => `${number(angle, 3)}°${known(spread) ? ` ± ${number(spread, 2)}°${kind}` : ''} by ${name}`);
  return `Angle of repose: ${angles.join(', ')}${known(pile.spread_deg) ? `; the first three differ by ${number(pile.spread_deg, 2)}°` : ''}.`;
}

export class SceneSection extends PlayedSection {
  constructor(host, folder) {
    const { scene } = folder;
    super(host, folder, Object.fromEntries(scene.columns.map(({ name, values }) => [name, values])));
    this.scene = scene;
    this.tell();
    this.addPlayer('The scene in 3D', folder.scene_picture);
    this.tellSensors();
    this.drawCurves();
    this.tellTables();
    this.play(new Map(folder.piles).get('scene'));
  }

  tell() {
    const { host, scene } = this;
    const { book } = scene;
    element('h1', scene.title ?? this.name, host);
    element('p', `${scene.whole ? 'Ended' : 'Stopped'} after ${number(scene.time, 4)} s: ${scene.ended_because}. ${counted(book.entered_count, 'particle')} came in, ${whole(book.inside_count)} inside, ${whole(book.left_count)} went out.`, host, { class: 'answer' });
    const waiting = book.waiting_count ? ` ${whole(book.waiting_count)} wait for room at inlets.` : '';
    for (const pile of scene.piles) element('p', angleText(pile), host, { class: 'answer' });
    element('p', `${number(book.entered_mass, 5)} kg came in, ${number(book.inside_mass, 5)} kg inside, ${number(book.left_mass, 5)} kg went out.${waiting} Energy unaccounted for: ${number(100 * book.ledger, 2)} % of what was turned over.`, host, { class: 'soft' });
  }

  // Each sensor's columns, by its name.
  sensors() {
    const groups = new Map();
    for (const { name, unit } of this.scene.columns) {
      const [sensor, what, ...shape] = name.split('.');
      if (!what) continue;
      if (!groups.has(sensor)) groups.set(sensor, new Map());
      const kinds = groups.get(sensor);
      const kind = what.replace(/_[xyz]$/, '');
      if (!kinds.has(kind)) kinds.set(kind, { unit, columns: [] });
      kinds.get(kind).columns.push([shape.length ? shape.join('.') : what, name]);
    }
    return groups;
  }

  toldAt(time) {
    const { series } = this;
    const i = this.pointAt(time);
    if (i < 0) return '';
    this.now?.forEach(({ name, cell, mark }) => {
      cell.textContent = known(series[name][i]) ? number(series[name][i], 4) : '–';
      mark.setAttribute('x', sparkWidth * (series.time[i] / (series.time.at(-1) || 1)));
    });
    const phase = this.scene.phases[series.phase?.[i]];
    return `${phase ? `Phase ${phase}: ` : ''}${whole(series.inside[i])} inside, ${whole(series.left[i])} out, highest speed ${number(series.highest_speed[i], 3)} m/s`;
  }

  // What the sensors read at the moment shown, over their windows, and its course.
  tellSensors() {
    const read = this.scene.columns.filter(({ name, values }) => name.includes('.') && values.some((v) => v));
    const rest = this.scene.columns.filter((column) => column.name.includes('.') && !read.includes(column));
    this.now = [];
    if (read.length) {
      element('h2', 'What the sensors read', this.host);
      const summary = (head, key) => ({ head, value: (c) => c[key], text: (c) => number(c[key], 4) });
      const window = ({ from, until }) => (known(until) ? `${number(from)} to ${number(until)} s` : from > 0 ? `from ${number(from)} s on` : 'all of it');
      const cells = new Map();
      table(this.host, [
        { head: 'sensor', value: ({ name }) => name, text: ({ name }) => { const [sensor, ...what] = name.split('.'); return `${sensor}: ${what.join(', ').replaceAll('_', ' ')}`; } },
        { head: 'unit', value: ({ unit }) => unit || '1' },
        { head: 'then', value: (c) => c.last, text: (c) => number(c.last, 4), draw: ({ name }, cell) => cells.set(name, cell) },
        { head: 'course', value: () => ' ', draw: (c, cell) => this.now.push({ name: c.name, cell: cells.get(c.name), mark: spark(cell, this.series.time, c.values) }) },
        summary('mean', 'mean'), summary('sd', 'sd'), summary('least', 'least'), summary('greatest', 'greatest'), { head: 'over', value: window },
      ], read, `${this.name}-sensors.csv`, 'What the sensors read');
    }
    for (const [what, empty] of [['Zero throughout', ({ values }) => values.some(known)], ['Nothing to measure yet', ({ values }) => !values.some(known)]]) {
      const names = rest.filter(empty).map(({ name }) => name);
      if (names.length) element('p', `${what}: ${names.join(', ')}.`, this.host, { class: 'soft' });
    }
  }

  drawCurves() {
    const all = this.host;
    this.host = folded(all, 'Curves');
    for (const [sensor, kinds] of this.sensors())
      for (const [kind, { unit, columns }] of kinds)
        if (columns.some(([, name]) => this.series[name].some((value) => known(value) && value !== 0))) this.chart(`${sensor}: ${kind.replaceAll('_', ' ')}`, `${kind.replaceAll('_', ' ')}${unit ? ` / ${unit}` : ''}`, columns.slice(0, 4));
    this.chart('Bodies', 'bodies', [['came in', 'entered'], ['inside', 'inside'], ['went out', 'left'], ['waiting', 'waiting']]);
    this.fallingChart('Energy of motion', 'energy / J', [['translation', 'kinetic'], ['rotation', 'rotational']]);
    this.chart('Rotational velocity', 'mean |ω| / (rad/s)', [['mean |ω|', 'mean_rotation']], { from: 2 });
    this.drawResidence();
    this.host = all;
  }

  // How many bodies stayed how long, by class.
  drawResidence() {
    for (const { name, from, until, classes } of this.scene.residence) {
      if (!(until > from)) continue;
      const { length } = classes[0].counts;
      element('h2', `${name}: how long bodies stayed`, this.host);
      new Chart(element('div', null, this.host, { class: 'chart' }), {
        x: { label: 'time inside / s', values: classes[0].counts.map((_, i) => from + ((i + 0.5) * (until - from)) / length), text: (v) => number(v, 3) },
        yLabel: 'bodies', logX: false, logY: false,
        series: classes.map((one, i) => ({ label: one.name, values: one.counts, color: palette[i % palette.length], width: 2, points: true, text: whole })),
      });
    }
  }

  tellTables() {
    const { scene } = this;
    for (const p of scene.piles) {
      this.values(`The heap ${p.name}`, [
        ['angle by sectors / °', p.sectors.angle_deg], ['its standard deviation / °', p.sectors.sd_deg], ['sectors with a flank', p.sectors.count],
        ['angle by the cone / °', p.cone.angle_deg], ['its misfit, rms / mm', known(p.cone.rms) ? 1000 * p.cone.rms : null],
        ['angle by silhouettes / °', p.silhouettes.angle_deg], ['its standard deviation / °', p.silhouettes.sd_deg],
        ['the three ways differ by / °', p.spread_deg], ['angle by volume and centroid / °', p.volume_deg],
        ['height / mm', 1000 * p.height], ['base radius / mm', known(p.base_radius) ? 1000 * p.base_radius : null], ['run-out / mm', 1000 * p.run_out],
        ['packing fraction', p.packing_fraction], ['bodies', p.body_count], ['particle size / mm', 1000 * p.particle_size],
      ], 'heap');
    }
    this.values('Where bodies came in and went out', [
      ...scene.inlets.map(({ name, count, mass, waiting }) => [`inlet ${name}`, `${whole(count)}, ${number(mass, 5)} kg${waiting ? `, ${whole(waiting)} wait` : ''}`]),
      ...scene.outlets.map(({ name, count, mass }) => [name ? `outlet ${name}` : 'over the rim of the domain', `${whole(count)}, ${number(mass, 5)} kg`]),
    ], 'book');
    this.shapeTable(scene.shapes);
    this.saveSeries();
  }
}
