/* A world as VTK files: what each view holds is said in scree/report.h. A view is counted
 * first, then filled into one block per array, then written. */
#include "base/array.h"
#include "base/vec.h"
#include "report/program.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

enum { SPHERE_LEVEL = 2, ROUND_SIDES = 96, ARRAYS_MAX = 9 };

/* Points, cells and the arrays over them, growing together. */
typedef struct sheet {
  double *points;
  uint32_t *triangles;
  size_t point_count, triangle_count;
  size_t cell_count; /* that the arrays have room for */
  scree_vtk_array arrays[ARRAYS_MAX];
  size_t array_count;
  char names[SCREE_MAP_COUNT][32]; /* of maps, with units */
} sheet;

static void free_sheet(sheet *s) {
  scree_free(s->points);
  scree_free(s->triangles);
  for (size_t i = 0; i < s->array_count; i++) scree_free((void *)(uintptr_t)s->arrays[i].values);
  *s = (sheet){0};
}

/* A cleared array of the type for every cell; NULL where memory is out. */
static void *add_array(sheet *s, const char *name, scree_vtk_type type, size_t components) {
  size_t size = type == SCREE_VTK_FLOAT32 ? 4 : type == SCREE_VTK_UINT8 ? 1 : 8;
  void *values = scree_alloc_zero(s->cell_count, size * components);
  if (values) s->arrays[s->array_count++] = (scree_vtk_array){name, type, components, values};
  return values;
}

static bool make_room(sheet *s, size_t point_count, size_t triangle_count, size_t cell_count) {
  s->points = scree_alloc(point_count, 3 * sizeof *s->points);
  s->triangles = scree_alloc(triangle_count, 3 * sizeof *s->triangles);
  s->cell_count = cell_count;
  return s->points && s->triangles;
}

/* The mesh scaled, turned and moved, appended. */
static void add_mesh(sheet *s, const scree_mesh *mesh, double scale, const mat3 *turn, vec3 move) {
  for (size_t t = 0; t < 3 * mesh->triangle_count; t++)
    s->triangles[3 * s->triangle_count + t] = (uint32_t)s->point_count + mesh->triangles[t];
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    vec3 p = vec3_scale(vec3_load(mesh->positions + 3 * v), scale);
    vec3_store(s->points + 3 * (s->point_count + v), vec3_add(mat3_mul_vec(turn, p), move));
  }
  s->point_count += mesh->vertex_count;
  s->triangle_count += mesh->triangle_count;
}

static scree_status too_many(scree_error *error, size_t point_count) {
  return scree_fail(error, SCREE_LIMIT,
                    "world: %zu points do not fit into one file; at most 4294967295", point_count);
}

static mat3 turn_of(const double orientation[4]) {
  return quat_to_mat3((quat){orientation[0], orientation[1], orientation[2], orientation[3]});
}

static double norm_of(const double v[3]) {
  return vec3_norm(vec3_load(v));
}

/* ---- Bodies ---- */

static bool is_mesh(const scree_particle_measures *m) {
  return m->kind == SCREE_PARTICLE_MESH;
}

/* The icosphere of unit radius that stands for every sphere. */
static scree_status unit_sphere(scree_mesh *sphere, scree_error *error) {
  char name[] = "icosphere-0";
  name[sizeof name - 2] = (char)('0' + SPHERE_LEVEL);
  SCREE_TRY(scree_sample_make(name, NULL, NULL, sphere, error));
  for (size_t v = 0; v < sphere->vertex_count; v++)
    vec3_store(sphere->positions + 3 * v, vec3_unit(vec3_load(sphere->positions + 3 * v)));
  return SCREE_OK;
}

static void count_body(const scree_particle *particle, const scree_mesh *sphere, size_t *points,
                       size_t *triangles) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  const scree_mesh *mesh = is_mesh(&m) ? scree_particle_mesh(particle) : sphere;
  size_t copies = is_mesh(&m) ? 1 : m.point_count;
  *points += copies * mesh->vertex_count;
  *triangles += copies * mesh->triangle_count;
}

