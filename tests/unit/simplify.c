#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/curve.h"
#include "support/shapes.h"

#include "base/alloc.h"
#include "simplify/flat_fan.h"

static const scree_method methods[] = {SCREE_METHOD_VOLUME, SCREE_METHOD_QECD};

/* Closed, manifold, oriented, without degenerate facets; measures as the record says. */
static void check_level(const scree_curve *curve, size_t index, const scree_mesh *mesh) {
  scree_error error;
  scree_level level;
  scree_topology topology;
  double area, volume;
  scree_curve_level(curve, index, &level);
  assert_int_equal(mesh->triangle_count, level.triangle_count);
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  assert_true(topology.closed && topology.manifold && topology.oriented);
  assert_int_equal(topology.degenerate_facet_count, 0);
  assert_int_equal(topology.unused_vertex_count, 0);
  CHECK_OK(scree_mesh_area_volume(mesh, &area, &volume, &error), error);
  CHECK_NEAR(level.area, area, 1e-12 * area);
  CHECK_NEAR(level.volume, volume, 1e-12 * fabs(volume));
}

static void every_level_is_sound_and_as_recorded(void **state) {
  (void)state;
  scree_rng rng = {.seed = 3};
  for (int m = 0; m < 2; m++)
    for (int shape = 0; shape < 3; shape++) {
      scree_mesh mesh = shape == 0   ? shape_icosphere(0.02, 3)
                        : shape == 1 ? shape_torus(0.03, 0.01, 24, 12)
                                     : shape_grid_box(0.1, 0.05, 0.02, 8);
      if (shape == 1) shape_shake(&mesh, 2e-4, &rng);
      scree_curve *curve = curve_of(&mesh, methods[m]);
      scree_curve_facts facts = scree_curve_get_facts(curve);
      assert_true(facts.closed);
      assert_int_equal(facts.shell_count, 1);
      assert_int_equal(facts.boundary_edge_count, 0);
      /* a sphere of few triangles and its volume has far corners, which are refused */
      if (shape != 1) assert_true(facts.floor_count <= (shape == 0 ? 18 : 8));
      scree_replay *replay = NULL;
      scree_error error;
      CHECK_OK(scree_replay_start(curve, &replay, &error), error);
      scree_level first, level;
      scree_curve_level(curve, 0, &first);
      for (size_t i = 0; i < scree_curve_level_count(curve); i++) {
        const scree_mesh *now;
        CHECK_OK(scree_replay_step(replay, i, &now, &error), error);
        check_level(curve, i, now);
        scree_curve_level(curve, i, &level);
        if (methods[m] == SCREE_METHOD_VOLUME)
          CHECK_NEAR(level.volume, first.volume, 1e-12 * first.volume);
        assert_int_equal(scree_curve_find(curve, level.triangle_count), i);
      }
      scree_replay_free(replay);
      scree_curve_free(curve);
      scree_mesh_free(&mesh);
    }
}

static void a_box_goes_to_its_twelve_triangles(void **state) {
  (void)state;
  for (int m = 0; m < 2; m++) {
    scree_mesh mesh = shape_grid_box(0.1, 0.05, 0.02, 16), twelve;
    scree_curve *curve = curve_of(&mesh, methods[m]);
    size_t level = scree_curve_find(curve, 12);
    scree_level at;
    scree_error error;
    scree_curve_level(curve, level, &at);
    assert_int_equal(at.triangle_count, 12);
    CHECK_NEAR(at.area, 2 * (0.1 * 0.05 + 0.05 * 0.02 + 0.02 * 0.1), 1e-15);
    CHECK_OK(scree_curve_mesh(curve, level, &twelve, &error), error);
    check_level(curve, level, &twelve);
    scree_mesh_free(&twelve);
    scree_curve_free(curve);
    scree_mesh_free(&mesh);
  }
}

/* A number that any difference in the record changes. */
static uint64_t fingerprint(const scree_curve *curve) {
  uint64_t hash = scree_curve_level_count(curve);
  for (size_t i = 0; i < scree_curve_level_count(curve); i++) {
    scree_level level;
    uint64_t bits;
    scree_curve_level(curve, i, &level);
    memcpy(&bits, &level.area, sizeof bits);
    hash = hash * UINT64_C(6364136223846793005) + bits;
  }
  return hash;
}

