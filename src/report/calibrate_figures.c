/* Figures of a calibration: every pair of parameters, answers beside what was measured, and how
 * intervals narrowed. */
#include "base/file.h"
#include "report/drawing.h"
#include "report/program.h"

#include <math.h>

enum { MOST_DRAWN = 6, MOST_POINTS = 600, BINS = 24, MOST_PANELS = 36 };

static scree_status finish(scree_drawing *d, const scree_calibration_result *r, scree_figure figure,
                           const char *stem, bool overwrite, scree_error *error) {
  char note[256];
  snprintf(note, sizeof note, "scree %s, %.100s, %zu runs, seed %llu", r->version, r->title,
           r->progress.done, (unsigned long long)r->seed);
  figure.note = note;
  return scree_drawing_write(d, figure, stem, overwrite, error);
}

static scree_axis axis_of(const scree_parameter_result *p) {
  return (scree_axis){.label = p->name,
                      .scale = p->logarithmic ? SCREE_SCALE_LOG : SCREE_SCALE_LINEAR,
                      .minimum = p->from,
                      .maximum = p->to};
}

/* ---- pairs ---- */

/* Shares of the samples in equal parts of the range, as steps. */
static void add_histogram(scree_drawing *d, const scree_calibration_result *r, size_t k) {
  const scree_parameter_result *p = &r->parameters[k];
  scree_curve_room at = scree_drawing_add(d, 2 * BINS, (scree_series){.draw = SCREE_DRAW_LINE});
  if (!at.x) return;
  double low = p->logarithmic ? log(p->from) : p->from, high = p->logarithmic ? log(p->to) : p->to,
         step = (high - low) / BINS;
  for (size_t b = 0; b < 2 * BINS; b++) {
    double edge = low + step * (double)((b + 1) / 2);
    at.x[b] = p->logarithmic ? exp(edge) : edge;
    at.y[b] = 0;
  }
  for (size_t i = 0; i < r->sample_count; i++) {
    double value = r->samples[i * r->parameter_count + k];
    double bin = ((p->logarithmic ? log(value) : value) - low) / step;
    size_t b = bin < 0 ? 0 : bin >= BINS ? BINS - 1 : (size_t)bin;
    at.y[2 * b] += 1.0 / (double)r->sample_count;
    at.y[2 * b + 1] = at.y[2 * b];
  }
}

static void add_pair(scree_drawing *d, const scree_calibration_result *r, size_t across,
                     size_t up) {
  size_t count = r->sample_count < MOST_POINTS ? r->sample_count : MOST_POINTS;
  scree_curve_room at = scree_drawing_add(
      d, count,
      (scree_series){.marker = SCREE_MARKER_PLUS, .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_FAINT});
  for (size_t i = 0; at.x && i < count; i++) {
    const double *row = r->samples + i * r->sample_count / count * r->parameter_count;
    at.x[i] = row[across];
    at.y[i] = row[up];
  }
}

static scree_status draw_corner(const void *result, const char *stem, bool overwrite,
                                scree_error *error) {
  const scree_calibration_result *r = result;
  scree_drawing d = {0};
  size_t n = r->parameter_count < MOST_DRAWN ? r->parameter_count : MOST_DRAWN;
  for (size_t up = 0; up < n; up++)
    for (size_t across = 0; across < n; across++) {
      bool same = up == across;
      scree_drawing_panel(&d, NULL, axis_of(&r->parameters[across]),
                          same ? (scree_axis){.label = "share"} : axis_of(&r->parameters[up]));
      if (same)
        add_histogram(&d, r, up);
      else
        add_pair(&d, r, across, up);
    }
  scree_figure figure = {.columns = n, .panel_width = 230, .panel_height = 210};
  return finish(&d, r, figure, stem, overwrite, error);
}

/* ---- answers ---- */

static void add_point(scree_drawing *d, const char *label, int place, double y, double low,
                      double high) {
  scree_curve_room at = scree_drawing_add(
      d, 1,
      (scree_series){
          .label = label, .style = place - 1, .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_BARS});
  if (!at.x) return;
  *at.x = place;
  *at.y = y;
  *at.low = low;
  *at.high = high;
}

