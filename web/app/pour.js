// The tab of pouring: particles fall into a container, a drum or a hopper while one looks on. The physics is the library's, in a worker.
import { Box3, Quaternion, Vector3 } from '../src/pile.js';
import { Cancelled, Engine } from './engine.js';
import { equipment } from './equipment.js';
import { PileView, setShapeColors, shapeColor } from '../src/pile.js';
import { swatch } from '../src/view.js';
import { counted, element, number, whole } from '../src/text.js';

const samples = ['fp-1', 'dc-1', 'sp-1'];
const frame = 1 / 30; // s simulated between pictures, and about as long on the clock where the machine is quick enough
const patience = 60; // ms of computing before a picture is shown all the same
const still = 2e-8; // J a particle: at rest

setShapeColors(['#4c8bc9', '#d98a3d', '#4fae7f', '#b872a8', '#a89a2e', '#8a8a94']);

// The side of a cylinder, as high as it is wide, or with four corners of a box with sides along x and y.
function tube(radius, sides) {
  const points = [], triangles = [];
  const reach = sides === 4 ? radius * Math.SQRT2 : radius;
  for (let i = 0; i < sides; i++) {
    const angle = (2 * Math.PI * (i + 0.5)) / sides, next = 2 * ((i + 1) % sides);
    for (const z of [0, 2 * radius]) points.push(reach * Math.cos(angle), reach * Math.sin(angle), z);
    triangles.push(2 * i, next, 2 * i + 1, next, next + 1, 2 * i + 1);
  }
  return { points: Float32Array.from(points), triangles: Uint32Array.from(triangles) };
}

// A pour as the report's view of piles draws it: where walls and bodies are now.
class LivePile {
  constructor({ walls, tube: container, surfaces }, count) {
    this.shapes = surfaces.map((mesh) => ({ mesh }));
    this.wallCount = walls.length;
    this.walls = container ? [{ endless: false, mesh: tube(container.width / 2, container.sides) }] : walls;
    this.fixed = Boolean(container);
    Object.assign(this, { capacity: count, entered: 0, poses: null, shapeOf: [], bodies: surfaces.map(() => []) });
  }
  // Of a shape those that have entered: the view keeps this list.
  bodiesOf(shape) {
    return this.bodies[shape];
  }
  enter({ poses, entered, shapeOf }) {
    for (let body = this.entered; body < entered; body++) {
      this.bodies[shapeOf[body]].push(body);
      this.shapeOf[body] = shapeOf[body];
    }
    Object.assign(this, { poses, entered });
  }
  momentAt() {
    return null;
  }
  place(row, position, quaternion) {
    const [x, y, z, w, i, j, k] = this.poses.subarray(7 * row, 7 * row + 7);
    position.set(x, y, z);
    quaternion.set(i, j, k, w);
    return !Number.isNaN(x);
  }
  pose(body, _, position, quaternion) {
    return body < this.entered && this.place(this.wallCount + body, position, quaternion);
  }
  wallPose(wall, _, position, quaternion) {
    if (this.fixed) {
      position.set(0, 0, 0);
      quaternion.identity();
    } else {
      this.place(this.walls.indexOf(wall), position, quaternion);
    }
  }
  sceneBox() {
    const box = new Box3(), position = new Vector3(), turn = new Quaternion(), point = new Vector3();
    for (const wall of this.walls.filter(({ endless }) => !endless)) {
      this.wallPose(wall, null, position, turn);
      for (let i = 0; i < wall.mesh.points.length; i += 3) box.expandByPoint(point.fromArray(wall.mesh.points, i).applyQuaternion(turn).add(position));
    }
    return box;
  }
}

export class PourTab {
  constructor(host, scans) {
    Object.assign(this, { host, scans, engine: null, playing: false });
    this.build();
  }

  build() {
    const { host } = this;
    element('h1', 'Pour particles', host);
    element('p', 'Non-convex polyhedra fall into a container, a turning drum or a hopper, with the library\'s contact forces, friction and damping. Shapes are the scans of the first tab, decimated, or samples.', host, { class: 'soft' });
    const row = element('div', null, host, { class: 'controls' });
    const choose = (text, id, choices) => {
      const select = element('select', null, element('label', text, row), { id });
      choices.forEach(([value, shown]) => element('option', shown, select, { value }));
      return select;
    };
    this.source = choose('Shapes ', 'pour-source', [['samples', 'three sample devices'], ['scans', 'my scans']]);
    this.container = choose('Into a ', 'pour-container', Object.keys(equipment).map((name) => [name, name]));
    [this.source, this.container].forEach((select) => select.addEventListener('change', () => this.offerSliders()));
    this.stiffness = choose('Stiffness ', 'pour-stiffness', [['0.1', 'a tenth (quick)'], ['0.01', 'a hundredth (quicker, softer)'], ['1', 'as the paper (slow)']]);
    const sliders = element('div', null, host, { class: 'tolerances' });
    const slide = (text, id, low, high, step, value, shown, parent = sliders) => {
      const label = element('label', `${text} `, parent);
      const output = element('output', shown(value), label);
      const input = element('input', null, label, { type: 'range', class: 'slider', id, min: low, max: high, step, value });
      input.addEventListener('input', () => (output.textContent = shown(Number(input.value))));
      return input;
    };
    this.count = slide('Particles', 'pour-count', 10, 200, 5, 40, whole);
    this.triangles = slide('Triangles a sample', 'pour-triangles', 20, 400, 10, 100, whole);
    this.friction = slide('Friction', 'pour-friction', 0, 1, 0.05, 0.5, String);
    this.own = Object.entries(equipment).map(([name, { sliders: all }]) => {
      const parent = element('div', null, host, { class: 'tolerances', 'data-container': name });
      return { name, parent, inputs: Object.fromEntries(all.map(([key, text, low, high, step, value, unit]) => [key, slide(text, `pour-${key}`, low, high, step, value, (v) => `${v} ${unit}`, parent)])) };
    });
    this.offerSliders();
    const buttons = element('div', null, host, { class: 'controls' });
    const button = (text, id, act) => {
      const made = element('button', text, buttons, { type: 'button', id });
      made.addEventListener('click', act);
      return made;
    };
    button('Pour', 'pour-start', () => this.begin());
    this.pause = button('Pause', 'pour-pause', () => this.toggle());
    button('Turn back', 'pour-home', () => this.view?.home());
    this.pause.disabled = true;
    this.state = element('p', null, host, { role: 'status', class: 'soft state', id: 'pour-state' });
    const figure = element('figure', null, element('div', null, host, { class: 'pile' }), { class: 'view' });
    this.viewHost = element('div', null, figure);
    this.legend = element('p', null, host, { class: 'legend' });
  }

