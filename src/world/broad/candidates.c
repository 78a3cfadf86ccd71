/* Candidate lists: every pair of features of a and b that could touch before the relative motion
 * has covered `skin`. Each goes to sleep with the path at which it must be looked at first;
 * features that are awake already stay so with their memory. The list holds until the path reaches
 * list.end.
 *
 * Points are found through both trees and the closest-point query, edges through both edge trees,
 * in the frame of b; edges that face away from each other are left out. */
#include "world/broad/candidates.h"
#include "world/state/walls.h"

#include "particle/closest.h"

/* A list of fast bodies should last this many steps. */
enum { FAST_STEPS = 40 };
static const double fast_skins =
    3; /* no list of fast bodies reaches farther than this many skins */

typedef scree_listing listing; /* contact.h */

/* What tells one feature pair from another: the cached face is not part of it. */
static uint64_t name_of(uint32_t kind, uint32_t a, uint32_t b) {
  if (kind == SCREE_FEATURE_POINT_FACE || kind == SCREE_FEATURE_POINT_WALL) b = 0;
  if (kind == SCREE_FEATURE_FACE_POINT) a = 0;
  return (((uint64_t)a << 32 | b) + kind) * 0x9E3779B97F4A7C15u;
}

/* One bit for each awake feature pair's name: most names are not among them. */
static void mark_awake(listing *l) {
  for (uint32_t i = 0; i < l->pair->active.count; i++) {
    const scree_feature_pair *feature = &l->scratch->features[i];
    uint64_t bit = name_of(feature->kind, feature->a, feature->b) >> 56;
    l->awake[bit >> 6] |= (uint64_t)1 << (bit & 63);
  }
}

static bool is_awake(const listing *l, uint32_t kind, uint32_t a, uint32_t b) {
  uint64_t name = name_of(kind, a, b), bit = name >> 56;
  if (!(l->awake[bit >> 6] >> (bit & 63) & 1)) return false;
  for (uint32_t i = 0; i < l->pair->active.count; i++) {
    const scree_feature_pair *feature = &l->scratch->features[i];
    if (feature->kind == kind && name_of(kind, feature->a, feature->b) == name) return true;
  }
  return false;
}

static void put_to_sleep(listing *l, scree_feature_kind kind, uint32_t a, uint32_t b, double gap) {
  if (gap > l->skin || is_awake(l, kind, a, b)) return;
  const scree_sleeping_feature sleeping_feature = {l->pair->list.path + gap, a, b, kind};
  scree_range *sleeping = &l->scratch->neighbours->sleeping;
  if (l->to) {
    if (l->count < l->room) l->to[l->count] = sleeping_feature;
    l->count++;
    return;
  }
  l->full = l->full || !scree_reserve_sleeping(l->scratch, sleeping->count + 1);
  if (!l->full) scree_sleeping_features(l->scratch)[sleeping->count++] = sleeping_feature;
}

static vec3 into_b(const listing *l, vec3 p) {
  return vec3_add(mat3_mul_vec(&l->relative->rotation, p), l->relative->position);
}

static void list_wall_point(listing *l, uint32_t i) {
  const scree_world_wall *wall = &l->world->walls.items[l->pair->b];
  vec3 closest, normal, p = into_b(l, l->a->points[i]);
  double side = scree_wall_side(wall, p);
  if (scree_pair_is_new(l->pair))
    side = scree_wall_first_side(wall, p, l->relative->position,
                                 scree_pair_clearance(l->pair, l->a, i));
  double d = scree_wall_distance(wall, p, side, &closest, &normal);
  put_to_sleep(l, SCREE_FEATURE_POINT_WALL, i, 0,
               d - l->a->point_radii[i] - l->pair->law.smoothing);
}

/* Nodes of the other side's tree under which everything lies that can be near the present node. A
 * walk down one tree takes the other's along, a level at a time. */
enum { FRONT_SIZE = 48 };
typedef struct front {
  uint32_t nodes[FRONT_SIZE];
  int count;
} front;

/* What the other tree's nodes must meet: a box, and for edges a cone of outward directions. */
typedef struct sieve {
  const scree_tree *tree;
  scree_box box;
  const scree_cone *cone; /* reversed; NULL: any direction */
} sieve;

static bool passes(const sieve *s, uint32_t node) {
  return scree_box_meets(&s->tree->nodes[node].box, &s->box) &&
         (!s->cone || scree_cones_meet(s->cone, &s->tree->cones[node]));
}