static scree_mesh bumpy_sphere(int level, uint64_t seed) {
  scree_rng rng = {.seed = seed};
  scree_mesh mesh = shape_icosphere(0.03, level);
  shape_shake(&mesh, 0.03 * 0.2 / (double)(1 << level), &rng);
  return mesh;
}

/* A ring with square teeth: most collapses would fold, and wait for others about them. */
static scree_mesh toothed_ring(void) {
  enum { AROUND = 80, ACROSS = 6, TOOTH = 2 };
  scree_mesh mesh = shape_torus(0.03, 0.008, AROUND, ACROSS);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double stretch = v / ACROSS / TOOTH % 2 ? 1.15 : 1;
    mesh.positions[3 * v] *= stretch;
    mesh.positions[3 * v + 1] *= stretch;
  }
  return mesh;
}

/* A prism of n sides, each end a fan about its middle, `height` above the end. */
static scree_mesh fan_prism(uint32_t n, double height) {
  scree_mesh mesh = shape_make(2 * n + 2, 4 * n);
  for (uint32_t i = 0; i < 2 * n; i++) {
    double angle = 2 * acos(-1) * (i % n) / n;
    vec3_store(mesh.positions + 3 * i, (vec3){cos(angle), sin(angle), i < n ? -2 : 2});
  }
  vec3_store(mesh.positions + 6 * (size_t)n, (vec3){0, 0, -2 - height});
  vec3_store(mesh.positions + 6 * (size_t)n + 3, (vec3){0, 0, 2 + height});
  for (uint32_t i = 0; i < n; i++) {
    uint32_t j = (i + 1) % n;
    const uint32_t four[12] = {i, j, n + j, i, n + j, n + i, j, i, 2 * n, n + i, n + j, 2 * n + 1};
    memcpy(mesh.triangles + 12 * (size_t)i, four, sizeof four);
  }
  return mesh;
}

/* Of 10 segments to 6,000, flat and pointed: it comes down to few triangles, and all levels on the
 * way are sound. */
static void fans_of_any_size_are_decimated(void **state) {
  (void)state;
  static const uint32_t sizes[] = {10, 128, 300, 6000};
  for (int i = 0; i < 8; i++) {
    scree_mesh mesh = fan_prism(sizes[i / 2], i % 2 ? 0.5 : 0);
    scree_curve *curve;
    scree_error error;
    if (i == 7) { /* pointed ones take the time of their square */
      scree_mesh_free(&mesh);
      mesh = fan_prism(1000, 0.5);
    }
    CHECK_OK(scree_curve_build(&mesh, NULL, NULL, &curve, &error), error);
    assert_true(scree_curve_get_facts(curve).floor_count <= 12);
    static const size_t counts[] = {SIZE_MAX, 2000, 200, 40, 20};
    for (int k = 0; k < 5; k++) {
      scree_mesh level;
      size_t index = scree_curve_find(curve, counts[k]);
      CHECK_OK(scree_curve_mesh(curve, index, &level, &error), error);
      check_level(curve, index, &level);
      scree_mesh_free(&level);
    }
    scree_curve_free(curve);
    scree_mesh_free(&mesh);
  }
}

/* Flat fans become the same surface with few triangles at each vertex; pointed ones stay. */
static void flat_fans_are_cut_to_the_same_surface(void **state) {
  (void)state;
  for (int pointed = 0; pointed < 2; pointed++) {
    scree_mesh mesh = fan_prism(1000, pointed ? 0.5 : 0), cut = mesh;
    scree_measures was, is;
    scree_error error;
    uint32_t *triangles = NULL, most = 0, *many = calloc(mesh.vertex_count, sizeof *many);
    CHECK_OK(scree_flat_fans_cut(&mesh, &triangles, &error), error);
    cut.triangles = triangles;
    CHECK_OK(scree_mesh_measure(&mesh, &was, &error), error);
    CHECK_OK(scree_mesh_measure(&cut, &is, &error), error);
    assert_true(is.closed);
    CHECK_NEAR(is.area / was.area, 1, 1e-12);
    CHECK_NEAR(is.volume / was.volume, 1, 1e-12);
    for (size_t c = 0; c < 3 * cut.triangle_count; c++) {
      uint32_t count = ++many[cut.triangles[c]];
      most = count > most ? count : most;
    }
    assert_int_equal(pointed, most == 1000);
    if (!pointed) assert_true(most <= 128);
    free(many);
    scree_free(triangles);
    scree_mesh_free(&mesh);
  }
}

