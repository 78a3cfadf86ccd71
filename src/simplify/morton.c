/* Morton, "A computer oriented geodetic data base and a new technique in file sequencing" (IBM,
 * 1966): the bits of the three coordinates, each in 1024 steps along the longest side, are
 * interleaved and the outcome is sorted, by radix; vertices within the same steps by the next bits.
 *
 * The coordinates are those along the principal axes of the vertices, the first two in the
 * direction of the longer tail (the third moment), so that the order is the same however the scan
 * lies, unless its own symmetry leaves the axes open. */
#include "simplify/morton.h"

#include "base/eigen.h"
#include "base/parallel.h"
#include "base/radix.h"

enum { STEPS = 1 << SCREE_MORTON_BITS, BLOCK = 1 << 14 };
/* Vertices within the same steps, of more of which the order stays as it was. */
enum { MOST_TOGETHER = 64 };

/* A symmetric matrix. */
typedef struct sym3 {
  double xx, xy, xz, yy, yz, zz;
} sym3;

/* Sums over a block of vertices. */
typedef struct block_sums {
  vec3 first, low, high, third; /* first and third moments */
  sym3 second;
} block_sums;

typedef struct framing {
  const scree_positions *places;
  scree_principal_frame *frame;
  block_sums *blocks;
} framing;

/* m + weight g g^T. */
static void add_square(sym3 *m, vec3 g, double weight) {
  m->xx += weight * g.x * g.x;
  m->xy += weight * g.x * g.y;
  m->xz += weight * g.x * g.z;
  m->yy += weight * g.y * g.y;
  m->yz += weight * g.y * g.z;
  m->zz += weight * g.z * g.z;
}

static vec3 place(const scree_positions *p, size_t index) {
  return vec3_load(p->at + p->stride * index);
}

static void measure_block(void *context, scree_block block) {
  const framing *f = context;
  block_sums sums = {.first = {0, 0, 0}};
  for (size_t i = block.begin; i < block.end; i++) {
    vec3 p = vec3_sub(place(f->places, i), f->frame->centre);
    sums.first = vec3_add(sums.first, p);
    add_square(&sums.second, p, 1);
  }
  f->blocks[block.index] = sums;
}

static void look_block(void *context, scree_block block) {
  const framing *f = context;
  vec3 p = scree_principal_frame_into(f->frame, place(f->places, block.begin));
  block_sums sums = {.low = p, .high = p, .third = {0, 0, 0}};
  for (size_t i = block.begin; i < block.end; i++) {
    p = scree_principal_frame_into(f->frame, place(f->places, i));
    sums.low = vec3_min(sums.low, p);
    sums.high = vec3_max(sums.high, p);
    sums.third = vec3_add(sums.third, (vec3){p.x * p.x * p.x, p.y * p.y * p.y, 0});
  }
  f->blocks[block.index] = sums;
}

/* Mean and principal axes. */
static void find_axes(framing *f, size_t blocks) {
  double count = (double)f->places->count, values[3];
  vec3 first = {0, 0, 0};
  sym3 second = {0};
  scree_parallel_for(f->places->count, BLOCK, measure_block, f);
  for (size_t i = 0; i < blocks; i++) {
    const block_sums *b = &f->blocks[i];
    first = vec3_add(first, b->first);
    second.xx += b->second.xx, second.xy += b->second.xy, second.xz += b->second.xz;
    second.yy += b->second.yy, second.yz += b->second.yz, second.zz += b->second.zz;
  }
  vec3 mean = vec3_scale(first, 1 / count);
  add_square(&second, mean, -count);
  mat3 matrix = {{{second.xx, second.xy, second.xz},
                  {second.xy, second.yy, second.yz},
                  {second.xz, second.yz, second.zz}}};
  scree_eigen_symmetric(&matrix, values, &f->frame->axes);
  f->frame->centre = vec3_add(f->frame->centre, mean);
}

static void turn_round(double row[3], double *low, double *high) {
  for (int k = 0; k < 3; k++) row[k] = -row[k];
  double swapped = *low;
  *low = -*high;
  *high = -swapped;
}

