/* Figures of a study, in the manner of the paper's Figs. 5, 7 and 8. */
#include "report/drawing.h"
#include "report/program.h"

#include <math.h>

enum { CURVE_POINTS = 200, TEXT = 160 };
static const double PANEL_WIDTH = 350, PANEL_HEIGHT = 300;

static const scree_axis rp_axis = {"percentage reduction  R_{p}", SCREE_SCALE_LOG, 0, 0};

static const char *label_of(const char *label, const char *none) {
  return label[0] ? label : none;
}

static scree_status finish(scree_drawing *d, const scree_study_result *r, const char *path,
                           bool overwrite, scree_error *error) {
  char note[256];
  snprintf(note, sizeof note,
           "scree %s, study %s, %zu replicates, %zu runs done, method %s, seed %llu", r->version,
           r->name, r->replicate_count, r->counts.done, r->method, (unsigned long long)r->seed);
  scree_figure figure = {.panel_width = PANEL_WIDTH, .panel_height = PANEL_HEIGHT, .note = note};
  return scree_drawing_write(d, figure, path, overwrite, error);
}

static scree_status nothing_to_draw(const char *path, const char *what, scree_error *error) {
  return scree_fail(error, SCREE_UNSUPPORTED, "%s: nothing to draw: %s", path, what);
}

/* ---- angle and its coefficient of variation against Rp ---- */

static void add_angles(scree_drawing *d, const scree_study_result *r, size_t family,
                       bool variation) {
  const scree_family_result *f = &r->families[family];
  const char *label = label_of(f->label, "mean and standard deviation");
  scree_curve_room at =
      scree_drawing_add(d, f->level_count,
                        (scree_series){.label = variation && r->family_count == 1 ? NULL : label,
                                       .style = (int)family,
                                       .draw = SCREE_DRAW_LINE | SCREE_DRAW_MARKERS |
                                               (variation ? 0 : SCREE_DRAW_BARS)});
  for (size_t k = 0; at.x && k < f->level_count; k++) {
    const scree_point_result *p = &r->points[f->levels[k]];
    const scree_summary *s = &p->angle_deg;
    at.x[k] = p->rp_value;
    at.y[k] = variation ? 100 * s->cv : s->mean;
    at.low[k] = s->mean - s->sd;
    at.high[k] = s->mean + s->sd;
  }
}

