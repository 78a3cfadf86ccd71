/* Pictures of worlds and heaps: the bodies as items of the ray tracer. */
#include "base/alloc.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

static const double room = 0.85; /* of the heap's radius: a picture is wider than high */
enum { SPHERE_LEVEL = 3 };

typedef struct scene {
  scree_shapes shapes;
  scree_mesh *meshes; /* own, of shapes made of spheres; else empty */
  scree_render_item *items;
  size_t item_count;
} scene;

static scree_status make_spheres(scene *s, scree_error *error) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < s->shapes.count; i++) {
    scree_particle_measures m;
    scree_particle_measure(s->shapes.particles[i], &m);
    if (m.kind != SCREE_PARTICLE_MESH)
      status = scree_spheres_mesh(s->shapes.particles[i], SPHERE_LEVEL, &s->meshes[i], error);
  }
  return status;
}

/* run: where not NULL, the shapes are numbered as it has them. */
static void add_bodies(const scree_world *world, const scree_run *run, scene *s) {
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    if (scree_world_body_removed(world, i)) continue;
    size_t shape = s->shapes.of_body[i];
    scree_body body;
    scree_world_get_body(world, i, &body);
    scree_render_item *item = &s->items[s->item_count++];
    *item = (scree_render_item){.mesh = s->meshes[shape].triangle_count
                                            ? &s->meshes[shape]
                                            : scree_particle_mesh(s->shapes.particles[shape])};
    memcpy(item->position, body.position, sizeof item->position);
    memcpy(item->quaternion, body.orientation, sizeof item->quaternion);
    scree_shape_color_linear(run ? scree_run_body_shape(run, i) : shape, item->color);
  }
}

static scree_status draw(const scree_world *world, const scree_run *run,
                         const scree_render_options *options, const scree_progress *progress,
                         scree_image *image, scree_error *error) {
  size_t bodies = scree_world_body_count(world);
  scene s = {0};
  scree_status status = scree_shapes_find(world, &s.shapes, error);
  if (status != SCREE_OK) return status;
  s.meshes = scree_alloc_zero(s.shapes.count, sizeof *s.meshes);
  s.items = scree_alloc_zero(bodies, sizeof *s.items);
  if (!s.meshes || !s.items) {
    status = scree_fail_memory(error, bodies * sizeof *s.items, "a picture's bodies");
    goto done;
  }
  status = make_spheres(&s, error);
  if (status != SCREE_OK) goto done;
  add_bodies(world, run, &s);
  scree_render_cell cell = {s.items, s.item_count, NULL};
  status = scree_render(&cell, 1, options, progress, image, error);
done:
  for (size_t i = 0; s.meshes && i < s.shapes.count; i++) scree_mesh_free(&s.meshes[i]);
  scree_free(s.meshes);
  scree_free(s.items);
  scree_shapes_free(&s.shapes);
  return status;
}

scree_status scree_world_picture(const scree_world *world, const scree_render_options *options,
                                 const scree_progress *progress, scree_image *image,
                                 scree_error *error) {
  return draw(world, NULL, options, progress, image, error);
}

/* The heap in the middle: as wide as its base, or as most of the bodies lie where there is none. */
static scree_status focus_on_heap(const scree_run *run, scree_render_options *o,
                                  scree_error *error) {
  scree_run_result result;
  scree_status status = scree_run_measure(run, &result, error);
  if (status != SCREE_OK) return status;
  const scree_repose *r = &result.repose;
  double radius =
      r->heap && isfinite(r->base_radius) ? fmin(r->base_radius, r->run_out) : 0.6 * r->run_out;
  o->focus[0] = r->axis[0];
  o->focus[1] = r->axis[1];
  o->focus[2] = 0.35 * r->peak;
  o->focus_radius = room * fmax(radius, 0.6 * r->peak);
  return SCREE_OK;
}

scree_status scree_run_picture(const scree_run *run, const scree_render_options *options,
                               const scree_progress *progress, scree_image *image,
                               scree_error *error) {
  scree_render_options o = options ? *options : scree_default_render_options();
  scree_status status = o.focus_radius > 0 ? SCREE_OK : focus_on_heap(run, &o, error);
  if (status != SCREE_OK) return status;
  return draw(scree_run_view(run), run, &o, progress, image, error);
}
