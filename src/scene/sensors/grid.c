/* Fields over a grid by coarse graining (Goldhirsch, Granular Matter 12, 239, 2010), averaged over
 * time. With W a Gaussian of width w about a cell's middle r, cut off at 4 w, and sums over bodies,
 *
 *     solid fraction  sum V_i W           density  rho = sum m_i W
 *     velocity        v = sum m_i v_i W/rho
 *     temperature     T = sum m_i |v_i - v|^2 W/(3 rho)
 *     stress          sum m_i (v_i - v)(v_i - v) W + sum f_ij r_ij int_0^1 W(r - r_j - s r_ij) ds
 *
 * the last over contacts: f_ij acts on i, r_ij from the centre of j, or the place on a wall, to
 * that of i; pressure is positive. Fluctuations are from the mean over time. In a grid that moves
 * with a geometry all places, velocities and forces are in that one's frame, and relative to it. */
#include "scene/sensors/grid.h"
#include "scene/region.h"
#include "scene/sensors/mixing.h"

#include "base/math.h"
#include "base/quote.h"

#include <string.h>

#define SCREE_PLAN_GRID(ROW, T)                                                                    \
  ROW(T, GROUP, box, scree_plan_box, "")                                                           \
  ROW(T, GROUP, cylinder, scree_plan_cylinder, "instead of a box")                                 \
  ROW(T, VECTOR, cells, SCREE_NONE, 1, 1000, "",                                                   \
      "along x, y and z; of a cylinder outward, around and along")                                 \
  ROW(T, REAL, width, NAN, 1e-9, 1e3, "m",                                                         \
      "of coarse graining; not given: the largest body's size")                                    \
  ROW(T, REAL, every, NAN, 1e-9, 1e9, "s", "between samples; not given: as the series")            \
  ROW(T, TEXT, with, "a geometry: the grid is in its frame and moves with it")
SCREE_RECORD_TYPE(scree_plan_grid, SCREE_PLAN_GRID)

static scree_status check_grid(const scree_reader *r, const void *record) {
  const scree_plan_grid *p = record;
  const bool there[] = {p->box != NULL, p->cylinder != NULL};
  SCREE_TRY(scree_plan_one_of(r, &p->place, there, 2, "box, cylinder"));
  if (!given(p->cells)) return scree_fail_place(r, &p->place, "needs cells: [10, 10, 10]");
  for (int k = 0; k < 3; k++)
    if (p->cells[k] != floor(p->cells[k]))
      return scree_fail_place(r, &p->place, "cells %g: must be whole numbers", p->cells[k]);
  if (p->cells[0] * p->cells[1] * p->cells[2] > 1e6)
    return scree_fail_place(r, &p->place, "%g cells: at most 1e6",
                            p->cells[0] * p->cells[1] * p->cells[2]);
  return scree_region_check(r, &SCREE_REGION_OF(p), true);
}
SCREE_RECORD_TABLE(scree_plan_grid, SCREE_PLAN_GRID, "a grid", NULL, check_grid)

static const double cut_off = 4;  /* widths */
static const double piece = 0.25; /* of a width, of a contact's line */
static const double turn = 6.283185307179586;

/* ---- cells ---- */

static const size_t *cells_of(const scree_plan_grid *plan, size_t cells[3]) {
  for (int k = 0; k < 3; k++) cells[k] = (size_t)plan->cells[k];
  return cells;
}

static size_t cell_count(const scree_plan_grid *plan) {
  size_t n[3];
  cells_of(plan, n);
  return n[0] * n[1] * n[2];
}

/* A corner of the grid, counted along x, y, z or outward, around, along; halves are middles. */
static vec3 place_at(const scree_plan_grid *plan, double i, double j, double k) {
  if (plan->box) {
    vec3 low = vec3_load(plan->box->min), sides = vec3_sub(vec3_load(plan->box->max), low);
    return (vec3){low.x + sides.x * i / plan->cells[0], low.y + sides.y * j / plan->cells[1],
                  low.z + sides.z * k / plan->cells[2]};
  }
  const scree_plan_cylinder *c = plan->cylinder;
  vec3 axis = vec3_unit(vec3_load(c->axis)), u, v;
  vec3_frame(axis, &u, &v);
  double r = c->radius * i / plan->cells[0], a = turn * j / plan->cells[1];
  vec3 out = vec3_mad(vec3_scale(u, r * scree_cos(a)), v, r * scree_sin(a));
  return vec3_mad(vec3_add(vec3_load(c->at), out), axis, c->length * k / plan->cells[2]);
}

