/* The mirror: what goes to the device and what comes back. Pointers of the world to arrays that are
 * newer there are parked in the meantime. */
#include "world/device/cuda_state.h"
#include "world/broad/broad.h"
#include "world/step/checkpoint.h"

#include "base/alloc.h"

#include <string.h>

#ifdef SCREE_WITH_CUDA

/* An array of the world and its mirror. */
typedef struct span {
  size_t field;          /* where in scree_world its pointer is */
  size_t capacity, used; /* bytes */
  unsigned part;
  enum {
    COMES_BACK,
    MADE, /* there, and here again when it is needed */
    SENT  /* steps do not change it, or need no more than the room */
  } kind;
} span;

enum { FIRST_CONTACTS = 4096 };

#define FIELD(member) offsetof(scree_world, member)

/* Forces on bodies, here or away. */
static bool has_applied(const scree_world *w) {
  return w->bodies.applied || w->residence.on_device->applied;
}

/* All arrays that the kernels use, but for those with pointers in them. */
static size_t list_spans(const scree_world *w, span spans[SCREE_MOST_SPANS]) {
  const size_t n = w->bodies.count, k = w->list.neighbours.count, p = w->pairs.count;
  const size_t spheres = w->spheres.list.pairs.count ? w->spheres.list.count : 0;
  const scree_pools *pools = &w->pools;
  const size_t items = pools->features_used, sleeping_features = pools->sleeping_used;
#define OF(member, count, part, kind)                                                              \
  {                                                                                                \
    FIELD(member), (count) * sizeof *w->member, (count) * sizeof *w->member, SCREE_PART_##part,    \
        kind                                                                                       \
  }
#define POOL(member, room, count)                                                                  \
  {                                                                                                \
    FIELD(member), (room) * sizeof *w->member, (count) * sizeof *w->member, SCREE_PART_LISTS,      \
        COMES_BACK                                                                                 \
  }
  const span all[] = {
      OF(bodies.frame, n, POSES, COMES_BACK),
      OF(bodies.orientation, n, POSES, COMES_BACK),
      OF(bodies.momentum, n, BODIES, COMES_BACK),
      OF(bodies.inertia, n, BODIES, SENT),
      OF(bodies.force, n, BODIES, COMES_BACK),
      OF(bodies.torque, n, BODIES, COMES_BACK),
      OF(bodies.mass, n, BODIES, SENT),
      OF(bodies.travel, n, BODIES, COMES_BACK),
      OF(bodies.path, n, BODIES, COMES_BACK),
      OF(bodies.turn, n, BODIES, COMES_BACK),
      OF(bodies.removed, n, REMOVED, SENT),
      OF(bodies.material, n, BODIES, SENT),
      OF(list.neighbours.items, k, LISTS, COMES_BACK),
      OF(list.pair_of.items, k, LISTS, COMES_BACK),
      OF(list.ledger.items, k, LISTS, COMES_BACK),
      OF(list.keys.items, k, LISTS, MADE),
      OF(pairs.items, p, LISTS, COMES_BACK),
      OF(spare_pairs.items, p, LISTS, COMES_BACK),
      POOL(pools.features, pools->feature_capacity, items),
      POOL(pools.further, pools->feature_capacity, items),
      POOL(pools.sleeping_features, pools->sleeping_capacity, sleeping_features),
      OF(list.slots.items, k, LISTS, COMES_BACK),
      OF(list.wake_threshold.items, w->residence.on_device->body_count + w->walls.count, LISTS,
         COMES_BACK),
      OF(list.touching.items, k / 64 + 1, LISTS, COMES_BACK),
      OF(list.sides.items, w->list.sides.count, LISTS, MADE),
      OF(list.wall_pairs.items, w->list.wall_pairs.count, LISTS, MADE),
      OF(bodies.applied, has_applied(w) ? n : 0, BODIES, COMES_BACK),
      OF(bodies.balance, n, BODIES, COMES_BACK),
      OF(list.side_begin, n + 1, LISTS, SENT),
      {FIELD(list.acting.items), w->list.sides.count * sizeof(uint32_t), 0, SCREE_PART_LISTS, MADE},
      {FIELD(workspace.awake.items), k * sizeof(uint32_t), 0, SCREE_PART_LISTS, MADE},
      OF(list.body_path_at_build, n, BODIES, COMES_BACK),
      OF(spheres.list.body, spheres, LISTS, SENT),
      OF(spheres.list.place_of, spheres ? w->spheres.list.body_count : 0, LISTS, SENT),
      OF(spheres.list.begin, spheres ? spheres + 1 : 0, LISTS, SENT),
      OF(spheres.seconds.items, w->spheres.seconds.count, LISTS, SENT),
      OF(spheres.laws.items, w->spheres.laws.count, LISTS, SENT),
      OF(spheres.list.pairs.items, w->spheres.list.pairs.count, LISTS, COMES_BACK),
      OF(spheres.list.contacts.items, w->spheres.list.pairs.count, LISTS, COMES_BACK),
      OF(spheres.blocks.items, w->spheres.blocks.count, LISTS, COMES_BACK),
      {FIELD(spheres.place), spheres * sizeof *w->spheres.place, 0, SCREE_PART_LISTS, MADE},
      {FIELD(spheres.motion), spheres * sizeof *w->spheres.motion, 0, SCREE_PART_LISTS, MADE},
      {FIELD(spheres.load), spheres * sizeof *w->spheres.load, 0, SCREE_PART_LISTS, MADE},
      OF(joints.all.items, w->joints.all.count, JOINTS, COMES_BACK),
      OF(joints.begin.items, w->joints.all.count ? n + 1 : 0, JOINTS, SENT),
      OF(joints.sides.items, 2 * w->joints.all.count, JOINTS, SENT),
      OF(joints.fragment.items, w->joints.fragment.count, JOINTS, SENT),
      OF(motions.items, w->motions.count, WALLS, SENT),
      OF(motion_rows.items, w->motion_rows.count, WALLS, SENT),
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

static void lead_to(void *pointer, scree_device_address address) {
  uintptr_t at = (uintptr_t)address;
  memcpy(pointer, &at, sizeof at);
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
  lead(p, &tree->nodes, tree->node_count, sizeof *tree->nodes);
  lead(p, &tree->cones, tree->node_count, sizeof *tree->cones);
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

static const scree_world_wall *walls_of(const scree_world *w) {
  return w->walls.items ? w->walls.items : w->residence.on_device->walls;
}

/* Walls first, so that bodies that are added change no address. */
static const scree_particle *shape_at(const scree_world *w, size_t i) {
  size_t walls = w->walls.count;
  return i < walls ? walls_of(w)[i].surface : w->bodies.particle[i - walls];
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
  if (d->seen_count != count || d->wall_count != w->walls.count) return false;
  for (size_t i = 0; i < count; i++)
    if (d->seen[i] != shape_at(w, i)) return false;
  return true;
}

/* Whether the first shapes are those that it was packed with, and none is new. */
static bool bytes_are_there(const scree_world *w, const struct scree_device_world *d,
                            size_t bytes) {
  if (d->wall_count != w->walls.count || d->shape_bytes != bytes) return false;
  for (size_t i = 0; i < d->seen_count; i++)
    if (i >= w->walls.count + w->bodies.count || d->seen[i] != shape_at(w, i)) return false;
  return true;
}

static scree_status send_bytes(const scree_world *w, struct scree_device_world *d, size_t bytes,
                               scree_error *error) {
  scree_cuda_block *block = &d->own[BLOCK_SHAPES];
  bool there = bytes_are_there(w, d, bytes);
  d->seen_count = 0;
  SCREE_TRY(scree_cuda_reserve(block, bytes, error));
  SCREE_SCRATCH_ZERO(char, shapes, bytes, error);
  packer p = {shapes, 0, block->at};
  pack_shapes(w, &p, d->addresses);
  if (!there) SCREE_TRY(scree_cuda_write(&d->queue, block->at, shapes, p.used, error));
  d->shape_bytes = bytes;
  return SCREE_OK;
}

static scree_status send_shapes(scree_world *w, struct scree_device_world *d, scree_error *error) {
  if (shapes_are_there(w, d)) return SCREE_OK;
  size_t walls = w->walls.count, count = w->bodies.count + walls;
  void *addresses = scree_resize(d->addresses, count, sizeof *d->addresses);
  if (addresses) d->addresses = addresses;
  void *seen = scree_resize(d->seen, count, sizeof *d->seen);
  if (seen) d->seen = seen;
  if (!seen || !addresses) return scree_fail_memory(error, count * sizeof *d->addresses, "shapes");
  packer measured = {0};
  pack_shapes(w, &measured, d->addresses);
  SCREE_TRY(send_bytes(w, d, measured.used, error));
  for (size_t i = 0; i < count; i++) d->seen[i] = shape_at(w, i);
  d->seen_count = count;
  d->wall_count = walls;
  size_t bytes = w->bodies.count * sizeof *d->addresses;
  SCREE_TRY(scree_cuda_reserve_more(&d->own[BLOCK_PARTICLES], bytes, error));
  return scree_cuda_write(&d->queue, d->own[BLOCK_PARTICLES].at, d->addresses + walls, bytes,
                          error);
}

static scree_status send_walls(const scree_world *w, struct scree_device_world *d,
                               scree_error *error) {
  size_t count = w->walls.count, bytes = count * sizeof *w->walls.items;
  if (count == 0) return SCREE_OK;
  void *copies = scree_resize(d->copies, count, sizeof *d->copies);
  if (!copies) return scree_fail_memory(error, bytes, "walls");
  d->copies = copies;
  memcpy(d->copies, w->walls.items, bytes);
  for (size_t i = 0; i < count; i++) lead_to(&d->copies[i].surface, d->addresses[i]);
  SCREE_TRY(scree_cuda_reserve(&d->own[BLOCK_WALLS], bytes, error));
  return scree_cuda_write(&d->queue, d->own[BLOCK_WALLS].at, d->copies, bytes, error);
}

/* ---- there ---- */

/* How many lists are made at once, and how many depths looked for. */
static uint32_t lists_of(const scree_world *w) {
  size_t share = w->list.neighbours.count / 32;
  return share < 64 ? 64 : share > 4096 ? 4096 : (uint32_t)share;
}
static size_t depths_of(const scree_world *w) {
  size_t share = 8 * w->list.neighbours.count;
  return share < 65536 ? 65536 : share > 1 << 22 ? 1 << 22 : share;
}

/* The memory of one of those arrays. */
static scree_cuda_block *array_at(scree_world *w, size_t field) {
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans), i = 0;
  while (i < count && spans[i].field != field) i++;
  return &w->residence.on_device->arrays[i];
}

scree_cuda_place scree_cuda_place_of(struct scree_device_world *d) {
  return (scree_cuda_place){&d->queue, d->own[BLOCK_WORLD].at, d->own[BLOCK_WORLDS].at, d->image,
                            array_at};
}

void scree_cuda_lead_header(const scree_world *w, struct scree_device_world *d) {
  lead_to(&d->header.hands, d->own[BLOCK_HANDS].at);
  lead_to(&d->header.progress, d->own[BLOCK_PROGRESS].at);
  lead_to(&d->header.contact_counts, d->own[BLOCK_CONTACT_COUNTS].at);
  lead_to(&d->header.new_lists, d->own[BLOCK_NEW_LISTS].at);
  d->header.new_list_capacity = lists_of(w);
  lead_to(&d->header.depth_jobs, d->own[BLOCK_DEPTH_JOBS].at);
  lead_to(&d->header.depths, d->own[BLOCK_DEPTHS].at);
  d->header.depth_capacity = depths_of(w);
  lead_to(&d->header.sphere_loads, d->own[BLOCK_SPHERE_LOADS].at);
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++)
    lead_to(&d->header.visits[kind], d->own[BLOCK_VISITS + kind].at);
}

static scree_status send_image(scree_world *w, struct scree_device_world *d,
                               scree_device_address broad, scree_error *error) {
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans);
  memcpy(d->image, w, sizeof *w);
  void **const hosts_own[] = {
      (void **)&d->image->workspace.scratch,   (void **)&d->image->workspace.progress.items,
      (void **)&d->image->workspace.offenders, (void **)&d->image->residence.on_device,
      (void **)&d->image->kept.path,           (void **)&d->image->kept.bytes};
  for (size_t i = 0; i < sizeof hosts_own / sizeof *hosts_own; i++) *hosts_own[i] = NULL;
  for (size_t i = 0; i < count; i++)
    lead_to((char *)d->image + spans[i].field, spans[i].capacity ? d->arrays[i].at : 0);
  lead_to(&d->image->broad, broad);
  lead_to(&d->image->residence.sums, d->own[BLOCK_SUMS].at);
  lead_to(&d->image->bodies.particle, d->own[BLOCK_PARTICLES].at);
  lead_to(&d->image->walls.items, d->own[BLOCK_WALLS].at);
  lead_to(&d->image->pools.contacts, d->own[BLOCK_CONTACTS].at);
  d->image->pools.contact_capacity = d->contact_capacity;
  d->image->pools.contacts_used = d->contacts_used;
  scree_cuda_lead_header(w, d);
  return scree_cuda_write(&d->queue, d->own[BLOCK_WORLD].at, d->image, sizeof *w, error);
}

