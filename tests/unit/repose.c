#include "base/alloc.h"
#include "base/rng.h"
#include "base/vec.h"
#include "support/check.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979323846;

/* Heaps of known shape, written into the field directly. */
typedef double shape(double x, double y, const double *p);

static double cone_shape(double x, double y, const double *p) { /* apex x, y, height, tan */
  return p[2] - p[3] * hypot(x - p[0], y - p[1]);
}
static double truncated_shape(double x, double y, const double *p) {
  return fmin(p[4], cone_shape(x, y, p));
}
static double pyramid_shape(double x, double y, const double *p) { /* height, tan across a face */
  return p[0] - p[1] * fmax(fabs(x), fabs(y));
}
static double tilted_shape(double x, double y, const double *p) {
  return cone_shape(x, y, p) + p[4] * x;
}
static double layer_shape(double x, double y, const double *p) {
  return hypot(x, y) < 0.4 ? p[0] : 0;
}

static scree_repose measured(shape *surface, const double *p, double noise, double particle_size) {
  scree_height_field field;
  scree_error error;
  CHECK_OK(scree_height_field_create(0, 0, 0.5, 2e-3, &field, &error), error);
  scree_rng rng = {.seed = 3};
  for (size_t j = 0; j < field.rows; j++)
    for (size_t i = 0; i < field.columns; i++) {
      double z = surface(field.x + ((double)i + 0.5) * field.cell,
                         field.y + ((double)j + 0.5) * field.cell, p);
      if (z > 0)
        field.height[j * field.columns + i] = fmax(1e-9, z + noise * scree_rng_normal(&rng));
    }
  scree_repose_options options = scree_default_repose_options();
  options.particle_size = particle_size;
  scree_repose repose;
  CHECK_OK(scree_repose_measure(&field, &options, &repose, &error), error);
  scree_height_field_free(&field);
  return repose;
}

static double deg(double tangent) {
  return atan(tangent) * 57.29577951308232;
}

static void cones_give_their_angle_each_way(void **state) {
  (void)state;
  for (double angle = 10; angle <= 50; angle += 8) {
    double tangent = tan(angle / 57.29577951308232), p[] = {0.02, -0.03, 0.35 * tangent, tangent};
    scree_repose r = measured(cone_shape, p, 0, 0.02);
    assert_true(r.heap);
    CHECK_NEAR(r.sector_deg, angle, 0.15);
    CHECK_NEAR(r.cone_deg, angle, 1e-6);
    CHECK_NEAR(r.silhouette_deg, angle, 0.15);
    CHECK_NEAR(r.cone_apex[0], 0.02, 1e-6);
    CHECK_NEAR(r.base_radius, 0.35, 0.003);
    CHECK_NEAR(r.axis[1], -0.03, 1e-3);
    CHECK_NEAR(r.envelope_volume, 3.14159265 * 0.35 * 0.35 * p[2] / 3, 2e-3 * p[2] * 0.35 * 0.35);
    CHECK_NEAR(r.volume_deg, angle, 0.15);
    assert_true(r.spread_deg < 0.2);
    assert_int_equal(r.sector_count, r.sector_total);
    assert_in_range(r.sector_total, 26, 29); /* pi R round the middle of the flank, 40 mm each */
    assert_int_equal(r.flank_count, 36);
    assert_true(r.sector_sd_deg < 0.3);
  }
}

static void rough_and_truncated_heaps_give_the_angle_of_their_flanks(void **state) {
  (void)state;
  double p[] = {0, 0, 0.2, 0.5, 0.12};
  scree_repose rough = measured(cone_shape, p, 4e-3, 0.02);
  CHECK_NEAR(rough.sector_deg, deg(0.5), 0.5);
  CHECK_NEAR(rough.cone_deg, deg(0.5), 0.5);
  scree_repose cut = measured(truncated_shape, p, 0, 0.02);
  CHECK_NEAR(cut.height, 0.12, 1e-9);
  CHECK_NEAR(cut.sector_deg, deg(0.5), 0.15);
  CHECK_NEAR(cut.cone_deg, deg(0.5), 1e-6);
  CHECK_NEAR(cut.silhouette_deg, deg(0.5), 0.2);
}

/* In a sector at the angle a from the middle of a face the slope is tan * cos a: the mean over an
 * eighth turn of atan(tan cos a), and from the side the slope is that of the outline, tan cos a
 * again. */
static void pyramids_and_tilted_cones_give_the_mean_over_directions(void **state) {
  (void)state;
  double p[] = {0.2, 0.6}, mean = 0;
  for (int i = 0; i < 1000; i++)
    mean += deg(0.6 * cos((i + 0.5) / 1000 * 0.7853981633974483)) / 1000;
  scree_repose pyramid = measured(pyramid_shape, p, 0, 0.02);
  CHECK_NEAR(pyramid.sector_deg, mean, 0.4);
  assert_true(pyramid.sector_sd_deg > 1);
  double q[] = {0, 0, 0.15, 0.5, 0.05};
  scree_repose tilted = measured(tilted_shape, q, 0, 0.02);
  CHECK_NEAR(tilted.sector_deg, deg(0.5), 0.7);
  CHECK_NEAR(tilted.cone_deg, deg(0.5), 1.0);
}

