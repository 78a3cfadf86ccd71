/* Distances between surfaces as Metro takes them (Cignoni, Rocchini, Scopigno 1998, "Metro:
 * measuring error on simplified surfaces"): from points spread over one surface to the nearest
 * point of the other. What differs: nothing is random, and the largest distance comes with a bound.
 *
 * Mean and root mean square. A facet of area A is cut in m x m equal parts, m = round(sqrt(A times
 * the density)), at least 1, and the integral over each part taken by the rule 3/4 centroid + 1/12
 * of each corner, exact to second degree. Centroids alone are too low, because distances are mostly
 * convex over a part: by 18 per cent on the noise of a scan, by 3 to 7 on facets of a coarse level
 * cut in six. A facet's own corners are asked once, before the facets. Edges longer than a part's
 * are sampled as densely, for the maximum. Unless a density is asked for, it grows fourfold until
 * mean and root mean square change by less than CONVERGED.
 *
 * Bound. The distance from a fixed triangle is a convex function of the point, so over a part of a
 * facet it is largest at a corner of the part: the distance of the part from the other surface is
 * at most the largest corner distance from any one of its triangles, for which the one nearest to
 * the centroid is taken. And distance changes no faster than position: it is also at most that of
 * the centroid plus the way to the farthest corner (Tang, Lee, Kim 2009, "Interactive Hausdorff
 * distance computation for general polygonal models"; Guthe, Borodin, Klein 2005). On request parts
 * whose bound is above the largest distance found are cut in four, the largest bound of a block
 * first.
 *
 * Facets are visited in the order of their tree, so that each query starts from the triangle found
 * by the one before; blocks have a fixed size and start afresh. */
#include "base/alloc.h"
#include "base/owned.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/sum.h"
#include "mesh/measure/surface.h"
#include "mesh/mesh.h"

enum {
  BLOCK = 512,             /* vertices or facets that share a start */
  CHUNK = 256 * BLOCK,     /* between two reports of progress */
  EDGE_MOST = 1 << 12,     /* samples of an edge: of needles it would be any number */
  HEAP_MOST = 1 << 16,     /* parts of a block's facets that wait to be cut */
  SAMPLE_LEAST = 10000,    /* by default, to begin with */
  SAMPLE_LIMIT = 1 << 28,  /* per surface */
  CONVERGE_MOST = 1 << 24, /* samples per surface while converging */
};

/* Share of the bodies' size: distances below are rounding, and not worth cutting facets for. */
#define ROUNDING 1e-12
/* Twice the density each way changes mean and rms by no more than this share. The error left is
 * a fraction of the change, so that the results are within 1 per cent. */
#define CONVERGED 0.005
/* The Hausdorff distance's gap by default: the same accuracy. */
#define DEFAULT_GAP 0.01

/* ---- Surfaces ---- */

static void set_size(scree_surface *s) {
  scree_sum area = {0};
  for (size_t i = 0; i < s->bvh.mesh.triangle_count; i++) {
    double c[9];
    scree_bvh_corners(&s->bvh, i, c);
    vec3 normal = vec3_triangle_normal(vec3_load(c), vec3_load(c + 3), vec3_load(c + 6));
    scree_sum_add(&area, vec3_norm(normal) / 2);
    s->largest_facet = fmax(s->largest_facet, vec3_norm(normal) / 2);
  }
  s->area = scree_sum_value(area);
  s->size = vec3_distance(s->bvh.tree.nodes[0].box.low, s->bvh.tree.nodes[0].box.high);
}

scree_status scree_surface_create(const scree_mesh *mesh, scree_surface **surface,
                                  scree_error *error) {
  SCREE_TRY(scree_mesh_verify(mesh, error));
  if (mesh->triangle_count == 0)
    return scree_fail(error, SCREE_BAD_MESH, "the mesh has no triangles");
  scree_surface *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a surface");
  scree_status status = scree_bvh_build(mesh, &made->bvh, error);
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
  scree_bvh_free(&surface->bvh);
  scree_free(surface);
}

