/* A study: what its file says, the points and runs that follow from it, and its folder. */
#pragma once

#include "base/owned.h"
#include "base/path.h"
#include "base/schema.h"
#include "choice/criterion.h"

enum { SCREE_RUN_KEY_BYTES = 24 };

typedef struct scree_factor {
  const char *key; /* a field or a parameter of the scene; or "rp", "shapes" of the study's */
  size_t line, column;
  bool range, logarithmic; /* from `from` to `to`; else levels */
  double from, to;
  const char **levels; /* texts as in the file; of "shapes" the sets' labels */
  size_t *sets;        /* of "shapes": index of each level's set; else NULL */
  size_t level_count;
} scree_factor;

/* A shape by its word in the file, and what scree_study_prepare found. */
typedef struct scree_study_shape {
  const char *word;        /* path or sample:NAME */
  const char *path;        /* where the file is: relative to the study's file; NULL for samples */
  const char *name;        /* short and unique; also of its files */
  bool known;              /* what follows has been read from the folder */
  scree_checksum checksum; /* of the file; of a sample: of its name and options */
  uint64_t triangle_count;
  double area, volume; /* m2, m3 */
  double paper_rp, robust_rp, recommended_rp;
} scree_study_shape;

/* Shapes that a run mixes. */
typedef struct scree_shape_set {
  const char *label;
  size_t *shapes;
  size_t count;
} scree_shape_set;

typedef struct scree_study_point {
  const char **values; /* a text per factor */
  size_t set;          /* of shapes */
  const char *rp;      /* "spheres", "scan", "recommended", a multiple of it or a number */
  const char *label;   /* the factors' values; "" where there are no factors */
} scree_study_point;

typedef enum scree_design {
  SCREE_DESIGN_GRID,
  SCREE_DESIGN_LATIN,
  SCREE_DESIGN_SOBOL,
  SCREE_DESIGN_LIST /* point i has level i of every factor */
} scree_design;

/* A column of a scene's sensors: its last value, its mean or standard deviation over a window of
 * time, or its value at a time; the outline of its heap at a place; a number that a command prints.
 */
typedef struct scree_answer {
  const char *name, *column;
  const char *unit; /* NULL: not known */
  bool mean, sd, outline;
  double from, until; /* s; NaN: the sensor's */
  double at;          /* s; of an outline m; NAN: the last */
} scree_answer;

struct scree_study {
  scree_arena arena; /* all texts and arrays of the plan */
  const char *path;  /* of its file, for errors */
  const char *text;  /* the file's */
  size_t text_size;
  char *folder; /* NULL before scree_study_open */
  const char *name;
  const char *scene_text, *scene_path; /* of the base, a file's or a template's */
  bool scene_is_file;
  const char *(*settings)[2]; /* its fields that the base changes, and their values */
  size_t setting_count;
  scree_texts command; /* where the base is one: its words; else none */
  const char *here;    /* the folder of the file */
  double timeout;      /* s, of a run of the command */
  scree_answer *answers;
  size_t answer_count;
  const char **phases; /* of the scene, and the first in which something moves */
  size_t phase_count, moving_phase;
  bool has_pile, own_shapes; /* own: the study names them */
  uint64_t seed;
  size_t replicate_count, attempt_limit;
  scree_method method;
  double unit_m;
  scree_sample_options sample;
  scree_design design;
  size_t wanted_points;       /* of a design that is no grid */
  const char *analysis_angle; /* "sector", "cone" or "silhouette" */
  double margin_deg, confidence;
  scree_study_shape *shapes;
  size_t shape_count;
  scree_shape_set *sets;
  size_t set_count;
  scree_factor *factors;
  size_t factor_count;
  scree_study_point *points;
  size_t point_count;
  char (*keys)[SCREE_RUN_KEY_BYTES]; /* of every run; NULL before all shapes are known */
};

static inline size_t scree_study_run_point(const scree_study *study, size_t run) {
  return run % study->point_count;
}
static inline size_t scree_study_run_replicate(const scree_study *study, size_t run) {
  return run / study->point_count;
}

/* runs.c: whether the key is no field of the scene but of the study's own shapes: "shapes", "rp".
 */
bool scree_study_is_own(const scree_study *study, const char *key);
/* The seed of a run: the study's, or its point's where seed is a factor, and the replicate. */
uint64_t scree_study_run_seed(const scree_study *study, size_t run);
/* Which answers the study asks for. They are not among what names a run: other answers go on with
 * the runs that were made, and take theirs from what these left. */
void scree_study_answers_mark(const scree_study *study, char mark[SCREE_CHECKSUM_TEXT]);

/* folder.c: waits for as long as others are to be waited for; SCREE_CANCELLED. */
scree_status scree_study_pause(const scree_study_options *options, const scree_progress *progress,
                               const char *what, scree_error *error);
