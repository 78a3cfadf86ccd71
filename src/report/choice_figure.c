/* The paper's Fig. 4: (a) the surface error, (b) the criterion, against Rp, on log axes. Thin lines
 * are the dense curve, markers the paper's grid. A ring goes around the paper's choice, a square
 * around the robust one, and a star stands at the recommended one. With one object the robust
 * criterion is drawn too. */
#include "base/number.h"
#include "report/choice.h"
#include "report/plot.h"
#include "report/program.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

static const double PANEL_WIDTH = 350, PANEL_HEIGHT = 310;
/* eps_s crosses zero; below this part of the largest error nothing is to be read. */
static const double ERROR_FLOOR = 1e-4;

enum { SERIES_PER_ENTRY = 2, EXTRA_SERIES = 4, NOTE_BYTES = 256 };

typedef struct panel_data {
  scree_series *series;
  double *values; /* all the arrays below */
  size_t series_count, used;
} panel_data;

static double *take(panel_data *data, size_t count) {
  double *block = data->values + data->used;
  data->used += count;
  return block;
}

static void copy_levels(panel_data *data, const scree_choice_level *levels, size_t count,
                        bool criterion, scree_series *series) {
  double *x = take(data, count), *y = take(data, count);
  for (size_t i = 0; i < count; i++) {
    x[i] = fmax(levels[i].rp, levels[i].rp_reached);
    y[i] = criterion ? levels[i].ip : levels[i].eps_s;
    /* a level that stands for several Rp below the floor is drawn once, where it is */
    bool repeated = i + 1 < count && levels[i].level_index == levels[i + 1].level_index;
    if (repeated && !levels[i].reached) y[i] = NAN;
  }
  *series = (scree_series){.x = x, .y = y, .count = count};
}

static void add_entries(const scree_choice_report *report, bool criterion, panel_data *data) {
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice_entry *entry = &report->entries[e];
    scree_series *line = &data->series[data->series_count++];
    copy_levels(data, entry->choice->trace, entry->choice->trace_count, criterion, line);
    line->style = (int)e;
    line->draw = SCREE_DRAW_LINE | SCREE_DRAW_FAINT | SCREE_DRAW_UNFITTED;
  }
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice_entry *entry = &report->entries[e];
    scree_series *points = &data->series[data->series_count++];
    copy_levels(data, entry->choice->levels, entry->choice->level_count, criterion, points);
    points->label = entry->name;
    points->style = (int)e;
    points->draw = SCREE_DRAW_MARKERS;
  }
}

static void add_robust_line(const scree_choice *choice, bool criterion, panel_data *data) {
  size_t count = choice->trace_count;
  double *x = take(data, count), *y = take(data, count);
  for (size_t i = 0; i < count; i++) {
    x[i] = choice->trace[i].rp;
    y[i] = choice->trace[i].reached
               ? (criterion ? choice->trace[i].robust_ip : choice->trace[i].worst_eps_s)
               : NAN;
  }
  data->series[data->series_count++] =
      (scree_series){.label = "worst at this or finer levels",
                     .x = x,
                     .y = y,
                     .count = count,
                     .style = SCREE_STYLE_INK,
                     .draw = SCREE_DRAW_LINE | SCREE_DRAW_DASHED | SCREE_DRAW_UNFITTED};
}

/* The grid's Rp, or the level's own where the grid's was not reached. */
static double pick_rp(const scree_choice *choice, const scree_pick *pick) {
  return fmax(pick->rp, (double)pick->triangle_count / (double)choice->triangle_count);
}

/* What each rule chooses: every figure marks them all. */
static const struct {
  scree_choice_rule rule;
  const char *label;
  scree_marker marker;
} picks[] = {{SCREE_RULE_PAPER, "paper's choice (grid minimum)", SCREE_MARKER_RING},
             {SCREE_RULE_ROBUST, "robust choice", SCREE_MARKER_FRAME},
             {SCREE_RULE_RECOMMENDED, "recommended", SCREE_MARKER_STAR}};
enum { PICKS = sizeof picks / sizeof *picks };

