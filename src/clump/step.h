/* One Gauss-Newton step of all spheres of a clump. */
#pragma once

#include "clump/exposed.h"
#include "clump/field.h"
#include "clump/overlap.h"

/* What one sphere adds to a step: 4 unknowns, its centre and radius. */
typedef struct scree_normal_equations {
  double curvature[4][4];           /* lower triangle; its Cholesky factor once solved */
  double gradient[4];               /* of the objective */
  double slopes[SCREE_MOMENTS][4];  /* of the union's moments */
  double moments[SCREE_MOMENTS];    /* its share of the union's */
  double answers[SCREE_MOMENTS][4]; /* curvature^-1 slopes */
} scree_normal_equations;

/* What moves spheres: the body's field, and scratch. */
typedef struct scree_mover {
  const scree_target *body;
  const scree_distance_field *field;
  double tolerance[SCREE_MOMENTS]; /* how far the union's moments may be from the body's */
  double most_outside;             /* no sphere stands out of the body by more; INFINITY: any */
  scree_directions directions;
  scree_normal_equations *equations; /* SCREE_MOST_SPHERES */
} scree_mover;

scree_status scree_mover_make(const scree_target *body, const scree_distance_field *field,
                              scree_mover *mover, scree_error *error);
void scree_mover_free(scree_mover *mover);

typedef struct scree_step {
  double softness;            /* distance from the surface over which the objective turns */
  double damping;             /* share of the Newton step that is taken */
  double outside;             /* weight of what is outside against what is missing inside */
  double hold;                /* share of the moments' errors that is corrected; 0: none held */
  size_t held;                /* the first so many moments */
  bool restore;               /* move for the moments alone, as little as will do */
  const double *moments;      /* of the union, where they were measured; NULL: from its surface */
  bool active[SCREE_MOMENTS]; /* which were out of tolerance in this or an earlier step */
} scree_step;

void scree_mover_step(scree_mover *mover, scree_sphere *spheres, size_t count, scree_step *step);
