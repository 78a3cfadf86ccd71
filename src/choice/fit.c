/* Round each point a height z = a + b x + c y + d x^2 + e x y + f y^2 over the mean tangent plane
 * is fitted by least squares to the vertices within REACH spacings that face the same way.
 *
 * Scanner noise is alike all over the surface, and what it leaves over of a fit does not depend on
 * how far that reaches. What the quadric misses of the shape is not alike, and grows with the
 * reach: with its third power where the surface is smooth, with the first along edges and on rough
 * ground. So the noise is asked of fits of two reaches, r1^2 = n^2 + s^2 and r2^2 = n^2 + k s^2,
 * where they fit best, at a tenth of the points. With k of smooth shape n is largest, with k of
 * edges least. Where the two are far apart, or many points have too few vertices within reach that
 * face their way, as of a coarse mesh, the noise cannot be told.
 *
 * Noise of slope g adds g^2 / 2 to each unit of area. The slope is seen as the angle between the
 * facet and the fitted surface. */
#include "choice/gauge.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "base/radix.h"
#include "mesh/measure/bounds.h"
#include "mesh/mesh.h"

enum {
  UNKNOWNS = 6,
  LEAST_NEIGHBOURS = 12, /* twice the unknowns */
  MOST_NEIGHBOURS = 256,
  BLOCK = 64,
  CELLS = 27
};
/* In spacings, sqrt(area / vertices): about 20 and 38 vertices. */
static const double REACH = 2.5, FAR_REACH = 3.5;
/* Fits whose residual is above so many times what is usual are of edges and corners. */
static const double GOOD_FIT = 2;
/* Per neighbour: where these lie in two rows, which tell no curvature across, pivots are squares of
 * the noise; in three rows they are 0.05. */
static const double LEAST_PIVOT = 0.01;
/* Share of the points that must have fits for the noise to be told, and the share of these that it
 * is asked of, with its quantile of the normal distribution. */
static const double TOLD_SHARE = 2.0 / 3, BEST_SHARE = 0.1, BEST_QUANTILE = -1.2816;
/* The largest noise that the fits allow over the least, squared, for it to be told. */
static const double MOST_SPAN = 4;
/* Share of the spacing: noise of no more is told in any case, that of shape as none. */
static const double LEAST_NOISE = 0.01;

/* Vertices in cubic cells, by a hash of the cell. */
typedef struct cells {
  const scree_mesh *mesh;
  vec3 *normals; /* of the vertices */
  vec3 low;
  double spacing, side; /* of the vertices; of a cell: the reach */
  uint32_t mask, *starts, *vertices;
} cells;

typedef struct cell_index {
  int64_t x, y, z;
} cell_index;

static cell_index cell_of(const cells *c, vec3 p) {
  return (cell_index){(int64_t)floor((p.x - c->low.x) / c->side),
                      (int64_t)floor((p.y - c->low.y) / c->side),
                      (int64_t)floor((p.z - c->low.z) / c->side)};
}

static uint32_t hash_of(const cells *c, cell_index i) {
  return ((uint32_t)i.x * 73856093U ^ (uint32_t)i.y * 19349663U ^ (uint32_t)i.z * 83492791U) &
         c->mask;
}

static vec3 vertex_at(const cells *c, uint32_t v) {
  return vec3_load(c->mesh->positions + 3 * (size_t)v);
}

static void set_normals(cells *c) {
  for (size_t v = 0; v < c->mesh->vertex_count; v++) c->normals[v] = (vec3){0, 0, 0};
  for (size_t t = 0; t < c->mesh->triangle_count; t++) {
    vec3 n = scree_facet_normal(c->mesh, t);
    for (size_t k = 0; k < 3; k++) {
      vec3 *normal = &c->normals[c->mesh->triangles[3 * t + k]];
      *normal = vec3_add(*normal, n);
    }
  }
  for (size_t v = 0; v < c->mesh->vertex_count; v++) c->normals[v] = vec3_unit(c->normals[v]);
}

static void fill_cells(cells *c) {
  size_t count = c->mesh->vertex_count;
  for (uint32_t i = 0; i <= c->mask + 1; i++) c->starts[i] = 0;
  for (uint32_t v = 0; v < count; v++) c->starts[hash_of(c, cell_of(c, vertex_at(c, v))) + 1]++;
  for (uint32_t i = 0; i <= c->mask; i++) c->starts[i + 1] += c->starts[i];
  for (uint32_t v = 0; v < count; v++)
    c->vertices[c->starts[hash_of(c, cell_of(c, vertex_at(c, v)))]++] = v;
  for (uint32_t i = c->mask + 1; i > 0; i--) c->starts[i] = c->starts[i - 1];
  c->starts[0] = 0;
}

