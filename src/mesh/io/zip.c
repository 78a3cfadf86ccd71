/* The zip format, as far as a 3MF needs it: the end record at the end of the file (behind which lie
 * at most 65535 bytes of comment) gives the central directory, whose entries give where the members
 * lie (PKWARE APPNOTE 4.3). In zip64, what is all ones there stands with 64 bits in another end
 * record and in the extra fields of an entry. No encryption, methods 0 (stored) and 8 (deflate).
 * Every offset is checked against the file's length. */
#include "mesh/io/zip.h"

#include "base/alloc.h"

#include <stdint.h>
#include <stdio.h>
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
  PIECE = 1 << 16,
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
  uint32_t method, crc;
} entry;

/* Reads those of content_count, stored_count and local that are all ones from one of the extra
 * fields, where they stand in this order. */
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
  }
  return true;
}

/* Where the entry's content lies: behind a local header whose own lengths count. */
static bool locate(const unsigned char *bytes, size_t byte_count, entry *e) {
  if (!widen(e)) return false;
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
               .crc = get32(head + 16),
               .stored_count = get32(head + 20),
               .content_count = get32(head + 24),
               .local = get32(head + 42)};
  *at += ENTRY_SIZE + e->name_length + get16(head + 30) + get16(head + 32);
  return *at <= byte_count;
}

scree_zip_answer scree_zip_find(const unsigned char *bytes, size_t byte_count, const char *name,
                                scree_zip_member *member) {
  directory d;
  entry e;
  if (!find_directory(bytes, byte_count, &d)) return SCREE_ZIP_DAMAGED;
  for (uint64_t i = 0, at = d.at; i < d.entry_count; i++) {
    if (!next_entry(bytes, byte_count, &at, &e)) return SCREE_ZIP_DAMAGED;
    if (e.name_length != strlen(name) ||
        strncasecmp((const char *)e.name, name, e.name_length) != 0)
      continue;
    bool encrypted = get16(e.head + 8) & 1;
    if (encrypted || (e.method != STORED && e.method != DEFLATED)) return SCREE_ZIP_METHOD;
    if (!locate(bytes, byte_count, &e)) return SCREE_ZIP_DAMAGED;
    *member = (scree_zip_member){e.content, (size_t)e.stored_count, e.crc, e.method == DEFLATED};
    return SCREE_ZIP_FOUND;
  }
  return SCREE_ZIP_ABSENT;
}

void scree_zip_first_name(const unsigned char *bytes, size_t byte_count,
                          char name[SCREE_ZIP_NAME]) {
  directory d;
  entry e;
  uint64_t at = 0;
  *name = 0;
  if (!find_directory(bytes, byte_count, &d) || !d.entry_count) return;
  at = d.at;
  if (next_entry(bytes, byte_count, &at, &e))
    snprintf(name, SCREE_ZIP_NAME, "%.*s", (int)e.name_length, (const char *)e.name);
}

static void *zip_alloc(void *context, unsigned count, unsigned size) {
  (void)context;
  return scree_alloc(count, size);
}

static void zip_free(void *context, void *block) {
  (void)context;
  scree_free(block);
}

/* The next piece of the content: its length, and zlib's code. */
static int inflate_piece(z_stream *z, const scree_zip_member *member, size_t *done,
                         unsigned char *piece, size_t *made) {
  uint64_t left = member->stored_count - *done;
  z->next_in = (Bytef *)(uintptr_t)(member->bytes + *done);
  z->avail_in = left < UINT32_MAX ? (uInt)left : UINT32_MAX;
  size_t given = z->avail_in;
  z->next_out = piece;
  z->avail_out = PIECE;
  int code = inflate(z, Z_NO_FLUSH);
  *done += given - z->avail_in;
  *made = PIECE - z->avail_out;
  return code;
}

static int copy_piece(const scree_zip_member *member, size_t *done, unsigned char *piece,
                      size_t *made) {
  size_t left = member->stored_count - *done;
  *made = left < PIECE ? left : PIECE;
  memcpy(piece, member->bytes + *done, *made);
  *done += *made;
  return *made == left ? Z_STREAM_END : Z_OK;
}

scree_status scree_zip_stream(const scree_zip_member *member, scree_zip_taker *take,
                              void *context) {
  unsigned char *piece = scree_alloc(PIECE, 1);
  z_stream z = {.zalloc = zip_alloc, .zfree = zip_free};
  int code = piece ? inflateInit2(&z, RAW_WINDOW) : Z_MEM_ERROR;
  uLong crc = crc32(0, NULL, 0);
  size_t done = 0, made = 0;
  while (code == Z_OK) {
    code = member->is_deflated ? inflate_piece(&z, member, &done, piece, &made)
                               : copy_piece(member, &done, piece, &made);
    if (code != Z_OK && code != Z_STREAM_END) break;
    crc = crc32(crc, piece, (uInt)made);
    if (!take(context, piece, made, code == Z_STREAM_END)) code = Z_ERRNO;
  }
  if (piece) inflateEnd(&z);
  scree_free(piece);
  if (code == Z_MEM_ERROR) return SCREE_OUT_OF_MEMORY;
  return code == Z_STREAM_END && crc == member->crc ? SCREE_OK : SCREE_BAD_FILE;
}
