/* What the kernels of a step and their host share beside the world. Kernels take the world
 * and this, both on the device. */
#pragma once

#include "world/broad/candidates.h"
#include "world/contact/contact.h"

/* Feature pairs of one kind are visited side by side. */
enum { SCREE_VISIT_EDGES, SCREE_VISIT_SURFACES, SCREE_VISIT_OTHERS, SCREE_VISIT_KINDS };

/* A feature pair that is to be visited: by the place of its pair among those awake, and its own
 * there. */
typedef struct scree_visit {
  uint32_t place, feature;
} scree_visit;

/* A list that is to be made, in parts of as many entries each. What a part finds is kept where it
 * is little, as mostly it is; else it is found again to be written. */
enum { SCREE_LIST_PARTS = 512, SCREE_LIST_KEPT = 4 };
typedef struct scree_new_list {
  scree_listing listing;
  uint32_t place; /* of the pair */
  uint32_t entries;
  uint32_t found[SCREE_LIST_PARTS]; /* by each part; then, by those before it */
  scree_sleeping_feature kept[SCREE_LIST_PARTS][SCREE_LIST_KEPT];
} scree_new_list;

/* A pair that asks for depths (depth.c), of which there are `count` from `first` on. */
enum { SCREE_DEPTH_PARTS = 1024, SCREE_MOST_DEPTH_JOBS = 1024 };
typedef struct scree_depth_job {
  uint32_t place;
  uint32_t count;
  uint64_t first;
} scree_depth_job;

/* How far a pair has come in a step. */
enum { SCREE_PAIR_NEW, SCREE_PAIR_LISTING, SCREE_PAIR_LISTED, SCREE_PAIR_READY, SCREE_PAIR_ASKS };

typedef struct scree_device_step {
  scree_scratch *hands; /* by place in world->workspace.awake, as is the next */
  uint8_t *progress;
  uint8_t
      *contact_counts; /* of feature pairs, by where their contacts begin in the pool of contacts */
  scree_visit *visits[SCREE_VISIT_KINDS];
  scree_new_list *new_lists;
  uint32_t new_list_capacity;
  scree_depth_job *depth_jobs;
  scree_depth *depths;
  scree_sphere_load (*sphere_loads)[2]; /* of pairs of spheres */
  uint64_t depth_capacity, depths_used;

  uint32_t awake_count, new_list_count, depth_job_count; /* in this step */
  uint32_t visit_counts[SCREE_VISIT_KINDS];
  uint32_t stop;       /* no further step before the host has looked */
  uint32_t resume;     /* the step has begun, and is gone on with */
  uint32_t too_small;  /* some pair found too little room in the pools */
  uint32_t again;      /* there were more lists to be made than places for them */
  uint32_t stale;      /* the neighbours hold no longer */
  uint32_t fallen;     /* some body was below the floor, and is removed */
  uint32_t parted;     /* some joint's state changed */
  uint32_t offender;   /* first body that would move too far, or scree_none */
  scree_tally tally;   /* of pairs: of this step; depenetrations of all */
  double last_overlap; /* of the last step that is done */
  uint64_t list_builds, evaluations;
  uint64_t done, wanted; /* steps */
} scree_device_step;

/* In the order of a step, with a thread for each: */
#define SCREE_KERNELS(X)                                                                           \
  X(awake)          /* of the neighbours */                                                        \
  X(relate)         /* pair that is awake */                                                       \
  X(list_count)     /* part of a list that ended   */                                              \
  X(list_place)     /* such list */                                                                \
  X(list_write)     /* part of it */                                                               \
  X(list_end)       /* list */                                                                     \
  X(visit)          /* feature pair that is awake */                                               \
  X(meet)           /* pair */                                                                     \
  X(depth)          /* edge or point of a pair that asks for depths */                             \
  X(contact_law)    /* pair */                                                                     \
  X(spheres_load)   /* sphere */                                                                   \
  X(spheres)        /* pair of spheres */                                                          \
  X(spheres_gather) /* sphere */                                                                   \
  X(joints)         /* joint */                                                                    \
  X(gather)         /* body */                                                                     \
  X(advance)        /* body or wall */                                                             \
  X(end)            /* step */

/* In the order of a broad phase (grids.h, lists.h). Of each list of lists first the sums of chunks,
 * then the places. */
#define SCREE_BROAD_KERNELS(X)                                                                     \
  X(box)           /* of the bodies */                                                             \
  X(grids)         /* once */                                                                      \
  X(cell)          /* body */                                                                      \
  X(bucket_sums)   /* chunk of buckets */                                                          \
  X(bucket_places) /* chunk */                                                                     \
  X(bin)           /* body */                                                                      \
  X(find)          /* body */                                                                      \
  X(key_sums)      /* chunk of bodies */                                                           \
  X(key_places)    /* chunk */                                                                     \
  X(key_write)     /* body */                                                                      \
  X(key_sort)      /* body */                                                                      \
  X(match)         /* neighbours */                                                                \
  X(drop)          /* body of the old list */                                                      \
  X(left_sums)     /* chunk of those */                                                            \
  X(left_places)   /* chunk */                                                                     \
  X(leave)         /* body of the old list */                                                      \
  X(leave_wall)    /* wall */                                                                      \
  X(carry)         /* neighbours */                                                                \
  X(renew)         /* neighbours */                                                                \
  X(side_count)    /* neighbours */                                                                \
  X(side_sums)     /* chunk of bodies */                                                           \
  X(side_places)   /* chunk */                                                                     \
  X(side)          /* neighbours */                                                                \
  X(list_body)     /* body */                                                                      \
  X(wall_sums)     /* chunk of bodies */                                                           \
  X(wall_places)   /* chunk */                                                                     \
  X(list_walls)    /* body */                                                                      \
  X(list_touching) /* 64 neighbours */                                                             \
  X(list_date)     /* body, and all walls */

/* For whoever looks at a world between steps, or has changed it. */
#define SCREE_OBSERVE_KERNELS(X)                                                                   \
  X(sums)           /* of the parts of an observation */                                           \
  X(wall_forces)    /* wall */                                                                     \
  X(wall_threshold) /* wall */