/* Vertices within the reach that face the same way; as many as there is room for. */
static int find_neighbours(const cells *c, vec3 p, vec3 normal,
                           uint32_t neighbours[MOST_NEIGHBOURS]) {
  cell_index at = cell_of(c, p);
  uint32_t seen[CELLS];
  int seen_count = 0, count = 0;
  for (int k = 0; k < CELLS; k++) {
    cell_index i = {at.x + k % 3 - 1, at.y + k / 3 % 3 - 1, at.z + k / 9 - 1};
    uint32_t hash = hash_of(c, i);
    bool again = false;
    for (int j = 0; j < seen_count; j++) again = again || seen[j] == hash;
    if (again) continue;
    seen[seen_count++] = hash;
    for (uint32_t j = c->starts[hash]; j < c->starts[hash + 1] && count < MOST_NEIGHBOURS; j++) {
      uint32_t v = c->vertices[j];
      if (vec3_distance(vertex_at(c, v), p) < c->side && vec3_dot(c->normals[v], normal) > 0)
        neighbours[count++] = v;
    }
  }
  return count;
}

/* Solves the system in place by elimination with pivots, none of them below `least`; the last
 * column becomes the solution. */
static bool solve(double a[UNKNOWNS][UNKNOWNS + 1], double least) {
  for (int i = 0; i < UNKNOWNS; i++) {
    int pivot = i;
    for (int j = i + 1; j < UNKNOWNS; j++)
      if (fabs(a[j][i]) > fabs(a[pivot][i])) pivot = j;
    if (!(fabs(a[pivot][i]) > least)) return false;
    for (int k = 0; k <= UNKNOWNS; k++) {
      double swap = a[i][k];
      a[i][k] = a[pivot][k];
      a[pivot][k] = swap;
    }
    for (int j = 0; j < UNKNOWNS; j++) {
      double factor = j == i ? 0 : a[j][i] / a[i][i];
      for (int k = i; k <= UNKNOWNS; k++) a[j][k] -= factor * a[i][k];
    }
  }
  for (int i = 0; i < UNKNOWNS; i++) a[i][UNKNOWNS] /= a[i][i];
  return true;
}

typedef struct point_fit {
  double residual; /* root mean square, m; INFINITY: there is no fit */
  int freedom;     /* neighbours less unknowns */
  vec3 normal;     /* the fitted surface's at the point */
} point_fit;

/* Round p, where the surface has that normal. */
static point_fit fit_at(const cells *c, vec3 p, vec3 normal) {
  uint32_t neighbours[MOST_NEIGHBOURS];
  point_fit fit = {.residual = INFINITY, .normal = normal};
  int count = find_neighbours(c, p, normal, neighbours);
  vec3 up = {0, 0, 0}, u, v;
  for (int i = 0; i < count; i++) up = vec3_add(up, c->normals[neighbours[i]]);
  if (count < LEAST_NEIGHBOURS || vec3_norm(up) == 0) return fit;
  fit.freedom = count - UNKNOWNS;
  up = vec3_unit(up);
  vec3_frame(up, &u, &v);
  double a[UNKNOWNS][UNKNOWNS + 1] = {{0}}, right[UNKNOWNS], square = 0;
  for (int i = 0; i < count; i++) {
    vec3 d = vec3_scale(vec3_sub(vertex_at(c, neighbours[i]), p), 1 / c->side);
    double x = vec3_dot(d, u), y = vec3_dot(d, v), z = vec3_dot(d, up);
    const double f[UNKNOWNS] = {1, x, y, x * x, x * y, y * y};
    square += z * z;
    for (int j = 0; j < UNKNOWNS; j++) {
      for (int k = 0; k < UNKNOWNS; k++) a[j][k] += f[j] * f[k];
      a[j][UNKNOWNS] += f[j] * z;
    }
  }
  for (int j = 0; j < UNKNOWNS; j++) right[j] = a[j][UNKNOWNS];
  if (!solve(a, LEAST_PIVOT * count)) return fit;
  for (int j = 0; j < UNKNOWNS; j++) square -= a[j][UNKNOWNS] * right[j];
  fit.normal = vec3_unit(vec3_mad(vec3_mad(up, u, -a[1][UNKNOWNS]), v, -a[2][UNKNOWNS]));
  fit.residual = c->side * sqrt(fmax(square, 0) / fit.freedom);
  return fit;
}

typedef struct fitting {
  const cells *cells;
  const vec3 *points, *normals;
  point_fit *fits;
} fitting;

static void fit_block(void *context, scree_block block) {
  const fitting *f = context;
  for (size_t i = block.begin; i < block.end; i++)
    f->fits[i] = fit_at(f->cells, f->points[i], f->normals[i]);
}

