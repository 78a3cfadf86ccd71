/* The decimation of a mesh, where nothing may fail. */
#pragma once

#include "support/check.h"

static inline scree_curve *curve_of(const scree_mesh *mesh, scree_method method) {
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  options.method = method;
  CHECK_OK(scree_curve_build(mesh, &options, NULL, &curve, &error), error);
  return curve;
}
