/* The step: pairs, forces, advance. Every pair adds to a ledger of its own, and every body sums its
 * pairs in list order, so that the result does not depend on the threads. */
#include "world/backend.h"
#include "world/broad.h"
#include "world/checkpoint.h"
#include "world/contact.h"
#include "world/integrate.h"
#include "world/materials.h"
#include "world/pairs.h"
#include "world/spheres.h"
#include "world/stages.h"
#include "world/walls.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/atomic.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <stddef.h>
#include <string.h>

/* Several blocks are gone through at once where there are many, for at the beginning nothing was
 * asked for. */
enum { MOST_BLOCKS = 8, LEAST_PARTS = 32 };

bool scree_is_awake(const scree_world *world, size_t k) {
  const scree_slot *slot = &world->slots.items[k];
  return world->wake_threshold.items[slot->a] + world->wake_threshold.items[slot->b] >= slot->wake;
}

/* Without branches: one in five is. */
static size_t list_awake(const scree_world *world, size_t begin, size_t end, uint32_t *awake) {
  size_t count = 0;
  for (size_t k = begin; k < end; k++) {
    awake[count] = (uint32_t)k;
    count += scree_is_awake(world, k);
  }
  return count;
}

/* The pair and what its evaluation reads first. */
SCREE_PREFETCHES void fetch_pair(const scree_world *world, size_t k) {
  const scree_pair *pair = scree_pair_of(world, k);
  if (pair)
    scree_prefetch(pair, offsetof(scree_pair, separation));
  else
    scree_prefetch(&world->neighbours.items[k], sizeof(scree_neighbours));
  size_t b = world->slots.items[k].b;
  if (b < world->bodies.count) scree_prefetch(&world->bodies.frame[b], sizeof(scree_frame));
}

/* Whether it is likely that feature pairs of the pair wake in the coming step. */
static bool may_wake_features(const scree_pair *pair) {
  return pair->list.path + 4 * pair->list.travel >= pair->list.next_feature;
}

/* The feature pairs of a pair that has come, wherever they are. */
SCREE_PREFETCHES void fetch_features(const scree_world *world, const scree_pair *pair) {
  if (!pair || pair->spheres) return;
  const scree_feature_pair *features = &world->pools.features[pair->active.first];
  scree_prefetch(features, sizeof *features);
  if (pair->active.count > 1)
    scree_prefetch(features + 1, (pair->active.count - 1) * sizeof *features);
  if (may_wake_features(pair))
    scree_prefetch(&world->neighbours.items[pair->neighbours].sleeping, 1);
}

SCREE_PREFETCHES void fetch_faces(const scree_particle *surface,
                                  const scree_feature_pair *feature) {
  for (uint32_t i = 0; i < feature->face_count; i++)
    scree_prefetch(&surface->faces[feature->face[i]], sizeof(scree_face));
}

/* What feature pairs that have come read of their shapes. */
SCREE_PREFETCHES void fetch_shapes(const scree_world *world, const scree_pair *pair) {
  if (!pair || pair->spheres) return;
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  for (uint32_t i = 0; i < pair->active.count; i++) {
    const scree_feature_pair *feature = &world->pools.features[pair->active.first + i];
    if (feature->kind == SCREE_FEATURE_EDGE_EDGE) {
      scree_prefetch(&a->edges[feature->a], sizeof(scree_edge));
      scree_prefetch(&b->edges[feature->b], sizeof(scree_edge));
    } else if (feature->kind == SCREE_FEATURE_POINT_FACE) {
      scree_prefetch(&a->points[feature->a], 1);
      fetch_faces(b, feature);
    } else if (feature->kind == SCREE_FEATURE_FACE_POINT) {
      scree_prefetch(&b->points[feature->b], 1);
      fetch_faces(a, feature);
    }
  }
  if (may_wake_features(pair))
    scree_prefetch(
        &world->pools.sleeping_features[world->neighbours.items[pair->neighbours].sleeping.first],
        256);
}

enum { PAIRS_AHEAD = 8, FEATURES_AHEAD = 4, SHAPES_AHEAD = 2 };

void scree_balance_add(scree_balance *balance, const scree_pair_work *work) {
  balance->dashpot += work->later_dashpot + work->dashpot - work->lost - work->let_go;
  balance->tangential += work->later_tangential + work->tangential;
  balance->wall += work->wall;
}