scree_status scree_cuda_reserve_own(const scree_world *w, struct scree_device_world *d,
                                    scree_error *error) {
  const size_t k = w->list.neighbours.count;
  if (d->contact_capacity == 0) d->contact_capacity = FIRST_CONTACTS;
  size_t sizes[BLOCK_COUNT] = {[BLOCK_WORLD] = sizeof *w,
                               [BLOCK_WORLDS] = sizeof(scree_device_address),
                               [BLOCK_HANDS] = k * sizeof(scree_scratch),
                               [BLOCK_PROGRESS] = k,
                               [BLOCK_CONTACTS] = d->contact_capacity * sizeof(scree_contact_point),
                               [BLOCK_CONTACT_COUNTS] = d->contact_capacity,
                               [BLOCK_NEW_LISTS] = lists_of(w) * sizeof(scree_new_list),
                               [BLOCK_DEPTH_JOBS] = SCREE_MOST_DEPTH_JOBS * sizeof(scree_depth_job),
                               [BLOCK_DEPTHS] = depths_of(w) * sizeof(scree_depth),
                               [BLOCK_SPHERE_LOADS] =
                                   2 * w->spheres.list.pairs.count * sizeof(scree_sphere_load)};
  for (int kind = 0; kind < SCREE_VISIT_KINDS; kind++)
    sizes[BLOCK_VISITS + kind] = w->pools.feature_capacity * sizeof(scree_visit);
  for (int i = 0; i < BLOCK_COUNT; i++) SCREE_TRY(scree_cuda_reserve(&d->own[i], sizes[i], error));
  return SCREE_OK;
}

