/* Progress on the terminal, and Ctrl-C. */
#pragma once

#include "scree.h"

/* On stderr: nothing; one line drawn again and again; or, for a log, a line now and then of calls
 * that last. */
typedef enum cli_progress_kind {
  CLI_PROGRESS_NONE,
  CLI_PROGRESS_LINE,
  CLI_PROGRESS_LOG
} cli_progress_kind;
/* A progress that is shown so and cancels after Ctrl-C, SIGTERM, or a terminal that goes away
 * (SIGHUP, unless ignored). */
const scree_progress *cli_terminal_start(cli_progress_kind kind);
/* A share of a progress that stands for one phase among several: `progress` is given to whoever
 * does that part. What was reported once is never taken back. */
typedef struct cli_share {
  const scree_progress *whole;
  const char *phase; /* as it is shown; NULL: by the part's own name */
  double base, part; /* of the whole */
  double done;       /* the farthest so far, of the whole */
  scree_progress progress;
} cli_share;
cli_share cli_share_of(const scree_progress *whole, const char *phase);
/* Goes on with the next part, from `base` on; the share must not move in memory after that. */
const scree_progress *cli_share_enter(cli_share *share, double base, double part);
/* One's own line in the same place. */
void cli_terminal_line(const char *text);
/* "42 s", "7 min", "3.2 h"; "..." where seconds is not finite. */
void cli_terminal_seconds(char *text, size_t size, double seconds);
/* Clears the line: before anything else is printed. */
void cli_terminal_end(void);
/* From here on what is asked for is done: the next of these signals changes nothing any more, and
 * the one after it ends the program where it stands. False where one came before. */
bool cli_terminal_settle(void);
/* The signals end the program where it stands: for a call that leaves no files and works where it
 * cannot be asked to stop. */
void cli_terminal_release(void);
/* Whether one of these came, before it was settled; with true, cli_terminal_reraise ends the
 * program as the signal would have done, so that the shell sees it. */
bool cli_interrupted(void);
void cli_terminal_reraise(void);
