/* What a choice says in sentences. The text for people, the JSON and the page all have them from
 * here, so that none tells what another keeps silent about. */
#include "base/number.h"
#include "report/choice.h"
#include "report/program.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Above this ratio of counts two choices are said to differ. */
static const double NOTABLE_RATIO = 1.5;
/* The paper's scans have some 760,000 triangles; beyond this factor from it, or between objects,
 * the dependence on resolution is said. */
static const double PAPER_COUNT = 762008, NOTABLE_RESOLUTION = 3;
/* And it is none where the count would hardly change. */
static const double NOTABLE_GROWTH = 0.1;
/* A width that changes by more is told with the count. */
static const double NOTABLE_WIDTH = 0.02;
/* Mean angle of the normals over pi (18 degrees): what stands out less than the distances allowed
 * is flattened. */
static const double NOTABLE_NORMALS = 0.1;
/* Noise above this share of the tolerance on the mean distance takes part in it. */
static const double NOTABLE_NOISE = 0.3;
/* A level with more of the scan's triangles than this is hardly coarser than the scan. */
static const double NOTABLE_SHARE = 0.5;
/* A distance of less, as a share of the size, is none. */
static const double ROUNDING = 1e-9;
/* Thinner bodies, as shares of the size, of which no walls were found are foils. */
static const double FOIL = 0.01;
/* Walls that a level has no more of than this are said to be gone. */
static const double GONE = 0.01;
/* The cost of a particle-step in a flowing heap, over that of 100 triangles: 2.5 at 1,500. */
static const double COST_RISE = 1.5 / 1400, COST_START = 100;
/* The paper's coarsest levels; a floor above is worth a word. */
enum { PAPER_FLOOR = 8, NUMBER_BYTES = SCREE_NUMBER_SIZE };

typedef struct sentences {
  char (*texts)[SCREE_CHOICE_SENTENCE_BYTES];
  size_t count;
} sentences;

SCREE_PRINTF(2, 3) static void say(sentences *s, const char *format, ...) {
  if (s->count == SCREE_CHOICE_SENTENCES) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(s->texts[s->count++], SCREE_CHOICE_SENTENCE_BYTES, format, arguments);
  va_end(arguments);
}

/* With so many digits, whatever the locale. */
static const char *number_text(double value, int digits, char buffer[NUMBER_BYTES]) {
  scree_number_format_digits(value, digits, buffer);
  return buffer;
}
#define NUMBER(value, digits) number_text(value, digits, (char[NUMBER_BYTES]){0})

/* A fraction as a change in per cent: +1.2, -3 */
static const char *change_text(double fraction, char buffer[NUMBER_BYTES]) {
  int digits = fabs(fraction) < 0.995 ? 2 : 6; /* no powers of ten */
  if (fabs(fraction) < ROUNDING) fraction = 0;
  buffer[0] = '+';
  scree_number_format_digits(100 * fraction, digits, buffer + (fraction >= 0));
  return buffer;
}
#define CHANGE(fraction) change_text(fraction, (char[NUMBER_BYTES]){0})

static double ratio(double a, double b) {
  return a > b ? a / b : b / a;
}

static bool is_recommended(const scree_choice_report *report, const scree_choice *choice) {
  return report->rule == SCREE_RULE_RECOMMENDED && choice->fidelity;
}

/* ---- The answer ---- */

static const char *error_words(scree_shape_error which) {
  static const char *const words[] = {
      [SCREE_ERROR_AREA] = "the area",
      [SCREE_ERROR_VOLUME] = "the volume",
      [SCREE_ERROR_HAUSDORFF] = "the largest distance",
      [SCREE_ERROR_MEAN] = "the mean distance",
      [SCREE_ERROR_INERTIA] = "the inertia",
      [SCREE_ERROR_WIDTHS] = "the widths",
      [SCREE_ERROR_THICKNESS] = "the distance over the walls' thickness",
      [SCREE_ERROR_THINNEST] = "the thinnest walls",
      [SCREE_ERROR_CONVEXITY] = "the convexity",
      [SCREE_ERROR_NORMALS] = "the normals",
  };
  return words[which];
}

static double cost_of(size_t triangle_count) {
  return 1 + COST_RISE * ((double)triangle_count - COST_START);
}

