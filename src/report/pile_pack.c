/* A pile packed for the page. Of every body all moments stand together, so that a body at rest
 * costs next to nothing; a motion that does not fit loses every second frame until it does. A
 * browser draws all bodies many times a second: shapes are decimated until all together have as
 * many triangles as it can take. */
#include "report/page_parts.h"

#include "base/owned.h"
#include "base/platform.h"
#include "report/pack.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

enum {
  MOST_DRAWN = 500000,     /* triangles of all bodies together */
  MOST_SHAPE = 4000,       /* of one shape */
  LEAST_SHAPE = 80,        /* below, a device is not known again */
  SPHERE_LEVEL = 2,        /* icosphere: 320 triangles */
  COARSE_SPHERE_LEVEL = 1, /* in clumps, and where there are many */
  PATH_BYTES = 4096
};
static const double one = 32767; /* of a quaternion's component */

typedef struct pile {
  scree_packing pack;
  scree_scene *scene;
  const scree_world *world; /* its */
  scree_motion motion;      /* at least one frame */
  size_t wall_count;        /* in the motion they stand before the bodies */
} pile;

/* position on the grid, whether it is there, quaternion */
typedef struct moment {
  scree_grid_point at;
  int16_t q[4];
} moment;

/* ---- what is on disk ---- */

static void put_pose(float *pose, const double position[3], const double turn[4]) {
  for (int k = 0; k < 7; k++) pose[k] = (float)(k < 3 ? position[k] : turn[k - 3]);
}

/* The last frame alone. */
static scree_status still(pile *p) {
  const scree_world *world = p->world;
  size_t bodies = scree_world_body_count(world), all = p->wall_count + bodies;
  scree_motion *m = &p->motion;
  *m = (scree_motion){.frame_count = 1, .body_count = all};
  SCREE_TRY_ALLOC(m->time, 1, p->pack.error);
  SCREE_TRY_ALLOC(m->poses, 7 * all, p->pack.error);
  m->time[0] = scree_world_time(world);
  for (size_t w = 0; w < p->wall_count; w++) {
    scree_wall wall;
    double turn[4];
    scree_world_get_wall(world, w, &wall);
    scree_world_wall_orientation(world, w, turn);
    put_pose(m->poses + 7 * w, wall.position, turn);
  }
  for (size_t b = 0; b < bodies; b++) {
    static const double gone[4] = {NAN, NAN, NAN, NAN};
    scree_body body;
    scree_world_get_body(world, b, &body);
    bool there = !scree_world_body_removed(world, b);
    put_pose(m->poses + 7 * (p->wall_count + b), there ? body.position : gone,
             there ? body.orientation : gone);
  }
  return SCREE_OK;
}

/* Whether the motion ends with the world as it stands: else it is of another run. */
static bool ends_with(const pile *p) {
  const scree_motion *m = &p->motion;
  const scree_world *world = p->world;
  size_t bodies = scree_world_body_count(world);
  if (m->frame_count == 0 || m->body_count != p->wall_count + bodies) return false;
  size_t last = m->frame_count - 1;
  if (m->time[last] != scree_world_time(world)) return false;
  for (size_t b = 0; b < bodies; b++) {
    const float *pose = m->poses + 7 * (last * m->body_count + p->wall_count + b);
    scree_body body;
    scree_world_get_body(world, b, &body);
    for (int k = 0; k < 3 && !scree_world_body_removed(world, b); k++)
      if (pose[k] != (float)body.position[k]) return false;
  }
  return true;
}

static scree_status load(pile *p, const char *path) {
  const char *slash = strrchr(path, '/');
  char beside[PATH_BYTES];
  SCREE_TRY(scree_scene_load(path, &p->scene, p->pack.error));
  p->world = scree_scene_view(p->scene);
  p->wall_count = scree_world_wall_count(p->world);
  int length = snprintf(beside, sizeof beside, "%.*smotion.scree",
                        (int)(slash ? slash + 1 - path : 0), path);
  if (length < PATH_BYTES && scree_path_exists(beside)) {
    SCREE_TRY(scree_motion_read(beside, &p->motion, p->pack.error));
    if (ends_with(p)) return SCREE_OK;
    scree_motion_free(&p->motion);
  }
  return still(p);
}