/* plan.c: "grid", "latin", "sobol" or "list". */
const char *scree_study_design_name(const scree_study *study);
/* points.c: the design's points with their labels; all values have been checked. */
scree_status scree_study_make_points(scree_study *study, scree_error *error);
/* Names every run by its content; all shapes must be known. */
scree_status scree_study_make_keys(scree_study *study, scree_error *error);

/* shapes.c: reads what the folder has on the shapes; where it has all, names the runs too. */
scree_status scree_study_know_shapes(scree_study *study, scree_error *error);
/* levels.c: spheres of the clumps that "clump:20" stands for, 1 to 300; 0 where it is none. */
size_t scree_study_spheres(const char *rp);
/* What an Rp text that the plan has found to be one of the shape's levels stands for. */
double scree_study_rp(const scree_study_shape *shape, const char *rp);
/* The file of a shape's level; by the macro until the end of the block. */
const char *scree_study_level_path(const scree_study *study, const scree_study_shape *shape,
                                   const char *rp, char path[SCREE_PATH_BYTES]);
#define SCREE_LEVEL_PATH(study, shape, rp)                                                         \
  scree_study_level_path(study, shape, rp, (char[SCREE_PATH_BYTES]){0})
/* The particle of a shape at a level, from the folder; free it. */
scree_status scree_study_make_shape(const scree_study *study, size_t shape, const char *rp,
                                    scree_shape_made *made, scree_error *error);

/* scene_base.c: takes the text of a scene's file, or of a template; one field more that the base
 * changes; what the plan of the base says. */
scree_status scree_study_read_scene(scree_study *study, const char *name, scree_error *error);
scree_status scree_study_take_template(scree_study *study, const char *name, scree_error *error);
scree_status scree_study_add_setting(scree_study *study, const char *key, const char *value,
                                     scree_error *error);
scree_status scree_study_look(scree_study *study, scree_error *error);
/* Its file with the base's settings and the values of a point (NULL: none), to be freed; that of a
 * run; whether a value can be. */
scree_status scree_study_scene(const scree_study *study, const scree_study_point *point,
                               scree_scene_file **file, scree_error *error);
scree_status scree_study_run_scene(const scree_study *study, size_t run, scree_scene_file **file,
                                   scree_error *error);
scree_status scree_study_try(const scree_study *study, const char *key, const char *value,
                             scree_error *error);
/* Puts the particles of a run's shapes, made from the folder's levels, into the store; adds to
 * *triangle_count their mean. */
scree_status scree_study_stock(const scree_study *study, size_t run, const scree_scene_file *file,
                               scree_shape_store *store, double *triangle_count,
                               scree_error *error);
/* Whether the base has such a column, and its unit, known from its sensors and shapes. */
bool scree_study_has_column(const scree_study *study, const char *column, const char **unit);
/* A hint for a column that it has not: the one that was meant, or those that there are, to end a
 * sentence.
 */
const char *scree_study_column_hint(scree_study *study, const char *column);
/* The scene's text into the study's folder. */
scree_status scree_study_keep_scene(const scree_study *study, scree_error *error);

/* command_base.c: the words, a list or all in one text, parted at blanks. */
scree_status scree_study_read_command(scree_study *study, const scree_yaml *command,
                                      scree_error *error);
/* Whether the command has a word with {key} in it. */
bool scree_command_has(const scree_texts *command, const char *key);
/* The word of the command with a run's values, as text in the arena's way; folder NULL: {folder} is
 * left as it is. */
scree_status scree_study_command_word(const scree_study *study, size_t run, size_t word,
                                      const char *folder, char *text, size_t size,
                                      scree_error *error);

/* folder.c: FOLDER/KIND/NAME ENDING; by the macro until the end of the block. */
const char *scree_study_path(const scree_study *study, const char *kind, const char *name,
                             const char *ending, char path[SCREE_PATH_BYTES]);
#define SCREE_STUDY_PATH(study, kind, name, ending)                                                \
  scree_study_path(study, kind, name, ending, (char[SCREE_PATH_BYTES]){0})

/* Writes the text where the file does not hold it already, so that a folder in use is left alone.
 */
scree_status scree_study_keep_text(const char *text, const char *path, scree_error *error);

/* confidence in (0, 1), for example 0.95: of normally distributed values; 0: without intervals. */
scree_summary scree_summarise(const double *values, size_t count, double confidence);
/* SCREE_BAD_ARGUMENT with fewer than two different x above zero. */
scree_status scree_fit_power(const double *x, const double *y, size_t count, double confidence,
                             scree_power_law *fit, scree_error *error);
/* degree 0 to SCREE_POLYNOMIAL_DEGREE; SCREE_BAD_ARGUMENT with fewer than degree + 1 different x.
 */
scree_status scree_fit_polynomial(const double *x, const double *y, size_t count, int degree,
                                  scree_polynomial *fit, scree_error *error);
