/* The cuda backend: a mirror of the world's arrays on the device, on which the kernels of a step
 * run. The device has a copy of the world's own struct with its pointers led to the mirror, so that
 * both sides run the same code on the same indices.
 *
 * The state goes to the device when steps begin and comes back when they end. In between the host
 * only asks for steps, several at once: where the neighbours hold no longer, a pair finds too
 * little room in a pool, or something is wrong, the kernels do nothing more until the host has
 * mended it. Every world has a queue of its own, so that worlds that are stepped by several threads
 * share the device. */
#include "world/backend.h"
#include "world/broad.h"
#include "world/contact.h"
#include "world/cuda_batch.h"
#include "world/cuda_broad.h"
#include "world/pairs.h"
#include "world/stages.h"
#include "world/walls.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <string.h>

#ifdef SCREE_WITH_CUDA

/* An array of the world and its mirror. */
typedef struct span {
  size_t field;          /* where in scree_world its pointer is */
  size_t capacity, used; /* bytes */
  bool comes_back;
} span;

enum { MOST_SPANS = 40, FIRST_TOUCHES = 4096, STEPS_AT_ONCE = 8 };
/* For how many threads are started: parts of lists and of depths, in all and for each of the
 * neighbours; items of a pair. */
enum { PARTS_AT_ONCE = 32768, PARTS = 64, VISITS = 4 };

/* What the device alone has. */
enum {
  BLOCK_PARTICLES,
  BLOCK_SHAPES,
  BLOCK_WALLS,
  BLOCK_WORLD,
  BLOCK_WORLDS, /* where it is: a list of one */
  BLOCK_HANDS,
  BLOCK_PROGRESS,
  BLOCK_TOUCHES,
  BLOCK_TOUCH_COUNTS,
  BLOCK_DUE,
  BLOCK_DEPTH_JOBS,
  BLOCK_DEPTHS,
  BLOCK_VISITS,
  BLOCK_COUNT = BLOCK_VISITS + SCREE_VISIT_KINDS
};

struct scree_device_world {
  scree_cuda_queue queue;
  scree_cuda_block arrays[MOST_SPANS], own[BLOCK_COUNT];
  scree_cuda_broad *broad;
  uint64_t touch_capacity, touches_used;
  size_t awake; /* pairs in a step, about */
  scree_device_step header;
  scree_world *image;          /* the device's struct */
  const scree_particle **seen; /* bodies' particles whose shapes are on the device */
  size_t seen_count;
  scree_device_address *addresses; /* of the bodies' shapes, then of the walls' */
  size_t address_count;
  bool current; /* the device has the state */
  bool listed;  /* the neighbours were made there */
};

#define FIELD(member) offsetof(scree_world, member)

/* All arrays that the kernels use, but for those with pointers in them. */
static size_t list_spans(const scree_world *w, span spans[MOST_SPANS]) {
  const size_t n = w->bodies.count, k = w->neighbours.count, p = w->pairs.count;
  const scree_pools *pools = &w->pools;
  const size_t items = pools->items_used, sleepers = pools->sleepers_used;
#define OF(member, count, back)                                                                    \
  { FIELD(member), (count) * sizeof *w->member, (count) * sizeof *w->member, back }
#define POOL(member, room, count)                                                                  \
  { FIELD(member), (room) * sizeof *w->member, (count) * sizeof *w->member, true }
  const span all[] = {
      OF(bodies.frame, n, true),
      OF(bodies.orientation, n, true),
      OF(bodies.momentum, n, true),
      OF(bodies.inertia, n, false),
      OF(bodies.force, n, true),
      OF(bodies.torque, n, true),
      OF(bodies.mass, n, false),
      OF(bodies.travel, n, true),
      OF(bodies.path, n, true),
      OF(bodies.turn, n, true),
      OF(bodies.removed, n, true),
      OF(bodies.material, n, false),
      OF(neighbours.items, k, true),
      OF(pair_of.items, k, true),
      OF(ledger.items, k, true),
      OF(keys.items, k, false),
      OF(pairs.items, p, true),
      OF(spare_pairs.items, p, true),
      POOL(pools.items, pools->item_capacity, items),
      POOL(pools.further, pools->item_capacity, items),
      POOL(pools.sleepers, pools->sleeper_capacity, sleepers),
      OF(slots.items, k, true),
      OF(due.items, n + w->walls.count, true),
      OF(touching.items, k / 64 + 1, true),
      OF(sides.items, w->sides.count, false),
      OF(wall_pairs.items, w->wall_pairs.count, false),
      OF(bodies.applied, w->bodies.applied ? n : 0, true),
      OF(bodies.booked, n, true),
      OF(side_begin, n + 1, false),
      {FIELD(acting.items), w->sides.count * sizeof(uint32_t), 0, false},
      {FIELD(awake.items), k * sizeof(uint32_t), 0, false},
      OF(body_path_at_build, n, true),
      OF(motions.items, w->motions.count, false),
      OF(motion_rows.items, w->motion_rows.count, false),
  };
#undef OF
#undef POOL
  memcpy(spans, all, sizeof all);
  return sizeof all / sizeof *all;
}

