/* Memory running out in meshes, curves, the choice and reports: every public call refuses with a
 * sentence, leaks nothing and leaves no file half-written. tests/allocations.sh keeps the list. */
#include "choice/fidelity.h"
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

/* ---- Meshes ---- */

static scree_status copy_mesh(void *context, scree_error *error) {
  scree_mesh copy = {0};
  scree_status status = scree_mesh_copy(context, &copy, error);
  if (status == SCREE_OK) status = scree_mesh_canonicalize(&copy, error);
  scree_mesh_free(&copy);
  return status;
}

static scree_status weld_loose(void *context, scree_error *error) {
  const scree_mesh *mesh = context;
  static double corners[9 * 400];
  scree_mesh welded = {0};
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
    memcpy(corners + 3 * c, mesh->positions + 3 * (size_t)mesh->triangles[c], 3 * sizeof *corners);
  scree_status status = scree_mesh_weld(corners, mesh->triangle_count, 1e-6, &welded, NULL, error);
  scree_mesh_free(&welded);
  return status;
}

static scree_status repair_directly(void *context, scree_error *error) {
  scree_mesh repaired = {0};
  scree_status status = scree_mesh_repair(context, NULL, NULL, &repaired, NULL, error);
  scree_mesh_free(&repaired);
  return status;
}

static scree_status measure_surfaces(void *context, scree_error *error) {
  scree_surface *surface = NULL;
  scree_distance distance;
  scree_distance_options options = scree_default_distance_options();
  options.sample_count = 200;
  scree_status status = scree_surface_create(context, &surface, error);
  if (status == SCREE_OK)
    status = scree_surface_distance(surface, surface, &options, NULL, &distance, error);
  scree_surface_free(surface);
  return status;
}

static scree_status replay_curve(void *context, scree_error *error) {
  scree_replay *replay = NULL;
  const scree_mesh *level;
  scree_status status = scree_replay_start(context, &replay, error);
  if (status == SCREE_OK) status = scree_replay_step(replay, 20, &level, error);
  scree_replay_free(replay);
  return status;
}

static void meshes(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(0.02, 2), holed = ball;
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  check_allocation_failures(copy_mesh, &ball);
  check_allocation_failures(weld_loose, &ball);
  check_allocation_failures(measure_surfaces, &ball);
  CHECK_OK(scree_curve_build(&ball, &options, NULL, &curve, &error), error);
  check_allocation_failures(replay_curve, curve);
  scree_curve_free(curve);
  holed.triangle_count -= 5;
  check_allocation_failures(repair_directly, &holed);
  scree_mesh_free(&ball);
}

/* ---- The choice ---- */

static scree_choice_options quick_options(void) {
  scree_choice_options o = scree_default_choice_options();
  o.rp_min = 1e-2;
  o.rp_max = 0.5;
  o.per_decade = 3;
  return o;
}

typedef struct choosing {
  scree_mesh mesh;
  scree_curve *curve;
  scree_choice choices[2];
} choosing;

static scree_status choose_one(void *context, scree_error *error) {
  const choosing *c = context;
  const scree_choice_options options = quick_options();
  scree_choice choice = {0};
  scree_status status = scree_choose(c->curve, &c->mesh, &options, NULL, &choice, error);
  scree_choice_free(&choice);
  return status;
}

static scree_status choose_mesh(void *context, scree_error *error) {
  const choosing *c = context;
  scree_mesh scan = {0}, level = {0};
  scree_status status = scree_mesh_copy(&c->mesh, &scan, error);
  if (status == SCREE_OK) status = scree_choose_mesh(&scan, 1, NULL, &level, NULL, error);
  scree_mesh_free(&scan);
  scree_mesh_free(&level);
  return status;
}

static scree_status measure_levels(void *context, scree_error *error) {
  const choosing *c = context;
  scree_fidelity *fidelity = NULL;
  scree_status status = scree_fidelity_measure(c->curve, &c->mesh, NULL, 0, NULL, &fidelity, error);
  scree_fidelity_free(fidelity);
  return status;
}