/* The cells along one of the grid's directions whose middles lie within `reach` of x; of count
 * cells from low to high. */
static void range_of(double x, double reach, double low, double high, size_t count,
                     size_t range[2]) {
  double cell = (high - low) / (double)count, from = ceil((x - reach - low) / cell - 0.5),
         to = floor((x + reach - low) / cell - 0.5) + 1;
  range[0] = from > 0 ? (size_t)fmin(from, (double)count) : 0;
  range[1] = to > 0 ? (size_t)fmin(to, (double)count) : 0;
}

static void ranges_of(const scree_plan_grid *plan, vec3 p, double reach, size_t ranges[3][2]) {
  size_t n[3];
  cells_of(plan, n);
  if (plan->box) {
    const double *low = plan->box->min, *high = plan->box->max;
    range_of(p.x, reach, low[0], high[0], n[0], ranges[0]);
    range_of(p.y, reach, low[1], high[1], n[1], ranges[1]);
    range_of(p.z, reach, low[2], high[2], n[2], ranges[2]);
    return;
  }
  const scree_plan_cylinder *c = plan->cylinder;
  vec3 axis = vec3_unit(vec3_load(c->axis)), d = vec3_sub(p, vec3_load(c->at));
  double along = vec3_dot(d, axis), away = vec3_norm(vec3_mad(d, axis, -along));
  range_of(away, reach, 0, c->radius, n[0], ranges[0]);
  ranges[1][0] = 0, ranges[1][1] = n[1];
  range_of(along, reach, 0, c->length, n[2], ranges[2]);
}

static scree_status begin(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  const scree_plan_grid *plan = sensor->plan->grid;
  scree_scene_grid *grid = sensor->state;
  size_t families = scene->plan.families.count;
  grid->cell_count = cell_count(plan);
  grid->number_count = grid->cell_count * (SCREE_GRID_SUMS + families);
  SCREE_TRY_TAKE(grid->sums, &scene->arena, grid->number_count, error);
  SCREE_TRY_TAKE(grid->mixing, &scene->arena, 2 * families, error);
  SCREE_TRY_TAKE(grid->indices, &scene->arena, families, error);
  SCREE_TRY_TAKE(grid->middles, &scene->arena, grid->cell_count, error);
  size_t n[3], at = 0;
  cells_of(plan, n);
  for (size_t k = 0; k < n[2]; k++)
    for (size_t j = 0; j < n[1]; j++)
      for (size_t i = 0; i < n[0]; i++)
        grid->middles[at++] = place_at(plan, (double)i + 0.5, (double)j + 0.5, (double)k + 0.5);
  return SCREE_OK;
}

/* ---- sampling ---- */

typedef struct sampling {
  const scree_scene *scene;
  scree_scene_sensor *sensor;
  double width, scale; /* m; of W, 1/m3 */
  vec3 at, velocity, spin;
  mat3 rotation; /* of the frame */
} sampling;

/* What a cell gets, times W there. */
typedef struct deposit {
  double sums[SCREE_GRID_SUMS];
  size_t family;
  double share; /* of the family; 0: of none */
} deposit;

static vec3 into_frame(const sampling *s, vec3 p) {
  return mat3_tmul_vec(&s->rotation, vec3_sub(p, s->at));
}

