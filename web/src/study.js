// The section of a study (study.json, docs/reference/formats.md): what the runs say, each curve with its spread, the tables.
import { Chart, palette } from './chart.js';
import { effects } from './effects.js';
import { holds } from './packed.js';
import { Pile, PilePlayer } from './pile.js';
import { counted, element, number, rpText, table, whole } from './text.js';

// Rp as a number: the scan itself is 1, spheres have none.
const rpOf = (point) => (point.rp === 'scan' ? 1 : point.rp === 'spheres' ? NaN : Number(point.rp));
const deviations = 'one standard deviation to either side of the mean';
const known = (x) => x !== null && x !== undefined && Number.isFinite(x);
// Replicates that are all alike have no interval: their scatter is not zero but was not seen.
const alike = (s) => s.count > 1 && s.sd === 0;
const spread = (s, low, high) => (alike(s) ? { low: null, high: null } : { low: s[low], high: s[high] });
const sdText = (s, digits) => (alike(s) ? 'all alike' : number(s.sd, digits));
const rpName = (rp) => (Number(rp) > 0 ? `Rp = ${rpText(Number(rp))}` : `the ${rp}`);

export class StudySection {
  constructor(host, { study, piles }) {
    Object.assign(this, { host, study, piles: new Map(piles) });
    this.along = this.axis();
    this.families = new Map();
    for (const point of study.points) {
      const family = point.label.split(', ').filter((part) => !part.startsWith(`${this.along?.key} `)).join(', ');
      if (!this.families.has(family)) this.families.set(family, []);
      this.families.get(family).push(point);
    }
    for (const points of this.families.values()) points.sort((a, b) => this.along?.of(a) - this.along?.of(b));
    this.answers = Object.keys(study.points[0]?.answers ?? {});
    if (this.answers.length) {
      this.tellAnswers();
      return;
    }
    this.tell();
    this.drawAngles();
    this.drawRotation();
    this.drawTimes();
    this.showPiles();
    this.tellTables();
  }

  // What the charts run along: Rp where that varied, else the first factor of numbers that did; null where none did.
  axis() {
    const { points } = this.study;
    const varied = (of) => new Set(points.map(of).filter(Number.isFinite)).size > 1;
    if (varied(rpOf)) return { key: 'rp', label: 'Rp', of: rpOf, log: true, text: (v) => v.toExponential(1) };
    const key = Object.keys(points[0]?.factors ?? {}).find((name) => varied(({ factors }) => factors[name]));
    return key ? { key, label: key, of: ({ factors }) => factors[key], log: false, text: (v) => number(v, 4) } : null;
  }

  // Of a scene: a chart and a table for each answer.
  tellAnswers() {
    const { host, study } = this;
    element('h1', `Study ${study.name}`, host);
    element('p', `${whole(study.runs.done)} of ${counted(study.points.length * study.replicates, 'run')} are done; ${counted(study.replicates, 'replicate')} a point. Intervals are of ${number(100 * study.confidence)} % confidence.`, host, { class: 'soft' });
    for (const answer of this.answers) {
      const get = (p) => p.answers[answer];
      const unit = study.units?.[answer], named = unit ? `${answer} / ${unit}` : answer;
      element('h2', named, host);
      this.against(null, named, (p) => ({ value: get(p).mean, ...spread(get(p), 'mean_low', 'mean_high') }), 'the interval of the mean');
      table(host, [
        { head: 'point', value: (p) => p.label || study.name }, { head: 'runs done', value: (p) => p.runs.done },
        { head: 'mean', value: (p) => get(p).mean, text: (p) => number(get(p).mean, 5) },
        ...[['low', 'mean_low'], ['high', 'mean_high']].map(([head, key]) => ({ head, value: (p) => (alike(get(p)) ? null : get(p)[key]), text: (p) => number(alike(get(p)) ? null : get(p)[key], 5) })),
        { head: 'sd', value: (p) => get(p).sd, text: (p) => sdText(get(p), 5) }, { head: 'CV', value: (p) => get(p).cv, text: (p) => number(get(p).cv, 5) },
      ], study.points, `${study.name}-${answer}.csv`, named);
      this.tellEffects(named, get);
    }
  }

