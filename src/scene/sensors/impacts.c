/* Impacts: what every contact of two bodies, or of a body and a wall, came with and cost.
 *
 * A contact is followed from the look at which it first touches to that at which it no longer does.
 * There are two looks at least in the shortest. Its kinetic energy of approach is what is left of
 * it at the first look, with what springs hold and dashpots have taken by then (world/hits.h). What
 * it dissipates is the difference of the ledger of its pair. Damage is the sum over all contacts of
 * W - W_min, W being the energy of approach, where that is above 0 (Vogel and Peukert, Powder
 * Technology 129, 101, 2003). Bodies share what a contact of two costs in halves. */
#include "scene/sensors/sensor.h"
#include "world/observe/hits.h"
#include "world/state/remote.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/math.h"

#include <string.h>

#define SCREE_PLAN_IMPACTS(ROW, T)                                                                 \
  ROW(T, WORD, by, 0, "shape|material", "classes of bodies; geometry by name")                     \
  ROW(T, REAL, least, 1e-9, 1e-18, 1e12, "J", "where the spectra begin")                           \
  ROW(T, REAL, most, 1e3, 1e-18, 1e12, "J", "and end")                                             \
  ROW(T, COUNT, bins, 5, 1, 100, "in a decade of energy")                                          \
  ROW(T, REAL, threshold, 0, 0, 1e12, "J", "damage is what the energy of approach exceeds it by")  \
  ROW(T, REAL, window, NAN, 1e-9, 1e9, "s", "a spectrum for each; not given: one of all")
SCREE_RECORD_TYPE(scree_plan_impacts, SCREE_PLAN_IMPACTS)

static scree_status check_impacts(const scree_reader *r, const void *record) {
  const scree_plan_impacts *p = record;
  if (p->least < p->most) return SCREE_OK;
  return scree_fail_place(r, &p->place, "least %g J must be below most %g J", p->least, p->most);
}
SCREE_RECORD_TABLE(scree_plan_impacts, SCREE_PLAN_IMPACTS, "impacts", NULL, check_impacts)

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

typedef struct impacts {
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
} impacts;

/* A contact that is followed, or the last one of these neighbours. */
typedef struct hit_record {
  uint32_t a, b;
  bool wall, touching;
  double seen_normal, seen_tangential; /* J, the pair's losses at the last look */
  double approach, normal, tangential; /* J, of the contact */
} hit_record;

typedef struct hit_list {
  hit_record *items; /* in the order of the world's neighbours */
  size_t count, capacity;
} hit_list;

/* What all impacts sensors follow together. */
typedef struct following {
  uint64_t steps, next; /* from one look to the next; the step of that */
  hit_list hits, now;   /* now: scratch */
} following;

static impacts *impacts_of(const scree_scene_sensor *sensor) {
  return scree_sensor_state(sensor, &scree_sensor_impacts);
}

enum { LOOKS = 4 }; /* in the shortest contact, which lasts twice `contact.steps` */

/* ---- classes ---- */

static int by_of(const scree_scene_sensor *sensor) {
  return sensor->plan->impacts->by ? SCREE_BY_MATERIAL : SCREE_BY_SHAPE;
}

static size_t body_class(const scree_scene *scene, const scree_scene_sensor *sensor, size_t body) {
  return scree_scene_class_of(scene, by_of(sensor), scene->shape_of.items[body]);
}

static size_t class_count(const scree_scene *scene, const scree_scene_sensor *sensor) {
  size_t n = scree_scene_class_count(scene, by_of(sensor));
  return n * (n + 1) / 2 + n * scene->plan.geometry.count;
}

/* First the pairs of bodies, (0, 0), (0, 1), (1, 1), (0, 2), ..., then bodies and geometry. */
static size_t class_of(const scree_scene *scene, const scree_scene_sensor *sensor,
                       const hit_record *hit) {
  size_t n = scree_scene_class_count(scene, by_of(sensor)), i = body_class(scene, sensor, hit->a);
  if (hit->wall)
    return n * (n + 1) / 2 + i * scene->plan.geometry.count +
           scree_scene_wall_geometry(scene, hit->b);
  size_t j = body_class(scene, sensor, hit->b), low = i < j ? i : j, high = i < j ? j : i;
  return high * (high + 1) / 2 + low;
}

