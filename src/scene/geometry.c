/* Geometry: walls of the world, their motions, and whether a body that is placed is clear of them.
 */
#include "scene/walls.h"

#include "particle/closest.h"
#include "particle/shape.h"
#include "scene/solids.h"
#include "world/loop.h"

#include <string.h>

static const double degree = 0.017453292519943295, two_pi = 6.283185307179586;

static const scree_plan_geometry *plan_of(const scree_scene *scene, size_t index) {
  return &scene->plan.geometry.items[index];
}

/* ---- into the world ---- */

static quat turn_of(const scree_plan_geometry *g) {
  if (!g->turn) return (quat){1, 0, 0, 0};
  vec3 axis = vec3_unit(vec3_load(g->turn->axis));
  return quat_from_rotation_vector(vec3_scale(axis, degree * g->turn->angle_deg));
}

static void turn_vector(const scree_plan_geometry *g, const double from[3], double to[3]) {
  mat3 turn = quat_to_mat3(turn_of(g));
  vec3_store(to, mat3_mul_vec(&turn, vec3_load(from)));
}

static void turn_mesh(const scree_plan_geometry *g, scree_mesh *mesh) {
  if (!g->turn) return;
  for (size_t v = 0; v < mesh->vertex_count; v++)
    turn_vector(g, mesh->positions + 3 * v, mesh->positions + 3 * v);
}

static size_t material_of(const scree_scene *scene, const char *name) {
  return name ? SCREE_PLAN_FIND(scene->plan.materials, name) : 0;
}

void scree_scene_belt_loop(const scree_plan_geometry *g, double loop[3]) {
  vec3 none = {0, 0, 0};
  vec3_store(loop,
             g->belt ? vec3_scale(vec3_unit(vec3_load(g->belt->axis)), g->belt->speed) : none);
}

static scree_status add_wall(const scree_scene *scene, const scree_plan_geometry *g,
                             scree_world *world, scree_wall *wall, scree_error *error) {
  wall->material = material_of(scene, g->material);
  memcpy(wall->position, g->at, sizeof wall->position);
  if (!isnan(g->surface_velocity[0]))
    memcpy(wall->surface_velocity, g->surface_velocity, sizeof wall->surface_velocity);
  scree_scene_belt_loop(g, wall->surface_loop);
  return scree_world_add_wall(world, wall, NULL, error);
}

/* A line more about the geometry; the first time that it is made. */
static scree_status note(scree_scene *scene, size_t index, const char *text, scree_error *error) {
  const char *old = scene->geometry[index].note;
  size_t size = (old ? strlen(old) + 1 : 0) + strlen(text) + 1;
  char *lines = scree_arena_take(&scene->arena, size, 1);
  if (!lines) return scree_fail_memory(error, size, "a wall's line");
  snprintf(lines, size, "%s%s%s", old ? old : "", old ? "\n" : "", text);
  scene->geometry[index].note = lines;
  return SCREE_OK;
}

/* One copy of a geometry that goes into a world. */
typedef struct making {
  scree_scene *scene;
  size_t index; /* of the geometry */
  scree_plan_geometry copy;
  const char *folder;
  scree_world *world;
  bool tells; /* the first copy, for the gallery */
} making;

/* What is solid and what is a sheet of it; of a file (NULL: there is none) with what was done. */
static scree_status add_mesh(const making *m, const char *file, scree_mesh *mesh,
                             scree_error *error) {
  const scree_plan_geometry *g = &m->copy;
  scree_scene_walls walls;
  turn_mesh(g, mesh);
  scree_status status = scree_scene_make_walls(m->scene, g, mesh, &walls, error);
  scree_mesh_free(mesh);
  if (status != SCREE_OK) return status;
  scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &walls.solid};
  if (walls.solid.triangle_count) status = add_wall(m->scene, g, m->world, &wall, error);
  wall.mesh = &walls.sheet;
  wall.two_sided = true;
  if (status == SCREE_OK && walls.sheet.triangle_count)
    status = add_wall(m->scene, g, m->world, &wall, error);
  if (status == SCREE_OK && m->tells && (file || !walls.is_plain))
    status = note(m->scene, m->index, walls.note, error);
  scree_scene_walls_free(&walls);
  return status;
}

