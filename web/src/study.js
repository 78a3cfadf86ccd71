// The section of a study (study.json, docs/reference/formats.md): what each factor does to each answer, with its spread.
import { holds } from './packed.js';
import { Skeleton, axisName, capital, fixed, said, unitText, words } from './page.js';
import { Pile, PilePlayer } from './pile.js';
import { Plot, span, spanWithBars } from './plot.js';
import { element, folded, known, number, table, whole } from './text.js';

const mean = (values) => values.reduce((sum, v) => sum + v, 0) / values.length;
const signed = (value, spread) => `${value > 0 ? '+' : ''}${fixed(value, spread)}`;
// Replicates that are all alike have no interval: their scatter is not zero but was not seen.
const alike = (s) => s.count > 1 && s.sd === 0;
const halfOf = (s) => (s.count > 1 && !alike(s) ? (s.mean_high - s.mean_low) / 2 : null);
const sdText = (s) => (alike(s) ? 'all alike' : number(s.sd, 3));

// A factor's levels, numbers in their order, and where they lie on an axis: words at equal distances.
function axisOf(points, name) {
  const levels = [...new Set(points.map(({ factors }) => factors[name]))], numbers = levels.every((v) => typeof v === 'number');
  if (numbers) levels.sort((a, b) => a - b);
  const log = numbers && (name === 'rp' || levels[0] > 0) && levels.at(-1) > 20 * levels[0] && levels[0] > 0;
  const at = (value) => (numbers ? value : levels.indexOf(value)), ends = [at(levels[0]), at(levels.at(-1))];
  const range = log ? [ends[0] / 1.3, ends[1] * 1.3] : [ends[0] - 0.06 * (ends[1] - ends[0]), ends[1] + 0.06 * (ends[1] - ends[0])];
  return { name, levels, at, log, range, ticks: levels.length < 8 || !numbers ? levels.map((v) => [at(v), typeof v === 'number' ? number(v, 3) : String(v)]) : undefined };
}

export class StudySection {
  constructor(host, folder) {
    const { study } = folder, { told, points } = study;
    const page = new Skeleton(host, { title: study.name, kind: 'study', date: folder.provenance?.started, told: study });
    Object.assign(this, { study, page, host: page.host, piles: new Map(folder.piles) });
    const strength = (name) => Math.abs(told[0].effects.find((e) => e.factor === name && !e.other)?.size ?? 0);
    this.axes = Object.keys(points[0]?.factors ?? {}).map((name) => axisOf(points, name)).filter(({ levels }) => levels.length > 1).sort((a, b) => strength(b.name) - strength(a.name));
    this.answers = told.map((t) => ({ ...t, get: (p) => p.answers[t.name] ?? p.angle_deg, title: words(t.name === 'angle_deg' ? 'angle of repose' : t.name) }));
    if (study.runs.done) this.tell();
    this.tables();
  }

  tell() {
    const { page, answers: [first, ...others], study } = this, shown = (a, width) => `${fixed(a, width)}`;
    const hero = this.lines(first, { w: 560, h: 400, b: 46, l: 58 });
    if (!hero) page.hero.classList.add('alone');
    hero?.put(page.picture, null, `Bars: ${number(100 * study.confidence)} % of the mean. Point or tap: the same in every chart.`);
    const effects = (a) => a.effects.filter((e) => !e.other), both = first.effects.find((e) => e.other);
    const effect = (a, e, size, name) => page.plain(`${name ? name + words(e.factor) : capital(words(e.factor))}, ${e.from} to ${e.to}`, signed(e.size, e.half ?? Math.abs(e.size)), unitText(a.unit), known(e.half) ? `± ${fixed(e.half, e.half)}` : '', '', size);
    effects(first).slice(0, 3).forEach((e) => effect(first, e, 'main half', ''));
    if (both) page.plain('Both at once, besides', signed(both.size, both.half ?? Math.abs(both.size)), unitText(first.unit), known(both.half) ? `± ${fixed(both.half, both.half)}` : '', 'more than the sum');
    if (!effects(first).length) {
      const all = study.points.map(first.get).filter((s) => s.count);
      if (all.length) page.plain(capital(first.title), fixed(mean(all.map((s) => s.mean)), first.half), unitText(first.unit), known(first.half) ? `± ${shown(first.half, first.half)}` : '', all.length > 1 ? `the mean of ${all.length} points` : '', 'main full');
    }
    if (known(first.scatter)) page.plain('One run scatters by', fixed(first.scatter, first.scatter), unitText(first.unit), '', 'over all points');
    if (known(first.half) && first.half > 0) page.plain('Each point is known to', `± ${fixed(first.half, first.half)}`, unitText(first.unit), '', `${study.replicates} repeats`);
    others.slice(0, 1).forEach((a) => effects(a).slice(0, 2).forEach((e) => effect(a, e, '', `${capital(a.title)}, by `)));
    page.plain('Runs', whole(study.runs.done), '', `of ${whole(study.points.length * study.replicates)}`, study.runs.failed ? `${whole(study.runs.failed)} failed` : 'none failed');
    page.tellNext();
    page.grid('What each factor does', [
      ...this.answers.map((a) => this.effects(a)), ...others.map((a) => this.card(this.lines(a), `${capital(a.title)}${this.axes[0] ? ` against ${words(this.axes[0].name)}` : ''}`, 'Bars: interval of the mean.')),
      others.length ? this.trade(first, others[0]) : null, this.scatter(first), this.repeats(first),
      study.points[0]?.heap_count !== undefined && !others.length && this.axes.length ? this.card(this.lines({ get: (p) => p.seconds, name: 'seconds', title: 'computation time', unit: 's' }), 'Computation time of a run') : null, this.rotation(),
    ]);
    this.showPiles();
  }

