// Curves on logarithmic axes through uPlot, with marks, and redrawn for print in dark on white.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { ticks } from './text.js';

let printing = false;
const charts = new Set();

const color = (name) => (printing ? { '--ink': '#1c1c22', '--rule': '#d9d9de' }[name] : getComputedStyle(document.body).getPropertyValue(name).trim());
const ink = () => color('--ink');
const rule = () => color('--rule');

// Okabe and Ito's, and two more, on light and on dark paper.
const dark = matchMedia('(prefers-color-scheme: dark)');
const shade = (light, other) => () => (dark.matches && !printing ? other : light);
export const palette = [shade('#0072b2', '#56b4e9'), shade('#d55e00', '#e69f00'), shade('#009e73', '#1fc79a'), shade('#b0578d', '#e3a0c6'), shade('#857400', '#f0e442'), shade('#55555f', '#c9c9d3')];

// A piece of a line as a background: its dashes and gaps, from left to right.
function lineImage(color, dash) {
  if (!dash) return color;
  let at = 0;
  const stops = dash.map((length, i) => `${i % 2 ? 'transparent' : color} ${at}px ${at += length}px`);
  return `repeating-linear-gradient(90deg, ${stops.join(', ')})`;
}

const raised = (n) => [...String(n)].map((c) => (c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c])).join('');
const exponentOf = (v) => Math.floor(Math.log10(v) + 1e-9);
const digitOf = (v) => Math.round(v / 10 ** exponentOf(v));
const power = (v) => `${digitOf(v) > 1 ? `${digitOf(v)}·` : ''}10${raised(exponentOf(v))}`;
// Of the ticks of a logarithmic axis those with a label and a line: powers of ten, and where fewer than two are in
// sight, more digits.
const major = (at) => [[1], [1, 2, 5]].map((digits) => at.map((v) => (digits.includes(digitOf(v)) ? v : null)))
  .find((some) => some.filter((v) => v !== null).length > 1) ?? at;

export class Chart {
  // yLeast: lower end of the axis, where data go below. series: [{label, values, color, dash, width, text(v),
  // low, high: ends of error bars, points: bool}]; marks(): [{x, color, dash, label}]; pick(index): a click.
  constructor(host, { x, series, marks, pick, yLabel, yLeast, logY = true, logX = true }) {
    Object.assign(this, { host, x, series, marks, pick, yLabel, yLeast, logX, logY });
    charts.add(this);
    this.draw();
  }

  draw() {
    const { host, x, series } = this;
    host.replaceChildren();
    const axis = (label, log) => ({
      label, stroke: ink, ticks: { stroke: rule }, labelSize: 24,
      grid: { stroke: rule, width: 1, ...(log ? { filter: (_, at) => major(at) } : {}) },
      ...(log ? { values: (_, at) => major(at).map((v) => (v === null ? '' : power(v))) } : { values: (_, at) => ticks(at) }),
    });
    const options = {
      width: Math.max(260, host.clientWidth), height: 340,
      cursor: { drag: { x: false, y: false } },
      legend: { markers: { width: 0, fill: (_, i) => lineImage(series[i - 1].color(), series[i - 1].dash) } },
      scales: { x: { time: false, distr: this.logX ? 3 : 1 }, y: { distr: this.logY ? 3 : 1, ...(this.logY ? {} : { range: () => this.span() }), ...(this.yLeast ? { range: (_, low, high) => uPlot.rangeLog(Math.max(low, this.yLeast), high, 10, true) } : {}) } },
      axes: [axis(x.label, this.logX), { ...axis(this.yLabel, this.logY), size: (_, at) => 26 + 7 * Math.max(4, ...(at ?? []).map((text) => String(text ?? '').length)) }],
      series: [{ label: x.label, value: (_, v) => (v === null ? '' : `: ${x.text(v)}`) }, ...series.map((s) => ({
        label: s.label, stroke: s.color, width: s.width ?? 1.5, dash: s.dash, spanGaps: true, points: { show: s.points ?? false },
        value: (_, v) => (v === null ? '' : `: ${s.text(v)}`),
      }))],
      hooks: { draw: [(plot) => this.drawBars(plot), (plot) => this.drawMarks(plot)] },
    };
    const positive = (v) => (v > 0 || !this.logY ? v : null);
    this.plot = new uPlot(options, [x.values, ...series.map((s) => s.values.map(positive))], host);
    this.plot.over.addEventListener('click', () => {
      if (this.plot.cursor.idx !== null && this.plot.cursor.idx !== undefined) this.pick?.(this.plot.cursor.idx);
    });
  }

