/* Heaps as JSON and CSV. */
#include "base/file.h"
#include "base/number.h"
#include "report/csv.h"
#include "report/shapes.h"

#include <string.h>

/* ---- JSON ---- */

/* The fields in the groups of the file: numbers, words and flags as what they are. */
static void json_experiment(scree_json *json, const scree_experiment *e) {
  scree_json_object(json, "experiment");
  scree_json_text(json, "preset", e->preset);
  for (size_t i = 0; scree_experiment_key(i); i++) {
    const char *key = scree_experiment_key(i);
    char text[64];
    double value;
    scree_experiment_get(e, key, text, sizeof text);
    bool number = scree_number_read(text, &value);
    if (!strcmp(text, "true") || !strcmp(text, "false"))
      scree_json_bool(json, key, text[0] == 't');
    else if (number && strcmp(key, "seed") != 0)
      scree_json_number(json, key, value);
    else if (number)
      scree_json_count(json, key, e->seed);
    else
      scree_json_text(json, key, text);
  }
  scree_json_end(json);
}

static void json_shapes(scree_json *json, const scree_run *run) {
  scree_json_array(json, "shapes");
  for (size_t i = 0; i < scree_run_shape_count(run); i++) {
    scree_run_shape shape;
    scree_run_get_shape(run, i, &shape);
    scree_json_object(json, NULL);
    scree_json_text(json, "name", shape.name);
    scree_json_text(json, "source", shape.source);
    scree_shape_json(json, shape.particle);
    scree_json_number(json, "density_factor", shape.density_factor);
    scree_json_end(json);
  }
  scree_json_end(json);
}

static void json_way(scree_json *json, const char *key, double deg, double sd_deg, size_t count) {
  scree_json_row_object(json, key);
  scree_json_number(json, "angle_deg", deg);
  scree_json_number(json, "sd_deg", sd_deg);
  scree_json_count(json, "count", count);
}

static void json_result(scree_json *json, const scree_run_result *r) {
  const scree_repose *h = &r->repose;
  scree_json_object(json, "result");
  scree_json_bool(json, "heap", h->heap);
  scree_json_text(json, "no_heap_because", h->heap ? NULL : h->reason);
  json_way(json, "sectors", h->sector_deg, h->sector_sd_deg, h->sector_count);
  scree_json_count(json, "total", h->sector_total);
  scree_json_end(json);
  scree_json_row_object(json, "cone");
  scree_json_number(json, "angle_deg", h->cone_deg);
  scree_json_number(json, "rms", h->cone_rms);
  scree_json_end(json);
  json_way(json, "silhouettes", h->silhouette_deg, h->silhouette_sd_deg, h->flank_count);
  scree_json_end(json);
  scree_json_number(json, "spread_deg", h->spread_deg);
  scree_json_number(json, "volume_deg", h->volume_deg);
  scree_json_number(json, "height", h->height);
  scree_json_number(json, "peak", h->peak);
  scree_json_number(json, "base_radius", h->base_radius);
  scree_json_number(json, "run_out", h->run_out);
  scree_json_number(json, "envelope_volume", h->envelope_volume);
  scree_json_number(json, "packing_fraction", r->packing_fraction);
  scree_json_number(json, "coordination", r->coordination);
  scree_json_count(json, "body_count", r->body_count);
  scree_json_count(json, "left_count", r->left_count);
  scree_json_number(json, "particle_size", r->particle_size);
  scree_json_number(json, "time", r->time);
  scree_json_number(json, "kinetic", r->kinetic);
  scree_json_bool(json, "still", r->still);
  scree_json_end(json);
}

static void json_costs(scree_json *json, const scree_run *run) {
  scree_run_costs c;
  scree_run_get_costs(run, &c);
  scree_json_object(json, "costs");
  scree_json_number(json, "time_step", c.time_step);
  scree_json_count(json, "step_count", c.step_count);
  scree_json_count(json, "particle_steps", c.particle_steps);
  scree_json_number(json, "wall_seconds", c.wall_seconds);
  scree_json_number(json, "processor_seconds", c.processor_seconds);
  scree_json_count(json, "piece_count", c.piece_count);
  scree_json_number(json, "largest_overlap", c.largest_overlap);
  scree_json_end(json);
}

/* ---- the series, by columns ---- */

typedef struct column {
  const char *name;
  size_t offset; /* of a double in scree_run_point */
} column;

#define AT(name)                                                                                   \
  { #name, offsetof(scree_run_point, name) }
static const column columns[] = {AT(time),
                                 AT(kinetic),
                                 AT(mean_rotation),
                                 AT(highest_speed),
                                 AT(largest_overlap),
                                 AT(coordination),
                                 AT(cylinder_height),
                                 AT(sector_deg),
                                 AT(cone_deg),
                                 AT(silhouette_deg),
                                 AT(height)};
#undef AT
enum { COLUMNS = sizeof columns / sizeof *columns };

static double column_value(const scree_run_point *point, const column *c) {
  double value;
  memcpy(&value, (const char *)point + c->offset, sizeof value);
  return value;
}

static void json_series(scree_json *json, const scree_run *run) {
  size_t count;
  const scree_run_point *points = scree_run_series(run, &count);
  scree_json_object(json, "series");
  scree_json_row_array(json, "phase");
  for (size_t i = 0; i < count; i++) scree_json_text(json, NULL, scree_phase_name(points[i].phase));
  scree_json_end(json);
  scree_json_row_array(json, "body_count");
  for (size_t i = 0; i < count; i++) scree_json_count(json, NULL, points[i].body_count);
  scree_json_end(json);
  for (size_t k = 0; k < COLUMNS; k++) {
    scree_json_row_array(json, columns[k].name);
    for (size_t i = 0; i < count; i++)
      scree_json_number(json, NULL, column_value(&points[i], &columns[k]));
    scree_json_end(json);
  }
  scree_json_end(json);
}

scree_status scree_heap_json_write(const scree_heap_entry *entry, const char *path, bool overwrite,
                                   scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  const scree_experiment *own = scree_run_experiment(entry->run);
  scree_json json = scree_json_start(output.stream);
  scree_json_object(&json, NULL);
  scree_json_maker(&json, entry->command_line);
  scree_json_text(&json, "file", entry->file);
  scree_json_text(&json, "phase", scree_phase_name(scree_run_phase(entry->run)));
  json_result(&json, entry->result);
  json_experiment(&json, entry->measure ? entry->measure : own);
  json_shapes(&json, entry->run);
  json_costs(&json, entry->run);
  json_series(&json, entry->run);
  scree_json_end(&json);
  return scree_output_commit(&output, error);
}

/* ---- CSV ---- */

scree_status scree_series_csv_write(const scree_run *run, const char *path, bool overwrite,
                                    scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  size_t count;
  const scree_run_point *points = scree_run_series(run, &count);
  fputs("phase,body_count", output.stream);
  for (size_t k = 0; k < COLUMNS; k++) fprintf(output.stream, ",%s", columns[k].name);
  fputc('\n', output.stream);
  for (size_t i = 0; i < count; i++) {
    fprintf(output.stream, "%s,%zu", scree_phase_name(points[i].phase), points[i].body_count);
    for (size_t k = 0; k < COLUMNS; k++) {
      fputc(',', output.stream);
      scree_csv_number(output.stream, column_value(&points[i], &columns[k]));
    }
    fputc('\n', output.stream);
  }
  return scree_output_commit(&output, error);
}
