/* Impacts of a scene: counts, sums and spectra of the energies of contacts, by class. */
#pragma once

#include "scene/scene.h"

/* What is summed by class and by body: contacts that are over, J of approach, J dissipated, J above
 * the threshold; of bodies also the J of the largest approach. */
enum {
  SCREE_IMPACT_COUNT,
  SCREE_IMPACT_APPROACH,
  SCREE_IMPACT_NORMAL,
  SCREE_IMPACT_TANGENTIAL,
  SCREE_IMPACT_DAMAGE,
  SCREE_IMPACT_SUMS,
  SCREE_IMPACT_LARGEST = SCREE_IMPACT_SUMS,
  SCREE_IMPACT_OF_BODY
};
enum { SCREE_IMPACT_SPECTRA = 3 }; /* of approach, of normal and tangential dissipation */

struct scree_scene_impacts {
  size_t class_count, bin_count; /* the first bin is below `least`, the last from `most` on */
  double *sums;                  /* class_count x SCREE_IMPACT_SUMS */
  double *spectra;               /* counts: class_count x SCREE_IMPACT_SPECTRA x bin_count */
  double window_from;            /* s */
  struct {
    double *items; /* of those that are over: from, until (s), then as spectra */
    size_t count, capacity;
  } windows;
  struct {
    double *items; /* SCREE_IMPACT_OF_BODY of each body */
    size_t count, capacity;
  } bodies;
};

void scree_impact_class_names(const scree_scene *scene, const scree_scene_sensor *sensor,
                              size_t index, const char *names[2]);
/* J, where the bin begins; bin 0 begins at 0. */
double scree_impact_bin(const scree_plan_impacts *plan, size_t bin);
