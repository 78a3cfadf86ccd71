/* The cuda backend: the kernels of a step on the mirror of a world (cuda_state.c).
 *
 * The state goes to the device when steps begin, and stays there. The host only asks for steps,
 * several at once: where the neighbours hold no longer, a pair finds too little room in a pool, or
 * something is wrong, the kernels do nothing more until the host has mended it. Every world has a
 * queue of its own, so that worlds that are stepped by several threads share the device.
 */
#include "world/broad/broad.h"
#include "world/broad/spheres.h"
#include "world/device/backend.h"
#include "world/device/cuda_state.h"
#include "world/observe/sums.h"
#include "world/state/joints.h"
#include "world/state/pairs.h"
#include "world/state/remote.h"
#include "world/step/stages.h"

#include "base/alloc.h"
#include "base/error.h"
#include "world/device/cuda_driver.h"

/* Steps of several worlds in the same launches: each is too small to fill a device. */

/* What a world asks for: up to `steps` steps, by its struct on the device. */
typedef struct scree_cuda_request {
  scree_device_address world;
  scree_device_step *step; /* goes to the device and comes back */
  size_t steps;
  size_t counts[SCREE_STEP_KERNELS]; /* about how many elements each kernel has */
} scree_cuda_request;

#ifdef SCREE_WITH_CUDA
#include <pthread.h>
#include <string.h>
#include <time.h>

/* A world's request in the list of those that wait. */
typedef struct waiting {
  const scree_cuda_request *request;
  scree_status status;
  scree_error error;
  bool done;
  struct waiting *next;
} waiting;

/* The worlds that step together on a device. One of the threads that wait leads: it does the steps
 * of all that wait then, while others come and wait for the next round. */
static struct batch {
  pthread_mutex_t mutex;
  pthread_cond_t changed;
  waiting *first;
  size_t count, last_count; /* who wait; who were in the last round */
  bool led;
  scree_cuda_queue queue;
  scree_cuda_block worlds, steps;
} batches[SCREE_MOST_DEVICES];
static pthread_once_t once = PTHREAD_ONCE_INIT;
static const long patience = 300000; /* ns, for those of the last round to come again */

static void set_up(void) {
  for (int i = 0; i < SCREE_MOST_DEVICES; i++) {
    pthread_mutex_init(&batches[i].mutex, NULL);
    pthread_cond_init(&batches[i].changed, NULL);
    batches[i].queue.device = i;
  }
}

static size_t most_elements(const waiting *first, int kernel) {
  size_t most = 0;
  for (const waiting *w = first; w; w = w->next)
    if (w->request->counts[kernel] > most) most = w->request->counts[kernel];
  return most;
}

static scree_status launch_all(struct batch *b, const waiting *first, size_t count,
                               scree_error *error) {
  size_t steps = 0;
  for (const waiting *w = first; w; w = w->next)
    if (w->request->steps > steps) steps = w->request->steps;
  for (size_t i = 0; i < steps; i++)
    for (int k = 0; k < SCREE_STEP_KERNELS; k++)
      if (most_elements(first, k) > 0)
        SCREE_TRY(scree_cuda_launch(&b->queue, (scree_kernel)k, most_elements(first, k), count,
                                    b->worlds.at, b->steps.at, error));
  return SCREE_OK;
}

/* The structs of all lie side by side. */
static scree_status do_all(struct batch *b, waiting *first, size_t count, scree_error *error) {
  const size_t world_bytes = count * sizeof(scree_device_address),
               step_bytes = count * sizeof(scree_device_step);
  SCREE_SCRATCH(scree_device_address, worlds, count, error);
  SCREE_SCRATCH(scree_device_step, steps, count, error);
  if (!b->queue.stream) SCREE_TRY(scree_cuda_open_queue(&b->queue, error));
  SCREE_TRY(scree_cuda_reserve(&b->worlds, world_bytes, error));
  SCREE_TRY(scree_cuda_reserve(&b->steps, step_bytes, error));
  size_t i = 0;
  for (const waiting *w = first; w; w = w->next, i++) {
    worlds[i] = w->request->world;
    steps[i] = *w->request->step;
  }
  SCREE_TRY(scree_cuda_write(&b->queue, b->worlds.at, worlds, world_bytes, error));
  SCREE_TRY(scree_cuda_write(&b->queue, b->steps.at, steps, step_bytes, error));
  SCREE_TRY(launch_all(b, first, count, error));
  SCREE_TRY(scree_cuda_read(&b->queue, steps, b->steps.at, step_bytes, error));
  i = 0;
  for (const waiting *w = first; w; w = w->next, i++) *w->request->step = steps[i];
  return SCREE_OK;
}