static void check_the_same_bits(scree_mesh mesh) {
  scree_rng rng = {.seed = 11};
  scree_mesh plain = shape_weld(&mesh, NULL);
  for (int m = 0; m < 2; m++) {
    scree_set_threads(1);
    scree_curve *curve = curve_of(&plain, methods[m]);
    uint64_t expected = fingerprint(curve);
    scree_curve_free(curve);
    for (int threads = 2; threads <= 8; threads += 1 + threads / 3 * 4) {
      scree_set_threads(threads);
      scree_mesh shuffled = shape_weld(&mesh, &rng);
      curve = curve_of(&shuffled, methods[m]);
      assert_true(fingerprint(curve) == expected);
      scree_curve_free(curve);
      scree_mesh_free(&shuffled);
    }
    scree_set_threads(0);
  }
  scree_mesh_free(&plain);
  scree_mesh_free(&mesh);
}

static void the_same_bits_for_any_threads_and_facet_order(void **state) {
  (void)state;
  check_the_same_bits(bumpy_sphere(5, 5));
  check_the_same_bits(toothed_ring());
}

static void passes_keep_every_promise(void **state) {
  (void)state;
  for (int m = 0; m < 2; m++) {
    scree_mesh mesh = bumpy_sphere(5, 9); /* 20,480 triangles: passes come first */
    scree_curve *curve = curve_of(&mesh, methods[m]);
    scree_replay *replay = NULL;
    scree_error error;
    scree_level first, level;
    scree_curve_level(curve, 0, &first);
    CHECK_OK(scree_replay_start(curve, &replay, &error), error);
    for (size_t i = 0; i < scree_curve_level_count(curve); i += 997) {
      const scree_mesh *now;
      CHECK_OK(scree_replay_step(replay, i, &now, &error), error);
      check_level(curve, i, now);
      scree_curve_level(curve, i, &level);
      if (m == 0) CHECK_NEAR(level.volume, first.volume, 1e-12 * first.volume);
    }
    scree_replay_free(replay);
    scree_curve_free(curve);
    scree_mesh_free(&mesh);
  }
}

/* So many cavities, and no other shell inside another or inside out. */
static void check_cavities(const scree_mesh *mesh, size_t count) {
  scree_check check;
  scree_error error;
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &check, &error), error);
  assert_int_equal(check.defects[SCREE_DEFECT_CAVITY], count);
  assert_int_equal(check.defects[SCREE_DEFECT_INSIDE_OUT_SHELL], 0);
  assert_int_equal(check.defects[SCREE_DEFECT_NESTED_SHELL], 0);
}

/* A body with small bubbles just below its surface and drops just above it, which coarse facets
 * could leap over without meeting them. */
static void shells_stay_in_and_beside_each_other(void **state) {
  (void)state;
  enum { BUBBLES = 6, DROPS = 6 };
  for (uint64_t seed = 0; seed < 3; seed++) {
    scree_rng rng = {.seed = seed};
    scree_mesh mesh = bumpy_sphere(seed % 3 == 2 ? 5 : 4, 17); /* 20,480: passes too */
    for (int i = 0; i < BUBBLES + DROPS; i++) {
      vec3 at = vec3_unit((vec3){scree_rng_uniform(&rng) - 0.5, scree_rng_uniform(&rng) - 0.5,
                                 scree_rng_uniform(&rng) - 0.5});
      scree_mesh small = shape_icosphere(3e-4, 0);
      for (size_t t = 0; i < BUBBLES && t < small.triangle_count; t++) shape_flip(&small, t);
      shape_move(&small, vec3_scale(at, i < BUBBLES ? 0.0285 : 0.0315));
      scree_mesh joined = shape_join(&mesh, &small);
      scree_mesh_free(&small);
      scree_mesh_free(&mesh);
      mesh = joined;
    }
    check_cavities(&mesh, BUBBLES);
    for (int m = 0; m < 2; m++) {
      scree_curve *curve = curve_of(&mesh, methods[m]);
      scree_replay *replay = NULL;
      scree_error error;
      CHECK_OK(scree_replay_start(curve, &replay, &error), error);
      size_t last = scree_curve_level_count(curve) - 1;
      for (size_t i = last % 101; i <= last; i += last - i > 200 ? 101 : 1) {
        const scree_mesh *now;
        CHECK_OK(scree_replay_step(replay, i, &now, &error), error);
        check_cavities(now, BUBBLES);
      }
      scree_replay_free(replay);
      scree_curve_free(curve);
    }
    scree_mesh_free(&mesh);
  }
}

