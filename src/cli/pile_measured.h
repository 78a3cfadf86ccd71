/* `scree pile` of what users have: a scan of a heap, its outline, a picture of it. */
#pragma once

#include "cli/args.h"

typedef enum cli_pile_kind {
  CLI_PILE_SCENE, /* a frame or a checkpoint */
  CLI_PILE_SCAN,
  CLI_PILE_OUTLINE,
  CLI_PILE_PICTURE,
} cli_pile_kind;

/* By content and name: a PNG is a picture, .csv an outline, scree's own files and stdin a scene. */
cli_pile_kind cli_pile_kind_of(const char *path);

typedef struct cli_measured_pile {
  cli_pile_kind kind;
  double unit;  /* m per unit of a scan or an outline */
  double scale; /* m across a picture */
  double cell;  /* m; 0: by the size of what was measured */
  scree_repose_options how;
  bool json, csv;
} cli_measured_pile;

/* Measures and prints it. */
scree_status cli_measure_pile(const cli_call *call, const cli_measured_pile *what,
                              scree_error *error);
