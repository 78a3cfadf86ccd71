/* Figures of a calibration: every pair of parameters, answers beside what was measured, and how
 * intervals narrowed. */
#include "base/arena.h"
#include "base/file.h"
#include "report/plot.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

enum { MOST_DRAWN = 6, MOST_POINTS = 600, BINS = 24, MOST_PANELS = 36, MOST_SERIES = 160 };

typedef struct drawing {
  const scree_calibration_result *r;
  scree_arena arena;
  scree_panel panels[MOST_PANELS];
  scree_series series[MOST_SERIES];
  size_t panel_count, series_count;
  char note[256];
  bool good; /* memory is not out */
} drawing;

static double *take(drawing *d, size_t count) {
  double *room = scree_arena_take(&d->arena, count + 1, sizeof *room);
  d->good = d->good && room;
  return room;
}

static void start_panel(drawing *d, const char *title, scree_axis x, scree_axis y) {
  d->panels[d->panel_count++] = (scree_panel){
      .title = title, .x = x, .y = y, .series = d->series + d->series_count, .series_count = 0};
}

static void add_series(drawing *d, scree_series series) {
  if (d->series_count == MOST_SERIES) return;
  d->series[d->series_count++] = series;
  d->panels[d->panel_count - 1].series_count++;
}

static scree_status finish(drawing *d, size_t columns, double width, double height,
                           const char *stem, scree_error *error) {
  const scree_calibration_result *r = d->r;
  snprintf(d->note, sizeof d->note, "scree %s, %.100s, %zu runs, seed %llu", r->version, r->title,
           r->progress.done, (unsigned long long)r->seed);
  scree_figure figure = {.panels = d->panels,
                         .panel_count = d->panel_count,
                         .columns = columns,
                         .panel_width = width,
                         .panel_height = height,
                         .note = d->note};
  scree_status status = d->good ? scree_figure_write_all(&figure, stem, true, error)
                                : scree_fail_memory(error, 0, "a figure");
  scree_arena_free(&d->arena);
  return status;
}

static scree_axis axis_of(const scree_parameter_result *p) {
  return (scree_axis){.label = p->name,
                      .scale = p->logarithmic ? SCREE_SCALE_LOG : SCREE_SCALE_LINEAR,
                      .minimum = p->from,
                      .maximum = p->to};
}

/* ---- pairs ---- */

/* Shares of the samples in equal parts of the range, as steps. */
static void add_histogram(drawing *d, size_t k) {
  const scree_calibration_result *r = d->r;
  const scree_parameter_result *p = &r->parameters[k];
  double *x = take(d, 2 * BINS), *y = take(d, 2 * BINS);
  if (!d->good) return;
  double low = p->logarithmic ? log(p->from) : p->from, high = p->logarithmic ? log(p->to) : p->to,
         step = (high - low) / BINS;
  for (size_t b = 0; b < 2 * BINS; b++) {
    double at = low + step * (double)((b + 1) / 2);
    x[b] = p->logarithmic ? exp(at) : at;
    y[b] = 0;
  }
  for (size_t i = 0; i < r->sample_count; i++) {
    double value = r->samples[i * r->parameter_count + k];
    double bin = ((p->logarithmic ? log(value) : value) - low) / step;
    size_t b = bin < 0 ? 0 : bin >= BINS ? BINS - 1 : (size_t)bin;
    y[2 * b] += 1.0 / (double)r->sample_count;
    y[2 * b + 1] = y[2 * b];
  }
  add_series(d, (scree_series){.x = x, .y = y, .count = 2 * BINS, .draw = SCREE_DRAW_LINE});
}

static void add_pair(drawing *d, size_t across, size_t up) {
  const scree_calibration_result *r = d->r;
  size_t count = r->sample_count < MOST_POINTS ? r->sample_count : MOST_POINTS;
  double *x = take(d, count), *y = take(d, count);
  for (size_t i = 0; d->good && i < count; i++) {
    const double *row = r->samples + i * r->sample_count / count * r->parameter_count;
    x[i] = row[across];
    y[i] = row[up];
  }
  add_series(d, (scree_series){.x = x,
                               .y = y,
                               .count = d->good ? count : 0,
                               .marker = SCREE_MARKER_PLUS,
                               .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_FAINT});
}

static scree_status draw_corner(const scree_calibration_result *r, const char *stem,
                                scree_error *error) {
  drawing d = {.r = r, .good = true};
  size_t n = r->parameter_count < MOST_DRAWN ? r->parameter_count : MOST_DRAWN;
  for (size_t up = 0; up < n; up++)
    for (size_t across = 0; across < n; across++) {
      bool same = up == across;
      start_panel(&d, NULL, axis_of(&r->parameters[across]),
                  same ? (scree_axis){.label = "share"} : axis_of(&r->parameters[up]));
      if (same)
        add_histogram(&d, up);
      else
        add_pair(&d, across, up);
    }
  return finish(&d, n, 230, 210, stem, error);
}

/* ---- answers ---- */

