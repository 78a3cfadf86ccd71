// The section of clumps (clump.json, docs/reference/formats.md): answer, table of the bodies, and for the body picked its
// curve, the clump of every number of spheres over the surface in 3D, and the table.
import { Skeleton, capital } from './page.js';
import { Plot, span } from './plot.js';
import { element, folded, number, percent, table, whole } from './text.js';
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
    this.bodies = folder.clump;
    this.state = { body: 0, row: 0, surface: true };
    const { bodies } = this, [first] = bodies, poor = bodies.filter((b) => b.wall_cells < 3 || this.chosen(b).iou < 0.6), name = (b) => (bodies.length > 1 ? `${b.name}: ` : '');
    this.page = new Skeleton(host, {
      title: bodies.length > 1 ? `${bodies.length} bodies` : first.name, kind: 'clumps of spheres', date: folder.provenance?.started,
      told: {
        verdict: poor.length ? 'not reached' : 'answered', state: poor.length ? 'Spheres are the wrong shape; take the mesh' : 'Covered',
        sentence: bodies.slice(0, 3).map((b) => `${name(b)}${coverage(b, b.chosen)}.`).join(' '),
        but: [...bodies.filter((b) => b.chosen !== b.recommended).map((b) => `${name(b)}recommended, of those tried: ${coverage(b, b.recommended)}.`), ...poor.map((b) => (b.wall_cells < 3 ? `${name(b)}walls of ${number(mm * b.thickness, 3)} mm are thinner than the spheres can follow.` : `${name(b)}spheres and body have less than 0.6 of the volume of both in common.`)),
          ...bodies.filter((b) => b.recommended === b.clumps.at(-1).sphere_count && b.recommended > 1).map((b) => `${name(b)}more spheres than were tried may do better.`)].slice(0, 6).map(capital).join(' '),
      },
    });
    this.host = this.page.host;
    this.build();
    for (const b of bodies.slice(0, 2)) {
      this.page.plain(capital(`${name(b)}spheres`), whole(b.chosen), '', '', `recommended ${whole(b.recommended)}`, 'main half');
      this.page.plain('Intersection over union', number(this.chosen(b).iou, 3), '', '', '1 is the body itself', 'half');
      this.page.plain('Mean distance', number(mm * meanOf(this.chosen(b)), 3), 'mm', '', `greatest ${number(mm * worstOf(this.chosen(b)), 3)} mm`, 'half');
      this.page.plain('Volume of the union', percent(this.chosen(b).volume_error), '', '', 'off; mass and inertia are the body\'s own', 'half');
    }
    if (bodies.length > 1) this.tellBodies();
    this.select(0);
  }

  chosen(body) {
    return body.clumps.find((c) => c.sphere_count === body.chosen);
  }

  tellBodies() {
    table(folded(this.host, 'Each body'), [
      { head: 'body', value: (b) => b.name }, { head: 'spheres', value: (b) => b.chosen, text: (b) => whole(b.chosen) }, { head: 'IoU', value: (b) => this.chosen(b).iou, text: (b) => number(this.chosen(b).iou, 4) },
      { head: 'mean distance / mm', value: (b) => mm * meanOf(this.chosen(b)), text: (b) => number(mm * meanOf(this.chosen(b)), 3) }, { head: 'recommended', value: (b) => b.recommended, text: (b) => whole(b.recommended) }, { head: 'by mean distance', value: (b) => b.recommended_by_distance, text: (b) => whole(b.recommended_by_distance) },
    ], this.bodies, 'clumps.csv', 'Bodies and the spheres chosen for each');
  }

  build() {
    const host = this.page.picture, { bodies } = this;
    if (bodies.length > 1) {
      const group = element('div', null, host, { role: 'group', 'aria-label': 'Bodies', class: 'objects' });
      this.buttons = bodies.map((body, i) => {
        const button = element('button', body.name, group, { type: 'button' });
        button.addEventListener('click', () => this.select(i));
        return button;
      });
    }
    this.buildView();
    const label = element('label', 'Number of spheres ', host, { class: 'soft' });
    this.slider = element('input', null, label, { type: 'range', min: 0, step: 1, class: 'slider' });
    this.slider.addEventListener('input', () => this.pick(Number(this.slider.value)));
    this.told = element('p', null, host, { 'aria-live': 'polite', class: 'level-text' });
    this.chartHost = element('div', null, this.host, { class: 'grid' });
    this.tableHost = folded(this.host, 'Every number of spheres', false);
  }

  buildView() {
    const host = element('div', null, this.page.picture);
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
    this.page.pointer.show('spheres', clump.sphere_count);
  }

  draw() {
    const { spheres } = this.bodies[this.state.body].clumps[this.state.row];
    this.view?.showSpheres(spheres, this.mesh, this.frame, this.state.surface);
  }

  drawChart() {
    const { clumps, recommended, size } = this.bodies[this.state.body], xs = clumps.map((c) => c.sphere_count);
    this.chartHost.replaceChildren();
    this.page.pointer.plots = [];
    if (clumps.length < 2) return;
    for (const [title, yl, lines] of [['How far spheres and body are apart', 'share', [['1 − IoU', (c) => 1 - c.iou], ['mean distance / L', (c) => meanOf(c) / size]]], ['What is least at the recommended number', 'criterion', [['1 − IoU + n/200', (c) => c.volume_criterion]]]]) {
      const all = lines.map(([name, value]) => ({ name, values: clumps.map(value) }));
      const plot = new Plot(this.page.pointer, { r: 110, x: [xs[0], xs.at(-1)], xlog: true, y: span(all.flatMap(({ values }) => values)), xl: 'spheres', yl }).vline(recommended, 'c3', '4 3');
      all.forEach(({ name, values }, i) => plot.line(xs, values, `c${i + 1}`).end(values.at(-1), name, `t${i + 1}`));
      plot.follow('spheres', xs, all, { unit: ' spheres', digits: 3, text: whole, pick: (i) => this.pick(i) }).put(this.chartHost, title, `Dashed: recommended, ${whole(recommended)}. Click: that many above.`);
    }
  }

  tellTable() {
    const { name, clumps } = this.bodies[this.state.body];
    const column = (head, value, digits = 3) => ({ head, value, text: (c) => number(value(c), digits) });
    this.tableHost.querySelectorAll(':scope > :not(summary)').forEach((each) => each.remove());
    table(this.tableHost, [
      { head: 'spheres', value: (c) => c.sphere_count, text: (c) => whole(c.sphere_count) },
      column('IoU', (c) => c.iou, 4), column('mean distance / mm', (c) => mm * meanOf(c)), column('greatest / mm', (c) => mm * worstOf(c)),
      { head: 'volume', value: (c) => c.volume_error, text: (c) => percent(c.volume_error) },
      { head: 'inertia', value: (c) => c.inertia_error, text: (c) => percent(c.inertia_error) },
      column('roughness / mm', (c) => mm * c.roughness), column('normals / °', (c) => c.slope_deg), column('1 − IoU + n/200', (c) => c.volume_criterion, 4), column('mean/L + n/5000', (c) => c.distance_criterion, 4),
    ], clumps, `${name}-clumps.csv`, 'Errors against the number of spheres');
  }
}