/* The front one level farther down where there is room. */
static void refine(const sieve *s, const front *from, front *to) {
  to->count = 0;
  for (int i = 0; i < from->count; i++) {
    uint32_t node = from->nodes[i], child = s->tree->nodes[node].first;
    bool split = !s->tree->nodes[node].count && to->count + from->count - i < FRONT_SIZE;
    if (!split) {
      if (passes(s, node)) to->nodes[to->count++] = node;
      continue;
    }
    if (passes(s, child)) to->nodes[to->count++] = child;
    if (passes(s, child + 1)) to->nodes[to->count++] = child + 1;
  }
}

/* The points of one side against the surface of the other. */
typedef struct point_listing {
  listing *list;
  const scree_particle *from, *to;
  bool forth;    /* from is a */
  mat3 rotation; /* from's frame into to's */
  vec3 shift;
  double far;
} point_listing;

static void list_point(const point_listing *pl, uint32_t i, const front *near) {
  listing *l = pl->list;
  vec3 p = vec3_add(mat3_mul_vec(&pl->rotation, pl->from->points[i]), pl->shift);
  double contact = pl->from->point_radii[i] + pl->to->radius + l->pair->law.smoothing;
  uint32_t face;
  double distance =
      scree_nearest_face(pl->to, near->nodes, near->count, p, l->skin + contact, &face);
  l->closest_queries++;
  if (!(distance < INFINITY)) return;
  double gap = distance - contact;
  if (gap > 0 && scree_pair_is_new(l->pair) && pl->to->measures.volume > 0 &&
      scree_is_inside(pl->to, p))
    gap = 0; /* made or moved there: nothing was seen from outside */
  if (pl->forth)
    put_to_sleep(l, SCREE_FEATURE_POINT_FACE, i, 0, gap);
  else
    put_to_sleep(l, SCREE_FEATURE_FACE_POINT, 0, i, gap);
}

static void list_points_below(const point_listing *pl, uint32_t index, const front *above) {
  const scree_tree_node *node = &pl->from->point_tree.nodes[index];
  scree_box box = scree_box_moved(&node->box, &pl->rotation, pl->shift);
  sieve s = {&pl->to->face_tree, scree_box_grown(box, pl->far), NULL};
  front here;
  refine(&s, above, &here);
  if (here.count == 0) return;
  for (uint32_t k = 0; k < node->count; k++)
    list_point(pl, pl->from->point_tree.order[node->first + k], &here);
  if (node->count) return;
  list_points_below(pl, node->first, &here);
  list_points_below(pl, node->first + 1, &here);
}

static point_listing points_against(listing *l, bool forth) {
  const scree_particle *from = forth ? l->a : l->b, *to = forth ? l->b : l->a;
  const scree_frame *r = l->relative;
  point_listing pl = {l, from, to, forth, r->rotation, r->position, 0};
  if (!forth) {
    pl.rotation = mat3_transpose(&r->rotation);
    pl.shift = vec3_neg(mat3_mul_vec(&pl.rotation, r->position));
  }
  pl.far = l->skin + l->pair->law.smoothing + to->radius; /* boxes hold the radii */
  return pl;
}

static void list_sphere(listing *l, uint32_t i) {
  vec3 p = into_b(l, l->a->points[i]);
  double far = l->a->point_radii[i] + l->pair->law.smoothing + l->skin;
  scree_box near = scree_box_grown(scree_box_of(p, p), far);
  if (!scree_box_meets(&near, &l->b->box)) return; /* which holds the radii */
  for (uint32_t j = 0; j < l->b->point_count; j++)
    put_to_sleep(l, SCREE_FEATURE_POINT_POINT, i, j,
                 vec3_distance(p, l->b->points[j]) - l->a->point_radii[i] - l->b->point_radii[j] -
                     l->pair->law.smoothing);
}

/* One edge of a against the edges of b. Edges can touch only along a direction that is outward for
 * one and inward for the other: their cones of normals, one of them reversed, must meet. */
