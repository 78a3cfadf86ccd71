/* Morton, "A computer oriented geodetic data base and a new technique in file sequencing" (IBM,
 * 1966): the bits of the three coordinates, each in 1024 steps along the box's longest side, are
 * interleaved and the outcome is sorted, by radix. */
#include "simplify/order.h"

#include "base/parallel.h"
#include "base/radix.h"

enum { AXIS_BITS = 10, STEPS = 1 << AXIS_BITS, BLOCK = 1 << 14 };

typedef struct coding {
  const scree_mesh *mesh;
  vec3 low;
  double per_length;
  scree_keyed *items;
} coding;

/* Puts two zeros between the bits. */
static uint32_t spread(uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

static uint32_t step_of(double x, double low, double per_length) {
  double step = (x - low) * per_length;
  return step < STEPS - 1 ? (uint32_t)step : STEPS - 1;
}

static void code_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const coding *c = context;
  for (size_t v = begin; v < end; v++) {
    const double *p = c->mesh->positions + 3 * v;
    uint32_t x = step_of(p[0], c->low.x, c->per_length), y = step_of(p[1], c->low.y, c->per_length),
             z = step_of(p[2], c->low.z, c->per_length);
    c->items[v] = (scree_keyed){spread(x) | spread(y) << 1 | spread(z) << 2, (uint32_t)v};
  }
}

scree_status scree_order_vertices(const scree_mesh *mesh, vec3 low, vec3 high, uint32_t *order,
                                  scree_error *error) {
  size_t count = mesh->vertex_count;
  double extent = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
  coding c = {.mesh = mesh, .low = low, .per_length = STEPS / extent};
  scree_keyed *swap = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(c.items, count, error, done);
  SCREE_ALLOC_OR(swap, count, error, done);
  scree_parallel_for(count, BLOCK, code_block, &c);
  const scree_keyed *sorted = scree_radix_sort(c.items, swap, count, 3 * AXIS_BITS);
  for (size_t i = 0; i < count; i++) order[i] = sorted[i].index;
  status = SCREE_OK;
done:
  scree_free(c.items);
  scree_free(swap);
  return status;
}
