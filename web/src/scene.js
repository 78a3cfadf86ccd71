// The section of one scene (result.json with scene.yaml, docs/reference/formats.md): its bodies and walls to play, what its
// sensors read beside them.
import { PlayedSection, known } from './played.js';
import { counted, element, number, whole } from './text.js';

// The angle of repose three ways, or why there is none.
function angleText(pile) {
  if (!pile.heap) return `${pile.name}: there is no heap: ${pile.no_heap_because}.`;
  const ways = [['the sectors', pile.sectors, pile.sectors.sd_deg], ['the cone', pile.cone, null], ['the silhouettes', pile.silhouettes, pile.silhouettes.sd_deg]];
  const angles = ways.filter(([, way]) => known(way.angle_deg)).map(([name, way, sd]) => `${number(way.angle_deg, 3)}°${known(sd) ? ` ± ${number(sd, 2)}°` : ''} by ${name}`);
  return `Angle of repose: ${angles.join(', ')}${known(pile.spread_deg) ? `; the three ways differ by ${number(pile.spread_deg, 2)}°` : ''}.`;
}

export class SceneSection extends PlayedSection {
  constructor(host, folder) {
    const { scene } = folder;
    super(host, folder, Object.fromEntries(scene.columns.map(({ name, values }) => [name, values])));
    this.scene = scene;
    this.tell();
    this.addPlayer('The scene in 3D', folder.scene_picture);
    this.tellShapes(scene.shapes.map(({ name }) => name));
    this.reading = element('p', null, this.player.box, { class: 'soft' });
    this.drawSensors();
    this.tellTables();
    this.play(new Map(folder.piles).get('scene'));
  }

  tell() {
    const { host, scene } = this;
    const { book } = scene;
    element('h1', scene.title ?? this.name, host);
    element('p', `${scene.whole ? 'Ended' : 'Stopped'} after ${number(scene.time, 4)} s: ${scene.ended_because}. ${counted(book.entered_count, 'particle')} came in, ${whole(book.inside_count)} inside, ${whole(book.left_count)} went out.`, host, { class: 'answer' });
    const waiting = book.waiting_count ? ` ${whole(book.waiting_count)} wait for room at inlets.` : '';
    for (const pile of scene.piles) element('p', angleText(pile), host, { class: 'answer' });
    element('p', `${number(book.entered_mass, 5)} kg came in, ${number(book.inside_mass, 5)} kg inside, ${number(book.left_mass, 5)} kg went out.${waiting} Energy unaccounted for: ${number(100 * book.ledger, 2)} % of what was turned over.`, host, { class: 'soft' });
  }

  // Each sensor's columns, by its name.
  sensors() {
    const groups = new Map();
    for (const { name, unit } of this.scene.columns) {
      const [sensor, what, ...shape] = name.split('.');
      if (!what) continue;
      if (!groups.has(sensor)) groups.set(sensor, new Map());
      const kinds = groups.get(sensor);
      const kind = what.replace(/_[xyz]$/, '');
      if (!kinds.has(kind)) kinds.set(kind, { unit, columns: [] });
      kinds.get(kind).columns.push([shape.length ? shape.join('.') : what, name]);
    }
    return groups;
  }

  toldAt(time) {
    const { series } = this;
    const i = this.pointAt(time);
    if (i < 0) return '';
    this.reading?.replaceChildren([...this.sensors()].flatMap(([sensor, kinds]) => [...kinds].map(([kind, { unit, columns }]) => {
      const values = columns.slice(0, 3).map(([, name]) => (known(series[name][i]) ? number(series[name][i], 3) : '–')).join(', ');
      return `${sensor} ${kind.replaceAll('_', ' ')} ${values}${unit ? ` ${unit}` : ''}`;
    })).join('; '));
    const phase = this.scene.phases[series.phase?.[i]];
    return `${phase ? `Phase ${phase}: ` : ''}${whole(series.inside[i])} inside, ${whole(series.left[i])} out, highest speed ${number(series.highest_speed[i], 3)} m/s`;
  }

  drawSensors() {
    for (const [sensor, kinds] of this.sensors())
      for (const [kind, { unit, columns }] of kinds)
        if (columns.some(([, name]) => this.series[name].some((value) => known(value) && value !== 0))) this.chart(`${sensor}: ${kind.replaceAll('_', ' ')}`, `${kind.replaceAll('_', ' ')}${unit ? ` / ${unit}` : ''}`, columns.slice(0, 4));
    this.chart('Bodies', 'bodies', [['came in', 'entered'], ['inside', 'inside'], ['went out', 'left'], ['waiting', 'waiting']]);
    this.fallingChart('Energy of motion', 'energy / J', [['translation', 'kinetic'], ['rotation', 'rotational']]);
    this.chart('Rotational velocity', 'mean |ω| / (rad/s)', [['mean |ω|', 'mean_rotation']], { from: 2 });
  }

  tellTables() {
    const { scene } = this;
    const read = scene.columns.filter(({ name }) => name.includes('.'));
    if (read.length) this.values('The sensors at the end', read.map(({ name, unit, last }) => [`${name}${unit ? ` / ${unit}` : ''}`, last]), 'sensors');
    for (const p of scene.piles) {
      this.values(`The heap ${p.name}`, [
        ['angle by sectors / °', p.sectors.angle_deg], ['its standard deviation / °', p.sectors.sd_deg], ['sectors with a flank', p.sectors.count],
        ['angle by the cone / °', p.cone.angle_deg], ['its misfit, rms / mm', known(p.cone.rms) ? 1000 * p.cone.rms : null],
        ['angle by silhouettes / °', p.silhouettes.angle_deg], ['its standard deviation / °', p.silhouettes.sd_deg],
        ['the three ways differ by / °', p.spread_deg], ['angle by volume and centroid / °', p.volume_deg],
        ['height / mm', 1000 * p.height], ['base radius / mm', known(p.base_radius) ? 1000 * p.base_radius : null], ['run-out / mm', 1000 * p.run_out],
        ['packing fraction', p.packing_fraction], ['bodies', p.body_count], ['particle size / mm', 1000 * p.particle_size],
      ], 'heap');
    }
    this.values('Where bodies came in and went out', [
      ...scene.inlets.map(({ name, count, mass, waiting }) => [`inlet ${name}`, `${whole(count)}, ${number(mass, 5)} kg${waiting ? `, ${whole(waiting)} wait` : ''}`]),
      ...scene.outlets.map(({ name, count, mass }) => [name ? `outlet ${name}` : 'over the rim of the domain', `${whole(count)}, ${number(mass, 5)} kg`]),
    ], 'book');
    this.shapeTable(scene.shapes);
    this.saveSeries();
  }
}
