/* The broad phase: which bodies' bounding boxes, grown by a margin, overlap.
 *
 * Bodies are binned by centre into cubic cells as wide as the largest grown box, so that partners
 * lie in the 27 cells around. The cells are visited through a sorted list of (cell, body). The list
 * of pairs stays valid until some body's path since it was made exceeds half the margin. Old and
 * new lists are both sorted, so pairs that stay keep their memory in one merge. */
#include "world/world.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/progress.h"

#include <stdlib.h>
#include <string.h>

static const double margin_share = 0.1; /* of the mean body size: rebuilds against extra pairs */

typedef struct cell_entry {
  int32_t x, y, z;
  uint32_t body;
} cell_entry;

struct scree_broad {
  scree_box *boxes; /* grown, by body */
  cell_entry *cells;
  uint32_t *bucket_begin; /* by hash */
  size_t capacity, bucket_count;
  double margin;
};

void scree_broad_free(scree_world *world) {
  if (!world->broad) return;
  scree_free(world->broad->boxes);
  scree_free(world->broad->cells);
  scree_free(world->broad->bucket_begin);
  scree_free(world->broad);
}

static scree_status reserve(scree_world *world, scree_error *error) {
  if (!world->broad) world->broad = scree_alloc_zero(1, sizeof *world->broad);
  scree_broad *broad = world->broad;
  if (!broad) return scree_fail_memory(error, sizeof *broad, "the broad phase");
  size_t capacity = world->bodies.capacity;
  if (broad->capacity >= capacity) return SCREE_OK;
  size_t buckets = 64;
  while (buckets < 2 * capacity) buckets *= 2;
  void *boxes = scree_resize(broad->boxes, capacity, sizeof *broad->boxes);
  if (boxes) broad->boxes = boxes;
  void *cells = scree_resize(broad->cells, 2 * capacity, sizeof *broad->cells);
  if (cells) broad->cells = cells;
  void *begin = scree_resize(broad->bucket_begin, buckets + 1, sizeof *broad->bucket_begin);
  if (begin) broad->bucket_begin = begin;
  if (!boxes || !cells || !begin)
    return scree_fail_memory(error, capacity * sizeof *broad->boxes, "the broad phase");
  broad->capacity = capacity;
  broad->bucket_count = buckets;
  return SCREE_OK;
}

static size_t bucket_of(const scree_broad *broad, int32_t x, int32_t y, int32_t z) {
  uint64_t h = (uint64_t)(uint32_t)x * 0x9E3779B97F4A7C15u ^
               (uint64_t)(uint32_t)y * 0xC2B2AE3D27D4EB4Fu ^
               (uint64_t)(uint32_t)z * 0x165667B19E3779F9u;
  h ^= h >> 29;
  return (size_t)(h & (broad->bucket_count - 1));
}

/* Boxes grown by half the margin; returns the widest side. */
static double make_boxes(scree_world *world) {
  scree_broad *broad = world->broad;
  const scree_bodies *bodies = &world->bodies;
  double size = 0, widest = 0;
  size_t present = 0;
  for (size_t i = 0; i < bodies->count; i++)
    if (!bodies->removed[i]) {
      size += bodies->particle[i]->measures.size;
      present++;
    }
  broad->margin = present ? margin_share * size / (double)present : 0;
  for (size_t i = 0; i < bodies->count; i++) {
    if (bodies->removed[i]) continue;
    const scree_frame *frame = &bodies->frame[i];
    scree_box box = scree_box_moved(&bodies->particle[i]->box, &frame->rotation, frame->position);
    broad->boxes[i] = scree_box_grown(box, 0.5 * broad->margin);
    vec3 side = vec3_sub(broad->boxes[i].high, broad->boxes[i].low);
    widest = fmax(widest, fmax(side.x, fmax(side.y, side.z)));
  }
  return widest;
}

