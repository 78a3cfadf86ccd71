// A pile (docs/reference/formats.md): its shapes, where its bodies were at moments of the run, and of a scene where its walls
// were; and the 3D view that plays it. Between two moments bodies go straight and turn evenly.
import {
  Box3, BufferAttribute, BufferGeometry, DoubleSide, Group, InstancedMesh, MathUtils, Matrix4, Mesh, MeshStandardMaterial,
  Plane, Quaternion, Vector3,
} from 'three';
import { bodyPaints, byShape, tellPaint, wallPaints } from './paint.js';
import { Reader, decodeMesh, decodeVertices } from './packed.js';
import { counted, element, number, whole } from './text.js';
import { View, corners } from './view.js';

export { Box3, Quaternion, Vector3 };

let shapeColors; // as the pictures have them
export const setShapeColors = (colors) => {
  shapeColors = colors;
};
export const shapeColor = (shape) => shapeColors[shape % shapeColors.length];

export class Pile {
  constructor(id) {
    const reader = new Reader(id);
    const surface = () => {
      const name = reader.text();
      const triangleCount = reader.u32();
      const grid = { low: reader.reals(3), step: reader.real() };
      const mesh = decodeMesh(reader.mesh());
      for (let i = 0; i < mesh.points.length; i++) mesh.points[i] = grid.low[i % 3] + grid.step * mesh.points[i];
      return { name, triangleCount, mesh };
    };
    const map = (count) => {
      const name = reader.text(), unit = reader.text(), low = reader.real(), high = reader.real();
      const steps = new Uint16Array(decodeVertices(reader.buffer(), count, 4));
      return { name, unit, values: Float32Array.from({ length: count }, (_, t) => low + ((high - low) * steps[2 * t]) / 65535) };
    };
    this.walls = Array.from({ length: reader.u32() }, () => {
      const wall = { endless: reader.u32() > 0, ...surface() };
      return { ...wall, maps: Array.from({ length: reader.u32() }, () => map(wall.mesh.triangles.length / 3)) };
    });
    this.shapes = Array.from({ length: reader.u32() }, surface);
    this.bodyCount = reader.u32();
    this.shapeOf = new Uint32Array(decodeVertices(reader.buffer(), this.bodyCount, 4));
    const joined = reader.u32() > 0, numbers = () => decodeVertices(reader.buffer(), this.bodyCount, 4);
    this.fragmentOf = joined ? new Uint32Array(numbers()) : null; // at the end
    this.loadOf = joined ? new Float32Array(numbers()) : null; // likewise: the greatest share of its strength that a joint uses
    this.low = reader.reals(3);
    this.step = reader.real();
    const count = reader.u32();
    this.times = reader.reals(count);
    for (const wall of this.walls) wall.poses = Array.from({ length: count }, () => reader.reals(7));
    const tracks = decodeVertices(reader.buffer(), this.bodyCount * count, 16);
    this.places = new Uint16Array(tracks);
    this.turns = new Int16Array(tracks);
  }

  bodiesOf(shape) {
    return [...this.shapeOf.keys()].filter((body) => this.shapeOf[body] === shape);
  }

  get end() {
    return this.times[this.times.length - 1];
  }

  // The moment at or before a time, and how far it is to the next one, from 0 to 1.
  momentAt(time) {
    const { times } = this;
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    const next = Math.min(low + 1, times.length - 1);
    const part = next > low ? (time - times[low]) / (times[next] - times[low]) : 0;
    return { moment: low, next, part: Math.min(1, Math.max(0, part)) };
  }

  // Position and quaternion of a body; false where it is not there.
  pose(body, { moment, next, part }, position, quaternion) {
    const { places, turns, times } = this;
    const a = 8 * (body * times.length + moment);
    if (!places[a + 3]) return false;
    const b = places[8 * (body * times.length + next) + 3] ? 8 * (body * times.length + next) : a;
    const mix = (k, from) => from[a + k] + part * (from[b + k] - from[a + k]);
    position.set(...[0, 1, 2].map((k) => this.low[k] + this.step * mix(k, places)));
    quaternion.set(mix(5, turns), mix(6, turns), mix(7, turns), mix(4, turns)).normalize();
    return true;
  }

