/* Pictures of worlds and heaps: the bodies as items of the ray tracer. */
#include "base/alloc.h"
#include "base/vec.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

static const double room = 0.85; /* of the heap's radius: a picture is wider than high */
enum { SPHERE_LEVEL = 3 };

typedef struct drawing {
  scree_shapes shapes;
  scree_mesh *meshes; /* own, of shapes made of spheres; else empty */
  scree_render_item *items;
  size_t item_count;
} drawing;

static void free_scene(drawing *s) {
  for (size_t i = 0; s->meshes && i < s->shapes.count; i++) scree_mesh_free(&s->meshes[i]);
  scree_free(s->meshes);
  scree_free(s->items);
  scree_shapes_free(&s->shapes);
}

static scree_status make_spheres(drawing *s, scree_error *error) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < s->shapes.count; i++) {
    scree_particle_measures m;
    scree_particle_measure(s->shapes.particles[i], &m);
    if (m.kind != SCREE_PARTICLE_MESH)
      status = scree_spheres_mesh(s->shapes.particles[i], SPHERE_LEVEL, &s->meshes[i], error);
  }
  return status;
}

/* of: where not NULL, the shapes are numbered as it has them. */
static void add_bodies(const scree_world *world, const scree_scene *of, drawing *s) {
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
    shape = of ? scree_scene_body_shape(of, i) : shape;
    scree_shape_color_linear(shape, item->color);
  }
}

static scree_status draw(const scree_world *world, const scree_scene *scene,
                         const scree_render_options *options, const scree_progress *progress,
                         scree_image *image, scree_error *error) {
  size_t bodies = scree_world_body_count(world);
  drawing s = {0};
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
  add_bodies(world, scene, &s);
  scree_render_cell cell = {s.items, s.item_count, NULL};
  status = scree_render(&cell, 1, options, progress, image, error);
done:
  free_scene(&s);
  return status;
}

scree_status scree_world_picture(const scree_world *world, const scree_render_options *options,
                                 const scree_progress *progress, scree_image *image,
                                 scree_error *error) {
  return draw(world, NULL, options, progress, image, error);
}

/* ---- scenes ---- */

static const float wall_color[3] = {0.32f, 0.36f, 0.42f};
static const double steep = 0.7; /* of a normal's length along z: what is flatter is a floor */

enum { FINE_WALL = 4000 }; /* triangles from which on a wall is cut as it is */

/* Each triangle becomes four, their corners no longer shared: a coarse wall is cut more finely. */
static scree_status refine(scree_mesh *mesh, scree_error *error) {
  size_t count = mesh->triangle_count;
  scree_mesh fine = {.vertex_count = 6 * count, .triangle_count = 4 * count};
  static const unsigned char quarters[12] = {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5};
  fine.positions = scree_alloc(fine.vertex_count, 3 * sizeof *fine.positions);
  fine.triangles = scree_alloc(fine.triangle_count, 3 * sizeof *fine.triangles);
  if (!fine.positions || !fine.triangles) {
    scree_mesh_free(&fine);
    return scree_fail_memory(error, 6 * count, "a wall's triangles");
  }
  for (size_t t = 0; t < count; t++) {
    double *p = fine.positions + 18 * t;
    for (size_t c = 0; c < 3; c++)
      memcpy(p + 3 * c, mesh->positions + 3 * (size_t)mesh->triangles[3 * t + c], 3 * sizeof *p);
    for (size_t c = 0; c < 3; c++)
      for (size_t k = 0; k < 3; k++)
        p[9 + 3 * c + k] = 0.5 * (p[3 * c + k] + p[3 * ((c + 1) % 3) + k]);
    for (size_t c = 0; c < 12; c++) fine.triangles[12 * t + c] = (uint32_t)(6 * t + quarters[c]);
  }
  scree_mesh_free(mesh);
  *mesh = fine;
  return SCREE_OK;
}

/* Where the bodies are: their middle, and the centres of the lowest and of the highest. */
typedef struct crowd {
  double middle[3], low, high;
} crowd;

/* Cuts away what stands between the viewer and the middle, but not what lies below all bodies, nor
 * floors that one may lie on. */
