/* Any triangle soup becomes a wall: pieces of which every edge belongs to one facet or two, wound
 * alike, without facets that have no area or lie on others. What was done to a clean surface is
 * undone: noise of its corners, facets turned over, edges split on one side, slivers, facets twice,
 * sheets with two sides of other facets; what is added to it stays a piece of its own: baffles,
 * boxes that touch. Wherever points are asked, a mended solid is where it was. */
#include "mesh/repair/soup.h"
#include "base/vec.h"
#include "mesh/adjacency.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

static const double noise = 1e-7; /* m, of surfaces of about 1 m */

/* ---- loose triangles ---- */

typedef struct soup {
  double corners[9 * 4096];
  size_t count;
} soup;

static void add(soup *s, vec3 a, vec3 b, vec3 c) {
  double *t = s->corners + 9 * s->count++;
  vec3_store(t, a), vec3_store(t + 3, b), vec3_store(t + 6, c);
}

static vec3 corner(const soup *s, size_t t, int k) {
  return vec3_load(s->corners + 9 * t + 3 * k);
}

static void add_mesh(soup *s, const scree_mesh *mesh) {
  for (size_t t = 0; t < mesh->triangle_count; t++)
    add(s, scree_mesh_corner(mesh, t, 0), scree_mesh_corner(mesh, t, 1),
        scree_mesh_corner(mesh, t, 2));
}

static void shake(soup *s, scree_rng *rng) {
  for (size_t i = 0; i < 9 * s->count; i++)
    s->corners[i] += noise * (2 * scree_rng_uniform(rng) - 1);
}

static size_t turn_over(soup *s, double share, scree_rng *rng) {
  size_t turned = 0;
  for (size_t t = 0; t < s->count; t++) {
    if (scree_rng_uniform(rng) >= share) continue;
    vec3 b = corner(s, t, 1);
    vec3_store(s->corners + 9 * t + 3, corner(s, t, 2));
    vec3_store(s->corners + 9 * t + 6, b);
    turned++;
  }
  return turned;
}

/* Cuts an edge of a facet and not of its neighbour. */
static void cut(soup *s, scree_rng *rng) {
  size_t t = scree_rng_below(rng, s->count);
  int k = (int)scree_rng_below(rng, 3);
  vec3 a = corner(s, t, k), b = corner(s, t, (k + 1) % 3), c = corner(s, t, (k + 2) % 3),
       at = vec3_lerp(a, b, 0.2 + 0.6 * scree_rng_uniform(rng));
  double *own = s->corners + 9 * t;
  vec3_store(own, a), vec3_store(own + 3, at), vec3_store(own + 6, c);
  add(s, at, b, c);
}

/* A facet without area fills the gap that is none: in its place two come. */
static void put_sliver(soup *s, scree_rng *rng) {
  size_t t = scree_rng_below(rng, s->count);
  vec3 a = corner(s, t, 0), b = corner(s, t, 1), c = corner(s, t, 2),
       at = vec3_lerp(a, b, 0.3 + 0.4 * scree_rng_uniform(rng));
  double *own = s->corners + 9 * t;
  vec3_store(own, a), vec3_store(own + 3, at), vec3_store(own + 6, c);
  add(s, at, b, c);
  add(s, a, b, at);
}

static void repeat(soup *s, size_t count, scree_rng *rng) {
  for (size_t i = 0; i < count; i++) {
    size_t t = scree_rng_below(rng, s->count);
    int k = (int)scree_rng_below(rng, 3), turn = 1 + (int)scree_rng_below(rng, 2);
    add(s, corner(s, t, k), corner(s, t, (k + turn) % 3), corner(s, t, (k + 2 * turn) % 3));
  }
}

static scree_pieces mend(const soup *s) {
  scree_error error;
  scree_mesh mesh;
  scree_pieces pieces;
  CHECK_OK(scree_mesh_weld(s->corners, s->count, 0, &mesh, NULL, &error), error);
  CHECK_OK(scree_pieces_make(&mesh, &pieces, &error), error);
  scree_mesh_free(&mesh);
  return pieces;
}

/* ---- what holds of every result ---- */

static double area_of(const scree_mesh *mesh) {
  double sum = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++)
    sum += 0.5 * vec3_norm(vec3_triangle_normal(scree_mesh_corner(mesh, t, 0),
                                                scree_mesh_corner(mesh, t, 1),
                                                scree_mesh_corner(mesh, t, 2)));
  return sum;
}

