#include "cli/surface.h"

#include "base/owned.h"
#include "base/quote.h"
#include "cli/terminal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

scree_status cli_recommended_level(scree_curve *curve, const scree_mesh *mesh,
                                   const scree_progress *progress, size_t *level,
                                   scree_error *error) {
  scree_choice choice;
  SCREE_TRY(scree_choose(curve, mesh, NULL, progress, &choice, error));
  *level = choice.recommended.level_index;
  scree_choice_free(&choice);
  return SCREE_OK;
}

/* The command that repairs the word with an option, and what that does. */
static void offer(const char *word, const char *option, const char *does, scree_error *error) {
  char shown[CLI_PRINTABLE_BYTES], quoted[CLI_PRINTABLE_BYTES];
  size_t used = strlen(error->message);
  scree_quote_text(SCREE_QUOTE_SHELL, word, quoted, sizeof quoted);
  snprintf(error->message + used, sizeof error->message - used,
           "; `scree repair %s -o closed.stl %s` %s", cli_printable(quoted, shown), option, does);
}

void cli_hint_at_option(const char *word, const scree_repair_report *report,
                        const scree_repair_options *options, scree_error *error) {
  const scree_check *after = &report->after;
  double change = 100 * fabs(report->volume_after / report->volume_before - 1);
  char option[32], does[64];
  if (error->status != SCREE_BAD_MESH) return;
  if (after->usable && change <= 99) {
    snprintf(option, sizeof option, "--volume-change %.0f%%", ceil(change));
    offer(word, option, "allows it", error);
  } else if (report->refused_share > options->hole_share) {
    snprintf(does, sizeof does, "guesses %.2g %% of its area", 100 * report->refused_share);
    offer(word, "--holes 100%", does, error);
  } else if (!options->keep_largest && after->shell_count > 1) {
    offer(word, "--largest", "keeps the largest shell alone", error);
  }
}

/* Always in the same unit, which is the default one. */
static scree_status load_unscaled(const char *word, const cli_input_options *options,
                                  const scree_progress *progress, scree_scan *scan, double *scale,
                                  scree_error *error) {
  cli_input_options used = *options;
  used.read.unit_m = scree_default_read_options().unit_m;
  used.read.ignore_comment_unit = used.remarked = true;
  SCREE_TRY(cli_load(word, &used, progress, scan, error));
  bool commented = scan->comment_unit_m > 0 && !options->read.ignore_comment_unit;
  if (!scan->states_unit) scan->unit_m = commented ? scan->comment_unit_m : options->read.unit_m;
  *scale = scan->states_unit ? 1 : scan->unit_m / used.read.unit_m;
  if (!cli_is_sample(word, NULL) && !options->remarked)
    cli_remark_scan(word, options, scan, *scale);
  scan->states_unit |= commented;
  return SCREE_OK;
}

static void scale_check(scree_check *check, double scale) {
  for (int k = 0; k < 3; k++) check->size[k] *= scale;
  check->volume *= scale * scale * scale;
}

/* What was done to a mesh, as if the mesh had been larger by the scale. */
static void scale_report(scree_repair_report *report, double scale) {
  report->seam_distance *= scale;
  report->area_before *= scale * scale;
  report->area_after *= scale * scale;
  report->guessed_area *= scale * scale;
  report->volume_before *= scale * scale * scale;
  report->volume_after *= scale * scale * scale;
  report->filled_volume *= scale * scale * scale;
  report->handle_length *= scale;
  report->moved_mean *= scale;
  report->moved_most *= scale;
  for (int k = 0; k < 3; k++) report->handle_place[k] *= scale, report->moved_place[k] *= scale;
  scale_check(&report->before, scale);
  scale_check(&report->after, scale);
}

