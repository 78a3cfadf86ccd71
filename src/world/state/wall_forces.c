/* Forces on walls, and the work that they do. */
#include "world/state/keys.h"
#include "world/state/walls.h"

/* Whether those of world->wall_pairs.items[i] are a body and wall w. */
static bool is_with(const scree_world *world, size_t i, size_t w) {
  return scree_key_second(world->list.keys.items[world->list.wall_pairs.items[i]]) == w;
}

double scree_wall_work(const scree_world *world, size_t w) {
  double work = world->walls.items[w].energy;
  for (size_t i = 0; i < world->list.wall_pairs.count; i++)
    if (is_with(world, i, w))
      work += world->list.ledger.items[world->list.wall_pairs.items[i]].wall;
  return work;
}

void scree_wall_sum(const scree_world *world, size_t w) {
  scree_world_wall *wall = &world->walls.items[w];
  scree_wrench all = {{0, 0, 0}, {0, 0, 0}};
  double belt_power = 0;
  for (size_t i = 0; i < world->list.wall_pairs.count; i++) {
    if (!is_with(world, i, w)) continue;
    const scree_pair *pair = scree_pair_of(world, world->list.wall_pairs.items[i]);
    if (!pair || !pair->touching) continue;
    all.force = vec3_add(all.force, pair->contact.wrench.force);
    all.moment = vec3_sub(all.moment, pair->contact.wrench.torque_b);
    belt_power += pair->contact.belt_power;
  }
  wall->force = vec3_sub((vec3){0, 0, 0}, all.force); /* and never -0 */
  wall->torque = vec3_sub((vec3){0, 0, 0}, all.moment);
  wall->power = scree_wall_power(wall, &all, belt_power);
  wall->work = scree_wall_work(world, w);
  wall->summed = world->step_count;
}

void scree_walls_settle(const scree_world *world) {
  for (size_t w = 0; w < world->walls.count; w++)
    if (world->walls.items[w].summed != world->step_count) scree_wall_sum(world, w);
}
