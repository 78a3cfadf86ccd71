#include "pile/fill.h"

#include "base/rng.h"

/* Random numbers: one stream for the order, then one a layer. */
enum { ORDER_STREAM = 1, FIRST_LAYER_STREAM = 16 };
enum { TRIES = 400 };

static bool touches(vec3 p, double radius, const scree_placement *other, double clearance) {
  double reach = radius + other->radius + clearance;
  return vec3_norm2(vec3_sub(p, other->position)) < reach * reach;
}

static bool is_free(const scree_fill_layer *layer, vec3 p, double radius,
                    const scree_placement *placed, size_t placed_count) {
  for (size_t i = placed_count; i-- > 0;)
    if (touches(p, radius, &placed[i], layer->clearance)) return false;
  for (size_t i = layer->present_count; i-- > 0;)
    if (touches(p, radius, &layer->present[i], layer->clearance)) return false;
  return true;
}

/* A uniform point of the disc in which the particle's centre may lie. */
static vec3 random_point(const scree_fill_layer *layer, double radius, scree_rng *rng) {
  double room = layer->cylinder_radius - radius - layer->clearance;
  double r = room * sqrt(scree_rng_uniform(rng)), a = 6.283185307179586 * scree_rng_uniform(rng);
  return (vec3){r * cos(a), r * sin(a), layer->bottom + radius};
}

size_t scree_fill_place(const scree_fill_layer *layer, scree_placement *placements, size_t count) {
  scree_rng rng = {.seed = layer->seed, .stream = FIRST_LAYER_STREAM + layer->layer_index};
  for (size_t i = 0; i < count; i++) {
    scree_placement *p = &placements[i];
    if (p->radius + layer->clearance > layer->cylinder_radius) return i;
    bool found = false;
    for (int try = 0; try < TRIES && !found; try++) {
      p->position = random_point(layer, p->radius, &rng);
      found = is_free(layer, p->position, p->radius, placements, i);
    }
    if (!found) return i;
    p->orientation = scree_rng_rotation(&rng);
  }
  return count;
}

void scree_fill_order(uint64_t seed, size_t shape_count, uint32_t *order, size_t count) {
  scree_rng rng = {.seed = seed, .stream = ORDER_STREAM};
  for (size_t i = 0; i < count; i++) order[i] = (uint32_t)(i % shape_count);
  for (size_t i = count; i > 1; i--) {
    size_t j = scree_rng_below(&rng, i);
    uint32_t swapped = order[i - 1];
    order[i - 1] = order[j];
    order[j] = swapped;
  }
}
