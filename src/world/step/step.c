/* The step: pairs, forces, advance. Every pair adds to a ledger of its own, and every body sums its
 * pairs in list order, so that the result does not depend on the threads. */
#include "world/broad/broad.h"
#include "world/contact/contact.h"
#include "world/contact/spheres.h"
#include "world/state/joints.h"
#include "world/state/pairs.h"
#include "world/step/integrate.h"
#include "world/step/stages.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/atomic.h"
#include "base/parallel.h"

#include <stddef.h>
#include <string.h>

/* Several blocks are gone through at once where there are many, for at the beginning nothing was
 * asked for. */
enum { MOST_BLOCKS = 8, LEAST_PARTS = 32 };

bool scree_is_awake(const scree_world *world, size_t k) {
  const scree_slot *slot = &world->list.slots.items[k];
  return world->list.wake_threshold.items[slot->a] + world->list.wake_threshold.items[slot->b] >=
         slot->wake;
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
    scree_prefetch(pair, offsetof(scree_pair, list));
  else
    scree_prefetch(&world->list.neighbours.items[k], sizeof(scree_neighbours));
  size_t b = world->list.slots.items[k].b;
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
    scree_prefetch(&world->list.neighbours.items[pair->neighbours].sleeping, 1);
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
        &world->pools
             .sleeping_features[world->list.neighbours.items[pair->neighbours].sleeping.first],
        256);
}

enum { PAIRS_AHEAD = 8, FEATURES_AHEAD = 4, SHAPES_AHEAD = 2 };

void scree_balance_add(scree_balance *balance, const scree_pair_work *work) {
  balance->dashpot += work->later_dashpot + work->dashpot - work->lost - work->let_go;
  balance->tangential += work->later_tangential + work->tangential;
  balance->wall += work->wall;
}

static uint64_t bits_of(double number) {
  uint64_t bits;
  memcpy(&bits, &number, sizeof bits);
  return bits;
}

static void note_hardened(scree_world *world, const scree_pair *pair, const scree_pair_work *work) {
  const uint8_t *materials = world->bodies.material;
  const size_t of_b = pair->wall ? world->walls.items[pair->b].given.material : materials[pair->b];
  scree_hardening *h = &world->materials.hardened[scree_hardened_at(materials[pair->a], of_b)];
  if (work->begins_hardening) scree_atomic_add(&h->count, 1);
  scree_atomic_raise(&h->deepest, bits_of(pair->contact.overlap / pair->law.limit));
  scree_atomic_raise(&h->missing, bits_of(work->missing));
}

void scree_note_overlap(scree_tally *tally, double overlap) {
  scree_atomic_raise(&tally->largest_overlap, bits_of(overlap));
}

void scree_note_pair(scree_world *world, scree_tally *tally, const scree_pair *pair,
                     const scree_pair_work *work) {
  uint32_t k = pair->neighbours;
  if (work->pressed) scree_atomic_lower(&tally->trouble.pressed, k);
  if (work->passed) scree_atomic_lower(&tally->trouble.passed, k);
  if (work->too_fast) scree_atomic_lower(&tally->trouble.too_fast, k);
  if (work->start_depth > 0) scree_atomic_lower(&tally->trouble.start, k);
  if (work->begins_depenetration) scree_atomic_add(&tally->depenetrations, 1);
  if (work->missing > 0) {
    scree_atomic_add(&tally->hardened, 1);
    note_hardened(world, pair, work);
  }
  if (pair->touching) scree_note_overlap(tally, pair->contact.overlap);
}

double scree_largest_overlap(const scree_tally *tally) {
  double overlap;
  memcpy(&overlap, &tally->largest_overlap, sizeof overlap);
  return overlap;
}

uint32_t scree_pair_at(scree_world *world, uint32_t k) {
  uint32_t pair = world->list.pair_of.items[k];
  if (pair != scree_none) return pair;
  pair = scree_pair_take(world);
  if (pair == scree_none) return pair;
  scree_pair_begin(&world->pairs.items[pair], &world->list.neighbours.items[k], k);
  return world->list.pair_of.items[k] = pair;
}

