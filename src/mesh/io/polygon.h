/* Faces with any number of corners, turned into triangles. */
#pragma once

#include "base/alloc.h"

typedef struct scree_index_list {
  uint32_t *items;
  size_t count, capacity;
} scree_index_list;

/* Positions and faces of a file, on the way to triangles. Zero it to begin. */
typedef struct scree_face_list {
  scree_index_list triangles; /* three indices each */
  scree_index_list polygons;  /* a count above 3, then so many indices, and so on */
  size_t lost_count;          /* faces with fewer than three corners */
} scree_face_list;

/* Adds a face of `count` corners; false when memory is out. */
bool scree_face_list_add(scree_face_list *list, const uint32_t *corners, size_t count);
void scree_face_list_free(scree_face_list *list);

/* Cuts the polygons into triangles, count - 2 each, and adds these to list->triangles; all indices
 * lie below the number of positions. Fails with SCREE_LIMIT where polygons are so intricate that it
 * would take minutes. `name` stands for the file in errors. */
scree_status scree_face_list_triangulate(scree_face_list *list, const double *positions,
                                         const char *name, scree_error *error);
