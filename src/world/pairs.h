/* Neighbours and pairs: how they begin and end, and where their lists lie. */
#pragma once

#include "world/world.h"

#include "world/contact.h"

/* pair.c: neighbours a and b, new and set up. */
scree_neighbours scree_neighbours_new(const scree_world *world, uint32_t a, uint32_t b, bool wall);
/* After a change of the materials: stiffness, damping and so on of all neighbours and pairs. */
void scree_neighbours_set_up(scree_world *world);
/* world.c: room for forces on bodies, none at first. */
scree_status scree_bodies_make_applied(scree_bodies *bodies, scree_error *error);
/* Whether neighbours were ever made of it. */
bool scree_body_has_neighbours(const scree_world *world, size_t body);
/* After a jump: the body's contacts start anew. */
void scree_body_forget(scree_world *world, size_t body);
/* Half the particle's thinnest wall, m. */
double scree_thin_overlap(const scree_particle *particle);
/* As a pair of neighbours that are asleep or new; its place for feature pairs stays. */
void scree_pair_begin(scree_pair *pair, const scree_neighbours *neighbours, uint32_t index);
/* What is kept of a pair without awake feature pairs. */
void scree_pair_end(const scree_pair *pair, scree_neighbours *neighbours);
/* A spare pair, in a step by many threads at once; scree_none when there is none. */
uint32_t scree_pair_take(scree_world *world);
void scree_pair_give_back(scree_world *world, uint32_t pair);
/* More spare pairs, at least as many as a step asked for in vain; false when memory is out. */
bool scree_pairs_grow(scree_world *world);
/* Pairs lie in the order of their neighbours again, where many do not. */
void scree_pairs_tidy(scree_world *world);

/* A pair and its neighbours with pools of their own. Zeroed before the first use; free it. */
typedef struct scree_pair_copy {
  scree_pair pair;
  scree_neighbours neighbours;
  scree_pools pools;
  scree_scratch scratch;
} scree_pair_copy;
/* Of an awake pair; false when memory is out. */
bool scree_copy_pair(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy);
/* Its contact at this moment; the contacts are in the copy's scratch. False when memory is out. */
bool scree_evaluate_copy(const scree_world *world, scree_pair_copy *copy);
void scree_free_pair_copy(scree_pair_copy *copy);

/* pool.c */

/* The lists packed in the order of their owners, with room for `extra` more, and for as much again.
 * False when memory is out; nothing has moved then. */
bool scree_pack_features(scree_pools *pools, scree_pair *pairs, size_t count, size_t extra);
bool scree_pack_sleeping(scree_pools *pools, scree_neighbours *neighbours, size_t count);
/* The pools that were asked for more than they have grow; false when memory is out. */
bool scree_pools_grow(scree_pools *pools, scree_pair *pairs, size_t pair_count,
                      scree_neighbours *neighbours, size_t neighbour_count);
void scree_pools_free(scree_pools *pools);
