// A 3D view of a mesh that is turned with mouse, finger or arrow keys. Flat shading, so that facets are seen.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, Group, IcosahedronGeometry, InstancedMesh, LineBasicMaterial, LineSegments, MathUtils,
  Matrix4, Mesh, MeshStandardMaterial, PerspectiveCamera, Scene, Spherical, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { element } from './text.js';

export const mostEdgeTriangles = 60000; // edges of finer meshes would hide them
const filled = 0.92; // of the panel by the scan; its levels stick out a little

// viridis at nine points
const ramp = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
  [92, 200, 99], [170, 220, 50], [253, 231, 37]];

export function rampColor(t) {
  const x = Math.min(1, Math.max(0, t)) * (ramp.length - 1);
  const i = Math.min(ramp.length - 2, Math.floor(x));
  return ramp[i].map((c, k) => Math.round(c + (ramp[i + 1][k] - c) * (x - i)));
}

// Its 256 colours, as three.js has them.
export const rampTable = () => Array.from({ length: 256 }, (_, i) => new Color().setRGB(...rampColor(i / 255).map((c) => c / 255), 'srgb'));

// It as a bar, from left to right.
export function rampBar(host) {
  const bar = element('canvas', null, host, { width: 128, height: 12, class: 'scale-bar', role: 'img', 'aria-label': 'colour scale' });
  const context = bar.getContext('2d');
  for (let i = 0; i < 128; i++) {
    context.fillStyle = `rgb(${rampColor(i / 127)})`;
    context.fillRect(i, 0, 1, 12);
  }
}

export function swatch(host, color, text) {
  const item = element('span', null, host);
  const context = element('canvas', null, item, { width: 12, height: 12, 'aria-hidden': 'true' }).getContext('2d');
  context.fillStyle = color;
  context.fillRect(0, 0, 12, 12);
  item.append(` ${text}`);
}

function surface(mesh, field, range) {
  const geometry = new BufferGeometry();
  if (!field) {
    geometry.setAttribute('position', new BufferAttribute(mesh.points, 3));
    geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
    return geometry;
  }
  geometry.setAttribute('position', new BufferAttribute(field.points, 3));
  const table = rampTable().map((color) => color.toArray());
  const colors = new Float32Array(field.points.length);
  for (let v = 0; v < field.distances.length; v++) {
    const t = range > 0 ? Math.min(255, Math.round((255 * field.distances[v]) / range)) : 0;
    colors.set(table[t], 3 * v);
  }
  geometry.setAttribute('color', new BufferAttribute(colors, 3));
  return geometry;
}

function edges(mesh) {
  const { points, triangles } = mesh;
  const count = points.length / 3, seen = new Set(), pairs = [];
  for (let i = 0; i < triangles.length; i++) {
    const a = triangles[i], b = triangles[i % 3 === 2 ? i - 2 : i + 1];
    const key = a < b ? a * count + b : b * count + a;
    if (seen.has(key)) continue;
    seen.add(key);
    pairs.push(a, b);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(Uint32Array.from(pairs), 1));
  return geometry;
}

const surfaceMaterial = (field) => new MeshStandardMaterial({
  color: field ? 0xffffff : 0x7d9cc0, vertexColors: Boolean(field), flatShading: true, roughness: 0.8,
  polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
});
const edgeMaterial = (only, dense) => new LineBasicMaterial({
  color: only ? 0x4477aa : 0x101018, transparent: true, opacity: dense < 5000 ? 0.9 : dense < 20000 ? 0.5 : 0.25,
});

// How far from the origin, in a direction, the camera sees all points.
function fitDistance(camera, direction, points) {
  const right = new Vector3().crossVectors(camera.up, direction).normalize();
  const upward = new Vector3().crossVectors(direction, right);
  const high = filled * Math.tan(MathUtils.degToRad(camera.fov / 2)), wide = high * camera.aspect;
  const reach = (p) => p.dot(direction) + Math.max(Math.abs(p.dot(right)) / wide, Math.abs(p.dot(upward)) / high);
  return points.reduce((far, p) => Math.max(far, reach(p)), 1);
}

export function corners(low, high) {
  const [xs, ys, zs] = low.map((x, k) => [x, high[k]]);
  return xs.flatMap((x) => ys.flatMap((y) => zs.map((z) => new Vector3(x, y, z))));
}