static void add_body(sheet *s, const scree_particle *particle, const scree_body *state,
                     const scree_mesh *sphere) {
  scree_particle_measures m;
  mat3 turn = turn_of(state->orientation);
  vec3 move = vec3_load(state->position);
  scree_particle_measure(particle, &m);
  if (is_mesh(&m)) {
    add_mesh(s, scree_particle_mesh(particle), 1, &turn, move);
    return;
  }
  for (size_t k = 0; k < m.point_count; k++) {
    double centre[3], radius;
    scree_particle_point(particle, k, centre, &radius);
    add_mesh(s, sphere, radius, &turn, vec3_add(mat3_mul_vec(&turn, vec3_load(centre)), move));
  }
}

/* What a body's triangles or its point carry. */
typedef struct body_arrays {
  int64_t *body, *shape, *material;
  float *speed, *angular_speed;
} body_arrays;

static bool add_surface_arrays(sheet *s, body_arrays *a) {
  a->body = add_array(s, "body", SCREE_VTK_INT64, 1);
  a->shape = add_array(s, "shape", SCREE_VTK_INT64, 1);
  a->material = add_array(s, "material", SCREE_VTK_INT64, 1);
  a->speed = add_array(s, "speed", SCREE_VTK_FLOAT32, 1);
  a->angular_speed = add_array(s, "angular_speed", SCREE_VTK_FLOAT32, 1);
  return s->array_count == 5;
}

static void fill_surfaces(const scree_world *world, const scree_shapes *shapes,
                          const scree_mesh *sphere, sheet *s, const body_arrays *a) {
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body state;
    size_t begin = s->triangle_count;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &state);
    add_body(s, shapes->particles[shapes->of_body[i]], &state, sphere);
    for (size_t t = begin; t < s->triangle_count; t++) {
      a->body[t] = (int64_t)i;
      a->shape[t] = (int64_t)shapes->of_body[i];
      a->material[t] = (int64_t)scree_world_body_material(world, i);
      a->speed[t] = (float)norm_of(state.velocity);
      a->angular_speed[t] = (float)norm_of(state.angular_velocity);
    }
  }
}

static scree_status make_surfaces(const scree_world *world, sheet *s, scree_error *error) {
  scree_shapes shapes = {0};
  scree_mesh sphere = {0};
  body_arrays arrays;
  size_t points = 0, triangles = 0;
  scree_status status = unit_sphere(&sphere, error);
  if (status == SCREE_OK) status = scree_shapes_find(world, &shapes, error);
  for (size_t i = 0; status == SCREE_OK && i < scree_world_body_count(world); i++)
    if (!scree_world_body_removed(world, i))
      count_body(shapes.particles[shapes.of_body[i]], &sphere, &points, &triangles);
  if (status == SCREE_OK && points > UINT32_MAX) status = too_many(error, points);
  if (status == SCREE_OK &&
      (!make_room(s, points, triangles, triangles) || !add_surface_arrays(s, &arrays)))
    status = scree_fail_memory(error, 24 * points + 44 * triangles, "the triangles of a world");
  if (status == SCREE_OK) fill_surfaces(world, &shapes, &sphere, s, &arrays);
  scree_shapes_free(&shapes);
  scree_mesh_free(&sphere);
  return status;
}

static size_t live_count(const scree_world *world) {
  size_t count = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++)
    count += !scree_world_body_removed(world, i);
  return count;
}

static void fill_points(const scree_world *world, const scree_shapes *shapes, sheet *s,
                        const body_arrays *ids, double *const reals[5]) {
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body state;
    scree_particle_measures m;
    size_t at = s->point_count;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &state);
    scree_particle_measure(shapes->particles[shapes->of_body[i]], &m);
    memcpy(s->points + 3 * at, state.position, sizeof state.position);
    ids->body[at] = (int64_t)i;
    ids->shape[at] = (int64_t)shapes->of_body[i];
    ids->material[at] = (int64_t)scree_world_body_material(world, i);
    memcpy(reals[0] + 4 * at, state.orientation, sizeof state.orientation);
    memcpy(reals[1] + 3 * at, state.velocity, sizeof state.velocity);
    memcpy(reals[2] + 3 * at, state.angular_velocity, sizeof state.angular_velocity);
    reals[3][at] = scree_world_body_mass(world, i);
    reals[4][at] = m.size;
    s->point_count++;
  }
}

