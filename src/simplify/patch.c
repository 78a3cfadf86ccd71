/* A pass over patches evaluates every edge of some of them but those of borders, keeps the cheapest
 * of each vertex, and sets a threshold of cost, as a pass of batches does. Then patch by patch it
 * does so once more, and rounds follow: the candidates below the threshold are gone through in the
 * order of cost, and those that are independent (batch.c) of what was taken before are done, one
 * after the other; what is left over is evaluated once more for the next round. All that is done
 * with a patch is done at once, while it is in the cache; method `volume` has the sums of its
 * vertices for so long only, for they would be a quarter of all memory.
 *
 * Does a collapse make the surface run into itself? Every cell of the grid has a set of directions
 * which all triangles in it faced, by a margin, when the grid was built, and which all that come to
 * lie in it must still face. That asks for nothing that changes meanwhile; and where one direction
 * is in the sets of all cells about a collapse, it has the certificate of grid.h whatever else is
 * done, before or after.
 *
 * Where a scan is so fine that its noise faces every way, that decides little. Then cells have
 * owners instead: those whose triangles, as a pass begins, are all one patch's alone (own.h); one
 * without surface is its around which nothing else lies. A collapse must lie in its patch's cells,
 * now and as it will be. So nothing that another thread does comes there, and the patch's triangles
 * alone are searched. Vertices beside foreign cells are borders as well.
 *
 * Other collapses wait for the batches. */
#include "simplify/patch.h"

#include "base/parallel.h"
#include "base/radix.h"
#include "simplify/cheapest.h"
#include "simplify/limit.h"
#include "simplify/order.h"
#include "simplify/own.h"

/* Rounds of a pass, and the share of the patch's vertices below which a round takes too few to go
 * on. */
enum { ROUNDS = 8 };
#define FEW 0.01
/* A pass that takes less than this share of the triangles is the last; one that takes less than the
 * second while cells have directions, the last with these. */
#define LITTLE     0.05
#define TOO_LITTLE 0.15
/* Passes go on while the levels are fine (cheapest.h), or of more triangles than this: batches of
 * so many wait for memory. */
enum { MANY = 400000 };
/* Room for a patch's own triangles, for each of its vertices. */
enum { OWN_ROOM = 3 };
/* The threshold comes from one in so many patches; from more, where that would be fewer than so
 * many. */
enum { SAMPLE_STRIDE = 8, LEAST_SAMPLES = 8 };
enum { WALK_BLOCK = 1 << 12 };
/* Of the curve: steps along an axis, and of them those by which it may be shifted. */
enum { AXIS_BITS = 7, STEPS = 1 << AXIS_BITS, SHIFT = STEPS / 4 };

/* What the record will have of a collapse, and its cost. */
typedef struct deed {
  vec3 position;       /* metres */
  double area, volume; /* unit box */
  uint32_t kept, gone; /* vertices of the mesh given */
  float error;
  double cost;
} deed;

/* What was done in a patch, round by round; later where the record's order begins with it. */
typedef struct doings {
  uint32_t counts[ROUNDS], places[ROUNDS];
  double moves; /* the sum of the roots of their mean square moves */
} doings;

typedef struct work work;

typedef struct patching {
  scree_cheapest e;
  scree_decimator *d;
  size_t patch, passes; /* vertices of a patch; passes until now */
  size_t stride;        /* of those sampled */
  double usual2;        /* squared stray that no collapse of this pass may exceed */
  uint16_t *own_place;  /* while cells have owners: per triangle of a patch, its place; or NULL */
  scree_frame_of_places frame;
  uint32_t *members;  /* the vertices, patch by patch */
  uint32_t *place_of; /* per vertex: its place among them */
  uint8_t *marks;     /* per vertex: TOUCHED, APEX */
  deed *deeds;        /* those of a patch from half the place of its first member on */
  doings *doings;     /* per patch */
  work *works;        /* per worker */
} patching;

/* TOUCHED: an end of one taken in this round, or a neighbour of one. APEX: of one taken. */
enum { TOUCHED = 1, APEX = 2 };

/* One taken: its ring's triangles are in work.edges. */
typedef struct taken {
  uint32_t half_edge, first_edge, a_count, count;
} taken;

