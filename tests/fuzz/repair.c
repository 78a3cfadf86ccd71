/* Check and repair of arbitrary meshes: what is called repaired passes the check, once more
 * repaired it stays as it is. */
#include "fuzz/fuzz.h"
#include "fuzz/meshes.h"

/* Settings from the first byte, a mesh from the rest (meshes.h). */
static scree_repair_options options_of(uint8_t byte) {
  scree_repair_options o = scree_default_repair_options();
  o.hole_share = byte % 4 / 3.0;
  o.flat_holes = byte & 4;
  o.keep_largest = byte & 8;
  o.drop_cavities = byte & 16;
  o.cut_intersections = byte & 32;
  o.debris_share = byte & 64 ? 0 : 0.01;
  o.seam_tolerance = byte & 128 ? 0.01 : 1e-4;
  return o;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static fuzz_mesh in;
  scree_check check;
  scree_error error;
  scree_mesh once, twice;
  if (size < 3) return 0;
  const scree_repair_options options = options_of(data[0]);
  fuzz_mesh_decode(data + 1, size - 1, &in);
  FUZZ_CHECK(scree_mesh_check(&in.mesh, NULL, NULL, &check, &error) == SCREE_OK);
  scree_status status = scree_mesh_repair(&in.mesh, &options, NULL, &once, NULL, &error);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_MESH);
  if (status != SCREE_OK) return 0;
  FUZZ_CHECK(scree_mesh_check(&once, NULL, NULL, &check, &error) == SCREE_OK);
  FUZZ_CHECK(check.usable && once.triangle_count >= 4);
  FUZZ_CHECK(scree_mesh_repair(&once, &options, NULL, &twice, NULL, &error) == SCREE_OK);
  FUZZ_CHECK(twice.triangle_count == once.triangle_count);
  FUZZ_CHECK(memcmp(twice.positions, once.positions, 24 * once.vertex_count) == 0);
  FUZZ_CHECK(memcmp(twice.triangles, once.triangles, 12 * once.triangle_count) == 0);
  scree_mesh_free(&once);
  scree_mesh_free(&twice);
  fuzz_taken++;
  return 0;
}
