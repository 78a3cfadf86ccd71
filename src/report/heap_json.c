/* Heaps as JSON: those of scenes, and those that were measured (docs/reference/formats.md). */
#include "report/json.h"
#include "report/program.h"

static void put_way(scree_json *json, const char *key, double deg, double sd_deg, size_t count) {
  scree_json_row_object(json, key);
  SCREE_JSON_MEMBERS(json, AS("angle_deg", deg), AS("sd_deg", sd_deg), AS("count", count));
}

void scree_json_repose(scree_json *json, const scree_repose *h) {
  SCREE_JSON_MEMBERS(json, OF(h, heap), AS("no_heap_because", h->heap ? NULL : h->reason));
  put_way(json, "sectors", h->sector_deg, h->sector_sd_deg, h->sector_count);
  scree_json_count(json, "total", h->sector_total);
  scree_json_end(json);
  SCREE_JSON_ROW(json, "cone", AS("angle_deg", h->cone_deg), AS("rms", h->cone_rms));
  put_way(json, "silhouettes", h->silhouette_deg, h->silhouette_sd_deg, h->flank_count);
  scree_json_end(json);
  SCREE_JSON_MEMBERS(json, OF(h, spread_deg), OF(h, volume_deg), OF(h, volume_se_deg),
                     OF(h, height), OF(h, peak), OF(h, base_radius), OF(h, run_out),
                     OF(h, envelope_volume));
}

const scree_field scree_pile_rows[SCREE_PILE_ROWS] = {
    SCREE_FIELD_OF(scree_pile, packing_fraction), SCREE_FIELD_OF(scree_pile, body_count),
    SCREE_FIELD_IN(scree_pile, "particle_size", "m", size)};

static void put_ground(scree_json *json, const scree_ground *g) {
  scree_json_object(json, "ground");
  scree_json_numbers(json, "up", g->up, 3);
  SCREE_JSON_MEMBERS(json, OF(g, offset), OF(g, share), OF(g, rms), OF(g, filled));
  scree_json_end(json);
}

scree_status scree_heap_json_write(const scree_heap_entry *entry, const char *path, bool overwrite,
                                   scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  scree_json_object(&json, NULL);
  scree_json_maker(&json, entry->command_line);
  SCREE_JSON_MEMBERS(&json, OF(entry, file), OF(entry, kind));
  if (entry->ground) put_ground(&json, entry->ground);
  scree_json_repose(&json, entry->repose);
  SCREE_JSON_MEMBERS(&json, OF(entry->options, particle_size), OF(entry->options, band_low),
                     OF(entry->options, band_high));
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}
