/* Checkpoints are written. */
#pragma once

#include "world/state/world.h"

/* A checkpoint's bytes, free with scree_free. Without its contacts a world can be looked at, and
 * not gone on with. */
scree_status scree_world_pack(const scree_world *world, bool contacts, unsigned char **bytes,
                              size_t *byte_count, scree_error *error);
/* The same within a larger file: its count of bytes, and the bytes. */
scree_status scree_world_save_block(scree_codec *codec, const scree_world *world, bool contacts,
                                    scree_error *error);
