/* Rods and plates run out of an open hopper, a sheet of triangles, over its lower rim: nothing goes
 * through the sheet, and the ledger closes. */
#include "support/law.h"

#include "base/rng.h"
#include "support/shapes.h"

enum { SIDES = 12, LAYERS = 4, ROW = 3, BODIES = LAYERS * ROW * ROW };
static const double top = 0.25, mouth = 0.06, height = 0.25, floor_at = -0.3;

/* A cone's sheet: its mouth at z = 0, its top where the cylinder begins. */
static scree_mesh funnel(void) {
  scree_mesh mesh = shape_make(2 * SIDES, 2 * SIDES);
  for (uint32_t i = 0; i < SIDES; i++) {
    double angle = 2 * 3.14159265358979323846 * i / SIDES;
    for (uint32_t k = 0; k < 2; k++) {
      double r = k ? top * 1.05 : mouth, *p = &mesh.positions[3 * (2 * i + k)];
      p[0] = r * cos(angle), p[1] = r * sin(angle), p[2] = k ? height : 0;
    }
    uint32_t a = 2 * i, b = 2 * ((i + 1) % SIDES), triangles[6] = {a, b, a + 1, b, b + 1, a + 1};
    memcpy(&mesh.triangles[6 * i], triangles, sizeof triangles);
  }
  return mesh;
}

static scree_world *make_hopper(const scree_mesh *sheet) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  o.gravity[2] = -9.81;
  o.stiffness_factor = 0.4;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material material = scree_default_material();
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  const scree_wall walls[] = {
      {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = sheet},
      {.kind = SCREE_WALL_CYLINDER, .axis = {0, 0, 1}, .position = {0, 0, height}, .radius = top},
      {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}, .position = {0, 0, floor_at}}};
  for (int i = 0; i < 3; i++) CHECK_OK(scree_world_add_wall(world, &walls[i], NULL, &error), error);
  return world;
}

static void fill(scree_world *world, scree_particle *const shapes[2]) {
  const double spacing = 0.09;
  scree_rng rng = {.seed = 5};
  for (int i = 0; i < BODIES; i++) {
    scree_body body = scree_default_body();
    quat q = scree_rng_rotation(&rng);
    const double orientation[4] = {q.w, q.x, q.y, q.z};
    memcpy(body.orientation, orientation, sizeof orientation);
    body.position[0] = spacing * (i % ROW - 1);
    body.position[1] = spacing * (i / ROW % ROW - 1);
    body.position[2] = 0.32 + spacing * (i / (ROW * ROW));
    law_body(world, shapes[i % 2], body);
  }
}

/* The ledger's error over what the bodies bring, in kinetic and potential energy above the floor;
 * `below`: how many are under the mouth in the end. */
static double run_out(const char *what, scree_particle *const shapes[2], size_t *below) {
  scree_mesh sheet = funnel();
  scree_world *world = make_hopper(&sheet);
  fill(world, shapes);
  scree_observation o;
  law_step(world, 1);
  double mass = 0, before = law_ledger(world, &o), worst = 0;
  for (size_t i = 0; i < BODIES; i++) mass += scree_world_body_mass(world, i);
  double came_in = o.kinetic + o.potential - mass * 9.81 * floor_at;
  while (scree_world_time(world) < 1) {
    law_step(world, 200);
    worst = fmax(worst, fabs(law_ledger(world, &o) - before) / came_in);
  }
  *below = 0;
  for (size_t i = 0; i < BODIES; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    double z = body.position[2], r = hypot(body.position[0], body.position[1]);
    *below += z < 0;
    if (z > 0 && z < height) /* over the sheet, not behind it */
      assert_true(r < mouth + (top * 1.05 - mouth) * z / height);
  }
  print_message("%s: %zu of %d below, ends at %.3g of %.3g J\n", what, *below, BODIES,
                law_ledger(world, &o) - before, came_in);
  scree_world_free(world);
  scree_mesh_free(&sheet);
  return worst;
}

static void open_hoppers_keep_their_ledger(void **state) {
  (void)state;
  scree_particle *rod = shape_particle(shape_box(0.06, 0.004, 0.004)),
                 *plate = shape_particle(shape_box(0.06, 0.04, 0.0015));
  size_t below;
  double worst = run_out("rods and plates", (scree_particle *[]){rod, plate}, &below);
  assert_true(below > 0);
  LAW_BELOW("L17", "open hopper, rods and plates: ledger over what came in", worst, 2e-3);
  worst = run_out("plates", (scree_particle *[]){plate, plate}, &below);
  assert_true(below > 0);
  LAW_BELOW("L17", "open hopper, plates: ledger over what came in", worst, 2e-3);
  scree_particle_free(rod);
  scree_particle_free(plate);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(open_hoppers_keep_their_ledger)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
