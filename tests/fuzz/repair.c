/* Check and repair of arbitrary meshes: what is called repaired passes the check, once more
 * repaired it stays as it is. */
#include "fuzz/fuzz.h"
#include "scree.h"

#include <math.h>
#include <string.h>

enum { MOST_VERTICES = 64, MOST_FACETS = 128 };

typedef struct input {
  double positions[3 * MOST_VERTICES];
  uint32_t triangles[3 * MOST_FACETS];
  scree_mesh mesh;
  scree_repair_options options;
} input;

/* Two bytes of settings, a vertex count, three bytes per vertex, three per facet. Coordinates lie
 * on a coarse grid, on one far from the origin, or spread over many magnitudes. */
static void decode(const uint8_t *data, size_t size, input *in) {
  memset(in, 0, sizeof *in);
  in->options = scree_default_repair_options();
  in->options.hole_edges = data[0] % 4 * 3;
  in->options.fill_large_holes = data[0] & 4;
  in->options.keep_largest = data[0] & 8;
  in->options.drop_cavities = data[0] & 16;
  in->options.cut_intersections = data[0] & 32;
  in->options.debris_share = data[0] & 64 ? 0 : 0.01;
  in->options.seam_tolerance = data[0] & 128 ? 0.01 : 1e-4;
  size_t at = 3, kind = data[1] % 4;
  while (in->mesh.vertex_count < 3u + data[2] % (MOST_VERTICES - 2) && at + 3 <= size) {
    double *p = in->positions + 3 * in->mesh.vertex_count++;
    for (int k = 0; k < 3; k++) {
      int8_t byte = (int8_t)data[at++];
      p[k] = kind == 0   ? byte
             : kind == 1 ? 1e6 + byte / 3.0
             : kind == 2 ? byte / 16
                         : ldexp(byte % 8, byte / 2);
      if (kind == 3 && byte == 127) p[k] = NAN;
    }
  }
  if (in->mesh.vertex_count == 0) return;
  while (in->mesh.triangle_count < MOST_FACETS && at + 3 <= size) {
    uint32_t *corner = in->triangles + 3 * in->mesh.triangle_count++;
    for (int k = 0; k < 3; k++) corner[k] = data[at++] % (uint32_t)in->mesh.vertex_count;
  }
  in->mesh.positions = in->positions;
  in->mesh.triangles = in->triangles;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static input in;
  scree_check check;
  scree_error error;
  scree_mesh once, twice;
  if (size < 3) return 0;
  decode(data, size, &in);
  FUZZ_CHECK(scree_mesh_check(&in.mesh, NULL, NULL, &check, &error) == SCREE_OK);
  scree_status status = scree_mesh_repair(&in.mesh, &in.options, NULL, &once, NULL, &error);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_MESH);
  if (status != SCREE_OK) return 0;
  FUZZ_CHECK(scree_mesh_check(&once, NULL, NULL, &check, &error) == SCREE_OK);
  FUZZ_CHECK(check.usable && once.triangle_count >= 4);
  FUZZ_CHECK(scree_mesh_repair(&once, &in.options, NULL, &twice, NULL, &error) == SCREE_OK);
  FUZZ_CHECK(twice.triangle_count == once.triangle_count);
  FUZZ_CHECK(memcmp(twice.positions, once.positions, 24 * once.vertex_count) == 0);
  FUZZ_CHECK(memcmp(twice.triangles, once.triangles, 12 * once.triangle_count) == 0);
  scree_mesh_free(&once);
  scree_mesh_free(&twice);
  return 0;
}
