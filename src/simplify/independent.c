#include "simplify/independent.h"

#include "base/parallel.h"
#include "base/prefetch.h"

#include <string.h>

enum { BLOCK = SCREE_CHOICE_BLOCK, AHEAD = 8 };

/* TOUCHED: an end of one taken, or a neighbour of one. APEX: of one taken. GONE: its own candidate
 * is out of the race. */
enum { TOUCHED = 1, APEX = 2, GONE = 4 };

/* Whether candidate u goes before v. Along a regular grid equal costs in the order of the vertices
 * would make each wait for the one before. */
static bool goes_before(const scree_choosing *c, uint32_t u, uint32_t v) {
  if (c->cost[u] != c->cost[v]) return c->cost[u] < c->cost[v];
  const uint32_t scatter = 0x9e3779b1u; /* odd: a bijection */
  return u * scatter < v * scatter;
}

/* Who sees a claim sees the cost of its candidate, which may have been found just before. */
static void claim(const scree_choosing *c, uint32_t *leader, uint32_t v) {
  uint32_t found = __atomic_load_n(leader, __ATOMIC_ACQUIRE);
  while (found == SCREE_NONE || goes_before(c, v, found))
    if (__atomic_compare_exchange_n(leader, &found, v, true, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE))
      return;
}

static void set_mark(scree_choosing *c, uint32_t v, uint8_t mark) {
  if (!(__atomic_load_n(&c->marks[v], __ATOMIC_RELAXED) & mark))
    __atomic_fetch_or(&c->marks[v], mark, __ATOMIC_RELAXED);
}

/* Whether what was taken leaves it in question. */
static bool is_open(const scree_choosing *c, const scree_contender *e) {
  uint32_t d = e->d == SCREE_NONE ? e->c : e->d;
  return !((c->marks[e->a] & (TOUCHED | GONE)) | (c->marks[e->b] & TOUCHED) |
           ((c->marks[e->c] | c->marks[d]) & APEX));
}

SCREE_PREFETCHES void ask_for_claims(const scree_choosing *c, const scree_contender *e) {
  __builtin_prefetch(&c->leader[e->b], 1);
  __builtin_prefetch(&c->apex_leader[e->c], 1);
  if (e->d != SCREE_NONE) __builtin_prefetch(&c->apex_leader[e->d], 1);
}

static void claim_all(const scree_choosing *c, const scree_contender *e) {
  claim(c, &c->leader[e->a], e->a);
  claim(c, &c->leader[e->b], e->a);
  claim(c, &c->apex_leader[e->c], e->a);
  if (e->d != SCREE_NONE) claim(c, &c->apex_leader[e->d], e->a);
}

void scree_choose_enter(const scree_choosing *c, size_t block) {
  struct scree_choice_count count = c->counts[block];
  const scree_contender *contenders = c->contenders + block * BLOCK + count.waiting;
  for (uint32_t i = 0; i < count.left; i++) claim_all(c, &contenders[i]);
}

/* Those still in question claim their ends and apexes, the others are dropped. */
static void claim_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)worker;
  scree_choosing *c = context;
  scree_contender *contenders = c->contenders + begin + c->counts[block].waiting;
  uint32_t kept = 0, count = c->counts[block].left;
  for (uint32_t i = 0; i < count;
       i++) { /* without branches, for who is open is as good as random */
    contenders[kept] = contenders[i];
    kept += is_open(c, &contenders[i]);
  }
  for (uint32_t i = 0; i < kept; i++) {
    if (i + AHEAD < kept) ask_for_claims(c, &contenders[i + AHEAD]);
    claim_all(c, &contenders[i]);
  }
  c->counts[block].left = kept;
}

static bool leads_at(const scree_choosing *c, uint32_t v, uint32_t at) {
  uint32_t leader = c->leader[at];
  return leader == v || leader == SCREE_NONE || goes_before(c, v, leader);
}

enum { LOSES, LEADS, UNFINISHED, TOO_LONG };

/* Lists the triangles around one end of the edge of h, from h to `stop`, while it leads at their
 * corners. UNFINISHED: at a boundary, or the ring is too long. */
static int gather_side(const scree_choosing *c, uint32_t v, uint32_t h, uint32_t stop,
                       scree_ring *r) {
  const scree_halfmesh *s = c->s;
  while ((h = scree_turn(s, h)) != stop) {
    if (h == SCREE_NONE || r->count == SCREE_RING_MAX) return UNFINISHED;
    uint32_t across = scree_next(h);
    if (!leads_at(c, v, s->half[across].from)) return LOSES;
    r->edge[r->count++] = across;
  }
  return LEADS;
}

/* The same for any ring, at more cost. */
static int gather_open(const scree_choosing *c, uint32_t v, scree_ring *r) {
  const scree_halfmesh *s = c->s;
  if (!scree_ring_gather(s, c->best[v], r)) return TOO_LONG;
  for (uint32_t i = 0; i < r->count; i++)
    if (!leads_at(c, v, s->half[r->edge[i]].from) || !leads_at(c, v, scree_to(s, r->edge[i])))
      return LOSES;
  return LEADS;
}

