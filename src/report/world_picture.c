/* Pictures of worlds and heaps: the bodies as items of the ray tracer. */
#include "base/owned.h"
#include "base/vec.h"
#include "report/image.h"
#include "report/program.h"
#include "report/ray.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

static const double room = 0.85; /* of the heap's radius: a picture is wider than high */
enum { SPHERE_LEVEL = 3 };

typedef struct drawing {
  scree_shapes shapes;
  size_t wall_count;
  scree_mesh *walls;
  scree_render_item *items;
  size_t item_count;
} drawing;

static void free_drawing(drawing *s) {
  for (size_t w = 0; s->walls && w < s->wall_count; w++) scree_mesh_free(&s->walls[w]);
  scree_free(s->walls);
  scree_free(s->items);
  scree_shapes_free(&s->shapes);
}

/* What bodies are coloured by: the first that is not NULL, else their shapes as the world has them.
 */
typedef struct coloring {
  const float *loads;
  const size_t *fragments;
  const scree_scene *scene;
} coloring;

static void color_body(const coloring *by, size_t body, size_t shape, float color[3]) {
  if (by->loads) {
    const vec3 c = scree_viridis((double)by->loads[body]);
    color[0] = (float)c.x, color[1] = (float)c.y, color[2] = (float)c.z;
    return;
  }
  scree_shape_color_linear(by->fragments ? by->fragments[body]
                           : by->scene   ? scree_scene_body_shape(by->scene, body)
                                         : shape,
                           color);
}

static void add_bodies(const scree_world *world, const coloring *by, drawing *s) {
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    if (scree_world_body_removed(world, i)) continue;
    size_t shape = s->shapes.of_body[i];
    scree_body body;
    scree_world_get_body(world, i, &body);
    scree_render_item *item = &s->items[s->item_count++];
    *item = (scree_render_item){.mesh = scree_shape_surface(&s->shapes, shape)};
    memcpy(item->position, body.position, sizeof item->position);
    memcpy(item->quaternion, body.orientation, sizeof item->quaternion);
    color_body(by, i, shape, item->color);
  }
}

/* ---- walls ---- */

static const float wall_color[3] = {0.32f, 0.36f, 0.42f};
static const double steep = 0.7; /* of a normal's length along z: what is flatter is a floor */

/* A convex piece of a triangle that two planes have cut: each adds a corner. */
typedef struct piece {
  vec3 corners[5];
  size_t count;
} piece;

/* The side of a plane on which `along` grows, or the other. */
typedef struct half {
  vec3 along;
  double from;
} half;

static double beyond(const half *h, vec3 p) {
  return vec3_dot(h->along, p) - h->from;
}

/* What of the piece lies on the half's side; with sign -1 on the other. */
static piece clip(const piece *p, const half *h, double sign) {
  piece cut = {.count = 0};
  for (size_t i = 0; i < p->count; i++) {
    vec3 a = p->corners[i], b = p->corners[(i + 1) % p->count];
    double da = sign * beyond(h, a), db = sign * beyond(h, b);
    if (da >= 0) cut.corners[cut.count++] = a;
    if ((da < 0) != (db < 0))
      cut.corners[cut.count++] = vec3_add(a, vec3_scale(vec3_sub(b, a), da / (da - db)));
  }
  return cut;
}

/* As a fan, its corners its own; room for it is there. */
static void add_piece(const piece *p, scree_mesh *mesh) {
  for (size_t i = 2; i < p->count; i++) {
    const vec3 corners[3] = {p->corners[0], p->corners[i - 1], p->corners[i]};
    for (size_t c = 0; c < 3; c++) {
      double *at = mesh->positions + 3 * mesh->vertex_count;
      at[0] = corners[c].x, at[1] = corners[c].y, at[2] = corners[c].z;
      mesh->triangles[3 * mesh->triangle_count + c] = (uint32_t)mesh->vertex_count++;
    }
    mesh->triangle_count++;
  }
}

/* Where the bodies are: their middle, and the centres of the lowest and of the highest. */
typedef struct crowd {
  double middle[3], low, high;
} crowd;