static void *pointer_at(const scree_world *world, size_t field) {
  void *pointer;
  memcpy(&pointer, (const char *)world + field, sizeof pointer);
  return pointer;
}

/* ---- shapes ---- */

/* An array of a particle, or the particle itself, in the block of all shapes. */
typedef struct packer {
  char *bytes; /* NULL: only measured */
  size_t used;
  scree_device_address base;
} packer;

static scree_device_address pack(packer *p, const void *from, size_t size) {
  scree_device_address at = p->base + p->used;
  if (p->bytes && from && size) memcpy(p->bytes + p->used, from, size);
  p->used = (p->used + size + 63) & ~(size_t)63;
  return at;
}

/* Leads a pointer of a copy to the device. */
static void lead(packer *p, void *pointer, size_t count, size_t size) {
  void *from;
  memcpy(&from, pointer, sizeof from);
  if (!from) return;
  uintptr_t at = (uintptr_t)pack(p, from, count * size);
  memcpy(pointer, &at, sizeof at);
}

static void pack_tree(packer *p, scree_tree *tree) {
  size_t nodes = tree->item_count ? 1 : 0; /* children come in twos, after their parent */
  for (size_t i = 0; i < nodes; i++) nodes += tree->nodes[i].count ? 0 : 2;
  lead(p, &tree->nodes, nodes, sizeof *tree->nodes);
  lead(p, &tree->cones, nodes, sizeof *tree->cones);
  lead(p, &tree->order, tree->item_count, sizeof *tree->order);
}

static scree_device_address pack_shape(packer *p, const scree_particle *particle) {
  scree_particle copy;
  memcpy(&copy, particle, sizeof copy);
  lead(p, &copy.mesh.triangles, 3 * copy.mesh.triangle_count, sizeof *copy.mesh.triangles);
  lead(p, &copy.mesh.positions, 3 * copy.mesh.vertex_count, sizeof *copy.mesh.positions);
  lead(p, &copy.core, 3 * copy.mesh.vertex_count, sizeof *copy.core);
  pack_tree(p, &copy.face_tree);
  pack_tree(p, &copy.edge_tree);
  pack_tree(p, &copy.point_tree);
  lead(p, &copy.faces, copy.face_count, sizeof *copy.faces);
  lead(p, &copy.face_signs, copy.face_count, sizeof *copy.face_signs);
  lead(p, &copy.points, copy.point_count, sizeof *copy.points);
  lead(p, &copy.point_radii, copy.point_count, sizeof *copy.point_radii);
  lead(p, &copy.edges, copy.edge_count, sizeof *copy.edges);
  return pack(p, &copy, sizeof copy);
}

static const scree_particle *shape_at(const scree_world *w, size_t i) {
  size_t n = w->bodies.count;
  return i < n ? w->bodies.particle[i] : w->walls.items[i - n].surface;
}

/* Every particle once, bodies' and walls' alike, and the addresses of all. */
static void pack_shapes(const scree_world *w, packer *p, scree_device_address *addresses) {
  size_t count = w->bodies.count + w->walls.count;
  for (size_t i = 0; i < count; i++) {
    const scree_particle *particle = shape_at(w, i);
    size_t same = i;
    for (size_t k = i; k-- > 0 && same == i;)
      if (shape_at(w, k) == particle) same = k;
    addresses[i] = !particle ? 0 : same < i ? addresses[same] : pack_shape(p, particle);
  }
}

/* What is on the device is still right. */
static bool shapes_are_there(const scree_world *w, const struct scree_device_world *d) {
  size_t count = w->bodies.count + w->walls.count;
  if (d->seen_count != count) return false;
  for (size_t i = 0; i < count; i++)
    if (d->seen[i] != shape_at(w, i)) return false;
  return true;
}

