/* Running a scene in a folder: what the verbs run, repose and drop do alike. */
#pragma once

#include "cli/input.h"
#include "report/provenance.h"

/* What of each frame becomes a file for ParaView: bits. */
enum { CLI_BODIES = 1, CLI_POINTS = 2, CLI_CONTACTS = 4, CLI_GEOMETRY = 8, CLI_FRAME_KINDS = 4 };

/* The frames that were written. */
typedef struct cli_frames {
  double *items; /* the times, s */
  size_t count, capacity;
} cli_frames;

/* What calls of these verbs ask for. */
typedef struct cli_scene_options {
  const char *output; /* folder; NULL: none */
  cli_texts set, change;
  size_t rays;
  bool print, resume, overwrite, json, no_picture;
} cli_scene_options;

typedef struct cli_scene_run {
  const cli_call *call;
  const cli_scene_options *options;
  scree_work_start start;
  scree_scene_file *file; /* NULL: that of the checkpoint */
  const char *file_name;  /* as given; NULL: scene.yaml of the folder */
  const char *output;     /* the options', or one in it */
  scree_shape_store *store;
  unsigned views;
  bool states;      /* also frames that can be measured again */
  bool brief;       /* the answer, not every number: these are in result.txt */
  bool common_page; /* one of several, which get one report together */
  bool time_told;
  const char *name; /* of this one among several; NULL: it is the only one */
  scree_scene *scene;
  scree_scene_forecast forecast;
  cli_frames frames;
} cli_scene_run;

/* Whether the folder can be written to, before any work; of a call with several the same of what
 * an earlier one left. */
scree_status cli_check_scene_output(const cli_scene_run *run, scree_error *error);
scree_status cli_clear_scene_output(const cli_call *call, const char *folder, scree_error *error);
/* Runs it to its end, prints what came of it and writes that into the folder. run->scene stays, to
 * be looked at; also where it was stopped. */
scree_status cli_run_scene(cli_scene_run *run, scree_error *error);
void cli_scene_run_free(cli_scene_run *run);

/* Sets fields by options (NULL: none), then those of --set. Of what cannot be, alone or together,
 * the first is told. */
scree_status cli_set_fields(const cli_call *call, scree_scene_file *file, const cli_fields *fields,
                            const cli_texts *set);

/* A heap's angles, three ways, a line each, and its size. */
void cli_print_repose(FILE *stream, const scree_repose *repose);
/* The same of a pile, with its particles. */
void cli_print_pile(FILE *stream, const scree_pile *pile);
