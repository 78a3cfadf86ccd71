/* How far the surface is from the scan, as the reference surface stands for it: the scan itself or,
 * where it is large, one of its finest levels. Below, that is called the scan.
 *
 * Vertices of the scan that the surface has left are samples, each in the list of the triangle that
 * it is nearest to (after Klein, Liebich, Strasser, "Mesh reduction with error control", 1996). The
 * deviation of a collapse is the greatest distance, both ways, that the new triangles answer for:
 * of the samples around from these, and of the new vertex and the middles of the new edges from the
 * scan. */
#pragma once

#include "mesh/measure/extent.h"
#include "simplify/fan.h"

typedef struct scree_samples {
  scree_halfmesh scan; /* the reference surface, in the same box */
  scree_surface_tree scan_tree;
  scree_extent extent;               /* of the scan, in the frame of its least box */
  double weight[SCREE_EXTENT_COUNT]; /* of what is lost of the width along each direction */
  int8_t *end;                       /* per vertex of the scan: see scree_extent_end */
  uint32_t *of;                      /* per vertex of the surface: of the scan */
  uint32_t *first; /* per triangle of the surface: its farthest sample, the first of its list,
                      or NONE */
  float *worst;    /* per triangle: the greatest distance of its samples */
  uint32_t *next;  /* per vertex of the scan: in its triangle's list */
  float *far;      /* the same: its distance from its triangle; below 0: no sample yet */
  double mean;     /* of the samples' distances, when it was last found */
  size_t count;    /* of them then */
  bool borrows;    /* the scan, its tree and its ends are another's */
} scree_samples;

/* Samples about one collapse: scratch of one thread. */
typedef struct scree_gathered {
  struct scree_sample {
    uint32_t sample, start; /* start: of the fan's triangles the one to look at first */
    float far;              /* while they are thinned */
  } * items;
  size_t count, capacity;
} scree_gathered;

static inline bool scree_has_samples(const scree_samples *samples) {
  return samples->far != NULL;
}

/* With the reference surface set, its area too, finds its tree and its extent. */
scree_status scree_samples_start(scree_samples *samples, scree_error *error);
/* Makes samples of all its vertices that the surface, whose tree is tight, has left. */
scree_status scree_samples_find(const scree_halfmesh *surface, const scree_surface_tree *tree,
                                scree_samples *samples, scree_error *error);
/* A copy for a squeezed surface, which borrows the scan; to be freed also where it fails. */
scree_status scree_samples_copy(const scree_samples *samples, const scree_halfmesh *surface,
                                scree_samples *copy, scree_error *error);
void scree_samples_free(scree_samples *samples);

/* Finds the mean anew; in parallel, the same bits for any number of threads. */
scree_status scree_samples_average(scree_samples *samples, scree_error *error);

/* Before the surface is squeezed (scree_halfmesh_compact): so are the lists. */
void scree_samples_compact(scree_samples *samples, const scree_halfmesh *surface);

/* At most about the deviation of the fan as it is set, at little cost: what the worst sample around
 * is off, and how high the new vertex is above the triangles there. */
double scree_deviation_bound(const scree_samples *samples, const scree_halfmesh *s,
                             const scree_fan *fan);

/* A sample so far from the surface, as a deviation: that or, where it is an end of the scan, what
 * is lost of the width there. */
double scree_deviation_of(const scree_samples *samples, uint32_t sample, double far);

/* What a vertex there adds to the scan's widths, as a deviation: to become wider by a share counts
 * alike, in whichever direction. A flat body packs by its thickness. */
double scree_deviation_growth(const scree_samples *samples, const scree_halfmesh *s, vec3 at);

/* The deviation; below `from` it need not be exact, above `to` a lower bound. */
double scree_deviation_find(const scree_samples *samples, const scree_halfmesh *s,
                            const scree_fan *fan, double from, double to);

/* The samples of the fan's triangles and of those that go, and the vertices of the scan that its
 * vertices will leave. False: out of memory. */
bool scree_samples_gather(const scree_samples *samples, const scree_halfmesh *s,
                          const scree_fan *fan, scree_gathered *gathered);

/* What was gathered goes to the nearest of the fan's triangles as it is set. Touches only these
 * triangles' lists. */
void scree_samples_settle(scree_samples *samples, const scree_fan *fan,
                          const scree_gathered *gathered);

/* Before the fan collapses: its samples are gathered, thinned and settled. False: out of memory. */
bool scree_samples_move(scree_samples *samples, const scree_halfmesh *s, const scree_fan *fan,
                        scree_gathered *scratch);
