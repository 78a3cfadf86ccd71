/* Where and when some work was done, for the files of the program's verbs. */
#pragma once

#include "report/json.h"
#include "scree.h"

/* When some work began, by three clocks, in seconds. */
typedef struct scree_work_start {
  double calendar, elapsed, processor; /* since 1970; of no meaning alone; of all threads */
} scree_work_start;

scree_work_start scree_work_started(void);

/* JSON: version, command, when the work began and how long it took until now, on what machine and
 * how many threads. Kept apart from results, which do not change from run to run. */
scree_status scree_provenance_write(const scree_work_start *start, const char *command_line,
                                    const char *path, bool overwrite, scree_error *error);

/* The members "command", "started", "ended", "machine" and "inputs"; null where not known. */
void scree_json_origin(scree_json *json, const scree_origin *origin);