static scree_status choose_of_two(void *context, scree_error *error) {
  const choosing *c = context;
  scree_set_choice set = {0};
  scree_status status = scree_choose_set(c->choices, 2, &set, error);
  scree_set_choice_free(&set);
  return status;
}

static scree_status load_ball(void *context, size_t index, const scree_progress *progress,
                              scree_mesh *mesh, double *scale, scree_error *error) {
  (void)index, (void)progress, (void)scale;
  return scree_mesh_copy(context, mesh, error);
}

static scree_status choose_many(void *context, scree_error *error) {
  choosing *c = context;
  scree_choice choices[2] = {{0}};
  scree_set_choice set = {0};
  scree_choice_job job = {.count = 2,
                          .simplify = scree_default_simplify_options(),
                          .options = quick_options(),
                          .load = load_ball,
                          .context = &c->mesh};
  job.options.area_only = true;
  scree_status status = scree_choose_each(&job, NULL, choices, &set, error);
  for (int i = 0; i < 2; i++) scree_choice_free(&choices[i]);
  scree_set_choice_free(&set);
  return status;
}

static void start_choosing(choosing *c) {
  const scree_simplify_options simplify = scree_default_simplify_options();
  const scree_choice_options options = quick_options();
  scree_error error;
  c->mesh = shape_icosphere(0.02, 0);
  CHECK_OK(scree_curve_build(&c->mesh, &simplify, NULL, &c->curve, &error), error);
  for (int i = 0; i < 2; i++)
    CHECK_OK(scree_choose(c->curve, &c->mesh, &options, NULL, &c->choices[i], &error), error);
}

static void end_choosing(choosing *c) {
  for (int i = 0; i < 2; i++) scree_choice_free(&c->choices[i]);
  scree_curve_free(c->curve);
  scree_mesh_free(&c->mesh);
}

static void choices(void **state) {
  (void)state;
  choosing c;
  start_choosing(&c);
  check_allocation_failures(choose_one, &c);
  check_allocation_failures(choose_mesh, &c);
  check_allocation_failures(measure_levels, &c);
  check_allocation_failures(choose_of_two, &c);
  check_allocation_failures(choose_many, &c);
  end_choosing(&c);
}

/* ---- Reports ---- */

static scree_status write_figure(void *context, scree_error *error) {
  static const char *const names[] = {"f.png", "f.svg", "f.pdf", "f.csv", "f.gnuplot"};
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < 5 && status == SCREE_OK; i++)
    status = scree_choice_figure_write(context, in_folder(names[i]), true, error);
  return status;
}

static scree_status write_tables(void *context, scree_error *error) {
  const scree_choice_report *report = context;
  scree_status status = scree_choice_json_write(report, in_folder("c.json"), true, error);
  if (status == SCREE_OK) status = scree_choice_csv_write(report, in_folder("c.csv"), true, error);
  if (status == SCREE_OK)
    status = scree_choice_curve_csv_write(report->entries, in_folder("d.csv"), true, error);
  return status;
}

static void choice_reports(void **state) {
  (void)state;
  choosing c;
  start_choosing(&c);
  scree_set_choice set;
  scree_error error;
  CHECK_OK(scree_choose_set(c.choices, 2, &set, &error), error);
  const scree_choice_options options = quick_options();
  scree_choice_entry entries[2] = {{.name = "one", .file = "one.stl", .choice = &c.choices[0]},
                                   {.name = "two", .file = "two.stl", .choice = &c.choices[1]}};
  scree_choice_report report = {
      .entries = entries, .entry_count = 2, .set = &set, .options = &options};
  check_allocation_failures(write_tables, &report);
  check_allocation_failures(write_figure, &report);
  scree_set_choice_free(&set);
  end_choosing(&c);
}

