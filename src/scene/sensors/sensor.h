/* A kind of sensor: one file of this folder, which holds the rows of its fields, what it keeps, and
 * the one object by which everything else knows it, scree_sensor_KEY. Its row in kinds.h puts it
 * into the table over which sensors.c loops; nothing else names a kind.
 *
 * Every function but `read` may be NULL, and most kinds have two or three. They are
 * called in this order:
 *
 *     check                        of the plan, when a file is read
 *     complete                     when the particles are known
 *     begin                        when the world stands with its walls, before any step
 *     code                         into a checkpoint; or out of one, after begin
 *     watch                        when `next` says so or, without a `next`, at every tick
 *     read                         for each row of the series, and whenever a number is asked for
 *     tables, write, doubt         at the end of a run
 *     end                          once, whatever failed before
 *
 * Rules. A kind keeps its numbers in its state and nowhere else: neither in the scene nor in the
 * plan. It reads the world and never changes it, so that no bit of a run depends on its sensors,
 * and the order of sensors does not matter. What it keeps is the same for any number of threads. A
 * run that goes on with other sensors takes over those that stayed by `code`, out and in. */
#pragma once

#include "base/codec.h"
#include "base/file.h"
#include "heap/repose.h"
#include "scene/plan_fields.h"
#include "scene/scene.h"

/* A column of the series, SENSOR.WHAT; of classes, where there are several, SENSOR.WHAT.CLASS. */
typedef struct scree_sensor_column {
  const char *what, *unit;
  enum { SCREE_OF_ALL, SCREE_OF_ALL_AND_EACH, SCREE_OF_EACH } of;
} scree_sensor_column;

/* The classes that columns come by. */
typedef struct scree_sensor_classes {
  size_t count;
  int by; /* SCREE_BY_SIZE, ... */
  /* NULL: scree_scene_class_name */
  void (*name)(const scree_scene *scene, int by, size_t index, char *text, size_t size);
} scree_sensor_classes;

/* When a sensor is read. */
typedef struct scree_sensor_moment {
  double time;        /* s */
  double last_time;   /* s, of the last row of the series; -INFINITY: there is none */
  const double *last; /* what the sensor had there; NULL */
  bool all;           /* also what the series has at some of its rows only */
} scree_sensor_moment;

/* Where tables go. */
typedef struct scree_sensor_folder {
  const char *path;
  const char *sensor; /* its name */
} scree_sensor_folder;

/* A table of numbers that are no columns: SENSOR.WHAT, in a folder sensor-SENSOR-WHAT.csv. */
typedef struct scree_sensor_rows scree_sensor_rows;
typedef struct scree_sensor_table {
  const char *what;
  bool is_long; /* a row for each body or triangle: result.json is without */
  struct {
    const char *name, *unit;
    int digits;  /* of its numbers in a file; 0: 9 */
  } columns[10]; /* up to one without a name */
  /* Each row by scree_sensor_put_row. */
  scree_status (*fill)(const scree_scene *scene, const scree_scene_sensor *sensor,
                       scree_sensor_rows *rows, scree_error *error);
} scree_sensor_table;

struct scree_sensor_kind {
  /* Bytes of what a sensor keeps, in the scene's arena and 0 before `begin`: scree_sensor_state. */
  size_t state_size;

  /* ---- the plan ---- */

  /* The geometry that it is of, by name, or NULL. That there is one is seen to, and
   * scree_scene_sensor has its index. */
  const char *(*geometry)(const scree_plan_sensor *plan);
  /* What single fields and their record's own check cannot say: names that it refers to. */
  scree_status (*check)(const scree_reader *reader, const scree_plan *plan,
                        const scree_plan_sensor *sensor);
  /* Fields that were not given and follow from the particles. */
  scree_status (*complete)(const scree_scene *scene, const scree_plan_sensor *plan,
                           scree_error *error);
  /* The box that a domain must hold which the file does not give. */
  void (*reach)(const scree_plan_sensor *plan, double low[3], double high[3]);

  /* ---- the series ---- */

  const scree_sensor_column *columns; /* up to one without a name */
  /* Instead, where they depend on the sensor. */
  const scree_sensor_column *(*columns_of)(const scree_scene *scene,
                                           const scree_scene_sensor *sensor);
  scree_sensor_classes (*classes)(const scree_scene *scene, const scree_scene_sensor *sensor);
  /* Its numbers now, one for each column. */
  scree_status (*read)(const scree_scene *scene, const scree_scene_sensor *sensor,
                       const scree_sensor_moment *now, double *values, scree_error *error);