  // Those of the container picked; a scan has the triangles that were chosen.
  offerSliders() {
    this.triangles.parentElement.hidden = this.source.value === 'scans';
    this.own.forEach(({ name, parent }) => (parent.hidden = name !== this.container.value));
  }

  values() {
    const { inputs } = this.own.find(({ name }) => name === this.container.value);
    const asked = { count: this.count, stiffness: this.stiffness, friction: this.friction, ...inputs };
    return Object.fromEntries(Object.entries(asked).map(([key, { value }]) => [key, Number(value)]));
  }

  tell(text, isError = false) {
    this.state.textContent = text;
    this.state.classList.toggle('error', isError);
  }

  // A PLY file of each shape, with its unit.
  async makeShapes() {
    if (this.source.value === 'scans') {
      const shapes = await this.scans.levels();
      if (!shapes.length) throw new Error('There is no scan in the first tab yet: add one there, or pour the samples.');
      return shapes;
    }
    const shapes = [];
    for (const name of samples) {
      this.tell(`Making ${name} ...`);
      const { code, complaints, files } = await this.engine.ask({ do: 'program', wanted: ['shape.ply'],
        words: ['simplify', `sample:${name}`, '--resolution', '2.5mm', '-n', this.triangles.value, '-u', 'm', '-o', 'shape.ply'] });
      if (code) throw new Error(complaints.join(' '));
      shapes.push({ name, bytes: files[0], unit: 1 });
    }
    return shapes;
  }

  async begin() {
    this.playing = false;
    this.engine?.end();
    const engine = new Engine();
    this.engine = engine;
    try {
      this.tell('Starting ...');
      await engine.ready;
      const shapes = await this.makeShapes();
      const values = this.values(), { count } = values;
      const made = await engine.ask({ do: 'pour', shapes: shapes.map((shape) => ({ ...shape, share: 1 })), container: this.container.value, values });
      this.view ??= new PileView(this.viewHost, 'The pour in 3D');
      this.pile = new LivePile(made, count);
      this.pile.enter(await engine.ask({ do: 'advance', until: 0, ms: 0 }));
      this.view.set(this.pile);
      this.tellLegend(shapes, made);
      this.pause.disabled = false;
      await this.play(engine, count);
    } catch (error) {
      if (!(error instanceof Cancelled)) this.tell(error.message, true);
    }
  }

  tellLegend(shapes, { surfaces, step }) {
    this.legend.replaceChildren();
    shapes.forEach(({ name }, k) => swatch(this.legend, shapeColor(k), `${name}, ${whole(surfaces[k].triangles.length / 3)} triangles`));
    element('span', `time step ${number(step * 1e6, 3)} µs`, this.legend);
  }

  toggle() {
    this.playing = !this.playing;
    this.pause.textContent = this.playing ? 'Pause' : 'Go on';
    if (this.playing) this.resume?.();
  }

  async play(engine, count) {
    let time = 0;
    this.playing = true;
    this.pause.textContent = 'Pause';
    while (engine === this.engine) {
      if (!this.playing) await new Promise((resolve) => (this.resume = resolve));
      const begin = performance.now();
      const now = await engine.ask({ do: 'advance', until: time + frame, ms: patience });
      const speed = (now.time - time) / (performance.now() - begin) * 1000;
      time = now.time;
      this.show(now, count, Math.min(1, speed));
      this.end = now.end || (this.pile.fixed && now.entered === count && now.energy < still ? 'at rest' : '');
      if (this.end) break;
      await new Promise((resolve) => setTimeout(resolve, Math.max(0, 1000 * frame - (performance.now() - begin))));
      await new Promise(requestAnimationFrame);
    }
    if (engine !== this.engine) return;
    this.pause.disabled = true;
    this.tell(`Ended after ${number(time, 3)} s, ${this.end}: ${counted(count, 'particle')}${this.left ? `, of which ${whole(this.left)} went out` : ''}.`);
    document.body.dataset.poured = String(count);
  }

  show(now, count, speed) {
    const { entered, left, time, energy } = now;
    this.left = left;
    this.pile.enter(now);
    this.view.showTime(time);
    this.tell(`${number(time, 3)} s simulated, ${number(100 * speed, 2)} % of real time; ${whole(entered)} of ${counted(count, 'particle')} came in${left ? `, ${whole(left)} went out` : ''}, ${number(energy, 2)} J of motion each.`);
    Object.assign(document.body.dataset, { pourTime: time, pourEntered: entered, pourLeft: left });
  }
}
