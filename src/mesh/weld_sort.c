/* Sorting of vertices and triangles; see weld.c for the whole. */
#include "mesh/weld_sort.h"

#include "base/parallel.h"
#include "base/radix.h"

#include <stdlib.h>
#include <string.h>

enum {
  SMALL = 24,         /* sorted by insertion */
  MOST_DEPTH = 12,    /* spreads of one range before qsort bounds the worst case */
  PER_BUCKET = 2,     /* vertices per bucket, on average */
  SORT_BLOCK = 32768, /* vertices per block of parallel work */
};

typedef struct record {
  double x[3];
  uint64_t index; /* in the loose mesh */
} record;

static bool record_less(const record *a, const record *b) {
  if (a->x[0] != b->x[0]) return a->x[0] < b->x[0];
  if (a->x[1] != b->x[1]) return a->x[1] < b->x[1];
  return a->x[2] < b->x[2];
}

static void insertion_sort(record *r, size_t n) {
  for (size_t i = 1; i < n; i++) {
    record moving = r[i];
    size_t j = i;
    for (; j > 0 && record_less(&moving, &r[j - 1]); j--) r[j] = r[j - 1];
    r[j] = moving;
  }
}

static int compare_records(const void *a, const void *b) {
  return record_less(a, b) ? -1 : record_less(b, a);
}

/* The bucket of coordinate x: its place in [low, high], spread over `last` + 1 buckets. Monotone,
 * also after rounding: subtraction, product and conversion all are. */
typedef struct spread {
  double low, scale;
  int axis;
  uint32_t last;
} spread;

static uint32_t bucket_of(const spread *s, double x) {
  double place = (x - s->low) * s->scale;
  return place < (double)s->last ? (uint32_t)place : s->last;
}

/* The spread of n records along the first axis from `axis` on where they differ. */
static spread find_spread(const record *r, size_t n, int axis) {
  for (;; axis++) {
    double low = r[0].x[axis], high = low;
    for (size_t i = 1; i < n; i++) {
      double x = r[i].x[axis];
      low = x < low ? x : low;
      high = x > high ? x : high;
    }
    if (low < high || axis == 2) {
      uint32_t last = (uint32_t)(n / PER_BUCKET);
      double scale = (double)last / (high - low);
      /* a range below the least normal number overflows the quotient: everything above low goes to
       * the last bucket, which is still monotone */
      return (spread){low, scale, axis, last};
    }
  }
}

/* Sorts r; scratch and counts have room for n entries, of which only these n are touched: disjoint
 * ranges can be sorted at the same time. */
static void sort_records(record *r, record *scratch, uint32_t *counts, size_t n, int axis,
                         int depth) {
  if (n <= SMALL) {
    insertion_sort(r, n);
    return;
  }
  if (depth == MOST_DEPTH) {
    qsort(r, n, sizeof *r, compare_records);
    return;
  }
  spread s = find_spread(r, n, axis);
  memset(counts, 0, ((size_t)s.last + 2) * sizeof *counts);
  for (size_t i = 0; i < n; i++) counts[bucket_of(&s, r[i].x[s.axis]) + 1]++;
  for (size_t b = 1; b <= s.last; b++) counts[b] += counts[b - 1];
  for (size_t i = 0; i < n; i++) scratch[counts[bucket_of(&s, r[i].x[s.axis])]++] = r[i];
  memcpy(r, scratch, n * sizeof *r);
  /* the counts are free again: bucket ends are found by asking */
  for (size_t begin = 0; begin < n;) {
    uint32_t bucket = bucket_of(&s, r[begin].x[s.axis]);
    size_t end = begin + 1;
    while (end < n && bucket_of(&s, r[end].x[s.axis]) == bucket) end++;
    if (end - begin > 1)
      sort_records(r + begin, scratch + begin, counts + begin, end - begin, s.axis, depth + 1);
    begin = end;
  }
}

/* ---- vertices ---- */

typedef struct vertex_sort {
  const scree_loose_mesh *loose;
  record *sorted, *scratch;
  uint32_t *counts; /* one per record, and one more */
  size_t count;
  spread spread;
  size_t *block_starts; /* per block, and one more: the first bucket start at or behind it */
  double *positions;    /* of the made mesh */
  uint32_t *rank;       /* of each loose vertex */
} vertex_sort;