static scree_status send_shapes(scree_world *w, struct scree_device_world *d, scree_error *error) {
  if (shapes_are_there(w, d)) return SCREE_OK;
  size_t count = w->bodies.count + w->walls.count;
  void *seen = scree_resize(d->seen, count, sizeof *d->seen);
  if (seen) d->seen = seen;
  void *addresses = scree_resize(d->addresses, count, sizeof *d->addresses);
  if (addresses) d->addresses = addresses;
  if (!seen || !addresses) return scree_fail_memory(error, count * sizeof *d->addresses, "shapes");
  packer measured = {0};
  pack_shapes(w, &measured, d->addresses);
  scree_status status = scree_cuda_reserve(&d->own[BLOCK_SHAPES].at, &d->own[BLOCK_SHAPES].capacity,
                                           measured.used, error);
  if (status) return status;
  packer p = {scree_alloc_zero(measured.used, 1), 0, d->own[BLOCK_SHAPES].at};
  if (!p.bytes) return scree_fail_memory(error, measured.used, "shapes");
  pack_shapes(w, &p, d->addresses);
  status = scree_cuda_write(&d->queue, d->own[BLOCK_SHAPES].at, p.bytes, p.used, error);
  scree_free(p.bytes);
  if (status) return status;
  for (size_t i = 0; i < count; i++) d->seen[i] = shape_at(w, i);
  d->seen_count = count;
  size_t bytes = w->bodies.count * sizeof *d->addresses;
  status = scree_cuda_reserve(&d->own[BLOCK_PARTICLES].at, &d->own[BLOCK_PARTICLES].capacity, bytes,
                              error);
  return status
             ? status
             : scree_cuda_write(&d->queue, d->own[BLOCK_PARTICLES].at, d->addresses, bytes, error);
}

static void lead_to(void *pointer, scree_device_address address) {
  uintptr_t at = (uintptr_t)address;
  memcpy(pointer, &at, sizeof at);
}

static scree_status send_walls(const scree_world *w, struct scree_device_world *d,
                               scree_error *error) {
  size_t count = w->walls.count, bytes = count * sizeof *w->walls.items;
  if (count == 0) return SCREE_OK;
  scree_world_wall *copy = scree_alloc(count, sizeof *copy);
  if (!copy) return scree_fail_memory(error, bytes, "walls");
  memcpy(copy, w->walls.items, bytes);
  for (size_t i = 0; i < count; i++) lead_to(&copy[i].surface, d->addresses[w->bodies.count + i]);
  scree_status status =
      scree_cuda_reserve(&d->own[BLOCK_WALLS].at, &d->own[BLOCK_WALLS].capacity, bytes, error);
  if (!status) status = scree_cuda_write(&d->queue, d->own[BLOCK_WALLS].at, copy, bytes, error);
  scree_free(copy);
  return status;
}

/* ---- the whole state, there and back ---- */

/* How many lists are made at once, and how many depths looked for. */
static uint32_t lists_of(const scree_world *w) {
  size_t share = w->neighbours.count / 32;
  return share < 64 ? 64 : share > 4096 ? 4096 : (uint32_t)share;
}
static size_t depths_of(const scree_world *w) {
  size_t share = 8 * w->neighbours.count;
  return share < 65536 ? 65536 : share > 1 << 22 ? 1 << 22 : share;
}

/* The memory of one of those arrays. */
static scree_cuda_block *array_at(scree_world *w, size_t field) {
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans), i = 0;
  while (i < count && spans[i].field != field) i++;
  return &w->on_device->arrays[i];
}

static scree_cuda_place place_of(const struct scree_device_world *d) {
  return (scree_cuda_place){&d->queue, d->own[BLOCK_WORLD].at, d->own[BLOCK_WORLDS].at, d->image,
                            array_at};
}

static void lead_header(const scree_world *w, struct scree_device_world *d) {
  lead_to(&d->header.hands, d->own[BLOCK_HANDS].at);
  lead_to(&d->header.progress, d->own[BLOCK_PROGRESS].at);
  lead_to(&d->header.touch_counts, d->own[BLOCK_TOUCH_COUNTS].at);
  lead_to(&d->header.due, d->own[BLOCK_DUE].at);
  d->header.due_capacity = lists_of(w);
  lead_to(&d->header.depth_jobs, d->own[BLOCK_DEPTH_JOBS].at);
  lead_to(&d->header.depths, d->own[BLOCK_DEPTHS].at);
  d->header.depth_capacity = depths_of(w);
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++)
    lead_to(&d->header.visits[kind], d->own[BLOCK_VISITS + kind].at);
}