static void put(const sampling *s, vec3 p, const deposit *d, double factor) {
  const scree_plan_grid *plan = s->sensor->plan->grid;
  scree_scene_grid *grid = scree_grid_of(s->sensor);
  size_t n[3], ranges[3][2], families = s->scene->plan.families.count;
  const double reach = cut_off * s->width, narrow = -0.5 / (s->width * s->width);
  cells_of(plan, n);
  ranges_of(plan, p, reach, ranges);
  for (size_t k = ranges[2][0]; k < ranges[2][1]; k++)
    for (size_t j = ranges[1][0]; j < ranges[1][1]; j++)
      for (size_t i = ranges[0][0]; i < ranges[0][1]; i++) {
        size_t cell = (k * n[1] + j) * n[0] + i;
        double r2 = vec3_norm2(vec3_sub(grid->middles[cell], p));
        if (r2 > reach * reach) continue;
        double weight = factor * s->scale * scree_exp(narrow * r2);
        double *sums = grid->sums + cell * (SCREE_GRID_SUMS + families);
        for (int q = 0; q < SCREE_GRID_SUMS; q++) sums[q] += weight * d->sums[q];
        sums[SCREE_GRID_SUMS + d->family] += weight * d->share;
      }
}

/* xx, yy, zz, xy, yz, xz. */
static void add_product(double *to, vec3 a, vec3 b, double factor) {
  to[0] += factor * a.x * b.x;
  to[1] += factor * a.y * b.y;
  to[2] += factor * a.z * b.z;
  to[3] += 0.5 * factor * (a.x * b.y + a.y * b.x);
  to[4] += 0.5 * factor * (a.y * b.z + a.z * b.y);
  to[5] += 0.5 * factor * (a.x * b.z + a.z * b.x);
}

static void put_bodies(const sampling *s) {
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(s->scene, &b, &body); b++) {
    const scree_scene_shape *shape = &s->scene->shapes[s->scene->shape_of.items[b]];
    vec3 p = vec3_load(body.position), arm = vec3_sub(p, s->at),
         v = vec3_sub(vec3_load(body.velocity), vec3_add(s->velocity, vec3_cross(s->spin, arm)));
    v = mat3_tmul_vec(&s->rotation, v);
    deposit d = {.family = shape->family, .share = shape->mass};
    d.sums[SCREE_GRID_SOLID] = shape->volume;
    d.sums[SCREE_GRID_DENSITY] = shape->mass;
    vec3_store(d.sums + SCREE_GRID_MOMENTUM, vec3_scale(v, shape->mass));
    add_product(d.sums + SCREE_GRID_FLUX, v, v, shape->mass);
    put(s, into_frame(s, p), &d, 1);
  }
}

static bool put_contact(void *context, const scree_contact *c) {
  const sampling *s = context;
  scree_body a, b;
  scree_world_get_body(s->scene->world, c->body, &a);
  vec3 from = vec3_load(c->position), to = vec3_load(a.position);
  if (!c->wall) {
    scree_world_get_body(s->scene->world, c->other, &b);
    vec3 d = vec3_sub(to, vec3_load(b.position));
    from = vec3_sub(to, scree_nearest_image(s->scene->world, d));
  }
  vec3 branch = mat3_tmul_vec(&s->rotation, vec3_sub(to, from)),
       force = mat3_tmul_vec(&s->rotation, vec3_load(c->force));
  deposit d = {.share = 0};
  add_product(d.sums + SCREE_GRID_CONTACT, force, branch, 1);
  size_t pieces = (size_t)ceil(fmin(1000, vec3_norm(branch) / (piece * s->width))) + 1;
  for (size_t i = 0; i < pieces; i++)
    put(s, into_frame(s, vec3_lerp(from, to, ((double)i + 0.5) / (double)pieces)), &d,
        1 / (double)pieces);
  return true;
}

/* Puts it where the grid stands: in the frame of the geometry that it goes with. */
static void place_frame(const scree_scene *scene, const scree_scene_sensor *sensor, sampling *s) {
  s->rotation = quat_to_mat3((quat){1, 0, 0, 0});
  if (!sensor->plan->grid->with) return;
  size_t wall_index = scene->geometry[sensor->geometry].first_wall;
  double q[4];
  scree_wall wall;
  scree_world_get_wall(scene->world, wall_index, &wall);
  scree_world_wall_orientation(scene->world, wall_index, q);
  s->at = vec3_load(wall.position);
  s->velocity = vec3_load(wall.velocity);
  s->spin = vec3_load(wall.angular_velocity);
  s->rotation = quat_to_mat3(quat_load(q));
}

