/* The whole of a pair's step. */
#include "world/contact/contact.h"

static void fall_asleep(const scree_world *world, scree_pair *pair, scree_neighbours *n, vec3 at) {
  n->asleep_since = scree_bodies_path(world, pair);
  n->wake = n->asleep_since + scree_min(pair->list.next_feature, pair->list.end) - pair->list.path;
  n->asleep_at = at;
  n->asleep_turned = scree_pair_turned(world, pair);
  pair->asleep = true;
}

void scree_pair_leave(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  const vec3 at = scratch->relative.position; /* as the step began */
  scree_pair_watch(world, pair, scratch);
  if (scratch->substeps > 1 || pair->substeps.count > 1) scree_pair_follow(world, pair, scratch);
  if (pair->touching && pair->wall) scratch->work.wall += scree_half_work_of_wall(world, pair);
  if (!scree_pair_stays_awake(pair)) fall_asleep(world, pair, scratch->neighbours, at);
}

bool scree_pair_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  if (!scree_pair_narrow_phase(world, pair, scratch)) return false;
  scree_pair_leave(world, pair, scratch);
  return true;
}