static scree_status add_file(const making *m, const char *name, scree_error *error) {
  scree_read_options o = scree_default_read_options();
  scree_scan scan;
  o.unit_m = scree_plan_unit(m->copy.unit);
  SCREE_CLEANUP(scree_free_at) char *path = scree_scene_path(m->folder, name);
  if (!path) return scree_fail_memory(error, strlen(name), "a path");
  SCREE_TRY(scree_scan_read(path, &o, &scan, error));
  return add_mesh(m, name, &scan.mesh, error);
}

static scree_status add_shaft(const making *m, scree_error *error) {
  const scree_plan_geometry *g = &m->copy;
  for (int side = 0; side < 4; side++) {
    int k = side / 2;
    double half = 0.5 * (k ? g->shaft->depth : g->shaft->width), inwards = side % 2 ? -1 : 1;
    scree_plan_geometry one = *g;
    scree_wall wall = {.kind = SCREE_WALL_PLANE};
    double normal[3] = {0, 0, 0};
    normal[k] = inwards;
    one.at[k] -= inwards * half;
    turn_vector(g, normal, wall.axis);
    SCREE_TRY(add_wall(m->scene, &one, m->world, &wall, error));
  }
  return SCREE_OK;
}

/* By the numbers of the plan: a box or what solids.h makes; false: no mesh. */
static bool describes_mesh(const scree_plan_geometry *g, scree_mesh *mesh, scree_status *status,
                           scree_error *error) {
  if (!isnan(g->box[0]))
    *status = scree_box_mesh(g->box, mesh, error);
  else if (g->loop)
    *status = scree_loop_mesh(g->loop, mesh, error);
  else if (g->screw)
    *status = scree_screw_mesh(g->screw, mesh, error);
  else if (g->sieve)
    *status = scree_sieve_mesh(g->sieve, mesh, error);
  else
    return false;
  return true;
}

static scree_status add_solid(const making *m, scree_error *error) {
  const scree_plan_geometry *g = &m->copy;
  scree_wall wall = {.kind = SCREE_WALL_PLANE};
  scree_mesh mesh;
  scree_status status;
  if (g->shaft) return add_shaft(m, error);
  if (describes_mesh(g, &mesh, &status, error))
    return status == SCREE_OK ? add_mesh(m, NULL, &mesh, error) : status;
  if (g->disc) {
    wall.kind = SCREE_WALL_DISC;
    wall.radius = g->disc->radius;
    turn_vector(g, g->disc->normal, wall.axis);
  } else if (g->cylinder) {
    wall.kind = SCREE_WALL_CYLINDER;
    wall.radius = g->cylinder->radius;
    wall.length = g->cylinder->length;
    turn_vector(g, g->cylinder->axis, wall.axis);
  } else {
    turn_vector(g, g->plane, wall.axis);
  }
  return add_wall(m->scene, g, m->world, &wall, error);
}

/* ---- copies ---- */

/* Their way; of those about an axis alone round a wheel of 1 m. */
static scree_loop loop_of(const scree_plan_round *round) {
  return (scree_loop){vec3_unit(vec3_load(round->axis)), vec3_load(round->through),
                      vec3_load(round->span), isnan(round->radius) ? 1 : round->radius};
}

static double way_of_copy(const scree_plan_round *round, size_t copy) {
  const scree_loop loop = loop_of(round);
  return scree_loop_length(&loop) * (double)copy / (double)round->count;
}

