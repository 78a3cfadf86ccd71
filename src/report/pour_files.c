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

typedef struct column {
  const char *name;
  size_t offset; /* in scree_pour_point */
  bool is_count; /* a size_t; else a double */
} column;

#define REAL(name)                                                                                 \
  { #name, offsetof(scree_pour_point, seen.name), false }
#define COUNT(name)                                                                                \
  { #name, offsetof(scree_pour_point, seen.name), true }
static const column columns[] = {
    REAL(time),
    COUNT(body_count),
    REAL(kinetic),
    REAL(rotational),
    REAL(potential),
    REAL(elastic),
    REAL(dissipated_dashpot),
    REAL(dissipated_friction),
    {"entered_energy", offsetof(scree_pour_point, entered_energy), false},
    COUNT(pair_count),
    COUNT(contact_count),
    REAL(coordination),
    REAL(largest_overlap),
    REAL(highest_speed),
    REAL(mean_rotation)};
#undef REAL
#undef COUNT
enum { COLUMNS = sizeof columns / sizeof *columns };

static void json_value(scree_json *json, const char *key, const scree_pour_point *point,
                       const column *c) {
  const char *at = (const char *)point + c->offset;
  double real;
  size_t count;
  if (c->is_count) {
    memcpy(&count, at, sizeof count);
    scree_json_count(json, key, count);
  } else {
    memcpy(&real, at, sizeof real);
    scree_json_number(json, key, real);
  }
}

static void json_result(scree_json *json, const scree_pour_entry *entry) {
  const scree_world *world = scree_pour_view(entry->pour);
  scree_json_object(json, "result");
  scree_json_bool(json, "still", entry->still);
  scree_json_text(json, "stopped_because", entry->stopped_because);
  scree_json_count(json, "particle_count", scree_pour_particle_count(entry->pour));
  scree_json_count(json, "entered_count", scree_pour_entered_count(entry->pour));
  scree_json_count(json, "step_count", scree_world_step_count(world));
  scree_json_number(json, "time_step", scree_world_time_step(world, NULL));
  for (size_t k = 0; k < COLUMNS; k++)
    json_value(json, columns[k].name, &entry->points[entry->point_count - 1], &columns[k]);
  scree_json_end(json);
}

static void json_series(scree_json *json, const scree_pour_entry *entry) {
  scree_json_object(json, "series");
  for (size_t k = 0; k < COLUMNS; k++) {
    scree_json_row_array(json, columns[k].name);
    for (size_t i = 0; i < entry->point_count; i++)
      json_value(json, NULL, &entry->points[i], &columns[k]);
    scree_json_end(json);
  }
  scree_json_end(json);
}

scree_status scree_pour_json_write(const scree_pour_entry *entry, const char *path, bool overwrite,
                                   scree_error *error) {
  scree_output output;
  size_t shapes = scree_pour_shape_count(entry->pour), *order = NULL;
  if (entry->point_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: a pour without a point in time", path);
  order = scree_alloc(shapes, sizeof *order);
  if (!order) return scree_fail_memory(error, shapes * sizeof *order, "the shapes of a pour");
  scree_status status = order_shapes(entry->pour, order, error);
  if (status == SCREE_OK) status = scree_output_open(path, overwrite, &output, error);
  if (status == SCREE_OK) {
    scree_json json = scree_json_start(output.stream);
    scree_json_object(&json, NULL);
    scree_json_text(&json, "version", scree_version());
    scree_json_text(&json, "command", entry->command_line);
    json_result(&json, entry);
    json_options(&json, entry->pour);
    json_shapes(&json, entry, order);
    json_series(&json, entry);
    scree_json_end(&json);
    status = scree_output_commit(&output, error);
  }
  scree_free(order);
  return status;
}
