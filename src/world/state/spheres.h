/* Pairs of spheres have lists and contacts of their own: small ones, in the order of space.
 *
 * Spheres have places in that order (a curve of Morton's through their centres), which change only
 * when the lists are made. A pair belongs to the block of its first sphere. */
#pragma once

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SCREE_SPHERE_BLOCK = 4096 };                       /* spheres */
static const uint32_t scree_sphere_touches = 0x80000000u; /* of a pair's contact */

static const uint32_t scree_of_spheres = 0x80000000u; /* of a pair in a trouble */

/* Where a sphere is, and how it moves: copies, of the step. */
typedef struct scree_sphere_place {
  vec3 position;
  double radius;
} scree_sphere_place;
typedef struct scree_sphere_motion {
  vec3 velocity, spin, velocity_now, spin_now; /* as of a scree_frame */
} scree_sphere_motion;
/* Forces and torques of its contacts with spheres. */
typedef struct scree_sphere_load {
  vec3 force, torque;
} scree_sphere_load;
/* The same for a sphere of another block, by the place. */
typedef struct scree_sphere_share {
  scree_sphere_load load;
  uint64_t to;
} scree_sphere_share;

/* Two spheres that are near each other. */
typedef struct scree_sphere_pair {
  uint32_t a, b;    /* places, a before b */
  uint32_t contact; /* and whether they touch; scree_none: they never did since they are listed */
  uint32_t law;     /* of spheres.laws */
} scree_sphere_pair;

static inline bool scree_spheres_touch(const scree_sphere_pair *pair) {
  return pair->contact != UINT32_MAX && pair->contact & scree_sphere_touches;
}

/* What a contact remembers: two lines of the cache. In space; a's side of the normal is above. */
typedef struct scree_sphere_contact {
  vec3 slid;                  /* m, the tangential spring */
  double overlap;             /* m, of the last step */
  double largest;             /* m, or worked, J: as of a scree_pair */
  double dashpot, tangential; /* J, the books */
  double kick;                /* s, for which the last forces act; 0: there were none */
  /* For the second half of the last step's work: */
  float normal[3], damps; /* unit; N, of the dashpot along it */
  float rubs[3], springs; /* N, tangential; N, of the spring where its balance is drawn */
  float couple[3], age;   /* N m, of rolling on a; s, since the touch began */
  float rolled[3], spare; /* rad, the spring of rolling */
} scree_sphere_contact;

/* Who is near whom. There is another one, of before, in which what stays is looked up. */
typedef struct scree_sphere_list {
  size_t count, body_count; /* spheres; all bodies of then */
  uint32_t *body;           /* of each place */
  uint32_t *place_of;       /* of each body; scree_none */
  uint32_t *begin; /* of each place, where the pairs begin of which it is the first; count + 1 */
  struct {
    scree_sphere_pair *items;
    size_t count, capacity;
  } pairs; /* sorted by a, then b */
  struct {
    scree_sphere_contact *items;
    size_t capacity;
  } contacts; /* those of a block lie from where its pairs begin; there is room for all */
} scree_sphere_list;

/* The contacts of a block of spheres. */
typedef struct scree_sphere_block {
  uint32_t contacts;            /* how many there are */
  uint32_t share_begin, shares; /* where they begin, and those of the step */
} scree_sphere_block;

typedef struct scree_spheres {
  scree_sphere_list list, old;
  size_t capacity; /* of bodies */
  uint32_t *kind;  /* of each place: those of one kind have the same laws; see kind_count */
  scree_sphere_place *place;
  scree_sphere_motion *motion;
  scree_sphere_load *load;
  struct {
    scree_sphere_block *items;
    struct scree_tally *tallies;
    size_t count, capacity;
  } blocks;
  struct {
    uint32_t *items; /* scratch: pairs that touch or did, each block's from where its pairs begin */
    size_t capacity;
  } found;
  struct {
    scree_sphere_share *items; /* scratch: what goes to other blocks */
    size_t capacity;
  } shares;
  struct {
    uint32_t *items; /* for a device, whose threads gather: where the pairs of which each place is
                        the second begin, list.count + 2; then these, ascending */
    size_t count, capacity;
  } seconds;
  struct {
    struct scree_pair_law *items;
    size_t count, capacity;
  } laws; /* of kinds; where these are too many, of pairs */
} scree_spheres;
