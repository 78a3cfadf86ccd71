/* The stages of a step, each for one of many independent elements. The loops of step.c and
 * integrate.c call them on the processor's threads, the kernels of device/ on a device's: one code,
 * the same bits. */
#pragma once

#include "world/state/scratch.h"

enum { SCREE_PAIR_BLOCK = 128 }; /* neighbours: whole words of list.touching */

/* step.c: whether neighbours k are awake or have come to their threshold. */
bool scree_is_awake(const scree_world *world, size_t k);
/* Whether neighbours k, which are awake, are spheres apart; then they sleep. */
bool scree_needs_no_pair(scree_world *world, uint32_t k);
/* The pair of neighbours k, which may be one that begins; scree_none when there is no spare one. */
uint32_t scree_pair_at(scree_world *world, uint32_t k);
/* After its evaluation: whether the pair is given back. */
bool scree_settle_pair(scree_world *world, const scree_pair *pair);
void scree_balance_add(scree_balance *balance, const scree_pair_work *work);
/* Pairs may be noted in any order, and several at once. How deep the first pair that overlaps from
 * the start does is left to the caller. */
void scree_note_pair(scree_world *world, scree_tally *tally, const scree_pair *pair,
                     const scree_pair_work *work);
/* Of a pair that touches, and of which there is nothing else to note. */
void scree_note_overlap(scree_tally *tally, double overlap);
/* spheres.c: all contacts of spheres. */
void scree_step_spheres(scree_world *world);
/* 0 where none overlaps. */
double scree_largest_overlap(const scree_tally *tally);

static const scree_trouble scree_no_trouble = {scree_none, scree_none, scree_none, scree_none, 0};
static inline bool scree_is_trouble(const scree_trouble *trouble) {
  return (trouble->start & trouble->pressed & trouble->too_fast & trouble->passed) != scree_none;
}
/* The whole of a step. */
scree_status scree_take_step(scree_world *world);
/* joints.c: a joint's force, and whether its state changed; of all, and what comes of breaks. */
bool scree_joint_step(scree_world *world, size_t joint);
void scree_joints_evaluate(scree_world *world);
/* time_step.c */
double scree_world_choose_time_step(const scree_world *world, char reason[256]);
/* describe.c: a sentence in world->failure. */
scree_status scree_describe_trouble(scree_world *world, const scree_trouble *trouble);
/* Room for the blocks' results. */
scree_status scree_reserve_blocks(scree_world *world, scree_error *error);

/* integrate.c: the forces on body i, and how far it will move; false where that is too far. */
bool scree_gather_body(scree_world *world, size_t i);
/* Kick, turn and drift. */
void scree_advance_body(scree_world *world, size_t i);
/* For a body that scree_gather_body refused: a sentence in world->failure. */
scree_status scree_describe_offender(scree_world *world, size_t i);
