// The section of a calibration or a search (calibration.json, docs/reference/formats.md): the settings that agree, or how
// far the nearest is off, answers beside what was measured, and how intervals narrowed.
import { Plot, legend, span } from './plot.js';
import { Skeleton, axisName, capital, fixed, said, unitText, words } from './page.js';
import { counted, element, folded, known, number, percent, table } from './text.js';

const usual = 1.645; // of a normal value, 90 %
const mean = (values) => values.reduce((sum, v) => sum + v, 0) / values.length;
const deviation = (values) => Math.sqrt(mean(values.map((v) => (v - mean(values)) ** 2)));
const halfOf = (a) => usual * Math.hypot(a.uncertainty ?? 0, known(a.scatter) && a.repeats ? a.scatter / Math.sqrt(a.repeats) : 0);
const ranks = (values) => values.map((v) => values.filter((w) => w < v).length);
const correlation = (x, y) => {
  const spread = deviation(x) * deviation(y);
  return spread > 0 ? mean(x.map((v, i) => (v - mean(x)) * (y[i] - mean(y)))) / spread : 0;
};

// Kernel density of values along an axis.
function density(values, { from, to, scale }) {
  const log = scale === 'log', at = log ? Math.log : Number, width = 1.06 * (deviation(values.map(at)) || 1e-9) * values.length ** -0.2;
  const xs = Array.from({ length: 121 }, (_, i) => at(from) + ((at(to) - at(from)) * i) / 120);
  return { xs: xs.map((x) => (log ? Math.exp(x) : x)), ys: xs.map((x) => mean(values.map((v) => Math.exp(-0.5 * ((x - at(v)) / width) ** 2))) / (width * Math.sqrt(2 * Math.PI))), prior: 1 / (at(to) - at(from)) };
}

export class CalibrationSection {
  constructor(host, folder) {
    const c = folder.calibration, search = Boolean(c.sought), misfit = c.fits === false;
    Object.assign(this, { c, host, runs: c.all_runs.map((run, i) => ({ ...run, index: i })), measured: c.answers.filter((a) => a.measured) });
    this.column = new Map(c.answers.map((a, k) => [a, this.runs.map((run) => run.answers[k])]));
    this.page = new Skeleton(host, { title: c.title.replace(/\.ya?ml$/, ''), kind: search ? 'search' : 'calibration', date: c.ended, told: c });
    if (search) this.tellSearch();
    else if (misfit) this.tellMisfit();
    else if (known(c.parameters[0]?.mean)) this.tellFit();
  }

  name(run) {
    return `Run ${run.index + 1}: ${this.c.parameters.map((p, k) => `${words(p.name)} ${number(run.values[k], 3)}`).join(', ')}`;
  }
  axis(p) {
    return { range: [p.from, p.to], log: p.scale === 'log', name: axisName(p.name, p.unit) };
  }
  marked(run, more = {}) {
    return { key: `run ${run.index}`, told: this.name(run), shape: run.check ? 'diamond' : 'dot', r: run.check ? 4 : 3, ...more };
  }
  plot(options) {
    return new Plot(this.page.pointer, options);
  }

  // ---- it fits ----

  tellFit() {
    const { c, page } = this, { parameters: ps } = c;
    const pairs = ps.flatMap((_, j) => ps.slice(0, j).map((__, i) => ({ i, j, r: correlation(c.samples.map((s) => s[i]), c.samples.map((s) => s[j])) }))).sort((a, b) => Math.abs(b.r) - Math.abs(a.r));
    if (pairs.length) this.pair(pairs[0], true).put(page.picture, null, `${c.fits ? 'Settings that agree with what was measured' : 'Settings that may agree'}; correlation ${number(pairs[0].r, 2)}.`);
    else this.posterior(ps[0], 0).put(page.picture, null, 'Shaded: the interval. Dashed: what was allowed before any run.');
    if (pairs.length) legend(page.picture, [['c1', 'dot', 'agree'], ['c0 open', 'dot', 'were run'], ['c3', 'diamond', 'check runs'], ['c2', 'diamond', 'mean'], ['c0', '4 3', 'before any run']]);
    ps.slice(0, 4).forEach((p) => this.tellParameter(p));
    const room = 8 - Math.min(4, ps.length), answers = c.answers.filter((a) => !a.x);
    for (const a of [...answers.filter((b) => b.measured), ...answers.filter((b) => b.predicted && !b.measured)].slice(0, room)) this.tellAnswer(a);
    page.tellNext();
    page.grid('Does the model give what was measured?', [...c.answers.filter((a) => a.measured || a.predicted).map((a) => this.strip(a)), ...this.measured.map((a) => this.response(a))]);
    page.grid('How well are the parameters known?', [
      ...(pairs.length ? ps.map((p, k) => (host) => this.posterior(p, k).put(host, said(p.finding), 'Shaded: the interval. Dashed: before any run. Orange: mean.')) : []),
      this.history('interval, % of range', ps.map((p) => words(p.name)), 100), ...pairs.slice(1).map((pair) => (host) => this.pair(pair).put(host, `${capital(words(ps[pair.i].name))} and ${words(ps[pair.j].name)}: correlation ${number(pair.r, 2)}`)),
    ]);
    this.tables();
  }

