/* The pile of a run or a pour for the report's page: its shapes, and where its bodies were. */
#pragma once

#include "base/error.h"

/* Packs the last frame of a run, or the world (.world) that a pour left, and what motion.scree
 * beside it tells of it (docs/reference/formats.md) into at most byte_limit bytes, where the shapes
 * and one frame fit, leaving out frames; *bytes is NULL where path does not exist. Free it with
 * scree_free.
 */
scree_status scree_pile_pack(const char *path, size_t byte_limit, unsigned char **bytes,
                             size_t *byte_count, scree_error *error);
