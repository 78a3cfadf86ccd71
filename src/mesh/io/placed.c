#include "mesh/io/placed.h"

#include "base/array.h"
#include "mesh/weld.h"

#include <math.h>
#include <stdio.h>

scree_status scree_placed_add(scree_reading *r, scree_placed *placed, const scree_affine *where,
                              const double *vertices, size_t vertex_count) {
  size_t before = placed->positions.count;
  if (before / 3 + vertex_count > SCREE_PLACED_MOST)
    return scree_reading_fail(r, SCREE_LIMIT, "as %s: more than %d vertices with all instances",
                              r->scan->format, SCREE_PLACED_MOST);
  if (!SCREE_RESERVE(&placed->positions, before + 3 * vertex_count))
    return scree_fail_memory(r->error, 3 * vertex_count * sizeof *vertices, "placed vertices");
  for (size_t v = 0; v < vertex_count; v++) {
    double *out = placed->positions.items + before + 3 * v;
    scree_affine_apply(where, vertices + 3 * v, out);
    for (int k = 0; k < 3; k++)
      if (!(fabs(out[k] * r->unit_m) <= SCREE_COORDINATE_LIMIT))
        return scree_reading_fail(
            r, SCREE_BAD_FILE,
            "as %s: a vertex is placed at %g; coordinates must be finite and at most %g m in size",
            r->scan->format, out[k], SCREE_COORDINATE_LIMIT);
  }
  placed->positions.count += 3 * vertex_count;
  return SCREE_OK;
}

scree_status scree_placed_add_triangle(scree_reading *r, scree_placed *placed, size_t first_vertex,
                                       const uint32_t corners[3], bool is_mirrored) {
  uint32_t t[3];
  if (placed->faces.triangles.count / 3 == SCREE_PLACED_MOST)
    return scree_reading_fail(r, SCREE_LIMIT, "as %s: more than %d triangles with all instances",
                              r->scan->format, SCREE_PLACED_MOST);
  for (int c = 0; c < 3; c++) t[c] = (uint32_t)first_vertex + corners[is_mirrored ? 2 - c : c];
  if (!scree_face_list_add(&placed->faces, t, 3))
    return scree_fail_memory(r->error, sizeof t, "placed triangles");
  return SCREE_OK;
}

bool scree_placed_wants(scree_reading *r, const char *name) {
  bool asked = ++r->scan->part_count == r->options->part;
  if (asked) snprintf(r->scan->part_name, sizeof r->scan->part_name, "%s", name ? name : "");
  return asked || !r->options->part;
}

scree_status scree_placed_weld(scree_reading *r, scree_placed *placed) {
  return scree_reading_weld_faces(r, placed->positions.items, placed->positions.count / 3,
                                  &placed->faces);
}

void scree_placed_free(scree_placed *placed) {
  scree_free(placed->positions.items);
  scree_face_list_free(&placed->faces);
  *placed = (scree_placed){0};
}
