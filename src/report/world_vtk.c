/* A world as VTK files: what each view holds is said in scree/report.h. A view is counted
 * first, then filled into points, cells and a row over each of them, then written. */
#include "base/array.h"
#include "base/vec.h"
#include "report/program.h"
#include "report/shapes.h"
#include "report/vtk.h"

#include <math.h>
#include <string.h>

enum { SPHERE_LEVEL = 2, ROUND_SIDES = 96 };

/* Points and triangles, growing together. */
typedef struct sheet {
  double *points;
  uint32_t *triangles;
  size_t point_count, triangle_count;
} sheet;

static void free_sheet(sheet *s) {
  scree_free(s->points);
  scree_free(s->triangles);
}

static scree_status make_room(sheet *s, size_t point_count, size_t triangle_count,
                              scree_error *error) {
  if (point_count > UINT32_MAX)
    return scree_fail(error, SCREE_LIMIT,
                      "world: %zu points do not fit into one file; at most 4294967295",
                      point_count);
  SCREE_TRY_ALLOC(s->points, 3 * point_count, error);
  SCREE_TRY_ALLOC(s->triangles, 3 * triangle_count, error);
  return SCREE_OK;
}

/* The mesh turned and moved, appended. */
static void add_mesh(sheet *s, const scree_mesh *mesh, const mat3 *turn, vec3 move) {
  for (size_t t = 0; t < 3 * mesh->triangle_count; t++)
    s->triangles[3 * s->triangle_count + t] = (uint32_t)s->point_count + mesh->triangles[t];
  for (size_t v = 0; v < mesh->vertex_count; v++)
    vec3_store(s->points + 3 * (s->point_count + v),
               vec3_add(mat3_mul_vec(turn, vec3_load(mesh->positions + 3 * v)), move));
  s->point_count += mesh->vertex_count;
  s->triangle_count += mesh->triangle_count;
}

static double norm_of(const double v[3]) {
  return vec3_norm(vec3_load(v));
}

typedef struct output_name {
  const char *path;
  bool overwrite;
} output_name;

/* ---- Bodies ---- */

/* What a triangle of a body carries. */
typedef struct surface_row {
  int64_t body, shape, material;
  float speed, angular_speed;
} surface_row;

static const scree_field surface_members[] = {
    SCREE_FIELD_OF(surface_row, body),          SCREE_FIELD_OF(surface_row, shape),
    SCREE_FIELD_OF(surface_row, material),      SCREE_FIELD_OF(surface_row, speed),
    SCREE_FIELD_OF(surface_row, angular_speed),
};

static void fill_surfaces(const scree_world *world, const scree_shapes *shapes, sheet *s,
                          surface_row *rows) {
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body state;
    size_t begin = s->triangle_count;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &state);
    mat3 turn = quat_to_mat3(quat_load(state.orientation));
    add_mesh(s, scree_shape_surface(shapes, shapes->of_body[i]), &turn, vec3_load(state.position));
    for (size_t t = begin; t < s->triangle_count; t++)
      rows[t] = (surface_row){
          (int64_t)i, (int64_t)shapes->of_body[i], (int64_t)scree_world_body_material(world, i),
          (float)norm_of(state.velocity), (float)norm_of(state.angular_velocity)};
  }
}

/* Writes rows over the points, or over the triangles or lines. */
static scree_status write(const scree_world *world, scree_vtk_data data, scree_vtk_rows rows,
                          const output_name *to, scree_error *error) {
  data.time = scree_world_time(world);
  return scree_vtp_write_rows(&data, &rows, to->path, to->overwrite, error);
}

static scree_vtk_data triangles_of(const sheet *s) {
  return (scree_vtk_data){.points = s->points,
                          .point_count = s->point_count,
                          .triangles = s->triangles,
                          .cell_count = s->triangle_count};
}

static scree_status write_surfaces(const scree_world *world, const output_name *to,
                                   scree_error *error) {
  SCREE_CLEANUP(scree_shapes_free) scree_shapes shapes = {0};
  SCREE_CLEANUP(free_sheet) sheet s = {0};
  size_t points = 0, triangles = 0;
  SCREE_TRY(scree_shapes_find(world, &shapes, error));
  SCREE_TRY(scree_shapes_draw(&shapes, SPHERE_LEVEL, error));
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    if (scree_world_body_removed(world, i)) continue;
    const scree_mesh *surface = scree_shape_surface(&shapes, shapes.of_body[i]);
    points += surface->vertex_count;
    triangles += surface->triangle_count;
  }
  SCREE_TRY(make_room(&s, points, triangles, error));
  SCREE_SCRATCH(surface_row, rows, triangles, error);
  fill_surfaces(world, &shapes, &s, rows);
  return write(world, triangles_of(&s), SCREE_VTK_ROWS(rows, false, surface_members), to, error);
}

typedef struct point_row {
  int64_t body, shape, material;
  double orientation[4], velocity[3], angular_velocity[3], mass, size;
} point_row;

