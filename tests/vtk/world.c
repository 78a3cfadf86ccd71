/* Makes a small world of boxes, a sphere and a clump on walls of every kind, writes every view of
 * it into the folder named, and its state as JSON to stdout, told by the public calls one by one.
 */
#include "report/program.h"
#include "scene/scene.h"
#include "scree.h"

#include <math.h>
#include <stdlib.h>

static void must(scree_status status, const scree_error *error) {
  if (status == SCREE_OK) return;
  fprintf(stderr, "%s\n", error->message);
  _Exit(1);
}

static void add_walls(scree_world *world) {
  scree_error error;
  scree_mesh plate;
  must(scree_sample_make("box-12", NULL, NULL, &plate, &error), &error);
  scree_wall walls[] = {
      {.kind = SCREE_WALL_PLANE, .material = 1, .axis = {0, 0, 2}},
      {.kind = SCREE_WALL_DISC,
       .material = 1,
       .position = {0, 0, -1},
       .axis = {0, 1, 1},
       .radius = 0.5},
      {.kind = SCREE_WALL_CYLINDER,
       .material = 1,
       .position = {0, 0, -0.1},
       .axis = {0, 0, 1},
       .radius = 0.4,
       .length = 0.75},
      {.kind = SCREE_WALL_CYLINDER, .material = 1, .axis = {1, 0, 0}, .radius = 3},
      {.kind = SCREE_WALL_MESH,
       .material = 1,
       .position = {0, 0, 2},
       .axis = {1, 0, 0},
       .mesh = &plate,
       .angular_velocity = {0, 1, 0}},
  };
  for (size_t i = 0; i < sizeof walls / sizeof *walls; i++)
    must(scree_world_add_wall(world, &walls[i], NULL, &error), &error);
  scree_mesh_free(&plate);
}

static void add(scree_world *world, scree_particle *particle, double x, double z) {
  scree_error error;
  scree_body body = scree_default_body();
  body.position[0] = x, body.position[2] = z;
  body.velocity[0] = 0.01 * x, body.velocity[2] = -0.02;
  body.angular_velocity[2] = 0.5;
  body.orientation[0] = cos(z), body.orientation[3] = sin(z); /* about the vertical */
  must(scree_world_add_body(world, particle, 0, &body, NULL, &error), &error);
}

/* Two boxes, one on the other; a sphere and a clump beside them; one body taken out. */
static void add_bodies(scree_world *world) {
  const double centres[] = {0, 0, 0, 0.03, 0, 0}, radii[] = {0.02, 0.02};
  scree_error error;
  scree_mesh box;
  scree_particle *shapes[3];
  must(scree_sample_make("box-12", NULL, NULL, &box, &error), &error);
  must(scree_particle_from_mesh(&box, NULL, &shapes[0], &error), &error);
  must(scree_particle_sphere(0.03, &shapes[1], &error), &error);
  must(scree_particle_clump(centres, radii, 2, NULL, &shapes[2], &error), &error);
  scree_mesh_free(&box);
  const double half = 0.03456;
  add(world, shapes[0], 0, half);
  add(world, shapes[1], 0.5, 1);
  add(world, shapes[0], 0.01, 3 * half);
  add(world, shapes[2], -0.1, 0.01999);
  add(world, shapes[1], 0.1, 0.02999);
  scree_world_remove_body(world, 1);
  for (int i = 0; i < 3; i++) scree_particle_free(shapes[i]);
}

static void print_values(const char *name, const double *values, int count) {
  printf("\"%s\": [", name);
  for (int i = 0; i < count; i++) printf("%s%.17g", i ? ", " : "", values[i]);
  fputs("]", stdout);
}

static void print_bodies(const scree_world *world) {
  const char *before = "";
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body b;
    if (scree_world_body_removed(world, i)) continue;
    scree_world_get_body(world, i, &b);
    printf("%s{\"body\": %zu, \"mass\": %.17g, ", before, i, scree_world_body_mass(world, i));
    print_values("position", b.position, 3);
    fputs(", ", stdout);
    print_values("orientation", b.orientation, 4);
    fputs(", ", stdout);
    print_values("velocity", b.velocity, 3);
    fputs(", ", stdout);
    print_values("angular_velocity", b.angular_velocity, 3);
    puts("}");
    before = ",";
  }
}

static bool print_contact(void *context, const scree_contact *c) {
  const char **before = context;
  printf("%s{\"body\": %zu, \"other\": %zu, \"wall\": %d, \"overlap\": %.17g, ", *before, c->body,
         c->other, c->wall, c->overlap);
  print_values("position", c->position, 3);
  fputs(", ", stdout);
  print_values("normal", c->normal, 3);
  fputs(", ", stdout);
  print_values("force", c->force, 3);
  puts("}");
  *before = ",";
  return true;
}

/* A few spheres on their way into the cylinder of a scene, as checkpoint and as frame. */
static void write_scene(const char *folder) {
  scree_error error;
  scree_scene_file *file;
  scree_scene *scene;
  char path[512];
  must(scree_scene_file_template("repose", &file, &error), &error);
  must(scree_scene_file_set(file, "preset", "demo", &error), &error);
  must(scree_scene_file_set(file, "particles", "4", &error), &error);
  must(scree_scene_file_set(file, "shapes.ball.sphere", "0.06", &error), &error);
  must(scree_scene_create(file, NULL, &scene, &error), &error);
  while (scree_world_body_count(scree_scene_view(scene)) == 0)
    must(scree_scene_advance(scene, 100, &error), &error);
  snprintf(path, sizeof path, "%s/scene.scree", folder);
  must(scree_scene_save(scene, path, false, &error), &error);
  snprintf(path, sizeof path, "%s/frame.scree", folder);
  must(scree_scene_save_frame(scene, path, false, &error), &error);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

int main(int argc, char **argv) {
  if (argc != 2) return 2;
  scree_error error;
  scree_world *world;
  scree_material material = scree_default_material(), wall = scree_default_wall_material();
  must(scree_world_create(NULL, &world, &error), &error);
  must(scree_world_add_material(world, &material, NULL, &error), &error);
  must(scree_world_add_material(world, &wall, NULL, &error), &error);
  add_walls(world);
  add_bodies(world);
  must(scree_world_step(world, 5, &error), &error);
  for (int view = 0; view < SCREE_VIEW_COUNT; view++) {
    static const char *const names[SCREE_VIEW_COUNT] = {"surfaces", "points", "contacts", "walls"};
    char path[512];
    snprintf(path, sizeof path, "%s/%s.vtp", argv[1], names[view]);
    must(scree_world_vtp_write(world, view, path, false, &error), &error);
    if (scree_world_vtp_write(world, view, path, false, &error) != SCREE_EXISTS) return 1;
  }
  const char *files[] = {"surfaces.vtp", "points.vtp"}, *before = "";
  const double times[] = {0, scree_world_time(world)};
  char path[512];
  snprintf(path, sizeof path, "%s/pile.vtp.series", argv[1]);
  must(scree_pvd_write(files, times, 2, path, false, &error), &error);
  snprintf(path, sizeof path, "%s/world.scree", argv[1]);
  must(scree_world_save(world, path, false, &error), &error);
  write_scene(argv[1]);
  printf("{\"time\": %.17g, \"bodies\": [\n", scree_world_time(world));
  print_bodies(world);
  puts("], \"contacts\": [");
  must(scree_world_visit_contacts(world, print_contact, &before, &error), &error);
  double turn[4];
  scree_world_wall_orientation(world, 4, turn);
  puts("],");
  print_values("mesh_wall_orientation", turn, 4);
  puts("}");
  scree_world_free(world);
  return 0;
}
