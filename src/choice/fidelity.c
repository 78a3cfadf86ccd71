/* The sweep over the levels, from fine to coarse, and what it found. */
#include "choice/fidelity.h"
#include "choice/gauge.h"

#include "base/alloc.h"
#include "base/math.h"
#include "base/owned.h"
#include "base/progress.h"
#include "simplify/curve.h"

#include <math.h>
#include <string.h>

typedef struct level_row {
  size_t level_index, triangle_count;
  scree_gauge_reading reading;
  bool usual;
} level_row;

enum { FACTS = SCREE_SCAN_BOX_HEIGHT + 1 };

struct scree_fidelity {
  double scan[FACTS];
  size_t count;
  level_row *rows;
};

const char *scree_shape_error_name(scree_shape_error which) {
#define SCREE_SHAPE_ERROR_NAME(name, text) text,
  static const char *const names[] = {SCREE_SHAPE_ERROR_LIST(SCREE_SHAPE_ERROR_NAME)};
#undef SCREE_SHAPE_ERROR_NAME
  return (unsigned)which < SCREE_SHAPE_ERROR_COUNT ? names[which] : "?";
}

size_t scree_fidelity_levels(const scree_curve *curve, size_t level_indices[SCREE_FIDELITY_MOST]) {
  size_t scan = scree_curve_get_facts(curve).triangle_count, count = 0;
  for (int k = 1; count < SCREE_FIDELITY_MOST; k++) {
    double rp = scree_power_of_ten(-(double)k / SCREE_FIDELITY_PER_DECADE);
    size_t target = scree_choice_target(rp, scan), index = scree_curve_find(curve, target);
    if (target > SCREE_FIDELITY_FINEST) continue;
    if (count == 0 || index != level_indices[count - 1]) level_indices[count++] = index;
    if (index + 1 == scree_curve_level_count(curve)) break;
  }
  return count;
}

void scree_fidelity_free(scree_fidelity *fidelity) {
  if (!fidelity) return;
  scree_free(fidelity->rows);
  scree_free(fidelity);
}

SCREE_OWNABLE(scree_fidelity)

