/* The file of levels that the report shows (docs/reference/formats.md): written by
 * scree_levels_write, put into the page as it is, read by web/src/levels.js. */
#pragma once

#include "base/error.h"

/* Whether the bytes are such a file, whole; name goes into the sentence where not. */
scree_status scree_levels_check(const char *bytes, size_t byte_count, const char *name,
                                scree_error *error);

/* Takes the scan out of such a file, so that the fine level stands in for it: in place. Answers the
 * bytes that are left; all of them where the file is not as scree_levels_write makes it. */
size_t scree_levels_drop_scan(char *bytes, size_t byte_count);