static void list_edge(listing *l, uint32_t i, const front *above) {
  const scree_edge *ea = &l->a->edges[i];
  const mat3 *r = &l->relative->rotation;
  vec3 p0 = into_b(l, ea->start), p1 = into_b(l, ea->end), along = mat3_mul_vec(r, ea->along);
  scree_cone cone = scree_cone_opposite(&ea->normals, r);
  double contact = l->pair->law.reach + l->pair->law.smoothing;
  sieve s = {&l->b->edge_tree, scree_box_grown(scree_box_of(p0, p1), l->skin + contact), &cone};
  uint32_t stack[FRONT_SIZE + SCREE_TREE_STACK];
  int depth = 0;
  for (int k = above->count; k-- > 0;) stack[depth++] = above->nodes[k];
  while (depth > 0) {
    uint32_t index = stack[--depth];
    const scree_tree_node *node = &s.tree->nodes[index];
    if (!passes(&s, index)) continue;
    if (node->count == 0) {
      stack[depth++] = node->first + 1;
      stack[depth++] = node->first;
      continue;
    }
    for (uint32_t k = 0; k < node->count; k++) {
      uint32_t j = s.tree->order[node->first + k];
      const scree_edge *eb = &l->b->edges[j];
      if (!scree_cones_meet(&cone, &eb->normals)) continue;
      double s_a, s_b;
      scree_closest_on_segments(p0, along, ea->length, eb->start, eb->along, eb->length, &s_a,
                                &s_b);
      double d = vec3_distance(vec3_mad(p0, along, s_a), vec3_mad(eb->start, eb->along, s_b));
      put_to_sleep(l, SCREE_FEATURE_EDGE_EDGE, i, j, d - contact);
    }
  }
}

static void list_edges_below(listing *l, uint32_t index, const front *above) {
  const scree_tree *tree = &l->a->edge_tree;
  const scree_tree_node *node = &tree->nodes[index];
  const scree_frame *r = l->relative;
  scree_box box = scree_box_moved(&node->box, &r->rotation, r->position);
  scree_cone cone = scree_cone_opposite(&tree->cones[index], &r->rotation);
  double far = l->skin + l->pair->law.reach + l->pair->law.smoothing;
  sieve s = {&l->b->edge_tree, scree_box_grown(box, far), &cone};
  front here;
  refine(&s, above, &here);
  if (here.count == 0) return;
  for (uint32_t k = 0; k < node->count; k++) list_edge(l, tree->order[node->first + k], &here);
  if (node->count) return;
  list_edges_below(l, node->first, &here);
  list_edges_below(l, node->first + 1, &here);
}

static double box_gap(const scree_box *a, const scree_box *b) {
  double x = scree_max(a->low.x - b->high.x, b->low.x - a->high.x),
         y = scree_max(a->low.y - b->high.y, b->low.y - a->high.y),
         z = scree_max(a->low.z - b->high.z, b->low.z - a->high.z);
  return scree_max(x, scree_max(y, z));
}

/* The shapes are at least this far apart: the larger gap of the two boxes in either frame. Boxes
 * hold the contact radii. */
static double least_distance(const listing *l) {
  const scree_frame *r = l->relative;
  scree_box moved = scree_box_moved(&l->a->box, &r->rotation, r->position);
  double gap = box_gap(&moved, &l->b->box);
  mat3 back = mat3_transpose(&r->rotation);
  moved = scree_box_moved(&l->b->box, &back, vec3_neg(mat3_mul_vec(&back, r->position)));
  return scree_max(gap, box_gap(&moved, &l->a->box)) - l->pair->law.smoothing;
}

/* A ball around the part of either box that is within the skin of the other box, and room to move
 * by the skin: all that can touch while the list holds. In the frame in which the boxes' common
 * part is smaller. None where the smaller body is no larger. */
static void set_region(listing *l) {
  const scree_frame *r = l->relative;
  scree_pair *pair = l->pair;
  double far = l->skin + pair->law.smoothing, best = INFINITY;
  mat3 back = mat3_transpose(&r->rotation);
  vec3 shift = vec3_neg(mat3_mul_vec(&back, r->position));
  for (int of_a = 0; of_a < 2; of_a++) {
    scree_box other = of_a ? scree_box_moved(&l->b->box, &back, shift)
                           : scree_box_moved(&l->a->box, &r->rotation, r->position);
    const scree_box *own = of_a ? &l->a->box : &l->b->box;
    vec3 low = vec3_max(own->low, other.low), high = vec3_min(own->high, other.high);
    vec3 centre = vec3_scale(vec3_add(low, high), 0.5), side = vec3_sub(high, low);
    double radius = 0.5 * vec3_norm(vec3_add(side, (vec3){2 * far, 2 * far, 2 * far})) + l->skin;
    if (radius >= best) continue;
    best = radius;
    pair->list.region = of_a ? into_b(l, centre) : centre;
  }
  best = scree_max(best, l->skin / scree_cone_slack); /* the path grows by radius times angle */
  double smaller = scree_min(l->a->measures.bounding_radius, l->b->measures.bounding_radius);
  pair->list.region_radius = best < smaller ? best : 0;
}

