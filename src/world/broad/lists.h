/* From the keys of neighbours to all lists that a step reads, as stages (grids.h) for neighbours k
 * and bodies i. */
#pragma once

#include "world/state/world.h"

/* Ascending, without further memory. */
void scree_sort_places(uint32_t *items, size_t count);
/* Makes and counts the key of neighbours that have none. */
void scree_lists_key(scree_world *world, size_t k);
/* Sorts the keys of body i. */
void scree_lists_sort(scree_world *world, size_t i);

/* Where neighbours k were in the old list. */
void scree_lists_match(scree_world *world, size_t k);
/* Drops what the old list has and the new one has not. Those of body i give back their pairs, what
 * was entered in the balance goes to it, and the walls among them are counted; then, these are
 * written; then, what they entered in the balance goes to wall w. */
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
/* Orders the sides of body i, and finds until when its neighbours may sleep and how many are walls.
 */
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
