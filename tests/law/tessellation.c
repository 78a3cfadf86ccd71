/* L5 and L16: the force between two bodies neither jumps nor sees how their faces are cut. */
#include "support/law.h"

#include "base/rng.h"
#include "support/shapes.h"

enum { CUTS = 4 };

static const double degree = 3.14159265358979323846 / 180;

/* A plate of 100 x 60 x 15 mm, whole, in even squares, in uneven ones, and in many uneven ones. */
static scree_particle *plate(int cut) {
  const double size[3] = {0.1, 0.06, 0.015};
  const size_t squares[CUTS] = {1, 4, 5, 12};
  scree_mesh mesh = cut ? shape_grid_box(size[0], size[1], size[2], squares[cut])
                        : shape_box(size[0], size[1], size[2]);
  for (size_t i = 0; cut > 1 && i < 3 * mesh.vertex_count; i++) {
    double whole = size[i % 3];
    mesh.positions[i] = whole * pow(mesh.positions[i] / whole, 1.2 + 0.4 * (double)(i % 3));
  }
  return shape_particle(mesh);
}

static scree_particle *cube(void) {
  return shape_particle(shape_box(0.03, 0.03, 0.03));
}

/* Force along z on `upper` at these poses, both at rest, in a world without memory of others. */
static double force_at(scree_world *world, const scree_body *upper, const scree_body *lower) {
  scree_body apart = *upper, after;
  apart.position[2] += 0.001; /* seen from outside first */
  law_place(world, 0, &apart);
  law_place(world, 1, lower);
  law_step(world, 1);
  apart = *upper;
  law_place(world, 0, &apart);
  law_place(world, 1, lower);
  law_step(world, 1);
  scree_world_get_body(world, 0, &after);
  return scree_world_body_mass(world, 0) * after.velocity[2] / scree_world_time_step(world, NULL);
}

/* The cube above the plate, turned by q, its lowest corner `depth` into the rounded faces. */
static scree_body pressed(scree_particle *shape, scree_particle *on, quat q, double depth) {
  scree_particle_measures m, mo;
  scree_particle_measure(shape, &m);
  scree_particle_measure(on, &mo);
  mat3 r = quat_to_mat3(q);
  double lowest = 0;
  for (size_t i = 0; i < m.point_count; i++) {
    double c[3], radius;
    scree_particle_point(shape, i, c, &radius);
    lowest = fmin(lowest, mat3_mul_vec(&r, vec3_load(c)).z - radius);
  }
  scree_body body = scree_default_body();
  const double orientation[4] = {q.w, q.x, q.y, q.z};
  memcpy(body.orientation, orientation, sizeof orientation);
  body.position[2] = 0.0075 + mo.rounding - lowest - depth;
  return body;
}

static scree_world *pair_world(scree_particle *upper, scree_particle *lower) {
  law_setup setup = law_default();
  setup.restitution = 1;
  setup.friction = 0;
  scree_world *world = law_world(&setup);
  law_body(world, upper, scree_default_body());
  law_body(world, lower, scree_default_body());
  return world;
}

/* A corner, an edge and a face of a cube slide across the plate at 10 um depth: the same force at
 * every place and however the plate is cut. */
static void sliding(void **state) {
  (void)state;
  const quat corner = quat_from_rotation_vector((vec3){45 * degree, 35 * degree, 0}),
             edge = quat_from_rotation_vector((vec3){45 * degree, 0, 7 * degree}),
             face = quat_from_rotation_vector((vec3){0, 0, 20 * degree});
  const quat turns[3] = {corner, edge, face};
  const char *const names[3] = {"corner", "edge", "face"};
  scree_particle *slider = cube();
  for (int k = 0; k < 3; k++) {
    double first = 0, worst = 0;
    for (int cut = 0; cut < CUTS; cut++) {
      scree_particle *base = plate(cut);
      scree_world *world = pair_world(slider, base);
      scree_body lower = scree_default_body(), upper = pressed(slider, base, turns[k], 1e-5);
      for (int i = 0; i <= 100; i++) {
        upper.position[0] = 0.022 * (i - 50) / 50.0;
        upper.position[1] = 0.007 * (i - 50) / 50.0;
        double force = force_at(world, &upper, &lower);
        if (cut == 0 && i == 0) first = force;
        worst = fmax(worst, fabs(force / first - 1));
      }
      scree_world_free(world);
      scree_particle_free(base);
    }
    char what[80];
    snprintf(what, sizeof what, "sliding %s: change of force, 4 cuts, 101 places", names[k]);
    assert_true(first > 1);
    LAW_BELOW("L16", what, worst, 0.01);
  }
  scree_particle_free(slider);
}

/* Spike, then face: a cube tilts from standing on a corner to lying flat, its deepest point at 10
 * um all the way. The force has no leap, and does not depend on the cut. */
static void spike_then_face(void **state) {
  (void)state;
  enum { STEPS = 2000 };
  static double force[CUTS][STEPS + 1];
  scree_particle *spike = cube();
  double leap = 0, apart = 0;
  for (int cut = 0; cut < CUTS; cut++) {
    scree_particle *base = plate(cut);
    scree_world *world = pair_world(spike, base);
    scree_body lower = scree_default_body();
    for (int i = 0; i <= STEPS; i++) {
      /* finer and finer towards flat, where the corners come in one after the other */
      double tilt = 20 * degree * pow(1 - i / (double)STEPS, 6);
      scree_body upper =
          pressed(spike, base, quat_from_rotation_vector((vec3){tilt, 0.6 * tilt, 0}), 1e-5);
      force[cut][i] = force_at(world, &upper, &lower);
      if (i) leap = fmax(leap, fabs(force[cut][i] / force[cut][i - 1] - 1));
      apart = fmax(apart, fabs(force[cut][i] / force[0][i] - 1));
    }
    scree_world_free(world);
    scree_particle_free(base);
  }
  /* four equal corners share a spring of at most K/(1 - kappa)^2 and l0 more depth */
  LAW_BELOW("L16", "flat over spike", force[0][STEPS] / force[0][0], 1.2 / (0.9 * 0.9));
  LAW_BELOW("L16", "largest leap between 2001 tilts, relative", leap, 0.01);
  LAW_BELOW("L16", "difference between 4 cuts, relative", apart, 0.01);
  scree_particle_free(spike);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sliding), cmocka_unit_test(spike_then_face)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
