/* A slow decimator's knowledge of a surface: what the tests of the decimation compare the engine
 * with (unit/simplify_oracle.c). It knows a list of triangles and nothing else; everything is
 * computed from it anew. */
#ifndef SCREE_TEST_ORACLE_H
#define SCREE_TEST_ORACLE_H

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What the rules name (docs/decimation.md). */
#define STAND_OFF    0.5
#define EQUALLY_NEAR 1e-12
#define EDGE_PARTS   6
#define RELAX_GAIN   1e-2

enum { BEST = 0, FALLBACK = 1, OUT = 4, STATES = 7, IN_DOUBT = 8 };

typedef struct oracle {
  size_t vertex_count, triangle_count;
  vec3 *position;
  uint32_t *triangle;
  bool qecd, batched;
  vec3 *plane; /* of the first mesh's triangles: unit normal */
  double *offset, *weight;
  size_t plane_count;
  uint16_t *share; /* vertex_count * plane_count: how often the plane counts at the vertex */
  uint8_t *state;  /* vertex_count^2, lower vertex first */
  double *start;   /* corners of the first mesh's triangles, 9 each, and their area */
  double start_area;
  vec3 *witness;    /* the first mesh's vertices */
  uint32_t *holder; /* of each witness: the triangle that stands for it, and its squared distance */
  double *held2;
  double farthest; /* the distance of the farthest place when it was last found */
  size_t far_at;   /* triangles at which it is found anew */
  double toll;     /* weight of the stray's sixth power */
  size_t renew_at; /* triangles at which it is found anew */
  double *whole;   /* as state, for every place: the whole cost, or NAN where it is not known yet */
  size_t moved, taken; /* moves of the record that were checked; of these, in any order */
  size_t exchanged;    /* pairs that moved together */
  bool parted, looks_ahead;
  size_t weighed;           /* choices of which every offer was done */
  size_t compared, decided; /* collapses, and those with no rival within rounding */
} oracle;

typedef struct place {
  vec3 target;
  double cost, error, slack; /* slack: what rounding may change in the cost */
  double stray;              /* weight of the stray's fourth power, not in the cost yet */
  vec3 other; /* where the rule between two places is within rounding: the other, else target */
} place;

/* ---- Collapses: oracle_collapse.c ---- */

vec3 oracle_corner(const oracle *o, size_t t, size_t i);
bool oracle_has(const oracle *o, size_t t, uint32_t v);
vec3 oracle_area_vector(const oracle *o, size_t t);
/* Solves the n x n system in place, with pivots. */
void oracle_solve(double m[4][5], int n);
void oracle_add_square(double m[4][5], vec3 n, double rhs, double w);
place oracle_place_of(const oracle *o, uint32_t a, uint32_t b, int fallback);
/* The mesh with the edge collapsed; triangles keep their numbers, those that go become 0 0 0. */
oracle oracle_collapsed(const oracle *o, uint32_t a, uint32_t b, vec3 x);
bool oracle_gone(const oracle *o, size_t t);
/* Edges with a fold, over all pairs of triangles that share one, of which one is `touched`. */
int oracle_folds(const oracle *o, const bool *touched);
/* Pairs that meet beyond what they share, of which one is touched. */
int oracle_meetings(const oracle *o, const bool *touched);
bool oracle_triangles_stay_sound(const oracle *o, const oracle *after, uint32_t a, uint32_t b);
/* The squared distance from the first mesh. */
double oracle_start_distance2(const oracle *o, vec3 x);
bool oracle_may_collapse(const oracle *o, uint32_t a, uint32_t b, vec3 x);
double oracle_triangle_distance2(const oracle *o, size_t t, vec3 p);
/* The squared distance of p from the triangles of a after the collapse; *nearest: of those that are
 * nearest the largest, of the largest the first. */
double oracle_patch_distance2(const oracle *after, uint32_t a, vec3 p, uint32_t *nearest);
/* Squared, of the collapse of (a, b) to x. */
double oracle_stray2_of(const oracle *o, uint32_t a, uint32_t b, vec3 x);

/* Does it; of the witnesses around, which triangle holds them. */
void oracle_apply(oracle *o, uint32_t a, uint32_t b, vec3 x);
/* The same of a move. */
void oracle_apply_move(oracle *o, uint32_t v, vec3 x);

/* ---- Moves after a collapse: oracle_move.c ---- */

/* Two vertices that take over volume from each other. */
typedef struct pair {
  uint32_t v[2];
  vec3 step[2];
  double sum, gain; /* before; of it, by the exchange */
} pair;

/* Of the witnesses of v's triangles, each from the triangle that it is held by now, or where it was
 * on the surface from the nearest of v's: the sum of the squared distances, and the largest
 * distance, also of v and of places on its edges, if asked for. */
double oracle_off_around(const oracle *o, uint32_t v, double *worst);
/* Whether the engine was right to leave vertex v, or to move it to *x. */
void oracle_check_move(const oracle *o, uint32_t v, const vec3 *x);
/* From how the pressures fall with the volume taken over; that which makes them the same. */
bool oracle_find_pair(const oracle *o, uint32_t v, uint32_t w, pair *p);
/* Whether the engine was right to leave the pair, or to move it to x. */
void oracle_check_pair(const oracle *o, const pair *p, bool sure, const vec3 *x);
/* The pair about vertex a that gains most, if any is worth it; *second: the gain of the next. */
pair oracle_best_pair(const oracle *o, uint32_t a, double *second);
/* The corner of the triangle that has the side from v to w; NONE: there is none. */
uint32_t oracle_beyond_side(const oracle *o, uint32_t v, uint32_t w);
/* The neighbour of v that is farthest from it; *alone: by more than rounding. */
uint32_t oracle_farthest_neighbour(const oracle *o, uint32_t v, bool *alone);
/* Finds the farthest place of the level anew, if it is time. */
void oracle_renew_farthest(oracle *o);
/* What the engine should do: where vertex v moves, if it does; where the two move that gain most
 * about a. *sure becomes false where rounding decides. */
bool oracle_find_move(const oracle *o, uint32_t v, vec3 *x, bool *sure);
bool oracle_find_exchange(const oracle *o, uint32_t a, pair *p, vec3 *x, bool *sure);

/* ---- Looking ahead: oracle_ahead.c ---- */

/* The distance of the farthest of all witnesses, vertices and places on edges. */
double oracle_farthest(const oracle *o);
/* The mean distance of the witnesses times the cube root of the greatest: of what the level had and
 * what is around the new vertex, once (a, b) has collapsed to x. */
double oracle_score_alone(const oracle *o, uint32_t a, uint32_t b, vec3 x);
/* The mean distance of the witnesses times the cube root of the farthest of all, once (a, b) has
 * collapsed to x and the vertices about it have moved. */
double oracle_score_after(const oracle *o, uint32_t a, uint32_t b, vec3 x, bool *sure);

#endif