  card(plot, title, note) {
    return plot && ((host) => plot.put(host, title, note));
  }

  // The answer along the strongest factor, a line for each level of the next; over all else the mean.
  lines(answer, size = {}) {
    const { study: { points }, page } = this, [along, by] = this.axes, groups = by?.levels.slice(0, 6) ?? [null];
    if (!along) return null;
    const rows = groups.map((level) => along.levels.map((value) => {
      const all = points.filter(({ factors }) => factors[along.name] === value && (level === null || factors[by.name] === level)).map(answer.get).filter((s) => s.count);
      const halves = all.map(halfOf);
      return all.length ? { at: along.at(value), value, mean: mean(all.map((s) => s.mean)), half: halves.every(known) ? Math.hypot(...halves) / all.length : 0 } : null;
    }).filter(Boolean));
    const flat = rows.flat();
    if (!flat.length) return null;
    const plot = new Plot(page.pointer, { r: by ? 104 : 16, ...size, x: along.range, xlog: along.log, xt: along.ticks, y: spanWithBars(flat.map((p) => p.mean), flat.map((p) => p.mean - p.half), flat.map((p) => p.mean + p.half)), xl: words(along.name), yl: axisName(answer.title, answer.unit), label: `${answer.title} against ${words(along.name)}` });
    rows.forEach((row, i) => {
      const cls = `c${(i % 4) + 1}`;
      plot.line(row.map((p) => p.at), row.map((p) => p.mean), cls, i > 3 ? '5 3' : '');
      for (const p of row) {
        if (p.half) plot.ebar(p.at, p.mean - p.half, p.mean + p.half, cls);
        plot.dot(p.at, p.mean, cls, { key: `${p.value} ${groups[i]}`, r: 4, told: `${words(along.name)} ${p.value}${by ? `, ${words(by.name)} ${groups[i]}` : ''}: ${fixed(p.mean, answer.half)}${p.half ? ` ± ${fixed(p.half, p.half)}` : ''}${unitText(answer.unit)}` });
      }
      if (by) plot.end(row.at(-1)?.mean, (typeof groups[i] === 'number' ? number(groups[i], 3) : groups[i]).slice(0, 15), `t${(i % 4) + 1}`);
    });
    if (by) plot.at(plot.w, plot.t + 2, words(by.name).slice(0, 18), 's', 'end');
    return plot.follow(`along ${along.name}`, along.levels.map(along.at), rows.map((row, i) => ({ name: by ? `${words(by.name)} ${groups[i]}:` : '', values: along.levels.map((v) => row.find((p) => p.value === v)?.mean), unit: unitText(answer.unit) })), { name: words(along.name), text: (x) => String(along.levels.find((v) => along.at(v) === x)) });
  }