static const scree_field point_members[] = {
    SCREE_FIELD_OF(point_row, body),     SCREE_FIELD_OF(point_row, shape),
    SCREE_FIELD_OF(point_row, material), SCREE_FIELD_OF(point_row, orientation),
    SCREE_FIELD_OF(point_row, velocity), SCREE_FIELD_OF(point_row, angular_velocity),
    SCREE_FIELD_OF(point_row, mass),     SCREE_FIELD_OF(point_row, size),
};

static scree_status write_points(const scree_world *world, const output_name *to,
                                 scree_error *error) {
  SCREE_CLEANUP(scree_shapes_free) scree_shapes shapes = {0};
  size_t count = scree_world_live_count(world), at = 0;
  SCREE_TRY(scree_shapes_find(world, &shapes, error));
  SCREE_SCRATCH(double, points, 3 * count, error);
  SCREE_SCRATCH(point_row, rows, count, error);
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body state;
    scree_particle_measures m;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &state);
    scree_particle_measure(shapes.particles[shapes.of_body[i]], &m);
    point_row *row = &rows[at];
    *row = (point_row){.body = (int64_t)i,
                       .shape = (int64_t)shapes.of_body[i],
                       .material = (int64_t)scree_world_body_material(world, i),
                       .mass = scree_world_body_mass(world, i),
                       .size = m.size};
    memcpy(row->orientation, state.orientation, sizeof state.orientation);
    memcpy(row->velocity, state.velocity, sizeof state.velocity);
    memcpy(row->angular_velocity, state.angular_velocity, sizeof state.angular_velocity);
    memcpy(points + 3 * at++, state.position, sizeof state.position);
  }
  const scree_vtk_data data = {.points = points, .point_count = count};
  return write(world, data, SCREE_VTK_ROWS(rows, true, point_members), to, error);
}

/* ---- Contacts ---- */

/* A touching pair with the sums over its features. */
typedef struct pair_row {
  int64_t body, other, feature_count;
  uint8_t wall;
  vec3 force, normal_force, tangential_force;
  vec3 place;    /* the sum of weight times position; then their mean */
  double weight; /* force */
  double overlap;
} pair_row;

static const scree_field pair_members[] = {
    SCREE_FIELD_OF(pair_row, body),
    SCREE_FIELD_OF(pair_row, other),
    SCREE_FIELD_OF(pair_row, wall),
    SCREE_FIELD_OF(pair_row, feature_count),
    SCREE_FIELD_OF(pair_row, force),
    SCREE_FIELD_OF(pair_row, normal_force),
    SCREE_FIELD_OF(pair_row, tangential_force),
    SCREE_FIELD_OF(pair_row, place),
    SCREE_FIELD_OF(pair_row, overlap),
};

typedef struct pair_list {
  pair_row *items;
  size_t count, capacity;
  bool failed; /* memory ran out */
} pair_list;

