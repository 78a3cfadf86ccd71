#include "report/page_parts.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"
#include "base/path.h"
#include "base/platform.h"

enum {
  MOST_PART_BYTES = 64 << 20,
  MOST_PICTURE_BYTES = 1300000,
  LEAST_PILE_BYTES = 300000, /* kept for each, as far as half the room goes */
};

scree_status scree_page_part_add(scree_page_parts *parts, scree_part_kind kind, const char *folder,
                                 const char *name, const char **id, scree_error *error) {
  const char *path = SCREE_PATH_IN(folder, name);
  scree_path_info info;
  *id = NULL;
  if (!scree_path_look(path, &info)) return SCREE_OK;
  if (kind == SCREE_PART_PICTURE && info.byte_count > MOST_PICTURE_BYTES) return SCREE_OK;
  scree_page_part made = {.kind = kind, .path = scree_strdup(path)};
  snprintf(made.id, sizeof made.id, "part-%zu", parts->count);
  if (!made.path || !SCREE_PUSH(parts, made)) {
    scree_free(made.path);
    return scree_fail_memory(error, strlen(path), "the parts of a page");
  }
  *id = parts->items[parts->count - 1].id;
  return SCREE_OK;
}

void scree_page_parts_free(scree_page_parts *parts) {
  for (size_t i = 0; i < parts->count; i++) {
    scree_free(parts->items[i].path);
    scree_free(parts->items[i].bytes);
  }
  scree_free(parts->items);
  *parts = (scree_page_parts){0};
}

/* ---- writing ---- */

static void put_base64(FILE *stream, const char *bytes, size_t count) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const unsigned char *b = (const unsigned char *)bytes;
  for (size_t i = 0; i < count; i += 3) {
    size_t left = count - i;
    uint32_t word = (uint32_t)b[i] << 16;
    if (left > 1) word |= (uint32_t)b[i + 1] << 8;
    if (left > 2) word |= b[i + 2];
    char text[4] = {digits[word >> 18], digits[word >> 12 & 63],
                    left > 1 ? digits[word >> 6 & 63] : '=', left > 2 ? digits[word & 63] : '='};
    fwrite(text, 1, sizeof text, stream);
  }
}

static void put_part(FILE *stream, const scree_page_part *it, const void *bytes, size_t size) {
  if (it->kind == SCREE_PART_PICTURE)
    fprintf(stream, "<img id=\"%s\" alt=\"The heap\" src=\"data:image/png;base64,", it->id);
  else
    fprintf(stream, "<script type=\"text/plain\" id=\"%s\">", it->id);
  put_base64(stream, bytes, size);
  fputs(it->kind == SCREE_PART_PICTURE ? "\">\n" : "</script>\n", stream);
}

/* ---- levels ---- */

static scree_status read_levels(scree_page_parts *parts, size_t *total, scree_error *error) {
  *total = 0;
  for (size_t i = 0; i < parts->count; i++) {
    scree_page_part *it = &parts->items[i];
    if (it->kind != SCREE_PART_LEVELS) continue;
    SCREE_TRY(scree_file_read(it->path, MOST_PART_BYTES, &it->bytes, &it->size, error));
    SCREE_TRY(scree_levels_check(it->bytes, it->size, it->path, error));
    it->whole = true;
    *total += it->size;
  }
  return SCREE_OK;
}

/* The largest that still has its scan; NULL: none has. */
static scree_page_part *largest_whole(const scree_page_parts *parts) {
  scree_page_part *found = NULL;
  for (size_t i = 0; i < parts->count; i++) {
    scree_page_part *it = &parts->items[i];
    if (it->bytes && it->whole && (!found || it->size > found->size)) found = it;
  }
  return found;
}

/* Takes scans out, then levels from the last one on, until the rest fits; answers its bytes. */
static size_t fit_levels(scree_page_parts *parts, size_t total, size_t room) {
  scree_page_part *it;
  while (total > room && (it = largest_whole(parts))) {
    size_t before = it->size;
    it->size = scree_levels_drop_scan(it->bytes, it->size);
    it->whole = false;
    total -= before - it->size;
  }
  for (size_t i = parts->count; i-- > 0 && total > room;) {
    it = &parts->items[i];
    if (!it->bytes) continue;
    total -= it->size;
    scree_free(it->bytes);
    it->bytes = NULL;
  }
  return total;
}

/* ---- pictures and piles ---- */

/* Where there is room. */
static void put_fitting(const scree_page_part *it, FILE *stream, const void *bytes, size_t size,
                        size_t *room) {
  if (size > *room) return;
  put_part(stream, it, bytes, size);
  *room -= size;
}

static scree_status put_picture(const scree_page_part *it, FILE *stream, size_t *room,
                                scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  size_t size;
  SCREE_TRY(scree_file_read(it->path, MOST_PART_BYTES, &bytes, &size, error));
  put_fitting(it, stream, bytes, size, room);
  return SCREE_OK;
}

static scree_status put_pile(const scree_page_part *it, FILE *stream, size_t share, size_t *room,
                             scree_error *error) {
  SCREE_CLEANUP(scree_free_at) unsigned char *bytes = NULL;
  size_t size = 0;
  SCREE_TRY(scree_pile_pack(it->path, share, &bytes, &size, error));
  if (!bytes) return scree_fail(error, SCREE_IO, "%s: is no longer there", it->path);
  put_fitting(it, stream, bytes, size, room);
  return SCREE_OK;
}

/* Each may take its share of what those before it left. */
static scree_status put_piles(const scree_page_parts *parts, size_t left, FILE *stream,
                              size_t *room, scree_error *error) {
  for (size_t i = 0; i < parts->count && left > 0; i++) {
    if (parts->items[i].kind != SCREE_PART_PILE) continue;
    SCREE_TRY(put_pile(&parts->items[i], stream, *room / left, room, error));
    left--;
  }
  return SCREE_OK;
}

static size_t count_piles(const scree_page_parts *parts) {
  size_t count = 0;
  for (size_t i = 0; i < parts->count; i++) count += parts->items[i].kind == SCREE_PART_PILE;
  return count;
}

scree_status scree_page_parts_put(scree_page_parts *parts, FILE *stream, size_t room,
                                  scree_error *error) {
  size_t total, piles = count_piles(parts);
  size_t kept = piles < room / 2 / LEAST_PILE_BYTES ? piles * LEAST_PILE_BYTES : room / 2;
  if (piles == 0) kept = 0;
  SCREE_TRY(read_levels(parts, &total, error));
  room -= kept + fit_levels(parts, total, room - kept);
  for (size_t i = 0; i < parts->count; i++) {
    const scree_page_part *it = &parts->items[i];
    if (it->kind == SCREE_PART_PICTURE) SCREE_TRY(put_picture(it, stream, &room, error));
    if (it->bytes) put_part(stream, it, it->bytes, it->size);
  }
  room += kept;
  return put_piles(parts, piles, stream, &room, error);
}