static scree_status write_measures(void *context, scree_error *error) {
  const scree_measure_entry *entry = context;
  scree_status status =
      scree_measure_json_write(entry, 1, "test", in_folder("m.json"), true, error);
  if (status == SCREE_OK)
    status = scree_measure_csv_write(entry, 1, in_folder("m.csv"), true, error);
  return status;
}

static scree_status write_distance(void *context, scree_error *error) {
  return scree_distance_json_write(context, "test", in_folder("distance.json"), true, error);
}

static scree_status write_curve(void *context, scree_error *error) {
  return scree_curve_json_write(context, "test", in_folder("curve.json"), true, error);
}

static scree_status write_check(void *context, scree_error *error) {
  return scree_check_json_write(context, 1, "test", in_folder("check.json"), true, error);
}

static scree_status write_vtk(void *context, scree_error *error) {
  static const char *const files[] = {"a.vtp", "b.vtp"};
  static const double times[] = {0, 1};
  scree_status status = scree_vtp_write(context, in_folder("a.vtp"), true, error);
  if (status == SCREE_OK)
    status = scree_pvd_write(files, times, 2, in_folder("a.pvd"), true, error);
  return status;
}

static void other_reports(void **state) {
  (void)state;
  scree_error error;
  scree_mesh ball = shape_icosphere(0.02, 1);
  scree_scan scan = {.format = "test"};
  scree_check check;
  CHECK_OK(scree_mesh_check(&ball, NULL, NULL, &check, &error), error);
  scree_check_entry checked = {.file = "a", .scan = &scan, .unit_m = 1e-3, .check = &check};
  check_allocation_failures(write_check, &checked);
  scree_measure_entry measured = {.file = "a", .format = "test", .unit_m = 1e-3};
  CHECK_OK(scree_mesh_measure(&ball, &measured.measures, &error), error);
  check_allocation_failures(write_measures, &measured);
  scree_distance_entry distance = {.file = {"a", "b"}, .unit_m = {1, 1}};
  check_allocation_failures(write_distance, &distance);
  scree_curve_row row = {0};
  scree_curve_entry curve = {
      .file = "a", .format = "test", .unit_m = 1, .rows = &row, .row_count = 1};
  check_allocation_failures(write_curve, &curve);
  scree_vtk_array array = {"x", SCREE_VTK_FLOAT64, 3, ball.positions};
  scree_vtk_data data = {.points = ball.positions,
                         .point_count = ball.vertex_count,
                         .triangles = ball.triangles,
                         .cell_count = ball.triangle_count,
                         .point_arrays = &array,
                         .point_array_count = 1,
                         .time = 1};
  check_allocation_failures(write_vtk, &data);
  scree_mesh_free(&ball);
}

static scree_status draw(void *context, scree_error *error) {
  const scree_mesh *mesh = context;
  scree_render_item item = {.mesh = mesh, .color = {0.5f, 0.5f, 0.5f}};
  scree_render_cell cell = {.items = &item, .item_count = 1, .caption = "ball"};
  scree_render_options options = scree_default_render_options();
  scree_image image = {0};
  options.width = options.height = 64;
  options.samples = 1;
  scree_status status = scree_render(&cell, 1, &options, NULL, &image, error);
  if (status == SCREE_OK)
    status = scree_image_write_png(&image, in_folder("ball.png"), true, error);
  scree_image_free(&image);
  return status;
}

static void pictures(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(0.02, 1);
  scree_error error;
  scree_status status = draw(&ball, &error);
  if (status != SCREE_UNSUPPORTED) check_allocation_failures(draw, &ball);
  scree_mesh_free(&ball);
  if (status == SCREE_UNSUPPORTED) skip();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(meshes),        cmocka_unit_test(choices),  cmocka_unit_test(choice_reports),
      cmocka_unit_test(other_reports), cmocka_unit_test(pictures),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
