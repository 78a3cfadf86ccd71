/* Decimation against a slow decimator, collapse by collapse.
 *
 * The oracle knows a list of triangles and nothing else: stars, quadrics, costs, places, the link
 * condition, flips, slivers, folds and intersections are computed from it anew for every edge at
 * every collapse, by other formulas than the engine's (sums over triangles instead of sums per
 * vertex, a system of Lagrange's multipliers instead of a frame, planes of the first mesh instead
 * of accumulated quadrics, all pairs of triangles instead of a grid).
 *
 * For every collapse of the engine's record it asks: was this collapse allowed, is its place the
 * one of least cost, are its error and its changes of area and volume right, and was every edge
 * of lower cost not allowed? Where the engine and the oracle differ by rounding the engine's place
 * is taken over, so that errors do not add up. What an edge may do next after a refusal is part of
 * the rules: it waits, at the cost of its cheapest allowed other place or out of the race, until a
 * triangle at one of its ends changes.
 *
 * After every collapse the survivor and its neighbours have their turns to move: was the move the
 * step that the oracle finds, or half or a quarter of it, did the witnesses gain, was it allowed,
 * and did none stay that should have moved? At last two of them that are no neighbours move
 * together: the same is asked, and whether they were the two that gain most.
 *
 * When few triangles are left, the collapse must be the best of some that are best before any move:
 * see "Looking ahead".
 *
 * That is asked of the greedy stage. Of batches and patches, all but whose turn it was: every
 * collapse of their record, done after those before it, is allowed, at the place of least cost,
 * with the right error and changes. Which of a round's candidates are taken has a test of its own
 * (simplify_independent.c). */
#include "mesh/intersect.h"
#include "simplify/patch.h"
#include "support/decimator.h"
#include "support/oracle.h"
#include "support/shapes.h"

/* What the rules name (docs/decimation.md). */
#define STRAY_SHARE   0.01
#define TOLL_SHARE    0.1
#define USUAL_MEANS   10.0
#define RENEW_SHARE   0.7
#define PARTING_COUNT 1000
#define AHEAD_COUNT   200
#define EQUAL_COST    1e-9

/* ---- The order ---- */

static uint8_t *state_of(oracle *o, uint32_t a, uint32_t b) {
  return &o->state[a < b ? a * o->vertex_count + b : b * o->vertex_count + a];
}

/* The place with its whole cost; fallback < 0: the best. */
static place whole_place(oracle *o, uint32_t a, uint32_t b, int fallback) {
  place p = oracle_place_of(o, a, b, fallback);
  if (!(p.cost < INFINITY) || !(p.stray > 0)) return p;
  double *whole = &o->whole[4 * (size_t)(state_of(o, a, b) - o->state) + (size_t)(fallback + 1)];
  if (isnan(*whole)) {
    double least = sqrt(STRAY_SHARE * p.cost / p.stray);
    if (o->toll > 0) least = fmin(least, pow(STRAY_SHARE * p.cost / o->toll, 1.0 / 3));
    double stray2 = fmax(oracle_stray2_of(o, a, b, p.target), least);
    *whole = p.cost + p.stray * pow(stray2, 2) + o->toll * pow(stray2, 3);
  }
  p.slack *= *whole / p.cost;
  p.cost = *whole;
  return p;
}

/* The cheapest at whole cost of the best place and the others. */
static place first_choice(oracle *o, uint32_t a, uint32_t b) {
  place best = whole_place(o, a, b, -1);
  for (int k = 0; k < SCREE_FALLBACK_COUNT && !o->qecd; k++) {
    if (oracle_place_of(o, a, b, k).cost > (1 + EQUAL_COST) * best.cost) continue;
    place p = whole_place(o, a, b, k);
    bool equal = fabs(p.cost - best.cost) <= EQUAL_COST * best.cost;
    if (equal) best.other = p.target;
    if (!equal && p.cost < best.cost) best = p;
  }
  return best;
}

/* The edge's place as it waits; cost INFINITY: out. Where the cost without the stray is above
 * `enough`, that is the answer. */
