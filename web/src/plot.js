// Charts as SVG in the page's colours: axes, marks, and a pointer that all charts of a section share.
import { element, known, number, ticks } from './text.js';

export function svg(tag, parent, attributes = {}, text) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  parent?.append(made);
  return made;
}

// What is pointed at in any chart is marked in all: a place on the axis of a group, or what has a key.
export class Pointer {
  plots = [];
  marks = new Map();

  show(group, x) {
    for (const plot of this.plots) if (plot.group === group) plot.point(x);
  }

  light(key) {
    for (const { drawn, plot } of this.marks.get(this.lit) ?? []) {
      drawn.classList.remove('on');
      plot.say(null);
    }
    this.lit = key;
    for (const { drawn, plot, told } of this.marks.get(key) ?? []) {
      drawn.classList.add('on');
      if (told) plot.say(told);
    }
  }
}

// From the least to the greatest, with some room.
export function span(values, room = 0.08) {
  const all = values.filter(known), low = Math.min(...all), high = Math.max(...all);
  const more = (high - low || Math.abs(high) || 1) * room;
  return all.length ? [low >= 0 && low < more ? 0 : low - more, high + more] : [0, 1];
}

// Of values with bars: bars that reach beyond three times the values' own span are cut.
export function spanWithBars(values, lows, highs) {
  const [low, high] = span(values), [least, most] = span([...values, ...lows, ...highs]);
  return [Math.max(least, low - (high - low)), Math.min(most, high + (high - low))];
}

function stepsOf([low, high], count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((n) => n * power >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(10)));
}

// Powers of ten, or where fewer than two are in sight, more digits.
function decadesOf([low, high]) {
  const all = (digits) => Array.from({ length: Math.ceil(Math.log10(high)) - Math.floor(Math.log10(low)) + 1 }, (_, i) => 10 ** (Math.floor(Math.log10(low)) + i)).flatMap((p) => digits.map((d) => Number((d * p).toPrecision(6)))).filter((v) => v >= low * 0.999 && v <= high * 1.001);
  const found = [[1], [1, 2, 5]].map(all).find((at) => at.length > 1) ?? [low, high];
  return found.filter((_, i) => i % Math.ceil(found.length / 7) === 0);
}

const round = (v) => Number(v.toFixed(1));

export class Plot {
  // x, y: [low, high]; xl, yl: what the axes are; xt: [value, text] of each tick; label: what is seen, for who does not see it.
  constructor(pointer, { w = 420, h = 250, l = 54, r = 14, t = 12, b = 42, x, y, xl = '', yl = '', xlog = false, ylog = false, xt, nox = false, noy = false, label = '' }) {
    Object.assign(this, { pointer, w, h, l, r, t, b, x, y, xl, ends: [], series: [], keys: [] });
    const place = ([low, high], from, to, log) => (log ? (v) => round(from + (Math.log(v / low) / Math.log(high / low)) * (to - from)) : (v) => round(from + ((v - low) / (high - low || 1)) * (to - from)));
    this.X = place(x, l, w - r, xlog);
    this.Y = place(y, h - b, t, ylog);
    this.xlog = xlog;
    this.svg = svg('svg', null, { class: 'plot', viewBox: `0 0 ${w} ${h}`, role: 'img', 'aria-label': label || `${yl} against ${xl}` });
    const at = (range, log, count) => (log ? decadesOf(range) : stepsOf(range, count));
    const texts = (values, log) => (log ? values.map((v) => number(v, 3)) : ticks(values));
    const xs = nox ? [] : xt?.map(([v]) => v) ?? at(x, xlog, 5), ys = noy ? [] : at(y, ylog, 5);
    const words = xt?.map(([, text]) => text) ?? texts(xs, xlog);
    xs.forEach((v, i) => {
      svg('line', this.svg, { class: 'g', x1: this.X(v), x2: this.X(v), y1: t, y2: h - b });
      svg('text', this.svg, { class: 'tk', x: this.X(v), y: h - b + 16, 'text-anchor': 'middle' }, words[i]);
    });
    texts(ys, ylog).forEach((text, i) => {
      svg('line', this.svg, { class: 'g', x1: l, x2: w - r, y1: this.Y(ys[i]), y2: this.Y(ys[i]) });
      svg('text', this.svg, { class: 'tk', x: l - 6, y: this.Y(ys[i]) + 4, 'text-anchor': 'end' }, text);
    });
    svg('path', this.svg, { class: 'ax', d: noy ? `M${l} ${h - b}H${w - r}` : `M${l} ${t}V${h - b}H${w - r}` });
    if (xl) svg('text', this.svg, { class: 'lb', x: (l + w - r) / 2, y: h - 6, 'text-anchor': 'middle' }, xl);
    if (yl) svg('text', this.svg, { class: 'lb', transform: `translate(12 ${(t + h - b) / 2}) rotate(-90)`, 'text-anchor': 'middle' }, yl);
    this.inside = svg('svg', this.svg, { x: l, y: t - 6, width: w - l - r + 6, height: h - b - t + 12, viewBox: `${l} ${t - 6} ${w - l - r + 6} ${h - b - t + 12}` }); // lines end at the rim
    pointer.plots.push(this);
  }

