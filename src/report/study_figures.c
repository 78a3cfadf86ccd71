/* Figures of a study, in the manner of the paper's Figs. 5, 7 and 8. */
#include "base/arena.h"
#include "report/plot.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

enum { MOST_SERIES = 64, CURVE_POINTS = 200, TEXT = 160 };
static const double PANEL_WIDTH = 350, PANEL_HEIGHT = 300;

typedef struct drawing {
  const scree_study_result *result;
  scree_arena arena;
  scree_series series[MOST_SERIES];
  size_t series_count;
  char note[256];
} drawing;

static double *take(drawing *d, size_t count) {
  return scree_arena_take(&d->arena, count, sizeof(double));
}

static const char *label_of(const char *label, const char *none) {
  return label[0] ? label : none;
}

/* A new series of `count` points; false when memory is out. */
static bool start_series(drawing *d, size_t count, double **x, double **y, double **low,
                         double **high) {
  if (d->series_count == MOST_SERIES) return false;
  *x = take(d, count);
  *y = take(d, count);
  *low = take(d, count);
  *high = take(d, count);
  return *x && *y && *low && *high;
}

static scree_status finish(drawing *d, const scree_panel *panels, size_t count, const char *path,
                           bool overwrite, scree_error *error) {
  const scree_study_result *r = d->result;
  snprintf(d->note, sizeof d->note,
           "scree %s, study %s, %zu replicates, %zu runs done, method %s, seed %llu", r->version,
           r->name, r->replicate_count, r->counts.done, r->method, (unsigned long long)r->seed);
  scree_figure figure = {.panels = panels,
                         .panel_count = count,
                         .panel_width = PANEL_WIDTH,
                         .panel_height = PANEL_HEIGHT,
                         .note = d->note};
  const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
  if (dot && (!slash || dot > slash)) return scree_figure_write(&figure, path, overwrite, error);
  return scree_figure_write_all(&figure, path, overwrite, error);
}

static scree_status nothing_to_draw(const char *path, const char *what, scree_error *error) {
  return scree_fail(error, SCREE_UNSUPPORTED, "%s: nothing to draw: %s", path, what);
}

static scree_status no_memory(scree_error *error) {
  return scree_fail_memory(error, 0, "a figure");
}

/* ---- angle and its coefficient of variation against Rp ---- */

static bool add_angles(drawing *d, const scree_family_result *f, bool variation, int style) {
  double *x, *y, *low, *high;
  if (!start_series(d, f->level_count, &x, &y, &low, &high)) return false;
  for (size_t k = 0; k < f->level_count; k++) {
    const scree_point_result *p = &d->result->points[f->levels[k]];
    const scree_summary *s = &p->angle_deg;
    x[k] = p->rp_value;
    y[k] = variation ? 100 * s->cv : s->mean;
    low[k] = variation ? 100 * s->sd_low / fabs(s->mean) : s->mean - s->sd;
    high[k] = variation ? 100 * s->sd_high / fabs(s->mean) : s->mean + s->sd;
  }
  d->series[d->series_count++] = (scree_series){
      .label = label_of(f->label, "mean and standard deviation"),
      .x = x,
      .y = y,
      .low = variation ? NULL : low,
      .high = variation ? NULL : high,
      .count = f->level_count,
      .style = style,
      .draw = SCREE_DRAW_LINE | SCREE_DRAW_MARKERS | (variation ? 0 : SCREE_DRAW_BARS)};
  return true;
}

/* The band within which angles count as the finest's. */
static bool add_margin(drawing *d, const scree_family_result *f) {
  double *x, *y, *low, *high;
  const scree_point_result *points = d->result->points;
  double finest = points[f->levels[f->level_count - 1]].angle_deg.mean;
  if (!isfinite(finest)) return true;
  if (!start_series(d, 2, &x, &y, &low, &high)) return false;
  for (size_t k = 0; k < 2; k++) {
    x[k] = points[f->levels[k ? f->level_count - 1 : 0]].rp_value;
    y[k] = finest;
    low[k] = finest - d->result->margin_deg;
    high[k] = finest + d->result->margin_deg;
  }
  d->series[d->series_count++] = (scree_series){.label = "finest level and margin",
                                                .x = x,
                                                .y = y,
                                                .low = low,
                                                .high = high,
                                                .count = 2,
                                                .style = SCREE_STYLE_INK,
                                                .draw = SCREE_DRAW_BAND | SCREE_DRAW_LINE |
                                                        SCREE_DRAW_DASHED | SCREE_DRAW_FAINT};
  return true;
}

