/* Rate-limited calls of a scree_progress. */
#pragma once

#include "base/platform.h" /* scree_now */
#include "scree.h"

typedef struct scree_ticker {
  const scree_progress *progress; /* may be NULL: then every tick answers true */
  double last_report;             /* seconds, monotonic clock */
} scree_ticker;

/* Reports when the progress's interval is over (always when fraction is 0 or 1); false means
 * cancel. */
bool scree_tick(scree_ticker *ticker, const char *phase, double fraction);