/* Bodies far out share the last cells: clamping keeps neighbours neighbours. */
static int32_t cell_of(double place) {
  const double last = 1 << 30;
  place = floor(place);
  return (int32_t)(place > -last ? fmin(place, last) : -last);
}

/* Counting sort of the bodies by bucket; ascending by body within one. */
static void bin_bodies(scree_world *world, double width) {
  scree_broad *broad = world->broad;
  const scree_bodies *bodies = &world->bodies;
  cell_entry *unsorted = broad->cells + broad->capacity;
  memset(broad->bucket_begin, 0, (broad->bucket_count + 1) * sizeof *broad->bucket_begin);
  size_t count = 0;
  for (size_t i = 0; i < bodies->count; i++) {
    if (bodies->removed[i]) continue;
    vec3 c = vec3_scale(vec3_add(broad->boxes[i].low, broad->boxes[i].high), 0.5 / width);
    cell_entry entry = {cell_of(c.x), cell_of(c.y), cell_of(c.z), (uint32_t)i};
    unsorted[count++] = entry;
    broad->bucket_begin[bucket_of(broad, entry.x, entry.y, entry.z) + 1]++;
  }
  for (size_t b = 0; b < broad->bucket_count; b++)
    broad->bucket_begin[b + 1] += broad->bucket_begin[b];
  for (size_t k = count; k-- > 0;) { /* backwards: begin moves from end to begin of its bucket */
    const cell_entry *e = &unsorted[k];
    broad->cells[--broad->bucket_begin[bucket_of(broad, e->x, e->y, e->z) + 1]] = *e;
  }
  /* every begin now stands one bucket too far */
  for (size_t b = 0; b < broad->bucket_count; b++)
    broad->bucket_begin[b] = broad->bucket_begin[b + 1];
  broad->bucket_begin[broad->bucket_count] = (uint32_t)count;
}

static uint64_t key_of(uint32_t a, uint32_t b, bool wall) {
  return (uint64_t)a << 32 | (wall ? 0x80000000u : 0) | b;
}

static bool push_key(scree_world *world, uint64_t key) {
  return SCREE_PUSH(&world->keys, key);
}

/* Whether the body may come near the wall before the next rebuild. */
static bool near_wall(const scree_world *world, size_t body, const scree_world_wall *wall) {
  const scree_frame *frame = &world->bodies.frame[body];
  const scree_particle *particle = world->bodies.particle[body];
  if (!scree_wall_is_analytic(wall)) {
    scree_box box =
        scree_box_moved(&wall->surface->box, &wall->frame.rotation, wall->frame.position);
    return scree_box_meets(&world->broad->boxes[body], &box);
  }
  vec3 p = mat3_tmul_vec(&wall->frame.rotation, vec3_sub(frame->position, wall->frame.position));
  vec3 closest, normal;
  double reach = particle->measures.bounding_radius + world->broad->margin;
  return scree_wall_distance(wall, p, scree_wall_side(wall, p), &closest, &normal) < reach;
}

static int compare_keys(const void *x, const void *y) {
  uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
  return a < b ? -1 : a > b;
}

/* Partners of body a that come after it, and its walls, in ascending order. */
static bool list_partners(scree_world *world, uint32_t a, const cell_entry *cell) {
  const scree_broad *broad = world->broad;
  size_t first = world->keys.count;
  for (int n = 0; n < 27; n++) {
    int32_t x = cell->x + n % 3 - 1, y = cell->y + n / 3 % 3 - 1, z = cell->z + n / 9 - 1;
    size_t bucket = bucket_of(broad, x, y, z);
    for (size_t k = broad->bucket_begin[bucket]; k < broad->bucket_begin[bucket + 1]; k++) {
      const cell_entry *other = &broad->cells[k];
      if (other->body <= a || other->x != x || other->y != y || other->z != z) continue;
      if (!scree_box_meets(&broad->boxes[a], &broad->boxes[other->body])) continue;
      if (!push_key(world, key_of(a, other->body, false))) return false;
    }
  }
  for (size_t w = 0; w < world->walls.count; w++)
    if (near_wall(world, a, &world->walls.items[w]) &&
        !push_key(world, key_of(a, (uint32_t)w, true)))
      return false;
  if (world->keys.count > first + 1)
    qsort(world->keys.items + first, world->keys.count - first, sizeof *world->keys.items,
          compare_keys);
  return true;
}