static void draw_answer(scree_drawing *d, const scree_answer_result *a) {
  bool curve = a->point_count > 0;
  scree_drawing_panel(d, a->name,
                      curve ? (scree_axis){.label = "x"}
                            : (scree_axis){.label = a->experiment, .minimum = 0, .maximum = 4},
                      (scree_axis){.label = a->answer});
  if (curve) {
    scree_drawing_put(d, (scree_series){.label = "simulated, interval",
                                        .x = a->x,
                                        .y = a->curve_mean,
                                        .low = a->curve_low,
                                        .high = a->curve_high,
                                        .count = a->point_count,
                                        .style = 1,
                                        .draw = SCREE_DRAW_LINE | SCREE_DRAW_BAND});
    scree_drawing_put(d, (scree_series){.label = "measured",
                                        .x = a->x,
                                        .y = a->y,
                                        .count = a->point_count,
                                        .draw = SCREE_DRAW_MARKERS});
    return;
  }
  double half = a->uncertainty;
  if (isfinite(a->scatter)) half = hypot(half, a->scatter / sqrt(a->repeat_count));
  if (a->measured) add_point(d, "measured", 1, a->value, a->value - half, a->value + half);
  add_point(d, "simulated, interval", 2, a->mean, a->low, a->high);
  add_point(d, "a single one, interval", 3, a->mean, a->single_low, a->single_high);
}

static scree_status draw_answers(const void *result, const char *stem, bool overwrite,
                                 scree_error *error) {
  const scree_calibration_result *r = result;
  scree_drawing d = {0};
  for (size_t i = 0; i < r->answer_count && i < MOST_PANELS; i++) draw_answer(&d, &r->answers[i]);
  scree_figure figure = {
      .columns = d.panels.count < 3 ? d.panels.count : 3, .panel_width = 260, .panel_height = 260};
  return finish(&d, r, figure, stem, overwrite, error);
}

/* ---- history ---- */

static scree_status draw_history(const void *result, const char *stem, bool overwrite,
                                 scree_error *error) {
  const scree_calibration_result *r = result;
  static const scree_guide half = {"identified", 0.5, true};
  scree_drawing d = {0};
  size_t lines = r->is_search ? 1 : r->parameter_count, width = 1 + lines;
  scree_panel *panel = scree_drawing_panel(
      &d, NULL, (scree_axis){.label = "runs"},
      r->is_search ? (scree_axis){.label = r->sought}
                   : (scree_axis){.label = "width of the interval beside the range",
                                  .minimum = 0,
                                  .maximum = 1.05});
  if (panel && !r->is_search) panel->guides = &half;
  if (panel && !r->is_search) panel->guide_count = 1;
  for (size_t k = 0; k < lines; k++) {
    scree_curve_room at = scree_drawing_add(
        &d, r->history_count,
        (scree_series){.label = r->is_search ? "best so far" : r->parameters[k].name,
                       .style = (int)k,
                       .draw = SCREE_DRAW_LINE | SCREE_DRAW_MARKERS});
    for (size_t i = 0; at.x && i < r->history_count; i++) {
      at.x[i] = r->history[i * width];
      at.y[i] = r->history[i * width + 1 + k];
    }
  }
  scree_figure figure = {.columns = 1, .panel_width = 380, .panel_height = 300};
  return finish(&d, r, figure, stem, overwrite, error);
}

/* ---- all files ---- */

static scree_status write_text(const void *result, const char *path, bool overwrite,
                               scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  scree_calibration_print(result, true, output.stream);
  return scree_output_commit(&output, error);
}

scree_status scree_calibration_report_write(const scree_calibration_result *result,
                                            const char *folder, scree_error *error) {
  static const scree_product of_search[] = {{"calibration.json", scree_calibration_json_write},
                                            {"settings.csv", scree_calibration_csv_write},
                                            {"calibration.txt", write_text},
                                            {"history", draw_history}};
  static const scree_product of_fit[] = {{"calibration.json", scree_calibration_json_write},
                                         {"calibration.txt", write_text},
                                         {"samples.csv", scree_calibration_csv_write},
                                         {"corner", draw_corner},
                                         {"answers", draw_answers},
                                         {"history", draw_history}};
  if (result->is_search)
    return scree_products_write(of_search, sizeof of_search / sizeof *of_search, result, folder,
                                true, error);
  /* where nothing is fitted there is nothing to draw but the answers */
  size_t count = result->agreement == SCREE_AGREEMENT_NO ? 2 : sizeof of_fit / sizeof *of_fit;
  return scree_products_write(of_fit, count, result, folder, true, error);
}
