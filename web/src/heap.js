// The section of one heap (result.json, docs/formats.md): its angles, the pile to play, the curves beside it.
import { Chart, palette } from './chart.js';
import { Pile, PilePlayer, shapeColor } from './pile.js';
import { element, number, saveButton, table, whole } from './text.js';

const known = (x) => x !== null && x !== undefined && Number.isFinite(x);
const phases = { packing: 'filling', settling: 'settling', lifting: 'the cylinder rises', holding: 'coming to rest', done: 'the end' };

export class HeapSection {
  constructor(host, folder) {
    const [, id] = folder.piles[0] ?? [];
    Object.assign(this, { host, heap: folder.heap, series: folder.heap.series, charts: [] });
    this.name = folder.folder.split('/').filter(Boolean).pop();
    this.tell();
    this.player = new PilePlayer(element('div', null, host), {
      picture: document.getElementById(folder.picture),
      label: 'The heap in 3D',
      told: (time) => this.toldAt(time),
      onTime: () => this.markTime(),
    });
    this.tellShapes();
    this.drawAngles();
    this.drawMotion();
    this.tellTables();
    if (id && this.player.view) this.player.show(new Pile(id));
  }

  tell() {
    const { host, heap } = this;
    const { result: r, experiment: e, shapes } = heap;
    element('h1', `A heap of ${whole(e.particles)} particles of ${shapes.length === 1 ? `one shape, ${shapes[0].name}` : `${whole(shapes.length)} shapes`}`, host);
    const ways = [['the sectors', r.sectors, r.sectors.sd_deg], ['the cone', r.cone, null], ['the silhouettes', r.silhouettes, r.silhouettes.sd_deg]];
    const angles = ways.filter(([, way]) => known(way.angle_deg)).map(([name, way, sd]) => `${number(way.angle_deg, 3)}°${known(sd) ? ` ± ${number(sd, 2)}°` : ''} by ${name}`);
    element('p', r.heap ? `Angle of repose: ${angles.join(', ')}${known(r.spread_deg) ? `; the three ways differ by ${number(r.spread_deg, 2)}°` : ''}.` : `There is no heap: ${r.no_heap_because}.`, host, { class: 'answer' });
    element('p', `${r.still ? 'Still' : 'Not yet still'} after ${number(r.time, 4)} s; ${whole(r.body_count)} particles on the disc, ${whole(r.left_count)} fell off; ${number(1000 * r.height, 3)} mm high. Preset ${e.preset}, seed ${e.seed}.${e.preset === 'demo' ? ' The preset demo shows a heap; take no number from it.' : ''}`, host, { class: 'soft' });
  }

  tellShapes() {
    const { shapes } = this.heap;
    const list = element('p', null, this.player.box, { class: 'legend' });
    shapes.forEach((shape, k) => {
      const item = element('span', null, list);
      const swatch = element('canvas', null, item, { width: 12, height: 12, 'aria-hidden': 'true' });
      const context = swatch.getContext('2d');
      context.fillStyle = shapeColor(k);
      context.fillRect(0, 0, 12, 12);
      item.append(` ${shape.name}`);
    });
  }

  // What the series says of a moment.
  toldAt(time) {
    const { series } = this;
    let i = series.time.findIndex((t) => t > time + 1e-9);
    i = i < 0 ? series.time.length - 1 : Math.max(0, i - 1);
    if (i < 0) return '';
    const lift = series.cylinder_height[i];
    return `${phases[series.phase[i]] ?? series.phase[i]}${lift > 0 ? `, cylinder ${number(1000 * lift, 3)} mm up` : ''}; kinetic energy ${number(series.kinetic[i], 3)} J, mean rotation ${number(series.mean_rotation[i], 3)} rad/s`;
  }

  // Curves are drawn anew at most some twenty times a second.
  markTime() {
    const now = performance.now();
    clearTimeout(this.marking);
    if (now - (this.marked ?? 0) < 50) {
      this.marking = setTimeout(() => this.markTime(), 60);
      return;
    }
    this.marked = now;
    this.charts.forEach((chart) => chart.redraw());
  }