static scree_status make_points(const scree_world *world, sheet *s, scree_error *error) {
  static const char *const names[5] = {"orientation", "velocity", "angular_velocity", "mass",
                                       "size"};
  static const size_t components[5] = {4, 3, 3, 1, 1};
  scree_shapes shapes = {0};
  body_arrays ids = {0};
  double *reals[5];
  size_t count = live_count(world);
  scree_status status = scree_shapes_find(world, &shapes, error);
  if (status != SCREE_OK) return status;
  if (make_room(s, count, 0, count)) {
    ids.body = add_array(s, "body", SCREE_VTK_INT64, 1);
    ids.shape = add_array(s, "shape", SCREE_VTK_INT64, 1);
    ids.material = add_array(s, "material", SCREE_VTK_INT64, 1);
    for (int k = 0; k < 5; k++) reals[k] = add_array(s, names[k], SCREE_VTK_FLOAT64, components[k]);
  }
  if (s->array_count == 8)
    fill_points(world, &shapes, s, &ids, reals);
  else
    status = scree_fail_memory(error, 150 * count, "the points of a world");
  scree_shapes_free(&shapes);
  return status;
}

/* ---- Contacts ---- */

/* A touching pair with the sums over its features. */
typedef struct pair_line {
  size_t body, other;
  bool wall;
  int64_t feature_count;
  vec3 force, normal_force, tangential_force;
  vec3 place;    /* sum of weight times position */
  double weight; /* force */
  double overlap;
} pair_line;

typedef struct pair_list {
  pair_line *items;
  size_t count, capacity;
  bool failed; /* memory ran out */
} pair_list;

/* The features of a pair follow each other. */
static bool add_feature(void *context, const scree_contact *c) {
  pair_list *list = context;
  pair_line *p = list->count ? &list->items[list->count - 1] : NULL;
  if (!p || p->body != c->body || p->other != c->other || p->wall != c->wall) {
    const pair_line first = {.body = c->body, .other = c->other, .wall = c->wall};
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): room was made */
    if (!SCREE_PUSH(list, first)) {
      list->failed = true;
      return false;
    }
    p = &list->items[list->count - 1];
  }
  vec3 force = vec3_load(c->force), n = vec3_load(c->normal);
  vec3 along = vec3_scale(n, vec3_dot(force, n));
  double weight = vec3_norm(force) + 1e-300; /* a force of zero still has a place */
  p->feature_count++;
  p->force = vec3_add(p->force, force);
  p->normal_force = vec3_add(p->normal_force, along);
  p->tangential_force = vec3_add(p->tangential_force, vec3_sub(force, along));
  p->place = vec3_mad(p->place, vec3_load(c->position), weight);
  p->weight += weight;
  p->overlap = fmax(p->overlap, c->overlap);
  return true;
}

static vec3 centre_of(const scree_world *world, size_t body) {
  scree_body state;
  scree_world_get_body(world, body, &state);
  return vec3_load(state.position);
}

typedef struct line_arrays {
  int64_t *body, *other, *feature_count;
  uint8_t *wall;
  double *force, *normal_force, *tangential_force, *place, *overlap;
} line_arrays;

static bool add_line_arrays(sheet *s, line_arrays *a) {
  a->body = add_array(s, "body", SCREE_VTK_INT64, 1);
  a->other = add_array(s, "other", SCREE_VTK_INT64, 1);
  a->wall = add_array(s, "wall", SCREE_VTK_UINT8, 1);
  a->feature_count = add_array(s, "feature_count", SCREE_VTK_INT64, 1);
  a->force = add_array(s, "force", SCREE_VTK_FLOAT64, 3);
  a->normal_force = add_array(s, "normal_force", SCREE_VTK_FLOAT64, 3);
  a->tangential_force = add_array(s, "tangential_force", SCREE_VTK_FLOAT64, 3);
  a->place = add_array(s, "place", SCREE_VTK_FLOAT64, 3);
  a->overlap = add_array(s, "overlap", SCREE_VTK_FLOAT64, 1);
  return s->array_count == 9;
}

static void fill_lines(const scree_world *world, const pair_list *pairs, sheet *s,
                       const line_arrays *a) {
  for (size_t i = 0; i < pairs->count; i++) {
    const pair_line *p = &pairs->items[i];
    vec3 place = vec3_scale(p->place, 1 / p->weight);
    vec3_store(s->points + 6 * i, centre_of(world, p->body));
    vec3_store(s->points + 6 * i + 3, p->wall ? place : centre_of(world, p->other));
    a->body[i] = (int64_t)p->body;
    a->other[i] = (int64_t)p->other;
    a->wall[i] = p->wall;
    a->feature_count[i] = p->feature_count;
    vec3_store(a->force + 3 * i, p->force);
    vec3_store(a->normal_force + 3 * i, p->normal_force);
    vec3_store(a->tangential_force + 3 * i, p->tangential_force);
    vec3_store(a->place + 3 * i, place);
    a->overlap[i] = p->overlap;
  }
  s->point_count = 2 * pairs->count;
}

