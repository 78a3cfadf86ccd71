/* What is kept of a contact from step to step.
 *
 * A step of two that are awake writes it in this order. contact.c enters the second half of the
 * last step's work (`book`), finds how the two move (`list`), and has lists made anew where they
 * end. narrow.c and edges.c find the contacts of the `active` feature pairs, depth.c how deep edges
 * lie inside, where that is asked (`depth`, depenetrating, apart.found). From these law.c makes the
 * force: anchors and `history` go on, `contact` is what comes of it, of which the bodies read the
 * wrench, and `book` what the next step needs for the energies. watch.c looks whether one has come
 * through the other. Where the step is too long for the two, substep.c goes through these stages
 * again with its own steps, and keeps in `substeps` what the bodies have not had yet. */
#pragma once

#include "particle/particle.h"

/* Force on a and its moment about the centre of b. */
typedef struct scree_wrench {
  vec3 force, moment;
} scree_wrench;

/* What a touching feature remembers: the anchored tangential spring. */
typedef struct scree_anchor {
  vec3 stretch;  /* xi, in the frame of b */
  vec3 normal;   /* of the last step, in the frame of b */
  double weight; /* of the last step; 0: no memory */
} scree_anchor;

typedef enum scree_feature_kind {
  SCREE_FEATURE_POINT_FACE,  /* point of a, surface of b */
  SCREE_FEATURE_FACE_POINT,  /* surface of a, point of b */
  SCREE_FEATURE_EDGE_EDGE,   /* edge of a, edge of b */
  SCREE_FEATURE_POINT_POINT, /* spheres */
  SCREE_FEATURE_POINT_WALL,  /* point of a, analytic wall */
} scree_feature_kind;

/* A feature pair that cannot touch before the pair's path reaches `wake`. */
typedef struct scree_sleeping_feature {
  double wake;
  uint32_t a, b;
  uint32_t kind;
} scree_sleeping_feature;

enum { SCREE_CACHED_FACES = 4, SCREE_ANCHORS = 3 };

/* Whether the closest points of two edges lie within both. */
typedef enum scree_crossing {
  SCREE_CROSSING_NONE,
  SCREE_CROSSING_COUNTS,
  SCREE_CROSSING_REFUSED, /* which way it is out is not known */
} scree_crossing;

/* A feature pair that is evaluated every step: two cache lines. */
typedef struct scree_feature_pair {
  uint8_t kind;
  bool has_reference, inside;
  bool notched; /* it has further anchors */
  uint32_t a, b;
  union {
    struct {              /* of a point: */
      uint8_t face_count; /* cached nearest faces */
      int8_t side;        /* of a sheet: 1 where its normals point, -1, or 0: not known */
      uint16_t sheet;     /* of the side */
    };
    uint32_t crossing; /* of edges: a scree_crossing, of the last step */
  };
  uint32_t face[SCREE_CACHED_FACES];
  union {
    double valid; /* of a point: path up to which no other face can be nearer */
    double held;  /* of edges: overlap that does not count (edges.c) */
  };
  vec3 reference; /* the separation direction, kept from the last time the cores were apart */
  double gap;     /* found in this step; 0: stay awake */
  scree_anchor anchor;
} scree_feature_pair;

/* The anchors of a point in a notch beyond the first: few feature pairs ever read them. */
typedef struct scree_further {
  scree_anchor anchor[SCREE_ANCHORS - 1];
} scree_further;

/* Force and torques about the centres of a and b (about its position for a wall), on a and on b;
 * the force on b is the opposite. */
typedef struct scree_pair_wrench {
  vec3 force, torque_a, torque_b;
} scree_pair_wrench;

/* A load in space as the ledger keeps it from one step to the next: the bodies do not feel its
 * rounding. */
typedef struct scree_kept_wrench {
  float force[3], moment[3];
} scree_kept_wrench;

static inline scree_wrench scree_kept_as_wrench(const scree_kept_wrench *kept) {
  const float *f = kept->force, *m = kept->moment;
  return (scree_wrench){{f[0], f[1], f[2]}, {m[0], m[1], m[2]}};
}

/* What follows of the two bodies' sizes, masses and materials. */
typedef struct scree_pair_law {
  double stiffness, damping, friction; /* K, C, mu */
  double smoothing, reach, limit;      /* l0; rounding of both meshes; overlap limit */
  double thin;                         /* the limit, or half the thinnest wall where less */
  double contact_time;                 /* half period pi sqrt(m/K) */
  double restitution;                  /* e */
  double pull;                         /* N, with which they hold each other */
  double rolling, rolling_damping; /* of spheres mu_r R, m, and torque over angular velocity; of all
                                      else mu_r */
  double hertz,
      mindlin; /* 4/3 E* R*^1/2 and 8 G* R*^1/2, N/m^3/2; 0: K holds. Else K is that of a
                  linear contact as long as one that begins at 1 m/s, and C is over m^1/4 */
} scree_pair_law;

/* How far the list of feature pairs lasts; the pair has it while awake, its neighbours while
 * asleep. */
