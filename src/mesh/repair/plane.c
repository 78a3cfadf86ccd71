/* Cutting a body off what it stands on, as a table that was scanned with it.
 *
 * The table's rim is most of the scan's boundary and lies in a plane. Planes through three points
 * of the boundary, drawn by length, are tried (Fischler and Bolles 1981, "Random sample
 * consensus"); the one near which most of the boundary's length runs is fitted to that by least
 * squares. What stands on it is on the side to which the surface reaches farther. The cut goes
 * above the plane by three standard deviations of the rim, for the table is as uneven, and by a
 * thousandth of the size. */
#include "base/array.h"
#include "base/eigen.h"
#include "base/radix.h"
#include "base/rng.h"
#include "mesh/repair/repair.h"

#include <math.h>

enum { TRIES = 500 };
static const double TOLERANCE = 0.01;   /* of the diagonal: how near the plane a rim runs */
static const double LEAST_SHARE = 0.25; /* of the boundary that a table's rim is at least */
static const double ABOVE = 1e-3;       /* of the diagonal */

typedef struct rim_piece {
  vec3 middle;
  double length, up_to; /* the sum of lengths so far */
} rim_piece;

typedef struct rim {
  rim_piece *items;
  size_t count, capacity;
} rim;

static scree_status collect_rim(const scree_mesh *mesh, rim *out, scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY(scree_adjacency_build(mesh, &adjacency, error));
  double sum = 0;
  for (size_t h = 0; h < 3 * mesh->triangle_count; h++) {
    if (adjacency.ring[h] != h) continue;
    vec3 a = scree_mesh_vertex(mesh, scree_half_edge_from(mesh, (uint32_t)h)),
         b = scree_mesh_vertex(mesh, scree_half_edge_to(mesh, (uint32_t)h));
    double length = vec3_distance(a, b);
    rim_piece piece = {vec3_scale(vec3_add(a, b), 0.5), length, sum += length};
    if (!SCREE_PUSH(out, piece)) return scree_repair_no_memory(error);
  }
  return SCREE_OK;
}

static vec3 draw(const rim *r, scree_rng *rng) {
  double at = scree_rng_uniform(rng) * r->items[r->count - 1].up_to;
  SCREE_FIND_FIRST(i, 0, r->count - 1, r->items[i].up_to <= at)
  return r->items[i].middle;
}

static scree_cut_plane plane_of(vec3 normal, vec3 on) {
  return (scree_cut_plane){{normal.x, normal.y, normal.z}, vec3_dot(normal, on)};
}

static double distance_to(const scree_cut_plane *p, vec3 v) {
  return vec3_dot(vec3_load(p->normal), v) - p->offset;
}

static double length_near(const rim *r, const scree_cut_plane *p, double tolerance) {
  double sum = 0;
  for (size_t i = 0; i < r->count; i++)
    if (fabs(distance_to(p, r->items[i].middle)) <= tolerance) sum += r->items[i].length;
  return sum;
}

/* Least squares of what is near; answers the standard deviation. */
static double fit_plane(const rim *r, double tolerance, scree_cut_plane *p) {
  vec3 centre = {0, 0, 0}, moment = centre;
  double sum = 0, values[3];
  mat3 spread = {{{0}}}, axes;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < r->count; i++) {
      const rim_piece *piece = &r->items[i];
      if (fabs(distance_to(p, piece->middle)) > tolerance) continue;
      vec3 d = vec3_sub(piece->middle, centre);
      const double v[3] = {d.x, d.y, d.z};
      if (pass == 0) {
        moment = vec3_mad(moment, piece->middle, piece->length);
        sum += piece->length;
      } else {
        for (int k = 0; k < 9; k++) spread.m[k / 3][k % 3] += piece->length * v[k / 3] * v[k % 3];
      }
    }
    centre = vec3_scale(moment, 1 / sum);
  }
  scree_eigen_symmetric(&spread, values, &axes);
  *p = plane_of((vec3){axes.m[0][0], axes.m[0][1], axes.m[0][2]}, centre);
  return sqrt(fmax(0, values[0]) / sum);
}

