/* Greedy methods, and what clumps are written to: tables, figures, particles, other codes. */
#include "base/rng.h"
#include "base/vec.h"
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/overlap.h"
#include "support/shapes.h"

/* A box, its clumps, and all that is written of them. */
typedef struct made {
  scree_mesh mesh;
  scree_clumps clumps;
  scree_clump_entry entry;
  scree_clump_report report;
  scree_particle *particle;
} made;

static scree_clumps make(const scree_mesh *mesh, scree_clump_method method, size_t most) {
  scree_clump_options options = scree_default_clump_options();
  scree_clumps clumps;
  scree_error error;
  options.most = most;
  options.method = method;
  CHECK_OK(scree_clumps_make(mesh, &options, NULL, &clumps, &error), error);
  return clumps;
}

static void set_up(made *m) {
  scree_error error;
  mat3 turn = quat_to_mat3(quat_unit((quat){0.9, 0.2, -0.3, 0.1}));
  *m = (made){.mesh = shape_grid_box(0.03, 0.02, 0.012, 2)};
  shape_transform(&m->mesh, &turn, (vec3){0.1, 0.2, -0.3});
  m->clumps = make(&m->mesh, SCREE_CLUMP_PEELING, 8);
  m->entry = (scree_clump_entry){.name = "box",
                                 .file = "box.stl",
                                 .format = "STL binary",
                                 .unit_m = 1e-3,
                                 .mesh = &m->mesh,
                                 .clumps = &m->clumps,
                                 .chosen = scree_clumps_of_count(&m->clumps, 8)};
  m->report = (scree_clump_report){&m->entry, 1, "scree clump box.stl"};
  CHECK_OK(scree_clump_particle(&m->clumps, m->entry.chosen, &m->particle, &error), error);
}

static void clean_up(made *m) {
  scree_particle_free(m->particle);
  scree_clumps_free(&m->clumps);
  scree_mesh_free(&m->mesh);
}

/* All spheres moved together cover more than any method that places one by one, as points count it.
 */
static void fitted_is_best(void **state) {
  (void)state;
  enum { SPHERES = 5, LINES = 2000 };
  scree_mesh mesh = shape_grid_box(3, 2, 1.2, 2);
  double best = 0;
  for (int method = 0; scree_clump_method_name((scree_clump_method)method); method++) {
    scree_clumps clumps = make(&mesh, (scree_clump_method)method, SPHERES);
    const scree_clump *c = scree_clumps_of_count(&clumps, SPHERES);
    overlap_counts counts = overlap_count(&mesh, c->spheres, c->sphere_count, LINES);
    double iou = overlap_iou(&counts);
    CHECK_NEAR(iou, c->iou, 0.015);
    if (method == SCREE_CLUMP_FITTED)
      best = iou;
    else
      assert_true(iou < best);
    assert_true(c->sphere_count >= 1 && iou > 0.001);
    if (method == SCREE_CLUMP_PEELING || method == SCREE_CLUMP_FAVIER)
      CHECK_NEAR(c->outside, 0, 1e-9); /* inscribed */
    scree_clumps_free(&clumps);
  }
  scree_mesh_free(&mesh);
}

/* The largest ball inside a box touches its widest faces; the next ones are as large. */
static void peeling_begins_with_the_largest_ball(void **state) {
  (void)state;
  made m;
  set_up(&m);
  CHECK_NEAR(scree_clumps_of_count(&m.clumps, 1)->spheres[0].radius, 0.006, 2e-4);
  for (size_t i = 1; i < m.clumps.clump_count; i++)
    assert_true(m.clumps.clumps[i].iou >= m.clumps.clumps[i - 1].iou - 1e-12);
  clean_up(&m);
}

