/* Triangles by place, and the exact search among them.
 *
 * One by one, every triangle is in a linked list of each cell it touches, and listed again when it
 * changes. In a batch triangles come in groups that lie near each other (order.h), of which the box
 * is known: it is set when the directions are entered and widened by every collapse that may be
 * done. Of the few groups about an uncertain collapse all triangles are looked at. The search then
 * asks for the certificate once more, for the box of the ring alone instead of all its cells; only
 * where that fails are pairs of triangles tested. */
#include "simplify/grid_cells.h"

#include "base/array.h"
#include "base/parallel.h"
#include "mesh/intersect.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Groups that are asked for together first. */
enum { GROUPS_JOINED = 64 };

/* A box in steps of a fraction of a cell: boxes that are apart in steps are apart. */
enum { STEPS_PER_CELL = 32 }; /* at most 1025 cells along an axis */

static scree_grid_box coarse_box(const scree_grid *g, vec3 low, vec3 high) {
  double k = g->cells_per_length * STEPS_PER_CELL;
  const double from[3] = {g->low.x, g->low.y, g->low.z};
  const double l[3] = {low.x, low.y, low.z}, h[3] = {high.x, high.y, high.z};
  scree_grid_box box;
  for (int i = 0; i < 3; i++) {
    box.low[i] = (uint16_t)scree_cell_along(l[i], from[i], k, g->size[i] * STEPS_PER_CELL);
    box.high[i] = (uint16_t)scree_cell_along(h[i], from[i], k, g->size[i] * STEPS_PER_CELL);
  }
  return box;
}

static bool apart(const scree_grid_box *a, const scree_grid_box *b) {
  return a->low[0] > b->high[0] || a->low[1] > b->high[1] || a->low[2] > b->high[2] ||
         a->high[0] < b->low[0] || a->high[1] < b->low[1] || a->high[2] < b->low[2];
}

static bool list_large(scree_grid *g, uint32_t triangle) {
  if (!scree_array_reserve((void **)&g->large, &g->large_capacity, g->large_count + 1,
                           sizeof *g->large))
    return false;
  g->large[g->large_count++] = triangle;
  return true;
}

static bool list(scree_grid *g, vec3 low, vec3 high, uint32_t triangle) {
  scree_grid_box c = scree_cells_of(g, low, high);
  if (scree_count_cells(&c) > SCREE_CELLS_MAX) return list_large(g, triangle);
  scree_grid_box box = coarse_box(g, low, high);
  SCREE_FOR_CELLS(g, c, cell) {
    scree_grid_node node = {triangle, g->head[cell], box};
    if (!SCREE_PUSH(g, node)) return false;
    g->head[cell] = (uint32_t)(g->count - 1);
  }
  return true;
}

static void triangle_box(const scree_halfmesh *s, uint32_t t, vec3 *low, vec3 *high) {
  vec3 at[3];
  scree_corners(s, t, at);
  *low = vec3_min(at[0], vec3_min(at[1], at[2]));
  *high = vec3_max(at[0], vec3_max(at[1], at[2]));
}

bool scree_grid_list_triangle(scree_grid *g, const scree_halfmesh *s, uint32_t t) {
  vec3 low, high;
  triangle_box(s, t, &low, &high);
  return list(g, low, high, t);
}

/* The planned collapse that changes triangle t, or NONE. */
static uint32_t planned_for(const scree_halfmesh *s, uint32_t t, const scree_planned *planned) {
  if (!planned) return SCREE_NONE;
  for (size_t i = 0; i < 3; i++) {
    uint32_t chosen = planned->chosen[s->half[3 * (size_t)t + i].from];
    if (chosen != SCREE_NONE) return chosen;
  }
  return SCREE_NONE;
}