/* Fills v->scratch with the used vertices. */
static void gather_records(vertex_sort *v) {
  const scree_loose_mesh *loose = v->loose;
  size_t count = 0;
  for (size_t i = 0; i < loose->vertex_count; i++) {
    if (loose->used && !loose->used[i]) continue;
    const double *p = loose->positions + 3 * i;
    v->scratch[count++] = (record){{p[0], p[1], p[2]}, i};
  }
}

/* Spreads scratch over sorted: the first, serial pass of the sort. */
static void spread_records(vertex_sort *v) {
  v->spread = find_spread(v->scratch, v->count, 0);
  const spread *s = &v->spread;
  uint32_t *counts = v->counts;
  memset(counts, 0, ((size_t)s->last + 2) * sizeof *counts);
  for (size_t i = 0; i < v->count; i++) counts[bucket_of(s, v->scratch[i].x[s->axis]) + 1]++;
  for (size_t b = 1; b <= s->last; b++) counts[b] += counts[b - 1];
  for (size_t i = 0; i < v->count; i++)
    v->sorted[counts[bucket_of(s, v->scratch[i].x[s->axis])]++] = v->scratch[i];
}

static bool in_one_bucket(const vertex_sort *v, size_t i, size_t j) {
  const spread *s = &v->spread;
  return bucket_of(s, v->sorted[i].x[s->axis]) == bucket_of(s, v->sorted[j].x[s->axis]);
}

/* The first bucket start at or behind i. */
static size_t bucket_start(const vertex_sort *v, size_t i) {
  if (i == 0) return 0;
  while (i < v->count && in_one_bucket(v, i - 1, i)) i++;
  return i;
}

/* Sorts the buckets that start in a block and writes their vertices. */
static void sort_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  vertex_sort *v = context;
  begin = v->block_starts[block];
  end = v->block_starts[block + 1];
  for (size_t first = begin; first < end;) {
    size_t next = first + 1;
    while (next < end && in_one_bucket(v, next - 1, next)) next++;
    if (next - first > 1)
      sort_records(v->sorted + first, v->scratch + first, v->counts + first, next - first,
                   v->spread.axis, 1);
    first = next;
  }
  for (size_t i = begin; i < end; i++) {
    memcpy(v->positions + 3 * i, v->sorted[i].x, sizeof v->sorted[i].x);
    v->rank[v->sorted[i].index] = (uint32_t)i;
  }
}

static scree_status sort_vertices(vertex_sort *v, scree_error *error) {
  size_t blocks = scree_block_count(v->count, SORT_BLOCK);
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(v->sorted, v->count, error, done);
  SCREE_ALLOC_OR(v->scratch, v->count, error, done);
  SCREE_ALLOC_OR(v->counts, v->count + 2, error, done);
  SCREE_ALLOC_OR(v->block_starts, blocks + 1, error, done);
  scree_populate(v->sorted, v->count * sizeof *v->sorted);
  scree_populate(v->scratch, v->count * sizeof *v->scratch);
  gather_records(v);
  if (v->count) spread_records(v);
  for (size_t k = 0; k <= blocks; k++)
    v->block_starts[k] = k < blocks ? bucket_start(v, k * SORT_BLOCK) : v->count;
  scree_parallel_for(v->count, SORT_BLOCK, sort_block, v);
  status = SCREE_OK;
done:
  scree_free(v->sorted);
  scree_free(v->scratch);
  scree_free(v->counts);
  scree_free(v->block_starts);
  return status;
}

/* ---- triangles ---- */

typedef struct triangle_sort {
  const uint32_t
      *starts;    /* of the triangles whose smallest vertex is v: [starts[v], starts[v+1]) */
  uint64_t *rest; /* the second index, high, and the third */
  uint32_t *triangles;
} triangle_sort;

static void sort_triangle_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const triangle_sort *s = context;
  for (size_t v = begin; v < end; v++) {
    size_t first = s->starts[v], last = s->starts[v + 1];
    scree_sort_keys(s->rest + first, last - first);
    for (size_t t = first; t < last; t++) {
      s->triangles[3 * t] = (uint32_t)v;
      s->triangles[3 * t + 1] = (uint32_t)(s->rest[t] >> 32);
      s->triangles[3 * t + 2] = (uint32_t)s->rest[t];
    }
  }
}

