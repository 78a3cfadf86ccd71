/* Memory running out in particles, worlds, checkpoints and runs: every public call refuses with a
 * sentence, leaks nothing and leaves no file half-written. tests/allocations.sh keeps the list. */
#include "study/study.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "world/state/world.h"

#include <unistd.h>

static char file[] = "/tmp/scree-memory-XXXXXX";
static const char *backend = "cpu";

/* ---- Particles ---- */

static scree_status make_particles(void *context, scree_error *error) {
  static const double centres[6] = {0, 0, 0, 0.01, 0, 0}, radii[2] = {0.01, 0.008};
  scree_particle *made[5] = {NULL};
  scree_status status = scree_particle_from_mesh(context, NULL, &made[0], error);
  if (status == SCREE_OK) status = scree_particle_sphere(0.01, &made[1], error);
  if (status == SCREE_OK) status = scree_particle_clump(centres, radii, 2, NULL, &made[2], error);
  if (status == SCREE_OK)
    status = scree_particle_clump(centres, radii, 2, made[0], &made[3], error);
  if (status == SCREE_OK) status = scree_particle_clump_read(file, NULL, &made[4], error);
  for (int i = 0; i < 5; i++) scree_particle_free(made[i]);
  return status;
}

static void particles(void **state) {
  (void)state;
  scree_mesh box = shape_box(0.04, 0.03, 0.012);
  FILE *table = fopen(file, "w");
  fputs("0 0 0 10\n10 0 0 8\n", table);
  fclose(table);
  check_allocation_failures(make_particles, &box);
  scree_mesh_free(&box);
}

/* ---- Worlds ---- */

static scree_status add_walls(scree_world *world, scree_mesh *mesh, scree_error *error) {
  static const double up[3] = {0, 0, 0.1}, still[3] = {0, 0, 0};
  const scree_wall walls[] = {{.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}},
                              {.kind = SCREE_WALL_CYLINDER, .axis = {0, 0, 1}, .radius = 0.1},
                              {.kind = SCREE_WALL_MESH,
                               .axis = {0, 0, 1},
                               .position = {-0.05, -0.05, -0.011},
                               .mesh = mesh}};
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < sizeof walls / sizeof *walls && status == SCREE_OK; i++)
    status = scree_world_add_wall(world, &walls[i], NULL, error);
  if (status == SCREE_OK) status = scree_world_set_wall_velocity(world, 1, up, still, error);
  return status;
}

static scree_status add_motions(scree_world *world, scree_error *error) {
  static const double rows[4] = {0, 0, 1, 0.01}, side[3] = {0.1, 0, 0}, still[3] = {0, 0, 0};
  scree_wall_motion motion = scree_default_wall_motion();
  motion.law = SCREE_MOTION_POSITIONS, motion.table = rows, motion.row_count = 2;
  scree_status status = scree_world_set_wall_motion(world, 0, &motion, 1, error);
  if (status == SCREE_OK)
    status = scree_world_set_wall_surface(world, 2, side, still, (double[3]){0}, error);
  if (status == SCREE_OK) status = scree_world_set_body_force(world, 1, side, still, error);
  return status;
}

/* Two boxes on the floor and two above them. */
static scree_status add_bodies(scree_world *world, scree_particle *particle, scree_error *error) {
  scree_status status = SCREE_OK;
  for (int i = 0; i < 4 && status == SCREE_OK; i++) {
    scree_body body = scree_default_body();
    body.position[0] = 0.05 * (i % 2);
    body.position[2] = i < 2 ? 0.0059 : 0.019;
    body.velocity[2] = i < 2 ? 0 : -0.5;
    status = scree_world_add_body(world, particle, 0, &body, NULL, error);
  }
  return status;
}

typedef struct parts {
  scree_mesh shape, plate;
  scree_particle *particle;
} parts;

static scree_status make_world(parts *p, scree_world **world, scree_error *error) {
  scree_world_options options = scree_default_world_options();
  scree_material material = scree_default_material();
  options.stiffness_factor = 0.01;
  scree_status status = scree_world_create(&options, world, error);
  for (int i = 0; i < 2 && status == SCREE_OK; i++)
    status = scree_world_add_material(*world, &material, NULL, error);
  if (status == SCREE_OK) status = scree_world_set_contact(*world, 0, 1, 0.5, 0.2, error);
  if (status == SCREE_OK) status = add_walls(*world, &p->plate, error);
  if (status == SCREE_OK) status = add_bodies(*world, p->particle, error);
  if (status == SCREE_OK) status = add_motions(*world, error);
  return status;
}

static bool count_contact(void *context, const scree_contact *contact) {
  (void)contact;
  ++*(size_t *)context;
  return true;
}