static bool list_keys(scree_world *world, double width) {
  world->keys.count = 0;
  const scree_bodies *bodies = &world->bodies;
  for (size_t i = 0; i < bodies->count; i++) {
    if (bodies->removed[i]) continue;
    const scree_box *box = &world->broad->boxes[i];
    vec3 c = vec3_scale(vec3_add(box->low, box->high), 0.5 / width);
    cell_entry cell = {cell_of(c.x), cell_of(c.y), cell_of(c.z), 0};
    if (!list_partners(world, (uint32_t)i, &cell)) return false;
  }
  return true;
}

static uint64_t key_at(const scree_world *world, size_t k) {
  const scree_neighbours *n = &world->neighbours.items[k];
  return key_of(n->a, n->b, n->wall);
}

static void move_neighbours(scree_world *world, size_t from, size_t to) {
  if (from == to) return;
  world->neighbours.items[to] = world->neighbours.items[from];
  world->pair_of.items[to] = world->pair_of.items[from];
}

/* Those that are no longer near give their pairs back; the others move together. */
static void drop_neighbours(scree_world *world) {
  size_t kept = 0, key = 0;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    uint64_t own = key_at(world, k);
    while (key < world->keys.count && world->keys.items[key] < own) key++;
    if (key < world->keys.count && world->keys.items[key] == own)
      move_neighbours(world, k, kept++);
    else if (world->pair_of.items[k] != scree_none)
      scree_pair_give_back(world, world->pair_of.items[k]);
  }
  world->neighbours.count = kept;
}

/* The new list, in place: those that were there keep what they are. Room is made before anything
 * moves. */
static bool merge_neighbours(scree_world *world) {
  size_t needed = world->keys.count;
  if (needed >= scree_none || !SCREE_RESERVE(&world->neighbours, needed) ||
      !SCREE_RESERVE(&world->pair_of, needed))
    return false;
  drop_neighbours(world);
  size_t old = world->neighbours.count;
  for (size_t k = needed; k-- > 0;) { /* from the end, where there is room */
    uint64_t key = world->keys.items[k];
    if (old > 0 && key_at(world, old - 1) == key) {
      move_neighbours(world, --old, k);
      scree_pair *pair = scree_pair_of(world, k);
      if (pair) pair->neighbours = (uint32_t)k;
      continue;
    }
    world->neighbours.items[k] = scree_neighbours_new(
        world, (uint32_t)(key >> 32), (uint32_t)key & 0x7fffffffu, (key & 0x80000000u) != 0);
    world->pair_of.items[k] = scree_none;
  }
  world->neighbours.count = needed;
  return true;
}

/* There is room. */
static void list_wall_pairs(scree_world *world) {
  world->wall_pairs.count = 0;
  for (size_t k = 0; k < world->neighbours.count; k++)
    if (world->neighbours.items[k].wall)
      world->wall_pairs.items[world->wall_pairs.count++] = (uint32_t)k;
}

static void fill_slots(scree_world *world) {
  size_t bodies = world->bodies.count;
  world->due.count = bodies + world->walls.count;
  for (size_t i = 0; i < bodies; i++) scree_set_body_due(world, i);
  for (size_t w = 0; w < world->walls.count; w++) scree_set_wall_due(world, w);
  world->slots.count = world->neighbours.count;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    const scree_neighbours *n = &world->neighbours.items[k];
    world->slots.items[k] = (scree_slot){n->asleep ? n->wake : -INFINITY, n->a,
                                         n->wall ? (uint32_t)bodies + n->b : n->b};
    const scree_pair *pair = scree_pair_of(world, k);
    scree_mark_touching(world, k, pair && pair->touching);
  }
}