  // m/s, the mean between the moments about a time; 0 where it is not there at both.
  speed(body, { moment, next }) {
    const { places, times } = this;
    const a = 8 * (body * times.length + moment), b = 8 * (body * times.length + next);
    if (next === moment || !places[a + 3] || !places[b + 3]) return 0;
    return (this.step * Math.hypot(...[0, 1, 2].map((k) => places[b + k] - places[a + k]))) / (times[next] - times[moment]);
  }

  // s, since the first moment at which it is there.
  age(body, time) {
    const { places, times } = this;
    this.first ??= new Float64Array(this.bodyCount).map((_, i) => times[times.findIndex((_, k) => places[8 * (i * times.length + k) + 3])] ?? Infinity);
    return Math.max(0, time - this.first[body]);
  }

  // Position and quaternion of a wall of a scene.
  wallPose(wall, { moment, next, part }, position, quaternion) {
    const a = wall.poses[moment], b = wall.poses[next];
    position.set(...[0, 1, 2].map((k) => a[k] + part * (b[k] - a[k])));
    quaternion.set(a[4], a[5], a[6], a[3]).slerp(new Quaternion(b[4], b[5], b[6], b[3]), part);
  }

  // What a scene's picture is fitted to: its walls, but for endless ones, while they have not moved off by more than
  // their own size, and its bodies at the start, half way and at the end.
  sceneBox() {
    const box = new Box3(), position = new Vector3(), turn = new Quaternion(), one = new Vector3(1, 1, 1), first = new Vector3();
    for (const wall of this.walls.filter(({ endless }) => !endless)) {
      const own = new Box3().setFromArray(wall.mesh.points), size = own.getSize(new Vector3()).length();
      for (const [i, time] of this.times.entries()) {
        this.wallPose(wall, this.momentAt(time), position, turn);
        if (i === 0) first.copy(position);
        if (position.distanceTo(first) > size) break;
        const placed = new Matrix4().compose(position, turn, one);
        for (const corner of corners(own.min.toArray(), own.max.toArray())) box.expandByPoint(corner.clone().applyMatrix4(placed));
      }
    }
    const sizes = this.shapes.map(({ mesh }) => new Vector3().setScalar(2 * Math.sqrt(mesh.points.reduce((most, _, i, p) => (i % 3 ? most : Math.max(most, p[i] ** 2 + p[i + 1] ** 2 + p[i + 2] ** 2)), 0))));
    for (const time of [0, this.times.length >> 1, this.times.length - 1].map((i) => this.times[i])) {
      for (let i = 0; i < this.bodyCount; i++) if (this.pose(i, this.momentAt(time), position, turn)) box.union(new Box3().setFromCenterAndSize(position, sizes[this.shapeOf[i]]));
    }
    return box.isEmpty() ? box.expandByPoint(position.set(0, 0, 0)) : box;
  }
}

function geometryOf(mesh) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(mesh.points, 3));
  geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
  return geometry;
}

// Draws a pile at any time. Throws where there is no WebGL.
export class PileView extends View {
  constructor(host, label) {
    super(host, label, [2.2, -3.4, 1.5]);
    this.renderer.localClippingEnabled = true;
    this.ruler = element('div', null, host, { class: 'ruler' });
    this.cut = { share: 0, bodies: false };
    this.plane = new Plane();
  }

  set(pile) {
    this.clear();
    this.pile = pile;
    const group = new Group();
    this.group = group;
    this.paint = byShape(pile);
    const fit = this.setScene(group);
    this.instances = pile.shapes.map((shape, k) => {
      const bodies = pile.bodiesOf(k);
      const drawn = new InstancedMesh(geometryOf(shape.mesh), new MeshStandardMaterial({ flatShading: true, roughness: 0.8, side: DoubleSide }), pile.capacity ?? bodies.length);
      drawn.frustumCulled = false;
      group.add(drawn);
      return { drawn, bodies };
    });
    this.parts.push(group);
    this.scene.add(group);
    this.surround(fit);
  }