scree_status cli_load_closed(const char *word, const cli_input_options *options, bool no_repair,
                             const scree_progress *progress, scree_scan *scan, double *scale,
                             scree_repair_report *report, scree_error *error) {
  scree_repair_options repair = scree_default_repair_options();
  scree_repair_report made = {.before.usable = true};
  scree_status status = scale ? load_unscaled(word, options, progress, scan, scale, error)
                              : cli_load(word, options, progress, scan, error);
  const bool sample = cli_is_sample(word, NULL);
  if (options->keep_handles) repair.handle_edges = 0;
  if (sample) repair.intersections = false;
  if (status == SCREE_OK && !(sample && (no_repair || options->keep_handles))) {
    status = scree_mesh_prepare(&scan->mesh, no_repair ? NULL : &repair, progress, &scan->mesh,
                                &made, error);
    if (status != SCREE_OK && !no_repair) cli_hint_at_option(word, &made, &repair, error);
    if (status != SCREE_OK) scree_scan_free(scan);
    if (scale) scale_report(&made, *scale);
  }
  if (report) *report = made;
  return status == SCREE_OK ? status : cli_name_in_error(word, error);
}

scree_status cli_into_metres(const char *word, const cli_input_options *options, bool no_repair,
                             double scale, const scree_progress *progress, scree_mesh *mesh,
                             scree_error *error) {
  scree_scan again;
  cli_input_options used = *options;
  if (scale == 1) return SCREE_OK;
  used.remarked = true;
  if (!strcmp(word, "-")) {
    scree_mesh_scale(mesh, scale);
    return SCREE_OK;
  }
  SCREE_TRY(cli_load_closed(word, &used, no_repair, progress, &again, NULL, NULL, error));
  scree_mesh_free(mesh);
  *mesh = again.mesh;
  return SCREE_OK;
}

scree_status cli_load_for_levels(const cli_call *call, const cli_source *source,
                                 const cli_soundness *how, scree_scan *scan, double *scale,
                                 scree_error *error) {
  cli_input_options input = cli_source_options(source);
  scree_repair_report report;
  char note[1024], shown[CLI_PRINTABLE_BYTES];
  const char *word = call->inputs[0];
  input.keep_handles = how->keep_handles;
  if (how->unchecked) return load_unscaled(word, &input, call->progress, scan, scale, error);
  SCREE_TRY(
      cli_load_closed(word, &input, how->no_repair, call->progress, scan, scale, &report, error));
  cli_repair_text(&report, note, sizeof note);
  cli_terminal_end();
  if (note[0] && !call->quiet) fprintf(stderr, "%s: %s\n", cli_printable(word, shown), note);
  return SCREE_OK;
}

void cli_print_left_out(FILE *stream, size_t count) {
  if (count)
    fprintf(stream, "%10zu facet%s of fewer than three different corners left out on reading\n",
            count, cli_plural(count));
}

void cli_print_check(FILE *stream, const scree_check *check) {
  if (check->size[0] > 0 || check->size[1] > 0 || check->size[2] > 0)
    fprintf(stream, "%10.4g x %.4g x %.4g mm size along x, y, z\n", 1e3 * check->size[0],
            1e3 * check->size[1], 1e3 * check->size[2]);
  fprintf(stream, "%10zu triangle%s\n%10zu vertices\n%10zu shell%s\n", check->triangle_count,
          cli_plural(check->triangle_count), check->vertex_count, check->shell_count,
          cli_plural(check->shell_count));
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
    if (check->defects[i])
      fprintf(stream, "%10zu %s\n", check->defects[i],
              scree_defect_text((scree_defect)i, check->defects[i]));
  if (check->too_many_pairs)
    fprintf(stream,
            "more than %d pairs of facets meet: neither their kinds are told, nor how shells lie\n",
            SCREE_PAIR_LIMIT);
  if (check->volume_known)
    fprintf(stream, "%10.6g cm3 volume\n", check->volume * 1e6);
  else
    fprintf(stream, "%10s volume%s\n", "unknown",
            check->intersections_known ? "" : ": self-intersections were not looked for");
}

/* "; volume 4.15 -> 4.21 cm3", where it is another or was not known. */
static size_t tell_change(const char *what, const char *unit, double before, double after,
                          char *buffer, size_t size) {
  int length = 0;
  if (isnan(before))
    length = snprintf(buffer, size, "; %s %.6g %s, unknown before", what, after, unit);
  else if (fabs(after / before - 1) >= CLI_NOTABLE_CHANGE)
    length = snprintf(buffer, size, "; %s %.6g -> %.6g %s", what, before, after, unit);
  return length > 0 && (size_t)length < size ? (size_t)length : 0;
}

