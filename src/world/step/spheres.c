/* Contacts of spheres: found by distance, and summed at once.
 *
 * A block of spheres has the pairs of which they are the first. It adds forces to its own in the
 * order of the pairs; those on spheres of later blocks wait, and are added after all blocks are
 * done, in their order. So each sphere's forces come in one order, whatever the threads. */
#include "world/contact/spheres.h"
#include "world/step/stages.h"

#include "base/parallel.h"

#include <stddef.h>

enum { AHEAD = 8, LOAD_BLOCK = 256 };

static void load_block(void *context, scree_block block) {
  scree_world *world = context;
  const uint32_t *body = world->spheres.list.body;
  for (size_t i = block.begin; i < block.end; i++) {
    if (i + AHEAD < block.end)
      scree_prefetch(&world->bodies.frame[body[i + AHEAD]], offsetof(scree_frame, rotation));
    scree_spheres_load(world, i);
  }
}

static void add(scree_sphere_load *to, const scree_sphere_load *load) {
  to->force = vec3_add(to->force, load->force);
  to->torque = vec3_add(to->torque, load->torque);
}

/* Without branches: which pairs touch is as good as random. */
static size_t find_due(const scree_world *world, size_t begin, size_t end, uint32_t *found) {
  size_t count = 0;
  for (size_t k = begin; k < end; k++) {
    found[count] = (uint32_t)k;
    count += scree_sphere_pair_is_due(world, &world->spheres.list.pairs.items[k]);
  }
  return count;
}

SCREE_PREFETCHES void fetch_ahead(const scree_spheres *s, uint32_t k) {
  const scree_sphere_pair *pair = &s->list.pairs.items[k];
  if (pair->contact != scree_none)
    scree_prefetch(&s->list.contacts.items[pair->contact & ~scree_sphere_touches],
                   sizeof *s->list.contacts.items);
  scree_prefetch(&s->motion[pair->b], sizeof *s->motion);
  scree_prefetch(&s->load[pair->b], sizeof *s->load);
}

static void step_block(void *context, scree_block block) {
  scree_world *world = context;
  scree_spheres *s = &world->spheres;
  scree_sphere_block *own = &s->blocks.items[block.index];
  scree_tally *tally = &s->blocks.tallies[block.index];
  const size_t begin = s->list.begin[block.begin];
  uint32_t *found = s->found.items + begin;
  const size_t count = find_due(world, begin, s->list.begin[block.end], found);
  *tally = (scree_tally){.trouble = scree_no_trouble};
  own->shares = 0;
  for (size_t i = 0; i < count; i++) {
    const scree_sphere_pair *pair = &s->list.pairs.items[found[i]];
    scree_sphere_result r;
    if (i + AHEAD < count) fetch_ahead(s, found[i + AHEAD]);
    if (!scree_sphere_pair_step(world, found[i], &r)) continue;
    scree_note_pair(world, tally, &r.pair, &r.work);
    add(&s->load[pair->a], &r.on_a);
    if (pair->b < block.end)
      add(&s->load[pair->b], &r.on_b);
    else
      s->shares.items[own->share_begin + own->shares++] = (scree_sphere_share){r.on_b, pair->b};
  }
}

void scree_step_spheres(scree_world *world) {
  scree_spheres *s = &world->spheres;
  const size_t count = s->list.pairs.count ? s->list.count : 0;
  scree_parallel_for(count, LOAD_BLOCK, load_block, world);
  scree_parallel_for(count, SCREE_SPHERE_BLOCK, step_block, world);
  for (size_t block = 0; block < s->blocks.count; block++) {
    const scree_sphere_block *own = &s->blocks.items[block];
    for (uint32_t i = 0; i < own->shares; i++) {
      const scree_sphere_share *share = &s->shares.items[own->share_begin + i];
      add(&s->load[share->to], &share->load);
    }
  }
}
