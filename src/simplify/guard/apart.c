#include "simplify/guard/apart.h"

#include "base/alloc.h"
#include "mesh/index/intersect.h"

#include <string.h>

/* There is room for so many triangles near one collapse, those whose leaves meet its box, without
 * asking for memory. */
enum { ROOM = 4096 };
/* The name of the moved vertex, which no vertex has. */
#define MOVED (SCREE_NONE - 2)

/* A triangle with its corners named by vertices of the mesh given. */
typedef struct corners {
  uint32_t name[3];
  vec3 at[3];
} corners;

typedef struct search {
  const scree_surroundings *around;
  const scree_fan *fan;
  scree_bounds box;
  corners moved[SCREE_FAN_MAX];
  scree_bounds bounds[SCREE_FAN_MAX]; /* of these */
  uint32_t own[ROOM], *found;
  size_t found_count;
} search;

static corners corners_of(const scree_halfmesh *s, uint32_t t) {
  corners c;
  for (size_t i = 0; i < 3; i++) {
    uint32_t v = s->half[3 * (size_t)t + i].from;
    c.name[i] = s->vertex[v].origin;
    c.at[i] = s->vertex[v].at;
  }
  return c;
}

static scree_bounds bounds_of(const corners *c) {
  scree_bounds b = scree_bounds_empty();
  for (int i = 0; i < 3; i++) scree_bounds_add(&b, c->at[i]);
  return b;
}

static bool meet(const corners *x, const corners *y) {
  vec3 at[6];
  uint32_t t[3] = {0, 1, 2}, u[3] = {3, 4, 5};
  memcpy(at, x->at, sizeof x->at);
  memcpy(at + 3, y->at, sizeof y->at);
  for (uint32_t i = 0; i < 3; i++)
    for (uint32_t j = 0; j < 3; j++)
      if (x->name[i] == y->name[j]) u[j] = t[i];
  return scree_triangles_meet(&at[0].x, t, u) != SCREE_MEET_NOT;
}

static bool is_of_fan(const search *q, uint32_t t) {
  const scree_half_edge *half = q->around->s->half + 3 * (size_t)t;
  for (int i = 0; i < 3; i++)
    if (half[i].from == q->fan->a || half[i].from == q->fan->b) return true;
  return false;
}

static uint32_t averse_of(const scree_fan *f) {
  scree_facing facing = scree_facing_all();
  for (uint32_t i = 0; i < f->count; i++) scree_facing_add(&facing, f->after[i]);
  return scree_facing_averse(&facing);
}

/* Whether the triangle faces g, or lies outside the box. */
static bool faces(const corners *c, vec3 g, const scree_bounds *box) {
  if (vec3_dot(g, vec3_triangle_normal(c->at[0], c->at[1], c->at[2])) > 0) return true;
  scree_bounds b = bounds_of(c);
  return !scree_bounds_meet(&b, box);
}

/* A direction that the fan's triangles face before and after, and what is near as well. */
static bool certified(const search *q) {
  const scree_halfmesh *s = q->around->s;
  const scree_fan *f = q->fan;
  vec3 g = {0, 0, 0};
  if (!s->closed) return false;
  for (uint32_t i = 0; i < f->count; i++) g = vec3_add(g, f->after[i]);
  for (uint32_t i = 0; i < f->count; i++)
    if (!(vec3_dot(g, f->after[i]) > 0)) return false;
  for (size_t k = 0; k < q->found_count; k++) {
    uint32_t t = q->found[k];
    if (scree_is_gone(s, t)) continue;
    corners c = corners_of(s, t);
    if (!faces(&c, g, &q->box)) return false;
  }
  return true;
}

/* How many of the fan's triangles, before and after, meet it. */
static void count_met(const search *q, const corners *c, int *was, int *will_be) {
  scree_bounds b = bounds_of(c);
  int met = 0;
  for (uint32_t i = 0; i < q->fan->count; i++)
    met += scree_bounds_meet(&b, &q->bounds[i]) && meet(&q->moved[i], c);
  *will_be += met;
  if (met == 0) return;
  for (uint32_t k = 0; k < scree_fan_triangle_count(q->fan); k++) {
    corners own = corners_of(q->around->s, scree_fan_triangle(q->around->s, q->fan, k));
    scree_bounds of_own = bounds_of(&own);
    *was += scree_bounds_meet(&b, &of_own) && meet(&own, c);
  }
}

/* The fan's triangles with each other. */
static int count_own(const search *q) {
  const uint32_t n = q->fan->count;
  int met = 0;
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = i + 1; j < n; j++) met += meet(&q->moved[i], &q->moved[j]);
  return met;
}

static bool meets_no_more(search *q) {
  const scree_halfmesh *s = q->around->s;
  const scree_fan *f = q->fan;
  for (uint32_t i = 0; i < f->count; i++) {
    uint32_t h = f->edge[i];
    q->moved[i] =
        (corners){{MOVED, s->vertex[s->half[h].from].origin, s->vertex[scree_to(s, h)].origin},
                  {f->at, f->from[i], f->to[i]}};
    q->bounds[i] = scree_fan_bounds(f, i);
  }
  int was = 0, will_be = count_own(q);
  if (will_be > 0) return false;
  for (size_t k = 0; k < q->found_count; k++) {
    uint32_t t = q->found[k];
    if (scree_is_gone(s, t) || is_of_fan(q, t)) continue;
    corners c = corners_of(s, t);
    count_met(q, &c, &was, &will_be);
  }
  return will_be <= was;
}

bool scree_apart(const scree_surroundings *around, const scree_fan *f) {
  const scree_halfmesh *s = around->s;
  search q; /* too large to be cleared each time */
  q.around = around;
  q.fan = f;
  q.box = scree_bounds_empty();
  scree_bounds_add(&q.box, f->at);
  scree_bounds_add(&q.box, s->vertex[f->a].at);
  scree_bounds_add(&q.box, s->vertex[f->b].at);
  for (uint32_t i = 0; i < f->count; i++) {
    scree_bounds_add(&q.box, f->from[i]);
    scree_bounds_add(&q.box, f->to[i]);
  }
  if (s->closed && scree_surface_tree_faces(around->tree, &q.box, averse_of(f))) return true;
  q.found = q.own;
  q.found_count = scree_surface_tree_overlap(around->tree, s, &q.box, q.found, ROOM);
  if (q.found_count > ROOM) {
    q.found = scree_alloc(q.found_count, sizeof *q.found);
    if (!q.found) return false;
    scree_surface_tree_overlap(around->tree, s, &q.box, q.found, q.found_count);
  }
  bool apart =
      certified(&q) || (meets_no_more(&q) && scree_markers_stay(around->markers, s, f, &q.box));
  if (q.found != q.own) scree_free(q.found);
  return apart;
}
