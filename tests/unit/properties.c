/* What must not change where a scan's facets come in another order, or the scan is scaled, moved or
 * turned: from the loose facets through welding, check, measures, decimation to the choice; unions
 * of shells, and the distance between surfaces. Repair: tests/unit/repair.c. */
#include "base/vec.h"
#include "support/check.h"
#include "support/shapes.h"

typedef struct result {
  scree_check check;
  scree_measures measures;
  scree_choice choice;
  size_t floor_count;
} result;

/* A rough body of 1280 facets with a cavity. */
static scree_mesh body(void) {
  scree_mesh outer = shape_icosphere(0.03, 3), inner = shape_icosphere(0.01, 1);
  scree_rng rng = {.seed = 61};
  shape_shake(&outer, 3e-4, &rng);
  for (size_t t = 0; t < inner.triangle_count; t++) shape_flip(&inner, t);
  scree_mesh both = shape_join(&outer, &inner);
  scree_mesh_free(&outer);
  scree_mesh_free(&inner);
  return both;
}

static result work(const scree_mesh *loose, scree_rng *rng, scree_method method) {
  result r;
  scree_error error;
  scree_mesh mesh = shape_weld(loose, rng);
  scree_simplify_options simplify = scree_default_simplify_options();
  scree_choice_options options = scree_default_choice_options();
  scree_curve *curve;
  options.rp_min = 0.01;
  options.rp_max = 1;
  simplify.method = method;
  CHECK_OK(scree_mesh_check(&mesh, NULL, NULL, &r.check, &error), error);
  CHECK_OK(scree_mesh_measure(&mesh, &r.measures, &error), error);
  CHECK_OK(scree_curve_build(&mesh, &simplify, NULL, &curve, &error), error);
  CHECK_OK(scree_choose(curve, &mesh, &options, NULL, &r.choice, &error), error);
  r.floor_count = scree_curve_get_facts(curve).floor_count;
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
  return r;
}

static void free_result(result *r) {
  scree_choice_free(&r->choice);
}

/* tolerance: relative, of what comes before decimation; choices agree where it is 0. */
static void expect_same(const result *a, const result *b, double scale, double tolerance) {
  assert_string_equal(a->check.verdict, b->check.verdict);
  assert_memory_equal(a->check.defects, b->check.defects, sizeof a->check.defects);
  double area = a->measures.area * scale * scale, volume = a->measures.volume * pow(scale, 3);
  CHECK_NEAR(b->measures.area, area, tolerance * area);
  CHECK_NEAR(b->measures.volume, volume, tolerance * volume);
  CHECK_NEAR(b->check.volume, a->check.volume * pow(scale, 3), tolerance * volume);
  for (int i = 0; i < 3; i++) {
    double moment = a->measures.principal_moments[i] * pow(scale, 5);
    CHECK_NEAR(b->measures.principal_moments[i], moment, 100 * tolerance * moment);
  }
  CHECK_NEAR(b->measures.convexity, a->measures.convexity, 10 * tolerance);
  assert_int_equal(a->choice.triangle_count, b->choice.triangle_count);
  if (tolerance > 0) return;
  assert_int_equal(a->floor_count, b->floor_count);
  assert_int_equal(a->choice.paper.triangle_count, b->choice.paper.triangle_count);
  assert_int_equal(a->choice.robust.triangle_count, b->choice.robust.triangle_count);
  for (size_t i = 0; i < a->choice.level_count; i++)
    assert_true(a->choice.levels[i].eps_s == b->choice.levels[i].eps_s);
}

static const scree_method methods[] = {SCREE_METHOD_VOLUME, SCREE_METHOD_QECD};

static void order_of_facets(void **state) {
  (void)state;
  scree_rng rng = {.seed = 62};
  scree_mesh mesh = body();
  for (int m = 0; m < 2; m++) {
    result first = work(&mesh, NULL, methods[m]);
    assert_true(first.check.usable && first.check.defects[SCREE_DEFECT_CAVITY] == 1);
    for (int round = 0; round < 4; round++) {
      result again = work(&mesh, &rng, methods[m]);
      expect_same(&first, &again, 1, 0);
      free_result(&again);
    }
    free_result(&first);
  }
  scree_mesh_free(&mesh);
}

/* A power of two changes no digit, so not even the choice. */
static void scale(void **state) {
  (void)state;
  scree_mesh mesh = body();
  for (int m = 0; m < 2; m++) {
    result first = work(&mesh, NULL, methods[m]);
    for (int power = -20; power <= 20; power += 10) {
      double factor = ldexp(1, power);
      scree_mesh scaled;
      scree_error error;
      CHECK_OK(scree_mesh_copy(&mesh, &scaled, &error), error);
      for (size_t i = 0; i < 3 * scaled.vertex_count; i++) scaled.positions[i] *= factor;
      result other = work(&scaled, NULL, methods[m]);
      expect_same(&first, &other, factor, 0);
      free_result(&other);
      scree_mesh_free(&scaled);
    }
    free_result(&first);
  }
  scree_mesh_free(&mesh);
}

/* Turned and moved, coordinates round, and of edges that cost nearly the same another goes first:
 * the choice moves within what a noisy curve leaves open. */
