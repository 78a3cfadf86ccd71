/* Twenty phones fall onto a plate: from a scan to particles at rest, with the library alone.
 *
 *   cc drop.c $(pkg-config --cflags --libs scree) -o drop && ./drop */
#include <scree.h>

static int fail(const scree_error *error) {
  fprintf(stderr, "%s\n", error->message);
  return 1;
}

int main(void) {
  scree_error error;
  scree_mesh scan, mesh;
  scree_curve *curve;
  scree_particle *phone;
  scree_world *world;

  /* a scan (or scree_scan_read), decimated to 100 triangles */
  scree_sample_options coarse = scree_default_sample_options();
  coarse.resolution = 2e-3;
  coarse.noise = 0;
  if (scree_sample_make("fp-1", &coarse, NULL, &scan, &error)) return fail(&error);
  scree_simplify_options simplify = scree_default_simplify_options();
  if (scree_curve_build(&scan, &simplify, NULL, &curve, &error)) return fail(&error);
  if (scree_curve_mesh(curve, scree_curve_find(curve, 100), &mesh, &error)) return fail(&error);
  if (scree_particle_from_mesh(&mesh, NULL, &phone, &error)) return fail(&error);
  scree_curve_free(curve);
  scree_mesh_free(&scan);
  scree_mesh_free(&mesh);

  /* a world with a floor, half as stiff as the default: faster, with larger overlaps */
  scree_world_options options = scree_default_world_options();
  options.stiffness_factor = 0.5;
  scree_material material = scree_default_material();
  scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  if (scree_world_create(&options, &world, &error)) return fail(&error);
  if (scree_world_add_material(world, &material, NULL, &error)) return fail(&error);
  if (scree_world_add_wall(world, &floor, NULL, &error)) return fail(&error);

  for (int i = 0; i < 20; i++) {
    scree_body body = {.position = {0.17 * (i % 2), 0.17 * (i / 2 % 2), 0.1 + 0.17 * (i / 4)},
                       .orientation = {1, 0.3 * i, 0.7 * i, 0.2 * i}};
    if (scree_world_add_body(world, phone, 0, &body, NULL, &error)) return fail(&error);
  }
  scree_particle_free(phone); /* the world keeps its own reference */

  scree_observation o;
  do {
    if (scree_world_step(world, 2000, &error)) return fail(&error);
    scree_world_observe(world, &o);
    printf("%.3f s: %.2e J of motion, %zu pairs touch, overlaps up to %.1f um\n", o.time,
           o.kinetic + o.rotational, o.pair_count, 1e6 * o.largest_overlap);
  } while (o.time < 1);
  if (scree_world_vtp_write(world, SCREE_VIEW_SURFACES, "drop.vtp", true, &error))
    return fail(&error);
  scree_world_free(world);
  return 0;
}
