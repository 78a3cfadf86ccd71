/* A scene as JSON: result.json of `scree run` (docs/reference/formats.md). */
#include "base/alloc.h"
#include "base/file.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"
#include "report/shapes.h"

#include <math.h>

static void json_book(scree_json *json, const scree_scene *scene) {
  scree_scene_book b;
  scree_scene_get_book(scene, &b);
  scree_json_object(json, "book");
  SCREE_JSON_MEMBERS(json, OF(&b, entered_count), OF(&b, inside_count), OF(&b, left_count),
                     OF(&b, waiting_count), OF(&b, entered_mass), OF(&b, inside_mass),
                     OF(&b, left_mass), OF(&b, entered_energy), OF(&b, left_energy),
                     OF(&b, ledger));
  scree_json_end(json);
}

static void json_hardened(scree_json *json, const scree_scene *scene) {
  scree_scene_hardening h;
  scree_json_array(json, "hardened");
  for (size_t i = 0; scree_scene_get_hardening(scene, i, &h); i++)
    SCREE_JSON_ROW(json, NULL, OF(&h, material), OF(&h, other), OF(&h, count), OF(&h, deepest),
                   OF(&h, stiffness_missing));
  scree_json_end(json);
}

static void json_changes(scree_json *json, const scree_scene *scene) {
  size_t count = scree_scene_change_count(scene);
  SCREE_JSON_LIST (json, "changes", i, count) {
    scree_scene_change_entry c = scree_scene_change_at(scene, i);
    SCREE_JSON_ROW(json, NULL, OF(&c, time), OF(&c, field), OF(&c, was), OF(&c, is));
  }
}

static void json_pile(scree_json *json, const char *name, const scree_pile_settings *settings,
                      const scree_pile *pile) {
  scree_json_object(json, NULL);
  scree_json_text(json, "name", name);
  char finding[200];
  scree_pile_finding(&pile->repose, finding, sizeof finding);
  scree_json_text(json, "finding", finding);
  scree_json_repose(json, &pile->repose);
  for (int i = 0; i < SCREE_PILE_ROWS; i++) scree_json_field(json, &scree_pile_rows[i], pile);
  SCREE_JSON_MEMBERS(json, OF(settings, cell), AS("sectors_asked", settings->sectors),
                     OF(settings, band_low), OF(settings, band_high));
  scree_json_end(json);
}

static void json_piles(scree_json *json, const scree_scene_entry *entry, const scree_pile *piles) {
  scree_json_array(json, "piles");
  for (size_t i = 0; scree_scene_pile_name(entry->scene, i); i++) {
    scree_pile_settings own = scree_scene_pile_settings(entry->scene, i);
    json_pile(json, scree_scene_pile_name(entry->scene, i), entry->measure ? entry->measure : &own,
              &piles[i]);
  }
  scree_json_end(json);
}

/* What sensors have besides columns, but tables of single bodies. */
static scree_status json_tables(scree_json *json, const scree_scene *scene, scree_error *error) {
  const char *name;
  scree_json_array(json, "tables");
  for (size_t i = 0; (name = scree_scene_table_name(scene, i)); i++) {
    SCREE_CLEANUP(scree_scene_table_free) scree_scene_table t = {0};
    SCREE_TRY(scree_scene_make_table(scene, i, &t, error));
    if (t.is_long) continue;
    scree_json_object(json, NULL);
    scree_json_text(json, "name", name);
    SCREE_JSON_LIST (json, "columns", k, t.column_count) {
      scree_json_row_object(json, NULL);
      SCREE_JSON_MEMBERS(json, AS("name", t.names[k]), AS("unit", t.units[k]));
      SCREE_JSON_ROW_LIST (json, "values", row, t.row_count) {
        const size_t at = row * t.column_count + k;
        if (t.texts[at])
          scree_json_text(json, NULL, t.texts[at]);
        else
          scree_json_number(json, NULL, t.values[at]);
      }
      scree_json_end(json);
    }
    scree_json_end(json);
  }
  scree_json_end(json);
  return SCREE_OK;
}

static void json_costs(scree_json *json, const scree_scene *scene) {
  scree_scene_costs c = scree_scene_get_costs(scene);
  scree_json_object(json, "costs");
  SCREE_JSON_MEMBERS(json, AS("particle_steps", c.body_steps), OF(&c, wall_seconds),
                     OF(&c, processor_seconds), OF(&c, piece_count));
  scree_json_end(json);
}