static void moving_scaling_turning_change_rounding_only(void **state) {
  (void)state;
  scree_rng rng = {.seed = 2};
  for (int m = 0; m < 2; m++) {
    scree_mesh mesh = bumpy_sphere(5, 4), other = bumpy_sphere(5, 4);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    for (int i = 0; i < 9; i++) turn.m[i / 3][i % 3] *= 7;
    shape_transform(&other, &turn, (vec3){0.5, -2, 1});
    scree_curve *a = curve_of(&mesh, methods[m]), *b = curve_of(&other, methods[m]);
    for (size_t count = 16000; count > 100; count /= 2) {
      scree_level level_a, level_b;
      scree_curve_level(a, scree_curve_find(a, count), &level_a);
      scree_curve_level(b, scree_curve_find(b, count), &level_b);
      CHECK_NEAR(level_b.area / 49, level_a.area, 1e-6 * level_a.area);
    }
    scree_curve_free(a);
    scree_curve_free(b);
    scree_mesh_free(&mesh);
    scree_mesh_free(&other);
  }
}

/* A curve that is scaled afterwards is the other one times the factor, to the bit where that is a
 * power of two. */
static void a_scaled_curve_is_the_same_curve(void **state) {
  (void)state;
  static const double factor = 1024;
  for (int m = 0; m < 2; m++) {
    scree_mesh mesh = bumpy_sphere(4, 4), scaled = bumpy_sphere(4, 4);
    scree_simplify_options options = {.method = methods[m]};
    scree_curve *a = curve_of(&mesh, methods[m]), *b = NULL;
    scree_error error;
    assert_int_equal(scree_curve_build_scaled(&scaled, 0, &options, NULL, &b, &error),
                     SCREE_BAD_ARGUMENT);
    CHECK_OK(scree_curve_build_scaled(&scaled, factor, &options, NULL, &b, &error), error);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
      assert_true(scaled.positions[i] == factor * mesh.positions[i]);
    assert_int_equal(scree_curve_level_count(a), scree_curve_level_count(b));
    for (size_t i = 0; i < scree_curve_level_count(a); i += i < 4700 ? 47 : 1) {
      scree_level level_a, level_b;
      scree_mesh mesh_a, mesh_b;
      scree_curve_level(a, i, &level_a);
      scree_curve_level(b, i, &level_b);
      assert_int_equal(level_a.triangle_count, level_b.triangle_count);
      assert_true(level_b.area == level_a.area * factor * factor);
      assert_true(level_b.volume == level_a.volume * factor * factor * factor);
      assert_true(level_b.quadric_error == level_a.quadric_error * factor);
      CHECK_OK(scree_curve_mesh(a, i, &mesh_a, &error), error);
      CHECK_OK(scree_curve_mesh(b, i, &mesh_b, &error), error);
      assert_int_equal(mesh_a.vertex_count, mesh_b.vertex_count);
      for (size_t k = 0; k < 3 * mesh_a.vertex_count; k++)
        assert_true(mesh_b.positions[k] == factor * mesh_a.positions[k]);
      scree_mesh_free(&mesh_a);
      scree_mesh_free(&mesh_b);
    }
    scree_curve_free(b);
    scree_mesh_free(&scaled);
    scaled = bumpy_sphere(4, 4);
    options.error_limit = factor * 1e-4; /* of what comes out */
    CHECK_OK(scree_curve_build_scaled(&scaled, factor, &options, NULL, &b, &error), error);
    scree_level last;
    scree_curve_level(b, scree_curve_level_count(b) - 1, &last);
    assert_true(last.quadric_error <= options.error_limit && last.triangle_count > 8 &&
                last.triangle_count < mesh.triangle_count);
    scree_curve_free(a);
    scree_curve_free(b);
    scree_mesh_free(&mesh);
    scree_mesh_free(&scaled);
  }
}