/* What a worker needs for a patch. */
struct work {
  patching *p;
  scree_cheapest e;   /* that of all, with this surface */
  scree_halfmesh s;   /* that of all, with sums of the patch, unless the method keeps them */
  double (*sums)[10]; /* room */
  const uint32_t *members;
  size_t member_count;
  deed *deeds;
  size_t deed_count, room;
  scree_keyed *candidates, *swap;
  size_t count;
  taken *taken;
  size_t taken_count;
  uint32_t *edges;
  size_t edge_count, edge_room;
  scree_own own; /* while cells have owners: of the patch */
  size_t patch;  /* which */
};

static size_t patch_count(const patching *p) {
  return scree_block_count(p->d->s.vertex_count, p->patch);
}

/* Where the box lies on the curve: elsewhere from pass to pass (the powers of the root of x^4 = x +
 * 1 fill the cube evenly), by up to a quarter of the curve's cube. */
static vec3 shift_of(size_t passes) {
  const double root = 1.22074408460575947536, at = (double)passes;
  vec3 turns = {at / root, at / (root * root), at / (root * root * root)};
  return (vec3){SHIFT * (turns.x - floor(turns.x)), SHIFT * (turns.y - floor(turns.y)),
                SHIFT * (turns.z - floor(turns.z))};
}

typedef struct sorting {
  const patching *p;
  vec3 shift;
  scree_keyed *items;
} sorting;

static void code_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const sorting *c = context;
  for (size_t v = begin; v < end; v++) {
    vec3 steps = scree_frame_steps(&c->p->frame, STEPS - SHIFT, c->p->d->s.vertex[v].at);
    c->items[v] = (scree_keyed){scree_morton_code(vec3_add(steps, c->shift)), (uint32_t)v};
  }
}

static void member_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const sorting *c = context;
  for (size_t i = begin; i < end; i++) {
    uint32_t v = c->items[i].index;
    c->p->members[i] = v;
    c->p->place_of[v] = (uint32_t)i;
  }
}

/* Which vertices are in which patch. There is room for sorting where the deeds will be. */
static void find_members(const patching *p) {
  size_t count = p->d->s.vertex_count;
  sorting c = {p, shift_of(p->passes), (scree_keyed *)p->deeds};
  scree_parallel_for(count, WALK_BLOCK, code_block, &c);
  c.items = scree_radix_sort(c.items, c.items + count, count, 3 * AXIS_BITS);
  scree_parallel_for(count, WALK_BLOCK, member_block, &c);
}

static bool is_border(const patching *p, uint32_t v) {
  const scree_halfmesh *s = &p->d->s;
  uint32_t h = s->vertex[v].outgoing, stop = h;
  size_t patch = p->place_of[v] / p->patch;
  bool border = s->flags[v] & SCREE_VERTEX_ANCHOR; /* others read where it is */
  do {
    border |= p->place_of[scree_to(s, h)] / p->patch != patch;
    h = scree_turn(s, h);
  } while (h != stop);
  return border;
}

/* Asks for the patch's vertices, and for the triangles around them. */
SCREE_PREFETCHES void ask_for_members(const work *w) {
  const scree_halfmesh *s = &w->s;
  for (size_t i = 0; i < w->member_count; i++) __builtin_prefetch(&s->vertex[w->members[i]]);
  for (size_t i = 0; i < w->member_count; i++) {
    uint32_t h = s->vertex[w->members[i]].outgoing;
    if (h != SCREE_NONE) __builtin_prefetch(&s->half[h]);
  }
}

/* Makes patch k the worker's. */
static void enter_patch(work *w, size_t k) {
  const patching *p = w->p;
  size_t first = k * p->patch, left = p->d->s.vertex_count - first;
  w->members = p->members + first;
  w->member_count = left < p->patch ? left : p->patch;
  w->patch = k;
  w->deeds = p->deeds + first / 2;
  w->room = w->member_count / 2;
  w->s = p->d->s;
  w->e = p->e;
  w->e.s = &w->s;
  if (p->d->coster->merge) return;
  w->s.sums = w->sums;
  w->s.slot = p->place_of;
  w->s.first_slot = (uint32_t)first;
}

