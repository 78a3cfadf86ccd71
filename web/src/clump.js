// The section of clumps (clump.json, docs/reference/formats.md): answer, table of the bodies, and for the body picked its
// curve, the clump of every number of spheres over the surface in 3D, and the table.
import { Chart, palette } from './chart.js';
import { element, number, percent, table, whole } from './text.js';
import { View } from './view.js';

const mm = 1000;
const meanOf = (clump) => (clump.to_mesh_mean + clump.from_mesh_mean) / 2;
const worstOf = (clump) => Math.max(clump.to_mesh_max, clump.from_mesh_max);

// What the view frames a body by.
function frameOf(surface) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  surface.points.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  const half = low.map((x, k) => (high[k] - x) / 2);
  return { centre: low.map((x, k) => (x + high[k]) / 2), half, size: 2 * Math.hypot(...half) || 1 };
}

// How well so many spheres cover the body, in words.
function coverage(body, count) {
  const clump = body.clumps.find((c) => c.sphere_count === count);
  return `${whole(count)} ${count === 1 ? 'sphere covers' : 'spheres cover'} it with an intersection over union of ${number(clump.iou, 3)}, on average within ${number(mm * meanOf(clump), 3)} mm`;
}

export class ClumpSection {
  constructor(host, folder) {
    this.host = host;
    this.bodies = folder.clump;
    this.state = { body: 0, row: 0, surface: true };
    this.tellAnswer();
    if (this.bodies.length > 1) this.tellBodies();
    this.build();
    this.select(0);
  }

  tellAnswer() {
    const { bodies, host } = this;
    const [first] = bodies;
    element('h1', bodies.length > 1 ? `How many spheres do these ${bodies.length} bodies need?` : `How many spheres does ${first.name} need?`, host);
    for (const body of bodies) {
      const { chosen, recommended } = body;
      const name = bodies.length > 1 ? `${body.name}: ` : '';
      const most = body.clumps.at(-1).sphere_count;
      const last = recommended === most && most > 1 ? ` That is the largest number tried: more spheres may do better.` : '';
      const other = chosen === recommended ? '' : ` Recommended, of those tried: ${coverage(body, recommended)}.`;
      element('p', `${name}${coverage(body, chosen)}.${other}${last}`, host, { class: 'answer' });
    }
    element('p', `Recommended: the least 1 − IoU + n/200. Mass, centre and inertia that go with a clump are the surface's own, whatever those of the spheres' union. Method: ${first.method}.`, host, { class: 'soft' });
    const iou = (body) => body.clumps.find((c) => c.sphere_count === body.recommended).iou;
    for (const body of bodies.filter((b) => b.wall_cells >= 3 && iou(b) < 0.6))
      element('p', `${body.name}: spheres and body have less than 0.6 of the volume of both in common; spheres are the wrong shape for it; take its mesh.`, host, { class: 'soft' });
    for (const body of bodies.filter((b) => b.wall_cells < 3))
      element('p', `${body.name}: its walls of ${number(mm * body.thickness, 3)} mm are thinner than the spheres can follow; take its mesh.`, host, { class: 'soft' });
  }

  tellBodies() {
    const chosen = (body) => body.clumps.find((c) => c.sphere_count === body.chosen);
    element('h2', 'Each body', this.host);
    table(this.host, [
      { head: 'body', value: (b) => b.name },
      { head: 'spheres', value: (b) => b.chosen, text: (b) => whole(b.chosen) },
      { head: 'IoU', value: (b) => chosen(b).iou, text: (b) => number(chosen(b).iou, 4) },
      { head: 'mean distance / mm', value: (b) => mm * meanOf(chosen(b)), text: (b) => number(mm * meanOf(chosen(b)), 3) },
      { head: 'recommended', value: (b) => b.recommended, text: (b) => whole(b.recommended) },
      { head: 'by mean distance', value: (b) => b.recommended_by_distance, text: (b) => whole(b.recommended_by_distance) },
    ], this.bodies, 'clumps.csv', 'Bodies and the spheres chosen for each');
  }

  build() {
    const { host, bodies } = this;
    if (bodies.length > 1) {
      element('h2', 'Look at', host);
      const group = element('div', null, host, { role: 'group', 'aria-label': 'Bodies', class: 'objects' });
      this.buttons = bodies.map((body, i) => {
        const button = element('button', body.name, group, { type: 'button' });
        button.addEventListener('click', () => this.select(i));
        return button;
      });
    }
    element('h2', 'The clump over the surface', host);
    const label = element('label', 'spheres ', host);
    this.slider = element('input', null, label, { type: 'range', min: 0, step: 1 });
    this.slider.addEventListener('input', () => this.pick(Number(this.slider.value)));
    this.told = element('p', null, host, { 'aria-live': 'polite' });
    this.buildView();
    element('h2', 'Errors against the number of spheres', host);
    this.chartHost = element('div', null, host);
    this.tableHost = element('div', null, host);
  }

