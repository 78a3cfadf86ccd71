#include "base/codec.h"

#include "base/array.h"

#include <string.h>

void scree_code_bytes(scree_codec *c, void *bytes, size_t count) {
  if (!scree_codec_good(c) || count == 0) return;
  if (c->loading) {
    if (count > c->count - c->position) {
      c->failed = true;
      return;
    }
    memcpy(bytes, c->source + c->position, count);
    c->position += count;
    return;
  }
  void *grown = c->bytes;
  if (!scree_array_reserve(&grown, &c->capacity, c->count + count, 1)) {
    c->out_of_memory = true;
    return;
  }
  c->bytes = grown;
  memcpy(c->bytes + c->count, bytes, count);
  c->count += count;
}

/* The lowest `size` bytes of value, the lowest first. */
static void code_integer(scree_codec *c, uint64_t *value, size_t size) {
  unsigned char bytes[8] = {0};
  for (size_t i = 0; i < size; i++) bytes[i] = (unsigned char)(*value >> 8 * i);
  scree_code_bytes(c, bytes, size);
  if (!c->loading || !scree_codec_good(c)) return;
  *value = 0;
  for (size_t i = 0; i < size; i++) *value |= (uint64_t)bytes[i] << 8 * i;
}

void scree_code_u8(scree_codec *c, uint8_t *value) {
  scree_code_bytes(c, value, 1);
}

void scree_code_u32(scree_codec *c, uint32_t *value) {
  uint64_t wide = *value;
  code_integer(c, &wide, 4);
  *value = (uint32_t)wide;
}

void scree_code_u64(scree_codec *c, uint64_t *value) {
  code_integer(c, value, 8);
}

void scree_code_real(scree_codec *c, double *value) {
  uint64_t bits;
  memcpy(&bits, value, sizeof bits);
  code_integer(c, &bits, 8);
  memcpy(value, &bits, sizeof bits);
}

void scree_code_reals(scree_codec *c, double *values, size_t count) {
  for (size_t i = 0; i < count; i++) scree_code_real(c, &values[i]);
}

void scree_code_bool(scree_codec *c, bool *value) {
  uint8_t byte = c->loading ? 0 : *value; /* a place that is loaded may hold anything */
  scree_code_u8(c, &byte);
  if (byte > 1) c->failed = true;
  *value = byte == 1;
}

void scree_code_vec3(scree_codec *c, vec3 *value) {
  scree_code_real(c, &value->x);
  scree_code_real(c, &value->y);
  scree_code_real(c, &value->z);
}

void scree_code_count(scree_codec *c, size_t *count, size_t record_bytes) {
  uint64_t wide = *count;
  scree_code_u64(c, &wide);
  if (c->loading && (c->failed || wide > (c->count - c->position) / record_bytes)) {
    c->failed = true;
    wide = 0;
  }
  *count = (size_t)wide;
}

void scree_code_text(scree_codec *codec, const char *text, size_t length) {
  scree_code_count(codec, &length, 1);
  for (size_t i = 0; i < length; i++) {
    uint8_t byte = (uint8_t)text[i];
    scree_code_u8(codec, &byte);
  }
}

char *scree_decode_text(scree_codec *codec) {
  size_t length = 0;
  scree_code_count(codec, &length, 1);
  if (!scree_codec_good(codec)) return NULL;
  char *text = scree_alloc(length + 1, 1);
  if (!text) {
    codec->out_of_memory = true;
    return NULL;
  }
  scree_code_bytes(codec, text, length);
  text[length] = 0;
  return text;
}
