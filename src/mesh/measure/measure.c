/* Exact integrals over a polyhedron by the divergence theorem: signed sums over the tetrahedra that
 * the triangles (p, q, r) span with an origin o inside the bounding box (Zhang and Chen 2001,
 * "Efficient feature extraction for 2D/3D objects in mesh representation"; Tonon 2004, "Explicit
 * exact formulas for the 3-D tetrahedron inertia tensor"). With a, b, c the corners from o,
 * s = a + b + c, n = (q - p) x (r - p) and d = a . n:
 *
 *   S = sum |n| / 2                 V = sum d / 6
 *   int x dV   = sum d s / 24       int x x' dV = sum d (a a' + b b' + c c' + s s') / 120
 *
 * d is taken as a . n, not a . (b x c): the error then scales with the triangle, not with its
 * distance. Sums are compensated, in blocks of a fixed size that are combined in order. */
#include "mesh/measure/bounds.h"

#include "base/alloc.h"
#include "base/eigen.h"
#include "base/parallel.h"
#include "base/sum.h"

#include <string.h>

#define PI 3.141592653589793

enum {
  AREA,
  VOLUME,
  FIRST,      /* x, y, z */
  SECOND = 5, /* xx, yy, zz, xy, xz, yz */
  INTEGRALS = 11,
  BLOCK = 1 << 13 /* triangles */
};

/* Below this part of area times diagonal a volume is rounding: the surface is flat or folded on
 * itself, and has no centroid. */
#define NO_VOLUME 1e-14

typedef struct integrator {
  const scree_mesh *mesh;
  vec3 origin;
  int integral_count; /* 2: area and volume only */
  scree_sum *sums;    /* integral_count per block */
} integrator;

static void add_moments(scree_sum *sums, vec3 a, vec3 b, vec3 c, double d) {
  vec3 s = vec3_add(vec3_add(a, b), c);
  double first = d / 24, second = d / 120;
  scree_sum_add(&sums[FIRST], first * s.x);
  scree_sum_add(&sums[FIRST + 1], first * s.y);
  scree_sum_add(&sums[FIRST + 2], first * s.z);
#define MOMENT(i, j) (second * (a.i * a.j + b.i * b.j + c.i * c.j + s.i * s.j))
  scree_sum_add(&sums[SECOND], MOMENT(x, x));
  scree_sum_add(&sums[SECOND + 1], MOMENT(y, y));
  scree_sum_add(&sums[SECOND + 2], MOMENT(z, z));
  scree_sum_add(&sums[SECOND + 3], MOMENT(x, y));
  scree_sum_add(&sums[SECOND + 4], MOMENT(x, z));
  scree_sum_add(&sums[SECOND + 5], MOMENT(y, z));
#undef MOMENT
}

static void integrate_block(void *context, scree_block block) {
  const integrator *in = context;
  scree_sum sums[INTEGRALS] = {{0}};
  for (size_t t = block.begin; t < block.end; t++) {
    vec3 p = scree_mesh_corner(in->mesh, t, 0), q = scree_mesh_corner(in->mesh, t, 1),
         r = scree_mesh_corner(in->mesh, t, 2);
    vec3 normal = vec3_triangle_normal(p, q, r), a = vec3_sub(p, in->origin);
    double d = vec3_dot(a, normal);
    scree_sum_add(&sums[AREA], vec3_norm(normal) / 2);
    scree_sum_add(&sums[VOLUME], d / 6);
    if (in->integral_count > 2)
      add_moments(sums, a, vec3_sub(q, in->origin), vec3_sub(r, in->origin), d);
  }
  memcpy(in->sums + block.index * (size_t)in->integral_count, sums,
         (size_t)in->integral_count * sizeof *sums);
}

static scree_status integrate(const scree_mesh *mesh, vec3 origin, int integral_count,
                              double *integrals, scree_error *error) {
  integrator in = {.mesh = mesh, .origin = origin, .integral_count = integral_count};
  size_t blocks = scree_block_count(mesh->triangle_count, BLOCK);
  SCREE_TRY_ALLOC(in.sums, blocks * (size_t)integral_count, error);
  scree_parallel_for(mesh->triangle_count, BLOCK, integrate_block, &in);
  for (int i = 0; i < integral_count; i++) {
    scree_sum total = {0};
    for (size_t block = 0; block < blocks; block++)
      scree_sum_merge(&total, in.sums[block * (size_t)integral_count + (size_t)i]);
    integrals[i] = scree_sum_value(total);
  }
  scree_free(in.sums);
  return SCREE_OK;
}

/* ---- The whole set ---- */

static scree_status check_facets(const scree_mesh *mesh, scree_error *error) {
  SCREE_TRY(scree_mesh_verify(mesh, error));
  return mesh->triangle_count ? SCREE_OK
                              : scree_fail(error, SCREE_BAD_MESH, "the mesh has no triangles");
}

