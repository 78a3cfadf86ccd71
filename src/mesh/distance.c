/* Distances between surfaces as Metro takes them (Cignoni, Rocchini, Scopigno 1998, "Metro:
 * measuring error on simplified surfaces"): from points spread over one surface to the nearest
 * point of the other. What differs: nothing is random, and the largest distance comes with a bound.
 *
 * Mean and root mean square. A facet of area A is cut in m x m equal parts, m = round(sqrt(A times
 * the density)), at least 1, and the integral over it taken from their centroids; where m is 1, by
 * the rule 3/4 centroid + 1/12 of each corner, exact to second degree (on the noise of a scan the
 * centroid alone would see only the mean of three corners: 18 per cent too little). Corners are
 * asked once, before the facets. Edges longer than a part's are sampled as densely, for the
 * maximum.
 *
 * Bound. The distance from a fixed triangle is a convex function of the point, so over a part of a
 * facet it is largest at a corner of the part: the distance of the part from the other surface is
 * at most the largest corner distance from any one of its triangles, for which the one nearest to
 * the centroid is taken. And distance changes no faster than position: it is also at most that of
 * the centroid plus the way to the farthest corner (Tang, Lee, Kim 2009, "Interactive Hausdorff
 * distance computation for general polygonal models"; Guthe, Borodin, Klein 2005). On request parts
 * whose bound is above the largest distance found are cut in four, again and again.
 *
 * Facets are visited in the order of their tree, so that each query starts from the triangle found
 * by the one before; blocks have a fixed size and start afresh. */
#include "base/alloc.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/sum.h"
#include "mesh/bvh.h"
#include "mesh/mesh.h"

#include <string.h>

enum {
  BLOCK = 512,         /* vertices or facets that share a start */
  CHUNK = 256 * BLOCK, /* between two reports of progress */
  /* Samples for cutting, all facets together and each at least and at most: surfaces that all but
   * coincide would be cut without end. */
  CUT_BUDGET = 1 << 22,
  CUT_LEAST = 32,
  CUT_MOST = 1 << 14,
  SAMPLE_LEAST = 10000,   /* by default */
  SAMPLE_LIMIT = 1 << 28, /* per surface */
};

/* Of the size of the bodies: distances below are rounding, and not worth cutting facets for. */
#define ROUNDING 1e-12

struct scree_surface {
  scree_mesh mesh;
  scree_bvh bvh;
  uint32_t *vertices; /* those in use, in the order in which the tree's triangles name them */
  size_t used_count;
  double area, size; /* size: bounding box diagonal */
};

/* ---- Surfaces ---- */

static void set_size(scree_surface *s) {
  scree_sum area = {0};
  for (size_t i = 0; i < s->mesh.triangle_count; i++) {
    const double *c = s->bvh.corners + 9 * i;
    vec3 normal = vec3_triangle_normal(vec3_load(c), vec3_load(c + 3), vec3_load(c + 6));
    scree_sum_add(&area, vec3_norm(normal) / 2);
  }
  s->area = scree_sum_value(area);
  s->size = vec3_distance(vec3_load(s->bvh.nodes[0].low), vec3_load(s->bvh.nodes[0].high));
}