/* Spheres have no Rp: their angle, if there is one, is a line across. */
static size_t spheres_guide(const scree_study_result *r, scree_guide *guide) {
  for (size_t f = 0; f < r->family_count; f++) {
    size_t spheres = r->families[f].spheres;
    if (spheres == SIZE_MAX || !isfinite(r->points[spheres].angle_deg.mean)) continue;
    *guide = (scree_guide){"spheres", r->points[spheres].angle_deg.mean, true};
    return 1;
  }
  return 0;
}

/* The Rp that were chosen, of the first family; texts and guides have room for two. */
static size_t pick_guides(const scree_study_result *r, char texts[2][TEXT], scree_guide *guides) {
  size_t count = 0;
  const scree_family_result *f = r->families;
  const scree_rp_pick *picks[] = {&f->by_ip, &f->recommended};
  static const char *const names[] = {"I_{p}", "recommended"};
  for (size_t i = 0; i < 2; i++) {
    if (!(picks[i]->mean > 0)) continue;
    snprintf(texts[count], TEXT, "%s: %.2g", names[i], picks[i]->mean);
    guides[count] = (scree_guide){texts[count], picks[i]->mean, false};
    count++;
  }
  return count;
}

scree_status scree_study_angle_figure(const scree_study_result *result, const char *path,
                                      bool overwrite, scree_error *error) {
  if (result->family_count == 0) return nothing_to_draw(path, "fewer than two Rp", error);
  drawing d = {.result = result};
  char texts[2][TEXT];
  scree_guide guides[3];
  size_t guide_count = pick_guides(result, texts, guides);
  size_t angle_guides = guide_count + spheres_guide(result, &guides[guide_count]);
  bool good = result->family_count > 1 || add_margin(&d, &result->families[0]);
  for (size_t f = 0; good && f < result->family_count && f < MOST_SERIES / 2 - 1; f++)
    good = add_angles(&d, &result->families[f], false, (int)f);
  size_t first = d.series_count;
  for (size_t f = 0; good && f < result->family_count && f < MOST_SERIES / 2 - 1; f++) {
    good = add_angles(&d, &result->families[f], true, (int)f);
    if (result->family_count == 1) d.series[d.series_count - 1].label = NULL;
  }
  scree_panel panels[2] = {
      {"(a) angle of repose",
       {"percentage reduction  R_{p}", SCREE_SCALE_LOG, 0, 0},
       {"angle of repose (degrees)", SCREE_SCALE_LINEAR, 0, 0},
       d.series,
       first,
       guides,
       angle_guides},
      {"(b) its coefficient of variation",
       {"percentage reduction  R_{p}", SCREE_SCALE_LOG, 0, 0},
       {"CV (%)", SCREE_SCALE_LINEAR, 0, 0},
       d.series + first,
       d.series_count - first,
       guides,
       guide_count},
  };
  scree_status status = good ? finish(&d, panels, 2, path, overwrite, error) : no_memory(error);
  scree_arena_free(&d.arena);
  return status;
}

/* ---- rotation against time ---- */

scree_status scree_study_rotation_figure(const scree_study_result *result, const char *path,
                                         bool overwrite, scree_error *error) {
  drawing d = {.result = result};
  for (size_t p = 0; p < result->point_count && d.series_count < MOST_SERIES; p++) {
    const scree_point_result *point = &result->points[p];
    if (point->series_count < 2) continue;
    d.series[d.series_count++] = (scree_series){.label = label_of(point->label, point->shapes),
                                                .x = point->time,
                                                .y = point->rotation,
                                                .count = point->series_count,
                                                .style = (int)p,
                                                .draw = SCREE_DRAW_LINE};
  }
  if (d.series_count == 0) return nothing_to_draw(path, "no run is done", error);
  scree_panel panel = {"rotational velocity of the particles",
                       {"time since the cylinder began to rise (s)", SCREE_SCALE_LINEAR, 0, 0},
                       {"mean |\u03c9| (rad/s)", SCREE_SCALE_LINEAR, 0, 0},
                       d.series,
                       d.series_count,
                       NULL,
                       0};
  scree_status status = finish(&d, &panel, 1, path, overwrite, error);
  scree_arena_free(&d.arena);
  return status;
}

/* ---- time against Rp ---- */

