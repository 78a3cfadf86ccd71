/* The broad phase: which bodies' bounding boxes, grown by a margin, overlap.
 *
 * Bodies of any mixture of sizes are binned by centre into a hierarchy of grids of cubic cells. The
 * coarsest has cells as wide as the largest grown box, each finer one half as wide; a body is in
 * the finest of which the cells are as wide as its box. It looks for partners in its own grid and
 * in the coarser ones, in the cells where the centre of one that reaches it may lie. The list of
 * pairs stays valid until some body's path since it was made exceeds half its margin, or a wall's.
 * Old and new lists are both sorted, so pairs that stay keep their memory in one merge. */
#include "world/broad.h"
#include "world/pairs.h"
#include "world/stages.h"
#include "world/walls.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/progress.h"
#include "particle/closest.h"

#include <stdlib.h>
#include <string.h>

/* Rebuilds against extra pairs: of the mean body size, and at most of the body's own. */
static const double margin_share = 0.1, own_margin_share = 0.4;
enum { MOST_GRIDS = 32 };

typedef struct cell {
  int32_t x, y, z;
  uint32_t grid;
} cell;

typedef struct cell_entry {
  cell at;
  uint32_t body;
} cell_entry;

struct scree_broad {
  scree_box *boxes; /* grown, by body */
  uint8_t *grid;    /* of each body, 0: the coarsest */
  cell_entry *cells;
  uint32_t *bucket_begin; /* by hash */
  uint32_t *key_begin;    /* by body a */
  size_t capacity, bucket_count;
  double margin;
  double width[MOST_GRIDS];
  uint32_t used; /* a bit for each grid that holds a body */
  struct {
    uint64_t *items; /* of pairs, as they are found */
    size_t count, capacity;
  } found;
};

void scree_broad_free(scree_world *world) {
  scree_broad *broad = world->broad;
  if (!broad) return;
  scree_free(broad->boxes);
  scree_free(broad->grid);
  scree_free(broad->cells);
  scree_free(broad->bucket_begin);
  scree_free(broad->key_begin);
  scree_free(broad->found.items);
  scree_free(broad);
}

static scree_status reserve(scree_world *world, scree_error *error) {
  if (!world->broad) world->broad = scree_alloc_zero(1, sizeof *world->broad);
  scree_broad *broad = world->broad;
  if (!broad) return scree_fail_memory(error, sizeof *broad, "the broad phase");
  size_t capacity = world->bodies.capacity, buckets = 64;
  if (broad->capacity >= capacity) return SCREE_OK;
  while (buckets < 2 * capacity) buckets *= 2;
  const struct {
    void **array;
    size_t count, size;
  } arrays[] = {{(void **)&broad->boxes, capacity, sizeof *broad->boxes},
                {(void **)&broad->grid, capacity, sizeof *broad->grid},
                {(void **)&broad->cells, 2 * capacity, sizeof *broad->cells},
                {(void **)&broad->bucket_begin, buckets + 1, sizeof *broad->bucket_begin},
                {(void **)&broad->key_begin, capacity + 1, sizeof *broad->key_begin}};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    void *moved = scree_resize(*arrays[i].array, arrays[i].count, arrays[i].size);
    if (!moved)
      return scree_fail_memory(error, arrays[i].count * arrays[i].size, "the broad phase");
    *arrays[i].array = moved;
  }
  broad->capacity = capacity;
  broad->bucket_count = buckets;
  return SCREE_OK;
}

static size_t bucket_of(const scree_broad *broad, const cell *c) {
  uint64_t h = (uint64_t)(uint32_t)c->x * 0x9E3779B97F4A7C15u ^
               (uint64_t)(uint32_t)c->y * 0xC2B2AE3D27D4EB4Fu ^
               (uint64_t)(uint32_t)c->z * 0x165667B19E3779F9u ^ c->grid * 0xFF51AFD7ED558CCDu;
  h ^= h >> 29;
  return (size_t)(h & (broad->bucket_count - 1));
}

/* Small bodies among large ones have a margin of their own size. */
static double margin_of(const scree_world *world, size_t body) {
  return scree_min(world->broad->margin,
                   own_margin_share * world->bodies.particle[body]->measures.size);
}