/* Features of one kind that may touch: those of `from`, in the order of its tree, against all of
 * the other body's. */
typedef enum group {
  GROUP_WALL_POINTS,
  GROUP_POINTS,
  GROUP_POINTS_OF_B,
  GROUP_EDGES,
  GROUP_SPHERES,
  GROUP_COUNT
} group;

static size_t group_size(const listing *l, group g) {
  const scree_particle *a = l->a, *b = l->b;
  switch (g) {
  case GROUP_WALL_POINTS:
    return l->analytic ? a->point_count : 0;
  case GROUP_POINTS:
    return b && b->face_count ? a->point_count : 0;
  case GROUP_POINTS_OF_B:
    return b && a->face_count ? b->point_count : 0;
  case GROUP_EDGES:
    return b && b->edge_count ? a->edge_count : 0;
  default:
    return b && !l->pair->wall && !a->face_count && !b->face_count ? a->point_count : 0;
  }
}

/* All features of a group, with the trees' help. */
static void list_group(listing *l, group g) {
  const front whole = {.nodes = {0}, .count = 1};
  size_t count = group_size(l, g);
  if (count == 0) return;
  if (g == GROUP_EDGES) {
    list_edges_below(l, 0, &whole);
  } else if (g == GROUP_POINTS || g == GROUP_POINTS_OF_B) {
    point_listing pl = points_against(l, g == GROUP_POINTS);
    list_points_below(&pl, 0, &whole);
  } else {
    for (uint32_t i = 0; i < count; i++)
      g == GROUP_SPHERES ? list_sphere(l, i) : list_wall_point(l, i);
  }
}

size_t scree_listing_count(const scree_listing *l) {
  size_t count = 0;
  for (int g = 0; g < GROUP_COUNT; g++) count += group_size(l, (group)g);
  return count;
}

void scree_listing_take(scree_listing *l, size_t entry) {
  const front whole = {.nodes = {0}, .count = 1};
  int g = 0;
  while (entry >= group_size(l, (group)g)) entry -= group_size(l, (group)g++);
  if (g == GROUP_WALL_POINTS || !l->b) {
    list_wall_point(l, (uint32_t)entry);
  } else if (g == GROUP_EDGES) {
    list_edge(l, l->a->edge_tree.order[entry], &whole);
  } else if (g == GROUP_SPHERES) {
    list_sphere(l, (uint32_t)entry);
  } else {
    point_listing pl = points_against(l, g == GROUP_POINTS);
    list_point(&pl, pl.from->point_tree.order[entry], &whole);
  }
}

bool scree_listing_begin(scree_listing *l, const scree_world *world, scree_pair *pair,
                         scree_scratch *scratch) {
  bool analytic = pair->wall && scree_wall_is_analytic(&world->walls.items[pair->b]);
  double skin = scree_pair_skin(world, pair);
  skin = scree_max(skin, scree_min(FAST_STEPS * pair->list.travel, fast_skins * skin));
  skin = scree_min(skin, scree_cone_slack * scree_pair_radius(world, pair)); /* of edges' cones */
  *l = (listing){.world = world,
                 .pair = pair,
                 .a = world->bodies.particle[pair->a],
                 .b = scree_pair_shape_b(world, pair),
                 .relative = &scratch->relative,
                 .scratch = scratch,
                 .skin = skin,
                 .analytic = analytic};
  mark_awake(l);
  scratch->neighbours->sleeping.count = 0;
  double apart = analytic ? 0 : least_distance(l);
  pair->list.region_radius = 0;
  pair->list.next_feature = -INFINITY;
  pair->list.end = pair->list.path + scree_max(apart, l->skin);
  if (apart > l->skin) return false;
  if (!pair->wall && l->b->measures.kind != SCREE_PARTICLE_SPHERE)
    set_region(l); /* its frame turns */
  return true;
}

bool scree_pair_list(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  double started = scree_now();
  listing l;
  if (!scree_listing_begin(&l, world, pair, scratch)) return true;
  for (int g = 0; g < GROUP_COUNT; g++) list_group(&l, (group)g);
  scratch->counters.list_builds++;
  scratch->counters.closest_queries += l.closest_queries;
  scratch->counters.candidate_seconds += scree_now() - started;
  return !l.full;
}