/* ---- heaps of particles ---- */

/* Boxes of 100 x 50 x 15 mm, their centres spread evenly under a cone, a half of it filled, lying
 * as the normal deviate of 0.4 rad about flat has it; an eighth more of them strewn around it. */
static void pile_boxes(double tangent, size_t count, uint64_t seed, scree_height_field *field) {
  static const vec3 half = {0.05, 0.025, 0.0075};
  double volume = 8 * half.x * half.y * half.z;
  double base = cbrt(6 * volume * (double)count / (pi * tangent));
  scree_rng rng = {.seed = seed};
  scree_mesh box = shape_box(2 * half.x, 2 * half.y, 2 * half.z);
  scree_error error;
  shape_move(&box, vec3_scale(half, -1));
  CHECK_OK(scree_height_field_create(0, 0, 2.2 * base, 5e-3, field, &error), error);
  for (size_t i = 0; i < count + count / 8; i++) {
    double r = base * sqrt(scree_rng_uniform(&rng)), z = base * tangent * scree_rng_uniform(&rng);
    bool stray = i >= count;
    while (!stray && z > tangent * (base - r)) {
      r = base * sqrt(scree_rng_uniform(&rng));
      z = base * tangent * scree_rng_uniform(&rng);
    }
    if (stray) r = base * (0.9 + scree_rng_uniform(&rng));
    double a = 2 * pi * scree_rng_uniform(&rng), turn = pi * scree_rng_uniform(&rng),
           way = 2 * pi * scree_rng_uniform(&rng),
           tilt = (stray ? 0.04 : 0.4) * scree_rng_normal(&rng);
    quat about = {cos(turn), 0, 0, sin(turn)},
         over = {cos(0.5 * tilt), sin(0.5 * tilt) * cos(way), sin(0.5 * tilt) * sin(way), 0},
         q = quat_mul(over, about);
    mat3 m = quat_to_mat3(q);
    double lowest = fabs(m.m[2][0]) * half.x + fabs(m.m[2][1]) * half.y + fabs(m.m[2][2]) * half.z;
    const double at[] = {r * cos(a), r * sin(a), fmax(stray ? 0 : z, lowest)},
                 turned[] = {q.w, q.x, q.y, q.z};
    scree_height_field_add_mesh(field, &box, at, turned, 0);
  }
  scree_mesh_free(&box);
}

static const double box_size = 0.0523; /* m: of the sphere of equal volume */

static scree_repose measured_boxes(double angle, size_t count, uint64_t seed) {
  scree_height_field field;
  scree_error error;
  scree_repose_options options = scree_default_repose_options();
  scree_repose r;
  options.particle_size = box_size;
  pile_boxes(tan(angle * pi / 180), count, seed, &field);
  CHECK_OK(scree_repose_measure(&field, &options, &r, &error), error);
  scree_height_field_free(&field);
  return r;
}

/* The mean over heaps built alike is near the cone's angle, by sectors and by the cone: up to 3
 * degrees below it with 270 boxes, whose random places leave gaps in the thin toe, and 1 with 1200.
 * Outlines lie outside the surface, more so towards the base, and are flatter. One heap strays by a
 * few degrees, and all ways with it. */
static void check_mean_of_heaps(double angle, size_t count, size_t heaps, double tolerance) {
  double sector = 0, cone = 0, outline = 0, spread = 0, n = (double)heaps;
  for (uint64_t seed = 1; seed <= heaps; seed++) {
    scree_repose r = measured_boxes(angle, count, seed);
    if (!r.heap) fail_msg("%s", r.reason);
    assert_true(r.sector_total >= 9 && r.sector_total <= 26);
    CHECK_NEAR(r.sector_deg, r.cone_deg, 2);
    CHECK_NEAR(r.sector_deg, angle, 8);
    sector += r.sector_deg / n;
    cone += r.cone_deg / n;
    outline += r.silhouette_deg / n;
    spread += r.spread_deg / n;
  }
  CHECK_NEAR(sector, angle, tolerance);
  CHECK_NEAR(cone, angle, tolerance);
  CHECK_NEAR(outline, sector - 1.5, 1.5);
  assert_true(spread < 4);
}

static void heaps_of_particles_give_their_angle(void **state) {
  (void)state;
  check_mean_of_heaps(23, 270, 16, 3.5);
  check_mean_of_heaps(33, 270, 16, 3.5);
  check_mean_of_heaps(20, 1200, 4, 1.5);
}

/* The standard error that one heap tells of its angle by volume and centroid is what heaps built
 * alike scatter by. */