static scree_status order_vertices(scree_surface *s, scree_error *error) {
  bool *seen = NULL;
  SCREE_ALLOC_OR(s->vertices, s->mesh.vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(seen, s->mesh.vertex_count, error, out_of_memory);
  memset(seen, 0, s->mesh.vertex_count * sizeof *seen);
  for (size_t i = 0; i < s->mesh.triangle_count; i++)
    for (size_t k = 0; k < 3; k++) {
      uint32_t v = s->mesh.triangles[3 * (size_t)s->bvh.order[i] + k];
      if (!seen[v]) s->vertices[s->used_count++] = v;
      seen[v] = true;
    }
  scree_free(seen);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

scree_status scree_surface_create(const scree_mesh *mesh, scree_surface **surface,
                                  scree_error *error) {
  scree_status status = scree_mesh_verify(mesh, error);
  if (status != SCREE_OK) return status;
  if (mesh->triangle_count == 0)
    return scree_fail(error, SCREE_BAD_MESH, "the mesh has no triangles");
  scree_surface *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a surface");
  status = scree_mesh_copy(mesh, &made->mesh, error);
  if (status == SCREE_OK) status = scree_bvh_build(mesh, &made->bvh, error);
  if (status == SCREE_OK) status = order_vertices(made, error);
  if (status != SCREE_OK) {
    scree_surface_free(made);
    return status;
  }
  set_size(made);
  *surface = made;
  return SCREE_OK;
}

void scree_surface_free(scree_surface *surface) {
  if (!surface) return;
  scree_mesh_free(&surface->mesh);
  scree_bvh_free(&surface->bvh);
  scree_free(surface->vertices);
  scree_free(surface);
}

/* The nearest triangle and its squared distance; *near is a triangle to start from, then the one
 * found. */
static double find_nearest(const scree_bvh *bvh, vec3 p, uint32_t *near) {
  scree_bvh_hit hit = {.index = *near};
  hit.distance2 = scree_triangle_closest(bvh->corners + 9 * (size_t)*near, p, &hit.point);
  scree_bvh_closest(bvh, p, &hit);
  *near = hit.index;
  return hit.distance2;
}

typedef struct point_query {
  const scree_surface *surface;
  const double *points;
  double *distances;
} point_query;

static void query_points(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const point_query *q = context;
  uint32_t near = 0;
  for (size_t i = begin; i < end; i++)
    q->distances[i] = sqrt(find_nearest(&q->surface->bvh, vec3_load(q->points + 3 * i), &near));
}

void scree_surface_distances(const scree_surface *surface, const double *points, size_t point_count,
                             double *distances) {
  point_query q = {surface, points, distances};
  scree_parallel_for(point_count, BLOCK, query_points, &q);
}

scree_status scree_mesh_distance_field(const scree_mesh *mesh, const scree_mesh *reference,
                                       double *distances, scree_error *error) {
  scree_surface *surface = NULL;
  scree_status status = scree_mesh_verify(mesh, error);
  if (status == SCREE_OK) status = scree_surface_create(reference, &surface, error);
  if (status != SCREE_OK) return status;
  scree_surface_distances(surface, mesh->positions, mesh->vertex_count, distances);
  scree_surface_free(surface);
  return SCREE_OK;
}

/* ---- One way ---- */

/* A part of a facet. */
typedef struct part {
  vec3 corner[3];
} part;

/* One that may be cut further. */
typedef struct queued {
  part part;
  double bound;
  uint32_t near;
} queued;

/* What a block of facets comes to. */
typedef struct tally {
  scree_sum area, distance, square;
  double maximum, bound;
  vec3 at;
  size_t sample_count;
} tally;

typedef struct sweep {
  const scree_surface *from, *to;
  double density; /* samples per m^2 */
  double gap;     /* as asked; 0: parts are not cut further */
  size_t budget;  /* samples for cutting a facet */
  double found;   /* the largest distance of the sweeps before */
  double *vertex_distance;
  uint32_t *vertex_near; /* a triangle of to.bvh, per vertex of from */
  double *facet_bound;   /* per facet in tree order, where gap is asked */
  queued *heaps;         /* CUT_MOST per worker, where gap is asked */
  tally *tallies;        /* per block of a chunk */
  size_t first;          /* of the chunk */
} sweep;

static void note(tally *t, double distance, vec3 at) {
  t->sample_count++;
  if (distance > t->maximum) t->maximum = distance, t->at = at;
}

static void sweep_vertices(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const sweep *s = context;
  tally t = {.maximum = -1};
  uint32_t near = 0;
  for (size_t i = s->first + begin; i < s->first + end; i++) {
    uint32_t v = s->from->vertices[i];
    vec3 p = vec3_load(s->from->mesh.positions + 3 * (size_t)v);
    double distance = sqrt(find_nearest(&s->to->bvh, p, &near));
    s->vertex_distance[v] = distance;
    s->vertex_near[v] = near;
    scree_sum_add(&t.distance, distance);
    scree_sum_add(&t.square, distance * distance);
    note(&t, distance, p);
  }
  s->tallies[block] = t;
}

static vec3 part_middle(const part *p) {
  return vec3_scale(vec3_add(vec3_add(p->corner[0], p->corner[1]), p->corner[2]), 1.0 / 3);
}

/* The largest corner distance from triangle near of the other surface: no point of the part is
 * farther from the surface. */
static double bound_by_triangle(const sweep *s, const part *p, uint32_t near) {
  double largest2 = 0;
  for (int k = 0; k < 3; k++) {
    vec3 point;
    double distance2 =
        scree_triangle_closest(s->to->bvh.corners + 9 * (size_t)near, p->corner[k], &point);
    largest2 = fmax(largest2, distance2);
  }
  return sqrt(largest2);
}

static double bound_by_way(const part *p, vec3 middle, double distance) {
  double way2 = 0;
  for (int k = 0; k < 3; k++) way2 = fmax(way2, vec3_norm2(vec3_sub(p->corner[k], middle)));
  return distance + sqrt(way2);
}

/* Samples the middle of a part; returns its distance. The bound is taken only where it could be the
 * largest. */
static double sample_part(const sweep *s, const part *p, uint32_t *near, tally *t, double *bound) {
  vec3 middle = part_middle(p);
  double distance = sqrt(find_nearest(&s->to->bvh, middle, near));
  note(t, distance, middle);
  *bound = bound_by_way(p, middle, distance);
  if (*bound > fmax(s->found, t->maximum)) *bound = fmin(*bound, bound_by_triangle(s, p, *near));
  return distance;
}

/* Part (i, j), upright or not, of a facet cut in m x m. */
static part part_of(const part *facet, size_t m, size_t i, size_t j, bool upright) {
  vec3 u = vec3_scale(vec3_sub(facet->corner[1], facet->corner[0]), 1 / (double)m),
       v = vec3_scale(vec3_sub(facet->corner[2], facet->corner[0]), 1 / (double)m),
       base = vec3_mad(vec3_mad(facet->corner[0], u, (double)i), v, (double)j);
  vec3 far = vec3_add(vec3_add(base, u), v);
  return upright ? (part){{base, vec3_add(base, u), vec3_add(base, v)}}
                 : (part){{far, vec3_add(base, v), vec3_add(base, u)}};
}

static double sweep_cut_facet(const sweep *s, const part *facet, size_t m, double area,
                              uint32_t *near, tally *t) {
  double largest = 0, weight = area / (double)(m * m);
  for (size_t i = 0; i < m; i++)
    for (size_t j = 0; i + j < m; j++)
      for (int upright = 1; upright >= 0; upright--) {
        if (!upright && i + j + 1 == m) continue;
        part p = part_of(facet, m, i, j, upright);
        double bound, distance = sample_part(s, &p, near, t, &bound);
        scree_sum_add(&t->distance, weight * distance);
        scree_sum_add(&t->square, weight * distance * distance);
        largest = fmax(largest, bound);
      }
  return largest;
}

static double sweep_whole_facet(const sweep *s, const part *facet, const uint32_t *corners,
                                double area, uint32_t *near, tally *t) {
  double bound, middle = sample_part(s, facet, near, t, &bound);
  double sum = 0, square = 0;
  for (int k = 0; k < 3; k++) {
    double distance = s->vertex_distance[corners[k]];
    sum += distance;
    square += distance * distance;
    if (bound > fmax(s->found, t->maximum))
      bound = fmin(bound, bound_by_triangle(s, facet, s->vertex_near[corners[k]]));
  }
  scree_sum_add(&t->distance, area * (0.75 * middle + sum / 12));
  scree_sum_add(&t->square, area * (0.75 * middle * middle + square / 12));
  return bound;
}

/* Edges, as Metro does: where an edge crosses a hollow it is farther off than the middles of parts.
 * For the maximum alone. Edges between two facets are seen twice, whichever way they are wound. */
static void sweep_edges(const sweep *s, const part *facet, uint32_t near, tally *t) {
  for (int k = 0; k < 3; k++) {
    vec3 from = facet->corner[k], to = facet->corner[(k + 1) % 3];
    double parts = round(vec3_distance(from, to) * sqrt(s->density));
    for (double i = 1; i < parts; i++) {
      vec3 at = vec3_lerp(from, to, i / parts);
      note(t, sqrt(find_nearest(&s->to->bvh, at, &near)), at);
    }
  }
}

static void sweep_facets(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const sweep *s = context;
  tally t = {.maximum = -1};
  for (size_t i = s->first + begin; i < s->first + end; i++) {
    const double *c = s->from->bvh.corners + 9 * i;
    const uint32_t *corners = s->from->mesh.triangles + 3 * (size_t)s->from->bvh.order[i];
    part facet = {{vec3_load(c), vec3_load(c + 3), vec3_load(c + 6)}};
    double area =
        vec3_norm(vec3_triangle_normal(facet.corner[0], facet.corner[1], facet.corner[2])) / 2;
    double cuts = round(sqrt(area * s->density));
    uint32_t near = s->vertex_near[corners[0]];
    double bound = cuts > 1 ? sweep_cut_facet(s, &facet, (size_t)cuts, area, &near, &t)
                            : sweep_whole_facet(s, &facet, corners, area, &near, &t);
    sweep_edges(s, &facet, near, &t);
    scree_sum_add(&t.area, area);
    t.bound = fmax(t.bound, bound);
    if (s->facet_bound) s->facet_bound[i] = bound;
  }
  s->tallies[block] = t;
}

/* ---- Cutting, the part of the largest bound first ---- */

static void heap_push(queued *heap, size_t *count, const queued *item) {
  size_t i = (*count)++;
  for (; i > 0 && heap[(i - 1) / 2].bound < item->bound; i = (i - 1) / 2)
    heap[i] = heap[(i - 1) / 2];
  heap[i] = *item;
}

static queued heap_pop(queued *heap, size_t *count) {
  queued top = heap[0], last = heap[--*count];
  size_t i = 0;
  for (;;) {
    size_t child = 2 * i + 1;
    if (child >= *count) break;
    if (child + 1 < *count && heap[child + 1].bound > heap[child].bound) child++;
    if (heap[child].bound <= last.bound) break;
    heap[i] = heap[child];
    i = child;
  }
  heap[i] = last;
  return top;
}

static void push_part(const sweep *s, const part *p, uint32_t near, queued *heap, size_t *count,
                      tally *t) {
  queued item = {.part = *p, .near = near};
  sample_part(s, p, &item.near, t, &item.bound);
  heap_push(heap, count, &item);
}

static void push_quarters(const sweep *s, const queued *whole, queued *heap, size_t *count,
                          tally *t) {
  const vec3 *corner = whole->part.corner;
  vec3 side[3];
  for (int k = 0; k < 3; k++)
    side[k] = vec3_scale(vec3_add(corner[(k + 1) % 3], corner[(k + 2) % 3]), 0.5);
  const part parts[4] = {{{corner[0], side[2], side[1]}},
                         {{side[2], corner[1], side[0]}},
                         {{side[1], side[0], corner[2]}},
                         {{side[0], side[1], side[2]}}};
  for (int k = 0; k < 4; k++) push_part(s, &parts[k], whole->near, heap, count, t);
}

/* What is below the largest distance found, give or take the gap, is done with. */
static void cut_facet(const sweep *s, const part *facet, uint32_t near, queued *heap, tally *t) {
  size_t count = 0;
  push_part(s, facet, near, heap, &count, t);
  for (size_t spent = 1;; spent += 4) {
    double enough = fmax(s->found, t->maximum) * (1 + s->gap) + ROUNDING * s->to->size;
    if (heap[0].bound <= enough || spent + 4 > s->budget) break;
    queued top = heap_pop(heap, &count);
    push_quarters(s, &top, heap, &count, t);
  }
  t->bound = fmax(t->bound, heap[0].bound);
}

static void sweep_bounds(void *context, size_t begin, size_t end, size_t block, int worker) {
  const sweep *s = context;
  tally t = {.maximum = -1};
  double enough = s->found * (1 + s->gap) + ROUNDING * s->to->size;
  for (size_t i = s->first + begin; i < s->first + end; i++) {
    const double *c = s->from->bvh.corners + 9 * i;
    part facet = {{vec3_load(c), vec3_load(c + 3), vec3_load(c + 6)}};
    if (s->facet_bound[i] <= enough) {
      t.bound = fmax(t.bound, s->facet_bound[i]);
      continue;
    }
    uint32_t first = s->from->mesh.triangles[3 * (size_t)s->from->bvh.order[i]];
    cut_facet(s, &facet, s->vertex_near[first], s->heaps + (size_t)worker * CUT_MOST, &t);
  }
  s->tallies[block] = t;
}

static void add_tally(tally *total, const tally *t) {
  scree_sum_merge(&total->area, t->area);
  scree_sum_merge(&total->distance, t->distance);
  scree_sum_merge(&total->square, t->square);
  total->sample_count += t->sample_count;
  total->bound = fmax(total->bound, t->bound);
  if (t->maximum > total->maximum) total->maximum = t->maximum, total->at = t->at;
}

/* What part of the whole work is done, for the report. */
typedef struct stage {
  scree_ticker ticker;
  double done, share;
} stage;

static scree_status run_sweep(sweep *s, size_t count, scree_block_function *body, stage *st,
                              tally *total, scree_error *error) {
  *total = (tally){.maximum = -1};
  for (s->first = 0; s->first < count; s->first += CHUNK) {
    size_t here = count - s->first < CHUNK ? count - s->first : CHUNK;
    if (!scree_tick(&st->ticker, "distance",
                    st->done + st->share * (double)s->first / (double)count))
      return scree_fail(error, SCREE_CANCELLED, "cancelled while measuring the distance");
    scree_parallel_for(here, BLOCK, body, s);
    for (size_t block = 0; block < scree_block_count(here, BLOCK); block++)
      add_tally(total, &s->tallies[block]);
  }
  st->done += st->share;
  return SCREE_OK;
}

static scree_status run_sweeps(sweep *s, stage *st, tally *vertices, tally *facets, tally *cuts,
                               scree_error *error) {
  size_t facet_count = s->from->mesh.triangle_count;
  scree_status status = run_sweep(s, s->from->used_count, sweep_vertices, st, vertices, error);
  s->found = vertices->maximum;
  if (status == SCREE_OK) status = run_sweep(s, facet_count, sweep_facets, st, facets, error);
  s->found = fmax(s->found, facets->maximum);
  if (status == SCREE_OK && s->facet_bound) {
    status = run_sweep(s, facet_count, sweep_bounds, st, cuts, error);
    facets->bound = cuts->bound;
  }
  return status;
}

static scree_deviation conclude(const tally *vertices, const tally *facets, const tally *cuts) {
  /* a surface without area is as good as its vertices */
  double area = scree_sum_value(facets->area);
  const tally *mean = area > 0 ? facets : vertices;
  double weight = area > 0 ? area : (double)vertices->sample_count;
  tally total = *vertices;
  add_tally(&total, facets);
  add_tally(&total, cuts);
  scree_deviation d = {.mean = scree_sum_value(mean->distance) / weight,
                       .rms = sqrt(scree_sum_value(mean->square) / weight),
                       .maximum = total.maximum,
                       .maximum_bound = fmax(facets->bound, total.maximum),
                       .sample_count = total.sample_count};
  vec3_store(d.at, total.at);
  return d;
}

static scree_status deviate(const scree_surface *from, const scree_surface *to,
                            const scree_distance_options *options, stage *st,
                            scree_deviation *deviation, scree_error *error) {
  sweep s = {.from = from, .to = to, .gap = options->hausdorff_gap};
  size_t vertex_count = from->mesh.vertex_count;
  tally vertices, facets = {0}, cuts = {.maximum = -1};
  scree_status status = SCREE_OUT_OF_MEMORY;
  s.density = from->area > 0 ? (double)options->sample_count / from->area : 0;
  SCREE_ALLOC_OR(s.vertex_distance, vertex_count, error, done);
  SCREE_ALLOC_OR(s.vertex_near, vertex_count, error, done);
  SCREE_ALLOC_OR(s.tallies, CHUNK / BLOCK, error, done);
  s.budget = CUT_BUDGET / from->mesh.triangle_count;
  s.budget = s.budget < CUT_LEAST ? CUT_LEAST : s.budget > CUT_MOST ? CUT_MOST : s.budget;
  if (s.gap > 0) {
    SCREE_ALLOC_OR(s.facet_bound, from->mesh.triangle_count, error, done);
    SCREE_ALLOC_OR(s.heaps, (size_t)scree_worker_count() * CUT_MOST, error, done);
  }
  status = run_sweeps(&s, st, &vertices, &facets, &cuts, error);
  if (status == SCREE_OK) *deviation = conclude(&vertices, &facets, &cuts);
done:
  scree_free(s.vertex_distance);
  scree_free(s.vertex_near);
  scree_free(s.tallies);
  scree_free(s.facet_bound);
  scree_free(s.heaps);
  return status;
}

/* ---- Both ways ---- */

scree_distance_options scree_default_distance_options(void) {
  return (scree_distance_options){0};
}

static scree_status set_options(const scree_distance_options *asked, const scree_surface *a,
                                const scree_surface *b, scree_distance_options *options,
                                scree_error *error) {
  *options = asked ? *asked : scree_default_distance_options();
  if (options->sample_count == 0) {
    size_t more = a->used_count > b->used_count ? a->used_count : b->used_count;
    options->sample_count = more < SAMPLE_LEAST ? SAMPLE_LEAST : more;
  }
  if (options->sample_count > SAMPLE_LIMIT)
    return scree_fail(error, SCREE_LIMIT, "%zu samples, above the limit of %d",
                      options->sample_count, SAMPLE_LIMIT);
  if (options->hausdorff_gap != 0 && !(options->hausdorff_gap >= 1e-6))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "hausdorff_gap is %g, neither 0 nor at least 1e-6",
                      options->hausdorff_gap);
  return SCREE_OK;
}

scree_status scree_surface_distance(const scree_surface *a, const scree_surface *b,
                                    const scree_distance_options *options,
                                    const scree_progress *progress, scree_distance *distance,
                                    scree_error *error) {
  scree_distance_options o;
  scree_distance d = {0};
  scree_status status = set_options(options, a, b, &o, error);
  if (status != SCREE_OK) return status;
  int sweeps = (o.one_way ? 1 : 2) * (o.hausdorff_gap > 0 ? 3 : 2);
  stage st = {.ticker = {.progress = progress}, .share = 1.0 / sweeps};
  status = deviate(a, b, &o, &st, &d.forward, error);
  if (status == SCREE_OK && !o.one_way) status = deviate(b, a, &o, &st, &d.backward, error);
  if (status != SCREE_OK) return status;
  d.hausdorff = fmax(d.forward.maximum, d.backward.maximum);
  d.hausdorff_bound = fmax(d.forward.maximum_bound, d.backward.maximum_bound);
  *distance = d;
  return SCREE_OK;
}

scree_status scree_mesh_distance(const scree_mesh *a, const scree_mesh *b,
                                 const scree_distance_options *options,
                                 const scree_progress *progress, scree_distance *distance,
                                 scree_error *error) {
  scree_surface *first = NULL, *second = NULL;
  scree_status status = scree_surface_create(a, &first, error);
  if (status == SCREE_OK) status = scree_surface_create(b, &second, error);
  if (status == SCREE_OK)
    status = scree_surface_distance(first, second, options, progress, distance, error);
  scree_surface_free(first);
  scree_surface_free(second);
  return status;
}
