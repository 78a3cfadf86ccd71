/* Finding a member of a zip archive and reading it. */
#pragma once

#include "base/error.h"

typedef struct scree_zip_member {
  const unsigned char *bytes; /* as stored, inside the archive */
  size_t stored_count;
  uint32_t crc; /* of the content, as the archive says */
  bool is_deflated;
} scree_zip_member;

typedef enum scree_zip_answer {
  SCREE_ZIP_FOUND,
  SCREE_ZIP_ABSENT,
  SCREE_ZIP_DAMAGED, /* or cut off */
  SCREE_ZIP_METHOD,  /* compressed by a method that is not read, or encrypted */
} scree_zip_answer;

/* The member of this name, in any case of letters. */
scree_zip_answer scree_zip_find(const unsigned char *bytes, size_t byte_count, const char *name,
                                scree_zip_member *member);
/* The name of the first member; "" where there is none, or the archive is damaged. */
enum { SCREE_ZIP_NAME = 100 };
void scree_zip_first_name(const unsigned char *bytes, size_t byte_count, char name[SCREE_ZIP_NAME]);

/* Is given the content piece by piece; false ends it. */
typedef bool scree_zip_taker(void *context, const unsigned char *bytes, size_t count, bool is_last);
/* SCREE_BAD_FILE where the member is damaged (by its CRC-32 too) or take answered false;
 * SCREE_OUT_OF_MEMORY. */
scree_status scree_zip_stream(const scree_zip_member *member, scree_zip_taker *take, void *context);