bool scree_settle_pair(scree_world *world, const scree_pair *pair) {
  uint32_t k = pair->neighbours;
  scree_slot *slot = &world->list.slots.items[k];
  if (pair->touching != scree_pair_touches(world, k)) scree_mark_touching(world, k, pair->touching);
  if (scree_pair_stays_awake(pair)) {
    slot->wake = -INFINITY;
    return false;
  }
  scree_neighbours *n = &world->list.neighbours.items[k];
  scree_pair_end(pair, n);
  slot->wake = pair->asleep ? n->wake : -INFINITY;
  world->list.pair_of.items[k] = scree_none;
  return true;
}

bool scree_needs_no_pair(scree_world *world, uint32_t k) {
  return world->list.pair_of.items[k] == scree_none && world->list.neighbours.items[k].spheres &&
         scree_spheres_stay_apart(world, k);
}

/* False where a pool has too little room: the pair is to be evaluated again. */
static bool evaluate_pair(scree_world *world, scree_pair *pair, scree_scratch *scratch,
                          scree_pair_progress *part) {
  uint32_t k = pair->neighbours;
  scree_take_in_hand(scratch, &world->pools, pair, &world->list.neighbours.items[k]);
  if (pair->spheres)
    scree_spheres_evaluate(world, pair, scratch, NULL);
  else if (!scree_pair_evaluate(world, pair, scratch))
    return false;
  scree_balance_add(&world->list.ledger.items[k], &scratch->work);
  scree_note_pair(world, &part->tally, pair, &scratch->work);
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
  uint32_t *awake = &world->workspace.awake.items[begin];
  *progress = (scree_pair_progress){.awake = (uint32_t)list_awake(world, begin, end, awake),
                                    .tally = {.trouble = scree_no_trouble}};
  for (size_t k = 0; k < PAIRS_AHEAD && k < progress->awake; k++) fetch_pair(world, awake[k]);
}

/* From where it stopped, if it did. Pairs that fall asleep take the places of those already done.
 */
static void evaluate_blocks(void *context, scree_block block) {
  scree_world *world = context;
  scree_pair_progress *progress = &world->workspace.progress.items[block.index];
  uint32_t *awake = &world->workspace.awake.items[block.begin];
  if (progress->done == 0) begin_blocks(world, block.begin, block.end, progress);
  const size_t count = progress->awake;
  size_t i = progress->done;
  for (; i < count; i++) {
    fetch_ahead(world, awake, i, count);
    if (scree_needs_no_pair(world, awake[i])) continue;
    uint32_t index = scree_pair_at(world, awake[i]);
    if (index == scree_none) break;
    scree_pair *pair = &world->pairs.items[index];
    if (!evaluate_pair(world, pair, &world->workspace.scratch[block.worker], progress)) break;
    if (scree_settle_pair(world, pair)) awake[progress->given++] = index;
  }
  progress->done = (uint32_t)i;
}

static size_t pairs_at_once(const scree_world *world) {
  size_t blocks = scree_block_count(world->list.neighbours.count, SCREE_PAIR_BLOCK) / LEAST_PARTS;
  return SCREE_PAIR_BLOCK * (blocks < 1 ? 1 : blocks > MOST_BLOCKS ? MOST_BLOCKS : blocks);
}

static bool all_done(const scree_world *world, size_t parts) {
  for (size_t p = 0; p < parts; p++)
    if (world->workspace.progress.items[p].done < world->workspace.progress.items[p].awake)
      return false;
  return true;
}

/* For what the workers asked for in vain. */
static bool make_room(scree_world *world) {
  if (atomic_load(&world->spare_pairs.count) < 0 && !scree_pairs_grow(world)) return false;
  for (int i = 0; i < world->workspace.scratch_count; i++) {
    scree_scratch *scratch = &world->workspace.scratch[i];
    if (!SCREE_RESERVE(&scratch->contacts, scratch->contacts_needed)) return false;
  }
  return scree_pools_grow(&world->pools, world->pairs.items, world->pairs.count,
                          world->list.neighbours.items, world->list.neighbours.count);
}

