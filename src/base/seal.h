/* What stands before the bytes of scree's own files, so that a foreign, cut or damaged one is
 * known: magic (8 bytes), version and byte order mark (u32), count of the bytes that follow and
 * their XXH3-128 (u64, high half first). */
#pragma once

#include "base/codec.h"
#include "base/error.h"

enum { SCREE_SEAL_BYTES = 40 };

/* A kind of file. */
typedef struct scree_seal {
  char magic[9];
  const char *kind, *whose; /* for messages: "checkpoint of a scree world", "world" */
  uint32_t version;         /* that is read and written */
} scree_seal;

/* Saving: room for the seal in a codec that is empty, and at the end the seal. */
void scree_seal_begin(scree_codec *codec);
scree_status scree_seal_end(scree_codec *codec, const scree_seal *seal, scree_error *error);

/* Loading: checks the seal and leaves the codec behind it. SCREE_BAD_FILE with `name` and reason.
 */
scree_status scree_seal_check(scree_codec *codec, const scree_seal *seal, const char *name,
                              scree_error *error);

/* Loading a file ("-" is stdin): reads it and checks its seal. The codec stands on *bytes, free
 * with scree_free; *name is what messages call the file. */
scree_status scree_seal_read(const char *path, const scree_seal *seal, char **bytes,
                             scree_codec *codec, const char **name, scree_error *error);
/* Says that memory is out, or that the codec has come to what no such file holds. */
scree_status scree_seal_refuse(const scree_codec *codec, const scree_seal *seal, const char *name,
                               scree_error *error);

/* Writes these bytes, whole or not at all. */
scree_status scree_seal_write(const unsigned char *bytes, size_t byte_count, const char *path,
                              bool overwrite, scree_error *error);
