/* Which runs a study has. Run r is point r mod P in replicate r / P, so that every point has its
 * first replicate before any has its second; its seed is the study's plus the replicate's number:
 * one run can be repeated by `seed` alone, more replicates leave the earlier ones as they were, and
 * the same seeds at all points only matter before the first contact. */
#include "base/file.h"
#include "study/study.h"

#include <stdlib.h>
#include <string.h>

bool scree_study_is_own(const scree_study *study, const char *key) {
  return study->own_shapes && (!strcmp(key, "rp") || !strcmp(key, "shapes"));
}

size_t scree_study_run_count(const scree_study *study) {
  return study->point_count * study->replicate_count;
}

uint64_t scree_study_run_seed(const scree_study *study, size_t run) {
  const scree_study_point *point = &study->points[scree_study_run_point(study, run)];
  uint64_t seed = study->seed;
  for (size_t f = 0; f < study->factor_count; f++)
    if (!strcmp(study->factors[f].key, "seed")) seed = strtoull(point->values[f], NULL, 10);
  return seed + scree_study_run_replicate(study, run);
}

void scree_study_answers_mark(const scree_study *study, char mark[SCREE_CHECKSUM_TEXT]) {
  scree_checksum sum = {0};
  for (size_t i = 0; i < study->answer_count; i++) {
    const char *name = study->answers[i].name;
    scree_checksum next = scree_checksum_of(name, strlen(name));
    const uint64_t both[4] = {sum.high, sum.low, next.high, next.low};
    sum = scree_checksum_of(both, sizeof both);
  }
  scree_checksum_text(sum, mark);
}
