// What particles are poured into: templates of the library, and what this page sets in them. Lengths follow the
// largest particle.

const list = (...values) => `[${values.join(', ')}]`;
const box = (field, x, y, low, high) => ({ [`${field}.min`]: list(-x, -y, low), [`${field}.max`]: list(x, y, high) });
const common = ({ count, stiffness, friction }, grain) => ({
  'contact.stiffness_factor': stiffness, [`materials.${grain}.friction`]: friction, time: 1e6, // s: the page ends it
  ...(grain === 'grain' ? { 'materials.grain.young': 1e8, 'materials.steel.young': 1e11, 'pairs.0.friction': friction } : {}),
  ...(grain === 'grain' ? { 'inlets.feed.count': count } : { particles: count }),
});

function drum({ diameter, speed, ...others }, size) {
  const radius = 0.5 * diameter * size, half = 0.75 * size;
  return {
    ...common(others, 'grain'),
    'pairs.0.friction': 1.2, // a rough lining: a smooth shell slides under a shallow bed, which rests
    'geometry.shell.cylinder.radius': radius, 'geometry.shell.cylinder.length': 2 * half, 'geometry.shell.at': list(0, -half, 0),
    'geometry.shell.motion.0.rotate.speed': (speed * 2 * Math.PI) / 60, 'geometry.shell.motion.0.from': 0.5,
    'geometry.near.at': list(0, -half, 0), 'geometry.far.at': list(0, half, 0),
    ...box('inlets.feed.box', 0.65 * radius, half, -0.5 * radius, 0.65 * radius),
    'sensors.mixing.segregation.cells': radius,
  };
}

// The template's proportions: a bottom of four slabs round a hole, a slide under it, a pipe above.
function hopper({ opening, opens, ...others }, size) {
  const hole = opening * size, radius = Math.max(1.1 * hole, 1.5 * size), bottom = 2 * radius, thick = 0.2 * radius;
  const slab = 1.1 * radius - hole / 2, middle = (hole + slab) / 2, slide = 1.25 * hole;
  return {
    ...common(others, 'grain'),
    ...Object.fromEntries([['left', -1], ['right', 1]].flatMap(([name, side]) => [
      [`geometry.${name}.box`, list(slab, 2.2 * radius, thick)], [`geometry.${name}.at`, list(side * middle, 0, bottom)]])),
    ...Object.fromEntries([['front', -1], ['back', 1]].flatMap(([name, side]) => [
      [`geometry.${name}.box`, list(hole, slab, thick)], [`geometry.${name}.at`, list(0, side * middle, bottom)]])),
    'geometry.sides.cylinder.radius': radius, 'geometry.sides.cylinder.length': 6 * radius, 'geometry.sides.at': list(0, 0, bottom),
    'geometry.slide.box': list(slide, slide, 0.4 * thick), 'geometry.slide.at': list(0, 0, bottom - 0.8 * thick),
    'geometry.slide.motion.0.translate.velocity': list(4 * slide, 0, 0),
    'geometry.slide.motion.0.from': opens, 'geometry.slide.motion.0.until': opens + 0.5,
    'inlets.feed.cylinder.at': list(0, 0, bottom + 2.5 * radius), 'inlets.feed.cylinder.radius': 0.95 * radius, 'inlets.feed.cylinder.length': 2 * radius,
    ...box('outlets.bin.box', 4 * radius, 4 * radius, -0.2 * radius, 0.4 * size),
    'sensors.discharge.flow.through': list(0, 0, bottom - thick),
    ...box('sensors.hopper.region.box', radius, radius, bottom, bottom + 6 * radius),
    'stop.after': opens + 0.5,
  };
}

// tube: the sides of what is drawn of a container without an end; sliders: [name, text, low, high, step, value, unit]
export const equipment = {
  cylinder: { template: 'drop', tube: 64, sliders: [], fields: (values) => common(values, 'particles') },
  box: { template: 'drop-box', tube: 4, sliders: [], fields: (values) => common(values, 'particles') },
  drum: {
    template: 'drum', fields: drum,
    sliders: [['diameter', 'Diameter of the drum', 2, 6, 0.25, 3, 'particle sizes'], ['speed', 'It turns', 0, 40, 1, 12, 'times a minute']],
  },
  hopper: {
    template: 'hopper', fields: hopper,
    sliders: [['opening', 'Opening', 1, 5, 0.25, 2, 'particle sizes'], ['opens', 'It opens after', 0.5, 6, 0.5, 2, 's']],
  },
};