/* A robust choice's error is the worst at finer levels: the level's own is drawn. */
static double pick_value(const scree_choice_report *report, const scree_choice *choice,
                         const scree_pick *pick, bool criterion) {
  double penalty =
      report->options->weight * (double)pick->triangle_count / (double)choice->triangle_count;
  return pick->level_eps_s + (criterion ? penalty : 0);
}

static void add_picks(const scree_choice_report *report, size_t which, bool criterion,
                      panel_data *data) {
  size_t count = report->entry_count;
  double *x = take(data, count), *y = take(data, count);
  for (size_t e = 0; e < count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    const scree_pick *pick = scree_choice_pick(choice, picks[which].rule);
    x[e] = pick_rp(choice, pick);
    bool known = picks[which].rule != SCREE_RULE_RECOMMENDED || choice->fidelity;
    y[e] = known ? pick_value(report, choice, pick, criterion) : NAN;
  }
  data->series[data->series_count++] =
      (scree_series){.label = picks[which].label,
                     .x = x,
                     .y = y,
                     .count = count,
                     .style = SCREE_STYLE_INK,
                     .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_UNFITTED,
                     .marker = picks[which].marker};
}

/* Up to the grid's end, or to a choice behind it. */
static double largest_rp(const scree_choice_report *report) {
  double rp = report->options->rp_max;
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    for (size_t k = 0; k < PICKS; k++)
      rp = fmax(rp, pick_rp(choice, scree_choice_pick(choice, picks[k].rule)));
  }
  return rp / 0.75;
}

/* Least (above 0) and largest value of the levels up to an Rp, of the envelope too where drawn. */
static void find_range(const scree_choice_level *levels, size_t count, double rp_max,
                       bool criterion, bool envelope, double range[2]) {
  for (size_t i = 0; i < count && levels[i].rp <= rp_max; i++) {
    const scree_choice_level *level = &levels[i];
    double value = criterion ? level->ip : level->eps_s;
    double worst = criterion ? level->robust_ip : level->worst_eps_s;
    if (value > 0) range[0] = fmin(range[0], value);
    range[1] = fmax(range[1], envelope ? fmax(value, worst) : value);
  }
}

/* All that is drawn, but of errors no less than the grid's least, and than the floor. */
static void fit_errors(const scree_choice_report *report, bool criterion, scree_axis *axis) {
  double grid[2] = {INFINITY, 0}, drawn[2] = {INFINITY, 0}, rp_max = largest_rp(report);
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    find_range(choice->levels, choice->level_count, rp_max, criterion, false, grid);
    find_range(choice->trace, choice->trace_count, rp_max, criterion, report->entry_count == 1,
               drawn);
    for (size_t k = 0; k < PICKS; k++) {
      double value =
          pick_value(report, choice, scree_choice_pick(choice, picks[k].rule), criterion);
      if (value > 0) drawn[0] = fmin(drawn[0], value);
      drawn[1] = fmax(drawn[1], value);
    }
  }
  double low = criterion ? fmin(grid[0], drawn[0]) : grid[0], high = fmax(grid[1], drawn[1]);
  if (!(high > 0)) return;
  axis->minimum = fmax(low / 1.4, ERROR_FLOOR * high);
  axis->maximum = high * 1.4;
}

static scree_status allocate(const scree_choice_report *report, panel_data *data,
                             scree_error *error) {
  size_t points = 2 * PICKS * report->entry_count;
  for (size_t e = 0; e < report->entry_count; e++)
    points += 2 * (report->entries[e].choice->level_count + report->entries[e].choice->trace_count);
  points += 2 * report->entries[0].choice->trace_count;
  size_t series = SERIES_PER_ENTRY * report->entry_count + EXTRA_SERIES;
  data->series = scree_alloc_zero(series, sizeof *data->series);
  data->values = scree_alloc(points, sizeof *data->values);
  if (!data->series || !data->values)
    return scree_fail_memory(error, points * sizeof *data->values, "a figure's data");
  return SCREE_OK;
}