/* No two spheres of a bubble pack meet at a larger angle than asked. */
static void bubbles_keep_their_angle(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846;
  scree_mesh mesh = shape_grid_box(3, 2, 1.2, 2);
  scree_clump_options options = scree_default_clump_options();
  scree_clumps clumps;
  scree_error error;
  options.method = SCREE_CLUMP_BUBBLE;
  options.angle_deg = 100;
  options.ratio = 0.3;
  CHECK_OK(scree_clumps_make(&mesh, &options, NULL, &clumps, &error), error);
  const scree_clump *c = &clumps.clumps[clumps.clump_count - 1];
  assert_true(c->sphere_count > 2);
  for (size_t i = 0; i < c->sphere_count; i++) {
    assert_true(c->spheres[i].radius >= 0.3 * c->spheres[0].radius);
    for (size_t k = 0; k < i; k++) {
      const scree_sphere *s = &c->spheres[i], *t = &c->spheres[k];
      double d = vec3_distance(vec3_load(s->centre), vec3_load(t->centre));
      double cosine =
          (s->radius * s->radius + t->radius * t->radius - d * d) / (2 * s->radius * t->radius);
      assert_true(180 - 180 / pi * acos(fmax(-1, fmin(1, cosine))) <= 100 + 1e-6);
    }
  }
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

/* Mass, centre and inertia are the box's, by the closed form, also through a file. */
static void the_bodys_mass_goes_along(void **state) {
  (void)state;
  made m;
  scree_error error;
  set_up(&m);
  CHECK_OK(scree_spheres_write(&m.clumps, m.entry.chosen, 1e-3, in_folder("c.csv"), false, &error),
           error);
  scree_particle *read;
  CHECK_OK(scree_particle_clump_read(in_folder("c.csv"), NULL, &read, &error), error);
  const double s[3] = {0.03, 0.02, 0.012}, volume = s[0] * s[1] * s[2];
  scree_particle *both[2] = {m.particle, read};
  for (int i = 0; i < 2; i++) {
    scree_particle_measures p;
    scree_particle_measure(both[i], &p);
    assert_int_equal(p.kind, SCREE_PARTICLE_CLUMP);
    assert_int_equal(p.point_count, m.entry.chosen->sphere_count);
    CHECK_NEAR(p.volume, volume, 1e-12 * volume);
    for (int k = 0; k < 3; k++) {
      double a = s[(k + 1) % 3], b = s[(k + 2) % 3], moment = volume / 12 * (a * a + b * b);
      CHECK_NEAR(p.inertia[k], moment, 1e-9 * moment);
      CHECK_NEAR(p.centre[k], m.clumps.measures.centroid[k], 1e-12);
    }
  }
  scree_particle_free(read);
  clean_up(&m);
}

/* A table names the unit that it was written in, which holds unless the options say otherwise. */
static void a_table_names_its_unit(void **state) {
  (void)state;
  static const double units[] = {1, 1e-3, 0.0254};
  made m;
  scree_error error;
  scree_particle_measures p, q;
  set_up(&m);
  scree_particle_measure(m.particle, &p);
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    scree_particle *read;
    scree_read_options o = scree_default_read_options();
    CHECK_OK(
        scree_spheres_write(&m.clumps, m.entry.chosen, units[i], in_folder("u.csv"), true, &error),
        error);
    for (int given = 0; given < 2; given++) {
      double scale = given ? pow(o.unit_m / units[i], 3) : 1;
      o.ignore_comment_unit = given;
      CHECK_OK(scree_particle_clump_read(in_folder("u.csv"), &o, &read, &error), error);
      scree_particle_measure(read, &q);
      CHECK_NEAR(q.volume, scale * p.volume, 1e-9 * scale * p.volume);
      scree_particle_free(read);
    }
  }
  clean_up(&m);
}

static scree_status write_for(const scree_particle *particle, const char *code,
                              const scree_code_write_options *options, scree_error *error) {
  return scree_code_write(particle, scree_code_find(code), options, in_folder("."), NULL, error);
}

/* EDEM's table, read as any other, has the particle's spheres; MFiX's has them in diameters of the
 * bounding sphere, each with no more than its whole surface and all with more than the largest. */
