/* Sensors, of whatever kind (scene/sensors/sensor.h): their columns of numbers and the series of
 * them, their looks, files and checkpoints. */
#include "scene/sensors/sensor.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"
#include "base/quote.h"

#include <stdarg.h>

/* ---- kinds ---- */

#define SENSOR_KIND(T, row, key, ...) &scree_sensor_##key,
static const scree_sensor_kind *const kinds[] = {SCREE_SENSOR_KINDS(SENSOR_KIND, )};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const scree_sensor_kind *kind_of(const scree_plan_sensor *plan) {
  return kinds[scree_plan_kind(&scree_plan_sensor_record, plan)];
}

static scree_status check_sensor(const scree_reader *r, const void *record) {
  const scree_plan_sensor *s = record;
  SCREE_TRY(scree_plan_one_kind(r, &scree_plan_sensor_record, s, KINDS));
  return scree_plan_check_window(r, &s->place, s->from, s->until);
}
SCREE_RECORD_TABLE(scree_plan_sensor, SCREE_PLAN_SENSOR, "a sensor", NULL, check_sensor)

static const char *geometry_of(const scree_plan_sensor *plan) {
  const scree_sensor_kind *kind = kind_of(plan);
  return kind->geometry ? kind->geometry(plan) : NULL;
}

scree_status scree_plan_check_sensors(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->sensors.count; i++) {
    const scree_plan_sensor *s = &plan->sensors.items[i];
    const char *of = geometry_of(s);
    if (of) SCREE_TRY(SCREE_PLAN_NEED(r, plan, geometry, "geometry", of, &s->place));
    if (kind_of(s)->check) SCREE_TRY(kind_of(s)->check(r, plan, s));
  }
  return SCREE_OK;
}

bool scree_sensor_reach(const scree_plan_sensor *plan, double low[3], double high[3]) {
  const scree_sensor_kind *kind = kind_of(plan);
  if (kind->reach) kind->reach(plan, low, high);
  return kind->reach != NULL;
}

scree_status scree_sensors_complete(const scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_plan_sensor *plan = &scene->plan.sensors.items[i];
    if (kind_of(plan)->complete) SCREE_TRY(kind_of(plan)->complete(scene, plan, error));
  }
  return SCREE_OK;
}

/* ---- columns ---- */

/* What is always there. */
typedef struct base {
  scree_observation seen;
  scree_scene_book book;
  size_t phase;
} base;

#define COLUMN(name, unit, member) SCREE_FIELD_IN(base, name, unit, member)
static const scree_field base_columns[] = {
    COLUMN("time", "s", seen.time),
    COLUMN("entered", "", book.entered_count),
    COLUMN("inside", "", book.inside_count),
    COLUMN("left", "", book.left_count),
    COLUMN("waiting", "", book.waiting_count),
    COLUMN("mass_inside", "kg", book.inside_mass),
    COLUMN("kinetic", "J", seen.kinetic),
    COLUMN("rotational", "J", seen.rotational),
    COLUMN("potential", "J", seen.potential),
    COLUMN("elastic", "J", seen.elastic),
    COLUMN("dissipated_dashpot", "J", seen.dissipated_dashpot),
    COLUMN("dissipated_friction", "J", seen.dissipated_friction),
    COLUMN("wall_work", "J", seen.wall_work),
    COLUMN("entered_energy", "J", book.entered_energy),
    COLUMN("ledger", "", book.ledger),
    COLUMN("pairs", "", seen.pair_count),
    COLUMN("contacts", "", seen.contact_count),
    COLUMN("coordination", "", seen.coordination),
    COLUMN("largest_overlap", "m", seen.largest_overlap),
    COLUMN("highest_speed", "m/s", seen.highest_speed),
    COLUMN("mean_rotation", "rad/s", seen.mean_rotation),
    COLUMN("phase", "", phase)};
#undef COLUMN
enum { BASE_COLUMNS = sizeof base_columns / sizeof *base_columns };

SCREE_PRINTF(3, 4)
static bool add_column(scree_scene *scene, const char *unit, const char *format, ...) {
  scree_scene_column column = {.unit = unit};
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(column.name, sizeof column.name, format, arguments);
  va_end(arguments);
  return SCREE_PUSH(&scene->columns, column);
}