/* The same surface with its vertices and triangles in another order. */
static scree_mesh renumbered(const scree_mesh *mesh, scree_rng *rng) {
  scree_mesh other = shape_make(mesh->vertex_count, mesh->triangle_count);
  uint32_t *number = malloc(mesh->vertex_count * sizeof *number);
  for (uint32_t v = 0; v < mesh->vertex_count; v++) {
    uint32_t w = scree_rng_below(rng, v + 1);
    number[v] = number[w];
    number[w] = v;
  }
  for (size_t v = 0; v < mesh->vertex_count; v++)
    memcpy(other.positions + 3 * (size_t)number[v], mesh->positions + 3 * v,
           3 * sizeof *mesh->positions);
  for (size_t t = 0; t < mesh->triangle_count; t++)
    for (size_t i = 0; i < 3; i++) /* 7919 is prime */
      other.triangles[3 * (t * 7919 % mesh->triangle_count) + i] =
          number[mesh->triangles[3 * t + i]];
  free(number);
  return other;
}

/* With no two costs equal nothing is decided by numbers. */
static void numbers_change_rounding_only(void **state) {
  (void)state;
  scree_rng rng = {.seed = 3};
  scree_mesh mesh = bumpy_sphere(5, 5), other = renumbered(&mesh, &rng);
  for (int m = 0; m < 2; m++) {
    scree_curve *a = curve_of(&mesh, methods[m]), *b = curve_of(&other, methods[m]);
    for (size_t count = 16000; count > 20; count = count * 3 / 4) {
      scree_level level_a, level_b;
      scree_curve_level(a, scree_curve_find(a, count), &level_a);
      scree_curve_level(b, scree_curve_find(b, count), &level_b);
      CHECK_NEAR(level_b.area, level_a.area, 1e-9 * level_a.area);
    }
    scree_curve_free(a);
    scree_curve_free(b);
  }
  scree_mesh_free(&mesh);
  scree_mesh_free(&other);
}

/* Open sheets, several shells, and tangles with edges of every kind: no crash, levels as recorded,
 * no more faults than at the start. */
static void any_mesh_is_taken(void **state) {
  (void)state;
  scree_rng rng = {.seed = 8};
  for (int round = 0; round < 300; round++) {
    scree_mesh mesh;
    if (round == 0) {
      scree_mesh low = shape_sheet(0, 12), high = shape_icosphere(1, 2);
      shape_move(&high, (vec3){0, 0, 5});
      mesh = shape_join(&low, &high);
      scree_mesh_free(&low);
      scree_mesh_free(&high);
    } else {
      mesh = shape_random_tangle(&rng);
    }
    for (int m = 0; m < 2; m++) {
      scree_simplify_options options = scree_default_simplify_options();
      scree_curve *curve = NULL;
      scree_error error;
      scree_topology before, after;
      scree_mesh last;
      options.method = methods[m];
      if (scree_curve_build(&mesh, &options, NULL, &curve, &error) != SCREE_OK) continue;
      size_t end = scree_curve_level_count(curve) - 1;
      scree_level level;
      scree_curve_level(curve, end, &level);
      CHECK_OK(scree_curve_mesh(curve, end, &last, &error), error);
      CHECK_OK(scree_mesh_topology(&mesh, &before, &error), error);
      CHECK_OK(scree_mesh_topology(&last, &after, &error), error);
      if (before.degenerate_facet_count == 0) {
        assert_int_equal(last.triangle_count, level.triangle_count);
        assert_true(after.non_manifold_edge_count <= before.non_manifold_edge_count);
        assert_true(after.degenerate_facet_count == 0);
      }
      if (round == 0) assert_true(level.triangle_count <= 20 && after.shell_count == 2);
      scree_mesh_free(&last);
      scree_curve_free(curve);
    }
    scree_mesh_free(&mesh);
  }
}