static sampling begin_sample(scree_scene *scene, scree_scene_sensor *sensor) {
  const scree_plan_grid *plan = sensor->plan->grid;
  sampling s = {.scene = scene, .sensor = sensor};
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    s.width = fmax(s.width, scene->shapes[i].particle->measures.size);
  if (!isnan(plan->width)) s.width = plan->width;
  s.scale = 1 / (turn * s.width * s.width * sqrt(turn) * s.width);
  place_frame(scene, sensor, &s);
  return s;
}

static bool cell_at(const scree_scene *scene, const scree_scene_sensor *sensor, vec3 place,
                    size_t *cell) {
  const scree_plan_grid *plan = sensor->plan->grid;
  sampling s = {.scene = scene};
  size_t n[3];
  double at[3]; /* of the way through the grid, from 0 to 1 */
  cells_of(plan, n);
  place_frame(scene, sensor, &s);
  vec3 p = into_frame(&s, place);
  if (plan->box) {
    vec3_store(at, p);
    for (int k = 0; k < 3; k++)
      at[k] = (at[k] - plan->box->min[k]) / (plan->box->max[k] - plan->box->min[k]);
  } else {
    const scree_plan_cylinder *c = plan->cylinder;
    vec3 axis = vec3_unit(vec3_load(c->axis)), d = vec3_sub(p, vec3_load(c->at)), u, v;
    vec3_frame(axis, &u, &v);
    double x = vec3_dot(d, u), y = vec3_dot(d, v), angle = scree_atan2(y, x) / turn;
    at[0] = sqrt(x * x + y * y) / c->radius;
    at[1] = angle < 0 ? angle + 1 : angle;
    at[2] = vec3_dot(d, axis) / c->length;
  }
  *cell = 0;
  for (int k = 2; k >= 0; k--) {
    if (!(at[k] >= 0 && at[k] <= 1)) return false;
    size_t i = (size_t)(at[k] * (double)n[k]);
    *cell = *cell * n[k] + (i < n[k] ? i : n[k] - 1);
  }
  return true;
}

static uint64_t interval_of(const scree_scene *scene, const scree_plan_grid *plan) {
  double every = isnan(plan->every) ? scene->plan.output->series : plan->every;
  return (uint64_t)fmax(1, floor(every / scene->time_step + 0.5));
}

static uint64_t next(const scree_scene *scene, const scree_scene_sensor *sensor) {
  (void)scene;
  return scree_grid_of(sensor)->next;
}

static bool find_cell(const scree_scene *scene, const scree_scene_sensor *sensor,
                      const double position[3], int64_t cell[3]) {
  size_t index = 0;
  bool inside = cell_at(scene, sensor, vec3_load(position), &index);
  cell[0] = (int64_t)index, cell[1] = cell[2] = 0;
  return inside;
}

static scree_status sample_mixing(const scree_scene *scene, scree_scene_sensor *sensor,
                                  scree_error *error) {
  scree_scene_grid *grid = scree_grid_of(sensor);
  size_t families = scene->plan.families.count;
  if (families < 2) return SCREE_OK;
  SCREE_TRY(
      scree_mixing_measure(scene, sensor, find_cell, SCREE_BY_SHAPE, NULL, grid->indices, error));
  for (size_t c = 0; c < families; c++) {
    if (isnan(grid->indices[c])) continue;
    grid->mixing[2 * c] += grid->indices[c];
    grid->mixing[2 * c + 1]++;
  }
  return SCREE_OK;
}

static scree_status watch(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  scree_scene_grid *grid = scree_grid_of(sensor);
  grid->next = scree_world_step_count(scene->world) + interval_of(scene, sensor->plan->grid);
  if (!scree_sensor_is_on(scene, sensor)) return SCREE_OK;
  sampling s = begin_sample(scene, sensor);
  put_bodies(&s);
  SCREE_TRY(scree_world_visit_contacts(scene->world, put_contact, &s, error));
  SCREE_TRY(sample_mixing(scene, sensor, error));
  grid->sample_count++;
  return SCREE_OK;
}