static void check_edges(const scree_pieces *p) {
  scree_error error;
  scree_adjacency adjacency;
  size_t *piece_of = calloc(p->mesh.triangle_count, sizeof *piece_of);
  bool *open = calloc(p->count, sizeof *open);
  CHECK_OK(scree_adjacency_build(&p->mesh, &adjacency, &error), error);
  for (size_t i = 0; i < p->count; i++)
    for (size_t t = 0; t < p->items[i].count; t++) piece_of[p->items[i].first + t] = i;
  for (uint32_t h = 0; h < 3 * p->mesh.triangle_count; h++) {
    uint32_t g = adjacency.ring[h];
    assert_int_not_equal(g, SCREE_NO_HALF_EDGE);
    open[piece_of[h / 3]] |= g == h;
    if (g == h) continue;
    assert_int_equal(adjacency.ring[g], h);
    assert_int_equal(scree_half_edge_from(&p->mesh, h), scree_half_edge_to(&p->mesh, g));
    assert_int_equal(piece_of[g / 3], piece_of[h / 3]);
  }
  for (size_t i = 0; i < p->count; i++) assert_int_equal(open[i], !p->items[i].closed);
  scree_adjacency_free(&adjacency);
  free(piece_of);
  free(open);
}

/* Its mesh is a wall of the world, and nothing in it is to be mended but that its pieces may touch
 * each other. */
static void check_result(const scree_pieces *p) {
  scree_error error;
  size_t facets = 0;
  check_edges(p);
  for (size_t i = 0; i < p->count; i++) {
    assert_int_equal(p->items[i].first, facets);
    facets += p->items[i].count;
  }
  assert_int_equal(facets, p->mesh.triangle_count);
  scree_world *world;
  CHECK_OK(scree_world_create(NULL, &world, &error), error);
  scree_material steel = scree_default_material();
  CHECK_OK(scree_world_add_material(world, &steel, NULL, &error), error);
  scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &p->mesh};
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_world_free(world);
}

/* The same wall as the clean surface: area, and where it is solid. */
static void check_like(const scree_pieces *p, const scree_mesh *clean, double volume,
                       scree_rng *rng) {
  check_result(p);
  CHECK_NEAR(area_of(&p->mesh), area_of(clean), 1e-4 * area_of(clean));
  if (volume == 0) return;
  assert_int_equal(p->count, 1);
  assert_true(p->items[0].closed);
  CHECK_NEAR(fabs(p->items[0].volume), volume, 1e-4 * volume);
  scree_pieces whole;
  scree_error error;
  CHECK_OK(scree_pieces_make(clean, &whole, &error), error);
  for (int i = 0; i < 50; i++) {
    vec3 at = {1.4 * scree_rng_uniform(rng) - 0.2, 1.4 * scree_rng_uniform(rng) - 0.2,
               1.4 * scree_rng_uniform(rng) - 0.2};
    assert_int_equal(abs(scree_piece_winding(p, 0, at)), scree_piece_winding(&whole, 0, at));
  }
  scree_pieces_free(&whole);
}

/* ---- tests ---- */

static scree_mesh clean_surface(int kind, double *volume) {
  scree_mesh mesh;
  vec3 middle = {0.5, 0.5, 0.5};
  if (kind == 0) mesh = shape_grid_box(1, 0.8, 0.6, 3);
  if (kind == 1) mesh = shape_icosphere(0.5, 2), shape_move(&mesh, middle);
  if (kind == 2) mesh = shape_torus(0.35, 0.12, 16, 10), shape_move(&mesh, middle);
  if (kind == 3) mesh = shape_sheet(0.3, 6);
  *volume = 0;
  for (size_t t = 0; kind < 3 && t < mesh.triangle_count; t++)
    *volume +=
        vec3_dot(scree_mesh_corner(&mesh, t, 0),
                 vec3_cross(scree_mesh_corner(&mesh, t, 1), scree_mesh_corner(&mesh, t, 2))) /
        6;
  return mesh;
}

static void what_is_clean_stays(void **state) {
  (void)state;
  for (int kind = 0; kind < 4; kind++) {
    double volume;
    scree_error error;
    scree_pieces pieces;
    scree_mesh mesh = clean_surface(kind, &volume);
    CHECK_OK(scree_pieces_make(&mesh, &pieces, &error), error);
    assert_int_equal(pieces.count, 1);
    assert_int_equal(pieces.mesh.vertex_count, mesh.vertex_count);
    assert_int_equal(pieces.mesh.triangle_count, mesh.triangle_count);
    assert_memory_equal(pieces.mesh.positions, mesh.positions,
                        3 * mesh.vertex_count * sizeof *mesh.positions);
    assert_memory_equal(pieces.mesh.triangles, mesh.triangles,
                        3 * mesh.triangle_count * sizeof *mesh.triangles);
    const scree_wall_mending none = {0};
    assert_memory_equal(&pieces.mending, &none, sizeof none);
    scree_pieces_free(&pieces);
    scree_mesh_free(&mesh);
  }
}