static uint32_t least_of(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t ab = a < b ? a : b;
  return ab < c ? ab : c;
}

/* Triangles by their smallest vertex, counted and spread in two halves. */
typedef struct triangle_spread {
  const uint32_t *loose, *rank;
  uint32_t *triangles; /* renumbered */
  uint32_t *next[2];   /* per vertex: how many a half has of it; then where the next one goes */
  uint64_t *rest;
} triangle_spread;

static void count_half(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const triangle_spread *s = context;
  uint32_t *counts = s->next[block];
  for (size_t t = begin; t < end; t++) {
    const uint32_t *v = s->loose + 3 * t;
    uint32_t *ranked = s->triangles + 3 * t;
    for (int k = 0; k < 3; k++) ranked[k] = s->rank[v[k]];
    counts[least_of(ranked[0], ranked[1], ranked[2])]++;
  }
}

static void spread_half(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const triangle_spread *s = context;
  uint32_t *next = s->next[block];
  for (size_t t = begin; t < end; t++) {
    const uint32_t *v = s->triangles + 3 * t;
    uint32_t least = least_of(v[0], v[1], v[2]);
    int k = v[0] == least ? 0 : v[1] == least ? 1 : 2;
    uint32_t second = v[(k + 1) % 3], third = v[(k + 2) % 3];
    s->rest[next[least]++] = (uint64_t)second << 32 | third;
  }
}

/* Renumbers loose->triangles by rank, into made->triangles. */
static scree_status sort_triangles(const scree_loose_mesh *loose, const uint32_t *rank,
                                   scree_mesh *made, scree_error *error) {
  scree_status status = SCREE_OUT_OF_MEMORY;
  size_t count = loose->triangle_count, vertex_count = made->vertex_count;
  /* the vertices' starts, and both halves' counts */
  uint32_t *starts = scree_alloc_zero(3 * vertex_count + 1, sizeof *starts);
  uint64_t *rest = NULL;
  if (!starts) {
    scree_fail_memory(error, 3 * vertex_count * sizeof *starts, "the triangles of a mesh");
    goto done;
  }
  SCREE_ALLOC_OR(rest, count, error, done);
  scree_populate(rest, count * sizeof *rest);
  scree_populate(made->triangles, 3 * count * sizeof *made->triangles);
  triangle_spread s = {.loose = loose->triangles,
                       .rank = rank,
                       .triangles = made->triangles,
                       .next = {starts + vertex_count + 1, starts + 2 * vertex_count + 1},
                       .rest = rest};
  scree_parallel_for(count, count / 2 + 1, count_half, &s);
  uint32_t start = 0;
  for (size_t v = 0; v < vertex_count; v++) {
    uint32_t first = s.next[0][v], second = s.next[1][v];
    starts[v] = s.next[0][v] = start;
    s.next[1][v] = start + first;
    start += first + second;
  }
  starts[vertex_count] = start;
  scree_parallel_for(count, count / 2 + 1, spread_half, &s);
  triangle_sort sort = {starts, rest, made->triangles};
  scree_parallel_for(vertex_count, SORT_BLOCK, sort_triangle_block, &sort);
  status = SCREE_OK;
done:
  scree_free(starts);
  scree_free(rest);
  return status;
}

scree_status scree_weld_sort(const scree_loose_mesh *loose, scree_mesh *mesh, scree_error *error) {
  size_t count = 0;
  for (size_t i = 0; i < loose->vertex_count; i++) count += !loose->used || loose->used[i];
  scree_mesh made = {.vertex_count = count, .triangle_count = loose->triangle_count};
  uint32_t *rank = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(made.positions, 3 * count, error, done);
  SCREE_ALLOC_OR(made.triangles, 3 * made.triangle_count, error, done);
  SCREE_ALLOC_OR(rank, loose->vertex_count, error, done);
  vertex_sort vertices = {
      .loose = loose, .count = count, .positions = made.positions, .rank = rank};
  status = sort_vertices(&vertices, error);
  if (status == SCREE_OK) status = sort_triangles(loose, rank, &made, error);
  if (status != SCREE_OK) goto done;
  *mesh = made;
  made = (scree_mesh){0};
done:
  scree_free(rank);
  scree_mesh_free(&made);
  return status;
}
