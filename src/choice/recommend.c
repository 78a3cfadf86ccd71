/* The load of a level is its largest error over its tolerance. Of the usual levels the coarsest
 * that keeps all tolerances and the next enclose the level sought. They are narrowed by halves
 * until a level that keeps all is next to one that does not.
 *
 * What is found is measured once more with many more points than the sweep's, so that the answer
 * holds for a measurement by others. Where it does not keep all by that, levels finer by 1, 2, 4
 * collapses and so on are measured with as many points until one does, and halves narrow what lies
 * between. */
#include "choice/recommend.h"
#include "choice/fidelity.h"

#include "base/alloc.h"
#include "base/owned.h"
#include "simplify/curve.h"

enum { DENSE_POINTS = 40000 };
/* Levels are made from one of so many triangles, in place of the scan. */
enum { TAIL_COUNT = 4 * SCREE_FIDELITY_FINEST };
/* Where a level is known, coarser ones are looked for down to this share of its triangles. */
enum { FEWER = 2 };
static const double DENSE_GAP = 0.004;
/* The most load of a level that will do: leaves room for what the measurement misses. */
static const double MOST_LOAD = 0.98;
/* A level of this load by the quick measurement does not do by the dense one either. */
static const double SURE_LOAD = 1.1;

typedef struct search {
  const scree_curve *curve;
  scree_curve *tail; /* of the curve, from level `from` on */
  size_t from;
  const double *tolerances;
  size_t below;                /* only levels of fewer triangles are asked for */
  size_t finest;               /* level: of these */
  scree_gauge_reading reading; /* of the last level that was found to keep all */
  scree_error *error;
} search;

/* Level `fine` keeps all, or is taken to; `coarse` does not, or is none of the curve's. */
typedef struct bracket {
  size_t fine, coarse;
} bracket;

static size_t triangles_at(const scree_curve *curve, size_t level_index) {
  scree_level level;
  scree_curve_level(curve, level_index, &level);
  return level.triangle_count;
}

/* With tolerances NULL all errors are found, whatever they are. */
static scree_status read_level(const search *s, const scree_gauge *gauge, double gap,
                               size_t level_index, const double *tolerances,
                               scree_gauge_reading *reading) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  SCREE_TRY(scree_curve_mesh(s->tail, level_index - s->from, &mesh, s->error));
  return scree_gauge_read(gauge, &mesh, gap, tolerances, reading, s->error);
}

static scree_status keeps_all(search *s, const scree_gauge *gauge, double gap, size_t level_index,
                              bool *keeps) {
  scree_gauge_reading reading;
  SCREE_TRY(read_level(s, gauge, gap, level_index, level_index ? s->tolerances : NULL, &reading));
  *keeps = scree_normalised_error(reading.errors, s->tolerances, NULL) <= MOST_LOAD;
  if (*keeps || level_index == 0) s->reading = reading;
  return SCREE_OK;
}

static scree_status narrow(search *s, const scree_gauge *gauge, double gap, bracket *b) {
  while (b->coarse - b->fine > 1) {
    size_t middle = b->fine + (b->coarse - b->fine) / 2;
    bool keeps;
    SCREE_TRY(keeps_all(s, gauge, gap, middle, &keeps));
    if (keeps)
      b->fine = middle;
    else
      b->coarse = middle;
  }
  return SCREE_OK;
}

/* Between the coarsest usual level that keeps all, or the finest, and the next coarser usual one.
 * *keeps: there may be such a level. Without another known the finest is taken to be one. */
static scree_status first_bracket(search *s, const scree_gauge *quick, bracket *b, bool *keeps) {
  const bool is_first = s->below == SIZE_MAX;
  size_t usual[SCREE_FIDELITY_MOST], count = scree_fidelity_levels(s->curve, usual);
  *b = (bracket){s->finest, scree_curve_level_count(s->curve)};
  while (count-- > 0 && usual[count] > s->finest) {
    bool far = !is_first && triangles_at(s->curve, usual[count]) < s->below / FEWER;
    *keeps = false;
    if (!far) SCREE_TRY(keeps_all(s, quick, SCREE_GAUGE_GAP, usual[count], keeps));
    if (*keeps) {
      b->fine = usual[count];
      return SCREE_OK;
    }
    b->coarse = usual[count];
  }
  *keeps = is_first;
  return is_first ? SCREE_OK : keeps_all(s, quick, SCREE_GAUGE_GAP, s->finest, keeps);
}