static double widest_side(const scree_box *box) {
  vec3 side = vec3_sub(box->high, box->low);
  return scree_max(side.x, scree_max(side.y, side.z));
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
    scree_box box = scree_box_moved(&bodies->particle[i]->box, &frame->rotation,
                                    scree_world_fold(world, frame->position));
    broad->boxes[i] = scree_box_grown(box, 0.5 * margin_of(world, i));
    widest = scree_max(widest, widest_side(&broad->boxes[i]));
  }
  return widest > 0 ? widest : 1;
}

/* The finest grid of which the cells hold every body's box. */
static void choose_grids(scree_world *world, double widest) {
  scree_broad *broad = world->broad;
  broad->used = 0;
  for (int g = 0; g < MOST_GRIDS; g++) broad->width[g] = ldexp(widest, -g);
  for (size_t i = 0; i < world->bodies.count; i++) {
    if (world->bodies.removed[i]) continue;
    double side = widest_side(&broad->boxes[i]);
    uint8_t g = 0;
    while (g + 1 < MOST_GRIDS && side <= broad->width[g + 1]) g++;
    broad->grid[i] = g;
    broad->used |= (uint32_t)1 << g;
  }
}

/* Bodies far out share the last cells: clamping keeps neighbours neighbours. */
static int32_t cell_of(double place) {
  const double last = 1 << 30;
  place = floor(place);
  return (int32_t)(place > -last ? scree_min(place, last) : -last);
}

static cell cell_at(const scree_broad *broad, vec3 place, uint32_t grid) {
  vec3 c = vec3_scale(place, 1 / broad->width[grid]);
  return (cell){cell_of(c.x), cell_of(c.y), cell_of(c.z), grid};
}

/* Counting sort of the bodies by bucket; ascending by body within one. */
static void bin_bodies(scree_world *world) {
  scree_broad *broad = world->broad;
  const scree_bodies *bodies = &world->bodies;
  cell_entry *unsorted = broad->cells + broad->capacity;
  memset(broad->bucket_begin, 0, (broad->bucket_count + 1) * sizeof *broad->bucket_begin);
  size_t count = 0;
  for (size_t i = 0; i < bodies->count; i++) {
    if (bodies->removed[i]) continue;
    vec3 centre = vec3_scale(vec3_add(broad->boxes[i].low, broad->boxes[i].high), 0.5);
    unsorted[count] = (cell_entry){cell_at(broad, centre, broad->grid[i]), (uint32_t)i};
    broad->bucket_begin[bucket_of(broad, &unsorted[count++].at) + 1]++;
  }
  for (size_t b = 0; b < broad->bucket_count; b++)
    broad->bucket_begin[b + 1] += broad->bucket_begin[b];
  for (size_t k = count; k-- > 0;) { /* backwards: begin moves from end to begin of its bucket */
    const cell_entry *e = &unsorted[k];
    broad->cells[--broad->bucket_begin[bucket_of(broad, &e->at) + 1]] = *e;
  }
  /* every begin now stands one bucket too far */
  for (size_t b = 0; b < broad->bucket_count; b++)
    broad->bucket_begin[b] = broad->bucket_begin[b + 1];
  broad->bucket_begin[broad->bucket_count] = (uint32_t)count;
}

static uint64_t key_of(uint32_t a, uint32_t b, bool wall) {
  return (uint64_t)a << 32 | (wall ? 0x80000000u : 0) | b;
}

static int compare_keys(const void *x, const void *y) {
  uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
  return a < b ? -1 : a > b;
}

/* Partners of the body, in this box, in one cell; of those in its own grid the ones after it. */
static bool find_in_cell(scree_world *world, uint32_t body, const scree_box *box, const cell *c) {
  scree_broad *broad = world->broad;
  bool own = broad->grid[body] == c->grid;
  size_t bucket = bucket_of(broad, c);
  for (size_t k = broad->bucket_begin[bucket]; k < broad->bucket_begin[bucket + 1]; k++) {
    const cell_entry *e = &broad->cells[k];
    uint32_t other = e->body;
    if ((own && other <= body) || e->at.x != c->x || e->at.y != c->y || e->at.z != c->z ||
        e->at.grid != c->grid || !scree_box_meets(box, &broad->boxes[other]))
      continue;
    uint64_t key = body < other ? key_of(body, other, false) : key_of(other, body, false);
    if (!SCREE_PUSH(&broad->found, key)) return false;
  }
  return true;
}

