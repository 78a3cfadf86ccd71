/* The verbs `calibrate` and `optimise`. */
#pragma once

#include "cli/study.h"

/* Refuses a file that is for the other verb. */
scree_status calibrate_run(const cli_call *call, scree_error *error);

/* All but what a study alone has. */
#define CALIBRATION                                                                                \
  .options = study_options, .option_count = STUDY_OPTIONS - 1, .defaults = &study_defaults,        \
  .options_size = sizeof study_defaults, .input_minimum = 1, .input_maximum = 2,                   \
  .partners = "tasks:slurm", .exclusive = STUDY_EXCLUSIVE, .run = calibrate_run