/* Cells are as large as the fits reach. */
static void fit_all(cells *c, double reach, const vec3 *points, const vec3 *normals, size_t count,
                    point_fit *fits) {
  fitting f = {c, points, normals, fits};
  c->side = reach * c->spacing;
  fill_cells(c);
  scree_parallel_for(count, BLOCK, fit_block, &f);
}

static double median_residual(const point_fit *fits, size_t count, double *scratch) {
  for (size_t i = 0; i < count; i++) scratch[i] = fits[i].residual;
  scree_sort_numbers(scratch, count);
  return count > 0 && isfinite(scratch[count / 2]) ? scratch[count / 2] : 0;
}

/* The same points count for both reaches. */
static bool has_both(const point_fit *near, const point_fit *far) {
  return isfinite(near->residual + far->residual);
}

/* What the best residuals would be of, were they of noise alone, by the distribution of chi squared
 * (Wilson and Hilferty 1931): of `fits`, which are near or far. NaN: at too few points. */
static double best_residual(const point_fit *fits, const point_fit *near, const point_fit *far,
                            size_t count, double *scratch) {
  size_t told = 0;
  double freedom = 0;
  for (size_t i = 0; i < count; i++) {
    if (!has_both(&near[i], &far[i])) continue;
    freedom += fits[i].freedom;
    scratch[told++] = fits[i].residual;
  }
  if ((double)told < TOLD_SHARE * (double)count || told == 0) return NAN;
  scree_sort_numbers(scratch, told);
  double variance = 2 / (9 * freedom / (double)told);
  return scratch[(size_t)(BEST_SHARE * (double)told)] /
         pow(1 - variance + BEST_QUANTILE * sqrt(variance), 1.5);
}

/* The share of the near fits' squared residual that is noise; NaN: it cannot be told. */
static double noise_share(double near, double far, double spacing) {
  double square = (FAR_REACH / REACH) * (FAR_REACH / REACH), smooth = square * square * square;
  double growth = far * far / (near * near), most = (smooth - growth) / (smooth - 1),
         least = (square - growth) / (square - 1);
  bool is_told = near <= LEAST_NOISE * spacing || MOST_SPAN * least >= most;
  return is_told ? fmax(0, fmin(1, most)) : NAN;
}

static scree_status make_cells(const scree_mesh *mesh, cells *c, scree_error *error) {
  double area;
  vec3 high;
  SCREE_TRY(scree_mesh_area_volume(mesh, &area, NULL, error));
  *c = (cells){.mesh = mesh, .spacing = sqrt(area / (double)mesh->vertex_count), .mask = 1};
  while (c->mask < mesh->vertex_count) c->mask = 2 * c->mask + 1;
  scree_mesh_bounds(mesh, &c->low, &high);
  SCREE_TRY_ALLOC(c->normals, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(c->starts, (size_t)c->mask + 2, error);
  SCREE_TRY_ALLOC(c->vertices, mesh->vertex_count, error);
  set_normals(c);
  return SCREE_OK;
}

static void free_cells(cells *c) {
  scree_free(c->normals);
  scree_free(c->starts);
  scree_free(c->vertices);
}

/* Mean cosine between facets and fitted surface where the fit is good. */
static double mean_cosine(const point_fit *near, const point_fit *far, const vec3 *normals,
                          size_t count, double most) {
  double sum = 0;
  size_t good = 0;
  for (size_t i = 0; i < count; i++) {
    if (!has_both(&near[i], &far[i]) || near[i].residual > most) continue;
    sum += vec3_dot(near[i].normal, normals[i]);
    good++;
  }
  return good ? sum / (double)good : 1;
}

scree_status scree_fit_points(const scree_mesh *mesh, const vec3 *points, vec3 *normals,
                              size_t count, scree_fit *fit, scree_error *error) {
  SCREE_CLEANUP(free_cells) cells c = {0};
  SCREE_TRY(make_cells(mesh, &c, error));
  SCREE_SCRATCH(point_fit, near, count, error);
  SCREE_SCRATCH(point_fit, far, count, error);
  SCREE_SCRATCH(double, scratch, count, error);
  fit_all(&c, FAR_REACH, points, normals, count, far);
  fit_all(&c, REACH, points, normals, count, near);
  double best = best_residual(near, near, far, count, scratch),
         share = noise_share(best, best_residual(far, near, far, count, scratch), c.spacing),
         most = GOOD_FIT * median_residual(near, count, scratch);
  *fit = (scree_fit){best * sqrt(share), 1};
  if (share > 0)
    fit->area_share = 1 - share * (1 - mean_cosine(near, far, normals, count, GOOD_FIT * best));
  for (size_t i = 0; i < count; i++)
    if (near[i].residual <= most) normals[i] = near[i].normal;
  return SCREE_OK;
}
