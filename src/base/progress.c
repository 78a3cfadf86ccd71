#include "base/progress.h"

#include <time.h>

double scree_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool scree_tick(scree_ticker *ticker, const char *phase, double fraction) {
  const scree_progress *progress = ticker->progress;
  if (!progress || !progress->report) return true;
  double now = scree_now();
  if (fraction > 0 && fraction < 1 && now - ticker->last_report < progress->interval) return true;
  ticker->last_report = now;
  return progress->report(progress->context, phase, fraction);
}
