/* What the verbs `calibrate` and `optimise` share: they differ in their words only. */
#ifndef SCREE_CLI_CALIBRATE_H
#define SCREE_CLI_CALIBRATE_H

#include "cli/study.h"

enum { CALIBRATE_OPTIONS = 10 };
extern const cli_option calibrate_options[CALIBRATE_OPTIONS];
extern const study_arguments calibrate_defaults;

/* Refuses a file that is for the other verb. */
int calibrate_run(const cli_call *call, bool search);

#endif