static void add_point(drawing *d, const char *label, double x, double y, double low, double high,
                      int style) {
  double *room = take(d, 4);
  if (!d->good) return;
  memcpy(room, (double[]){x, y, low, high}, 4 * sizeof *room);
  add_series(d, (scree_series){.label = label,
                               .x = room,
                               .y = room + 1,
                               .low = room + 2,
                               .high = room + 3,
                               .count = 1,
                               .style = style,
                               .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_BARS});
}

static void draw_answer(drawing *d, const scree_answer_result *a) {
  bool curve = a->point_count > 0;
  start_panel(d, a->name,
              curve ? (scree_axis){.label = "x"}
                    : (scree_axis){.label = a->experiment, .minimum = 0, .maximum = 4},
              (scree_axis){.label = a->answer});
  if (curve) {
    add_series(d, (scree_series){.label = "simulated, interval",
                                 .x = a->x,
                                 .y = a->curve_mean,
                                 .low = a->curve_low,
                                 .high = a->curve_high,
                                 .count = a->point_count,
                                 .style = 1,
                                 .draw = SCREE_DRAW_LINE | SCREE_DRAW_BAND});
    add_series(d, (scree_series){.label = "measured",
                                 .x = a->x,
                                 .y = a->y,
                                 .count = a->point_count,
                                 .draw = SCREE_DRAW_MARKERS});
    return;
  }
  double half = a->uncertainty;
  if (isfinite(a->scatter)) half = hypot(half, a->scatter / sqrt(a->repeat_count));
  if (a->measured) add_point(d, "measured", 1, a->value, a->value - half, a->value + half, 0);
  add_point(d, "simulated, interval", 2, a->mean, a->low, a->high, 1);
  add_point(d, "a single one, interval", 3, a->mean, a->single_low, a->single_high, 2);
}

static scree_status draw_answers(const scree_calibration_result *r, const char *stem,
                                 scree_error *error) {
  drawing d = {.r = r, .good = true};
  for (size_t i = 0; i < r->answer_count && i < MOST_PANELS; i++) draw_answer(&d, &r->answers[i]);
  return finish(&d, d.panel_count < 3 ? d.panel_count : 3, 260, 260, stem, error);
}

/* ---- history ---- */

static scree_status draw_history(const scree_calibration_result *r, const char *stem,
                                 scree_error *error) {
  static const scree_guide half = {"identified", 0.5, true};
  drawing d = {.r = r, .good = true};
  size_t lines = r->is_search ? 1 : r->parameter_count, width = 1 + lines;
  start_panel(&d, NULL, (scree_axis){.label = "runs"},
              r->is_search ? (scree_axis){.label = r->sought}
                           : (scree_axis){.label = "width of the interval beside the range",
                                          .minimum = 0,
                                          .maximum = 1.05});
  for (size_t k = 0; k < lines; k++) {
    double *x = take(&d, r->history_count), *y = take(&d, r->history_count);
    for (size_t i = 0; d.good && i < r->history_count; i++) {
      x[i] = r->history[i * width];
      y[i] = r->history[i * width + 1 + k];
    }
    add_series(&d, (scree_series){.label = r->is_search ? "best so far" : r->parameters[k].name,
                                  .x = x,
                                  .y = y,
                                  .count = d.good ? r->history_count : 0,
                                  .style = (int)k,
                                  .draw = SCREE_DRAW_LINE | SCREE_DRAW_MARKERS});
  }
  if (!r->is_search) {
    d.panels[0].guides = &half;
    d.panels[0].guide_count = 1;
  }
  return finish(&d, 1, 380, 300, stem, error);
}

/* ---- all files ---- */

static scree_status write_text(const scree_calibration_result *r, const char *path,
                               scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, true, &output, error);
  if (status != SCREE_OK) return status;
  scree_calibration_print(r, output.stream);
  return scree_output_commit(&output, error);
}

scree_status scree_calibration_report_write(const scree_calibration_result *result,
                                            const char *folder, scree_error *error) {
  char path[4200];
#define IN_FOLDER(name) (snprintf(path, sizeof path, "%.4100s/%s", folder, name), path)
  scree_status status =
      scree_calibration_json_write(result, IN_FOLDER("calibration.json"), true, error);
  if (status == SCREE_OK)
    status = scree_calibration_csv_write(
        result, IN_FOLDER(result->is_search ? "settings.csv" : "samples.csv"), true, error);
  if (status == SCREE_OK) status = write_text(result, IN_FOLDER("calibration.txt"), error);
  scree_status drawn = status;
  if (drawn == SCREE_OK && !result->is_search)
    drawn = draw_corner(result, IN_FOLDER("corner"), error);
  if (drawn == SCREE_OK && !result->is_search)
    drawn = draw_answers(result, IN_FOLDER("answers"), error);
  if (drawn == SCREE_OK) drawn = draw_history(result, IN_FOLDER("history"), error);
#undef IN_FOLDER
  return drawn == SCREE_UNSUPPORTED ? SCREE_OK : drawn; /* a build without pictures */
}