static void other_codes_get_the_spheres(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846;
  made m;
  scree_error error;
  scree_particle *read;
  scree_particle_measures p;
  scree_code_write_options o = scree_default_code_write_options();
  set_up(&m);
  scree_particle_measure(m.particle, &p);
  o.name = "other";
  CHECK_OK(write_for(m.particle, "edem", &o, &error), error);
  CHECK_OK(write_for(m.particle, "mfix", &o, &error), error);
  scree_read_options metres = scree_default_read_options();
  metres.unit_m = 1;
  CHECK_OK(scree_particle_clump_read(in_folder("other.tsv"), &metres, &read, &error), error);
  scree_particle_measures q;
  scree_particle_measure(read, &q);
  assert_int_equal(q.point_count, p.point_count);
  scree_particle_free(read);
  FILE *f = fopen(in_folder("other-gsp_config.csv"), "r");
  assert_non_null(f);
  char line[512];
  double area = 0, size = 2 * p.bounding_radius;
  assert_non_null(fgets(line, sizeof line, f));
  assert_non_null(fgets(line, sizeof line, f));
  for (size_t i = 0; i < p.point_count; i++) {
    double c[3], r, row[5];
    scree_particle_point(m.particle, i, c, &r);
    assert_non_null(fgets(line, sizeof line, f));
    assert_int_equal(
        sscanf(line, "%lf,%lf,%lf,%lf,%lf,", &row[0], &row[1], &row[2], &row[3], &row[4]), 5);
    for (int k = 0; k < 3; k++) CHECK_NEAR(row[k] * size, c[k], 1e-9);
    CHECK_NEAR(row[3] * size, 2 * r, 1e-9);
    assert_true(row[4] <= pi * row[3] * row[3] * (1 + 1e-9));
    area += row[4] * size * size;
  }
  assert_null(fgets(line, sizeof line, f));
  (void)fclose(f);
  double ball = cbrt(36 * pi * p.volume * p.volume);
  assert_true(area > ball && area < 2 * ball);
  clean_up(&m);
}

static void a_wrong_mass_is_told(void **state) {
  (void)state;
  static const char *const lines[] = {"# volume -1", "# volume", "# centroid 1 2",
                                      "# inertia 1 1 1 0 0 x", "# inertia 1 1 9 0 0 0"};
  for (size_t i = 0; i < 2 * sizeof lines / sizeof *lines; i++) {
    bool is_own = i % 2; /* comments of others say what they like */
    FILE *f = fopen(in_folder("w.csv"), "w");
    assert_non_null(f);
    fprintf(f, "x,y,z,radius\n# %s 0.2.0, unit 0.001 m\n%s\n0,0,0,1\n", is_own ? "scree" : "other",
            lines[i / 2]);
    (void)fclose(f);
    scree_particle *particle = NULL;
    scree_error error;
    scree_status status = scree_particle_clump_read(in_folder("w.csv"), NULL, &particle, &error);
    assert_int_equal(status, is_own ? SCREE_BAD_FILE : SCREE_OK);
    if (is_own) assert_non_null(strstr(error.message, "line 3"));
    scree_particle_free(particle);
  }
}

static scree_status read_text(const char *text, scree_particle **particle, scree_error *error) {
  FILE *f = fopen(in_folder("t.csv"), "w");
  assert_non_null(f);
  assert_true(fputs(text, f) >= 0);
  (void)fclose(f);
  *error = (scree_error){0};
  return scree_particle_clump_read(in_folder("t.csv"), NULL, particle, error);
}

