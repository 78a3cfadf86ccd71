/* An open hash table from the particle's address to its number. */
#include "report/shapes.h"

#include "base/alloc.h"
#include "base/vec.h"

#include <math.h>
#include <string.h>

/* ---- how they are shown and told ---- */

/* Told apart also by lightness. */
static const uint32_t colors[SCREE_SHAPE_COLORS] = {
    0x4575b4, 0xd9612c, 0x4c9954, 0xd6a638, 0x855099, 0x61b5c2, 0xb53845, 0x99999e, 0xd9c9a6};

uint32_t scree_shape_color(size_t shape) {
  return colors[shape % SCREE_SHAPE_COLORS];
}

void scree_shape_color_linear(size_t shape, float linear[3]) {
  for (int k = 0; k < 3; k++) {
    double s = (scree_shape_color(shape) >> (16 - 8 * k) & 255) / 255.0;
    linear[k] = (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
  }
}

void scree_joint_loads(const scree_world *world, float *loads) {
  memset(loads, 0, scree_world_body_count(world) * sizeof *loads);
  for (size_t k = 0; k < scree_world_joint_count(world); k++) {
    scree_joint_observation j;
    scree_world_observe_joint(world, k, &j);
    if (j.state != SCREE_JOINT_WHOLE) continue;
    loads[j.a] = fmaxf(loads[j.a], (float)j.load);
    if (j.b != SCREE_SPACE) loads[j.b] = fmaxf(loads[j.b], (float)j.load);
  }
}

void scree_shape_json(scree_json *json, const scree_particle *particle) {
  static const char *const kinds[] = {"mesh", "sphere", "clump"};
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  SCREE_JSON_MEMBERS(json, AS("kind", kinds[m.kind]), OF(&m, triangle_count), OF(&m, point_count),
                     OF(&m, edge_count), OF(&m, volume), OF(&m, size), OF(&m, thickness),
                     OF(&m, rounding));
}

/* ---- finding them ---- */

void scree_shapes_free(scree_shapes *shapes) {
  for (size_t i = 0; shapes->spheres && i < shapes->count; i++)
    scree_mesh_free(&shapes->spheres[i]);
  scree_free(shapes->spheres);
  scree_free(shapes->particles);
  scree_free(shapes->of_body);
  *shapes = (scree_shapes){0};
}

static size_t slot_of(const scree_particle *particle, size_t mask) {
  uint64_t address = (uint64_t)(uintptr_t)particle;
  return (size_t)((address >> 6) * 0x9e3779b97f4a7c15u >> 20) & mask;
}

scree_status scree_shapes_find(const scree_world *world, scree_shapes *shapes, scree_error *error) {
  size_t bodies = scree_world_body_count(world), mask = 15;
  SCREE_CLEANUP(scree_shapes_free) scree_shapes found = {0};
  while (mask < 2 * bodies) mask = 2 * mask + 1;
  SCREE_SCRATCH_ZERO(size_t, slots, mask + 1, error); /* 1 + shape; 0: free */
  SCREE_TRY_ALLOC(found.particles, bodies, error);
  SCREE_TRY_ALLOC(found.of_body, bodies, error);
  for (size_t i = 0; i < bodies; i++) {
    scree_particle *particle = scree_world_body_particle(world, i);
    size_t slot = slot_of(particle, mask);
    while (slots[slot] && found.particles[slots[slot] - 1] != particle) slot = (slot + 1) & mask;
    if (!slots[slot]) {
      found.particles[found.count++] = particle;
      slots[slot] = found.count;
    }
    found.of_body[i] = slots[slot] - 1;
  }
  *shapes = found;
  memset(&found, 0, sizeof found);
  return SCREE_OK;
}

scree_particle *scree_world_shape(const scree_world *world, size_t shape) {
  SCREE_CLEANUP(scree_shapes_free) scree_shapes shapes = {0};
  if (scree_shapes_find(world, &shapes, NULL) != SCREE_OK) return NULL;
  return shape < shapes.count ? shapes.particles[shape] : NULL;
}

size_t scree_world_live_count(const scree_world *world) {
  size_t count = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++)
    count += !scree_world_body_removed(world, i);
  return count;
}

/* ---- spheres as meshes ---- */

/* The spheres of one particle as one mesh. */
static scree_status mesh_of_spheres(const scree_particle *particle, size_t sphere_count,
                                    const scree_mesh *unit, scree_mesh *mesh, scree_error *error) {
  size_t vertices = sphere_count * unit->vertex_count,
         triangles = sphere_count * unit->triangle_count;
  SCREE_CLEANUP(scree_mesh_free)
  scree_mesh made = {.vertex_count = vertices, .triangle_count = triangles};
  SCREE_TRY_ALLOC(made.positions, 3 * vertices, error);
  SCREE_TRY_ALLOC(made.triangles, 3 * triangles, error);
  for (size_t k = 0; k < sphere_count; k++) {
    double centre[3], radius;
    scree_particle_point(particle, k, centre, &radius);
    for (size_t v = 0; v < unit->vertex_count; v++) {
      vec3 direction = vec3_unit(vec3_load(unit->positions + 3 * v));
      vec3_store(made.positions + 3 * (k * unit->vertex_count + v),
                 vec3_mad(vec3_load(centre), direction, radius));
    }
    for (size_t i = 0; i < 3 * unit->triangle_count; i++)
      made.triangles[3 * k * unit->triangle_count + i] =
          unit->triangles[i] + (uint32_t)(k * unit->vertex_count);
  }
  *mesh = made;
  memset(&made, 0, sizeof made);
  return SCREE_OK;
}

scree_status scree_spheres_mesh(const scree_particle *particle, int level, scree_mesh *mesh,
                                scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh unit = {0};
  scree_particle_measures m;
  char name[16];
  snprintf(name, sizeof name, "icosphere-%d", level);
  scree_particle_measure(particle, &m);
  SCREE_TRY(scree_sample_make(name, NULL, NULL, &unit, error));
  return mesh_of_spheres(particle, m.point_count, &unit, mesh, error);
}

scree_status scree_shapes_draw(scree_shapes *shapes, int level, scree_error *error) {
  SCREE_TRY_ALLOC_ZERO(shapes->spheres, shapes->count, error);
  for (size_t i = 0; i < shapes->count; i++) {
    scree_particle_measures m;
    scree_particle_measure(shapes->particles[i], &m);
    if (m.kind != SCREE_PARTICLE_MESH)
      SCREE_TRY(scree_spheres_mesh(shapes->particles[i], level, &shapes->spheres[i], error));
  }
  return SCREE_OK;
}

const scree_mesh *scree_shape_surface(const scree_shapes *shapes, size_t shape) {
  const scree_mesh *spheres = &shapes->spheres[shape];
  return spheres->triangle_count ? spheres : scree_particle_mesh(shapes->particles[shape]);
}
