#include "clump/target.h"

#include "base/alloc.h"
#include "base/eigen.h"
#include "base/math.h"
#include "base/radix.h"
#include "base/sum.h"
#include "mesh/measure/bounds.h"
#include "particle/mass.h"

enum { THICKNESS_SAMPLES = 1000, SHRINKINGS = 40 };

/* The integral of (axis . x)^3 over the solid about the centre: of a tetrahedron with one corner
 * there, V / 20 times the sum of all monomials of degree 3 in its corners' heights. */
static double third_moment(const scree_mesh *mesh, vec3 centre, vec3 axis) {
  scree_sum sum = {0};
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 p[3];
    double h[3];
    for (int k = 0; k < 3; k++) {
      p[k] = vec3_sub(scree_mesh_corner(mesh, t, k), centre);
      h[k] = vec3_dot(axis, p[k]);
    }
    double volume = vec3_dot(p[0], vec3_cross(p[1], p[2])) / 6;
    double cubic = h[0] * h[0] * (h[0] + h[1] + h[2]) + h[1] * h[1] * (h[0] + h[1] + h[2]) +
                   h[2] * h[2] * (h[0] + h[1] + h[2]) + h[0] * h[1] * h[2];
    scree_sum_add(&sum, volume / 20 * cubic);
  }
  return scree_sum_value(sum);
}

/* Rows: axes by ascending second moment, right-handed; the two longer ones point to where the third
 * moment is positive. */
static mat3 target_axes(const scree_mesh *mesh, const scree_solid *solid, double second[3]) {
  mat3 axes;
  scree_eigen_symmetric(&solid->second, second, &axes);
  for (int row = 1; row < 3; row++)
    if (third_moment(mesh, solid->centre, vec3_load(axes.m[row])) < 0)
      for (int k = 0; k < 3; k++) axes.m[row][k] = -axes.m[row][k];
  vec3_store(axes.m[0], vec3_cross(vec3_load(axes.m[1]), vec3_load(axes.m[2])));
  return axes;
}

static void into_frame(scree_target *b) {
  for (size_t v = 0; v < b->mesh.vertex_count; v++) {
    double *p = b->mesh.positions + 3 * v;
    vec3 q = vec3_scale(vec3_sub(vec3_load(p), b->centre), 1 / b->scale);
    for (int k = 0; k < 3; k++) p[k] = vec3_dot(vec3_load(b->axes.m[k]), q);
  }
}

static scree_status sum_areas(scree_target *b, scree_error *error) {
  SCREE_TRY_ALLOC(b->area_below, b->mesh.triangle_count, error);
  for (size_t t = 0; t < b->mesh.triangle_count; t++) {
    vec3 normal = scree_facet_normal(&b->mesh, t);
    b->area += vec3_norm(normal) / 2;
    b->area_below[t] = b->area;
  }
  return SCREE_OK;
}

scree_status scree_target_make(const scree_mesh *mesh, scree_target *body, scree_error *error) {
  SCREE_CLEANUP(scree_target_free) scree_target b = {0};
  SCREE_TRY(scree_mesh_verify(mesh, error));
  if (mesh->triangle_count == 0 || !scree_mesh_is_cycle(mesh))
    return scree_fail(error, SCREE_BAD_MESH,
                      "the surface is not closed, so it has no volume to fill with spheres; "
                      "`scree repair` may help");
  scree_solid solid = scree_solid_of_mesh(mesh);
  if (!(solid.volume > 0))
    return scree_fail(error, SCREE_BAD_MESH,
                      "the surface's volume is %g m3; it must be above 0 (a surface that is inside "
                      "out is turned by `scree repair`)",
                      solid.volume);
  double second[3];
  b.axes = target_axes(mesh, &solid, second);
  b.centre = solid.centre;
  b.scale = scree_cbrt(solid.volume);
  b.moments[0] = 1;
  for (int k = 0; k < 3; k++)
    b.moments[SCREE_FIRST_INERTIA + k] =
        (second[(k + 1) % 3] + second[(k + 2) % 3]) / (solid.volume * b.scale * b.scale);
  SCREE_TRY(scree_mesh_copy(mesh, &b.mesh, error));
  into_frame(&b);
  scree_mesh_bounds(&b.mesh, &b.low, &b.high);
  SCREE_TRY(sum_areas(&b, error));
  SCREE_TRY(scree_bvh_build(&b.mesh, &b.tree, error));
  *body = b;
  b = (scree_target){0};
  return SCREE_OK;
}

