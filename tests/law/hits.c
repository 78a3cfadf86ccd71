/* L5, L6, L7, L16, L19: hits between polyhedra. */
#include "support/law.h"

#include "support/hits.h"
#include "support/shapes.h"

static const double degree = 3.14159265358979323846 / 180;

enum { UNEVEN = 7 };

/* 0: 12 triangles; else a grid of n squares a side, an uneven one for UNEVEN. */
static scree_particle *box_of(size_t n) {
  const double size[3] = {0.1, 0.05, 0.015};
  if (n == 0) return shape_particle(shape_box(size[0], size[1], size[2]));
  scree_mesh mesh = shape_grid_box(size[0], size[1], size[2], n);
  for (size_t i = 0; n == UNEVEN && i < 3 * mesh.vertex_count; i++) {
    double whole = size[i % 3];
    mesh.positions[i] = whole * pow(mesh.positions[i] / whole, 1.2 + 0.4 * (double)(i % 3));
  }
  return shape_particle(mesh);
}

/* The particle's axes ascend in moment: x long, z thin. Two boxes, one above the other. */
static double one_landing(scree_particle *box, scree_particle *other, double turn, double speed,
                          double steps, int phase) {
  law_setup setup = law_default();
  setup.steps_per_contact = steps;
  scree_world *world = law_world(&setup);
  scree_particle_measures m;
  scree_particle_measure(box, &m);
  scree_body up = scree_default_body(), down = up;
  up.velocity[2] = -0.5 * speed;
  down.velocity[2] = 0.5 * speed;
  up.orientation[0] = cos(turn / 2);
  up.orientation[3] = sin(turn / 2);
  size_t a = law_body(world, box, up), b = law_body(world, other, down);
  double step = scree_world_time_step(world, NULL) * speed;
  up.position[2] = 0.0075 + m.rounding + 0.5 * step * (3 + 0.25 * phase + 0.125);
  down.position[2] = -up.position[2];
  law_place(world, a, &up);
  law_place(world, b, &down);
  scree_observation o;
  double energy = 0.25 * scree_world_body_mass(world, a) * speed * speed, worst = 0;
  bool touched = false;
  for (int i = 0; i < 20000; i++) {
    law_step(world, 1);
    double ledger = law_ledger(world, &o);
    worst = fmax(worst, fabs(ledger / energy - 1));
    if (o.pair_count)
      touched = true;
    else if (touched)
      break;
  }
  scree_body after;
  scree_world_get_body(world, a, &after);
  if (o.rotational > 1e-4 * energy) fail_msg("L5 spin energy %g", o.rotational / energy);
  if (worst > (steps < 40 ? 4e-3 : 1e-3)) fail_msg("L17 ledger off by %g", worst);
  scree_world_free(world);
  return 2 * after.velocity[2] / speed;
}

/* The time of the first touch within a step shifts e by a percent at N = 40: the mean over four. */
static void face_on_face(scree_particle *box, double turn, double speed, double steps,
                         double tolerance) {
  double restitution = 0;
  char what[80];
  scree_particle *other = box_of(0);
  scree_particle_measures m;
  scree_particle_measure(box, &m);
  for (int phase = 0; phase < 4; phase++)
    restitution += 0.25 * one_landing(box, other, turn, speed, steps, phase);
  snprintf(what, sizeof what, "e: %zu triangles, turned %.0f, %g m/s, N %g", m.triangle_count,
           turn / degree, speed, steps);
  LAW_RELATIVE("L5", what, restitution, 0.3, tolerance);
  scree_particle_free(other);
}

static void land_all_ways(scree_particle *box) {
  for (int turned = 0; turned < 2; turned++)
    for (int fast = 0; fast < 2; fast++) {
      double turn = turned ? 30 * degree : 0, speed = fast ? 7 : 0.5;
      face_on_face(box, turn, speed, 20, 0.05);
      face_on_face(box, turn, speed, 40, 0.01);
    }
  scree_particle_free(box);
}

static void faces_meet_as_one_spring(void **state) {
  (void)state;
  const size_t grids[] = {0, 2, 5, UNEVEN, 12};
  for (int i = 0; i < 5; i++) land_all_ways(box_of(grids[i]));
}

/* The same box cut into 3072 triangles and decimated: its faces stay flat, with any triangles in
 * them. */
static void decimated_faces_meet_as_one_spring(void **state) {
  (void)state;
  const size_t counts[] = {1500, 760, 300, 100, 12};
  scree_error error;
  scree_mesh mesh = shape_grid_box(0.1, 0.05, 0.015, 16), level;
  scree_curve *curve = NULL;
  scree_simplify_options options = scree_default_simplify_options();
  CHECK_OK(scree_curve_build(&mesh, &options, NULL, &curve, &error), error);
  for (int i = 0; i < 5; i++) {
    CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, counts[i]), &level, &error), error);
    land_all_ways(shape_particle(level));
  }
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
}

static void undamped_hits_keep_energy(void **state) {
  (void)state;
  const struct {
    const char *name;
    scree_particle *particle;
    double steps, worst;
  } cases[] = {
      {"boxes, N 20", box_of(0), 20, 0.05},
      {"boxes of 300 triangles, N 20", box_of(5), 20, 0.05},
      {"boxes, N 40", box_of(0), 40, 0.02},
      {"icospheres of 320, N 20", shape_particle(shape_icosphere(0.025, 2)), 20, 0.05},
      {"tori of 400, N 20", shape_particle(shape_torus(0.03, 0.01, 20, 10)), 20, 0.05},
  };
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    double mean = 0, worst = 0;
    const int hits = 40;
    for (int i = 0; i < hits; i++) {
      double ratio = law_random_hit(cases[c].particle, cases[c].steps, (uint64_t)i, false);
      mean += ratio / hits;
      worst = fmax(worst, fabs(ratio - 1));
    }
    char what[80];
    snprintf(what, sizeof what, "mean energy ratio: %s", cases[c].name);
    LAW_NEAR("L6", what, mean, 1, 0.005);
    LAW_BELOW("L6", "worst", worst, cases[c].worst);
    double highest = 0;
    for (int i = 0; i < hits; i++)
      highest = fmax(highest, law_random_hit(cases[c].particle, cases[c].steps, (uint64_t)i, true));
    LAW_BELOW("L7", "damped: highest energy over that at the start", highest, 1.002);
    scree_particle_free(cases[c].particle);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(faces_meet_as_one_spring),
      cmocka_unit_test(decimated_faces_meet_as_one_spring),
      cmocka_unit_test(undamped_hits_keep_energy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
