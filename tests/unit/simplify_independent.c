/* Which collapses a round takes, against the definition: a walk through all candidates in the order
 * of cost that asks, by sets of neighbours found from a list of triangles, whether each is
 * independent of all taken before. */
#include "simplify/independent.h"

#include "base/parallel.h"
#include "support/check.h"
#include "support/shapes.h"

typedef struct choice {
  scree_halfmesh s;
  size_t blocks;
  uint32_t *best;
  double *cost;
  scree_choosing choosing;
} choice;

static void *room(size_t count, size_t size, int byte) {
  void *made = scree_alloc(count, size);
  assert_non_null(made);
  return memset(made, byte, count * size);
}

static void prepare(const scree_mesh *mesh, choice *c) {
  scree_error error;
  CHECK_OK(scree_halfmesh_build(mesh, &c->s, &error), error);
  size_t n = c->s.vertex_count;
  c->blocks = scree_block_count(n, SCREE_CHOICE_BLOCK);
  c->best = room(n, sizeof *c->best, 0xff);
  c->cost = room(n, sizeof *c->cost, 0);
  c->choosing = (scree_choosing){
      .s = &c->s,
      .best = c->best,
      .cost = c->cost,
      .contenders = room(c->blocks * SCREE_CHOICE_BLOCK, sizeof *c->choosing.contenders, 0),
      .counts = room(c->blocks, sizeof *c->choosing.counts, 0),
      .leader = room(n, sizeof *c->choosing.leader, 0xff),
      .apex_leader = room(n, sizeof *c->choosing.apex_leader, 0xff),
      .marks = room(n, 1, 0),
      .edges = room(c->s.triangle_count, sizeof *c->choosing.edges, 0)};
}

static void drop(choice *c) {
  scree_halfmesh_free(&c->s);
  scree_free(c->best);
  scree_free(c->cost);
  scree_free(c->choosing.contenders);
  scree_free(c->choosing.counts);
  scree_free(c->choosing.leader);
  scree_free(c->choosing.apex_leader);
  scree_free(c->choosing.marks);
  scree_free(c->choosing.edges);
}

/* A share of the vertices have one of their edges as a candidate, at costs of which many are equal
 * where `values` are few. */
static void draw_candidates(choice *c, double share, uint64_t values, scree_rng *rng) {
  const scree_halfmesh *s = &c->s;
  for (uint32_t v = 0; v < s->vertex_count; v++) {
    c->best[v] = SCREE_NONE;
    if (scree_rng_uniform(rng) > share) continue;
    uint32_t h = s->vertex[v].outgoing, turns = (uint32_t)scree_rng_below(rng, 5);
    for (uint32_t i = 0; i < turns && scree_turn(s, h) != SCREE_NONE; i++) h = scree_turn(s, h);
    scree_contender *block = c->choosing.contenders + v / SCREE_CHOICE_BLOCK * SCREE_CHOICE_BLOCK;
    scree_ring r;
    scree_ring_name(s, h, &r);
    c->best[v] = h;
    c->cost[v] = (double)scree_rng_below(rng, values);
    block[c->choosing.counts[v / SCREE_CHOICE_BLOCK].left++] =
        (scree_contender){.a = r.a, .b = r.b, .c = r.c, .d = r.d};
  }
}

/* Candidates of this cost or more wait for the others. */
static void let_wait(choice *c, double cost) {
  scree_contender sorted[SCREE_CHOICE_BLOCK];
  for (size_t k = 0; k < c->blocks; k++) {
    scree_contender *block = c->choosing.contenders + k * SCREE_CHOICE_BLOCK;
    struct scree_choice_count *count = &c->choosing.counts[k];
    uint32_t all = count->left, placed = 0;
    for (int cheap = 0; cheap < 2; cheap++) {
      for (uint32_t i = 0; i < all; i++)
        if ((c->cost[block[i].a] < cost) == cheap) sorted[placed++] = block[i];
      if (!cheap) count->waiting = placed;
    }
    count->left = all - count->waiting;
    memcpy(block, sorted, all * sizeof *sorted);
  }
}

/* near[u n + v]: u and v are corners of one triangle, or the same. */
static bool *find_neighbours(const scree_halfmesh *s) {
  size_t n = s->vertex_count;
  bool *near = room(n * n, sizeof *near, 0);
  for (size_t v = 0; v < n; v++) near[v * n + v] = true;
  for (size_t h = 0; h < 3 * s->triangle_count; h++)
    for (size_t i = 0; i < 3; i++) near[s->half[h].from * n + s->half[h - h % 3 + i].from] = true;
  return near;
}

static bool share_apex(const scree_ring *x, const scree_ring *y) {
  return x->c == y->c || (x->d != SCREE_NONE && x->d == y->d) || x->c == y->d || x->d == y->c;
}

static bool are_independent(const bool *near, size_t n, const scree_ring *x, const scree_ring *y) {
  return !near[x->a * n + y->a] && !near[x->a * n + y->b] && !near[x->b * n + y->a] &&
         !near[x->b * n + y->b] && !share_apex(x, y);
}

/* The order that the header promises: equal costs as the engine has them, which is the same for
 * all pairs. */
static bool goes_before(const choice *c, uint32_t u, uint32_t v) {
  if (c->cost[u] != c->cost[v]) return c->cost[u] < c->cost[v];
  return u * 0x9e3779b1u < v * 0x9e3779b1u;
}

