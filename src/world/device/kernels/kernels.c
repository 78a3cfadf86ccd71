/* The kernels: each stage of a step as loops over its elements, around the very functions that the
 * loops of step.c and integrate.c call. A kernel returns at once where an earlier one stopped the
 * steps. Every element is written by the one thread that has it; several threads meet only at
 * counters and lists of work, whose order shows nowhere. */
#include "base/atomic.h"
#include "world/broad/broad.h"
#include "world/contact/spheres.h"
#include "world/device/kernels/threads.h"
#include "world/state/pairs.h"
#include "world/state/walls.h"
#include "world/step/stages.h"

/* What clang calls for an atomic operation of C, by the names that it uses. */
uint64_t scree_fetch_add(volatile void *at, uint64_t value,
                         int order) __asm__("__atomic_fetch_add_8");
uint64_t scree_fetch_sub(volatile void *at, uint64_t value,
                         int order) __asm__("__atomic_fetch_sub_8");
uint64_t scree_fetch_or(volatile void *at, uint64_t value,
                        int order) __asm__("__atomic_fetch_or_8");
uint64_t scree_fetch_and(volatile void *at, uint64_t value,
                         int order) __asm__("__atomic_fetch_and_8");
uint64_t scree_fetch_add(volatile void *at, uint64_t value, int order) {
  (void)order;
  return (uint64_t)__nvvm_atom_add_gen_ll((volatile long long *)at, (long long)value);
}
uint64_t scree_fetch_sub(volatile void *at, uint64_t value, int order) {
  return scree_fetch_add(at, (uint64_t)0 - value, order);
}
uint64_t scree_fetch_or(volatile void *at, uint64_t value, int order) {
  (void)order;
  return (uint64_t)__nvvm_atom_or_gen_ll((volatile long long *)at, (long long)value);
}
uint64_t scree_fetch_and(volatile void *at, uint64_t value, int order) {
  (void)order;
  return (uint64_t)__nvvm_atom_and_gen_ll((volatile long long *)at, (long long)value);
}
/* A device has no clock that timers could use. */
double scree_now(void) {
  return 0;
}

static void raise_flag(uint32_t *flag) {
  __nvvm_atom_max_gen_ui(flag, 1);
}

/* Some pairs are not ready. No kernel asks for what it may itself find: other threads of it may
 * have, sooner or later. */
static bool pairs_wait(const scree_device_step *step) {
  return step->stop || step->too_small || step->again;
}
/* Or something is wrong with some. */
static bool bodies_wait(const scree_device_step *step) {
  return pairs_wait(step) || scree_is_trouble(&step->tally.trouble);
}
/* Or with some body. */
static bool is_held(const scree_device_step *step) {
  return bodies_wait(step) || step->offender != scree_none;
}

/* ---- pairs ---- */

static void do_awake(scree_world *world, scree_device_step *step) {
  if (step->stop || step->resume) return;
  FOR_EACH (k, world->list.neighbours.count) {
    if (!scree_is_awake(world, k) || scree_needs_no_pair(world, (uint32_t)k)) continue;
    uint32_t place = scree_atomic_add(&step->awake_count, 1);
    world->workspace.awake.items[place] = (uint32_t)k;
    step->progress[place] = SCREE_PAIR_NEW;
  }
}

static scree_pair *pair_at(const scree_world *world, size_t place) {
  return scree_pair_of(world, world->workspace.awake.items[place]);
}

/* The pair at this place, with its lists in hand. */
static scree_pair *take_pair(scree_world *world, scree_device_step *step, size_t place) {
  scree_scratch *hand = &step->hands[place];
  scree_pair *pair = pair_at(world, place);
  scree_take_in_hand(hand, &world->pools, pair, &world->list.neighbours.items[pair->neighbours]);
  hand->contacts.items = world->pools.contacts + hand->first_contact;
  return pair;
}

