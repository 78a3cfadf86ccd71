/* Impacts: what every contact of two bodies, or of a body and a wall, came with and cost.
 *
 * A contact is followed from the look at which it first touches to that at which it no longer does.
 * There are two looks at least in the shortest. Its kinetic energy of approach is what is left of
 * it at the first look, with what springs hold and dashpots have taken by then (world/hits.h). What
 * it dissipates is the difference of the ledger of its pair. Damage is the sum over all contacts of
 * W - W_min, W being the energy of approach, where that is above 0 (Vogel and Peukert, Powder
 * Technology 129, 101, 2003). Bodies share what a contact of two costs in halves. */
#include "scene/impacts.h"
#include "world/backend.h"
#include "world/hits.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/math.h"

#include <string.h>

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
                       const scree_scene_hit *hit) {
  size_t n = scree_scene_class_count(scene, by_of(sensor)), i = body_class(scene, sensor, hit->a);
  if (hit->wall)
    return n * (n + 1) / 2 + i * scene->plan.geometry.count +
           scree_scene_wall_geometry(scene, hit->b);
  size_t j = body_class(scene, sensor, hit->b), low = i < j ? i : j, high = i < j ? j : i;
  return high * (high + 1) / 2 + low;
}

void scree_impact_class_names(const scree_scene *scene, const scree_scene_sensor *sensor,
                              size_t index, const char *names[2]) {
  size_t n = scree_scene_class_count(scene, by_of(sensor)), pairs = n * (n + 1) / 2;
  if (index >= pairs) {
    size_t walls = scene->plan.geometry.count;
    names[0] = scree_scene_class_name(scene, by_of(sensor), (index - pairs) / walls);
    names[1] = scree_scene_geometry_name(scene, (index - pairs) % walls);
    return;
  }
  size_t high = 0;
  while ((high + 1) * (high + 2) / 2 <= index) high++;
  names[0] = scree_scene_class_name(scene, by_of(sensor), index - high * (high + 1) / 2);
  names[1] = scree_scene_class_name(scene, by_of(sensor), high);
}

/* ---- room ---- */

scree_status scree_scene_plan_impacts(scree_scene *scene, scree_scene_sensor *sensor,
                                      scree_error *error) {
  const scree_plan_impacts *plan = sensor->plan->impacts;
  scree_scene_impacts *made = scree_arena_take(&scene->arena, 1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "impacts");
  *made = (scree_scene_impacts){.window_from = sensor->plan->from};
  sensor->impacts = made;
  made->class_count = class_count(scene, sensor);
  double decades = scree_log10(plan->most / plan->least);
  made->bin_count = (size_t)ceil(decades * (double)plan->bins - 1e-9) + 2;
  size_t sums = made->class_count * SCREE_IMPACT_SUMS,
         spectra = made->class_count * SCREE_IMPACT_SPECTRA * made->bin_count;
  made->sums = scree_arena_take(&scene->arena, sums, sizeof *made->sums);
  made->spectra = scree_arena_take(&scene->arena, spectra, sizeof *made->spectra);
  if (!made->sums || !made->spectra)
    return scree_fail_memory(error, (sums + spectra) * sizeof *made->sums, "impacts");
  memset(made->sums, 0, sums * sizeof *made->sums);
  memset(made->spectra, 0, spectra * sizeof *made->spectra);
  scene->hit_steps = (uint64_t)fmax(1, floor(2 * scene->plan.contact->steps / LOOKS));
  return SCREE_OK;
}

void scree_scene_free_impacts(scree_scene_sensor *sensor) {
  if (!sensor->impacts) return;
  scree_free(sensor->impacts->windows.items);
  scree_free(sensor->impacts->bodies.items);
}

double scree_impact_bin(const scree_plan_impacts *plan, size_t bin) {
  return plan->least * scree_power_of_ten(((double)bin - 1) / (double)plan->bins);
}

static size_t bin_of(const scree_scene_impacts *impacts, const scree_plan_impacts *plan,
                     double energy) {
  if (!(energy >= plan->least)) return 0;
  double at = floor(scree_log10(energy / plan->least) * (double)plan->bins + 1e-12) + 1;
  return at < (double)impacts->bin_count ? (size_t)at : impacts->bin_count - 1;
}