/* Whether the candidate leads wherever it must; then its ring is gathered. */
static int leads(const scree_choosing *c, const scree_contender *e, scree_ring *r) {
  const scree_halfmesh *s = c->s;
  uint32_t v = e->a, h = c->best[v];
  if (c->leader[v] != v || c->leader[e->b] != v || c->apex_leader[e->c] != v ||
      (e->d != SCREE_NONE && c->apex_leader[e->d] != v) || !leads_at(c, v, e->c))
    return LOSES;
  if (e->d == SCREE_NONE) return gather_open(c, v, r);
  if (!leads_at(c, v, e->d)) return LOSES;
  uint32_t twin = s->half[h].twin;
  r->count = 0;
  int side = gather_side(c, v, h, scree_next(twin), r);
  r->a_count = r->count;
  if (side == LEADS) side = gather_side(c, v, twin, scree_next(h), r);
  return side == UNFINISHED ? gather_open(c, v, r) : side;
}

static void touch(scree_choosing *c, const scree_contender *e, const scree_ring *r) {
  const scree_halfmesh *s = c->s;
  set_mark(c, e->a, TOUCHED);
  set_mark(c, e->b, TOUCHED);
  set_mark(c, e->c, APEX);
  if (e->d != SCREE_NONE) set_mark(c, e->d, APEX);
  for (uint32_t i = 0; i < r->count; i++) {
    set_mark(c, s->half[r->edge[i]].from, TOUCHED);
    set_mark(c, scree_to(s, r->edge[i]), TOUCHED);
  }
}

static void refuse(scree_choosing *c, const scree_contender *e) {
  c->s->refused[c->best[e->a]] = SCREE_EDGE_REFUSED;
  set_mark(c, e->a, GONE);
}

/* Takes what leads. */
static void decide_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)worker;
  scree_choosing *c = context;
  struct scree_choice_count *counts = &c->counts[block];
  scree_contender *all = c->contenders + begin, *contenders = all + counts->waiting, leading[BLOCK];
  uint32_t edges[SCREE_RING_MAX], kept = 0, count = counts->left, taken = 0;
  scree_ring r = {.edge = edges};
  for (uint32_t i = 0; i < count; i++) {
    scree_contender e = contenders[i];
    if (i + AHEAD < count) {
      ask_for_claims(c, &contenders[i + AHEAD]);
      __builtin_prefetch(&c->s->half[c->best[contenders[i + AHEAD].a]]);
    }
    int outcome = leads(c, &e, &r);
    if (outcome == TOO_LONG) refuse(c, &e);
    if (outcome != LEADS) {
      contenders[kept++] = e;
      continue;
    }
    touch(c, &e, &r);
    uint32_t first =
        (uint32_t)__atomic_fetch_add(&c->edge_count, (size_t)r.count, __ATOMIC_RELAXED);
    memcpy(c->edges + first, edges, r.count * sizeof *edges);
    leading[taken++] = (scree_contender){
        .taken = e.a, .first_edge = first, .a_count = r.a_count, .count = r.count};
  }
  counts->left = kept;
  counts->just_taken = taken;
  counts->taken += taken;
  memcpy(all + BLOCK - counts->taken, leading, taken * sizeof *leading);
}

static void resign(scree_choosing *c, const scree_contender *e) {
  __atomic_store_n(&c->leader[e->a], SCREE_NONE, __ATOMIC_RELAXED);
  __atomic_store_n(&c->leader[e->b], SCREE_NONE, __ATOMIC_RELAXED);
  __atomic_store_n(&c->apex_leader[e->c], SCREE_NONE, __ATOMIC_RELAXED);
  if (e->d != SCREE_NONE) __atomic_store_n(&c->apex_leader[e->d], SCREE_NONE, __ATOMIC_RELAXED);
}

/* What claim_block wrote is taken back. */
static void resign_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)worker;
  scree_choosing *c = context;
  struct scree_choice_count *counts = &c->counts[block];
  const scree_contender *all = c->contenders + begin;
  for (uint32_t i = 0; i < counts->left; i++) resign(c, &all[counts->waiting + i]);
  for (uint32_t i = 0; i < counts->just_taken; i++) {
    scree_ring r;
    scree_ring_name(c->s, c->best[all[BLOCK - counts->taken + i].taken], &r);
    resign(c, &(scree_contender){.a = r.a, .b = r.b, .c = r.c, .d = r.d});
  }
}

static bool any_left(const scree_choosing *c) {
  for (size_t k = 0; k < scree_block_count(c->s->vertex_count, BLOCK); k++)
    if (c->counts[k].left) return true;
  return false;
}

/* Decides among those in question, which have claimed. */
static void choose_left(scree_choosing *c) {
  size_t count = c->s->vertex_count;
  while (any_left(c)) {
    scree_parallel_for(count, BLOCK, decide_block, c);
    scree_parallel_for(count, BLOCK, resign_block, c);
    scree_parallel_for(count, BLOCK, claim_block, c);
  }
}

void scree_choose_independent(scree_choosing *c) {
  size_t count = c->s->vertex_count;
  c->edge_count = 0;
  choose_left(c);
  for (size_t k = 0; k < scree_block_count(count, BLOCK); k++) {
    c->counts[k].left = c->counts[k].waiting;
    c->counts[k].waiting = 0;
  }
  scree_parallel_for(count, BLOCK, claim_block, c);
  choose_left(c);
}