/* ---- shapes ---- */

/* The surface that is drawn of a shape: its own, or a level of about `target` triangles. */
static scree_status drawn_surface(pile *p, scree_particle *particle, size_t target,
                                  scree_mesh *mesh) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  if (m.kind != SCREE_PARTICLE_MESH)
    return scree_spheres_mesh(
        particle, m.point_count == 1 && target >= 320 ? SPHERE_LEVEL : COARSE_SPHERE_LEVEL, mesh,
        p->pack.error);
  const scree_mesh *own = scree_particle_mesh(particle);
  if (own->triangle_count <= target) return scree_mesh_copy(own, mesh, p->pack.error);
  scree_simplify_options options = scree_default_simplify_options();
  SCREE_OWNED(scree_curve, curve);
  options.stop_count = target;
  SCREE_TRY(scree_curve_build(own, &options, NULL, &curve, p->pack.error));
  return scree_curve_mesh(curve, scree_curve_find(curve, target), mesh, p->pack.error);
}

static void put_name(scree_packing *p, const char *name) {
  char text[64];
  snprintf(text, sizeof text, "%s", name ? name : "");
  scree_pack_u32(p, strlen(text));
  scree_code_bytes(&p->out, text, strlen(text));
}

static void put_grid(scree_packing *p) {
  scree_code_reals(&p->out, p->low, 3);
  scree_code_real(&p->out, &p->step);
}

/* A surface with the grid that its vertices lie on. */
static scree_status put_surface(pile *p, const char *name, size_t triangle_count,
                                const scree_mesh *mesh) {
  double low[3], high[3];
  scree_pack_box(mesh, low, high);
  scree_pack_grid(&p->pack, low, high);
  put_name(&p->pack, name);
  scree_pack_u32(&p->pack, triangle_count);
  put_grid(&p->pack);
  return scree_pack_mesh(&p->pack, mesh, NULL);
}

/* One map of a wall, the numbers of its drawn triangles on a grid from the least to the most;
 * nothing where there is none yet. */
static scree_status put_map(pile *p, size_t wall, scree_wall_map map, double *values,
                            size_t triangles, size_t *count) {
  const size_t cells = scree_scene_wall_cells(p->scene, wall);
  double low = 0, high = 0;
  if (!scree_scene_wall_map(p->scene, wall, map, values)) return SCREE_OK;
  for (size_t t = 0; t < cells; t++) {
    if (isnan(values[t])) return SCREE_OK;
    low = fmin(low, values[t]), high = fmax(high, values[t]);
  }
  typedef uint16_t pair[2]; /* the codec wants 4 bytes */
  SCREE_SCRATCH_ZERO(pair, steps, triangles, p->pack.error);
  for (size_t t = 0; high > low && t < triangles; t++)
    steps[t][0] =
        (uint16_t)lrint(65535 * (values[cells == triangles ? t : 0] - low) / (high - low));
  put_name(&p->pack, scree_wall_map_name(map));
  put_name(&p->pack, scree_wall_map_unit(map));
  scree_code_real(&p->pack.out, &low);
  scree_code_real(&p->pack.out, &high);
  (*count)++;
  return scree_pack_vertices(&p->pack, steps, triangles, sizeof *steps);
}

/* Their number stands before them. */
static scree_status put_maps(pile *p, size_t wall, size_t triangles) {
  const size_t at = p->pack.out.count, cells = scree_scene_wall_cells(p->scene, wall);
  size_t count = 0;
  SCREE_SCRATCH(double, values, cells, p->pack.error);
  scree_pack_u32(&p->pack, 0);
  for (int m = 0; m < SCREE_MAP_COUNT; m++)
    SCREE_TRY(put_map(p, wall, (scree_wall_map)m, values, triangles, &count));
  if (scree_codec_good(&p->pack.out)) p->pack.out.bytes[at] = (unsigned char)count;
  return SCREE_OK;
}

