/* The objects of a 3MF archive, as its XML parts say them, before they are placed. */
#pragma once

#include "base/array.h"
#include "mesh/io/placed.h"

/* What a volume is for in a slicer: only solids are the shape. */
typedef enum scree_3mf_role {
  SCREE_3MF_SOLID,
  SCREE_3MF_NEGATIVE,
  SCREE_3MF_MODIFIER,
  SCREE_3MF_SUPPORT,
  SCREE_3MF_ROLE_COUNT
} scree_3mf_role;

/* Triangles first to last of an object, or its component whose object is `first`. */
typedef struct scree_3mf_volume {
  uint32_t object_id, first, last;
  bool is_component;
  scree_3mf_role role;
} scree_3mf_volume;

/* An object placed: by the build, or in another. */
typedef struct scree_3mf_component {
  uint32_t object_id;
  size_t part;       /* in which it is defined */
  bool is_unprinted; /* an item that the build is to leave out */
  scree_affine where;
} scree_3mf_component;

typedef struct scree_3mf_object {
  uint32_t id;
  size_t part;
  size_t first_vertex, vertex_count; /* in coordinates */
  size_t first_triangle, triangle_count, first_component, component_count;
  bool is_support;
} scree_3mf_object;

typedef struct scree_3mf_triangle {
  uint32_t corner[3];
  scree_3mf_role role;
} scree_3mf_triangle;

typedef struct scree_3mf_part {
  char name[256]; /* in the archive, without a leading slash */
} scree_3mf_part;

#define SCREE_3MF_LIST(type)                                                                       \
  struct {                                                                                         \
    type *items;                                                                                   \
    size_t count, capacity;                                                                        \
  }

typedef struct scree_3mf {
  SCREE_3MF_LIST(scree_3mf_part) parts; /* the first is the model; others as they are named */
  SCREE_3MF_LIST(scree_3mf_object) objects;
  SCREE_3MF_LIST(scree_3mf_component) components;
  SCREE_3MF_LIST(scree_3mf_component) items; /* of the build of the first part */
  SCREE_3MF_LIST(double) vertices;
  SCREE_3MF_LIST(scree_3mf_triangle) triangles;
  SCREE_3MF_LIST(scree_3mf_volume) volumes;
  char unit_name[16];
  const char *unread; /* an extension that is used and not read; NULL: none */
  size_t left_out[SCREE_3MF_ROLE_COUNT], unprinted; /* items */
} scree_3mf;

struct XML_ParserStruct;
/* One part being parsed. */
typedef struct scree_3mf_parse {
  scree_3mf *model;
  void (*start)(void *parse, const char *name, const char **attributes);
  const char *part_name;
  size_t part;
  uint32_t object_id; /* slicers' settings: of the object that is open */
  scree_reading *r;
  uint64_t given; /* bytes of the part so far */
  struct XML_ParserStruct *parser;
  scree_status status;
  SCREE_3MF_LIST(struct scree_3mf_prefix) prefixes; /* of namespaces */
} scree_3mf_parse;
struct scree_3mf_prefix {
  char name[32], uri[128];
};

/* Parses part_name by its `start`; a part that is not there is an error only where it is needed. */
scree_status scree_3mf_parse_part(scree_reading *r, scree_3mf_parse *p, bool is_needed);
/* Parses model part `index` into objects and, of the first, the build. */
scree_status scree_3mf_read_part(scree_reading *r, scree_3mf *m, size_t index);
/* The part of this path, made where it is new. */
size_t scree_3mf_part_index(scree_3mf_parse *p, const char *path);
/* NULL: there is none. */
scree_3mf_object *scree_3mf_find(scree_3mf *m, size_t part, uint32_t id);
/* NULL: there is none. */
const char *scree_3mf_attribute(const char **attributes, const char *name);
/* 0 for what is no number: the specification begins at 1. */
uint32_t scree_3mf_id(const char *text);
/* Ends the parsing: memory is out. */
void scree_3mf_stop_memory(scree_3mf_parse *p);
void scree_3mf_free(scree_3mf *m);
