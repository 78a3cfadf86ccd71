/* Which bodies' bounding boxes and balls, grown by a margin, overlap.
 *
 * Bodies of any mixture of sizes are binned by centre into a hierarchy of grids of cubic cells. The
 * coarsest has cells as wide as the largest grown box, each finer one half as wide; a body is in
 * the finest of which the cells are as wide as its box. It looks for partners in its own grid and
 * in the coarser ones, in the cells where the centre of one that reaches it may lie. */
#include "world/broad/grids.h"
#include "world/broad/broad.h"
#include "world/state/joints.h"
#include "world/state/keys.h"
#include "world/state/walls.h"

#include "particle/closest.h"

#include <string.h>

static size_t bucket_of(const scree_broad *broad, const scree_cell *c) {
  uint64_t h = (uint64_t)(uint32_t)c->x * 0x9E3779B97F4A7C15u ^
               (uint64_t)(uint32_t)c->y * 0xC2B2AE3D27D4EB4Fu ^
               (uint64_t)(uint32_t)c->z * 0x165667B19E3779F9u ^ c->grid * 0xFF51AFD7ED558CCDu;
  h ^= h >> 29;
  return (size_t)(h & (broad->bucket_count - 1));
}

static double widest_side(const scree_box *box) {
  vec3 side = vec3_sub(box->high, box->low);
  return scree_max(side.x, scree_max(side.y, side.z));
}

/* Bits of numbers above 0 are in the order of the numbers. */
static void raise_real(uint64_t *at, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  if (value > 0) scree_atomic_raise(at, bits);
}

