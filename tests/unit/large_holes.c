/* Large fillings, refined and smooth: against closed forms of what was cut away, against the plain
 * filling, and where the smooth one must be taken back. */
#include "base/rng.h"
#include "base/vec.h"
#include "mesh/mesh.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979324;

/* Keeps the facets whose corners all pass. */
static void keep_where(scree_mesh *mesh, bool (*passes)(const double *p, double limit),
                       double limit) {
  size_t kept = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    bool all = true;
    for (int k = 0; k < 3; k++)
      all &= passes(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k], limit);
    if (all) memmove(mesh->triangles + 3 * kept++, mesh->triangles + 3 * t, 12);
  }
  mesh->triangle_count = kept;
}

static bool is_low(const double *p, double limit) {
  return p[2] <= limit;
}
static bool is_middle(const double *p, double limit) {
  return fabs(p[2]) <= limit;
}
static bool is_off_window(const double *p, double limit) {
  return p[2] < 1.999 || fabs(p[0] - 1) > limit || fabs(p[1] - 1) > limit;
}

static scree_mesh fill(const scree_mesh *mesh, bool flat, scree_repair_report *report) {
  scree_repair_options options = scree_default_repair_options();
  scree_mesh filled;
  scree_error error;
  options.hole_share = 1;
  options.flat_holes = flat;
  CHECK_OK(scree_mesh_repair(mesh, &options, NULL, &filled, report, &error), error);
  assert_true(report->after.usable);
  return filled;
}

static double volume_filled(const scree_mesh *mesh, bool flat, scree_repair_report *report) {
  scree_measures m;
  scree_error error;
  scree_mesh filled = fill(mesh, flat, report);
  CHECK_OK(scree_mesh_measure(&filled, &m, &error), error);
  scree_mesh_free(&filled);
  return m.volume;
}

/* Edges at vertices off the sphere: within these shares of the surroundings'. */
static void check_sizes(const scree_mesh *mesh, double size, double low, double high) {
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
    size_t next = i % 3 == 2 ? i - 2 : i + 1;
    vec3 a = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[i]),
         b = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[next]);
    if (vec3_norm(a) > 0.9999 && vec3_norm(b) > 0.9999) continue;
    double length = vec3_distance(a, b);
    assert_true(length > low * size && length < high * size);
  }
}

/* A third of the area is missing: flat, a quarter of the volume goes with it. */
static void sphere_less_a_third(void **state) {
  (void)state;
  for (int level = 4; level <= 6; level++) {
    scree_mesh mesh = shape_icosphere(1, level);
    scree_repair_report plain, smooth;
    keep_where(&mesh, is_low, 1.0 / 3);
    double ball = 4 * pi / 3, flat = volume_filled(&mesh, true, &plain) / ball - 1;
    double fair = volume_filled(&mesh, false, &smooth) / ball - 1;
    assert_true(flat < -0.25 && fair > -0.08 && fair < 0);
    assert_int_equal(smooth.done[SCREE_REPAIR_SMOOTH_HOLE], 1);
    assert_int_equal(plain.done[SCREE_REPAIR_SMOOTH_HOLE], 0);
    assert_int_equal(plain.done[SCREE_REPAIR_FILL_FACET],
                     plain.before.defects[SCREE_DEFECT_BOUNDARY_EDGE] - 2);
    scree_mesh filled = fill(&mesh, false, &smooth);
    assert_int_equal(filled.triangle_count,
                     mesh.triangle_count + smooth.done[SCREE_REPAIR_FILL_FACET]);
    check_sizes(&filled, 1.2 * pow(0.5, level), 0.2, 2.5);
    scree_mesh_free(&filled);
    scree_mesh_free(&mesh);
  }
}

/* Both ends missing, on a rough ball. */
static void barrel(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 5);
  scree_repair_report report;
  scree_rng rng = {.seed = 3};
  shape_shake(&mesh, 0.003, &rng);
  keep_where(&mesh, is_middle, 0.7);
  double ball = 4 * pi / 3;
  assert_true(volume_filled(&mesh, true, &report) < 0.9 * ball);
  CHECK_NEAR(volume_filled(&mesh, false, &report), ball, 0.03 * ball);
  assert_int_equal(report.done[SCREE_REPAIR_SMOOTH_HOLE], 2);
  scree_mesh_free(&mesh);
}

