/* The kernels: each stage of a step as one thread an element, around the very functions that the
 * loops of step.c and integrate.c call. A kernel returns at once where an earlier one of the same
 * step stopped it. Every element is written by the one thread that has it; several threads meet
 * only at counters, whose order shows nowhere. */
#include "world/contact.h"
#include "world/device/device.h"
#include "world/stages.h"

/* What clang calls for an atomic operation of C, by the names that it uses. */
uint64_t scree_fetch_add(volatile void *at, uint64_t value,
                         int order) __asm__("__atomic_fetch_add_8");
uint64_t scree_fetch_sub(volatile void *at, uint64_t value,
                         int order) __asm__("__atomic_fetch_sub_8");
uint64_t scree_fetch_add(volatile void *at, uint64_t value, int order) {
  (void)order;
  return (uint64_t)__nvvm_atom_add_gen_ll((volatile long long *)at, (long long)value);
}
uint64_t scree_fetch_sub(volatile void *at, uint64_t value, int order) {
  return scree_fetch_add(at, (uint64_t)0 - value, order);
}
/* A device has no clock that timers could use. */
double scree_now(void) {
  return 0;
}

static uint32_t thread_index(void) {
  return __nvvm_read_ptx_sreg_ctaid_x() * __nvvm_read_ptx_sreg_ntid_x() +
         __nvvm_read_ptx_sreg_tid_x();
}

static bool has_trouble(const scree_pair_sums *sums) {
  return (sums->start & sums->beyond_limit & sums->too_fast) != scree_none;
}

void scree_kernel_awake(scree_world *world, scree_device_step *step) {
  uint32_t block = thread_index();
  size_t begin = (size_t)block * SCREE_PAIR_BLOCK, count = world->neighbours.count;
  if (begin >= count) return;
  size_t end = begin + SCREE_PAIR_BLOCK < count ? begin + SCREE_PAIR_BLOCK : count;
  step->counts[block] = (uint32_t)scree_list_awake(world, begin, end, &world->awake.items[begin]);
  for (uint32_t j = 0; j < step->counts[block]; j++) step->done[begin + j] = 0;
}

void scree_kernel_evaluate(scree_world *world, scree_device_step *step) {
  uint32_t at = thread_index();
  if (at >= world->neighbours.count ||
      at % SCREE_PAIR_BLOCK >= step->counts[at / SCREE_PAIR_BLOCK] || step->done[at])
    return;
  uint32_t index = scree_pair_at(world, world->awake.items[at]);
  scree_scratch scratch = {0};
  bool done = false;
  if (index != scree_none) {
    scree_pair *pair = &world->pairs.items[index];
    scree_take_in_hand(&scratch, &world->pools, pair, &world->neighbours.items[pair->neighbours]);
    done = scree_pair_evaluate(world, pair, &scratch, &step->work[at]);
  }
  step->done[at] = done;
  if (!done) __nvvm_atom_max_gen_ui(&step->too_small, 1);
}

void scree_kernel_settle(scree_world *world, scree_device_step *step) {
  uint32_t block = thread_index(), begin = block * SCREE_PAIR_BLOCK;
  if (begin >= world->neighbours.count || step->too_small) return;
  scree_pair_sums sums = scree_no_sums();
  for (uint32_t at = begin; at < begin + step->counts[block]; at++) {
    uint32_t index = world->pair_of.items[world->awake.items[at]];
    scree_pair *pair = &world->pairs.items[index];
    scree_add_work(&sums, &step->work[at], pair);
    if (!scree_settle_pair(world, pair)) continue;
    int64_t place = atomic_fetch_add_explicit(&world->spare_pairs.count, 1, memory_order_relaxed);
    world->spare_pairs.items[place] = index;
  }
  world->sums.items[block] = sums;
}

void scree_kernel_combine(scree_world *world, scree_device_step *step) {
  if (thread_index() > 0 || step->too_small) return;
  step->sums = scree_combine_sums(world);
}

void scree_kernel_gather(scree_world *world, scree_device_step *step) {
  uint32_t i = thread_index();
  if (i >= world->bodies.count || world->bodies.removed[i] || step->too_small ||
      has_trouble(&step->sums))
    return;
  if (!scree_gather_body(world, i)) __nvvm_atom_min_gen_ui(&step->offender, i);
}

void scree_kernel_book(scree_world *world, scree_device_step *step) {
  if (thread_index() > 0 || step->too_small || has_trouble(&step->sums) ||
      step->offender != scree_none)
    return;
  scree_book_work(world);
}

void scree_kernel_advance(scree_world *world, scree_device_step *step) {
  uint32_t i = thread_index();
  if (i >= world->bodies.count || world->bodies.removed[i] || step->too_small ||
      has_trouble(&step->sums) || step->offender != scree_none)
    return;
  scree_advance_body(world, i);
  if (!(world->bodies.frame[i].position.z < world->options.floor_height)) return;
  world->bodies.removed[i] = true;
  __nvvm_atom_max_gen_ui(&step->fallen, 1);
}
