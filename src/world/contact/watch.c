/* A watch over all contacts that does not ask the contact law: whether places deep within a body
 * come through the surface of another, or of a wall.
 *
 * When the two have moved by a quarter of the depth of the deepest place, each place's way since
 * the last look is followed through the surface. A body that is pressed in, or moved out of
 * another, comes back on the side from which it came. Two that let go of each other while a place
 * is still through have passed one another; so have those that rest in each other. */
#include "world/broad/candidates.h"
#include "world/contact/contact.h"

#include "particle/closest.h"

enum { MOST_PASSAGES = 8 };

/* The places of one of the two, against the surface of the other. */
typedef struct watched {
  const scree_particle *from, *to;
  bool forth; /* from is a */
} watched;

static bool choose(const scree_world *world, const scree_pair *pair, watched *w) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  bool forth = b && b->face_count && (!a->face_count || scree_pair_smaller_is_a(world, pair));
  *w = (watched){forth ? a : b, forth ? b : a, forth};
  return w->from && w->to->face_count && w->from->inner_count;
}

/* A place in the frame of the surface, a being at `at` and turned so in the frame of b. */
static vec3 placed(const watched *w, vec3 place, const mat3 *turned, vec3 at) {
  return w->forth ? vec3_add(mat3_mul_vec(turned, place), at)
                  : mat3_tmul_vec(turned, vec3_sub(place, at));
}

static bool none_is_through(const scree_watch *watch) {
  uint32_t sum = 0;
  for (int i = 0; i < SCREE_INNER_PLACES; i++) sum += watch->through[i];
  return sum == 0;
}

/* Whether the body is: its deepest place, or half of all. Of one that a rim cuts into fewer are. */
static bool is_through(const watched *w, const scree_watch *watch) {
  uint32_t count = 0;
  for (int i = 0; i < SCREE_INNER_PLACES; i++) count += watch->through[i] > 0;
  return watch->through[0] > 0 || 2 * count > w->from->inner_count;
}

static vec3 side_of(const scree_watch *watch) {
  return (vec3){watch->came[0], watch->came[1], watch->came[2]};
}

/* Place i comes through a face. What counts is through how many it is: of a closed wall two. */
static void pass(const scree_face *face, vec3 along, uint32_t i, scree_watch *watch) {
  vec3 out = vec3_dot(face->normal, along) > 0 ? face->normal : vec3_neg(face->normal);
  if (none_is_through(watch))
    watch->came[0] = (float)-out.x, watch->came[1] = (float)-out.y, watch->came[2] = (float)-out.z;
  bool back = watch->through[i] > 0 && vec3_dot(side_of(watch), out) > watch_back_cosine;
  watch->through[i] = (uint8_t)(back ? watch->through[i] - 1 : watch->through[i] + 1);
}

static void follow(const scree_particle *to, vec3 then, vec3 now, uint32_t i, scree_watch *watch) {
  double length = vec3_distance(then, now);
  if (!(length > 0)) return;
  scree_ray_interval way = {then, vec3_scale(vec3_sub(now, then), 1 / length), 0, length};
  for (int k = 0; k < MOST_PASSAGES; k++) {
    uint32_t face;
    way.after = scree_next_passage(to, &way, 0, SIZE_MAX, &face);
    if (!(way.after < INFINITY)) return;
    pass(&to->faces[face], way.along, i, watch);
  }
}

/* Whether a place that came through a sheet is beyond a rim, and not on the far side. */
static bool is_round_rim(const scree_particle *sheet, vec3 at, const scree_watch *watch) {
  const uint32_t root = 0;
  uint32_t face;
  int region;
  if (!(scree_nearest_face(sheet, &root, 1, at, INFINITY, &face) < INFINITY)) return false;
  vec3 offset = vec3_sub(at, scree_closest_on_face(&sheet->faces[face], at, &region));
  return vec3_norm2(scree_outward(sheet, face, region)) == 0 &&
         vec3_dot(side_of(watch), vec3_unit(offset)) > watch_rim_cosine;
}

/* Whether the deepest place came out on the far side with all that is as far from it as the
 * surface. */
static bool is_beyond(const watched *w, const scree_frame *relative, const scree_watch *watch) {
  if (!watch->through[0]) return false;
  vec3 at = placed(w, w->from->inner[0], &relative->rotation, relative->position);
  return !scree_is_near(w->to, at, w->from->inner_depth) &&
         (w->to->sheet || w->to->hollow || !scree_is_inside(w->to, at));
}

/* How fast the first place moves against the surface. */
static double speed_of(const watched *w, const scree_frame *relative) {
  vec3 at = w->from->inner[0];
  if (w->forth) at = vec3_add(mat3_mul_vec(&relative->rotation, at), relative->position);
  return vec3_norm(vec3_add(relative->velocity, vec3_cross(relative->spin, at)));
}

static void look(const scree_world *world, const watched *w, const scree_frame *relative,
                 scree_watch *watch) {
  const quat was = {watch->turned[0], watch->turned[1], watch->turned[2], watch->turned[3]};
  const mat3 then = quat_to_mat3(was);
  const bool clear = none_is_through(watch);
  for (uint32_t i = 0; i < w->from->inner_count; i++) {
    vec3 place = w->from->inner[i];
    vec3 now = placed(w, place, &relative->rotation, relative->position);
    follow(w->to, placed(w, place, &then, watch->at), now, i, watch);
    if (watch->through[i] > 0 && w->to->sheet && is_round_rim(w->to, now, watch))
      watch->through[i] = 0;
  }
  if (!clear || none_is_through(watch)) return;
  watch->since = (float)world->time;
}

static void remember(const scree_world *world, const scree_pair *pair, const scree_frame *relative,
                     scree_watch *watch) {
  quat q = scree_pair_turned(world, pair);
  watch->at = relative->position;
  watch->turned[0] = (float)q.w, watch->turned[1] = (float)q.x;
  watch->turned[2] = (float)q.y, watch->turned[3] = (float)q.z;
  watch->taken = true;
}

/* How long a place may be through: until the two must have been parted. */
static double longest_time(const scree_pair *pair, const watched *w) {
  double rest = passage_patience * pair->law.contact_time;
  return pair->depenetrating ? rest + passage_patience * w->from->inner_depth /
                                          scree_depenetration_speed(&pair->law)
                             : rest;
}

void scree_pair_watch(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  scree_watch *watch = &pair->watch;
  const scree_frame *relative = &scratch->relative;
  if (watch->taken && pair->list.path < watch->due) return;
  watched w;
  if (!choose(world, pair, &w)) {
    watch->due = INFINITY;
    watch->taken = true;
    return;
  }
  if (watch->taken) look(world, &w, relative, watch);
  if (!pair->touching && none_is_through(watch)) watch->speed = (float)speed_of(&w, relative);
  remember(world, pair, relative, watch);
  watch->due = pair->list.path + watch_look_share * w.from->inner_depth;
  if (none_is_through(watch)) return;
  watch->due = -INFINITY; /* at every step */
  bool apart = !pair->touching && !pair->depenetrating;
  bool passed = is_beyond(&w, relative, watch),
       settled = apart || world->time - watch->since > longest_time(pair, &w);
  scratch->work.passed = passed || (settled && is_through(&w, watch));
  if (apart && !scratch->work.passed) *watch = (scree_watch){.taken = false};
}
