/* A tetrahedron falls onto a plane and comes to rest there, by the library of DEM alone. */
#include <scree.h>

#include <stdio.h>

int main(void) {
  double positions[] = {0, 0, 0, 0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01};
  uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const scree_mesh mesh = {positions, triangles, 4, 4};
  scree_error error = {0};
  scree_particle *particle;
  scree_world *world;
  scree_material soft = scree_default_material();
  scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  scree_body body = scree_default_body();
  size_t material, index;
  soft.young = 1e5;
  body.position[2] = 0.02;
  if (scree_particle_from_mesh(&mesh, NULL, &particle, &error) ||
      scree_world_create(NULL, &world, &error) ||
      scree_world_add_material(world, &soft, &material, &error) ||
      scree_world_add_wall(world, &floor, NULL, &error) ||
      scree_world_add_body(world, particle, material, &body, &index, &error) ||
      scree_world_step(world, (size_t)(0.5 / scree_world_time_step(world, NULL)), &error)) {
    fprintf(stderr, "%s\n", error.message);
    return 1;
  }
  scree_world_get_body(world, index, &body);
  printf("%s\n", body.position[2] > 0 && body.position[2] < 0.005
                     ? scree_version()
                     : "it does not rest on the plane");
  scree_particle_free(particle);
  scree_world_free(world);
  return 0;
}