  chart(title, yLabel, keys, options = {}) {
    const { series, host } = this;
    if (!keys.some(([, key]) => series[key].some(known))) return;
    element('h2', title, host);
    this.charts.push(new Chart(element('div', null, host, { class: 'chart' }), {
      x: { label: 'time / s', values: series.time, text: (v) => number(v, 4) }, yLabel, logX: false, logY: false,
      series: keys.map(([label, key], i) => ({ label, values: series[key], color: palette[i + (options.from ?? 0)], dash: [undefined, [6, 3], [2, 2]][i], width: 2, text: (v) => number(v, 4), points: Boolean(options.points) })),
      marks: () => (this.player.view ? [{ x: this.player.time }] : []),
      pick: (i) => {
        this.player.stop();
        this.player.goTo(Math.min(series.time[i], this.player.pile?.end ?? 0));
      },
      ...options,
    }));
  }

  drawAngles() {
    this.chart('Angle against time', 'angle / °', [['sectors', 'sector_deg'], ['cone', 'cone_deg'], ['silhouettes', 'silhouette_deg']], { points: true });
  }

  drawMotion() {
    this.chart('Kinetic energy against time', 'energy / J', [['kinetic energy', 'kinetic']], {
      logY: true, from: 1, yLeast: 1e-8 * Math.max(...this.series.kinetic.filter(known)), // at rest it falls to nothing
    });
    this.chart('Rotational velocity against time', 'mean |ω| / (rad/s)', [['mean |ω|', 'mean_rotation']], { from: 2 });
  }

  tellTables() {
    const { host, heap, name } = this;
    const { result: r, costs: c } = heap;
    const rows = (title, list, file) => {
      element('h2', title, host);
      table(host, [{ head: 'what', value: (row) => row[0] }, { head: 'value', value: (row) => row[1], text: (row) => (typeof row[1] === 'number' ? number(row[1], 5) : row[1]) }], list, file, title);
    };
    rows('The heap', [
      ['angle by sectors / °', r.sectors.angle_deg], ['its standard deviation / °', r.sectors.sd_deg], ['sectors with a flank', r.sectors.count],
      ['angle by the cone / °', r.cone.angle_deg], ['its misfit, rms / mm', known(r.cone.rms) ? 1000 * r.cone.rms : null],
      ['angle by silhouettes / °', r.silhouettes.angle_deg], ['its standard deviation / °', r.silhouettes.sd_deg],
      ['the three ways differ by / °', r.spread_deg], ['angle by volume and centroid / °', r.volume_deg],
      ['height / mm', 1000 * r.height], ['base radius / mm', known(r.base_radius) ? 1000 * r.base_radius : null], ['run-out / mm', 1000 * r.run_out],
      ['packing fraction', r.packing_fraction], ['coordination number', r.coordination], ['particle size / mm', 1000 * r.particle_size],
      ['kinetic energy left / J', r.kinetic],
    ], `${name}-heap.csv`);
    element('h2', 'Shapes', host);
    table(host, [
      { head: 'shape', value: (s) => s.name }, { head: 'kind', value: (s) => s.kind }, { head: 'triangles', value: (s) => s.triangle_count, text: (s) => whole(s.triangle_count) },
      { head: 'volume / mm³', value: (s) => s.volume * 1e9, text: (s) => number(s.volume * 1e9, 5) }, { head: 'size / mm', value: (s) => s.size * 1000, text: (s) => number(s.size * 1000, 4) },
      { head: 'source', value: (s) => s.source },
    ], heap.shapes, `${name}-shapes.csv`, 'Shapes').classList.add('sources');
    const more = element('details', null, host);
    element('summary', 'The experiment, and what it cost', more);
    const flat = (object, before = '') => Object.entries(object).flatMap(([key, value]) => (value && typeof value === 'object' ? flat(value, `${before}${key}.`) : [[`${before}${key}`, value]]));
    table(more, [{ head: 'field', value: (row) => row[0] }, { head: 'value', value: (row) => row[1] }], [...flat(heap.experiment), ...flat(c)], `${name}-experiment.csv`, 'The experiment');
    const keys = Object.keys(this.series);
    saveButton(host, 'Save the series as CSV', `${name}-series.csv`, () => [keys, ...this.series.time.map((_, i) => keys.map((key) => this.series[key][i]))]);
  }
}