static scree_status send_span(const scree_world *w, struct scree_device_world *d, size_t i,
                              const span *s, scree_error *error) {
  SCREE_TRY(scree_cuda_reserve_more(&d->arrays[i], s->capacity, error));
  return scree_cuda_write(&d->queue, d->arrays[i].at, pointer_at(w, s->field), s->used, error);
}

scree_status scree_cuda_send(scree_world *w, struct scree_device_world *d, scree_error *error) {
  d->body_count = w->bodies.count;
  d->current = false;
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans);
  SCREE_TRY(send_shapes(w, d, error));
  SCREE_TRY(send_walls(w, d, error));
  SCREE_TRY(scree_cuda_reserve_own(w, d, error));
  for (size_t i = 0; i < count; i++) SCREE_TRY(send_span(w, d, i, &spans[i], error));
  scree_device_address broad = 0;
  scree_cuda_place place = scree_cuda_place_of(d);
  SCREE_TRY(scree_cuda_broad_send(&d->broad, w, &place, &broad, error));
  SCREE_TRY(send_image(w, d, broad, error));
  SCREE_TRY(scree_cuda_write(&d->queue, d->own[BLOCK_WORLDS].at, &d->own[BLOCK_WORLD].at,
                             sizeof(scree_device_address), error));
  SCREE_TRY(scree_cuda_wait(&d->queue, error)); /* steps have another queue */
  d->current = true;
  d->changed = 0;
  return SCREE_OK;
}

