#include "simplify/limit.h"

#include "simplify/cheapest.h"
#include "simplify/stray.h"

/* Where there are no more than SCREE_GREEDY_COUNT triangles, what is usual for the squared stray
 * counts for so much: single collapses would look at more places, and pay a toll. */
#define COARSE_USUAL2 0.5
/* When the levels are not fine any more or the surface is kept, as long as there are no witnesses:
 * how far one collapse may stray, in mean moves of those of the pass before. */
#define MOST_MOVES 4.0
/* ... and how far all of them since the surface was kept may, squared, against that. */
#define ALL_MOVES2 1.44
/* On a rough surface every stray is large: its cost is above the threshold, which comes from costs
 * without it, or it is above the limit, for mean moves are those of the few that are done. Most
 * wait, then. After passes that take less than the first share of the triangles a whole cost may be
 * twice as many times the threshold, and the stray as far as that is worth; less again after passes
 * that take more than the second. */
#define STALLS   0.1
#define MOVES_ON 0.2

static double leniency(const scree_decimator *d) {
  return ldexp(1, d->lenient);
}

double scree_usual_stray2(const scree_decimator *d) {
  double usual = 0;
  if (scree_memory_is_kept(&d->memory)) {
    bool large = scree_is_large(d);
    usual = scree_memory_usual(&d->memory, large || scree_is_held_close(d));
    if (usual > 0 && !large && !scree_is_close_scan(d))
      usual = fmax(usual, scree_memory_worst(&d->memory));
  } else if (!scree_is_fine(d) || scree_memory_has_surface(&d->memory)) {
    usual = sqrt(sqrt(leniency(d))) * MOST_MOVES * d->mean_move; /* as D^4 costs */
  }
  double usual2 = usual > 0 ? usual * usual : INFINITY;
  return d->s.live_triangle_count <= SCREE_GREEDY_COUNT ? COARSE_USUAL2 * usual2 : usual2;
}

/* Places looked at on every new edge. */
static uint32_t edge_places(const scree_decimator *d) {
  return scree_is_close_scan(d) ? SCREE_MOST_EDGE_PLACES : scree_is_large(d) ? 3 : 1;
}

bool scree_strays(const scree_decimator *d, const scree_ring *ring, const scree_candidate *c,
                  double cost_limit, double usual2) {
  if (!(c->stray > 0)) return false;
  double most = fmin(scree_stray_at(c, leniency(d) * cost_limit), usual2);
  if (scree_memory_is_kept(&d->memory))
    return !scree_memory_stays_within(&d->memory, &d->s, ring, c->target, edge_places(d), most);
  if (!scree_stays_within(&d->s, ring, c->target, most)) return true;
  if (!(usual2 < INFINITY)) return false;
  return !scree_ends_stay_within(&d->s, ring, c->target, most) ||
         (scree_memory_has_surface(&d->memory) &&
          !scree_memory_stays_within(&d->memory, &d->s, ring, c->target, 1, ALL_MOVES2 * usual2));
}

void scree_limits_follow(scree_decimator *d, double share) {
  if (scree_memory_is_kept(&d->memory)) /* witnesses tell better what is far off */
    d->lenient = 0;
  else if (share < STALLS)
    d->lenient++;
  else if (share > MOVES_ON && d->lenient > 0)
    d->lenient--;
}
