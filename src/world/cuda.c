/* The cuda backend: a mirror of the world's arrays on the device, on which the kernels of a step
 * run. The device has a copy of the world's own struct with its pointers led to the mirror, so that
 * both sides run the same code on the same indices.
 *
 * The state goes to the device when steps begin and comes back when they end. In between the host
 * moves the walls, asks after every step whether the neighbours still hold, and makes them anew
 * with its own broad phase where they do not. A pair that finds too little room in a pool stops the
 * step: the host lets the pools grow, and it is evaluated again (world.h, scree_pools). */
#include "world/backend.h"
#include "world/broad.h"
#include "world/contact.h"
#include "world/cuda_driver.h"
#include "world/pairs.h"
#include "world/stages.h"
#include "world/walls.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <string.h>

#ifdef SCREE_WITH_CUDA

typedef struct block {
  scree_device_address at;
  size_t capacity; /* bytes */
} block;

/* An array of the world and its mirror. */
typedef struct span {
  size_t field;          /* where in scree_world its pointer is */
  size_t capacity, used; /* bytes */
  bool comes_back;
} span;

enum { MOST_SPANS = 40, FIRST_TOUCHES = 4096 };

struct scree_device_world {
  int device;
  block arrays[MOST_SPANS], particles, shapes, walls, world, step, counts, done, work, touches;
  uint64_t touch_capacity;
  scree_device_step header;
  scree_world *image;          /* the device's struct */
  const scree_particle **seen; /* bodies' particles whose shapes are on the device */
  size_t seen_count;
  scree_device_address *addresses; /* of the bodies' shapes, then of the walls' */
  size_t address_count;
  bool current; /* the device has the state */
};

#define FIELD(member) offsetof(scree_world, member)

static size_t blocks_of(const scree_world *world) {
  return scree_block_count(world->neighbours.count, SCREE_PAIR_BLOCK);
}

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
      OF(neighbours.items, k, true),
      OF(pair_of.items, k, true),
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
      OF(side_begin, n + 1, false),
      {FIELD(acting.items), w->sides.count * sizeof(uint32_t), 0, false},
      {FIELD(sums.items), blocks_of(w) * sizeof(scree_pair_sums), 0, false},
      {FIELD(awake.items), k * sizeof(uint32_t), 0, false},
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
  scree_status status =
      scree_cuda_reserve(&d->shapes.at, &d->shapes.capacity, measured.used, error);
  if (status) return status;
  packer p = {scree_alloc_zero(measured.used, 1), 0, d->shapes.at};
  if (!p.bytes) return scree_fail_memory(error, measured.used, "shapes");
  pack_shapes(w, &p, d->addresses);
  status = scree_cuda_write(d->shapes.at, p.bytes, p.used, error);
  scree_free(p.bytes);
  if (status) return status;
  for (size_t i = 0; i < count; i++) d->seen[i] = shape_at(w, i);
  d->seen_count = count;
  size_t bytes = w->bodies.count * sizeof *d->addresses;
  status = scree_cuda_reserve(&d->particles.at, &d->particles.capacity, bytes, error);
  return status ? status : scree_cuda_write(d->particles.at, d->addresses, bytes, error);
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
  scree_status status = scree_cuda_reserve(&d->walls.at, &d->walls.capacity, bytes, error);
  if (!status) status = scree_cuda_write(d->walls.at, copy, bytes, error);
  scree_free(copy);
  return status;
}

/* ---- the whole state, there and back ---- */

static scree_status send_image(scree_world *w, struct scree_device_world *d, scree_error *error) {
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  memcpy(d->image, w, sizeof *w);
  void **const hosts_own[] = {(void **)&d->image->broad,
                              (void **)&d->image->scratch,
                              (void **)&d->image->keys.items,
                              (void **)&d->image->progress.items,
                              (void **)&d->image->offenders,
                              (void **)&d->image->body_path_at_build,
                              (void **)&d->image->bodies.material,
                              (void **)&d->image->motions.items,
                              (void **)&d->image->motion_rows.items,
                              (void **)&d->image->on_device,
                              (void **)&d->image->kept.path,
                              (void **)&d->image->kept.bytes};
  for (size_t i = 0; i < sizeof hosts_own / sizeof *hosts_own; i++) *hosts_own[i] = NULL;
  for (size_t i = 0; i < count; i++)
    if (pointer_at(w, spans[i].field)) lead_to((char *)d->image + spans[i].field, d->arrays[i].at);
  lead_to(&d->image->bodies.particle, d->particles.at);
  lead_to(&d->image->walls.items, d->walls.at);
  lead_to(&d->image->pools.touches, d->touches.at);
  d->image->pools.touch_capacity = d->touch_capacity;
  lead_to(&d->header.counts, d->counts.at);
  lead_to(&d->header.done, d->done.at);
  lead_to(&d->header.work, d->work.at);
  return scree_cuda_write(d->world.at, d->image, sizeof *w, error);
}