/* Those of the last round are back soon, as a rule. */
static void wait_for_others(struct batch *b) {
  struct timespec until;
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_nsec += patience;
  until.tv_sec += until.tv_nsec / 1000000000;
  until.tv_nsec %= 1000000000;
  while (b->count < b->last_count)
    if (pthread_cond_timedwait(&b->changed, &b->mutex, &until)) break;
}

/* The mutex is held, but while the device works. */
static void lead(struct batch *b) {
  b->led = true;
  wait_for_others(b);
  waiting *first = b->first;
  size_t count = b->last_count = b->count;
  b->first = NULL;
  b->count = 0;
  pthread_mutex_unlock(&b->mutex);
  scree_error error;
  scree_status status = do_all(b, first, count, &error);
  pthread_mutex_lock(&b->mutex);
  for (waiting *w = first; w; w = w->next) {
    w->status = status;
    if (status) w->error = error;
    w->done = true;
  }
  b->led = false;
  pthread_cond_broadcast(&b->changed);
}

/* Does it, together with what other threads ask for meanwhile; waits for it. */
static scree_status cuda_do_steps(int device, const scree_cuda_request *request,
                                  scree_error *error) {
  pthread_once(&once, set_up);
  struct batch *b = &batches[device];
  waiting own = {.request = request};
  pthread_mutex_lock(&b->mutex);
  own.next = b->first;
  b->first = &own;
  b->count++;
  pthread_cond_broadcast(&b->changed);
  while (!own.done) {
    if (b->led)
      pthread_cond_wait(&b->changed, &b->mutex);
    else
      lead(b);
  }
  pthread_mutex_unlock(&b->mutex);
  if (own.status) *error = own.error;
  return own.status;
}

#endif

#ifdef SCREE_WITH_CUDA

enum { STEPS_AT_ONCE = 8 };
/* For how many threads are started: parts of lists and of depths, in all and for each of the
 * neighbours; feature pairs of a pair. */
enum { PARTS_AT_ONCE = 32768, PARTS = 64, VISITS = 4 };

/* For so many steps. */
static scree_status launch(scree_world *w, size_t steps) {
  struct scree_device_world *d = w->residence.on_device;
  const size_t bodies = w->bodies.count, pairs = w->list.neighbours.count,
               awake = d->awake ? d->awake : pairs,
               spheres = w->spheres.list.pairs.count ? w->spheres.list.count : 0,
               parts = PARTS * pairs < PARTS_AT_ONCE ? PARTS * pairs : PARTS_AT_ONCE;
  const scree_cuda_request request = {
      .world = d->own[BLOCK_WORLD].at,
      .step = &d->header,
      .steps = steps,
      .counts = {[SCREE_KERNEL_awake] = pairs,
                 [SCREE_KERNEL_relate] = awake,
                 [SCREE_KERNEL_list_count] = parts,
                 [SCREE_KERNEL_list_place] = awake,
                 [SCREE_KERNEL_list_write] = parts,
                 [SCREE_KERNEL_list_end] = awake,
                 [SCREE_KERNEL_visit] = VISITS * awake,
                 [SCREE_KERNEL_meet] = awake,
                 [SCREE_KERNEL_depth] = parts,
                 [SCREE_KERNEL_contact_law] = awake,
                 [SCREE_KERNEL_spheres_load] = spheres,
                 [SCREE_KERNEL_spheres] = w->spheres.list.pairs.count,
                 [SCREE_KERNEL_spheres_gather] = spheres,
                 [SCREE_KERNEL_joints] = w->joints.all.count,
                 [SCREE_KERNEL_gather] = bodies,
                 [SCREE_KERNEL_advance] = bodies + w->walls.count,
                 [SCREE_KERNEL_end] = 1}};
  return cuda_do_steps(d->queue.device, &request, &w->failure);
}

