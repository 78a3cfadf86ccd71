#include "cli/clump_surface.h"

#include "cli/surface.h"

#include <string.h>

/* Into metres as well. */
static scree_status decimate(scree_scan *scan, double scale, size_t triangles,
                             const scree_progress *progress, scree_mesh *mesh, scree_error *error) {
  scree_curve *curve;
  scree_simplify_options simplify = scree_default_simplify_options();
  simplify.stop_count = triangles;
  SCREE_TRY(scree_curve_build_scaled(&scan->mesh, scale, &simplify, progress, &curve, error));
  scree_status status = scree_curve_mesh(curve, scree_curve_find(curve, triangles), mesh, error);
  scree_curve_free(curve);
  return status;
}

scree_status cli_load_for_clump(const char *word, const cli_input_options *input,
                                const scree_progress *progress, cli_clump_surface *surface,
                                scree_error *error) {
  scree_repair_report repair;
  scree_scan scan;
  double scale;
  scree_status status =
      cli_load_closed(word, input, surface->no_repair, progress, &scan, &scale, &repair, error);
  if (status != SCREE_OK) return status;
  cli_repair_text(&repair, surface->note, sizeof surface->note);
  memcpy(surface->format, scan.format, sizeof surface->format);
  surface->unit_m = scan.unit_m;
  surface->checksum = scan.checksum;
  surface->scan_triangle_count = scan.mesh.triangle_count;
  if (scan.mesh.triangle_count > surface->triangles) {
    status = decimate(&scan, scale, surface->triangles, progress, &surface->mesh, error);
  } else {
    status = cli_into_metres(word, input, surface->no_repair, scale, progress, &scan.mesh, error);
    if (status == SCREE_OK) {
      surface->mesh = scan.mesh;
      scan.mesh = (scree_mesh){0};
    }
  }
  scree_scan_free(&scan);
  return status == SCREE_OK ? status : cli_name_in_error(word, error);
}
