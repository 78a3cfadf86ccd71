/* Distances from the scan are taken at the points spread over it. A vertex of the scan lies no
 * farther from the level than its point does, plus the way between them; vertices that could be the
 * farthest by that bound are asked themselves. Distances back are taken at points spread over the
 * level, half as many: its facets are few and flat. Facets of the level are cut
 * (mesh/measure/distance.c) where they could hold a point farther than the farthest found. */
#include "choice/gauge.h"

#include "base/alloc.h"
#include "base/math.h"
#include "base/owned.h"
#include "base/parallel.h"
#include "base/radix.h"
#include "base/sum.h"
#include "mesh/index/bvh.h"
#include "simplify/flat_fan.h"

enum {
  PROBE_STEP = 4,    /* points per probe */
  BACK_STEP = 2,     /* points of the spread per point of the level, at least */
  BACK_LEAST = 1000, /* points of a level */
  CUT_STEP = 5,      /* points of the spread per sample for cutting */
  QUERY_BLOCK = 256  /* points that share a start */
};
/* Facets of the scan no larger than this hide nothing between their corners; of D. */
static const double SMALL_FACET = 0.002;
/* From how many points of a level its mean distance is known to one per cent: so many times the
 * root of its facets, for the error falls with the points a facet and averages over facets. */
static const double POINTS_PER_ROOT = 600;
/* Maxima of the distance over a facet rise from it by no more than this: 30 degrees. */
static const double SLOPE = 0.5;
/* A wall's other side faces back: the cosine of its normal with the ray inward. */
static const double FACING_BACK = 0.8;
/* Thinner is the surface itself, seen from beside the point; of D. */
static const double LEAST_WALL = 0.002;

double scree_normalised_error(const double errors[SCREE_SHAPE_ERROR_COUNT],
                              const double tolerances[SCREE_SHAPE_ERROR_COUNT],
                              scree_shape_error *which) {
  double load = 0;
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++) {
    if (!(errors[e] / tolerances[e] > load)) continue;
    load = errors[e] / tolerances[e];
    if (which) *which = (scree_shape_error)e;
  }
  return load;
}

/* ---- The scan ---- */

static double percentile(double *values, size_t count, double share) {
  if (count == 0) return NAN;
  scree_sort_numbers(values, count);
  return values[(size_t)(share * (double)count)];
}

/* How thick the surface is along a line from between its sides; 0 where it has none there. */
static double thickness_along(const scree_bvh *bvh, const scree_body_wall *wall) {
  double facing[2] = {0, 0};
  double there = scree_ray_meet(bvh, wall->middle, wall->inward, 0, &facing[0]),
         back = scree_ray_meet(bvh, wall->middle, vec3_neg(wall->inward), 0, &facing[1]);
  bool inside = there + back < INFINITY && facing[0] > 0 && facing[1] > 0;
  return inside ? there + back : 0;
}

/* None of a foil: what a ray meets there are its edges. */
static void find_walls(scree_gauge *g) {
  const scree_bvh *bvh = &g->surface->bvh;
  double usual = 2 * fabs(g->measures.volume) / g->measures.area;
  if (usual < LEAST_WALL * g->length) return;
  for (size_t i = 0; i < g->probe_count; i++) {
    scree_body_wall *wall = &g->walls[g->wall_count];
    double facing = 0;
    wall->point = (uint32_t)(i * g->probe_step);
    wall->inward = vec3_neg(g->probe_normals[i]);
    vec3 from = g->spread.points[wall->point];
    double way = scree_ray_meet(bvh, from, wall->inward, LEAST_WALL * g->length, &facing);
    if (!(way < INFINITY) || facing < FACING_BACK) continue;
    wall->middle = vec3_mad(from, wall->inward, way / 2);
    wall->thickness = thickness_along(bvh, wall);
    g->wall_count += wall->thickness > 0;
  }
}