static scree_status reserve_scratch(const scree_world *w, struct scree_device_world *d,
                                    scree_error *error) {
  const size_t k = w->neighbours.count;
  if (d->touch_capacity == 0) d->touch_capacity = FIRST_TOUCHES;
  const struct {
    block *block;
    size_t size;
  } all[] = {{&d->world, sizeof *w},
             {&d->step, sizeof d->header},
             {&d->counts, blocks_of(w) * sizeof(uint32_t)},
             {&d->done, k},
             {&d->work, k * sizeof(scree_pair_work)},
             {&d->touches, d->touch_capacity * sizeof(scree_touch)}};
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < sizeof all / sizeof *all && !status; i++)
    status = scree_cuda_reserve(&all[i].block->at, &all[i].block->capacity, all[i].size, error);
  return status;
}

static scree_status send(scree_world *w, struct scree_device_world *d, scree_error *error) {
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  scree_status status = send_shapes(w, d, error);
  if (!status) status = send_walls(w, d, error);
  if (!status) status = reserve_scratch(w, d, error);
  for (size_t i = 0; i < count && !status; i++) {
    status = scree_cuda_reserve(&d->arrays[i].at, &d->arrays[i].capacity, spans[i].capacity, error);
    if (!status)
      status =
          scree_cuda_write(d->arrays[i].at, pointer_at(w, spans[i].field), spans[i].used, error);
  }
  if (!status) status = send_image(w, d, error);
  d->current = status == SCREE_OK;
  return status;
}

/* What a step changes of the struct itself. */
static void take_numbers(scree_world *w, const scree_world *image) {
  w->work_dashpot = image->work_dashpot;
  w->work_tangential = image->work_tangential;
  w->applied_work = image->applied_work;
  w->parting_count = image->parting_count;
  w->largest_overlap = image->largest_overlap;
  w->spare_pairs.count = image->spare_pairs.count;
  w->pools.items_used = image->pools.items_used;
  w->pools.sleepers_used = image->pools.sleepers_used;
}

static scree_status fetch(scree_world *w, scree_error *error) {
  struct scree_device_world *d = w->on_device;
  if (!d || !d->current) return SCREE_OK;
  scree_status status = scree_cuda_read(d->image, d->world.at, sizeof *w, error);
  if (status) return status;
  take_numbers(w, d->image);
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  for (size_t i = 0; i < count && !status; i++) {
    size_t used = spans[i].used < spans[i].capacity ? spans[i].used : spans[i].capacity;
    if (spans[i].comes_back)
      status = scree_cuda_read(pointer_at(w, spans[i].field), d->arrays[i].at, used, error);
  }
  size_t removed = 0;
  for (size_t i = 0; i < w->bodies.count; i++) removed += w->bodies.removed[i];
  w->bodies.removed_count = removed;
  return status;
}

static scree_status fetch_to_host(scree_world *w, scree_error *error) {
  scree_status status = fetch(w, error);
  if (w->on_device) w->on_device->current = false;
  return status;
}

/* ---- a step ---- */

static scree_status launch(scree_world *w, scree_kernel first, scree_kernel last) {
  struct scree_device_world *d = w->on_device;
  const size_t
      blocks = blocks_of(w),
      counts[SCREE_KERNEL_COUNT] = {
          [SCREE_KERNEL_awake] = blocks,           [SCREE_KERNEL_evaluate] = w->neighbours.count,
          [SCREE_KERNEL_settle] = blocks,          [SCREE_KERNEL_combine] = 1,
          [SCREE_KERNEL_gather] = w->bodies.count, [SCREE_KERNEL_book] = 1,
          [SCREE_KERNEL_advance] = w->bodies.count};
  scree_status status = scree_cuda_write(d->step.at, &d->header, sizeof d->header, &w->failure);
  for (int k = (int)first; k <= (int)last && !status; k++)
    status = scree_cuda_launch(d->device, (scree_kernel)k, counts[k], d->world.at, d->step.at,
                               &w->failure);
  return status ? status : scree_cuda_read(&d->header, d->step.at, sizeof d->header, &w->failure);
}

/* The pools that were asked for more than they have. */
static scree_status make_room(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  scree_status status = fetch_to_host(w, &w->failure);
  if (status) return status;
  uint64_t touches = d->image->pools.touches_used;
  while (d->touch_capacity < touches) d->touch_capacity *= 2;
  bool good = w->spare_pairs.count >= 0 || scree_pairs_grow(w);
  if (!good || !scree_pools_grow(&w->pools, w->pairs.items, w->pairs.count, w->neighbours.items,
                                 w->neighbours.count))
    return scree_fail_memory(&w->failure, 0, "contact features of a pair");
  return send(w, d, &w->failure);
}

static scree_status evaluate(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  d->header.offender = scree_none;
  d->header.too_small = d->header.fallen = 0;
  d->header.sums = scree_no_sums();
  scree_status status = launch(w, SCREE_KERNEL_awake, SCREE_KERNEL_advance);
  while (!status && d->header.too_small) {
    status = make_room(w);
    d->header.too_small = 0;
    if (!status) status = launch(w, SCREE_KERNEL_evaluate, SCREE_KERNEL_advance);
  }
  return status;
}