static scree_status build_world(void *context, scree_error *error) {
  const scree_material material = scree_default_material();
  scree_material_contact contact;
  scree_world *world = NULL;
  scree_status status = scree_world_create(NULL, &world, error);
  if (status == SCREE_OK) status = scree_world_add_material(world, &material, NULL, error);
  if (status == SCREE_OK)
    status = scree_world_add_wall(world, &(scree_wall){.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}},
                                  NULL, error);
  if (status == SCREE_OK) status = scree_world_set_contact(world, 0, 0, 0.5, 0.2, error);
  if (status == SCREE_OK) status = scree_world_get_pair(world, 0, 0, &contact, error);
  if (status == SCREE_OK) status = scree_world_set_pair(world, 0, 0, &contact, error);
  if (status == SCREE_OK)
    status = scree_world_set_wall_velocity(world, 0, (double[3]){0}, (double[3]){0}, error);
  if (status == SCREE_OK)
    status = scree_world_add_body(world, ((parts *)context)->particle, 0, NULL, NULL, error);
  const scree_wall_motion motion = scree_default_wall_motion();
  if (status == SCREE_OK) status = scree_world_set_wall_motion(world, 0, &motion, 1, error);
  if (status == SCREE_OK)
    status = scree_world_set_wall_surface(world, 0, (double[3]){1}, (double[3]){0}, (double[3]){0},
                                          error);
  if (status == SCREE_OK) status = scree_world_set_body_density(world, 0, 1500, error);
  if (status == SCREE_OK)
    status = scree_world_set_body_force(world, 0, (double[3]){0}, (double[3]){0}, error);
  const scree_body body = scree_default_body();
  if (status == SCREE_OK) status = scree_world_set_body(world, 0, &body, error);
  scree_world_free(world);
  return status;
}

static scree_status step_world(void *context, scree_error *error) {
  scree_world *world = NULL;
  size_t contacts = 0;
  char description[256];
  scree_status status = scree_check_backend(backend, description, error);
  if (status == SCREE_OK) status = scree_set_backend(backend, error);
  if (status == SCREE_OK) status = make_world(context, &world, error);
  if (status == SCREE_OK) status = scree_world_set_backend(world, backend, error);
  if (status == SCREE_OK) status = scree_world_keep(world, file, 25, error);
  if (status == SCREE_OK) status = scree_world_step(world, 60, error);
  if (status == SCREE_OK)
    status = scree_world_visit_contacts(world, count_contact, &contacts, error);
  if (status == SCREE_OK) assert_true(contacts > 0);
  scree_world_free(world);
  return status;
}

static scree_status save_world(void *context, scree_error *error) {
  return scree_world_save(context, file, true, error);
}

static scree_status load_world(void *context, scree_error *error) {
  (void)context;
  scree_world *world = NULL;
  scree_status status = scree_world_load(file, &world, error);
  scree_world_free(world);
  return status;
}

static scree_status write_world_vtk(void *context, scree_error *error) {
  scree_status status = SCREE_OK;
  for (int view = 0; view < SCREE_VIEW_COUNT && status == SCREE_OK; view++)
    status = scree_world_vtp_write(context, (scree_world_view)view, file, true, error);
  return status;
}

static void worlds(void **state) {
  (void)state;
  scree_error error;
  scree_world *world = NULL;
  parts p = {.shape = shape_box(0.04, 0.03, 0.012), .plate = shape_box(0.1, 0.1, 0.01)};
  CHECK_OK(scree_particle_from_mesh(&p.shape, NULL, &p.particle, &error), error);
  check_allocation_failures(build_world, &p);
  check_allocation_failures(step_world, &p);
  CHECK_OK(make_world(&p, &world, &error), error);
  CHECK_OK(scree_world_step(world, 60, &error), error);
  check_allocation_failures(write_world_vtk, world);
  check_allocation_failures(save_world, world);
  check_allocation_failures(load_world, NULL);
  scree_world_free(world);
  scree_particle_free(p.particle);
  scree_mesh_free(&p.shape);
  scree_mesh_free(&p.plate);
}

/* ---- heaps ---- */

static scree_status measure_heap(void *context, scree_error *error) {
  (void)context;
  const scree_repose_options options = scree_default_repose_options();
  scree_height_field field = {0};
  scree_repose repose;
  scree_status status = scree_height_field_create(0, 0, 0.5, 0.02, &field, error);
  for (size_t i = 0; status == SCREE_OK && i < field.rows * field.columns; i++) {
    double x = (double)(i % field.columns) - 24.5, y = (double)(i / field.columns) - 24.5;
    field.height[i] = fmax(0, 0.2 - 0.01 * hypot(x, y));
  }
  if (status == SCREE_OK) status = scree_repose_measure(&field, &options, &repose, error);
  scree_height_field_free(&field);
  return status;
}

static void heaps(void **state) {
  (void)state;
  check_allocation_failures(measure_heap, NULL);
}

static scree_status fit(void *context, scree_error *error) {
  static const double x[] = {1, 2, 4, 8, 16}, y[] = {1, 0.7, 0.52, 0.37, 0.26};
  (void)context;
  scree_power_law power;
  scree_polynomial polynomial;
  scree_status status = scree_fit_power(x, y, 5, 0.95, &power, error);
  if (status == SCREE_OK) status = scree_fit_polynomial(x, y, 5, 2, &polynomial, error);
  return status;
}

static void fits(void **state) {
  (void)state;
  check_allocation_failures(fit, NULL);
}

static int make_file(void **state) {
  (void)state;
  int fd = mkstemp(file);
  return fd < 0 ? -1 : close(fd);
}

static int remove_file(void **state) {
  (void)state;
  return unlink(file);
}

/* With a backend's name: there. */
int main(int argc, char **argv) {
  if (argc > 1) backend = argv[1];
  use_threads(0); /* the same allocations in every run, whatever the clock says of a step */
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles),
      cmocka_unit_test(worlds),
      cmocka_unit_test(heaps),
      cmocka_unit_test(fits),
  };
  return cmocka_run_group_tests(tests, make_file, remove_file);
}