/* The pools that were asked for more than they have grow. */
static scree_status make_room(scree_world *w) {
  struct scree_device_world *d = w->residence.on_device;
  scree_status status = scree_cuda_fetch(w, d, SCREE_ALL_PARTS, &w->failure);
  if (status) return status;
  while (d->contact_capacity < d->contacts_used) d->contact_capacity *= 2;
  bool good = w->spare_pairs.count >= 0 || scree_pairs_grow(w);
  if (!good || !scree_pools_grow(&w->pools, w->pairs.items, w->pairs.count,
                                 w->list.neighbours.items, w->list.neighbours.count))
    return scree_fail_memory(&w->failure, 0, "contact features of a pair");
  const double begun = w->time; /* the device has done some steps since */
  for (uint64_t i = 0; i < d->header.done; i++) w->time += w->time_step;
  status = scree_cuda_send(w, d, &w->failure);
  w->time = begun;
  if (!status) scree_cuda_part_with(w, d);
  return status;
}

/* Lists the pairs of a state that is there already. */
static scree_status list_there(scree_world *w, struct scree_device_world *d) {
  scree_cuda_place place = scree_cuda_place_of(d);
  size_t count = 0;
  d->listed = true;
  SCREE_TRY(scree_cuda_broad_find(d->broad, w, &place, &count, &w->failure));
  SCREE_TRY(scree_cuda_broad_list(d->broad, w, &place, count, &w->failure));
  SCREE_TRY(scree_cuda_reserve_own(w, d, &w->failure));
  SCREE_TRY(scree_cuda_wait(&d->queue, &w->failure));
  scree_cuda_lead_header(w, d);
  return SCREE_OK;
}

static scree_status list_here(scree_world *w, struct scree_device_world *d) {
  SCREE_TRY(scree_broad_update(w, &w->failure));
  d->contacts_used = 0;
  SCREE_TRY(scree_reserve_blocks(w, &w->failure));
  SCREE_TRY(scree_spheres_list_seconds(w, &w->failure));
  return scree_cuda_send(w, d, &w->failure);
}

/* The device has the state, and neighbours that hold. */
static scree_status prepare(scree_world *w) {
  struct scree_device_world *d = w->residence.on_device;
  SCREE_TRY(scree_joints_prepare(w, &w->failure));
  const bool lists_spheres = (d->header.stale || w->list.stale) &&
                             (w->spheres.list.count > 1 || scree_spheres_are_there(w));
  if (d->current && lists_spheres) /* which are listed here */
    SCREE_TRY(scree_world_change(w, SCREE_ALL_PARTS, &w->failure));
  bool there = d->current;
  SCREE_TRY(there ? scree_cuda_send_changed(w, d, &w->failure) : list_here(w, d));
  SCREE_TRY(scree_cuda_tell(d, offsetof(scree_world, time_step), sizeof w->time_step, &w->failure));
  scree_cuda_part_with(w, d);
  d->settled = false;
  if (there && (d->header.stale || w->list.stale)) SCREE_TRY(list_there(w, d));
  d->header.stale = d->header.fallen = d->header.parted = 0;
  return SCREE_OK;
}

static void begin_steps(struct scree_device_world *d, size_t wanted) {
  scree_device_step *h = &d->header;
  h->done = 0;
  h->wanted = wanted;
  h->awake_count = h->depth_job_count = h->resume = 0;
  h->depths_used = 0;
  h->offender = scree_none;
  h->tally = (scree_tally){.trouble = scree_no_trouble};
  h->list_builds = h->evaluations = 0;
}

/* What was not done of a step that has begun goes on. */
static void go_on(struct scree_device_world *d, bool resume) {
  scree_device_step *h = &d->header;
  h->stop = h->too_small = h->again = h->new_list_count = 0;
  h->resume = resume;
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++) h->visit_counts[kind] = 0;
}

