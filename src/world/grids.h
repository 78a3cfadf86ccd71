/* The broad phase's own arrays, and its stages for one of many independent elements. The loops of
 * broad.c call them on the processor, the kernels of device/ on a device: one code, the same bits.
 * Threads meet only at counters and largest values; what is listed in the order in which they came
 * is sorted. */
#pragma once

#include "world/groups.h"
#include "world/world.h"

enum { SCREE_MOST_NEIGHBOURS = INT32_MAX }; /* sides are numbers of 32 bits */
enum { SCREE_MOST_GRIDS = 32, SCREE_FOUND = 16 };
static const uint32_t scree_wall_partner = 0x80000000u; /* of a wall's number */

typedef struct scree_cell {
  int32_t x, y, z;
  uint32_t grid; /* 0: the coarsest */
} scree_cell;

typedef struct scree_cell_entry {
  scree_cell at;
  uint32_t body;
} scree_cell_entry;

struct scree_broad {
  uint64_t widest; /* bits of the widest side of a box */
  double width[SCREE_MOST_GRIDS];
  uint32_t used; /* a bit for each grid that holds a body */
  size_t capacity, wall_capacity, bucket_count;
  scree_box *boxes; /* of the bodies, grown by half the margin */
  scree_cell *cells;
  uint64_t *wall_reach; /* bits of how far from each wall the farthest point of a body may be */
  scree_groups buckets; /* of cells, by hash */
  scree_cell_entry *binned;
  uint32_t *found; /* the first SCREE_FOUND partners that each body finds; walls with a bit more */
  uint32_t *found_count; /* of all */
  scree_groups listed;   /* keys of each body that comes first in them */
  uint64_t *old_keys;    /* what was listed before, and where those of the bodies of then begin */
  size_t old_key_capacity, old_bodies;
  uint32_t *old_begin;
  struct {
    uint32_t *items; /* where those listed were in the old list; scree_none: nowhere */
    size_t capacity;
  } match;
  scree_groups left; /* walls that each body is no longer near */
  struct {
    uint32_t *items; /* old neighbours */
    size_t capacity;
  } left_features;
  scree_groups sides, walls; /* of each body: places in world->sides, neighbours that are walls */
  /* Where the old ones are; here they are moved in place, on a device to other memory. */
  scree_neighbours *old_neighbours;
  uint32_t *old_pair_of;
  scree_balance *old_ledger;
};

/* Until they are over: of body i its box, the widest one, and how far the walls must reach. */
void scree_grids_box(scree_world *world, size_t i);
/* Once: the grids' widths; slack and reach of walls. */
void scree_grids_begin(scree_world *world, size_t i);
/* The cell of body i, and how many its bucket has; then, its place in the bucket. */
void scree_grids_cell(scree_world *world, size_t i);
void scree_grids_bin(scree_world *world, size_t i);
/* The partners that body i finds: counted, for whoever comes first; then, written. */
void scree_grids_find(scree_world *world, size_t i);
void scree_grids_write(scree_world *world, size_t i);