static scree_status make_contacts(const scree_world *world, sheet *s, uint32_t **lines,
                                  scree_error *error) {
  pair_list pairs = {0};
  line_arrays arrays;
  scree_status status = scree_world_visit_contacts(world, add_feature, &pairs, error);
  size_t count = pairs.count;
  if (status == SCREE_OK && pairs.failed)
    status = scree_fail_memory(error, count * sizeof *pairs.items, "the contacts of a world");
  if (status == SCREE_OK && 2 * count > UINT32_MAX) status = too_many(error, 2 * count);
  if (status == SCREE_OK) {
    *lines = scree_alloc(count, 2 * sizeof **lines);
    if (*lines && make_room(s, 2 * count, 0, count) && add_line_arrays(s, &arrays)) {
      fill_lines(world, &pairs, s, &arrays);
      for (uint32_t i = 0; i < 2 * count; i++) (*lines)[i] = i;
    } else {
      status = scree_fail_memory(error, 200 * count, "the contacts of a world");
    }
  }
  scree_free(pairs.items);
  return status;
}

/* ---- Walls ---- */

/* The box of the bodies and of the walls that end. */
typedef struct extent {
  vec3 low, high;
  bool any;
} extent;

static void cover(extent *e, vec3 centre, double radius) {
  vec3 r = {radius, radius, radius}, low = vec3_sub(centre, r), high = vec3_add(centre, r);
  e->low = e->any ? vec3_min(e->low, low) : low;
  e->high = e->any ? vec3_max(e->high, high) : high;
  e->any = true;
}

static extent extent_of(const scree_world *world) {
  extent e = {0};
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_particle_measures m;
    if (scree_world_body_removed(world, i)) continue;
    scree_particle_measure(scree_world_body_particle(world, i), &m);
    cover(&e, centre_of(world, i), m.bounding_radius);
  }
  for (size_t i = 0; i < scree_world_wall_count(world); i++) {
    scree_wall wall;
    scree_world_get_wall(world, i, &wall);
    if (wall.kind == SCREE_WALL_DISC || (wall.kind == SCREE_WALL_CYLINDER && wall.length > 0))
      cover(&e, vec3_load(wall.position), wall.radius);
  }
  if (!e.any) cover(&e, (vec3){0, 0, 0}, 1);
  return e;
}

/* A ring of ROUND_SIDES points about the wall's axis. */
static void add_ring(sheet *s, const mat3 *turn, vec3 at, double radius, double height) {
  const double step = 6.283185307179586 / ROUND_SIDES;
  for (int k = 0; k < ROUND_SIDES; k++) {
    vec3 p = {radius * cos(step * k), radius * sin(step * k), height};
    vec3_store(s->points + 3 * s->point_count++, vec3_add(mat3_mul_vec(turn, p), at));
  }
}

static void add_triangle(sheet *s, size_t a, size_t b, size_t c) {
  uint32_t *t = s->triangles + 3 * s->triangle_count++;
  t[0] = (uint32_t)a, t[1] = (uint32_t)b, t[2] = (uint32_t)c;
}

static void add_disc(sheet *s, const mat3 *turn, vec3 at, double radius) {
  size_t ring = s->point_count;
  add_ring(s, turn, at, radius, 0);
  vec3_store(s->points + 3 * s->point_count++, at);
  for (size_t k = 0; k < ROUND_SIDES; k++)
    add_triangle(s, ring + k, ring + (k + 1) % ROUND_SIDES, ring + ROUND_SIDES);
}