static scree_status check_indices(const scree_curve *curve, const size_t *indices, size_t count,
                                  scree_error *error) {
  for (size_t i = 0; i < count; i++)
    if (indices[i] >= scree_curve_level_count(curve) || (i > 0 && indices[i] <= indices[i - 1]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "level index %zu at place %zu: must ascend below the curve's %zu levels",
                        indices[i], i, scree_curve_level_count(curve));
  return SCREE_OK;
}

static scree_status sweep(scree_fidelity *f, const scree_gauge *gauge, const scree_curve *curve,
                          const scree_progress *progress, scree_error *error) {
  SCREE_OWNED(scree_replay, replay);
  scree_ticker ticker = {.progress = progress};
  SCREE_TRY(scree_replay_start(curve, &replay, error));
  for (size_t i = 0; i < f->count; i++) {
    const scree_mesh *level;
    level_row *r = &f->rows[i];
    if (!scree_tick(&ticker, "measuring levels", (double)i / (double)f->count))
      return scree_fail(error, SCREE_CANCELLED, "cancelled while measuring levels");
    SCREE_TRY(scree_replay_step(replay, r->level_index, &level, error));
    SCREE_TRY(scree_gauge_read(gauge, level, SCREE_GAUGE_GAP, NULL, &r->reading, error));
    r->triangle_count = level->triangle_count;
  }
  return SCREE_OK;
}

/* Both lists ascend. */
static void mark_usual(scree_fidelity *f, const scree_curve *curve) {
  size_t usual[SCREE_FIDELITY_MOST], count = scree_fidelity_levels(curve, usual);
  for (size_t i = 0, k = 0; i < f->count; i++) {
    while (k < count && usual[k] < f->rows[i].level_index) k++;
    f->rows[i].usual = k < count && usual[k] == f->rows[i].level_index;
  }
}

static void keep_facts(scree_fidelity *f, const scree_gauge *g) {
  f->scan[SCREE_SCAN_LENGTH] = g->length;
  f->scan[SCREE_SCAN_NOISE] = g->fit.sigma;
  f->scan[SCREE_SCAN_CLEAN_AREA] = g->clean_area;
  f->scan[SCREE_SCAN_THICKNESS] = g->thickness;
  f->scan[SCREE_SCAN_THINNEST] = g->thinnest;
  for (int i = 0; i < 3; i++)
    f->scan[SCREE_SCAN_BOX_LENGTH + i] = scree_extent_width(&g->extent, i);
}

scree_status scree_fidelity_sweep(const scree_gauge *gauge, const scree_curve *curve,
                                  const size_t *level_indices, size_t level_count,
                                  const scree_progress *progress, scree_fidelity **fidelity,
                                  scree_error *error) {
  SCREE_TRY(check_indices(curve, level_indices, level_count, error));
  SCREE_OWNED(scree_fidelity, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_TRY_ALLOC_ZERO(made->rows, level_count, error);
  made->count = level_count;
  for (size_t i = 0; i < level_count; i++) made->rows[i].level_index = level_indices[i];
  mark_usual(made, curve);
  keep_facts(made, gauge);
  SCREE_TRY(sweep(made, gauge, curve, progress, error));
  *fidelity = made;
  made = NULL;
  return SCREE_OK;
}

scree_status scree_fidelity_measure(const scree_curve *curve, const scree_mesh *scan,
                                    const size_t *level_indices, size_t level_count,
                                    const scree_progress *progress, scree_fidelity **fidelity,
                                    scree_error *error) {
  size_t usual[SCREE_FIDELITY_MOST];
  SCREE_CLEANUP(scree_gauge_free) scree_gauge gauge = {0};
  if (!level_indices) {
    level_count = scree_fidelity_levels(curve, usual);
    level_indices = usual;
  }
  SCREE_TRY(scree_gauge_make(scan, SCREE_GAUGE_POINTS, &gauge, error));
  return scree_fidelity_sweep(&gauge, curve, level_indices, level_count, progress, fidelity, error);
}

scree_status scree_fidelity_insert(scree_fidelity *f, size_t level_index, size_t triangle_count,
                                   const scree_gauge_reading *reading, size_t *row,
                                   scree_error *error) {
  size_t at = 0;
  while (at < f->count && f->rows[at].level_index < level_index) at++;
  if (at == f->count || f->rows[at].level_index != level_index) {
    level_row *grown;
    SCREE_TRY_BLOCK(grown, scree_resize(f->rows, f->count + 1, sizeof *grown), f->count + 1, error);
    f->rows = grown;
    memmove(&f->rows[at + 1], &f->rows[at], (f->count++ - at) * sizeof *grown);
  }
  f->rows[at] = (level_row){level_index, triangle_count, *reading, false};
  *row = at;
  return SCREE_OK;
}

size_t scree_fidelity_count(const scree_fidelity *fidelity) {
  return fidelity->count;
}

bool scree_fidelity_is_usual(const scree_fidelity *fidelity, size_t row) {
  return fidelity->rows[row].usual;
}

size_t scree_fidelity_level_index(const scree_fidelity *fidelity, size_t row) {
  return fidelity->rows[row].level_index;
}

size_t scree_fidelity_triangle_count(const scree_fidelity *fidelity, size_t row) {
  return fidelity->rows[row].triangle_count;
}

double scree_fidelity_error(const scree_fidelity *fidelity, size_t row, scree_shape_error which) {
  return fidelity->rows[row].reading.errors[which];
}

void scree_fidelity_farthest(const scree_fidelity *fidelity, size_t row, double at[3]) {
  memcpy(at, fidelity->rows[row].reading.farthest, 3 * sizeof *at);
}

double scree_fidelity_change(const scree_fidelity *fidelity, size_t row, scree_shape_change which) {
  return fidelity->rows[row].reading.changes[which];
}

double scree_fidelity_scan(const scree_fidelity *fidelity, scree_scan_fact which) {
  return (unsigned)which < FACTS ? fidelity->scan[which] : NAN;
}