static int kind_of_visit(const scree_feature_pair *feature) {
  return feature->kind == SCREE_FEATURE_EDGE_EDGE ? SCREE_VISIT_EDGES
         : feature->kind == SCREE_FEATURE_POINT_FACE || feature->kind == SCREE_FEATURE_FACE_POINT
             ? SCREE_VISIT_SURFACES
             : SCREE_VISIT_OTHERS;
}

/* A pair that is ready asks for visits of its feature pairs. */
static void ask_for_visits(scree_device_step *step, const scree_pair *pair, size_t place) {
  const scree_feature_pair *features = step->hands[place].features;
  uint32_t counts[SCREE_VISIT_KINDS] = {0}, first[SCREE_VISIT_KINDS];
  for (uint32_t i = 0; i < pair->active.count; i++) counts[kind_of_visit(&features[i])]++;
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++)
    if (counts[kind] > 0) first[kind] = scree_atomic_add(&step->visit_counts[kind], counts[kind]);
  for (uint32_t i = 0; i < pair->active.count; i++) {
    int kind = kind_of_visit(&features[i]);
    step->visits[kind][first[kind]++] = (scree_visit){(uint32_t)place, i};
  }
}

/* Pairs that find too little room are as before, and begin anew when the step is gone on with. */
static void send_back(scree_device_step *step, scree_pair *pair, size_t place, uint32_t *why) {
  scree_pair_step_back(pair, &step->hands[place]);
  step->progress[place] = SCREE_PAIR_NEW;
  raise_flag(why);
}

static void wake(scree_device_step *step, scree_pair *pair, size_t place) {
  scree_scratch *hand = &step->hands[place];
  hand->contacts.capacity = 0;
  if (!scree_pair_wake(pair, hand)) {
    send_back(step, pair, place, &step->too_small);
    return;
  }
  step->progress[place] = SCREE_PAIR_READY;
  ask_for_visits(step, pair, place);
}

static void begin_list(scree_world *world, scree_device_step *step, scree_pair *pair,
                       size_t place) {
  scree_listing listing;
  if (!scree_listing_begin(&listing, world, pair, &step->hands[place])) {
    wake(step, pair, place);
    return;
  }
  uint32_t at = scree_atomic_add(&step->new_list_count, 1);
  if (at >= step->new_list_capacity) {
    send_back(step, pair, place, &step->again);
    return;
  }
  scree_new_list *list = &step->new_lists[at];
  list->listing = listing;
  list->place = (uint32_t)place;
  list->entries = (uint32_t)scree_listing_count(&listing);
  step->progress[place] = SCREE_PAIR_LISTING;
}

static void do_relate(scree_world *world, scree_device_step *step) {
  if (step->stop) return;
  FOR_EACH (place, step->awake_count) {
    if (step->progress[place] != SCREE_PAIR_NEW) {
      ask_for_visits(step, take_pair(world, step, place), place);
      continue;
    }
    if (scree_pair_at(world, world->workspace.awake.items[place]) == scree_none) {
      raise_flag(&step->too_small);
      continue;
    }
    scree_pair *pair = take_pair(world, step, place);
    if (pair->spheres) continue; /* have no lists */
    scree_pair_relate(world, pair, &step->hands[place]);
    if (scree_pair_needs_list(pair))
      begin_list(world, step, pair, place);
    else
      wake(step, pair, place);
  }
}

/* ---- lists ---- */

static size_t list_count(const scree_device_step *step) {
  return step->new_list_count < step->new_list_capacity ? step->new_list_count
                                                        : step->new_list_capacity;
}

/* The entries of a part, one after another; how many features they find. */
static uint32_t take_part(const scree_new_list *list, size_t part, scree_sleeping_feature *to,
                          uint32_t room) {
  uint32_t size = (list->entries + SCREE_LIST_PARTS - 1) / SCREE_LIST_PARTS;
  size_t begin = part * size, end = begin + size < list->entries ? begin + size : list->entries;
  scree_listing listing = list->listing;
  listing.to = to;
  listing.room = room;
  listing.count = 0;
  for (size_t e = begin; e < end; e++) scree_listing_take(&listing, e);
  return listing.count;
}