static void class_names(const scree_scene *scene, int by, size_t index, const char *names[2]) {
  size_t n = scree_scene_class_count(scene, by), pairs = n * (n + 1) / 2;
  if (index >= pairs) {
    size_t walls = scene->plan.geometry.count;
    names[0] = scree_scene_class_name(scene, by, (index - pairs) / walls);
    names[1] = scree_scene_geometry_name(scene, (index - pairs) % walls);
    return;
  }
  size_t high = 0;
  while ((high + 1) * (high + 2) / 2 <= index) high++;
  names[0] = scree_scene_class_name(scene, by, index - high * (high + 1) / 2);
  names[1] = scree_scene_class_name(scene, by, high);
}

/* A-B */
static void pair_name(const scree_scene *scene, int by, size_t index, char *text, size_t size) {
  const char *names[2];
  class_names(scene, by, index, names);
  snprintf(text, size, "%s-%s", names[0], names[1]);
}

/* ---- room ---- */

static scree_status begin(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  const scree_plan_impacts *plan = sensor->plan->impacts;
  impacts *made = sensor->state;
  double decades = scree_log10(plan->most / plan->least);
  made->window_from = sensor->plan->from;
  made->class_count = class_count(scene, sensor);
  made->bin_count = (size_t)ceil(decades * (double)plan->bins - 1e-9) + 2;
  size_t spectra = made->class_count * SCREE_IMPACT_SPECTRA * made->bin_count;
  SCREE_TRY_TAKE(made->sums, &scene->arena, made->class_count * SCREE_IMPACT_SUMS, error);
  SCREE_TRY_TAKE(made->spectra, &scene->arena, spectra, error);
  following *all = sensor->shared;
  if (!all->steps) all->next = scree_world_step_count(scene->world);
  all->steps = (uint64_t)fmax(1, floor(2 * scene->plan.contact->steps / LOOKS));
  return SCREE_OK;
}

static void end(scree_scene_sensor *sensor) {
  scree_free(impacts_of(sensor)->windows.items);
  scree_free(impacts_of(sensor)->bodies.items);
}

/* J, where the bin begins; bin 0 begins at 0. */
static double bin_begin(const scree_plan_impacts *plan, size_t bin) {
  return plan->least * scree_power_of_ten(((double)bin - 1) / (double)plan->bins);
}

static size_t bin_of(const impacts *of, const scree_plan_impacts *plan, double energy) {
  if (!(energy >= plan->least)) return 0;
  double at = floor(scree_log10(energy / plan->least) * (double)plan->bins + 1e-12) + 1;
  return at < (double)of->bin_count ? (size_t)at : of->bin_count - 1;
}

/* ---- counting ---- */

static bool is_on(const scree_scene *scene, const scree_scene_sensor *sensor) {
  return impacts_of(sensor) && scree_sensor_is_on(scene, sensor);
}

static double *of_body(impacts *of, uint32_t body) {
  size_t needed = ((size_t)body + 1) * SCREE_IMPACT_OF_BODY, had = of->bodies.count;
  if (!SCREE_RESERVE(&of->bodies, needed)) return NULL;
  if (needed > had) {
    memset(of->bodies.items + had, 0, (needed - had) * sizeof *of->bodies.items);
    of->bodies.count = needed;
  }
  return of->bodies.items + (size_t)body * SCREE_IMPACT_OF_BODY;
}

/* What was dissipated since the last look. */
static bool add_losses(impacts *of, size_t class, const hit_record *hit, double normal,
                       double tangential) {
  const double share = hit->wall ? 1 : 0.5;
  double *sums = of->sums + class * SCREE_IMPACT_SUMS;
  sums[SCREE_IMPACT_NORMAL] += normal;
  sums[SCREE_IMPACT_TANGENTIAL] += tangential;
  for (int side = 0; side < (hit->wall ? 1 : 2); side++) {
    double *body = of_body(of, side ? hit->b : hit->a);
    if (!body) return false;
    body[SCREE_IMPACT_NORMAL] += share * normal;
    body[SCREE_IMPACT_TANGENTIAL] += share * tangential;
  }
  return true;
}

