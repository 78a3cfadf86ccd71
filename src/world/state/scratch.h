/* A pair in hand: what a step of it works with. */
#pragma once

#include "world/state/world.h"

/* One touching feature, in the frame of b. */
typedef struct scree_contact_point {
  vec3 at, normal; /* normal towards a */
  double overlap, taper, weight;
  double gap_gradient; /* how much the overlap falls as a moves along the normal */
  vec3 fading;         /* along which the taper falls as a moves, 1/m */
  vec3 force;          /* on a */
  bool of_depth;       /* of an edge inside: without friction or memory */
  scree_anchor *anchor;
} scree_contact_point;

typedef struct scree_contact_list {
  scree_contact_point *items;
  size_t count, capacity;
} scree_contact_list;

/* What a pair's evaluation adds to the ledger, J, and what is wrong with it. */
typedef struct scree_pair_work {
  double later_dashpot, later_tangential; /* second half of the last step */
  double dashpot, tangential;             /* first half of this */
  double lost;                            /* in the hysteretic spring */
  double let_go;                          /* by springs whose references start anew */
  double wall;                            /* of a wall on the body */
  double start_depth;                     /* in each other from the start, m; 0: none */
  double missing;                         /* scree_stiffness_missing, where hardened; else 0 */
  bool too_fast, pressed, begins_depenetration, begins_hardening, passed;
} scree_pair_work;

/* Whether a pair asks for depths: from the start; of edges that lie deeper than `above`, m; deeper
 * than `claimed` one must, else the features look the wrong way. */
typedef struct scree_depth_question {
  bool start, edges;
  double above, claimed;
} scree_depth_question;

/* How much a worker has done since the start. */
typedef struct scree_counters {
  uint64_t feature_evaluations, closest_queries, list_builds, depth_queries;
  double candidate_seconds;
} scree_counters;

/* What the visits of the awake feature pairs find. */
typedef struct scree_findings {
  double nap;        /* those that cannot touch for longer go to sleep */
  double least_gap;  /* of them all */
  uint32_t to_sleep; /* how many do */
  bool any_inside;
  scree_depth_question question;
} scree_findings;

/* The pair as it was when the step began. */
typedef struct scree_pair_before {
  scree_list_state list;
  scree_pair_wrench wrench;
  bool asleep, was_depenetrating;
} scree_pair_before;

/* A pair in hand: where its lists and its bodies are, and what is found out about it in a step. A
 * worker has one, a device one for every pair that is awake. */
struct scree_scratch {
  scree_pools *pools;
  scree_neighbours *neighbours; /* of the pair */
  scree_feature_pair *features; /* its awake ones */
  scree_further *further;
  scree_contact_list contacts;
  size_t contacts_needed; /* by a pair that found too little room */
  size_t first_contact;   /* of a device: in the pool of contacts */
  size_t first_depth;     /* likewise, among the depths that were found for it */
  scree_counters counters;
  const scree_frame *a, *b; /* where the pair's two are */
  scree_frame own[2];       /* these where they are the pair's alone */
  scree_frame relative;     /* a in the frame of b */
  double drift, step;       /* s, of their last drift and of the coming one */
  uint32_t substeps;        /* of the coming step */
  scree_findings found;
  scree_pair_before before;
  scree_pair_work work;
  double spring_work;    /* J, of the pair's spring since the last look */
  double overlap_before; /* m, at it */
  scree_anchor no_anchor;
};

/* pool.c: a larger place for the pair's feature pairs, or for the sleeping feature pairs of the
 * neighbours in hand; false where the pool has too little room. */
bool scree_grow_features(scree_scratch *scratch, scree_pair *pair, uint32_t needed);
bool scree_grow_sleeping(scree_scratch *scratch, uint32_t needed);
/* Room for the contacts of the pair in hand, which are found anew. */
bool scree_reserve_contacts(scree_scratch *scratch, size_t needed);
static inline bool scree_reserve_features(scree_scratch *scratch, scree_pair *pair,
                                          uint32_t needed) {
  return needed <= pair->active.capacity || scree_grow_features(scratch, pair, needed);
}
static inline bool scree_reserve_sleeping(scree_scratch *scratch, uint32_t needed) {
  return needed <= scratch->neighbours->sleeping.capacity || scree_grow_sleeping(scratch, needed);
}
/* Where the pair's lists are; before its evaluation. */
static inline void scree_take_in_hand(scree_scratch *s, scree_pools *pools, const scree_pair *pair,
                                      scree_neighbours *neighbours) {
  s->pools = pools;
  s->neighbours = neighbours;
  s->features = pools->features + pair->active.first;
  s->further = pools->further + pair->active.first;
}
/* The sleeping feature pairs of the neighbours in hand. */
static inline scree_sleeping_feature *scree_sleeping_features(const scree_scratch *s) {
  return s->pools->sleeping_features + s->neighbours->sleeping.first;
}
