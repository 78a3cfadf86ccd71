/* The result of one run as a file: what the database is made from. */
#pragma once

#include "base/field.h"
#include "study/study.h"

typedef struct scree_record_costs {
  double time_step; /* s */
  uint64_t step_count, particle_steps;
  double wall_seconds, processor_seconds;
  uint64_t piece_count;
  double largest_overlap; /* m */
} scree_record_costs;

/* The heap of a scene with a pile; else NaN. */
typedef struct scree_record_result {
  scree_pile pile;
  uint64_t body_count, left_count; /* in the heap, or inside; and not */
  double coordination;
  double kinetic, time; /* J, s */
  bool still;
} scree_record_result;

/* A row of the series; NaN where the scene has no such column. */
typedef struct scree_record_point {
  double time; /* s */
  size_t phase, body_count;
  double kinetic, mean_rotation, highest_speed, largest_overlap, coordination, cylinder_height;
  double sector_deg, cone_deg, silhouette_deg, height;
} scree_record_point;

typedef struct scree_study_record {
  bool failed;
  char reason[512];
  char worker[160], machine[160], version[32];
  double started, ended; /* s since 1970 */
  double triangle_count; /* mean over the particles; 0 for spheres */
  scree_record_costs costs;
  scree_record_result result;
  char hash[40]; /* of the final state of the world */
  scree_record_point *series;
  size_t series_count;
  double *answers; /* in the order of the study that has this mark */
  size_t answer_count;
  char answered[SCREE_CHECKSUM_TEXT]; /* scree_study_answers_mark */
} scree_study_record;

/* Its fields, which file and database have alike, as X(key, member of scree_study_record, whether
 * a study tells its mean and limits for each point): a new one is unknown in records that were made
 * before. The database has those between the first and the last. A run that failed has the first
 * SCREE_RECORD_OF_FAILED. */
#define SCREE_RUN_ROWS(X)                                                                          \
  X(failed, failed, 0)                                                                             \
  X(reason, reason, 0)                                                                             \
  X(worker, worker, 0)                                                                             \
  X(machine, machine, 0)                                                                           \
  X(version, version, 0)                                                                           \
  X(started, started, 0)                                                                           \
  X(ended, ended, 0)                                                                               \
  X(triangle_count, triangle_count, 0)                                                             \
  X(time_step, costs.time_step, 0)                                                                 \
  X(step_count, costs.step_count, 0)                                                               \
  X(particle_steps, costs.particle_steps, 0)                                                       \
  X(wall_seconds, costs.wall_seconds, 0)                                                           \
  X(processor_seconds, costs.processor_seconds, 0)                                                 \
  X(piece_count, costs.piece_count, 0)                                                             \
  X(largest_overlap, costs.largest_overlap, 0)                                                     \
  X(heap, result.pile.repose.heap, 0)                                                              \
  X(heap_reason, result.pile.repose.reason, 0)                                                     \
  X(sector_deg, result.pile.repose.sector_deg, 0)                                                  \
  X(sector_sd_deg, result.pile.repose.sector_sd_deg, 0)                                            \
  X(cone_deg, result.pile.repose.cone_deg, 0)                                                      \
  X(silhouette_deg, result.pile.repose.silhouette_deg, 0)                                          \
  X(silhouette_sd_deg, result.pile.repose.silhouette_sd_deg, 0)                                    \
  X(height, result.pile.repose.height, 1)                                                          \
  X(base_radius, result.pile.repose.base_radius, 0)                                                \
  X(run_out, result.pile.repose.run_out, 1)                                                        \
  X(body_count, result.body_count, 0)                                                              \
  X(left_count, result.left_count, 0)                                                              \
  X(coordination, result.coordination, 1)                                                          \
  X(packing_fraction, result.pile.packing_fraction, 1)                                             \
  X(particle_size, result.pile.size, 0)                                                            \
  X(kinetic, result.kinetic, 0)                                                                    \
  X(time, result.time, 0)                                                                          \
  X(still, result.still, 0)                                                                        \
  X(hash, hash, 0)                                                                                 \
  X(answered, answered, 0)
#define SCREE_RECORD_ONE(...)                    +1
#define SCREE_RECORD_TELLS(key, member, is_told) +is_told
enum {
  SCREE_RECORD_FIELDS = SCREE_RUN_ROWS(SCREE_RECORD_ONE),
  SCREE_RECORD_TOLD = SCREE_RUN_ROWS(SCREE_RECORD_TELLS),
  SCREE_RECORD_OF_FAILED = 8
};
extern const scree_field scree_record_fields[SCREE_RECORD_FIELDS];
extern const bool scree_record_is_told[SCREE_RECORD_FIELDS];
/* A whole number that is not known; a real one is NaN. */
#define SCREE_UNKNOWN_COUNT UINT64_MAX
/* Numbers of a row of the series, and the column of the scene that each is, * being its pile. */
#define SCREE_SERIES_ROWS(X)                                                                       \
  X(time, "time")                                                                                  \
  X(mean_rotation, "mean_rotation")                                                                \
  X(kinetic, "kinetic")                                                                            \
  X(highest_speed, "highest_speed")                                                                \
  X(largest_overlap, "largest_overlap")                                                            \
  X(coordination, "coordination")                                                                  \
  X(cylinder_height, "cylinder.z")                                                                 \
  X(sector_deg, "*.sector_deg")                                                                    \
  X(cone_deg, "*.cone_deg")                                                                        \
  X(silhouette_deg, "*.silhouette_deg")                                                            \
  X(height, "*.height")
enum { SCREE_RECORD_COLUMNS = SCREE_SERIES_ROWS(SCREE_RECORD_ONE) };
extern const scree_field scree_record_columns[SCREE_RECORD_COLUMNS];
extern const char *const scree_record_of_scene[SCREE_RECORD_COLUMNS];
static inline double *scree_record_number(scree_record_point *point, size_t column) {
  return (double *)(void *)((char *)point + scree_record_columns[column].offset);
}

/* scene_base.c: what is kept of a scene that has ended; its answers alone. */
scree_status scree_study_record_scene(const scree_study *study, const scree_scene *scene,
                                      scree_study_record *record, scree_error *error);

scree_status scree_study_answer_scene(const scree_study *study, const scree_scene *scene,
                                      scree_study_record *record, scree_error *error);

/* command_base.c: the answers in what it printed. Runs the command, whose own files go to `folder`,
 * and keeps what it prints. watch is called a few times a second; false ends it, with
 * SCREE_CANCELLED. */
scree_status scree_study_record_command(const scree_study *study, size_t run, const char *folder,
                                        bool (*watch)(void *context), void *context,
                                        scree_study_record *record, scree_error *error);
scree_status scree_study_answer_command(const scree_study *study, const char *folder,
                                        scree_study_record *record, scree_error *error);

/* The result of a run without a pile: no number is known. */
scree_record_result scree_no_result(void);

/* FOLDER/results/KEY.yaml, which is JSON too. */
scree_status scree_study_record_write(const scree_study_record *record, const char *path,
                                      scree_error *error);
/* SCREE_BAD_FILE for what is no record. Free with scree_study_record_free. */
scree_status scree_study_record_read(const char *path, scree_study_record *record,
                                     scree_error *error);
void scree_study_record_free(scree_study_record *record);