static void do_list_count(scree_world *world, scree_device_step *step) {
  (void)world;
  if (step->stop) return;
  FOR_EACH (i, list_count(step) * SCREE_LIST_PARTS) {
    scree_new_list *list = &step->new_lists[i / SCREE_LIST_PARTS];
    size_t part = i % SCREE_LIST_PARTS;
    list->found[part] = take_part(list, part, list->kept[part], SCREE_LIST_KEPT);
  }
}

static void do_list_place(scree_world *world, scree_device_step *step) {
  if (step->stop) return;
  FOR_EACH (i, list_count(step)) {
    scree_new_list *list = &step->new_lists[i];
    uint32_t total = 0;
    for (int part = 0; part < SCREE_LIST_PARTS; part++) {
      uint32_t found = list->found[part];
      list->found[part] = total;
      total += found;
    }
    scree_scratch *hand = &step->hands[list->place];
    take_pair(world, step, list->place);
    if (!scree_reserve_sleeping(hand, total)) continue;
    hand->neighbours->sleeping.count = total;
    step->progress[list->place] = SCREE_PAIR_LISTED;
  }
}

static void do_list_write(scree_world *world, scree_device_step *step) {
  if (step->stop) return;
  FOR_EACH (i, list_count(step) * SCREE_LIST_PARTS) {
    const scree_new_list *list = &step->new_lists[i / SCREE_LIST_PARTS];
    const scree_range *sleeping = &step->hands[list->place].neighbours->sleeping;
    size_t part = i % SCREE_LIST_PARTS;
    uint32_t begin = list->found[part],
             end = part + 1 < SCREE_LIST_PARTS ? list->found[part + 1] : sleeping->count;
    if (step->progress[list->place] != SCREE_PAIR_LISTED || begin == end) continue;
    scree_sleeping_feature *to = world->pools.sleeping_features + sleeping->first + begin;
    if (end - begin > SCREE_LIST_KEPT)
      take_part(list, part, to, end - begin);
    else
      for (uint32_t k = 0; k < end - begin; k++) to[k] = list->kept[part][k];
  }
}

static void do_list_end(scree_world *world, scree_device_step *step) {
  if (step->stop) return;
  FOR_EACH (i, list_count(step)) {
    size_t place = step->new_lists[i].place;
    scree_pair *pair = take_pair(world, step, place);
    if (step->progress[place] == SCREE_PAIR_LISTED)
      wake(step, pair, place);
    else
      send_back(step, pair, place, &step->too_small);
  }
}

/* ---- contacts ---- */

static void visit(scree_world *world, scree_device_step *step, const scree_visit *v) {
  const scree_scratch *hand = &step->hands[v->place];
  const scree_pair *pair = pair_at(world, v->place);
  size_t first = hand->first_contact + (size_t)SCREE_ANCHORS * v->feature;
  scree_scratch own; /* of the feature pair's visit, which needs no more of it: */
  own.pools = &world->pools;
  own.features = hand->features;
  own.further = hand->further;
  own.contacts = (scree_contact_list){world->pools.contacts + first, 0, SCREE_ANCHORS};
  own.counters.feature_evaluations = own.counters.closest_queries = 0;
  scree_feature_pair *feature = &hand->features[v->feature];
  own.drift = hand->drift;
  feature->gap = scree_feature_contact(world, pair, feature, &hand->relative, &own);
  step->contact_counts[first] = (uint8_t)own.contacts.count;
}

/* Feature pairs of one kind follow each other, and no warp has two kinds. */
static void do_visit(scree_world *world, scree_device_step *step) {
  if (pairs_wait(step)) return;
  enum { WARP = 32 };
  size_t ends[SCREE_VISIT_KINDS], all = 0;
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++)
    ends[kind] = all += (step->visit_counts[kind] + WARP - 1) / WARP * WARP;
  FOR_EACH (i, all) {
    size_t at = i;
    int kind = 0;
    while (i >= ends[kind]) at = i - ends[kind++];
    if (at < step->visit_counts[kind]) visit(world, step, &step->visits[kind][at]);
  }
}