/* What of a cylinder stands above all bodies ever is not drawn: it may be very long. */
static void cut_off(const pile *p, const scree_wall *wall, scree_mesh *mesh) {
  const scree_motion *m = &p->motion;
  double high = 2 * wall->radius;
  if (!(wall->length > 0) || fabs(wall->axis[2]) < 1) return;
  for (size_t i = 0; i < m->frame_count * m->body_count; i++)
    if (i % m->body_count >= p->wall_count && (double)m->poses[7 * i + 2] > high)
      high = (double)m->poses[7 * i + 2];
  for (size_t v = 0; v < mesh->vertex_count; v++)
    mesh->positions[3 * v + 2] = fmin(mesh->positions[3 * v + 2], high);
}

/* The walls: those that are drawn smaller than the whole, then planes, are told apart by
 * whether they count where the view is fitted. */
static scree_status put_walls(pile *p) {
  scree_pack_u32(&p->pack, p->wall_count);
  for (size_t w = 0; w < p->wall_count; w++) {
    scree_wall wall;
    SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
    scree_world_get_wall(p->world, w, &wall);
    bool endless = wall.kind == SCREE_WALL_PLANE || wall.kind == SCREE_WALL_DISC ||
                   (wall.kind == SCREE_WALL_CYLINDER && !(wall.length > 0));
    const char *name = scree_scene_geometry_name(p->scene, scree_scene_wall_geometry(p->scene, w));
    scree_pack_u32(&p->pack, endless);
    SCREE_TRY(scree_wall_mesh(p->world, w, &mesh, p->pack.error));
    if (wall.kind == SCREE_WALL_CYLINDER) cut_off(p, &wall, &mesh);
    p->pack.keeps_order = true;
    SCREE_TRY(put_surface(p, name, mesh.triangle_count, &mesh));
    SCREE_TRY(put_maps(p, w, mesh.triangle_count));
    p->pack.keeps_order = false;
  }
  return SCREE_OK;
}

static scree_status put_shapes(pile *p) {
  size_t shapes = 0, bodies = p->motion.body_count - p->wall_count;
  size_t target = MOST_DRAWN / (bodies ? bodies : 1);
  target = target < LEAST_SHAPE ? LEAST_SHAPE : target > MOST_SHAPE ? MOST_SHAPE : target;
  while (scree_scene_shape_name(p->scene, shapes)) shapes++;
  scree_pack_u32(&p->pack, shapes);
  for (size_t i = 0; i < shapes; i++) {
    scree_particle *particle = scree_scene_shape_particle(p->scene, i);
    scree_particle_measures m;
    SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
    scree_particle_measure(particle, &m);
    SCREE_TRY(drawn_surface(p, particle, target, &mesh));
    SCREE_TRY(put_surface(p, scree_scene_shape_name(p->scene, i), m.triangle_count, &mesh));
  }
  return SCREE_OK;
}

static scree_status put_bodies(pile *p) {
  size_t bodies = p->motion.body_count - p->wall_count;
  SCREE_SCRATCH(uint32_t, shape, bodies, p->pack.error);
  for (size_t b = 0; b < bodies; b++) shape[b] = (uint32_t)scree_scene_body_shape(p->scene, b);
  scree_pack_u32(&p->pack, bodies);
  SCREE_TRY(scree_pack_vertices(&p->pack, shape, bodies, sizeof *shape));
  bool joined = scree_world_joint_count(p->world) > 0 && scree_world_body_count(p->world) == bodies;
  scree_pack_u32(&p->pack, joined);
  if (!joined) return SCREE_OK;
  SCREE_SCRATCH(size_t, fragment, bodies, p->pack.error);
  SCREE_SCRATCH(float, load, bodies, p->pack.error);
  (void)scree_world_fragments(p->world, fragment);
  for (size_t b = 0; b < bodies; b++) shape[b] = (uint32_t)fragment[b];
  SCREE_TRY(scree_pack_vertices(&p->pack, shape, bodies, sizeof *shape));
  scree_joint_loads(p->world, load);
  return scree_pack_vertices(&p->pack, load, bodies, sizeof *load);
}

/* ---- motion ---- */

/* The frame at place k of those kept: every stride-th, and the last. */
static size_t frame_at(const scree_motion *m, size_t stride, size_t k) {
  size_t frame = k * stride;
  return frame < m->frame_count ? frame : m->frame_count - 1;
}