  tellParameter(p) {
    const bound = known(p.at_least) ? `at least ${fixed(p.at_least, p.high - p.low)}` : known(p.at_most) ? `at most ${fixed(p.at_most, p.high - p.low)}` : null;
    this.page.tile(capital(words(p.name)), bound ?? (p.identified ? fixed(p.mean, p.high - p.low) : 'not told'), unitText(p.unit), `${fixed(p.low, p.high - p.low)} to ${fixed(p.high, p.high - p.low)}`,
      `of ${number(p.from)} to ${number(p.to)} asked; ${p.identified ? 'identified' : bound ? 'its range ends there' : 'not identifiable'}`, 'main half', null);
  }

  tellAnswer(a) {
    const { page } = this, spread = a.high - a.low, { check } = a;
    if (a.measured) page.tile(capital(words(a.name)), fixed(known(a.gap) ? a.value + a.gap : a.mean, a.gap_sd ?? spread), unitText(a.unit), `for ${fixed(a.value, a.gap_sd ?? spread)} ± ${fixed(halfOf(a), a.gap_sd ?? spread)} measured`, known(a.gap) ? (a.met ? '✓ agrees' : '✗ off') : '', '', known(a.gap) ? !a.met : null);
    else page.tile(`${capital(words(a.name))}, predicted`, fixed(a.mean, spread), unitText(a.unit), `${fixed(a.counted_low ?? a.low, spread)} to ${fixed(a.counted_high ?? a.high, spread)}`, check.runs ? `${known(a.counted_low) ? '✗' : '✓'} check runs ${fixed(check.mean, spread)}` : 'not checked', '', check.runs ? known(a.counted_low) : null);
  }

  // Two parameters on a plane, with the density of each at its side.
  pair({ i, j }, big = false) {
    const { c } = this, [p, q] = [c.parameters[i], c.parameters[j]], [px, qx] = [this.axis(p), this.axis(q)], side = 56;
    const size = big ? { w: 560, h: 410, l: 58, b: 46 } : { w: 420, h: 300 };
    const plot = this.plot({ ...size, t: side, r: side, x: px.range, y: qx.range, xlog: px.log, ylog: qx.log, xl: px.name, yl: qx.name, label: `Settings of ${words(p.name)} and ${words(q.name)} that agree with what was measured: ${fixed(p.low, p.high - p.low)} to ${fixed(p.high, p.high - p.low)} and ${fixed(q.low, q.high - q.low)} to ${fixed(q.high, q.high - q.low)}` });
    plot.xband(p.low, p.high, 'c1').yband(q.low, q.high, 'c1');
    for (const run of this.runs) plot.dot(run.values[i], run.values[j], run.check ? 'c3' : 'c0 open', this.marked(run));
    for (const row of c.samples) plot.dot(row[i], row[j], 'c1 faint', { r: 1.7 });
    plot.dot(p.mean, q.mean, 'c2', { r: 5, shape: 'diamond' });
    const [dp, dq] = [density(c.samples.map((s) => s[i]), p), density(c.samples.map((s) => s[j]), q)], [mp, mq] = [Math.max(...dp.ys), Math.max(...dq.ys)];
    const up = (y) => side - 6 - (y / mp) * (side - 24), right = (y) => plot.w - side + 6 + (y / mq) * (side - 20), foot = plot.h - plot.b;
    const d = (points) => points.map((xy) => xy.map((v) => v.toFixed(1)).join(' ')).join('L');
    plot.path('ar dark c1', `M${d(dp.xs.map((x, k) => [plot.X(x), up(dp.ys[k])]))}V${side - 6}H${plot.l}Z`, {}, plot.svg);
    plot.path('ar dark c1', `M${d(dq.xs.map((y, k) => [right(dq.ys[k]), plot.Y(y)]))}H${plot.w - side + 6}V${foot}Z`, {}, plot.svg);
    plot.path('ln c0 thin', `M${plot.l} ${up(dp.prior)}H${plot.w - side}M${right(dq.prior)} ${side}V${foot}`, { 'stroke-dasharray': '4 3' }, plot.svg);
    if (big) plot.at(plot.X(p.mean), 12, `${fixed(p.low, p.high - p.low)} to ${fixed(p.high, p.high - p.low)}`, 'b t1', 'middle');
    return plot;
  }