void scree_note_pair(scree_tally *tally, const scree_pair *pair, const scree_pair_work *work) {
  uint32_t k = pair->neighbours;
  if (work->beyond_limit) scree_atomic_lower(&tally->trouble.beyond_limit, k);
  if (work->passed) scree_atomic_lower(&tally->trouble.passed, k);
  if (work->too_fast) scree_atomic_lower(&tally->trouble.too_fast, k);
  if (work->start_depth > 0) scree_atomic_lower(&tally->trouble.start, k);
  if (work->begins_depenetration) scree_atomic_add(&tally->depenetrations, 1);
  if (!pair->touching) return;
  uint64_t bits;
  memcpy(&bits, &pair->overlap, sizeof bits);
  scree_atomic_raise(&tally->largest_overlap, bits);
}

double scree_largest_overlap(const scree_tally *tally) {
  double overlap;
  memcpy(&overlap, &tally->largest_overlap, sizeof overlap);
  return overlap;
}

uint32_t scree_pair_at(scree_world *world, uint32_t k) {
  uint32_t pair = world->pair_of.items[k];
  if (pair != scree_none) return pair;
  pair = scree_pair_take(world);
  if (pair == scree_none) return pair;
  scree_pair_begin(&world->pairs.items[pair], &world->neighbours.items[k], k);
  return world->pair_of.items[k] = pair;
}

bool scree_settle_pair(scree_world *world, const scree_pair *pair) {
  uint32_t k = pair->neighbours;
  scree_slot *slot = &world->slots.items[k];
  if (pair->touching != scree_pair_touches(world, k)) scree_mark_touching(world, k, pair->touching);
  if (scree_pair_stays_awake(pair)) {
    slot->wake = -INFINITY;
    return false;
  }
  scree_neighbours *n = &world->neighbours.items[k];
  scree_pair_end(pair, n);
  slot->wake = pair->asleep ? n->wake : -INFINITY;
  world->pair_of.items[k] = scree_none;
  return true;
}

bool scree_needs_no_pair(scree_world *world, uint32_t k) {
  return world->pair_of.items[k] == scree_none && world->neighbours.items[k].spheres &&
         scree_spheres_stay_apart(world, k);
}

/* False where a pool has too little room: the pair is to be evaluated again. */
static bool evaluate_pair(scree_world *world, scree_pair *pair, scree_scratch *scratch,
                          scree_pair_progress *part) {
  uint32_t k = pair->neighbours;
  scree_take_in_hand(scratch, &world->pools, pair, &world->neighbours.items[k]);
  if (pair->spheres)
    scree_spheres_evaluate(world, pair, scratch, NULL);
  else if (!scree_pair_evaluate(world, pair, scratch))
    return false;
  scree_balance_add(&world->ledger.items[k], &scratch->work);
  scree_note_pair(&part->tally, pair, &scratch->work);
  if (part->tally.trouble.start == k) part->tally.trouble.start_depth = scratch->work.start_depth;
  return true;
}

/* Asks for what the next pairs of the list will read. */
SCREE_PREFETCHES void fetch_ahead(const scree_world *world, const uint32_t *awake, size_t i,
                                  size_t count) {
  if (i + PAIRS_AHEAD < count) fetch_pair(world, awake[i + PAIRS_AHEAD]);
  if (i + FEATURES_AHEAD < count)
    fetch_features(world, scree_pair_of(world, awake[i + FEATURES_AHEAD]));
  if (i + SHAPES_AHEAD < count) fetch_shapes(world, scree_pair_of(world, awake[i + SHAPES_AHEAD]));
}

static void begin_blocks(scree_world *world, size_t begin, size_t end,
                         scree_pair_progress *progress) {
  uint32_t *awake = &world->awake.items[begin];
  *progress = (scree_pair_progress){.awake = (uint32_t)list_awake(world, begin, end, awake),
                                    .tally = {.trouble = scree_no_trouble}};
  for (size_t k = 0; k < PAIRS_AHEAD && k < progress->awake; k++) fetch_pair(world, awake[k]);
}

/* From where it stopped, if it did. Pairs that fall asleep take the places of those already done.
 */