static double real_of(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

void scree_grids_box(scree_world *world, size_t i) {
  scree_broad *broad = world->broad;
  if (world->bodies.removed[i]) return;
  const scree_frame *frame = &world->bodies.frame[i];
  const scree_particle *particle = world->bodies.particle[i];
  scree_box box =
      scree_box_moved(&particle->box, &frame->rotation, scree_world_fold(world, frame->position));
  broad->boxes[i] = scree_box_grown(box, 0.5 * scree_body_margin(world, i));
  raise_real(&broad->widest, widest_side(&broad->boxes[i]));
  for (size_t w = 0; w < world->walls.count; w++)
    raise_real(&broad->wall_reach[w],
               vec3_distance(frame->position, world->walls.items[w].frame.position) +
                   particle->measures.bounding_radius + 2 * world->list.margin);
}

/* Half the margin is for the walls that move; sheets and planes have it in any case. They reach as
 * far from their position as bodies can be while the list lasts, and their own points. */
static void prepare_walls(scree_world *world) {
  const double margin = world->list.margin;
  for (size_t w = 0; w < world->walls.count; w++) {
    scree_world_wall *wall = &world->walls.items[w];
    bool still = wall->motion_count == 0 && wall->travel == 0 &&
                 vec3_norm2(wall->frame.velocity) + vec3_norm2(wall->frame.spin) == 0;
    wall->slack = still && !scree_wall_is_analytic(wall) ? 0 : 0.5 * margin;
    wall->reach = scree_min(real_of(world->broad->wall_reach[w]), scree_wall_extent(wall) + margin);
  }
}

void scree_grids_begin(scree_world *world, size_t i) {
  (void)i;
  scree_broad *broad = world->broad;
  double width = real_of(broad->widest);
  if (!(width > 0)) width = 1;
  for (int g = 0; g < SCREE_MOST_GRIDS; g++, width *= 0.5) broad->width[g] = width;
  prepare_walls(world);
}

/* Bodies far out share the last cells: clamping keeps neighbours neighbours. */
static int32_t place_of(double place) {
  const double last = 1 << 30;
  place = floor(place);
  return (int32_t)(place > -last ? scree_min(place, last) : -last);
}

static scree_cell cell_at(const scree_broad *broad, vec3 place, uint32_t grid) {
  vec3 c = vec3_scale(place, 1 / broad->width[grid]);
  return (scree_cell){place_of(c.x), place_of(c.y), place_of(c.z), grid};
}

void scree_grids_cell(scree_world *world, size_t i) {
  scree_broad *broad = world->broad;
  if (world->bodies.removed[i]) return;
  const scree_box *box = &broad->boxes[i];
  double side = widest_side(box);
  uint32_t g = 0;
  while (g + 1 < SCREE_MOST_GRIDS && side <= broad->width[g + 1]) g++;
  scree_atomic_or(&broad->used, (uint32_t)1 << g);
  broad->cells[i] = cell_at(broad, vec3_scale(vec3_add(box->low, box->high), 0.5), g);
  scree_atomic_add(&broad->buckets.count[bucket_of(broad, &broad->cells[i])], 1);
}

void scree_grids_bin(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  if (world->bodies.removed[i]) return;
  uint32_t place = scree_groups_take(&broad->buckets, bucket_of(broad, &broad->cells[i]));
  broad->binned[place] = (scree_cell_entry){broad->cells[i], (uint32_t)i};
}

/* ---- who finds whom ---- */

typedef struct search {
  scree_world *world;
  uint32_t body, count;
  bool writes; /* else counts, and remembers the first few */
} search;

static uint64_t key_with(uint32_t body, uint32_t partner) {
  bool other_first = partner < body; /* no wall is */
  return other_first ? scree_key_of(partner, body, false) : scree_key_of(body, partner, false);
}

static void write_key(const scree_world *world, uint64_t key) {
  world->list.keys.items[scree_groups_take(&world->broad->listed, key >> 32)] = key;
}

/* Whether both are spheres, which have lists of their own, by their places; but for two that were
 * joined, whose contact begins from the overlap that there is. */
static bool are_spheres(const scree_world *world, uint32_t one, uint32_t other,
                        uint32_t places[2]) {
  const scree_spheres *s = &world->spheres;
  if (s->list.count < 2 || other & scree_wall_partner) return false;
  const uint32_t a = s->list.place_of[one], b = s->list.place_of[other];
  if (a == scree_none || b == scree_none || scree_joints_held(world, one, other)) return false;
  places[0] = a < b ? a : b;
  places[1] = a < b ? b : a;
  return true;
}

static void write_pair(const scree_world *world, uint32_t body, uint32_t partner) {
  uint32_t places[2];
  if (are_spheres(world, body, partner, places))
    world->spheres.found.items[scree_groups_take(&world->broad->spheres, places[0])] = places[1];
  else
    write_key(world, key_with(body, partner));
}

static void count_pair(const scree_world *world, uint32_t body, uint32_t partner) {
  uint32_t places[2];
  if (are_spheres(world, body, partner, places))
    scree_atomic_add(&world->broad->spheres.count[places[0]], 1);
  else
    scree_atomic_add(&world->broad->listed.count[key_with(body, partner) >> 32], 1);
}

static void note(search *s, uint32_t partner) {
  const scree_broad *broad = s->world->broad;
  uint32_t count = s->count++;
  if (s->writes) {
    write_pair(s->world, s->body, partner);
    return;
  }
  count_pair(s->world, s->body, partner);
  if (count < SCREE_FOUND) broad->found[SCREE_FOUND * (size_t)s->body + count] = partner;
}

/* Whether the balls around two bodies, grown as their boxes are, meet: of spheres half of the boxes
 * that do have none that do. */
static bool balls_meet(const scree_world *world, size_t i, size_t j) {
  const scree_bodies *b = &world->bodies;
  double reach = b->particle[i]->measures.bounding_radius +
                 b->particle[j]->measures.bounding_radius +
                 0.5 * (scree_body_margin(world, i) + scree_body_margin(world, j));
  vec3 between = vec3_sub(b->frame[i].position, b->frame[j].position);
  return vec3_norm2(scree_nearest_image(world, between)) <= reach * reach;
}

/* In this box, in one cell; of those in its own grid the ones after it. */
static void find_in_cell(search *s, const scree_box *box, const scree_cell *c) {
  const scree_broad *broad = s->world->broad;
  bool own = broad->cells[s->body].grid == c->grid;
  size_t bucket = bucket_of(broad, c);
  for (size_t k = broad->buckets.begin[bucket]; k < broad->buckets.begin[bucket + 1]; k++) {
    const scree_cell_entry *e = &broad->binned[k];
    uint32_t other = e->body;
    if ((own && other <= s->body) || e->at.x != c->x || e->at.y != c->y || e->at.z != c->z ||
        e->at.grid != c->grid || !scree_box_meets(box, &broad->boxes[other]) ||
        !balls_meet(s->world, s->body, other) || scree_joints_hold(s->world, s->body, other))
      continue;
    note(s, other);
  }
}

/* In the grid's cells where the centre of one that reaches the box may lie. */
static void find_in_grid(search *s, const scree_box *box, uint32_t grid) {
  const scree_broad *broad = s->world->broad;
  scree_box grown = scree_box_grown(*box, (0.5 + 1e-6) * broad->width[grid]); /* and rounding */
  scree_cell low = cell_at(broad, grown.low, grid), high = cell_at(broad, grown.high, grid),
             c = low;
  for (c.z = low.z; c.z <= high.z; c.z++)
    for (c.y = low.y; c.y <= high.y; c.y++)
      for (c.x = low.x; c.x <= high.x; c.x++) find_in_cell(s, box, &c);
}

static void find_bodies(search *s, const scree_box *box) {
  const scree_broad *broad = s->world->broad;
  for (uint32_t g = 0; g <= broad->cells[s->body].grid; g++)
    if (broad->used >> g & 1) find_in_grid(s, box, g);
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
static void find_images(search *s) {
  const scree_world *world = s->world;
  const scree_box *box = &world->broad->boxes[s->body];
  double shifts[3][3], reach = world->broad->width[0];
  int count[3];
  for (int k = 0; k < 3; k++) count[k] = images_along(world, box, reach, k, shifts[k]);
  for (int i = 0; i < count[0]; i++)
    for (int j = 0; j < count[1]; j++)
      for (int k = 0; k < count[2]; k++) {
        vec3 shift = {shifts[0][i], shifts[1][j], shifts[2][k]};
        scree_box image = {vec3_add(box->low, shift), vec3_add(box->high, shift)};
        find_bodies(s, &image);
      }
}

/* Whether this gap is none; else the wall may come nearer by it than by its slack. */
static bool is_within(const scree_world *world, const scree_world_wall *wall, double gap) {
  if (gap < 0) return true;
  uint64_t bits;
  memcpy(&bits, &gap, sizeof bits);
  scree_atomic_raise(&world->broad->wall_gap[wall - world->walls.items], ~bits);
  return false;
}

/* Along the axis along which two boxes are farthest apart; below 0: they meet. */
static double box_gap(const scree_box *a, const scree_box *b) {
  vec3 gap = vec3_max(vec3_sub(a->low, b->high), vec3_sub(b->low, a->high));
  return scree_max(gap.x, scree_max(gap.y, gap.z));
}

/* Whether a mesh wall's surface, which may move by its slack, comes near the body, or the body was
 * put inside it. */
static bool near_mesh(const scree_world *world, size_t body, const scree_world_wall *wall) {
  scree_box box = scree_box_moved(&wall->surface->box, &wall->frame.rotation, wall->frame.position);
  box = scree_box_grown(box, wall->slack);
  if (!is_within(world, wall, box_gap(&world->broad->boxes[body], &box))) return false;
  const scree_particle *particle = world->bodies.particle[body];
  vec3 p = mat3_tmul_vec(&wall->frame.rotation,
                         vec3_sub(world->bodies.frame[body].position, wall->frame.position));
  double reach = particle->measures.bounding_radius + wall->surface->measures.rounding +
                 0.5 * scree_body_margin(world, body) + wall->slack;
  if (scree_is_near(wall->surface, p, reach)) return true;
  bool put = world->list.body_path_at_build[body] < 0 || wall->path_at_build < 0;
  if (put && wall->surface->measures.volume > 0 && scree_is_inside(wall->surface, p)) return true;
  return is_within(world, wall, 0);
}

/* Whether the body may come near the wall before the next rebuild. */
static bool near_wall(const scree_world *world, size_t body, const scree_world_wall *wall) {
  if (!scree_wall_is_analytic(wall)) return near_mesh(world, body, wall);
  const scree_frame *frame = &world->bodies.frame[body];
  vec3 p = mat3_tmul_vec(&wall->frame.rotation, vec3_sub(frame->position, wall->frame.position));
  vec3 closest, normal;
  double reach = world->bodies.particle[body]->measures.bounding_radius +
                 0.5 * scree_body_margin(world, body) + 0.5 * world->list.margin;
  double distance = scree_wall_distance(wall, p, scree_wall_side(wall, p), &closest, &normal);
  return is_within(world, wall, distance - reach);
}

static void find(search *s) {
  const scree_world *world = s->world;
  if (scree_world_is_periodic(world))
    find_images(s);
  else
    find_bodies(s, &world->broad->boxes[s->body]);
  for (size_t w = 0; w < world->walls.count; w++)
    if (near_wall(world, s->body, &world->walls.items[w]))
      note(s, scree_wall_partner | (uint32_t)w);
}

/* Where no body is near a wall it may come nearer by as much as the nearest is away. So a wall that
 * moves fast and far ends no list. What of it counts reaches farther by then. */
void scree_grids_widen_walls(scree_world *world) {
  for (size_t w = 0; w < world->walls.count; w++) {
    scree_world_wall *wall = &world->walls.items[w];
    const double farthest = real_of(world->broad->wall_reach[w]),
                 gap = world->broad->wall_gap[w] ? real_of(~world->broad->wall_gap[w]) : farthest,
                 more = scree_min(gap, farthest);
    wall->slack += more;
    wall->reach = scree_min(farthest + more, scree_wall_extent(wall) + world->list.margin);
  }
}

void scree_grids_find(scree_world *world, size_t i) {
  search s = {world, (uint32_t)i, 0, false};
  if (!world->bodies.removed[i]) find(&s);
  world->broad->found_count[i] = s.count;
}

/* Those beyond what was remembered are found again. */
void scree_grids_write(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  uint32_t count = broad->found_count[i];
  search s = {world, (uint32_t)i, 0, true};
  if (count > SCREE_FOUND) {
    find(&s);
    return;
  }
  for (uint32_t j = 0; j < count; j++) write_pair(world, s.body, broad->found[SCREE_FOUND * i + j]);
}
