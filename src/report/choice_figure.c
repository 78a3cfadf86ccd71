/* The paper's Fig. 4: (a) the surface error, (b) the criterion, against Rp, on log axes. Thin lines
 * are the dense curve, markers the paper's grid. A ring goes around the paper's choice, a square
 * around the robust one, and a star stands at the recommended one. With one object the robust
 * criterion is drawn too. */
#include "base/number.h"
#include "report/choice.h"
#include "report/drawing.h"
#include "report/program.h"

#include <math.h>

static const double PANEL_WIDTH = 350, PANEL_HEIGHT = 310;
/* eps_s crosses zero; below this part of the largest error nothing is to be read. */
static const double ERROR_FLOOR = 1e-4;

enum { NOTE_BYTES = 256 };

static void add_levels(scree_drawing *d, const scree_choice_level *levels, size_t count,
                       bool criterion, scree_series series) {
  scree_curve_room at = scree_drawing_add(d, count, series);
  for (size_t i = 0; at.x && i < count; i++) {
    at.x[i] = fmax(levels[i].rp, levels[i].rp_reached);
    at.y[i] = criterion ? levels[i].ip : levels[i].eps_s;
    /* a level that stands for several Rp below the floor is drawn once, where it is */
    bool repeated = i + 1 < count && levels[i].level_index == levels[i + 1].level_index;
    if (repeated && !levels[i].reached) at.y[i] = NAN;
  }
}

static void add_entries(scree_drawing *d, const scree_choice_report *report, bool criterion) {
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    add_levels(d, choice->trace, choice->trace_count, criterion,
               (scree_series){.style = (int)e,
                              .draw = SCREE_DRAW_LINE | SCREE_DRAW_FAINT | SCREE_DRAW_UNFITTED});
  }
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice_entry *entry = &report->entries[e];
    add_levels(d, entry->choice->levels, entry->choice->level_count, criterion,
               (scree_series){.label = entry->name, .style = (int)e, .draw = SCREE_DRAW_MARKERS});
  }
}

static void add_robust_line(scree_drawing *d, const scree_choice *choice, bool criterion) {
  scree_curve_room at = scree_drawing_add(
      d, choice->trace_count,
      (scree_series){.label = "worst at this or finer levels",
                     .style = SCREE_STYLE_INK,
                     .draw = SCREE_DRAW_LINE | SCREE_DRAW_DASHED | SCREE_DRAW_UNFITTED});
  for (size_t i = 0; at.x && i < choice->trace_count; i++) {
    const scree_choice_level *level = &choice->trace[i];
    at.x[i] = level->rp;
    at.y[i] = !level->reached ? NAN : criterion ? level->robust_ip : level->worst_eps_s;
  }
}

/* What every figure marks. */
static const struct {
  size_t pick; /* where in scree_choice */
  const char *label;
  scree_marker marker;
} picks[] = {
    {offsetof(scree_choice, paper), "paper's choice (grid minimum)", SCREE_MARKER_RING},
    {offsetof(scree_choice, robust), "robust choice", SCREE_MARKER_FRAME},
    {offsetof(scree_choice, recommended), "recommended", SCREE_MARKER_STAR},
};
enum { PICKS = sizeof picks / sizeof *picks };

static const scree_pick *pick_of(const scree_choice *choice, size_t which) {
  return (const scree_pick *)(const void *)((const char *)choice + picks[which].pick);
}

static void add_picks(scree_drawing *d, const scree_choice_report *report, size_t which,
                      bool criterion) {
  scree_curve_room at =
      scree_drawing_add(d, report->entry_count,
                        (scree_series){.label = picks[which].label,
                                       .style = SCREE_STYLE_INK,
                                       .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_UNFITTED,
                                       .marker = picks[which].marker});
  for (size_t e = 0; at.x && e < report->entry_count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    const scree_pick *pick = pick_of(choice, which);
    bool known = pick != &choice->recommended || choice->fidelity;
    at.x[e] = scree_report_pick_rp(choice, pick);
    at.y[e] = !known ? NAN : criterion ? pick->ip : pick->eps_s;
  }
}

/* Up to the grid's end, or to a choice behind it. */
static double largest_rp(const scree_choice_report *report) {
  double rp = report->options->rp_max;
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_choice *choice = report->entries[e].choice;
    for (size_t k = 0; k < PICKS; k++)
      rp = fmax(rp, scree_report_pick_rp(choice, pick_of(choice, k)));
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
      const scree_pick *pick = pick_of(choice, k);
      double value = criterion ? pick->ip : pick->eps_s;
      if (value > 0) drawn[0] = fmin(drawn[0], value);
      drawn[1] = fmax(drawn[1], value);
    }
  }
  double low = criterion ? fmin(grid[0], drawn[0]) : grid[0], high = fmax(grid[1], drawn[1]);
  if (!(high > 0)) return;
  axis->minimum = fmax(low / 1.4, ERROR_FLOOR * high);
  axis->maximum = high * 1.4;
}

/* guides: room for one, which a set has. */
static void add_panel(scree_drawing *d, const scree_choice_report *report, bool criterion,
                      const scree_guide *guides, size_t guide_count) {
  scree_axis x = {"percentage reduction  R_{p} = N^{r}/N^{m}", SCREE_SCALE_LOG,
                  0.75 * report->options->rp_min, largest_rp(report)},
             y = {criterion ? "I_{p}" : "\u03b5_{s}", SCREE_SCALE_LOG, 0, 0};
  fit_errors(report, criterion, &y);
  scree_panel *panel =
      scree_drawing_panel(d, criterion ? "(b) criterion" : "(a) surface error", x, y);
  if (panel) panel->guides = guides;
  if (panel) panel->guide_count = guide_count;
  add_entries(d, report, criterion);
  if (report->entry_count == 1) add_robust_line(d, report->entries[0].choice, criterion);
  for (size_t k = 0; k < PICKS; k++) add_picks(d, report, k, criterion);
}

/* The set's one Rp as a line, as the text names it. */
static size_t set_guide(const scree_choice_report *report, char *text, size_t size,
                        scree_guide *guide) {
  if (report->entry_count < 2 || !report->set) return 0;
  double rp = report->set->paper.rp;
  char number[SCREE_NUMBER_SIZE];
  snprintf(text, size, "paper's for the set: %s", scree_rp_text(rp, number));
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

scree_status scree_choice_figure_write(const void *what, const char *path, bool overwrite,
                                       scree_error *error) {
  const scree_choice_report *report = what;
  if (report->entry_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no object to draw", path);
  scree_drawing d = {0};
  char guide_text[64], missing[64], note[NOTE_BYTES];
  scree_guide guide;
  size_t guide_count = set_guide(report, guide_text, sizeof guide_text, &guide);
  for (int p = 0; p < 2; p++) add_panel(&d, report, p == 1, &guide, guide_count);
  snprintf(note, sizeof note, "scree %s, method %s, w = %g, reference area: %s%s", scree_version(),
           scree_method_name(report->method), report->options->weight, reference_text(report),
           missing_text(report, missing));
  scree_figure figure = {.panel_width = PANEL_WIDTH, .panel_height = PANEL_HEIGHT, .note = note};
  return scree_drawing_write(&d, figure, path, overwrite, error);
}