/* Finds the border, and the sums of the other vertices. */
static void sum_patch(work *w) {
  scree_halfmesh *s = &w->s;
  ask_for_members(w);
  for (size_t i = 0; i < w->member_count; i++) {
    uint32_t v = w->members[i];
    s->flags[v] &= (uint8_t)~SCREE_VERTEX_BORDER;
    if (s->vertex[v].outgoing == SCREE_NONE) continue;
    if (is_border(w->p, v) ||
        (w->p->own_place && !scree_grid_owns_fan(&w->p->d->grid, s, v, w->patch)))
      s->flags[v] |= SCREE_VERTEX_BORDER;
  }
  for (size_t i = 0; i < w->member_count && !w->p->d->coster->merge; i++) {
    uint32_t v = w->members[i];
    if (s->vertex[v].outgoing == SCREE_NONE || s->flags[v] & SCREE_VERTEX_BORDER) continue;
    w->p->d->coster->sum(s, v);
    s->flags[v] &= (uint8_t)~SCREE_VERTEX_STALE;
  }
}

/* A block is one of the patches sampled. */
static void sample_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)block;
  patching *p = context;
  work *w = &p->works[worker];
  enter_patch(w, begin * p->stride);
  sum_patch(w);
  scree_cheapest_find_of(&w->e, w->members, w->member_count);
}

/* Of the patches that are not sampled no vertex has a cost. */
static void clear_costs(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const patching *p = context;
  for (size_t v = begin; v < end; v++) p->e.cost[v] = INFINITY;
}

/* Sets the threshold; false: there is nothing to collapse. */
static bool sample(patching *p) {
  size_t patches = patch_count(p);
  p->stride = patches / LEAST_SAMPLES;
  if (p->stride > SAMPLE_STRIDE) p->stride = SAMPLE_STRIDE;
  if (p->stride < 1) p->stride = 1;
  scree_parallel_for(p->d->s.vertex_count, WALK_BLOCK, clear_costs, p);
  scree_parallel_for(scree_block_count(patches, p->stride), 1, sample_block, p);
  return scree_cheapest_set_limit(&p->e);
}

static bool is_marked(const patching *p, const scree_ring *r) {
  return ((p->marks[r->a] | p->marks[r->b]) & TOUCHED) | ((p->marks[r->c] | p->marks[r->d]) & APEX);
}

static void mark(const patching *p, const scree_ring *r) {
  const scree_halfmesh *s = &p->d->s;
  p->marks[r->a] |= TOUCHED;
  p->marks[r->b] |= TOUCHED;
  p->marks[r->c] |= APEX;
  p->marks[r->d] |= APEX;
  for (uint32_t i = 0; i < r->count; i++) {
    p->marks[s->half[r->edge[i]].from] |= TOUCHED;
    p->marks[scree_to(s, r->edge[i])] |= TOUCHED;
  }
}

static double cost_of_vertex(const void *context, uint32_t v) {
  return ((const scree_cheapest *)context)->cost[v];
}

/* Goes through the candidates in the order of cost and takes what is independent; the others are
 * left. */
static void choose(work *w) {
  patching *p = w->p;
  scree_halfmesh *s = &w->s;
  scree_keyed *sorted = scree_radix_sort(w->candidates, w->swap, w->count, 32);
  size_t left = 0;
  scree_refine_order(sorted, w->count, cost_of_vertex, &p->e);
  if (sorted != w->candidates) {
    w->swap = w->candidates;
    w->candidates = sorted;
  }
  for (size_t i = 0; i < w->member_count; i++) p->marks[w->members[i]] = 0;
  w->taken_count = w->edge_count = 0;
  for (size_t i = 0; i < w->count; i++) {
    uint32_t h = p->e.best[sorted[i].index];
    scree_ring r = {.edge = w->edges + w->edge_count};
    scree_ring_name(s, h, &r);
    bool full =
        w->edge_count + SCREE_RING_MAX > w->edge_room || w->deed_count + w->taken_count == w->room;
    if (is_marked(p, &r) || full) {
      sorted[left++] = sorted[i];
      continue;
    }
    if (!scree_ring_gather(s, h, &r)) {
      s->refused[h] = SCREE_EDGE_REFUSED;
      continue;
    }
    mark(p, &r);
    w->taken[w->taken_count++] = (taken){h, (uint32_t)w->edge_count, r.a_count, r.count};
    w->edge_count += r.count;
  }
  w->count = left;
}

