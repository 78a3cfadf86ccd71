/* Morton, "A computer oriented geodetic data base and a new technique in file sequencing" (IBM,
 * 1966): the bits of the three coordinates, each in 1024 steps along the box's longest side, are
 * interleaved and the outcome is sorted, by radix. */
#include "simplify/order.h"

#include "base/parallel.h"

enum { AXIS_BITS = 10, STEPS = 1 << AXIS_BITS, BLOCK = 1 << 14 };
enum { DIGIT = AXIS_BITS, RADIX = 1 << DIGIT, PASSES = 3 * AXIS_BITS / DIGIT };

typedef struct item {
  uint32_t code, vertex;
} item;

typedef struct coding {
  const scree_mesh *mesh;
  vec3 low;
  double per_length;
  item *items;
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
    c->items[v] = (item){spread(x) | spread(y) << 1 | spread(z) << 2, (uint32_t)v};
  }
}

static void sort_items(item *items, item *swap, size_t count) {
  for (int pass = 0; pass < PASSES; pass++) {
    int shift = pass * DIGIT;
    uint32_t start[RADIX + 1] = {0};
    for (size_t i = 0; i < count; i++) start[(items[i].code >> shift & (RADIX - 1)) + 1]++;
    for (int r = 0; r < RADIX; r++) start[r + 1] += start[r];
    for (size_t i = 0; i < count; i++)
      swap[start[items[i].code >> shift & (RADIX - 1)]++] = items[i];
    item *other = items;
    items = swap;
    swap = other;
  }
}

scree_status scree_order_vertices(const scree_mesh *mesh, vec3 low, vec3 high, uint32_t *order,
                                  scree_error *error) {
  size_t count = mesh->vertex_count;
  double extent = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
  coding c = {.mesh = mesh, .low = low, .per_length = STEPS / extent};
  item *swap = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(c.items, count, error, done);
  SCREE_ALLOC_OR(swap, count, error, done);
  scree_parallel_for(count, BLOCK, code_block, &c);
  sort_items(c.items, swap, count); /* an odd number of passes: the outcome is in swap */
  for (size_t i = 0; i < count; i++) order[i] = swap[i].vertex;
  status = SCREE_OK;
done:
  scree_free(c.items);
  scree_free(swap);
  return status;
}