/* What lies in a flat face stays flat, without new vertices, and the cube's volume exact. */
static void window_in_a_face(void **state) {
  (void)state;
  scree_mesh mesh = shape_grid_box(2, 2, 2, 20);
  scree_repair_report report;
  keep_where(&mesh, is_off_window, 0.65);
  CHECK_NEAR(volume_filled(&mesh, false, &report), 8, 1e-6);
  assert_int_equal(report.done[SCREE_REPAIR_SMOOTH_HOLE], 0);
  CHECK_NEAR(report.guessed_area, 1.4 * 1.4, 0.02);
  scree_mesh_free(&mesh);
}

static bool is_below_top(const double *p, double limit) {
  return p[2] < limit;
}

/* A face is missing, however the box is turned, also where the rim is a little rough: the filling
 * is that face. Rougher, or leaning so far inwards that it may go on, it is filled smoothly. */
static void missing_face(void **state) {
  (void)state;
  scree_rng rng = {.seed = 4};
  scree_repair_report report;
  for (int n = 0; n < 8; n++) {
    scree_mesh mesh = shape_grid_box(2, 2, 2, 20);
    size_t kept = 0;
    for (size_t t = 0; t < mesh.triangle_count; t++)
      for (int k = 0; k < 3; k++)
        if (is_below_top(mesh.positions + 3 * (size_t)mesh.triangles[3 * t + k], 1.999)) {
          memmove(mesh.triangles + 3 * kept++, mesh.triangles + 3 * t, 12);
          break;
        }
    mesh.triangle_count = kept;
    bool rough = n == 6, leaning = n == 7;
    for (size_t v = 0; v < mesh.vertex_count; v++) {
      double *p = mesh.positions + 3 * v;
      if (p[2] == 2 && n >= 3 && !leaning)
        p[2] += (rough ? 0.045 : 0.015) * (2 * scree_rng_uniform(&rng) - 1);
      /* a pyramid's stump of 33 degrees, its point far above the rim */
      if (leaning)
        p[0] = 1 + (p[0] - 1) * (1 + 2 - p[2]), p[1] = 1 + (p[1] - 1) * (1 + 2 - p[2]), p[2] *= 0.6;
    }
    scree_measures m;
    scree_error error;
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    if (n) shape_transform(&mesh, &turn, (vec3){3, 1, 2});
    scree_mesh filled = fill(&mesh, false, &report);
    CHECK_OK(scree_mesh_measure(&filled, &m, &error), error);
    assert_int_equal(report.done[SCREE_REPAIR_SMOOTH_HOLE], rough || leaning);
    if (!rough && !leaning) {
      CHECK_NEAR(m.volume, 8, n < 3 ? 1e-9 : 0.06);
      assert_int_equal(report.done[SCREE_REPAIR_FILL_FACET], 78);
    }
    scree_mesh_free(&filled);
    scree_mesh_free(&mesh);
  }
}

/* A ball stands where the smooth filling would go, above the plain one. */
static void taken_back_where_it_meets(void **state) {
  (void)state;
  scree_mesh bowl = shape_icosphere(1, 4), ball = shape_icosphere(0.2, 2);
  scree_repair_report report;
  keep_where(&bowl, is_low, 1.0 / 3);
  double alone = volume_filled(&bowl, true, &report);
  shape_move(&ball, (vec3){0, 0, 0.85});
  scree_mesh both = shape_join(&bowl, &ball);
  scree_measures m;
  scree_error error;
  CHECK_OK(scree_mesh_measure(&ball, &m, &error), error);
  CHECK_NEAR(volume_filled(&both, false, &report), alone + m.volume, 1e-12);
  assert_int_equal(report.done[SCREE_REPAIR_SMOOTH_HOLE], 0);
  assert_int_equal(report.done[SCREE_REPAIR_COARSE_HOLE], 1);
  assert_int_equal(report.done[SCREE_REPAIR_FILL_FACET],
                   report.before.defects[SCREE_DEFECT_BOUNDARY_EDGE] - 2);
  /* away from it, both are as they were alone */
  scree_mesh_free(&both);
  shape_move(&ball, (vec3){0, 0, 5});
  both = shape_join(&bowl, &ball);
  CHECK_NEAR(volume_filled(&both, false, &report), volume_filled(&bowl, false, &report) + m.volume,
             1e-9);
  scree_mesh_free(&both);
  scree_mesh_free(&bowl);
  scree_mesh_free(&ball);
}

