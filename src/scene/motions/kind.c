/* What kinds of motions ask for. */
#include "scene/motions/kind.h"
#include "scene/scene.h"

void scree_motion_take_table(scree_wall_motion *m, const scree_table *table, scree_motion_law law) {
  if (!table->count) return;
  m->law = law;
  m->table = table->items[0];
  m->row_count = table->count;
}

void scree_motion_take_sine(scree_wall_motion *m, double amplitude, double frequency,
                            double phase) {
  m->law = SCREE_MOTION_SINE;
  m->amplitude = amplitude;
  m->frequency = frequency;
  m->phase = phase;
}

double scree_motion_largest(const scree_table *table) {
  double largest = 0;
  for (size_t i = 0; i < table->count; i++) largest = fmax(largest, fabs(table->items[i][1]));
  return largest;
}

double scree_motion_steepest(const scree_table *table) {
  double largest = 0;
  for (size_t i = 1; i < table->count; i++) {
    const double *row = table->items[i], *last = table->items[i - 1];
    if (row[0] > last[0]) largest = fmax(largest, fabs(row[1] - last[1]) / (row[0] - last[0]));
  }
  return largest;
}

double scree_motion_arm(const scree_scene *scene, size_t geometry, const double axis[3],
                        const double through[3]) {
  const scree_scene_geometry *g = &scene->geometry[geometry];
  const vec3 n = vec3_unit(vec3_load(axis)), from = vec3_load(through);
  double far = 0;
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    const scree_world_wall *wall = scree_world_wall_at(scene->world, w);
    for (size_t v = 0; wall->surface && v < wall->surface->mesh.vertex_count; v++) {
      vec3 p = vec3_add(mat3_mul_vec(&wall->frame.rotation,
                                     vec3_load(wall->surface->mesh.positions + 3 * v)),
                        wall->frame.position),
           d = vec3_sub(p, from);
      far = fmax(far, vec3_norm(vec3_mad(d, n, -vec3_dot(d, n))));
    }
  }
  return far;
}
