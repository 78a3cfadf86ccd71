/* Adjacency and topology against an oracle that looks at all pairs, on thousands of tangles; and on
 * surfaces whose counts are known. */
#include "support/check.h"
#include "support/shapes.h"

#include "mesh/adjacency.h"

#define NEAR_FLAT                                                                                  \
  1e-9 /* tangles lie on an integer grid: a facet is flat or has area 1/2 at least */

static bool names_twice(const uint32_t *c) {
  return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

/* +1 where facet t runs along (a, b), -1 along (b, a), 0 where it has no such edge. */
static int runs_along(const scree_mesh *mesh, size_t t, uint32_t a, uint32_t b) {
  const uint32_t *c = mesh->triangles + 3 * t;
  if (names_twice(c)) return 0;
  for (int k = 0; k < 3; k++) {
    if (c[k] == a && c[(k + 1) % 3] == b) return 1;
    if (c[k] == b && c[(k + 1) % 3] == a) return -1;
  }
  return 0;
}

static bool has_vertex(const scree_mesh *mesh, size_t t, uint32_t v) {
  const uint32_t *c = mesh->triangles + 3 * t;
  return !names_twice(c) && (c[0] == v || c[1] == v || c[2] == v);
}

static bool share_edge(const scree_mesh *mesh, size_t s, size_t t) {
  const uint32_t *c = mesh->triangles + 3 * s;
  for (int k = 0; k < 3; k++)
    if (runs_along(mesh, s, c[k], c[(k + 1) % 3]) && runs_along(mesh, t, c[k], c[(k + 1) % 3]))
      return true;
  return false;
}

static bool share_edge_at(const scree_mesh *mesh, size_t s, size_t t, uint32_t v) {
  for (uint32_t w = 0; w < mesh->vertex_count; w++)
    if (w != v && runs_along(mesh, s, v, w) && runs_along(mesh, t, v, w)) return true;
  return false;
}

/* Pieces of the facets at vertex v (all facets where v is UINT32_MAX), by relabelling until nothing
 * changes. */
static size_t piece_count(const scree_mesh *mesh, uint32_t v) {
  size_t label[64], count = 0;
  bool all = v == UINT32_MAX, changed = true;
  for (size_t t = 0; t < mesh->triangle_count; t++)
    label[t] =
        (all ? !names_twice(mesh->triangles + 3 * t) : has_vertex(mesh, t, v)) ? t : SIZE_MAX;
  while (changed) {
    changed = false;
    for (size_t s = 0; s < mesh->triangle_count; s++)
      for (size_t t = 0; t < mesh->triangle_count; t++)
        if (label[s] != SIZE_MAX && label[t] != SIZE_MAX && label[s] < label[t] &&
            (all ? share_edge(mesh, s, t) : share_edge_at(mesh, s, t, v))) {
          label[t] = label[s];
          changed = true;
        }
  }
  for (size_t t = 0; t < mesh->triangle_count; t++) count += label[t] == t;
  return count;
}

static bool same_vertices(const uint32_t *a, const uint32_t *b) {
  for (int i = 0; i < 3; i++) {
    if (a[i] != b[0] && a[i] != b[1] && a[i] != b[2]) return false;
    if (b[i] != a[0] && b[i] != a[1] && b[i] != a[2]) return false;
  }
  return true;
}

static void oracle_facets(const scree_mesh *mesh, scree_topology *o) {
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *c = mesh->triangles + 3 * t;
    vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = vec3_load(mesh->positions + 3 * (size_t)c[k]);
    o->facet_count += !names_twice(c);
    o->degenerate_facet_count += vec3_norm(vec3_triangle_normal(p[0], p[1], p[2])) < NEAR_FLAT;
    for (size_t s = 0; s < t && !names_twice(c); s++)
      if (!names_twice(mesh->triangles + 3 * s) && same_vertices(c, mesh->triangles + 3 * s)) {
        o->duplicate_facet_count++;
        break;
      }
  }
}