  // The walls of a scene, seen through; the points that the picture is fitted to.
  setScene(group) {
    const { pile } = this;
    const box = pile.sceneBox(), middle = box.getCenter(new Vector3());
    const scale = 2 / Math.max(1e-9, box.getSize(new Vector3()).length());
    group.scale.setScalar(scale);
    group.position.copy(middle).multiplyScalar(-scale);
    this.walls = pile.walls.map((wall) => {
      const drawn = new Mesh(geometryOf(wall.mesh), new MeshStandardMaterial({ transparent: true, side: DoubleSide, flatShading: true }));
      drawn.renderOrder = 1;
      group.add(drawn);
      return { wall, drawn };
    });
    this.paintWalls(null);
    return corners(box.min.toArray(), box.max.toArray()).map((corner) => corner.sub(middle).multiplyScalar(scale));
  }

  // By one of wallPaints: walls that have the map are opaque; null: all are seen through.
  paintWalls(paint) {
    for (const { wall, drawn } of this.walls) {
      const map = paint && wall.maps.find(({ name }) => name === paint.name), { material } = drawn;
      if (map) {
        const geometry = geometryOf(wall.mesh).toNonIndexed(), colors = new Float32Array(9 * map.values.length);
        map.values.forEach((value, t) => [0, 3, 6].forEach((k) => paint.color(value).toArray(colors, 9 * t + k)));
        geometry.setAttribute('color', new BufferAttribute(colors, 3));
        drawn.geometry.dispose();
        drawn.geometry = geometry;
      }
      material.color.set(map ? 0xffffff : 0x8899bb);
      material.opacity = map ? 1 : wall.endless ? 0.08 : 0.2;
      material.depthWrite = material.vertexColors = Boolean(map);
      material.needsUpdate = true;
    }
  }

  // What is nearer than the plane across the view is left out: of walls, and with `bodies` of these too.
  draw() {
    if (this.group && this.outline.length) {
      const { share, bodies } = this.cut, { camera, plane } = this;
      const along = camera.getWorldDirection(plane.normal).setZ(0);
      if (along.lengthSq() < 1e-6) along.set(0, 1, 0);
      const reach = this.outline.map((p) => p.dot(along.normalize()));
      plane.constant = -MathUtils.lerp(Math.min(...reach), Math.max(...reach), share);
      const planes = share > 0 ? [plane] : [];
      for (const { drawn } of this.walls) drawn.material.clippingPlanes = planes;
      for (const { drawn } of this.instances ?? []) drawn.material.clippingPlanes = bodies ? planes : [];
      this.measure();
    }
    super.draw();
  }

  // A length of 1, 2 or 5 as it is seen in the middle, at most a quarter of the picture.
  measure() {
    const { camera, controls, host, ruler } = this;
    const across = 2 * Math.tan(MathUtils.degToRad(camera.fov / 2)) * camera.position.distanceTo(controls.target);
    const metre = (host.clientHeight / across) * this.group.scale.x, room = host.clientWidth / 4 / metre;
    const power = 10 ** Math.floor(Math.log10(room)), length = power * [5, 2, 1].find((n) => n * power <= room);
    ruler.style.width = `${length * metre}px`;
    ruler.textContent = length < 1e-3 ? `${number(1e6 * length)} µm` : length < 1 ? `${number(1e3 * length)} mm` : `${number(length)} m`;
  }

  showTime(time) {
    const { pile, paint } = this;
    const at = pile.momentAt(time);
    const position = new Vector3(), turn = new Quaternion(), one = new Vector3(1, 1, 1), matrix = new Matrix4();
    let count = 0;
    for (const { drawn, bodies } of this.instances) {
      let there = 0;
      for (const body of bodies) {
        if (!pile.pose(body, at, position, turn)) continue;
        drawn.setColorAt(there, paint.color(body, at, time));
        drawn.setMatrixAt(there++, matrix.compose(position, turn, one));
      }
      drawn.count = there;
      drawn.instanceMatrix.needsUpdate = true;
      if (drawn.instanceColor) drawn.instanceColor.needsUpdate = true;
      count += there;
    }
    for (const { wall, drawn } of this.walls) pile.wallPose(wall, at, drawn.position, drawn.quaternion);
    this.draw();
    return count;
  }
}