static bool doubt(const scree_scene *scene, const scree_scene_sensor *sensor,
                  char text[SCREE_REMARK]) {
  return scree_mixing_doubt(scene, sensor, find_cell, SCREE_BY_SHAPE, text);
}

/* ---- fields ---- */

scree_grid_fields scree_grid_fields_at(const scree_scene *scene, const scree_scene_sensor *sensor,
                                       size_t cell) {
  const scree_scene_grid *grid = scree_grid_of(sensor);
  const double *sums = grid->sums + cell * (SCREE_GRID_SUMS + scene->plan.families.count),
               n = (double)(grid->sample_count ? grid->sample_count : 1);
  scree_grid_fields f = {.solid = sums[SCREE_GRID_SOLID] / n,
                         .density = sums[SCREE_GRID_DENSITY] / n,
                         .shares = sums + SCREE_GRID_SUMS};
  bool any = sums[SCREE_GRID_DENSITY] > 0;
  vec3 v = {0, 0, 0};
  if (any) v = vec3_scale(vec3_load(sums + SCREE_GRID_MOMENTUM), 1 / sums[SCREE_GRID_DENSITY]);
  vec3_store(f.velocity, v);
  double mean[6] = {0};
  add_product(mean, v, v, f.density);
  for (int k = 0; k < 6; k++) {
    double kinetic = sums[SCREE_GRID_FLUX + k] / n - mean[k];
    if (k < 3 && any) f.temperature += fmax(0, kinetic) / (3 * f.density);
    f.stress[k] = kinetic + sums[SCREE_GRID_CONTACT + k] / n;
  }
  return f;
}

/* ---- the series ---- */

static const scree_sensor_column columns[] = {{"samples", "", SCREE_OF_ALL},
                                              {"solid", "", SCREE_OF_ALL},
                                              {"speed", "m/s", SCREE_OF_ALL},
                                              {"temperature", "m2/s2", SCREE_OF_ALL},
                                              {"pressure", "Pa", SCREE_OF_ALL},
                                              {"lacey", "", SCREE_OF_EACH},
                                              {0}};

static scree_sensor_classes classes(const scree_scene *scene, const scree_scene_sensor *sensor) {
  (void)sensor;
  return scree_classes_by(scene, SCREE_BY_SHAPE);
}

/* Means over the cells: of speed and temperature by mass. */
static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_scene_grid *grid = scree_grid_of(sensor);
  (void)now, (void)error;
  double n = (double)grid->cell_count, mass = 0, speed = 0, heat = 0, solid = 0, press = 0;
  for (size_t c = 0; c < grid->cell_count; c++) {
    scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
    solid += f.solid / n;
    mass += f.density;
    speed += f.density * vec3_norm(vec3_load(f.velocity));
    heat += f.density * f.temperature;
    press += (f.stress[0] + f.stress[1] + f.stress[2]) / (3 * n);
  }
  const double values[5] = {(double)grid->sample_count, solid, mass > 0 ? speed / mass : NAN,
                            mass > 0 ? heat / mass : NAN, press};
  memcpy(at, values, sizeof values);
  for (size_t c = 0; scene->plan.families.count > 1 && c < scene->plan.families.count; c++) {
    const double *mixing = grid->mixing + 2 * c;
    at[5 + c] = mixing[1] > 0 ? mixing[0] / mixing[1] : NAN;
  }
  return SCREE_OK;
}

/* ---- the file ---- */

static void begin_array(FILE *stream, const char *name, int components) {
  fputs("        <DataArray type=\"Float32\" Name=\"", stream);
  scree_quote(stream, SCREE_QUOTE_XML, name);
  fprintf(stream, "\" NumberOfComponents=\"%d\" format=\"ascii\">\n", components);
}

static void put_numbers(FILE *stream, const double *values, int count) {
  for (int k = 0; k < count; k++) fprintf(stream, "%.7g%c", values[k], k + 1 < count ? ' ' : '\n');
}

