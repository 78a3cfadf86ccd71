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

static const char *const file_names[] = {"series.csv",    "checkpoint.scree", "motion.scree",
                                         "frame-#.vtp",   "drop.pvd",         "drop.png",
                                         "drop.json",     "drop.txt",         "last.world",
                                         "stopped.scree", "provenance.json",  "report.html"};
static const cli_run_files run_files = {file_names, sizeof file_names / sizeof *file_names};

scree_status drop_check_output(const drop_run *run, scree_error *error) {
  const drop_arguments *a = run->arguments;
  scree_status status = cli_make_folder(a->output, error);
  if (status == SCREE_OK && !a->resume)
    status = cli_check_run_output(run->call, a->output, &run_files, a->overwrite, error);
  return status;
}

scree_status drop_clear_output(const drop_run *run, scree_error *error) {
  return cli_clear_run_output(run->call, run->arguments->output, &run_files, error);
}

double drop_energy(const scree_observation *o) {
  return o->kinetic + o->rotational + o->potential + o->elastic + o->dissipated_dashpot +
         o->dissipated_friction - o->wall_work;
}

scree_status drop_write_frame(drop_run *run, const scree_pour *pour, scree_error *error) {
  char name[CLI_FRAME_NAME], path[DROP_PATH_BYTES];
  const scree_world *world = scree_pour_view(pour);
  cli_frame_name(run->frames.count, "", name);
  scree_status status = drop_path(run, name, path, error);
  if (status == SCREE_OK)
    status = scree_world_vtp_write(world, SCREE_VIEW_SURFACES, path, true, error);
  if (status != SCREE_OK) return status;
  return cli_frames_note(&run->frames, scree_world_time(world), error);
}

scree_status drop_list_frames(const drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "drop.pvd", path, error);
  return status == SCREE_OK ? cli_frames_list(&run->frames, "", path, error) : status;
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
  if (status == SCREE_OK) status = scree_image_write_png(&image, path, true, error);
  scree_image_free(&image);
  return status;
}