/* Wound to be seen from inside. */
static void add_cylinder(sheet *s, const mat3 *turn, vec3 at, const scree_wall *wall,
                         const extent *e) {
  size_t low = s->point_count, high = low + ROUND_SIDES;
  double begin = 0, end = wall->length;
  if (!(end > 0)) {
    vec3 centre = vec3_lerp(e->low, e->high, 0.5);
    double half = 0.5 * vec3_distance(e->low, e->high);
    double middle = mat3_tmul_vec(turn, vec3_sub(centre, at)).z;
    begin = middle - half, end = middle + half;
  }
  add_ring(s, turn, at, wall->radius, begin);
  add_ring(s, turn, at, wall->radius, end);
  for (size_t k = 0; k < ROUND_SIDES; k++) {
    size_t next = (k + 1) % ROUND_SIDES;
    add_triangle(s, low + k, high + k, high + next);
    add_triangle(s, low + k, high + next, low + next);
  }
}

/* A square under the middle of all there is. */
static void add_plane(sheet *s, const mat3 *turn, vec3 at, const extent *e) {
  size_t first = s->point_count;
  double half = 0.5 * vec3_distance(e->low, e->high);
  vec3 middle = mat3_tmul_vec(turn, vec3_sub(vec3_lerp(e->low, e->high, 0.5), at));
  for (int k = 0; k < 4; k++) {
    vec3 p = {middle.x + (k == 1 || k == 2 ? half : -half), middle.y + (k > 1 ? half : -half), 0};
    vec3_store(s->points + 3 * s->point_count++, vec3_add(mat3_mul_vec(turn, p), at));
  }
  add_triangle(s, first, first + 1, first + 2);
  add_triangle(s, first, first + 2, first + 3);
}

static void add_wall(sheet *s, const scree_world *world, size_t index, const extent *e) {
  scree_wall wall;
  double orientation[4];
  scree_world_get_wall(world, index, &wall);
  scree_world_wall_orientation(world, index, orientation);
  mat3 turn = turn_of(orientation);
  vec3 at = vec3_load(wall.position);
  switch (wall.kind) {
  case SCREE_WALL_PLANE:
    add_plane(s, &turn, at, e);
    break;
  case SCREE_WALL_DISC:
    add_disc(s, &turn, at, wall.radius);
    break;
  case SCREE_WALL_CYLINDER:
    add_cylinder(s, &turn, at, &wall, e);
    break;
  case SCREE_WALL_MESH:
    add_mesh(s, wall.mesh, 1, &turn, at);
    break;
  }
}

scree_status scree_wall_mesh(const scree_world *world, size_t index, scree_mesh *mesh,
                             scree_error *error) {
  sheet s = {0};
  scree_wall wall;
  double orientation[4];
  extent e = extent_of(world);
  scree_world_get_wall(world, index, &wall);
  scree_world_wall_orientation(world, index, orientation);
  bool triangles = wall.kind == SCREE_WALL_MESH;
  if (!make_room(&s, triangles ? wall.mesh->vertex_count : 2 * ROUND_SIDES + 1,
                 triangles ? wall.mesh->triangle_count : 2 * ROUND_SIDES, 0)) {
    free_sheet(&s);
    return scree_fail_memory(error, 0, "a wall's triangles");
  }
  add_wall(&s, world, index, &e);
  mat3 turn = turn_of(orientation);
  for (size_t v = 0; v < s.point_count; v++) {
    vec3 p = vec3_sub(vec3_load(s.points + 3 * v), vec3_load(wall.position));
    vec3_store(s.points + 3 * v, mat3_tmul_vec(&turn, p));
  }
  *mesh = (scree_mesh){s.points, s.triangles, s.point_count, s.triangle_count};
  return SCREE_OK;
}

/* The maps of a scene's walls, a row of cells for each; NaN where no sensor looks. */
static scree_status fill_maps(const scree_scene *scene, size_t wall, size_t begin, sheet *s,
                              double *const maps[SCREE_MAP_COUNT], scree_error *error) {
  size_t cells = scree_scene_wall_cells(scene, wall), triangles = s->triangle_count - begin;
  double *values = scree_alloc(cells, sizeof *values);
  if (!values) return scree_fail_memory(error, cells * sizeof *values, "a wall's map");
  for (size_t m = 0; m < SCREE_MAP_COUNT; m++) {
    bool known = scree_scene_wall_map(scene, wall, (scree_wall_map)m, values);
    for (size_t t = 0; t < triangles; t++)
      maps[m][begin + t] = known ? values[cells == triangles ? t : 0] : NAN;
  }
  scree_free(values);
  return SCREE_OK;
}