  posterior(p, k) {
    const { range, log, name } = this.axis(p), { xs, ys, prior } = density(this.c.samples.map((row) => row[k]), p), top = 1.15 * Math.max(...ys, prior);
    return this.plot({ h: 210, l: 14, x: range, xlog: log, y: [0, top], noy: true, xl: name, label: said(p.finding) })
      .xband(p.low, p.high, 'c1').area(xs, xs.map(() => 0), ys, 'c1').line(xs, ys, 'c1').line(range, [prior, prior], 'c0', '4 3').vline(p.mean, 'c2')
      .text(p.mean, 0.92 * top, fixed(p.mean, p.high - p.low), 'b t2', 'start', 6).follow(`posterior ${k}`, xs, [{ name: 'density', values: ys }], { name: words(p.name), digits: 3 });
  }

  // What was measured, what the settings give, and the check runs, on one axis.
  strip(a) {
    if (a.x) return this.curve(a);
    const misfit = this.c.fits === false, all = this.runs.map((run, i) => ({ run, value: this.column.get(a)[i] })).filter(({ value }) => known(value));
    const checks = all.filter(({ run }) => run.check), spread = a.gap_sd ?? a.high - a.low, half = a.measured ? halfOf(a) : 0;
    const rows = [a.measured && 'measured', misfit ? 'all runs' : 'simulated', checks.length && (misfit ? 'nearest' : 'check runs')].filter(Boolean);
    const [low, high] = span([a.low, a.high, a.single_low, a.single_high, a.check.low, a.check.high, ...(misfit ? all : checks).map(({ value }) => value), ...(a.measured ? [a.value - half, a.value + half] : [])], 0.12);
    const plot = this.plot({ h: 58 + 30 * rows.length, l: 82, t: 6, b: 40, x: [low, high], y: [0, 1], noy: true, xl: axisName(a.name, a.unit), label: said(a.finding) });
    rows.forEach((row, i) => {
      const y = 24 + 30 * i;
      plot.at(76, y + 4, row, 's', 'end');
      if (row === 'measured') plot.hbar(y, a.value - half, a.value + half, 'c2').mark(plot.X(a.value), y, 'c2', { shape: 'square', r: 4 });
      if (row === 'simulated') plot.box(plot.X(a.single_low), plot.X(a.single_high), y - 7, y + 7, 'c1').hbar(y, a.low, a.high, 'c1').mark(plot.X(a.mean), y, 'c1', { r: 4.5 });
      const several = row === 'all runs' ? all.filter(({ run }) => !run.check) : row === 'simulated' || row === 'measured' ? [] : checks;
      if (several === checks && known(a.check.low) && !misfit) plot.hbar(y, a.check.low, a.check.high, 'c0', 4);
      for (const { run, value } of several) plot.mark(plot.X(value), y, several === checks ? 'c3' : 'c0 faint', this.marked(run, { told: `${this.name(run)}: ${fixed(value, spread)}${unitText(a.unit)}` }));
      if (several === checks) plot.mark(plot.X(mean(checks.map(({ value }) => value))), y, 'c3', { shape: 'diamond', r: 6 });
    });
    const note = misfit ? 'Orange: measured, 90 %. Green: runs at the nearest setting.' : checks.length ? `Check runs ${fixed(a.check.mean, spread)}, expected ${fixed(a.check.low, spread)} to ${fixed(a.check.high, spread)} (grey). Pale: a single run.` : 'Pale: a single run.';
    return (host) => plot.put(host, said(a.finding), note);
  }

  curve(a) {
    const [low, high] = span([...a.curve_low, ...a.curve_high, ...a.y]);
    const plot = this.plot({ x: [a.x[0], a.x.at(-1)], y: [low, high], xl: 'x', yl: axisName(a.name, a.unit) }).area(a.x, a.curve_low, a.curve_high, 'c1').line(a.x, a.curve_mean, 'c1').line(a.x, a.y, 'c2', '5 3');
    plot.follow(`curve ${a.name}`, a.x, [{ name: 'simulated', values: a.curve_mean }, { name: 'measured', values: a.y }], { name: 'x' });
    return (host) => plot.put(host, said(a.finding), 'Blue: simulated, with its interval. Orange: measured.');
  }

