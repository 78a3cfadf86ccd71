/* Welding of arbitrary corners, exact and near. */
#include "fuzz/reading.h"

enum { MOST_FACETS = 500 };

/* Corners from two bytes per coordinate: many coincide, and now and then one is enormous or tiny.
 */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static double corners[9 * MOST_FACETS];
  static const double tolerances[] = {0, 1e-12, 1e-6, 1e-3, 0.1};
  if (size < 1) return 0;
  double tolerance = tolerances[data[0] % 5];
  size_t facet_count = (size - 1) / 18;
  if (facet_count > MOST_FACETS) facet_count = MOST_FACETS;
  for (size_t i = 0; i < 9 * facet_count; i++)
    corners[i] = ldexp((double)(int8_t)data[1 + 2 * i], (int8_t)data[2 + 2 * i] % 99);
  scree_mesh mesh = {0};
  scree_error error;
  size_t degenerate_count;
  scree_status status =
      scree_mesh_weld(corners, facet_count, tolerance, &mesh, &degenerate_count, &error);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_ARGUMENT || status == SCREE_LIMIT);
  if (status != SCREE_OK) return 0;
  FUZZ_CHECK(mesh.triangle_count + degenerate_count == facet_count);
  fuzz_check_mesh(&mesh);
  scree_mesh_free(&mesh);
  fuzz_taken++;
  return 0;
}
