// What sections with a pile to play have in common: the player, the curves beside it that mark its time, tables of
// values.
import { Chart, palette } from './chart.js';
import { holds } from './packed.js';
import { Pile, PilePlayer } from './pile.js';
import { element, number, saveButton, table } from './text.js';

export const known = (x) => x !== null && x !== undefined && Number.isFinite(x);

export class PlayedSection {
  // series: columns, `time` among them; picture: the id of an <img> for browsers without WebGL
  constructor(host, folder, series) {
    Object.assign(this, { host, series, charts: [] });
    this.name = folder.folder.split('/').filter(Boolean).pop();
  }

  addPlayer(label, picture) {
    this.player = new PilePlayer(element('div', null, this.host), {
      picture: document.getElementById(picture),
      label,
      plays: true,
      told: (time) => this.toldAt(time),
      onTime: () => this.markTime(),
    });
  }

  // The pile, where the page holds it.
  play(id) {
    if (!this.player.view) return;
    if (holds(id)) this.player.show(new Pile(id), this.scene.shapes);
    else this.player.lack();
  }

  // The last point of the series at a time or before it; -1 where there is none.
  pointAt(time) {
    const { series } = this;
    const i = series.time.findIndex((t) => t > time + 1e-9);
    return i < 0 ? series.time.length - 1 : Math.max(0, i - 1);
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
      series: keys.map(([label, key], i) => ({ label, values: series[key], color: palette[(i + (options.from ?? 0)) % palette.length], dash: [undefined, [6, 3], [2, 2], [8, 2, 2, 2]][i], width: 2, text: (v) => number(v, 4), points: Boolean(options.points) })),
      marks: () => (this.player.view ? [{ x: this.player.time }] : []),
      pick: (i) => {
        this.player.stop();
        this.player.goTo(Math.min(series.time[i], this.player.pile?.end ?? 0));
      },
      ...options,
    }));
  }

  // Of what falls to nothing at rest: on a logarithmic axis down to 1e-8 of the most.
  fallingChart(title, yLabel, keys, options = {}) {
    const most = Math.max(...keys.flatMap(([, key]) => this.series[key].filter(known)));
    if (most > 0) this.chart(title, yLabel, keys, { logY: true, yLeast: 1e-8 * most, ...options });
  }

  // rows: [what, value]
  values(title, rows, file) {
    element('h2', title, this.host);
    table(this.host, [
      { head: 'what', value: (row) => row[0] },
      { head: 'value', value: (row) => row[1], text: (row) => (typeof row[1] === 'number' ? number(row[1], 5) : row[1]) },
    ], rows, `${this.name}-${file}.csv`, title);
  }

  shapeTable(shapes, extra = []) {
    element('h2', 'Shapes', this.host);
    table(this.host, [
      { head: 'shape', value: (s) => s.name }, ...extra, { head: 'kind', value: (s) => s.kind }, { head: 'triangles', value: (s) => s.triangle_count, text: (s) => s.triangle_count.toLocaleString('en') },
      { head: 'volume / mm³', value: (s) => s.volume * 1e9, text: (s) => number(s.volume * 1e9, 5) }, { head: 'size / mm', value: (s) => s.size * 1000, text: (s) => number(s.size * 1000, 4) },
      { head: 'source', value: (s) => s.source },
    ], shapes, `${this.name}-shapes.csv`, 'Shapes').classList.toggle('sources', shapes.some(({ source }) => source));
  }

  // Every field of the objects, nested ones with a dot.
  fields(title, objects, file) {
    const more = element('details', null, this.host);
    element('summary', title, more);
    const flat = (object, before = '') => Object.entries(object).flatMap(([key, value]) => (value && typeof value === 'object' ? flat(value, `${before}${key}.`) : [[`${before}${key}`, value]]));
    table(more, [{ head: 'field', value: (row) => row[0] }, { head: 'value', value: (row) => row[1] }], objects.flatMap((object) => flat(object)), `${this.name}-${file}.csv`, title);
  }

  saveSeries() {
    const { series } = this;
    const keys = Object.keys(series);
    saveButton(this.host, 'Save the series as CSV', `${this.name}-series.csv`, () => [keys, ...series.time.map((_, i) => keys.map((key) => series[key][i]))]);
  }
}