/* The contacts of all feature pairs, one after another. */
static void gather_touches(const scree_device_step *step, const scree_pair *pair,
                           scree_scratch *hand) {
  scree_contact_point *contacts = hand->contacts.items;
  size_t count = 0;
  for (uint32_t i = 0; i < pair->active.count; i++) {
    size_t from = (size_t)SCREE_ANCHORS * i,
           end = from + step->contact_counts[hand->first_contact + from];
    for (; from < end; from++, count++)
      if (from != count) contacts[count] = contacts[from];
  }
  hand->contacts.count = count;
}

/* Where there is room many threads look for the depths; else this one. */
static void ask_for_depths(scree_world *world, scree_device_step *step, scree_pair *pair,
                           size_t place) {
  scree_scratch *hand = &step->hands[place];
  size_t count = scree_depth_count(world, pair, hand);
  if (count == 0) return;
  uint64_t first = scree_fetch_add(&step->depths_used, count, 0);
  uint32_t at = scree_atomic_add(&step->depth_job_count, 1);
  if (first + count > step->depth_capacity || at >= SCREE_MOST_DEPTH_JOBS) {
    if (at < SCREE_MOST_DEPTH_JOBS) step->depth_jobs[at].count = 0;
    scree_pair_find_depths(world, pair, hand, &hand->work);
    return;
  }
  step->depth_jobs[at] = (scree_depth_job){(uint32_t)place, (uint32_t)count, first};
  hand->first_depth = (size_t)first;
  step->progress[place] = SCREE_PAIR_ASKS;
}

static void do_meet(scree_world *world, scree_device_step *step) {
  if (pairs_wait(step)) return;
  FOR_EACH (place, step->awake_count) {
    scree_pair *pair = take_pair(world, step, place);
    if (pair->spheres) continue;
    gather_touches(step, pair, &step->hands[place]);
    scree_pair_meet(world, pair, &step->hands[place]);
    ask_for_depths(world, step, pair, place);
  }
}

static void do_depth(scree_world *world, scree_device_step *step) {
  if (pairs_wait(step)) return;
  size_t jobs =
      step->depth_job_count < SCREE_MOST_DEPTH_JOBS ? step->depth_job_count : SCREE_MOST_DEPTH_JOBS;
  FOR_EACH (i, jobs * SCREE_DEPTH_PARTS) {
    const scree_depth_job *job = &step->depth_jobs[i / SCREE_DEPTH_PARTS];
    if (job->count == 0) continue;
    const scree_scratch *hand = &step->hands[job->place];
    const scree_pair *pair = pair_at(world, job->place);
    for (size_t e = i % SCREE_DEPTH_PARTS; e < job->count; e += SCREE_DEPTH_PARTS)
      step->depths[job->first + e] = scree_depth_of(world, pair, hand, e);
  }
}

static void do_contact_law(scree_world *world, scree_device_step *step) {
  if (pairs_wait(step)) return;
  FOR_EACH (place, step->awake_count) {
    scree_pair *pair = take_pair(world, step, place);
    scree_scratch *hand = &step->hands[place];
    uint32_t k = pair->neighbours, index = world->list.pair_of.items[k];
    if (step->progress[place] == SCREE_PAIR_ASKS)
      scree_pair_take_depths(world, pair, step->depths + hand->first_depth, hand, &hand->work);
    if (pair->spheres) {
      scree_spheres_evaluate(world, pair, hand, NULL);
    } else {
      scree_pair_contact_law(world, pair, hand);
      scree_pair_leave(world, pair, hand);
    }
    scree_balance_add(&world->list.ledger.items[k], &hand->work);
    scree_note_pair(world, &step->tally, pair, &hand->work);
    if (scree_settle_pair(world, pair)) scree_pair_give_back(world, index);
  }
}

/* ---- spheres ---- */

static size_t sphere_count(const scree_world *world) {
  return world->spheres.list.pairs.count ? world->spheres.list.count : 0;
}