static void evaluate_blocks(void *context, size_t begin, size_t end, size_t part, int worker) {
  scree_world *world = context;
  scree_pair_progress *progress = &world->progress.items[part];
  uint32_t *awake = &world->awake.items[begin];
  if (progress->done == 0) begin_blocks(world, begin, end, progress);
  const size_t count = progress->awake;
  size_t i = progress->done;
  for (; i < count; i++) {
    fetch_ahead(world, awake, i, count);
    if (scree_needs_no_pair(world, awake[i])) continue;
    uint32_t index = scree_pair_at(world, awake[i]);
    if (index == scree_none) break;
    scree_pair *pair = &world->pairs.items[index];
    if (!evaluate_pair(world, pair, &world->scratch[worker], progress)) break;
    if (scree_settle_pair(world, pair)) awake[progress->given++] = index;
  }
  progress->done = (uint32_t)i;
}

static size_t pairs_at_once(const scree_world *world) {
  size_t blocks = scree_block_count(world->neighbours.count, SCREE_PAIR_BLOCK) / LEAST_PARTS;
  return SCREE_PAIR_BLOCK * (blocks < 1 ? 1 : blocks > MOST_BLOCKS ? MOST_BLOCKS : blocks);
}

static bool all_done(const scree_world *world, size_t parts) {
  for (size_t p = 0; p < parts; p++)
    if (world->progress.items[p].done < world->progress.items[p].awake) return false;
  return true;
}

/* For what the workers asked for in vain. */
static bool make_room(scree_world *world) {
  if (atomic_load(&world->spare_pairs.count) < 0 && !scree_pairs_grow(world)) return false;
  for (int i = 0; i < world->scratch_count; i++) {
    scree_scratch *scratch = &world->scratch[i];
    if (!SCREE_RESERVE(&scratch->contacts, scratch->contacts_needed)) return false;
  }
  return scree_pools_grow(&world->pools, world->pairs.items, world->pairs.count,
                          world->neighbours.items, world->neighbours.count);
}

/* The first of all. */
static void add_trouble(scree_trouble *all, const scree_trouble *part) {
  if (all->start == scree_none) {
    all->start = part->start;
    all->start_depth = part->start_depth;
  }
  if (all->beyond_limit == scree_none) all->beyond_limit = part->beyond_limit;
  if (all->passed == scree_none) all->passed = part->passed;
  if (all->too_fast == scree_none) all->too_fast = part->too_fast;
}

static scree_status evaluate_pairs(scree_world *world) {
  size_t count = world->neighbours.count, size = pairs_at_once(world),
         parts = scree_block_count(count, size);
  for (size_t p = 0; p < parts; p++) world->progress.items[p] = (scree_pair_progress){0};
  scree_parallel_for(count, size, evaluate_blocks, world);
  while (!all_done(world, parts)) {
    if (!make_room(world))
      return scree_fail_memory(&world->failure, 0, "contact features of a pair");
    scree_parallel_for(count, size, evaluate_blocks, world);
  }
  scree_trouble trouble = scree_no_trouble;
  world->largest_overlap = 0;
  for (size_t p = 0; p < parts; p++) {
    const scree_pair_progress *part = &world->progress.items[p];
    for (uint32_t i = 0; i < part->given; i++)
      scree_pair_give_back(world, world->awake.items[p * size + i]);
    world->largest_overlap = scree_max(world->largest_overlap, scree_largest_overlap(&part->tally));
    world->depenetration_count += part->tally.depenetrations;
    add_trouble(&trouble, &part->tally.trouble);
  }
  return scree_is_trouble(&trouble) ? scree_describe_trouble(world, &trouble) : SCREE_OK;
}

static const double pi = 3.14159265358979323846;

/* A body's shape in a few words. */
static const char *describe_shape(const scree_particle *p, char text[64]) {
  const scree_particle_measures *m = &p->measures;
  if (m->kind == SCREE_PARTICLE_MESH)
    snprintf(text, 64, "%zu triangles, size %.3g m", m->triangle_count, m->size);
  else
    snprintf(text, 64, "%zu sphere%s, size %.3g m", m->point_count, m->point_count == 1 ? "" : "s",
             m->size);
  return text;
}

