/* What kinds of geometry ask for: walls of a copy as it stands. */
#include "scene/geometry/kind.h"

#include "scene/walls.h"

#include <string.h>

static bool is_across(const double a[3], const double b[3]) {
  vec3 v = vec3_load(a), n = vec3_load(b);
  return fabs(vec3_dot(v, n)) <= 1e-6 * vec3_norm(v) * vec3_norm(n);
}

scree_status scree_geometry_check_surface(const scree_reader *r, const scree_plan_geometry *g,
                                          const double normal[3]) {
  if (!given(g->surface_velocity) || is_across(g->surface_velocity, normal)) return SCREE_OK;
  return scree_fail_place(r, &g->place, "surface_velocity must lie in the surface");
}

scree_status scree_geometry_check_span(const scree_reader *r, const scree_place *place,
                                       const double axis[3], const double span[3]) {
  if (is_across(axis, span)) return SCREE_OK;
  return scree_fail_place(r, place, "span must be square to the axis");
}

quat scree_geometry_turn_of(const scree_plan_geometry *g) {
  if (!g->turn) return (quat){1, 0, 0, 0};
  vec3 axis = vec3_unit(vec3_load(g->turn->axis));
  return quat_from_rotation_vector(vec3_scale(axis, SCREE_DEGREE * g->turn->angle_deg));
}

void scree_geometry_belt_loop(const scree_plan_geometry *g, double loop[3]) {
  vec3 none = {0, 0, 0};
  vec3_store(loop,
             g->belt ? vec3_scale(vec3_unit(vec3_load(g->belt->axis)), g->belt->speed) : none);
}

void scree_geometry_turn(const scree_plan_geometry *g, const double from[3], double to[3]) {
  mat3 turn = quat_to_mat3(scree_geometry_turn_of(g));
  vec3_store(to, mat3_mul_vec(&turn, vec3_load(from)));
}

static size_t material_of(const scree_scene *scene, const char *name) {
  return name ? SCREE_PLAN_FIND(scene->plan.materials, name) : 0;
}

scree_status scree_geometry_add_wall(const scree_geometry_making *m, scree_wall *wall,
                                     scree_error *error) {
  const scree_plan_geometry *g = &m->copy;
  wall->material = material_of(m->scene, g->material);
  memcpy(wall->position, g->at, sizeof wall->position);
  if (given(g->surface_velocity))
    memcpy(wall->surface_velocity, g->surface_velocity, sizeof wall->surface_velocity);
  scree_geometry_belt_loop(g, wall->surface_loop);
  return scree_world_add_wall(m->world, wall, NULL, error);
}

/* A line more about the geometry; the first time that it is made. */
static scree_status note(const scree_geometry_making *m, const char *text, scree_error *error) {
  const char **notes = &m->scene->geometry[m->index].note, *old = *notes;
  size_t size = (old ? strlen(old) + 1 : 0) + strlen(text) + 1;
  char *lines = scree_arena_take(&m->scene->arena, size, 1);
  if (!lines) return scree_fail_memory(error, size, "a wall's line");
  snprintf(lines, size, "%s%s%s", old ? old : "", old ? "\n" : "", text);
  *notes = lines;
  return SCREE_OK;
}

static scree_status add_walls(const scree_geometry_making *m, bool is_file,
                              const scree_scene_walls *walls, scree_error *error) {
  scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &walls->solid};
  if (walls->solid.triangle_count) SCREE_TRY(scree_geometry_add_wall(m, &wall, error));
  wall.mesh = &walls->sheet;
  wall.two_sided = true;
  if (walls->sheet.triangle_count) SCREE_TRY(scree_geometry_add_wall(m, &wall, error));
  return m->tells && (is_file || !walls->is_plain) ? note(m, walls->note, error) : SCREE_OK;
}

scree_status scree_geometry_add_mesh(const scree_geometry_making *m, bool is_file, scree_mesh *mesh,
                                     scree_error *error) {
  scree_scene_walls walls;
  for (size_t v = 0; m->copy.turn && v < mesh->vertex_count; v++)
    scree_geometry_turn(&m->copy, mesh->positions + 3 * v, mesh->positions + 3 * v);
  scree_status status = scree_scene_make_walls(m->scene, &m->copy, mesh, &walls, error);
  scree_mesh_free(mesh);
  if (status != SCREE_OK) return status;
  status = add_walls(m, is_file, &walls, error);
  scree_scene_walls_free(&walls);
  return status;
}
