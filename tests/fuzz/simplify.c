/* Decimation of arbitrary meshes: what scree_curve_build promises of every level holds, and levels
 * are what the record says. */
#include "fuzz/fuzz.h"
#include "fuzz/meshes.h"

enum { LEVELS = 5 }; /* looked at, from the first to the last */

/* What a level may not have more of than the mesh given. */
typedef struct faults {
  scree_topology topology;
  size_t meetings; /* pairs of facets that cross, touch or overlap */
} faults;

static faults look_at(const scree_mesh *mesh) {
  faults f = {.meetings = 0};
  scree_check check;
  scree_error error;
  FUZZ_CHECK(scree_mesh_topology(mesh, &f.topology, &error) == SCREE_OK);
  FUZZ_CHECK(scree_mesh_check(mesh, NULL, NULL, &check, &error) == SCREE_OK);
  for (int d = SCREE_DEFECT_CROSSING_PAIR; d <= SCREE_DEFECT_OVERLAPPING_PAIR; d++)
    f.meetings += check.defects[d];
  return f;
}

static void compare(const faults *given, const faults *level, bool exact) {
  const scree_topology *a = &given->topology, *b = &level->topology;
  if (a->closed && a->manifold && a->oriented && !a->inward_shell_count)
    FUZZ_CHECK(b->closed && b->manifold && b->oriented && b->shell_count == a->shell_count);
  FUZZ_CHECK(b->non_manifold_edge_count <= a->non_manifold_edge_count);
  if (exact) FUZZ_CHECK(b->degenerate_facet_count <= a->degenerate_facet_count);
  if (exact && !given->meetings) FUZZ_CHECK(!level->meetings);
}

/* exact: not far from the origin, where positions round, nor of many magnitudes: facets may become
 * flat, or come to touch, by rounding alone. */
static void check_levels(const scree_curve *curve, const scree_mesh *mesh, bool exact) {
  const faults given = look_at(mesh);
  size_t count = scree_curve_level_count(curve);
  scree_level first, level;
  scree_curve_level(curve, 0, &first);
  FUZZ_CHECK(first.triangle_count == mesh->triangle_count);
  for (size_t i = 0; i < LEVELS; i++) {
    size_t index = i * (count - 1) / (LEVELS - 1);
    scree_mesh made;
    scree_error error;
    scree_curve_level(curve, index, &level);
    FUZZ_CHECK(level.triangle_count <= first.triangle_count && isfinite(level.area));
    FUZZ_CHECK(scree_curve_mesh(curve, index, &made, &error) == SCREE_OK);
    FUZZ_CHECK(made.triangle_count == level.triangle_count);
    const faults left = look_at(&made);
    compare(&given, &left, exact);
    scree_mesh_free(&made);
  }
}

/* Settings from the first byte, a mesh from the rest (meshes.h). */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static fuzz_mesh in;
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  size_t used = scree_memory_used();
  if (size < 3) return 0;
  options.method = data[0] & 1 ? SCREE_METHOD_QECD : SCREE_METHOD_VOLUME;
  options.stop_count = data[0] & 2 ? data[0] / 8 : 0;
  options.error_limit = data[0] & 4 ? data[0] / 8 : 0;
  fuzz_mesh_decode(data + 1, size - 1, &in);
  scree_set_threads(1);
  scree_status status = scree_curve_build(&in.mesh, &options, NULL, &curve, &error);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_MESH);
  FUZZ_CHECK(status == SCREE_OK || (error.message[0] && !curve));
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) check_levels(curve, &in.mesh, data[1] % 2 == 0);
  scree_curve_free(curve);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