/* In the grid's cells where the centre of one that reaches the box may lie. */
static bool find_in_grid(scree_world *world, uint32_t body, const scree_box *box, uint32_t grid) {
  const scree_broad *broad = world->broad;
  scree_box grown = scree_box_grown(*box, (0.5 + 1e-6) * broad->width[grid]); /* and rounding */
  cell low = cell_at(broad, grown.low, grid), high = cell_at(broad, grown.high, grid), c = low;
  for (c.z = low.z; c.z <= high.z; c.z++)
    for (c.y = low.y; c.y <= high.y; c.y++)
      for (c.x = low.x; c.x <= high.x; c.x++)
        if (!find_in_cell(world, body, box, &c)) return false;
  return true;
}

static bool find_bodies(scree_world *world, uint32_t body, const scree_box *box) {
  const scree_broad *broad = world->broad;
  for (uint32_t g = 0; g <= broad->grid[body]; g++)
    if (broad->used >> g & 1 && !find_in_grid(world, body, box, g)) return false;
  return true;
}

/* Along one axis: by how many periods the box is moved to meet what lies across a boundary. All
 * places are folded into one period; boxes reach out of it by less than `reach`. */
static int images_along(const scree_world *world, const scree_box *box, double reach, int k,
                        double shifts[3]) {
  const scree_world_options *o = &world->options;
  const double low[3] = {box->low.x, box->low.y, box->low.z},
               high[3] = {box->high.x, box->high.y, box->high.z};
  double begin = o->period_from[k], end = begin + o->period[k];
  int count = 1;
  shifts[0] = 0;
  if (!(o->period[k] > 0)) return count;
  if (low[k] < begin + reach) shifts[count++] = o->period[k];
  if (high[k] > end - reach) shifts[count++] = -o->period[k];
  return count;
}

/* Also across the boundaries of a periodic world. */
static bool find_images(scree_world *world, uint32_t body) {
  const scree_box *box = &world->broad->boxes[body];
  double shifts[3][3], reach = world->broad->width[0];
  int count[3];
  for (int k = 0; k < 3; k++) count[k] = images_along(world, box, reach, k, shifts[k]);
  for (int i = 0; i < count[0]; i++)
    for (int j = 0; j < count[1]; j++)
      for (int k = 0; k < count[2]; k++) {
        vec3 shift = {shifts[0][i], shifts[1][j], shifts[2][k]};
        scree_box image = {vec3_add(box->low, shift), vec3_add(box->high, shift)};
        if (!find_bodies(world, body, &image)) return false;
      }
  return true;
}

/* Whether a mesh wall's surface, which may move by `slack`, comes near the body, or the body was
 * put inside it. */
static bool near_mesh(const scree_world *world, size_t body, const scree_world_wall *wall,
                      double slack) {
  scree_box box = scree_box_moved(&wall->surface->box, &wall->frame.rotation, wall->frame.position);
  box = scree_box_grown(box, slack);
  if (!scree_box_meets(&world->broad->boxes[body], &box)) return false;
  const scree_particle *particle = world->bodies.particle[body];
  vec3 p = mat3_tmul_vec(&wall->frame.rotation,
                         vec3_sub(world->bodies.frame[body].position, wall->frame.position));
  double reach = particle->measures.bounding_radius + wall->surface->measures.rounding +
                 0.5 * margin_of(world, body) + slack;
  const uint32_t root = 0;
  uint32_t face;
  if (scree_nearest_face(wall->surface, &root, 1, p, reach, &face) < INFINITY) return true;
  bool put = world->body_path_at_build[body] < 0 || wall->path_at_build < 0;
  return put && wall->surface->measures.volume > 0 && scree_is_inside(wall->surface, p);
}

/* Whether the body may come near the wall before the next rebuild. */
static bool near_wall(const scree_world *world, size_t body, const scree_world_wall *wall) {
  if (!scree_wall_is_analytic(wall)) return near_mesh(world, body, wall, wall->slack);
  const scree_frame *frame = &world->bodies.frame[body];
  vec3 p = mat3_tmul_vec(&wall->frame.rotation, vec3_sub(frame->position, wall->frame.position));
  vec3 closest, normal;
  double reach = world->bodies.particle[body]->measures.bounding_radius +
                 0.5 * margin_of(world, body) + 0.5 * world->broad->margin;
  return scree_wall_distance(wall, p, scree_wall_side(wall, p), &closest, &normal) < reach;
}

