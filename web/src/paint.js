// What bodies and walls are coloured by, and what the colours mean.
import { Color } from 'three';
import { shapeColor } from './pile.js';
import { element, number } from './text.js';
import { rampBar, rampTable, swatch } from './view.js';

const mostNames = 24; // that a legend has
const most = 20000; // numbers that a range is found of

// From 0, or the least where that is lower, to where the highest 2 % begin: single peaks would hide the rest.
function rangeOf(values, fromLeast) {
  const step = Math.ceil(values.length / most), some = [];
  for (let i = 0; i < values.length; i += step) if (values[i] !== 0) some.push(values[i]);
  some.sort((a, b) => a - b);
  const low = some[0] ?? 0, high = some[Math.floor(0.98 * (some.length - 1))] ?? 0;
  return { low: fromLeast ? low : Math.min(0, low), high, over: some.at(-1) > high };
}

// A colour of each number, along viridis.
function scale(name, unit, values, of, fromLeast = false) {
  const range = rangeOf(values, fromLeast), { low, high } = range;
  const table = rampTable();
  const color = (value) => table[Math.round(255 * Math.min(1, Math.max(0, high > low ? (value - low) / (high - low) : 0)))];
  return { name, unit, range, color: (...where) => color(of(...where)) };
}

function classes(name, names, of) {
  const colors = names.map((_, k) => new Color(shapeColor(k)));
  return { name, names, color: (body) => colors[of(body)] };
}

export const byShape = (pile) => classes('shape', pile.shapes.map(({ name }) => name), (body) => pile.shapeOf[body]);

// shapes: rows of result.json, in the order of the pile's.
export function bodyPaints(pile, shapes) {
  const families = [...new Set(shapes.map(({ family }) => family))];
  const sizes = shapes.map(({ size }) => 1000 * size);
  const paints = [byShape(pile)];
  if (pile.fragmentOf) {
    const fragments = Array.from({ length: 1 + pile.fragmentOf.reduce((a, b) => (b < 0xffffffff ? Math.max(a, b) : a), 0) }, (_, k) => `fragment ${k + 1}`);
    paints.unshift(classes('fragment', fragments, (body) => pile.fragmentOf[body] % fragments.length));
    const loads = pile.loadOf.map((load) => 100 * load);
    paints.push(scale('stress of joints at the end', '% of strength', loads, (body) => loads[body]));
  }
  if (families.length > 1 && families.length < shapes.length) paints.push(classes('class', families, (body) => families.indexOf(shapes[pile.shapeOf[body]].family)));
  if (pile.times.length > 1) {
    const speeds = [], ages = [];
    for (let i = 0, all = pile.bodyCount * pile.times.length, step = Math.ceil(all / most); i < all; i += step) {
      const body = Math.floor(i / pile.times.length), time = pile.times[i % pile.times.length];
      speeds.push(pile.speed(body, pile.momentAt(time)));
      ages.push(pile.age(body, time));
    }
    paints.push(scale('speed', 'm/s', speeds, (body, at) => pile.speed(body, at)));
    paints.push(scale('time since it came in', 's', ages, (body, at, time) => pile.age(body, time)));
  }
  if (new Set(sizes).size > 1) paints.push(scale('size', 'mm', sizes, (body) => sizes[pile.shapeOf[body]], true));
  return paints;
}

// Maps over the triangles of walls, by name; what nothing touched is grey.
export function wallPaints(pile) {
  const found = new Map();
  for (const { maps } of pile.walls) for (const { name, unit, values } of maps) found.set(name, { unit, values: [...(found.get(name)?.values ?? []), ...values] });
  const bare = new Color(0xb8bcc6);
  return [...found].filter(([, { values }]) => values.some((v) => v !== 0)).map(([name, { unit, values }]) => {
    const made = scale(name, unit, values, (v) => v), { color } = made;
    return { ...made, color: (v) => (v === 0 ? bare : color(v)) };
  });
}

export function tellPaint(host, { name, names, unit, range }) {
  if (names?.length > mostNames) {
    element('span', `${names.length} ${name}s`, host);
    return;
  }
  if (names) {
    names.forEach((text, k) => swatch(host, shapeColor(k), text));
    return;
  }
  const item = element('span', `${name} / ${unit}: ${number(range.low, 3)} `, host);
  rampBar(item);
  item.append(` ${number(range.high, 3)}${range.over ? ' and more' : ''}`);
}