double scree_surface_nearest(const scree_surface *surface, vec3 p, uint32_t *near) {
  const scree_bvh *bvh = &surface->bvh;
  scree_bvh_hit hit = {.index = *near};
  double corners[9];
  scree_bvh_corners(bvh, *near, corners);
  hit.distance2 = scree_triangle_closest(corners, p, &hit.point);
  scree_bvh_closest(bvh, p, &hit);
  *near = hit.index;
  return sqrt(hit.distance2);
}

void scree_surface_nearest_points(const scree_surface *surface, const vec3 *points, size_t count,
                                  double *distances, uint32_t *nearest) {
  uint32_t near = 0;
  for (size_t i = 0; i < count; i++) {
    distances[i] = scree_surface_nearest(surface, points[i], &near);
    nearest[i] = near;
  }
}

typedef struct point_query {
  const scree_surface *surface;
  const double *points;
  double *distances;
} point_query;

static void query_points(void *context, scree_block block) {
  const point_query *q = context;
  uint32_t near = 0;
  for (size_t i = block.begin; i < block.end; i++)
    q->distances[i] = scree_surface_nearest(q->surface, vec3_load(q->points + 3 * i), &near);
}

void scree_surface_distances(const scree_surface *surface, const double *points, size_t point_count,
                             double *distances) {
  point_query q = {surface, points, distances};
  scree_parallel_for(point_count, BLOCK, query_points, &q);
}

/* Most of three rays that run along no axis leave the body first where the point is inside: one
 * may meet an edge, and miss. */
static void sign_points(void *context, scree_block block) {
  static const vec3 rays[] = {{0.36, 0.48, 0.8}, {-0.768, 0.64, 0.024}, {0.28, -0.576, -0.768}};
  const point_query *q = context;
  for (size_t i = block.begin; i < block.end; i++) {
    int inside = 0;
    for (int k = 0; k < 3; k++) {
      double facing = -1;
      scree_ray_meet(&q->surface->bvh, vec3_load(q->points + 3 * i), vec3_unit(rays[k]), 0,
                     &facing);
      inside += facing > 0;
    }
    if (inside > 1) q->distances[i] = -q->distances[i];
  }
}

void scree_surface_signed_distances(const scree_surface *surface, const double *points,
                                    size_t point_count, double *distances) {
  point_query q = {surface, points, distances};
  scree_surface_distances(surface, points, point_count, distances);
  scree_parallel_for(point_count, BLOCK, sign_points, &q);
}

scree_status scree_mesh_distance_field(const scree_mesh *mesh, const scree_mesh *reference,
                                       double *distances, scree_error *error) {
  scree_surface *surface;
  SCREE_TRY(scree_mesh_verify(mesh, error));
  SCREE_TRY(scree_surface_create(reference, &surface, error));
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
  double slope;   /* as asked */
  double budget;  /* samples for cutting, per facet of a block */
  double found;   /* the largest distance of the sweeps before */
  double *vertex_distance;
  uint32_t *vertex_near; /* a triangle of to.bvh, per vertex of from */
  double *facet_bound;   /* per facet in tree order, where gap is asked */
  queued *heaps;         /* HEAP_MOST per worker, where gap is asked */
  tally *tallies;        /* per block of a chunk */
  size_t first;          /* of the chunk */
} sweep;

static void note(tally *t, double distance, vec3 at) {
  t->sample_count++;
  if (distance > t->maximum) t->maximum = distance, t->at = at;
}

static void sweep_vertices(void *context, scree_block block) {
  const sweep *s = context;
  tally t = {.maximum = -1};
  uint32_t near = 0;
  for (size_t v = s->first + block.begin; v < s->first + block.end; v++) {
    vec3 p = vec3_load(s->from->bvh.mesh.positions + 3 * v);
    double distance = scree_surface_nearest(s->to, p, &near);
    s->vertex_distance[v] = distance;
    s->vertex_near[v] = near;
    scree_sum_add(&t.distance, distance);
    scree_sum_add(&t.square, distance * distance);
    note(&t, distance, p);
  }
  s->tallies[block.index] = t;
}