/* For rays in the mesh's own frame. */
static scree_status make_rays(const scree_mesh *mesh, scree_ray_scene **rays, scree_error *error) {
  size_t count = 3 * mesh->vertex_count;
  SCREE_SCRATCH(float, positions, count, error);
  for (size_t i = 0; i < count; i++) positions[i] = (float)mesh->positions[i];
  SCREE_TRY(scree_ray_scene_create(rays, error));
  SCREE_TRY(scree_ray_scene_add(*rays, positions, mesh->vertex_count, mesh->triangles,
                                mesh->triangle_count, error));
  return scree_ray_scene_commit(*rays, error);
}

SCREE_OWNABLE(scree_ray_scene)

/* Whether the wall stands before more than a few of the bodies, of which many are asked. */
static scree_status find_hiding(const scree_mesh *mesh, const scree_render_item *item,
                                const scree_world *world, const scree_render_options *o,
                                bool *hides, scree_error *error) {
  enum { ASKED = 200 };
  static const double few = 0.25;
  mat3 turn = quat_to_mat3(quat_load(item->quaternion));
  vec3 along = mat3_tmul_vec(&turn, scree_to_camera(o->azimuth_deg, o->elevation_deg));
  const float direction[3] = {(float)along.x, (float)along.y, (float)along.z};
  size_t bodies = scree_world_body_count(world), stride = bodies / ASKED + 1;
  size_t asked = 0, hidden = 0;
  SCREE_OWNED(scree_ray_scene, rays);
  SCREE_TRY(make_rays(mesh, &rays, error));
  for (size_t i = 0; i < bodies; i += stride) {
    scree_body body;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &body);
    vec3 p = mat3_tmul_vec(&turn, vec3_sub(vec3_load(body.position), vec3_load(item->position)));
    hidden += scree_ray_blocked(rays, (const float[3]){(float)p.x, (float)p.y, (float)p.z},
                                direction, INFINITY);
    asked++;
  }
  *hides = (double)hidden > few * (double)asked;
  return SCREE_OK;
}

/* Cuts away what stands between the viewer and the middle, but not what lies below all bodies, nor
 * floors that one may lie on. */
static scree_status cut_open(scree_mesh *mesh, const scree_render_item *item, const crowd *all,
                             const scree_render_options *o, scree_error *error) {
  enum { MOST_PIECES = 2 + 3 }; /* triangles of what lies behind, and of what lies below before */
  vec3 viewer = scree_to_camera(o->azimuth_deg, 0), position = vec3_load(item->position);
  mat3 turn = quat_to_mat3(quat_load(item->quaternion));
  half before = {mat3_tmul_vec(&turn, viewer),
                 vec3_dot(vec3_sub(vec3_load(all->middle), position), viewer)};
  half above = {mat3_tmul_vec(&turn, (vec3){0, 0, 1}), all->low - position.z};
  size_t most = MOST_PIECES * mesh->triangle_count;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh open = {0};
  SCREE_TRY_ALLOC(open.positions, 9 * most, error);
  SCREE_TRY_ALLOC(open.triangles, 3 * most, error);
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    piece whole = {.count = 3};
    for (size_t k = 0; k < 3; k++)
      whole.corners[k] = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k]);
    vec3 n = vec3_unit(vec3_triangle_normal(whole.corners[0], whole.corners[1], whole.corners[2]));
    vec3 middle = vec3_scale(
        vec3_add(whole.corners[0], vec3_add(whole.corners[1], whole.corners[2])), 1.0 / 3);
    if (fabs(vec3_dot(n, above.along)) >= steep && beyond(&above, middle) < all->high - all->low) {
      add_piece(&whole, &open);
      continue;
    }
    piece front = clip(&whole, &before, 1), behind = clip(&whole, &before, -1),
          below = clip(&front, &above, -1);
    add_piece(&behind, &open);
    add_piece(&below, &open);
  }
  const scree_mesh before_cut = *mesh;
  *mesh = open;
  open = before_cut; /* to be freed */
  return SCREE_OK;
}