static bool add_class(scree_scene *scene, const scree_scene_sensor *sensor,
                      const scree_sensor_column *c, const scree_sensor_classes *classes,
                      size_t index) {
  char text[sizeof scene->columns.items->name];
  const char *name = text;
  if (classes->name)
    classes->name(scene, classes->by, index, text, sizeof text);
  else
    name = scree_scene_class_name(scene, classes->by, index);
  return add_column(scene, c->unit, "%s.%s.%s", sensor->plan->place.name, c->what, name);
}

static bool add_sensor(scree_scene *scene, const scree_scene_sensor *sensor) {
  const scree_sensor_kind *kind = sensor->kind;
  scree_sensor_classes classes = {0};
  bool good = true;
  if (kind->classes) classes = kind->classes(scene, sensor);
  const scree_sensor_column *c = kind->columns_of ? kind->columns_of(scene, sensor) : kind->columns;
  for (; good && c->what; c++) {
    if (c->of != SCREE_OF_EACH)
      good = add_column(scene, c->unit, "%s.%s", sensor->plan->place.name, c->what);
    for (size_t k = 0; good && c->of && classes.count > 1 && k < classes.count; k++)
      good = add_class(scene, sensor, c, &classes, k);
  }
  return good;
}

static bool add_tables(scree_scene *scene, const scree_scene_sensor *sensor) {
  const scree_sensor_table *tables = sensor->kind->tables;
  for (size_t k = 0; tables && tables[k].what; k++) {
    scree_scene_table_place place = {.sensor = (size_t)(sensor - scene->sensors), .table = k};
    snprintf(place.name, sizeof place.name, "%s.%s", sensor->plan->place.name, tables[k].what);
    if (!SCREE_PUSH(&scene->tables, place)) return false;
  }
  return true;
}

static scree_status plan_sensor(scree_scene *scene, scree_scene_sensor *sensor,
                                scree_error *error) {
  const char *of = geometry_of(sensor->plan);
  const scree_sensor_kind *kind = kind_of(sensor->plan);
  const scree_scene_sensor *first = scree_sensor_at(scene, kind, 0);
  unsigned char *state = NULL, *shared = first ? first->shared : NULL;
  if (of) sensor->geometry = SCREE_PLAN_FIND(scene->plan.geometry, of);
  if (kind->state_size) SCREE_TRY_TAKE(state, &scene->arena, kind->state_size, error);
  if (kind->shared_size && !first) SCREE_TRY_TAKE(shared, &scene->arena, kind->shared_size, error);
  sensor->leads = shared && !first;
  sensor->shared = shared;
  sensor->state = state;
  sensor->kind = kind;
  sensor->first_column = scene->columns.count;
  return add_sensor(scene, sensor) && add_tables(scene, sensor)
             ? SCREE_OK
             : scree_fail_memory(error, 0, "sensors");
}

scree_status scree_sensors_plan(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < BASE_COLUMNS; i++)
    if (!add_column(scene, base_columns[i].unit, "%s", base_columns[i].key))
      return scree_fail_memory(error, 0, "sensors");
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    scene->sensors[i].plan = &scene->plan.sensors.items[i];
    SCREE_TRY(plan_sensor(scene, &scene->sensors[i], error));
  }
  return SCREE_OK;
}

scree_status scree_sensors_begin(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *sensor = &scene->sensors[i];
    if (sensor->kind->begin) SCREE_TRY(sensor->kind->begin(scene, sensor, error));
  }
  return SCREE_OK;
}

void scree_sensors_end(scree_scene *scene) {
  for (size_t i = 0; scene->sensors && i < scene->plan.sensors.count; i++) {
    const scree_sensor_kind *kind = scene->sensors[i].kind;
    if (kind && kind->end) kind->end(&scene->sensors[i]);
    if (kind && kind->end_shared && scene->sensors[i].leads)
      kind->end_shared(scene->sensors[i].shared);
  }
}

const char *scree_scene_column_name(const scree_scene *scene, size_t index) {
  return index < scene->columns.count ? scene->columns.items[index].name : NULL;
}
const char *scree_scene_column_unit(const scree_scene *scene, size_t index) {
  return index < scene->columns.count ? scene->columns.items[index].unit : NULL;
}
size_t scree_scene_column_count(const scree_scene *scene) {
  return scene->columns.count;
}

