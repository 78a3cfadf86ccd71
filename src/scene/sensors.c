/* Sensors as columns of numbers: what each is called, what it reads now, and what flows
 * gather from tick to tick. */
#include "scene/grid.h"
#include "scene/impacts.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/sum.h"

#include <stdarg.h>
#include <string.h>

bool scree_scene_is_watching(const scree_scene *scene, const scree_scene_sensor *sensor) {
  double time = scree_world_time(scene->world);
  return time >= sensor->plan->from && !(time > sensor->plan->until);
}

size_t scree_scene_class_count(const scree_scene *scene, int by) {
  size_t materials = scene->plan.materials.count;
  return by == SCREE_BY_SIZE    ? SCREE_SCENE_SHAPES(scene)
         : by == SCREE_BY_SHAPE ? scene->plan.families.count
         : materials            ? materials
                                : 1;
}

size_t scree_scene_class_of(const scree_scene *scene, int by, size_t shape) {
  const scree_scene_shape *s = &scene->shapes[shape];
  return by == SCREE_BY_SIZE ? shape : by == SCREE_BY_SHAPE ? s->family : s->material;
}

const char *scree_scene_class_name(const scree_scene *scene, int by, size_t index) {
  const scree_plan *plan = &scene->plan;
  if (by == SCREE_BY_SIZE) return scree_scene_shape_name(scene, index);
  if (by == SCREE_BY_SHAPE) return plan->families.items[index].place.name;
  if (plan->materials.count == 0) return "bodies";
  return plan->materials.items[index].place.name;
}

/* ---- columns ---- */

/* What is always there: a number or count of the observation or of the book, or the phase. */
static const struct {
  const char *name, *unit;
  enum { SEEN_REAL, SEEN_COUNT, BOOK_REAL, BOOK_COUNT, PHASE } of;
  size_t offset;
} base_columns[] = {
    {"time", "s", SEEN_REAL, offsetof(scree_observation, time)},
    {"entered", "", BOOK_COUNT, offsetof(scree_scene_book, entered_count)},
    {"inside", "", BOOK_COUNT, offsetof(scree_scene_book, inside_count)},
    {"left", "", BOOK_COUNT, offsetof(scree_scene_book, left_count)},
    {"waiting", "", BOOK_COUNT, offsetof(scree_scene_book, waiting_count)},
    {"mass_inside", "kg", BOOK_REAL, offsetof(scree_scene_book, inside_mass)},
    {"kinetic", "J", SEEN_REAL, offsetof(scree_observation, kinetic)},
    {"rotational", "J", SEEN_REAL, offsetof(scree_observation, rotational)},
    {"potential", "J", SEEN_REAL, offsetof(scree_observation, potential)},
    {"elastic", "J", SEEN_REAL, offsetof(scree_observation, elastic)},
    {"dissipated_dashpot", "J", SEEN_REAL, offsetof(scree_observation, dissipated_dashpot)},
    {"dissipated_friction", "J", SEEN_REAL, offsetof(scree_observation, dissipated_friction)},
    {"wall_work", "J", SEEN_REAL, offsetof(scree_observation, wall_work)},
    {"entered_energy", "J", BOOK_REAL, offsetof(scree_scene_book, entered_energy)},
    {"ledger", "", BOOK_REAL, offsetof(scree_scene_book, ledger)},
    {"pairs", "", SEEN_COUNT, offsetof(scree_observation, pair_count)},
    {"contacts", "", SEEN_COUNT, offsetof(scree_observation, contact_count)},
    {"coordination", "", SEEN_REAL, offsetof(scree_observation, coordination)},
    {"largest_overlap", "m", SEEN_REAL, offsetof(scree_observation, largest_overlap)},
    {"highest_speed", "m/s", SEEN_REAL, offsetof(scree_observation, highest_speed)},
    {"mean_rotation", "rad/s", SEEN_REAL, offsetof(scree_observation, mean_rotation)},
    {"phase", "", PHASE, 0}};
enum { BASE_COLUMNS = sizeof base_columns / sizeof *base_columns };

