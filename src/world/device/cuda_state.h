/* A world's state on a device: a mirror of its arrays, and a copy of its struct whose pointers lead
 * to the mirror, so that both sides run the same code on the same indices. Which parts are newest
 * where. */
#pragma once

#include "world/device/cuda_broad.h"

enum { SCREE_MOST_SPANS = 52 };

/* What the device alone has. */
enum {
  BLOCK_PARTICLES,
  BLOCK_SHAPES,
  BLOCK_WALLS,
  BLOCK_WORLD,
  BLOCK_WORLDS, /* where it is: a list of one */
  BLOCK_HANDS,
  BLOCK_PROGRESS,
  BLOCK_CONTACTS,
  BLOCK_CONTACT_COUNTS,
  BLOCK_NEW_LISTS,
  BLOCK_DEPTH_JOBS,
  BLOCK_DEPTHS,
  BLOCK_SUMS,
  BLOCK_SPHERE_LOADS,
  BLOCK_VISITS,
  BLOCK_COUNT = BLOCK_VISITS + SCREE_VISIT_KINDS
};

struct scree_device_world {
  scree_world *world;
  scree_cuda_queue queue;
  scree_cuda_block arrays[SCREE_MOST_SPANS], own[BLOCK_COUNT];
  scree_cuda_broad *broad;
  uint64_t contact_capacity, contacts_used;
  size_t awake; /* pairs in a step, about */
  scree_device_step header;
  scree_world *image;          /* the device's struct */
  const scree_particle **seen; /* walls' and bodies' particles whose shapes are on the device */
  size_t seen_count, wall_count, shape_bytes;
  scree_device_address *addresses; /* of the walls' shapes, then of the bodies' */
  bool current;                    /* the device has the state, */
  unsigned away, changed;          /* newer than here; but for parts that changed here */
  void *parked[SCREE_MOST_SPANS];  /* the world's pointers to arrays that are away; */
  scree_world_wall *walls;         /* to its walls */
  scree_world_wall *copies;        /* of the walls, on their way: nobody who looks needs memory */
  bool applied;                    /* one of them is bodies.applied */
  bool settled;                    /* forces on walls are those of the last step */
  bool listed;                     /* the neighbours were made there */
  size_t body_count;               /* for which it has room */
};

scree_cuda_place scree_cuda_place_of(struct scree_device_world *d);
/* A field of the device's struct. */
scree_status scree_cuda_tell(struct scree_device_world *d, size_t field, size_t size,
                             scree_error *error);
void scree_cuda_lead_header(const scree_world *w, struct scree_device_world *d);
/* Room for what the steps need, which follows from the neighbours. */
scree_status scree_cuda_reserve_own(const scree_world *w, struct scree_device_world *d,
                                    scree_error *error);

/* The whole state, which is here, goes there; only what changed here. */
scree_status scree_cuda_send(scree_world *w, struct scree_device_world *d, scree_error *error);
scree_status scree_cuda_send_changed(scree_world *w, struct scree_device_world *d,
                                     scree_error *error);
/* From now on all is newer there: the world's pointers to it become NULL. */
void scree_cuda_part_with(scree_world *w, struct scree_device_world *d);
/* Parts come back, as they are there. On failure the state is lost: what is here can be looked at,
 * without the neighbours; it is stepped no more. A state that was kept (keep.c) is written. */
scree_status scree_cuda_fetch(scree_world *w, struct scree_device_world *d, unsigned parts,
                              scree_error *error);
void scree_cuda_lose(scree_world *w);
/* Who is removed, after a step has removed some. */
scree_status scree_cuda_fetch_removed(scree_world *w, struct scree_device_world *d,
                                      scree_error *error);
/* Frees all but the struct itself; the world has its pointers again. */
void scree_cuda_free_state(scree_world *w, struct scree_device_world *d);
