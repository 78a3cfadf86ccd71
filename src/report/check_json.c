/* Checks and repairs as JSON. */
#include "report/json.h"
#include "report/program.h"

static void json_check(scree_json *json, const char *key, const scree_check *check) {
  scree_json_object(json, key);
  SCREE_JSON_MEMBERS(json, OF(check, usable), OF(check, verdict), OF(check, triangle_count),
                     OF(check, vertex_count), OF(check, shell_count));
  scree_json_numbers(json, "size", check->size, 3);
  if (check->volume_known)
    scree_json_number(json, "volume", check->volume);
  else
    scree_json_text(json, "volume", NULL);
  SCREE_JSON_MEMBERS(json, OF(check, intersections_known), OF(check, too_many_pairs));
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
  SCREE_JSON_MEMBERS(json, OF(repair, seam_distance), OF(repair, area_before),
                     OF(repair, area_after), OF(repair, volume_before), OF(repair, volume_after),
                     OF(repair, guessed_area), OF(repair, filled_volume), OF(repair, handle_length),
                     OF(repair, moved_mean), OF(repair, moved_most));
  scree_json_numbers(json, "handle_place", repair->handle_place, 3);
  scree_json_numbers(json, "moved_place", repair->moved_place, 3);
  json_check(json, "after", &repair->after);
}

static void json_entry(scree_json *json, const scree_check_entry *entry, const char *command_line) {
  scree_json_object(json, NULL);
  scree_json_maker(json, command_line);
  scree_json_text(json, "file", entry->file);
  if (entry->scan) {
    char checksum[SCREE_CHECKSUM_TEXT];
    SCREE_JSON_MEMBERS(json, AS("checksum", scree_checksum_text(entry->scan->checksum, checksum)),
                       OF(entry->scan, format), OF(entry, unit_m), OF(entry->scan, facet_count),
                       AS("collapsed_facet_count", entry->scan->degenerate_count));
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
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  SCREE_JSON_LIST (&json, NULL, i, entry_count) json_entry(&json, &entries[i], command_line);
  return scree_json_commit(&json, error);
}