  // What each factor does to an answer, where several varied.
  tellEffects(what, get) {
    const found = effects(this.study.points, get);
    if (!found.length) return;
    element('p', `How much ${what} grows from one end of a factor to the other, the others at their middle:`, this.host, { class: 'soft' });
    table(this.host, [
      { head: 'factor', value: (e) => e.name },
      { head: 'from', value: (e) => e.from, text: (e) => (typeof e.from === 'number' ? number(e.from) : e.from) },
      { head: 'to', value: (e) => e.to, text: (e) => (typeof e.to === 'number' ? number(e.to) : e.to) },
      { head: 'effect', value: (e) => e.effect, text: (e) => number(e.effect, 3) },
      { head: 'standard error', value: (e) => e.error, text: (e) => number(e.error, 2) },
    ], found, `${this.study.name}-effects.csv`, `Effects on ${what}`);
  }

  // One heap of each point.
  showPiles() {
    const made = this.study.points.filter((point) => this.piles.has(point.pile));
    const points = made.filter((point) => holds(this.piles.get(point.pile)));
    if (!made.length) return;
    element('h2', 'A heap of each point', this.host);
    if (points.length < made.length) element('p', `The heaps of ${whole(made.length - points.length)} points are not in this page, which would grow too large.`, this.host, { class: 'soft' });
    if (!points.length) return;
    const group = element('div', null, this.host, { role: 'group', 'aria-label': 'Points', class: 'points' });
    const player = new PilePlayer(element('div', null, this.host), { label: 'The heap of the point in 3D' });
    if (!player.view) {
      group.remove();
      return;
    }
    const pick = (index) => {
      buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(i === index)));
      player.show(new Pile(this.piles.get(points[index].pile)));
    };
    const buttons = points.map((point, i) => {
      const button = element('button', point.label || rpName(point.rp), group, { type: 'button' });
      button.addEventListener('click', () => pick(i));
      return button;
    });
    pick(points.length - 1);
  }

  tell() {
    const { host, study } = this;
    const { runs } = study;
    const all = runs.done + runs.failed + runs.running + runs.leased + runs.waiting;
    element('h1', `Study ${study.name}: ${this.along && this.along.key !== 'rp' ? `the heap against ${this.along.label}` : 'how many triangles does the heap need?'}`, host);
    const answers = study.families.map((f) => {
      const what = f.label ? `${f.label}: ` : '', start = f.label ? ['from', 'the'] : ['From', 'The'];
      return f.converged
        ? `${what}${start[0]} ${rpName(f.converged_from)} on the angle of repose is that of ${rpName(f.finest)}, within ${number(study.margin_deg)}°.`
        : `${what}${start[1]} runs done do not show at any level that the angle of repose is that of ${rpName(f.finest)} within ${number(study.margin_deg)}°.`;
    });
    if (answers.length || this.along?.key === 'rp' || !this.along) element('p', answers.join(' ') || 'There are not two levels with heaps to compare.', host, { class: 'answer' });
    element('p', `${whole(runs.done)} of ${counted(all, 'run')} ${all === 1 ? 'is' : 'are'} done${runs.failed ? `, ${whole(runs.failed)} failed` : ''}; ${counted(study.replicates, 'replicate')} a point. Intervals are of ${number(100 * study.confidence)} % confidence. Angle measured: ${study.angle}.${study.mixed_versions ? ' The runs come from different versions of scree.' : ''}`, host, { class: 'soft' });
  }

  // One chart along the axis: a series for each family. get(point): {value, low, high} or null; bars: what low and high are.
  against(title, yLabel, get, bars, { logY = false, extra = () => [] } = {}) {
    const { along } = this;
    if (!along) return;
    const xs = [...new Set([...this.families.values()].flat().map(along.of).filter((x) => Number.isFinite(x) && (x > 0 || !along.log)))].sort((a, b) => a - b);
    const text = (v) => number(v, 4);
    const series = [...this.families].map(([name, points], i) => {
      const at = xs.map((x) => points.find((point) => along.of(point) === x)).map((point) => (point ? get(point) : null));
      const column = (key) => at.map((v) => (v && known(v[key]) ? v[key] : null));
      return {
        label: name || title || yLabel, values: column('value'), color: palette[i % palette.length], width: 2, points: true, text,
        ...(at.some((v) => v && known(v.low)) ? { low: column('low'), high: column('high') } : {}),
      };
    });
    const all = [...series, ...extra(xs)];
    if (!xs.length || !series.some((s) => s.values.some(known))) return;
    if (title) element('h2', `${title} against ${along.label}`, this.host);
    new Chart(element('div', null, this.host, { class: 'chart' }), {
      x: { label: along.label, values: xs, text: along.text }, yLabel, logX: along.log, logY, series: all,
    });
    if (series.some((s) => s.low?.some(known))) element('p', `Bars: ${bars}.`, this.host, { class: 'soft' });
  }

  drawAngles() {
    this.against('Angle of repose', 'angle / °', ({ angle_deg: a }) => (known(a.mean)
      ? { value: a.mean, ...(a.sd > 0 ? { low: a.mean - a.sd, high: a.mean + a.sd } : {}) } : null), deviations);
    for (const [name, points] of this.families) {
      const spheres = points.find((point) => point.rp === 'spheres' && known(point.angle_deg.mean));
      if (spheres) element('p', `${name ? `${name}: ` : ''}spheres of the same volumes, which have no Rp: ${number(spheres.angle_deg.mean)} ± ${number(spheres.angle_deg.sd)}°.`, this.host, { class: 'soft' });
    }
    this.against('Its coefficient of variation', 'CV / %', ({ angle_deg: a }) => (known(a.cv)
      ? { value: 100 * a.cv, low: known(a.sd_low) ? (100 * a.sd_low) / Math.abs(a.mean) : null, high: known(a.sd_high) ? (100 * a.sd_high) / Math.abs(a.mean) : null } : null), `the interval of ${number(100 * this.study.confidence)} % confidence of the standard deviation, over the mean`);
  }

  drawRotation() {
    const drawn = this.study.points.filter((point) => point.rotation.time.length > 1).slice(0, 8);
    if (!drawn.length) return;
    element('h2', 'Rotational velocity against time', this.host);
    const times = [...new Set(drawn.flatMap((point) => point.rotation.time))].sort((a, b) => a - b);
    const dashes = [undefined, [6, 3], [2, 2]];
    new Chart(element('div', null, this.host, { class: 'chart' }), {
      x: { label: 'time since the cylinder began to rise / s', values: times, text: (v) => number(v, 4) }, yLabel: 'mean |ω| / (rad/s)', logX: false, logY: false,
      series: drawn.map((point, i) => {
        const at = new Map(point.rotation.time.map((t, k) => [t, point.rotation.mean[k]]));
        return { label: point.label || point.rp, values: times.map((t) => at.get(t) ?? null), color: palette[i % palette.length], dash: dashes[Math.floor(i / palette.length)], text: (v) => number(v, 3) };
      }),
    });
    if (this.study.points.length > drawn.length) element('p', `The first ${drawn.length} points are drawn.`, this.host, { class: 'soft' });
  }

  drawTimes() {
    const { study } = this;
    const laws = this.along?.key === 'rp' ? study.families.filter((f) => f.time_law.count && known(f.time_law.exponent)) : [];
    const extra = (xs) => laws.map((f, i) => ({
      label: `${f.label ? `${f.label}: ` : ''}fit, Rp^${number(f.time_law.exponent, 2)}`, values: xs.map((x) => f.time_law.factor * x ** f.time_law.exponent),
      color: palette[(i + this.families.size) % palette.length], dash: [6, 4], text: (v) => number(v, 3),
    }));
    this.against('Computation time of a run', 'time / s', ({ seconds: s }) => (known(s.mean)
      ? { value: s.mean, low: known(s.sd) && s.sd < s.mean ? s.mean - s.sd : null, high: known(s.sd) && s.sd < s.mean ? s.mean + s.sd : null } : null), deviations, { logY: true, extra });
    for (const f of laws) {
      const { exponent, exponent_low: low, exponent_high: high, r2, factor } = f.time_law;
      element('p', `${f.label ? `${f.label}: ` : ''}time = ${number(factor, 3)} s Rp^${number(exponent, 3)}${known(low) ? ` (exponent ${number(low, 3)} to ${number(high, 3)})` : ''}, R² of the logarithms ${number(r2, 3)}.`, this.host, { class: 'soft' });
    }
  }

  tellTables() {
    const { host, study } = this;
    const summary = (key, head, digits = 4) => [
      { head, value: (p) => p[key].mean, text: (p) => number(p[key].mean, digits) },
      { head: `${head}: sd`, value: (p) => p[key].sd, text: (p) => sdText(p[key], 3) },
    ];
    element('h2', 'Every point', host);
    table(host, [
      { head: 'point', value: (p) => p.label || p.rp },
      { head: 'shapes', value: (p) => p.shapes },
      { head: 'Rp', value: (p) => p.rp },
      { head: 'triangles', value: (p) => p.triangle_count, text: (p) => (known(p.triangle_count) ? whole(Math.round(p.triangle_count)) : '–') },
      { head: 'runs done', value: (p) => p.runs.done },
      { head: 'failed', value: (p) => p.runs.failed },
      ...summary('angle_deg', 'angle / °'),
      { head: 'angle: CV', value: (p) => p.angle_deg.cv, text: (p) => (known(p.angle_deg.cv) ? `${number(100 * p.angle_deg.cv, 2)} %` : '–') },
      ...summary('height', 'height / m'), ...summary('packing_fraction', 'packing'), ...summary('coordination', 'coordination'), ...summary('seconds', 'time / s', 3),
    ], study.points, `${study.name}-points.csv`, 'Results at every point of the study');
    this.tellEffects('the angle / °', (p) => p.angle_deg);
    const compared = study.families.flatMap((f) => f.against_finest.map((c) => ({ ...c, family: f.label, finest: f.finest })));
    if (compared.length) {
      element('h2', 'Against the finest level', host);
      table(host, [
        { head: 'level', value: (c) => `${c.family ? `${c.family}: ` : ''}${c.rp}` },
        { head: 'finest', value: (c) => c.finest },
        { head: 'difference / °', value: (c) => c.difference, text: (c) => number(c.difference, 3) },
        { head: 'low', value: (c) => c.low, text: (c) => number(c.low, 3) },
        { head: 'high', value: (c) => c.high, text: (c) => number(c.high, 3) },
        { head: 'verdict', value: (c) => (c.equivalent ? 'the same within the margin' : c.different ? 'different' : 'cannot be told yet') },
        { head: 'runs needed', value: (c) => c.count_needed, text: (c) => (c.count_needed ? whole(c.count_needed) : '–') },
      ], compared, `${study.name}-comparisons.csv`, 'Each level against the finest');
    }
    if (study.failures.length) {
      element('h2', 'Runs that failed', host);
      table(host, [
        { head: 'point', value: (f) => f.label }, { head: 'replicate', value: (f) => f.replicate }, { head: 'reason', value: (f) => f.reason },
      ], study.failures, `${study.name}-failures.csv`, 'Runs that failed').classList.add('texts');
    }
  }
}