/* A length in mm from a share of the scan's size. */
static const char *length_text(const scree_choice *c, double share, char buffer[NUMBER_BYTES]) {
  double length = share * scree_fidelity_scan(c->fidelity, SCREE_SCAN_LENGTH);
  return number_text(share < ROUNDING ? 0 : 1e3 * length, 2, buffer);
}
#define LENGTH(choice, share) length_text(choice, share, (char[NUMBER_BYTES]){0})

static bool is_distance(scree_shape_error which) {
  return which == SCREE_ERROR_MEAN || which == SCREE_ERROR_HAUSDORFF;
}

/* What the next coarser level is refused for, and how much of it is allowed: a distance in mm. */
static void say_limit(sentences *s, const scree_choice_report *report, const scree_choice *c) {
  double error = scree_fidelity_error(c->fidelity, c->recommended_row, c->limited_by),
         most = scree_choice_tolerance(c, report->options, c->limited_by);
  const bool last = isnan(c->limit_beyond);
  const char *how = last ? "There is no coarser level; nearest to its tolerance is" : "Limited by",
             *where = last ? "" : " at the next coarser level";
  char share[NUMBER_BYTES], limit[NUMBER_BYTES];
  if (error < ROUNDING) say(s, "The surface is the scan's; no coarser level keeps all tolerances.");
  if (!last) error = c->limit_beyond;
  if (error < ROUNDING) return;
  if (is_distance(c->limited_by))
    say(s, "%s %s, %s mm%s of %s mm allowed, which is %s of the body's size of %s mm.", how,
        error_words(c->limited_by), LENGTH(c, error), where, LENGTH(c, most),
        scree_percent_text(most, limit),
        NUMBER(1e3 * scree_fidelity_scan(c->fidelity, SCREE_SCAN_LENGTH), 3));
  else
    say(s, "%s %s, %s%s of %s allowed.", how, error_words(c->limited_by),
        scree_percent_text(error, share), where, scree_percent_text(most, limit));
}

/* The power of ten, in m, that a place on a body of that size is told to: a thousandth or so. */
static double place_step(double size) {
  return pow(10, floor(log10(1e-3 * size) + 1e-9));
}

/* In mm, rounded to the step; no more digits than that step has. */
static const char *place_text(double metres, double step, char buffer[NUMBER_BYTES]) {
  double rounded = step * round(metres / step);
  scree_number_format_digits(1e3 * rounded + 0.0, 9, buffer);
  return buffer;
}
#define PLACE(metres, step) place_text(metres, step, (char[NUMBER_BYTES]){0})

/* What of the dimensions is another than the scan's, a sentence each; name: "" or "NAME: ". */
static void say_widths(sentences *s, const char *name, const scree_choice *c) {
  static const char *const sides[] = {"length", "width", "height"};
  for (int i = 0; i < 3; i++) {
    double change = scree_fidelity_change(c->fidelity, c->recommended_row,
                                          (scree_shape_change)(SCREE_CHANGE_LENGTH + i)),
           side =
               1e3 * scree_fidelity_scan(c->fidelity, (scree_scan_fact)(SCREE_SCAN_BOX_LENGTH + i));
    if (fabs(change) > NOTABLE_WIDTH)
      say(s, "%s%s %s is %s mm, not %s mm, %s %% (--tolerance widths=1%% keeps it).", name,
          *name ? "the" : "The", sides[i], NUMBER(side * (1 + change), 4), NUMBER(side, 4),
          CHANGE(change));
  }
}

/* m; 0: it is no foil. The thickness of a foil counts as no error. */
static double foil_thickness(const scree_choice *c) {
  const scree_fidelity *f = c->fidelity;
  double usual = 2 * fabs(c->volume) / c->area;
  bool foil = isnan(scree_fidelity_scan(f, SCREE_SCAN_THICKNESS)) &&
              usual < FOIL * scree_fidelity_scan(f, SCREE_SCAN_LENGTH);
  return foil ? usual : 0;
}