/* ---- looking ---- */

uint64_t scree_sensors_next(const scree_scene *scene) {
  uint64_t next = UINT64_MAX;
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *s = &scene->sensors[i];
    uint64_t own = s->kind->next ? s->kind->next(scene, s) : UINT64_MAX,
             shared = s->leads ? s->kind->next_shared(s->shared) : UINT64_MAX;
    if (own < next) next = own;
    if (shared < next) next = shared;
  }
  return next;
}

scree_status scree_sensors_watch(scree_scene *scene, bool ticks, scree_error *error) {
  uint64_t step = scree_world_step_count(scene->world);
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *s = &scene->sensors[i];
    bool due = s->kind->next ? step >= s->kind->next(scene, s) : ticks;
    if (s->leads && step >= s->kind->next_shared(s->shared))
      SCREE_TRY(s->kind->watch_shared(scene, s->shared, error));
    if (due && s->kind->watch) SCREE_TRY(s->kind->watch(scene, s, error));
  }
  return SCREE_OK;
}

/* ---- reading ---- */

/* all: also what the series has at some of its rows only. */
static scree_status measure(const scree_scene *scene, bool all, double *values,
                            scree_error *error) {
  base b = {.phase = scene->phase};
  scree_world_observe(scene->world, &b.seen);
  scree_scene_get_book(scene, &b.book);
  for (size_t i = 0; i < BASE_COLUMNS; i++) values[i] = scree_field_number(&base_columns[i], &b);
  const double *last = NULL; /* row */
  if (scene->row_count) last = scene->series.items + (scene->row_count - 1) * scene->columns.count;
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *s = &scene->sensors[i];
    const scree_sensor_moment now = {values[0], last ? last[0] : (double)-INFINITY,
                                     last ? last + s->first_column : NULL, all};
    SCREE_TRY(s->kind->read(scene, s, &now, values + s->first_column, error));
  }
  return SCREE_OK;
}

scree_status scree_scene_measure(const scree_scene *scene, double *values, scree_error *error) {
  return measure(scene, true, values, error);
}

scree_status scree_scene_record(scree_scene *scene, scree_error *error) {
  size_t columns = scene->columns.count, used = scene->row_count * columns;
  if (!SCREE_RESERVE(&scene->series, used + columns))
    return scree_fail_memory(error, (used + columns) * sizeof(double), "the series of a scene");
  SCREE_TRY(measure(scene, false, scene->series.items + used, error));
  scene->row_count++;
  return SCREE_OK;
}

/* The sensor that a column is of; NULL: none. */
static const scree_scene_sensor *sensor_of(const scree_scene *scene, size_t column) {
  size_t i = scene->plan.sensors.count;
  while (i > 0 && scene->sensors[i - 1].first_column > column) i--;
  return i ? &scene->sensors[i - 1] : NULL;
}

scree_scene_summary scree_scene_summarise(const scree_scene *scene, size_t column, double from,
                                          double until) {
  const scree_scene_sensor *sensor = sensor_of(scene, column);
  if (isnan(from)) from = sensor ? sensor->plan->from : 0;
  if (isnan(until)) until = sensor ? sensor->plan->until : NAN;
  scree_scene_summary s = {NAN, 0, NAN, INFINITY, -INFINITY, from, fmin(until, INFINITY), 0};
  double squares = 0, end = s.until + scene->time_step; /* a row is of the step after its moment */
  const double *row = scene->series.items;
  for (size_t i = 0; i < scene->row_count; i++, row += scene->columns.count) {
    double value = s.last = row[column];
    if (row[0] < s.from || row[0] >= end || isnan(value)) continue;
    double off = value - s.mean;
    s.mean += off / (double)++s.count;
    squares += off * (value - s.mean);
    s.least = fmin(s.least, value), s.greatest = fmax(s.greatest, value);
  }
  if (s.count > 1) s.sd = sqrt(squares / (double)(s.count - 1));
  if (s.count == 0) s.mean = s.least = s.greatest = NAN;
  return s;
}

const double *scree_scene_series(const scree_scene *scene, size_t *row_count) {
  *row_count = scene->row_count;
  return scene->series.items;
}

/* ---- checkpoints ---- */

