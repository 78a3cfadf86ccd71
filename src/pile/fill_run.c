/* Filling the cylinder: a layer holds what random sequential addition puts beside and above each
 * other in a slab one and a half particles thick; layers follow at equal intervals so that all are
 * in after pack_time, and enter with the speed that takes a layer out of the way before the next:
 * the paper's inlet at the top of the cylinder. The inlet lies above where the packed heap will
 * end, and rises with the heap if that comes too near; or, by phases.inlet, it begins near the disc
 * and only rises with the heap, so that nothing hits harder than it must. */
#include "pile/run.h"

static const double loose_packing = 0.30;  /* solid fraction that sets the height of the inlet */
static const double layer_thickness = 1.5; /* of the longest particle */
static const double layer_spacing = 1.05;  /* of a layer's height, travelled before the next */
static const double entry_speed_limit = 8; /* m/s: faster hits leave the contact law's range */

static scree_fill_layer layer_at(const scree_run *run, double bottom, size_t present_count) {
  return (scree_fill_layer){run->experiment.seed,
                            run->layer_count,
                            0.5 * run->experiment.cylinder_diameter,
                            bottom,
                            run->layer_height,
                            run->present,
                            present_count};
}

static double box_length(const scree_placement *p) {
  return 2 * fmin(p->radius, vec3_norm(p->half));
}

/* The extents of the particles that have not entered yet, in their order. */
static size_t list_waiting(scree_run *run) {
  size_t left = run->experiment.particle_count - run->entered_count;
  for (size_t i = 0; i < left; i++)
    run->placements[i] = run->extents[run->order[run->entered_count + i]];
  return left;
}

/* Places everything layer by layer without moving it: how many layers there will be, exactly as
 * long as no body stands in the inlet. */
static scree_status count_layers(scree_run *run, size_t *layers, scree_error *error) {
  size_t count = list_waiting(run), placed = 0;
  for (*layers = 0; placed < count; ++*layers) {
    scree_fill_layer layer = layer_at(run, 0, 0);
    layer.layer_index = *layers;
    size_t more = scree_fill_place(&layer, run->placements + placed, count - placed);
    if (more == 0)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "a particle %.4g mm across does not fit into the cylinder of %.4g mm",
                        1e3 * box_length(&run->placements[placed]),
                        1e3 * run->experiment.cylinder_diameter);
    placed += more;
  }
  return SCREE_OK;
}

scree_status scree_run_plan_filling(scree_run *run, scree_error *error) {
  const scree_experiment *e = &run->experiment;
  size_t layers;
  run->layer_height = 0;
  for (size_t i = 0; i < run->shape_count; i++)
    run->layer_height = fmax(run->layer_height, layer_thickness * box_length(&run->extents[i]));
  scree_status status = count_layers(run, &layers, error);
  if (status != SCREE_OK) return status;
  double travel = layer_spacing * run->layer_height;
  run->layer_interval = e->pack_time / (double)layers;
  run->entry_speed = layers > 1 ? travel / run->layer_interval : 0;
  if (!(run->entry_speed <= entry_speed_limit))
    return scree_fail(
        error, SCREE_BAD_ARGUMENT,
        "%zu particles make %zu layers of %.4g mm, which would have to enter at %.3g m/s; at "
        "most %g m/s: set phases.pack_time to %.3g s or more, or a wider cylinder",
        e->particle_count, layers, 1e3 * run->layer_height, run->entry_speed, entry_speed_limit,
        travel * (double)layers / entry_speed_limit);
  double radius = 0.5 * e->cylinder_diameter;
  run->inlet_height =
      run->solid_volume / (loose_packing * 3.14159265358979 * radius * radius) + e->drop_height;
  return SCREE_OK;
}

/* The height of the highest body that is not just entering. */
static double heap_height(const scree_run *run) {
  double top = 0;
  for (size_t i = 0; i < run->entered_count; i++) {
    scree_body body;
    if (scree_world_body_removed(run->world, i)) continue;
    scree_world_get_body(run->world, i, &body);
    if (body.velocity[2] >= -0.5 * run->entry_speed)
      top = fmax(top, body.position[2] + run->extents[run->order[i]].radius);
  }
  return top;
}

/* The bodies that reach above `bottom`; returns their number. */
static size_t list_present(scree_run *run, double bottom) {
  size_t count = 0;
  for (size_t i = 0; i < run->entered_count; i++) {
    scree_body body;
    if (scree_world_body_removed(run->world, i)) continue;
    scree_world_get_body(run->world, i, &body);
    scree_placement p = run->extents[run->order[i]];
    if (body.position[2] + p.radius < bottom) continue;
    p.position = vec3_load(body.position);
    p.orientation =
        (quat){body.orientation[0], body.orientation[1], body.orientation[2], body.orientation[3]};
    scree_placement_settle(&p);
    run->present[count++] = p;
  }
  return count;
}

static scree_status add_placed(scree_run *run, const scree_placement *p, scree_error *error) {
  size_t shape = run->order[run->entered_count], index;
  scree_body body = scree_default_body();
  vec3_store(body.position, p->position);
  body.orientation[0] = p->orientation.w;
  body.orientation[1] = p->orientation.x;
  body.orientation[2] = p->orientation.y;
  body.orientation[3] = p->orientation.z;
  body.velocity[2] = -run->entry_speed;
  scree_status status = scree_world_add_body(run->world, run->shapes[shape].particle,
                                             run->materials[shape], &body, &index, error);
  if (status == SCREE_OK) run->entered_count++;
  return status;
}

scree_status scree_run_enter_layer(scree_run *run, scree_error *error) {
  double bottom = heap_height(run) + run->experiment.drop_height;
  if (run->experiment.inlet == 0) bottom = fmax(bottom, run->inlet_height);
  size_t left = list_waiting(run), present = list_present(run, bottom);
  scree_fill_layer layer = layer_at(run, bottom, present);
  size_t placed = scree_fill_place(&layer, run->placements, left);
  run->layer_count++;
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < placed; i++)
    status = add_placed(run, &run->placements[i], error);
  return status;
}