static scree_status set_thickness(scree_gauge *g, scree_error *error) {
  SCREE_SCRATCH(double, sorted, g->wall_count, error);
  for (size_t i = 0; i < g->wall_count; i++) sorted[i] = g->walls[i].thickness;
  g->thickness = percentile(sorted, g->wall_count, 0.5);
  g->thinnest = percentile(sorted, g->wall_count, 0.01);
  return SCREE_OK;
}

static scree_status set_probes(scree_gauge *g, scree_error *error) {
  g->probe_step = PROBE_STEP;
  g->probe_count = (g->spread.count + PROBE_STEP - 1) / PROBE_STEP;
  SCREE_SCRATCH(vec3, points, g->probe_count, error);
  SCREE_TRY_ALLOC(g->probe_normals, g->probe_count, error);
  SCREE_TRY_ALLOC(g->walls, g->probe_count + 1, error);
  for (size_t i = 0; i < g->probe_count; i++) {
    points[i] = g->spread.points[i * PROBE_STEP];
    g->probe_normals[i] = g->spread.normals[i * PROBE_STEP];
    if (g->measures.inward) g->probe_normals[i] = vec3_neg(g->probe_normals[i]);
  }
  SCREE_TRY(scree_fit_points(g->scan, points, g->probe_normals, g->probe_count, &g->fit, error));
  g->clean_area = g->fit.area_share * g->measures.area;
  find_walls(g);
  return set_thickness(g, error);
}

/* With flat fans of thousands of triangles, whose boxes all meet, cut otherwise. */
static scree_status make_surface(const scree_mesh *scan, scree_surface **surface,
                                 scree_error *error) {
  scree_mesh same = *scan;
  SCREE_CLEANUP(scree_free_at) uint32_t *triangles = NULL;
  SCREE_TRY(scree_flat_fans_cut(scan, &triangles, error));
  if (triangles) same.triangles = triangles;
  return scree_surface_create(&same, surface, error);
}

scree_status scree_gauge_make(const scree_mesh *scan, size_t point_count, scree_gauge *gauge,
                              scree_error *error) {
  SCREE_CLEANUP(scree_gauge_free) scree_gauge made = {.scan = scan};
  SCREE_TRY(scree_mesh_measure(scan, &made.measures, error));
  if (!(made.measures.area > 0))
    return scree_fail(error, SCREE_BAD_MESH, "%zu triangles of area %g m2: no surface to judge",
                      scan->triangle_count, made.measures.area);
  made.length = sqrt(made.measures.area / acos(-1));
  scree_extent_of_mesh(&made.extent, made.measures.oriented_axes, scan);
  SCREE_TRY(make_surface(scan, &made.surface, error));
  SCREE_TRY(scree_spread_make(scan, point_count, &made.spread, error));
  SCREE_TRY(set_probes(&made, error));
  *gauge = made;
  made = (scree_gauge){0};
  return SCREE_OK;
}

scree_status scree_gauge_refine(const scree_gauge *gauge, size_t point_count, scree_gauge *refined,
                                scree_error *error) {
  SCREE_CLEANUP(scree_gauge_free)
  scree_gauge made = {.scan = gauge->scan,
                      .surface = gauge->surface,
                      .refined = true,
                      .measures = gauge->measures,
                      .length = gauge->length,
                      .extent = gauge->extent};
  SCREE_TRY(scree_spread_make(gauge->scan, point_count, &made.spread, error));
  SCREE_TRY(set_probes(&made, error));
  *refined = made;
  made = (scree_gauge){0};
  return SCREE_OK;
}

void scree_gauge_free(scree_gauge *gauge) {
  if (!gauge->refined) scree_surface_free(gauge->surface);
  scree_spread_free(&gauge->spread);
  scree_free(gauge->probe_normals);
  scree_free(gauge->walls);
  *gauge = (scree_gauge){0};
}

/* ---- From the scan to a level ---- */