void scree_sensor_code(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  if (sensor->kind->code) sensor->kind->code(c, scene, sensor);
}

void scree_sensor_code_shared(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  (void)scene;
  if (sensor->leads) sensor->kind->code_shared(c, sensor->shared);
}

/* ---- tables ---- */

static const scree_sensor_table *table_at(const scree_scene *scene, size_t index) {
  const scree_scene_table_place *place = &scene->tables.items[index];
  return &scene->sensors[place->sensor].kind->tables[place->table];
}

const char *scree_scene_table_name(const scree_scene *scene, size_t index) {
  return index < scene->tables.count ? scene->tables.items[index].name : NULL;
}

static scree_status fill_table(const scree_scene *scene, size_t index, scree_scene_table *made,
                               scree_error *error) {
  const scree_sensor_table *table = table_at(scene, index);
  scree_sensor_rows rows = {.width = 0};
  while (rows.width < sizeof table->columns / sizeof *table->columns &&
         table->columns[rows.width].name)
    rows.width++;
  made->column_count = rows.width;
  made->is_long = table->is_long;
  SCREE_TRY_ALLOC(made->names, rows.width, error);
  SCREE_TRY_ALLOC(made->units, rows.width, error);
  for (size_t k = 0; k < rows.width; k++) {
    made->names[k] = table->columns[k].name;
    made->units[k] = table->columns[k].unit;
  }
  const scree_scene_sensor *sensor = &scene->sensors[scene->tables.items[index].sensor];
  scree_status status = table->fill(scene, sensor, &rows, error);
  made->row_count = rows.values.count / rows.width;
  made->values = rows.values.items;
  made->texts = rows.texts.items;
  return status;
}

scree_status scree_scene_make_table(const scree_scene *scene, size_t index,
                                    scree_scene_table *table, scree_error *error) {
  scree_scene_table made = {0};
  scree_status status = fill_table(scene, index, &made, error);
  if (status == SCREE_OK)
    *table = made;
  else
    scree_scene_table_free(&made);
  return status;
}

void scree_scene_table_free(scree_scene_table *table) {
  scree_free(table->names);
  scree_free(table->units);
  scree_free(table->values);
  scree_free(table->texts);
  *table = (scree_scene_table){0};
}

static void put_table(FILE *stream, const scree_sensor_table *table, const scree_scene_table *t) {
  for (size_t k = 0; k < t->column_count; k++)
    fprintf(stream, "%s%s%s%s%s", k ? "," : "", t->names[k], *t->units[k] ? " [" : "", t->units[k],
            *t->units[k] ? "]" : "");
  putc('\n', stream);
  for (size_t i = 0; i < t->row_count * t->column_count; i++) {
    const size_t k = i % t->column_count;
    const int digits = table->columns[k].digits ? table->columns[k].digits : 9;
    if (t->texts[i])
      scree_quote(stream, SCREE_QUOTE_CSV, t->texts[i]);
    else
      fprintf(stream, "%.*g", digits, t->values[i]);
    putc(k + 1 < t->column_count ? ',' : '\n', stream);
  }
}

static scree_status write_table(const scree_scene *scene, size_t index, const char *folder,
                                scree_error *error) {
  const scree_sensor_table *table = table_at(scene, index);
  const scree_scene_sensor *s = &scene->sensors[scene->tables.items[index].sensor];
  const scree_sensor_folder to = {folder, s->plan->place.name};
  SCREE_CLEANUP(scree_scene_table_free) scree_scene_table made = {0};
  scree_output output;
  char what[64];
  snprintf(what, sizeof what, "%s.csv", table->what);
  SCREE_TRY(scree_scene_make_table(scene, index, &made, error));
  SCREE_TRY(scree_sensor_open(&to, what, &output, error));
  put_table(output.stream, table, &made);
  return scree_output_commit(&output, error);
}

scree_status scree_scene_write_tables(const scree_scene *scene, const char *folder,
                                      scree_error *error) {
  for (size_t i = 0; i < scene->tables.count; i++) SCREE_TRY(write_table(scene, i, folder, error));
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *s = &scene->sensors[i];
    const scree_sensor_folder to = {folder, s->plan->place.name};
    if (s->kind->write) SCREE_TRY(s->kind->write(scene, s, &to, error));
  }
  return SCREE_OK;
}