/* Whether the surface surely meets itself no more by it. */
static bool is_clear(const work *w, const scree_ring *ring, vec3 target,
                     const scree_around *around) {
  const scree_decimator *d = w->p->d;
  if (!w->p->own_place) return scree_grid_keeps(&d->grid, &d->s, ring, target, around);
  return scree_grid_owns(&d->grid, &d->s, ring, target, w->patch) &&
         scree_own_clear(&w->own, &d->grid, &d->s, ring, target, around);
}

/* 0, or why the collapse is not done. */
static uint8_t refusal(const work *w, scree_ring *ring, const scree_candidate *candidate,
                       scree_change *change) {
  const patching *p = w->p;
  const scree_decimator *d = p->d;
  scree_around around;
  if (!scree_collapse_keeps_topology(&d->s, ring) ||
      !scree_collapse_check(&d->s, ring, SCREE_LEAST_TURN, change, &around))
    return SCREE_EDGE_REFUSED;
  if (scree_strays(d, ring, candidate, p->e.limit, p->usual2)) return SCREE_EDGE_POSTPONED;
  if (!is_clear(w, ring, change->target, &around) ||
      !scree_anchors_stay(&d->anchors, &d->s, ring, change->target))
    return SCREE_EDGE_POSTPONED;
  return 0;
}

static void set_flags(scree_halfmesh *s, const scree_ring *r) {
  const uint8_t flags = SCREE_VERTEX_STALE | SCREE_VERTEX_CHANGED;
  s->flags[r->a] |= flags;
  for (uint32_t e = 0; e < r->count; e++) {
    s->flags[s->half[r->edge[e]].from] |= flags;
    s->flags[scree_to(s, r->edge[e])] |= flags;
  }
}

static void carry_out(work *w, const scree_ring *ring, const scree_candidate *candidate,
                      const scree_change *change) {
  const scree_decimator *d = w->p->d;
  scree_halfmesh *s = &w->s;
  w->deeds[w->deed_count++] = (deed){.position = vec3_mad(s->centre, change->target, s->scale),
                                     .area = change->area,
                                     .volume = change->volume,
                                     .kept = s->vertex[ring->a].origin,
                                     .gone = s->vertex[ring->b].origin,
                                     .error = (float)candidate->error,
                                     .cost = w->p->e.cost[ring->a]};
  uint32_t gone[] = {ring->half_edge / 3, s->half[ring->half_edge].twin / 3};
  scree_collapse_apply(s, ring, change->target);
  if (w->p->own_place) scree_own_follow(&w->own, &d->grid, s, ring, gone, w->p->own_place);
  if (d->coster->merge) d->coster->merge(s, ring->a, ring->b);
  set_flags(s, ring);
}

/* Does what was taken; answers how much of it. */
static size_t do_taken(work *w) {
  scree_halfmesh *s = &w->s;
  size_t before = w->deed_count;
  uint32_t edges[SCREE_SIDE_BY_SIDE];
  scree_candidate candidates[SCREE_SIDE_BY_SIDE];
  for (size_t begin = 0, count; begin < w->taken_count; begin += count) {
    count =
        w->taken_count - begin < SCREE_SIDE_BY_SIDE ? w->taken_count - begin : SCREE_SIDE_BY_SIDE;
    for (size_t i = 0; i < count; i++) edges[i] = w->taken[begin + i].half_edge;
    w->p->d->coster->evaluate(s, edges, count, candidates);
    for (size_t i = 0; i < count; i++) {
      const taken *t = &w->taken[begin + i];
      scree_ring ring = {
          .edge = w->edges + t->first_edge, .a_count = t->a_count, .count = t->count};
      scree_change change = {.target = candidates[i].target};
      scree_ring_name(s, t->half_edge, &ring);
      uint8_t refused = refusal(w, &ring, &candidates[i], &change);
      if (refused)
        s->refused[t->half_edge] = refused;
      else
        carry_out(w, &ring, &candidates[i], &change);
    }
  }
  /* Where cells have owners a collapse may be clear for those before it only. Of many equally dear
   * the order is not that of the rest of their costs: the record must not find another one. */
  for (size_t i = before + 1; i < w->deed_count; i++)
    w->deeds[i].cost = fmax(w->deeds[i].cost, w->deeds[i - 1].cost);
  return w->deed_count - before;
}

