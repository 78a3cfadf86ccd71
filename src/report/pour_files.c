/* A pour as JSON: drop.json of `scree drop` (docs/reference/formats.md). */
#include "base/alloc.h"
#include "base/file.h"
#include "report/shapes.h"

#include <string.h>

static void json_material(scree_json *json, const char *key, const scree_material *m) {
  scree_json_row_object(json, key);
  scree_json_number(json, "young", m->stiffness);
  scree_json_number(json, "density", m->density);
  scree_json_number(json, "restitution", m->restitution);
  scree_json_number(json, "friction", m->friction);
  scree_json_end(json);
}

static void json_options(scree_json *json, const scree_pour *pour) {
  scree_pour_options o;
  scree_pour_get_options(pour, &o);
  scree_json_object(json, "options");
  scree_json_text(json, "container", o.container == SCREE_CONTAINER_BOX ? "box" : "cylinder");
  scree_json_number(json, "width", o.width);
  scree_json_number(json, "depth", o.depth);
  scree_json_number(json, "drop_height", o.drop_height);
  scree_json_number(json, "entry_speed", o.entry_speed);
  scree_json_count(json, "seed", o.seed);
  scree_json_text(json, "law", o.world.law == SCREE_LAW_HYSTERETIC ? "hysteretic" : "linear");
  scree_json_number(json, "steps_per_contact", o.world.steps_per_contact);
  scree_json_number(json, "stiffness_factor", o.world.stiffness_factor);
  json_material(json, "particles", &o.particles);
  json_material(json, "walls", &o.walls);
  scree_json_end(json);
}

/* In the order of their first bodies, as a world has them (scree_world_shape); then those of which
 * none has entered. */
static scree_status order_shapes(const scree_pour *pour, size_t *order, scree_error *error) {
  size_t shapes = scree_pour_shape_count(pour), found = 0;
  bool *seen = scree_alloc_zero(shapes, sizeof *seen);
  if (!seen) return scree_fail_memory(error, shapes, "the shapes of a pour");
  for (size_t i = 0; i < scree_pour_entered_count(pour); i++) {
    size_t shape = scree_pour_shape_of(pour, i);
    if (!seen[shape]) order[found++] = shape;
    seen[shape] = true;
  }
  for (size_t shape = 0; shape < shapes; shape++)
    if (!seen[shape]) order[found++] = shape;
  scree_free(seen);
  return SCREE_OK;
}

static void json_shapes(scree_json *json, const scree_pour_entry *entry, const size_t *order) {
  scree_json_array(json, "shapes");
  for (size_t i = 0; i < scree_pour_shape_count(entry->pour); i++) {
    scree_pour_shape shape = scree_pour_get_shape(entry->pour, order[i]);
    scree_json_object(json, NULL);
    scree_json_text(json, "name", entry->names[order[i]]);
    scree_json_text(json, "source", entry->sources ? entry->sources[order[i]] : NULL);
    scree_json_count(json, "count", shape.count);
    scree_shape_json(json, shape.particle);
    scree_json_end(json);
  }
  scree_json_end(json);
}

/* ---- moments ---- */

/* Of the scene's series: its name here and there. */
static const char *const columns[][2] = {{"time", "time"},
                                         {"body_count", "inside"},
                                         {"kinetic", "kinetic"},
                                         {"rotational", "rotational"},
                                         {"potential", "potential"},
                                         {"elastic", "elastic"},
                                         {"dissipated_dashpot", "dissipated_dashpot"},
                                         {"dissipated_friction", "dissipated_friction"},
                                         {"entered_energy", "entered_energy"},
                                         {"pair_count", "pairs"},
                                         {"contact_count", "contacts"},
                                         {"coordination", "coordination"},
                                         {"largest_overlap", "largest_overlap"},
                                         {"highest_speed", "highest_speed"},
                                         {"mean_rotation", "mean_rotation"}};
enum { COLUMNS = sizeof columns / sizeof *columns };

static size_t column_of(const scree_scene *scene, size_t index) {
  size_t k = 0;
  while (strcmp(scree_scene_column_name(scene, k), columns[index][1]) != 0) k++;
  return k;
}

static void json_result(scree_json *json, const scree_pour_entry *entry, const double *now) {
  const scree_world *world = scree_pour_view(entry->pour);
  const scree_scene *scene = scree_pour_scene(entry->pour);
  const char *end = scree_scene_end(scene);
  scree_json_object(json, "result");
  scree_json_bool(json, "still", end && !strcmp(end, "still"));
  scree_json_text(json, "stopped_because", entry->stopped_because);
  scree_json_count(json, "particle_count", scree_pour_particle_count(entry->pour));
  scree_json_count(json, "entered_count", scree_pour_entered_count(entry->pour));
  scree_json_count(json, "step_count", scree_world_step_count(world));
  scree_json_number(json, "time_step", scree_world_time_step(world, NULL));
  for (size_t k = 0; k < COLUMNS; k++)
    scree_json_number(json, columns[k][0], now[column_of(scene, k)]);
  scree_json_end(json);
}

static void json_series(scree_json *json, const scree_scene *scene) {
  size_t rows, width = scree_scene_column_count(scene);
  const double *series = scree_scene_series(scene, &rows);
  scree_json_object(json, "series");
  for (size_t k = 0; k < COLUMNS; k++) {
    scree_json_row_array(json, columns[k][0]);
    for (size_t i = 0; i < rows; i++)
      scree_json_number(json, NULL, series[i * width + column_of(scene, k)]);
    scree_json_end(json);
  }
  scree_json_end(json);
}

scree_status scree_pour_json_write(const scree_pour_entry *entry, const char *path, bool overwrite,
                                   scree_error *error) {
  scree_output output;
  const scree_scene *scene = scree_pour_scene(entry->pour);
  size_t shapes = scree_pour_shape_count(entry->pour);
  size_t *order = scree_alloc(shapes, sizeof *order);
  double *now = scree_alloc(scree_scene_column_count(scene), sizeof *now);
  scree_status status = order && now ? scree_scene_measure(scene, now, error)
                                     : scree_fail_memory(error, shapes, "the JSON of a pour");
  if (status == SCREE_OK) status = order_shapes(entry->pour, order, error);
  if (status == SCREE_OK) status = scree_output_open(path, overwrite, &output, error);
  if (status == SCREE_OK) {
    scree_json json = scree_json_start(output.stream);
    scree_json_object(&json, NULL);
    scree_json_maker(&json, entry->command_line);
    json_result(&json, entry, now);
    json_options(&json, entry->pour);
    json_shapes(&json, entry, order);
    json_series(&json, scene);
    scree_json_end(&json);
    status = scree_output_commit(&output, error);
  }
  scree_free(order);
  scree_free(now);
  return status;
}