/* Of impacts; the rate follows from the count. */
static const struct {
  const char *name, *unit;
  int sum;
} impact_columns[] = {
    {"count", "", SCREE_IMPACT_COUNT},    {"approach", "J", SCREE_IMPACT_APPROACH},
    {"normal", "J", SCREE_IMPACT_NORMAL}, {"tangential", "J", SCREE_IMPACT_TANGENTIAL},
    {"damage", "J", SCREE_IMPACT_DAMAGE}, {"rate", "1/s", -1}};
enum { IMPACT_COLUMNS = sizeof impact_columns / sizeof *impact_columns };

SCREE_PRINTF(3, 4)
static bool add_column(scree_scene *scene, const char *unit, const char *format, ...) {
  scree_scene_column column = {.unit = unit};
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(column.name, sizeof column.name, format, arguments);
  va_end(arguments);
  return SCREE_PUSH(&scene->columns, column);
}

/* Where there are several classes, SENSOR.WHAT.CLASS of each. */
static bool add_classes(scree_scene *scene, const char *sensor, const char *what, const char *unit,
                        int by) {
  size_t count = scree_scene_class_count(scene, by);
  bool good = true;
  for (size_t c = 0; good && count > 1 && c < count; c++)
    good = add_column(scene, unit, "%s.%s.%s", sensor, what, scree_scene_class_name(scene, by, c));
  return good;
}

/* SENSOR.WHAT, and of each class. */
static bool add_by_class(scree_scene *scene, const char *sensor, const char *what, const char *unit,
                         int by) {
  return add_column(scene, unit, "%s.%s", sensor, what) &&
         add_classes(scene, sensor, what, unit, by);
}

static bool add_all(scree_scene *scene, const char *sensor, const char *const *names_units) {
  bool good = true;
  for (; good && names_units[0]; names_units += 2)
    good = add_column(scene, names_units[1], "%s.%s", sensor, names_units[0]);
  return good;
}

/* SENSOR.WHAT, and where there are several classes SENSOR.WHAT.A-B. */
static bool add_impacts(scree_scene *scene, const scree_scene_sensor *sensor) {
  bool good = true;
  for (size_t k = 0; good && k < IMPACT_COLUMNS; k++) {
    const char *what = impact_columns[k].name, *unit = impact_columns[k].unit;
    size_t classes = sensor->impacts->class_count;
    good = add_column(scene, unit, "%s.%s", sensor->plan->place.name, what);
    for (size_t c = 0; good && classes > 1 && c < classes; c++) {
      const char *names[2];
      scree_impact_class_names(scene, sensor, c, names);
      good = add_column(scene, unit, "%s.%s.%s-%s", sensor->plan->place.name, what, names[0],
                        names[1]);
    }
  }
  return good;
}

static bool is_hinge(const scree_scene *scene, const scree_scene_sensor *sensor) {
  return scene->plan.geometry.items[sensor->geometry].hinge;
}