/* *keeps: level b->fine does; else none does from the finest on. */
static scree_status find_level(search *s, const scree_gauge *quick, const scree_gauge *dense,
                               bracket *b, bool *keeps) {
  SCREE_TRY(first_bracket(s, quick, b, keeps));
  if (!*keeps) return SCREE_OK;
  SCREE_TRY(narrow(s, quick, SCREE_GAUGE_GAP, b));
  for (size_t step = 1;; step *= 2) {
    SCREE_TRY(keeps_all(s, dense, DENSE_GAP, b->fine, keeps));
    if (*keeps || b->fine == s->finest) break;
    b->coarse = b->fine;
    b->fine -= step < b->fine - s->finest ? step : b->fine - s->finest;
  }
  return *keeps ? narrow(s, dense, DENSE_GAP, b) : SCREE_OK;
}

/* Quick where that is sure, else dense. */
static scree_status read_beyond(const search *s, const scree_gauge *quick, const scree_gauge *dense,
                                size_t level_index, scree_gauge_reading *reading) {
  SCREE_TRY(read_level(s, quick, SCREE_GAUGE_GAP, level_index, NULL, reading));
  if (scree_normalised_error(reading->errors, s->tolerances, NULL) >= SURE_LOAD) return SCREE_OK;
  return read_level(s, dense, DENSE_GAP, level_index, NULL, reading);
}

/* What the next coarser level is refused for; of the last level, what is nearest to it. What the
 * quick measurement refused may do by the dense one: then it is taken. */
static scree_status find_limit(search *s, const scree_gauge *quick, const scree_gauge *dense,
                               size_t *level_index, scree_recommended *found) {
  scree_gauge_reading beyond = s->reading;
  for (;; ++*level_index) {
    found->is_last = *level_index + 1 == scree_curve_level_count(s->curve);
    if (found->is_last) break;
    SCREE_TRY(read_beyond(s, quick, dense, *level_index + 1, &beyond));
    if (!(scree_normalised_error(beyond.errors, s->tolerances, NULL) <= MOST_LOAD)) break;
    s->reading = beyond;
  }
  scree_normalised_error(beyond.errors, s->tolerances, &found->limited_by);
  found->beyond = beyond.errors[found->limited_by];
  found->level_index = *level_index;
  found->triangle_count = triangles_at(s->curve, *level_index);
  found->reading = s->reading;
  return SCREE_OK;
}

static scree_status search_from(search *s, size_t from, const scree_gauge *quick,
                                const scree_gauge *dense, bool *is_found,
                                scree_recommended *found) {
  SCREE_OWNED(scree_curve, tail);
  bracket b;
  SCREE_TRY(scree_curve_tail(s->curve, from, &tail, s->error));
  s->tail = tail;
  s->from = from;
  SCREE_TRY(find_level(s, quick, dense, &b, is_found));
  *is_found |= b.fine == 0;
  if (!*is_found) return SCREE_OK;
  return find_limit(s, quick, dense, &b.fine, found);
}

scree_status scree_recommend(const scree_curve *curve, const scree_gauge *quick,
                             const scree_gauge *dense,
                             const double tolerances[SCREE_SHAPE_ERROR_COUNT], size_t below,
                             bool *is_found, scree_recommended *found, scree_error *error) {
  search s = {.curve = curve, .tolerances = tolerances, .below = below, .error = error};
  size_t from = scree_curve_find(curve, TAIL_COUNT);
  s.finest = below == SIZE_MAX ? from : scree_curve_find(curve, below - 1);
  *is_found = false;
  if (below != SIZE_MAX && triangles_at(curve, s.finest) >= below) return SCREE_OK;
  SCREE_TRY(search_from(&s, from < s.finest ? from : s.finest, quick, dense, is_found, found));
  if (*is_found || below != SIZE_MAX) return SCREE_OK;
  s.finest = 0;
  return search_from(&s, 0, quick, dense, is_found, found);
}

scree_status scree_recommend_gauge(const scree_gauge *quick, scree_gauge *dense,
                                   scree_error *error) {
  return scree_gauge_refine(quick, DENSE_POINTS, dense, error);
}
