#include "simplify/guard/apart.h"

#include "simplify/tuning.h"

/* Height over longest edge, below which a triangle has no area but that of rounding. */
#define FLAT 1e-9

/* The worst of a set of triangles and of the edges between them. */
typedef struct worst {
  double shape; /* least height over longest edge */
  double fold;  /* least cosine over an edge */
  int folds;    /* edges with less than the strictest cosine */
  int flats;    /* triangles without area */
} worst;

static double cosine(vec3 n, vec3 m) {
  double l = sqrt(vec3_norm2(n) * vec3_norm2(m));
  return l > 0 ? vec3_dot(n, m) / l : 1;
}

static void take_shape(worst *w, vec3 n, vec3 a, vec3 b, vec3 c) {
  double l2 = scree_larger(vec3_norm2(vec3_sub(b, a)),
                           scree_larger(vec3_norm2(vec3_sub(c, b)), vec3_norm2(vec3_sub(a, c))));
  double shape = l2 > 0 ? vec3_norm(n) / l2 : 0;
  w->shape = scree_smaller(w->shape, shape);
  w->flats += shape < FLAT;
}

static void take_fold(worst *w, vec3 n, vec3 m) {
  double fold = cosine(n, m);
  w->fold = scree_smaller(w->fold, fold);
  w->folds += fold < scree_tune.fold[SCREE_LENIENCIES - 1];
}

static bool is_next(const scree_halfmesh *s, const scree_fan *f, uint32_t i, uint32_t j) {
  return i != j && scree_to(s, f->edge[i]) == s->half[f->edge[j]].from;
}

static uint32_t beyond(const scree_halfmesh *s, const scree_fan *f, uint32_t i) {
  return s->half[f->edge[i]].twin;
}

/* The worst of what is there: every edge of the fan's triangles and of those that go. */
static worst before(const scree_halfmesh *s, const scree_fan *f) {
  worst w = {.shape = 1, .fold = 1};
  vec3 at[3];
  for (uint32_t k = 0; k < scree_fan_triangle_count(f); k++) {
    uint32_t t = scree_fan_triangle(s, f, k);
    vec3 n = scree_normal_of(s, t);
    scree_corners(s, t, at);
    take_shape(&w, n, at[0], at[1], at[2]);
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
      uint32_t twin = s->half[h].twin;
      /* between two of them each edge once */
      bool inner = k >= f->count || h != f->edge[k];
      if (twin != SCREE_NONE && !(inner && twin < h))
        take_fold(&w, n, scree_normal_of(s, twin / 3));
    }
  }
  return w;
}

bool scree_shape_allows(const scree_halfmesh *s, const scree_fan *f, int leniency) {
  worst after = {.shape = 1, .fold = 1};
  for (uint32_t i = 0; i < f->count; i++) {
    vec3 n = f->after[i];
    if (cosine(n, f->before[i]) < scree_tune.turn[leniency]) return false;
    take_shape(&after, n, f->at, f->from[i], f->to[i]);
    uint32_t j = i + 1 < f->count ? i + 1 : 0;
    if (is_next(s, f, i, j)) take_fold(&after, n, f->after[j]);
    if (beyond(s, f, i) != SCREE_NONE)
      take_fold(&after, n, scree_normal_of(s, beyond(s, f, i) / 3));
  }
  double shape = scree_larger(scree_tune.shape[leniency], FLAT), fold = scree_tune.fold[leniency];
  if (after.fold >= fold && after.shape >= shape) return true;
  worst was = before(s, f);
  return after.folds <= was.folds && after.flats <= was.flats &&
         after.fold >= scree_smaller(fold, was.fold) &&
         after.shape >= scree_smaller(shape, 0.5 * was.shape);
}

bool scree_shape_is_spike(const scree_halfmesh *s, vec3 x) {
  double room = scree_tune.spike * sqrt(s->area / (double)s->live_triangle_count);
  return !(x.x >= s->low.x - room && x.y >= s->low.y - room && x.z >= s->low.z - room &&
           x.x <= s->high.x + room && x.y <= s->high.y + room && x.z <= s->high.z + room);
}
