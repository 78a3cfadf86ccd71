/* The broad phase's own arrays, and its stages for one of many independent elements. The loops of
 * broad.c call them on the processor, the kernels of device/ on a device: one code, the same bits.
 * Threads meet only at counters and largest values; what is listed in the order in which they came
 * is sorted. */
#pragma once

#include "base/atomic.h"
#include "world/state/world.h"

#include <stddef.h>

/* Lists of lists: `count` says how many each owner has, adding up where those of each begin;
 * writers take places by counting down again. */
typedef struct scree_groups {
  uint32_t *count; /* of `length` owners */
  uint32_t *begin; /* of theirs, and in begin[length] the end of all */
  uint64_t *sums;  /* of chunks */
  size_t length, chunk;
  uint64_t total;
} scree_groups;

/* At least one, which says that there are none. */
static inline size_t scree_groups_chunks(const scree_groups *groups) {
  return groups->length > groups->chunk ? (groups->length - 1) / groups->chunk + 1 : 1;
}
/* Sums one chunk; then, when all chunks have their sums, finds the places of its owners. */
static inline void scree_groups_sum(const scree_groups *groups, size_t chunk) {
  size_t begin = chunk * groups->chunk, end = begin + groups->chunk;
  uint64_t sum = 0;
  for (size_t i = begin; i < end && i < groups->length; i++) sum += groups->count[i];
  groups->sums[chunk] = sum;
}
static inline void scree_groups_place(scree_groups *groups, size_t chunk) {
  size_t begin = chunk * groups->chunk, end = begin + groups->chunk;
  uint64_t sum = 0;
  for (size_t c = 0; c < chunk; c++) sum += groups->sums[c];
  for (size_t i = begin; i < end && i < groups->length; i++) {
    groups->begin[i] = (uint32_t)sum;
    sum += groups->count[i];
  }
  if (end < groups->length) return;
  groups->begin[groups->length] = (uint32_t)sum;
  groups->total = sum;
}

/* A place among those of the owner that nobody else gets. */
static inline uint32_t scree_groups_take(const scree_groups *groups, size_t owner) {
  return groups->begin[owner] + scree_atomic_add(&groups->count[owner], UINT32_MAX) - 1;
}

enum { SCREE_MOST_NEIGHBOURS = INT32_MAX }; /* sides are numbers of 32 bits */
enum { SCREE_MOST_GRIDS = 32, SCREE_FOUND = 16 };

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
  uint64_t
      *wall_gap; /* bits, turned, of how far the nearest body is that is not near it; 0: none */
  scree_groups buckets; /* of cells, by hash */
  scree_cell_entry *binned;
  uint32_t *found; /* the first SCREE_FOUND partners that each body finds; walls with a bit more */
  uint32_t *found_count; /* of all */
  scree_groups spheres;  /* pairs by their first places */
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
  scree_groups sides, walls; /* of each body: places in list.sides, neighbours that are walls */
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
/* All walls, when the bodies near them are known. */
void scree_grids_widen_walls(scree_world *world);