/* Where what became of the surface lies off what was given by more than a choice keeps of it. */
static void tell_move(const scree_repair_report *report, char *buffer, size_t size) {
  static const double MOST = 0.04, MEAN = 0.003;
  double length = sqrt(report->area_after / 3.14159265358979323846);
  const double *at = report->moved_place;
  if (report->moved_most <= MOST * length && report->moved_mean <= MEAN * length) return;
  snprintf(buffer, size,
           "; that is off the file's surface by %.3g mm in the mean, and by up to %.3g mm, %.2g %% "
           "of the body's size, at %.4g, %.4g, %.4g mm: tolerances hold from there on",
           1e3 * report->moved_mean, 1e3 * report->moved_most, 100 * report->moved_most / length,
           1e3 * at[0], 1e3 * at[1], 1e3 * at[2]);
}

void cli_repair_text(const scree_repair_report *report, char *buffer, size_t size) {
  size_t used = 0;
  buffer[0] = 0;
  const size_t *done = report->done;
  if (report->before.usable && report->before.triangle_count == report->after.triangle_count)
    return; /* nothing is lost */
  for (int a = 0; a < SCREE_REPAIR_ACTION_COUNT; a++) {
    if (!done[a] || used + 1 >= size) continue;
    used += (size_t)snprintf(buffer + used, size - used, "%s%zu %s",
                             used ? ", " : "repaired: ", done[a],
                             scree_repair_action_text((scree_repair_action)a, done[a]));
    if (a == SCREE_REPAIR_FILL_CAVITY && used + 1 < size)
      used += (size_t)snprintf(buffer + used, size - used, " (%.3g mm3, %.2g %% of the mass)",
                               1e9 * report->filled_volume,
                               100 * report->filled_volume / report->volume_after);
    if (a == SCREE_REPAIR_CUT_HANDLE && used + 1 < size)
      used += (size_t)snprintf(buffer + used, size - used,
                               " (loops of up to %.3g mm, that one at %.4g, %.4g, %.4g mm)",
                               1e3 * report->handle_length, 1e3 * report->handle_place[0],
                               1e3 * report->handle_place[1], 1e3 * report->handle_place[2]);
  }
  if (used > 0 && used < size)
    used += tell_change("area", "cm2", 1e4 * report->area_before, 1e4 * report->area_after,
                        buffer + used, size - used);
  if (used > 0 && used < size)
    used += tell_change("volume", "cm3", 1e6 * report->volume_before, 1e6 * report->volume_after,
                        buffer + used, size - used);
  if (used < size && report->guessed_area > 0)
    used += (size_t)snprintf(buffer + used, size - used,
                             "; %.2g %% of the area is guessed: a scan of that side would say more",
                             100 * report->guessed_area / report->area_after);
  if (used < size) tell_move(report, buffer + used, size - used);
}

size_t cli_body_count(const scree_repair_report *report) {
  return report->after.defects[SCREE_DEFECT_EXTRA_BODY] + 1;
}

/* "4.15 -> 4.21 cm2 area (+1.5 %)" */
static void print_change(FILE *stream, const char *what, double before, double after) {
  if (isnan(before))
    fprintf(stream, "%10.6g %s, unknown before\n", after, what);
  else
    fprintf(stream, "%10.6g %s, %.6g before (%+.2g %%)\n", after, what, before,
            100 * (after / before - 1));
}