static void oracle_edges(const scree_mesh *mesh, scree_topology *o, bool *on_boundary) {
  for (uint32_t a = 0; a < mesh->vertex_count; a++)
    for (uint32_t b = a + 1; b < mesh->vertex_count; b++) {
      size_t facets = 0;
      int balance = 0;
      for (size_t t = 0; t < mesh->triangle_count; t++) {
        int run = runs_along(mesh, t, a, b);
        facets += run != 0;
        balance += run;
      }
      o->edge_count += facets > 0;
      o->boundary_edge_count += facets == 1;
      o->non_manifold_edge_count += facets > 2;
      o->inconsistent_edge_count += facets == 2 && balance != 0;
      if (facets % 2 == 0 && balance != 0) o->oriented = false;
      on_boundary[a * mesh->vertex_count + b] = on_boundary[b * mesh->vertex_count + a] =
          facets == 1;
    }
}

static size_t oracle_boundaries(const scree_mesh *mesh, const bool *on_boundary) {
  size_t n = mesh->vertex_count, label[64], count = 0;
  for (size_t v = 0; v < n; v++) {
    label[v] = SIZE_MAX;
    for (size_t w = 0; w < n; w++)
      if (w != v && on_boundary[v * n + w]) label[v] = v;
  }
  for (size_t round = 0; round < n; round++)
    for (size_t v = 0; v < n; v++)
      for (size_t w = 0; w < n; w++)
        if (w != v && on_boundary[v * n + w] && label[v] < label[w]) label[w] = label[v];
  for (size_t v = 0; v < n; v++) count += label[v] == v;
  return count;
}

static scree_topology oracle(const scree_mesh *mesh) {
  scree_topology o = {.oriented = true};
  bool on_boundary[64 * 64] = {false};
  oracle_facets(mesh, &o);
  oracle_edges(mesh, &o, on_boundary);
  o.boundary_count = oracle_boundaries(mesh, on_boundary);
  o.shell_count = piece_count(mesh, UINT32_MAX);
  for (uint32_t v = 0; v < mesh->vertex_count; v++) {
    size_t fans = piece_count(mesh, v);
    o.vertex_count += fans > 0;
    o.unused_vertex_count += fans == 0;
    o.non_manifold_vertex_count += fans > 1;
  }
  o.closed = o.boundary_edge_count == 0;
  o.manifold = o.non_manifold_edge_count == 0 && o.non_manifold_vertex_count == 0;
  return o;
}

static void test_tangles(void **state) {
  (void)state;
  scree_rng rng = {.seed = 1};
  for (int i = 0; i < 4000; i++) {
    scree_mesh mesh = shape_random_tangle(&rng);
    scree_topology got, expected = oracle(&mesh);
    scree_error error;
    CHECK_OK(scree_mesh_topology(&mesh, &got, &error), error);
#define SAME(field) assert_int_equal(got.field, expected.field)
    SAME(vertex_count), SAME(unused_vertex_count), SAME(edge_count), SAME(facet_count);
    SAME(shell_count), SAME(boundary_edge_count), SAME(boundary_count);
    SAME(non_manifold_edge_count), SAME(non_manifold_vertex_count), SAME(inconsistent_edge_count);
    SAME(degenerate_facet_count), SAME(duplicate_facet_count);
    SAME(closed), SAME(manifold), SAME(oriented);
    scree_mesh_free(&mesh);
  }
}

/* Every ring holds exactly the half-edges between its two vertices, each once, ascending. */
static void test_rings(void **state) {
  (void)state;
  scree_rng rng = {.seed = 2};
  for (int i = 0; i < 2000; i++) {
    scree_mesh mesh = shape_random_tangle(&rng);
    scree_adjacency adjacency;
    scree_error error;
    CHECK_OK(scree_adjacency_build(&mesh, &adjacency, &error), error);
    for (uint32_t h = 0; h < 3 * mesh.triangle_count; h++) {
      if (names_twice(mesh.triangles + h - h % 3)) {
        assert_int_equal(adjacency.ring[h], SCREE_NO_HALF_EDGE);
        continue;
      }
      uint32_t from = scree_half_edge_from(&mesh, h), to = scree_half_edge_to(&mesh, h), next = h;
      size_t facets = 0;
      for (size_t t = 0; t < mesh.triangle_count; t++) facets += !!runs_along(&mesh, t, from, to);
      assert_int_equal(scree_edge_facet_count(&adjacency, h), facets);
      for (uint32_t g = h + 1; g < 3 * mesh.triangle_count && next == h; g++)
        if (!names_twice(mesh.triangles + g - g % 3) &&
            ((scree_half_edge_from(&mesh, g) == from && scree_half_edge_to(&mesh, g) == to) ||
             (scree_half_edge_from(&mesh, g) == to && scree_half_edge_to(&mesh, g) == from)))
          next = g;
      if (next != h) assert_int_equal(adjacency.ring[h], next);
    }
    scree_adjacency_free(&adjacency);
    scree_mesh_free(&mesh);
  }
}