/* "body 3 (60 triangles, size 0.022 m) VERB wall 0 (mesh)". */
static void describe_both(const scree_world *world, const scree_neighbours *n, const char *verb,
                          char text[256]) {
  static const char *const walls[] = {"plane", "disc", "cylinder", "mesh"};
  char a[64], b[64];
  describe_shape(world->bodies.particle[n->a], a);
  if (n->wall)
    snprintf(b, sizeof b, "%s", walls[world->walls.items[n->b].given.kind]);
  else
    describe_shape(world->bodies.particle[n->b], b);
  snprintf(text, 256, "body %u (%s) %s %s %u (%s)", n->a, a, verb, n->wall ? "wall" : "body", n->b,
           b);
}

/* Where the first is, and what a contact must bear that is met at this speed: an overlap of
 * v sqrt(m/K). */
static void describe_demand(const scree_world *world, const scree_neighbours *n, double speed,
                            char text[256]) {
  const scree_pair_law *law = &n->law;
  const double asked = speed * law->contact_time / pi,
               factor = asked * asked / (law->limit * law->limit);
  vec3 at = world->bodies.frame[n->a].position;
  size_t used = (size_t)snprintf(text, 256, "; at %.4g %.4g %.4g m, met at %.3g m/s", at.x, at.y,
                                 at.z, speed);
  if (factor > 1)
    snprintf(text + used, 256 - used,
             ": a stiffness of %.3g N/m yields by %.3g m, %.3g N/m would hold (materials %.3g "
             "times as stiff)",
             law->stiffness, asked, factor * law->stiffness, factor);
}

static double relative_speed(const scree_world *world, const scree_neighbours *n) {
  const scree_frame *b = n->wall ? &world->walls.items[n->b].frame : &world->bodies.frame[n->b];
  vec3 arm = vec3_sub(world->bodies.frame[n->a].position, b->position);
  return vec3_distance(world->bodies.frame[n->a].velocity,
                       n->wall ? vec3_add(b->velocity, vec3_cross(b->spin, arm)) : b->velocity);
}

/* Of what else touches the body of neighbours k, that which presses most against it, where that is
 * more than half of what k press with; scree_none in an impact. */
static uint32_t find_counterforce(const scree_world *world, uint32_t k, bool of_b) {
  const scree_neighbours *n = &world->neighbours.items[k];
  const uint32_t body = of_b ? n->b : n->a;
  const vec3 force = scree_pair_of(world, k)->wrench.force;
  double most = 0.5 * vec3_norm2(force);
  uint32_t found = scree_none;
  for (size_t i = 0; i < world->neighbours.count; i++) {
    const scree_neighbours *other = &world->neighbours.items[i];
    const scree_pair *pair = scree_pair_of(world, i);
    const bool is_b = !other->wall && other->b == body;
    if (i == k || !pair || !pair->touching || !(other->a == body || is_b)) continue;
    double against = vec3_dot(force, pair->wrench.force) * (is_b == of_b ? -1 : 1);
    if (against > most) most = against, found = (uint32_t)i;
  }
  return found;
}

static bool wall_moves(const scree_world *world, const scree_neighbours *n) {
  if (!n->wall) return false;
  const scree_frame *frame = &world->walls.items[n->b].frame;
  return vec3_norm2(frame->velocity) + vec3_norm2(frame->spin) > 0;
}

/* A wall that moves does so whatever stands against it. */
static bool describe_pinch(const scree_world *world, uint32_t k, char text[256]) {
  const scree_neighbours *n = &world->neighbours.items[k];
  bool of_b = false;
  uint32_t other = find_counterforce(world, k, of_b);
  if (other == scree_none && !n->wall) other = find_counterforce(world, k, of_b = true);
  if (other == scree_none) return false;
  const scree_neighbours *m = &world->neighbours.items[other];
  if (!wall_moves(world, n) && !wall_moves(world, m)) return false;
  const uint32_t body = of_b ? n->b : n->a;
  vec3 at = world->bodies.frame[body].position;
  snprintf(text, 256,
           "; at %.4g %.4g %.4g m, body %u is pinched between %s %u and %s %u with %.3g N: a wall "
           "that moves presses as hard as it takes, leave it more room there or less friction",
           at.x, at.y, at.z, body, n->wall ? "wall" : "body", of_b ? n->a : n->b,
           m->wall ? "wall" : "body", m->a == body ? m->b : m->a,
           vec3_norm(scree_pair_of(world, k)->wrench.force));
  return true;
}

