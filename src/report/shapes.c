/* An open hash table from the particle's address to its number. */
#include "report/shapes.h"

#include "base/alloc.h"

void scree_shapes_free(scree_shapes *shapes) {
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
  scree_shapes found = {0};
  size_t *slots = NULL; /* 1 + shape; 0: free */
  while (mask < 2 * bodies) mask = 2 * mask + 1;
  slots = scree_alloc_zero(mask + 1, sizeof *slots);
  found.particles = scree_alloc(bodies, sizeof(scree_particle *));
  found.of_body = scree_alloc(bodies, sizeof *found.of_body);
  if (!slots || !found.particles || !found.of_body) {
    scree_free(slots);
    scree_shapes_free(&found);
    return scree_fail_memory(error, bodies * sizeof *slots, "the shapes of a world");
  }
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
  scree_free(slots);
  *shapes = found;
  return SCREE_OK;
}

scree_particle *scree_world_shape(const scree_world *world, size_t shape) {
  scree_shapes shapes;
  if (scree_shapes_find(world, &shapes, NULL) != SCREE_OK) return NULL;
  scree_particle *particle = shape < shapes.count ? shapes.particles[shape] : NULL;
  scree_shapes_free(&shapes);
  return particle;
}
