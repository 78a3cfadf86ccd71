/* What a scene says in one sentence: its heap's angle where it has one and may have one, else what
 * came in and went out. */
#include "base/error.h"
#include "base/number.h"
#include "report/program.h"

#include <math.h>

static const double half = 1.645; /* of a normal value, 90 % */

static void say_doubts(const scree_scene *scene, scree_words *w) {
  char doubt[SCREE_REMARK];
  for (size_t i = 0; i < 2 && scree_scene_doubt(scene, i, doubt); i++)
    SCREE_ADD_TEXT(w->but, "%s%s.", *w->but ? " " : "", doubt);
}

static void say_hardening(const scree_scene *scene, scree_words *w) {
  scree_scene_hardening h;
  if (!scree_scene_get_hardening(scene, 0, &h)) return;
  SCREE_ADD_TEXT(w->but,
                 "%s%s and %s were pressed beyond the overlap limit, where springs harden, %llu "
                 "times, by up to %.2g limits: %.3g times as stiff they would have stayed within.",
                 *w->but ? " " : "", h.material ? h.material : "bodies",
                 h.other ? h.other : "bodies", (unsigned long long)h.count, h.deepest,
                 h.stiffness_missing);
}

static void say_heap(const scree_scene *scene, const scree_pile *pile, scree_words *w) {
  const scree_repose *r = &pile->repose;
  char why[SCREE_REMARK], cost[SCREE_NUMBER_SIZE];
  double low = fmin(r->sector_deg, fmin(r->cone_deg, r->silhouette_deg)),
         high = fmax(r->sector_deg, fmax(r->cone_deg, r->silhouette_deg));
  double seconds;
  if (scree_scene_no_angle(scene, why, &seconds)) {
    w->verdict = SCREE_NOT_ENOUGH;
    w->state = "Not enough for an angle";
    SCREE_ADD_TEXT(w->answer, "No angle yet: %s.", why);
    scree_seconds_text(seconds, cost); /* it depends on the machine: not in the answer */
    SCREE_ADD_TEXT(w->next, "so many, about %s of a processor.", cost);
  } else if (!r->heap) {
    w->verdict = SCREE_NOT_ENOUGH;
    w->state = "No angle";
    SCREE_ADD_TEXT(w->answer, "No angle of repose: no heap, %s.", r->reason);
  } else {
    w->state = "A heap with an angle";
    SCREE_ADD_TEXT(w->answer,
                   "%zu particles of %.3g mm heap at %.1f +- %.1f deg (angle of repose by volume "
                   "and centroid, one heap).",
                   pile->body_count, 1e3 * pile->size, r->volume_deg, half * r->volume_se_deg);
    SCREE_ADD_TEXT(w->but, "The interval holds 90 %% for this heap; the next one may differ by "
                           "more.");
    if (high > low)
      SCREE_ADD_TEXT(w->but, " Methods that look at the flank alone read %.1f to %.1f deg.", low,
                     high);
    scree_seconds_text(scree_scene_get_costs(scene).processor_seconds, cost);
    SCREE_ADD_TEXT(w->next,
                   "two more heaps with other seeds (--seed 2, --seed 3), %s of a processor each, "
                   "tell how far heaps differ.",
                   cost);
  }
}

void scree_scene_words(const scree_scene *scene, const scree_pile *pile, const char *stopped,
                       scree_words *w) {
  const char *end = scree_scene_end(scene);
  scree_scene_book b;
  *w = (scree_words){.state = end ? end : "Ended"};
  scree_scene_get_book(scene, &b);
  if (pile) {
    say_heap(scene, pile, w);
  } else {
    SCREE_ADD_TEXT(w->answer, "%zu particles came in%s, %zu are inside and %zu went out in %.4g s.",
                   b.entered_count, scree_book_pieces(&b) ? " and came apart" : "", b.inside_count,
                   b.left_count, scree_world_time(scree_scene_view(scene)));
    if (b.waiting_count) SCREE_ADD_TEXT(w->but, "%zu found no room at inlets.", b.waiting_count);
  }
  say_hardening(scene, w);
  say_doubts(scene, w);
  if (!stopped) return;
  w->verdict = SCREE_NOT_ENOUGH;
  w->state = "Stopped before its end";
  SCREE_ADD_TEXT(w->but, "%sIt stopped because: %s.", *w->but ? " " : "", stopped);
  *w->next = 0;
  SCREE_ADD_TEXT(w->next, "go on with --resume.");
}

void scree_pile_finding(const scree_repose *r, char *to, size_t size) {
  double low = fmin(r->sector_deg, fmin(r->cone_deg, r->silhouette_deg)) - r->volume_deg,
         high = fmax(r->sector_deg, fmax(r->cone_deg, r->silhouette_deg)) - r->volume_deg;
  *to = 0;
  if (!r->heap || !(high >= low)) return;
  if (low * high > 0)
    snprintf(to, size, "Flank methods read %.1f to %.1f deg %s", fmin(fabs(low), fabs(high)),
             fmax(fabs(low), fabs(high)), low > 0 ? "more" : "less");
  else
    snprintf(to, size, "Flank methods read %.1f deg less to %.1f deg more", -low, high);
}