static bool add_sensor(scree_scene *scene, const scree_scene_sensor *sensor) {
  const scree_plan_sensor *plan = sensor->plan;
  static const char *const wall[] = {
      "force_x",       "N",   "force_y",     "N",   "force_z",    "N", "torque_x",         "N m",
      "torque_y",      "N m", "torque_z",    "N m", "power",      "W", "energy",           "J",
      "wear",          "J",   "worn_volume", "m3",  "worn_depth", "m", "highest_pressure", "Pa",
      "highest_shear", "Pa",  NULL};
  static const char *const pile[] = {"sector_deg",
                                     "deg",
                                     "cone_deg",
                                     "deg",
                                     "silhouette_deg",
                                     "deg",
                                     "height",
                                     "m",
                                     "base_radius",
                                     "m",
                                     "sector_sd_deg",
                                     "deg",
                                     "silhouette_sd_deg",
                                     "deg",
                                     "volume_deg",
                                     "deg",
                                     "run_out",
                                     "m",
                                     "packing",
                                     "",
                                     "count",
                                     "",
                                     NULL};
  static const char *const slide[] = {"way", "m",    "speed", "m/s",  "force", "N", "energy",
                                      "J",   "work", "J",     "lost", "J",     NULL};
  static const char *const hinge[] = {"way", "rad",  "speed", "rad/s", "force", "N m", "energy",
                                      "J",   "work", "J",     "lost",  "J",     NULL};
  static const char *const grid[] = {"samples",     "",      "solid",    "",   "speed", "m/s",
                                     "temperature", "m2/s2", "pressure", "Pa", NULL};
  static const char *const position[] = {"x", "m", "y", "m", "z", "m", NULL};
  const char *name = plan->place.name;
  if (plan->flow)
    return add_by_class(scene, name, "count", "", SCREE_BY_SIZE) &&
           add_by_class(scene, name, "mass", "kg", SCREE_BY_SIZE) &&
           add_by_class(scene, name, "rate", "1/s", SCREE_BY_SIZE) &&
           add_by_class(scene, name, "mass_rate", "kg/s", SCREE_BY_SIZE);
  if (plan->region)
    return add_by_class(scene, name, "count", "", SCREE_BY_SIZE) &&
           add_by_class(scene, name, "mass", "kg", SCREE_BY_SIZE) &&
           add_column(scene, "", "%s.packing", name) &&
           add_column(scene, "m/s", "%s.mean_speed", name) && add_all(scene, name, position);
  if (plan->wall) return add_all(scene, name, wall);
  if (plan->position) return add_all(scene, name, position);
  if (plan->part) return add_all(scene, name, is_hinge(scene, sensor) ? hinge : slide);
  if (plan->pile) return add_all(scene, name, pile);
  if (plan->slope) return add_column(scene, "deg", "%s.angle_deg", name);
  if (plan->segregation)
    return add_column(scene, "", "%s.per_cell", name) &&
           add_classes(scene, name, "lacey", "", plan->segregation->by);
  if (plan->grid)
    return add_all(scene, name, grid) && add_classes(scene, name, "lacey", "", SCREE_BY_SHAPE);
  if (plan->impacts) return add_impacts(scene, sensor);
  const int by = plan->residence->by;
  return add_by_class(scene, name, "count", "", by) && add_by_class(scene, name, "mean", "s", by) &&
         add_by_class(scene, name, "sd", "s", by) && add_by_class(scene, name, "p10", "s", by) &&
         add_by_class(scene, name, "median", "s", by) && add_by_class(scene, name, "p90", "s", by);
}

static bool allocate_sums(scree_scene *scene, scree_scene_sensor *sensor) {
  double **arrays[] = {&sensor->count, &sensor->mass};
  size_t count = SCREE_SCENE_SHAPES(scene) + 1;
  for (size_t i = 0; i < 2; i++) {
    *arrays[i] = scree_arena_take(&scene->arena, count, sizeof **arrays[i]);
    if (!*arrays[i]) return false;
    memset(*arrays[i], 0, count * sizeof **arrays[i]);
  }
  return true;
}

scree_status scree_scene_plan_columns(scree_scene *scene, scree_error *error) {
  bool good = true;
  for (size_t i = 0; good && i < BASE_COLUMNS; i++)
    good = add_column(scene, base_columns[i].unit, "%s", base_columns[i].name);
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *sensor = &scene->sensors[i];
    sensor->plan = &scene->plan.sensors.items[i];
    sensor->first_column = scene->columns.count;
    const scree_plan_sensor *p = sensor->plan;
    if (p->grid && p->grid->with)
      sensor->geometry = SCREE_PLAN_FIND(scene->plan.geometry, p->grid->with);
    const char *of = p->wall ? p->wall : p->part ? p->part : p->position;
    if (of) sensor->geometry = SCREE_PLAN_FIND(scene->plan.geometry, of);
    scree_status status =
        sensor->plan->impacts ? scree_scene_plan_impacts(scene, sensor, error) : SCREE_OK;
    if (status == SCREE_OK && p->grid) status = scree_scene_plan_grid(scene, sensor, error);
    if (status != SCREE_OK) return status;
    good = add_sensor(scene, sensor) && allocate_sums(scene, sensor);
  }
  return good ? SCREE_OK : scree_fail_memory(error, 0, "sensors");
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