typedef struct forward {
  const scree_gauge *gauge;
  const scree_mesh *mesh; /* the level's */
  const scree_surface *level;
  double *distances; /* of the points */
  uint32_t *nearest; /* facet of the level's tree, of each point */
  double mean, maximum;
  vec3 at;
} forward;

static void ask_points(void *context, scree_block block) {
  const forward *f = context;
  scree_surface_nearest_points(f->level, f->gauge->spread.points + block.begin,
                               block.end - block.begin, f->distances + block.begin,
                               f->nearest + block.begin);
}

static void keep_farthest(forward *f, double distance, vec3 at) {
  if (distance <= f->maximum) return;
  f->maximum = distance;
  f->at = at;
}

static double facet_distance(const scree_bvh *bvh, uint32_t facet, vec3 p) {
  double corners[9];
  vec3 point;
  scree_bvh_corners(bvh, facet, corners);
  return sqrt(scree_triangle_closest(corners, p, &point));
}

/* Vertices round point i, where one of them could be the farthest: by the way from the point, and
 * by the facet that is nearest to the point. */
static void ask_vertices(forward *f, size_t i, double gap) {
  const scree_spread *s = &f->gauge->spread;
  uint32_t near = f->nearest[i];
  for (uint32_t k = s->starts[i]; k < s->starts[i + 1]; k++) {
    vec3 p = vec3_load(f->gauge->scan->positions + 3 * (size_t)s->vertices[k]);
    double bound = f->distances[i] + vec3_distance(p, s->points[i]);
    if (bound <= (1 + gap) * f->maximum) continue;
    if (facet_distance(&f->level->bvh, near, p) <= (1 + gap) * f->maximum) continue;
    keep_farthest(f, scree_surface_nearest(f->level, p, &near), p);
  }
}

/* First round the points that are far themselves, so that the bound spares most of the others. */
static void find_farthest(forward *f, double gap) {
  const scree_spread *s = &f->gauge->spread;
  for (size_t i = 0; i < s->count; i++) keep_farthest(f, f->distances[i], s->points[i]);
  double far = 0.9 * f->maximum;
  for (int round = 0; round < 2; round++)
    for (size_t i = 0; i < s->count; i++) {
      bool first = f->distances[i] >= far;
      if (first == (round == 0) && f->distances[i] + s->reach[i] > (1 + gap) * f->maximum)
        ask_vertices(f, i, gap);
    }
}

static void go_forward(forward *f, double gap) {
  scree_sum sum = {0, 0};
  size_t count = f->gauge->spread.count;
  f->maximum = -1;
  scree_parallel_for(count, QUERY_BLOCK, ask_points, f);
  for (size_t i = 0; i < count; i++) scree_sum_add(&sum, f->distances[i]);
  f->mean = scree_sum_value(sum) / (double)count;
  find_farthest(f, gap);
}

/* ---- What the probes see ---- */

static vec3 facet_normal(const scree_bvh *bvh, uint32_t facet) {
  double c[9];
  scree_bvh_corners(bvh, facet, c);
  return vec3_unit(vec3_triangle_normal(vec3_load(c), vec3_load(c + 3), vec3_load(c + 6)));
}

/* Mean angle between the normals, over pi. */
static double normals_error(const forward *f) {
  const scree_gauge *g = f->gauge;
  double sum = 0, turn = g->measures.inward ? -1 : 1;
  for (size_t i = 0; i < g->probe_count; i++) {
    vec3 normal = facet_normal(&f->level->bvh, f->nearest[i * g->probe_step]);
    double cosine = turn * vec3_dot(normal, g->probe_normals[i]);
    sum += scree_acos(fmax(-1, fmin(1, cosine)));
  }
  return sum / (double)g->probe_count / acos(-1);
}

