#include "base/seal.h"

#include "base/alloc.h"
#include "base/file.h"

#include <string.h>

enum { BYTE_ORDER_MARK = 0x01020304, MAGIC_BYTES = 8 };

/* All of it, in its order. */
typedef struct record {
  unsigned char magic[MAGIC_BYTES];
  uint32_t version_order[2];
  uint64_t length_sum[3];
} record;

static void code_record(scree_codec *c, record *r) {
  scree_code_bytes(c, r->magic, sizeof r->magic);
  for (int i = 0; i < 2; i++) scree_code_u32(c, &r->version_order[i]);
  for (int i = 0; i < 3; i++) scree_code_u64(c, &r->length_sum[i]);
}

void scree_seal_begin(scree_codec *codec) {
  record room = {0};
  code_record(codec, &room);
}

scree_status scree_seal_end(scree_codec *codec, const scree_seal *seal, scree_error *error) {
  if (!scree_codec_good(codec)) return scree_fail_memory(error, codec->count, "a checkpoint");
  size_t length = codec->count - SCREE_SEAL_BYTES;
  scree_checksum sum = scree_checksum_of(codec->bytes + SCREE_SEAL_BYTES, length);
  record r = {.version_order = {seal->version, BYTE_ORDER_MARK},
              .length_sum = {length, sum.high, sum.low}};
  memcpy(r.magic, seal->magic, sizeof r.magic);
  scree_codec coded = {0};
  code_record(&coded, &r);
  bool good = scree_codec_good(&coded);
  if (good) memcpy(codec->bytes, coded.bytes, SCREE_SEAL_BYTES);
  scree_free(coded.bytes);
  return good ? SCREE_OK : scree_fail_memory(error, codec->count, "a checkpoint");
}

scree_status scree_seal_check(scree_codec *codec, const scree_seal *seal, const char *name,
                              scree_error *error) {
  record r = {0};
  code_record(codec, &r);
  if (codec->count < MAGIC_BYTES || memcmp(r.magic, seal->magic, MAGIC_BYTES) != 0)
    return scree_fail(error, SCREE_BAD_FILE, "%s: no %s", name, seal->kind);
  if (codec->failed)
    return scree_fail(error, SCREE_BAD_FILE, "%s: %zu bytes, shorter than the %d of a header", name,
                      codec->count, SCREE_SEAL_BYTES);
  if (r.version_order[1] != BYTE_ORDER_MARK)
    return scree_fail(error, SCREE_BAD_FILE, "%s: byte order mark 0x%08x instead of 0x%08x", name,
                      r.version_order[1], BYTE_ORDER_MARK);
  if (r.version_order[0] != seal->version)
    return scree_fail(error, SCREE_BAD_FILE, "%s: version %u; this program reads version %u", name,
                      r.version_order[0], seal->version);
  size_t length = codec->count - SCREE_SEAL_BYTES;
  if (r.length_sum[0] != length)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: %zu bytes follow the header, which announces %llu: cut short?", name,
                      length, (unsigned long long)r.length_sum[0]);
  scree_checksum sum = scree_checksum_of(codec->source + SCREE_SEAL_BYTES, length);
  if (sum.high != r.length_sum[1] || sum.low != r.length_sum[2])
    return scree_fail(error, SCREE_BAD_FILE, "%s: the checksum does not fit: the file is damaged",
                      name);
  return SCREE_OK;
}

scree_status scree_seal_read(const char *path, const scree_seal *seal, char **bytes,
                             scree_codec *codec, const char **name, scree_error *error) {
  size_t count;
  SCREE_TRY(scree_file_read(path, 0, bytes, &count, error));
  *codec = (scree_codec){.source = (unsigned char *)*bytes, .count = count, .loading = true};
  *name = strcmp(path, "-") != 0 ? path : "standard input";
  scree_status status = scree_seal_check(codec, seal, *name, error);
  if (status != SCREE_OK) scree_free(*bytes);
  return status;
}

scree_status scree_seal_refuse(const scree_codec *codec, const scree_seal *seal, const char *name,
                               scree_error *error) {
  if (codec->out_of_memory) return scree_fail_memory(error, codec->count, "a checkpoint");
  return scree_fail(error, SCREE_BAD_FILE, "%s: byte %zu: a value that no %s has, or too few bytes",
                    name, codec->position, seal->whose);
}

scree_status scree_seal_write(const unsigned char *bytes, size_t byte_count, const char *path,
                              bool overwrite, scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status) return status;
  fwrite(bytes, 1, byte_count, output.stream); /* a failure shows in the commit */
  return scree_output_commit(&output, error);
}