/* The speed with which they met follows from what the spring holds. */
static scree_status describe_overlap(scree_world *world, uint32_t k) {
  const scree_neighbours *n = &world->neighbours.items[k];
  double overlap = scree_pair_of(world, k)->overlap, now = relative_speed(world, n),
         held = overlap * pi / n->law.contact_time;
  char demand[256];
  if (!describe_pinch(world, k, demand))
    describe_demand(world, n, sqrt(now * now + held * held), demand);
  return scree_fail(&world->failure, SCREE_DIVERGED,
                    "world: step %llu, body %u overlaps %s %u by %.3g m; at most %.3g m%s",
                    (unsigned long long)world->step_count, n->a, n->wall ? "wall" : "body", n->b,
                    overlap, n->law.limit, demand);
}

static scree_status describe_passed(scree_world *world, uint32_t k) {
  const scree_neighbours *n = &world->neighbours.items[k];
  const scree_pair *pair = scree_pair_of(world, k); /* none where they are apart */
  char both[256], demand[256];
  describe_both(world, n, "has come through", both);
  describe_demand(world, n, pair ? pair->watch.speed : relative_speed(world, n), demand);
  return scree_fail(&world->failure, SCREE_DIVERGED, "world: step %llu, %s%s",
                    (unsigned long long)world->step_count, both, demand);
}

static scree_status describe_speed(scree_world *world, uint32_t k) {
  const scree_neighbours *n = &world->neighbours.items[k];
  const scree_pair *pair = scree_pair_of(world, k);
  return scree_fail(
      &world->failure, SCREE_DIVERGED,
      "world: step %llu, body %u moved by %.3g m past %s %u in one step of %.3g s; at "
      "most %.3g m (the thinnest wall of the two, or twice the overlap limit)",
      (unsigned long long)world->step_count, n->a, pair ? pair->list.travel : n->list.travel,
      n->wall ? "wall" : "body", n->b, world->time_step, 2 * n->law.thin);
}

static scree_status describe_start(scree_world *world, const scree_trouble *trouble) {
  const scree_neighbours *n = &world->neighbours.items[trouble->start];
  char both[256];
  describe_both(world, n, "and", both);
  return scree_fail(&world->failure, SCREE_DIVERGED,
                    "world: step %llu, %s lie %.3g m deep in each other from the start, or since "
                    "one was put there: put them apart",
                    (unsigned long long)world->step_count, both, trouble->start_depth);
}

scree_status scree_describe_trouble(scree_world *world, const scree_trouble *trouble) {
  const uint32_t found[] = {trouble->start, trouble->beyond_limit, trouble->passed,
                            trouble->too_fast};
  size_t first = 0;
  while (first < 3 && found[first] == scree_none) first++;
  const scree_neighbours *n = &world->neighbours.items[found[first]];
  world->failed_wall = n->wall ? (size_t)n->b + 1 : 0;
  if (trouble->start != scree_none) return describe_start(world, trouble);
  if (trouble->beyond_limit != scree_none) return describe_overlap(world, trouble->beyond_limit);
  if (trouble->passed != scree_none) return describe_passed(world, trouble->passed);
  return describe_speed(world, trouble->too_fast);
}

scree_status scree_reserve_blocks(scree_world *world, scree_error *error) {
  size_t blocks = scree_block_count(world->neighbours.count, SCREE_PAIR_BLOCK);
  if (!SCREE_RESERVE(&world->progress, blocks) ||
      !SCREE_RESERVE(&world->awake, world->neighbours.count))
    return scree_fail_memory(error, blocks * sizeof *world->progress.items, "pairs");
  int workers = scree_worker_count();
  if (workers <= world->scratch_count) return SCREE_OK;
  scree_scratch *scratch = scree_resize(world->scratch, (size_t)workers, sizeof *scratch);
  if (!scratch) return scree_fail_memory(error, (size_t)workers * sizeof *scratch, "scratch");
  memset(scratch + world->scratch_count, 0,
         (size_t)(workers - world->scratch_count) * sizeof *scratch);
  world->scratch = scratch;
  world->scratch_count = workers;
  return SCREE_OK;
}

