/* T-junctions (mesh/repair/rim.h) are looked for on edges of one facet alone: the others have what
 * they need. A dropped sliver leaves such a junction behind too. */
#include "mesh/repair/soup_tidy.h"

#include "base/alloc.h"
#include "mesh/repair/repair.h"
#include "mesh/repair/rim.h"
#include "mesh/weld_near.h"

#include <math.h>

static const double share = 2e-6; /* of the diagonal: 2 um in 1 m, far below any body */
static const double ulp = 1.2e-7; /* of a coordinate in single precision, as STL has them */
enum { PASSES = 8 };              /* an edge of each corner, and of what these leave */

double scree_soup_tolerance(const scree_mesh *mesh) {
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  vec3 far = vec3_max(vec3_neg(box.low), box.high);
  double largest = scree_larger(far.x, scree_larger(far.y, far.z));
  return scree_larger(share * vec3_distance(box.low, box.high), 4 * ulp * largest);
}

/* ---- vertices ---- */

static scree_status weld(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                         scree_error *error) {
  scree_mesh welded = {0};
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  double diagonal = vec3_distance(box.low, box.high);
  if (!(diagonal > 0)) return SCREE_OK; /* all of it is flat */
  scree_status status = scree_mesh_copy(mesh, &welded, error);
  if (status == SCREE_OK) status = scree_weld_near(&welded, tolerance / diagonal, error);
  if (status == SCREE_OK && welded.vertex_count < mesh->vertex_count) {
    mending->welded = mesh->vertex_count - welded.vertex_count;
    mending->flat = mesh->triangle_count - welded.triangle_count;
    scree_mesh kept = *mesh;
    *mesh = welded;
    welded = kept;
  }
  scree_mesh_free(&welded);
  return status;
}

/* Over its longest edge, m. */
static double height_of(const scree_mesh *mesh, size_t t) {
  vec3 c[3];
  double longest = 0;
  for (int k = 0; k < 3; k++) c[k] = scree_mesh_corner(mesh, t, k);
  for (int k = 0; k < 3; k++) longest = scree_larger(longest, vec3_distance(c[k], c[(k + 1) % 3]));
  double area2 = vec3_norm(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
  return longest > 0 ? area2 / longest : 0;
}

static scree_status drop_flat(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                              scree_error *error) {
  bool *gone = scree_alloc_zero(mesh->triangle_count, sizeof *gone);
  if (!gone) return scree_fail_memory(error, mesh->triangle_count, "a wall's facets");
  for (size_t t = 0; t < mesh->triangle_count; t++)
    gone[t] = scree_names_twice(mesh->triangles + 3 * t) || height_of(mesh, t) <= tolerance;
  mending->flat += scree_facets_drop(mesh, gone);
  scree_free(gone);
  return SCREE_OK;
}

/* ---- junctions and doubles ---- */

static scree_status join_once(scree_mesh *mesh, double tolerance, size_t *joined,
                              scree_error *error) {
  const scree_junction_rule rule = {tolerance, INFINITY, SIZE_MAX};
  scree_rim rim;
  scree_junctions found;
  scree_status status = scree_rim_find(mesh, &rim, error);
  if (status != SCREE_OK) return status;
  status = scree_rim_junctions(mesh, &rim, &rule, &found, error);
  scree_rim_free(&rim);
  if (status != SCREE_OK) return status;
  uint32_t *grown =
      scree_resize(mesh->triangles, mesh->triangle_count + found.count, 3 * sizeof *grown);
  if (grown) {
    mesh->triangles = grown;
    *joined += scree_junctions_split(mesh, &found);
  } else {
    status = scree_fail_memory(error, 3 * found.count * sizeof *grown, "a wall's facets");
  }
  scree_free(found.items);
  return status;
}

static scree_status drop_doubles(scree_mesh *mesh, scree_wall_mending *mending,
                                 scree_error *error) {
  size_t dropped;
  scree_status status = scree_facets_drop_doubles(mesh, &dropped, error);
  if (status == SCREE_OK) mending->doubled += dropped;
  return status;
}

scree_status scree_soup_join(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error) {
  for (int pass = 0; pass < PASSES; pass++) {
    size_t before = mending->joined;
    scree_status status = join_once(mesh, tolerance, &mending->joined, error);
    if (status != SCREE_OK || mending->joined == before) return status;
  }
  return SCREE_OK;
}

scree_status scree_soup_tidy(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error) {
  scree_status status = weld(mesh, tolerance, mending, error);
  if (status == SCREE_OK) status = drop_flat(mesh, tolerance, mending, error);
  if (status == SCREE_OK) status = drop_doubles(mesh, mending, error); /* which have no rims */
  if (status == SCREE_OK) status = scree_soup_join(mesh, tolerance, mending, error);
  return status == SCREE_OK ? drop_doubles(mesh, mending, error) : status;
}