static place waiting(oracle *o, uint32_t a, uint32_t b, double enough) {
  int state = *state_of(o, a, b) & STATES;
  if (state == OUT) return (place){.cost = INFINITY};
  place p = oracle_place_of(o, a, b, state - FALLBACK);
  if (p.cost > enough) return p;
  return state == BEST ? first_choice(o, a, b) : whole_place(o, a, b, state - FALLBACK);
}

/* What becomes of an edge whose turn came and which is not allowed. */
static void refuse(oracle *o, uint32_t a, uint32_t b) {
  uint8_t *state = state_of(o, a, b), next = OUT;
  double least = INFINITY;
  for (int k = 0; k < SCREE_FALLBACK_COUNT && (*state & STATES) == BEST; k++) {
    place p = whole_place(o, a, b, k);
    if (!(p.cost < least) || !oracle_may_collapse(o, a, b, p.target)) continue;
    least = p.cost;
    next = (uint8_t)(FALLBACK + k);
  }
  *state = (uint8_t)((*state & IN_DOUBT) | next);
}

/* Every edge once, as the lower and the higher end of a triangle's side. */
static bool next_edge(const oracle *o, size_t *side, uint32_t *a, uint32_t *b) {
  while (*side < 3 * o->triangle_count) {
    size_t h = (*side)++;
    *a = o->triangle[h];
    *b = o->triangle[h % 3 == 2 ? h - 2 : h + 1];
    if (*a < *b) return true;
  }
  return false;
}

/* Refuses what waits and is not allowed; false where something is, in spite of rounding. */
static bool nothing_waits(oracle *o) {
  size_t side = 0;
  uint32_t a, b;
  while (next_edge(o, &side, &a, &b))
    for (;;) {
      place p = waiting(o, a, b, INFINITY);
      if (!(p.cost < INFINITY) || *state_of(o, a, b) & IN_DOUBT) break;
      if (oracle_may_collapse(o, a, b, p.target)) return false;
      refuse(o, a, b);
    }
  return true;
}

static void start_anew(oracle *o) {
  memset(o->state, BEST, o->vertex_count * o->vertex_count);
}

