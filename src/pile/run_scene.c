/* The experiment of Katagiri and Koyanaka (2020), section 2.3, written as a scene: particles enter
 * in layers at the top of a cylinder, settle, the cylinder is raised, the heap comes to rest.
 *
 * The inlet lies above where the packed heap will end, and rises with the heap if that comes too
 * near; or, by phases.inlet, it begins near the disc and only rises with the heap, so that nothing
 * hits harder than it must. */
#include "pile/run.h"

static const double loose_packing = 0.30;    /* solid fraction that sets the height of the inlet */
static const double clearance_share = 0.005; /* of the particle size, kept free on each side */
static const double cylinder_length = 100;   /* m: its upper end is never met */
static const double fall_below = 0.5;        /* m under the disc where bodies are taken out */
static const double rim = 1.5;               /* of the longest particle: measured beyond the disc */
enum { TICK_STEPS = 200 };

static double inlet_height(const scree_run *run) {
  const scree_experiment *e = &run->experiment;
  double radius = 0.5 * e->cylinder_diameter;
  return run->solid_volume / (loose_packing * 3.14159265358979 * radius * radius) + e->drop_height;
}

static void put_materials(const scree_run *run, FILE *out) {
  const scree_experiment *e = &run->experiment;
  fprintf(out, "materials:\n  wall: {young: %.17g, restitution: %.17g, friction: %.17g}\n",
          e->young_wall, e->restitution, e->friction_wall);
  fprintf(out, "  grain: {young: %.17g, density: %.17g, restitution: %.17g, friction: %.17g}\n",
          e->young_particle, e->density, e->restitution, e->friction_particle);
  fprintf(out, "pairs:\n  - {between: [grain, wall], restitution: %.17g, friction: %.17g}\n",
          e->restitution, e->friction_wall);
}

static void put_equipment(const scree_run *run, FILE *out) {
  const scree_experiment *e = &run->experiment;
  fputs("shapes:\n", out);
  for (size_t i = 0; i < run->shape_count; i++)
    fprintf(out, "  grain-%zu: {given: grain-%zu, material: grain, density: %.17g}\n", i, i,
            e->density * run->shapes[i].density_factor);
  fprintf(out, "geometry:\n  disc: {disc: {radius: %.17g}, material: wall}\n",
          0.5 * e->disc_diameter);
  fprintf(out,
          "  cylinder: {cylinder: {radius: %.17g, length: %.17g}, material: wall, motion: "
          "[{translate: {velocity: [0, 0, %.17g]}, during: lift}]}\n",
          0.5 * e->cylinder_diameter, fmax(cylinder_length, 10 * inlet_height(run)), e->lift_speed);
  fprintf(out, "domain: {min: [-1e9, -1e9, %.17g], max: [1e9, 1e9, 1e9]}\n", -fall_below);
}

static void put_filling(const scree_run *run, FILE *out) {
  const scree_experiment *e = &run->experiment;
  fprintf(out, "inlets:\n  fill:\n    cylinder: {at: [0, 0, %.17g], radius: %.17g}\n    shapes: [",
          e->inlet == SCREE_INLET_TOP ? inlet_height(run) : e->drop_height,
          0.5 * e->cylinder_diameter);
  for (size_t i = 0; i < run->shape_count; i++) fprintf(out, "%sgrain-%zu", i ? ", " : "", i);
  fprintf(out,
          "]\n    count: %zu\n    layers: {pack_time: %.17g, above: %.17g, clearance: %.17g}\n",
          e->particle_count, e->pack_time, e->drop_height, clearance_share * run->size);
}

static void put_phases(const scree_run *run, FILE *out) {
  const scree_experiment *e = &run->experiment;
  char still[48] = "", hold[48];
  snprintf(hold, sizeof hold, ", still: %.17g", e->still_energy);
  if (e->stop_when_still) snprintf(still, sizeof still, "%s", hold);
  fprintf(out,
          "phases:\n  pack: {time: %.17g, filled: true}\n  settle: {time: %.17g%s}\n"
          "  lift: {time: %.17g%s%s}\n  hold: {time: %.17g%s}\n",
          e->pack_time, e->settle_time, still, e->lift_time, still,
          e->stop_when_still ? ", clear: cylinder" : "", e->hold_time, hold);
}

static void put_sensors(const scree_run *run, FILE *out) {
  const scree_experiment *e = &run->experiment;
  scree_plan_pile p = scree_run_pile(run, e);
  fprintf(out,
          "sensors:\n  cylinder: {position: cylinder}\n  heap: {pile: {disc: %.17g, reach: %.17g, "
          "size: %.17g, cell: %.17g, sectors: %zu, band_low: %.17g, band_high: %.17g, every: "
          "%.17g, during: [lift, hold]}}\n",
          p.disc, p.reach, p.size, p.cell, p.sectors, p.band_low, p.band_high, e->angle_interval);
  fprintf(out, "output: {frames: %.17g, series: %.17g, checkpoint: %.17g}\n", e->frame_interval,
          e->series_interval, e->checkpoint_interval);
}

static void put_scene(const void *context, FILE *out) {
  const scree_run *run = context;
  const scree_experiment *e = &run->experiment;
  fprintf(out, "title: angle of repose\nseed: %llu\ntick: %d\ngravity: [0, 0, %.17g]\n",
          (unsigned long long)e->seed, TICK_STEPS, -e->gravity);
  fprintf(out, "contact: {law: %s, steps: %.17g, stiffness_factor: %.17g}\n",
          e->contact_law == SCREE_LAW_HYSTERETIC ? "hysteretic" : "linear", e->steps_per_contact,
          e->stiffness_factor);
  put_materials(run, out);
  put_equipment(run, out);
  put_filling(run, out);
  put_phases(run, out);
  put_sensors(run, out);
}

scree_plan_pile scree_run_pile(const scree_run *run, const scree_experiment *measure) {
  double longest = 0, more = clearance_share * run->size;
  for (size_t i = 0; i < run->shape_count; i++) {
    scree_placement p = scree_placement_of(run->shapes[i].particle, more);
    longest = fmax(longest, 2 * fmin(p.radius, vec3_norm(p.half)));
  }
  double disc = 0.5 * run->experiment.disc_diameter;
  return (scree_plan_pile){.disc = disc,
                           .reach = disc + rim * longest,
                           .size = run->size,
                           .cell = measure->height_cell,
                           .sectors = measure->sector_count,
                           .band_low = measure->band_low,
                           .band_high = measure->band_high};
}

scree_status scree_run_file(const scree_run *run, scree_scene_file **file, scree_error *error) {
  return scree_scene_file_make(put_scene, run, file, error);
}
