/* L5 to L8 on what the decimation makes: samples and scans from 1500 down to 8 triangles. Without
 * arguments a part of it; with `full` every shape and number of triangles, 60 hits each.
 *
 * Every shape is scaled to 50 mm, the size of the paper's devices, so that speeds mean the same. */
#include "support/law.h"

#include "support/hits.h"
#include "support/shapes.h"

static const size_t counts[] = {1500, 760, 300, 100, 12, 8};
enum { COUNTS = sizeof counts / sizeof *counts };
static bool full;

/* Of 50 mm size, about the origin's scale: units do not matter. */
static void scale_to_size(scree_mesh *mesh) {
  double area, volume;
  scree_error error;
  CHECK_OK(scree_mesh_area_volume(mesh, &area, &volume, &error), error);
  double factor = 0.05 / cbrt(6 * volume / 3.14159265358979);
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++) mesh->positions[i] *= factor;
}

static scree_mesh sample_mesh(const char *name) {
  scree_error error;
  scree_mesh mesh;
  scree_sample_options o = scree_default_sample_options();
  o.resolution = 1.5e-3;
  o.noise = 0;
  CHECK_OK(scree_sample_make(name, &o, NULL, &mesh, &error), error);
  return mesh;
}

static scree_mesh scan_mesh(const char *path) {
  scree_error error;
  scree_scan scan;
  scree_mesh mesh;
  scree_repair_options repair = scree_default_repair_options();
  CHECK_OK(scree_scan_read(path, NULL, &scan, &error), error);
  CHECK_OK(scree_mesh_prepare(&scan.mesh, &repair, NULL, &mesh, NULL, &error), error);
  scree_scan_free(&scan);
  return mesh;
}

/* A sample by its name or a scan by its path, scaled and decimated. */
static scree_mesh level_of(const char *name, bool scan, size_t count) {
  scree_error error;
  scree_curve *curve = NULL;
  scree_mesh level, mesh = scan ? scan_mesh(name) : sample_mesh(name);
  scree_simplify_options o = scree_default_simplify_options();
  scale_to_size(&mesh);
  CHECK_OK(scree_curve_build(&mesh, &o, NULL, &curve, &error), error);
  CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, count), &level, &error), error);
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
  return level;
}

/* Fast hits, m/s: by their overlap no deeper than twice the thinnest wall, since what has come out
 * on its other side may slip off it; and such as the world must refuse, which pass a wall between
 * two steps. */
static void choose_speeds(const scree_particle *particle, double *fast, double *refused) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  scree_material material = scree_default_material();
  double mass = 0.5 * material.density * m.volume, stiffness = 0.5 * material.young * m.size,
         time = sqrt(mass / stiffness), step = 0.5 * 3.14159265358979 * time / 20;
  *fast = fmin(15.4, 2 * m.thickness / time);
  *refused = 1.5 * fmax(m.thickness, 8 * m.rounding) / step;
}

typedef struct tally {
  double mean, worst, highest, fast;
  double worst_fine; /* in steps a third as long */
  law_outcome out, refused;
} tally;

static void hit_many(scree_particle *particle, int hits, int tries, tally *t) {
  const quat none = {1, 0, 0, 0};
  const law_meeting meeting = {"", particle, particle, none, none, 0.02, 3.1, 0};
  const law_meeting straight = {"", particle, particle, none, none, 0, 3.1, 0};
  double refused;
  *t = (tally){0};
  choose_speeds(particle, &t->fast, &refused);
  for (int i = 0; i < hits; i++) {
    double ratio = law_random_hit(particle, 20, (uint64_t)i, false);
    t->mean += ratio / hits;
    t->worst = fmax(t->worst, fabs(ratio - 1));
    if (i % 2 == 0)
      t->worst_fine =
          fmax(t->worst_fine, fabs(law_random_hit(particle, 60, (uint64_t)i, false) - 1));
    if (i % 2 == 0) t->highest = fmax(t->highest, law_random_hit(particle, 20, (uint64_t)i, true));
  }
  for (int i = 0; i < tries; i++) {
    law_meet(&meeting, 7.7, (uint64_t)i, &t->out);
    law_meet(&meeting, t->fast, (uint64_t)i, &t->out);
    if (t->fast < 15.4) law_meet(&straight, refused, (uint64_t)i, &t->refused);
  }
}

