/* Neighbours and pairs: how they begin and end, and where their lists lie. */
#pragma once

#include "world/state/world.h"

void scree_bodies_free(scree_world *world);
/* As scree_world_remove_body, in a step. */
void scree_body_remove(scree_world *world, size_t index);
/* bodies.c: room for forces on bodies, none at first. */
scree_status scree_bodies_make_applied(scree_bodies *bodies, scree_error *error);
/* Whether neighbours were ever made of it. */
bool scree_body_has_neighbours(const scree_world *world, size_t body);
/* After a jump: the body's contacts start anew. */
void scree_body_forget(scree_world *world, size_t body);
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

/* pool.c */

/* The lists packed in the order of their owners, with room for `extra` more, and for as much again.
 * False when memory is out; nothing has moved then. */
bool scree_pack_features(scree_pools *pools, scree_pair *pairs, size_t count, size_t extra);
bool scree_pack_sleeping(scree_pools *pools, scree_neighbours *neighbours, size_t count);
/* The pools that were asked for more than they have grow; false when memory is out. */
bool scree_pools_grow(scree_pools *pools, scree_pair *pairs, size_t pair_count,
                      scree_neighbours *neighbours, size_t neighbour_count);
void scree_pools_free(scree_pools *pools);