static void say_recommended(sentences *s, const scree_choice_report *report,
                            const scree_choice *c) {
  const scree_fidelity *f = c->fidelity;
  const scree_pick *pick = &c->recommended;
  size_t row = c->recommended_row;
  double at[3], foil = foil_thickness(c), mean = scree_fidelity_error(f, row, SCREE_ERROR_MEAN),
                thinnest = scree_fidelity_change(f, row, SCREE_CHANGE_THINNEST),
                step = place_step(scree_fidelity_scan(f, SCREE_SCAN_LENGTH));
  char count[NUMBER_BYTES], rp[NUMBER_BYTES], share[NUMBER_BYTES], walls[96] = "";
  scree_fidelity_farthest(f, row, at);
  if (foil > 0)
    snprintf(walls, sizeof walls, "in the mean %s of this foil's thickness of about %s mm; ",
             scree_percent_text(mean * scree_fidelity_scan(f, SCREE_SCAN_LENGTH) / foil, share),
             NUMBER(1e3 * foil, 2));
  else if (isfinite(thinnest) && 1 + thinnest < GONE)
    snprintf(walls, sizeof walls, "of the thinnest walls, %s mm, some are gone; ",
             NUMBER(1e3 * scree_fidelity_scan(f, SCREE_SCAN_THINNEST), 2));
  else if (isfinite(thinnest))
    snprintf(walls, sizeof walls, "thinnest walls %s mm, %s %%; ",
             NUMBER(1e3 * (1 + thinnest) * scree_fidelity_scan(f, SCREE_SCAN_THINNEST), 2),
             CHANGE(thinnest));
  say(s, "Use %s triangles (Rp = %s): surface %s mm off in the mean, %s mm at worst.",
      scree_count_text(pick->triangle_count, count), scree_rp_text(pick->rp, rp), LENGTH(c, mean),
      LENGTH(c, scree_fidelity_error(f, row, SCREE_ERROR_HAUSDORFF)));
  say(s, "Worst at %s, %s, %s mm; %sinertia %s %%, area %s %%.", PLACE(at[0], step),
      PLACE(at[1], step), PLACE(at[2], step), walls,
      CHANGE(scree_fidelity_change(f, row, SCREE_CHANGE_INERTIA)),
      CHANGE(pick->area / c->area - 1));
  say_widths(s, "", c);
  say_limit(s, report, c);
}

bool scree_choice_cost(const scree_choice *c, char text[SCREE_CHOICE_SENTENCE_BYTES]) {
  double slower = cost_of(c->recommended.triangle_count) / cost_of(c->paper.triangle_count);
  char other[NUMBER_BYTES];
  snprintf(text, SCREE_CHOICE_SENTENCE_BYTES,
           "In a flowing heap it takes about %s times as long to simulate as the paper's %s "
           "triangles.",
           NUMBER(slower, 2), scree_count_text(c->paper.triangle_count, other));
  return slower >= 1.05;
}

static void say_by_area(sentences *s, const scree_choice_report *report, const scree_choice *c) {
  const scree_pick *pick = scree_choice_pick(c, report->rule);
  char count[NUMBER_BYTES], rp[NUMBER_BYTES], percent[NUMBER_BYTES], low[NUMBER_BYTES],
      high[NUMBER_BYTES];
  say(s, "Use %s triangles (Rp = %s): area within %s of the scan's.",
      scree_count_text(pick->triangle_count, count),
      scree_rp_text(scree_report_pick_rp(c, pick), rp), scree_percent_text(pick->eps_s, percent));
  if (pick->most > pick->fewest)
    say(s, "From %s up to %s triangles there are levels with an Ip within a tenth of it.",
        scree_count_text(pick->fewest, low), scree_count_text(pick->most, high));
}

/* The level of an object at the set's Rp, which lies on the grid. */
static const scree_choice_level *level_at(const scree_choice *c, double rp) {
  size_t k = 0;
  while (k + 1 < c->level_count && c->levels[k].rp < rp * (1 - 1e-9)) k++;
  return &c->levels[k];
}

