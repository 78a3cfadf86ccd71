/* The triangles of a file's placed parts, in its unit: what readers of files with instances end in.
 */
#pragma once

#include "mesh/io/affine.h"
#include "mesh/io/read.h"

typedef struct scree_placed {
  struct {
    double *items;
    size_t count, capacity;
  } positions; /* three each */
  scree_face_list faces;
} scree_placed;

/* Adds vertex_count vertices, placed, and the triangles between them, which stay outward where the
 * placement mirrors. SCREE_LIMIT above SCREE_IMPORT_MOST of either. */
scree_status scree_placed_add(scree_reading *r, scree_placed *placed, const scree_affine *where,
                              const double *vertices, size_t vertex_count);
scree_status scree_placed_add_triangle(scree_reading *r, scree_placed *placed, size_t first_vertex,
                                       const uint32_t corners[3], bool is_mirrored);
/* Welds them into r->scan->mesh. */
scree_status scree_placed_weld(scree_reading *r, scree_placed *placed);
void scree_placed_free(scree_placed *placed);