/* taken[v]: the walk takes v's candidate. */
static void walk_in_order(const choice *c, bool *taken) {
  size_t n = c->s.vertex_count, count = 0, kept = 0;
  uint32_t *order = room(n, sizeof *order, 0);
  scree_ring *rings = room(n, sizeof *rings, 0);
  bool *near = find_neighbours(&c->s);
  for (uint32_t v = 0; v < n; v++) {
    taken[v] = false;
    if (c->best[v] == SCREE_NONE) continue;
    size_t i = count++;
    for (; i > 0 && goes_before(c, v, order[i - 1]); i--) order[i] = order[i - 1];
    order[i] = v;
  }
  for (size_t i = 0; i < count; i++) {
    bool free = true;
    scree_ring_name(&c->s, c->best[order[i]], &rings[kept]);
    for (size_t k = 0; k < kept && free; k++)
      free = are_independent(near, n, &rings[kept], &rings[k]);
    if (!free) continue;
    kept++;
    taken[order[i]] = true;
  }
  scree_free(order);
  scree_free(rings);
  scree_free(near);
}

static void compare(const choice *c, const bool *taken) {
  size_t n = c->s.vertex_count;
  uint32_t edges[SCREE_RING_MAX];
  bool *chosen = room(n, sizeof *chosen, 0), *used = room(c->s.triangle_count, sizeof *used, 0);
  for (size_t k = 0; k < c->blocks; k++) {
    const struct scree_choice_count *count = &c->choosing.counts[k];
    assert_int_equal(count->left, 0);
    for (uint32_t i = 1; i <= count->taken; i++) {
      const scree_contender *t = &c->choosing.contenders[(k + 1) * SCREE_CHOICE_BLOCK - i];
      scree_ring r = {.edge = edges};
      assert_int_equal(t->taken / SCREE_CHOICE_BLOCK, k);
      chosen[t->taken] = true;
      assert_true(scree_ring_gather(&c->s, c->best[t->taken], &r));
      assert_int_equal(t->count, r.count);
      assert_int_equal(t->a_count, r.a_count);
      assert_memory_equal(c->choosing.edges + t->first_edge, edges, r.count * sizeof *edges);
      for (uint32_t e = 0; e < r.count; e++) { /* no triangle is in two rings */
        assert_false(used[r.edge[e] / 3]);
        used[r.edge[e] / 3] = true;
      }
    }
  }
  for (uint32_t v = 0; v < n; v++) {
    assert_int_equal(chosen[v], taken[v]);
    assert_int_equal(c->choosing.leader[v], SCREE_NONE);
    assert_int_equal(c->choosing.apex_leader[v], SCREE_NONE);
  }
  scree_free(chosen);
  scree_free(used);
}

static void try_mesh(const scree_mesh *mesh, scree_rng *rng) {
  static const double shares[] = {0.1, 0.6, 1};
  static const uint64_t values[] = {1, 20, 1000000};
  for (int i = 0; i < 9; i++) {
    scree_set_threads(1 + i % 4);
    choice c;
    prepare(mesh, &c);
    bool *taken = room(c.s.vertex_count, sizeof *taken, 0);
    draw_candidates(&c, shares[i % 3], values[i / 3], rng);
    let_wait(&c, (double)values[i / 3] * (double)(i % 4) / 3);
    for (size_t k = 0; k < c.blocks; k++) scree_choose_enter(&c.choosing, k);
    scree_choose_independent(&c.choosing);
    walk_in_order(&c, taken);
    compare(&c, taken);
    scree_free(taken);
    drop(&c);
  }
  scree_set_threads(0);
}

static void the_same_as_a_walk_in_the_order_of_cost(void **state) {
  (void)state;
  scree_rng rng = {.seed = 7};
  scree_mesh sphere = shape_icosphere(1, 4), sheet = shape_sheet(0, 36),
             torus = shape_torus(2, 0.5, 60, 12), tetrahedron = shape_tetrahedron(1, 1, 1);
  try_mesh(&sphere, &rng);
  try_mesh(&sheet, &rng);
  try_mesh(&torus, &rng);
  try_mesh(&tetrahedron, &rng);
  scree_mesh_free(&sphere);
  scree_mesh_free(&sheet);
  scree_mesh_free(&torus);
  scree_mesh_free(&tetrahedron);
}

/* A fan of more triangles than a ring may have: its edges are noted as refused, not taken. */
static void too_long_a_ring_is_refused(void **state) {
  (void)state;
  enum { SPOKES = SCREE_RING_MAX + 20 };
  scree_mesh cone = shape_make(SPOKES + 2, 2 * SPOKES);
  vec3_store(cone.positions, (vec3){0, 0, 1});
  vec3_store(cone.positions + 3, (vec3){0, 0, -1});
  for (uint32_t i = 0; i < SPOKES; i++) {
    double angle = 2 * acos(-1) * i / SPOKES;
    uint32_t here = 2 + i, next = 2 + (i + 1) % SPOKES;
    vec3_store(cone.positions + 3 * (size_t)here, (vec3){cos(angle), sin(angle), 0});
    memcpy(cone.triangles + 6 * (size_t)i, (uint32_t[]){0, here, next, 1, next, here},
           6 * sizeof *cone.triangles);
  }
  choice c;
  prepare(&cone, &c);
  scree_ring r;
  uint32_t h = c.s.vertex[0].outgoing;
  c.best[0] = h;
  scree_ring_name(&c.s, h, &r);
  c.choosing.contenders[0] = (scree_contender){.a = r.a, .b = r.b, .c = r.c, .d = r.d};
  c.choosing.counts[0].left = 1;
  scree_choose_enter(&c.choosing, 0);
  scree_choose_independent(&c.choosing);
  assert_int_equal(c.choosing.counts[0].taken, 0);
  assert_int_equal(c.s.refused[h], SCREE_EDGE_REFUSED);
  drop(&c);
  scree_mesh_free(&cone);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_same_as_a_walk_in_the_order_of_cost),
      cmocka_unit_test(too_long_a_ring_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
