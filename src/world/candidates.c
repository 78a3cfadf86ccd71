/* Candidate lists: every pair of features of a and b that could touch before the relative motion
 * has covered `skin`. Each goes to sleep with the path at which it must be looked at first;
 * features that are awake already stay so with their memory. The list holds until the path reaches
 * list_end.
 *
 * Points are found through both trees and the closest-point query, edges through both edge trees,
 * in the frame of b; edges that face away from each other are left out. */
#include "world/world.h"

#include "base/array.h"
#include "base/progress.h"
#include "particle/closest.h"

static const double fast_steps = 40; /* a list of fast bodies should last this many steps, */
static const double fast_skins = 3;  /* but not reach farther than this many skins */

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

static void list_wall_points(listing *l) {
  const scree_world_wall *wall = &l->world->walls.items[l->pair->b];
  for (uint32_t i = 0; i < l->a->point_count; i++) {
    vec3 closest, normal, p = into_b(l, l->a->points[i]);
    double d = scree_wall_distance(wall, p, scree_wall_side(wall, p), &closest, &normal);
    put_to_sleep(l, SCREE_ITEM_POINT_WALL, i, 0, d - l->a->point_radii[i] - l->pair->smoothing);
  }
}

/* The points of one side against the surface of the other. */
typedef struct point_listing {
  listing *list;
  const scree_particle *from, *to;
  bool forth;    /* from is a */
  mat3 rotation; /* from's frame into to's */
  vec3 shift;
} point_listing;

static void list_point(const point_listing *pl, uint32_t i) {
  listing *l = pl->list;
  vec3 p = vec3_add(mat3_mul_vec(&pl->rotation, pl->from->points[i]), pl->shift);
  double touch = pl->from->point_radii[i] + pl->to->measures.rounding + l->pair->smoothing;
  uint32_t face;
  double distance = scree_nearest_face(pl->to, p, l->skin + touch, &face);
  l->scratch->closest_queries++;
  if (!(distance < INFINITY)) return;
  double gap = distance - touch;
  if (pl->forth)
    put_to_sleep(l, SCREE_ITEM_POINT_FACE, i, face, gap);
  else
    put_to_sleep(l, SCREE_ITEM_FACE_POINT, face, i, gap);
}

/* Whether the box of any leaf meets the box. */
static bool meets_boxes(const scree_tree *tree, const scree_box *box) {
  const scree_tree_node *nodes = tree->nodes;
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const scree_tree_node *node = &nodes[stack[--depth]];
    if (!scree_box_meets(&node->box, box)) continue;
    if (node->count) return true;
    stack[depth++] = node->first;
    stack[depth++] = node->first + 1;
  }
  return false;
}

