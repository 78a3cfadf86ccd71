/* The last good state of a run that fails: a checkpoint in memory, made anew every so many steps
 * and written when a step leaves the model's range, finds no memory or loses its device. It is
 * older than the failure, since the failing step has already changed the contacts' memory; being
 * exact, it leads there again. */
#include "world/state/save.h"
#include "world/step/checkpoint.h"

#include "base/alloc.h"
#include "base/seal.h"

#include <string.h>

scree_status scree_world_keep_all(scree_world *world, const char *path, uint64_t step_interval,
                                  scree_packer *pack, const void *what, scree_error *error) {
  if (path && step_interval == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: a state kept every 0 steps; at least 1");
  char *copy = path ? scree_strdup(path) : NULL;
  if (path && !copy) return scree_fail_memory(error, strlen(path), "a file name");
  scree_free(world->kept.path);
  scree_free(world->kept.bytes);
  memset(&world->kept, 0, sizeof world->kept);
  world->kept.path = copy;
  world->kept.interval = step_interval;
  world->kept.pack = pack;
  world->kept.what = what;
  return SCREE_OK;
}

static scree_status pack_world(const void *world, unsigned char **bytes, size_t *byte_count,
                               scree_error *error) {
  return scree_world_pack(world, true, bytes, byte_count, error);
}

scree_status scree_world_keep(scree_world *world, const char *path, uint64_t step_interval,
                              scree_error *error) {
  return scree_world_keep_all(world, path, step_interval, pack_world, world, error);
}

size_t scree_world_steps_to_keep(const scree_world *world) {
  if (!world->kept.path) return SIZE_MAX;
  uint64_t since = world->step_count - world->kept.step, interval = world->kept.interval;
  return world->kept.bytes && since < interval ? (size_t)(interval - since) : 0;
}

scree_status scree_world_keep_state(scree_world *world, scree_error *error) {
  unsigned char *bytes;
  size_t count;
  SCREE_TRY(world->kept.pack(world->kept.what, &bytes, &count, error));
  scree_free(world->kept.bytes);
  world->kept.bytes = bytes;
  world->kept.byte_count = count;
  world->kept.step = world->step_count;
  return SCREE_OK;
}

void scree_world_write_kept(scree_world *world) {
  if (!world->kept.bytes) return;
  scree_error error;
  char *message = world->failure.message;
  size_t used = strlen(message), left = sizeof world->failure.message - used;
  if (scree_seal_write(world->kept.bytes, world->kept.byte_count, world->kept.path, true, &error) ==
      SCREE_OK)
    snprintf(message + used, left, "; the state of step %llu is in %s",
             (unsigned long long)world->kept.step, world->kept.path);
  else
    snprintf(message + used, left, "; its checkpoint could not be written: %.300s", error.message);
  scree_free(world->kept.bytes); /* once */
  world->kept.bytes = NULL;
}
