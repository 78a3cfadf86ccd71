/* Checkpoints, and the last good state of a run that fails. */
#pragma once

#include "world/state/world.h"

/* load.c: the reverse of scree_world_pack and scree_world_save_block, `name` for messages. */
scree_status scree_world_load_block(scree_codec *codec, const char *name, scree_world **world,
                                    scree_error *error);
scree_status scree_world_unpack(const unsigned char *bytes, size_t byte_count, const char *name,
                                scree_world **world, scree_error *error);

/* keep.c: scree_world_keep for what stands around the world, which outlives it. */
scree_status scree_world_keep_all(scree_world *world, const char *path, uint64_t step_interval,
                                  scree_packer *pack, const void *what, scree_error *error);
/* Steps until a state is to be kept; 0: now. */
size_t scree_world_steps_to_keep(const scree_world *world);
/* Packs the state; after a failure writes what was packed last,
 * and says so in world->failure. */
scree_status scree_world_keep_state(scree_world *world, scree_error *error);
void scree_world_write_kept(scree_world *world);
