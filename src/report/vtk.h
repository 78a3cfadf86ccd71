/* Files for ParaView of tables: a row a point or a cell, whose members become the arrays. */
#pragma once

#include "base/error.h"
#include "base/field.h"

typedef struct scree_vtk_rows {
  const void *rows; /* one a point, or one a cell */
  size_t row_bytes;
  bool of_points;
  const scree_field *members;
  size_t member_count;
} scree_vtk_rows;
#define SCREE_VTK_ROWS(rows, of_points, members)                                                   \
  (scree_vtk_rows) {                                                                               \
    rows, sizeof *(rows), of_points, members, sizeof(members) / sizeof *(members)                  \
  }

/* scree_vtp_write with these arrays behind those of `data`. */
scree_status scree_vtp_write_rows(const scree_vtk_data *data, const scree_vtk_rows *rows,
                                  const char *path, bool overwrite, scree_error *error);
