/* Numbers to bytes and back, little-endian on every machine. One function lists the fields of a
 * record and serves both ways: scree_code_* appends the value to the bytes, or, when loading, reads
 * it into the value. Errors stick: after one nothing is changed, and the end of the work asks for
 * `failed` (the bytes ran out, or hold what they must not) and `out_of_memory`. */
#pragma once

#include "base/alloc.h"
#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct scree_codec {
  const unsigned char *source; /* loading: borrowed */
  unsigned char *bytes;        /* saving: grown; the caller frees it */
  size_t count, capacity, position;
  bool loading, failed, out_of_memory;
} scree_codec;

void scree_code_bytes(scree_codec *codec, void *bytes, size_t count);
void scree_code_u8(scree_codec *codec, uint8_t *value);
void scree_code_u32(scree_codec *codec, uint32_t *value);
void scree_code_u64(scree_codec *codec, uint64_t *value);
void scree_code_real(scree_codec *codec, double *value);
void scree_code_reals(scree_codec *codec, double *values, size_t count);
void scree_code_bool(scree_codec *codec, bool *value);
void scree_code_vec3(scree_codec *codec, vec3 *value);

/* A count of records of at least record_bytes each: one that the bytes left cannot hold fails, so
 * that no damaged count asks for memory. */
void scree_code_count(scree_codec *codec, size_t *count, size_t record_bytes);

/* A text with its length; reading one, it is to be freed, and NULL where it cannot be had. */
void scree_code_text(scree_codec *codec, const char *text, size_t length);
char *scree_decode_text(scree_codec *codec);

/* Saving: frees the bytes. */
static inline void scree_codec_free(scree_codec *codec) {
  scree_free(codec->bytes);
}

static inline bool scree_codec_good(const scree_codec *codec) {
  return !codec->failed && !codec->out_of_memory;
}