/* Bodies that are below the floor. */
static scree_status note_fallen(scree_world *w) {
  struct scree_device_world *d = w->residence.on_device;
  if (!d->header.fallen) return SCREE_OK;
  SCREE_TRY(scree_cuda_fetch_removed(w, d, &w->failure));
  size_t removed = 0;
  for (size_t i = 0; i < w->bodies.count; i++) removed += w->bodies.removed[i];
  w->bodies.removed_count = removed;
  w->list.stale = true;
  return SCREE_OK;
}

static scree_status note_parted(scree_world *w) {
  if (!w->residence.on_device->header.parted) return SCREE_OK;
  SCREE_TRY(scree_world_change(w, SCREE_PART_JOINTS, &w->failure));
  scree_joints_regroup(w);
  return SCREE_OK;
}

static scree_status finish(scree_world *w) {
  const scree_device_step *h = &w->residence.on_device->header;
  const scree_trouble *t = &h->tally.trouble;
  if (!scree_is_trouble(t) && h->offender == scree_none) return SCREE_OK;
  scree_status status = scree_cuda_fetch(w, w->residence.on_device, SCREE_ALL_PARTS, &w->failure);
  if (status) return status;
  return h->offender != scree_none ? scree_describe_offender(w, h->offender)
                                   : scree_describe_trouble(w, t);
}

static void count_steps(scree_world *w, const scree_device_step *h, double started) {
  for (uint64_t i = 0; i < h->done; i++) w->time += w->time_step;
  w->step_count += h->done;
  w->depenetration_count += h->tally.depenetrations;
  if (h->done) w->largest_overlap = h->last_overlap;
  w->timings.contacts += scree_now() - started;
  w->timings.total += scree_now() - started;
  w->timings.steps += h->done;
  if (h->done) w->residence.on_device->awake = (size_t)(h->evaluations / h->done);
  w->timings.list_builds += h->list_builds;
  w->timings.pair_evaluations += h->done * (w->list.neighbours.count + w->spheres.list.pairs.count);
}

/* Mostly nothing was. */
static scree_status fetch_hardened(scree_world *w) {
  struct scree_device_world *d = w->residence.on_device;
  if (d->header.tally.hardened == 0) return SCREE_OK;
  const size_t count = w->materials.count * (w->materials.count + 1) / 2;
  return scree_cuda_read(&d->queue, w->materials.hardened,
                         d->own[BLOCK_WORLD].at + offsetof(scree_world, materials.hardened),
                         count * sizeof *w->materials.hardened, &w->failure);
}

static scree_status step(scree_world *w, size_t most, size_t *done) {
  struct scree_device_world *d = w->residence.on_device;
  if (w->bodies.count == 0) { /* there are no arrays */
    scree_status status = scree_world_change(w, SCREE_ALL_PARTS, &w->failure);
    return status ? status : scree_backend_cpu.step(w, most, done);
  }
  double started = scree_now();
  scree_status status = prepare(w);
  double after_broad = scree_now();
  w->timings.broad += after_broad - started;
  w->timings.total += after_broad - started;
  if (most > STEPS_AT_ONCE) most = STEPS_AT_ONCE;
  begin_steps(d, most);
  for (bool resume = false; !status; resume = true) {
    go_on(d, resume);
    status = launch(w, most - d->header.done);
    if (status || !(d->header.too_small || d->header.again)) break;
    if (d->header.too_small) status = make_room(w);
  }
  if (!status) status = note_fallen(w);
  if (!status) status = note_parted(w);
  if (!status) status = fetch_hardened(w);
  if (status && d->current) scree_cuda_lose(w);
  if (status) return status;
  *done = d->header.done;
  count_steps(w, &d->header, after_broad);
  return finish(w);
}

/* ---- looking ---- */

/* Forces on walls, which follow from pairs. */
static scree_status settle(scree_world *w, struct scree_device_world *d) {
  scree_cuda_place place = scree_cuda_place_of(d);
  SCREE_TRY(
      scree_cuda_tell(d, offsetof(scree_world, step_count), sizeof w->step_count, &w->failure));
  SCREE_TRY(scree_cuda_launch(&d->queue, SCREE_KERNEL_wall_forces, w->walls.count, 1, place.worlds,
                              0, &w->failure));
  d->settled = true;
  return SCREE_OK;
}

