/* Welding in four steps, each linear in practice:
 *
 * 1. Equal positions get one number each, by a hash table over the corners. The table's seed
 * differs from run to run, so that no file can be made to collide; the result does not depend on
 * it.
 * 2. Distinct positions are sorted by x, y, z: spread over buckets by their place between the least
 *    and largest x, then each bucket again by itself (by y where x is all the same), small ones by
 *    insertion. Spreading is monotone, so the outcome is the plain lexicographic order.
 * 3. With a tolerance, near vertices are united (weld_near.c).
 * 4. Triangles are renumbered, turned to their smallest index, and sorted: counted by that index,
 *    then each small group by the other two.
 *
 * Steps 2 and 4 have one possible outcome for a set of facets, so the order of the file, the hash
 * and the number of threads leave no trace. */
#include "mesh/weld.h"

#include "base/parallel.h"
#include "mesh/mesh.h"

#include <math.h>
#include <string.h>

enum { BATCH = 192, EMPTY = 0, LOOK_BLOCK = 1 << 14 };

/* ---- 1. equal positions ---- */

typedef struct distinct {
  double *positions; /* 3 * count */
  size_t count, capacity;
  uint32_t *slots; /* number + 1 of the position, or EMPTY; slot_count is a power of two */
  size_t slot_count;
  uint64_t seed;
} distinct;

static uint64_t fold(uint64_t a, uint64_t b) {
  __extension__ typedef unsigned __int128 uint128;
  uint128 product = (uint128)a * b;
  return (uint64_t)product ^ (uint64_t)(product >> 64);
}

static uint64_t hash_position(const double *p, uint64_t seed) {
  uint64_t k[3];
  memcpy(k, p, sizeof k);
  uint64_t h = fold(k[0] ^ seed, k[1] ^ 0x9e3779b97f4a7c15u);
  return fold(h ^ k[2], seed | 1);
}

/* A number that an author of files cannot know: where the stack lies, and the time. */
static uint64_t run_seed(const void *somewhere) {
  double now = scree_now();
  uint64_t bits;
  memcpy(&bits, &now, sizeof bits);
  return fold(bits ^ 0xd6e8feb86659fd93u, (uint64_t)(uintptr_t)somewhere ^ 0xa0761d6478bd642fu);
}

static bool slots_allocate(distinct *d, size_t slot_count) {
  uint32_t *slots = scree_alloc_zero(slot_count, sizeof *slots);
  if (!slots) return false;
  scree_free(d->slots);
  d->slots = slots;
  d->slot_count = slot_count;
  for (size_t i = 0; i < d->count; i++) {
    size_t slot = hash_position(d->positions + 3 * i, d->seed) & (slot_count - 1);
    while (slots[slot] != EMPTY) slot = (slot + 1) & (slot_count - 1);
    slots[slot] = (uint32_t)i + 1;
  }
  return true;
}

/* Room for `extra` more positions at a load of at most one half. */
static bool distinct_reserve(distinct *d, size_t extra) {
  size_t needed = d->count + extra;
  if (needed > d->capacity) {
    size_t capacity = d->capacity * 2 > needed ? d->capacity * 2 : needed;
    double *moved = scree_resize(d->positions, capacity, 3 * sizeof *moved);
    if (!moved) return false;
    d->positions = moved;
    d->capacity = capacity;
  }
  size_t slot_count = d->slot_count;
  while (slot_count / 2 < needed) slot_count *= 4;
  return slot_count == d->slot_count || slots_allocate(d, slot_count);
}

/* Equal bits are equal values here, where no -0 is left; one comparison, as it is mostly true. */
static bool same_position(const double *a, const double *b) {
  uint64_t x[3], y[3];
  memcpy(x, a, sizeof x);
  memcpy(y, b, sizeof y);
  return ((x[0] ^ y[0]) | (x[1] ^ y[1]) | (x[2] ^ y[2])) == 0;
}

static uint32_t distinct_number(distinct *d, const double *p, uint64_t hash) {
  size_t mask = d->slot_count - 1, slot = hash & mask;
  for (; d->slots[slot] != EMPTY; slot = (slot + 1) & mask) {
    uint32_t number = d->slots[slot] - 1;
    if (same_position(d->positions + 3 * (size_t)number, p)) return number;
  }
  uint32_t number = (uint32_t)d->count++;
  memcpy(d->positions + 3 * (size_t)number, p, 3 * sizeof *p);
  d->slots[slot] = number + 1;
  return number;
}

/* Whether all coordinates are finite and within the limit. As integers, the sizes of doubles are in
 * order, NaN above all: a bit survives in the sign where one is too large. */
