/* Finding one member of a zip archive, and looking at its beginning. */
#ifndef SCREE_MESH_ZIP_H
#define SCREE_MESH_ZIP_H

#include <stdbool.h>
#include <stddef.h>

typedef struct scree_zip_member {
  const unsigned char *bytes; /* as stored, inside the archive */
  size_t stored_count;
  bool is_deflated;
} scree_zip_member;

/* The member of this name, in any case of letters; false where the archive's directory is damaged,
 * the archive is cut off, or there is none. */
bool scree_zip_find(const unsigned char *bytes, size_t byte_count, const char *name,
                    scree_zip_member *member);

/* The same archive without zip64, which assimp cannot read, where it has any and does without: then
 * *narrow is to be freed with free(), else NULL. False where memory is out. For a child process, so
 * that it allocates as assimp does. */
bool scree_zip_narrow(const unsigned char *bytes, size_t byte_count, unsigned char **narrow,
                      size_t *narrow_count);

/* The first `capacity` bytes of the member, or fewer; answers how many. */
size_t scree_zip_peek(const scree_zip_member *member, char *out, size_t capacity);

#endif