static bool find_all(scree_world *world) {
  scree_broad *broad = world->broad;
  broad->found.count = 0;
  for (size_t i = 0; i < world->bodies.count; i++) {
    if (world->bodies.removed[i]) continue;
    bool found = scree_world_is_periodic(world) ? find_images(world, (uint32_t)i)
                                                : find_bodies(world, (uint32_t)i, &broad->boxes[i]);
    if (!found) return false;
    for (size_t w = 0; w < world->walls.count; w++)
      if (near_wall(world, i, &world->walls.items[w]) &&
          !SCREE_PUSH(&broad->found, key_of((uint32_t)i, (uint32_t)w, true)))
        return false;
  }
  return true;
}

/* All pairs' keys, ascending: by counting those of each body a, and each body's by comparing. */
static bool list_keys(scree_world *world) {
  scree_broad *broad = world->broad;
  size_t bodies = world->bodies.count;
  if (!find_all(world) || broad->found.count >= UINT32_MAX ||
      !SCREE_RESERVE(&world->keys, broad->found.count))
    return false;
  uint32_t *begin = broad->key_begin;
  memset(begin, 0, (bodies + 1) * sizeof *begin);
  for (size_t k = 0; k < broad->found.count; k++) begin[broad->found.items[k] >> 32]++;
  for (size_t i = 0, sum = 0; i <= bodies; i++) {
    size_t count = begin[i];
    begin[i] = (uint32_t)sum;
    sum += count;
  }
  for (size_t k = 0; k < broad->found.count; k++) {
    uint64_t key = broad->found.items[k];
    world->keys.items[begin[key >> 32]++] = key;
  }
  world->keys.count = broad->found.count;
  for (size_t i = 0, first = 0; i < bodies; first = begin[i++])
    if (begin[i] > first + 1)
      qsort(world->keys.items + first, begin[i] - first, sizeof *world->keys.items, compare_keys);
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

bool scree_broad_is_valid(const scree_world *world) {
  if (world->pairs_stale) return false;
  for (size_t w = 0; w < world->walls.count; w++) {
    const scree_world_wall *wall = &world->walls.items[w];
    if (wall->path - wall->path_at_build > wall->slack) return false;
  }
  const scree_bodies *bodies = &world->bodies;
  for (size_t i = 0; i < bodies->count; i++)
    if (!bodies->removed[i] &&
        bodies->path[i] - world->body_path_at_build[i] > 0.5 * margin_of(world, i))
      return false;
  return true;
}

/* How far from the wall's position bodies can be while the list lasts, and its own points. */
static double reach_of(const scree_world *world, const scree_world_wall *wall) {
  const scree_bodies *bodies = &world->bodies;
  double reach = 0, margin = world->broad->margin, own = scree_wall_extent(wall) + margin;
  for (size_t i = 0; i < bodies->count && reach < own; i++)
    if (!bodies->removed[i])
      reach = scree_max(reach, vec3_distance(bodies->frame[i].position, wall->frame.position) +
                                   bodies->particle[i]->measures.bounding_radius + 2 * margin);
  return scree_min(reach, own);
}

/* Half the margin is for the walls that move; sheets and planes have it in any case. */
static void prepare_walls(scree_world *world) {
  for (size_t w = 0; w < world->walls.count; w++) {
    scree_world_wall *wall = &world->walls.items[w];
    bool still = wall->motion_count == 0 && wall->travel == 0 &&
                 vec3_norm2(wall->frame.velocity) + vec3_norm2(wall->frame.spin) == 0;
    wall->slack = still && !scree_wall_is_analytic(wall) ? 0 : 0.5 * world->broad->margin;
    wall->reach = reach_of(world, wall);
  }
}

scree_status scree_broad_update(scree_world *world, scree_error *error) {
  if (world->bodies.count == 0 || scree_broad_is_valid(world)) return SCREE_OK;
  scree_status status = reserve(world, error);
  if (status) return status;
  choose_grids(world, make_boxes(world));
  bin_bodies(world);
  prepare_walls(world);
  bool good = list_keys(world) && merge_neighbours(world);
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