static void json_parts(scree_json *json, const scree_scene *scene) {
  scree_json_array(json, "shapes");
  for (size_t i = 0; scree_scene_shape_name(scene, i); i++) {
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, AS("name", scree_scene_shape_name(scene, i)),
                       AS("family", scree_scene_shape_family(scene, i)),
                       AS("source", scree_scene_shape_source(scene, i)));
    scree_shape_json(json, scree_scene_shape_particle(scene, i));
    scree_json_end(json);
  }
  scree_json_end(json);
  scree_json_array(json, "geometry");
  for (size_t i = 0; scree_scene_geometry_name(scene, i); i++)
    scree_json_text(json, NULL, scree_scene_geometry_name(scene, i));
  scree_json_end(json);
  scree_json_array(json, "phases");
  for (size_t i = 0; scree_scene_phase_name(scene, i); i++)
    scree_json_text(json, NULL, scree_scene_phase_name(scene, i));
  scree_json_end(json);
  scree_json_array(json, "inlets");
  for (size_t i = 0; scree_scene_inlet_name(scene, i); i++) {
    double mass;
    size_t waiting, count = scree_scene_inlet_count(scene, i, &mass, &waiting);
    SCREE_JSON_ROW(json, NULL, AS("name", scree_scene_inlet_name(scene, i)), AS("count", count),
                   AS("mass", mass), AS("waiting", waiting));
  }
  scree_json_end(json);
  scree_json_array(json, "outlets"); /* the last is the domain's rim */
  for (size_t i = 0;; i++) {
    const char *name = scree_scene_outlet_name(scene, i);
    double mass;
    size_t count = scree_scene_outlet_count(scene, i, &mass);
    SCREE_JSON_ROW(json, NULL, AS("name", name), AS("count", count), AS("mass", mass));
    if (!name) break;
  }
  scree_json_end(json);
}

static void json_columns(scree_json *json, const scree_scene *scene, const double *last) {
  size_t rows, columns = scree_scene_column_count(scene);
  const double *series = scree_scene_series(scene, &rows);
  SCREE_JSON_LIST (json, "columns", k, columns) {
    scree_scene_summary s = scree_scene_summarise(scene, k, NAN, NAN);
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, AS("name", scree_scene_column_name(scene, k)),
                       AS("unit", scree_scene_column_unit(scene, k)),
                       AS("last", rows ? s.last : last[k]), OF(&s, mean), OF(&s, sd), OF(&s, least),
                       OF(&s, greatest), OF(&s, from), OF(&s, until));
    SCREE_JSON_ROW_LIST (json, "values", i, rows)
      scree_json_number(json, NULL, series[i * columns + k]);
    scree_json_end(json);
  }
}

static scree_status write_scene(FILE *stream, const scree_scene_entry *entry, const double *last,
                                const scree_pile *piles, scree_error *error) {
  const scree_scene *scene = entry->scene;
  const scree_world *world = scree_scene_view(scene);
  scree_json json = scree_json_start(stream);
  scree_json_object(&json, NULL);
  scree_json_maker(&json, entry->command_line);
  SCREE_JSON_MEMBERS(&json, AS("title", scree_scene_title(scene)), OF(entry, file),
                     AS("ended_because",
                        entry->stopped_because ? entry->stopped_because : scree_scene_end(scene)));
  scree_json_bool(&json, "whole", !entry->stopped_because);
  scree_words words;
  scree_scene_words(scene, scree_scene_pile_name(scene, 0) ? piles : NULL, entry->stopped_because,
                    &words);
  scree_json_words(&json, &words);
  SCREE_JSON_MEMBERS(&json, AS("time", scree_world_time(world)),
                     AS("time_step", scree_world_time_step(world, NULL)),
                     AS("step_count", scree_world_step_count(world)),
                     AS("wall_seconds", entry->seconds));
  json_costs(&json, scene);
  json_book(&json, scene);
  json_hardened(&json, scene);
  json_changes(&json, scene);
  json_piles(&json, entry, piles);
  json_parts(&json, scene);
  scree_status status = json_tables(&json, scene, error);
  json_columns(&json, scene, last);
  scree_json_end(&json);
  return status;
}

scree_status scree_scene_json_write(const scree_scene_entry *entry, const char *path,
                                    bool overwrite, scree_error *error) {
  size_t pile_count = 0;
  while (scree_scene_pile_name(entry->scene, pile_count)) pile_count++;
  SCREE_SCRATCH(double, last, scree_scene_column_count(entry->scene), error);
  SCREE_SCRATCH_ZERO(scree_pile, piles, pile_count, error);
  SCREE_TRY(scree_scene_measure(entry->scene, last, error));
  for (size_t i = 0; i < pile_count; i++)
    SCREE_TRY(scree_scene_measure_pile(entry->scene, i, entry->measure, &piles[i], error));
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  scree_status status = write_scene(output.stream, entry, last, piles, error);
  if (status == SCREE_OK) return scree_output_commit(&output, error);
  scree_output_discard(&output);
  return status;
}

/* ---- CSV ---- */

scree_status scree_scene_csv_write(const scree_scene *scene, const char *path, bool overwrite,
                                   scree_error *error) {
  size_t rows, columns = scree_scene_column_count(scene);
  const double *series = scree_scene_series(scene, &rows);
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  for (size_t k = 0; k < columns; k++) {
    const char *unit = scree_scene_column_unit(scene, k);
    char title[160];
    snprintf(title, sizeof title, *unit ? "%s [%s]" : "%s", scree_scene_column_name(scene, k),
             unit);
    if (k) putc(',', output.stream);
    scree_quote(output.stream, SCREE_QUOTE_CSV, title);
  }
  for (size_t i = 0; i < rows; i++)
    for (size_t k = 0; k < columns; k++) {
      fputc(k ? ',' : '\n', output.stream);
      scree_csv_number(output.stream, series[i * columns + k]);
    }
  fputc('\n', output.stream);
  return scree_output_commit(&output, error);
}
