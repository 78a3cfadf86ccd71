/* Candidate lists: every pair of features of a and b that could touch before the relative motion
 * has covered `skin`. Each goes to sleep with the path at which it must be looked at first;
 * features that are awake already stay so with their memory. The list holds until the path reaches
 * list_end.
 *
 * Points are found through the other side's bounding box and the closest-point query; edges through
 * both edge trees at once, in the frame of b. */
#include "world/world.h"

#include "base/array.h"
#include "base/progress.h"
#include "particle/closest.h"

typedef struct listing {
  const scree_world *world;
  scree_pair *pair;
  const scree_particle *a, *b; /* b NULL: analytic wall */
  const scree_frame *relative;
  scree_scratch *scratch;
  double skin;
  bool failed;
} listing;

static bool is_awake(const scree_pair *pair, uint32_t kind, uint32_t a, uint32_t b) {
  for (size_t i = 0; i < pair->active.count; i++) {
    const scree_item *item = &pair->active.items[i];
    if (item->kind != kind) continue;
    bool same_a = item->a == a, same_b = item->b == b;
    if (kind == SCREE_ITEM_POINT_FACE || kind == SCREE_ITEM_POINT_WALL) same_b = true;
    if (kind == SCREE_ITEM_FACE_POINT) same_a = true;
    if (same_a && same_b) return true;
  }
  return false;
}

static void put_to_sleep(listing *l, scree_item_kind kind, uint32_t a, uint32_t b, double gap) {
  if (gap > l->skin || is_awake(l->pair, kind, a, b)) return;
  scree_sleeper sleeper = {l->pair->path + gap, a, b, kind};
  if (!SCREE_PUSH(&l->pair->sleeping, sleeper)) l->failed = true;
}

static vec3 into_b(const listing *l, vec3 p) {
  return vec3_add(mat3_mul_vec(&l->relative->rotation, p), l->relative->position);
}

static vec3 into_a(const listing *l, vec3 p) {
  return mat3_tmul_vec(&l->relative->rotation, vec3_sub(p, l->relative->position));
}

static void list_wall_points(listing *l) {
  const scree_world_wall *wall = &l->world->walls.items[l->pair->b];
  for (uint32_t i = 0; i < l->a->point_count; i++) {
    vec3 closest, normal;
    double d = scree_wall_distance(wall, into_b(l, l->a->points[i]), &closest, &normal);
    put_to_sleep(l, SCREE_ITEM_POINT_WALL, i, 0, d - l->a->point_radii[i] - l->pair->smoothing);
  }
}

/* The points of `from` against the surface of `to`; `forth`: from is a. */
static void list_surface_points(listing *l, const scree_particle *from, const scree_particle *to,
                                bool forth) {
  double far = l->skin + l->pair->smoothing + to->measures.rounding;
  for (uint32_t i = 0; i < from->point_count; i++) {
    vec3 p = forth ? into_b(l, from->points[i]) : into_a(l, from->points[i]);
    double reach = far + from->point_radii[i];
    if (scree_box_distance2(&to->face_tree.nodes[0].box, p) > reach * reach) continue;
    scree_near near;
    scree_closest_faces(to, p, reach, 0, &near);
    l->scratch->closest_queries++;
    if (near.count == 0) continue;
    double gap =
        near.distance[0] - from->point_radii[i] - to->measures.rounding - l->pair->smoothing;
    if (forth)
      put_to_sleep(l, SCREE_ITEM_POINT_FACE, i, near.face[0], gap);
    else
      put_to_sleep(l, SCREE_ITEM_FACE_POINT, near.face[0], i, gap);
  }
}

static void list_sphere_pairs(listing *l) {
  for (uint32_t i = 0; i < l->a->point_count; i++) {
    vec3 p = into_b(l, l->a->points[i]);
    for (uint32_t j = 0; j < l->b->point_count; j++)
      put_to_sleep(l, SCREE_ITEM_POINT_POINT, i, j,
                   vec3_distance(p, l->b->points[j]) - l->a->point_radii[i] - l->b->point_radii[j] -
                       l->pair->smoothing);
  }
}

static void list_edge_pair(listing *l, uint32_t i, uint32_t j) {
  const scree_edge *ea = &l->a->edges[i], *eb = &l->b->edges[j];
  vec3 p0 = into_b(l, ea->start), p1 = into_b(l, ea->end);
  double s, t;
  scree_closest_on_segments(p0, p1, eb->start, eb->end, &s, &t);
  double d = vec3_distance(vec3_lerp(p0, p1, s), vec3_lerp(eb->start, eb->end, t));
  put_to_sleep(l, SCREE_ITEM_EDGE_EDGE, i, j, d - l->pair->reach - l->pair->smoothing);
}

static void list_leaf_edges(listing *l, const scree_tree_node *na, const scree_tree_node *nb) {
  for (uint32_t i = 0; i < na->count; i++)
    for (uint32_t j = 0; j < nb->count; j++)
      list_edge_pair(l, l->a->edge_tree.order[na->first + i], l->b->edge_tree.order[nb->first + j]);
}

static double extent_of(const scree_box *box) {
  vec3 side = vec3_sub(box->high, box->low);
  return side.x + side.y + side.z;
}

static void list_edges(listing *l) {
  if (l->a->edge_count == 0 || l->b->edge_count == 0) return;
  struct {
    uint32_t a, b;
  } stack[2 * SCREE_TREE_STACK];
  const scree_tree_node *nodes_a = l->a->edge_tree.nodes, *nodes_b = l->b->edge_tree.nodes;
  double far = l->skin + l->pair->reach + l->pair->smoothing;
  int depth = 0;
  stack[depth].a = 0;
  stack[depth++].b = 0;
  while (depth > 0) {
    depth--;
    uint32_t ia = stack[depth].a, ib = stack[depth].b;
    const scree_tree_node *na = &nodes_a[ia], *nb = &nodes_b[ib];
    scree_box moved = scree_box_moved(&na->box, &l->relative->rotation, l->relative->position);
    moved = scree_box_grown(moved, far);
    if (!scree_box_meets(&moved, &nb->box)) continue;
    if (na->count && nb->count) {
      list_leaf_edges(l, na, nb);
      continue;
    }
    bool split_a = na->count == 0 && (nb->count || extent_of(&na->box) >= extent_of(&nb->box));
    for (uint32_t child = 0; child < 2; child++) {
      stack[depth].a = split_a ? na->first + child : ia;
      stack[depth++].b = split_a ? ib : nb->first + child;
    }
  }
}

bool scree_pair_list(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                     scree_scratch *scratch) {
  double started = scree_now();
  listing l = {.world = world,
               .pair = pair,
               .a = world->bodies.particle[pair->a],
               .b = scree_pair_shape_b(world, pair),
               .relative = relative,
               .scratch = scratch,
               .skin = world->options.skin / world->options.smoothing * pair->smoothing};
  pair->sleeping.count = 0;
  if (!l.b) {
    list_wall_points(&l);
  } else {
    if (l.b->face_count) list_surface_points(&l, l.a, l.b, true);
    if (l.a->face_count) list_surface_points(&l, l.b, l.a, false);
    if (l.a->face_count && l.b->face_count) list_edges(&l);
    if (!l.a->face_count && !l.b->face_count) list_sphere_pairs(&l);
  }
  pair->list_end = pair->path + l.skin;
  scratch->list_builds++;
  scratch->candidate_seconds += scree_now() - started;
  return !l.failed;
}