  // All runs against the parameter that an answer follows most.
  response(a) {
    const { parameters } = this.c, all = this.runs.map((run, i) => ({ run, value: this.column.get(a)[i] })).filter(({ value }) => known(value));
    if (a.x || all.length < 4) return null;
    const order = ranks(all.map(({ value }) => value)), strength = parameters.map((_, k) => Math.abs(correlation(ranks(all.map(({ run }) => run.values[k])), order)));
    const k = strength.indexOf(Math.max(...strength)), p = parameters[k], { range, log, name } = this.axis(p), half = halfOf(a);
    const plot = this.plot({ x: range, xlog: log, y: span([...all.map(({ value }) => value), a.value - half, a.value + half]), xl: name, yl: axisName(a.name, a.unit), label: `${words(a.name)} of all runs against ${words(p.name)}, with the measured band` });
    if (a.measured) plot.yband(a.value - half, a.value + half, 'c2').hline(a.value, 'c2').text(p.to, a.value + half, `measured ${fixed(a.value, a.gap_sd)}${unitText(a.unit)}`, 'b t2', 'end', -2, -5);
    for (const { run, value } of all) plot.dot(run.values[k], value, run.check ? 'c3' : 'c1', this.marked(run, { told: `${this.name(run)}: ${fixed(value, a.gap_sd)}${unitText(a.unit)}` }));
    return (host) => plot.put(host, `${capital(words(a.name))} of every run against ${words(p.name)}`, 'Each mark a run; green: check runs. Point at one: it is marked on the whole page.');
  }

  history(yl, names, factor) {
    const { history, history_finding: finding } = this.c, xs = history.map((row) => row[0]);
    if (history.length < 2) return null;
    const lines = names.map((name, k) => ({ name, values: history.map((row) => factor * row[k + 1]), unit: factor === 100 ? ' %' : '' }));
    const [low, high] = span(lines.flatMap(({ values }) => values));
    const plot = this.plot({ r: 110, x: [xs[0], xs.at(-1)], y: [factor === 100 ? 0 : low, high], xl: 'runs made', yl });
    lines.forEach(({ name, values }, k) => plot.line(xs, values, `c${(k % 4) + 1}`).end(values.at(-1), name, `t${(k % 4) + 1}`));
    return (host) => plot.follow('runs', xs, lines, { name: 'after', unit: ' runs', digits: 3 }).put(host, finding, factor === 100 ? 'A flat line: what was measured limits the answer, not the number of runs.' : '');
  }

  tables() {
    const { c } = this, host = folded(this.page.host, 'Tables', false), interval = (low, high) => (known(low) ? `${number(low)} to ${number(high)}` : '–');
    table(host, [
      { head: 'parameter', value: (p) => p.name }, { head: 'mean', value: (p) => p.mean, text: (p) => number(p.mean) },
      { head: `interval of ${percent(c.confidence)}`, value: (p) => interval(p.low, p.high) }, { head: 'of its range', value: (p) => p.narrowed, text: (p) => percent(p.narrowed) },
      { head: 'told', value: (p) => (p.identified ? 'identified' : known(p.at_least) ? `at least ${number(p.at_least)}` : known(p.at_most) ? `at most ${number(p.at_most)}` : 'not identifiable') },
    ], c.parameters, 'parameters.csv', 'What is known of the parameters');
    table(host, [
      { head: 'answer', value: (a) => a.name }, { head: 'measured', value: (a) => (a.x ? 'a curve' : a.value), text: (a) => (a.x ? 'a curve' : number(a.value)) },
      { head: 'simulated', value: (a) => a.mean, text: (a) => number(a.mean) }, { head: 'its interval', value: (a) => interval(a.low, a.high) },
      { head: 'of a single one', value: (a) => interval(a.single_low, a.single_high) }, { head: 'agrees', value: (a) => (a.measured ? (a.inside ? 'yes' : 'no') : a.predicted ? 'predicted' : 'on offer') },
    ], c.answers, 'answers.csv', 'Answers beside what was measured');
  }

  // ---- it does not fit ----