static bool in_range(const double *p, size_t count) {
  const double limit = SCREE_COORDINATE_LIMIT;
  uint64_t limit_bits, too_large = 0;
  memcpy(&limit_bits, &limit, sizeof limit);
  for (size_t i = 0; i < count; i++) {
    uint64_t bits;
    memcpy(&bits, p + i, sizeof bits);
    too_large |= limit_bits - (bits & INT64_MAX);
  }
  return too_large >> 63 == 0;
}

/* Hashes a batch, and asks for what its look-up will touch ahead of use: the table, then the
 * positions it names. False at a coordinate out of range. */
static bool prepare_batch(const distinct *d, double *p, size_t count, uint64_t *hashes) {
  for (size_t i = 0; i < 3 * count; i++) p[i] += 0.0; /* -0 becomes 0 */
  if (!in_range(p, 3 * count)) return false;
  size_t mask = d->slot_count - 1;
  for (size_t i = 0; i < count; i++) {
    hashes[i] = hash_position(p + 3 * i, d->seed);
    __builtin_prefetch(d->slots + (hashes[i] & mask));
  }
  for (size_t i = 0; i < count; i++) {
    uint32_t number = d->slots[hashes[i] & mask];
    if (number != EMPTY) __builtin_prefetch(d->positions + 3 * (size_t)(number - 1));
  }
  return true;
}

static size_t first_bad(const double *p, size_t count) {
  size_t i = 0;
  while (i < 3 * count && fabs(p[i]) <= SCREE_COORDINATE_LIMIT) i++;
  return i / 3;
}

/* numbers[i] is the number of corner i's position. */
static scree_status number_corners(const scree_corner_source *source, distinct *d,
                                   uint32_t *numbers, size_t *bad_corner, scree_error *error) {
  double batch[3 * BATCH];
  uint64_t hashes[BATCH];
  for (size_t first = 0; first < source->corner_count; first += BATCH) {
    size_t count = source->corner_count - first < BATCH ? source->corner_count - first : BATCH;
    source->fetch(source->context, first, count, batch);
    if (!distinct_reserve(d, count))
      return scree_fail_memory(error, d->capacity * 3 * sizeof *batch, "the vertices of a mesh");
    if (!prepare_batch(d, batch, count, hashes)) {
      size_t corner = first_bad(batch, count);
      if (bad_corner) *bad_corner = first + corner;
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "corner %zu lies at (%g, %g, %g) m; coordinates must be finite and at "
                        "most %g m in size",
                        first + corner, batch[3 * corner], batch[3 * corner + 1],
                        batch[3 * corner + 2], SCREE_COORDINATE_LIMIT);
    }
    for (size_t i = 0; i < count; i++)
      numbers[first + i] = distinct_number(d, batch + 3 * i, hashes[i]);
    if (d->count >= UINT32_MAX - BATCH)
      return scree_fail(error, SCREE_LIMIT, "more than the limit of %u distinct vertices",
                        UINT32_MAX - BATCH);
  }
  return SCREE_OK;
}

static scree_status distinct_create(distinct *d, size_t corner_count, size_t triangle_count,
                                    scree_error *error) {
  /* a closed surface has half as many vertices as triangles */
  size_t expected = triangle_count / 2 + triangle_count / 16 + 64;
  if (expected > corner_count + BATCH) expected = corner_count + BATCH;
  d->capacity = expected;
  d->seed = run_seed(d);
  SCREE_TRY_ALLOC(d->positions, 3 * expected, error);
  scree_populate(d->positions, 3 * expected * sizeof *d->positions);
  size_t slot_count = 1024;
  while (slot_count / 2 < expected) slot_count *= 2;
  if (slots_allocate(d, slot_count)) return SCREE_OK;
  return scree_fail_memory(error, slot_count * sizeof *d->slots, "the vertices of a mesh");
}

static void free_distinct(distinct *d) {
  scree_free(d->positions);
  scree_free(d->slots);
}

/* ---- 4. triangles ---- */

/* What one pass over the triangles renumbers: corner c of the source has vertex map[numbers[c]]. */
typedef struct renumbering {
  const uint32_t *triangles; /* of the source, or NULL */
  const uint32_t *numbers;
  size_t triangle_count;
} renumbering;

static void load_triangle(const renumbering *r, size_t t, uint32_t v[3]) {
  for (size_t k = 0; k < 3; k++) {
    size_t corner = r->triangles ? r->triangles[3 * t + k] : 3 * t + k;
    v[k] = r->numbers ? r->numbers[corner] : (uint32_t)corner;
  }
}