  /* ---- what it gathers ---- */

  scree_status (*begin)(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error);
  /* Step of the next look; NULL: it looks at ticks. */
  uint64_t (*next)(const scree_scene *scene, const scree_scene_sensor *sensor);
  scree_status (*watch)(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error);
  /* Its state in or out, by the codec's direction. */
  void (*code)(scree_codec *codec, scree_scene *scene, scree_scene_sensor *sensor);
  /* What is not in the arena. */
  void (*end)(scree_scene_sensor *sensor);

  /* ---- what all sensors of the kind gather together ---- */

  /* Bytes of it, in the scene's arena and 0 before the first `begin`: scree_sensor_shared. */
  size_t shared_size;
  uint64_t (*next_shared)(const void *shared);
  scree_status (*watch_shared)(scree_scene *scene, void *shared, scree_error *error);
  void (*code_shared)(scree_codec *codec, void *shared);
  void (*end_shared)(void *shared);

  /* ---- what it tells ---- */

  const scree_sensor_table *tables; /* up to one without a name */
  /* Files that are no tables, each by scree_sensor_open. */
  scree_status (*write)(const scree_scene *scene, const scree_scene_sensor *sensor,
                        const scree_sensor_folder *folder, scree_error *error);
  /* Whether its numbers are to be doubted, and why. */
  bool (*doubt)(const scree_scene *scene, const scree_scene_sensor *sensor,
                char text[SCREE_REMARK]);
};

#define SCREE_SENSOR_EXTERN(T, row, key, ...) extern const scree_sensor_kind scree_sensor_##key;
SCREE_SENSOR_KINDS(SCREE_SENSOR_EXTERN, )

/* ---- what kinds ask for ---- */

/* The sensor's state, if it is of that kind; NULL: it is of another, or has none. */
static inline void *scree_sensor_state(const scree_scene_sensor *sensor,
                                       const scree_sensor_kind *kind) {
  return sensor->kind == kind ? sensor->state : NULL;
}
/* What all sensors of that kind share; NULL: there are none. */
void *scree_sensor_shared(const scree_scene *scene, const scree_sensor_kind *kind);
/* The sensor of that kind with that index among them; NULL past the last. */
const scree_scene_sensor *scree_sensor_at(const scree_scene *scene, const scree_sensor_kind *kind,
                                          size_t index);

/* Whether now is between a sensor's `from` and `until`. */
bool scree_sensor_is_on(const scree_scene *scene, const scree_scene_sensor *sensor);

static inline scree_sensor_classes scree_classes_by(const scree_scene *scene, int by) {
  return (scree_sensor_classes){scree_scene_class_count(scene, by), by, NULL};
}
/* Numbers for a column that is of all and, of several classes, of each. */
static inline size_t scree_sensor_width(size_t class_count) {
  return class_count > 1 ? class_count + 1 : 1;
}

/* Numbers for all columns, and texts for those of words; texts may be NULL. */
scree_status scree_sensor_put_row(scree_sensor_rows *rows, const double *values,
                                  const char *const *texts, scree_error *error);

/* FOLDER/sensor-NAME-WHAT, a file of its own until it is whole. */
scree_status scree_sensor_open(const scree_sensor_folder *folder, const char *what,
                               scree_output *output, scree_error *error);

struct scree_sensor_rows {
  size_t width;
  struct {
    double *items;
    size_t count, capacity;
  } values;
  struct {
    const char **items; /* of each value; NULL: it is a number */
    size_t count, capacity;
  } texts;
};

/* An array that grows, of items of so many bytes each, in or out. */
#define SCREE_CODE_LIST(codec, list, bytes, code_items)                                            \
  do {                                                                                             \
    size_t count_ = (list)->count;                                                                 \
    scree_code_count((codec), &count_, (bytes));                                                   \
    if (!scree_codec_good(codec)) break;                                                           \
    if (!SCREE_RESERVE(list, count_)) {                                                            \
      (codec)->out_of_memory = true;                                                               \
      break;                                                                                       \
    }                                                                                              \
    (list)->count = count_;                                                                        \
    code_items((codec), (list)->items, count_);                                                    \
  } while (0)

/* The surface of what lies there, as a height field. */
void scree_raise_body(const scree_scene *scene, size_t index, const scree_body *body,
                      double floor_z, scree_height_field *field);
/* m: diameter of the sphere of the body's volume. */
double scree_body_size(const scree_scene *scene, size_t index);
