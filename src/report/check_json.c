/* Checks and repairs as JSON. */
#include "base/file.h"
#include "report/json.h"
#include "report/program.h"

static void json_check(scree_json *json, const char *key, const scree_check *check) {
  scree_json_object(json, key);
  scree_json_bool(json, "usable", check->usable);
  scree_json_text(json, "verdict", check->verdict);
  scree_json_count(json, "triangle_count", check->triangle_count);
  scree_json_count(json, "vertex_count", check->vertex_count);
  scree_json_count(json, "shell_count", check->shell_count);
  scree_json_numbers(json, "size", check->size, 3);
  if (check->volume_known)
    scree_json_number(json, "volume", check->volume);
  else
    scree_json_text(json, "volume", NULL);
  scree_json_bool(json, "intersections_known", check->intersections_known);
  scree_json_bool(json, "too_many_pairs", check->too_many_pairs);
  scree_json_object(json, "defects");
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
    if (scree_defect_is_counted(check, (scree_defect)i))
      scree_json_count(json, scree_defect_name((scree_defect)i), check->defects[i]);
    else
      scree_json_text(json, scree_defect_name((scree_defect)i), NULL);
  scree_json_end(json);
  scree_json_end(json);
}

static void json_repair(scree_json *json, const scree_repair_report *repair) {
  scree_json_object(json, "done");
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++)
    scree_json_count(json, scree_repair_action_name((scree_repair_action)i), repair->done[i]);
  scree_json_end(json);
  scree_json_number(json, "seam_distance", repair->seam_distance);
  scree_json_number(json, "area_before", repair->area_before);
  scree_json_number(json, "area_after", repair->area_after);
  scree_json_number(json, "volume_before", repair->volume_before);
  scree_json_number(json, "volume_after", repair->volume_after);
  scree_json_number(json, "filled_volume", repair->filled_volume);
  json_check(json, "after", &repair->after);
}

static void json_entry(scree_json *json, const scree_check_entry *entry, const char *command_line) {
  scree_json_object(json, NULL);
  scree_json_maker(json, command_line);
  scree_json_text(json, "file", entry->file);
  if (entry->scan) {
    char checksum[SCREE_CHECKSUM_TEXT];
    scree_json_text(json, "checksum", scree_checksum_text(entry->scan->checksum, checksum));
    scree_json_text(json, "format", entry->scan->format);
    scree_json_number(json, "unit_m", entry->unit_m);
    scree_json_count(json, "facet_count", entry->scan->facet_count);
    scree_json_count(json, "collapsed_facet_count", entry->scan->degenerate_count);
  }
  if (entry->check) json_check(json, "check", entry->check);
  if (entry->repair) json_repair(json, entry->repair);
  if (entry->output) scree_json_text(json, "output", entry->output);
  if (entry->failure) scree_json_text(json, "failure", entry->failure);
  scree_json_end(json);
}

scree_status scree_check_json_write(const scree_check_entry *entries, size_t entry_count,
                                    const char *command_line, const char *path, bool overwrite,
                                    scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  scree_json json = scree_json_start(output.stream);
  scree_json_array(&json, NULL);
  for (size_t i = 0; i < entry_count; i++) json_entry(&json, &entries[i], command_line);
  scree_json_end(&json);
  return scree_output_commit(&output, error);
}
