/* The broad phase of a world whose state is on a device. Nothing but counts comes back. */
#pragma once

#include "world/device/cuda_driver.h"

/* Where the world is on the device. */
typedef struct scree_cuda_place {
  const scree_cuda_queue *queue;
  scree_device_address world, worlds; /* a list of it alone */
  scree_world *image;                 /* the device's struct, with its pointers */
  /* The memory of an array of the world, by where its pointer is in the struct. */
  scree_cuda_block *(*array)(scree_world *world, size_t field);
} scree_cuda_place;

typedef struct scree_cuda_broad scree_cuda_broad; /* what the broad phase has there of its own */

/* A field of the device's world, where it is not as it is there. */
scree_status scree_cuda_broad_tell(const scree_cuda_place *place, size_t field, const void *value,
                                   size_t size, scree_error *error);
/* Before scree_cuda_broad_send makes room for more bodies: where those of the list are comes here.
 */
scree_status scree_cuda_broad_keep(const scree_cuda_broad *broad, scree_world *world,
                                   const scree_cuda_place *place, scree_error *error);
/* After the world's arrays were written: what the next list is compared with. Makes *broad, when it
 * is NULL, and answers where the device's scree_broad is. */
scree_status scree_cuda_broad_send(scree_cuda_broad **broad, scree_world *world,
                                   const scree_cuda_place *place, scree_device_address *at,
                                   scree_error *error);
/* Finds who is near whom, which says how many neighbours there will be. */
scree_status scree_cuda_broad_find(scree_cuda_broad *broad, scree_world *world,
                                   const scree_cuda_place *place, size_t *count,
                                   scree_error *error);
/* Then makes so many, and all lists that follow from them. */
scree_status scree_cuda_broad_list(scree_cuda_broad *broad, scree_world *world,
                                   const scree_cuda_place *place, size_t count, scree_error *error);
void scree_cuda_broad_free(scree_cuda_broad *broad);