  path(cls, d, more = {}, host = this.inside) {
    return svg('path', host, { class: cls, d, ...more });
  }

  line(xs, ys, cls, dash) {
    let d = '', pen = false;
    xs.forEach((x, i) => {
      if (known(ys[i])) d += `${pen ? 'L' : 'M'}${this.X(x)} ${this.Y(ys[i])}`;
      pen = known(ys[i]) || (pen && ys[i] === null); // null: not read at this moment
    });
    this.path(`ln ${cls}`, d, dash ? { 'stroke-dasharray': dash } : {});
    return this;
  }

  area(xs, low, high, cls) {
    const edge = (ys) => xs.map((x, i) => `${this.X(x)} ${this.Y(ys[i])}`);
    this.path(`ar ${cls}`, `M${edge(high).join('L')}L${edge(low).reverse().join('L')}Z`);
    return this;
  }

  box(x0, x1, y0, y1, cls) {
    svg('rect', this.inside, { class: `ar ${cls}`, x: Math.min(x0, x1), y: Math.min(y0, y1), width: Math.abs(x1 - x0), height: Math.abs(y1 - y0) });
    return this;
  }
  xband(a, b, cls) { return this.box(this.X(a), this.X(b), this.t, this.h - this.b, cls); }
  yband(a, b, cls) { return this.box(this.l, this.w - this.r, this.Y(a), this.Y(b), cls); }
  vline(v, cls, dash = 'none') { this.path(`ln ${cls}`, `M${this.X(v)} ${this.t}V${this.h - this.b}`, { 'stroke-dasharray': dash }); return this; }
  hline(v, cls, dash = 'none') { this.path(`ln ${cls}`, `M${this.l} ${this.Y(v)}H${this.w - this.r}`, { 'stroke-dasharray': dash }); return this; }

  // At pixels; key and told: what is marked with it in other charts, and said below this one.
  mark(x, y, cls, { r = 3.4, shape = 'dot', key, told } = {}) {
    const d = { dot: `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`, square: `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}Z`, diamond: `M${x} ${y - 1.3 * r}l${1.3 * r} ${1.3 * r}l${-1.3 * r} ${1.3 * r}l${-1.3 * r} ${-1.3 * r}Z`, cross: `M${x - r} ${y - r}l${2 * r} ${2 * r}m0 ${-2 * r}l${-2 * r} ${2 * r}` }[shape];
    const drawn = this.path(`${shape === 'cross' ? 'xx' : 'pt'} ${cls}`, d, {}, this.svg);
    if (key === undefined) return this;
    const { marks } = this.pointer;
    if (!marks.has(key)) marks.set(key, []);
    marks.get(key).push({ drawn, plot: this, told });
    this.keys.push({ key, x });
    drawn.addEventListener('pointerenter', () => this.pointer.light(key));
    drawn.addEventListener('pointerleave', () => this.pointer.light(null));
    return this;
  }
  dot(x, y, cls, how) { return this.mark(this.X(x), this.Y(y), cls, how); }

  // What reaches out of the chart ends in an arrow.
  ebar(x, low, high, cls) {
    const at = this.X(x), [least, most] = this.y;
    const end = (v, limit, out) => (out ? `M${at - 4} ${this.Y(limit) + (limit === most ? 6 : -6)}L${at} ${this.Y(limit)}L${at + 4} ${this.Y(limit) + (limit === most ? 6 : -6)}` : `M${at - 4} ${this.Y(v)}h8`);
    this.cut = this.cut || low < least || high > most;
    this.path(`ln ${cls}`, `M${at} ${this.Y(Math.max(low, least))}V${this.Y(Math.min(high, most))}${end(low, least, low < least)}${end(high, most, high > most)}`);
    return this;
  }
  // y in pixels
  hbar(y, low, high, cls, cap = 5) {
    this.path(`ln ${cls}`, `M${this.X(low)} ${y}H${this.X(high)}M${this.X(low)} ${y - cap}v${2 * cap}M${this.X(high)} ${y - cap}v${2 * cap}`);
    return this;
  }
  // At pixels.
  at(x, y, text, cls = '', anchor = 'start') {
    svg('text', this.svg, { class: cls, x, y, 'text-anchor': anchor }, text);
    return this;
  }
  text(x, y, text, cls, anchor, dx = 0, dy = 0) { return this.at(this.X(x) + dx, this.Y(y) + dy, text, cls, anchor); }

