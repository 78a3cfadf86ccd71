/* Finding a member of a zip archive and reading it. */
#pragma once

#include "base/error.h"

typedef struct scree_zip_member {
  const unsigned char *bytes; /* as stored, inside the archive */
  size_t stored_count;
  uint32_t crc; /* of the content, as the archive says */
  bool is_deflated;
} scree_zip_member;

/* The member of this name, in any case of letters; false where the archive's directory is damaged,
 * the archive is cut off, or there is none. */
bool scree_zip_find(const unsigned char *bytes, size_t byte_count, const char *name,
                    scree_zip_member *member);

/* Is given the content piece by piece; false ends it. */
typedef bool scree_zip_taker(void *context, const unsigned char *bytes, size_t count, bool is_last);
/* SCREE_BAD_FILE where the member is damaged (by its CRC-32 too) or take answered false;
 * SCREE_OUT_OF_MEMORY. */
scree_status scree_zip_stream(const scree_zip_member *member, scree_zip_taker *take, void *context);
