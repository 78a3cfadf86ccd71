/* The surface once more, for what is to be tried on it or done to one level alone. */
#ifndef SCREE_SIMPLIFY_TRIAL_H
#define SCREE_SIMPLIFY_TRIAL_H

#include "simplify/step.h"

/* A decimator of its own, which has of the other one what does not change. */
typedef struct scree_trial {
  scree_decimator d;
  scree_step step;
} scree_trial;

/* Room for copies of the surface as it is, and a record of one collapse. Free it whatever the
 * outcome. */
scree_status scree_trial_allocate(scree_trial *trial, const scree_decimator *d, scree_error *error);
void scree_trial_free(scree_trial *trial);

/* Makes it a copy of the step's surface, with an empty record. */
void scree_trial_start(scree_trial *trial, const scree_step *from);
/* Makes the step's surface that of the trial. */
void scree_trial_take(const scree_trial *trial, scree_step *step);

#endif