/* The axes' directions, and the box in the frame. */
static void direct_axes(framing *f, size_t blocks) {
  scree_parallel_for(f->places->count, BLOCK, look_block, f);
  vec3 low = f->blocks[0].low, high = f->blocks[0].high, third = {0, 0, 0};
  for (size_t i = 0; i < blocks; i++) {
    low = vec3_min(low, f->blocks[i].low);
    high = vec3_max(high, f->blocks[i].high);
    third = vec3_add(third, f->blocks[i].third);
  }
  scree_principal_frame *frame = f->frame;
  vec3 extent = vec3_sub(high, low);
  frame->extent = fmax(extent.x, fmax(extent.y, extent.z));
  bool x = third.x < 0, y = third.y < 0;
  if (x) turn_round(frame->axes.m[0], &low.x, &high.x);
  if (y) turn_round(frame->axes.m[1], &low.y, &high.y);
  if (x != y) turn_round(frame->axes.m[2], &low.z, &high.z); /* right-handed, as they were */
  frame->low = low;
  frame->high = high;
}

scree_status scree_principal_frame_find(const scree_positions *places, vec3 centre,
                                        scree_principal_frame *frame, scree_error *error) {
  size_t blocks = scree_block_count(places->count, BLOCK);
  framing f = {.places = places, .frame = frame};
  SCREE_TRY_ALLOC(f.blocks, blocks, error);
  frame->centre = centre;
  find_axes(&f, blocks);
  direct_axes(&f, blocks);
  scree_free(f.blocks);
  return SCREE_OK;
}

vec3 scree_principal_frame_steps(const scree_principal_frame *frame, double steps, vec3 p) {
  /* half a step less, or rounding would say in which step the farthest lies */
  return vec3_scale(vec3_sub(scree_principal_frame_into(frame, p), frame->low),
                    (steps - 0.5) / frame->extent);
}

/* Puts two zeros between the bits. */
static uint32_t spread(uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

static uint32_t whole_step(double step) {
  return step < STEPS - 1 ? step > 0 ? (uint32_t)step : 0 : STEPS - 1;
}

uint32_t scree_morton_code(vec3 steps) {
  return spread(whole_step(steps.x)) | spread(whole_step(steps.y)) << 1 |
         spread(whole_step(steps.z)) << 2;
}

typedef struct coding {
  scree_positions places;
  scree_principal_frame frame;
  scree_keyed *items;
} coding;

static vec3 steps_of(const coding *c, size_t v) {
  return scree_principal_frame_steps(&c->frame, STEPS, place(&c->places, v));
}

static void code_block(void *context, scree_block block) {
  const coding *c = context;
  for (size_t v = block.begin; v < block.end; v++)
    c->items[v] = (scree_keyed){scree_morton_code(steps_of(c, v)), (uint32_t)v};
}

/* The bits after those of the code. */
static uint32_t next_code(const coding *c, uint32_t v) {
  vec3 steps = steps_of(c, v);
  vec3 rest = {steps.x - floor(steps.x), steps.y - floor(steps.y), steps.z - floor(steps.z)};
  return scree_morton_code(vec3_scale(rest, STEPS));
}

/* Those of equal code by their next bits. */
static void order_together(const coding *c, scree_keyed *items, size_t count) {
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && items[end].key == items[begin].key;) end++;
    if (end - begin == 1 || end - begin > MOST_TOGETHER) continue;
    for (size_t i = begin; i < end; i++) {
      scree_keyed item = {next_code(c, items[i].index), items[i].index};
      size_t j = i;
      for (; j > begin && items[j - 1].key > item.key; j--) items[j] = items[j - 1];
      items[j] = item;
    }
  }
}

scree_status scree_order_vertices(const scree_mesh *mesh, vec3 centre, uint32_t *order,
                                  scree_error *error) {
  size_t count = mesh->vertex_count;
  SCREE_SCRATCH(scree_keyed, items, count, error);
  SCREE_SCRATCH(scree_keyed, swap, count, error);
  coding c = {.places = {mesh->positions, 3, count}, .items = items};
  SCREE_TRY(scree_principal_frame_find(&c.places, centre, &c.frame, error));
  scree_parallel_for(count, BLOCK, code_block, &c);
  scree_keyed *sorted = scree_radix_sort(c.items, swap, count, 3 * SCREE_MORTON_BITS);
  order_together(&c, sorted, count);
  for (size_t i = 0; i < count; i++) order[i] = sorted[i].index;
  return SCREE_OK;
}