static void check_level(const char *name, size_t count, const scree_mesh *mesh) {
  scree_error error;
  scree_particle *particle = NULL;
  char what[96];
  tally t;
  snprintf(what, sizeof what, "%s at %zu", name, count);
  if (scree_particle_from_mesh(mesh, NULL, &particle, &error) != SCREE_OK)
    fail_msg("%s: %s", what, error.message);
  int tries = full ? 60 : 8;
  hit_many(particle, full ? 60 : 30, tries, &t);
  print_message("%s triangles, hits at 7.7 and %.3g m/s\n", what, t.fast);
  LAW_NEAR("L6", "mean energy ratio of undamped hits", t.mean, 1, 0.005);
  LAW_BELOW("L6", "worst", t.worst, 0.12);
  LAW_BELOW("L6", "worst at N = 60", t.worst_fine, 0.02);
  LAW_BELOW("L7", "damped: highest energy over that at the start", t.highest, 1.002);
  LAW_NEAR("L8", "passed through", (double)t.out.through, 0, 0);
  LAW_NEAR("L8", "stuck", (double)t.out.stuck, 0, 0);
  LAW_NEAR("L8", "stopped beyond the overlap limit", (double)t.out.stopped, 0, 0);
  if (t.fast < 15.4) LAW_NEAR("L8", "too fast for the walls", (double)t.refused.stopped, tries, 0);
  scree_particle_free(particle);
}

/* One level of one shape: a test, so that one that fails does not hide the others. */
typedef struct level_case {
  const char *name;
  bool scan;
  size_t count;
  char title[64];
} level_case;

static void check_case(void **state) {
  const level_case *c = *state;
  char path[1000];
  if (c->scan && !(scan_data_folder() && scan_data_path(c->name, path, sizeof path))) {
    skip();
    return; /* the compiler does not know that skip() never comes back */
  }
  scree_mesh level = level_of(c->scan ? path : c->name, c->scan, c->count);
  check_level(c->name, level.triangle_count, &level);
  scree_mesh_free(&level);
}

/* Levels `first`, first + step ... of the table of counts. */
static size_t list_shape(const char *name, bool scan, size_t first, size_t step,
                         level_case *cases) {
  size_t count = 0;
  for (size_t i = full ? 0 : first; i < COUNTS; i += full ? 1 : step) {
    level_case *c = &cases[count++];
    *c = (level_case){.name = name, .scan = scan, .count = counts[i]};
    snprintf(c->title, sizeof c->title, "%s at %zu", name, counts[i]);
  }
  return count;
}

int main(int argument_count, char **arguments) {
  static const char *const samples[] = {"fp-1", "dc-2", "sp-3", "fp-2", "dc-1", "sp-1"};
  static const char *const scans[] = {"rock_chrono4.obj", "ycb_power_drill.obj", "stone_E22.ply",
                                      "imu_adis16480.stl", "stone_073ac.ply"};
  static level_case cases[11 * COUNTS];
  static struct CMUnitTest tests[11 * COUNTS];
  size_t count = 0;
  full = argument_count > 1 && strcmp(arguments[1], "full") == 0;
  for (size_t i = 0; i < (full ? 6 : 3); i++)
    count += list_shape(samples[i], false, i, 3, cases + count);
  for (size_t i = 0; i < (full ? 5 : 2); i++)
    count += list_shape(scans[i], true, 1 + i, 3, cases + count);
  for (size_t i = 0; i < count; i++)
    tests[i] = (struct CMUnitTest){
        .name = cases[i].title, .test_func = check_case, .initial_state = &cases[i]};
  return _cmocka_run_group_tests("decimated", tests, count, NULL, NULL);
}