static vec3 middle(vec3 low, vec3 high) {
  return vec3_add(vec3_scale(low, 0.5), vec3_scale(high, 0.5));
}

/* From integrals about the origin to mass properties about the centroid; a volume wound inward
 * counts as if turned round. */
static void set_mass(scree_measures *m, vec3 origin, double diagonal, const double *integrals) {
  double volume = integrals[VOLUME], sign = volume < 0 ? -1 : 1;
  const double *first = integrals + FIRST, *second = integrals + SECOND;
  double offset[3] = {0, 0, 0}, about[6] = {0};
  m->has_volume = fabs(volume) > NO_VOLUME * m->area * diagonal;
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  if (m->has_volume) {
    for (int k = 0; k < 3; k++) offset[k] = first[k] / volume;
    for (int i = 0; i < 6; i++)
      about[i] = sign * (second[i] - volume * offset[row[i]] * offset[column[i]]);
  }
  vec3_store(m->centroid, vec3_add(origin, vec3_load(offset)));
  double trace = about[0] + about[1] + about[2];
  mat3 inertia = {{{trace - about[0], 0 - about[3], 0 - about[4]},
                   {0 - about[3], trace - about[1], 0 - about[5]},
                   {0 - about[4], 0 - about[5], trace - about[2]}}};
  mat3 axes;
  scree_eigen_symmetric(&inertia, m->principal_moments, &axes);
  memcpy(m->inertia, inertia.m, sizeof m->inertia);
  memcpy(m->principal_axes, axes.m, sizeof m->principal_axes);
  double size = fabs(volume);
  m->volume = volume;
  m->inward = m->has_volume && volume < 0;
  if (!m->has_volume) return;
  m->equivalent_diameter = cbrt(6 * size / PI);
  m->sphericity = PI * m->equivalent_diameter * m->equivalent_diameter / m->area;
}

/* The vertices in use, relative to origin. */
static scree_status gather_points(const scree_mesh *mesh, vec3 origin, vec3 **points,
                                  size_t *point_count, scree_error *error) {
  size_t count = 0;
  SCREE_SCRATCH_ZERO(bool, used, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(*points, mesh->vertex_count, error);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) used[mesh->triangles[c]] = true;
  for (size_t v = 0; v < mesh->vertex_count; v++)
    if (used[v]) (*points)[count++] = vec3_sub(vec3_load(mesh->positions + 3 * v), origin);
  *point_count = count;
  return SCREE_OK;
}

static scree_status measure_hull(const scree_mesh *mesh, vec3 origin, scree_measures *m,
                                 scree_error *error) {
  SCREE_CLEANUP(scree_free_at) vec3 *points = NULL;
  size_t point_count = 0;
  SCREE_CLEANUP(scree_hull_free) scree_hull hull = {0};
  scree_minimum_box box;
  mat3 axes;
  memcpy(axes.m, m->principal_axes, sizeof axes.m);
  SCREE_TRY(gather_points(mesh, origin, &points, &point_count, error));
  SCREE_TRY(scree_hull_build(points, point_count, &hull, error));
  SCREE_TRY(scree_minimum_box_fit(&hull, &axes, &box, error));
  m->hull_area = hull.area;
  m->hull_volume = hull.volume;
  m->convexity = m->has_volume && hull.volume > 0 ? fabs(m->volume) / hull.volume : 0;
  memcpy(m->oriented_axes, box.axes.m, sizeof m->oriented_axes);
  vec3_store(m->oriented_dimensions, box.size);
  vec3_store(m->oriented_center, vec3_add(origin, box.center));
  return SCREE_OK;
}

scree_status scree_mesh_measure(const scree_mesh *mesh, scree_measures *measures,
                                scree_error *error) {
  scree_measures m = {0};
  double integrals[INTEGRALS];
  vec3 low, high;
  SCREE_TRY(check_facets(mesh, error));
  scree_mesh_bounds(mesh, &low, &high);
  vec3 origin = middle(low, high), size = vec3_sub(high, low);
  SCREE_TRY(integrate(mesh, origin, INTEGRALS, integrals, error));
  m.closed = scree_mesh_is_cycle(mesh);
  m.area = integrals[AREA];
  vec3_store(m.box_min, low);
  vec3_store(m.box_max, high);
  vec3_store(m.dimensions, size);
  set_mass(&m, origin, vec3_norm(size), integrals);
  SCREE_TRY(measure_hull(mesh, origin, &m, error));
  *measures = m;
  return SCREE_OK;
}

scree_status scree_mesh_area_volume(const scree_mesh *mesh, double *area, double *volume,
                                    scree_error *error) {
  double integrals[2];
  vec3 low, high;
  SCREE_TRY(check_facets(mesh, error));
  scree_mesh_bounds(mesh, &low, &high);
  SCREE_TRY(integrate(mesh, middle(low, high), 2, integrals, error));
  if (area) *area = integrals[AREA];
  if (volume) *volume = integrals[VOLUME];
  return SCREE_OK;
}
