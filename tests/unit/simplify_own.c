/* A patch's own triangles: searches among them answer as those among all do, before and after
 * collapses; and cells that one patch owns are no other's. */
#include "simplify/grid_cells.h"
#include "simplify/own.h"
#include "support/decimator.h"
#include "support/shapes.h"

#include <stdlib.h>
#include <string.h>

static scree_mesh rough_ball(double radius, int level, double share, scree_rng *rng) {
  scree_mesh mesh = shape_icosphere(radius, level);
  shape_roughen(&mesh, share, rng);
  return mesh;
}

/* A random edge that might go, to a place so far from its middle. */
static bool draw_edge(const scree_halfmesh *s, double far, scree_rng *rng, scree_ring *ring,
                      scree_change *change, scree_around *around) {
  uint32_t h = (uint32_t)(scree_rng_uniform(rng) * 3 * (double)s->triangle_count);
  if (s->half[h].from == SCREE_NONE || !scree_ring_gather(s, h, ring)) return false;
  vec3 middle = vec3_scale(vec3_add(s->vertex[ring->a].at, s->vertex[ring->b].at), 0.5);
  vec3 off = {scree_rng_normal(rng), scree_rng_normal(rng), scree_rng_normal(rng)};
  change->target = vec3_mad(middle, off, far);
  return scree_collapse_keeps_topology(s, ring) &&
         scree_collapse_check(s, ring, SCREE_LEAST_TURN, change, around);
}

static void answers_are_those_of_all(void **state) {
  (void)state;
  scree_error error;
  scree_rng rng = {.seed = 3};
  size_t clear = 0, refused = 0;
  uint32_t edges[SCREE_RING_MAX];
  scree_ring ring = {.edge = edges};
  scree_change change;
  scree_around around;
  for (int round = 0; round < 4; round++) {
    scree_mesh inner = rough_ball(0.0196, 3, 0.004, &rng);
    scree_mesh outer = rough_ball(0.02, 3, 0.004 + 0.002 * round, &rng);
    for (size_t t = 0; t < inner.triangle_count; t++) shape_flip(&inner, t);
    scree_mesh mesh = shape_join(&inner, &outer); /* a thin shell */
    scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
    scree_halfmesh *s = &d.s;
    scree_grid all = {.few = false};
    scree_own own;
    uint16_t *place_of = scree_alloc(s->triangle_count, sizeof *place_of);
    CHECK_OK(scree_grid_look_at_all(&all, &error), error);
    CHECK_OK(scree_own_allocate(&own, s->triangle_count, &error), error);
    for (uint32_t t = 0; t < s->triangle_count; t++) own.triangles[own.count++] = t;
    scree_own_enter(&own, &all, s, place_of);
    double far = 0.2 * sqrt(s->area / (double)s->triangle_count);
    for (int i = 0; i < 40000; i++) {
      if (!draw_edge(s, far, &rng, &ring, &change, &around)) continue;
      bool expected = scree_grid_clear(&all, s, &ring, change.target, NULL);
      assert_int_equal(scree_own_clear(&own, &all, s, &ring, change.target, &around), expected);
      clear += expected;
      refused += !expected;
      if (!expected || i % 2 != 0) continue;
      uint32_t gone[] = {ring.half_edge / 3, s->half[ring.half_edge].twin / 3};
      scree_collapse_apply(s, &ring, change.target);
      scree_own_follow(&own, &all, s, &ring, gone, place_of);
    }
    scree_own_free(&own);
    scree_grid_free(&all);
    scree_free(place_of);
    scree_decimator_free(&d);
    scree_mesh_free(&mesh);
    scree_mesh_free(&inner);
    scree_mesh_free(&outer);
  }
  print_message("%zu clear, %zu not\n", clear, refused);
  assert_true(clear > 1000 && refused > 100);
}

static const scree_halfmesh *sorted_surface;
static int by_x(const void *a, const void *b) {
  double x = sorted_surface->vertex[*(const uint32_t *)a].at.x;
  double y = sorted_surface->vertex[*(const uint32_t *)b].at.x;
  return (x > y) - (x < y);
}