typedef struct scree_list_state {
  double travel, path;      /* of the relative motion: last step, and sum; upper bounds */
  double next_feature, end; /* on path */
  vec3 region; /* ball in the frame of b that holds what the list is about, until it ends */
  double region_radius; /* 0: none */
  double eased;         /* m, overlap that does not count: of two that were joined; it only falls */
} scree_list_state;

/* Places [first, first + count) of a pool; there is room for `capacity`. */
typedef struct scree_range {
  uint32_t first, count, capacity;
} scree_range;

/* What watch.c knows of a pair. */
typedef struct scree_watch {
  double due;      /* on the list's path: the next look */
  vec3 at;         /* a in the frame of b when it was last looked at, */
  float turned[4]; /* and its orientation */
  float came[3];   /* unit, in the frame of the surface: from where what is through came */
  float speed;     /* m/s, before the two met */
  float since;     /* s, since when something is through */
  uint8_t through[SCREE_INNER_PLACES]; /* how many faces each inner place is through */
  bool taken;                          /* the pair was looked at */
} scree_watch;

/* What geometry and law found in the last step. */
typedef struct scree_pair_contact {
  scree_pair_wrench wrench;           /* the bodies read it */
  double overlap;                     /* m */
  double elastic, tangential_elastic; /* U of all springs, and of the tangential ones, J */
  float belt_power; /* W, of a belt's friction on a, by the belt's motion along itself */
  uint32_t count;   /* of features that press */
} scree_pair_contact;

/* What a contact remembers beside its anchors, from when it began. */
typedef struct scree_contact_history {
  double age; /* s */
  union {
    double largest; /* m, overlap: hysteresis */
    double worked;  /* J, by the spring: the other laws */
  };
  vec3 rolled; /* the spring of rolling resistance: of spheres, rad, in space; else m, on the arm on
                  which they roll, in the frame of b */
} scree_contact_history;

/* What the energy book needs of one step in the next. */
typedef struct scree_work_book {
  double kick; /* s, for which the last wrench acts; 0: there was none */
  scree_wrench spring;
  scree_kept_wrench dashpot, tangential;  /* parts of the wrench */
  double later_dashpot, later_tangential; /* J of the last step's sub-steps, not yet entered */
} scree_work_book;

/* Of spheres: the tangential spring, m, in space; on which side they are of a sheet. */
typedef struct scree_sphere_memory {
  vec3 slid;
  double side;
} scree_sphere_memory;

/* How two that lie in each other are moved apart, in the frame of b. */
typedef struct scree_separation {
  vec3 direction; /* of a; 0: not yet */
  double found;   /* m, how deep they were when it was last looked for */
  vec3 place;     /* where a is pushed */
} scree_separation;

enum { SCREE_MOST_SUBSTEPS = 16 };

/* What a pair that moves its bodies in steps of its own carries over (substep.c). */
typedef struct scree_pair_substeps {
  uint8_t count; /* of the last step */
  bool followed; /* the wrench is a mean over those, or holds what is `owed`: `ahead` counts */
  float elastic_since;         /* J, by which `elastic` has grown since the step began */
  scree_pair_wrench owed;      /* impulses and their moments of the last step's */
  scree_pair_wrench ahead;     /* impulses: what the motion at the step's beginning has more than
                                  the mean */
  scree_kept_wrench others[2]; /* on a and on b, before the last step's */
  double foreseen;             /* J, of the spring by them */
} scree_pair_substeps;

/* A pair that is awake. What every step touches comes first, and of that what spheres need. Pairs
 * lie together, apart from what is kept of those asleep: a step comes to one pair of neighbours in
 * five, and each would lie on a page of its own. */
typedef struct scree_pair {
  _Alignas(64) uint32_t a;
  uint32_t b;
  bool wall;    /* b is a wall */
  bool spheres; /* as of the neighbours */
  bool asleep; /* no feature pair can touch before the bodies' paths reach the neighbours' `wake` */
  bool touching;
  bool depenetrating, was_depenetrating; /* is moved apart (law.c); was, until the last step */
  uint32_t neighbours;                   /* index */
  scree_range active;                    /* in the pool of feature pairs */
  scree_pair_contact contact;
  scree_pair_law law;
  scree_contact_history history;
  scree_work_book book;
  union {
    scree_sphere_memory sphere; /* of spheres */
    scree_separation apart;     /* of others */
  };
  scree_list_state list;
  double depth; /* m: no edge lies deeper inside the other body; -INFINITY: not known */
  scree_pair_substeps substeps;
  scree_watch watch;
} scree_pair;

/* Two bodies, or a body and a wall, whose boxes are near each other: what is kept of them while
 * they are asleep. */
typedef struct scree_neighbours {
  uint32_t a, b;
  bool wall;
  bool spheres; /* two spheres, or one and a plane, disc or cylinder: spheres.c */
  bool asleep;  /* else awake, or new */
  scree_list_state list;
  double wake, asleep_since; /* on path[a] + path[b] */
  vec3 asleep_at;            /* a in the frame of b when they fell asleep */
  quat asleep_turned;
  scree_range sleeping; /* in the pool of sleeping feature pairs; awake or not */
  scree_pair_law law;
} scree_neighbours;