/* scene: whose maps it has; NULL: none. */
static scree_status make_walls(const scree_world *world, const scree_scene *scene, sheet *s,
                               scree_error *error) {
  size_t count = scree_world_wall_count(world), points = 0, triangles = 0;
  extent e = extent_of(world);
  for (size_t i = 0; i < count; i++) {
    scree_wall wall;
    scree_world_get_wall(world, i, &wall);
    bool mesh = wall.kind == SCREE_WALL_MESH;
    points += mesh ? wall.mesh->vertex_count : 2 * ROUND_SIDES;
    triangles += mesh ? wall.mesh->triangle_count : 2 * ROUND_SIDES;
  }
  if (points > UINT32_MAX) return too_many(error, points);
  int64_t *number = NULL, *kind = NULL;
  double *maps[SCREE_MAP_COUNT] = {NULL};
  bool good = make_room(s, points, triangles, triangles);
  if (good) {
    number = add_array(s, "wall", SCREE_VTK_INT64, 1);
    kind = add_array(s, "kind", SCREE_VTK_INT64, 1);
    good = number && kind;
  }
  for (size_t m = 0; good && scene && m < SCREE_MAP_COUNT; m++) {
    snprintf(s->names[m], sizeof s->names[m], "%s [%s]", scree_wall_map_name((scree_wall_map)m),
             scree_wall_map_unit((scree_wall_map)m));
    maps[m] = add_array(s, s->names[m], SCREE_VTK_FLOAT64, 1);
    good = maps[m];
  }
  if (!good) return scree_fail_memory(error, 64 * triangles, "the walls of a world");
  for (size_t i = 0; i < count; i++) {
    scree_wall wall;
    size_t begin = s->triangle_count;
    scree_world_get_wall(world, i, &wall);
    add_wall(s, world, i, &e);
    for (size_t t = begin; t < s->triangle_count; t++) {
      number[t] = (int64_t)i;
      kind[t] = wall.kind;
    }
    if (scene) SCREE_TRY(fill_maps(scene, i, begin, s, maps, error));
  }
  return SCREE_OK;
}

/* ---- One file ---- */

const char *scree_world_view_name(scree_world_view view) {
  static const char *const names[] = {"surfaces", "points", "contacts", "walls"};
  return (int)view >= 0 && view < SCREE_VIEW_COUNT ? names[view] : NULL;
}

static scree_status write_view(const scree_world *world, const scree_scene *scene,
                               scree_world_view view, const char *path, bool overwrite,
                               scree_error *error) {
  sheet s = {0};
  uint32_t *lines = NULL;
  scree_status status;
  if (view == SCREE_VIEW_SURFACES)
    status = make_surfaces(world, &s, error);
  else if (view == SCREE_VIEW_POINTS)
    status = make_points(world, &s, error);
  else if (view == SCREE_VIEW_CONTACTS)
    status = make_contacts(world, &s, &lines, error);
  else if (view == SCREE_VIEW_WALLS)
    status = make_walls(world, scene, &s, error);
  else
    status = scree_fail(error, SCREE_BAD_ARGUMENT, "world: view %d is none of 0 to %d", (int)view,
                        SCREE_VIEW_COUNT - 1);
  if (status == SCREE_OK) {
    bool points = view == SCREE_VIEW_POINTS, on_lines = view == SCREE_VIEW_CONTACTS;
    scree_vtk_data data = {.points = s.points,
                           .point_count = s.point_count,
                           .triangles = points || on_lines ? NULL : s.triangles,
                           .lines = lines,
                           .cell_count = on_lines ? s.point_count / 2 : s.triangle_count,
                           .time = scree_world_time(world)};
    if (points)
      data.point_arrays = s.arrays, data.point_array_count = s.array_count;
    else
      data.cell_arrays = s.arrays, data.cell_array_count = s.array_count;
    status = scree_vtp_write(&data, path, overwrite, error);
  }
  free_sheet(&s);
  scree_free(lines);
  return status;
}

scree_status scree_world_vtp_write(const scree_world *world, scree_world_view view,
                                   const char *path, bool overwrite, scree_error *error) {
  return write_view(world, NULL, view, path, overwrite, error);
}

scree_status scree_scene_walls_vtp_write(const scree_scene *scene, const char *path, bool overwrite,
                                         scree_error *error) {
  return write_view(scree_scene_view(scene), scene, SCREE_VIEW_WALLS, path, overwrite, error);
}
