/* Pairs of two spheres, or of a sphere and a plane, disc or cylinder. */
#pragma once

#include "world/contact.h"

/* Whether neighbours are such. */
bool scree_are_spheres(const scree_world *world, const scree_neighbours *neighbours);
/* Neighbours k have no pair: whether they need none in this step, being apart; then they sleep. */
bool scree_spheres_stay_apart(scree_world *world, size_t k);
/* The whole of a pair's step, as scree_pair_evaluate; `contact` (may be NULL) is what touches. */
void scree_spheres_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                            scree_contact_point *contact);