/* The features of a pair follow each other. */
static bool add_feature(void *context, const scree_contact *c) {
  pair_list *list = context;
  pair_row *p = list->count ? &list->items[list->count - 1] : NULL;
  const pair_row first = {.body = (int64_t)c->body, .other = (int64_t)c->other, .wall = c->wall};
  if (!p || p->body != first.body || p->other != first.other || p->wall != first.wall) {
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

static void free_pairs(pair_list *pairs) {
  scree_free(pairs->items);
}

static scree_status write_contacts(const scree_world *world, const output_name *to,
                                   scree_error *error) {
  SCREE_CLEANUP(free_pairs) pair_list pairs = {0};
  SCREE_CLEANUP(free_sheet) sheet s = {0};
  SCREE_TRY(scree_world_visit_contacts(world, add_feature, &pairs, error));
  size_t count = pairs.count;
  if (pairs.failed)
    return scree_fail_memory(error, count * sizeof *pairs.items, "the contacts of a world");
  SCREE_TRY(make_room(&s, 2 * count, 0, error));
  SCREE_SCRATCH(uint32_t, lines, 2 * count, error);
  for (size_t i = 0; i < count; i++) {
    pair_row *p = &pairs.items[i];
    p->place = vec3_scale(p->place, 1 / p->weight);
    vec3_store(s.points + 6 * i, centre_of(world, (size_t)p->body));
    vec3_store(s.points + 6 * i + 3, p->wall ? p->place : centre_of(world, (size_t)p->other));
  }
  for (uint32_t i = 0; i < 2 * count; i++) lines[i] = i;
  const scree_vtk_data data = {
      .points = s.points, .point_count = 2 * count, .lines = lines, .cell_count = count};
  return write(world, data, SCREE_VTK_ROWS(pairs.items, false, pair_members), to, error);
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
  mat3 turn = quat_to_mat3(quat_load(orientation));
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
    add_mesh(s, wall.mesh, &turn, at);
    break;
  }
}

scree_status scree_wall_mesh(const scree_world *world, size_t index, scree_mesh *mesh,
                             scree_error *error) {
  SCREE_CLEANUP(free_sheet) sheet s = {0};
  scree_wall wall;
  double orientation[4];
  extent e = extent_of(world);
  scree_world_get_wall(world, index, &wall);
  scree_world_wall_orientation(world, index, orientation);
  bool triangles = wall.kind == SCREE_WALL_MESH;
  SCREE_TRY(make_room(&s, triangles ? wall.mesh->vertex_count : 2 * ROUND_SIDES + 1,
                      triangles ? wall.mesh->triangle_count : 2 * ROUND_SIDES, error));
  add_wall(&s, world, index, &e);
  mat3 turn = quat_to_mat3(quat_load(orientation));
  for (size_t v = 0; v < s.point_count; v++) {
    vec3 p = vec3_sub(vec3_load(s.points + 3 * v), vec3_load(wall.position));
    vec3_store(s.points + 3 * v, mat3_tmul_vec(&turn, p));
  }
  *mesh = (scree_mesh){s.points, s.triangles, s.point_count, s.triangle_count};
  s = (sheet){0};
  return SCREE_OK;
}

typedef struct wall_row {
  int64_t wall, kind;
  double maps[SCREE_MAP_COUNT]; /* NaN where no sensor looks */
} wall_row;

/* The maps of a scene's walls, over the triangles from `begin` on. */
static scree_status fill_maps(const scree_scene *scene, size_t wall, size_t begin, const sheet *s,
                              wall_row *rows, scree_error *error) {
  size_t cells = scree_scene_wall_cells(scene, wall), triangles = s->triangle_count - begin;
  SCREE_SCRATCH(double, values, cells, error);
  for (size_t m = 0; m < SCREE_MAP_COUNT; m++) {
    bool known = scree_scene_wall_map(scene, wall, (scree_wall_map)m, values);
    for (size_t t = 0; t < triangles; t++)
      rows[begin + t].maps[m] = known ? values[cells == triangles ? t : 0] : NAN;
  }
  return SCREE_OK;
}

/* scene: whose maps it has; NULL: none. */
static scree_status write_walls(const scree_world *world, const scree_scene *scene,
                                const output_name *to, scree_error *error) {
  SCREE_CLEANUP(free_sheet) sheet s = {0};
  size_t count = scree_world_wall_count(world), points = 0, triangles = 0;
  extent e = extent_of(world);
  for (size_t i = 0; i < count; i++) {
    scree_wall wall;
    scree_world_get_wall(world, i, &wall);
    bool mesh = wall.kind == SCREE_WALL_MESH;
    points += mesh ? wall.mesh->vertex_count : 2 * ROUND_SIDES;
    triangles += mesh ? wall.mesh->triangle_count : 2 * ROUND_SIDES;
  }
  SCREE_TRY(make_room(&s, points, triangles, error));
  SCREE_SCRATCH(wall_row, rows, triangles, error);
  for (size_t i = 0; i < count; i++) {
    scree_wall wall;
    size_t begin = s.triangle_count;
    scree_world_get_wall(world, i, &wall);
    add_wall(&s, world, i, &e);
    for (size_t t = begin; t < s.triangle_count; t++)
      rows[t] = (wall_row){.wall = (int64_t)i, .kind = wall.kind};
    if (scene) SCREE_TRY(fill_maps(scene, i, begin, &s, rows, error));
  }
  char names[SCREE_MAP_COUNT][32];
  scree_field members[2 + SCREE_MAP_COUNT] = {SCREE_FIELD_OF(wall_row, wall),
                                              SCREE_FIELD_OF(wall_row, kind)};
  for (size_t m = 0; m < SCREE_MAP_COUNT; m++) {
    snprintf(names[m], sizeof names[m], "%s [%s]", scree_wall_map_name((scree_wall_map)m),
             scree_wall_map_unit((scree_wall_map)m));
    members[2 + m] = (scree_field)SCREE_FIELD_AS(wall_row, names[m], maps[m]);
  }
  const scree_vtk_rows table = {rows, sizeof *rows, false, members,
                                scene ? 2 + SCREE_MAP_COUNT : 2};
  return write(world, triangles_of(&s), table, to, error);
}

/* ---- One file ---- */

scree_status scree_world_vtp_write(const scree_world *world, scree_world_view view,
                                   const char *path, bool overwrite, scree_error *error) {
  const output_name to = {path, overwrite};
  switch (view) {
  case SCREE_VIEW_SURFACES:
    return write_surfaces(world, &to, error);
  case SCREE_VIEW_POINTS:
    return write_points(world, &to, error);
  case SCREE_VIEW_CONTACTS:
    return write_contacts(world, &to, error);
  case SCREE_VIEW_WALLS:
    return write_walls(world, NULL, &to, error);
  default:
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: view %d is none of 0 to %d", (int)view,
                      SCREE_VIEW_COUNT - 1);
  }
}

scree_status scree_scene_walls_vtp_write(const scree_scene *scene, const char *path, bool overwrite,
                                         scree_error *error) {
  const output_name to = {path, overwrite};
  return write_walls(scree_scene_view(scene), scene, &to, error);
}
