/* Facets are put in the order of a Morton curve through the bounding box, so that neighbours on the
 * curve are neighbours on the surface. The area along the curve is cut in equal shares, and a point
 * is taken in the facet where the middle of each share falls, by a sequence that fills a square
 * evenly (Roberts 2018, R2). Vertices go to the nearer of the points before and after their facet
 * on the curve. */
#include "choice/gauge.h"

#include "base/alloc.h"
#include "base/radix.h"
#include "mesh/measure/bounds.h"
#include "mesh/mesh.h"
#include "simplify/morton.h"

/* Steps of R2: 1/p and 1/p^2 with p^3 = p + 1. */
static const double STEP_U = 0.7548776662466927, STEP_V = 0.5698402909980532;

static void key_facets(const scree_mesh *mesh, scree_keyed *keys) {
  vec3 low, high;
  scree_mesh_bounds(mesh, &low, &high);
  vec3 size = vec3_sub(high, low);
  double scale = ((1 << SCREE_MORTON_BITS) - 1) / fmax(size.x, fmax(size.y, size.z));
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 middle =
        vec3_scale(vec3_add(vec3_add(scree_mesh_corner(mesh, t, 0), scree_mesh_corner(mesh, t, 1)),
                            scree_mesh_corner(mesh, t, 2)),
                   1.0 / 3);
    keys[t] =
        (scree_keyed){scree_morton_code(vec3_scale(vec3_sub(middle, low), scale)), (uint32_t)t};
  }
}

/* Takes the points, and for each facet on the curve the number of points before it. */
static void take_points(const scree_mesh *mesh, const scree_keyed *curve, size_t wanted,
                        uint32_t *before, scree_spread *s) {
  double area = 0, done = 0, u = 0.5, v = 0.5;
  for (size_t k = 0; k < mesh->triangle_count; k++)
    area += vec3_norm(scree_facet_normal(mesh, curve[k].index)) / 2;
  double share = area / (double)wanted;
  for (size_t k = 0; k < mesh->triangle_count; k++) {
    size_t t = curve[k].index;
    vec3 normal = scree_facet_normal(mesh, t), corner = scree_mesh_corner(mesh, t, 0),
         e = vec3_sub(scree_mesh_corner(mesh, t, 1), corner),
         f = vec3_sub(scree_mesh_corner(mesh, t, 2), corner);
    before[k] = (uint32_t)s->count;
    done += vec3_norm(normal) / 2;
    for (; s->count < wanted && ((double)s->count + 0.5) * share <= done; s->count++) {
      u = fmod(u + STEP_U, 1);
      v = fmod(v + STEP_V, 1);
      double x = u + v > 1 ? 1 - u : u, y = u + v > 1 ? 1 - v : v;
      s->points[s->count] = vec3_mad(vec3_mad(corner, e, x), f, y);
      s->normals[s->count] = vec3_unit(normal);
    }
  }
}

/* The point that each vertex goes to: the nearest of those next to its facets on the curve. */
static void find_nearest(const scree_mesh *mesh, const scree_keyed *curve, const uint32_t *before,
                         const scree_spread *s, uint32_t *nearest, double *distance) {
  for (size_t v = 0; v < mesh->vertex_count; v++) distance[v] = INFINITY, nearest[v] = UINT32_MAX;
  for (size_t k = 0; k < mesh->triangle_count; k++)
    for (size_t c = 0; c < 3; c++) {
      uint32_t v = mesh->triangles[3 * (size_t)curve[k].index + c];
      vec3 p = vec3_load(mesh->positions + 3 * (size_t)v);
      for (size_t i = before[k] ? before[k] - 1 : 0; i <= before[k] && i < s->count; i++) {
        double d = vec3_distance(p, s->points[i]);
        if (d < distance[v]) distance[v] = d, nearest[v] = (uint32_t)i;
      }
    }
}

static void group_vertices(const scree_mesh *mesh, const uint32_t *nearest, const double *distance,
                           scree_spread *s) {
  for (size_t i = 0; i <= s->count; i++) s->starts[i] = 0;
  for (size_t i = 0; i < s->count; i++) s->reach[i] = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    if (nearest[v] == UINT32_MAX) continue;
    s->starts[nearest[v] + 1]++;
    s->reach[nearest[v]] = fmax(s->reach[nearest[v]], distance[v]);
  }
  for (size_t i = 0; i < s->count; i++) s->starts[i + 1] += s->starts[i];
  for (size_t v = 0; v < mesh->vertex_count; v++)
    if (nearest[v] != UINT32_MAX) s->vertices[s->starts[nearest[v]]++] = (uint32_t)v;
  for (size_t i = s->count; i > 0; i--) s->starts[i] = s->starts[i - 1];
  s->starts[0] = 0;
}

scree_status scree_spread_make(const scree_mesh *mesh, size_t count, scree_spread *spread,
                               scree_error *error) {
  SCREE_CLEANUP(scree_spread_free) scree_spread made = {0};
  SCREE_SCRATCH(scree_keyed, keys, mesh->triangle_count, error);
  SCREE_SCRATCH(scree_keyed, swap, mesh->triangle_count, error);
  SCREE_SCRATCH(uint32_t, before, mesh->triangle_count, error);
  SCREE_SCRATCH(uint32_t, nearest, mesh->vertex_count, error);
  SCREE_SCRATCH(double, distance, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(made.points, count, error);
  SCREE_TRY_ALLOC(made.normals, count, error);
  SCREE_TRY_ALLOC(made.vertices, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(made.starts, count + 1, error);
  SCREE_TRY_ALLOC(made.reach, count, error);
  key_facets(mesh, keys);
  const scree_keyed *curve =
      scree_radix_sort(keys, swap, mesh->triangle_count, 3 * SCREE_MORTON_BITS);
  take_points(mesh, curve, count, before, &made);
  find_nearest(mesh, curve, before, &made, nearest, distance);
  group_vertices(mesh, nearest, distance, &made);
  *spread = made;
  made = (scree_spread){0};
  return SCREE_OK;
}

void scree_spread_free(scree_spread *spread) {
  scree_free(spread->points);
  scree_free(spread->normals);
  scree_free(spread->vertices);
  scree_free(spread->starts);
  scree_free(spread->reach);
  *spread = (scree_spread){0};
}