static scree_topology topology_of(const scree_mesh *mesh) {
  scree_topology topology;
  scree_error error;
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  return topology;
}

static void check_whole(scree_mesh mesh, long long genus, size_t shells, size_t inward) {
  scree_topology t = topology_of(&mesh);
  assert_true(t.closed && t.manifold && t.oriented);
  assert_int_equal(t.genus, genus);
  assert_int_equal(t.shell_count, shells);
  assert_int_equal(t.inward_shell_count, inward);
  assert_int_equal(t.boundary_count, 0);
  assert_int_equal(2 * t.edge_count, 3 * t.facet_count);
  assert_int_equal(t.degenerate_facet_count, 0);
  scree_mesh_free(&mesh);
}

static void test_known_surfaces(void **state) {
  (void)state;
  check_whole(shape_box(1, 2, 3), 0, 1, 0);
  check_whole(shape_grid_box(1, 2, 3, 5), 0, 1, 0);
  check_whole(shape_tetrahedron(1e-3, 2e-3, 1e-3), 0, 1, 0);
  check_whole(shape_icosphere(1, 4), 0, 1, 0);
  check_whole(shape_torus(2, 1, 40, 20), 1, 1, 0);
  scree_mesh torus = shape_torus(2, 1, 12, 8), ball = shape_icosphere(9, 1);
  for (size_t t = 0; t < torus.triangle_count; t++) shape_flip(&torus, t);
  check_whole(shape_join(&torus, &ball), 1, 2, 1);
  scree_mesh_free(&torus);
  scree_mesh_free(&ball);
}

static void test_sheet_and_pinch(void **state) {
  (void)state;
  scree_mesh sheet = shape_sheet(0, 7);
  scree_topology t = topology_of(&sheet);
  assert_int_equal(t.boundary_edge_count, 28);
  assert_int_equal(t.boundary_count, 1);
  assert_int_equal(t.euler_characteristic, 1);
  assert_true(!t.closed && t.manifold && t.oriented && t.genus == -1);
  shape_flip(&sheet, 20);
  assert_int_equal(topology_of(&sheet).inconsistent_edge_count, 3);
  scree_mesh_free(&sheet);

  scree_mesh a = shape_tetrahedron(1, 1, 1), b = shape_tetrahedron(-1, -1, -1);
  scree_mesh two = shape_join(&a, &b);
  for (size_t i = 0; i < 3 * two.triangle_count; i++)
    if (two.triangles[i] == 4) two.triangles[i] = 0;
  t = topology_of(&two);
  assert_int_equal(t.non_manifold_vertex_count, 1);
  assert_int_equal(t.non_manifold_edge_count, 0);
  assert_int_equal(t.unused_vertex_count, 1);
  assert_int_equal(t.shell_count, 2);
  assert_int_equal(t.inward_shell_count, 1);
  assert_false(t.manifold);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
  scree_mesh_free(&two);
}

/* A hub that many facets share takes the long way through the sort. */
static void test_hub(void **state) {
  (void)state;
  size_t n = 500;
  scree_mesh mesh = shape_make(n + 2, 2 * n);
  for (size_t i = 0; i < n; i++) {
    double angle = 6.283185307179586 * (double)i / (double)n;
    vec3_store(mesh.positions + 3 * (i + 2), (vec3){cos(angle), sin(angle), 0});
    uint32_t here = (uint32_t)(i + 2), next = (uint32_t)((i + 1) % n + 2);
    const uint32_t two[6] = {0, here, next, 1, next, here};
    memcpy(mesh.triangles + 6 * i, two, sizeof two);
  }
  vec3_store(mesh.positions, (vec3){0, 0, 1});
  vec3_store(mesh.positions + 3, (vec3){0, 0, -1});
  check_whole(mesh, 0, 1, 0);
}