/* The geometry as the copy stands; its turn is put into `turn`. */
static scree_plan_geometry copied(const scree_plan_geometry *g, size_t copy,
                                  scree_plan_turn *turn) {
  scree_plan_geometry one = *g;
  if (copy == 0) return one;
  const scree_loop loop = loop_of(g->copies);
  const scree_loop_place place = scree_loop_at(&loop, way_of_copy(g->copies, copy));
  const quat q = quat_mul(place.turn, turn_of(g));
  const vec3 axis = {q.x, q.y, q.z};
  *turn = (scree_plan_turn){.axis = {0, 0, 1},
                            .angle_deg = 2 * scree_atan2(vec3_norm(axis), q.w) / degree};
  if (vec3_norm(axis) > 0) vec3_store(turn->axis, axis);
  vec3_store(one.at, scree_loop_carry(&loop, &place, vec3_load(g->at)));
  one.turn = turn;
  return one;
}

/* ---- motions ---- */

static void take_table(scree_wall_motion *m, const scree_table *table, scree_motion_law law) {
  if (!table->count) return;
  m->law = law;
  m->table = table->items[0];
  m->row_count = table->count;
}

static void take_sine(scree_wall_motion *m, double amplitude, double frequency, double phase) {
  m->law = SCREE_MOTION_SINE;
  m->amplitude = amplitude;
  m->frequency = frequency;
  m->phase = phase;
}

static scree_wall_motion motion_of(const scree_plan_motion *plan) {
  scree_wall_motion m = scree_default_wall_motion();
  if (plan->translate) {
    const scree_plan_translate *t = plan->translate;
    bool constant = !isnan(t->velocity[0]);
    memcpy(m.axis, constant ? t->velocity : t->along, sizeof m.axis);
    m.speed = constant ? vec3_norm(vec3_load(t->velocity)) : 0;
    if (m.speed == 0 && constant) m.axis[2] = 1; /* stands */
    take_table(&m, &t->table, SCREE_MOTION_SPEEDS);
    take_table(&m, &t->positions, SCREE_MOTION_POSITIONS);
  } else if (plan->rotate) {
    const scree_plan_rotate *t = plan->rotate;
    m.turns = true;
    memcpy(m.axis, t->axis, sizeof m.axis);
    memcpy(m.through, t->through, sizeof m.through);
    m.speed = isnan(t->speed) ? 0 : t->speed;
    if (!isnan(t->amplitude)) take_sine(&m, t->amplitude, t->frequency, t->phase);
    take_table(&m, &t->table, SCREE_MOTION_SPEEDS);
    take_table(&m, &t->positions, SCREE_MOTION_POSITIONS);
  } else if (plan->crank) {
    const scree_plan_crank *c = plan->crank;
    memcpy(m.axis, c->along, sizeof m.axis);
    take_sine(&m, c->radius, c->speed / two_pi, c->phase);
    m.law = SCREE_MOTION_CRANK;
    m.rod = c->rod;
  } else {
    const scree_plan_vibrate *v = plan->vibrate;
    memcpy(m.axis, v->along, sizeof m.axis);
    take_sine(&m, v->amplitude, v->frequency, v->phase);
  }
  return m;
}

static scree_wall_motion motion_round(const scree_plan_round *copies, double speed, size_t copy) {
  scree_wall_motion m = scree_default_wall_motion();
  memcpy(m.axis, copies->axis, sizeof m.axis);
  memcpy(m.through, copies->through, sizeof m.through);
  memcpy(m.span, copies->span, sizeof m.span);
  m.radius = copies->radius;
  m.start = way_of_copy(copies, copy);
  m.speed = speed;
  return m;
}

/* The angles first, then the ways. */
static size_t put_path(const scree_plan_path *path, scree_wall_motion *motions) {
  size_t count = 0;
  for (int k = 0; k < SCREE_PATH_COLUMNS; k++) {
    const int column = (k + 3) % SCREE_PATH_COLUMNS;
    if (!path->tables[column].count) continue;
    scree_wall_motion *m = &motions[count++];
    *m = scree_default_wall_motion();
    m->axis[2] = 0;
    m->axis[k % 3] = 1;
    m->turns = k < 3;
    memcpy(m->through, path->through, sizeof m->through);
    take_table(m, &path->tables[column], SCREE_MOTION_POSITIONS);
  }
  return count;
}