static void one_heap_tells_how_sure_its_angle_is(void **state) {
  (void)state;
  enum { HEAPS = 40 };
  static const struct {
    double angle;
    size_t count;
  } piles[] = {{30, 150}, {20, 270}, {33, 600}};
  for (size_t k = 0; k < sizeof piles / sizeof *piles; k++) {
    double sum = 0, squares = 0, errors = 0;
    for (uint64_t seed = 1; seed <= HEAPS; seed++) {
      scree_repose r = measured_boxes(piles[k].angle, piles[k].count, seed);
      sum += r.volume_deg;
      squares += r.volume_deg * r.volume_deg;
      errors += r.volume_se_deg * r.volume_se_deg / HEAPS;
    }
    double sd = sqrt((squares - sum * sum / HEAPS) / (HEAPS - 1));
    print_message("%zu boxes: SD %.2f, told %.2f degrees\n", piles[k].count, sd, sqrt(errors));
    assert_true(sqrt(errors) > 0.65 * sd && sqrt(errors) < 1.5 * sd);
  }
}

static void what_is_too_small_gets_no_number(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= 10; seed++) {
    scree_repose r = measured_boxes(35, 20, seed);
    assert_false(r.heap);
    assert_true(strstr(r.reason, "too small: in the middle of its flank") ||
                strstr(r.reason, "less than 1.5 particle sizes"));
    assert_true(isnan(r.sector_deg) && isnan(r.spread_deg) && isnan(r.volume_deg));
  }
}

static void what_is_no_heap_gets_no_number(void **state) {
  (void)state;
  double p[] = {0.028};
  scree_repose layer = measured(layer_shape, p, 0, 0.02);
  assert_false(layer.heap);
  assert_true(isnan(layer.sector_deg) && isnan(layer.cone_deg) && isnan(layer.silhouette_deg));
  assert_string_equal(layer.reason, "28.0 mm high, less than 1.5 particle sizes of 20.0 mm");
  double tall[] = {0.2};
  assert_false(measured(layer_shape, tall, 0, 0.02).heap);
  double none[] = {-1};
  assert_string_equal(measured(layer_shape, none, 0, 0).reason, "nothing lies on the floor");
}

/* The field of one tetrahedron and one sphere against a direct evaluation. */
static void surfaces_are_raised_exactly_at_the_centres(void **state) {
  (void)state;
  double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  uint32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  scree_mesh mesh = {corners, faces, 4, 4};
  scree_height_field field;
  scree_error error;
  CHECK_OK(scree_height_field_create(0, 0, 2, 0.05, &field, &error), error);
  const double at[] = {0.01, 0.02, 5}, upright[] = {1, 0, 0, 0}, centre[] = {-1, -1, 5.5};
  scree_height_field_add_mesh(&field, &mesh, at, upright, 5);
  scree_height_field_add_sphere(&field, centre, 0.4, 5);
  size_t raised = 0;
  for (size_t j = 0; j < field.rows; j++)
    for (size_t i = 0; i < field.columns; i++) {
      double x = field.x + ((double)i + 0.5) * 0.05, y = field.y + ((double)j + 0.5) * 0.05;
      double plane = 1 - (x - 0.01) - (y - 0.02), got = field.height[j * field.columns + i];
      double d2 = (x + 1) * (x + 1) + (y + 1) * (y + 1);
      if (d2 < 0.15) {
        CHECK_NEAR(got, 0.5 + sqrt(0.16 - d2), 1e-12);
      } else if (x > 0.05 && y > 0.05 && plane > 0.05) {
        CHECK_NEAR(got, plane, 1e-12);
        raised++;
      }
    }
  assert_true(raised > 100);
  scree_height_field_free(&field);
  assert_int_equal(scree_height_field_create(0, 0, 1, 1e-7, &field, &error), SCREE_BAD_ARGUMENT);
}

/* Not a number, infinite, or so large that cubes overflow: refused, wherever it stands. */
static void lengths_without_end_are_refused(void **state) {
  (void)state;
  static const double bad[] = {NAN, INFINITY, 1e200, -1e200};
  scree_repose_options options = scree_default_repose_options();
  scree_height_field field;
  scree_repose r;
  scree_error error;
  CHECK_OK(scree_height_field_create(0, 0, 0.5, 0.1, &field, &error), error);
  double *places[] = {&field.height[0], &field.height[field.rows * field.columns - 1], &field.x,
                      &field.y};
  for (size_t p = 0; p < 4; p++)
    for (size_t i = 0; i < 4; i++) {
      double kept = *places[p];
      *places[p] = bad[i];
      assert_int_equal(scree_repose_measure(&field, &options, &r, &error), SCREE_BAD_ARGUMENT);
      *places[p] = kept;
    }
  CHECK_OK(scree_repose_measure(&field, &options, &r, &error), error);
  scree_height_field_free(&field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cones_give_their_angle_each_way),
      cmocka_unit_test(rough_and_truncated_heaps_give_the_angle_of_their_flanks),
      cmocka_unit_test(pyramids_and_tilted_cones_give_the_mean_over_directions),
      cmocka_unit_test(heaps_of_particles_give_their_angle),
      cmocka_unit_test(one_heap_tells_how_sure_its_angle_is),
      cmocka_unit_test(what_is_too_small_gets_no_number),
      cmocka_unit_test(what_is_no_heap_gets_no_number),
      cmocka_unit_test(lengths_without_end_are_refused),
      cmocka_unit_test(surfaces_are_raised_exactly_at_the_centres),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