static scree_status take_step(scree_world *world) {
  scree_timings *timings = &world->timings;
  double start = scree_now();
  scree_status status = scree_broad_update(world, &world->failure);
  if (!status) status = scree_reserve_blocks(world, &world->failure);
  if (status) return status;
  double after_broad = scree_now();
  status = evaluate_pairs(world);
  double after_contacts = scree_now();
  if (!status && !scree_world_gather(world)) status = world->failure.status;
  if (!status) {
    scree_world_advance(world);
    world->time += world->time_step;
    world->step_count++;
  }
  double end = scree_now();
  timings->broad += after_broad - start;
  timings->contacts += after_contacts - after_broad;
  timings->bodies += end - after_contacts;
  timings->total += end - start;
  timings->steps++;
  timings->pair_evaluations += world->neighbours.count;
  return status;
}

/* What a step takes less than this to do is done by one thread: to share out its loops, and to wait
 * for the last in each, costs about as much. */
static const double shared_from = 1e-4; /* s */
bool scree_share_all_steps;
enum { ASK_EVERY = 1024 }; /* steps, of which one is done alone to see what it takes */

/* The same bits for any number of threads: the clock may decide. A step that the system interrupted
 * must not, so that the estimate grows slowly. */
static scree_status one_step(scree_world *world, size_t most, size_t *done) {
  (void)most;
  *done = 1;
  double *took = &world->alone_seconds, before = world->timings.total;
  const bool many = scree_worker_count() > 1,
             alone = many && !scree_share_all_steps &&
                     (world->step_count % ASK_EVERY == 0 || *took < shared_from);
  if (alone) scree_work_alone(true);
  scree_status status = take_step(world);
  if (!alone) return status;
  scree_work_alone(false);
  const double now = world->timings.total - before;
  *took = world->step_count % ASK_EVERY == 1 ? now : scree_min(now, 1.1 * *took);
  return status;
}

/* The state is stepped where it is, but for one that was on a device. */
static scree_status begin(scree_world *world, scree_error *error) {
  return world->on_device ? scree_world_change(world, SCREE_ALL_PARTS, error) : SCREE_OK;
}

const scree_backend scree_backend_cpu = {"cpu", begin, one_step, NULL, NULL, NULL, NULL};

static scree_status check_time_step(scree_world *world, scree_error *error) {
  if (!world->time_step_stale) return SCREE_OK;
  SCREE_TRY(scree_world_bring(world, SCREE_PART_WALLS, error));
  world->time_step = scree_world_choose_time_step(world, NULL);
  world->time_step_stale = false;
  if (!(world->options.time_step > 0)) return SCREE_OK;
  scree_world_options automatic = world->options;
  world->options.time_step = 0;
  double coarsest =
      scree_world_choose_time_step(world, NULL) * world->options.steps_per_contact / 15;
  world->options = automatic;
  if (world->bodies.count == world->bodies.removed_count ||
      world->time_step <= coarsest * (1 + 1e-12))
    return SCREE_OK;
  world->time_step_stale = true;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "world: a time step of %.4g s is too long for these bodies: at most %.4g s "
                    "(15 per contact)",
                    world->time_step, coarsest);
}

scree_status scree_world_step(scree_world *world, size_t step_count, scree_error *error) {
  if (world->diverged) {
    if (error) *error = world->failure;
    return world->failure.status;
  }
  const scree_backend *backend = scree_backend_of(world);
  scree_status status = check_time_step(world, error);
  if (!status) status = backend->begin(world, error);
  if (status) return status;
  for (size_t k = 0, done = 0; k < step_count; k += done) {
    size_t to_keep = scree_world_steps_to_keep(world);
    if (to_keep == 0) {
      status = scree_world_keep_state(world, error);
      if (status) return status;
      to_keep = scree_world_steps_to_keep(world);
    }
    status = backend->step(world, to_keep < step_count - k ? to_keep : step_count - k, &done);
    if (status == SCREE_OK) continue;
    world->diverged = true;
    scree_world_write_kept(world);
    if (error) *error = world->failure;
    return status;
  }
  return SCREE_OK;
}