/* What the walls did, which is booked on the device. */
static scree_status fetch_walls(scree_world *w, struct scree_device_world *d) {
  size_t count = w->walls.count;
  if (count == 0) return SCREE_OK;
  scree_world_wall *copy = scree_alloc(count, sizeof *copy);
  if (!copy) return scree_fail_memory(&w->failure, count * sizeof *copy, "walls");
  scree_status status = scree_cuda_read(copy, d->walls.at, count * sizeof *copy, &w->failure);
  for (size_t i = 0; i < count && !status; i++) {
    scree_particle *surface = w->walls.items[i].surface;
    w->walls.items[i] = copy[i];
    w->walls.items[i].surface = surface;
  }
  scree_free(copy);
  return status;
}

/* The host moves the walls, and says until when those that sleep near them may. */
static scree_status move_walls(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  scree_status status = fetch_walls(w, d);
  if (status) return status;
  scree_walls_advance(w);
  status = send_walls(w, d, &w->failure);
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans), from = w->bodies.count * sizeof *w->due.items;
  for (size_t i = 0; i < count && !status; i++)
    if (spans[i].field == FIELD(due.items))
      status = scree_cuda_write(d->arrays[i].at + from, w->due.items + w->bodies.count,
                                spans[i].used - from, &w->failure);
  return status;
}

/* For the host's question whether the neighbours hold. */
static scree_status read_paths(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  span spans[MOST_SPANS];
  size_t count = list_spans(w, spans);
  for (size_t i = 0; i < count; i++)
    if (spans[i].field == FIELD(bodies.path))
      return scree_cuda_read(w->bodies.path, d->arrays[i].at, spans[i].used, &w->failure);
  return SCREE_OK;
}

static scree_status update_neighbours(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  if (d->current && scree_broad_is_valid(w)) return SCREE_OK;
  scree_status status = fetch_to_host(w, &w->failure);
  if (!status) status = scree_broad_update(w, &w->failure);
  if (!status) status = scree_reserve_blocks(w, &w->failure);
  return status ? status : send(w, d, &w->failure);
}

static scree_status finish(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  scree_status status = scree_describe_trouble(w, &d->header.sums);
  if (status) return status;
  if (d->header.offender != scree_none) return scree_describe_offender(w, d->header.offender);
  return SCREE_OK;
}

static scree_status step(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  if (w->bodies.count == 0) return scree_backend_cpu.step(w); /* there are no arrays yet */
  double start = scree_now();
  scree_status status = update_neighbours(w);
  double after_broad = scree_now();
  if (!status) status = evaluate(w);
  if (status) return status;
  bool trouble = (d->header.sums.start & d->header.sums.beyond_limit & d->header.sums.too_fast &
                  d->header.offender) != scree_none;
  if (trouble) {
    status = fetch_to_host(w, &w->failure);
    return status ? status : finish(w);
  }
  w->largest_overlap = d->header.sums.largest_overlap;
  status = move_walls(w);
  if (!status) status = read_paths(w);
  if (d->header.fallen) w->pairs_stale = true;
  w->time += w->time_step;
  w->step_count++;
  double end = scree_now();
  w->timings.broad += after_broad - start;
  w->timings.contacts += end - after_broad;
  w->timings.total += end - start;
  w->timings.steps++;
  w->timings.pair_evaluations += w->neighbours.count;
  return status;
}

static void release(scree_world *w) {
  struct scree_device_world *d = w->on_device;
  scree_error error;
  if (!d || scree_cuda_use(d->device, &error)) return;
  for (size_t i = 0; i < MOST_SPANS; i++) scree_cuda_free(d->arrays[i].at);
  const block *all[] = {&d->particles, &d->shapes, &d->walls, &d->world,  &d->step,
                        &d->counts,    &d->done,   &d->work,  &d->touches};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) scree_cuda_free(all[i]->at);
  scree_free(d->image);
  scree_free(d->seen);
  scree_free(d->addresses);
  scree_free(d);
  w->on_device = NULL;
}

static scree_status begin(scree_world *w, scree_error *error) {
  if (!w->on_device) {
    struct scree_device_world *d = scree_alloc_zero(1, sizeof *d);
    if (d) d->image = scree_alloc_zero(1, sizeof *d->image);
    if (!d || !d->image) {
      scree_free(d);
      return scree_fail_memory(error, sizeof *w, "a world on a device");
    }
    d->device = scree_backend_device();
    w->on_device = d;
  }
  return scree_cuda_use(w->on_device->device, error);
}

const scree_backend scree_backend_cuda = {"cuda", begin, step, fetch_to_host, release};

#else

static scree_status unsupported(scree_world *world, scree_error *error) {
  (void)world;
  char description[256];
  return scree_cuda_open(0, description, error);
}

const scree_backend scree_backend_cuda = {"cuda", unsupported, NULL, unsupported, NULL};

#endif