/* The pairs' slots, and for every body the pairs it is in, ascending: the order in which forces are
 * summed. */
static bool list_sides(scree_world *world) {
  size_t bodies = world->bodies.count, pairs = world->neighbours.count;
  world->sides.count = 0;
  if (bodies == 0) return true; /* there are no arrays yet */
  if (!SCREE_RESERVE(&world->sides, 2 * pairs) || !SCREE_RESERVE(&world->acting, 2 * pairs) ||
      !SCREE_RESERVE(&world->due, bodies + world->walls.count) ||
      !SCREE_RESERVE(&world->slots, pairs) || !SCREE_RESERVE(&world->touching, pairs / 64 + 1) ||
      !SCREE_RESERVE(&world->wall_pairs, pairs))
    return false;
  fill_slots(world);
  list_wall_pairs(world);
  size_t *begin = world->side_begin;
  memset(begin, 0, (bodies + 1) * sizeof *begin);
  for (size_t k = 0; k < pairs; k++) {
    const scree_neighbours *n = &world->neighbours.items[k];
    begin[n->a + 1]++;
    if (!n->wall) begin[n->b + 1]++;
  }
  for (size_t i = 0; i < bodies; i++) begin[i + 1] += begin[i];
  world->sides.count = begin[bodies];
  for (size_t k = pairs; k-- > 0;) {
    const scree_neighbours *n = &world->neighbours.items[k];
    world->sides.items[--begin[n->a + 1]] = (uint32_t)(2 * k);
    if (!n->wall) world->sides.items[--begin[n->b + 1]] = (uint32_t)(2 * k + 1);
  }
  for (size_t i = 0; i < bodies; i++) begin[i] = begin[i + 1];
  begin[bodies] = world->sides.count;
  return true;
}

static bool is_valid(const scree_world *world) {
  if (world->pairs_stale) return false;
  double wall_travel = 0;
  for (size_t w = 0; w < world->walls.count; w++) {
    const scree_world_wall *wall = &world->walls.items[w];
    wall_travel = fmax(wall_travel, wall->path - wall->path_at_build);
    if (vec3_norm2(wall->frame.spin) > 0) return false; /* rare: rebuilt every step */
  }
  const scree_bodies *bodies = &world->bodies;
  double allowed = 0.5 * world->broad->margin - wall_travel;
  for (size_t i = 0; i < bodies->count; i++)
    if (!bodies->removed[i] && bodies->path[i] - world->body_path_at_build[i] > allowed)
      return false;
  return true;
}

scree_status scree_broad_update(scree_world *world, scree_error *error) {
  if (world->bodies.count == 0 || is_valid(world)) return SCREE_OK;
  scree_status status = reserve(world, error);
  if (status) return status;
  double widest = make_boxes(world);
  bin_bodies(world, widest > 0 ? widest : 1);
  bool good = list_keys(world, widest > 0 ? widest : 1) && merge_neighbours(world);
  if (good) scree_pairs_tidy(world);
  if (!good || !list_sides(world))
    return scree_fail_memory(error, world->keys.count * sizeof(scree_neighbours),
                             "pairs of bodies");
  for (size_t i = 0; i < world->bodies.count; i++)
    world->body_path_at_build[i] = world->bodies.path[i];
  for (size_t w = 0; w < world->walls.count; w++)
    world->walls.items[w].path_at_build = world->walls.items[w].path;
  world->pairs_stale = false;
  world->timings.broad_builds++;
  return SCREE_OK;
}

double scree_broad_margin(const scree_world *world) {
  return world->broad ? world->broad->margin : 0;
}

scree_status scree_broad_restore(scree_world *world, double margin, scree_error *error) {
  scree_status status = reserve(world, error);
  if (status) return status;
  world->broad->margin = margin;
  return list_sides(world) ? SCREE_OK : scree_fail_memory(error, 0, "pairs of bodies");
}
