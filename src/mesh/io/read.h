
#include "base/file.h"
#include "mesh/io/polygon.h"
#include "mesh/io/text.h"

/* One file being read: what every reader is given, and what all of them end in. */
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
  const char *path;      /* of the file, for others beside it; NULL: bytes in memory, or a stream */
  scree_checksum beside; /* of those that were read; zero: none */
} scree_reading;

/* The file as text, behind a byte order mark. */
scree_text scree_reading_text(const scree_reading *r);

enum { SCREE_SNIFF_BYTES = 4096 }; /* as far as one looks for what a file is */

/* Takes the unit that scree wrote into the file's first lines, unless the options say not to. */
void scree_reading_take_unit(scree_reading *r, const unsigned char *bytes, size_t byte_count);

/* "NAME: no facets" and its like: the sentence is for the whole file. */
scree_status scree_reading_fail(const scree_reading *r, scree_status status, const char *format,
                                ...) SCREE_PRINTF(3, 4);

/* Welds loose triangles in file units into scan->mesh: the end of a reader. */
scree_status scree_reading_weld(scree_reading *r, const double *corner_positions,
                                size_t triangle_count);
/* The same for indexed faces, which are cut into triangles first. */
scree_status scree_reading_weld_faces(scree_reading *r, const double *positions,
                                      size_t position_count, scree_face_list *faces);
/* The readers. One file is read by one of them, found by content (read.c). */
#pragma once

enum { SCREE_STL_HEADER = 84, SCREE_STL_FACET = 50 };

/* A binary STL's length beside the count in its header. */
typedef enum scree_stl_length {
  SCREE_STL_WHOLE,       /* what the count says */
  SCREE_STL_SWAPPED,     /* what the count says with the most significant byte first */
  SCREE_STL_MISCOUNTED,  /* whole facets, but the count is too low, or the highest there is */
  SCREE_STL_OTHER_LENGTH /* anything else */
} scree_stl_length;

/* Each fills scan->mesh, format and counts. */
scree_status scree_read_stl_binary(scree_reading *r, scree_stl_length length);
/* A binary STL whose length is what its count says, welded as it is read: then *done, and r->bytes
 * are not needed. Where anything is wrong with the file it is not done, and no error, for
 * scree_read_stl_binary has the sentences. */
scree_status scree_read_stl_stream(scree_reading *r, scree_stream *stream, bool *done);
scree_status scree_read_stl_ascii(scree_reading *r);
scree_status scree_read_ply(scree_reading *r);
scree_status scree_read_obj(scree_reading *r);
scree_status scree_read_off(scree_reading *r);
scree_status scree_read_3mf(scree_reading *r);
scree_status scree_read_gltf(scree_reading *r, bool is_binary);
/* The facets that a binary STL's header of SCREE_STL_HEADER bytes names. */
size_t scree_stl_count(const unsigned char *bytes);
/* How long a file of byte_count bytes that begins so (at least SCREE_STL_HEADER of them, or all) is
 * as a binary STL. */
scree_stl_length scree_stl_length_of(const unsigned char *bytes, size_t byte_count);
/* Whether the word begins an OFF file, also of a kind that is refused. */
bool scree_is_off_word(scree_token word);

/* scree_scan_read of byte_count bytes in memory; name stands for the file in errors. */
scree_status scree_scan_parse(const void *bytes, size_t byte_count, const char *name,
                              const scree_read_options *options, scree_scan *scan,
                              scree_error *error);
