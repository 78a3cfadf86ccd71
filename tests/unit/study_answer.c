/* What a study says of runs whose answer is known: records are written as by workers, gathered into
 * the database, analysed and drawn. */
#include "report/program.h"
#include "study/record.h"
#include "study/special.h"
#include "study/study.h"
#include "support/check.h"
#include "support/folder.h"

#include <unistd.h>

enum { LEVELS = 5, REPLICATES = 4, SPHERES = LEVELS, POINTS = LEVELS + 1 };
static const char *const names[POINTS] = {"1e-5", "1e-4", "3e-4", "1e-3", "2e-3", "spheres"};
static const double rps[LEVELS] = {1e-5, 1e-4, 3e-4, 1e-3, 2e-3};

/* A study as it might have come out. */
typedef struct outcome {
  const char *name, *angle;
  double angles[LEVELS], sd;           /* degrees: mean over the replicates, and their SD */
  double (*seconds)(double rp, int r); /* of replicate r */
  double paper_rp[2];                  /* chosen by Ip for the two shapes */
  double recommended_rp[2];
} outcome;

/* Four values of mean 0 and SD 1. */
static double deviate(size_t replicate) {
  static const double values[REPLICATES] = {-3, 1, -1, 3};
  return values[replicate] / sqrt(20.0 / 3);
}

static double quartic(double rp, int r) {
  double value = 3 + rp * (2e4 + rp * (-5e6 + rp * (4e9 + rp * 1e12)));
  return value + (r % 2 ? 0.25 : -0.25);
}
static double power(double rp, int r) {
  return 700 * pow(rp, 0.37) * exp(r % 2 ? 0.01 : -0.01);
}

/* Rotation since the lift, which begins at 0.5 s: a straight line of its own in each replicate.
 * Replicate 1 ends early and lies still, replicate 2 ends early and does not. */
static scree_record_point series_point(size_t replicate, size_t i) {
  double time = 0.1 * (double)i;
  return (scree_record_point){.time = time,
                              .phase = time < 0.45 ? 0 : 2,
                              .mean_rotation = (double)(replicate + 1) * (1 + (time - 0.5)),
                              .sector_deg = NAN,
                              .cone_deg = NAN,
                              .silhouette_deg = NAN,
                              .height = NAN};
}

static scree_study_record make_record(const outcome *o, size_t level, size_t replicate,
                                      scree_record_point *series) {
  double angle = level == SPHERES ? NAN : o->angles[level] + o->sd * deviate(replicate);
  bool cone = !strcmp(o->angle, "cone");
  scree_study_record r = {.version = "test",
                          .started = 1e9,
                          .ended = 1e9 + 10,
                          .triangle_count = level == SPHERES ? 0 : 100 * rps[level] / 1e-4,
                          .series = series,
                          .series_count = replicate == 1 || replicate == 2 ? 11 : 21};
  r.costs.processor_seconds = level == SPHERES ? 1 : o->seconds(rps[level], (int)replicate);
  r.costs.wall_seconds = 100;
  r.result.pile.repose = (scree_repose){.heap = level != SPHERES,
                                        .sector_deg = cone ? angle + 5 : angle,
                                        .cone_deg = cone ? angle : angle - 5,
                                        .silhouette_deg = angle + 3,
                                        .height = 0.2};
  r.result.body_count = 30;
  r.result.left_count = level == SPHERES ? 10 : 0;
  r.result.still = replicate != 2;
  for (size_t i = 0; i < r.series_count; i++) series[i] = series_point(replicate, i);
  snprintf(r.hash, sizeof r.hash, "%zu-%zu", level, replicate);
  return r;
}

/* The level of a run of the plan, by its text: the file has them in another order. */
static size_t level_of(const scree_study *study, size_t run) {
  scree_study_run of;
  scree_error error;
  size_t level = 0;
  CHECK_OK(scree_study_get_run(study, run, &of, &error), error);
  while (strcmp(names[level], of.rp) != 0) level++;
  return level;
}

