// The section of a calibration or a search (calibration.json, docs/reference/formats.md): what is known of the parameters,
// every pair of them, the answers beside what was measured, and how intervals narrowed.
import { Chart, palette } from './chart.js';
import { counted, element, number, percent, table } from './text.js';

const known = (x) => x !== null && x !== undefined && Number.isFinite(x);
const interval = (low, high) => (known(low) ? `${number(low)} to ${number(high)}` : '–');

function svg(tag, parent, attributes) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
  return made;
}

export class CalibrationSection {
  constructor(host, { calibration }) {
    Object.assign(this, { host, calibration });
    this.tell();
    if (calibration.sought) this.tellSettings();
    else this.tellParameters();
    this.drawHistory();
  }

  // What is known, before how it came to be known.
  answer() {
    const { calibration: c } = this;
    const [best] = c.settings ?? [];
    if (best) return `The best so far: ${c.parameters.map(({ name }, i) => `${name} ${number(best.values[i], 3)}`).join(', ')} with ${c.sought} ${number(best.mean, 4)} (${interval(best.low, best.high)}).`;
    const told = (p) => (p.identified ? `${p.name} ${number(p.mean, 3)} (${number(p.low, 3)} to ${number(p.high, 3)})`
      : known(p.at_least) ? `${p.name} at least ${number(p.at_least, 3)}` : known(p.at_most) ? `${p.name} at most ${number(p.at_most, 3)}` : `${p.name} is not told by these measurements`);
    return `${c.parameters.map(told).join('; ')}. Intervals of ${percent(c.confidence)}.`;
  }

  tell() {
    const { host, calibration: c } = this;
    element('h1', c.title, host);
    if (c.sought ? c.settings?.length : known(c.parameters[0]?.mean)) element('p', this.answer(), host, { class: 'answer' });
    element('p', `${counted(c.done, 'run')} in ${counted(c.rounds, 'round')}${c.failed ? `, ${c.failed} failed` : ''}: ${c.stopped ?? 'not ended yet'}.`, host, { class: 'soft' });
    for (const { a, b, one_end: one, other_end: other } of c.trades ?? [])
      element('p', `${a} and ${b} trade against each other: ${a} ${number(one[0], 3)} with ${b} ${number(one[1], 3)} gives the same answers as ${a} ${number(other[0], 3)} with ${b} ${number(other[1], 3)}.`, host);
    const best = c.advice?.[0];
    if (best) element('p', `${best.name}, measured ${counted(best.repeats, 'time')} more, would tell most: ${c.parameters.map(({ name }, i) => `${name} to ${percent(best.narrowed[i])} of its range`).join(', ')}.`, host);
    for (const reason of c.failures) element('p', `failed: ${reason}`, host, { class: 'soft' });
  }

  tellParameters() {
    const { host, calibration: c } = this;
    table(host, [
      { head: 'parameter', value: (p) => p.name },
      { head: 'mean', value: (p) => number(p.mean) },
      { head: `interval of ${percent(c.confidence)}`, value: (p) => interval(p.low, p.high) },
      { head: 'of its range', value: (p) => percent(p.narrowed) },
      { head: 'told', value: (p) => (p.identified ? 'identified' : known(p.at_least) ? `at least ${number(p.at_least)}` : known(p.at_most) ? `at most ${number(p.at_most)}` : 'not identifiable') },
    ], c.parameters, 'parameters.csv', 'What is known of the parameters');
    this.drawPairs();
    table(host, [
      { head: 'answer', value: (a) => a.name },
      { head: 'measured', value: (a) => (known(a.value) ? number(a.value) : a.x ? 'a curve' : '–') },
      { head: 'simulated', value: (a) => number(a.mean) },
      { head: 'its interval', value: (a) => interval(a.low, a.high) },
      { head: 'of a single one', value: (a) => interval(a.single_low, a.single_high) },
      { head: 'agrees', value: (a) => (a.measured ? (a.inside ? 'yes' : 'no') : a.predicted ? 'predicted' : 'on offer') },
    ], c.answers, 'answers.csv', 'Answers beside what was measured');
    c.answers.filter(({ x }) => x).forEach((a) => this.drawCurve(a));
  }

  // Each pair of parameters as points on a plane.
  drawPairs() {
    const { host, calibration: { parameters, samples } } = this;
    const size = 180, edge = 34;
    const place = (p, value) => (p.scale === 'log' ? Math.log(value / p.from) / Math.log(p.to / p.from) : (value - p.from) / (p.to - p.from));
    const box = element('div', null, host, { class: 'pairs' });
    parameters.forEach((p, i) => parameters.slice(0, i).forEach((q, j) => {
      const plot = svg('svg', box, { viewBox: `0 0 ${size + edge} ${size + edge}`, width: size + edge, height: size + edge, role: 'img', 'aria-label': `${p.name} against ${q.name}` });
      svg('rect', plot, { x: edge, y: 2, width: size - 2, height: size - 2, fill: 'none', stroke: 'currentColor', 'stroke-opacity': 0.4 });
      for (const row of samples)
        svg('circle', plot, { cx: edge + place(q, row[j]) * (size - 2), cy: size - place(p, row[i]) * (size - 2), r: 1.8, fill: 'currentColor', 'fill-opacity': 0.35 });
      svg('text', plot, { x: edge + size / 2, y: size + 18, 'text-anchor': 'middle', 'font-size': 12, fill: 'currentColor' }).textContent = `${q.name} ${number(q.from)} to ${number(q.to)}`;
      svg('text', plot, { x: 12, y: size / 2, 'text-anchor': 'middle', 'font-size': 12, fill: 'currentColor', transform: `rotate(-90 12 ${size / 2})` }).textContent = `${p.name} ${number(p.from)} to ${number(p.to)}`;
    }));
    if (parameters.length > 1) element('p', 'Each point is a pair that agrees with what was measured.', host, { class: 'soft' });
  }

  drawCurve(a) {
    const text = (v) => number(v, 4);
    new Chart(element('div', null, this.host, { class: 'chart' }), {
      x: { label: 'x', values: a.x, text }, yLabel: a.name, logX: false, logY: false,
      series: [{ label: 'simulated', values: a.curve_mean, low: a.curve_low, high: a.curve_high, color: palette[0], width: 2, text },
        { label: 'measured', values: a.y, color: palette[1], width: 1, points: true, text }],
    });
  }

  tellSettings() {
    const { host, calibration: c } = this;
    table(host, [
      ...c.parameters.map(({ name }, i) => ({ head: name, value: (s) => number(s.values[i]) })),
      { head: c.sought, value: (s) => number(s.mean) },
      { head: `interval of ${percent(c.confidence)}`, value: (s) => interval(s.low, s.high) },
      { head: 'limits hold', value: (s) => percent(s.allowed) },
      { head: 'runs', value: (s) => s.runs },
    ], c.settings, 'settings.csv', `Settings with the ${c.maximise ? 'most' : 'least'} of ${c.sought}, the best first`);
  }

  drawHistory() {
    const { host, calibration: { history, parameters, sought } } = this;
    if (history.length < 2) return;
    const text = (v) => number(v, 3);
    const series = (sought ? ['best so far'] : parameters.map(({ name }) => name)).map((label, i) => ({
      label, values: history.map((row) => row[i + 1]), color: palette[i % palette.length], width: 2, points: true, text,
    }));
    new Chart(element('div', null, host, { class: 'chart' }), {
      x: { label: 'runs', values: history.map((row) => row[0]), text }, yLabel: sought ?? 'interval beside the range', logX: false, logY: false, series,
    });
  }
}
