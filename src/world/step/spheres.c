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

static void add_loads(scree_spheres *s, scree_sphere_block *own, size_t end, uint32_t k,
                      const scree_sphere_load *on_a, const scree_sphere_load *on_b) {
  const scree_sphere_pair *pair = &s->list.pairs.items[k];
  add(&s->load[pair->a], on_a);
  if (pair->b < end)
    add(&s->load[pair->b], on_b);
  else
    s->shares.items[own->share_begin + own->shares++] = (scree_sphere_share){*on_b, pair->b};
}

static void step_alone(scree_world *world, scree_block block, uint32_t k) {
  scree_spheres *s = &world->spheres;
  scree_sphere_result r;
  if (!scree_sphere_pair_step(world, k, &r)) return;
  scree_note_pair(world, &s->blocks.tallies[block.index], &r.pair, &r.work);
  add_loads(s, &s->blocks.items[block.index], block.end, k, &r.on_a, &r.on_b);
}

/* Four pairs, in their order. */
static void step_four(scree_world *world, scree_block block, const uint32_t *k,
                      scree_sphere_lanes *four) {
  scree_spheres *s = &world->spheres;
  const unsigned taken = scree_sphere_lanes_step(world, k, four);
  for (int l = 0; l < SCREE_SPHERE_LANES; l++) {
    if (!(taken >> l & 1)) {
      step_alone(world, block, k[l]);
      continue;
    }
    scree_note_overlap(&s->blocks.tallies[block.index], four->overlap[l]);
    add_loads(s, &s->blocks.items[block.index], block.end, k[l], &four->on_a[l], &four->on_b[l]);
  }
}

static void step_block(void *context, scree_block block) {
  scree_world *world = context;
  scree_spheres *s = &world->spheres;
  const size_t begin = s->list.begin[block.begin];
  uint32_t *found = s->found.items + begin;
  const size_t count = find_due(world, begin, s->list.begin[block.end], found);
  s->blocks.tallies[block.index] = (scree_tally){.trouble = scree_no_trouble};
  s->blocks.items[block.index].shares = 0;
  scree_sphere_lanes four = {.law = {scree_none, scree_none, scree_none, scree_none}};
  const bool by_fours = scree_sphere_lanes_serve(world);
  for (size_t i = 0, width; i < count; i += width) {
    width = by_fours && i + SCREE_SPHERE_LANES <= count ? SCREE_SPHERE_LANES : 1;
    for (size_t k = i + AHEAD; k < i + AHEAD + width && k < count; k++) fetch_ahead(s, found[k]);
    if (width == 1)
      step_alone(world, block, found[i]);
    else
      step_four(world, block, found + i, &four);
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
