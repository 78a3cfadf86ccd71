/* Who passes through a plane: bodies whose centre is on the other side than at the last tick;
 * what hangs together by joints is counted with its first. */
#include "scene/sensors/sensor.h"

#include "base/alloc.h"
#include "base/array.h"

#define SCREE_PLAN_FLOW(ROW, T)                                                                    \
  ROW(T, VECTOR, through, SCREE_NONE, -1e6, 1e6, "m", "a point of the plane")                      \
  ROW(T, DIRECTION, normal, (0, 0, 1), "along it counts up, against it down")                      \
  ROW(T, REAL, radius, NAN, 0, 1e6, "m", "about the point; not given: all of it")
SCREE_RECORD_TYPE(scree_plan_flow, SCREE_PLAN_FLOW)
SCREE_RECORD_TABLE(scree_plan_flow, SCREE_PLAN_FLOW, "a flow", "through: [x, y, z]", NULL)

typedef struct flow {
  double *count, *mass; /* by shape, all shapes last */
  struct {
    int8_t *items; /* the side each body was on */
    size_t count, capacity;
  } side;
} flow;

static scree_status begin(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  flow *f = sensor->state;
  SCREE_TRY_TAKE(f->count, &scene->arena, scene->named_count + 1, error);
  SCREE_TRY_TAKE(f->mass, &scene->arena, scene->named_count + 1, error);
  return SCREE_OK;
}

static void end(scree_scene_sensor *sensor) {
  scree_free(((flow *)sensor->state)->side.items);
}

static void count_crossing(const scree_scene *scene, flow *f, size_t body, int way) {
  size_t all = scene->named_count, shape = scree_scene_named(scene, scene->shape_of.items[body]);
  double mass = way * scree_world_body_mass(scene->world, body),
         count = scree_scene_counts(scene, body) ? way : 0;
  f->count[shape] += count;
  f->count[all] += count;
  f->mass[shape] += mass;
  f->mass[all] += mass;
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

static scree_status watch(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  const scree_plan_flow *plan = sensor->plan->flow;
  flow *f = sensor->state;
  vec3 n = vec3_unit(vec3_load(plan->normal)), through = vec3_load(plan->through);
  size_t count = scene->shape_of.count;
  double far = across_boundary(scene, n);
  if (!SCREE_RESERVE(&f->side, count)) return scree_fail_memory(error, count, "a flow's bodies");
  for (size_t b = 0; b < count; b++) {
    if (scree_world_body_removed(scene->world, b)) continue;
    scree_body body;
    scree_world_get_body(scene->world, b, &body);
    vec3 d = vec3_sub(vec3_load(body.position), through);
    double height = vec3_dot(d, n);
    int8_t side = height < 0 ? -1 : 1;
    bool known = b < f->side.count;
    bool crossed = known && side != f->side.items[b] && fabs(height) < far;
    if (crossed && (isnan(plan->radius) || vec3_norm(vec3_mad(d, n, -height)) <= plan->radius))
      count_crossing(scene, f, b, side);
    f->side.items[b] = side;
    if (!known) f->side.count = b + 1;
  }
  return SCREE_OK;
}

/* ---- the series ---- */

static const scree_sensor_column columns[] = {{"count", "", SCREE_OF_ALL_AND_EACH},
                                              {"mass", "kg", SCREE_OF_ALL_AND_EACH},
                                              {"rate", "1/s", SCREE_OF_ALL_AND_EACH},
                                              {"mass_rate", "kg/s", SCREE_OF_ALL_AND_EACH},
                                              {0}};

static scree_sensor_classes classes(const scree_scene *scene, const scree_scene_sensor *sensor) {
  (void)sensor;
  return scree_classes_by(scene, SCREE_BY_SIZE);
}

/* Counts and masses, and since the last row how many a second. */
static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const flow *f = sensor->state;
  const double *of[] = {f->count, f->mass}, since = fmax(0, now->last_time);
  size_t shapes = scene->named_count, width = scree_sensor_width(shapes);
  (void)error;
  for (size_t k = 0; k < 2; k++) {
    at[k * width] = of[k][shapes];
    for (size_t s = 0; shapes > 1 && s < shapes; s++) at[k * width + 1 + s] = of[k][s];
  }
  for (size_t k = 0; k < 2 * width; k++)
    at[2 * width + k] =
        now->time > since ? (at[k] - (now->last ? now->last[k] : 0)) / (now->time - since) : NAN;
  return SCREE_OK;
}

/* ---- the rest ---- */

static void code(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  flow *f = sensor->state;
  scree_code_reals(c, f->count, scene->named_count + 1);
  scree_code_reals(c, f->mass, scene->named_count + 1);
  SCREE_CODE_LIST(c, &f->side, 1, scree_code_bytes);
}

static void reach(const scree_plan_sensor *plan, double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) low[k] = high[k] = plan->flow->through[k];
}

const scree_sensor_kind scree_sensor_flow = {.state_size = sizeof(flow),
                                             .reach = reach,
                                             .columns = columns,
                                             .classes = classes,
                                             .read = read,
                                             .begin = begin,
                                             .watch = watch,
                                             .code = code,
                                             .end = end};
