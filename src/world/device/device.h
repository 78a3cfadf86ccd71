/* What the kernels of a step and their host share beside the world: what one launch tells the next,
 * and the host. Kernels take the world and this, both on the device. */
#ifndef SCREE_WORLD_DEVICE_DEVICE_H
#define SCREE_WORLD_DEVICE_DEVICE_H

#include "world/contact.h"

typedef struct scree_device_step {
  uint32_t *counts;      /* of awake neighbours, by block; they lie in world->awake */
  uint8_t *done;         /* by place in world->awake */
  scree_pair_work *work; /* likewise */
  uint32_t too_small;    /* some found too little room: evaluate again */
  uint32_t fallen;       /* some body was below the floor, and is removed */
  uint32_t offender;     /* first body that would move too far, or scree_none */
  scree_pair_sums sums;  /* of all pairs */
} scree_device_step;

/* In the order of a step. */
#define SCREE_KERNELS(X)                                                                           \
  X(awake)    /* a thread for each block of neighbours */                                          \
  X(evaluate) /* for each place of awake ones */                                                   \
  X(settle)   /* for each block */                                                                 \
  X(combine)  /* one */                                                                            \
  X(gather)   /* for each body */                                                                  \
  X(book)     /* one */                                                                            \
  X(advance)  /* for each body */

#endif