static void cut_open(scree_mesh *mesh, const scree_render_item *item, const crowd *all,
                     const scree_render_options *o) {
  double azimuth = o->azimuth_deg / 57.29577951308232;
  vec3 viewer = {cos(azimuth), sin(azimuth), 0};
  mat3 turn = quat_to_mat3(
      (quat){item->quaternion[0], item->quaternion[1], item->quaternion[2], item->quaternion[3]});
  size_t kept = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 c[3];
    for (int k = 0; k < 3; k++) {
      vec3 p = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k]);
      c[k] = vec3_add(mat3_mul_vec(&turn, p), vec3_load(item->position));
    }
    vec3 n = vec3_unit(vec3_triangle_normal(c[0], c[1], c[2]));
    vec3 at = vec3_scale(vec3_add(c[0], vec3_add(c[1], c[2])), 1.0 / 3);
    bool before = vec3_dot(vec3_sub(at, vec3_load(all->middle)), viewer) > 0;
    bool below = fmax(c[0].z, fmax(c[1].z, c[2].z)) < all->low;
    bool floor = fabs(n.z) >= steep && at.z < all->high;
    if (before && !below && !floor) continue;
    memmove(mesh->triangles + 3 * kept++, mesh->triangles + 3 * t, 3 * sizeof *mesh->triangles);
  }
  mesh->triangle_count = kept;
}

static scree_status add_walls(const scree_world *world, const scree_render_options *o,
                              const crowd *all, drawing *s, scree_mesh *meshes,
                              scree_error *error) {
  scree_status status = SCREE_OK;
  for (size_t w = 0; status == SCREE_OK && w < scree_world_wall_count(world); w++) {
    scree_wall wall;
    scree_render_item *item = &s->items[s->item_count];
    scree_world_get_wall(world, w, &wall);
    if (wall.kind == SCREE_WALL_PLANE) continue; /* the picture has a ground */
    status = scree_wall_mesh(world, w, &meshes[w], error);
    while (status == SCREE_OK && meshes[w].triangle_count < FINE_WALL)
      status = refine(&meshes[w], error);
    *item = (scree_render_item){.mesh = &meshes[w]};
    memcpy(item->position, wall.position, sizeof item->position);
    scree_world_wall_orientation(world, w, item->quaternion);
    memcpy(item->color, wall_color, sizeof item->color);
    if (status == SCREE_OK) cut_open(&meshes[w], item, all, o);
    s->item_count += status == SCREE_OK && meshes[w].triangle_count > 0;
  }
  return status;
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

scree_status scree_scene_picture(const scree_scene *scene, const scree_render_options *options,
                                 const scree_progress *progress, scree_image *image,
                                 scree_error *error) {
  const scree_world *world = scree_scene_view(scene);
  scree_render_options o = options ? *options : scree_default_render_options();
  size_t bodies = scree_world_body_count(world), walls = scree_world_wall_count(world);
  drawing s = {0};
  const crowd all = find_crowd(world);
  scree_status status = scree_shapes_find(world, &s.shapes, error);
  if (status != SCREE_OK) return status;
  scree_mesh *meshes = scree_alloc_zero(walls, sizeof *meshes);
  s.meshes = scree_alloc_zero(s.shapes.count, sizeof *s.meshes);
  s.items = scree_alloc_zero(bodies + walls, sizeof *s.items);
  if (!meshes || !s.meshes || !s.items)
    status = scree_fail_memory(error, bodies * sizeof *s.items, "a picture's bodies");
  if (status == SCREE_OK) status = make_spheres(&s, error);
  if (status == SCREE_OK) {
    add_bodies(world, scene, &s);
    status = add_walls(world, &o, &all, &s, meshes, error);
  }
  if (status == SCREE_OK) {
    scree_render_cell cell = {s.items, s.item_count, NULL};
    status = scree_render(&cell, 1, &o, progress, image, error);
  }
  for (size_t w = 0; meshes && w < walls; w++) scree_mesh_free(&meshes[w]);
  scree_free(meshes);
  free_scene(&s);
  return status;
}

/* ---- heaps ---- */

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
    scree_status status = scree_scene_measure_pile(scene, 0, NULL, &pile, error);
    if (status != SCREE_OK) return status;
    focus_on(&pile.repose, &o);
  }
  return draw(scree_scene_view(scene), scene, &o, progress, image, error);
}