/* ---- counting ---- */

static bool is_on(const scree_scene *scene, const scree_scene_sensor *sensor) {
  return sensor->impacts && scree_scene_is_watching(scene, sensor);
}

static double *of_body(scree_scene_impacts *impacts, uint32_t body) {
  size_t needed = ((size_t)body + 1) * SCREE_IMPACT_OF_BODY, had = impacts->bodies.count;
  if (!SCREE_RESERVE(&impacts->bodies, needed)) return NULL;
  if (needed > had) {
    memset(impacts->bodies.items + had, 0, (needed - had) * sizeof *impacts->bodies.items);
    impacts->bodies.count = needed;
  }
  return impacts->bodies.items + (size_t)body * SCREE_IMPACT_OF_BODY;
}

/* What was dissipated since the last look. */
static bool add_losses(scree_scene_impacts *impacts, size_t class, const scree_scene_hit *hit,
                       double normal, double tangential) {
  const double share = hit->wall ? 1 : 0.5;
  double *sums = impacts->sums + class * SCREE_IMPACT_SUMS;
  sums[SCREE_IMPACT_NORMAL] += normal;
  sums[SCREE_IMPACT_TANGENTIAL] += tangential;
  for (int side = 0; side < (hit->wall ? 1 : 2); side++) {
    double *body = of_body(impacts, side ? hit->b : hit->a);
    if (!body) return false;
    body[SCREE_IMPACT_NORMAL] += share * normal;
    body[SCREE_IMPACT_TANGENTIAL] += share * tangential;
  }
  return true;
}

/* A contact that is over. */
static bool count_hit(scree_scene_impacts *impacts, const scree_plan_impacts *plan, size_t class,
                      const scree_scene_hit *hit) {
  const double share = hit->wall ? 1 : 0.5, damage = fmax(0, hit->approach - plan->threshold);
  const double energies[SCREE_IMPACT_SPECTRA] = {hit->approach, hit->normal, hit->tangential};
  double *spectra = impacts->spectra + class * SCREE_IMPACT_SPECTRA * impacts->bin_count;
  for (size_t s = 0; s < SCREE_IMPACT_SPECTRA; s++)
    spectra[s * impacts->bin_count + bin_of(impacts, plan, energies[s])]++;
  double *sums = impacts->sums + class * SCREE_IMPACT_SUMS;
  sums[SCREE_IMPACT_COUNT]++;
  sums[SCREE_IMPACT_APPROACH] += hit->approach;
  sums[SCREE_IMPACT_DAMAGE] += damage;
  for (int side = 0; side < (hit->wall ? 1 : 2); side++) {
    double *body = of_body(impacts, side ? hit->b : hit->a);
    if (!body) return false;
    body[SCREE_IMPACT_COUNT]++;
    body[SCREE_IMPACT_APPROACH] += share * hit->approach;
    body[SCREE_IMPACT_DAMAGE] += share * damage;
    body[SCREE_IMPACT_LARGEST] = fmax(body[SCREE_IMPACT_LARGEST], hit->approach);
  }
  return true;
}

static bool tell_losses(scree_scene *scene, const scree_scene_hit *hit, double normal,
                        double tangential) {
  bool good = true;
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++)
    if (is_on(scene, &scene->sensors[i]))
      good = add_losses(scene->sensors[i].impacts, class_of(scene, &scene->sensors[i], hit), hit,
                        normal, tangential);
  return good;
}

static bool tell_hit(scree_scene *scene, const scree_scene_hit *hit) {
  bool good = true;
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++)
    if (is_on(scene, &scene->sensors[i]))
      good = count_hit(scene->sensors[i].impacts, scene->sensors[i].plan->impacts,
                       class_of(scene, &scene->sensors[i], hit), hit);
  return good;
}

/* ---- looking ---- */

static int order_of(const scree_scene_hit *hit, const scree_pair_losses *l) {
  if (hit->a != l->a) return hit->a < l->a ? -1 : 1;
  if (hit->wall != l->wall) return hit->wall ? 1 : -1;
  return hit->b == l->b ? 0 : hit->b < l->b ? -1 : 1;
}