/* The first of all. */
static void add_trouble(scree_trouble *all, const scree_trouble *part) {
  if (all->start == scree_none) {
    all->start = part->start;
    all->start_depth = part->start_depth;
  }
  if (all->pressed == scree_none) all->pressed = part->pressed;
  if (all->passed == scree_none) all->passed = part->passed;
  if (all->too_fast == scree_none) all->too_fast = part->too_fast;
}

static void add_tally(scree_world *world, scree_trouble *trouble, const scree_tally *tally) {
  world->largest_overlap = scree_max(world->largest_overlap, scree_largest_overlap(tally));
  world->depenetration_count += tally->depenetrations;
  add_trouble(trouble, &tally->trouble);
}

static scree_status evaluate_pairs(scree_world *world) {
  size_t count = world->list.neighbours.count, size = pairs_at_once(world),
         parts = scree_block_count(count, size);
  for (size_t p = 0; p < parts; p++) world->workspace.progress.items[p] = (scree_pair_progress){0};
  scree_parallel_for(count, size, evaluate_blocks, world);
  while (!all_done(world, parts)) {
    if (!make_room(world))
      return scree_fail_memory(&world->failure, 0, "contact features of a pair");
    scree_parallel_for(count, size, evaluate_blocks, world);
  }
  scree_trouble trouble = scree_no_trouble;
  world->largest_overlap = 0;
  for (size_t p = 0; p < parts; p++) {
    const scree_pair_progress *part = &world->workspace.progress.items[p];
    for (uint32_t i = 0; i < part->given; i++)
      scree_pair_give_back(world, world->workspace.awake.items[p * size + i]);
    add_tally(world, &trouble, &part->tally);
  }
  scree_step_spheres(world);
  for (size_t block = 0; block < world->spheres.blocks.count; block++)
    add_tally(world, &trouble, &world->spheres.blocks.tallies[block]);
  return scree_is_trouble(&trouble) ? scree_describe_trouble(world, &trouble) : SCREE_OK;
}

scree_status scree_reserve_blocks(scree_world *world, scree_error *error) {
  size_t blocks = scree_block_count(world->list.neighbours.count, SCREE_PAIR_BLOCK);
  if (!SCREE_RESERVE(&world->workspace.progress, blocks) ||
      !SCREE_RESERVE(&world->workspace.awake, world->list.neighbours.count))
    return scree_fail_memory(error, blocks * sizeof *world->workspace.progress.items, "pairs");
  int workers = scree_worker_count();
  if (workers <= world->workspace.scratch_count) return SCREE_OK;
  scree_scratch *scratch = scree_resize(world->workspace.scratch, (size_t)workers, sizeof *scratch);
  if (!scratch) return scree_fail_memory(error, (size_t)workers * sizeof *scratch, "scratch");
  memset(scratch + world->workspace.scratch_count, 0,
         (size_t)(workers - world->workspace.scratch_count) * sizeof *scratch);
  world->workspace.scratch = scratch;
  world->workspace.scratch_count = workers;
  return SCREE_OK;
}

scree_status scree_take_step(scree_world *world) {
  scree_timings *timings = &world->timings;
  double start = scree_now();
  scree_status status = scree_joints_prepare(world, &world->failure);
  if (!status) status = scree_broad_update(world, &world->failure);
  if (!status) status = scree_reserve_blocks(world, &world->failure);
  if (status) return status;
  double after_broad = scree_now();
  status = evaluate_pairs(world);
  double after_contacts = scree_now();
  if (!status) scree_joints_evaluate(world);
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
  timings->pair_evaluations += world->list.neighbours.count + world->spheres.list.pairs.count;
  return status;
}
