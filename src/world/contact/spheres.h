/* Pairs of two spheres, or of a sphere and a plane, disc or cylinder. */
#pragma once

#include "world/state/scratch.h"

/* Neighbours k, a sphere and a wall, have no pair: whether they need none in this step, being
 * apart; then they sleep. */
bool scree_spheres_stay_apart(scree_world *world, size_t k);
/* The whole of a pair's step, as scree_pair_evaluate; `contact` (may be NULL) is what touches. */
void scree_spheres_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                            scree_contact_point *contact);

/* ---- two spheres (state/spheres.h) ---- */

/* Copies of the state of the sphere at this place. */
void scree_spheres_load(scree_world *world, size_t place);
/* Whether a pair touches, or did. */
static inline bool scree_sphere_pair_is_due(const scree_world *world,
                                            const scree_sphere_pair *two) {
  if (scree_spheres_touch(two)) return true;
  const scree_sphere_place *a = &world->spheres.place[two->a], *b = &world->spheres.place[two->b];
  const double reach = a->radius + b->radius;
  return vec3_norm2(scree_nearest_image(world, vec3_sub(a->position, b->position))) < reach * reach;
}
typedef struct scree_sphere_result {
  scree_sphere_load on_a, on_b;
  scree_pair pair; /* as after the step */
  scree_pair_work work;
} scree_sphere_result;
/* The step of pair k; false where they are apart, which has no result. */
bool scree_sphere_pair_step(scree_world *world, size_t k, scree_sphere_result *result);

/* lanes.c: four pairs in hand, which share what is read of their laws with those before. */
enum { SCREE_SPHERE_LANES = 4 };
typedef struct scree_sphere_lanes {
  uint32_t law[SCREE_SPHERE_LANES]; /* whose members follow; scree_none: of no pair yet */
  double stiffness[SCREE_SPHERE_LANES], damping[SCREE_SPHERE_LANES], slides[SCREE_SPHERE_LANES],
      slides_ratio[SCREE_SPHERE_LANES], friction[SCREE_SPHERE_LANES], limit[SCREE_SPHERE_LANES],
      thin[SCREE_SPHERE_LANES], contact_time[SCREE_SPHERE_LANES], pull[SCREE_SPHERE_LANES],
      rolling[SCREE_SPHERE_LANES], rolling_damping[SCREE_SPHERE_LANES];
  double overlap[SCREE_SPHERE_LANES]; /* m, after the step */
  scree_sphere_load on_a[SCREE_SPHERE_LANES], on_b[SCREE_SPHERE_LANES];
} scree_sphere_lanes;
/* Whether this processor and the world's law have such steps. */
bool scree_sphere_lanes_serve(const scree_world *world);
/* The step of the four pairs k, as of each alone; a bit for each for which it was taken. Of the
 * others, which begin, end or are hardened, nothing is changed. */
unsigned scree_sphere_lanes_step(scree_world *world, const uint32_t k[SCREE_SPHERE_LANES],
                                 scree_sphere_lanes *four);
/* For a device: what acts on the sphere at this place, in the order in which step/spheres.c adds
 * it; on both of each pair. */
void scree_spheres_gather(scree_world *world, size_t place, const scree_sphere_load (*loads)[2]);
/* For whoever looks at pair k: as a pair of neighbours would be after the last step. */
scree_pair scree_sphere_pair_of(const scree_world *world, size_t k);