/* ---- one body, at every resolution ---- */

/* Where facets are missing of a body 2 across, by their centre. */
static bool in_window(vec3 c, double half) {
  return c.z > 1.999 && fabs(c.x - 1) < half && fabs(c.y - 1) < half;
}
static bool is_missing(int hole, vec3 c) {
  switch (hole) {
  case 0:
    return in_window(c, 0.1); /* 0.17 % of the area */
  case 1:
    return in_window(c, 0.6); /* 6 % */
  case 2:
    return in_window(c, 2); /* a face */
  case 3:
    return c.z > 1.999 || c.z < 0.001; /* two of them */
  case 4:
    return c.x > 1.8 && c.y > 1.8 && c.z > 1.8; /* a corner */
  case 5:
    return c.x > 1.8 && c.z > 1.8 && fabs(c.y - 1) < 0.2; /* an edge */
  case 6:
    return c.z > 1.999 && fabs(c.x - 1) < 0.2; /* a slit from edge to edge */
  default:
    return c.z > 0.001; /* all but a face */
  }
}

/* Whether a hole is filled, whether it is told as a guess, and what comes of it do not hang on how
 * many edges it has. */
static void alike_at_every_resolution(void **state) {
  (void)state;
  for (int hole = 0; hole < 8; hole++) {
    double guessed = NAN;
    for (int n = 10; n <= 50; n += 10) {
      scree_mesh mesh = shape_grid_box(2, 2, 2, n), filled = {0};
      size_t kept = 0;
      for (size_t t = 0; t < mesh.triangle_count; t++) {
        vec3 c = {0, 0, 0};
        for (int k = 0; k < 3; k++)
          c = vec3_mad(c, scree_mesh_vertex(&mesh, mesh.triangles[3 * t + k]), 1.0 / 3);
        if (!is_missing(hole, c)) memmove(mesh.triangles + 3 * kept++, mesh.triangles + 3 * t, 12);
      }
      mesh.triangle_count = kept;
      scree_repair_report report;
      scree_error error;
      scree_measures m;
      scree_repair_options options = scree_default_repair_options();
      options.intersections = n <= 20; /* which take most of the time */
      scree_status status = scree_mesh_repair(&mesh, &options, NULL, &filled, &report, &error);
      assert_int_equal(status, hole < 7 ? SCREE_OK : SCREE_BAD_MESH);
      if (status == SCREE_OK) {
        CHECK_OK(scree_mesh_measure(&filled, &m, &error), error);
        CHECK_NEAR(m.volume, 8, 0.01 * 8);
        if (isnan(guessed)) guessed = report.guessed_area;
        CHECK_NEAR(report.guessed_area, guessed, 0.02 * guessed + 1e-9);
        assert_true((guessed > 0) == (hole != 0 && hole != 4 && hole != 5));
      } else {
        CHECK_NEAR(report.refused_share, 0.5, 0.01);
      }
      scree_mesh_free(&filled);
      scree_mesh_free(&mesh);
    }
  }
}

static scree_status call_repair(void *context, scree_error *error) {
  scree_repair_options options = scree_default_repair_options();
  scree_mesh filled = {0};
  options.hole_share = 1;
  scree_status status = scree_mesh_repair(context, &options, NULL, &filled, NULL, error);
  scree_mesh_free(&filled);
  return status;
}

static void out_of_memory(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 3);
  keep_where(&mesh, is_low, 0.2);
  assert_true(check_allocation_failures(call_repair, &mesh) > 60);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sphere_less_a_third),
      cmocka_unit_test(barrel),
      cmocka_unit_test(window_in_a_face),
      cmocka_unit_test(missing_face),
      cmocka_unit_test(taken_back_where_it_meets),
      cmocka_unit_test(alike_at_every_resolution),
      cmocka_unit_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