static const scree_field fields[] = {
    SCREE_FIELD_AS(scree_grid_fields, "solid fraction", solid),
    SCREE_FIELD_AS(scree_grid_fields, "density [kg/m3]", density),
    SCREE_FIELD_AS(scree_grid_fields, "velocity [m/s]", velocity),
    SCREE_FIELD_AS(scree_grid_fields, "granular temperature [m2/s2]", temperature),
    SCREE_FIELD_AS(scree_grid_fields, "stress [Pa]", stress)};

/* One field of all cells. */
static void put_field(FILE *stream, const scree_scene *scene, const scree_scene_sensor *sensor,
                      const scree_field *field) {
  int count = (int)(field->size / sizeof(double));
  begin_array(stream, field->key, count);
  for (size_t c = 0; c < scree_grid_of(sensor)->cell_count; c++) {
    scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
    put_numbers(stream, scree_field_at(field, &f), count);
  }
  fputs("        </DataArray>\n", stream);
}

static void put_shares(FILE *stream, const scree_scene *scene, const scree_scene_sensor *sensor) {
  for (size_t s = 0; s < scene->plan.families.count; s++) {
    char name[96];
    snprintf(name, sizeof name, "share of %s", scene->plan.families.items[s].place.name);
    begin_array(stream, name, 1);
    for (size_t c = 0; c < scree_grid_of(sensor)->cell_count; c++) {
      scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
      double n = (double)(scree_grid_of(sensor)->sample_count ? scree_grid_of(sensor)->sample_count
                                                              : 1),
             share = f.density > 0 ? f.shares[s] / n / f.density : 0;
      put_numbers(stream, &share, 1);
    }
    fputs("        </DataArray>\n", stream);
  }
}

static void put_corners(FILE *stream, const scree_plan_grid *plan, const size_t n[3]) {
  for (size_t k = 0; k <= n[2]; k++)
    for (size_t j = 0; j <= n[1]; j++)
      for (size_t i = 0; i <= n[0]; i++) {
        double at[3];
        vec3_store(at, place_at(plan, (double)i, (double)j, (double)k));
        put_numbers(stream, at, 3);
      }
}

/* VTK's XML of a structured grid, as text. */
static scree_status write(const scree_scene *scene, const scree_scene_sensor *sensor,
                          const scree_sensor_folder *folder, scree_error *error) {
  const scree_plan_grid *plan = sensor->plan->grid;
  const size_t n[3] = {(size_t)plan->cells[0], (size_t)plan->cells[1], (size_t)plan->cells[2]};
  scree_output output;
  SCREE_TRY(scree_sensor_open(folder, "grid.vts", &output, error));
  FILE *out = output.stream;
  fprintf(out,
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\" version=\"1.0\">\n"
          "  <StructuredGrid WholeExtent=\"0 %zu 0 %zu 0 %zu\">\n"
          "    <Piece Extent=\"0 %zu 0 %zu 0 %zu\">\n      <CellData>\n",
          n[0], n[1], n[2], n[0], n[1], n[2]);
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
    put_field(out, scene, sensor, &fields[i]);
  put_shares(out, scene, sensor);
  fputs("      </CellData>\n      <Points>\n", out);
  begin_array(out, "Points", 3);
  put_corners(out, plan, n);
  fputs("        </DataArray>\n      </Points>\n    </Piece>\n  </StructuredGrid>\n</VTKFile>\n",
        out);
  return scree_output_commit(&output, error);
}

/* ---- the rest ---- */

static void code(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  scree_scene_grid *grid = scree_grid_of(sensor);
  scree_code_reals(c, grid->sums, grid->number_count);
  scree_code_reals(c, grid->mixing, 2 * scene->plan.families.count);
  scree_code_u64(c, &grid->next);
  scree_code_u64(c, &grid->sample_count);
}

static const char *geometry(const scree_plan_sensor *plan) {
  return plan->grid->with;
}

const scree_sensor_kind scree_sensor_grid = {.state_size = sizeof(scree_scene_grid),
                                             .geometry = geometry,
                                             .columns = columns,
                                             .classes = classes,
                                             .read = read,
                                             .begin = begin,
                                             .next = next,
                                             .watch = watch,
                                             .code = code,
                                             .write = write,
                                             .doubt = doubt};
