/* What stands in the report's page as base64, behind the data that name it: levels, piles,
 * pictures. Together they keep to a number of bytes: what does not fit is made smaller, then left
 * out, and the script says so of an id that it does not find. */
#pragma once

#include "base/error.h"

typedef enum scree_part_kind {
  SCREE_PART_LEVELS,
  SCREE_PART_PILE,
  SCREE_PART_PICTURE, /* where there is no WebGL; at most 1.3 MB */
} scree_part_kind;

typedef struct scree_page_part {
  scree_part_kind kind;
  char *path;
  char id[24];
  char *bytes; /* of levels, once read; NULL: left out */
  size_t size;
  bool whole; /* of levels: with the scan */
} scree_page_part;

typedef struct scree_page_parts {
  scree_page_part *items;
  size_t count, capacity;
} scree_page_parts;

/* Notes folder/name where it exists; *id is then what it is called in the page, the parts' own and
 * good until the next call, else NULL. */
scree_status scree_page_part_add(scree_page_parts *parts, scree_part_kind kind, const char *folder,
                                 const char *name, const char **id, scree_error *error);
/* Writes them in at most `room` bytes before base64: levels first, the largest without their scans
 * where they are too many; pictures; piles share what is left and lose moments. */
scree_status scree_page_parts_put(scree_page_parts *parts, FILE *stream, size_t room,
                                  scree_error *error);
void scree_page_parts_free(scree_page_parts *parts);

/* The page's script in pieces, NULL behind the last. */
extern const char *const scree_page_script[];

/* Whether the bytes are a file of levels (docs/reference/formats.md), whole: scree_levels_write
 * writes it, the page takes it as it is, and web/src/levels.js reads it; name goes into the
 * sentence where not. */
scree_status scree_levels_check(const char *bytes, size_t byte_count, const char *name,
                                scree_error *error);

/* Takes the scan out of such a file, so that the fine level stands in for it: in place. Answers the
 * bytes that are left; all of them where the file is not as scree_levels_write makes it. */
size_t scree_levels_drop_scan(char *bytes, size_t byte_count);

/* Packs the last frame of a run, or the world (.world) that a pour left, and what motion.scree
 * beside it tells of it (docs/reference/formats.md) into at most byte_limit bytes, where the shapes
 * and one frame fit, leaving out frames; *bytes is NULL where path does not exist. Free it with
 * scree_free.
 */
scree_status scree_pile_pack(const char *path, size_t byte_limit, unsigned char **bytes,
                             size_t *byte_count, scree_error *error);