static void list_surface_points(listing *l, const scree_particle *from, const scree_particle *to,
                                bool forth) {
  const scree_frame *r = l->relative;
  point_listing pl = {l, from, to, forth, r->rotation, r->position};
  if (!forth) {
    pl.rotation = mat3_transpose(&r->rotation);
    pl.shift = vec3_neg(mat3_mul_vec(&pl.rotation, r->position));
  }
  double far = l->skin + l->pair->smoothing + to->measures.rounding; /* boxes hold the radii */
  const scree_tree_node *nodes = from->point_tree.nodes;
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  if (from->point_count) stack[depth++] = 0;
  while (depth > 0) {
    const scree_tree_node *node = &nodes[stack[--depth]];
    scree_box box = scree_box_moved(&node->box, &pl.rotation, pl.shift);
    box = scree_box_grown(box, far);
    if (!meets_boxes(&to->face_tree, &box)) continue;
    if (node->count == 0) {
      stack[depth++] = node->first + 1;
      stack[depth++] = node->first;
      continue;
    }
    for (uint32_t k = 0; k < node->count; k++)
      list_point(&pl, from->point_tree.order[node->first + k]);
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

/* Edges can touch only along a direction that is outward for one and inward for the other: their
 * cones of normals, one of them reversed, must meet. */
static bool face_each_other(const scree_edge *ea, vec3 outward_a, const scree_edge *eb) {
  return -vec3_dot(outward_a, eb->outward) >= ea->cosine * eb->cosine - ea->sine * eb->sine;
}

/* One edge of a against the edges of b. */
static void list_edge(listing *l, uint32_t i) {
  const scree_edge *ea = &l->a->edges[i];
  vec3 p0 = into_b(l, ea->start), p1 = into_b(l, ea->end),
       along = mat3_mul_vec(&l->relative->rotation, ea->along),
       outward = mat3_mul_vec(&l->relative->rotation, ea->outward);
  double touch = l->pair->reach + l->pair->smoothing;
  scree_box box = scree_box_grown(scree_box_of(p0, p1), l->skin + touch);
  const scree_tree *tree = &l->b->edge_tree;
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const scree_tree_node *node = &tree->nodes[stack[--depth]];
    if (!scree_box_meets(&node->box, &box)) continue;
    if (node->count == 0) {
      stack[depth++] = node->first + 1;
      stack[depth++] = node->first;
      continue;
    }
    for (uint32_t k = 0; k < node->count; k++) {
      uint32_t j = tree->order[node->first + k];
      const scree_edge *eb = &l->b->edges[j];
      if (!face_each_other(ea, outward, eb)) continue;
      double s, t;
      scree_closest_on_segments(p0, along, ea->length, eb->start, eb->along, eb->length, &s, &t);
      double d = vec3_distance(vec3_mad(p0, along, s), vec3_mad(eb->start, eb->along, t));
      put_to_sleep(l, SCREE_ITEM_EDGE_EDGE, i, j, d - touch);
    }
  }
}

static void list_edges(listing *l) {
  if (l->a->edge_count == 0 || l->b->edge_count == 0) return;
  const scree_tree *tree = &l->a->edge_tree;
  double far = l->skin + l->pair->reach + l->pair->smoothing;
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const scree_tree_node *node = &tree->nodes[stack[--depth]];
    scree_box box = scree_box_moved(&node->box, &l->relative->rotation, l->relative->position);
    box = scree_box_grown(box, far);
    if (!meets_boxes(&l->b->edge_tree, &box)) continue;
    if (node->count == 0) {
      stack[depth++] = node->first + 1;
      stack[depth++] = node->first;
      continue;
    }
    for (uint32_t k = 0; k < node->count; k++) list_edge(l, tree->order[node->first + k]);
  }
}

static double box_gap(const scree_box *a, const scree_box *b) {
  double x = fmax(a->low.x - b->high.x, b->low.x - a->high.x),
         y = fmax(a->low.y - b->high.y, b->low.y - a->high.y),
         z = fmax(a->low.z - b->high.z, b->low.z - a->high.z);
  return fmax(x, fmax(y, z));
}

/* The shapes are at least this far apart: the larger gap of the two boxes in either frame. Boxes
 * hold the roundings. */
static double least_distance(const listing *l) {
  const scree_frame *r = l->relative;
  scree_box moved = scree_box_moved(&l->a->box, &r->rotation, r->position);
  double gap = box_gap(&moved, &l->b->box);
  mat3 back = mat3_transpose(&r->rotation);
  moved = scree_box_moved(&l->b->box, &back, vec3_neg(mat3_mul_vec(&back, r->position)));
  return fmax(gap, box_gap(&moved, &l->a->box)) - l->pair->smoothing;
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
               .skin = scree_pair_skin(world, pair)};
  l.skin = fmax(l.skin, fmin(fast_steps * pair->travel, fast_skins * l.skin));
  pair->sleeping.count = 0;
  double apart = l.b ? least_distance(&l) : 0;
  if (apart > l.skin) {
    pair->list_end = pair->path + apart;
    return true;
  }
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
