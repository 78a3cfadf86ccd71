/* A decimation about to begin, for tests of its stages. */
#ifndef SCREE_TEST_DECIMATOR_H
#define SCREE_TEST_DECIMATOR_H

#include "simplify/decimate.h"
#include "support/check.h"

/* With default options, no limit of error and nothing settled. The mesh must stay; free with
 * scree_decimator_free. */
static inline scree_decimator begin_decimation(const scree_mesh *mesh, const scree_coster *coster,
                                               scree_error *error) {
  scree_decimator d = {.mesh = mesh,
                       .coster = coster,
                       .options = scree_default_simplify_options(),
                       .error_limit = INFINITY,
                       .unsettled = SCREE_UNSETTLED_ALL,
                       .first_triangle_count = mesh->triangle_count,
                       .error = error};
  CHECK_OK(scree_halfmesh_build(mesh, &d.s, error), *error);
  CHECK_OK(scree_record_allocate(&d.record, mesh->vertex_count, error), *error);
  for (size_t t = 0; t < d.s.triangle_count; t++) {
    vec3 at[3];
    scree_corners(&d.s, t, at);
    d.s.area += 0.5 * vec3_norm(vec3_triangle_normal(at[0], at[1], at[2]));
  }
  return d;
}

#endif