static scree_status find_plane(const scree_mesh *mesh, double diagonal, scree_cut_plane *best,
                               scree_error *error) {
  SCREE_CLEANUP(scree_free_at) rim r = {0};
  scree_rng rng = {1, 0, 0};
  double tolerance = TOLERANCE * diagonal, most = 0;
  SCREE_TRY(collect_rim(mesh, &r, error));
  for (int i = 0; r.count && i < TRIES; i++) {
    vec3 a = draw(&r, &rng), b = draw(&r, &rng), c = draw(&r, &rng);
    vec3 normal = vec3_cross(vec3_sub(b, a), vec3_sub(c, a));
    if (!(vec3_norm(normal) > 1e-6 * diagonal * diagonal)) continue;
    scree_cut_plane p = plane_of(vec3_unit(normal), a);
    double length = length_near(&r, &p, tolerance);
    if (length > most) most = length, *best = p;
  }
  if (r.count == 0)
    return scree_fail(error, SCREE_BAD_MESH,
                      "the surface has no boundary, by which the plane that it stands on is "
                      "found; say where it is, as z=12mm");
  double whole = r.items[r.count - 1].up_to;
  if (!(most >= LEAST_SHARE * whole))
    return scree_fail(error, SCREE_BAD_MESH,
                      "no plane carries more than %.2g %% of the boundary, and %g %% are needed; "
                      "say where it is, as z=12mm",
                      whole > 0 ? 100 * most / whole : 0, 100 * LEAST_SHARE);
  double deviation = fit_plane(&r, tolerance, best), low = 0, high = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    double d = distance_to(best, scree_mesh_vertex(mesh, v));
    low = fmin(low, d), high = fmax(high, d);
  }
  if (-low > high)
    *best = plane_of(vec3_neg(vec3_load(best->normal)),
                     vec3_scale(vec3_load(best->normal), best->offset));
  best->offset += 3 * deviation + ABOVE * diagonal;
  return SCREE_OK;
}

/* ---- The cut ---- */

typedef struct corners {
  double *items;
  size_t count, capacity;
} corners;

/* Where the edge crosses the plane, the same for both its facets. */
static vec3 crossing(const scree_mesh *mesh, uint32_t a, uint32_t b, const double *height) {
  uint32_t low = a < b ? a : b, high = a < b ? b : a;
  vec3 from = scree_mesh_vertex(mesh, low), to = scree_mesh_vertex(mesh, high);
  return vec3_mad(from, vec3_sub(to, from), height[low] / (height[low] - height[high]));
}

static bool keep_above(const scree_mesh *mesh, size_t t, const double *height, corners *out) {
  const uint32_t *c = mesh->triangles + 3 * t;
  vec3 corner[4];
  int count = 0;
  for (int k = 0; k < 3; k++) {
    uint32_t a = c[k], b = c[(k + 1) % 3];
    if (height[a] >= 0) corner[count++] = scree_mesh_vertex(mesh, a);
    if ((height[a] > 0 && height[b] < 0) || (height[a] < 0 && height[b] > 0))
      corner[count++] = crossing(mesh, a, b, height);
  }
  for (int k = 2; k < count; k++) {
    if (!SCREE_RESERVE(out, out->count + 9)) return false;
    vec3_store(out->items + out->count, corner[0]);
    vec3_store(out->items + out->count + 3, corner[k - 1]);
    vec3_store(out->items + out->count + 6, corner[k]);
    out->count += 9;
  }
  return true;
}

static double diagonal_of(const scree_mesh *mesh) {
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  return mesh->vertex_count ? vec3_distance(box.low, box.high) : 0;
}

scree_status scree_repair_cut_off(const scree_mesh *mesh, const scree_cut_plane *given,
                                  scree_cut_plane *plane, size_t *dropped, scree_mesh *above,
                                  scree_error *error) {
  SCREE_CLEANUP(scree_free_at) corners out = {0};
  double diagonal = diagonal_of(mesh);
  if (given)
    *plane = *given;
  else
    SCREE_TRY(find_plane(mesh, diagonal, plane, error));
  SCREE_SCRATCH(double, height, mesh->vertex_count, error);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    double d = distance_to(plane, scree_mesh_vertex(mesh, v));
    height[v] = fabs(d) <= 1e-9 * diagonal ? 0 : d;
  }
  *dropped = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *c = mesh->triangles + 3 * t;
    if (height[c[0]] <= 0 && height[c[1]] <= 0 && height[c[2]] <= 0)
      ++*dropped;
    else if (!keep_above(mesh, t, height, &out))
      return scree_repair_no_memory(error);
  }
  if (out.count == 0)
    return scree_fail(error, SCREE_BAD_MESH, "nothing of the surface stands on the plane");
  if (*dropped == 0)
    return scree_fail(error, SCREE_BAD_MESH, "nothing of the surface lies below the plane");
  return scree_mesh_weld(out.items, out.count / 9, 0, above, NULL, error);
}
