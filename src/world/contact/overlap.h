/* The pair's overlap: a smooth maximum of those of its features. */
#pragma once

#include "world/state/scratch.h"

/* The smooth maximum m of overlaps, t, and the denominator of the contact weights (law.c). */
typedef struct scree_smooth_maximum {
  double value, cutoff, denominator;
} scree_smooth_maximum;
/* From the overlaps and tapers of contacts; false when the pair does not touch. */
bool scree_solve_smooth_maximum(const scree_contact_point *contacts, size_t count, double l0,
                                double kappa, scree_smooth_maximum *result);
/* The pair's, blended more widely where its spring hardens. */
bool scree_find_smooth_maximum(const scree_pair_law *law, double kappa,
                               const scree_contact_list *contacts, scree_smooth_maximum *result);