static void refresh(work *w, uint32_t v) {
  scree_halfmesh *s = &w->s;
  if (!(s->flags[v] & SCREE_VERTEX_STALE) || w->p->d->coster->merge) return;
  w->p->d->coster->sum(s, v);
  s->flags[v] &= (uint8_t)~SCREE_VERTEX_STALE;
}

/* Puts the vertex among the candidates, if it is one. */
static void enlist(work *w, uint32_t v) {
  const scree_cheapest *e = &w->e;
  if (e->cost[v] <= e->limit)
    w->candidates[w->count++] = (scree_keyed){scree_key_of(e->cost[v]), v};
}

/* What is left costs something else where triangles have changed; what is gone or dear now is
 * dropped. */
static void reconsider(work *w) {
  const patching *p = w->p;
  const scree_halfmesh *s = &w->s;
  uint32_t edges[SCREE_SIDE_BY_SIDE], waiting = 0;
  size_t left = 0;
  for (size_t i = 0; i < w->count; i++) {
    uint32_t v = w->candidates[i].index, h = p->e.best[v];
    if (s->vertex[v].outgoing == SCREE_NONE || s->half[h].from != v || s->refused[h]) continue;
    uint32_t other = scree_to(s, h);
    w->candidates[left++].index = v;
    if (!((s->flags[v] | s->flags[other]) & SCREE_VERTEX_CHANGED)) continue;
    refresh(w, v);
    refresh(w, other);
    edges[waiting++] = h;
    if (waiting < SCREE_SIDE_BY_SIDE) continue;
    scree_cheapest_renew(&w->e, edges, waiting);
    waiting = 0;
  }
  scree_cheapest_renew(&w->e, edges, waiting);
  w->count = 0;
  for (size_t i = 0; i < left; i++) enlist(w, w->candidates[i].index);
}

/* Lists the triangles that are the patch's alone, at their first corners among its members, and so
 * in an order in which they lie near each other. False: they are too many. */
static bool list_own(work *w) {
  const patching *p = w->p;
  const scree_halfmesh *s = &w->s;
  scree_own *own = &w->own;
  own->count = 0;
  for (size_t i = 0; i < w->member_count; i++) {
    uint32_t first = s->vertex[w->members[i]].outgoing, h = first;
    size_t place = w->patch * p->patch + i;
    if (h == SCREE_NONE) continue;
    do {
      size_t b = p->place_of[scree_to(s, h)], c = p->place_of[s->half[scree_previous(h)].from];
      if (b > place && c > place && b / p->patch == w->patch && c / p->patch == w->patch) {
        if (own->count == own->room) return false;
        own->triangles[own->count++] = h / 3;
      }
      h = scree_turn(s, h);
    } while (h != first);
  }
  return true;
}

static void decimate_patch(work *w, doings *done) {
  patching *p = w->p;
  *done = (doings){.moves = 0};
  if (p->own_place) {
    if (!list_own(w)) return;
    scree_own_enter(&w->own, &p->d->grid, &w->s, p->own_place);
  }
  w->count = w->deed_count = 0;
  for (size_t i = 0; i < w->member_count; i++) {
    p->d->s.flags[w->members[i]] &= (uint8_t)~SCREE_VERTEX_CHANGED;
    enlist(w, w->members[i]);
  }
  double few = FEW * (double)w->member_count;
  for (int round = 0; round < ROUNDS; round++) {
    if (round > 0) reconsider(w);
    choose(w);
    done->counts[round] = (uint32_t)do_taken(w);
    if (done->counts[round] < few) break;
  }
  for (size_t i = 0; i < w->deed_count; i++) done->moves += sqrt((double)w->deeds[i].error);
}

/* A block is a patch. */
static void decimate_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)block;
  patching *p = context;
  work *w = &p->works[worker];
  enter_patch(w, begin);
  sum_patch(w);
  if (begin % p->stride != 0) /* else that is known */
    scree_cheapest_find_of(&w->e, w->members, w->member_count);
  decimate_patch(w, &p->doings[begin]);
}

static double cost_of_deed(const void *context, uint32_t index) {
  return ((const patching *)context)->deeds[index].cost;
}

/* The deeds in the order of the record: round by round, by cost. */
typedef struct writing {
  const patching *p;
  scree_keyed *items, *swap;
} writing;

