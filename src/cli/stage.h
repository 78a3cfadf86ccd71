/* A folder that is there whole or not at all: its files are written into another one and moved when
 * all is written. */
#pragma once

#include "cli/args.h"

enum { CLI_STAGE_BYTES = 4096 };

typedef struct cli_stage {
  const char *folder;         /* as asked for; borrowed */
  bool existed;               /* then the other folder lies in it, else beside it */
  char path[CLI_STAGE_BYTES]; /* of the other one: NAME.PROCESS-N.part; "" where there is none */
} cli_stage;

/* Makes the folder to write into, and what is missing above it. */
scree_status cli_stage_open(const char *folder, cli_stage *stage, scree_error *error);
/* Renames it to what was asked for; only where that was not there before. */
scree_status cli_stage_rename(cli_stage *stage, scree_error *error);
/* Removes it with all that it holds; nothing where it was renamed. */
void cli_stage_discard(cli_stage *stage);
/* Has an error name the folder that was asked for. */
void cli_stage_hide(const cli_stage *stage, scree_error *error);
