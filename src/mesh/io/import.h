/* What passes between a file of a format read through assimp, the child process that reads it, and
 * the parent (mesh/io/read_import.c). */
#pragma once

#include "base/error.h"

typedef enum scree_import_format {
  SCREE_IMPORT_COLLADA,
  SCREE_IMPORT_X3D,
  SCREE_IMPORT_AMF,
  SCREE_IMPORT_FBX,
  SCREE_IMPORT_3DS
} scree_import_format;

/* Where the unit of length comes from. */
typedef enum scree_unit_source {
  SCREE_UNIT_METRE,
  SCREE_UNIT_IN_ROOT,
  SCREE_UNIT_IN_SCENE,
  SCREE_UNIT_ASKED
} scree_unit_source;

typedef struct scree_import_kind {
  const char *name, *hint; /* for people; for assimp */
  scree_unit_source unit;
} scree_import_kind;

extern const scree_import_kind scree_import_kinds[]; /* by scree_import_format */

enum { SCREE_IMPORT_MOST = 1 << 26 }; /* triangles */

/* The metres of a unit that the root element of a 3MF or AMF names (3MF Core 1.3, 3.4; ISO/ASTM
 * 52915); 0: there is none of this name. */
double scree_unit_of_root(const char *name);

/* What the child answers before the corners: nine doubles per triangle. */
typedef struct scree_import_answer {
  uint64_t triangle_count;
  double unit_m;
  int64_t status;
  char unit_name[16];
  char message[256];
} scree_import_answer;

/* Checks an answer and welds its triangles; bytes are aligned as for a double. Errors:
 * SCREE_BAD_FILE, SCREE_LIMIT and those of welding. */
struct scree_reading;
scree_status scree_import_take(struct scree_reading *r, scree_import_format format,
                               const char *bytes, size_t byte_count);