static void list_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)block, (void)worker;
  const writing *w = context;
  const doings *done = &w->p->doings[begin];
  uint32_t index = (uint32_t)(begin * w->p->patch / 2);
  for (int round = 0; round < ROUNDS; round++)
    for (uint32_t i = 0; i < done->counts[round]; i++, index++)
      w->items[done->places[round] + i] =
          (scree_keyed){scree_key_of(w->p->deeds[index].cost), index};
}

static void write_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const writing *w = context;
  scree_record *r = &w->p->d->record;
  for (size_t i = begin; i < end; i++) {
    const deed *from = &w->p->deeds[w->items[i].index];
    size_t at = r->count + i;
    r->kept[at] = from->kept;
    r->gone[at] = from->gone;
    r->position[at] = from->position;
    r->area[at] = from->area;
    r->volume[at] = from->volume;
    r->error[at] = from->error;
  }
}

/* Enters in the record what was done, merged: what a patch did in a round is in the order of
 * cost. */
static scree_status write_deeds(patching *p, size_t *done) {
  scree_decimator *d = p->d;
  size_t patches = patch_count(p), ends[ROUNDS];
  writing w = {.p = p};
  scree_status status = SCREE_OUT_OF_MEMORY;
  double moves = 0;
  *done = 0;
  for (int round = 0; round < ROUNDS; round++) {
    for (size_t k = 0; k < patches; k++) {
      p->doings[k].places[round] = (uint32_t)*done;
      *done += p->doings[k].counts[round];
    }
    ends[round] = *done;
  }
  for (size_t k = 0; k < patches; k++) moves += p->doings[k].moves;
  if (*done == 0) return SCREE_OK;
  SCREE_ALLOC_OR(w.items, *done, d->error, finished);
  SCREE_ALLOC_OR(w.swap, *done, d->error, finished);
  scree_parallel_for(patches, 1, list_block, &w);
  for (int round = 0; round < ROUNDS; round++) {
    size_t begin = round > 0 ? ends[round - 1] : 0, count = ends[round] - begin;
    scree_keyed *sorted = scree_radix_sort(w.items + begin, w.swap + begin, count, 32);
    scree_refine_order(sorted, count, cost_of_deed, p);
    if (sorted != w.items + begin) memcpy(w.items + begin, sorted, count * sizeof *sorted);
  }
  scree_parallel_for(*done, WALK_BLOCK, write_block, &w);
  d->mean_move = moves / (double)*done;
  d->record.count += *done;
  d->s.live_vertex_count -= *done;
  d->s.live_triangle_count -= 2 * *done;
  scree_limits_follow(d, 2 * (double)*done / (double)d->s.live_triangle_count);
  status = SCREE_OK;
finished:
  scree_free(w.items);
  scree_free(w.swap);
  return status;
}

static void end_owning(patching *p) {
  for (int i = 0; p->works && i < scree_worker_count(); i++) scree_own_free(&p->works[i].own);
  scree_free(p->own_place);
  p->own_place = NULL;
}