/* The same two spheres, in mm, as every program writes them. */
static void columns_go_by_their_names(void **state) {
  (void)state;
  static const char *const tables[] = {
      "1 2 3 4\n6 2 3 2\n",          /* CLUMP */
      "1,2,3,4\n6,2,3,2\n",          /* MClump */
      "x,y,z,r\n1,2,3,4\n6,2,3,2\n", /* DEM-Engine */
      "radius,x,y,z\n4,1,2,3\n2,6,2,3\n",
      "x,y,z,diameter\n1,2,3,8\n6,2,3,4\n",
      "# a comment\n% another\nid;name;D;Z;Y;X\n7;big;8;3;2;1\n9;small;4;3;2;6\n",
      "X (m)\tY (m)\tZ (m)\tRadius (m)\n.001\t.002\t.003\t.004\n.006\t.002\t.003\t.002\n",
      "1 1 2 3 4\n2 6 2 3 2\n",
      "0, 1, 2, 3, 4 # the big one\n1, 6, 2, 3, 2\n",
      "# x y z r\n1 2 3 4\n6 2 3 2\n",
      "\"pos_x\",\"pos_y\",\"pos_z\",\"Sphere radius [mm]\"\n1,2,3,4\n6,2,3,2\n",
      "; a comment\nclump template create ...\n pebbles 2 ...\n 4 1 2 3 ... ; big\n 2 6 2 3\n"};
  for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
    scree_particle *p;
    scree_error error;
    scree_particle_measures m;
    double a[3], b[3], r, s;
    CHECK_OK(read_text(tables[i], &p, &error), error);
    scree_particle_measure(p, &m);
    assert_int_equal(m.point_count, 2);
    scree_particle_point(p, 0, a, &r), scree_particle_point(p, 1, b, &s);
    CHECK_NEAR(fmax(r, s), 4e-3, 1e-12);
    CHECK_NEAR(fmin(r, s), 2e-3, 1e-12);
    CHECK_NEAR(vec3_distance(vec3_load(a), vec3_load(b)), 5e-3, 1e-9);
    assert_int_equal(scree_particle_piece_count(p), 1);
    scree_particle_free(p);
  }
}

#define COMMAS_20 ",,,,,,,,,,,,,,,,,,,,"
#define COMMAS_80 COMMAS_20 COMMAS_20 COMMAS_20 COMMAS_20
static void what_is_no_table_is_told(void **state) {
  (void)state;
  static const struct {
    const char *text, *said;
  } tables[] = {{"x,y,z\n1,2,3\n", "no column is named radius or diameter"},
                {"x,y,radius\n1,2,3\n", "no column is named z"},
                {"x,y,z,r,X\n1,2,3,4,5\n", "columns 1 and 5 both say x"},
                {"x;y;z;r\n0,1;0,2;0,3;0,4\n", "with a decimal comma; write a point"},
                {"x,y,z,r\n1,2,3\n", "3 columns, but the first line names 4"},
                {"1 2 3\n", "line 1: must be x, y, z, radius"},
                {"5 1 2 3 4\n9 1 2 3 4\n", "other columns are named in a first line"},
                {"a b c\n", "must be x, y, z, radius"},
                {"x,y,z,r" COMMAS_80 "\n1,2,3,4" COMMAS_80 "\n", "more than 64 columns"},
                {"x,y,z,r\n1,2,3,-4\n", "the radius is"},
                {"clump template create pebbles 2 1 0 0 0", "pebble 2 of 2"},
                {"clump template create", "no pebbles"}};
  for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
    scree_particle *p;
    scree_error error;
    assert_int_equal(read_text(tables[i].text, &p, &error), SCREE_BAD_FILE);
    if (!strstr(error.message, tables[i].said)) fail_msg("'%s'", error.message);
  }
}

/* PFC's own mass and moments come back. */
static void pebbles_bring_their_body(void **state) {
  (void)state;
  made m;
  scree_error error;
  scree_particle *read;
  scree_particle_measures p, q;
  scree_code_write_options o = scree_default_code_write_options();
  scree_read_options metres = scree_default_read_options();
  set_up(&m);
  o.name = "pebbles";
  metres.unit_m = 1;
  CHECK_OK(write_for(m.particle, "pfc", &o, &error), error);
  CHECK_OK(scree_particle_clump_read(in_folder("pebbles.dat"), &metres, &read, &error), error);
  scree_particle_measure(m.particle, &p);
  scree_particle_measure(read, &q);
  assert_int_equal(p.point_count, q.point_count);
  CHECK_NEAR(q.volume, p.volume, 1e-9 * p.volume);
  for (int k = 0; k < 3; k++) CHECK_NEAR(q.inertia[k], p.inertia[k], 1e-8 * p.inertia[k]);
  scree_particle_free(read);
  clean_up(&m);
}

