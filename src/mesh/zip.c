/* The zip format, as far as a 3MF needs it: the end record at the end of the file (behind which lie
 * at most 65535 bytes of comment) gives the central directory, whose entries give where the members
 * lie (PKWARE APPNOTE 4.3). In zip64, what is all ones there stands with 64 bits in another end
 * record and in the extra fields of an entry. No encryption, methods 0 (stored) and 8 (deflate).
 * Every offset is checked against the file's length. */
#ifdef SCREE_WITH_ASSIMP
#include "mesh/zip.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

enum {
  END_SIZE = 22,
  ENTRY_SIZE = 46,
  LOCAL_SIZE = 30,
  LOCATOR_SIZE = 20, /* of zip64's end record, right before the other one */
  WIDE_END_SIZE = 56,
  WIDE_FIELD = 1, /* of the extra fields: the entry's 64-bit numbers */
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

static uint64_t get64(const unsigned char *p) {
  return get32(p) | (uint64_t)get32(p + 4) << 32;
}

static const unsigned char *find_end_record(const unsigned char *bytes, size_t byte_count) {
  if (byte_count < END_SIZE) return NULL;
  size_t last = byte_count - END_SIZE, first = last > MOST_COMMENT ? last - MOST_COMMENT : 0;
  for (size_t at = last + 1; at-- > first;)
    if (!memcmp(bytes + at, "PK\5\6", 4)) return bytes + at;
  return NULL;
}

typedef struct directory {
  uint64_t entry_count, at;
} directory;

static bool find_directory(const unsigned char *bytes, size_t byte_count, directory *d) {
  const unsigned char *end = find_end_record(bytes, byte_count);
  if (!end) return false;
  *d = (directory){get16(end + 10), get32(end + 16)};
  if (d->entry_count != UINT16_MAX && d->at != UINT32_MAX) return true;
  if (end - bytes < LOCATOR_SIZE || memcmp(end - LOCATOR_SIZE, "PK\6\7", 4) != 0) return true;
  uint64_t at = get64(end - LOCATOR_SIZE + 8);
  if (byte_count < WIDE_END_SIZE || at > byte_count - WIDE_END_SIZE) return false;
  if (memcmp(bytes + at, "PK\6\6", 4) != 0) return false;
  *d = (directory){get64(bytes + at + 32), get64(bytes + at + 48)};
  return true;
}

/* An entry of the directory. */
typedef struct entry {
  const unsigned char *head, *name, *content;
  size_t name_length;
  uint64_t stored_count, content_count, local;
  uint32_t method;
  bool is_wide;
} entry;

/* Of content_count, stored_count and local those that are all ones stand in a field of the extra
 * ones, in this order. */
static bool widen(entry *e) {
  const unsigned char *fields = e->name + e->name_length;
  size_t at = 0, length = get16(e->head + 30);
  uint64_t *const numbers[] = {&e->content_count, &e->stored_count, &e->local};
  while (at + 4 <= length && get16(fields + at) != WIDE_FIELD) at += 4 + get16(fields + at + 2);
  at += 4;
  for (int i = 0; i < 3; i++) {
    if (*numbers[i] != UINT32_MAX) continue;
    if (at + 8 > length) return false;
    *numbers[i] = get64(fields + at);
    at += 8;
    e->is_wide = true;
  }
  return true;
}

/* Where the entry's content lies: behind a local header whose own lengths count. */
static bool locate(const unsigned char *bytes, size_t byte_count, entry *e) {
  uint32_t flags = get16(e->head + 8);
  if (!widen(e) || (flags & 1) || (e->method != STORED && e->method != DEFLATED)) return false;
  if (byte_count < LOCAL_SIZE || e->local > byte_count - LOCAL_SIZE) return false;
  const unsigned char *local = bytes + e->local;
  if (memcmp(local, "PK\3\4", 4) != 0) return false;
  uint64_t begin = e->local + LOCAL_SIZE + get16(local + 26) + get16(local + 28);
  if (begin > byte_count || e->stored_count > byte_count - begin) return false;
  e->content = bytes + begin;
  return true;
}

/* The entry at *at of the directory, behind which *at goes; false where it is damaged. */
static bool next_entry(const unsigned char *bytes, size_t byte_count, uint64_t *at, entry *e) {
  if (byte_count < ENTRY_SIZE || *at > byte_count - ENTRY_SIZE) return false;
  const unsigned char *head = bytes + *at;
  if (memcmp(head, "PK\1\2", 4) != 0) return false;
  *e = (entry){.head = head,
               .name = head + ENTRY_SIZE,
               .name_length = get16(head + 28),
               .method = get16(head + 10),
               .stored_count = get32(head + 20),
               .content_count = get32(head + 24),
               .local = get32(head + 42)};
  *at += ENTRY_SIZE + e->name_length + get16(head + 30) + get16(head + 32);
  return *at <= byte_count;
}

bool scree_zip_find(const unsigned char *bytes, size_t byte_count, const char *name,
                    scree_zip_member *member) {
  directory d;
  entry e;
  if (!find_directory(bytes, byte_count, &d)) return false;
  for (uint64_t i = 0, at = d.at; i < d.entry_count; i++) {
    if (!next_entry(bytes, byte_count, &at, &e)) return false;
    if (e.name_length != strlen(name) ||
        strncasecmp((const char *)e.name, name, e.name_length) != 0)
      continue;
    if (!locate(bytes, byte_count, &e)) return false;
    *member = (scree_zip_member){e.content, e.stored_count, e.method == DEFLATED};
    return true;
  }
  return false;
}

/* ---- Without zip64 ---- */

static unsigned char *put(unsigned char *out, uint64_t value, int byte_count) {
  for (int i = 0; i < byte_count; i++) *out++ = (unsigned char)(value >> 8 * i);
  return out;
}

/* What local header and directory have in common: version to name length, and no extra fields. */
static unsigned char *put_common(unsigned char *out, const entry *e) {
  out = put(out, 20, 2); /* the version that can read it: 2.0 */
  memcpy(out, e->head + 8, 12);
  out[0] &= (unsigned char)~8; /* the sizes stand here, not behind the content */
  out = put(out + 12, e->stored_count, 4);
  out = put(out, e->content_count, 4);
  out = put(out, e->name_length, 2);
  return put(out, 0, 2);
}

/* Header and content of one member; answers what lies behind. */
static unsigned char *put_member(unsigned char *out, const entry *e) {
  out = put_common(put(out, 0x04034b50, 4), e);
  memcpy(out, e->name, e->name_length);
  out += e->name_length;
  memcpy(out, e->content, e->stored_count);
  return out + e->stored_count;
}

static unsigned char *put_entry(unsigned char *out, const entry *e, uint64_t local) {
  out = put_common(put(put(out, 0x02014b50, 4), 20, 2), e);
  memset(out, 0, 10); /* no comment, first disk, no attributes */
  out = put(out + 10, local, 4);
  memcpy(out, e->name, e->name_length);
  return out + e->name_length;
}

bool scree_zip_narrow(const unsigned char *bytes, size_t byte_count, unsigned char **narrow,
                      size_t *narrow_count) {
  directory d;
  entry e;
  bool is_wide = false;
  *narrow = NULL;
  if (!find_directory(bytes, byte_count, &d) || d.entry_count >= UINT16_MAX) return true;
  uint64_t size = END_SIZE, at = d.at, local = 0;
  for (uint64_t i = 0; i < d.entry_count; i++) {
    if (!next_entry(bytes, byte_count, &at, &e) || !locate(bytes, byte_count, &e)) return true;
    size += LOCAL_SIZE + ENTRY_SIZE + 2 * e.name_length + e.stored_count;
    is_wide |= e.is_wide;
  }
  if (!is_wide || size >= UINT32_MAX) return true;
  unsigned char *made = malloc(size), *out = made;
  if (!made) return false;
  at = d.at;
  for (uint64_t i = 0; i < d.entry_count; i++) {
    next_entry(bytes, byte_count, &at, &e), locate(bytes, byte_count, &e);
    out = put_member(out, &e);
  }
  unsigned char *entries = out;
  at = d.at;
  for (uint64_t i = 0; i < d.entry_count; i++) {
    next_entry(bytes, byte_count, &at, &e), locate(bytes, byte_count, &e);
    out = put_entry(out, &e, local);
    local += LOCAL_SIZE + e.name_length + e.stored_count;
  }
  unsigned char *end = out;
  out = put(put(out, 0x06054b50, 4), 0, 4);
  out = put(put(out, d.entry_count, 2), d.entry_count, 2);
  out = put(put(out, (uint64_t)(end - entries), 4), (uint64_t)(entries - made), 4);
  out = put(out, 0, 2);
  *narrow = made;
  *narrow_count = (size_t)(out - made);
  return true;
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