/* The box of triangle t and what it will become; false: the triangle is gone. */
static bool box_with_plan(const scree_halfmesh *s, uint32_t t, const scree_planned *planned,
                          vec3 *low, vec3 *high) {
  if (scree_is_gone(s, t)) return false;
  triangle_box(s, t, low, high);
  uint32_t chosen = planned_for(s, t, planned);
  if (chosen != SCREE_NONE) {
    *low = vec3_min(*low, planned->changes[chosen].target);
    *high = vec3_max(*high, planned->changes[chosen].target);
  }
  return true;
}

bool scree_grid_list_all(scree_grid *g, const scree_halfmesh *s) {
  g->head = scree_alloc(g->cell_count, sizeof *g->head);
  if (!g->head) return false;
  memset(g->head, 0xff, g->cell_count * sizeof *g->head);
  for (uint32_t t = 0; t < s->triangle_count; t++)
    if (!scree_is_gone(s, t) && !scree_grid_list_triangle(g, s, t)) return false;
  return true;
}

/* ---- The groups of a batch ---- */

/* Several threads may widen a group: every bound moves one way. */
static void widen(scree_grid_box *group, const scree_grid_box *box) {
  for (int i = 0; i < 3; i++) {
    uint16_t low = __atomic_load_n(&group->low[i], __ATOMIC_RELAXED),
             high = __atomic_load_n(&group->high[i], __ATOMIC_RELAXED);
    while (box->low[i] < low &&
           !__atomic_compare_exchange_n(&group->low[i], &low, box->low[i], true, __ATOMIC_RELAXED,
                                        __ATOMIC_RELAXED)) {
    }
    while (box->high[i] > high &&
           !__atomic_compare_exchange_n(&group->high[i], &high, box->high[i], true,
                                        __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
  }
}

void scree_grid_widen_groups(scree_grid *g, const scree_ring *r, const scree_grid_box *box) {
  uint32_t last = SCREE_NONE;
  for (uint32_t i = 0; i < r->count; i++) {
    uint32_t group = r->edge[i] / 3 / SCREE_GROUP;
    if (group != last) widen(&g->groups[group], box);
    last = group;
  }
}

void scree_grid_join_groups(scree_grid *g) {
  size_t count = scree_block_count(g->group_count, GROUPS_JOINED);
  for (size_t k = 0; k < count; k++) {
    scree_grid_box all = SCREE_NO_CELLS;
    size_t end = (k + 1) * GROUPS_JOINED;
    if (end > g->group_count) end = g->group_count;
    for (size_t i = k * GROUPS_JOINED; i < end; i++) scree_join_cells(&all, &g->groups[i]);
    g->groups[g->group_count + k] = all;
  }
}

/* ---- Pairs of triangles ---- */

/* A triangle with corners named by mesh vertex; the moved vertex has the name MOVED. */
typedef struct corners {
  uint32_t name[3];
  vec3 at[3];
} corners;

#define MOVED       (SCREE_NONE - 2)
#define MOVED_OTHER (SCREE_NONE - 3)

static corners corners_of(const scree_halfmesh *s, uint32_t t) {
  corners c;
  for (size_t i = 0; i < 3; i++) {
    uint32_t v = s->half[3 * (size_t)t + i].from;
    c.name[i] = s->vertex[v].origin;
    c.at[i] = s->vertex[v].at;
  }
  return c;
}

static bool meet(const corners *x, const corners *y) {
  for (int axis = 0; axis < 3; axis++) {
    const double *a = &x->at[0].x + axis, *b = &y->at[0].x + axis;
    if (fmax(a[0], fmax(a[3], a[6])) < fmin(b[0], fmin(b[3], b[6])) ||
        fmax(b[0], fmax(b[3], b[6])) < fmin(a[0], fmin(a[3], a[6])))
      return false;
  }
  vec3 at[6];
  uint32_t t[3] = {0, 1, 2}, u[3] = {3, 4, 5};
  memcpy(at, x->at, sizeof x->at);
  memcpy(at + 3, y->at, sizeof y->at);
  for (uint32_t i = 0; i < 3; i++)
    for (uint32_t j = 0; j < 3; j++)
      if (x->name[i] == y->name[j]) u[j] = t[i];
  return scree_triangles_meet(&at[0].x, t, u) != SCREE_MEET_NOT;
}

/* A plane with the error of a side's sign: |n.(x - at)| above error |x - at| is past rounding. */
typedef struct plane {
  vec3 at, n;
  double error;
} plane;

static double size_of(vec3 v) {
  return fabs(v.x) + fabs(v.y) + fabs(v.z);
}

static plane plane_of(const vec3 *at) {
  vec3 e1 = vec3_sub(at[1], at[0]), e2 = vec3_sub(at[2], at[0]);
  return (plane){at[0], vec3_cross(e1, e2), 1e-14 * size_of(e1) * size_of(e2)};
}

/* 0: not sure. */
static int side_of(const plane *p, vec3 x) {
  vec3 d = vec3_sub(x, p->at);
  double dot = vec3_dot(p->n, d), error = p->error * size_of(d);
  return dot > error ? 1 : dot < -error ? -1 : 0;
}

typedef struct search {
  const scree_grid *grid;
  const scree_halfmesh *s;
  const scree_ring *ring;
  const scree_planned *planned;
  uint32_t self;                 /* index of this collapse among the planned, or NONE */
  int before, after;             /* triangles met by the ring as it is, and as it will be */
  uint64_t averse;               /* to the triangles of the ring as it will be */
  corners moved[SCREE_RING_MAX]; /* the ring as it will be, and its triangles' boxes */
  vec3 low[SCREE_RING_MAX], high[SCREE_RING_MAX];
  plane plane[SCREE_RING_MAX];
} search;

static corners ring_triangle(const search *q, uint32_t i) {
  const scree_halfmesh *s = q->s;
  uint32_t e = q->ring->edge[i], v1 = s->half[e].from, v2 = scree_to(s, e);
  uint32_t v0 = s->half[scree_previous(e)].from;
  return (corners){{s->vertex[v0].origin, s->vertex[v1].origin, s->vertex[v2].origin},
                   {s->vertex[v0].at, s->vertex[v1].at, s->vertex[v2].at}};
}

static int count_met_before(const search *q, const corners *c) {
  int met = 0;
  for (uint32_t i = 0; i < q->ring->count; i++) {
    corners own = ring_triangle(q, i);
    met += meet(&own, c);
  }
  return met;
}

static bool has_name(const corners *c, uint32_t name) {
  return c->name[0] == name || c->name[1] == name || c->name[2] == name;
}

/* All corners of x but those that y has too are surely on one side of the plane, y's. */
static bool beside(const corners *x, const corners *y, const plane *of_y) {
  int side = 0;
  for (int i = 0; i < 3; i++) {
    if (has_name(y, x->name[i])) continue;
    int at = side_of(of_y, x->at[i]);
    if (at == 0 || at == -side) return false;
    side = at;
  }
  return side != 0;
}

static int count_met_after(const search *q, const corners *c) {
  vec3 low = vec3_min(c->at[0], vec3_min(c->at[1], c->at[2]));
  vec3 high = vec3_max(c->at[0], vec3_max(c->at[1], c->at[2]));
  plane of_c = plane_of(c->at);
  int met = 0;
  for (uint32_t i = 0; i < q->ring->count; i++) {
    const corners *m = &q->moved[i];
    if (low.x > q->high[i].x || low.y > q->high[i].y || low.z > q->high[i].z ||
        high.x < q->low[i].x || high.y < q->low[i].y || high.z < q->low[i].z ||
        beside(m, c, &of_c) || beside(c, m, &q->plane[i]))
      continue;
    met += meet(m, c);
  }
  return met;
}

static void search_triangle(search *q, uint32_t t) {
  const scree_halfmesh *s = q->s;
  const scree_half_edge *half = s->half + 3 * (size_t)t;
  for (int i = 0; i < 3; i++)
    if (half[i].from == q->ring->a || half[i].from == q->ring->b) return;
  corners c = corners_of(s, t);
  int after = count_met_after(q, &c);
  if (after > 0) {
    q->before += count_met_before(q, &c);
    q->after += after;
  }
  uint32_t chosen = planned_for(s, t, q->planned);
  if (chosen == SCREE_NONE || chosen == q->self) return;
  int moved = 0;
  for (size_t i = 0; i < 3; i++)
    if (q->planned->chosen[half[i].from] == chosen) {
      c.at[i] = q->planned->changes[chosen].target;
      c.name[i] = MOVED_OTHER;
      moved++;
    }
  if (moved == 1) q->after += count_met_after(q, &c);
}

/* Triangles of the ring that will meet each other beside their common corner and edges. */
static int count_own(const search *q) {
  int met = 0;
  for (uint32_t i = 0; i < q->ring->count; i++)
    for (uint32_t j = i + 1; j < q->ring->count; j++) met += meet(&q->moved[i], &q->moved[j]);
  return met;
}

/* Whether the ring as it will be, of which every triangle faces one direction, is a graph over the
 * plane across it: closed, and once around. An open fan may overlap itself; it is not asked. */
static bool is_graph(const search *q) {
  vec3 direction = scree_faced_direction(q->averse), center = q->moved[0].at[0];
  vec3 across = vec3_cross(direction, vec3_sub(q->moved[0].at[1], center));
  uint32_t ends = 0, turns = 0;
  for (uint32_t i = 0; i < q->ring->count; i++) {
    const corners *m = &q->moved[i];
    ends ^= m->name[1] ^ m->name[2];
    turns += vec3_dot(across, vec3_sub(m->at[1], center)) < 0 &&
             vec3_dot(across, vec3_sub(m->at[2], center)) >= 0;
  }
  return ends == 0 && turns == 1;
}

static void search_begin(search *q, const scree_grid *g, const scree_halfmesh *s,
                         const scree_ring *r, vec3 target, const scree_planned *planned) {
  q->grid = g;
  q->s = s;
  q->ring = r;
  q->planned = planned;
  q->self = planned ? planned->chosen[r->a] : SCREE_NONE;
  q->before = q->after = 0;
  q->averse = 0;
  for (uint32_t i = 0; i < r->count; i++) {
    q->moved[i] = ring_triangle(q, i);
    q->moved[i].name[0] = MOVED;
    q->moved[i].at[0] = target;
    const vec3 *at = q->moved[i].at;
    q->low[i] = vec3_min(at[0], vec3_min(at[1], at[2]));
    q->high[i] = vec3_max(at[0], vec3_max(at[1], at[2]));
    q->plane[i] = plane_of(at);
    q->averse |= scree_averse_to(q->grid, q->plane[i].n);
  }
  if (q->averse != SCREE_ALL_AVERSE && is_graph(q)) return;
  q->after = count_own(q);
  if (q->after == 0) return;
  for (uint32_t i = 0; i < r->count; i++)
    for (uint32_t j = i + 1; j < r->count; j++) {
      corners x = ring_triangle(q, i), y = ring_triangle(q, j);
      q->before += meet(&x, &y);
    }
}

/* Directions that triangle t does not face, now or as it will be. */
static uint64_t averse_with_plan(const search *q, uint32_t t) {
  const scree_half_edge *half = q->s->half + 3 * (size_t)t;
  uint32_t chosen = planned_for(q->s, t, q->planned);
  vec3 at[3];
  scree_corners(q->s, t, at);
  uint64_t averse = scree_averse_to(q->grid, vec3_triangle_normal(at[0], at[1], at[2]));
  if (chosen == SCREE_NONE) return averse;
  int moved = 0;
  for (int i = 0; i < 3; i++)
    if (q->planned->chosen[half[i].from] == chosen) {
      at[i] = q->planned->changes[chosen].target;
      moved++;
    }
  if (moved == 1) averse |= scree_averse_to(q->grid, vec3_triangle_normal(at[0], at[1], at[2]));
  return averse;
}

static bool beyond_ring(const scree_ring *r, vec3 low, vec3 high) {
  return low.x > r->high.x || low.y > r->high.y || low.z > r->high.z || high.x < r->low.x ||
         high.y < r->low.y || high.z < r->low.z;
}

/* What is done with a triangle about the ring; false: no more of them is asked for. */
typedef bool visitor(search *q, uint32_t t);

static bool visit_group(search *q, size_t group, visitor *visit) {
  size_t end = (group + 1) * SCREE_GROUP;
  if (end > q->s->triangle_count) end = q->s->triangle_count;
  for (size_t t = group * SCREE_GROUP; t < end; t++) {
    vec3 low, high;
    if (!box_with_plan(q->s, (uint32_t)t, q->planned, &low, &high) ||
        beyond_ring(q->ring, low, high))
      continue;
    if (!visit(q, (uint32_t)t)) return false;
  }
  return true;
}

/* Visits the triangles whose box, with what they will become, touches the ring's. */
static bool visit_near(search *q, const scree_grid_box *c, visitor *visit) {
  const scree_grid *g = q->grid;
  const scree_grid_box *joined = g->groups + g->group_count;
  for (size_t k = 0; k * GROUPS_JOINED < g->group_count; k++) {
    if (apart(&joined[k], c)) continue;
    size_t end = (k + 1) * GROUPS_JOINED;
    if (end > g->group_count) end = g->group_count;
    for (size_t i = k * GROUPS_JOINED; i < end; i++)
      if (!apart(&g->groups[i], c) && !visit_group(q, i, visit)) return false;
  }
  return true;
}

/* Leaves out the directions that the triangle does not face; false: none is left. */
static bool narrow(search *q, uint32_t t) {
  q->averse |= averse_with_plan(q, t);
  return q->averse != SCREE_ALL_AVERSE;
}

static bool test(search *q, uint32_t t) {
  search_triangle(q, t);
  return true;
}

static void search_lists(search *q, const scree_grid_box *c, const scree_grid_box *box) {
  const scree_grid *g = q->grid;
  const scree_ring *r = q->ring;
  vec3 low, high;
  SCREE_FOR_CELLS(g, *c, cell)
  for (uint32_t i = g->head[cell]; i != SCREE_NONE; i = g->items[i].next) {
    uint32_t t = g->items[i].triangle;
    /* a triangle may have shrunk since it was listed */
    if (apart(&g->items[i].box, box) || !box_with_plan(q->s, t, NULL, &low, &high) ||
        beyond_ring(r, low, high))
      continue;
    /* it is listed in several cells: the first that both boxes have decides */
    if (scree_cell_of(g, vec3_max(low, r->low)) == cell) search_triangle(q, t);
  }
}

static void search_all(search *q) {
  vec3 low, high;
  for (uint32_t t = 0; t < q->s->triangle_count; t++)
    if (box_with_plan(q->s, t, NULL, &low, &high) && !beyond_ring(q->ring, low, high))
      search_triangle(q, t);
}

bool scree_grid_clear_among(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                            vec3 target, const uint32_t *triangles, size_t count) {
  search q;
  search_begin(&q, g, s, r, target, NULL);
  for (size_t i = 0; i < count; i++)
    if (!scree_is_gone(s, triangles[i])) search_triangle(&q, triangles[i]);
  return q.after <= q.before;
}

bool scree_grid_clear(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                      vec3 target, const scree_planned *planned) {
  search q;
  search_begin(&q, g, s, r, target, planned);
  if (g->few) {
    search_all(&q);
    return q.after <= q.before;
  }
  scree_grid_box c = scree_cells_of(g, r->low, r->high);
  if (planned) {
    if (s->closed && q.averse != SCREE_ALL_AVERSE && visit_near(&q, &c, narrow)) return true;
    visit_near(&q, &c, test);
  } else {
    scree_grid_box box = coarse_box(g, r->low, r->high);
    for (size_t i = 0; i < g->large_count; i++)
      if (!scree_is_gone(s, g->large[i])) search_triangle(&q, g->large[i]);
    search_lists(&q, &c, &box);
  }
  return q.after <= q.before;
}

/* ---- The whole surface ---- */

/* Vertices or triangles that one thread looks at at a time. */
enum { SWEPT_AT_ONCE = 64 };

/* Whether every triangle at v faces one direction, once around it: then those that share it have no
 * more in common than they should. */
static bool fan_is_graph(const scree_grid *g, const scree_halfmesh *s, uint32_t v) {
  uint64_t averse = 0;
  uint32_t first = s->vertex[v].outgoing, h = first, turns = 0;
  vec3 center = s->vertex[v].at, edge = vec3_sub(s->vertex[scree_to(s, first)].at, center);
  do {
    vec3 at[3];
    scree_corners(s, h / 3, at);
    averse |= scree_averse_to(g, vec3_triangle_normal(at[0], at[1], at[2]));
    h = scree_turn(s, h);
  } while (h != SCREE_NONE && h != first);
  if (h == SCREE_NONE || averse == SCREE_ALL_AVERSE) return false;
  vec3 across = vec3_cross(scree_faced_direction(averse), edge);
  do {
    uint32_t next = scree_turn(s, h);
    double from = vec3_dot(across, vec3_sub(s->vertex[scree_to(s, h)].at, center)),
           to = vec3_dot(across, vec3_sub(s->vertex[scree_to(s, next)].at, center));
    turns += from < 0 && to >= 0;
    h = next;
  } while (h != first);
  return turns == 1;
}

/* Whether the two surely have no more in common than vertices that they share. */
static bool are_apart(const scree_halfmesh *s, const bool *graph, uint32_t t, uint32_t u) {
  for (uint32_t i = 3 * t; i < 3 * t + 3; i++)
    for (uint32_t j = 3 * u; j < 3 * u + 3; j++)
      if (s->half[i].from == s->half[j].from && graph[s->half[i].from]) return true;
  corners x = corners_of(s, t), y = corners_of(s, u);
  plane of_x = plane_of(x.at), of_y = plane_of(y.at);
  return beside(&x, &y, &of_y) || beside(&y, &x, &of_x) || !meet(&x, &y);
}

static int by_low(const void *a, const void *b) {
  const scree_swept *x = a, *y = b;
  if (x->low.x != y->low.x) return x->low.x < y->low.x ? -1 : 1;
  return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

/* The search for two triangles that meet. */
typedef struct sweep {
  const scree_grid *grid;
  const scree_halfmesh *s;
  bool *graph;
  const scree_swept *swept;
  size_t count;
  atomic_bool met;
} sweep;

static void graph_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const sweep *q = context;
  for (size_t v = begin; v < end; v++)
    q->graph[v] =
        q->s->vertex[v].outgoing != SCREE_NONE && fan_is_graph(q->grid, q->s, (uint32_t)v);
}

/* Each with those that begin where it has not ended. */
static void sweep_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  sweep *q = context;
  for (size_t i = begin; i < end && !q->met; i++) {
    const scree_swept *a = &q->swept[i], *last = q->swept + q->count;
    for (const scree_swept *b = a + 1; b < last && b->low.x <= a->high.x; b++) {
      if (b->low.y > a->high.y || b->low.z > a->high.z || b->high.y < a->low.y ||
          b->high.z < a->low.z || are_apart(q->s, q->graph, a->triangle, b->triangle))
        continue;
      q->met = true;
      return;
    }
  }
}

bool scree_grid_clear_all(const scree_grid *g, const scree_halfmesh *s, bool *graph,
                          scree_swept *swept) {
  size_t count = 0;
  sweep q = {.grid = g, .s = s, .graph = graph, .swept = swept};
  scree_parallel_for(s->vertex_count, SWEPT_AT_ONCE, graph_block, &q);
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    swept[count].triangle = t;
    triangle_box(s, t, &swept[count].low, &swept[count].high);
    count++;
  }
  qsort(swept, count, sizeof *swept, by_low);
  q.count = count;
  scree_parallel_for(count, SWEPT_AT_ONCE, sweep_block, &q);
  return !q.met;
}