export class View {
  // from: where the camera stands at first, seen from the origin
  constructor(host, label, from = [2.35, -2.7, 1.75]) {
    this.host = host;
    this.from = new Vector3(...from).normalize();
    this.outline = [];
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    const canvas = this.renderer.domElement;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', `${label}. Arrow keys turn it, plus and minus move nearer and away, 0 turns it back.`);
    canvas.tabIndex = 0;
    host.append(canvas);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(25, 1, 0.01, 200);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new AmbientLight(0xffffff, 1.3));
    for (const [strength, x, y, z] of [[2.2, -0.6, 0.5, 1], [0.6, 1, -0.3, 0.4]]) {
      const light = new DirectionalLight(0xffffff, strength);
      light.position.set(x, y, z);
      this.camera.add(light);
    }
    this.scene.add(this.camera);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => (this.turned = true));
    canvas.addEventListener('keydown', (event) => this.key(event));
    this.home();
    new ResizeObserver(() => this.resize()).observe(host);
  }

  // Has the graphics driver translate what draws surfaces, colours and edges; a first picture would wait for it.
  async warm() {
    const mesh = { points: new Float32Array(9), triangles: Uint32Array.of(0, 1, 2) };
    const field = { points: new Float32Array(9), distances: new Float32Array(3) };
    this.warmed = new Group(); // kept: what nothing uses is forgotten
    this.warmed.add(new Mesh(surface(mesh), surfaceMaterial()), new Mesh(surface(mesh, field, 1), surfaceMaterial(field)), new LineSegments(edges(mesh), edgeMaterial(false, 1)));
    await this.renderer.compileAsync(this.warmed, this.camera, this.scene);
    this.scene.add(this.warmed);
    this.draw();
    this.scene.remove(this.warmed);
  }

  home() {
    this.turned = false;
    this.fit(this.from);
  }

  fit(direction) {
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(direction).multiplyScalar(fitDistance(this.camera, direction, this.outline));
    this.controls.update();
  }

  // outline: points round another object about the origin, seen whole from where the camera is turned to.
  surround(outline) {
    this.outline = outline;
    this.fit(this.camera.position.clone().sub(this.controls.target).normalize());
  }

  key(event) {
    const turns = { ArrowLeft: [0, -0.15], ArrowRight: [0, 0.15], ArrowUp: [-0.12, 0], ArrowDown: [0.12, 0] };
    const nearer = { '+': 0.9, '=': 0.9, '-': 1 / 0.9 };
    if (event.key === '0') {
      this.home();
    } else if (turns[event.key] || nearer[event.key]) {
      // three's spherical angles are about y; ours are about z
      const offset = this.camera.position.clone().sub(this.controls.target);
      const sphere = new Spherical().setFromVector3(new Vector3(offset.x, offset.z, -offset.y));
      const [polar, around] = turns[event.key] ?? [0, 0];
      sphere.phi = Math.min(Math.PI - 0.02, Math.max(0.02, sphere.phi + polar));
      sphere.theta += around;
      sphere.radius *= nearer[event.key] ?? 1;
      const moved = new Vector3().setFromSpherical(sphere);
      this.camera.position.set(moved.x, -moved.z, moved.y).add(this.controls.target);
      this.turned = true;
      this.controls.update();
    } else {
      return;
    }
    event.preventDefault();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.turned) this.home();
    this.draw();
  }

  clear() {
    for (const part of this.parts ?? []) {
      this.scene.remove(part);
      part.traverse((each) => {
        each.geometry?.dispose();
        each.material?.dispose();
        if (each.isInstancedMesh) each.dispose();
      });
    }
    this.parts = [];
  }

  // frame: {centre, size, half: of its box} in the mesh's units; field: distances to show as colours up to range, or null.
  show(mesh, frame, { wire = false, only = false, field = null, range = 1 }) {
    this.clear();
    if (!only) this.parts.push(new Mesh(surface(mesh, field, range), surfaceMaterial(field)));
    if (wire || only) this.parts.push(new LineSegments(edges(mesh), edgeMaterial(only, mesh.triangles.length / 3)));
    this.place(frame);
  }

  // A small picture of a mesh as it is seen now, as an address; what is shown is another then.
  thumbnail(mesh, frame) {
    this.show(mesh, frame, { wire: mesh.triangles.length < 3000 });
    const small = document.createElement('canvas'), { width, height } = this.renderer.domElement, scale = Math.min(200 / width, 136 / height);
    [small.width, small.height] = [200, 136];
    small.getContext('2d').drawImage(this.renderer.domElement, 100 - (scale * width) / 2, 68 - (scale * height) / 2, scale * width, scale * height);
    return small.toDataURL();
  }

  // spheres: rows x, y, z, radius in the mesh's units; over them the mesh's edges, if asked for.
  showSpheres(spheres, mesh, frame, wire) {
    this.clear();
    const balls = new InstancedMesh(new IcosahedronGeometry(1, 4), new MeshStandardMaterial({ color: 0xd08a3c, roughness: 0.7 }), spheres.length);
    spheres.forEach(([x, y, z, r], i) => balls.setMatrixAt(i, new Matrix4().makeScale(r, r, r).setPosition(x, y, z)));
    this.parts.push(balls);
    if (wire) this.parts.push(new LineSegments(edges(mesh), new LineBasicMaterial({ color: 0x101018, transparent: true, opacity: 0.45 })));
    this.place(frame);
  }

  // Scales and moves all parts so that the frame stands about the origin.
  place(frame) {
    for (const part of this.parts) {
      part.scale.setScalar(2 / frame.size);
      part.position.set(...frame.centre).multiplyScalar(-2 / frame.size);
      this.scene.add(part);
    }
    if (frame !== this.frame) {
      this.frame = frame;
      const half = frame.half.map((x) => (2 * x) / frame.size);
      this.surround(corners(half.map((x) => -x), half));
    }
    this.draw();
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
    this.onDraw?.(this);
  }

  follow(other) {
    this.turned = other.turned;
    this.camera.position.copy(other.camera.position);
    this.camera.quaternion.copy(other.camera.quaternion);
    this.controls.target.copy(other.controls.target);
    this.renderer.render(this.scene, this.camera);
  }
}

// Turning one turns the other.
export function link(a, b) {
  a.onDraw = (view) => b.follow(view);
  b.onDraw = (view) => a.follow(view);
}