static soup s; /* large */

static void what_was_done_is_undone(void **state) {
  (void)state;
  for (uint64_t seed = 0; seed < 200; seed++) {
    scree_rng rng = {.seed = seed, .stream = 1};
    double volume;
    scree_mesh clean = clean_surface((int)(seed % 4), &volume);
    s.count = 0;
    add_mesh(&s, &clean);
    uint64_t what = 1 + scree_rng_below(&rng, 31); /* some of all */
    for (int i = 0; what & 1 && i < 12; i++) cut(&s, &rng);
    for (int i = 0; what & 2 && i < 12; i++) put_sliver(&s, &rng);
    if (what & 4) repeat(&s, s.count / 4, &rng);
    size_t turned = what & 8 ? turn_over(&s, 0.3, &rng) : 0;
    if (what & 16) shake(&s, &rng);
    scree_pieces pieces = mend(&s);
    check_like(&pieces, &clean, volume, &rng);
    if (what == 8) assert_int_equal(pieces.mending.turned, turned);
    scree_pieces_free(&pieces);
    scree_mesh_free(&clean);
  }
}

/* A sheet once more with its other side out and its squares cut along the other diagonal, or the
 * same side once more: one half stays. */
static void two_sides_become_one(void **state) {
  (void)state;
  for (uint64_t seed = 0; seed < 40; seed++) {
    scree_rng rng = {.seed = seed, .stream = 2};
    const size_t n = 5;
    bool other_side = seed & 1, bent = seed & 2;
    s.count = 0;
    double area = 0;
    for (size_t half = 0; half < 2; half++)
      for (size_t i = 0; i < n * n; i++) {
        vec3 c[4];
        for (int k = 0; k < 4; k++) {
          double x = (double)(i % n + (size_t)(k == 1 || k == 2)) / (double)n,
                 y = (double)(i / n + (size_t)(k >= 2)) / (double)n;
          c[k] = (vec3){x, bent ? scree_cos(2 * y) : y, bent ? scree_sin(2 * y) : 0.1};
        }
        size_t first = s.count, from = half;
        add(&s, c[from], c[from + 1], c[from + 2]);
        add(&s, c[from], c[from + 2], c[(from + 3) % 4]);
        for (size_t t = first; half && other_side && t < s.count; t++) {
          vec3 b = corner(&s, t, 1);
          vec3_store(s.corners + 9 * t + 3, corner(&s, t, 2));
          vec3_store(s.corners + 9 * t + 6, b);
        }
        for (size_t t = first; half == 0 && t < s.count; t++)
          area += 0.5 * vec3_norm(vec3_triangle_normal(corner(&s, t, 0), corner(&s, t, 1),
                                                       corner(&s, t, 2)));
      }
    if (seed & 4) shake(&s, &rng);
    if (seed & 8) turn_over(&s, 0.2, &rng);
    scree_pieces pieces = mend(&s);
    check_result(&pieces);
    assert_int_equal(pieces.count, 1);
    assert_int_equal(pieces.mesh.triangle_count, 2 * n * n);
    assert_int_equal(pieces.mending.doubled, 2 * n * n);
    assert_false(pieces.items[0].closed);
    CHECK_NEAR(area_of(&pieces.mesh), area, 1e-5);
    scree_pieces_free(&pieces);
  }
}

/* Walls across a closed box, welded to it or not, are sheets of their own, and the box is whole. */
static void baffles_are_sheets(void **state) {
  (void)state;
  for (uint64_t seed = 0; seed < 40; seed++) {
    scree_rng rng = {.seed = seed, .stream = 3};
    scree_mesh box = shape_grid_box(1, 1, 1, 4);
    size_t baffles = 1 + seed % 3;
    s.count = 0;
    add_mesh(&s, &box);
    for (size_t i = 0; i < baffles; i++) {
      double x = 0.25 * (double)(i + 1), top = seed & 1 ? 1 : 0.6;
      add(&s, (vec3){x, 0, 0}, (vec3){x, 1, 0}, (vec3){x, 1, top});
      add(&s, (vec3){x, 0, 0}, (vec3){x, 1, top}, (vec3){x, 0, top});
    }
    if (seed & 2) turn_over(&s, 0.3, &rng);
    if (seed & 4) shake(&s, &rng);
    scree_pieces pieces = mend(&s);
    check_result(&pieces);
    double closed = 0;
    for (size_t i = 0; i < pieces.count; i++) closed += fabs(pieces.items[i].volume);
    CHECK_NEAR(closed, 1, 1e-4);
    assert_int_equal(pieces.count, 1 + baffles);
    CHECK_NEAR(area_of(&pieces.mesh), area_of(&box) + (double)baffles * (seed & 1 ? 1 : 0.6), 1e-4);
    scree_pieces_free(&pieces);
    scree_mesh_free(&box);
  }
}