/* Directions say too little: cells have owners from now on. */
static scree_status begin_owning(patching *p) {
  scree_decimator *d = p->d;
  scree_status status = SCREE_OK;
  d->lenient = 0; /* it was not the stray */
  SCREE_ALLOC_OR(p->own_place, d->s.triangle_count, d->error, out_of_memory);
  for (int i = 0; i < scree_worker_count() && status == SCREE_OK; i++)
    status = scree_own_allocate(&p->works[i].own, OWN_ROOM * p->patch, d->error);
  return status;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static scree_status prepare_grid(patching *p) {
  scree_decimator *d = p->d;
  size_t count = d->s.live_triangle_count;
  if (d->grid.built_for && (double)count > SCREE_REGRID_BELOW * (double)d->grid.built_for)
    return SCREE_OK; /* directions entered hold for all that was done since */
  scree_status status =
      scree_grid_shape_in(&d->grid, &d->s, &p->frame, SCREE_EDGES_PER_CELL, d->error);
  if (status == SCREE_OK && !p->own_place) scree_grid_enter_roomy(&d->grid, &d->s);
  return status;
}

static scree_status run_pass(patching *p, size_t *done) {
  scree_decimator *d = p->d;
  *done = 0;
  scree_status status = prepare_grid(p);
  if (status == SCREE_OK) status = scree_anchors_find(&d->s, &d->anchors, d->error);
  if (status != SCREE_OK) return status;
  find_members(p);
  if (p->own_place) scree_grid_enter_owners(&d->grid, &d->s, p->place_of, p->patch);
  if (!sample(p)) return SCREE_OK;
  p->usual2 = scree_usual_stray2(d);
  scree_parallel_for(patch_count(p), 1, decimate_block, p);
  status = write_deeds(p, done);
  if (status != SCREE_OK) return status;
  scree_halfmesh_compact(&d->s, (uint32_t *)p->e.cost, (uint32_t *)p->deeds);
  scree_halfmesh_give_back(&d->s);
  p->passes++;
  return SCREE_OK;
}

static void patching_free(patching *p) {
  end_owning(p);
  scree_cheapest_free(&p->e);
  scree_free(p->members);
  scree_free(p->place_of);
  scree_free(p->marks);
  scree_free(p->deeds);
  scree_free(p->doings);
  for (int i = 0; p->works && i < scree_worker_count(); i++) {
    scree_free(p->works[i].sums);
    scree_free(p->works[i].candidates);
    scree_free(p->works[i].swap);
    scree_free(p->works[i].taken);
    scree_free(p->works[i].edges);
  }
  scree_free(p->works);
}

static scree_status patching_allocate(patching *p) {
  scree_error *error = p->d->error;
  size_t n = p->d->s.vertex_count;
  if (scree_cheapest_allocate(&p->e, p->d) != SCREE_OK) return SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(p->members, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->place_of, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->marks, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->deeds, n / 2 + 1, error, out_of_memory);
  SCREE_ALLOC_OR(p->doings, n / p->patch + 1, error, out_of_memory);
  SCREE_ALLOC_OR(p->works, (size_t)scree_worker_count(), error, out_of_memory);
  memset(p->works, 0, (size_t)scree_worker_count() * sizeof *p->works);
  for (int i = 0; i < scree_worker_count(); i++) {
    work *w = &p->works[i];
    w->p = p;
    w->edge_room = 3 * p->patch + SCREE_RING_MAX;
    if (!p->d->coster->merge) SCREE_ALLOC_OR(w->sums, p->patch, error, out_of_memory);
    SCREE_ALLOC_OR(w->candidates, p->patch, error, out_of_memory);
    SCREE_ALLOC_OR(w->swap, p->patch, error, out_of_memory);
    SCREE_ALLOC_OR(w->taken, p->patch, error, out_of_memory);
    SCREE_ALLOC_OR(w->edges, w->edge_room, error, out_of_memory);
  }
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static bool goes_on(const scree_decimator *d) {
  size_t count = d->s.live_triangle_count;
  return d->s.closed && (scree_is_fine(d) || count > MANY) && count > d->options.stop_count;
}

scree_status scree_decimate_in_patches(scree_decimator *d, size_t patch) {
  patching p = {.d = d, .patch = patch};
  if (!goes_on(d)) return SCREE_OK;
  const scree_halfmesh *s = &d->s;
  scree_places places = {&s->vertex->at.x, sizeof *s->vertex / sizeof(double), s->vertex_count};
  scree_status status =
      scree_frame_find(&places, vec3_scale(vec3_add(s->low, s->high), 0.5), &p.frame, d->error);
  if (status == SCREE_OK && d->coster->merge) status = scree_decimate_sum(d);
  if (status == SCREE_OK) status = patching_allocate(&p);
  bool little = false;
  while (status == SCREE_OK && !little && goes_on(d)) {
    size_t before = d->s.live_triangle_count, done;
    status = scree_decimate_tick(d, &d->ticker) ? run_pass(&p, &done) : SCREE_CANCELLED;
    if (status != SCREE_OK) break;
    double share = 2 * (double)done / (double)before;
    if (!p.own_place && share < TOO_LITTLE)
      status = begin_owning(&p);
    else
      little = share < LITTLE;
  }
  for (size_t v = 0; v < d->s.vertex_count; v++) d->s.flags[v] &= (uint8_t)~SCREE_VERTEX_BORDER;
  scree_grid_free(&d->grid); /* its frame is ours */
  patching_free(&p);
  return status;
}