const speeds = [0.1, 0.25, 0.5, 1, 2, 4];
const calm = matchMedia('(prefers-reduced-motion: reduce)');
const calmPause = 500; // ms between moments where less motion is wanted

// View, slider of time and buttons. onTime(time) follows; told(time) says what goes on then; picture: an <img> shown
// where there is no WebGL; plays: from the start once it is seen, else it begins at the end.
export class PilePlayer {
  constructor(host, { onTime = () => {}, told = () => '', picture = null, label = 'The pile in 3D', plays = false } = {}) {
    Object.assign(this, { host, onTime, told, plays, time: 0, speed: 1, playing: false });
    this.box = element('div', null, host, { class: 'pile' });
    const figure = element('figure', null, this.box, { class: 'view' });
    const viewHost = element('div', null, figure);
    this.caption = element('figcaption', null, figure);
    try {
      this.view = new PileView(viewHost, label);
    } catch {
      this.view = null;
      figure.remove();
      element('p', `This browser shows no WebGL, so the pile in 3D, to turn around and play, is left out here.${picture ? ' A picture of its end stands in for it.' : ''} The curves and all tables are complete.`, this.box, { class: 'no-webgl', role: 'note' });
      if (picture) this.box.append(picture);
      return;
    }
    this.picture = picture;
    picture?.remove();
    this.build();
    this.box.addEventListener('keydown', (event) => {
      if (event.key !== ' ' || event.target.tagName === 'BUTTON' || event.target.tagName === 'SELECT') return;
      event.preventDefault();
      this.toggle();
    });
    addEventListener('beforeprint', () => this.pile && this.goTo(this.pile.end));
  }

  build() {
    const controls = element('div', null, this.box, { class: 'controls' });
    this.button = element('button', 'Play', controls, { type: 'button', class: 'play' });
    this.button.addEventListener('click', () => this.toggle());
    const label = element('label', 'Speed ', controls);
    const choice = element('select', null, label);
    speeds.forEach((speed) => element('option', `${speed} ×`, choice, { value: speed, ...(speed === 1 ? { selected: '' } : {}) }));
    choice.addEventListener('change', () => {
      this.speed = Number(choice.value);
    });
    this.speedChoice = choice;
    element('button', 'Turn back', controls, { type: 'button' }).addEventListener('click', () => this.view.home());
    const sliderLabel = element('label', 'Time', this.box, { class: 'soft' });
    this.slider = element('input', null, sliderLabel, { type: 'range', min: 0, step: 1, class: 'slider time' });
    this.slider.addEventListener('input', () => {
      this.stop();
      this.goTo(this.pile.times[Number(this.slider.value)]);
    });
    this.text = element('p', null, this.box, { class: 'level-text', 'aria-live': 'off' });
    const more = element('details', null, this.box);
    element('summary', 'Colours, cut, keys', more);
    this.looks = element('div', null, more, { class: 'controls' });
    this.legend = element('p', null, more, { class: 'legend' });
    element('p', 'Space plays and stops; on the time slider the arrow keys go from moment to moment. Turn with mouse or finger, or with the arrow keys once the view has the focus; plus and minus move nearer and away.', more, { class: 'soft hint' });
  }