/* ---- what changed here ---- */

static scree_status tell(struct scree_device_world *d, size_t field, const void *value, size_t size,
                         scree_error *error) {
  scree_cuda_place place = scree_cuda_place_of(d);
  return scree_cuda_broad_tell(&place, field, value, size, error);
}

scree_status scree_cuda_tell(struct scree_device_world *d, size_t field, size_t size,
                             scree_error *error) {
  return tell(d, field, (const char *)d->world + field, size, error);
}

static scree_status tell_address(struct scree_device_world *d, size_t field,
                                 scree_device_address address, scree_error *error) {
  uintptr_t at = (uintptr_t)address;
  return tell(d, field, &at, sizeof at, error);
}

/* More bodies, of which there are no neighbours yet: the lists stay, and are made anew there. */
static scree_status make_room_for_bodies(scree_world *w, struct scree_device_world *d,
                                         scree_error *error) {
  if (w->bodies.count == d->body_count) return SCREE_OK;
  const struct {
    size_t field, size;
  } lists[] = {{FIELD(list.side_begin), (w->bodies.count + 1) * sizeof *w->list.side_begin},
               {FIELD(list.wake_threshold.items),
                (w->bodies.count + w->walls.count) * sizeof *w->list.wake_threshold.items}};
  scree_cuda_place place = scree_cuda_place_of(d);
  scree_device_address broad;
  SCREE_TRY(scree_broad_reserve_bodies(w, error));
  for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
    scree_cuda_block *block = array_at(w, lists[i].field);
    SCREE_TRY(scree_cuda_reserve_more(block, lists[i].size, error));
    SCREE_TRY(tell_address(d, lists[i].field, block->at, error));
  }
  SCREE_TRY(scree_cuda_broad_keep(d->broad, w, &place, error));
  SCREE_TRY(scree_cuda_broad_send(&d->broad, w, &place, &broad, error));
  d->body_count = w->bodies.count;
  return SCREE_OK;
}