/* The mean of distance over thickness, and the change of the first percentile of thickness. */
static scree_status read_walls(const forward *f, scree_gauge_reading *r, scree_error *error) {
  const scree_gauge *g = f->gauge;
  double sum = 0;
  SCREE_SCRATCH(double, now, g->wall_count, error);
  for (size_t i = 0; i < g->wall_count; i++) {
    sum += f->distances[g->walls[i].point] / g->walls[i].thickness;
    now[i] = thickness_along(&f->level->bvh, &g->walls[i]);
  }
  r->errors[SCREE_ERROR_THICKNESS] = g->wall_count ? sum / (double)g->wall_count : NAN;
  r->changes[SCREE_CHANGE_THINNEST] = percentile(now, g->wall_count, 0.01) / g->thinnest - 1;
  return SCREE_OK;
}

/* ---- Integrals ---- */

static double inertia_error(const scree_measures *a, const scree_measures *b) {
  double difference = 0, size = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double d = a->inertia[i][j] - b->inertia[i][j];
      difference += d * d;
      size += b->inertia[i][j] * b->inertia[i][j];
    }
  return sqrt(difference / size);
}

static double trace_of(const scree_measures *m) {
  return m->principal_moments[0] + m->principal_moments[1] + m->principal_moments[2];
}

static void read_measures(const scree_gauge *g, const scree_measures *m, scree_gauge_reading *r) {
  const scree_measures *scan = &g->measures;
  r->changes[SCREE_CHANGE_AREA] = m->area / g->clean_area - 1;
  r->changes[SCREE_CHANGE_VOLUME] = m->volume / scan->volume - 1;
  r->changes[SCREE_CHANGE_INERTIA] = trace_of(m) / trace_of(scan) - 1;
  r->changes[SCREE_CHANGE_CONVEXITY] = m->convexity / scan->convexity - 1;
  r->errors[SCREE_ERROR_AREA] = fabs(r->changes[SCREE_CHANGE_AREA]);
  r->errors[SCREE_ERROR_VOLUME] = fabs(r->changes[SCREE_CHANGE_VOLUME]);
  r->errors[SCREE_ERROR_CONVEXITY] = fabs(r->changes[SCREE_CHANGE_CONVEXITY]);
  r->errors[SCREE_ERROR_INERTIA] = inertia_error(m, scan);
}

/* Relative changes; a body that is flat has no width across. */
static void read_widths(const scree_gauge *g, const scree_mesh *level, scree_gauge_reading *r) {
  scree_extent extent;
  scree_extent_of_mesh(&extent, g->measures.oriented_axes, level);
  r->errors[SCREE_ERROR_WIDTHS] = 0;
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
    double was = scree_extent_width(&g->extent, i),
           change = was > 0 ? scree_extent_width(&extent, i) / was - 1 : 0;
    if (i < 3) r->changes[SCREE_CHANGE_LENGTH + i] = change;
    r->errors[SCREE_ERROR_WIDTHS] = fmax(r->errors[SCREE_ERROR_WIDTHS], fabs(change));
  }
}

/* ---- Both ways ---- */

static size_t back_points(const scree_gauge *g, size_t facet_count) {
  double enough = g->refined ? INFINITY : POINTS_PER_ROOT * sqrt((double)facet_count);
  return (size_t)fmax(BACK_LEAST, fmin(enough, (double)(g->spread.count / BACK_STEP)));
}

/* From points spread over the level; their mean distance from the scan. */
static scree_status go_back(forward *f, double *mean, scree_error *error) {
  const scree_gauge *g = f->gauge;
  SCREE_CLEANUP(scree_spread_free) scree_spread points = {0};
  scree_sum sum = {0, 0};
  SCREE_TRY(scree_spread_make(f->mesh, back_points(g, f->mesh->triangle_count), &points, error));
  SCREE_SCRATCH(double, distances, points.count, error);
  scree_surface_distances(g->surface, &points.points->x, points.count, distances);
  for (size_t i = 0; i < points.count; i++) {
    scree_sum_add(&sum, distances[i]);
    keep_farthest(f, distances[i], points.points[i]);
  }
  *mean = scree_sum_value(sum) / (double)points.count;
  return SCREE_OK;
}