static scree_status send_image(scree_world *w, struct scree_device_world *d,
                               scree_device_address broad, scree_error *error) {
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  memcpy(d->image, w, sizeof *w);
  void **const hosts_own[] = {(void **)&d->image->scratch,   (void **)&d->image->progress.items,
                              (void **)&d->image->offenders, (void **)&d->image->on_device,
                              (void **)&d->image->kept.path, (void **)&d->image->kept.bytes};
  for (size_t i = 0; i < sizeof hosts_own / sizeof *hosts_own; i++) *hosts_own[i] = NULL;
  for (size_t i = 0; i < count; i++)
    lead_to((char *)d->image + spans[i].field, spans[i].capacity ? d->arrays[i].at : 0);
  lead_to(&d->image->broad, broad);
  lead_to(&d->image->bodies.particle, d->own[BLOCK_PARTICLES].at);
  lead_to(&d->image->walls.items, d->own[BLOCK_WALLS].at);
  lead_to(&d->image->pools.touches, d->own[BLOCK_TOUCHES].at);
  d->image->pools.touch_capacity = d->touch_capacity;
  d->image->pools.touches_used = d->touches_used;
  lead_header(w, d);
  return scree_cuda_write(&d->queue, d->own[BLOCK_WORLD].at, d->image, sizeof *w, error);
}

static scree_status reserve_own(const scree_world *w, struct scree_device_world *d,
                                scree_error *error) {
  const size_t k = w->neighbours.count;
  if (d->touch_capacity == 0) d->touch_capacity = FIRST_TOUCHES;
  size_t sizes[BLOCK_COUNT] = {[BLOCK_WORLD] = sizeof *w,
                               [BLOCK_WORLDS] = sizeof(scree_device_address),
                               [BLOCK_HANDS] = k * sizeof(scree_scratch),
                               [BLOCK_PROGRESS] = k,
                               [BLOCK_TOUCHES] = d->touch_capacity * sizeof(scree_touch),
                               [BLOCK_TOUCH_COUNTS] = d->touch_capacity,
                               [BLOCK_DUE] = lists_of(w) * sizeof(scree_due_list),
                               [BLOCK_DEPTH_JOBS] = SCREE_MOST_DEPTH_JOBS * sizeof(scree_depth_job),
                               [BLOCK_DEPTHS] = depths_of(w) * sizeof(scree_depth)};
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++)
    sizes[BLOCK_VISITS + kind] = w->pools.item_capacity * sizeof(scree_visit);
  scree_status status = SCREE_OK;
  for (int i = 0; i < BLOCK_COUNT && !status; i++)
    status = scree_cuda_reserve(&d->own[i].at, &d->own[i].capacity, sizes[i], error);
  return status;
}

static scree_status send(scree_world *w, struct scree_device_world *d, scree_error *error) {
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  scree_status status = send_shapes(w, d, error);
  if (!status) status = send_walls(w, d, error);
  if (!status) status = reserve_own(w, d, error);
  for (size_t i = 0; i < count && !status; i++) {
    status = scree_cuda_reserve(&d->arrays[i].at, &d->arrays[i].capacity, spans[i].capacity, error);
    if (!status)
      status = scree_cuda_write(&d->queue, d->arrays[i].at, pointer_at(w, spans[i].field),
                                spans[i].used, error);
  }
  scree_device_address broad = 0;
  scree_cuda_place place = place_of(d);
  if (!status) status = scree_cuda_broad_send(&d->broad, w, &place, &broad, error);
  if (!status) status = send_image(w, d, broad, error);
  if (!status)
    status = scree_cuda_write(&d->queue, d->own[BLOCK_WORLDS].at, &d->own[BLOCK_WORLD].at,
                              sizeof(scree_device_address), error);
  if (!status) status = scree_cuda_wait(&d->queue, error); /* steps have another queue */
  d->current = status == SCREE_OK;
  return status;
}

/* What steps change of the struct itself. */
static void take_numbers(scree_world *w, const scree_world *image) {
  w->largest_overlap = image->largest_overlap;
  w->spare_pairs.count = image->spare_pairs.count;
  w->pools.items_used = image->pools.items_used;
  w->pools.sleepers_used = image->pools.sleepers_used;
}