/* Two balls that share a vertex share it at every level. */
static void a_shared_vertex_stays_one(void **state) {
  (void)state;
  scree_mesh a = shape_icosphere(1, 3), b = shape_icosphere(1, 3);
  scree_error error;
  double top = -INFINITY;
  vec3 at = {0, 0, 0};
  for (size_t v = 0; v < a.vertex_count; v++) {
    vec3 x = vec3_load(a.positions + 3 * v);
    if (x.z > top) at = x;
    top = fmax(top, x.z);
  }
  for (size_t i = 0; i < 3 * b.vertex_count; i++) b.positions[i] = -b.positions[i];
  for (size_t t = 0; t < b.triangle_count; t++) {
    uint32_t *c = b.triangles + 3 * t, c0 = c[0];
    c[0] = c[1];
    c[1] = c0;
  }
  shape_move(&b, vec3_scale(at, 2)); /* its lowest vertex lies on the other's highest */
  scree_mesh loose = shape_join(&a, &b), mesh = shape_weld(&loose, NULL);
  assert_int_equal(mesh.vertex_count, a.vertex_count + b.vertex_count - 1);
  for (int m = 0; m < 2; m++) {
    scree_curve *curve = curve_of(&mesh, methods[m]);
    scree_replay *replay = NULL;
    assert_int_equal(scree_curve_get_facts(curve).locked_vertex_count, 2);
    CHECK_OK(scree_replay_start(curve, &replay, &error), error);
    for (size_t i = 0; i < scree_curve_level_count(curve); i++) {
      const scree_mesh *now;
      scree_topology topology;
      scree_level level;
      CHECK_OK(scree_replay_step(replay, i, &now, &error), error);
      CHECK_OK(scree_mesh_topology(now, &topology, &error), error);
      scree_curve_level(curve, i, &level);
      assert_int_equal(now->triangle_count, level.triangle_count);
      assert_int_equal(topology.non_manifold_vertex_count, 1);
    }
    scree_replay_free(replay);
    scree_curve_free(curve);
  }
  scree_mesh_free(&a);
  scree_mesh_free(&b);
  scree_mesh_free(&loose);
  scree_mesh_free(&mesh);
}

static void limits_stop_the_run(void **state) {
  (void)state;
  scree_mesh mesh = bumpy_sphere(4, 1);
  scree_simplify_options options = {.stop_count = 1001};
  scree_curve *curve = NULL;
  scree_error error;
  CHECK_OK(scree_curve_build(&mesh, &options, NULL, &curve, &error), error);
  assert_int_equal(scree_curve_get_facts(curve).floor_count, 1000);
  scree_curve_free(curve);
  options = (scree_simplify_options){.error_limit = 1e-4};
  CHECK_OK(scree_curve_build(&mesh, &options, NULL, &curve, &error), error);
  scree_level last;
  scree_curve_level(curve, scree_curve_level_count(curve) - 1, &last);
  assert_true(last.quadric_error <= 1e-4 && last.triangle_count > 8 && last.triangle_count < 5120);
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
}

/* The level of a run that stops there is that of one that goes on; of a closed body, and of one
 * beside a sheet, where one triangle may go at a time. */
static void a_stop_changes_no_level(void **state) {
  (void)state;
  static const size_t stops[] = {1126, 1001, 872, 700, 202, 201, 200, 101, 40};
  scree_mesh ball = bumpy_sphere(3, 1), sheet = shape_sheet(0, 12), bodies[2];
  shape_move(&sheet, (vec3){0, 0, 5});
  bodies[0] = ball;
  bodies[1] = shape_join(&ball, &sheet);
  for (int k = 0; k < 2; k++) {
    scree_simplify_options options = scree_default_simplify_options();
    scree_curve *whole, *part;
    scree_error error;
    CHECK_OK(scree_curve_build(&bodies[k], &options, NULL, &whole, &error), error);
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++) {
      scree_mesh a, b;
      options.stop_count = stops[i];
      CHECK_OK(scree_curve_build(&bodies[k], &options, NULL, &part, &error), error);
      size_t last = scree_curve_level_count(part) - 1;
      assert_int_equal(last, scree_curve_find(whole, stops[i]));
      CHECK_OK(scree_curve_mesh(whole, last, &a, &error), error);
      CHECK_OK(scree_curve_mesh(part, last, &b, &error), error);
      assert_int_equal(a.triangle_count, b.triangle_count);
      assert_int_equal(a.vertex_count, b.vertex_count);
      assert_memory_equal(a.triangles, b.triangles, 3 * a.triangle_count * sizeof *a.triangles);
      assert_memory_equal(a.positions, b.positions, 3 * a.vertex_count * sizeof *a.positions);
      scree_mesh_free(&a);
      scree_mesh_free(&b);
      scree_curve_free(part);
    }
    scree_curve_free(whole);
    scree_mesh_free(&bodies[k]);
  }
  scree_mesh_free(&sheet);
}

