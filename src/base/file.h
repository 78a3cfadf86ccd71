/* Whole files in, whole files out. Nothing half-written: output goes to a file without a name in
 * the target's folder (where a file system has none, to a temporary name there), which takes the
 * target's name when complete and on disk. A target that is no file (a device, a pipe) is written
 * to as it stands. */
#pragma once

#include "base/alloc.h"

/* Reads all of path ("-" is stdin), refusing more than max_bytes. 0: files may have any size, a
 * pipe or device may give an eighth of the machine's memory. The bytes are followed by one 0 that
 * is not counted. Free with scree_free. */
scree_status scree_file_read(const char *path, size_t max_bytes, char **bytes, size_t *byte_count,
                             scree_error *error);

/* Reads the first byte_count bytes of a regular file that the file `from` names: `name`, decoded,
 * from the folder of `from` down, with '/' between folders on every system. Nothing else is opened:
 * no link, no device or pipe, no other folder. A shorter file is SCREE_BAD_FILE. */
scree_status scree_file_read_beneath(const char *from, const char *name, size_t byte_count,
                                     char **bytes, scree_error *error);

/* How many bytes of a file of whole_count bytes (SCREE_NO_END: a stream) are worth reading, by its
 * first SCREE_JUDGED_BYTES, or all where it has fewer; SIZE_MAX: all that come. */
typedef size_t scree_file_judge(const char *bytes, size_t byte_count, size_t whole_count);
enum { SCREE_JUDGED_BYTES = 1 << 16 };
#define SCREE_NO_END SIZE_MAX

/* scree_file_read that leaves off there, for files are large and some streams never end; then
 * *whole_count is more than *byte_count: the length of the file, or SCREE_NO_END. */
scree_status scree_file_read_judged(const char *path, size_t max_bytes, scree_file_judge *judge,
                                    char **bytes, size_t *byte_count, size_t *whole_count,
                                    scree_error *error);

/* A regular file that is read from its beginning in pieces, into a small buffer that stays in the
 * processor's cache: half of the time of reading a whole file goes into memory touched for the
 * first time. */
typedef struct scree_stream {
  int fd;
  size_t byte_count, done; /* of the file when it was opened; read so far */
  void *hash;              /* of those */
} scree_stream;

/* False where there is no such file or no memory: nothing is open then. */
bool scree_stream_open(const char *path, scree_stream *stream);
/* The next bytes; false where there are not as many, or they cannot be read. */
bool scree_stream_read(scree_stream *stream, void *bytes, size_t byte_count);
/* The checksum of what was read. */
scree_checksum scree_stream_checksum(const scree_stream *stream);
void scree_stream_close(scree_stream *stream);

/* A file being written. */
typedef struct scree_output {
  FILE *stream;
  char *path;           /* NULL: the stream is stdout */
  char *temporary_path; /* NULL: path is no file and written to directly; "": has no name yet */
  bool overwrite;       /* a file that has the name by then */
} scree_output;

/* Opens path for writing ("-" is stdout). Without overwrite an existing file is refused with
 * SCREE_EXISTS. */
scree_status scree_output_open(const char *path, bool overwrite, scree_output *output,
                               scree_error *error);
/* Flushes, syncs and renames; a full disk is found here at the latest. Closes in every case. */
scree_status scree_output_commit(scree_output *output, scree_error *error);
/* Closes and removes the temporary file. */
void scree_output_discard(scree_output *output);

/* Whether path could be written to now, for before long work: SCREE_EXISTS where there is a file
 * and nothing may be overwritten, SCREE_IO where the system says no, or where the file there is
 * write-protected (mode 444; root may not either). Leaves nothing behind; "-", pipes and devices
 * are not opened. */
scree_status scree_output_check(const char *path, bool overwrite, scree_error *error);

/* A text, whole or not at all; "-" is stdout. */
scree_status scree_text_write(const char *text, const char *path, bool overwrite,
                              scree_error *error);

scree_checksum scree_checksum_of(const void *bytes, size_t byte_count);

/* Creates the folder and its parents; an existing folder is fine. */
scree_status scree_folder_create(const char *path, scree_error *error);
