// The section of one heap (result.json, docs/reference/formats.md): its angles, the pile to play, the curves beside it.
import { PlayedSection, known } from './played.js';
import { counted, element, number, whole } from './text.js';

const phases = { packing: 'filling', settling: 'settling', lifting: 'the cylinder rises', holding: 'coming to rest', done: 'the end' };

export class HeapSection extends PlayedSection {
  constructor(host, folder) {
    super(host, folder, folder.heap.series);
    const id = new Map(folder.piles).get('heap');
    this.heap = folder.heap;
    this.tell();
    this.addPlayer('The heap in 3D', folder.heap_picture);
    this.tellShapes(this.heap.shapes.map(({ name }) => name));
    this.drawAngles();
    this.drawMotion();
    this.tellTables();
    this.play(id);
  }

  tell() {
    const { host, heap } = this;
    const { result: r, experiment: e, shapes } = heap;
    element('h1', `A heap of ${counted(e.particles, 'particle')} of ${shapes.length === 1 ? `one shape, ${shapes[0].name}` : `${whole(shapes.length)} shapes`}`, host);
    const ways = [['the sectors', r.sectors, r.sectors.sd_deg], ['the cone', r.cone, null], ['the silhouettes', r.silhouettes, r.silhouettes.sd_deg]];
    const angles = ways.filter(([, way]) => known(way.angle_deg)).map(([name, way, sd]) => `${number(way.angle_deg, 3)}°${known(sd) ? ` ± ${number(sd, 2)}°` : ''} by ${name}`);
    element('p', r.heap ? `Angle of repose: ${angles.join(', ')}${known(r.spread_deg) ? `; the three ways differ by ${number(r.spread_deg, 2)}°` : ''}.` : `There is no heap: ${r.no_heap_because}.`, host, { class: 'answer' });
    element('p', `${r.still ? 'Still' : 'Not yet still'} after ${number(r.time, 4)} s; ${counted(r.body_count, 'particle')} on the disc, ${whole(r.left_count)} fell off; ${number(1000 * r.height, 3)} mm high. Preset ${e.preset}, seed ${e.seed}.${e.preset === 'demo' ? ' The preset demo shows a heap; take no number from it.' : ''}`, host, { class: 'soft' });
  }

  // What the series says of a moment.
  toldAt(time) {
    const { series } = this;
    const i = this.pointAt(time);
    if (i < 0) return '';
    const lift = series.cylinder_height[i];
    return `${phases[series.phase[i]] ?? series.phase[i]}${lift > 0 ? `, cylinder ${number(1000 * lift, 3)} mm up` : ''}; kinetic energy ${number(series.kinetic[i], 3)} J, mean rotation ${number(series.mean_rotation[i], 3)} rad/s`;
  }

  drawAngles() {
    this.chart('Angle against time', 'angle / °', [['sectors', 'sector_deg'], ['cone', 'cone_deg'], ['silhouettes', 'silhouette_deg']], { points: true });
  }

  drawMotion() {
    this.fallingChart('Kinetic energy against time', 'energy / J', [['kinetic energy', 'kinetic']], { from: 1 });
    this.chart('Rotational velocity against time', 'mean |ω| / (rad/s)', [['mean |ω|', 'mean_rotation']], { from: 2 });
  }

  tellTables() {
    const { heap } = this;
    const { result: r, costs } = heap;
    this.values('The heap', [
      ['angle by sectors / °', r.sectors.angle_deg], ['its standard deviation / °', r.sectors.sd_deg], ['sectors with a flank', r.sectors.count],
      ['angle by the cone / °', r.cone.angle_deg], ['its misfit, rms / mm', known(r.cone.rms) ? 1000 * r.cone.rms : null],
      ['angle by silhouettes / °', r.silhouettes.angle_deg], ['its standard deviation / °', r.silhouettes.sd_deg],
      ['the three ways differ by / °', r.spread_deg], ['angle by volume and centroid / °', r.volume_deg],
      ['height / mm', 1000 * r.height], ['base radius / mm', known(r.base_radius) ? 1000 * r.base_radius : null], ['run-out / mm', 1000 * r.run_out],
      ['packing fraction', r.packing_fraction], ['coordination number', r.coordination], ['particle size / mm', 1000 * r.particle_size],
      ['kinetic energy left / J', r.kinetic],
    ], 'heap');
    this.shapeTable(heap.shapes);
    this.fields('The experiment, and what it cost', [heap.experiment, costs], 'experiment');
    this.saveSeries();
  }
}