static scree_status build_and_rebuild(void *context, scree_error *error) {
  scree_simplify_options options = {.stop_count = ((scree_mesh *)context)->triangle_count / 2};
  scree_curve *curve = NULL;
  scree_mesh mesh;
  scree_status status = scree_curve_build(context, &options, NULL, &curve, error);
  if (status == SCREE_OK) status = scree_curve_mesh(curve, 3, &mesh, error);
  if (status == SCREE_OK) scree_mesh_free(&mesh);
  scree_curve_free(curve);
  return status;
}

/* The mesh is scaled by what succeeds alone. */
static scree_status build_scaled(void *context, scree_error *error) {
  scree_mesh *mesh = context;
  double before = mesh->positions[0];
  scree_curve *curve = NULL;
  scree_status status = scree_curve_build_scaled(mesh, 2, NULL, NULL, &curve, error);
  assert_true(mesh->positions[0] == (status == SCREE_OK ? 2 : 1) * before);
  scree_curve_free(curve);
  return status;
}

static void failing_memory_is_told(void **state) {
  (void)state;
  scree_mesh small = shape_icosphere(1, 1), large = bumpy_sphere(5, 1);
  check_allocation_failures(build_and_rebuild, &small);
  check_allocation_failures(build_and_rebuild, &large);
  check_allocation_failures(build_scaled, &small);
  scree_mesh_free(&small);
  scree_mesh_free(&large);
}

static void bad_input_is_refused_with_a_sentence(void **state) {
  (void)state;
  scree_mesh mesh = shape_box(1, 1, 1);
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  mesh.positions[4] = NAN;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_MESH);
  mesh.positions[4] = 0;
  mesh.triangles[5] = 99;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "99"));
  mesh.triangle_count = 0;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_MESH);
  options.error_limit = -1;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_ARGUMENT);
  assert_null(curve);
  mesh.triangle_count = 12;
  scree_mesh_free(&mesh);
}

typedef struct watched {
  double last;
  size_t count, stop_after;
} watched;

static bool watch(void *context, const char *phase, double fraction) {
  watched *w = context;
  (void)phase;
  assert_true(fraction >= w->last && fraction <= 1);
  w->last = fraction;
  return ++w->count < w->stop_after;
}

static void progress_grows_and_stops_the_run(void **state) {
  (void)state;
  scree_mesh ball = bumpy_sphere(5, 3);
  for (size_t stop_after = 5; stop_after < 1000; stop_after += 900) {
    scree_simplify_options options = scree_default_simplify_options();
    watched w = {.stop_after = stop_after};
    const scree_progress progress = {watch, &w, 0};
    scree_curve *curve = NULL;
    scree_error error;
    scree_status status = scree_curve_build(&ball, &options, &progress, &curve, &error);
    assert_int_equal(status, stop_after == 5 ? SCREE_CANCELLED : SCREE_OK);
    if (status == SCREE_OK) assert_true(w.count > 50 && w.last > 0.9);
    if (status != SCREE_OK) assert_int_equal(w.count, stop_after);
    scree_curve_free(curve);
  }
  scree_mesh_free(&ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_level_is_sound_and_as_recorded),
      cmocka_unit_test(a_box_goes_to_its_twelve_triangles),
      cmocka_unit_test(fans_of_any_size_are_decimated),
      cmocka_unit_test(flat_fans_are_cut_to_the_same_surface),
      cmocka_unit_test(the_same_bits_for_any_threads_and_facet_order),
      cmocka_unit_test(passes_keep_every_promise),
      cmocka_unit_test(shells_stay_in_and_beside_each_other),
      cmocka_unit_test(moving_scaling_turning_change_rounding_only),
      cmocka_unit_test(a_scaled_curve_is_the_same_curve),
      cmocka_unit_test(numbers_change_rounding_only),
      cmocka_unit_test(any_mesh_is_taken),
      cmocka_unit_test(a_shared_vertex_stays_one),
      cmocka_unit_test(limits_stop_the_run),
      cmocka_unit_test(a_stop_changes_no_level),
      cmocka_unit_test(failing_memory_is_told),
      cmocka_unit_test(progress_grows_and_stops_the_run),
      cmocka_unit_test(bad_input_is_refused_with_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