/* Counts and errors at the set's Rp. */
static void say_common_rp(sentences *s, const scree_choice_report *report) {
  size_t least = SIZE_MAX, most = 0;
  double worst = 0, rp = report->set->paper.rp;
  for (size_t i = 0; i < report->entry_count; i++) {
    const scree_choice_level *level = level_at(report->entries[i].choice, rp);
    if (level->triangle_count < least) least = level->triangle_count;
    if (level->triangle_count > most) most = level->triangle_count;
    worst = fmax(worst, level->eps_s);
  }
  char rp_buffer[NUMBER_BYTES], low[NUMBER_BYTES], high[NUMBER_BYTES], percent[NUMBER_BYTES];
  say(s, "Use Rp = %s for the set: %s%s%s triangles%s, area within %s.",
      scree_rp_text(rp, rp_buffer), scree_count_text(least, low), least < most ? " to " : "",
      least < most ? scree_count_text(most, high) : "", least < most ? "" : " each",
      scree_percent_text(worst, percent));
}

static void say_set(sentences *s, const scree_choice_report *report) {
  const scree_set_pick *pick = &report->set->paper;
  char low[NUMBER_BYTES], high[NUMBER_BYTES];
  if (!is_recommended(report, report->entries[0].choice)) {
    say_common_rp(s, report);
    if (pick->rp_high > pick->rp_low)
      say(s, "From Rp = %s up to %s there are levels with an Ip within a tenth of the least.",
          scree_rp_text(pick->rp_low, low), scree_rp_text(pick->rp_high, high));
    return;
  }
  size_t least = SIZE_MAX, most = 0;
  for (size_t i = 0; i < report->entry_count; i++) {
    size_t count = report->entries[i].choice->recommended.triangle_count;
    if (count < least) least = count;
    if (count > most) most = count;
  }
  say(s, "Use each shape's own count, %s%s%s triangles: all keep the same tolerances.",
      scree_count_text(least, low), least < most ? " to " : "",
      least < most ? scree_count_text(most, high) : "");
  for (size_t i = 0; i < report->entry_count; i++) {
    char name[64];
    snprintf(name, sizeof name, "%.60s: ", report->entries[i].name);
    say_widths(s, name, report->entries[i].choice);
  }
}

size_t scree_choice_answer(const scree_choice_report *report, size_t entry,
                           char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES]) {
  sentences s = {texts, 0};
  if (entry == report->entry_count) {
    say_set(&s, report);
    return s.count;
  }
  const scree_choice *c = report->entries[entry].choice;
  if (is_recommended(report, c))
    say_recommended(&s, report, c);
  else
    say_by_area(&s, report, c);
  return s.count;
}

void scree_choice_sentence(const scree_choice *choice, const scree_choice_options *options,
                           char text[SCREE_CHOICE_SENTENCE_BYTES]) {
  char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES];
  scree_choice_entry entry = {.choice = choice};
  scree_choice_report report = {.entries = &entry,
                                .entry_count = 1,
                                .options = options,
                                .rule =
                                    options->area_only ? SCREE_RULE_PAPER : SCREE_RULE_RECOMMENDED};
  scree_choice_answer(&report, 0, texts);
  memcpy(text, texts[0], SCREE_CHOICE_SENTENCE_BYTES);
}

/* ---- Warnings ---- */

static void warn_of_losses(sentences *s, const scree_choice_report *report, const scree_choice *c) {
  const scree_fidelity *f = c->fidelity;
  size_t row = c->recommended_row;
  char count[NUMBER_BYTES];
  double normals = scree_fidelity_error(f, row, SCREE_ERROR_NORMALS);
  if (normals > NOTABLE_NORMALS)
    say(s,
        "Relief is flattened: normals are %s degrees off in the mean (--tolerance normals=5%% "
        "keeps more).",
        NUMBER(180 * normals, 2));
  double noise = scree_fidelity_scan(f, SCREE_SCAN_NOISE),
         length = scree_fidelity_scan(f, SCREE_SCAN_LENGTH);
  if (noise > NOTABLE_NOISE * length * scree_choice_tolerance(c, report->options, SCREE_ERROR_MEAN))
    say(s,
        "Scan noise of %s mm takes part in the mean distance and in the area: the count is more "
        "than the shape needs.",
        NUMBER(1e3 * noise, 2));
  double foil = foil_thickness(c);
  if (foil > 0)
    say(s,
        "A foil of about %s mm: its thickness counts as no error (--tolerance mean=%smm keeps it).",
        NUMBER(1e3 * foil, 2), NUMBER(1e2 * foil, 1));
  if ((double)c->recommended.triangle_count > NOTABLE_SHARE * (double)c->triangle_count)
    say(s, "Most of the scan's %s triangles are needed for these tolerances.",
        scree_count_text(c->triangle_count, count));
}

