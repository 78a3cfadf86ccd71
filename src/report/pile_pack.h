/* The pile of a run for the report's page: its shapes, and where its bodies were. */
#ifndef SCREE_REPORT_PILE_PACK_H
#define SCREE_REPORT_PILE_PACK_H

#include "base/error.h"

/* Packs last.scree of a run's folder and what motion.scree tells of it (docs/formats.md) into at
 * most byte_limit bytes, where the shapes and one frame fit, leaving out frames; *bytes is NULL
 * where the folder has no last.scree. Free it with scree_free. */
scree_status scree_pile_pack(const char *folder, size_t byte_limit, unsigned char **bytes,
                             size_t *byte_count, scree_error *error);

#endif
