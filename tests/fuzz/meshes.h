/* Arbitrary meshes out of bytes. */
#pragma once

#include "scree.h"

#include <math.h>
#include <string.h>

enum { MOST_VERTICES = 64, MOST_FACETS = 128 };

typedef struct fuzz_mesh {
  double positions[3 * MOST_VERTICES];
  uint32_t triangles[3 * MOST_FACETS];
  scree_mesh mesh;
} fuzz_mesh;

/* A byte for the kind of coordinates, a vertex count, three bytes per vertex, three per facet.
 * Coordinates lie on a coarse grid, on one far from the origin, or spread over many magnitudes,
 * NaN among them. */
static inline void fuzz_mesh_decode(const uint8_t *data, size_t size, fuzz_mesh *in) {
  memset(in, 0, sizeof *in);
  size_t at = 2, kind = data[0] % 4;
  while (in->mesh.vertex_count < 3u + data[1] % (MOST_VERTICES - 2) && at + 3 <= size) {
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