/* A contact that is over. */
static bool count_hit(impacts *of, const scree_plan_impacts *plan, size_t class,
                      const hit_record *hit) {
  const double share = hit->wall ? 1 : 0.5, damage = fmax(0, hit->approach - plan->threshold);
  const double energies[SCREE_IMPACT_SPECTRA] = {hit->approach, hit->normal, hit->tangential};
  double *spectra = of->spectra + class * SCREE_IMPACT_SPECTRA * of->bin_count;
  for (size_t s = 0; s < SCREE_IMPACT_SPECTRA; s++)
    spectra[s * of->bin_count + bin_of(of, plan, energies[s])]++;
  double *sums = of->sums + class * SCREE_IMPACT_SUMS;
  sums[SCREE_IMPACT_COUNT]++;
  sums[SCREE_IMPACT_APPROACH] += hit->approach;
  sums[SCREE_IMPACT_DAMAGE] += damage;
  for (int side = 0; side < (hit->wall ? 1 : 2); side++) {
    double *body = of_body(of, side ? hit->b : hit->a);
    if (!body) return false;
    body[SCREE_IMPACT_COUNT]++;
    body[SCREE_IMPACT_APPROACH] += share * hit->approach;
    body[SCREE_IMPACT_DAMAGE] += share * damage;
    body[SCREE_IMPACT_LARGEST] = fmax(body[SCREE_IMPACT_LARGEST], hit->approach);
  }
  return true;
}

static bool tell_losses(scree_scene *scene, const hit_record *hit, double normal,
                        double tangential) {
  bool good = true;
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++)
    if (is_on(scene, &scene->sensors[i]))
      good = add_losses(impacts_of(&scene->sensors[i]), class_of(scene, &scene->sensors[i], hit),
                        hit, normal, tangential);
  return good;
}

static bool tell_hit(scree_scene *scene, const hit_record *hit) {
  bool good = true;
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++)
    if (is_on(scene, &scene->sensors[i]))
      good = count_hit(impacts_of(&scene->sensors[i]), scene->sensors[i].plan->impacts,
                       class_of(scene, &scene->sensors[i], hit), hit);
  return good;
}

/* ---- looking ---- */

static int order_of(const hit_record *hit, const scree_pair_losses *l) {
  if (hit->a != l->a) return hit->a < l->a ? -1 : 1;
  if (hit->wall != l->wall) return hit->wall ? 1 : -1;
  return hit->b == l->b ? 0 : hit->b < l->b ? -1 : 1;
}

/* One pair at this look, and how it was at the last: hit, all 0 where it was not there. */
static bool follow(scree_scene *scene, const scree_pair_losses *now, scree_pair_copy *copy,
                   hit_record *hit) {
  double normal = now->normal - hit->seen_normal,
         tangential = now->tangential - hit->seen_tangential;
  bool touched = hit->touching, passed = !touched && !now->touching && normal + tangential > 0;
  hit->a = now->a, hit->b = now->b, hit->wall = now->wall;
  hit->seen_normal = now->normal, hit->seen_tangential = now->tangential;
  if (!touched) hit->normal = hit->tangential = hit->approach = 0;
  hit->normal += normal, hit->tangential += tangential;
  if (!touched && now->touching) {
    if (!scree_pair_normal_energy(scene->world, now->at, copy, &hit->approach)) return false;
    hit->approach += normal;
  }
  if (passed) hit->approach = hit->normal; /* a graze between two looks */
  hit->touching = now->touching;
  if ((normal != 0 || tangential != 0) && !tell_losses(scene, hit, normal, tangential))
    return false;
  return (touched || passed) && !now->touching ? tell_hit(scene, hit) : true;
}

/* Those that are no more neighbours have parted, after the last look. */
static bool drop(scree_scene *scene, hit_record *hit) {
  bool touched = hit->touching;
  hit->touching = false;
  return touched ? tell_hit(scene, hit) : true;
}

static bool look(scree_scene *scene, following *all) {
  scree_pair_copy copy = {0};
  scree_losses losses = {0};
  size_t old = 0;
  bool good = scree_find_losses(scene->world, &losses);
  all->now.count = 0;
  for (size_t k = 0; k < losses.count && good; k++) {
    const scree_pair_losses *now = &losses.items[k];
    hit_record hit = {0};
    while (good && old < all->hits.count && order_of(&all->hits.items[old], now) < 0)
      good = drop(scene, &all->hits.items[old++]);
    if (old < all->hits.count && order_of(&all->hits.items[old], now) == 0)
      hit = all->hits.items[old++];
    good = good && follow(scene, now, &copy, &hit) && SCREE_PUSH(&all->now, hit);
  }
  scree_free(losses.items);
  while (good && old < all->hits.count) good = drop(scene, &all->hits.items[old++]);
  scree_free_pair_copy(&copy);
  hit_list last = all->hits;
  all->hits = all->now;
  all->now = last;
  return good;
}