/* To shapes that have come elsewhere. */
static scree_status lead_walls(const scree_world *w, const struct scree_device_world *d,
                               scree_error *error) {
  for (size_t i = 0; i < w->walls.count; i++)
    SCREE_TRY(scree_cuda_write(&d->queue,
                               d->own[BLOCK_WALLS].at + i * sizeof(scree_world_wall) +
                                   offsetof(scree_world_wall, surface),
                               &d->addresses[i], sizeof d->addresses[i], error));
  return SCREE_OK;
}

static scree_status send_parts(scree_world *w, struct scree_device_world *d, scree_error *error) {
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans);
  for (size_t i = 0; i < count; i++) {
    if (!(spans[i].part & d->changed)) continue;
    SCREE_TRY(send_span(w, d, i, &spans[i], error));
    SCREE_TRY(tell_address(d, spans[i].field, spans[i].capacity ? d->arrays[i].at : 0, error));
  }
  return SCREE_OK;
}

scree_status scree_cuda_send_changed(scree_world *w, struct scree_device_world *d,
                                     scree_error *error) {
  if (!d->changed) return SCREE_OK;
  static const size_t counts[] = {FIELD(bodies.count),       FIELD(motions.count),
                                  FIELD(motion_rows.count),  FIELD(joints.all.count),
                                  FIELD(joints.begin.count), FIELD(joints.fragment.count)};
  scree_cuda_place place = scree_cuda_place_of(d);
  const scree_device_address shapes = d->own[BLOCK_SHAPES].at;
  SCREE_TRY(send_shapes(w, d, error));
  if (d->own[BLOCK_SHAPES].at != shapes) SCREE_TRY(lead_walls(w, d, error));
  SCREE_TRY(tell_address(d, FIELD(bodies.particle), d->own[BLOCK_PARTICLES].at, error));
  SCREE_TRY(make_room_for_bodies(w, d, error));
  SCREE_TRY(send_parts(w, d, error));
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    SCREE_TRY(scree_cuda_tell(d, counts[i], sizeof(size_t), error));
  if (d->changed & SCREE_PART_WALLS) {
    SCREE_TRY(send_walls(w, d, error));
    SCREE_TRY(scree_cuda_launch(&d->queue, SCREE_KERNEL_wall_threshold, w->walls.count, 1,
                                place.worlds, 0, error));
  }
  SCREE_TRY(scree_cuda_wait(&d->queue, error));
  d->changed = 0;
  return SCREE_OK;
}

/* ---- back ---- */

void scree_cuda_part_with(scree_world *w, struct scree_device_world *d) {
  static void *const nothing = NULL;
  const unsigned parts = SCREE_ALL_PARTS & ~SCREE_PART_REMOVED & ~d->away;
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans);
  d->applied = has_applied(w);
  for (size_t i = 0; i < count; i++) {
    if (!(spans[i].part & parts) || spans[i].kind == SENT) continue;
    d->parked[i] = pointer_at(w, spans[i].field);
    memcpy((char *)w + spans[i].field, &nothing, sizeof nothing);
  }
  if (parts & SCREE_PART_WALLS) {
    d->walls = w->walls.items;
    w->walls.items = NULL;
  }
  d->away |= parts;
}

/* The world has its pointers again. */
static void take_back(scree_world *w, struct scree_device_world *d, unsigned parts) {
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans);
  parts &= d->away;
  for (size_t i = 0; i < count; i++)
    if (spans[i].part & parts && spans[i].kind != SENT)
      memcpy((char *)w + spans[i].field, &d->parked[i], sizeof d->parked[i]);
  if (parts & SCREE_PART_WALLS) w->walls.items = d->walls;
  d->away &= ~parts;
}