/* The walls have come elsewhere. */
static scree_status fetch_walls(scree_world *w, struct scree_device_world *d, scree_error *error) {
  size_t count = w->walls.count;
  if (count == 0) return SCREE_OK;
  scree_world_wall *copy = scree_alloc(count, sizeof *copy);
  if (!copy) return scree_fail_memory(error, count * sizeof *copy, "walls");
  scree_status status =
      scree_cuda_read(&d->queue, copy, d->own[BLOCK_WALLS].at, count * sizeof *copy, error);
  for (size_t i = 0; i < count && !status; i++) {
    scree_particle *surface = w->walls.items[i].surface;
    w->walls.items[i] = copy[i];
    w->walls.items[i].surface = surface;
  }
  scree_free(copy);
  return status;
}

static scree_status fetch_all(scree_world *w, struct scree_device_world *d, scree_error *error) {
  scree_status status =
      scree_cuda_read(&d->queue, d->image, d->own[BLOCK_WORLD].at, sizeof *w, error);
  if (status) return status;
  take_numbers(w, d->image);
  if (d->listed && !scree_broad_reserve(w)) return scree_fail_memory(error, 0, "pairs of bodies");
  d->touches_used = d->image->pools.touches_used;
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  for (size_t i = 0; i < count && !status; i++) {
    size_t used = spans[i].used < spans[i].capacity ? spans[i].used : spans[i].capacity;
    if (spans[i].comes_back)
      status =
          scree_cuda_read(&d->queue, pointer_at(w, spans[i].field), d->arrays[i].at, used, error);
  }
  if (!status) status = fetch_walls(w, d, error);
  if (!status && d->listed) status = scree_broad_restore(w, w->margin, error);
  if (!status) d->listed = false;
  size_t removed = 0;
  for (size_t i = 0; i < w->bodies.count; i++) removed += w->bodies.removed[i];
  w->pairs_stale |= removed != w->bodies.removed_count;
  w->bodies.removed_count = removed;
  return status;
}

/* The device has the state, and it does not come back. What is here can be looked at, without the
 * neighbours that were made there; it is stepped no more. */
static void lose(scree_world *w) {
  w->on_device->current = false;
  w->neighbours.count = w->wall_pairs.count = 0;
  w->diverged = true;
}

static scree_status fetch(scree_world *w, scree_error *error) {
  struct scree_device_world *d = w->on_device;
  if (!d || !d->current) return SCREE_OK;
  scree_status status = fetch_all(w, d, &w->failure);
  d->current = false;
  if (!status) return SCREE_OK;
  lose(w);
  if (error && error != &w->failure) *error = w->failure;
  return status;
}

/* ---- steps ---- */

/* For so many steps. */
static scree_status launch(scree_world *w, size_t steps) {
  struct scree_device_world *d = w->on_device;
  const size_t bodies = w->bodies.count, pairs = w->neighbours.count,
               awake = d->awake ? d->awake : pairs,
               parts = PARTS * pairs < PARTS_AT_ONCE ? PARTS * pairs : PARTS_AT_ONCE;
  const scree_cuda_request request = {.world = d->own[BLOCK_WORLD].at,
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
                                                 [SCREE_KERNEL_press] = awake,
                                                 [SCREE_KERNEL_gather] = bodies,
                                                 [SCREE_KERNEL_advance] = bodies + w->walls.count,
                                                 [SCREE_KERNEL_end] = 1}};
  return scree_cuda_do_steps(d->queue.device, &request, &w->failure);
}

/* The pools that were asked for more than they have grow. */
static scree_status make_room(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  scree_status status = fetch(w, &w->failure);
  if (status) return status;
  while (d->touch_capacity < d->touches_used) d->touch_capacity *= 2;
  bool good = w->spare_pairs.count >= 0 || scree_pairs_grow(w);
  if (!good || !scree_pools_grow(&w->pools, w->pairs.items, w->pairs.count, w->neighbours.items,
                                 w->neighbours.count))
    return scree_fail_memory(&w->failure, 0, "contact features of a pair");
  return send(w, d, &w->failure);
}

/* Of a state that is there already. */
static scree_status list_there(scree_world *w, struct scree_device_world *d) {
  scree_cuda_place place = place_of(d);
  size_t count = 0, removed = 0;
  d->listed = true;
  scree_status status = scree_cuda_broad_find(d->broad, w, &place, &count, &w->failure);
  if (!status) status = scree_cuda_broad_list(d->broad, w, &place, count, &w->failure);
  if (!status) status = reserve_own(w, d, &w->failure);
  if (!status) status = scree_cuda_wait(&d->queue, &w->failure);
  lead_header(w, d);
  for (size_t i = 0; i < w->bodies.count; i++) removed += w->bodies.removed[i];
  w->bodies.removed_count = removed;
  return status;
}

