/* Heaps as JSON: those of scenes, and those that were measured (docs/reference/formats.md). */
#include "base/file.h"
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
  scree_json_number(json, "spread_deg", h->spread_deg);
  scree_json_number(json, "volume_deg", h->volume_deg);
  scree_json_number(json, "volume_se_deg", h->volume_se_deg);
  scree_json_number(json, "height", h->height);
  scree_json_number(json, "peak", h->peak);
  scree_json_number(json, "base_radius", h->base_radius);
  scree_json_number(json, "run_out", h->run_out);
  scree_json_number(json, "envelope_volume", h->envelope_volume);
}

static void put_ground(scree_json *json, const scree_ground *g) {
  scree_json_object(json, "ground");
  scree_json_numbers(json, "up", g->up, 3);
  scree_json_number(json, "offset", g->offset);
  scree_json_number(json, "share", g->share);
  scree_json_number(json, "rms", g->rms);
  scree_json_number(json, "filled", g->filled);
  scree_json_end(json);
}

scree_status scree_heap_json_write(const scree_heap_entry *entry, const char *path, bool overwrite,
                                   scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  scree_json json = scree_json_start(output.stream);
  scree_json_object(&json, NULL);
  scree_json_maker(&json, entry->command_line);
  scree_json_text(&json, "file", entry->file);
  scree_json_text(&json, "kind", entry->kind);
  if (entry->ground) put_ground(&json, entry->ground);
  scree_json_repose(&json, entry->repose);
  scree_json_number(&json, "particle_size", entry->options->particle_size);
  scree_json_number(&json, "band_low", entry->options->band_low);
  scree_json_number(&json, "band_high", entry->options->band_high);
  scree_json_end(&json);
  return scree_output_commit(&output, error);
}