scree_status scree_cuda_fetch_removed(scree_world *w, struct scree_device_world *d,
                                      scree_error *error) {
  return scree_cuda_read(&d->queue, w->bodies.removed, array_at(w, FIELD(bodies.removed))->at,
                         w->bodies.count * sizeof *w->bodies.removed, error);
}

void scree_cuda_lose(scree_world *w) {
  take_back(w, w->residence.on_device, SCREE_ALL_PARTS);
  w->residence.on_device->current = false;
  w->residence.on_device->changed = 0;
  w->list.neighbours.count = w->list.wall_pairs.count = w->spheres.list.pairs.count = 0;
  w->diverged = true;
  scree_world_write_kept(w);
}

/* What steps change of the struct itself. */
static scree_status fetch_numbers(scree_world *w, struct scree_device_world *d,
                                  scree_error *error) {
  const size_t from = FIELD(spare_pairs), size = FIELD(spheres) - from;
  scree_world *image = d->image;
  SCREE_TRY(
      scree_cuda_read(&d->queue, (char *)image + from, d->own[BLOCK_WORLD].at + from, size, error));
  w->spare_pairs.count = image->spare_pairs.count;
  w->pools.features_used = image->pools.features_used;
  w->pools.sleeping_used = image->pools.sleeping_used;
  d->contacts_used = image->pools.contacts_used;
  return SCREE_OK;
}

/* The walls have come elsewhere. */
static scree_status fetch_walls(scree_world *w, struct scree_device_world *d, scree_error *error) {
  size_t count = w->walls.count;
  SCREE_TRY(scree_cuda_read(&d->queue, d->copies, d->own[BLOCK_WALLS].at, count * sizeof *d->copies,
                            error));
  for (size_t i = 0; i < count; i++) {
    scree_particle *surface = w->walls.items[i].surface;
    w->walls.items[i] = d->copies[i];
    w->walls.items[i].surface = surface;
  }
  return SCREE_OK;
}

static scree_status fetch_parts(scree_world *w, struct scree_device_world *d, unsigned parts,
                                scree_error *error) {
  bool lists = parts & SCREE_PART_LISTS, listed = lists && d->listed;
  SCREE_TRY(lists ? fetch_numbers(w, d, error) : SCREE_OK);
  if (listed && !scree_broad_reserve(w)) return scree_fail_memory(error, 0, "pairs of bodies");
  span spans[SCREE_MOST_SPANS];
  size_t count = list_spans(w, spans);
  for (size_t i = 0; i < count; i++) {
    const span *s = &spans[i];
    size_t used = s->used < s->capacity ? s->used : s->capacity;
    if (s->part & parts && s->kind == COMES_BACK)
      SCREE_TRY(scree_cuda_read(&d->queue, pointer_at(w, s->field), d->arrays[i].at, used, error));
  }
  if (parts & SCREE_PART_WALLS) SCREE_TRY(fetch_walls(w, d, error));
  if (listed) SCREE_TRY(scree_broad_restore(w, w->list.margin, error));
  if (listed) d->listed = false;
  return SCREE_OK;
}

scree_status scree_cuda_fetch(scree_world *w, struct scree_device_world *d, unsigned parts,
                              scree_error *error) {
  parts &= d->away;
  if (!parts) return SCREE_OK;
  take_back(w, d, parts);
  scree_status status = scree_cuda_use(d->queue.device, &w->failure);
  if (!status) status = fetch_parts(w, d, parts, &w->failure);
  if (!status) return SCREE_OK;
  scree_cuda_lose(w);
  if (error && error != &w->failure) *error = w->failure;
  return status;
}

void scree_cuda_free_state(scree_world *w, struct scree_device_world *d) {
  take_back(w, d, SCREE_ALL_PARTS);
  scree_error error;
  if (scree_cuda_use(d->queue.device, &error) == SCREE_OK) {
    scree_cuda_broad_free(d->broad);
    for (size_t i = 0; i < SCREE_MOST_SPANS; i++) scree_cuda_free(d->arrays[i]);
    for (size_t i = 0; i < BLOCK_COUNT; i++) scree_cuda_free(d->own[i]);
    scree_cuda_close_queue(&d->queue);
  }
  scree_free(d->image);
  scree_free(d->seen);
  scree_free(d->addresses);
  scree_free(d->copies);
}

#endif
