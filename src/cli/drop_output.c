/* What `scree drop` writes: frames for ParaView, a table over time, a picture. */
#include "base/platform.h"
#include "cli/drop.h"
#include "cli/output.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

scree_status drop_path(const drop_run *run, const char *name, char path[DROP_PATH_BYTES],
                       scree_error *error) {
  int length = snprintf(path, DROP_PATH_BYTES, "%s/%s", run->arguments->output, name);
  if (length < DROP_PATH_BYTES) return SCREE_OK;
  *error = (scree_error){SCREE_BAD_ARGUMENT, "the folder's name is too long"};
  return error->status;
}

static bool may_replace(const drop_run *run) {
  return run->arguments->overwrite || run->arguments->resume;
}

scree_status drop_no_series(scree_error *error) {
  *error = (scree_error){SCREE_IO, "series.csv: cannot write"};
  return SCREE_IO;
}

static const char *const file_names[] = {
    "series.csv",      "checkpoint.scree", "motion.scree", "frame-#.vtp", "drop.pvd",
    "drop.png",        "drop.json",        "drop.txt",     "last.world",  "before-failure.world",
    "provenance.json", "report.html"};
static const cli_run_files run_files = {file_names, sizeof file_names / sizeof *file_names};

scree_status drop_check_output(const drop_run *run, scree_error *error) {
  const drop_arguments *a = run->arguments;
  scree_status status = cli_make_folder(a->output, error);
  if (status == SCREE_OK && !a->resume)
    status = cli_check_run_output(run->call, a->output, &run_files, a->overwrite, error);
  return status;
}

scree_status drop_open_output(drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = SCREE_OK;
  if (may_replace(run))
    status = cli_clear_run_output(run->call, run->arguments->output, &run_files, error);
  if (status == SCREE_OK) status = drop_path(run, "series.csv", path, error);
  if (status != SCREE_OK) return status;
  run->series = scree_open_stream(path, may_replace(run) ? "w" : "wx");
  if (!run->series) return cli_refuse(error, SCREE_IO, path, strerror(errno));
  fprintf(run->series,
          "# scree %s, %s\ntime_s,steps,bodies,kinetic_J,rotational_J,potential_J,elastic_J,"
          "dissipated_dashpot_J,dissipated_friction_J,entered_J,ledger_J,touching_pairs,contacts,"
          "coordination,largest_overlap_m,highest_speed_m_s,mean_rotation_rad_s\n",
          scree_version(), run->call->command_line);
  return SCREE_OK;
}

scree_status drop_keep_state(drop_run *run, scree_error *error) {
  enum { KEEP_STEPS = 2000 };
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "before-failure.world", path, error);
  if (status != SCREE_OK) return status;
  return scree_world_keep(scree_pour_world(run->pour), path, KEEP_STEPS, error);
}

double drop_energy(const scree_observation *o) {
  return o->kinetic + o->rotational + o->potential + o->elastic + o->dissipated_dashpot +
         o->dissipated_friction - o->wall_work;
}

scree_status drop_write_line(drop_run *run, scree_error *error) {
  scree_observation o;
  const scree_world *world = scree_pour_view(run->pour);
  double entered = scree_pour_entered_energy(run->pour);
  scree_world_observe(world, &o);
  double ledger = drop_energy(&o) - entered;
  int length =
      fprintf(run->series,
              "%.9g,%llu,%zu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.3g,%zu,%zu,%.5g,%.5g,%.5g,%.5g\n",
              o.time, (unsigned long long)scree_world_step_count(world), o.body_count, o.kinetic,
              o.rotational, o.potential, o.elastic, o.dissipated_dashpot, o.dissipated_friction,
              entered, ledger, o.pair_count, o.contact_count, o.coordination, o.largest_overlap,
              o.highest_speed, o.mean_rotation);
  return length > 0 && fflush(run->series) == 0 ? SCREE_OK : drop_no_series(error);
}

/* ---- frames ---- */

static void name_frame(size_t index, char name[48]) {
  snprintf(name, 48, "frame-%06zu.vtp", index);
}

scree_status drop_note_frame(drop_run *run, double time, scree_error *error) {
  if (run->frames.count == run->frames.capacity) {
    size_t capacity = 2 * run->frames.capacity + 64;
    char **files = realloc(run->frames.files, capacity * sizeof *files);
    if (files) run->frames.files = files;
    double *times = realloc(run->frames.times, capacity * sizeof *times);
    if (times) run->frames.times = times;
    if (!files || !times) return drop_no_memory(error);
    run->frames.capacity = capacity;
  }
  char name[48];
  name_frame(run->frames.count, name);
  char *copy = strdup(name);
  if (!copy) return drop_no_memory(error);
  run->frames.files[run->frames.count] = copy;
  run->frames.times[run->frames.count++] = time;
  return SCREE_OK;
}

scree_status drop_write_frame(drop_run *run, scree_error *error) {
  char name[48], path[DROP_PATH_BYTES];
  const scree_world *world = scree_pour_world(run->pour);
  name_frame(run->frames.count, name);
  scree_status status = drop_path(run, name, path, error);
  if (status == SCREE_OK)
    status = scree_world_vtp_write(world, SCREE_VIEW_SURFACES, path, may_replace(run), error);
  return status == SCREE_OK ? drop_note_frame(run, scree_world_time(world), error) : status;
}

scree_status drop_close_output(drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "drop.pvd", path, error);
  if (status == SCREE_OK && run->frames.count)
    status = scree_pvd_write((const char *const *)run->frames.files, run->frames.times,
                             run->frames.count, path, may_replace(run), error);
  bool good = !run->series || fclose(run->series) == 0;
  run->series = NULL;
  return status != SCREE_OK || good ? status : drop_no_series(error);
}

void drop_free_output(drop_run *run) {
  for (size_t i = 0; i < run->frames.count; i++) free(run->frames.files[i]);
  free(run->frames.files);
  free(run->frames.times);
  if (run->series) fclose(run->series);
}

scree_status drop_write_picture(drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "drop.png", path, error);
  if (status != SCREE_OK) return status;
  scree_image image = {0};
  scree_render_options options = scree_default_render_options();
  options.samples = run->arguments->rays;
  status = scree_world_picture(scree_pour_world(run->pour), &options, run->call->progress, &image,
                               error);
  if (status == SCREE_OK) status = scree_image_write_png(&image, path, may_replace(run), error);
  scree_image_free(&image);
  return status;
}
