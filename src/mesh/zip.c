/* The zip format, as far as a 3MF needs it: the end record at the end of the file (behind which lie
 * at most 65535 bytes of comment) gives the central directory, whose entries give where the members
 * lie (PKWARE APPNOTE 4.3). No zip64, no encryption, methods 0 (stored) and 8 (deflate). Every
 * offset is checked against the file's length. */
#ifdef SCREE_WITH_ASSIMP
#include "mesh/zip.h"

#include <stdint.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

enum {
  END_SIZE = 22,
  ENTRY_SIZE = 46,
  LOCAL_SIZE = 30,
  MOST_COMMENT = 65535,
  STORED = 0,
  DEFLATED = 8,
  RAW_WINDOW = -15 /* zlib: deflate without a header */
};

static uint32_t get16(const unsigned char *p) {
  return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}
static uint32_t get32(const unsigned char *p) {
  return get16(p) | get16(p + 2) << 16;
}

static const unsigned char *find_end_record(const unsigned char *bytes, size_t byte_count) {
  if (byte_count < END_SIZE) return NULL;
  size_t last = byte_count - END_SIZE, first = last > MOST_COMMENT ? last - MOST_COMMENT : 0;
  for (size_t at = last + 1; at-- > first;)
    if (!memcmp(bytes + at, "PK\5\6", 4)) return bytes + at;
  return NULL;
}

/* Where the entry's content lies: behind a local header whose own lengths count. */
static bool locate(const unsigned char *bytes, size_t byte_count, const unsigned char *entry,
                   scree_zip_member *member) {
  uint32_t flags = get16(entry + 8), method = get16(entry + 10);
  size_t stored_count = get32(entry + 20), local = get32(entry + 42);
  if ((flags & 1) || (method != STORED && method != DEFLATED)) return false;
  if (byte_count < LOCAL_SIZE || local > byte_count - LOCAL_SIZE) return false;
  if (memcmp(bytes + local, "PK\3\4", 4) != 0) return false;
  size_t begin = local + LOCAL_SIZE + get16(bytes + local + 26) + get16(bytes + local + 28);
  if (begin > byte_count || stored_count > byte_count - begin) return false;
  *member = (scree_zip_member){bytes + begin, stored_count, method == DEFLATED};
  return true;
}

bool scree_zip_find(const unsigned char *bytes, size_t byte_count, const char *name,
                    scree_zip_member *member) {
  const unsigned char *end = find_end_record(bytes, byte_count);
  if (!end) return false;
  size_t entry_count = get16(end + 10), at = get32(end + 16), name_length = strlen(name);
  for (size_t i = 0; i < entry_count; i++) {
    if (byte_count < ENTRY_SIZE || at > byte_count - ENTRY_SIZE) return false;
    const unsigned char *entry = bytes + at;
    if (memcmp(entry, "PK\1\2", 4) != 0) return false;
    size_t length = get16(entry + 28);
    at += ENTRY_SIZE + length + get16(entry + 30) + get16(entry + 32);
    if (at > byte_count) return false;
    if (length == name_length && !strncasecmp((const char *)entry + ENTRY_SIZE, name, length))
      return locate(bytes, byte_count, entry, member);
  }
  return false;
}

size_t scree_zip_peek(const scree_zip_member *member, char *out, size_t capacity) {
  if (!member->is_deflated) {
    size_t count = member->stored_count < capacity ? member->stored_count : capacity;
    memcpy(out, member->bytes, count);
    return count;
  }
  z_stream stream = {0};
  if (inflateInit2(&stream, RAW_WINDOW) != Z_OK) return 0;
  stream.next_in = (Bytef *)(uintptr_t)member->bytes;
  stream.avail_in = member->stored_count < UINT32_MAX ? (uInt)member->stored_count : UINT32_MAX;
  stream.next_out = (Bytef *)out;
  stream.avail_out = (uInt)capacity;
  (void)inflate(&stream, Z_SYNC_FLUSH);
  size_t count = capacity - stream.avail_out;
  inflateEnd(&stream);
  return count;
}
#else
typedef int scree_zip_unused; /* a translation unit is never empty */
#endif