static void do_spheres_load(scree_world *world, scree_device_step *step) {
  if (pairs_wait(step)) return;
  FOR_EACH (i, sphere_count(world)) scree_spheres_load(world, i);
}

static void do_spheres(scree_world *world, scree_device_step *step) {
  if (pairs_wait(step)) return;
  FOR_EACH (k, world->spheres.list.pairs.count) {
    scree_sphere_result r;
    if (!scree_sphere_pair_is_due(world, &world->spheres.list.pairs.items[k]) ||
        !scree_sphere_pair_step(world, k, &r))
      continue;
    step->sphere_loads[k][0] = r.on_a;
    step->sphere_loads[k][1] = r.on_b;
    scree_note_pair(world, &step->tally, &r.pair, &r.work);
  }
}

static void do_spheres_gather(scree_world *world, scree_device_step *step) {
  if (bodies_wait(step)) return;
  FOR_EACH (i, sphere_count(world))
    scree_spheres_gather(world, i, (const scree_sphere_load(*)[2])step->sphere_loads);
}

/* ---- joints, bodies and walls ---- */

static void do_joints(scree_world *world, scree_device_step *step) {
  if (bodies_wait(step)) return;
  FOR_EACH (k, world->joints.all.count)
    if (scree_joint_step(world, k)) raise_flag(&step->parted);
}

static void do_gather(scree_world *world, scree_device_step *step) {
  if (bodies_wait(step)) return;
  FOR_EACH (i, world->bodies.count)
    if (!world->bodies.removed[i] && !scree_gather_body(world, i))
      scree_atomic_lower(&step->offender, (uint32_t)i);
}

static void advance_body(scree_world *world, scree_device_step *step, size_t i) {
  if (world->bodies.removed[i]) return;
  scree_advance_body(world, i);
  if (scree_body_has_left(world, i)) raise_flag(&step->stale);
  if (!(world->bodies.frame[i].position.z < world->options.floor_height)) return;
  world->bodies.removed[i] = true;
  raise_flag(&step->fallen);
}

static void do_advance(scree_world *world, scree_device_step *step) {
  if (is_held(step)) return;
  size_t bodies = world->bodies.count;
  FOR_EACH (i, bodies + world->walls.count) {
    if (i < bodies) {
      advance_body(world, step, i);
      continue;
    }
    scree_wall_advance(world, i - bodies);
    if (scree_wall_has_left(&world->walls.items[i - bodies])) raise_flag(&step->stale);
  }
}

/* How deep the pair that overlaps from the start does. */
static void find_start(const scree_world *world, scree_device_step *step) {
  for (uint32_t place = 0; place < step->awake_count; place++)
    if (world->workspace.awake.items[place] == step->tally.trouble.start)
      step->tally.trouble.start_depth = step->hands[place].work.start_depth;
}

static void do_end(scree_world *world, scree_device_step *step) {
  if (FIRST_ELEMENT > 0 || step->stop) return;
  step->stop = is_held(step);
  if (step->stop) {
    if (step->tally.trouble.start != scree_none) find_start(world, step);
    return;
  }
  world->time += world->time_step;
  step->last_overlap = scree_largest_overlap(&step->tally);
  scree_fetch_and(&world->pools.contacts_used, 0, 0);
  step->evaluations += step->awake_count;
  step->list_builds += step->new_list_count;
  step->tally.largest_overlap = 0;
  step->resume = step->awake_count = step->new_list_count = step->depth_job_count = 0;
  step->depths_used = 0;
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++) step->visit_counts[kind] = 0;
  step->done++;
  step->stop = step->stale || step->fallen || step->parted || step->done == step->wanted;
}

#define SCREE_KERNEL(name)                                                                         \
  void scree_kernel_##name(scree_world **worlds, scree_device_step *steps) {                       \
    do_##name(worlds[WORLD_INDEX], &steps[WORLD_INDEX]);                                           \
  }
SCREE_KERNELS(SCREE_KERNEL)
