/* A pile packed for the page. Of every body all moments stand together, so that a body at rest
 * costs next to nothing; a motion that does not fit loses every second frame until it does. A
 * browser draws all bodies many times a second: shapes are decimated until all together have as
 * many triangles as it can take. */
#include "report/pile_pack.h"

#include "base/alloc.h"
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

/* The last frame alone. */
static scree_status still(pile *p) {
  const scree_world *world = p->world;
  size_t bodies = scree_world_body_count(world), all = p->wall_count + bodies;
  scree_motion *m = &p->motion;
  *m = (scree_motion){.frame_count = 1, .body_count = all};
  m->time = scree_alloc(1, sizeof *m->time);
  m->poses = scree_alloc(all, 7 * sizeof *m->poses);
  if (!m->time || !m->poses)
    return scree_fail_memory(p->pack.error, all * 7 * sizeof *m->poses, "a pile");
  m->time[0] = scree_world_time(world);
  for (size_t w = 0; w < p->wall_count; w++) {
    scree_wall wall;
    double turn[4];
    scree_world_get_wall(world, w, &wall);
    scree_world_wall_orientation(world, w, turn);
    for (int k = 0; k < 7; k++)
      m->poses[7 * w + (size_t)k] = (float)(k < 3 ? wall.position[k] : turn[k - 3]);
  }
  for (size_t b = 0; b < bodies; b++) {
    scree_body body;
    scree_world_get_body(world, b, &body);
    bool there = !scree_world_body_removed(world, b);
    for (int k = 0; k < 7; k++)
      m->poses[7 * (p->wall_count + b) + (size_t)k] =
          there ? (float)(k < 3 ? body.position[k] : body.orientation[k - 3]) : NAN;
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
  scree_status status = scree_scene_load(path, &p->scene, p->pack.error);
  if (status != SCREE_OK) return status;
  p->world = scree_scene_view(p->scene);
  p->wall_count = scree_world_wall_count(p->world);
  int length = snprintf(beside, sizeof beside, "%.*smotion.scree",
                        (int)(slash ? slash + 1 - path : 0), path);
  if (length < PATH_BYTES && scree_path_exists(beside)) {
    status = scree_motion_read(beside, &p->motion, p->pack.error);
    if (status != SCREE_OK || ends_with(p)) return status;
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
  scree_curve *curve = NULL;
  options.stop_count = target;
  scree_status status = scree_curve_build(own, &options, NULL, &curve, p->pack.error);
  if (status == SCREE_OK)
    status = scree_curve_mesh(curve, scree_curve_find(curve, target), mesh, p->pack.error);
  scree_curve_free(curve);
  return status;
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
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t v = 0; v < mesh->vertex_count; v++)
    scree_pack_stretch(mesh->positions + 3 * v, low, high);
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
  uint16_t(*steps)[2] = scree_alloc_zero(triangles, sizeof *steps); /* the codec wants 4 bytes */
  if (!steps) return scree_fail_memory(p->pack.error, triangles * sizeof *steps, "a wall's map");
  for (size_t t = 0; high > low && t < triangles; t++)
    steps[t][0] =
        (uint16_t)lrint(65535 * (values[cells == triangles ? t : 0] - low) / (high - low));
  put_name(&p->pack, scree_wall_map_name(map));
  put_name(&p->pack, scree_wall_map_unit(map));
  scree_code_real(&p->pack.out, &low);
  scree_code_real(&p->pack.out, &high);
  scree_status status = scree_pack_vertices(&p->pack, steps, triangles, sizeof *steps);
  scree_free(steps);
  (*count)++;
  return status;
}

/* Their number stands before them. */
static scree_status put_maps(pile *p, size_t wall, size_t triangles) {
  const size_t at = p->pack.out.count, cells = scree_scene_wall_cells(p->scene, wall);
  size_t count = 0;
  scree_status status = SCREE_OK;
  double *values = scree_alloc(cells, sizeof *values);
  if (!values) return scree_fail_memory(p->pack.error, cells * sizeof *values, "a wall's map");
  scree_pack_u32(&p->pack, 0);
  for (int m = 0; status == SCREE_OK && m < SCREE_MAP_COUNT; m++)
    status = put_map(p, wall, (scree_wall_map)m, values, triangles, &count);
  if (scree_codec_good(&p->pack.out)) p->pack.out.bytes[at] = (unsigned char)count;
  scree_free(values);
  return status;
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
  scree_status status = SCREE_OK;
  scree_pack_u32(&p->pack, p->wall_count);
  for (size_t w = 0; status == SCREE_OK && w < p->wall_count; w++) {
    scree_wall wall;
    scree_mesh mesh = {0};
    scree_world_get_wall(p->world, w, &wall);
    bool endless = wall.kind == SCREE_WALL_PLANE || wall.kind == SCREE_WALL_DISC ||
                   (wall.kind == SCREE_WALL_CYLINDER && !(wall.length > 0));
    const char *name = scree_scene_geometry_name(p->scene, scree_scene_wall_geometry(p->scene, w));
    scree_pack_u32(&p->pack, endless);
    status = scree_wall_mesh(p->world, w, &mesh, p->pack.error);
    if (wall.kind == SCREE_WALL_CYLINDER && status == SCREE_OK) cut_off(p, &wall, &mesh);
    p->pack.keeps_order = true;
    if (status == SCREE_OK) status = put_surface(p, name, mesh.triangle_count, &mesh);
    if (status == SCREE_OK) status = put_maps(p, w, mesh.triangle_count);
    p->pack.keeps_order = false;
    scree_mesh_free(&mesh);
  }
  return status;
}

static scree_status put_shapes(pile *p) {
  size_t shapes = 0, bodies = p->motion.body_count - p->wall_count;
  size_t target = MOST_DRAWN / (bodies ? bodies : 1);
  target = target < LEAST_SHAPE ? LEAST_SHAPE : target > MOST_SHAPE ? MOST_SHAPE : target;
  while (scree_scene_shape_name(p->scene, shapes)) shapes++;
  scree_pack_u32(&p->pack, shapes);
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < shapes; i++) {
    scree_particle *particle = scree_scene_shape_particle(p->scene, i);
    scree_particle_measures m;
    scree_mesh mesh = {0};
    scree_particle_measure(particle, &m);
    status = drawn_surface(p, particle, target, &mesh);
    if (status == SCREE_OK)
      status = put_surface(p, scree_scene_shape_name(p->scene, i), m.triangle_count, &mesh);
    scree_mesh_free(&mesh);
  }
  return status;
}