static void turn_and_move(void **state) {
  (void)state;
  scree_rng rng = {.seed = 63};
  scree_mesh mesh = body();
  result first = work(&mesh, NULL, SCREE_METHOD_VOLUME);
  for (int round = 0; round < 6; round++) {
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    scree_mesh moved;
    scree_error error;
    CHECK_OK(scree_mesh_copy(&mesh, &moved, &error), error);
    shape_transform(&moved, &turn, vec3_scale(scree_rng_direction(&rng), 0.1 * round));
    result other = work(&moved, &rng, SCREE_METHOD_VOLUME);
    expect_same(&first, &other, 1, 1e-12);
    double ratio =
        (double)other.choice.robust.triangle_count / (double)first.choice.robust.triangle_count;
    assert_true(ratio > 0.7 && ratio < 1.4);
    free_result(&other);
    scree_mesh_free(&moved);
  }
  free_result(&first);
  scree_mesh_free(&mesh);
}

/* ---- Two surfaces ---- */

/* Three balls that overlap in pairs, and two rough bodies beside each other's surfaces. */
typedef struct pair {
  scree_check check;       /* of the balls: the volume of their union */
  scree_measures repaired; /* of what repair makes of them */
  scree_distance distance; /* of the rough bodies */
} pair;

static scree_mesh balls(void) {
  scree_mesh all = shape_icosphere(0.02, 2);
  for (int i = 1; i < 3; i++) {
    scree_mesh ball = shape_icosphere(0.02 - 0.003 * i, 2);
    shape_move(&ball, (vec3){0.021 * i, 0.0052 * i, -0.0031 * i});
    scree_mesh both = shape_join(&all, &ball);
    scree_mesh_free(&all);
    scree_mesh_free(&ball);
    all = both;
  }
  return all;
}

static pair work_on_pairs(const scree_mesh *overlapping, const scree_mesh *a, const scree_mesh *b,
                          scree_rng *rng) {
  pair r;
  scree_error error;
  scree_distance_options options = scree_default_distance_options();
  scree_mesh mesh = shape_weld(overlapping, rng), first = shape_weld(a, rng),
             second = shape_weld(b, rng), repaired;
  options.hausdorff_gap = 1e-3;
  CHECK_OK(scree_mesh_check(&mesh, NULL, NULL, &r.check, &error), error);
  CHECK_OK(scree_mesh_repair(&mesh, NULL, NULL, &repaired, NULL, &error), error);
  CHECK_OK(scree_mesh_measure(&repaired, &r.repaired, &error), error);
  CHECK_OK(scree_mesh_distance(&first, &second, &options, NULL, &r.distance, &error), error);
  scree_mesh_free(&mesh);
  scree_mesh_free(&first);
  scree_mesh_free(&second);
  scree_mesh_free(&repaired);
  return r;
}

/* bits: of the distance, nothing may change. */
static void expect_same_pairs(const pair *a, const pair *b, double scale, bool bits) {
  double volume = a->check.volume * pow(scale, 3), tolerance = bits ? 1e-12 : 1e-9;
  assert_true(a->check.volume_known && b->check.volume_known);
  CHECK_NEAR(b->check.volume, volume, tolerance * volume);
  CHECK_NEAR(b->repaired.volume, a->repaired.volume * pow(scale, 3), tolerance * volume);
  CHECK_NEAR(b->repaired.volume, volume, 1e-9 * volume);
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
    assert_int_equal(a->check.defects[i], b->check.defects[i]);
  double mean = a->distance.forward.mean * scale, rms = a->distance.backward.rms * scale;
  double most = a->distance.hausdorff * scale;
  /* turned, other points of the same facets are sampled, and the bound is within 1e-3 */
  CHECK_NEAR(b->distance.forward.mean, mean, (bits ? 1e-12 : 1e-2) * mean);
  CHECK_NEAR(b->distance.backward.rms, rms, (bits ? 1e-12 : 1e-2) * rms);
  CHECK_NEAR(b->distance.hausdorff, most, (bits ? 1e-12 : 2e-3) * most);
}

/* Order of facets, scale, turn and move: the union's volume as check tells it and as repair makes
 * it, and the distance between two surfaces. */
static void unions_and_distances(void **state) {
  (void)state;
  scree_rng rng = {.seed = 64};
  scree_mesh three = balls(), a = shape_icosphere(0.03, 3), b = shape_icosphere(0.0305, 3), *all[3];
  all[0] = &three, all[1] = &a, all[2] = &b;
  shape_shake(&a, 3e-4, &rng);
  shape_shake(&b, 3e-4, &rng);
  pair first = work_on_pairs(&three, &a, &b, NULL);
  assert_true(first.check.defects[SCREE_DEFECT_CROSSING_PAIR] > 20);
  for (int round = 0; round < 3; round++) {
    pair other = work_on_pairs(&three, &a, &b, &rng);
    expect_same_pairs(&first, &other, 1, true);
  }
  for (int power = -10; power <= 10; power += 10) {
    double factor = ldexp(1, power);
    for (int m = 0; m < 3; m++)
      for (size_t i = 0; i < 3 * all[m]->vertex_count; i++) all[m]->positions[i] *= factor;
    pair other = work_on_pairs(&three, &a, &b, NULL);
    expect_same_pairs(&first, &other, factor, true);
    for (int m = 0; m < 3; m++)
      for (size_t i = 0; i < 3 * all[m]->vertex_count; i++) all[m]->positions[i] /= factor;
  }
  for (int round = 0; round < 4; round++) {
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    vec3 offset = vec3_scale(scree_rng_direction(&rng), 0.1 * round);
    for (int m = 0; m < 3; m++) shape_transform(all[m], &turn, offset);
    pair other = work_on_pairs(&three, &a, &b, NULL);
    expect_same_pairs(&first, &other, 1, false);
  }
  for (int m = 0; m < 3; m++) scree_mesh_free(all[m]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(order_of_facets),
      cmocka_unit_test(scale),
      cmocka_unit_test(turn_and_move),
      cmocka_unit_test(unions_and_distances),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