static void warn_of_accidents(sentences *s, const scree_choice *c) {
  double differ = ratio((double)c->paper.triangle_count, (double)c->robust.triangle_count);
  if (c->paper_is_accident)
    say(s, "The paper's choice is an accident: the area crosses the scan's there; finer meshes are "
           "further off.");
  else if (differ > NOTABLE_RATIO)
    say(s, "The paper's and the robust choice differ %s times.", NUMBER(differ, 2));
}

/* Said of an object, or of the set, where noise is more of the area than the error chosen by. */
static void warn_of_noise(sentences *s, const scree_choice_report *report, size_t entry) {
  bool set = entry == report->entry_count;
  double most = 0;
  char percent[NUMBER_BYTES];
  for (size_t i = set ? 0 : entry; i < (set ? entry : entry + 1); i++) {
    const scree_choice *c = report->entries[i].choice;
    if (c->noise.found && c->noise.fraction > scree_choice_pick(c, report->rule)->eps_s)
      most = fmax(most, c->noise.fraction);
  }
  if (most > 0 && report->options->reference == SCREE_REFERENCE_SCAN)
    say(s, "Scan noise adds up to %s of area and misleads eps_s: --area smooth takes it out.",
        scree_percent_text(most, percent));
}

/* How many times the triangles at half the spacing, by the paper's criterion. */
static double growth_of(const scree_choice_report *report, size_t entry) {
  if (entry == report->entry_count) return report->set->paper_growth;
  const scree_choice *c = report->entries[entry].choice;
  return (double)c->paper_finer_count / (double)c->paper.triangle_count;
}

static void warn_of_resolution(sentences *s, const scree_choice_report *report, size_t entry) {
  double least = INFINITY, most = 0, growth = growth_of(report, entry);
  bool set = entry == report->entry_count;
  for (size_t i = set ? 0 : entry; i < (set ? entry : entry + 1); i++) {
    const scree_choice *c = report->entries[i].choice;
    least = fmin(least, (double)c->triangle_count);
    most = fmax(most, (double)c->triangle_count);
  }
  bool unlike = ratio(most, least) > NOTABLE_RESOLUTION ||
                ratio(least, PAPER_COUNT) > NOTABLE_RESOLUTION ||
                ratio(most, PAPER_COUNT) > NOTABLE_RESOLUTION;
  if (unlike && fabs(growth - 1) >= NOTABLE_GROWTH)
    say(s,
        "At half the scan's spacing Nr would be about %.*f times this, if the curve stays as it "
        "is.",
        growth < 9.95, growth);
}

static void warn_of_floor(sentences *s, const scree_choice_report *report, size_t entry) {
  const scree_choice_entry *e = &report->entries[entry];
  char count[NUMBER_BYTES], rp[NUMBER_BYTES];
  if (!e->choice->levels[0].reached && e->choice->floor_count > PAPER_FLOOR)
    say(s, "Rp = %s was not reached: %s stops at %s triangles.",
        scree_rp_text(report->options->rp_min, rp), e->name,
        scree_count_text(e->choice->floor_count, count));
}

/* Each line of a note. */
static void say_lines(sentences *s, const char *note) {
  while (note && *note) {
    size_t length = strcspn(note, "\n");
    say(s, "%.*s", (int)length, note);
    note += length + (note[length] == '\n');
  }
}

size_t scree_choice_warnings(const scree_choice_report *report, size_t entry,
                             char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES]) {
  sentences s = {texts, 0};
  bool set = entry == report->entry_count;
  bool recommended = is_recommended(report, report->entries[set ? 0 : entry].choice);
  if (!set) say_lines(&s, report->entries[entry].note);
  if (set || report->entry_count == 1) say_lines(&s, report->note);
  if (!set && recommended) warn_of_losses(&s, report, report->entries[entry].choice);
  if (!recommended) {
    if (!set) warn_of_accidents(&s, report->entries[entry].choice);
    warn_of_noise(&s, report, entry);
    warn_of_resolution(&s, report, entry);
  }
  if (!set && !recommended) warn_of_floor(&s, report, entry);
  return s.count;
}
