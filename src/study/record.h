/* The result of one run as a file: what the database is made from. */
#pragma once

#include "study/study.h"

typedef struct scree_record_costs {
  double time_step; /* s */
  uint64_t step_count, particle_steps;
  double wall_seconds, processor_seconds;
  uint64_t piece_count;
  double largest_overlap; /* m */
} scree_record_costs;

/* Of a scene with a pile its heap; else NaN. */
typedef struct scree_record_result {
  scree_repose repose;
  uint64_t body_count, left_count; /* in the heap, or inside; and not */
  double packing_fraction, coordination;
  double particle_size, kinetic, time; /* m, J, s */
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

/* Its fields, which file and database have alike. */
typedef struct scree_record_field {
  const char *key;
  enum { SCREE_RECORD_REAL, SCREE_RECORD_WHOLE, SCREE_RECORD_FLAG, SCREE_RECORD_TEXT } kind;
  size_t offset, size;
} scree_record_field;
/* The database has those between the first and the last. A run that failed has but some. */
enum { SCREE_RECORD_FIELDS = 35, SCREE_RECORD_OF_FAILED = 8 };
extern const scree_record_field scree_record_fields[SCREE_RECORD_FIELDS];
/* Numbers of a row of the series; the column of the scene that each is, * being its pile. */
typedef struct scree_record_column {
  const char *key, *of_scene;
  size_t offset;
} scree_record_column;
enum { SCREE_RECORD_COLUMNS = 11 };
extern const scree_record_column scree_record_columns[SCREE_RECORD_COLUMNS];
static inline double *scree_record_number(scree_record_point *point, size_t column) {
  return (double *)(void *)((char *)point + scree_record_columns[column].offset);
}

/* Which answers the study asks for. They are not among what names a run: other answers go on with
 * the runs that were made, and take theirs from what these left. */
void scree_study_answers_mark(const scree_study *study, char mark[SCREE_CHECKSUM_TEXT]);

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

/* Of a run without a pile: no number is known. */
scree_record_result scree_no_result(void);

/* FOLDER/results/KEY.yaml, which is JSON too. */
scree_status scree_study_record_write(const scree_study_record *record, const char *path,
                                      scree_error *error);
/* SCREE_BAD_FILE for what is no record. Free with scree_study_record_free. */
scree_status scree_study_record_read(const char *path, scree_study_record *record,
                                     scree_error *error);
void scree_study_record_free(scree_study_record *record);
