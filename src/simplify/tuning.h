/* All numbers of the method that were found by trying, with unit and reason. None depends on how
 * many triangles the scan has. */
#pragma once

/* What the guards allow is given three times: when no edge is left that they allow, the next is
 * taken. Cosines are of angles between normals. */
enum { SCREE_LENIENCIES = 3 };

typedef struct scree_tuning {
  /* cost */
  double stiff; /* share of the trace of H below which a direction is free: there the vertex stays
                   in the middle of its edge. Above rounding, below what a real crease has. */
  double tie;   /* weight of the edge's squared length times the trace of H in the cost: orders what
                   costs nothing, short edges first. Far below the cost of what changes a shape. */
  double drift; /* weight of area times deviation^4 in the cost: the deviation begins to count at a
                   tenth of the size of the triangles, and soon decides. */
  double usual; /* deviations of so many mean ones add as much as a usual collapse costs. */
  double grow;  /* to become wider or narrower by a share counts as a distance of so many times
                   that share of the size: more than the tolerances ask, 3 % of a width at both ends
                   and 4 % of the size, for what has become of a width is never made good. */
  double heed;  /* share of the cost below which the deviation's part is not looked for. */
  /* guards */
  double turn[SCREE_LENIENCIES];  /* least cosine of the turn of a normal: 84, 107, 134 degrees */
  double fold[SCREE_LENIENCIES];  /* least cosine over a new edge: 120, 135 and 149 degrees */
  double shape[SCREE_LENIENCIES]; /* height over longest edge; below it at most half is lost */
  double spike; /* of sqrt(area / triangles): so far beyond the scan's box a vertex may come */
  /* order */
  double batch;   /* share of the vertices whose cheapest edge a pass may take: more, and the order
                     of the costs is lost; less, and each pass finds them all for little. */
  double shift;   /* the most that another order than the first adds to the cost of an edge, as a
                     share: far below what the noise of a scan changes it by. */
  double expect;  /* share of what deviations added to an edge's cost that is expected to stay when
                     something beside it changes: with all of it edges wait too long and counts
                     rise, with none twice as many are judged. */
  double refresh; /* share of the triangles after which costs, boxes and what is usual are found
                     anew. */
  /* samples */
  int crowd; /* of a triangle, above which they are thinned: enough to tell its distance */
  /* fit */
  int sweeps;  /* over all vertices; more gain little */
  double hold; /* share of the trace that holds a vertex where it is: it may slide nowhere without
                  reason. */
  double near; /* of the mean distance: nearer samples weigh no more than these */
} scree_tuning;

static const scree_tuning scree_tune = {.stiff = 1e-5,
                                        .tie = 1e-9,
                                        .drift = 5,
                                        .usual = 12,
                                        .grow = 4,
                                        .heed = 0.1,
                                        .turn = {0.1, -0.3, -0.7},
                                        .fold = {-0.5, -0.7071, -0.857},
                                        .shape = {0.05, 0.01, 0},
                                        .spike = 0.5,
                                        .batch = 0.5,
                                        .shift = 0.02,
                                        .expect = 0.5,
                                        .refresh = 0.75,
                                        .crowd = 48,
                                        .sweeps = 3,
                                        .hold = 0.02,
                                        .near = 0.2};

enum {
  /* The reference surface has no more triangles: what lies below is far less than any deviation of
   * a level that is asked for, and larger scans take hardly more time and memory. */
  SCREE_REFERENCE_MOST = 50000,
  /* Down to so many triangles edges are ranked by passes; below, anew after each collapse, which is
   * better, and takes a second. */
  SCREE_PASS_LEAST = 16384,
  /* Below so many triangles a curve may go on in several orders: well above what is chosen, so that
   * they part in time. */
  SCREE_FORK_MOST = 7000
};