/* Of a copy; answers how many motions there are. */
static size_t put_motions(const scree_plan_geometry *g, size_t copy, scree_wall_motion *motions) {
  size_t count = 0;
  for (size_t i = 0; i < g->motion.count; i++) {
    const scree_plan_motion *plan = &g->motion.items[i];
    const size_t first = count;
    if (plan->path)
      count += put_path(plan->path, motions + count);
    else if (!plan->round)
      motions[count++] = motion_of(plan);
    else if (g->copies) /* it has them */
      motions[count++] = motion_round(g->copies, plan->round->speed, copy);
    for (size_t k = first; k < count; k++) {
      motions[k].from = plan->from;
      if (!isnan(plan->until)) motions[k].until = plan->until;
    }
  }
  return count;
}

scree_status scree_scene_set_motions(const scree_scene *scene, size_t index, scree_world *world,
                                     scree_error *error) {
  const scree_plan_geometry *g = plan_of(scene, index);
  const scree_scene_geometry *made = &scene->geometry[index];
  const size_t copies = g->copies ? g->copies->count : 1, most = SCREE_PATH_COLUMNS;
  SCREE_SCRATCH(scree_wall_motion, motions, most * g->motion.count, error);
  for (size_t w = 0; w < made->wall_count; w++) {
    const size_t count = put_motions(g, w / (made->wall_count / copies), motions);
    SCREE_TRY(scree_world_set_wall_motion(world, made->first_wall + w, motions, count, error));
  }
  return SCREE_OK;
}

/* ---- all of it ---- */

static scree_status add_copy(const making *m, scree_error *error) {
  const scree_plan_geometry *g = &m->copy;
  for (size_t k = 0; k < g->file.count; k++) SCREE_TRY(add_file(m, g->file.items[k], error));
  return g->file.count == 0 ? add_solid(m, error) : SCREE_OK;
}

static scree_status add_one(scree_scene *scene, size_t index, const char *folder,
                            scree_world *world, scree_error *error) {
  const scree_plan_geometry *g = plan_of(scene, index);
  scree_scene_geometry *made = &scene->geometry[index];
  const size_t copies = g->copies ? g->copies->count : 1;
  made->first_wall = scree_world_wall_count(world);
  for (size_t k = 0; k < copies; k++) {
    scree_plan_turn turn;
    const making m = {scene,  index, copied(g, k, &turn),
                      folder, world, k == 0 && world == scene->gallery};
    SCREE_TRY(add_copy(&m, error));
    made->wall_count = scree_world_wall_count(world) - made->first_wall;
    if (made->wall_count % (k + 1))
      return scree_fail(error, SCREE_BAD_MESH,
                        "copies: they have bodies on different sides; set side: outside");
  }
  SCREE_TRY(scree_scene_read_paths(scene, index, folder, error));
  return g->motion.count ? scree_scene_set_motions(scene, index, world, error) : SCREE_OK;
}

scree_status scree_scene_add_geometry(scree_scene *scene, const char *folder, scree_world *world,
                                      scree_error *error) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    scree_error why;
    scree_status status = add_one(scene, i, folder, world, &why);
    SCREE_TRY(scree_scene_blame(scene, &plan_of(scene, i)->place, status, &why, error));
  }
  return SCREE_OK;
}

/* ---- whether a body is clear ---- */

static bool clear_of_plane(const scree_wall *wall, const scree_placement *p) {
  double up, down;
  vec3 n = vec3_unit(vec3_load(wall->axis));
  scree_placement_reach(p, n, &up, &down);
  return vec3_dot(n, vec3_sub(p->position, vec3_load(wall->position))) > down;
}

static bool clear_of_disc(const scree_wall *wall, const scree_placement *p) {
  double up, down;
  vec3 n = vec3_unit(vec3_load(wall->axis)), d = vec3_sub(p->position, vec3_load(wall->position));
  double height = vec3_dot(n, d), away = vec3_norm(vec3_mad(d, n, -height));
  scree_placement_reach(p, n, &up, &down);
  return height > down || -height > up || away > wall->radius + p->radius;
}