/* ---- from tick to tick ---- */

static void count_crossing(scree_scene *scene, scree_scene_sensor *sensor, size_t body, int way) {
  size_t all = SCREE_SCENE_SHAPES(scene), shape = scene->shape_of.items[body];
  double mass = way * scree_world_body_mass(scene->world, body);
  sensor->count[shape] += way;
  sensor->count[all] += way;
  sensor->mass[shape] += mass;
  sensor->mass[all] += mass;
}

/* m: one that is farther from a plane than that has not crossed it but the boundary of a periodic
 * domain. */
static double across_boundary(const scree_scene *scene, vec3 n) {
  const double *period = scene->world->options.period, along[3] = {n.x, n.y, n.z};
  double far = INFINITY;
  for (int k = 0; k < 3; k++)
    if (period[k] > 0 && along[k] != 0) far = fmin(far, 0.25 * period[k] * fabs(along[k]));
  return far;
}

static scree_status watch_flow(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  const scree_plan_flow *plan = sensor->plan->flow;
  vec3 n = vec3_unit(vec3_load(plan->normal)), through = vec3_load(plan->through);
  size_t count = scene->shape_of.count;
  double far = across_boundary(scene, n);
  if (!SCREE_RESERVE(&sensor->side, count))
    return scree_fail_memory(error, count, "a flow's bodies");
  for (size_t b = 0; b < count; b++) {
    if (scree_world_body_removed(scene->world, b)) continue;
    scree_body body;
    scree_world_get_body(scene->world, b, &body);
    vec3 d = vec3_sub(vec3_load(body.position), through);
    double height = vec3_dot(d, n);
    int8_t side = height < 0 ? -1 : 1;
    bool known = b < sensor->side.count;
    bool crossed = known && side != sensor->side.items[b] && fabs(height) < far;
    if (crossed && (isnan(plan->radius) || vec3_norm(vec3_mad(d, n, -height)) <= plan->radius))
      count_crossing(scene, sensor, b, side);
    sensor->side.items[b] = side;
    if (!known) sensor->side.count = b + 1;
  }
  return SCREE_OK;
}

scree_status scree_scene_watch_flows(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    if (scene->sensors[i].plan->flow) SCREE_TRY(watch_flow(scene, &scene->sensors[i], error));
  return SCREE_OK;
}

/* ---- reading ---- */

/* The values of all shapes first, then where there are several each one's, at *at. */
static void put_by_shape(const scree_scene *scene, const double *values, double factor,
                         double **at) {
  size_t shapes = SCREE_SCENE_SHAPES(scene);
  *(*at)++ = factor * values[shapes];
  for (size_t s = 0; shapes > 1 && s < shapes; s++) *(*at)++ = factor * values[s];
}

/* The last row of the series; *since is then its time, if that is later. NULL: none. */
static const double *row_before(const scree_scene *scene, double *since) {
  if (!scene->row_count) return NULL;
  const double *row = scene->series.items + (scene->row_count - 1) * scene->columns.count;
  *since = fmax(*since, row[0]);
  return row;
}

/* Counts and masses, and since the last row how many a second. */
static void read_flow(const scree_scene *scene, const scree_scene_sensor *sensor, double time,
                      double *at) {
  size_t shapes = SCREE_SCENE_SHAPES(scene), width = shapes > 1 ? shapes + 1 : 1;
  const double *now = at;
  double since = 0;
  const double *row = row_before(scene, &since), *before = row ? row + sensor->first_column : NULL;
  put_by_shape(scene, sensor->count, 1, &at);
  put_by_shape(scene, sensor->mass, 1, &at);
  for (size_t k = 0; k < 2 * width; k++)
    *at++ = time > since ? (now[k] - (before ? before[k] : 0)) / (time - since) : NAN;
}

