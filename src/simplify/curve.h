/* What curve.c builds and replay.c reads. */
#pragma once

#include "base/owned.h"
#include "simplify/record.h"

struct scree_curve {
  const scree_mesh *mesh; /* the one given, or `cut` */
  scree_mesh cut;         /* the one given with its flat fans cut anew, its positions borrowed */
  scree_collapse_record record;
  scree_curve_facts facts;
  uint32_t *counts;    /* triangles per level, NULL where every collapse takes two */
  double area, volume; /* of level 0 */
};