static scree_panel make_panel(const scree_choice_report *report, bool criterion, panel_data *data) {
  scree_panel panel = {.title = criterion ? "(b) criterion" : "(a) surface error",
                       .x = {"percentage reduction  R_{p} = N^{r}/N^{m}", SCREE_SCALE_LOG,
                             0.75 * report->options->rp_min, largest_rp(report)},
                       .y = {criterion ? "I_{p}" : "\u03b5_{s}", SCREE_SCALE_LOG, 0, 0}};
  add_entries(report, criterion, data);
  if (report->entry_count == 1) add_robust_line(report->entries[0].choice, criterion, data);
  for (size_t k = 0; k < PICKS; k++) add_picks(report, k, criterion, data);
  fit_errors(report, criterion, &panel.y);
  panel.series = data->series;
  panel.series_count = data->series_count;
  return panel;
}

/* The set's one Rp as a line, as the text names it. */
static size_t set_guide(const scree_choice_report *report, char *text, size_t size,
                        scree_guide *guide) {
  if (report->entry_count < 2 || !report->set) return 0;
  double rp = scree_report_set_pick(report)->rp;
  char number[SCREE_NUMBER_SIZE];
  snprintf(text, size, "%s for the set: %s",
           report->rule == SCREE_RULE_ROBUST ? "robust" : "paper's", scree_rp_text(rp, number));
  *guide = (scree_guide){text, rp, false};
  return 1;
}

static bool has_below(const scree_choice_level *levels, size_t count, double rp_max, double least) {
  for (size_t i = 0; i < count && levels[i].rp <= rp_max; i++)
    if (!(levels[i].eps_s > 0) || levels[i].eps_s < least) return true;
  return false;
}

/* The axis is logarithmic and ends above the least: what has hardly an error, or none, is not on
 * it. */
static const char *missing_text(const scree_choice_report *report, char text[64]) {
  scree_axis axis = {.minimum = 0};
  char number[SCREE_NUMBER_SIZE];
  bool missing = false;
  double rp_max = largest_rp(report);
  fit_errors(report, false, &axis);
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    missing = missing || has_below(choice->levels, choice->level_count, rp_max, axis.minimum) ||
              has_below(choice->trace, choice->trace_count, rp_max, axis.minimum);
  }
  if (axis.minimum > 0)
    snprintf(text, 64, "; not in (a): \u03b5_{s} < %s", scree_rp_text(axis.minimum, number));
  else
    snprintf(text, 64, "; not in (a): \u03b5_{s} = 0");
  return missing ? text : "";
}

static const char *reference_text(const scree_choice_report *report) {
  size_t found = 0;
  for (size_t e = 0; e < report->entry_count; e++) found += report->entries[e].choice->noise.found;
  if (report->options->reference == SCREE_REFERENCE_SCAN || !found) return "the scan's";
  return found == report->entry_count ? "free of noise" : "free of noise where found";
}

scree_status scree_choice_figure_write(const scree_choice_report *report, const char *path,
                                       bool overwrite, scree_error *error) {
  if (report->entry_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no object to draw", path);
  panel_data data[2] = {{0}, {0}};
  scree_panel panels[2];
  char guide_text[64], missing[64], note[NOTE_BYTES];
  scree_guide guide;
  size_t guide_count = set_guide(report, guide_text, sizeof guide_text, &guide);
  scree_status status = SCREE_OK;
  for (int p = 0; p < 2 && status == SCREE_OK; p++) {
    status = allocate(report, &data[p], error);
    if (status != SCREE_OK) break;
    panels[p] = make_panel(report, p == 1, &data[p]);
    panels[p].guides = &guide;
    panels[p].guide_count = guide_count;
  }
  if (status == SCREE_OK) {
    snprintf(note, sizeof note, "scree %s, method %s, w = %g, reference area: %s%s",
             scree_version(), scree_method_name(report->method), report->options->weight,
             reference_text(report), missing_text(report, missing));
    scree_figure figure = {.panels = panels,
                           .panel_count = 2,
                           .panel_width = PANEL_WIDTH,
                           .panel_height = PANEL_HEIGHT,
                           .note = note};
    status = scree_figure_write(&figure, path, overwrite, error);
  }
  for (int p = 0; p < 2; p++) {
    scree_free(data[p].series);
    scree_free(data[p].values);
  }
  return status;
}