static scree_status put_bodies(pile *p) {
  size_t bodies = p->motion.body_count - p->wall_count;
  uint32_t *shape = scree_alloc(bodies, sizeof *shape);
  if (!shape) return scree_fail_memory(p->pack.error, bodies * sizeof *shape, "a pile");
  for (size_t b = 0; b < bodies; b++) shape[b] = (uint32_t)scree_scene_body_shape(p->scene, b);
  scree_pack_u32(&p->pack, bodies);
  scree_status status = scree_pack_vertices(&p->pack, shape, bodies, sizeof *shape);
  scree_free(shape);
  return status;
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
  moment *tracks = scree_alloc(count * bodies, sizeof *tracks);
  if (!tracks) return scree_fail_memory(p->pack.error, count * bodies * sizeof *tracks, "a motion");
  for (size_t b = 0; b < bodies; b++) fill_track(p, b, stride, count, tracks + b * count);
  scree_status status = scree_pack_vertices(&p->pack, tracks, count * bodies, sizeof *tracks);
  scree_free(tracks);
  return status;
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

scree_status scree_pile_pack(const char *path, size_t byte_limit, unsigned char **bytes,
                             size_t *byte_count, scree_error *error) {
  pile p = {.pack = {.error = error}};
  if (!scree_path_exists(path)) {
    *bytes = NULL;
    return SCREE_OK;
  }
  scree_status status = load(&p, path);
  if (status == SCREE_OK) status = pack(&p, byte_limit);
  scree_motion_free(&p.motion);
  scree_scene_free(p.scene);
  if (status == SCREE_OK) {
    *bytes = p.pack.out.bytes;
    *byte_count = p.pack.out.count;
  } else {
    scree_free(p.pack.out.bytes);
  }
  return status;
}
