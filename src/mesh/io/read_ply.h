/* The header of a PLY file. */
#pragma once

#include "mesh/io/read.h"

typedef enum scree_ply_type {
  SCREE_PLY_INT8,
  SCREE_PLY_UINT8,
  SCREE_PLY_INT16,
  SCREE_PLY_UINT16,
  SCREE_PLY_INT32,
  SCREE_PLY_UINT32,
  SCREE_PLY_FLOAT32,
  SCREE_PLY_FLOAT64,
} scree_ply_type;

/* What a property means to scree; the order X, Y, Z is used. */
typedef enum scree_ply_role {
  SCREE_PLY_X,
  SCREE_PLY_Y,
  SCREE_PLY_Z,
  SCREE_PLY_CORNERS,
  SCREE_PLY_NO_ROLE,
} scree_ply_role;

typedef struct scree_ply_property {
  scree_ply_type type, count_type; /* count_type of lists only */
  scree_ply_role role;
  bool is_list;
} scree_ply_property;

typedef enum scree_ply_kind {
  SCREE_PLY_VERTEX,
  SCREE_PLY_FACE,
  SCREE_PLY_STRIPS,
  SCREE_PLY_OTHER,
} scree_ply_kind;

typedef struct scree_ply_element {
  char name[32];
  scree_ply_kind kind;
  size_t count;
  size_t first_property, property_count;
} scree_ply_element;

typedef enum scree_ply_encoding {
  SCREE_PLY_ASCII,
  SCREE_PLY_LITTLE_ENDIAN,
  SCREE_PLY_BIG_ENDIAN,
} scree_ply_encoding;

typedef struct scree_ply_header {
  scree_ply_encoding encoding;
  struct {
    scree_ply_element *items;
    size_t count, capacity;
  } elements;
  struct {
    scree_ply_property *items;
    size_t count, capacity;
  } properties;
} scree_ply_header;

size_t scree_ply_type_size(scree_ply_type type);

/* Reads the header and leaves t at the first byte of data. Free it also after a failure. */
scree_status scree_ply_header_read(scree_text *t, scree_ply_header *header);
void scree_ply_header_free(scree_ply_header *header);
