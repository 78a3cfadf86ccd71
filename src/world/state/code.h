/* The fields of a checkpoint's records, in order: one list a record, for saving and loading. */
#pragma once

#include "base/seal.h"
#include "world/state/world.h"

extern const scree_seal scree_world_seal;

/* A record of real numbers alone, in the order of its fields. */
#define CODE_REALS(codec, record)                                                                  \
  scree_code_reals(codec, (double *)(record), sizeof *(record) / sizeof(double))

/* Such records one after another. */
#define CODE_EACH(codec, type, ...)                                                                \
  do {                                                                                             \
    type *const each[] = {__VA_ARGS__};                                                            \
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) CODE_REALS(codec, each[i]);            \
  } while (0)

void scree_code_options(scree_codec *c, scree_world_options *o);
void scree_code_measures(scree_codec *c, scree_particle_measures *m);
void scree_code_mesh(scree_codec *c, scree_mesh *mesh);
void scree_code_given_wall(scree_codec *c, scree_wall *w);
void scree_code_wall_motion(scree_codec *c, scree_motion_state *m);
void scree_code_wall_state(scree_codec *c, scree_world_wall *w);
void scree_code_feature(scree_codec *c, scree_feature_pair *i, scree_further *further);
void scree_code_sleeping(scree_codec *c, scree_sleeping_feature *s);
void scree_code_pair_name(scree_codec *c, scree_neighbours *n);
void scree_code_pair_state(scree_codec *c, scree_pair *p, scree_neighbours *n);
void scree_code_sphere_pair(scree_codec *c, scree_sphere_pair *two, scree_sphere_contact *contact);
void scree_code_body(scree_codec *c, const scree_world *world, size_t body);

/* What the world counts, and how it ended. */
typedef struct scree_world_tail {
  double time, time_step, largest_overlap, margin;
  uint64_t step_count, depenetration_count;
  bool pairs_stale, time_step_stale, diverged;
  uint32_t failure;
  char message[sizeof((scree_error *)0)->message];
} scree_world_tail;
void scree_code_tail(scree_codec *c, scree_world_tail *t);
void scree_code_hardening(scree_codec *c, scree_hardening *h);
/* How many of materials.hardened count: those of the materials that there are. */
static inline size_t scree_hardening_count(const scree_world *world) {
  return world->materials.count * (world->materials.count + 1) / 2;
}