  tellMisfit() {
    const { c, page } = this, off = (a) => Math.abs(a.gap) / a.gap_sd;
    const missed = this.measured.filter((a) => !a.x && known(a.gap)).sort((a, b) => off(b) - off(a)), [a, b] = missed;
    const both = b ? this.runs.filter((run) => [a, b].every((each) => known(this.column.get(each)[run.index]))) : [];
    if (both.length > 3) this.plane(a, b, both);
    else if (a) this.response(a)?.(page.picture);
    page.tile('Distance from all that was measured', number(c.misfit, 3), '', `chance alone allows ${number(c.misfit_limit, 3)}`, 'squared, in scatter and uncertainty (chi-square)', 'main full', null);
    for (const each of missed.slice(0, 6)) page.tile(`${capital(words(each.name))}: too ${each.gap < 0 ? 'low' : 'high'} by`, fixed(Math.abs(each.gap), each.gap_sd), unitText(each.unit), `± ${fixed(usual * each.gap_sd, each.gap_sd)}`, `${each.met ? '✓' : '✗'} ${fixed(each.value + each.gap, each.gap_sd)} for ${fixed(each.value, each.gap_sd)}`, '', !each.met);
    page.plain('Nearest setting, not fitted', c.parameters.map((p) => number(p.nearest, 3)).join(', '), '', c.parameters.map((p) => words(p.name)).join(', '), 'nothing follows from it', 'full');
    element('h2', 'What is usually missing', page.side);
    const list = element('ul', null, page.side, { class: 'say' });
    for (const hint of c.hints) element('li', hint, list);
    page.tellNext();
    this.tellRefits();
    page.grid('How far off, by measurement', [...this.measured.filter((each) => !each.x).map((each) => this.strip(each)), ...this.measured.map((each) => this.response(each))]);
    element('p', 'Left out, because the model does not fit: what the parameters would be and to within what, and what would be predicted.', page.host, { class: 'soft' });
  }

  // Where the model can go: all runs in the plane of the two answers that are off most.
  plane(a, b, runs) {
    const { page } = this, of = (each) => runs.map((run) => this.column.get(each)[run.index]), half = [halfOf(a), halfOf(b)];
    const range = (each, h) => span([...of(each), each.value - h, each.value + h], 0.1);
    const plot = this.plot({ w: 560, h: 400, l: 58, r: 20, t: 16, b: 46, x: range(a, half[0]), y: range(b, half[1]), xl: axisName(a.name, a.unit), yl: axisName(b.name, b.unit), label: `All runs by ${words(a.name)} and ${words(b.name)}; measured ${fixed(a.value, a.gap_sd)} and ${fixed(b.value, b.gap_sd)}, the nearest setting gives ${fixed(a.value + a.gap, a.gap_sd)} and ${fixed(b.value + b.gap, b.gap_sd)}` });
    plot.xband(a.value - half[0], a.value + half[0], 'c2').yband(b.value - half[1], b.value + half[1], 'c2');
    runs.forEach((run, i) => plot.dot(of(a)[i], of(b)[i], run.check ? 'c3' : 'c1', this.marked(run, { told: `${this.name(run)}: ${fixed(of(a)[i], a.gap_sd)}${unitText(a.unit)}, ${fixed(of(b)[i], b.gap_sd)}${unitText(b.unit)}` })));
    plot.dot(a.value, b.value, 'c2', { shape: 'cross', r: 8 });
    const out = a.value > a.highest ? a.highest : a.value < a.lowest ? a.lowest : a.value + a.gap, at = plot.Y(b.value);
    plot.path('ln cb', `M${plot.X(out)} ${at}H${plot.X(a.value) - Math.sign(plot.X(a.value) - plot.X(out)) * 12}`);
    plot.vline(out, 'cb thin', '4 3');
    plot.at((plot.X(out) + plot.X(a.value)) / 2, at - 9, `${fixed(Math.abs(a.value - out), a.gap_sd)}${unitText(a.unit)}`, 'big tb', 'middle');
    plot.put(page.picture, null, 'Each mark a run: what the model can give. Point at one: its setting, and the same run below.');
    legend(page.picture, [['c1', 'dot', 'a run'], ['c3', 'diamond', 'runs at the nearest setting'], ['c2', 'band', 'measured, 90 %'], ['cb', '4 3', out === a.value + a.gap ? 'nearest setting' : `${out === a.highest ? 'highest' : 'lowest'} of all runs`]]);
  }