/* One pair at this look, and how it was at the last: hit, all 0 where it was not there. */
static bool follow(scree_scene *scene, size_t neighbours, const scree_pair_losses *now,
                   scree_pair_copy *copy, scree_scene_hit *hit) {
  double normal = now->normal - hit->seen_normal,
         tangential = now->tangential - hit->seen_tangential;
  bool touched = hit->touching, passed = !touched && !now->touching && normal + tangential > 0;
  hit->a = now->a, hit->b = now->b, hit->wall = now->wall;
  hit->seen_normal = now->normal, hit->seen_tangential = now->tangential;
  if (!touched) hit->normal = hit->tangential = hit->approach = 0;
  hit->normal += normal, hit->tangential += tangential;
  if (!touched && now->touching) {
    if (!scree_pair_normal_energy(scene->world, neighbours, copy, &hit->approach)) return false;
    hit->approach += normal;
  }
  if (passed) hit->approach = hit->normal; /* a graze between two looks */
  hit->touching = now->touching;
  if ((normal != 0 || tangential != 0) && !tell_losses(scene, hit, normal, tangential))
    return false;
  return (touched || passed) && !now->touching ? tell_hit(scene, hit) : true;
}

/* Those that are no more neighbours have parted, after the last look. */
static bool drop(scree_scene *scene, scree_scene_hit *hit) {
  bool touched = hit->touching;
  hit->touching = false;
  return touched ? tell_hit(scene, hit) : true;
}

static bool look(scree_scene *scene) {
  scree_pair_copy copy = {0};
  scree_pair_losses now;
  size_t k = 0, old = 0;
  bool good = true;
  scene->hits_now.count = 0;
  while (good && scree_next_losses(scene->world, &k, &now)) {
    scree_scene_hit hit = {0};
    while (good && old < scene->hits.count && order_of(&scene->hits.items[old], &now) < 0)
      good = drop(scene, &scene->hits.items[old++]);
    if (old < scene->hits.count && order_of(&scene->hits.items[old], &now) == 0)
      hit = scene->hits.items[old++];
    good = good && follow(scene, k - 1, &now, &copy, &hit) && SCREE_PUSH(&scene->hits_now, hit);
  }
  while (good && old < scene->hits.count) good = drop(scene, &scene->hits.items[old++]);
  scree_free_pair_copy(&copy);
  scree_scene_hits last = scene->hits;
  scene->hits = scene->hits_now;
  scene->hits_now = last;
  return good;
}

/* A window that is over is kept, and the next begins. */
static bool turn_window(const scree_scene *scene, scree_scene_sensor *sensor) {
  scree_scene_impacts *impacts = sensor->impacts;
  double time = scree_world_time(scene->world), length = sensor->plan->impacts->window;
  if (isnan(length) || time < impacts->window_from + length) return true;
  size_t width = impacts->class_count * SCREE_IMPACT_SPECTRA * impacts->bin_count,
         used = impacts->windows.count;
  if (!SCREE_RESERVE(&impacts->windows, used + width + 2)) return false;
  double *row = impacts->windows.items + used;
  row[0] = impacts->window_from, row[1] = time;
  memcpy(row + 2, impacts->spectra, width * sizeof *row);
  memset(impacts->spectra, 0, width * sizeof *row);
  impacts->windows.count += width + 2;
  impacts->window_from = time;
  return true;
}

scree_status scree_scene_watch_impacts(scree_scene *scene, scree_error *error) {
  if (!scene->hit_steps || scree_world_step_count(scene->world) < scene->next_hits) return SCREE_OK;
  SCREE_TRY(scree_world_bring(scene->world, SCREE_ALL_PARTS, error));
  bool good = look(scene);
  for (size_t i = 0; good && i < scene->plan.sensors.count; i++)
    if (is_on(scene, &scene->sensors[i])) good = turn_window(scene, &scene->sensors[i]);
  scene->next_hits += scene->hit_steps;
  return good ? SCREE_OK : scree_fail_memory(error, 0, "impacts");
}