/* Against all pairs, on random spheres. */
static void pieces_are_counted(void **state) {
  (void)state;
  scree_rng rng = {4, 0, 0};
  enum { COUNT = 12 };
  for (int round = 0; round < 200; round++) {
    double centres[3 * COUNT], radii[COUNT];
    int group[COUNT], pieces = COUNT;
    scree_particle *p;
    scree_error error;
    for (int i = 0; i < COUNT; i++) {
      for (int k = 0; k < 3; k++) centres[3 * i + k] = 4 * scree_rng_uniform(&rng);
      radii[i] = 0.2 + 0.5 * scree_rng_uniform(&rng);
      group[i] = i;
    }
    for (int i = 0; i < COUNT; i++)
      for (int j = 0; j < i; j++) {
        double d = vec3_distance(vec3_load(centres + 3 * i), vec3_load(centres + 3 * j));
        int from = group[i], to = group[j];
        if (d > radii[i] + radii[j] || from == to) continue;
        pieces--;
        for (int k = 0; k < COUNT; k++)
          if (group[k] == from) group[k] = to;
      }
    CHECK_OK(scree_particle_clump(centres, radii, COUNT, NULL, &p, &error), error);
    assert_int_equal(scree_particle_piece_count(p), pieces);
    scree_particle_free(p);
  }
}

static scree_status write_json(void *context, scree_error *error) {
  made *m = context;
  return scree_clump_json_write(&m->report, in_folder("a.json"), true, error);
}
static scree_status write_csv(void *context, scree_error *error) {
  made *m = context;
  return scree_clump_csv_write(&m->report, in_folder("a.csv"), true, error);
}
static scree_status write_figure(void *context, scree_error *error) {
  made *m = context;
  return scree_clump_figure_write(&m->report, in_folder("a-figure.csv"), true, error);
}
static scree_status write_spheres(void *context, scree_error *error) {
  made *m = context;
  return scree_spheres_write(&m->clumps, m->entry.chosen, 1, in_folder("s.csv"), true, error);
}
static scree_status make_particle(void *context, scree_error *error) {
  made *m = context;
  scree_particle *particle = NULL;
  scree_status status = scree_clump_particle(&m->clumps, m->entry.chosen, &particle, error);
  scree_particle_free(particle);
  return status;
}
static scree_status write_code(void *context, scree_error *error) {
  made *m = context;
  scree_code_write_options o = scree_default_code_write_options();
  scree_status status = SCREE_OK;
  o.name = "clump";
  o.overwrite = true;
  for (size_t code = 0; scree_code_name(code) && status == SCREE_OK; code++)
    if (scree_code_takes(code, SCREE_PARTICLE_CLUMP))
      status = scree_code_write(m->particle, code, &o, in_folder("."), NULL, error);
  return status;
}

static void memory_may_run_out(void **state) {
  (void)state;
  made m;
  set_up(&m);
  check_allocation_failures(write_json, &m);
  check_allocation_failures(write_csv, &m);
  check_allocation_failures(write_figure, &m);
  check_allocation_failures(write_spheres, &m);
  check_allocation_failures(make_particle, &m);
  check_allocation_failures(write_code, &m);
  clean_up(&m);
}

static void a_mesh_is_no_clump(void **state) {
  (void)state;
  scree_particle *box = shape_particle(shape_box(1, 2, 3));
  scree_error error;
  assert_int_equal(write_for(box, "pfc", NULL, &error), SCREE_BAD_ARGUMENT);
  scree_particle_free(box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(fitted_is_best),
      cmocka_unit_test(peeling_begins_with_the_largest_ball),
      cmocka_unit_test(bubbles_keep_their_angle),
      cmocka_unit_test(the_bodys_mass_goes_along),
      cmocka_unit_test(a_table_names_its_unit),
      cmocka_unit_test(other_codes_get_the_spheres),
      cmocka_unit_test(a_wrong_mass_is_told),
      cmocka_unit_test(columns_go_by_their_names),
      cmocka_unit_test(what_is_no_table_is_told),
      cmocka_unit_test(pebbles_bring_their_body),
      cmocka_unit_test(pieces_are_counted),
      cmocka_unit_test(memory_may_run_out),
      cmocka_unit_test(a_mesh_is_no_clump),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