/* A facet that spans a hollow of the other surface is farther off than its corners. */
static scree_status search_facets(forward *f, const scree_surface *from, const scree_surface *to,
                                  double gap, scree_error *error) {
  scree_deviation d;
  const scree_deviation_rule way = {.sample_count = 1,
                                    .gap = gap,
                                    .slope = f->gauge->refined ? 1 : SLOPE,
                                    .known = f->maximum,
                                    .cut_budget = f->gauge->spread.count /
                                                  (f->gauge->refined ? BACK_STEP : CUT_STEP)};
  SCREE_TRY(scree_surface_deviation(from, to, &way, NULL, &d, error));
  keep_farthest(f, d.maximum, vec3_load(d.at));
  return SCREE_OK;
}

/* Of the scan's facets few may be farther off than what was found. */
static scree_status search_scan(forward *f, double gap, scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh part = {0};
  SCREE_OWNED(scree_surface, surface);
  SCREE_TRY(scree_surface_farther_part(f->gauge->surface, f->level, (1 + gap) * f->maximum, &part,
                                       error));
  if (part.triangle_count == 0) return SCREE_OK;
  SCREE_TRY(scree_surface_create(&part, &surface, error));
  return search_facets(f, surface, f->level, gap, error);
}

static scree_status read_means(forward *f, double gap, scree_gauge_reading *r, scree_error *error) {
  double back;
  go_forward(f, gap);
  SCREE_TRY(go_back(f, &back, error));
  r->errors[SCREE_ERROR_MEAN] = fmax(f->mean, back) / f->gauge->length;
  return SCREE_OK;
}

static scree_status read_farthest(forward *f, double gap, scree_gauge_reading *r,
                                  scree_error *error) {
  const scree_gauge *g = f->gauge;
  SCREE_TRY(search_facets(f, f->level, g->surface, gap, error));
  if (g->refined && sqrt(g->surface->largest_facet) >= SMALL_FACET * g->length)
    SCREE_TRY(search_scan(f, gap, error));
  r->errors[SCREE_ERROR_HAUSDORFF] = f->maximum / g->length;
  vec3_store(r->farthest, f->at);
  return SCREE_OK;
}

static scree_status read_level(forward *f, double gap, const double *tolerances,
                               scree_gauge_reading *r, scree_error *error) {
  SCREE_TRY(read_means(f, gap, r, error));
  if (tolerances && scree_normalised_error(r->errors, tolerances, NULL) > 1) return SCREE_OK;
  SCREE_TRY(read_farthest(f, gap, r, error));
  SCREE_TRY(read_walls(f, r, error));
  r->errors[SCREE_ERROR_NORMALS] = normals_error(f);
  r->errors[SCREE_ERROR_THINNEST] = fabs(r->changes[SCREE_CHANGE_THINNEST]);
  return SCREE_OK;
}

scree_status scree_gauge_read(const scree_gauge *gauge, const scree_mesh *level, double gap,
                              const double *tolerances, scree_gauge_reading *reading,
                              scree_error *error) {
  scree_surface *surface;
  scree_measures measures;
  scree_gauge_reading r = {0};
  SCREE_SCRATCH(double, distances, gauge->spread.count, error);
  SCREE_SCRATCH(uint32_t, nearest, gauge->spread.count, error);
  SCREE_TRY(scree_mesh_measure(level, &measures, error));
  SCREE_TRY(scree_surface_create(level, &surface, error));
  forward f = {
      .gauge = gauge, .mesh = level, .level = surface, .distances = distances, .nearest = nearest};
  read_measures(gauge, &measures, &r);
  read_widths(gauge, level, &r);
  scree_status status = read_level(&f, gap, tolerances, &r, error);
  scree_surface_free(surface);
  if (status == SCREE_OK) *reading = r;
  return status;
}