static void edge_starts_anew(oracle *o, uint32_t v, uint32_t w) {
  uint8_t *state = state_of(o, v, w);
  *state = BEST;
  for (size_t k = 0; k < 4; k++) o->whole[4 * (size_t)(state - o->state) + k] = NAN;
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* All edges start anew, and the toll is found from their costs without the stray. */
static void renew(oracle *o) {
  if (o->qecd || o->triangle_count > o->renew_at) return;
  double *costs = malloc((3 * o->triangle_count + 1) * sizeof *costs), worst = 0, mean = 0;
  size_t count = 0, side = 0;
  uint32_t a, b;
  start_anew(o);
  while (next_edge(o, &side, &a, &b)) {
    edge_starts_anew(o, a, b);
    costs[count] = oracle_place_of(o, a, b, -1).cost;
    count += costs[count] < INFINITY;
  }
  for (size_t w = 0; w < o->vertex_count; w++) {
    worst = fmax(worst, sqrt(o->held2[w]));
    mean += sqrt(o->held2[w]) / (double)o->vertex_count;
  }
  qsort(costs, count, sizeof *costs, by_value);
  if (count > 0) {
    double cost = costs[(size_t)(TOLL_SHARE * (double)count)];
    double far = fmax(USUAL_MEANS * mean, worst);
    o->toll = worst > EQUALLY_NEAR ? cost / pow(far, 6) : 0;
    o->renew_at = (size_t)(RENEW_SHARE * (double)o->triangle_count);
  }
  free(costs);
}

/* The engine collapses (a, b) next, to x; checks that no edge should have come before. */
static bool check_turn(oracle *o, uint32_t a, uint32_t b, vec3 x, place *chosen) {
  *chosen = waiting(o, a, b, INFINITY);
  double refused_at = 0;
  if (chosen->cost < INFINITY && !oracle_may_collapse(o, a, b, x) &&
      !oracle_may_collapse(o, a, b, chosen->target))
    *chosen = (place){.cost = INFINITY};
  double off = vec3_norm(vec3_sub(x, chosen->target));
  if (!(chosen->cost < INFINITY) ||
      (off > 1e-6 && !(vec3_norm(vec3_sub(x, chosen->other)) <= 1e-6))) {
    /* the best place was refused in between: one of the others */
    place best = waiting(o, a, b, INFINITY);
    if (best.cost < INFINITY) refused_at = best.cost;
    refuse(o, a, b);
    *chosen = waiting(o, a, b, INFINITY);
  }
  if (!(chosen->cost < INFINITY)) return false;
  double turn = fmax(chosen->cost, refused_at); /* all below it have had theirs */
  bool alone = true;
  size_t side = 0;
  uint32_t c, d;
  while (next_edge(o, &side, &c, &d)) {
    if (c == a && d == b) continue;
    for (;;) { /* until its turn is not now, or it is out */
      place p = waiting(o, c, d, 2 * turn);
      if (!(p.cost < INFINITY) || p.cost > turn + p.slack + chosen->slack) break;
      if (p.cost >= turn - p.slack - chosen->slack) {
        *state_of(o, c, d) |= IN_DOUBT; /* whether its turn came is rounding's to say */
        alone = false;
        break;
      }
      if (oracle_may_collapse(o, c, d, p.target)) {
        if (*state_of(o, c, d) & IN_DOUBT) break;
        print_error("edge (%u, %u) has cost %.9g and is allowed\n", c, d, p.cost);
        return false;
      }
      refuse(o, c, d);
    }
  }
  o->decided += alone;
  return true;
}

/* All edges at the ends of the triangles around v start anew. */
static void edges_start_anew(oracle *o, uint32_t v) {
  for (size_t t = 0; t < o->triangle_count; t++)
    for (size_t i = 0; i < 3 && oracle_has(o, t, v); i++)
      for (uint32_t u = 0; u < o->vertex_count; u++) edge_starts_anew(o, o->triangle[3 * t + i], u);
}

static void apply(oracle *o, uint32_t a, uint32_t b, vec3 x) {
  oracle_apply(o, a, b, x);
  for (size_t t = 0; o->qecd && t < o->plane_count; t++)
    o->share[a * o->plane_count + t] =
        (uint16_t)(o->share[a * o->plane_count + t] + o->share[b * o->plane_count + t]);
  edges_start_anew(o, a);
}

static void apply_move(oracle *o, uint32_t v, vec3 x) {
  oracle_apply_move(o, v, x);
  edges_start_anew(o, v);
}

/* The record's next move, if it belongs to collapse i, and whether it keeps the volume by itself.
 */
static const scree_move *next_move(const oracle *o, const scree_decimator *d, size_t i, vec3 *x,
                                   bool *alone) {
  const scree_moves *moves = &d->record.moves;
  const scree_move *m = &moves->items[o->moved];
  if (o->moved == moves->count || m->index != i) return NULL;
  *x = vec3_scale(vec3_sub(m->position, d->s.centre), 1 / d->s.scale);
  vec3 step = vec3_sub(*x, o->position[m->vertex]), sum = {0, 0, 0};
  for (size_t t = 0; t < o->triangle_count; t++)
    if (oracle_has(o, t, m->vertex)) sum = vec3_add(sum, oracle_area_vector(o, t));
  *alone = fabs(vec3_dot(sum, step)) <= 1e-8 * vec3_norm(sum) * vec3_norm(step);
  return m;
}

/* Vertex v has its turn to move after collapse i. */
static void check_turn_to_move(oracle *o, const scree_decimator *d, size_t i, uint32_t v) {
  vec3 x;
  bool alone;
  const scree_move *m = next_move(o, d, i, &x, &alone);
  if (!m || !alone || m->vertex != v) {
    oracle_check_move(o, v, NULL);
    return;
  }
  oracle_check_move(o, v, &x);
  apply_move(o, v, x);
  o->moved++;
}

/* At last two vertices about a, which survived collapse i, move together. */
static void check_exchange(oracle *o, const scree_decimator *d, size_t i, uint32_t a) {
  double second;
  bool alone;
  vec3 x[2];
  pair best = oracle_best_pair(o, a, &second), p;
  bool sure = best.gain > (1 + 1e-6) * RELAX_GAIN * best.sum && second < (1 - 1e-6) * best.gain;
  const scree_move *m = next_move(o, d, i, &x[0], &alone);
  if (!m) {
    if (best.gain > 0) oracle_check_pair(o, &best, sure, NULL);
    return;
  }
  assert_true(o->moved + 1 < d->record.moves.count && m[1].index == i);
  x[1] = vec3_scale(vec3_sub(m[1].position, d->s.centre), 1 / d->s.scale);
  if (!oracle_find_pair(o, m[0].vertex, m[1].vertex, &p) || p.gain < (1 - 1e-6) * best.gain ||
      !(best.gain > 0))
    fail_msg("vertices %u and %u moved for %g, others for %g", m[0].vertex, m[1].vertex, p.gain,
             best.gain);
  oracle_check_pair(o, &p, sure, x);
  for (int k = 0; k < 2; k++) apply_move(o, p.v[k], x[k]);
  o->moved += 2;
  o->exchanged++;
}

/* The survivor of collapse i, then its neighbours, counter-clockwise from the farthest. Where two
 * are as far, rounding decides the order, and the moves are taken over. */
static void check_moves(oracle *o, const scree_decimator *d, size_t i) {
  bool in_order, alone;
  vec3 x;
  uint32_t a = d->record.kept[i];
  oracle_renew_farthest(o);
  check_turn_to_move(o, d, i, a);
  uint32_t first = oracle_farthest_neighbour(o, a, &in_order), v = first;
  const scree_move *m;
  for (; !in_order && (m = next_move(o, d, i, &x, &alone)) && alone; o->taken++)
    check_turn_to_move(o, d, i, m->vertex);
  while (in_order) {
    check_turn_to_move(o, d, i, v);
    v = oracle_beyond_side(o, a, v);
    if (v == first) break;
  }
  check_exchange(o, d, i, a);
}

/* ---- Looking ahead ---- */

enum { OFFER_COUNT = 16, TRIAL_COUNT = 4, WEIGHED_EVERY = 3 };

typedef struct offer {
  uint32_t a, b;
  place p;
  double alone; /* its score without moves */
} offer;

static bool is_offered(const offer *offers, size_t count, uint32_t a, uint32_t b) {
  for (size_t i = 0; i < count; i++)
    if (offers[i].a == a && offers[i].b == b) return true;
  return false;
}

/* The edge that waits at the least cost and is not among the offers. */
static offer cheapest(oracle *o, const offer *offers, size_t count) {
  offer least = {.p = {.cost = INFINITY}};
  size_t side = 0;
  uint32_t a, b;
  while (next_edge(o, &side, &a, &b)) {
    if (is_offered(offers, count, a, b)) continue;
    place p = waiting(o, a, b, least.p.cost);
    if (p.cost < least.p.cost) least = (offer){.a = a, .b = b, .p = p};
  }
  return least;
}

/* The cheapest that are allowed; what is cheaper and is not is refused. *next: what waits at the
 * least cost then. */
static size_t find_offers(oracle *o, offer *offers, offer *next) {
  size_t count = 0;
  for (;;) {
    *next = cheapest(o, offers, count);
    if (!(next->p.cost < INFINITY) || count == OFFER_COUNT) return count;
    if (oracle_may_collapse(o, next->a, next->b, next->p.target))
      offers[count++] = *next;
    else
      refuse(o, next->a, next->b);
  }
}

/* Whether none of the others would have made a better level. */
static void weigh(oracle *o, const offer *offers, size_t count, uint32_t a, uint32_t b) {
  double score[TRIAL_COUNT], chosen = INFINITY;
  bool sure[TRIAL_COUNT], all = true;
  for (size_t i = 0; i < count; i++) {
    score[i] = oracle_score_after(o, offers[i].a, offers[i].b, offers[i].p.target, &sure[i]);
    all &= sure[i];
    if (offers[i].a == a && offers[i].b == b && sure[i]) chosen = score[i];
  }
  for (size_t i = 0; i < count && chosen < INFINITY; i++)
    if (sure[i] && score[i] < (1 - 1e-6) * chosen)
      fail_msg("collapse of (%u, %u) for %.9g, that of (%u, %u) makes %.9g", a, b, chosen,
               offers[i].a, offers[i].b, score[i]);
  o->weighed += all;
}

static int by_score(const void *a, const void *b) {
  const offer *x = a, *y = b;
  return (x->alone > y->alone) - (x->alone < y->alone);
}

/* The engine collapses (a, b) next, to x: one of the offers that are best as they are, and the best
 * of them. */
static bool check_choice(oracle *o, uint32_t a, uint32_t b, vec3 x, place *chosen) {
  offer offers[OFFER_COUNT], next;
  oracle_renew_farthest(o);
  size_t count = find_offers(o, offers, &next), tried = count;
  if (count == 0) return false;
  place last = offers[count - 1].p;
  bool clear = next.p.cost - last.cost > next.p.slack + last.slack;
  for (size_t i = 0; i < count; i++)
    offers[i].alone = oracle_score_alone(o, offers[i].a, offers[i].b, offers[i].p.target);
  qsort(offers, count, sizeof *offers, by_score);
  if (count > TRIAL_COUNT) {
    tried = TRIAL_COUNT;
    clear &= offers[tried].alone > (1 + 1e-6) * offers[tried - 1].alone;
  }
  o->decided += clear;
  for (size_t i = 0; i < count; i++) {
    *chosen = offers[i].p;
    if (offers[i].a != a || offers[i].b != b ||
        fmin(vec3_distance(x, chosen->target), vec3_distance(x, chosen->other)) > 1e-6)
      continue;
    if (clear && i >= tried) fail_msg("collapse of (%u, %u) is no trial", a, b);
    if (clear && o->compared % WEIGHED_EVERY == 0) weigh(o, offers, tried, a, b);
    return true;
  }
  *chosen = waiting(o, a, b, INFINITY); /* as cheap, but for rounding */
  return chosen->cost <= last.cost + last.slack + chosen->slack;
}

static void measure(const oracle *o, double *area, double *volume) {
  *area = *volume = 0;
  for (size_t t = 0; t < o->triangle_count; t++) {
    *area += 0.5 * vec3_norm(oracle_area_vector(o, t));
    *volume += vec3_dot(oracle_corner(o, t, 0), oracle_area_vector(o, t)) / 6;
  }
}

/* ---- Running both ---- */

static oracle oracle_of(const scree_mesh *mesh, const scree_halfmesh *s, bool qecd) {
  size_t n = mesh->vertex_count, m = mesh->triangle_count;
  oracle o = {.vertex_count = n,
              .triangle_count = m,
              .plane_count = m,
              .qecd = qecd,
              .renew_at = m,
              .far_at = m};
  o.position = malloc(n * sizeof *o.position);
  o.triangle = malloc(3 * m * sizeof *o.triangle);
  o.plane = malloc(m * sizeof *o.plane);
  o.offset = malloc(m * sizeof *o.offset);
  o.weight = malloc(m * sizeof *o.weight);
  o.share = calloc(n * m, sizeof *o.share);
  o.state = calloc(n * n, 1);
  o.start = malloc(9 * m * sizeof *o.start);
  memcpy(o.triangle, mesh->triangles, 3 * m * sizeof *o.triangle);
  for (size_t v = 0; v < n; v++)
    o.position[v] =
        vec3_scale(vec3_sub(vec3_load(mesh->positions + 3 * v), s->centre), 1 / s->scale);
  o.witness = malloc(n * sizeof *o.witness);
  o.holder = malloc(n * sizeof *o.holder);
  o.held2 = calloc(n, sizeof *o.held2);
  o.whole = malloc(4 * n * n * sizeof *o.whole);
  for (size_t i = 0; i < 4 * n * n; i++) o.whole[i] = NAN;
  memcpy(o.witness, o.position, n * sizeof *o.witness);
  for (size_t i = 3 * m; i-- > 0;) o.holder[o.triangle[i]] = (uint32_t)(i / 3);
  for (size_t t = 0; t < m; t++) {
    vec3 normal = oracle_area_vector(&o, t);
    o.weight[t] = vec3_norm(normal);
    o.plane[t] = vec3_scale(normal, 1 / o.weight[t]);
    o.offset[t] = -vec3_dot(o.plane[t], oracle_corner(&o, t, 0));
    o.start_area += 0.5 * o.weight[t];
    for (size_t i = 0; i < 3; i++) {
      o.share[o.triangle[3 * t + i] * m + t] = 1;
      vec3_store(o.start + 9 * t + 3 * i, oracle_corner(&o, t, i));
    }
  }
  return o;
}

static void oracle_free(oracle *o) {
  free(o->position);
  free(o->triangle);
  free(o->plane);
  free(o->offset);
  free(o->weight);
  free(o->share);
  free(o->state);
  free(o->start);
  free(o->witness);
  free(o->holder);
  free(o->held2);
  free(o->whole);
}

/* The collapse i of the record, which is in its turn: its place, what it changes with the moves
 * after it; does it. */
static void check_deed(oracle *o, const scree_decimator *d, size_t i, const place *chosen) {
  const scree_record *r = &d->record;
  uint32_t a = r->kept[i], b = r->gone[i];
  vec3 x = vec3_scale(vec3_sub(r->position[i], d->s.centre), 1 / d->s.scale);
  double area, volume, area_after, volume_after;
  double off = fmin(vec3_norm(vec3_sub(x, chosen->target)), vec3_norm(vec3_sub(x, chosen->other)));
  if (!(off <= 1e-6) || !oracle_may_collapse(o, a, b, x))
    fail_msg("collapse %zu, (%u, %u): placed %g beside the best, or not allowed", i, a, b, off);
  CHECK_NEAR((double)r->error[i], chosen->error, 1e-5 * chosen->error + 1e-14);
  measure(o, &area, &volume);
  apply(o, a, b, x);
  if (!o->batched && !o->qecd) check_moves(o, d, i);
  measure(o, &area_after, &volume_after);
  CHECK_NEAR(r->area[i], area_after - area, 1e-12);
  CHECK_NEAR(r->volume[i], volume_after - volume, 1e-12);
  if (!o->qecd) CHECK_NEAR(volume_after, volume, 1e-12);
  o->compared++;
}

/* One collapse of the greedy stage's record: everything about it. */
static void check_collapse(oracle *o, const scree_decimator *d, size_t i) {
  const scree_record *r = &d->record;
  uint32_t a = r->kept[i], b = r->gone[i];
  vec3 x = vec3_scale(vec3_sub(r->position[i], d->s.centre), 1 / d->s.scale);
  place chosen;
  size_t next = o->parted ? AHEAD_COUNT : PARTING_COUNT; /* there it begins anew */
  if (!o->qecd && !o->looks_ahead && o->triangle_count <= next) {
    o->parted = true;
    o->looks_ahead = o->triangle_count <= AHEAD_COUNT;
    o->renew_at = o->far_at = o->triangle_count;
  }
  renew(o);
  bool (*check)(oracle *, uint32_t, uint32_t, vec3, place *) =
      o->looks_ahead ? check_choice : check_turn;
  bool in_turn = check(o, a, b, x, &chosen);
  if (!in_turn && nothing_waits(o)) { /* all edges are looked at once more */
    start_anew(o);
    in_turn = check(o, a, b, x, &chosen);
  }
  if (!in_turn) fail_msg("collapse %zu, (%u, %u), at %zu triangles", i, a, b, o->triangle_count);
  check_deed(o, d, i, &chosen);
}

/* After the last collapse nothing is allowed. */
static void check_floor(oracle *o) {
  for (int round = 0; round < 2; round++) {
    if (!nothing_waits(o)) fail_msg("an edge could still go at %zu triangles", o->triangle_count);
    start_anew(o);
  }
}

/* On a surface that meets itself from the start the engine refuses a little more than it must, so
 * the shapes here do not. */
static bool is_clean(const oracle *o) {
  bool *touched = malloc(o->triangle_count * sizeof *touched);
  for (size_t t = 0; t < o->triangle_count; t++) touched[t] = true;
  bool clean = oracle_meetings(o, touched) == 0;
  free(touched);
  return clean;
}

static scree_decimator decimator_of(const scree_mesh *mesh, bool qecd, scree_error *error) {
  return begin_decimation(mesh, qecd ? &scree_qecd_coster : &scree_volume_coster, error);
}

typedef struct totals {
  size_t moved, exchanged, compared, decided, weighed;
} totals;

static void compare(const scree_mesh *mesh, bool qecd, totals *sum) {
  scree_error error;
  scree_decimator d = decimator_of(mesh, qecd, &error);
  assert_true(d.s.closed);
  CHECK_OK(scree_decimate_one_by_one(&d), error);
  oracle o = oracle_of(mesh, &d.s, qecd);
  assert_true(is_clean(&o));
  for (size_t i = 0; i < d.record.count; i++) check_collapse(&o, &d, i);
  assert_int_equal(o.triangle_count, d.s.live_triangle_count);
  assert_int_equal(o.moved, d.record.moves.count);
  check_floor(&o);
  sum->moved += o.moved - o.taken;
  sum->exchanged += o.exchanged;
  sum->compared += o.compared;
  sum->decided += o.decided;
  sum->weighed += o.weighed;
  oracle_free(&o);
  scree_decimator_free(&d);
}

/* Batches down to few triangles, or before them patches of so many vertices; answers how many
 * collapses they were. */
static size_t compare_batches(const scree_mesh *mesh, bool qecd, size_t patch) {
  scree_error error;
  scree_decimator d = decimator_of(mesh, qecd, &error);
  d.single_from = mesh->triangle_count / 12;
  if (patch > 0) {
    CHECK_OK(scree_decimate_in_patches(&d, patch), error);
    for (size_t v = 0; v < d.s.vertex_count; v++) assert_false(d.s.flags[v] & SCREE_VERTEX_BORDER);
  } else {
    CHECK_OK(scree_decimate_in_batches(&d), error);
  }
  oracle o = oracle_of(mesh, &d.s, qecd);
  o.batched = true;
  assert_true(is_clean(&o));
  for (size_t i = 0; i < d.record.count; i++) {
    place best = oracle_place_of(&o, d.record.kept[i], d.record.gone[i], -1);
    check_deed(&o, &d, i, &best);
  }
  assert_int_equal(o.triangle_count, d.s.live_triangle_count);
  size_t compared = o.compared;
  oracle_free(&o);
  scree_decimator_free(&d);
  return compared;
}

/* Two noisy plates, one close above the other: only the test for intersections keeps them apart. */
static scree_mesh two_plates(scree_rng *rng) {
  scree_mesh low = shape_grid_box(0.1, 0.05, 0.02, 4), high = shape_grid_box(0.1, 0.05, 0.02, 3);
  shape_move(&high, (vec3){0.01, 0.01, 0.0205});
  shape_shake(&low, 1.5e-4, rng);
  shape_shake(&high, 1.5e-4, rng);
  scree_mesh both = shape_join(&low, &high);
  scree_mesh_free(&low);
  scree_mesh_free(&high);
  return both;
}

enum { SHAPE_COUNT = 8, NOISY_FROM = 2 };
static const double noise[SHAPE_COUNT] = {0, 0, 1e-3, 5e-4, 1e-4, 4e-4, 0, 2e-3};
/* Of each shape: always, and with the argument `more` besides, which takes minutes. */
static const int rounds[2][SHAPE_COUNT] = {{1, 1, 1, 1, 1, 1, 1, 5}, {0, 0, 2, 2, 2, 2, 2, 15}};
static bool more;

static scree_mesh shape(int which, scree_rng *rng) {
  scree_mesh mesh;
  switch (which) {
  case 0:
    mesh = shape_grid_box(0.1, 0.05, 0.02, 4);
    break;
  case 1:
  case 2:
    mesh = shape_icosphere(0.02, 2);
    break;
  case 3:
    mesh = shape_torus(0.03, 0.01, 16, 8);
    break;
  case 4:
    mesh = shape_grid_box(0.1, 0.05, 0.004, 5);
    break;
  case 5:
    mesh = shape_torus(0.03, 0.004, 20, 5);
    break;
  case 6:
    mesh = two_plates(rng);
    break;
  default:
    mesh = shape_icosphere(0.02, 1);
  }
  if (noise[which] > 0) shape_shake(&mesh, noise[which], rng);
  return mesh;
}

static void every_collapse_is_the_oracles(void **state) {
  (void)state;
  scree_rng rng = {.seed = more ? 22 : 20}; /* with which the two plates do not meet */
  for (int which = 0; which < SHAPE_COUNT; which++)
    for (int qecd = 0; qecd < 2 && rounds[more][which] > 0; qecd++) {
      totals sum = {0};
      for (int round = 0; round < rounds[more][which]; round++) {
        scree_mesh mesh = shape(which, &rng);
        compare(&mesh, qecd, &sum);
        scree_mesh_free(&mesh);
      }
      print_message("shape %d, %s: %zu collapses, %zu without a rival within rounding, %zu moves, "
                    "%zu pairs, %zu choices\n",
                    which, qecd ? "qecd" : "volume", sum.compared, sum.decided, sum.moved,
                    sum.exchanged, sum.weighed);
      /* on noisy shapes rounding decides next to nothing */
      if (which >= NOISY_FROM) assert_true(sum.decided > sum.compared * 9 / 10);
      if (qecd) assert_int_equal(sum.moved, 0);
      if (!qecd && which >= NOISY_FROM)
        assert_true(sum.moved > 0 && sum.exchanged > 0 && sum.weighed > 0);
    }
}

/* A thin shell: coarse facets of the outer sphere would cut the inner one. */
static scree_mesh hollow_sphere(scree_rng *rng) {
  scree_mesh outer = shape_icosphere(0.02, 3), inner = shape_icosphere(0.0196, 3);
  for (size_t t = 0; t < inner.triangle_count; t++) shape_flip(&inner, t);
  scree_mesh both = shape_join(&outer, &inner);
  shape_shake(&both, 3e-5, rng);
  scree_mesh_free(&outer);
  scree_mesh_free(&inner);
  return both;
}

/* Noise of a good part of an edge, so that checks refuse; shells that only the search keeps apart.
 */
static void every_collapse_of_a_batch_is_sound(void **state) {
  (void)state;
  scree_rng rng = {.seed = 31};
  for (int which = 0; which < 3; which++)
    for (int qecd = 0; qecd < 2; qecd++) {
      scree_mesh mesh = which == 0   ? shape_icosphere(0.02, 3)
                        : which == 1 ? shape_torus(0.03, 0.006, 36, 12)
                                     : hollow_sphere(&rng);
      if (which < 2) shape_shake(&mesh, which == 0 ? 5e-4 : 3e-4, &rng);
      size_t compared = compare_batches(&mesh, qecd, 0);
      print_message("batches of shape %d, %s: %zu collapses\n", which, qecd ? "qecd" : "volume",
                    compared);
      assert_true(compared > mesh.vertex_count / 2);
      scree_mesh_free(&mesh);
    }
}

/* Boxes, of which cells of the grid see a side or an edge, of little and of more noise. */
static void every_collapse_of_a_patch_is_sound(void **state) {
  (void)state;
  scree_rng rng = {.seed = 37};
  for (int which = 0; which < 2; which++)
    for (int qecd = 0; qecd < 2; qecd++) {
      scree_mesh mesh = shape_grid_box(0.1, 0.07, 0.05, 14);
      shape_shake(&mesh, which == 0 ? 1e-4 : 3e-4, &rng);
      size_t compared = compare_batches(&mesh, qecd, 300);
      print_message("patches of shape %d, %s: %zu collapses of %zu vertices\n", which,
                    qecd ? "qecd" : "volume", compared, mesh.vertex_count);
      assert_true(compared > mesh.vertex_count / 10);
      scree_mesh_free(&mesh);
    }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_collapse_is_the_oracles),
                                     cmocka_unit_test(every_collapse_of_a_batch_is_sound),
                                     cmocka_unit_test(every_collapse_of_a_patch_is_sound)};
  const struct CMUnitTest greedy[] = {cmocka_unit_test(every_collapse_is_the_oracles)};
  more = argc > 1 && !strcmp(argv[1], "more");
  return more ? cmocka_run_group_tests(greedy, NULL, NULL)
              : cmocka_run_group_tests(tests, NULL, NULL);
}
