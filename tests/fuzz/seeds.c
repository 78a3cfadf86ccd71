/* Writes seeds for the targets whose files only the present program can write, so that a change of
 * their format does not leave the targets with files that all are refused at the first bytes:
 * FOLDER/checkpoint and FOLDER/scene, which must be there. */
#include "scene/scene.h"
#include "support/shapes.h"

#include <stdio.h>
#include <stdlib.h>

static const char *folder;
static scree_error error;

static void need(scree_status status) {
  if (status == SCREE_OK) return;
  fprintf(stderr, "%s\n", error.message);
  exit(1);
}

static const char *path_of(const char *target, const char *kind, int number) {
  static char path[4096];
  snprintf(path, sizeof path, "%s/%s/%s-%d", folder, target, kind, number);
  return path;
}

static scree_particle *make_box(void) {
  scree_particle *particle;
  scree_mesh mesh = shape_box(0.02, 0.012, 0.006);
  need(scree_particle_from_mesh(&mesh, NULL, &particle, &error));
  scree_mesh_free(&mesh);
  return particle;
}

/* ---- checkpoints of worlds: one for each kind of wall and law ---- */

static void add_bodies(scree_world *world) {
  const double centres[6] = {0, 0, 0, 0.01, 0, 0}, radii[2] = {0.006, 0.005};
  scree_particle *particles[3] = {make_box()};
  need(scree_particle_sphere(0.006, &particles[1], &error));
  need(scree_particle_clump(centres, radii, 2, NULL, &particles[2], &error));
  for (int i = 0; i < 3; i++) {
    scree_body body = scree_default_body();
    body.position[0] = 0.002 * i;
    body.position[2] = 0.008 + 0.013 * i;
    body.velocity[2] = -0.5;
    need(scree_world_add_body(world, particles[i], 0, &body, NULL, &error));
    scree_particle_free(particles[i]);
  }
}

static void write_worlds(void) {
  static const char *const names[] = {"plane", "disc", "cylinder", "mesh"};
  scree_mesh sheet = shape_sheet(0, 1);
  shape_move(&sheet, (vec3){-0.5, -0.5, 0});
  const scree_wall walls[] = {
      {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}},
      {.kind = SCREE_WALL_DISC, .axis = {0, 0, 1}, .radius = 0.1, .angular_velocity = {0, 0, 2}},
      {.kind = SCREE_WALL_CYLINDER,
       .axis = {0, 0, 1},
       .radius = 0.016,
       .length = 0.5,
       .velocity = {0, 0, 0.1}},
      {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &sheet}};
  for (int i = 0; i < 4; i++)
    for (int law = SCREE_LAW_LINEAR; law <= SCREE_LAW_HYSTERETIC; law++) {
      scree_world_options options = scree_default_world_options();
      scree_material material = scree_default_material();
      scree_world *world;
      scree_wall wall = walls[i];
      wall.material = 0;
      options.law = law;
      options.stiffness_factor = 0.01;
      need(scree_world_create(&options, &world, &error));
      need(scree_world_add_material(world, &material, NULL, &error));
      need(scree_world_add_wall(world, &wall, NULL, &error));
      add_bodies(world);
      need(scree_world_step(world, 200, &error));
      need(scree_world_save(world, path_of("checkpoint", names[i], law), true, &error));
      scree_world_free(world);
    }
  scree_mesh_free(&sheet);
}

/* ---- checkpoints and frames of a scene, one in every phase ---- */

static void write_scenes(void) {
  static const char *const fields[][2] = {
      {"shapes", "{ball: {sphere: 0.02, material: grain}, "
                 "chip: {box: [0.02, 0.012, 0.006], material: grain}}"},
      {"inlets.fill.shapes", "{ball: 1, chip: 1}"},
      {"particles", "4"},
      {"cylinder.diameter", "0.08"},
      {"disc.diameter", "0.3"},
      {"phases.pack_time", "0.1"},
      {"phases.settle_time", "0.05"},
      {"phases.lift_speed", "1"},
      {"phases.lift_time", "0.08"},
      {"phases.hold_time", "0.02"},
      {"phases.drop_height", "0.01"},
      {"contact.young_particle", "1e7"},
  };
  scree_scene_file *file;
  scree_scene *scene;
  need(scree_scene_file_template("repose", &file, &error));
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
    need(scree_scene_file_set(file, fields[i][0], fields[i][1], &error));
  need(scree_scene_create(file, NULL, &scene, &error));
  for (int phase = 0; phase <= 4; phase++) {
    const char *now = scree_scene_phase(scene);
    if (phase < 4)
      need(scree_scene_save(scene, path_of("scene", "checkpoint", phase), true, &error));
    need(scree_scene_save_frame(scene, path_of("scene", "frame", phase), true, &error));
    while (!scree_scene_end(scene) && scree_scene_phase(scene) == now)
      need(scree_scene_advance(scene, 50, &error));
  }
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

int main(int argument_count, char **arguments) {
  if (argument_count != 2) {
    fprintf(stderr, "usage: %s FOLDER\n", arguments[0]);
    return 1;
  }
  folder = arguments[1];
  scree_set_threads(1);
  write_worlds();
  write_scenes();
  return 0;
}
