#include "world/state/remote.h"
#include "world/state/walls.h"

scree_status scree_world_bring(const scree_world *world, unsigned parts, scree_error *error) {
  struct scree_device_world *there = world->residence.on_device;
  return there ? world->residence.remote->bring(there, parts, error) : SCREE_OK;
}

scree_status scree_world_change(scree_world *world, unsigned parts, scree_error *error) {
  bool settle =
      parts & (SCREE_PART_WALLS | SCREE_PART_LISTS); /* forces on walls follow from them */
  SCREE_TRY(scree_world_bring(world, parts | (settle ? SCREE_PART_WALLS : 0), error));
  if (settle) scree_walls_settle(world);
  if (world->residence.on_device)
    world->residence.remote->change(world->residence.on_device, parts);
  return SCREE_OK;
}