static scree_status add_walls(const scree_world *world, const scree_render_options *o,
                              const crowd *all, drawing *s, scree_error *error) {
  for (size_t w = 0; w < s->wall_count; w++) {
    scree_wall wall;
    scree_render_item *item = &s->items[s->item_count];
    scree_world_get_wall(world, w, &wall);
    if (wall.kind == SCREE_WALL_PLANE) continue; /* the picture has a ground */
    SCREE_TRY(scree_wall_mesh(world, w, &s->walls[w], error));
    *item = (scree_render_item){.mesh = &s->walls[w]};
    memcpy(item->position, wall.position, sizeof item->position);
    scree_world_wall_orientation(world, w, item->quaternion);
    memcpy(item->color, wall_color, sizeof item->color);
    bool hides = false;
    SCREE_TRY(find_hiding(&s->walls[w], item, world, o, &hides, error));
    if (hides) SCREE_TRY(cut_open(&s->walls[w], item, all, o, error));
    s->item_count += s->walls[w].triangle_count > 0;
  }
  return SCREE_OK;
}

static crowd find_crowd(const scree_world *world) {
  size_t count = 0;
  crowd all = {.low = INFINITY, .high = -INFINITY};
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &body);
    for (int k = 0; k < 3; k++) all.middle[k] += body.position[k];
    all.low = fmin(all.low, body.position[2]);
    all.high = fmax(all.high, body.position[2]);
    count++;
  }
  for (int k = 0; count && k < 3; k++) all.middle[k] /= (double)count;
  return all;
}

/* ---- pictures ---- */

/* of: see coloring. */
static scree_status draw(const scree_world *world, const scree_scene *of, bool walls,
                         const scree_render_options *options, const scree_progress *progress,
                         scree_image *image, scree_error *error) {
  SCREE_CLEANUP(free_drawing)
  drawing s = {.wall_count = walls ? scree_world_wall_count(world) : 0};
  scree_render_options o = options ? *options : scree_default_render_options();
  SCREE_TRY(scree_shapes_find(world, &s.shapes, error));
  SCREE_TRY_ALLOC_ZERO(s.walls, s.wall_count, error);
  SCREE_TRY_ALLOC_ZERO(s.items, scree_world_body_count(world) + s.wall_count, error);
  SCREE_TRY(scree_shapes_draw(&s.shapes, SPHERE_LEVEL, error));
  SCREE_SCRATCH(size_t, fragments, scree_world_body_count(world), error);
  SCREE_SCRATCH(float, loads, scree_world_body_count(world), error);
  coloring by = {.scene = of};
  if (o.joints) {
    scree_joint_loads(world, loads);
    by.loads = loads;
    o.value_label = "stress of joints over strength";
  } else if (scree_world_joint_count(world) > 0) {
    (void)scree_world_fragments(world, fragments);
    by.fragments = fragments;
  }
  add_bodies(world, &by, &s);
  const crowd all = find_crowd(world);
  SCREE_TRY(add_walls(world, &o, &all, &s, error));
  const scree_render_cell cell = {s.items, s.item_count, NULL};
  return scree_render(&cell, 1, &o, progress, image, error);
}

scree_status scree_world_picture(const scree_world *world, const scree_render_options *options,
                                 const scree_progress *progress, scree_image *image,
                                 scree_error *error) {
  return draw(world, NULL, false, options, progress, image, error);
}

scree_status scree_scene_picture(const scree_scene *scene, const scree_render_options *options,
                                 const scree_progress *progress, scree_image *image,
                                 scree_error *error) {
  return draw(scree_scene_view(scene), scene, true, options, progress, image, error);
}

/* The heap in the middle: as wide as its base, or as most of the bodies lie where there is none. */
static void focus_on(const scree_repose *r, scree_render_options *o) {
  double radius =
      r->heap && isfinite(r->base_radius) ? fmin(r->base_radius, r->run_out) : 0.6 * r->run_out;
  o->focus[0] = r->axis[0];
  o->focus[1] = r->axis[1];
  o->focus[2] = 0.35 * r->peak;
  o->focus_radius = room * fmax(radius, 0.6 * r->peak);
}

scree_status scree_scene_pile_picture(const scree_scene *scene, const scree_render_options *options,
                                      const scree_progress *progress, scree_image *image,
                                      scree_error *error) {
  scree_render_options o = options ? *options : scree_default_render_options();
  scree_pile pile;
  if (!scree_scene_pile_name(scene, 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the scene has no sensor of a pile");
  if (!(o.focus_radius > 0)) {
    SCREE_TRY(scree_scene_measure_pile(scene, 0, NULL, &pile, error));
    focus_on(&pile.repose, &o);
  }
  return draw(scree_scene_view(scene), scene, false, &o, progress, image, error);
}