/* Whether every triangle keeps three corners. */
typedef struct keeping {
  const renumbering *renumbering;
  bool all;
} keeping;

static void look_at_block(void *context, scree_block block) {
  keeping *k = context;
  bool degenerate = false;
  for (size_t t = block.begin; t < block.end; t++) {
    uint32_t v[3];
    load_triangle(k->renumbering, t, v);
    degenerate |= scree_names_twice(v);
  }
  if (degenerate) __atomic_store_n(&k->all, false, __ATOMIC_RELAXED);
}

static bool all_keep_corners(const renumbering *r) {
  keeping k = {r, true};
  scree_parallel_for(r->triangle_count, LOOK_BLOCK, look_at_block, &k);
  return k.all;
}

/* Writes the triangles that keep three corners, and marks the vertices they use; answers how many.
 * kept may be the source itself. */
static size_t keep_triangles(const renumbering *r, uint32_t *kept, uint8_t *used) {
  size_t count = 0;
  for (size_t t = 0; t < r->triangle_count; t++) {
    uint32_t v[3];
    load_triangle(r, t, v);
    if (scree_names_twice(v)) continue;
    used[v[0]] = used[v[1]] = used[v[2]] = 1;
    memcpy(kept + 3 * count++, v, sizeof v);
  }
  return count;
}

scree_status scree_weld_corners(const scree_corner_source *source, double tolerance,
                                scree_mesh *mesh, size_t *degenerate_count, size_t *bad_corner,
                                scree_error *error) {
  if (tolerance != 0 && !(tolerance >= 1e-12 && tolerance <= 0.1))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "the welding tolerance is %g; it must be 0 or lie in [1e-12, 0.1]",
                      tolerance);
  if (source->triangle_count > SCREE_TRIANGLE_LIMIT)
    return scree_fail(error, SCREE_LIMIT, "%zu triangles, more than the limit of %zu",
                      source->triangle_count, SCREE_TRIANGLE_LIMIT);
  SCREE_CLEANUP(free_distinct) distinct d = {0};
  SCREE_CLEANUP(scree_free_at) uint32_t *kept = NULL;
  SCREE_CLEANUP(scree_free_at) uint8_t *used = NULL;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  SCREE_TRY(distinct_create(&d, source->corner_count, source->triangle_count, error));
  SCREE_SCRATCH(uint32_t, numbers, source->corner_count, error);
  scree_populate(numbers, source->corner_count * sizeof *numbers);
  SCREE_TRY(number_corners(source, &d, numbers, bad_corner, error));
  scree_free(d.slots);
  d.slots = NULL;
  if (source->triangles) SCREE_TRY_ALLOC(kept, 3 * source->triangle_count, error);
  renumbering r = {source->triangles, numbers, source->triangle_count};
  uint32_t *target = kept ? kept : numbers;
  scree_loose_mesh loose = {d.positions, NULL, d.count, target, source->triangle_count};
  if (source->triangles || !all_keep_corners(&r)) {
    SCREE_TRY_ALLOC_ZERO(used, d.count, error);
    loose.used = used;
    loose.triangle_count = keep_triangles(&r, target, used);
  }
  SCREE_TRY(scree_weld_sort(&loose, &made, error));
  if (tolerance > 0) SCREE_TRY(scree_weld_near(&made, tolerance, error));
  if (degenerate_count) *degenerate_count = source->triangle_count - made.triangle_count;
  *mesh = made;
  made = (scree_mesh){0};
  return SCREE_OK;
}

static void fetch_doubles(const void *context, size_t first, size_t count, double *out) {
  memcpy(out, (const double *)context + 3 * first, 3 * count * sizeof *out);
}

scree_status scree_mesh_weld(const double *corner_positions, size_t facet_count, double tolerance,
                             scree_mesh *mesh, size_t *degenerate_count, scree_error *error) {
  scree_corner_source source = {fetch_doubles, corner_positions, 3 * facet_count, NULL,
                                facet_count};
  return scree_weld_corners(&source, tolerance, mesh, degenerate_count, NULL, error);
}

scree_status scree_mesh_canonicalize(scree_mesh *mesh, scree_error *error) {
  scree_corner_source source = {fetch_doubles, mesh->positions, mesh->vertex_count, mesh->triangles,
                                mesh->triangle_count};
  scree_mesh canonical;
  SCREE_TRY(scree_weld_corners(&source, 0, &canonical, NULL, NULL, error));
  scree_mesh_free(mesh);
  *mesh = canonical;
  return SCREE_OK;
}
