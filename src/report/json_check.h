/* Whether bytes are one JSON text (RFC 8259), nothing more: what goes into a page must not break
 * it. Nested to SCREE_JSON_DEPTH at most. Strings are not checked for UTF-8. */
#pragma once

#include "base/error.h"

/* bytes[byte_count] must be 0 (as scree_file_read leaves it). name goes into the sentence. */
scree_status scree_json_check(const char *bytes, size_t byte_count, const char *name,
                              scree_error *error);
