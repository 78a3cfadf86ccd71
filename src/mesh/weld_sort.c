/* Sorting of vertices and triangles; see weld.c for the whole.
 *
 * Both are sorted by a key of 32 bits first (base/radix.h), which leaves short runs of equal keys,
 * and each run by itself. A vertex's key is its place between the least and largest x; it is
 * monotone, also after rounding, so that the outcome is the plain lexicographic order. A triangle's
 * is its smallest index. */
#include "mesh/weld.h"

#include "base/parallel.h"
#include "base/radix.h"
#include "mesh/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  SMALL = 24,         /* sorted by insertion */
  SORT_BLOCK = 32768, /* keys per block of parallel work */
};

typedef struct record {
  double x[3];
  uint32_t index; /* in the loose mesh */
} record;

static int compare_records(const void *a, const void *b) {
  const record *p = a, *q = b;
  for (int k = 0; k < 3; k++)
    if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
  return 0;
}

static void sort_records(record *r, size_t count) {
  if (count > SMALL) {
    qsort(r, count, sizeof *r, compare_records);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    record moving = r[i];
    size_t j = i;
    for (; j > 0 && compare_records(&moving, &r[j - 1]) < 0; j--) r[j] = r[j - 1];
    r[j] = moving;
  }
}

/* What lies in ascending order of its keys. */
typedef struct sorting sorting;
struct sorting {
  void (*place)(const sorting *s, size_t first, size_t end); /* a run of equal keys */
  const scree_loose_mesh *loose;
  const scree_keyed *keyed;
  size_t count;
  record *records; /* of vertices */
  uint64_t *rest;  /* of triangles: the second index, high, and the third */
  uint32_t *rank;  /* of each loose vertex */
  scree_mesh *made;
};

/* The first run that begins at or behind i. */
static size_t run_start(const sorting *s, size_t i) {
  while (i > 0 && i < s->count && s->keyed[i].key == s->keyed[i - 1].key) i++;
  return i;
}

static size_t run_end(const sorting *s, size_t i) {
  uint32_t key = s->keyed[i].key;
  while (i < s->count && s->keyed[i].key == key) i++;
  return i;
}

/* The runs that begin in a block. */
static void place_runs(void *context, scree_block block) {
  const sorting *s = context;
  block.end = run_start(s, block.end);
  for (size_t first = run_start(s, block.begin), next; first < block.end; first = next) {
    next = run_end(s, first);
    s->place(s, first, next);
  }
}

/* ---- vertices ---- */

static void place_vertices(const sorting *s, size_t first, size_t end) {
  for (size_t i = first; i < end; i++) {
    record *r = &s->records[i];
    r->index = s->keyed[i].index;
    memcpy(r->x, s->loose->positions + 3 * (size_t)r->index, sizeof r->x);
  }
  sort_records(s->records + first, end - first);
  for (size_t i = first; i < end; i++) {
    memcpy(s->made->positions + 3 * i, s->records[i].x, sizeof s->records[i].x);
    s->rank[s->records[i].index] = (uint32_t)i;
  }
}

static bool is_used(const scree_loose_mesh *loose, size_t v) {
  return !loose->used || loose->used[v];
}

static scree_status sort_vertices(const scree_loose_mesh *loose, uint32_t *rank, scree_mesh *made,
                                  scree_error *error) {
  SCREE_SCRATCH(scree_keyed, keyed, made->vertex_count, error);
  SCREE_SCRATCH(scree_keyed, swap, made->vertex_count, error);
  SCREE_SCRATCH(record, records, made->vertex_count, error);
  double low = INFINITY, high = -INFINITY;
  size_t count = 0;
  for (size_t v = 0; v < loose->vertex_count; v++) {
    double x = loose->positions[3 * v];
    if (!is_used(loose, v)) continue;
    low = x < low ? x : low;
    high = x > high ? x : high;
  }
  /* a range below the least normal number overflows the quotient: all have one key then */
  double scale = UINT32_MAX / (high - low);
  for (size_t v = 0; v < loose->vertex_count; v++) {
    double place = isfinite(scale) ? (loose->positions[3 * v] - low) * scale : 0;
    if (is_used(loose, v))
      keyed[count++] =
          (scree_keyed){place < UINT32_MAX ? (uint32_t)place : UINT32_MAX, (uint32_t)v};
  }
  sorting s = {.place = place_vertices,
               .loose = loose,
               .count = count,
               .records = records,
               .rank = rank,
               .made = made};
  s.keyed = scree_radix_sort(keyed, swap, count, 32);
  scree_parallel_for(count, SORT_BLOCK, place_runs, &s);
  return SCREE_OK;
}

/* ---- triangles ---- */

static void place_triangles(const sorting *s, size_t first, size_t end) {
  for (size_t i = first; i < end; i++) {
    const uint32_t *v = s->loose->triangles + 3 * (size_t)s->keyed[i].index;
    uint32_t least = s->keyed[i].key, ranked[3] = {s->rank[v[0]], s->rank[v[1]], s->rank[v[2]]};
    int k = ranked[0] == least ? 0 : ranked[1] == least ? 1 : 2;
    s->rest[i] = (uint64_t)ranked[(k + 1) % 3] << 32 | ranked[(k + 2) % 3];
  }
  scree_sort_keys(s->rest + first, end - first);
  for (size_t i = first; i < end; i++) {
    uint32_t *out = s->made->triangles + 3 * i;
    out[0] = s->keyed[first].key;
    out[1] = (uint32_t)(s->rest[i] >> 32);
    out[2] = (uint32_t)s->rest[i];
  }
}

static scree_status sort_triangles(const scree_loose_mesh *loose, uint32_t *rank, scree_mesh *made,
                                   scree_error *error) {
  size_t count = loose->triangle_count;
  int bits = 1;
  SCREE_SCRATCH(scree_keyed, keyed, count, error);
  SCREE_SCRATCH(scree_keyed, swap, count, error);
  SCREE_SCRATCH(uint64_t, rest, count, error);
  for (size_t t = 0; t < count; t++) {
    const uint32_t *v = loose->triangles + 3 * t;
    uint32_t a = rank[v[0]], b = rank[v[1]], c = rank[v[2]], least = a < b ? a : b;
    keyed[t] = (scree_keyed){least < c ? least : c, (uint32_t)t};
  }
  while (bits < 32 && made->vertex_count >> bits) bits++;
  sorting s = {.place = place_triangles,
               .loose = loose,
               .count = count,
               .rest = rest,
               .rank = rank,
               .made = made};
  s.keyed = scree_radix_sort(keyed, swap, count, bits);
  scree_parallel_for(count, SORT_BLOCK, place_runs, &s);
  return SCREE_OK;
}

scree_status scree_weld_sort(const scree_loose_mesh *loose, scree_mesh *mesh, scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  SCREE_SCRATCH(uint32_t, rank, loose->vertex_count, error);
  size_t used = 0;
  for (size_t v = 0; v < loose->vertex_count; v++) used += is_used(loose, v);
  SCREE_TRY(scree_mesh_make(used, loose->triangle_count, &made, error));
  SCREE_TRY(sort_vertices(loose, rank, &made, error));
  SCREE_TRY(sort_triangles(loose, rank, &made, error));
  *mesh = made;
  made = (scree_mesh){0};
  return SCREE_OK;
}
