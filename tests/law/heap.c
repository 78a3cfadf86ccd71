/* L18: eighty decimated devices poured into a cylinder and left. */
#include "support/law.h"

#include "base/vec.h"
#include "particle/particle.h"

static scree_particle *device(const char *name, size_t triangles) {
  scree_error error;
  scree_mesh mesh, level;
  scree_curve *curve = NULL;
  scree_particle *particle = NULL;
  scree_sample_options o = scree_default_sample_options();
  scree_simplify_options simplify = scree_default_simplify_options();
  o.resolution = 2e-3;
  o.noise = 0;
  CHECK_OK(scree_sample_make(name, &o, NULL, &mesh, &error), error);
  CHECK_OK(scree_curve_build(&mesh, &simplify, NULL, &curve, &error), error);
  CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, triangles), &level, &error), error);
  CHECK_OK(scree_particle_from_mesh(&level, NULL, &particle, &error), error);
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
  scree_mesh_free(&level);
  return particle;
}

/* By how much a vertex may reach out of the rounded core that touches, m. */
static double reach_of(const scree_particle *particle, size_t vertex) {
  if (!particle->core) return 0;
  vec3 own = vec3_load(particle->mesh.positions + 3 * vertex),
       core = vec3_load(particle->core + 3 * vertex);
  return fmax(0, vec3_distance(own, core) - particle->radius);
}

/* How far the farthest vertex lies outside a cylinder of this radius or below its disc, and beyond
 * what it reaches out of the core, m. */
static double farthest_out(const scree_world *world, double radius) {
  double out = -INFINITY;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    const scree_particle *particle = scree_world_body_particle(world, i);
    const scree_mesh *mesh = &particle->mesh;
    mat3 turn = quat_to_mat3(
        (quat){body.orientation[0], body.orientation[1], body.orientation[2], body.orientation[3]});
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      vec3 at = vec3_add(vec3_load(body.position),
                         mat3_mul_vec(&turn, vec3_load(mesh->positions + 3 * v)));
      out = fmax(out, fmax(hypot(at.x, at.y) - radius, -at.z) - reach_of(particle, v));
    }
  }
  return out;
}

/* The farthest that any body has moved from where it was, m. */
static double farthest_way(const scree_world *world, const scree_body *before) {
  double way = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    way = fmax(way, vec3_norm(vec3_sub(vec3_load(body.position), vec3_load(before[i].position))));
  }
  return way;
}

static void poured_and_left(void **state) {
  (void)state;
  scree_error error;
  const scree_pour_shape shapes[] = {{.particle = device("fp-1", 100), .count = 30},
                                     {.particle = device("fp-3", 60), .count = 25},
                                     {.particle = device("sp-1", 100), .count = 25}};
  scree_pour_options o = scree_default_pour_options();
  o.width = 0.6;
  o.particles.density = 1100; /* devices of 0.1 kg, as the note's scales have it */
  scree_pour *pour = NULL;
  CHECK_OK(scree_pour_create(shapes, 3, &o, &pour, &error), error);
  scree_world *world = scree_pour_world(pour);
  scree_observation seen;
  double end = scree_pour_filling_time(pour) + 8, entered = 0, ledger = 0, quiet = 0;
  do { /* a device that is about to tip over is slow as well, but not for long */
    CHECK_OK(scree_pour_advance(pour, 500, &error), error);
    double sum = law_ledger(world, &seen);
    entered = scree_pour_entered_energy(pour);
    ledger = fmax(ledger, fabs(sum / entered - 1));
    if (seen.body_count < 80 || seen.pair_count == 0 || seen.kinetic + seen.rotational >= 1e-7)
      quiet = seen.time;
  } while (seen.time < end && seen.time < quiet + 0.5);
  print_message("%.2f s, %zu pairs touch\n", seen.time, seen.pair_count);
  LAW_NEAR("L18", "devices in the heap", (double)seen.body_count, 80, 0);
  LAW_BELOW("L18", "kinetic energy (J)", seen.kinetic + seen.rotational, 1e-6);
  LAW_BELOW("L18", "largest overlap (m)", seen.largest_overlap, 1e-5);
  LAW_BELOW("L18", "farthest vertex outside the walls (m)", farthest_out(world, 0.5 * o.width),
            1e-5);
  LAW_BELOW("L17", "ledger at N = 20, of what came in", ledger, 8e-3);
  /* left alone it stays what it is */
  scree_body before[80];
  for (size_t i = 0; i < 80; i++) scree_world_get_body(world, i, &before[i]);
  double kinetic = 0;
  for (end = seen.time + 2; seen.time < end;) {
    CHECK_OK(scree_pour_advance(pour, 500, &error), error);
    scree_world_observe(world, &seen);
    kinetic = fmax(kinetic, seen.kinetic + seen.rotational);
  }
  LAW_BELOW("L18", "kinetic energy in two seconds more (J)", kinetic, 1e-6);
  LAW_BELOW("L18", "farthest way of a body in them (m)", farthest_way(world, before), 1e-4);
  LAW_BELOW("L18", "largest overlap after them (m)", seen.largest_overlap, 1e-5);
  LAW_BELOW("L18", "farthest vertex outside after them (m)", farthest_out(world, 0.5 * o.width),
            1e-5);
  scree_pour_free(pour);
  for (int i = 0; i < 3; i++) scree_particle_free(shapes[i].particle);
}

/* Worst error of the ledger while 30 devices fall in, at these steps per contact. */
static double pour_error(const scree_pour_shape *shapes, double steps_per_contact) {
  scree_error error;
  scree_pour_options o = scree_default_pour_options();
  o.width = 0.6;
  o.particles.density = 1100;
  o.world.steps_per_contact = steps_per_contact;
  scree_pour *pour = NULL;
  CHECK_OK(scree_pour_create(shapes, 3, &o, &pour, &error), error);
  scree_observation seen;
  double worst = 0;
  do {
    CHECK_OK(scree_pour_advance(pour, 500, &error), error);
    double sum = law_ledger(scree_pour_world(pour), &seen);
    worst = fmax(worst, fabs(sum / scree_pour_entered_energy(pour) - 1));
  } while (seen.time < 0.7);
  assert_true(seen.dissipated_dashpot > 0.2 * scree_pour_entered_energy(pour));
  scree_pour_free(pour);
  return worst;
}

/* What the ledger misses is the integration's error, of second order in the time step. */
static void ledger_is_of_second_order(void **state) {
  (void)state;
  const scree_pour_shape shapes[] = {{.particle = device("fp-1", 100), .count = 10},
                                     {.particle = device("fp-3", 60), .count = 10},
                                     {.particle = device("sp-1", 100), .count = 10}};
  double coarse = pour_error(shapes, 20), fine = pour_error(shapes, 40);
  LAW_BELOW("L17", "ledger of a pour at N = 20", coarse, 5e-3);
  LAW_BELOW("L17", "the same at N = 40", fine, 1e-3);
  LAW_BELOW("L17", "N = 40 over N = 20; 1/4 expected, in another pour", fine / coarse, 0.5);
  for (int i = 0; i < 3; i++) scree_particle_free(shapes[i].particle);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(poured_and_left),
                                     cmocka_unit_test(ledger_is_of_second_order)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