/* Slices along x are patches. */
static uint32_t *slice(const scree_halfmesh *s) {
  uint32_t *order = scree_alloc(s->vertex_count, sizeof *order);
  uint32_t *place_of = scree_alloc(s->vertex_count, sizeof *place_of);
  for (uint32_t v = 0; v < s->vertex_count; v++) order[v] = v;
  sorted_surface = s;
  qsort(order, s->vertex_count, sizeof *order, by_x);
  for (uint32_t i = 0; i < s->vertex_count; i++) place_of[order[i]] = i;
  scree_free(order);
  return place_of;
}

static scree_grid_box cells_about(const scree_grid *g, const vec3 *at, size_t count) {
  vec3 low = scree_into_frame(g->frame, at[0]), high = low;
  for (size_t i = 1; i < count; i++) {
    vec3 p = scree_into_frame(g->frame, at[i]);
    low = vec3_min(low, p);
    high = vec3_max(high, p);
  }
  return scree_cells_of(g, low, high);
}

static bool apart(const scree_grid_box *a, const scree_grid_box *b) {
  for (int i = 0; i < 3; i++)
    if (a->low[i] > b->high[i] || b->low[i] > a->high[i]) return true;
  return false;
}

/* No triangle with a corner in another patch is in the box, and no other patch was given a cell of
 * it. */
static void check_box(const scree_grid *g, const scree_halfmesh *s, const scree_grid_box *c,
                      const uint32_t *place_of, size_t patch, size_t owner, uint8_t *given) {
  for (size_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    bool foreign = false;
    for (size_t i = 0; i < 3; i++) foreign |= place_of[s->half[3 * t + i].from] / patch != owner;
    if (!foreign) continue;
    scree_corners(s, t, at);
    scree_grid_box of_triangle = cells_about(g, at, 3);
    assert_true(apart(c, &of_triangle));
  }
  SCREE_FOR_CELLS(g, *c, cell) {
    assert_true(given[cell] == 0 || given[cell] == owner + 1);
    given[cell] = (uint8_t)(owner + 1);
  }
}

static void owned_cells_are_no_others(void **state) {
  (void)state;
  scree_error error;
  scree_rng rng = {.seed = 4};
  enum { PATCH = 430 };
  scree_mesh mesh = rough_ball(0.02, 4, 0.05, &rng);
  scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
  const scree_halfmesh *s = &d.s;
  scree_frame_of_places frame;
  scree_places places = {mesh.positions, 3, mesh.vertex_count};
  uint32_t edges[SCREE_RING_MAX], *place_of = slice(s);
  scree_ring ring = {.edge = edges};
  scree_change change;
  scree_around around;
  size_t owned = 0, not_owned = 0;
  /* in the unit box, as the surface is */
  for (size_t v = 0; v < mesh.vertex_count; v++)
    vec3_store(mesh.positions + 3 * v, s->vertex[v].at);
  CHECK_OK(scree_frame_find(&places, (vec3){0, 0, 0}, &frame, &error), error);
  CHECK_OK(scree_grid_shape_in(&d.grid, s, &frame, SCREE_EDGES_PER_CELL, &error), error);
  scree_grid_enter_owners(&d.grid, s, place_of, PATCH);
  uint8_t *given = scree_alloc_zero(d.grid.cell_count, 1);
  for (int i = 0; i < 12000; i++) {
    if (!draw_edge(s, 1e-3, &rng, &ring, &change, &around)) continue;
    vec3 at[2 * SCREE_RING_MAX + 1] = {change.target};
    for (uint32_t k = 0; k < ring.count; k++) {
      at[2 * k + 1] = s->vertex[s->half[ring.edge[k]].from].at;
      at[2 * k + 2] = s->vertex[scree_to(s, ring.edge[k])].at;
    }
    size_t owner = place_of[ring.a] / PATCH;
    bool owns = scree_grid_owns(&d.grid, s, &ring, change.target, owner);
    owned += owns;
    not_owned += !owns;
    if (!owns) continue;
    scree_grid_box c = cells_about(&d.grid, at, 2 * ring.count + 1);
    check_box(&d.grid, s, &c, place_of, PATCH, owner, given);
    assert_true(scree_grid_owns_fan(&d.grid, s, ring.a, owner));
    assert_false(scree_grid_owns(&d.grid, s, &ring, change.target, owner + 1));
  }
  print_message("%zu owned, %zu not\n", owned, not_owned);
  assert_true(owned > 1000 && not_owned > 1000);
  scree_free(given);
  scree_free(place_of);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(answers_are_those_of_all),
                                     cmocka_unit_test(owned_cells_are_no_others)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
