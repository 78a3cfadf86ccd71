// The section of one pour (drop.json, docs/reference/formats.md): the particles to play, the curves beside them.
import { PlayedSection, known } from './played.js';
import { counted, element, number, whole } from './text.js';

export class PourSection extends PlayedSection {
  constructor(host, folder) {
    super(host, folder, folder.pour.series);
    const id = new Map(folder.piles).get('pour');
    this.pour = folder.pour;
    this.tell();
    this.addPlayer('The pour in 3D', folder.pour_picture);
    this.tellShapes(this.pour.shapes.map(({ name }) => name));
    this.drawEnergies();
    this.tellTables();
    this.play(id);
  }

  tell() {
    const { host, pour } = this;
    const { result: r, options: o, shapes } = pour;
    const mm = (x) => number(1000 * x, 4);
    const container = o.container === 'box' ? `a box of ${mm(o.width)} × ${mm(o.depth)} mm` : `a cylinder of ${mm(o.width)} mm`;
    element('h1', `${counted(r.particle_count, 'particle')} of ${shapes.length === 1 ? `one shape, ${shapes[0].name},` : `${whole(shapes.length)} shapes`} poured into ${container}`, host);
    const end = r.stopped_because ? `Stopped after ${number(r.time, 4)} s: ${r.stopped_because}` : `${r.still ? 'Still' : 'Not yet still'} after ${number(r.time, 4)} s`;
    element('p', `${end}; each particle touches ${number(r.coordination, 3)} others or walls, the largest overlap is ${number(1e6 * r.largest_overlap, 3)} µm.`, host, { class: 'answer' });
    const lost = this.unaccounted();
    element('p', `${whole(r.entered_count)} of ${counted(r.particle_count, 'particle')} ${r.particle_count === 1 ? 'is' : 'are'} in, ${counted(r.contact_count, 'contact')} in ${counted(r.pair_count, 'touching pair')}. ${number(r.entered_energy, 4)} J came in${known(lost) ? `, of which ${number(100 * lost, 2)} % are not accounted for at the end` : ''}. Seed ${o.seed}.${o.stiffness_factor === 1 ? '' : ` All stiffnesses times ${number(o.stiffness_factor)}: overlaps are larger by its inverse.`}`, host, { class: 'soft' });
  }

  // Energies of the end, all together, against what came in: the share that is missing or too much.
  unaccounted() {
    const { result: r } = this.pour;
    const all = r.kinetic + r.rotational + r.potential + r.elastic + r.dissipated_dashpot + r.dissipated_friction;
    return r.entered_energy > 0 ? (all - r.entered_energy) / r.entered_energy : null;
  }

  toldAt(time) {
    const { series } = this;
    const i = this.pointAt(time);
    if (i < 0) return '';
    return `kinetic energy ${number(series.kinetic[i] + series.rotational[i], 3)} J, ${whole(series.contact_count[i])} contacts, highest speed ${number(series.highest_speed[i], 3)} m/s`;
  }

  drawEnergies() {
    this.fallingChart('Energy of motion against time', 'energy / J', [['translation', 'kinetic'], ['rotation', 'rotational']]);
    this.chart('Where the energy went', 'energy / J', [['potential', 'potential'], ['lost to dashpots', 'dissipated_dashpot'], ['lost to friction', 'dissipated_friction'], ['came in', 'entered_energy']]);
    this.chart('Rotational velocity against time', 'mean |ω| / (rad/s)', [['mean |ω|', 'mean_rotation']], { from: 2 });
    this.chart('Neighbours against time', 'touching neighbours a particle', [['coordination', 'coordination']], { from: 3 });
  }

  tellTables() {
    const { pour } = this;
    const { result: r } = pour;
    this.values('The end', [
      ['time / s', r.time], ['steps', r.step_count], ['time step / µs', 1e6 * r.time_step], ['particles in', r.entered_count], ['touching pairs', r.pair_count], ['contacts', r.contact_count],
      ['coordination number', r.coordination], ['largest overlap / µm', 1e6 * r.largest_overlap], ['highest speed / (m/s)', r.highest_speed], ['mean rotation / (rad/s)', r.mean_rotation],
      ['energy that came in / J', r.entered_energy], ['kinetic / J', r.kinetic], ['rotational / J', r.rotational], ['potential / J', r.potential], ['elastic / J', r.elastic],
      ['lost to dashpots / J', r.dissipated_dashpot], ['lost to friction / J', r.dissipated_friction],
    ], 'end');
    this.shapeTable(pour.shapes, [{ head: 'particles', value: (s) => s.count, text: (s) => whole(s.count) }]);
    this.fields('The options', [pour.options], 'options');
    this.saveSeries();
  }
}
