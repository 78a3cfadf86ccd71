/* Memory running out where folders, pages and pictures of worlds are made: every public call
 * refuses with a sentence, leaks nothing and leaves no file half-written. tests/allocations.sh
 * keeps the list. */
#include "base/file.h"
#include "report/program.h"
#include "report/provenance.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/pot.h"
#include "support/shapes.h"

/* ---- Texts, folders, pages ---- */

static scree_status write_texts(void *context, scree_error *error) {
  const scree_work_start start = scree_work_started();
  (void)context;
  scree_status status = scree_folder_create(in_folder("a/b/c"), error);
  if (status == SCREE_OK) status = scree_output_check(in_folder("a/b/text"), true, error);
  if (status == SCREE_OK) status = scree_text_write("text\n", in_folder("a/b/text"), true, error);
  if (status == SCREE_OK)
    status = scree_provenance_write(&start, "test", in_folder("a/provenance.json"), true, error);
  return status;
}

static void texts(void **state) {
  (void)state;
  assert_true(check_allocation_failures(write_texts, NULL) >= 5);
}

static scree_status write_page(void *context, scree_error *error) {
  return scree_page_write(context, 1, in_folder("report.html"), true, error);
}

static scree_status write_named_page(void *context, scree_error *error) {
  const char *const *folders = context;
  return scree_page_write_named(folders[0], "other", in_folder("named.html"), true, error);
}

/* One folder with a choice, its text, provenance and two files of levels. */
static void pages(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(0.02, 2);
  const scree_simplify_options simplify = scree_default_simplify_options();
  const scree_work_start start = scree_work_started();
  scree_curve *curve = NULL;
  scree_choice choice = {0};
  scree_error error;
  char results[400];
  const char *folders[] = {results};
  snprintf(results, sizeof results, "%s", in_folder("results"));
  CHECK_OK(scree_folder_create(in_folder("results/levels"), &error), error);
  CHECK_OK(scree_text_write("[]", in_folder("results/choice.json"), false, &error), error);
  CHECK_OK(scree_text_write("<one>", in_folder("results/choice.txt"), false, &error), error);
  CHECK_OK(
      scree_provenance_write(&start, "test", in_folder("results/provenance.json"), false, &error),
      error);
  CHECK_OK(scree_curve_build(&ball, &simplify, NULL, &curve, &error), error);
  CHECK_OK(scree_choose(curve, &ball, NULL, NULL, &choice, &error), error);
  for (int i = 0; i < 2; i++) {
    const char *path = in_folder(i ? "results/levels/b.levels" : "results/levels/a.levels");
    CHECK_OK(scree_levels_write(curve, &choice, 100000, path, false, &error), error);
  }
  assert_true(check_allocation_failures(write_page, folders) >= 8);
  assert_true(check_allocation_failures(write_named_page, folders) >= 8);
  scree_choice_free(&choice);
  scree_curve_free(curve);
  scree_mesh_free(&ball);
}

/* ---- Worlds and scenes ---- */

static scree_status export_world(void *context, scree_error *error) {
  scree_export_options options = scree_default_export_options();
  options.overwrite = true;
  return scree_world_export(context, &options, in_folder("pile"), error);
}

static scree_status draw_world(void *context, scree_error *error) {
  scree_render_options options = scree_default_render_options();
  scree_image image = {0};
  options.width = options.height = 64;
  options.samples = 1;
  scree_status status = scree_world_picture(context, &options, NULL, &image, error);
  scree_image_free(&image);
  return status;
}

static scree_status draw_scene(void *context, scree_error *error) {
  scree_render_options options = scree_default_render_options();
  scree_image image = {0};
  options.width = options.height = 64;
  options.samples = 1;
  scree_status status = scree_scene_pile_picture(context, &options, NULL, &image, error);
  scree_image_free(&image);
  return status;
}

static void scenes(void **state) {
  (void)state;
  const scree_poured ball = {"ball", "sphere", "0.04", 1};
  scree_scene_file *file = pot_file("4", &ball, 1);
  scree_error error;
  set_field(file, "cylinder.diameter", "0.2");
  scree_scene *scene = pot_scene(file);
  CHECK_OK(scree_scene_advance(scene, 500, &error), error);
  scree_status status = draw_scene(scene, &error);
  if (status != SCREE_UNSUPPORTED) check_allocation_failures(draw_scene, scene);
  scree_scene_free(scene);
  scree_scene_file_free(file);
  if (status == SCREE_UNSUPPORTED) skip();
}

/* A box, a sphere and a clump over a plate. */
static scree_world *make_world(const scree_mesh *box, const scree_mesh *plate) {
  static const double centres[6] = {0, 0, 0, 0.01, 0, 0}, radii[2] = {0.01, 0.008};
  const scree_material material = scree_default_material();
  const scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = plate};
  scree_particle *particles[3] = {NULL};
  scree_world *world = NULL;
  scree_error error;
  CHECK_OK(scree_world_create(NULL, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  CHECK_OK(scree_particle_from_mesh(box, NULL, &particles[0], &error), error);
  CHECK_OK(scree_particle_sphere(0.01, &particles[1], &error), error);
  CHECK_OK(scree_particle_clump(centres, radii, 2, NULL, &particles[2], &error), error);
  for (int i = 0; i < 3; i++) {
    scree_body body = scree_default_body();
    body.position[0] = 0.05 * i;
    body.position[2] = 0.05;
    CHECK_OK(scree_world_add_body(world, particles[i], 0, &body, NULL, &error), error);
    scree_particle_free(particles[i]);
  }
  return world;
}

static void worlds(void **state) {
  (void)state;
  scree_mesh box = shape_box(0.04, 0.03, 0.012), plate = shape_box(0.1, 0.1, 0.01);
  scree_world *world = make_world(&box, &plate);
  scree_error error;
  check_allocation_failures(export_world, world);
  scree_status status = draw_world(world, &error);
  if (status != SCREE_UNSUPPORTED) check_allocation_failures(draw_world, world);
  scree_world_free(world);
  scree_mesh_free(&box);
  scree_mesh_free(&plate);
  if (status == SCREE_UNSUPPORTED) skip();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(texts),
      cmocka_unit_test(pages),
      cmocka_unit_test(worlds),
      cmocka_unit_test(scenes),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