static vec3 part_middle(const part *p) {
  return vec3_scale(vec3_add(vec3_add(p->corner[0], p->corner[1]), p->corner[2]), 1.0 / 3);
}

/* The largest corner distance from triangle near of the other surface: no point of the part is
 * farther from the surface. */
static double bound_by_triangle(const sweep *s, const part *p, uint32_t near) {
  double largest2 = 0, corners[9];
  scree_bvh_corners(&s->to->bvh, near, corners);
  for (int k = 0; k < 3; k++) {
    vec3 point;
    double distance2 = scree_triangle_closest(corners, p->corner[k], &point);
    largest2 = fmax(largest2, distance2);
  }
  return sqrt(largest2);
}

static double bound_by_way(const part *p, vec3 middle, double distance, double slope) {
  double way2 = 0;
  for (int k = 0; k < 3; k++) way2 = fmax(way2, vec3_norm2(vec3_sub(p->corner[k], middle)));
  return distance + slope * sqrt(way2);
}

/* Samples the middle of a part; returns its distance. The bound is taken only where it could be the
 * largest. */
static double sample_part(const sweep *s, const part *p, uint32_t *near, tally *t, double *bound) {
  vec3 middle = part_middle(p);
  double distance = scree_surface_nearest(s->to, middle, near);
  note(t, distance, middle);
  *bound = bound_by_way(p, middle, distance, s->slope);
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

/* Corner (i, j) of the parts; a corner of the facet was asked before. */
static double sample_corner(const sweep *s, const part *facet, const uint32_t *corners, size_t m,
                            size_t i, size_t j, uint32_t *near, tally *t) {
  if (i + j == 0) return s->vertex_distance[corners[0]];
  if (i == m) return s->vertex_distance[corners[1]];
  if (j == m) return s->vertex_distance[corners[2]];
  vec3 u = vec3_sub(facet->corner[1], facet->corner[0]),
       v = vec3_sub(facet->corner[2], facet->corner[0]),
       at =
           vec3_mad(vec3_mad(facet->corner[0], u, (double)i / (double)m), v, (double)j / (double)m);
  double distance = scree_surface_nearest(s->to, at, near);
  note(t, distance, at);
  return distance;
}

/* How many of the m x m parts of a facet have the corner (i, j). */
static double parts_at(size_t m, size_t i, size_t j) {
  int sides = (i == 0) + (j == 0) + (i + j == m);
  return sides == 2 ? 1 : sides == 1 ? 3 : 6;
}

static void add_to_integrals(tally *t, double weight, double distance) {
  scree_sum_add(&t->distance, weight * distance);
  scree_sum_add(&t->square, weight * distance * distance);
}

static double sweep_cut_facet(const sweep *s, const part *facet, const uint32_t *corners, size_t m,
                              double area, uint32_t *near, tally *t) {
  double largest = 0, weight = area / (double)(m * m);
  for (size_t i = 0; i <= m; i++)
    for (size_t j = 0; i + j <= m; j++) {
      double distance = sample_corner(s, facet, corners, m, i, j, near, t);
      add_to_integrals(t, weight * parts_at(m, i, j) / 12, distance);
      for (int upright = 1; upright >= 0; upright--) {
        if (i + j + (upright ? 1 : 2) > m) continue;
        part p = part_of(facet, m, i, j, upright);
        double bound;
        distance = sample_part(s, &p, near, t, &bound);
        add_to_integrals(t, 0.75 * weight, distance);
        largest = fmax(largest, bound);
      }
    }
  return largest;
}

static double sweep_whole_facet(const sweep *s, const part *facet, const uint32_t *corners,
                                double area, uint32_t *near, tally *t) {
  double bound, middle = sample_part(s, facet, near, t, &bound);
  add_to_integrals(t, 0.75 * area, middle);
  for (int k = 0; k < 3; k++) {
    add_to_integrals(t, area / 12, s->vertex_distance[corners[k]]);
    if (bound > fmax(s->found, t->maximum))
      bound = fmin(bound, bound_by_triangle(s, facet, s->vertex_near[corners[k]]));
  }
  return bound;
}

/* Edges, as Metro does: where an edge crosses a hollow it is farther off than the middles of parts.
 * For the maximum alone. The corners of m x m parts lie on them, which is enough but for needles.
 * Edges between two facets are seen twice, whichever way they are wound. */
static void sweep_edges(const sweep *s, const part *facet, double m, uint32_t near, tally *t) {
  for (int k = 0; k < 3; k++) {
    vec3 from = facet->corner[k], to = facet->corner[(k + 1) % 3];
    double parts = fmin(round(vec3_distance(from, to) * sqrt(s->density)), EDGE_MOST);
    if (m > 1 && parts <= 2 * m) continue;
    for (double i = 1; i < parts; i++) {
      vec3 at = vec3_lerp(from, to, i / parts);
      note(t, scree_surface_nearest(s->to, at, &near), at);
    }
  }
}

static double cuts_of(double area, double density) {
  return round(sqrt(area * density));
}

static void sweep_facets(void *context, scree_block block) {
  const sweep *s = context;
  tally t = {.maximum = -1};
  for (size_t i = s->first + block.begin; i < s->first + block.end; i++) {
    const uint32_t *corners = s->from->bvh.mesh.triangles + 3 * i;
    double c[9];
    scree_bvh_corners(&s->from->bvh, i, c);
    part facet = {{vec3_load(c), vec3_load(c + 3), vec3_load(c + 6)}};
    double area =
        vec3_norm(vec3_triangle_normal(facet.corner[0], facet.corner[1], facet.corner[2])) / 2;
    double cuts = cuts_of(area, s->density);
    uint32_t near = s->vertex_near[corners[0]];
    double bound = cuts > 1 ? sweep_cut_facet(s, &facet, corners, (size_t)cuts, area, &near, &t)
                            : sweep_whole_facet(s, &facet, corners, area, &near, &t);
    sweep_edges(s, &facet, cuts, near, &t);
    scree_sum_add(&t.area, area);
    t.bound = fmax(t.bound, bound);
    if (s->facet_bound) s->facet_bound[i] = bound;
  }
  s->tallies[block.index] = t;
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

/* The cutting of a block: parts by falling bound, and the largest bound of those let go. */
typedef struct cutting {
  const sweep *sweep;
  queued *heap;
  size_t count;
  double settled;
  tally tally;
} cutting;

/* What is below the largest distance found, give or take the gap, is done with. */
static double enough(const cutting *c) {
  const sweep *s = c->sweep;
  return fmax(s->found, c->tally.maximum) * (1 + s->gap) + ROUNDING * s->to->size;
}

static void keep_part(cutting *c, const queued *item) {
  if (item->bound > enough(c))
    heap_push(c->heap, &c->count, item);
  else
    c->settled = fmax(c->settled, item->bound);
}

static void cut_in_four(cutting *c, const queued *whole) {
  const vec3 *corner = whole->part.corner;
  vec3 side[3];
  for (int k = 0; k < 3; k++)
    side[k] = vec3_scale(vec3_add(corner[(k + 1) % 3], corner[(k + 2) % 3]), 0.5);
  const part parts[4] = {{{corner[0], side[2], side[1]}},
                         {{side[2], corner[1], side[0]}},
                         {{side[1], side[0], corner[2]}},
                         {{side[0], side[1], side[2]}}};
  for (int k = 0; k < 4; k++) {
    queued item = {.part = parts[k], .near = whole->near};
    sample_part(c->sweep, &item.part, &item.near, &c->tally, &item.bound);
    item.bound = fmin(item.bound, whole->bound);
    keep_part(c, &item);
  }
}

static void sweep_bounds(void *context, scree_block block) {
  const sweep *s = context;
  cutting c = {.sweep = s,
               .heap = s->heaps + (size_t)block.worker * HEAP_MOST,
               .settled = 0,
               .tally = {.maximum = -1}};
  for (size_t i = s->first + block.begin; i < s->first + block.end; i++) {
    uint32_t corner = s->from->bvh.mesh.triangles[3 * i];
    double p[9];
    scree_bvh_corners(&s->from->bvh, i, p);
    keep_part(&c, &(queued){.part = {{vec3_load(p), vec3_load(p + 3), vec3_load(p + 6)}},
                            .bound = s->facet_bound[i],
                            .near = s->vertex_near[corner]});
  }
  double left = s->budget * (double)(block.end - block.begin);
  for (; c.count && c.heap[0].bound > enough(&c) && left >= 4 && c.count + 4 <= HEAP_MOST;
       left -= 4) {
    queued top = heap_pop(c.heap, &c.count);
    cut_in_four(&c, &top);
  }
  c.tally.bound = fmax(c.settled, c.count ? c.heap[0].bound : 0);
  s->tallies[block.index] = c.tally;
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

static bool is_near(scree_sum a, scree_sum b, double rounding) {
  double x = scree_sum_value(a), y = scree_sum_value(b);
  return fabs(x - y) <= CONVERGED * y + rounding;
}

/* Whether two sweeps of different density agree. */
static bool agree(const sweep *s, const tally *coarse, const tally *fine) {
  double length = ROUNDING * s->to->size, area = s->from->area;
  return is_near(coarse->distance, fine->distance, length * area) &&
         is_near(coarse->square, fine->square, length * length * area);
}

/* Facets that are all smaller than a part leave nothing to converge. */
static scree_status sweep_until_converged(sweep *s, bool converge, stage *st, tally *facets,
                                          scree_error *error) {
  size_t count = s->from->bvh.mesh.triangle_count;
  double share = st->share;
  if (!converge || cuts_of(s->from->largest_facet, s->density) <= 1)
    return run_sweep(s, count, sweep_facets, st, facets, error);
  s->density /= 4;
  st->share = share / 2;
  SCREE_TRY(run_sweep(s, count, sweep_facets, st, facets, error));
  for (bool done = false; !done;) {
    tally finer;
    s->density *= 4;
    st->share /= 2;
    SCREE_TRY(run_sweep(s, count, sweep_facets, st, &finer, error));
    done = agree(s, facets, &finer) || 4 * s->density * s->from->area > CONVERGE_MOST;
    finer.sample_count += facets->sample_count;
    if (facets->maximum > finer.maximum) finer.maximum = facets->maximum, finer.at = facets->at;
    *facets = finer;
  }
  st->share = share;
  return SCREE_OK;
}

static scree_status run_sweeps(sweep *s, const scree_deviation_rule *way, stage *st,
                               tally *vertices, tally *facets, tally *cuts, scree_error *error) {
  SCREE_TRY(run_sweep(s, s->from->bvh.mesh.vertex_count, sweep_vertices, st, vertices, error));
  s->found = fmax(way->known, vertices->maximum);
  SCREE_TRY(sweep_until_converged(s, way->converge, st, facets, error));
  s->found = fmax(s->found, facets->maximum);
  if (!s->facet_bound) return SCREE_OK;
  SCREE_TRY(run_sweep(s, s->from->bvh.mesh.triangle_count, sweep_bounds, st, cuts, error));
  facets->bound = cuts->bound;
  return SCREE_OK;
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

static void free_sweep(sweep *s) {
  SCREE_FREE_ALL(s->vertex_distance, s->vertex_near, s->tallies, s->facet_bound, s->heaps);
}

static scree_status deviate(const scree_surface *from, const scree_surface *to,
                            const scree_deviation_rule *way, stage *st, scree_deviation *deviation,
                            scree_error *error) {
  SCREE_CLEANUP(free_sweep)
  sweep s = {.from = from, .to = to, .gap = way->gap, .slope = way->slope};
  size_t vertex_count = from->bvh.mesh.vertex_count;
  tally vertices, facets = {0}, cuts = {.maximum = -1};
  s.density = from->area > 0 ? (double)way->sample_count / from->area : 0;
  SCREE_TRY_ALLOC(s.vertex_distance, vertex_count, error);
  SCREE_TRY_ALLOC(s.vertex_near, vertex_count, error);
  SCREE_TRY_ALLOC(s.tallies, CHUNK / BLOCK, error);
  s.budget = (double)way->cut_budget / (double)from->bvh.mesh.triangle_count;
  s.budget = fmax(s.budget, (double)way->cut_least);
  if (s.gap > 0) {
    SCREE_TRY_ALLOC(s.facet_bound, from->bvh.mesh.triangle_count, error);
    SCREE_TRY_ALLOC(s.heaps, (size_t)scree_worker_count() * HEAP_MOST, error);
  }
  SCREE_TRY(run_sweeps(&s, way, st, &vertices, &facets, &cuts, error));
  *deviation = conclude(&vertices, &facets, &cuts);
  return SCREE_OK;
}

scree_status scree_surface_deviation(const scree_surface *from, const scree_surface *to,
                                     const scree_deviation_rule *way,
                                     const scree_progress *progress, scree_deviation *deviation,
                                     scree_error *error) {
  stage st = {.ticker = {.progress = progress}, .share = way->gap > 0 ? 1.0 / 3 : 0.5};
  return deviate(from, to, way, &st, deviation, error);
}

/* ---- Both ways ---- */

scree_distance_options scree_default_distance_options(void) {
  return (scree_distance_options){.hausdorff_gap = DEFAULT_GAP};
}

static scree_status set_way(const scree_distance_options *options, const scree_surface *a,
                            const scree_surface *b, scree_deviation_rule *way, scree_error *error) {
  const scree_distance_options defaults = scree_default_distance_options();
  const scree_distance_options *o = options ? options : &defaults;
  size_t more = a->bvh.mesh.vertex_count > b->bvh.mesh.vertex_count ? a->bvh.mesh.vertex_count
                                                                    : b->bvh.mesh.vertex_count;
  *way = (scree_deviation_rule){o->sample_count,  o->sample_count == 0, o->hausdorff_gap, 1, 0,
                                SCREE_CUT_BUDGET, SCREE_CUT_LEAST};
  if (way->converge) way->sample_count = more < SAMPLE_LEAST ? SAMPLE_LEAST : more;
  if (way->sample_count > SAMPLE_LIMIT)
    return scree_fail(error, SCREE_LIMIT, "%zu samples, above the limit of %d", way->sample_count,
                      SAMPLE_LIMIT);
  if (way->gap != 0 && !(way->gap >= 1e-6))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "hausdorff_gap is %g, neither 0 nor at least 1e-6",
                      way->gap);
  return SCREE_OK;
}

scree_status scree_surface_distance(const scree_surface *a, const scree_surface *b,
                                    const scree_distance_options *options,
                                    const scree_progress *progress, scree_distance *distance,
                                    scree_error *error) {
  scree_deviation_rule way;
  scree_distance d = {0};
  SCREE_TRY(set_way(options, a, b, &way, error));
  bool one_way = options && options->one_way;
  int sweeps = (one_way ? 1 : 2) * (way.gap > 0 ? 3 : 2);
  stage st = {.ticker = {.progress = progress}, .share = 1.0 / sweeps};
  SCREE_TRY(deviate(a, b, &way, &st, &d.forward, error));
  if (!one_way) SCREE_TRY(deviate(b, a, &way, &st, &d.backward, error));
  d.hausdorff = fmax(d.forward.maximum, d.backward.maximum);
  d.hausdorff_bound = fmax(d.forward.maximum_bound, d.backward.maximum_bound);
  *distance = d;
  return SCREE_OK;
}

scree_status scree_mesh_distance(const scree_mesh *a, const scree_mesh *b,
                                 const scree_distance_options *options,
                                 const scree_progress *progress, scree_distance *distance,
                                 scree_error *error) {
  SCREE_OWNED(scree_surface, first);
  SCREE_OWNED(scree_surface, second);
  SCREE_TRY(scree_surface_create(a, &first, error));
  SCREE_TRY(scree_surface_create(b, &second, error));
  return scree_surface_distance(first, second, options, progress, distance, error);
}