  // What bodies and walls are coloured by, and the cut; shapes: as bodyPaints.
  offerLooks(shapes) {
    const { view, pile, looks } = this;
    const seen = [byShape(pile), null];
    const repaint = () => {
      this.legend.replaceChildren();
      seen.filter(Boolean).forEach((paint) => tellPaint(this.legend, paint));
      this.goTo(this.time);
    };
    const select = (label, names, pick) => {
      const choice = element('select', null, element('label', `${label} `, looks));
      names.forEach((name, i) => element('option', name, choice, { value: i }));
      choice.addEventListener('change', () => {
        pick(Number(choice.value));
        repaint();
      });
    };
    looks.replaceChildren();
    const bodies = shapes ? bodyPaints(pile, shapes) : [seen[0]], walls = wallPaints(pile);
    view.paint = seen[0] = bodies[0];
    if (bodies.length > 1) select('Particles by', bodies.map(({ name }) => name), (i) => { view.paint = seen[0] = bodies[i]; });
    if (walls.length) select('Walls by', ['nothing, seen through', ...walls.map(({ name }) => name)], (i) => view.paintWalls(seen[1] = walls[i - 1] ?? null));
    if (pile.walls.length) {
      const slider = element('input', null, element('label', 'Cut away ', looks), { type: 'range', min: 0, max: 1, step: 0.01, value: 0 });
      const through = element('label', null, looks), box = element('input', null, through, { type: 'checkbox' });
      through.append(' particles too');
      for (const input of [slider, box]) input.addEventListener('input', () => {
        view.cut = { share: Number(slider.value), bodies: box.checked };
        view.draw();
      });
    }
    repaint();
  }

  show(pile, shapes) {
    if (!this.view) return;
    this.stop();
    this.pile = pile;
    const single = pile.times.length < 2;
    this.button.disabled = this.slider.disabled = single;
    this.slider.max = pile.times.length - 1;
    this.view.set(pile);
    const drawn = pile.shapes.filter(({ mesh, triangleCount }) => triangleCount > mesh.triangles.length / 3);
    this.note = drawn.length ? `; drawn with up to ${whole(Math.max(...drawn.map(({ mesh }) => mesh.triangles.length / 3)))} triangles a particle, simulated with up to ${whole(Math.max(...pile.shapes.map((s) => s.triangleCount)))}` : '';
    if (single) this.note += '; only its end was recorded';
    this.time = this.plays ? pile.times[0] : pile.end;
    this.offerLooks(shapes);
    if (this.plays && !single) this.playOnceSeen();
  }

  // At the speed that comes next to ten seconds in all.
  playOnceSeen() {
    const off = (speed) => Math.abs(Math.log(this.pile.end / speed / 10));
    this.speed = [...speeds].sort((a, b) => off(a) - off(b))[0];
    this.speedChoice.value = this.speed;
    if (calm.matches) return;
    const watcher = new IntersectionObserver(([{ isIntersecting }]) => {
      if (!isIntersecting) return;
      watcher.disconnect();
      this.play();
    });
    watcher.observe(this.box);
  }

  // In place of a pile that is not in the page.
  lack() {
    this.box.replaceChildren(element('p', 'The particles in 3D are not in this page: it would grow too large, or they were not recorded. `scree report` of this folder alone may hold them.', null, { class: 'no-webgl', role: 'note' }));
    if (this.picture) this.box.append(this.picture);
    this.view = null;
  }

  goTo(time) {
    if (!this.view) return;
    this.time = time;
    const count = this.view.showTime(time);
    this.slider.value = this.pile.momentAt(time).moment;
    this.slider.setAttribute('aria-valuetext', `${number(time, 3)} seconds`);
    const said = this.told(time);
    this.text.textContent = `${time.toFixed(2)} s of ${this.pile.end.toFixed(2)} s${said ? `: ${said}` : ''}`;
    this.caption.textContent = `${counted(count, 'particle')}${this.note}`;
    Object.assign(document.body.dataset, { shownTime: time, shownBodies: count });
    this.onTime(time);
  }

  toggle() {
    if (this.playing) this.stop();
    else this.play();
  }

  play() {
    if (!this.pile || this.pile.times.length < 2) return;
    this.playing = true;
    this.button.textContent = 'Pause';
    if (this.time >= this.pile.end) this.goTo(this.pile.times[0]);
    let before = performance.now();
    const next = (now) => {
      if (!this.playing) return;
      if (calm.matches) {
        if (now - before >= calmPause) {
          before = now;
          this.goTo(this.pile.times[this.pile.momentAt(this.time).next]);
        }
      } else {
        this.goTo(Math.min(this.pile.end, this.time + (this.speed * MathUtils.clamp(now - before, 0, 250)) / 1000));
        before = now;
      }
      if (this.time >= this.pile.end) this.stop();
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  stop() {
    this.playing = false;
    if (this.button) this.button.textContent = 'Play';
  }
}