/* As many facets at one edge: in linear time, or this does not end. */
static void test_many_at_an_edge(void **state) {
  (void)state;
  size_t n = 300000;
  scree_mesh doubled = shape_make(3, n), fan = shape_make(n + 2, n);
  for (size_t i = 0; i < 3; i++) vec3_store(doubled.positions + 3 * i, (vec3){i == 1, i == 2, 0});
  for (size_t i = 0; i < 3 * n; i++) doubled.triangles[i] = (uint32_t)(i % 3);
  vec3_store(fan.positions, (vec3){0, 0, 0});
  vec3_store(fan.positions + 3, (vec3){0, 0, 1});
  for (size_t i = 0; i < n; i++) {
    const uint32_t corners[3] = {0, 1, (uint32_t)(i + 2)};
    vec3_store(fan.positions + 3 * (i + 2), (vec3){cos((double)i), sin((double)i), 0});
    memcpy(fan.triangles + 3 * i, corners, sizeof corners);
  }
  scree_topology t = topology_of(&doubled);
  assert_int_equal(t.duplicate_facet_count, n - 1);
  assert_int_equal(t.non_manifold_edge_count, 3);
  assert_int_equal(t.non_manifold_vertex_count, 0);
  t = topology_of(&fan);
  assert_int_equal(t.boundary_edge_count, 2 * n);
  assert_int_equal(t.non_manifold_edge_count, 1);
  assert_int_equal(t.non_manifold_vertex_count, 0);
  assert_int_equal(t.shell_count, 1);
  scree_mesh_free(&doubled);
  scree_mesh_free(&fan);
}

/* Thinner than the rounding of its coordinates is flat, wherever the mesh lies; above, it is not.
 */
static void test_flat_facets(void **state) {
  (void)state;
  for (double offset = 0; offset < 2e9; offset = offset * 1000 + 1) {
    scree_mesh mesh = shape_tetrahedron(1, 1, 1);
    double height = 64 * (offset + 1) * 2.3e-16;
    mesh.positions[9] = 0.5, mesh.positions[10] = height, mesh.positions[11] = 0;
    shape_move(&mesh, (vec3){offset, offset, offset});
    assert_int_equal(topology_of(&mesh).degenerate_facet_count, 0);
    mesh.positions[10] = mesh.positions[1];
    assert_int_equal(topology_of(&mesh).degenerate_facet_count, 1);
    scree_mesh_free(&mesh);
  }
}

static void test_bad_meshes(void **state) {
  (void)state;
  scree_topology topology = {.shell_count = 77};
  scree_error error;
  scree_mesh mesh = shape_box(1, 1, 1);
  mesh.triangles[16] = 8;
  assert_int_equal(scree_mesh_topology(&mesh, &topology, &error), SCREE_BAD_MESH);
  assert_string_equal(error.message, "triangle 5 names vertex 8, but there are only 8");
  mesh.triangles[16] = 0;
  mesh.positions[7] = INFINITY;
  assert_int_equal(scree_mesh_topology(&mesh, &topology, &error), SCREE_BAD_MESH);
  assert_string_equal(error.message, "vertex 2 has the coordinate y = inf, not finite");
  assert_int_equal(topology.shell_count, 77);
  scree_mesh_free(&mesh);
  scree_mesh empty = {0};
  CHECK_OK(scree_mesh_topology(&empty, &topology, &error), error);
  assert_int_equal(topology.shell_count, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_tangles),
      cmocka_unit_test(test_rings),
      cmocka_unit_test(test_known_surfaces),
      cmocka_unit_test(test_sheet_and_pinch),
      cmocka_unit_test(test_hub),
      cmocka_unit_test(test_many_at_an_edge),
      cmocka_unit_test(test_flat_facets),
      cmocka_unit_test(test_bad_meshes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
