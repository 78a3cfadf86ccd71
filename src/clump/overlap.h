/* The union of spheres against the body, along lines: moments, IoU, and what each sphere alone
 * covers. */
#pragma once

#include "clump/lines.h"

/* A stretch of a line within a sphere. */
typedef struct scree_chord {
  double low, high;
  uint32_t sphere;
} scree_chord;

/* Lines over the body and a rim around it, and scratch for the spheres' chords. */
typedef struct scree_ruler {
  const scree_target *body;
  scree_lines lines;
  uint32_t *count, *next; /* by line */
  scree_chord *chords;
  size_t chord_capacity;
  bool failed; /* memory ran out: what was measured since is worth nothing */
} scree_ruler;

/* What only one sphere covers: volume within the body, and outside. */
typedef struct scree_alone {
  double inside, outside;
} scree_alone;

typedef struct scree_overlap {
  double iou;                    /* of union and body */
  double common;                 /* volume of their intersection */
  double moments[SCREE_MOMENTS]; /* of the union */
} scree_overlap;

/* No sphere of a clump is larger (one of the body's volume has 0.62), nor has its centre outside
 * the body's box: so the lines reach around all. */
#define SCREE_LARGEST_SPHERE 0.7

/* To be freed also where it fails. */
scree_status scree_ruler_make(const scree_target *body, scree_ruler *ruler, scree_error *error);
void scree_ruler_free(scree_ruler *ruler);

/* alone: as many as spheres, or NULL. */
scree_overlap scree_ruler_measure(scree_ruler *ruler, const scree_sphere *spheres, size_t count,
                                  scree_alone *alone);

/* What IoU loses when the sphere goes. */
static inline double scree_overlap_loss(const scree_overlap *o, const scree_alone *a) {
  double common = o->common - a->inside;
  return o->iou - common / (1 + o->moments[0] - a->inside - a->outside - common);
}