  effects(a) {
    if (!a.effects.length) return null;
    const list = a.effects.slice(0, 5), reach = list.flatMap((e) => [e.size - (e.half ?? 0), e.size + (e.half ?? 0), 0]);
    const plot = new Plot(this.page.pointer, { h: 62 + 46 * list.length, l: 14, t: 4, x: spanWithBars(list.map((e) => e.size).concat(0), reach, reach), y: [0, 1], noy: true, xl: `change of the ${axisName(a.title, a.unit)}`, label: said(a.finding) }).vline(0, 'c0');
    list.forEach((e, i) => {
      const y = 18 + 46 * i, cls = e.other ? 'c4' : 'c1';
      plot.at(18, y + 2, e.other ? `${words(e.factor)} with ${words(e.other)}, besides` : `${words(e.factor)}, ${e.from} to ${e.to}`, 's').at(404, y + 2, `${signed(e.size, e.half ?? Math.abs(e.size))}${known(e.half) ? ` ± ${fixed(e.half, e.half)}` : ''}${unitText(a.unit)}`, 'b', 'end').box(plot.X(0), plot.X(e.size), y + 8, y + 22, `dark ${cls}`);
      if (known(e.half)) plot.hbar(y + 15, Math.max(plot.x[0], e.size - e.half), Math.min(plot.x[1], e.size + e.half), cls);
    });
    return (host) => plot.put(host, said(a.finding), 'From the first level to the last, over all else the mean. Bars: interval.');
  }

  trade(a, b) {
    const [along, by] = this.axes, points = this.study.points.filter((p) => a.get(p).count && b.get(p).count);
    if (!along || points.length < 3) return null;
    const plot = new Plot(this.page.pointer, { x: span(points.map((p) => a.get(p).mean)), y: span(points.map((p) => b.get(p).mean)), xl: axisName(a.title, a.unit), yl: axisName(b.title, b.unit) });
    for (const p of points) plot.dot(a.get(p).mean, b.get(p).mean, `c${by ? (by.levels.indexOf(p.factors[by.name]) % 4) + 1 : 1}`, { key: `${p.factors[along.name]} ${by ? p.factors[by.name] : null}`, r: 4, told: `${p.label}: ${fixed(a.get(p).mean, a.half)}${unitText(a.unit)}, ${fixed(b.get(p).mean, b.half)}${unitText(b.unit)}` });
    return this.card(plot, `${capital(b.title)} beside ${a.title}`, 'Each mark a point of the design.');
  }

  scatter(a) {
    const points = this.study.points.filter((p) => a.get(p).count > 1 && !alike(a.get(p))).slice(0, 40);
    if (points.length < 2) return null;
    const all = points.map(a.get), plot = new Plot(this.page.pointer, { x: [-0.6, points.length - 0.4], y: [0, Math.min(3 * a.scatter, 1.1 * Math.max(...all.map((s) => s.sd_high ?? s.sd)))], nox: true, xl: 'points of the design', yl: `scatter of one run${a.unit ? `, ${unitText(a.unit).trim()}` : ''}` }).hline(a.scatter, 'c0', '5 3');
    points.forEach((p, i) => plot.ebar(i, all[i].sd_low, all[i].sd_high, 'c1').dot(i, Math.min(all[i].sd, plot.y[1]), 'c1', { key: `${this.axes.slice(0, 2).map(({ name }) => p.factors[name]).concat(this.axes.length < 2 ? 'null' : []).join(' ')}`, told: `${p.label}: ${number(all[i].sd, 2)} (${number(all[i].sd_low, 2)} to ${number(all[i].sd_high, 2)})${unitText(a.unit)}` }));
    return this.card(plot, `${capital(a.title)}: one run scatters by ${fixed(a.scatter, a.scatter)}${unitText(a.unit)}`, 'Dashed: all points together. Bars: interval of each.');
  }

  repeats(a) {
    const now = this.study.replicates;
    if (!(a.half > 0)) return null;
    const counts = Array.from({ length: 30 }, (_, i) => i + 2), half = counts.map((n) => a.half * Math.sqrt(now / n)), plot = new Plot(this.page.pointer, { x: [0, 32], y: [0, 1.1 * Math.max(a.half, half[0])], xl: 'repeats of every point', yl: `±${a.unit ? `, ${unitText(a.unit).trim()}` : ''}` });
    plot.line(counts, half, 'c1').dot(now, a.half, 'c2', { shape: 'diamond', r: 5 }).text(now, a.half, `now ± ${fixed(a.half, a.half)}${unitText(a.unit)}`, 'b t2', 'start', 10, -6).follow('repeats', counts, [{ name: '±', values: half, unit: unitText(a.unit) }], { unit: ' repeats', digits: 2 });
    return this.card(plot, `What more repeats would tell of the ${a.title}`, 'From the scatter of all points, as its root.');
  }