static scree_status list_here(scree_world *w, struct scree_device_world *d) {
  scree_status status = scree_broad_update(w, &w->failure);
  d->touches_used = 0;
  if (!status) status = scree_reserve_blocks(w, &w->failure);
  return status ? status : send(w, d, &w->failure);
}

static scree_status update_neighbours(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  if (d->current && !d->header.stale && !d->header.fallen) return SCREE_OK;
  d->header.stale = d->header.fallen = 0;
  return d->current ? list_there(w, d) : list_here(w, d);
}

static void begin_steps(struct scree_device_world *d, size_t wanted) {
  scree_device_step *h = &d->header;
  h->done = 0;
  h->wanted = wanted;
  h->awake_count = h->depth_job_count = h->resume = 0;
  h->depths_used = 0;
  h->offender = scree_none;
  h->trouble = scree_no_trouble;
  h->largest_overlap = h->partings = h->list_builds = h->evaluations = 0;
}

/* What was not done of a step that has begun goes on. */
static void go_on(struct scree_device_world *d, bool resume) {
  scree_device_step *h = &d->header;
  h->stop = h->too_small = h->again = h->due_count = 0;
  h->resume = resume;
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++) h->visit_counts[kind] = 0;
}

static scree_status finish(scree_world *w) {
  const scree_device_step *h = &w->on_device->header;
  const scree_trouble *t = &h->trouble;
  if (!scree_is_trouble(t) && h->offender == scree_none) return SCREE_OK;
  scree_status status = fetch(w, &w->failure);
  if (status) return status;
  return h->offender != scree_none ? scree_describe_offender(w, h->offender)
                                   : scree_describe_trouble(w, t);
}

static void count_steps(scree_world *w, const scree_device_step *h, double started) {
  for (uint64_t i = 0; i < h->done; i++) w->time += w->time_step;
  w->step_count += h->done;
  w->parting_count += h->partings;
  w->timings.contacts += scree_now() - started;
  w->timings.total += scree_now() - started;
  w->timings.steps += h->done;
  if (h->done) w->on_device->awake = (size_t)(h->evaluations / h->done);
  w->timings.list_builds += h->list_builds;
  w->timings.pair_evaluations += h->done * w->neighbours.count;
}

static scree_status step(scree_world *w, size_t most, size_t *done) {
  struct scree_device_world *d = w->on_device;
  if (w->bodies.count == 0) return scree_backend_cpu.step(w, most, done); /* there are no arrays */
  double started = scree_now();
  scree_status status = update_neighbours(w);
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
  if (status && d->current) lose(w);
  if (status) return status;
  *done = d->header.done;
  count_steps(w, &d->header, after_broad);
  return finish(w);
}

static void release(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  scree_error error;
  if (!d || scree_cuda_use(d->queue.device, &error)) return;
  scree_cuda_broad_free(d->broad);
  for (size_t i = 0; i < MOST_SPANS; i++) scree_cuda_free(d->arrays[i].at);
  for (size_t i = 0; i < BLOCK_COUNT; i++) scree_cuda_free(d->own[i].at);
  scree_cuda_close_queue(&d->queue);
  scree_free(d->image);
  scree_free(d->seen);
  scree_free(d->addresses);
  scree_free(d);
  w->on_device = NULL;
}

static scree_status begin(scree_world *w, scree_error *error) {
  int device = scree_backend_device();
  if (w->on_device) return scree_cuda_use(w->on_device->queue.device, error);
  struct scree_device_world *d = scree_alloc_zero(1, sizeof *d);
  if (d) d->image = scree_alloc_zero(1, sizeof *d->image);
  if (!d || !d->image) {
    scree_free(d);
    return scree_fail_memory(error, sizeof *w, "a world on a device");
  }
  w->on_device = d;
  d->queue.device = device;
  scree_status status = scree_cuda_use(device, error);
  return status ? status : scree_cuda_open_queue(&d->queue, error);
}

const scree_backend scree_backend_cuda = {"cuda", begin, step, fetch, release};

#else

static scree_status unsupported(scree_world *world, scree_error *error) {
  (void)world;
  char description[256];
  return scree_cuda_open(0, description, error);
}

const scree_backend scree_backend_cuda = {"cuda", unsupported, NULL, unsupported, NULL};

#endif
