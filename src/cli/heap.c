#include "cli/heap.h"

#include <math.h>

static void print_angles(FILE *stream, const scree_repose *r) {
  if (!r->heap) {
    fprintf(stream, "  angle of repose   none: no heap, %s\n", r->reason);
    return;
  }
  fprintf(stream, "  angle of repose   %5.1f deg  sd %4.1f   sectors (%zu of %zu)\n", r->sector_deg,
          r->sector_sd_deg, r->sector_count, r->sector_total);
  fprintf(stream, "                    %5.1f deg  rms %4.1f mm  cone\n", r->cone_deg,
          1e3 * r->cone_rms);
  fprintf(stream, "                    %5.1f deg  sd %4.1f   silhouettes (%zu flank%s)\n",
          r->silhouette_deg, r->silhouette_sd_deg, r->flank_count, cli_plural(r->flank_count));
  fprintf(stream,
          "                    %5.1f deg  by volume and centroid; the three differ by %.1f\n",
          r->volume_deg, r->spread_deg);
}

void cli_print_heap(FILE *stream, const scree_run *run, const scree_run_result *result) {
  const scree_repose *r = &result->repose;
  fprintf(stream, "%s after %.2f s of simulated time, %s (%.2g J of motion left)\n",
          scree_run_phase(run) == SCREE_PHASE_DONE ? "done"
                                                   : scree_phase_name(scree_run_phase(run)),
          result->time, result->still ? "still" : "still moving", result->kinetic);
  print_angles(stream, r);
  fprintf(stream, "  height            %5.0f mm, its highest point %.0f mm\n", 1e3 * r->height,
          1e3 * r->peak);
  if (isfinite(r->base_radius))
    fprintf(stream, "  base radius       %5.0f mm, the farthest particle reaches %.0f mm\n",
            1e3 * r->base_radius, 1e3 * r->run_out);
  else
    fprintf(stream, "  run-out           %5.0f mm\n", 1e3 * r->run_out);
  fprintf(stream,
          "  particles         %5zu on the disc, %zu fell off, of %.1f mm (sphere of equal "
          "volume)\n",
          result->body_count, result->left_count, 1e3 * result->particle_size);
  fprintf(stream, "  packing fraction  %5.2f\n  coordination      %5.2f touching neighbours\n",
          result->packing_fraction, result->coordination);
}

void cli_print_costs(FILE *stream, const scree_run *run) {
  scree_run_costs c;
  scree_run_get_costs(run, &c);
  fprintf(stream,
          "  cost              %llu step%s of %.3g us in %.0f s, %.2f us a particle and step\n",
          (unsigned long long)c.step_count, cli_plural(c.step_count), 1e6 * c.time_step,
          c.wall_seconds, c.particle_steps ? 1e6 * c.wall_seconds / (double)c.particle_steps : 0);
}

scree_status cli_write_picture(const scree_run *run, const scree_render_options *options,
                               const char *path, bool overwrite, const scree_progress *progress,
                               scree_error *error) {
  scree_image image;
  scree_status status = scree_run_picture(run, options, progress, &image, error);
  if (status != SCREE_OK) return status;
  status = scree_image_write_png(&image, path, overwrite, error);
  scree_image_free(&image);
  return status;
}
