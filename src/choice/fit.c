/* Round each point a height z = a + b x + c y + d x^2 + e x y + f y^2 over the mean tangent plane
 * is fitted by least squares to the vertices within REACH spacings that face the same way.
 *
 * The median residual of the fits is noise where it does not depend on how far they reach. What the
 * quadric misses of the shape grows with the third power of the reach. So fits of two reaches tell
 * the two apart: r1^2 = n^2 + s^2 and r2^2 = n^2 + k s^2, with k the sixth power of the ratio.
 *
 * Noise of slope g adds g^2 / 2 to each unit of area. The slope is seen at points that fit well, as
 * the angle between the facet and the fitted surface. */
#include "choice/fit.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "base/radix.h"
#include "mesh/measure/measure.h"
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
/* Fits whose residual is above this many medians are of edges and corners. */
static const double GOOD_FIT = 2;

/* Vertices in cubic cells, by a hash of the cell. */
typedef struct cells {
  const scree_mesh *mesh;
  vec3 *normals; /* of the vertices */
  vec3 low;
  double side; /* of a cell: the reach */
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

/* Solves the system in place by elimination with pivots; the last column becomes the solution. */
static bool solve(double a[UNKNOWNS][UNKNOWNS + 1]) {
  for (int i = 0; i < UNKNOWNS; i++) {
    int pivot = i;
    for (int j = i + 1; j < UNKNOWNS; j++)
      if (fabs(a[j][i]) > fabs(a[pivot][i])) pivot = j;
    if (!(fabs(a[pivot][i]) > 1e-9)) return false;
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

/* The residual (root mean square, m) of the fit round p, INFINITY where there is none; *normal
 * becomes the fitted surface's at p. */
static double fit_at(const cells *c, vec3 p, vec3 *normal) {
  uint32_t neighbours[MOST_NEIGHBOURS];
  int count = find_neighbours(c, p, *normal, neighbours);
  vec3 up = {0, 0, 0}, u, v;
  for (int i = 0; i < count; i++) up = vec3_add(up, c->normals[neighbours[i]]);
  if (count < LEAST_NEIGHBOURS || vec3_norm(up) == 0) return INFINITY;
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
  if (!solve(a)) return INFINITY;
  for (int j = 0; j < UNKNOWNS; j++) square -= a[j][UNKNOWNS] * right[j];
  *normal = vec3_unit(vec3_mad(vec3_mad(up, u, -a[1][UNKNOWNS]), v, -a[2][UNKNOWNS]));
  return c->side * sqrt(fmax(square, 0) / (count - UNKNOWNS));
}

typedef struct fitting {
  const cells *cells;
  const vec3 *points, *facet_normals;
  vec3 *normals; /* fitted */
  double *residuals;
} fitting;

static void fit_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const fitting *f = context;
  for (size_t i = begin; i < end; i++) {
    f->normals[i] = f->facet_normals[i];
    f->residuals[i] = fit_at(f->cells, f->points[i], &f->normals[i]);
  }
}

static double median(double *values, size_t count) {
  if (count == 0) return 0;
  scree_sort_numbers(values, count);
  return isfinite(values[count / 2]) ? values[count / 2] : 0;
}

/* The share of the near fits' squared residual that is noise. */
static double noise_share(double near, double far) {
  double growth = pow(FAR_REACH / REACH, 6);
  if (!(near > 0)) return 0;
  double share = (growth - far * far / (near * near)) / (growth - 1);
  return fmax(0, fmin(1, share));
}

static scree_status make_cells(const scree_mesh *mesh, cells *c, scree_error *error) {
  double area;
  vec3 high;
  scree_status status = scree_mesh_area_volume(mesh, &area, NULL, error);
  if (status != SCREE_OK) return status;
  *c = (cells){.mesh = mesh, .side = REACH * sqrt(area / (double)mesh->vertex_count), .mask = 1};
  while (c->mask < mesh->vertex_count) c->mask = 2 * c->mask + 1;
  scree_mesh_bounds(mesh, &c->low, &high);
  SCREE_ALLOC_OR(c->normals, mesh->vertex_count, error, failed);
  SCREE_ALLOC_OR(c->starts, (size_t)c->mask + 2, error, failed);
  SCREE_ALLOC_OR(c->vertices, mesh->vertex_count, error, failed);
  set_normals(c);
  fill_cells(c);
  return SCREE_OK;
failed:
  return SCREE_OUT_OF_MEMORY;
}

static void free_cells(cells *c) {
  scree_free(c->normals);
  scree_free(c->starts);
  scree_free(c->vertices);
}

/* Mean cosine between facets and fitted surface where the fit is good. */
static double mean_cosine(const fitting *f, size_t count, double most) {
  double sum = 0;
  size_t good = 0;
  for (size_t i = 0; i < count; i++) {
    if (!(f->residuals[i] <= most)) continue;
    sum += vec3_dot(f->normals[i], f->facet_normals[i]);
    good++;
  }
  return good ? sum / (double)good : 1;
}

scree_status scree_fit_points(const scree_mesh *mesh, const vec3 *points, vec3 *normals,
                              size_t count, scree_fit *fit, scree_error *error) {
  cells c = {0};
  vec3 *fitted = NULL, *unused = NULL;
  double *residuals = NULL, *sorted = NULL;
  scree_status status = make_cells(mesh, &c, error);
  if (status != SCREE_OK) goto done;
  status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(fitted, count, error, done);
  SCREE_ALLOC_OR(unused, count, error, done);
  SCREE_ALLOC_OR(residuals, count, error, done);
  SCREE_ALLOC_OR(sorted, count, error, done);
  fitting f = {&c, points, normals, unused, sorted};
  c.side *= FAR_REACH / REACH; /* cells stay as they were filled, so they are filled anew */
  fill_cells(&c);
  scree_parallel_for(count, BLOCK, fit_block, &f);
  double far = median(sorted, count);
  c.side *= REACH / FAR_REACH;
  fill_cells(&c);
  f.normals = fitted;
  f.residuals = residuals;
  scree_parallel_for(count, BLOCK, fit_block, &f);
  for (size_t i = 0; i < count; i++) sorted[i] = residuals[i];
  double near = median(sorted, count), share = noise_share(near, far);
  *fit = (scree_fit){near * sqrt(share), 1 - share * (1 - mean_cosine(&f, count, GOOD_FIT * near))};
  for (size_t i = 0; i < count; i++)
    if (residuals[i] <= GOOD_FIT * near) normals[i] = fitted[i];
  status = SCREE_OK;
done:
  free_cells(&c);
  scree_free(fitted);
  scree_free(unused);
  scree_free(residuals);
  scree_free(sorted);
  return status;
}