/* A window that is over is kept, and the next begins. */
static bool turn_window(const scree_scene *scene, scree_scene_sensor *sensor) {
  impacts *of = impacts_of(sensor);
  double time = scree_world_time(scene->world), length = sensor->plan->impacts->window;
  if (isnan(length) || time < of->window_from + length) return true;
  size_t width = of->class_count * SCREE_IMPACT_SPECTRA * of->bin_count, used = of->windows.count;
  if (!SCREE_RESERVE(&of->windows, used + width + 2)) return false;
  double *row = of->windows.items + used;
  row[0] = of->window_from, row[1] = time;
  memcpy(row + 2, of->spectra, width * sizeof *row);
  memset(of->spectra, 0, width * sizeof *row);
  of->windows.count += width + 2;
  of->window_from = time;
  return true;
}

static uint64_t next_shared(const void *shared) {
  return ((const following *)shared)->next;
}

static scree_status watch_shared(scree_scene *scene, void *shared, scree_error *error) {
  following *all = shared;
  SCREE_TRY(scree_world_bring(scene->world, SCREE_ALL_PARTS, error));
  bool good = look(scene, all);
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++)
    if (is_on(scene, &scene->sensors[i])) good = turn_window(scene, &scene->sensors[i]);
  all->next += all->steps;
  return good ? SCREE_OK : scree_fail_memory(error, 0, "impacts");
}

static void code_hit(scree_codec *c, hit_record *hit) {
  double *reals[] = {&hit->seen_normal, &hit->seen_tangential, &hit->approach, &hit->normal,
                     &hit->tangential};
  scree_code_u32(c, &hit->a);
  scree_code_u32(c, &hit->b);
  scree_code_bool(c, &hit->wall);
  scree_code_bool(c, &hit->touching);
  for (size_t k = 0; k < sizeof reals / sizeof *reals; k++) scree_code_real(c, reals[k]);
}

static void code_hits(scree_codec *c, hit_record *hits, size_t count) {
  for (size_t i = 0; i < count; i++) code_hit(c, &hits[i]);
}

static void code_shared(scree_codec *c, void *shared) {
  following *all = shared;
  scree_code_u64(c, &all->next);
  SCREE_CODE_LIST(c, &all->hits, 50, code_hits);
}

static void end_shared(void *shared) {
  following *all = shared;
  scree_free(all->hits.items);
  scree_free(all->now.items);
}

/* ---- the series ---- */

/* Columns as they are summed; the rate follows from the count. */
static const scree_sensor_column columns[] = {{"count", "", SCREE_OF_ALL_AND_EACH},
                                              {"approach", "J", SCREE_OF_ALL_AND_EACH},
                                              {"normal", "J", SCREE_OF_ALL_AND_EACH},
                                              {"tangential", "J", SCREE_OF_ALL_AND_EACH},
                                              {"damage", "J", SCREE_OF_ALL_AND_EACH},
                                              {"rate", "1/s", SCREE_OF_ALL_AND_EACH},
                                              {0}};

static scree_sensor_classes classes(const scree_scene *scene, const scree_scene_sensor *sensor) {
  return (scree_sensor_classes){class_count(scene, sensor), by_of(sensor), pair_name};
}

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const impacts *of = impacts_of(sensor);
  size_t classes = of->class_count, width = scree_sensor_width(classes);
  const double since = fmax(sensor->plan->from, now->last_time), *counts = at;
  (void)scene, (void)error;
  for (size_t k = 0; k < SCREE_IMPACT_SUMS; k++, at += width) {
    at[0] = 0;
    for (size_t c = 0; c < classes; c++) {
      double value = of->sums[c * SCREE_IMPACT_SUMS + k];
      at[0] += value;
      if (classes > 1) at[1 + c] = value;
    }
  }
  for (size_t k = 0; k < width; k++)
    at[k] = now->time > since ? (counts[k] - (now->last ? now->last[k] : 0)) / (now->time - since)
                              : NAN;
  return SCREE_OK;
}

/* ---- tables ---- */