  rotation() {
    const drawn = this.study.points.filter((point) => point.rotation?.time.length > 1).slice(0, 6);
    if (!drawn.length) return null;
    const times = [...new Set(drawn.flatMap((point) => point.rotation.time))].filter((t) => t >= 0).sort((a, b) => a - b);
    const series = drawn.map((point) => ({ name: point.label || point.rp, values: times.map((t) => point.rotation.mean[point.rotation.time.indexOf(t)] ?? null), unit: '' }));
    const plot = new Plot(this.page.pointer, { r: 104, x: [0, times.at(-1)], y: span(series.flatMap((s) => s.values)), xl: 'time since the cylinder began to rise, s', yl: 'mean rotation, rad/s' });
    series.forEach(({ name, values }, i) => plot.line(times, values, `c${(i % 4) + 1}`, i > 3 ? '5 3' : '').end(values.findLast(known), name.slice(0, 16), `t${(i % 4) + 1}`));
    return this.card(plot.follow('time', times, series, { unit: ' s' }), 'Rotation while the heap forms');
  }

  // One heap of each point.
  showPiles() {
    const made = this.study.points.filter((point) => this.piles.has(point.pile)), points = made.filter((point) => holds(this.piles.get(point.pile)));
    if (!made.length) return;
    const host = folded(this.host, 'A heap of each point', false);
    if (points.length < made.length) element('p', `The heaps of ${whole(made.length - points.length)} points are not in this page, which would grow too large.`, host, { class: 'soft' });
    const group = element('div', null, host, { role: 'group', 'aria-label': 'Points', class: 'points' }), player = points.length ? new PilePlayer(element('div', null, host), { label: 'The heap of the point in 3D' }) : null;
    if (!player?.view) return group.remove();
    const pick = (index) => {
      buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(i === index)));
      player.show(new Pile(this.piles.get(points[index].pile)));
    };
    const buttons = points.map((point, i) => {
      const button = element('button', point.label || String(point.rp), group, { type: 'button' });
      button.addEventListener('click', () => pick(i));
      return button;
    });
    host.addEventListener('toggle', () => host.open && !player.pile && pick(points.length - 1));
  }

  tables() {
    const { study } = this, host = folded(this.host, 'All points', false), unit = (a) => `${a.title}${a.unit ? ` / ${a.unit === 'deg' ? '°' : a.unit}` : ''}`;
    table(host, [
      { head: 'point', value: (p) => p.label || p.rp || study.name }, { head: 'shapes', value: (p) => p.shapes }, { head: 'triangles', value: (p) => p.triangle_count, text: (p) => (known(p.triangle_count) ? whole(Math.round(p.triangle_count)) : '–') },
      { head: 'runs done', value: (p) => p.runs.done }, { head: 'failed', value: (p) => p.runs.failed },
      ...this.answers.flatMap((a) => [
        { head: unit(a), value: (p) => a.get(p).mean, text: (p) => number(a.get(p).mean, 5) }, { head: 'low', value: (p) => (alike(a.get(p)) ? null : a.get(p).mean_low), text: (p) => number(alike(a.get(p)) ? null : a.get(p).mean_low, 5) },
        { head: 'high', value: (p) => (alike(a.get(p)) ? null : a.get(p).mean_high), text: (p) => number(alike(a.get(p)) ? null : a.get(p).mean_high, 5) }, { head: 'sd', value: (p) => a.get(p).sd, text: (p) => sdText(a.get(p)) },
      ]),
      ...['height', 'packing_fraction', 'coordination', 'seconds'].map((key) => ({ head: words(key), value: (p) => p[key]?.mean, text: (p) => number(p[key]?.mean) })),
    ], study.points, `${study.name}-points.csv`, 'Results at every point of the study');
    const compared = study.families.flatMap((f) => f.against_finest.map((c) => ({ ...c, family: f.label, finest: f.finest })));
    if (compared.length) table(host, [
      { head: 'level', value: (c) => `${c.family ? `${c.family}: ` : ''}${c.rp}` }, { head: 'finest', value: (c) => c.finest }, ...['difference', 'low', 'high'].map((key) => ({ head: `${key} / °`, value: (c) => c[key], text: (c) => number(c[key], 3) })),
      { head: 'verdict', value: (c) => (c.equivalent ? 'the same within the margin' : c.different ? 'different' : 'cannot be told yet') }, { head: 'runs needed', value: (c) => c.count_needed, text: (c) => (c.count_needed ? whole(c.count_needed) : '–') },
    ], compared, `${study.name}-comparisons.csv`, 'Each level against the finest');
    if (study.failures.length) table(host, [{ head: 'point', value: (f) => f.label }, { head: 'replicate', value: (f) => f.replicate }, { head: 'reason', value: (f) => f.reason }], study.failures, `${study.name}-failures.csv`, 'Runs that failed').classList.add('texts');
  }
}