static void read_impacts(const scree_scene *scene, const scree_scene_sensor *sensor, double time,
                         double *at) {
  const scree_scene_impacts *impacts = sensor->impacts;
  size_t classes = impacts->class_count, width = classes > 1 ? classes + 1 : 1;
  double since = sensor->plan->from, *counts = at;
  const double *before = row_before(scene, &since);
  for (size_t k = 0; k + 1 < IMPACT_COLUMNS; k++, at += width) {
    at[0] = 0;
    for (size_t c = 0; c < classes; c++) {
      double value = impacts->sums[c * SCREE_IMPACT_SUMS + (size_t)impact_columns[k].sum];
      at[0] += value;
      if (classes > 1) at[1 + c] = value;
    }
  }
  for (size_t k = 0; k < width; k++)
    at[k] = time > since
                ? (counts[k] - (before ? before[sensor->first_column + k] : 0)) / (time - since)
                : NAN;
}

static void read_region(const scree_scene *scene, const scree_plan_box *box, double *count,
                        double *mass, double *at) {
  size_t shapes = SCREE_SCENE_SHAPES(scene);
  double speed = 0, solid = 0, volume = 1;
  vec3 middle = {0, 0, 0};
  memset(count, 0, (shapes + 1) * sizeof *count);
  memset(mass, 0, (shapes + 1) * sizeof *mass);
  for (int k = 0; k < 3; k++) volume *= box->max[k] - box->min[k];
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    if (!scree_is_in(body.position, box->min, box->max)) continue;
    size_t shape = scene->shape_of.items[b];
    double m = scree_world_body_mass(scene->world, b);
    count[shape]++, count[shapes]++;
    mass[shape] += m, mass[shapes] += m;
    solid += scene->shapes[shape].volume;
    speed += vec3_norm(vec3_load(body.velocity));
    middle = vec3_mad(middle, vec3_load(body.position), m);
  }
  put_by_shape(scene, count, 1, &at);
  put_by_shape(scene, mass, 1, &at);
  *at++ = solid / volume;
  *at++ = count[shapes] > 0 ? speed / count[shapes] : NAN;
  vec3_store(at, vec3_scale(middle, 1 / mass[shapes])); /* of none NAN */
}

static scree_status read_wall(const scree_scene *scene, const scree_scene_sensor *sensor,
                              double *at, scree_error *error) {
  const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
  for (int k = 0; k < 8; k++) at[k] = 0;
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    double force[3], torque[3];
    scree_world_wall_force(scene->world, w, force, torque);
    double power, energy;
    scree_world_wall_power(scene->world, w, &power, &energy);
    const vec3 arm = vec3_sub(scree_world_wall_at(scene->world, w)->frame.position,
                              scree_world_wall_at(scene->world, g->first_wall)->frame.position);
    double more[3]; /* about the first of copies */
    vec3_store(more, vec3_cross(arm, vec3_load(force)));
    for (int k = 0; k < 3; k++) at[k] += force[k], at[3 + k] += torque[k] + more[k];
    at[6] += power, at[7] += energy;
  }
  double sums[SCREE_MAP_COUNT], highest[SCREE_MAP_COUNT];
  SCREE_TRY(scree_scene_read_maps(scene, sensor, sums, highest, error));
  at[8] = sums[SCREE_MAP_WEAR];
  at[9] = sums[SCREE_MAP_WORN];
  at[10] = highest[SCREE_MAP_WORN];
  at[11] = highest[SCREE_MAP_PRESSURE];
  at[12] = highest[SCREE_MAP_SHEAR];
  return SCREE_OK;
}

/* Means over the cells: of speed and temperature by mass. */
static void read_grid(const scree_scene *scene, const scree_scene_sensor *sensor, double *at) {
  double n = (double)sensor->grid->cell_count, mass = 0, speed = 0, heat = 0, solid = 0, press = 0;
  for (size_t c = 0; c < sensor->grid->cell_count; c++) {
    scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
    solid += f.solid / n;
    mass += f.density;
    speed += f.density * vec3_norm(vec3_load(f.velocity));
    heat += f.density * f.temperature;
    press += (f.stress[0] + f.stress[1] + f.stress[2]) / (3 * n);
  }
  const double values[5] = {(double)sensor->grid->sample_count, solid,
                            mass > 0 ? speed / mass : NAN, mass > 0 ? heat / mass : NAN, press};
  memcpy(at, values, sizeof values);
  for (size_t c = 0; scene->plan.families.count > 1 && c < scene->plan.families.count; c++) {
    const double *mixing = sensor->grid->mixing + 2 * c;
    at[5 + c] = mixing[1] > 0 ? mixing[0] / mixing[1] : NAN;
  }
}

