/* Heaps as JSON: those of scenes, and those that were measured (docs/reference/formats.md). */
#include "report/json.h"
#include "report/program.h"

static void put_way(scree_json *json, const char *key, double deg, double sd_deg, size_t count) {
  scree_json_row_object(json, key);
  scree_json_number(json, "angle_deg", deg);
  scree_json_number(json, "sd_deg", sd_deg);
  scree_json_count(json, "count", count);
}

void scree_json_repose(scree_json *json, const scree_repose *h) {
  scree_json_bool(json, "heap", h->heap);
  scree_json_text(json, "no_heap_because", h->heap ? NULL : h->reason);
  put_way(json, "sectors", h->sector_deg, h->sector_sd_deg, h->sector_count);
  scree_json_count(json, "total", h->sector_total);
  scree_json_end(json);
  scree_json_row_object(json, "cone");
  scree_json_number(json, "angle_deg", h->cone_deg);
  scree_json_number(json, "rms", h->cone_rms);
  scree_json_end(json);
  put_way(json, "silhouettes", h->silhouette_deg, h->silhouette_sd_deg, h->flank_count);
  scree_json_end(json);
  SCREE_JSON_MEMBERS(json, h, spread_deg, volume_deg, volume_se_deg, height, peak, base_radius,
                     run_out, envelope_volume);
}

static void put_ground(scree_json *json, const scree_ground *g) {
  scree_json_object(json, "ground");
  scree_json_numbers(json, "up", g->up, 3);
  SCREE_JSON_MEMBERS(json, g, offset, share, rms, filled);
  scree_json_end(json);
}

scree_status scree_heap_json_write(const scree_heap_entry *entry, const char *path, bool overwrite,
                                   scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  scree_json_object(&json, NULL);
  scree_json_maker(&json, entry->command_line);
  SCREE_JSON_MEMBERS(&json, entry, file, kind);
  if (entry->ground) put_ground(&json, entry->ground);
  scree_json_repose(&json, entry->repose);
  SCREE_JSON_MEMBERS(&json, entry->options, particle_size, band_low, band_high);
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}