  // The name of a line, beside its end; they are kept apart when all are there.
  end(y, text, cls) {
    if (known(y)) this.ends.push({ at: Math.min(this.h - this.b, Math.max(this.t + 8, this.Y(y) + 4)), text, cls });
    return this;
  }
  nameEnds() {
    const all = this.ends.sort((a, b) => a.at - b.at);
    all.forEach((end, i) => { if (i && end.at < all[i - 1].at + 14) end.at = all[i - 1].at + 14; });
    const over = Math.max(0, (all.at(-1)?.at ?? 0) - (this.h - this.b + 4));
    all.forEach(({ at, text, cls }) => this.at(this.w - this.r + 6, at - over, text, `b ${cls}`));
  }

  // The charts of a group show the same x; series: [{name, values, unit}]
  follow(group, xs, series, { name = '', unit = '', digits = 4, pick, text = (x) => number(x, 4) } = {}) {
    Object.assign(this, { group, xs, series, how: { name, unit, digits, pick, text } });
    return this;
  }

  point(x) {
    this.cursor?.remove();
    if (x === null) return this.say(null);
    const off = (i) => Math.abs(this.X(this.xs[i]) - this.X(x));
    let best = 0;
    for (let i = 1; i < this.xs.length; i++) if (off(i) < off(best)) best = i;
    this.index = best;
    this.cursor = svg('line', this.svg, { class: 'cur', x1: this.X(this.xs[best]), x2: this.X(this.xs[best]), y1: this.t, y2: this.h - this.b });
    const { name, unit, digits, text } = this.how;
    const seen = this.series.map((s) => ({ ...s, value: s.values.slice(0, best + 1).findLast(known) })).filter((s) => known(s.value));
    return this.say(`${name} ${text(this.xs[best])}${unit}: ${seen.map((s) => `${s.name ? `${s.name} ` : ''}${number(s.value, digits)}${s.unit ?? ''}`).join(', ')}`.trim());
  }

  say(text) {
    if (!this.note) return;
    this.note.textContent = text ?? this.said;
    this.note.classList.toggle('live', text !== null);
  }

  // Under its title in the grid; said: what stands below while nothing is pointed at.
  put(host, title, said = '') {
    const card = element('figure', null, host, { class: 'card' });
    if (title) element('figcaption', title, card);
    this.nameEnds();
    card.append(this.svg);
    this.said = [said, this.cut ? 'Bars with an arrow reach out of the chart.' : ''].filter(Boolean).join(' ') || '\u00a0';
    this.note = element('p', this.said, card, { class: 'read' });
    if (this.group || this.keys.length) this.listen();
    return card;
  }

  listen() {
    const { pointer, svg: drawn, group } = this;
    drawn.setAttribute('tabindex', 0);
    this.keys.sort((a, b) => a.x - b.x);
    const valueAt = ({ clientX }) => {
      const box = drawn.getBoundingClientRect(), at = ((clientX - box.left) / box.width) * this.w;
      const share = Math.min(1, Math.max(0, (at - this.l) / (this.w - this.r - this.l))), [low, high] = this.x;
      return this.xlog ? low * (high / low) ** share : low + share * (high - low);
    };
    const away = () => (group ? pointer.show(group, null) : pointer.light(null));
    if (group) {
      for (const type of ['pointermove', 'pointerdown']) drawn.addEventListener(type, (event) => pointer.show(group, valueAt(event)));
      drawn.addEventListener('click', () => this.how.pick?.(this.index));
      drawn.addEventListener('pointerleave', away);
    }
    drawn.addEventListener('blur', away);
    drawn.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key], all = group ? this.xs : this.keys;
      if (!step) return;
      event.preventDefault();
      this.index = Math.min(all.length - 1, Math.max(0, (this.index ?? (step > 0 ? -1 : all.length)) + step));
      if (group) pointer.show(group, all[this.index]);
      else pointer.light(all[this.index].key);
    });
  }
}

// What marks and lines mean: [class, shape or dash, text].
export function legend(host, entries) {
  const all = element('p', null, host, { class: 'key' });
  for (const [cls, shape, text] of entries) {
    const item = element('span', null, all), sign = svg('svg', item, { width: 26, height: 12, 'aria-hidden': 'true' });
    if (shape === 'band') svg('rect', sign, { class: `ar ${cls}`, x: 1, y: 1, width: 24, height: 10 });
    else if (shape === 'dot') svg('circle', sign, { class: `pt ${cls}`, cx: 13, cy: 6, r: 4 });
    else if (shape === 'diamond') svg('path', sign, { class: `pt ${cls}`, d: 'M13 1L18 6L13 11L8 6Z' });
    else if (shape === 'square') svg('rect', sign, { class: `pt ${cls}`, x: 9, y: 2, width: 8, height: 8 });
    else svg('line', sign, { class: `ln ${cls}`, x1: 1, x2: 25, y1: 6, y2: 6, 'stroke-dasharray': shape });
    item.append(text);
  }
}