/* Boxes that touch over a face, an edge or a corner keep the volume of both, whatever they share.
 */
static void boxes_that_touch(void **state) {
  (void)state;
  static const double ways[][3] = {{1, 0, 0},     {1, 1, 0},     {1, 1, 1},  {1, 0.5, 0},
                                   {1, 0.3, 0.3}, {0.5, 0.5, 1}, {1, 1, 0.5}};
  for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
    for (size_t n = 1; n <= 4; n++) {
      scree_mesh one = shape_grid_box(1, 1, 1, n), other = shape_grid_box(1, 1, 1, 1 + n % 2);
      shape_move(&other, vec3_load(ways[i]));
      s.count = 0;
      add_mesh(&s, &one);
      add_mesh(&s, &other);
      scree_pieces pieces = mend(&s);
      check_result(&pieces);
      double closed = 0;
      for (size_t k = 0; k < pieces.count; k++) closed += pieces.items[k].volume;
      CHECK_NEAR(closed, 2, 1e-4);
      scree_pieces_free(&pieces);
      scree_mesh_free(&one);
      scree_mesh_free(&other);
    }
}

static void any_tangle_is_a_wall(void **state) {
  (void)state;
  size_t walls = 0, refused = 0;
  for (uint64_t seed = 0; seed < 3000; seed++) {
    scree_rng rng = {.seed = seed, .stream = 4};
    scree_mesh tangle = shape_random_tangle(&rng);
    scree_pieces pieces;
    scree_error error;
    if (scree_pieces_make(&tangle, &pieces, &error) == SCREE_OK) {
      check_result(&pieces);
      scree_pieces_free(&pieces);
      walls++;
    } else {
      assert_true(strstr(error.message, "none of its") || strstr(error.message, "no facets"));
      refused++;
    }
    scree_mesh_free(&tangle);
  }
  print_message("%zu walls, %zu without a facet that has an area\n", walls, refused);
  assert_true(walls > 5 * refused);
}

/* A band with one twist has no two sides: it is parted across. */
static void twisted_band(void **state) {
  (void)state;
  enum { N = 24 };
  s.count = 0;
  vec3 at[2 * (N + 1)];
  for (int i = 0; i <= N; i++)
    for (int k = 0; k < 2; k++) {
      double a = 2 * 3.14159265358979323846 * i / N, w = (k ? 0.2 : -0.2) * (i == N ? -1 : 1),
             half = i == N ? 0 : 0.5 * a, turn = i == N ? 0 : a;
      double r = 1 + w * scree_cos(half);
      at[2 * i + k] = (vec3){r * scree_cos(turn), r * scree_sin(turn), w * scree_sin(half)};
    }
  for (int i = 0; i < N; i++) {
    add(&s, at[2 * i], at[2 * i + 1], at[2 * i + 3]);
    add(&s, at[2 * i], at[2 * i + 3], at[2 * i + 2]);
  }
  scree_pieces pieces = mend(&s);
  check_result(&pieces);
  assert_int_equal(pieces.count, 1);
  assert_int_equal(pieces.mending.parted, 1);
  assert_int_equal(pieces.mesh.vertex_count, 2 * N + 2);
  scree_pieces_free(&pieces);
}

static scree_status make(void *context, scree_error *error) {
  scree_mesh wall = {0};
  scree_wall_mending mending;
  scree_status status = scree_wall_mend(context, &wall, &mending, error);
  if (status == SCREE_OK) assert_true(mending.doubled + mending.flat >= 18);
  scree_mesh_free(&wall);
  return status;
}

static void out_of_memory(void **state) {
  (void)state;
  scree_rng rng = {.seed = 7};
  scree_error error;
  scree_mesh sheet = shape_sheet(0, 3), mesh;
  s.count = 0;
  add_mesh(&s, &sheet);
  add_mesh(&s, &sheet);
  cut(&s, &rng);
  put_sliver(&s, &rng);
  CHECK_OK(scree_mesh_weld(s.corners, s.count, 0, &mesh, NULL, &error), error);
  check_allocation_failures(make, &mesh);
  scree_mesh_free(&mesh);
  scree_mesh_free(&sheet);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_clean_stays),  cmocka_unit_test(what_was_done_is_undone),
      cmocka_unit_test(two_sides_become_one), cmocka_unit_test(baffles_are_sheets),
      cmocka_unit_test(boxes_that_touch),     cmocka_unit_test(any_tangle_is_a_wall),
      cmocka_unit_test(twisted_band),         cmocka_unit_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