  buildView() {
    const host = element('div', null, this.host);
    const check = element('label', null, host);
    const box = element('input', null, check, { type: 'checkbox', checked: '' });
    check.append(' edges of the surface');
    box.addEventListener('change', () => {
      this.state.surface = box.checked;
      this.draw();
    });
    try {
      this.view = new View(element('div', null, element('div', null, host, { class: 'view' })), 'The clump over the surface');
    } catch {
      host.replaceChildren();
      element('p', 'This browser shows no WebGL, so the spheres over the surface in 3D are left out here. The curve and all tables are complete.', host, { class: 'no-webgl', role: 'note' });
    }
  }

  select(index) {
    this.state.body = index;
    this.buttons?.forEach((button, i) => button.setAttribute('aria-pressed', String(i === index)));
    const body = this.bodies[index];
    this.frame = frameOf(body.surface);
    this.mesh = { points: Float32Array.from(body.surface.points), triangles: Uint32Array.from(body.surface.triangles) };
    this.slider.max = body.clumps.length - 1;
    this.drawChart();
    this.tellTable();
    this.pick(body.clumps.findIndex((c) => c.sphere_count === body.chosen));
  }

  pick(row) {
    this.state.row = row;
    this.slider.value = row;
    const clump = this.bodies[this.state.body].clumps[row];
    this.told.textContent = `${whole(clump.sphere_count)} ${clump.sphere_count === 1 ? 'sphere' : 'spheres'}: IoU ${number(clump.iou, 4)}, mean distance ${number(mm * meanOf(clump), 3)} mm, greatest ${number(mm * worstOf(clump), 3)} mm, the union's volume ${percent(clump.volume_error)} off, its normals ${number(clump.slope_deg, 3)}° from the surface's on average.`;
    this.slider.setAttribute('aria-valuetext', this.told.textContent);
    this.draw();
    this.chart.draw();
  }

  draw() {
    const { spheres } = this.bodies[this.state.body].clumps[this.state.row];
    this.view?.showSpheres(spheres, this.mesh, this.frame, this.state.surface);
  }

  drawChart() {
    const { clumps, recommended } = this.bodies[this.state.body];
    const { size } = this.bodies[this.state.body];
    const curve = (label, value, i) => ({ label, values: clumps.map(value), color: palette[i], text: (v) => number(v, 3) });
    this.chartHost.replaceChildren();
    this.chart = new Chart(element('div', null, this.chartHost), {
      x: { label: 'spheres', values: clumps.map((c) => c.sphere_count), text: (v) => whole(v) },
      yLabel: 'share',
      series: [curve('1 − IoU', (c) => 1 - c.iou, 0), curve('mean distance / L', (c) => meanOf(c) / size, 1), curve('1 − IoU + n/200', (c) => c.volume_criterion, 2)],
      marks: () => [
        { x: recommended, color: palette[2], label: 'recommended' },
        { x: clumps[this.state.row].sphere_count, color: palette[5], dash: [4, 4], label: 'shown' },
      ],
      pick: (i) => this.pick(i),
    });
  }

  tellTable() {
    const { name, clumps } = this.bodies[this.state.body];
    const column = (head, value, digits = 3) => ({ head, value, text: (c) => number(value(c), digits) });
    this.tableHost.replaceChildren();
    table(this.tableHost, [
      { head: 'spheres', value: (c) => c.sphere_count, text: (c) => whole(c.sphere_count) },
      column('IoU', (c) => c.iou, 4), column('mean distance / mm', (c) => mm * meanOf(c)), column('greatest / mm', (c) => mm * worstOf(c)),
      { head: 'volume', value: (c) => c.volume_error, text: (c) => percent(c.volume_error) },
      { head: 'inertia', value: (c) => c.inertia_error, text: (c) => percent(c.inertia_error) },
      column('roughness / mm', (c) => mm * c.roughness), column('normals / °', (c) => c.slope_deg), column('1 − IoU + n/200', (c) => c.volume_criterion, 4), column('mean/L + n/5000', (c) => c.distance_criterion, 4),
    ], clumps, `${name}-clumps.csv`, 'Errors against the number of spheres');
  }
}
