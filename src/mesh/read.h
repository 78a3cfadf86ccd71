/* What the readers share. One file is read by one of them, found by content (read.c). */
#ifndef SCREE_MESH_READ_H
#define SCREE_MESH_READ_H

#include "base/file.h"
#include "mesh/import.h"
#include "mesh/polygon.h"
#include "mesh/text.h"

/* One file being read. */
typedef struct scree_reading {
  const char *name; /* for errors */
  const unsigned char *bytes;
  size_t byte_count;
  size_t whole_count; /* of the file; more than byte_count, or SCREE_NO_END of a stream, where its
                         beginning showed that it is no such file */
  const scree_read_options *options;
  double unit_m;    /* metres per unit: of the options, unless the file states its own */
  scree_scan *scan; /* filled; its mesh is freed by the caller on failure */
  scree_error *error;
} scree_reading;

/* The file as text, behind a byte order mark. */
scree_text scree_reading_text(const scree_reading *r);

enum { SCREE_STL_HEADER = 84, SCREE_STL_FACET = 50 };

/* The readers. Each fills scan->mesh, format and counts. */
scree_status scree_read_stl_binary(scree_reading *r);
/* A binary STL whose length is what its count says, welded as it is read: then *done, and r->bytes
 * are not needed. Where anything is wrong with the file it is not done, and no error, for
 * scree_read_stl_binary has the sentences. */
scree_status scree_read_stl_stream(scree_reading *r, scree_stream *stream, bool *done);
scree_status scree_read_stl_ascii(scree_reading *r);
scree_status scree_read_ply(scree_reading *r);
scree_status scree_read_obj(scree_reading *r);
scree_status scree_read_off(scree_reading *r);
/* Formats read through assimp; a build without it answers SCREE_UNSUPPORTED. */
scree_status scree_read_import(scree_reading *r, scree_import_format format);
/* Whether a file of byte_count bytes that begins so (at least SCREE_STL_HEADER of them, or all) is
 * a binary STL as long as its count says. */
bool scree_is_whole_stl(const unsigned char *bytes, size_t byte_count);
/* Whether the word begins an OFF file, also of a kind that is refused. */
bool scree_is_off_word(scree_token word);

/* "NAME: no facets" and its like: the sentence is for the whole file. */
scree_status scree_reading_fail(const scree_reading *r, scree_status status, const char *format,
                                ...) __attribute__((format(printf, 3, 4)));

/* Welds loose triangles in file units into scan->mesh: the end of a reader. */
scree_status scree_reading_weld(scree_reading *r, const double *corner_positions,
                                size_t triangle_count);
/* The same for indexed faces, which are cut into triangles first. */
scree_status scree_reading_weld_faces(scree_reading *r, const double *positions,
                                      size_t position_count, scree_face_list *faces);

#endif