static void find_grid(pile *p) {
  const scree_motion *m = &p->motion;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < m->frame_count * m->body_count; i++) {
    const float *pose = m->poses + 7 * i;
    if (i % m->body_count < p->wall_count) continue;
    double position[3] = {(double)pose[0], (double)pose[1], (double)pose[2]};
    if (!isnan(position[0])) scree_pack_stretch(position, low, high);
  }
  if (low[0] > high[0]) memset(low, 0, sizeof low), memset(high, 0, sizeof high);
  scree_pack_grid(&p->pack, low, high);
}

/* One body's moments. Signs of quaternions are chosen so that they change little from one to the
 * next; while a body is not there it repeats what it was, or will be. */
static void fill_track(const pile *p, size_t body, size_t stride, size_t count, moment *track) {
  const scree_motion *m = &p->motion;
  size_t first = count;
  for (size_t k = 0; k < count; k++) {
    const float *pose =
        m->poses + 7 * (frame_at(m, stride, k) * m->body_count + p->wall_count + body);
    track[k] = k ? track[k - 1] : (moment){0};
    track[k].at.extra = 0;
    if (isnan(pose[0])) continue;
    double position[3] = {(double)pose[0], (double)pose[1], (double)pose[2]}, same = 0;
    track[k].at = scree_pack_point(&p->pack, position);
    track[k].at.extra = 1;
    for (int i = 0; i < 4; i++) same += (double)pose[3 + i] * track[k].q[i];
    for (int i = 0; i < 4; i++)
      track[k].q[i] = (int16_t)lrint((same < 0 ? -one : one) * (double)pose[3 + i]);
    if (first == count) first = k;
  }
  for (size_t k = 0; first < count && k < first; k++) {
    track[k] = track[first];
    track[k].at.extra = 0;
  }
}

static scree_status put_motion(pile *p, size_t stride) {
  const scree_motion *m = &p->motion;
  size_t count = (m->frame_count - 2 + stride) / stride + 1; /* of one frame: 1 */
  scree_pack_u32(&p->pack, count);
  for (size_t k = 0; k < count; k++)
    scree_code_real(&p->pack.out, &m->time[frame_at(m, stride, k)]);
  for (size_t w = 0; w < p->wall_count; w++)
    for (size_t k = 0; k < count; k++)
      for (int i = 0; i < 7; i++) {
        double value =
            (double)m->poses[7 * (frame_at(m, stride, k) * m->body_count + w) + (size_t)i];
        scree_code_real(&p->pack.out, &value);
      }
  size_t bodies = m->body_count - p->wall_count;
  SCREE_SCRATCH(moment, tracks, count * bodies, p->pack.error);
  for (size_t b = 0; b < bodies; b++) fill_track(p, b, stride, count, tracks + b * count);
  return scree_pack_vertices(&p->pack, tracks, count * bodies, sizeof *tracks);
}

static scree_status pack(pile *p, size_t byte_limit) {
  SCREE_TRY(put_walls(p));
  SCREE_TRY(put_shapes(p));
  SCREE_TRY(put_bodies(p));
  find_grid(p);
  put_grid(&p->pack);
  size_t start = p->pack.out.count;
  for (size_t stride = 1;; stride *= 2) {
    p->pack.out.count = start;
    SCREE_TRY(put_motion(p, stride));
    if (p->pack.out.count <= byte_limit || stride >= p->motion.frame_count) break;
  }
  if (!scree_codec_good(&p->pack.out))
    return scree_fail_memory(p->pack.error, p->pack.out.count, "a packed pile");
  return SCREE_OK;
}

static void free_pile(pile *p) {
  scree_motion_free(&p->motion);
  scree_scene_free(p->scene);
  scree_free(p->pack.out.bytes);
}

scree_status scree_pile_pack(const char *path, size_t byte_limit, unsigned char **bytes,
                             size_t *byte_count, scree_error *error) {
  SCREE_CLEANUP(free_pile) pile p = {.pack = {.error = error}};
  *bytes = NULL;
  if (!scree_path_exists(path)) return SCREE_OK;
  SCREE_TRY(load(&p, path));
  SCREE_TRY(pack(&p, byte_limit));
  *bytes = p.pack.out.bytes;
  *byte_count = p.pack.out.count;
  p.pack.out.bytes = NULL;
  return SCREE_OK;
}
