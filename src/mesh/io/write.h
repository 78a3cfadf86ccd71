/* What the writers share. */
#pragma once

#include "base/vec.h"
#include "mesh/mesh.h"

#include <stdio.h>

enum { SCREE_PROVENANCE_SIZE = 256 };

/* A mesh on its way into a stream. */
typedef struct scree_writing {
  const scree_mesh *mesh;
  FILE *stream;
  double unit_m;
  char provenance[SCREE_PROVENANCE_SIZE]; /* one line, printable */
} scree_writing;

/* In the file's unit. */
static inline vec3 scree_writing_position(const scree_writing *w, uint32_t vertex) {
  vec3 p = vec3_load(w->mesh->positions + 3 * (size_t)vertex);
  return (vec3){p.x / w->unit_m, p.y / w->unit_m, p.z / w->unit_m};
}

/* "scree VERSION, unit NUMBER m; COMMENT", the comment may be NULL. */
void scree_provenance_text(double unit_m, const char *comment, char text[SCREE_PROVENANCE_SIZE]);
/* The unit in metres of a provenance that begins so, as a comment in a file has it; 0: it is none
 * of scree's. */
double scree_provenance_unit(const char *begin, const char *end);

/* A 3MF stays below the 4 GiB of a plain zip: 95 bytes a vertex and 54 a triangle at most. */
#define SCREE_3MF_LIMIT ((size_t)25000000)

/* write_3mf.c. The name that 3MF has for the unit; where it has none, *unit_m becomes 1, metre. */
const char *scree_3mf_unit(double *unit_m);
/* The metres of a unit of this name; 0: there is none. */
double scree_3mf_unit_m(const char *name);
/* The whole file, its unit one of these; errors are the stream's. */
void scree_write_3mf(const scree_writing *w);

/* The format's name as in the comments above ("auto" for SCREE_FORMAT_AUTO). */
const char *scree_file_format_name(scree_file_format format);
