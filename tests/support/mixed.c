#include "support/mixed.h"

#include "support/check.h"
#include "support/shapes.h"
#include "support/solids.h"

enum { SHAPES = 6 };

static void make_shapes(scree_particle *shapes[SHAPES]) {
  scree_error error;
  const double centres[9] = {0, 0, 0, 0.02, 0, 0, 0.01, 0.015, 0}, radii[3] = {0.012, 0.012, 0.01};
  shapes[0] = shape_particle(shape_box(0.04, 0.03, 0.012));
  shapes[1] = shape_particle(solid_tray(0.045, 0.03, 0.015, 0.004));
  shapes[2] = shape_particle(solid_hook(0.04, 0.01, 0.012));
  shapes[3] = shape_particle(shape_icosphere(0.015, 2));
  CHECK_OK(scree_particle_sphere(0.016, &shapes[4], &error), error);
  CHECK_OK(scree_particle_clump(centres, radii, 3, NULL, &shapes[5], &error), error);
}

static void add_wall(scree_world *world, scree_wall wall) {
  scree_error error;
  wall.material = 2;
  if (wall.axis[0] == 0 && wall.axis[1] == 0) wall.axis[2] = 1;
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
}

static void add_walls(scree_world *world) {
  scree_mesh sheet = shape_sheet(0, 3);
  for (size_t v = 0; v < sheet.vertex_count; v++)
    for (size_t i = 0; i < 2; i++) sheet.positions[3 * v + i] = 0.3 * sheet.positions[3 * v + i];
  add_wall(world, (scree_wall){.kind = SCREE_WALL_PLANE, .position = {0, 0, -0.02}});
  add_wall(world, (scree_wall){.kind = SCREE_WALL_CYLINDER,
                               .radius = 0.105,
                               .length = 0.5,
                               .velocity = {0, 0, 0.1}});
  add_wall(world, (scree_wall){.kind = SCREE_WALL_MESH,
                               .position = {-0.15, -0.15, 0},
                               .mesh = &sheet,
                               .velocity = {0.02, 0, 0}});
  add_wall(world, (scree_wall){.kind = SCREE_WALL_DISC,
                               .position = {0, 0, 0.001},
                               .radius = 0.03,
                               .angular_velocity = {0, 0, 2}});
  scree_mesh_free(&sheet);
}

scree_world *mixed_world(scree_law law) {
  scree_error error;
  scree_world *world = NULL;
  scree_world_options o = scree_default_world_options();
  o.law = law;
  o.stiffness_factor = 0.01;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material material = scree_default_material(), wall = scree_default_wall_material();
  for (int i = 0; i < 2; i++, material.density = 1200)
    CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  CHECK_OK(scree_world_add_material(world, &wall, NULL, &error), error);
  CHECK_OK(scree_world_set_contact(world, 0, 1, 0.5, 0.2, &error), error);
  add_walls(world);
  scree_particle *shapes[SHAPES];
  make_shapes(shapes);
  scree_rng rng = {.seed = 11};
  for (size_t i = 0; i < 27; i++) {
    scree_body body = scree_default_body();
    vec3 axis = scree_rng_direction(&rng);
    body.position[0] = 0.052 * ((double)(i % 3) - 1);
    body.position[1] = 0.052 * ((double)(i / 3 % 3) - 1);
    body.position[2] = 0.032 + 0.052 * (double)(i / 9);
    body.velocity[2] = -0.3;
    vec3_store(body.angular_velocity, vec3_scale(axis, 3));
    vec3_store(body.orientation, scree_rng_direction(&rng));
    CHECK_OK(scree_world_add_body(world, shapes[i % SHAPES], i % 2, &body, NULL, &error), error);
  }
  for (size_t i = 0; i < SHAPES; i++) scree_particle_free(shapes[i]);
  return world;
}
