#include "cli/clump_surface.h"

#include "base/owned.h"
#include "cli/surface.h"

#include <string.h>

/* Into metres as well. */
static scree_status decimate(scree_scan *scan, double scale, size_t triangles,
                             const scree_progress *progress, scree_mesh *mesh, scree_error *error) {
  SCREE_OWNED(scree_curve, curve);
  scree_simplify_options simplify = scree_default_simplify_options();
  simplify.stop_count = triangles;
  SCREE_TRY(scree_curve_build_scaled(&scan->mesh, scale, &simplify, progress, &curve, error));
  return scree_curve_mesh(curve, scree_curve_find(curve, triangles), mesh, error);
}

scree_status cli_load_for_clump(const char *word, const cli_input_options *input,
                                const scree_progress *progress, cli_clump_surface *surface,
                                scree_error *error) {
  scree_repair_report repair;
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  double scale;
  SCREE_TRY(
      cli_load_closed(word, input, surface->no_repair, progress, &scan, &scale, &repair, error));
  cli_repair_text(&repair, surface->note, sizeof surface->note);
  memcpy(surface->format, scan.format, sizeof surface->format);
  surface->unit_m = scan.unit_m;
  surface->checksum = scan.checksum;
  surface->scan_triangle_count = scan.mesh.triangle_count;
  scree_status status;
  if (scan.mesh.triangle_count > surface->triangles) {
    status = decimate(&scan, scale, surface->triangles, progress, &surface->mesh, error);
  } else {
    status = cli_into_metres(word, input, surface->no_repair, scale, progress, &scan.mesh, error);
    surface->mesh = scan.mesh;
    scan.mesh = (scree_mesh){0};
  }
  return status == SCREE_OK ? status : cli_name_in_error(word, error);
}