static bool clear_of_cylinder(const scree_wall *wall, const scree_placement *p) {
  vec3 axis = vec3_unit(vec3_load(wall->axis)), from = vec3_load(wall->position);
  vec3 d = vec3_sub(p->position, from);
  double along = vec3_dot(d, axis), away = vec3_norm(vec3_mad(d, axis, -along));
  if (wall->length > 0 && (along < -p->radius || along > wall->length + p->radius)) return true;
  return away > wall->radius + p->radius || scree_placement_within(p, from, axis, wall->radius);
}

/* Whether a plane lies between the box, in its own frame, and the triangle: the thirteen candidates
 * of the separating axis theorem (Akenine-Moeller 2001). */
static bool box_clear_of_triangle(const vec3 c[3], vec3 half) {
  const double h[3] = {half.x, half.y, half.z};
  vec3 axes[13] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, vec3_triangle_normal(c[0], c[1], c[2])};
  for (int e = 0; e < 3; e++)
    for (int k = 0; k < 3; k++)
      axes[4 + 3 * e + k] = vec3_cross(axes[k], vec3_sub(c[(e + 1) % 3], c[e]));
  for (int i = 0; i < 13; i++) {
    double reach = h[0] * fabs(axes[i].x) + h[1] * fabs(axes[i].y) + h[2] * fabs(axes[i].z);
    double a = vec3_dot(axes[i], c[0]), b = vec3_dot(axes[i], c[1]), d = vec3_dot(axes[i], c[2]);
    if (fmin(a, fmin(b, d)) > reach || fmax(a, fmax(b, d)) < -reach) return true;
  }
  return false;
}

static bool box_clear_of_face(const scree_oriented_box *box, const scree_face *face) {
  const vec3 c[3] = {face->corner, vec3_add(face->corner, face->along1),
                     vec3_add(face->corner, face->along2)};
  vec3 seen[3];
  for (int i = 0; i < 3; i++) seen[i] = mat3_tmul_vec(&box->axes, vec3_sub(c[i], box->centre));
  return box_clear_of_triangle(seen, box->half);
}

/* Whether the box, in the surface's frame, is clear of its faces. */
static bool box_clear_of_faces(const scree_oriented_box *box, const scree_particle *surface) {
  const scree_tree *tree = &surface->face_tree;
  const scree_box own = {vec3_neg(box->half), box->half};
  const scree_box around = scree_box_moved(&own, &box->axes, box->centre);
  scree_tree_walk walk;
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (!scree_box_meets(&node->box, &around) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t i = 0; i < node->count; i++)
      if (!box_clear_of_face(box, &surface->faces[tree->order[node->first + i]])) return false;
  }
  return true;
}

static bool clear_of_mesh(const scree_world_wall *wall, const scree_placement *p) {
  const mat3 *turn = &wall->frame.rotation;
  vec3 at = wall->frame.position, centre = mat3_tmul_vec(turn, vec3_sub(p->position, at));
  scree_oriented_box box = {mat3_tmul_vec(turn, vec3_sub(p->box.centre, at)), p->box.half,
                            mat3_tmul(turn, &p->box.axes)};
  if (scree_is_near(wall->surface, centre, p->radius) && !box_clear_of_faces(&box, wall->surface))
    return false;
  return wall->surface->sheet || !scree_is_inside(wall->surface, centre);
}

bool scree_scene_is_clear(const scree_scene *scene, const scree_placement *placement,
                          size_t *blocking) {
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++) {
    scree_wall wall;
    bool clear = true;
    scree_world_get_wall(scene->world, w, &wall);
    if (wall.kind == SCREE_WALL_PLANE) clear = clear_of_plane(&wall, placement);
    if (wall.kind == SCREE_WALL_DISC) clear = clear_of_disc(&wall, placement);
    if (wall.kind == SCREE_WALL_CYLINDER) clear = clear_of_cylinder(&wall, placement);
    if (wall.kind == SCREE_WALL_MESH)
      clear = clear_of_mesh(scree_world_wall_at(scene->world, w), placement);
    *blocking = w;
    if (!clear) return false;
  }
  return true;
}