  tellRefits() {
    const { c, page } = this;
    if (!c.refits?.length) return;
    element('h2', 'Which measurement is at odds with the rest?', page.host);
    const list = (f) => c.parameters.map((p, k) => `${words(p.name)} ${fixed(f.nearest[k], f.high[k] - f.low[k])} (${fixed(f.low[k], f.high[k] - f.low[k])} to ${fixed(f.high[k], f.high[k] - f.low[k])})`).join(', ');
    const others = (f) => c.answers.map((a, k) => ({ a, value: f.answers[k] })).filter(({ a, value }) => a.measured && known(value) && a.name !== f.without && Math.abs(value - a.value) > usual * a.gap_sd).map(({ a, value }) => `${words(a.name)} ${fixed(value, a.gap_sd)} for ${fixed(a.value, a.gap_sd)}`).join(', ');
    table(page.host, [
      { head: 'fitted again', value: (f) => `without ${words(f.without)}` }, { head: 'do the others agree?', value: (f) => (f.fits ? '✓ yes' : `✗ no${others(f) && `: ${others(f)}`}`) },
      { head: 'then the parameters would be', value: (f) => (f.fits ? list(f) : '–') }, { head: 'and the one left out', value: (f) => (known(f.value_low) ? `${number(f.value_low, 3)} to ${number(f.value_high, 3)}` : '–') },
    ], c.refits, 'refits.csv', 'Fits without each measurement').classList.add('stack');
  }

  // ---- a search ----

  tellSearch() {
    const { c, page } = this, [best] = c.settings ?? [], [p, q] = c.parameters;
    const sought = c.answers.find((a) => a.name === c.sought || a.answer === c.sought) ?? c.answers[0], values = this.column.get(sought), all = this.runs.filter((run) => known(values[run.index]));
    if (!best) return;
    const spread = best.high - best.low, order = ranks(all.map((run) => values[run.index])), [px, qx] = [this.axis(p), q && this.axis(q)];
    const plot = this.plot({ w: 560, h: 400, l: 58, r: 20, b: 46, x: px.range, xlog: px.log, xl: px.name, ...(q ? { y: qx.range, ylog: qx.log, yl: qx.name } : { y: span(all.map((run) => values[run.index])), yl: axisName(c.sought, sought.unit) }) });
    all.forEach((run, i) => {
      const share = all.length > 1 ? order[i] / (all.length - 1) : 1;
      plot.dot(run.values[0], q ? run.values[1] : values[run.index], `c1 rank${Math.round(4 * (c.maximise ? share : 1 - share))}`, this.marked(run, { r: 5, told: `${this.name(run)}: ${words(c.sought)} ${fixed(values[run.index], spread)}` }));
    });
    plot.dot(best.values[0], q ? best.values[1] : best.mean, 'c2', { shape: 'diamond', r: 6 });
    plot.put(page.picture, null, `Every run; the darker, the ${c.maximise ? 'greater' : 'less'}. Orange: the best setting.`);
    page.plain(capital(words(c.sought)), fixed(best.mean, spread), unitText(sought.unit), `${fixed(best.low, spread)} to ${fixed(best.high, spread)}`, `${counted(best.runs, 'run')} there`, 'main full');
    c.parameters.slice(0, 5).forEach((each, k) => page.plain(capital(words(each.name)), number(best.values[k], 4), unitText(each.unit), '', `of ${number(each.from)} to ${number(each.to)}`));
    if (c.answers.length > 1) page.tile('Limits hold', percent(best.allowed), '', '', best.allowed < c.confidence ? `✗ less than ${percent(c.confidence)}` : '✓ as asked', '', best.allowed < c.confidence);
    page.tellNext();
    page.grid('How it was found', [this.history(words(c.sought), ['best so far'], 1), this.response(sought), ...c.answers.filter((a) => a !== sought).map((a) => this.response(a))]);
    table(folded(page.host, 'Settings', false), [
      ...c.parameters.map(({ name }, i) => ({ head: words(name), value: (s) => s.values[i], text: (s) => number(s.values[i]) })), { head: words(c.sought), value: (s) => s.mean, text: (s) => number(s.mean) },
      { head: 'low', value: (s) => s.low, text: (s) => number(s.low) }, { head: 'high', value: (s) => s.high, text: (s) => number(s.high) },
      { head: 'limits hold', value: (s) => s.allowed, text: (s) => percent(s.allowed) }, { head: 'runs', value: (s) => s.runs },
    ], c.settings, 'settings.csv', `Settings with the ${c.maximise ? 'most' : 'least'} of ${c.sought}, the best first`);
  }
}
