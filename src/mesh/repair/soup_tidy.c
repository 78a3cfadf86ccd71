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
  SCREE_CLEANUP(scree_mesh_free) scree_mesh welded = {0};
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  double diagonal = vec3_distance(box.low, box.high);
  if (!(diagonal > 0)) return SCREE_OK; /* all of it is flat */
  SCREE_TRY(scree_mesh_copy(mesh, &welded, error));
  SCREE_TRY(scree_weld_near(&welded, tolerance / diagonal, error));
  if (welded.vertex_count == mesh->vertex_count) return SCREE_OK;
  mending->welded = mesh->vertex_count - welded.vertex_count;
  mending->flat = mesh->triangle_count - welded.triangle_count;
  scree_mesh kept = *mesh;
  *mesh = welded;
  welded = kept;
  return SCREE_OK;
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
  SCREE_SCRATCH(bool, gone, mesh->triangle_count, error);
  for (size_t t = 0; t < mesh->triangle_count; t++)
    gone[t] = scree_names_twice(mesh->triangles + 3 * t) || height_of(mesh, t) <= tolerance;
  mending->flat += scree_facets_drop(mesh, gone);
  return SCREE_OK;
}

/* ---- junctions and doubles ---- */

static scree_status join_once(scree_mesh *mesh, double tolerance, size_t *joined,
                              scree_error *error) {
  const scree_junction_rule rule = {tolerance, INFINITY, SIZE_MAX};
  SCREE_CLEANUP(scree_free_at) scree_junctions found = {0};
  SCREE_TRY(scree_junctions_find(mesh, &rule, &found, error));
  size_t count = mesh->triangle_count + found.count;
  uint32_t *grown = scree_resize(mesh->triangles, count, 3 * sizeof *grown);
  if (!grown) return scree_fail_memory(error, 3 * count * sizeof *grown, "a wall's facets");
  mesh->triangles = grown;
  *joined += scree_junctions_split(mesh, &found);
  return SCREE_OK;
}

static scree_status drop_doubles(scree_mesh *mesh, scree_wall_mending *mending,
                                 scree_error *error) {
  size_t dropped;
  SCREE_TRY(scree_facets_drop_doubles(mesh, &dropped, error));
  mending->doubled += dropped;
  return SCREE_OK;
}

scree_status scree_soup_join(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error) {
  for (int pass = 0; pass < PASSES; pass++) {
    size_t before = mending->joined;
    SCREE_TRY(join_once(mesh, tolerance, &mending->joined, error));
    if (mending->joined == before) break;
  }
  return SCREE_OK;
}

scree_status scree_soup_tidy(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error) {
  SCREE_TRY(weld(mesh, tolerance, mending, error));
  SCREE_TRY(drop_flat(mesh, tolerance, mending, error));
  SCREE_TRY(drop_doubles(mesh, mending, error)); /* which have no rims */
  SCREE_TRY(scree_soup_join(mesh, tolerance, mending, error));
  return drop_doubles(mesh, mending, error);
}