static bool add_times(drawing *d, const scree_family_result *f, int style) {
  double *x, *y, *low, *high;
  if (!start_series(d, f->level_count, &x, &y, &low, &high)) return false;
  for (size_t k = 0; k < f->level_count; k++) {
    const scree_point_result *p = &d->result->points[f->levels[k]];
    x[k] = p->rp_value;
    y[k] = p->seconds.mean;
    low[k] = p->seconds.mean - p->seconds.sd;
    high[k] = p->seconds.mean + p->seconds.sd;
  }
  d->series[d->series_count++] =
      (scree_series){.label = label_of(f->label, "runs: mean and standard deviation"),
                     .x = x,
                     .y = y,
                     .low = low,
                     .high = high,
                     .count = f->level_count,
                     .style = style,
                     .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_BARS};
  return true;
}

static bool add_curve(drawing *d, const scree_family_result *f, bool polynomial, char *label) {
  double *x, *y, *low, *high;
  const scree_point_result *points = d->result->points;
  double from = points[f->levels[0]].rp_value, to = points[f->levels[f->level_count - 1]].rp_value;
  if (polynomial ? !f->time_curve.count : !f->time_law.count) return true;
  if (!start_series(d, CURVE_POINTS, &x, &y, &low, &high)) return false;
  for (size_t i = 0; i < CURVE_POINTS; i++) {
    x[i] = from * pow(to / from, (double)i / (CURVE_POINTS - 1));
    y[i] = polynomial ? scree_polynomial_value(&f->time_curve, x[i])
                      : f->time_law.factor * pow(x[i], f->time_law.exponent);
  }
  if (polynomial)
    snprintf(label, TEXT, "fourth order, misfit %.2g s", f->time_curve.rms);
  else
    snprintf(label, TEXT, "R_{p}^{%.2f}", f->time_law.exponent);
  d->series[d->series_count++] = (scree_series){.label = label,
                                                .x = x,
                                                .y = y,
                                                .count = CURVE_POINTS,
                                                .style = SCREE_STYLE_INK,
                                                .draw = SCREE_DRAW_LINE | SCREE_DRAW_UNFITTED |
                                                        (polynomial ? SCREE_DRAW_DASHED : 0)};
  return true;
}

scree_status scree_study_time_figure(const scree_study_result *result, const char *path,
                                     bool overwrite, scree_error *error) {
  if (result->family_count == 0) return nothing_to_draw(path, "fewer than two Rp", error);
  drawing d = {.result = result};
  char labels[2][TEXT];
  bool good = true;
  for (size_t f = 0; good && f < result->family_count && f < MOST_SERIES - 2; f++)
    good = add_times(&d, &result->families[f], (int)f);
  if (good && result->family_count == 1)
    good = add_curve(&d, &result->families[0], false, labels[0]) &&
           add_curve(&d, &result->families[0], true, labels[1]);
  scree_panel panels[2] = {{"(a) logarithmic",
                            {"percentage reduction  R_{p}", SCREE_SCALE_LOG, 0, 0},
                            {"processor time of a run (s)", SCREE_SCALE_LOG, 0, 0},
                            d.series,
                            d.series_count,
                            NULL,
                            0},
                           {"(b) linear",
                            {"percentage reduction  R_{p}", SCREE_SCALE_LINEAR, 0, 0},
                            {"processor time of a run (s)", SCREE_SCALE_LINEAR, 0, 0},
                            d.series,
                            d.series_count,
                            NULL,
                            0}};
  scree_status status = good ? finish(&d, panels, 2, path, overwrite, error) : no_memory(error);
  scree_arena_free(&d.arena);
  return status;
}

/* ---- all ---- */

typedef scree_status writer(const scree_study_result *result, const char *path, bool overwrite,
                            scree_error *error);

scree_status scree_study_report_write(const scree_study_result *result, const char *folder,
                                      scree_error *error) {
  static const struct {
    writer *write;
    const char *name;
  } parts[] = {{scree_study_json_write, "study.json"},
               {scree_study_csv_write, "points.csv"},
               {scree_study_angle_figure, "angle"},
               {scree_study_rotation_figure, "rotation"},
               {scree_study_time_figure, "time"}};
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < sizeof parts / sizeof *parts; i++) {
    size_t size = strlen(folder) + strlen(parts[i].name) + 2;
    char *path = scree_alloc(size, 1);
    if (!path) return scree_fail_memory(error, size, "a path");
    snprintf(path, size, "%s/%s", folder, parts[i].name);
    status = parts[i].write(result, path, true, error);
    if (status == SCREE_UNSUPPORTED) status = SCREE_OK; /* nothing to draw yet */
    scree_free(path);
  }
  return status;
}