void cli_print_repair(FILE *stream, const scree_repair_report *report) {
  bool any = false;
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++) {
    if (!report->done[i]) continue;
    any = true;
    fprintf(stream, "%10zu %s\n", report->done[i],
            scree_repair_action_text((scree_repair_action)i, report->done[i]));
  }
  if (report->done[SCREE_REPAIR_CUT_OFF]) {
    double n[3]; /* without what rounding left */
    for (int k = 0; k < 3; k++) n[k] = round(1e4 * report->plane.normal[k]) / 1e4 + 0.0;
    fprintf(stream, "%10s the plane %.4g x %+.4g y %+.4g z = %.6g mm\n", "at", n[0], n[1], n[2],
            1e3 * report->plane.offset);
  }
  if (report->done[SCREE_REPAIR_CUT_HANDLE])
    fprintf(stream, "%10.3g mm long is the longest loop of a handle cut, at %.4g, %.4g, %.4g mm\n",
            1e3 * report->handle_length, 1e3 * report->handle_place[0],
            1e3 * report->handle_place[1], 1e3 * report->handle_place[2]);
  if (report->moved_most > 0)
    fprintf(stream, "%10.3g mm off what was given, at %.4g, %.4g, %.4g mm; %.3g mm in the mean\n",
            1e3 * report->moved_most, 1e3 * report->moved_place[0], 1e3 * report->moved_place[1],
            1e3 * report->moved_place[2], 1e3 * report->moved_mean);
  if (report->seam_distance > 0)
    fprintf(stream, "%10.3g mm is the distance within which seams were closed\n",
            report->seam_distance * 1e3);
  if (any && report->after.usable) {
    if (report->done[SCREE_REPAIR_FILL_CAVITY])
      fprintf(stream, "%10.3g mm3 of small cavities filled, %.2g %% of the mass\n",
              1e9 * report->filled_volume, 100 * report->filled_volume / report->volume_after);
    if (report->guessed_area > 0)
      fprintf(stream, "%10.2g %% of the area is guessed: a scan of that side would say more\n",
              100 * report->guessed_area / report->area_after);
    print_change(stream, "cm2 area", 1e4 * report->area_before, 1e4 * report->area_after);
    print_change(stream, "cm3 volume", 1e6 * report->volume_before, 1e6 * report->volume_after);
  }
  if (!any)
    fprintf(stream, "%10s %s be done\n", "nothing", report->before.usable ? "had to" : "could");
}

/* As single precision holds the coordinate in file units. */
static double rounded(double coordinate, double unit) {
  return (double)(float)(coordinate / unit) * unit;
}

static bool fits_single(const scree_mesh *mesh, double unit) {
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    if (rounded(mesh->positions[i], unit) != mesh->positions[i]) return false;
  return true;
}

/* The mesh as reading it from an STL gives it. */
static scree_status round_mesh(const scree_mesh *mesh, double unit, scree_mesh *read,
                               scree_error *error) {
  double *corners = malloc((9 * mesh->triangle_count + 1) * sizeof *corners);
  if (!corners) return scree_fail_memory(error, 0, "the rounded surface");
  for (size_t i = 0; i < 9 * mesh->triangle_count; i++)
    corners[i] = rounded(mesh->positions[3 * (size_t)mesh->triangles[i / 3] + i % 3], unit);
  scree_status status = scree_mesh_weld(corners, mesh->triangle_count, 0, read, NULL, error);
  free(corners);
  return status;
}

static bool is_single(const char *path) {
  return !strcmp(path, "-") || scree_file_format_of(path) == SCREE_FORMAT_STL;
}

double cli_volume_lost(const scree_mesh *mesh, const char *path, double unit) {
  scree_mesh single;
  scree_error error; /* is told by what writes the mesh; this only remarks */
  double held = 0, left = 0;
  if (!is_single(path) || scree_mesh_area_volume(mesh, NULL, &held, &error) != SCREE_OK ||
      scree_mesh_copy(mesh, &single, &error) != SCREE_OK)
    return 0;
  for (size_t i = 0; i < 3 * single.vertex_count; i++)
    single.positions[i] = rounded(single.positions[i], unit);
  scree_status status = scree_mesh_area_volume(&single, NULL, &left, &error);
  scree_mesh_free(&single);
  return status == SCREE_OK && held != 0 ? fabs(left - held) / fabs(held) : 0;
}

scree_status cli_check_rounded(const scree_mesh *mesh, const char *path, double unit,
                               const scree_check_options *how, const scree_progress *progress,
                               scree_error *error) {
  scree_mesh read;
  scree_check check;
  if (!is_single(path) || fits_single(mesh, unit)) return SCREE_OK;
  SCREE_TRY(round_mesh(mesh, unit, &read, error));
  scree_status status = scree_mesh_check(&read, how, progress, &check, error);
  scree_mesh_free(&read);
  if (status != SCREE_OK || check.usable) return status;
  error->status = SCREE_BAD_MESH;
  snprintf(error->message, sizeof error->message,
           "%.300s: rounded to the file's precision, the surface is %.500s; a .ply or .obj, as "
           "`scree simplify` writes, would hold it",
           path, check.verdict);
  return SCREE_BAD_MESH;
}

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
  double scale = 1;
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