static scree_status bring(struct scree_device_world *d, unsigned parts, scree_error *error) {
  scree_world *w = d->world;
  if (parts & SCREE_PART_LISTS && d->away) parts = SCREE_ALL_PARTS; /* they follow from all */
  if (!(parts & d->away)) return SCREE_OK;
  scree_status status = scree_cuda_use(d->queue.device, &w->failure);
  if (!status && parts & d->away & SCREE_PART_WALLS && !d->settled) status = settle(w, d);
  if (!status) return scree_cuda_fetch(w, d, parts, error);
  scree_cuda_lose(w);
  if (error && error != &w->failure) *error = w->failure;
  return status;
}

/* Lists are made anew from all that is here. */
static void change(struct scree_device_world *d, unsigned parts) {
  d->changed |= parts;
  if (parts & SCREE_PART_LISTS) d->current = false;
}

static scree_status sum_there(scree_world *w, struct scree_device_world *d, scree_sums *sums,
                              scree_error *error) {
  enum { AT_ONCE = 32 };
  scree_sums parts[AT_ONCE];
  const size_t count = scree_sum_part_count(w);
  const scree_cuda_place place = scree_cuda_place_of(d);
  scree_cuda_block *block = &d->own[BLOCK_SUMS];
  SCREE_TRY(scree_cuda_use(d->queue.device, error));
  SCREE_TRY(scree_cuda_send_changed(w, d, error));
  SCREE_TRY(scree_cuda_reserve(block, count * sizeof *parts, error));
  const uintptr_t at = (uintptr_t)block->at;
  SCREE_TRY(
      scree_cuda_broad_tell(&place, offsetof(scree_world, residence.sums), &at, sizeof at, error));
  SCREE_TRY(scree_cuda_tell(d, offsetof(scree_world, step_count), sizeof w->step_count, error));
  SCREE_TRY(scree_cuda_launch(&d->queue, SCREE_KERNEL_sums, count, 1, place.worlds, 0, error));
  for (size_t first = 0; first < count; first += AT_ONCE) {
    size_t some = count - first < AT_ONCE ? count - first : AT_ONCE;
    SCREE_TRY(scree_cuda_read(&d->queue, parts, block->at + first * sizeof *parts,
                              some * sizeof *parts, error));
    for (size_t i = 0; i < some; i++) scree_sums_merge(sums, &parts[i]);
  }
  return SCREE_OK;
}

static bool sum(struct scree_device_world *d, scree_sums *sums) {
  scree_world *w = d->world;
  if (!d->current || !d->away) return false;
  if (sum_there(w, d, sums, &w->failure) == SCREE_OK) return true;
  scree_cuda_lose(w);
  return false;
}

static void release(scree_world *w) {
  struct scree_device_world *d = w->residence.on_device;
  scree_cuda_free_state(w, d);
  scree_free(d);
  w->residence.on_device = NULL;
}

static const scree_remote on_device = {bring, change, sum, release};

static scree_status begin(scree_world *w, int device, scree_error *error) {
  if (w->residence.on_device) return scree_cuda_use(w->residence.on_device->queue.device, error);
  struct scree_device_world *d = scree_alloc_zero(1, sizeof *d);
  if (d) d->image = scree_alloc_zero(1, sizeof *d->image);
  if (!d || !d->image) {
    scree_free(d);
    return scree_fail_memory(error, sizeof *w, "a world on a device");
  }
  w->residence.on_device = d;
  w->residence.remote = &on_device;
  d->world = w;
  d->queue.device = device;
  scree_status status = scree_cuda_use(device, error);
  return status ? status : scree_cuda_open_queue(&d->queue, error);
}

int scree_cuda_device_of(const scree_world *w) {
  return w->residence.on_device ? w->residence.on_device->queue.device : -1;
}

const scree_backend scree_backend_cuda = {"cuda", begin, step};

#else

static scree_status unsupported(scree_world *world, int device, scree_error *error) {
  (void)world, (void)device;
  char description[256];
  return scree_cuda_open(0, description, error);
}

int scree_cuda_device_of(const scree_world *world) {
  (void)world;
  return -1;
}

const scree_backend scree_backend_cuda = {"cuda", unsupported, NULL};

#endif