  // The values with their bars, where the axis is linear.
  span() {
    const all = this.series.flatMap((s) => [s.values, s.low ?? [], s.high ?? []].flat()).filter((v) => v !== null && Number.isFinite(v));
    const low = Math.min(...all), high = Math.max(...all), room = (high - low || Math.abs(high) || 1) * 0.08;
    return low >= 0 ? [Math.max(0, low - room), high + room] : [low - room, high + room];
  }

  drawBars(plot) {
    const { ctx } = plot;
    const cap = 4 * devicePixelRatio;
    for (const s of this.series) {
      if (!s.low) continue;
      ctx.save();
      ctx.strokeStyle = s.color();
      ctx.lineWidth = 1.5 * devicePixelRatio;
      ctx.beginPath();
      this.x.values.forEach((x, i) => {
        if (!Number.isFinite(s.low[i] ?? NaN) || !Number.isFinite(s.high[i] ?? NaN) || (this.logX && !(x > 0))) return;
        const at = plot.valToPos(x, 'x', true);
        const [from, to] = [s.low[i], s.high[i]].map((v) => plot.valToPos(v, 'y', true));
        ctx.moveTo(at, from);
        ctx.lineTo(at, to);
        for (const end of [from, to]) {
          ctx.moveTo(at - cap, end);
          ctx.lineTo(at + cap, end);
        }
      });
      ctx.stroke();
      ctx.restore();
    }
  }

  drawMarks(plot) {
    const { ctx, bbox } = plot;
    const labels = []; // where they lie, so that none lies on another
    for (const mark of this.marks?.() ?? []) {
      const at = Math.round(plot.valToPos(mark.x, 'x', true));
      if (!(at >= bbox.left && at <= bbox.left + bbox.width)) continue;
      ctx.save();
      ctx.strokeStyle = ctx.fillStyle = (mark.color ?? ink)();
      ctx.lineWidth = 2 * devicePixelRatio;
      ctx.setLineDash((mark.dash ?? []).map((d) => d * devicePixelRatio));
      ctx.beginPath();
      ctx.moveTo(at, bbox.top);
      ctx.lineTo(at, bbox.top + bbox.height);
      ctx.stroke();
      if (mark.label) {
        const right = at > bbox.left + bbox.width / 2;
        ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
        ctx.textAlign = right ? 'right' : 'left';
        const width = ctx.measureText(mark.label).width, from = right ? at - 6 * devicePixelRatio - width : at + 6 * devicePixelRatio;
        let row = 0;
        while (labels.some((other) => other.row === row && other.from < from + width && from < other.to)) row++;
        labels.push({ row, from, to: from + width });
        ctx.fillText(mark.label, at + (right ? -6 : 6) * devicePixelRatio, bbox.top + (14 + 16 * row) * devicePixelRatio);
      }
      ctx.restore();
    }
  }

  redraw() {
    this.plot.redraw(false);
  }

  remove() {
    charts.delete(this);
    this.plot.destroy();
  }
}

const drawAll = () => charts.forEach((chart) => chart.draw());
addEventListener('beforeprint', () => {
  printing = true;
  drawAll();
});
addEventListener('afterprint', () => {
  printing = false;
  drawAll();
});
let resizing;
addEventListener('resize', () => {
  clearTimeout(resizing);
  resizing = setTimeout(drawAll, 150);
});
dark.addEventListener('change', drawAll);
document.addEventListener('toggle', drawAll, true); // what was folded had no width
