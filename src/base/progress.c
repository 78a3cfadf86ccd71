#include "base/progress.h"

bool scree_tick(scree_ticker *ticker, const char *phase, double fraction) {
  const scree_progress *progress = ticker->progress;
  if (!progress || !progress->report) return true;
  double now = scree_now();
  if (fraction > 0 && fraction < 1 && now - ticker->last_report < progress->interval) return true;
  ticker->last_report = now;
  return progress->report(progress->context, phase, fraction);
}
