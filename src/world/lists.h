/* From the keys of neighbours to all lists that a step reads, as stages (grids.h) for neighbours k
 * and bodies i. */
#pragma once

#include "world/grids.h"

/* First body, then bodies before walls, then the second: neighbours are sorted by it. */
static inline uint64_t scree_key_of(uint32_t a, uint32_t b, bool wall) {
  return (uint64_t)a << 32 | (wall ? scree_wall_partner : 0) | b;
}

static inline uint32_t scree_key_second(uint64_t key) {
  return (uint32_t)key & ~scree_wall_partner;
}

/* Of neighbours that are there, whose keys are not: the key, counted. */
void scree_lists_key(scree_world *world, size_t k);
/* Sorts the keys of body i. */
void scree_lists_sort(scree_world *world, size_t i);

/* Where neighbours k were in the old list. */
void scree_lists_match(scree_world *world, size_t k);
/* Of the old list those that are listed no longer. Those of body i give back their pairs, what was
 * entered in the balance goes to it, and the walls among them are counted; then, these are written;
 * then, what they entered in the balance goes to wall w. */
void scree_lists_drop(scree_world *world, size_t i);
void scree_lists_leave(scree_world *world, size_t i);
void scree_lists_leave_wall(scree_world *world, size_t w);
/* Those that stay come to their place. */
void scree_lists_carry(scree_world *world, size_t k);
/* New ones begin; the pairs of others learn where they are. */
void scree_lists_renew(scree_world *world, size_t k);

/* Counts neighbours k among the sides of their second body; then, their sides and slot. */
void scree_lists_count(scree_world *world, size_t k);
void scree_lists_side(scree_world *world, size_t k);
/* Of body i: its sides in order, until when its neighbours may sleep, how many are walls. */
void scree_lists_body(scree_world *world, size_t i);
/* The neighbours of body i that are walls. */
void scree_lists_walls(scree_world *world, size_t i);
/* 64 neighbours' bits: who touches. */
void scree_lists_touching(scree_world *world, size_t word);
/* Once: what is told of the walls, and the counts. */
void scree_lists_end(scree_world *world, size_t i);

/* From here on the list's age counts: of body i; once, of all walls. */
void scree_lists_date(scree_world *world, size_t i);
void scree_lists_date_walls(scree_world *world, size_t i);
