/* Law tests: a closed form against a run of the world. Each check prints its id, what is expected,
 * what came out and the tolerance; docs/background/verification.md lists the ids. */
#pragma once

#include "scree.h"
#include "support/check.h"

/* Fails when |got - expected| > tolerance; prints in every case. */
#define LAW_NEAR(id, what, got, expected, tolerance)                                               \
  do {                                                                                             \
    double got_ = (got), expected_ = (expected), tolerance_ = (tolerance);                         \
    print_message("%-4s %-52s expected %-12.6g got %-12.6g tolerance %.3g\n", id, what, expected_, \
                  got_, tolerance_);                                                               \
    if (!(fabs(got_ - expected_) <= tolerance_)) fail_msg("%s %s", id, what);                      \
  } while (0)
/* The same, relative to the expected value. */
#define LAW_RELATIVE(id, what, got, expected, tolerance)                                           \
  LAW_NEAR(id, what, got, expected, (tolerance)*fabs((double)(expected)))
/* Fails when got > limit. */
#define LAW_BELOW(id, what, got, limit)                                                            \
  do {                                                                                             \
    double got_ = (got), limit_ = (limit);                                                         \
    print_message("%-4s %-52s below    %-12.6g got %-12.6g\n", id, what, limit_, got_);            \
    if (!(got_ <= limit_)) fail_msg("%s %s", id, what);                                            \
  } while (0)

typedef struct law_setup {
  double restitution, friction, steps_per_contact, gravity;
  double stiffness, wall_stiffness, density;
  scree_rolling rolling;
} law_setup;

static inline law_setup law_default(void) {
  return (law_setup){0.3, 0.5, 40, 0, 1e8, 1e11, 2000, SCREE_ROLLING_COUPLE};
}

/* A world with material 0 for bodies and 1 for walls. */
static inline scree_world *law_world(const law_setup *setup) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  o.gravity[2] = -setup->gravity;
  o.steps_per_contact = setup->steps_per_contact;
  o.rolling = setup->rolling;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material m = {.young = setup->stiffness,
                      .density = setup->density,
                      .restitution = setup->restitution,
                      .friction = setup->friction};
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  m.young = setup->wall_stiffness;
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  return world;
}

/* The plane z = 0, solid below. */
static inline size_t law_floor(scree_world *world) {
  scree_error error;
  size_t index;
  scree_wall wall = {.kind = SCREE_WALL_PLANE, .material = 1, .axis = {0, 0, 1}};
  CHECK_OK(scree_world_add_wall(world, &wall, &index, &error), error);
  return index;
}

static inline size_t law_body(scree_world *world, scree_particle *particle, scree_body state) {
  scree_error error;
  size_t index;
  CHECK_OK(scree_world_add_body(world, particle, 0, &state, &index, &error), error);
  return index;
}

static inline void law_place(scree_world *world, size_t index, const scree_body *state) {
  scree_error error;
  CHECK_OK(scree_world_set_body(world, index, state, &error), error);
}

static inline void law_step(scree_world *world, size_t count) {
  scree_error error;
  CHECK_OK(scree_world_step(world, count, &error), error);
}

static inline scree_particle *law_sphere(double radius) {
  scree_error error;
  scree_particle *sphere = NULL;
  CHECK_OK(scree_particle_sphere(radius, &sphere, &error), error);
  return sphere;
}

/* Everything that must stay constant: kinetic, potential, elastic, dissipated, less the work
 * of walls and given forces. */
static inline double law_ledger(const scree_world *world, scree_observation *o) {
  scree_world_observe(world, o);
  return o->kinetic + o->rotational + o->potential + o->elastic + o->dissipated_dashpot +
         o->dissipated_friction - o->wall_work - o->applied_work;
}