static void write_text(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static scree_study *make_study(const outcome *o) {
  scree_study *study;
  scree_error error;
  char yaml[80], text[400];
  snprintf(yaml, sizeof yaml, "%s.yaml", o->name);
  const char *path = in_folder(yaml);
  snprintf(text, sizeof text,
           "name: %s\nreplicates: %d\nshapes: [sample:box, sample:sphere]\nbase: {preset: demo}\n"
           "factors: {rp: [3e-4, spheres, 2e-3, 1e-5, 1e-3, 1e-4]}\n"
           "analysis: {angle: %s, margin_deg: 2, confidence: 0.95}\n",
           o->name, REPLICATES, o->angle);
  write_text(path, text);
  CHECK_OK(scree_study_read(path, &study, &error), error);
  CHECK_OK(scree_study_open(study, in_folder(o->name), &error), error);
  for (size_t i = 0; i < study->shape_count; i++) {
    study->shapes[i].known = true;
    study->shapes[i].paper_rp = o->paper_rp[i];
    study->shapes[i].robust_rp = 2 * o->paper_rp[i];
    study->shapes[i].recommended_rp = o->recommended_rp[i];
  }
  CHECK_OK(scree_study_make_keys(study, &error), error);
  for (size_t run = 0; run < scree_study_run_count(study); run++) {
    scree_record_point series[21];
    scree_study_record r =
        make_record(o, level_of(study, run), scree_study_run_replicate(study, run), series);
    const char *file = SCREE_STUDY_PATH(study, "results", study->keys[run], ".yaml");
    CHECK_OK(scree_study_record_write(&r, file, &error), error);
  }
  CHECK_OK(scree_study_collect(study, true, &error), error);
  return study;
}

static scree_study_result analyse(const outcome *o) {
  scree_study *study = make_study(o);
  scree_study_result result;
  scree_error error;
  CHECK_OK(scree_study_analyse(study, &result, &error), error);
  scree_study_free(study);
  assert_int_equal(result.counts.done, POINTS * REPLICATES);
  assert_int_equal(result.family_count, 1);
  assert_int_equal(result.families[0].level_count, LEVELS);
  for (size_t k = 0; k < LEVELS; k++)
    assert_string_equal(result.points[result.families[0].levels[k]].rp, names[k]);
  assert_string_equal(result.points[result.families[0].spheres].rp, "spheres");
  return result;
}

static const outcome plateau = {.name = "plateau",
                                .angle = "sector",
                                .angles = {20, 27, 29.7, 30.1, 30},
                                .sd = 0.4,
                                .seconds = quartic,
                                .paper_rp = {1e-3, 3e-4},
                                .recommended_rp = {4e-4, 9e-5}};

/* Two one-sided tests and Welch's, written out for equal counts and spreads. */
static void check_comparison(const scree_comparison *c, double difference, double sd,
                             double margin) {
  double error = sd * sqrt(2.0 / REPLICATES), degrees = 2 * (REPLICATES - 1);
  CHECK_NEAR(c->difference, difference, 1e-9);
  CHECK_NEAR(c->degrees, degrees, 1e-9);
  CHECK_NEAR(c->p_equivalence, 1 - scree_student_cdf((margin - fabs(difference)) / error, degrees),
             1e-9);
  CHECK_NEAR(c->p_difference, 2 * scree_student_cdf(-fabs(difference) / error, degrees), 1e-9);
  CHECK_NEAR(c->high - c->low, -2 * scree_student_quantile(0.05, degrees) * error, 1e-9);
  assert_int_equal(c->equivalent, c->low > -margin && c->high < margin);
}

static void a_plateau_is_found_from_where_it_begins(void **state) {
  (void)state;
  scree_study_result r = analyse(&plateau);
  const scree_family_result *f = &r.families[0];
  for (size_t k = 0; k < LEVELS; k++) {
    const scree_point_result *p = &r.points[f->levels[k]];
    CHECK_NEAR(p->angle_deg.mean, plateau.angles[k], 1e-9);
    CHECK_NEAR(p->angle_deg.sd, 0.4, 1e-9);
    CHECK_NEAR(p->angle_deg.cv, 0.4 / plateau.angles[k], 1e-9);
    CHECK_NEAR(p->angle_deg.mean_high - p->angle_deg.mean,
               0.4 / 2 * -scree_student_quantile(0.025, 3), 1e-9);
    assert_int_equal(p->heap_count, REPLICATES);
    CHECK_NEAR(p->numbers[SCREE_RECORD_TOLD].mean, 0, 0);
    if (k + 1 < LEVELS) check_comparison(&f->comparisons[k], plateau.angles[k] - 30, 0.4, 2);
  }
  assert_true(f->comparisons[0].different && f->comparisons[1].different);
  assert_true(f->comparisons[2].equivalent && f->comparisons[3].equivalent);
  assert_true(f->converged);
  assert_int_equal(f->converged_from, 2);
  CHECK_NEAR(f->by_ip.low, 3e-4, 0);
  CHECK_NEAR(f->by_ip.high, 1e-3, 0);
  CHECK_NEAR(f->by_ip.mean, sqrt(3e-7), 1e-12);
  assert_int_equal(f->by_ip.in_range, SCREE_IN_RANGE_YES);
  assert_int_equal(f->by_robust.in_range, SCREE_IN_RANGE_YES);
  CHECK_NEAR(f->recommended.mean, 1.897366596e-4, 1e-12);
  assert_int_equal(f->recommended.in_range, SCREE_IN_RANGE_NO);
  const scree_point_result *spheres = &r.points[f->spheres];
  assert_int_equal(spheres->counts.done, REPLICATES);
  assert_int_equal(spheres->heap_count, 0);
  assert_true(isnan(spheres->angle_deg.mean));
  CHECK_NEAR(spheres->numbers[SCREE_RECORD_TOLD].mean, 0.25, 1e-12);
  scree_study_result_free(&r);
}

/* One shape's choice below where the plateau begins is enough. */
static void a_choice_below_the_plateau_is_told(void **state) {
  (void)state;
  outcome o = plateau;
  o.name = "below";
  o.angle = "cone";
  o.paper_rp[1] = 1.4e-4;
  scree_study_result r = analyse(&o);
  CHECK_NEAR(r.points[r.families[0].levels[0]].angle_deg.mean, 20, 1e-9); /* by the cone */
  assert_int_equal(r.families[0].converged_from, 2);
  assert_int_equal(r.families[0].by_ip.in_range, SCREE_IN_RANGE_NO);
  assert_int_equal(r.families[0].by_robust.in_range, SCREE_IN_RANGE_NO);
  scree_study_result_free(&r);
}

/* The second finest differs: what is the same as the finest by chance below it is no plateau. */
static void a_gap_ends_the_plateau(void **state) {
  (void)state;
  outcome o = plateau;
  o.name = "gap";
  o.angles[3] = 26;
  scree_study_result r = analyse(&o);
  assert_true(r.families[0].comparisons[2].equivalent);
  assert_false(r.families[0].converged);
  assert_int_equal(r.families[0].by_ip.in_range, SCREE_IN_RANGE_UNKNOWN);
  scree_study_result_free(&r);
}

static void with_wide_scatter_nothing_is_shown(void **state) {
  (void)state;
  outcome o = plateau;
  o.name = "scatter";
  o.sd = 3;
  scree_study_result r = analyse(&o);
  const scree_family_result *f = &r.families[0];
  assert_false(f->converged);
  for (size_t k = 2; k + 1 < LEVELS; k++) {
    check_comparison(&f->comparisons[k], o.angles[k] - 30, 3, 2);
    assert_false(f->comparisons[k].equivalent || f->comparisons[k].different);
    assert_true(f->comparisons[k].count_needed > REPLICATES);
  }
  assert_int_equal(f->comparisons[1].count_needed, 0); /* 3 degrees away: never within 2 */
  assert_int_equal(f->by_ip.in_range, SCREE_IN_RANGE_UNKNOWN);
  scree_study_result_free(&r);
}

static void time_against_rp_gives_back_both_laws(void **state) {
  (void)state;
  static const double coefficients[] = {3, 2e4, -5e6, 4e9, 1e12};
  scree_study_result r = analyse(&plateau);
  const scree_polynomial *curve = &r.families[0].time_curve;
  assert_int_equal(curve->count, LEVELS * REPLICATES);
  for (int k = 0; k <= 4; k++) CHECK_NEAR(curve->coefficient[k] / coefficients[k], 1, 1e-6);
  CHECK_NEAR(curve->rms, 0.25, 1e-9);
  CHECK_NEAR(r.points[r.families[0].levels[3]].seconds.mean, 23, 1e-9);
  scree_study_result_free(&r);
  outcome o = plateau;
  o.name = "power";
  o.seconds = power;
  r = analyse(&o);
  const scree_power_law *law = &r.families[0].time_law;
  assert_int_equal(law->count, LEVELS * REPLICATES);
  CHECK_NEAR(law->exponent, 0.37, 1e-9);
  CHECK_NEAR(law->factor, 700, 1e-6);
  double mean = 0, squares = 0, n = LEVELS * REPLICATES;
  for (size_t k = 0; k < LEVELS; k++) mean += log(rps[k]) / LEVELS;
  for (size_t k = 0; k < LEVELS; k++) squares += REPLICATES * pow(log(rps[k]) - mean, 2);
  double half = -scree_student_quantile(0.025, n - 2) * sqrt(n * 1e-4 / (n - 2) / squares);
  CHECK_NEAR(law->exponent_high - law->exponent, half, 1e-9);
  CHECK_NEAR(law->exponent - law->exponent_low, half, 1e-9);
  scree_study_result_free(&r);
}

static void rotation_is_the_mean_since_the_lift(void **state) {
  (void)state;
  scree_study_result r = analyse(&plateau);
  const scree_point_result *p = &r.points[0];
  size_t checked = 0;
  for (size_t i = 0; i < p->series_count; i++) {
    double t = p->time[i];
    /* to 0.5 s after the lift all four; then the still one keeps its last value, the other is out
     */
    double expected = t < 0.501 ? 2.5 * (1 + t) : ((1 + t) * (1 + 4) + 2 * 1.5) / 3;
    if (t < -0.45 || t > 1.499) continue;
    CHECK_NEAR(p->rotation[i], expected, 1e-9);
    checked++;
  }
  assert_true(checked >= 19);
  scree_study_result_free(&r);
}

static void all_of_it_is_drawn_and_written(void **state) {
  (void)state;
  static const char *const files[] = {"study.json",   "points.csv",   "angle.png", "angle.csv",
                                      "rotation.svg", "rotation.csv", "time.pdf",  "time.gnuplot"};
  scree_study_result r = analyse(&plateau);
  scree_error error;
  CHECK_OK(scree_study_report_write(&r, in_folder("."), &error), error);
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    assert_int_equal(access(in_folder(files[i]), R_OK), 0);
  scree_study_result_free(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_plateau_is_found_from_where_it_begins),
      cmocka_unit_test(a_choice_below_the_plateau_is_told),
      cmocka_unit_test(a_gap_ends_the_plateau),
      cmocka_unit_test(with_wide_scatter_nothing_is_shown),
      cmocka_unit_test(time_against_rp_gives_back_both_laws),
      cmocka_unit_test(rotation_is_the_mean_since_the_lift),
      cmocka_unit_test(all_of_it_is_drawn_and_written),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