static scree_status put_spectra(const scree_scene *scene, const scree_scene_sensor *sensor,
                                const double window[2], const double *spectra,
                                scree_sensor_rows *rows, scree_error *error) {
  const impacts *of = impacts_of(sensor);
  const size_t bins = of->bin_count;
  for (size_t c = 0; c < of->class_count; c++, spectra += SCREE_IMPACT_SPECTRA * bins) {
    const char *names[2];
    class_names(scene, by_of(sensor), c, names);
    for (size_t b = 0; b < bins; b++) {
      double low = b ? bin_begin(sensor->plan->impacts, b) : 0,
             high = b + 1 < bins ? bin_begin(sensor->plan->impacts, b + 1) : (double)INFINITY;
      if (spectra[b] + spectra[bins + b] + spectra[2 * bins + b] == 0) continue;
      const double row[] = {window[0],
                            window[1],
                            NAN,
                            NAN,
                            low,
                            high,
                            spectra[b],
                            spectra[bins + b],
                            spectra[2 * bins + b]};
      const char *const texts[sizeof row / sizeof *row] = {[2] = names[0], names[1]};
      SCREE_TRY(scree_sensor_put_row(rows, row, texts, error));
    }
  }
  return SCREE_OK;
}

static scree_status fill_spectra(const scree_scene *scene, const scree_scene_sensor *sensor,
                                 scree_sensor_rows *rows, scree_error *error) {
  const impacts *of = impacts_of(sensor);
  const size_t width = of->class_count * SCREE_IMPACT_SPECTRA * of->bin_count + 2;
  for (size_t at = 0; at + width <= of->windows.count; at += width)
    SCREE_TRY(put_spectra(scene, sensor, of->windows.items + at, of->windows.items + at + 2, rows,
                          error));
  const double last[2] = {of->window_from, scree_world_time(scene->world)};
  return put_spectra(scene, sensor, last, of->spectra, rows, error);
}

static scree_status fill_bodies(const scree_scene *scene, const scree_scene_sensor *sensor,
                                scree_sensor_rows *rows, scree_error *error) {
  const impacts *of = impacts_of(sensor);
  for (size_t b = 0; b < of->bodies.count / SCREE_IMPACT_OF_BODY; b++) {
    const double *v = of->bodies.items + b * SCREE_IMPACT_OF_BODY;
    if (v[SCREE_IMPACT_COUNT] + v[SCREE_IMPACT_NORMAL] + v[SCREE_IMPACT_TANGENTIAL] == 0) continue;
    double row[2 + SCREE_IMPACT_OF_BODY] = {(double)b, NAN};
    memcpy(row + 2, v, SCREE_IMPACT_OF_BODY * sizeof *v);
    const char *const texts[sizeof row / sizeof *row] = {
        NULL, scree_scene_shape_name(scene, scree_scene_body_shape(scene, b))};
    SCREE_TRY(scree_sensor_put_row(rows, row, texts, error));
  }
  return SCREE_OK;
}

static const scree_sensor_table tables[] = {{"spectra",
                                             false,
                                             {{"from", "s", 0},
                                              {"until", "s", 0},
                                              {"a", "", 0},
                                              {"b", "", 0},
                                              {"energy_from", "J", 6},
                                              {"energy_until", "J", 6},
                                              {"approach", "", 0},
                                              {"normal", "", 0},
                                              {"tangential", "", 0}},
                                             fill_spectra},
                                            {"bodies",
                                             true,
                                             {{"body", "", 0},
                                              {"shape", "", 0},
                                              {"count", "", 0},
                                              {"approach", "J", 0},
                                              {"normal", "J", 0},
                                              {"tangential", "J", 0},
                                              {"damage", "J", 0},
                                              {"largest", "J", 0}},
                                             fill_bodies},
                                            {0}};

/* ---- the rest ---- */

static void code(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  impacts *of = impacts_of(sensor);
  (void)scene;
  scree_code_reals(c, of->sums, of->class_count * SCREE_IMPACT_SUMS);
  scree_code_reals(c, of->spectra, of->class_count * SCREE_IMPACT_SPECTRA * of->bin_count);
  scree_code_real(c, &of->window_from);
  SCREE_CODE_LIST(c, &of->windows, 8, scree_code_reals);
  SCREE_CODE_LIST(c, &of->bodies, 8, scree_code_reals);
}

const scree_sensor_kind scree_sensor_impacts = {.state_size = sizeof(impacts),
                                                .columns = columns,
                                                .classes = classes,
                                                .read = read,
                                                .begin = begin,
                                                .code = code,
                                                .end = end,
                                                .shared_size = sizeof(following),
                                                .next_shared = next_shared,
                                                .watch_shared = watch_shared,
                                                .code_shared = code_shared,
                                                .end_shared = end_shared,
                                                .tables = tables};