void scree_target_free(scree_target *body) {
  scree_mesh_free(&body->mesh);
  scree_bvh_free(&body->tree);
  scree_free(body->area_below);
  *body = (scree_target){0};
}

void scree_target_monomials(vec3 p, double m[SCREE_MOMENTS]) {
  m[0] = 1;
  m[1] = p.x, m[2] = p.y, m[3] = p.z;
  m[4] = p.y * p.y + p.z * p.z, m[5] = p.x * p.x + p.z * p.z, m[6] = p.x * p.x + p.y * p.y;
  m[7] = p.x * p.y, m[8] = p.x * p.z, m[9] = p.y * p.z;
}

static vec3 unit_normal(const scree_target *body, size_t triangle) {
  vec3 n = scree_facet_normal(&body->mesh, triangle);
  double length = vec3_norm(n);
  return length > 0 ? vec3_scale(n, 1 / length) : (vec3){0, 0, 1};
}

/* The first triangle up to which there is so much area. */
static size_t triangle_at(const scree_target *body, double area) {
  SCREE_FIND_FIRST(i, 0, body->mesh.triangle_count - 1, body->area_below[i] < area)
  return i;
}

/* Along the area in equal steps, within the triangle by Roberts' sequence (2018, R2). */
scree_target_point scree_target_sample(const scree_target *body, size_t index, size_t count) {
  size_t t = triangle_at(body, body->area * ((double)index + 0.5) / (double)count);
  double u = fmod(0.5 + (double)index * 0.7548776662466927, 1),
         v = fmod(0.5 + (double)index * 0.5698402909980532, 1);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  vec3 a = scree_mesh_corner(&body->mesh, t, 0), b = scree_mesh_corner(&body->mesh, t, 1),
       c = scree_mesh_corner(&body->mesh, t, 2);
  vec3 at = vec3_mad(vec3_mad(a, vec3_sub(b, a), u), vec3_sub(c, a), v);
  return (scree_target_point){at, unit_normal(body, t)};
}

scree_target_point scree_target_nearest(const scree_target *body, vec3 p, double *distance) {
  scree_bvh_hit hit = {.distance2 = INFINITY};
  scree_bvh_closest(&body->tree, p, &hit);
  *distance = sqrt(hit.distance2);
  return (scree_target_point){hit.point, unit_normal(body, body->tree.tree.order[hit.index])};
}

double scree_target_tangent_radius(const scree_target *body, scree_target_point point) {
  double radius = 0.5 * vec3_norm(vec3_sub(body->high, body->low));
  for (int i = 0; i < SHRINKINGS; i++) {
    vec3 centre = vec3_mad(point.at, point.normal, -radius);
    scree_bvh_hit hit = {.distance2 = radius * radius * (1 - 1e-6)};
    if (!scree_bvh_closest(&body->tree, centre, &hit)) break;
    vec3 d = vec3_sub(point.at, hit.point);
    double height = vec3_dot(d, point.normal), smaller = vec3_dot(d, d) / (2 * height);
    if (!(height > 0) || !(smaller < radius)) break;
    radius = smaller;
  }
  return radius;
}

scree_status scree_target_thickness(const scree_target *body, double *thickness,
                                    scree_error *error) {
  SCREE_SCRATCH(double, walls, THICKNESS_SAMPLES, error);
  for (size_t i = 0; i < THICKNESS_SAMPLES; i++)
    walls[i] =
        2 * scree_target_tangent_radius(body, scree_target_sample(body, i, THICKNESS_SAMPLES));
  scree_sort_numbers(walls, THICKNESS_SAMPLES);
  *thickness = walls[THICKNESS_SAMPLES / 4];
  return SCREE_OK;
}