/* The band within which angles count as the finest's. */
static void add_margin(scree_drawing *d, const scree_study_result *r,
                       const scree_family_result *f) {
  double finest = r->points[f->levels[f->level_count - 1]].angle_deg.mean;
  if (!isfinite(finest)) return;
  scree_curve_room at =
      scree_drawing_add(d, 2,
                        (scree_series){.label = "finest level and margin",
                                       .style = SCREE_STYLE_INK,
                                       .draw = SCREE_DRAW_BAND | SCREE_DRAW_LINE |
                                               SCREE_DRAW_DASHED | SCREE_DRAW_FAINT});
  for (size_t k = 0; at.x && k < 2; k++) {
    at.x[k] = r->points[f->levels[k ? f->level_count - 1 : 0]].rp_value;
    at.y[k] = finest;
    at.low[k] = finest - r->margin_deg;
    at.high[k] = finest + r->margin_deg;
  }
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

static void add_angle_panel(scree_drawing *d, const scree_study_result *r, bool variation,
                            const scree_guide *guides, size_t guide_count) {
  scree_panel *panel = scree_drawing_panel(
      d, variation ? "(b) its coefficient of variation" : "(a) angle of repose", rp_axis,
      (scree_axis){variation ? "CV (%)" : "angle of repose (degrees)", SCREE_SCALE_LINEAR, 0, 0});
  if (panel) panel->guides = guides;
  if (panel) panel->guide_count = guide_count;
  if (!variation && r->family_count == 1) add_margin(d, r, &r->families[0]);
  for (size_t f = 0; f < r->family_count; f++) add_angles(d, r, f, variation);
}

scree_status scree_study_angle_figure(const void *what, const char *path, bool overwrite,
                                      scree_error *error) {
  const scree_study_result *result = what;
  scree_drawing d = {0};
  char texts[2][TEXT];
  scree_guide guides[3];
  if (result->family_count == 0) return nothing_to_draw(path, "fewer than two Rp", error);
  size_t guide_count = pick_guides(result, texts, guides);
  size_t angle_guides = guide_count + spheres_guide(result, &guides[guide_count]);
  add_angle_panel(&d, result, false, guides, angle_guides);
  add_angle_panel(&d, result, true, guides, guide_count);
  return finish(&d, result, path, overwrite, error);
}

/* ---- rotation against time ---- */

scree_status scree_study_rotation_figure(const void *what, const char *path, bool overwrite,
                                         scree_error *error) {
  const scree_study_result *result = what;
  scree_drawing d = {0};
  scree_drawing_panel(
      &d, "rotational velocity of the particles",
      (scree_axis){"time since the cylinder began to rise (s)", SCREE_SCALE_LINEAR, 0, 0},
      (scree_axis){"mean |\u03c9| (rad/s)", SCREE_SCALE_LINEAR, 0, 0});
  for (size_t p = 0; p < result->point_count; p++) {
    const scree_point_result *point = &result->points[p];
    if (point->series_count < 2) continue;
    scree_drawing_put(&d, (scree_series){.label = label_of(point->label, point->shapes),
                                         .x = point->time,
                                         .y = point->rotation,
                                         .count = point->series_count,
                                         .style = (int)p,
                                         .draw = SCREE_DRAW_LINE});
  }
  if (d.failed || d.series.count) return finish(&d, result, path, overwrite, error);
  scree_drawing_free(&d);
  return nothing_to_draw(path, "no run is done", error);
}

/* ---- time against Rp ---- */

static void add_times(scree_drawing *d, const scree_study_result *r, size_t family) {
  const scree_family_result *f = &r->families[family];
  scree_curve_room at = scree_drawing_add(
      d, f->level_count,
      (scree_series){.label = label_of(f->label, "runs: mean and standard deviation"),
                     .style = (int)family,
                     .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_BARS});
  for (size_t k = 0; at.x && k < f->level_count; k++) {
    const scree_point_result *p = &r->points[f->levels[k]];
    at.x[k] = p->rp_value;
    at.y[k] = p->seconds.mean;
    at.low[k] = p->seconds.mean - p->seconds.sd;
    at.high[k] = p->seconds.mean + p->seconds.sd;
  }
}

/* label: room for TEXT bytes. */
static void add_curve(scree_drawing *d, const scree_study_result *r, bool polynomial, char *label) {
  const scree_family_result *f = &r->families[0];
  double from = r->points[f->levels[0]].rp_value,
         to = r->points[f->levels[f->level_count - 1]].rp_value;
  if (polynomial ? !f->time_curve.count : !f->time_law.count) return;
  if (polynomial)
    snprintf(label, TEXT, "fourth order, misfit %.2g s", f->time_curve.rms);
  else
    snprintf(label, TEXT, "R_{p}^{%.2f}", f->time_law.exponent);
  scree_curve_room at =
      scree_drawing_add(d, CURVE_POINTS,
                        (scree_series){.label = label,
                                       .style = SCREE_STYLE_INK,
                                       .draw = SCREE_DRAW_LINE | SCREE_DRAW_UNFITTED |
                                               (polynomial ? SCREE_DRAW_DASHED : 0)});
  for (size_t i = 0; at.x && i < CURVE_POINTS; i++) {
    at.x[i] = from * pow(to / from, (double)i / (CURVE_POINTS - 1));
    at.y[i] = polynomial ? scree_polynomial_value(&f->time_curve, at.x[i])
                         : f->time_law.factor * pow(at.x[i], f->time_law.exponent);
  }
}

scree_status scree_study_time_figure(const void *what, const char *path, bool overwrite,
                                     scree_error *error) {
  const scree_study_result *result = what;
  scree_drawing d = {0};
  char labels[2][TEXT];
  if (result->family_count == 0) return nothing_to_draw(path, "fewer than two Rp", error);
  for (int linear = 0; linear < 2; linear++) {
    scree_scale scale = linear ? SCREE_SCALE_LINEAR : SCREE_SCALE_LOG;
    scree_drawing_panel(&d, linear ? "(b) linear" : "(a) logarithmic",
                        (scree_axis){rp_axis.label, scale, 0, 0},
                        (scree_axis){"processor time of a run (s)", scale, 0, 0});
    for (size_t f = 0; f < result->family_count; f++) add_times(&d, result, f);
    for (int k = 0; result->family_count == 1 && k < 2; k++)
      add_curve(&d, result, k == 1, labels[k]);
  }
  return finish(&d, result, path, overwrite, error);
}

/* ---- all ---- */

scree_status scree_study_report_write(const scree_study_result *result, const char *folder,
                                      scree_error *error) {
  static const scree_product products[] = {{"study.json", scree_study_json_write},
                                           {"points.csv", scree_study_csv_write},
                                           {"angle", scree_study_angle_figure},
                                           {"rotation", scree_study_rotation_figure},
                                           {"time", scree_study_time_figure}};
  return scree_products_write(products, sizeof products / sizeof *products, result, folder, true,
                              error);
}