static void read_part(const scree_scene *scene, size_t geometry, double *at) {
  const scree_scene_part *part = scene->geometry[geometry].part;
  const double values[6] = {part->way,
                            part->speed,
                            scree_scene_push(scene, geometry),
                            scree_scene_part_energy(scene, geometry),
                            part->work,
                            part->lost};
  memcpy(at, values, sizeof values);
}

static void read_position(const scree_scene *scene, size_t geometry, double *at) {
  scree_wall wall;
  scree_world_get_wall(scene->world, scene->geometry[geometry].first_wall, &wall);
  memcpy(at, wall.position, sizeof wall.position);
}

/* Whether the next row of the series has the pile: once in every interval of the clock. */
static bool pile_is_due(const scree_scene *scene, const scree_plan_pile *plan) {
  double time = scree_world_time(scene->world), every = plan->every, before = -every;
  if (scene->end) return true;
  if (!scree_scene_is_in_phase(scene, &plan->during) || every == 0) return false;
  if (isnan(every)) return true;
  if (scene->row_count) before = scene->series.items[(scene->row_count - 1) * scene->columns.count];
  return floor(time / every) > floor(before / every);
}

static scree_status read_sensor(const scree_scene *scene, const scree_scene_sensor *sensor,
                                bool all, double *values, scree_error *error) {
  const scree_plan_sensor *plan = sensor->plan;
  double *at = values + sensor->first_column;
  scree_status status = SCREE_OK;
  if (plan->flow)
    read_flow(scene, sensor, values[0], at);
  else if (plan->region)
    read_region(scene, plan->region->box, sensor->count, sensor->mass, at);
  else if (plan->wall)
    status = read_wall(scene, sensor, at, error);
  else if (plan->part)
    read_part(scene, sensor->geometry, at);
  else if (plan->position)
    read_position(scene, sensor->geometry, at);
  else if (plan->pile && !all && !pile_is_due(scene, plan->pile))
    for (int k = 0; k < SCREE_PILE_COLUMNS; k++) at[k] = NAN;
  else if (plan->pile)
    status = scree_scene_put_pile(scene, plan->pile, at, error);
  else if (plan->slope)
    status = scree_scene_measure_slope(scene, plan->slope, at, error);
  else if (plan->segregation)
    status = scree_scene_measure_mixing(scene, sensor, at, error);
  else if (plan->grid)
    read_grid(scene, sensor, at);
  else if (plan->impacts)
    read_impacts(scene, sensor, values[0], at);
  else
    status = scree_scene_read_residence(scene, sensor, at, error);
  return status;
}

/* all: also what the series has at some of its rows only. */
static scree_status measure(const scree_scene *scene, bool all, double *values,
                            scree_error *error) {
  scree_observation o;
  scree_scene_book b;
  scree_world_observe(scene->world, &o);
  scree_scene_get_book(scene, &b);
  for (size_t i = 0; i < BASE_COLUMNS; i++) {
    bool seen = base_columns[i].of <= SEEN_COUNT;
    const char *at = (seen ? (const char *)&o : (const char *)&b) + base_columns[i].offset;
    bool real = base_columns[i].of == SEEN_REAL || base_columns[i].of == BOOK_REAL;
    values[i] = base_columns[i].of == PHASE ? (double)scene->phase
                : real                      ? *(const double *)(const void *)at
                                            : (double)*(const size_t *)(const void *)at;
  }
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    SCREE_TRY(read_sensor(scene, &scene->sensors[i], all, values, error));
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
