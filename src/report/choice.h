/* What the texts and the figures of a choice share. */
#pragma once

#include "base/error.h"
#include "report/program.h"

#include <math.h>

/* The grid's Rp, or the level's own where the grid's was not reached. */
static inline double scree_report_pick_rp(const scree_choice *choice, const scree_pick *pick) {
  return fmax(pick->rp, (double)pick->triangle_count / (double)choice->triangle_count);
}
