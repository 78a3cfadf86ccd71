/* The answer for people: one row per object, one for the set, and what to do. Nine objects fit a
 * screen of 80 x 24. */
#include "cli/choose.h"

#include <math.h>
#include <string.h>

/* Above this ratio of counts two choices are said to differ. */
static const double NOTABLE_RATIO = 1.5;
/* The paper's scans have some 760,000 triangles; beyond this factor from it, or between objects,
 * the dependence on resolution is said. */
static const double PAPER_COUNT = 762008, NOTABLE_RESOLUTION = 3;
/* And it is none where the count would hardly change. */
static const double NOTABLE_GROWTH = 0.1;

/* The paper's coarsest levels; a floor above is worth a word. */
enum { PAPER_FLOOR = 8 };

static double ratio(double a, double b) {
  return a > b ? a / b : b / a;
}

/* 0.00123 as 1.2e-3 */
static const char *rp_text(double rp, char buffer[16]) {
  int exponent = (int)floor(log10(rp) + 1e-9);
  double digits = rp / pow(10, exponent);
  if (digits >= 9.95) {
    digits /= 10;
    exponent++;
  }
  if (exponent >= -1)
    snprintf(buffer, 16, "%.2f", rp);
  else
    snprintf(buffer, 16, "%.1fe%d", digits, exponent);
  return buffer;
}

static const char *percent_text(double fraction, char buffer[16]) {
  double percent = 100 * fraction;
  snprintf(buffer, 16, percent < 0.095 ? "%.3f%%" : percent < 9.95 ? "%.2f%%" : "%.0f%%", percent);
  return buffer;
}

/* The grid's Rp, or the level's own where the grid's was not reached. */
static double rp_of(const scree_choice *choice, const scree_pick *pick) {
  return fmax(pick->rp, (double)pick->triangle_count / (double)choice->triangle_count);
}

static void print_row(FILE *out, const choose_run *run, size_t index) {
  const scree_choice *c = &run->choices[index];
  char scan[32], n1[32], n2[32], rp1[16], rp2[16], e1[16], e2[16], noise[16];
  cli_print_cell(out, run->objects[index].name, 12, 12);
  fprintf(out, "%10s%7s |%7s%7s%8s%c|%7s%7s%8s\n", cli_count_text(c->triangle_count, scan),
          c->noise.found ? percent_text(c->noise.fraction, noise) : "-",
          rp_text(rp_of(c, &c->paper), rp1), cli_count_text(c->paper.triangle_count, n1),
          percent_text(c->paper.eps_s, e1), c->paper_is_accident ? '*' : ' ',
          rp_text(c->robust.rp, rp2), cli_count_text(c->robust.triangle_count, n2),
          percent_text(c->robust.eps_s, e2));
}

/* What eps_s is measured against, where that is not the scan's area by itself. */
static const char *reference_text(const choose_run *run) {
  size_t found = 0;
  for (size_t i = 0; i < run->count; i++) found += run->choices[i].noise.found;
  if (run->options.reference == SCREE_REFERENCE_SCAN) return "";
  return found == run->count ? ", area free of noise"
         : found             ? ", area free of noise where some was found"
                             : ", the scan's area: no noise was found";
}

static void print_table(FILE *out, const choose_run *run) {
  char rp1[16], rp2[16];
  fprintf(out, "Ip = eps_s + %g Nr/Nm, method %s%s, coordinates in %s\n", run->options.weight,
          scree_method_name(run->simplify.method), reference_text(run),
          cli_unit_name(run->arguments->source.unit));
  fprintf(out, "%30s%-24s| %s\n", "",
          run->arguments->paper ? "| paper (default)" : "| paper's grid",
          run->arguments->paper ? "robust" : "robust (default)");
  fprintf(out, "%-12s%10s%7s |%7s%7s%8s |%7s%7s%8s\n", "object", "triangles", "noise", "Rp", "Nr",
          "eps_s", "Rp", "Nr", "worst");
  for (size_t i = 0; i < run->count; i++) print_row(out, run, i);
  if (run->count > 1)
    fprintf(out, "%-30s|%7s%16s|%7s\n", "the set (least mean Ip)", rp_text(run->set.paper.rp, rp1),
            "", rp_text(run->set.robust.rp, rp2));
}

void choose_print_failed(FILE *out, const choose_run *run) {
  char shown[CLI_PRINTABLE_BYTES];
  fputs("Without ", out);
  for (size_t i = 0; i < run->failed_count; i++)
    fprintf(out, "%s%s", i ? ", " : "", cli_printable(run->objects[run->count + i].word, shown));
  if (run->count > 1)
    fprintf(out, ", which could not be used: the set's choice is of the other %zu.\n", run->count);
  else
    fputs(", which could not be used: there is no set to choose for.\n", out);
}

/* The level of an object at the set's Rp, which lies on the grid by the paper's rule and on the
 * trace by the robust one. */
static const scree_choice_level *level_at(const choose_run *run, size_t index, double rp) {
  const scree_choice *c = &run->choices[index];
  bool grid = run->arguments->paper;
  const scree_choice_level *levels = grid ? c->levels : c->trace;
  size_t count = grid ? c->level_count : c->trace_count, k = 0;
  while (k + 1 < count && levels[k].rp < rp * (1 - 1e-9)) k++;
  return &levels[k];
}

/* The range of counts and errors at the set's Rp. */
static void print_set_advice(FILE *out, const choose_run *run) {
  size_t least = SIZE_MAX, most = 0;
  double worst = 0, rp = choose_default_set_pick(run, &run->set)->rp;
  for (size_t i = 0; i < run->count; i++) {
    const scree_choice_level *level = level_at(run, i, rp);
    if (level->triangle_count < least) least = level->triangle_count;
    if (level->triangle_count > most) most = level->triangle_count;
    worst = fmax(worst, run->arguments->paper ? level->eps_s : level->worst_eps_s);
  }
  char rp_buffer[16], low[32], high[32], percent[16];
  fprintf(out, "Use Rp = %s for the set: %s%s%s triangles%s, area within %s.\n",
          rp_text(rp, rp_buffer), cli_count_text(least, low), least < most ? " to " : "",
          least < most ? cli_count_text(most, high) : "", least < most ? "" : " each",
          percent_text(worst, percent));
}

/* How sharp the choice is. */
static void print_similar(FILE *out, const choose_run *run) {
  char low[32], high[32];
  if (run->count > 1) {
    const scree_set_pick *pick = choose_default_set_pick(run, &run->set);
    if (pick->rp_high > pick->rp_low)
      fprintf(out,
              "From Rp = %s up to %s there are levels with an Ip within a tenth of the least.\n",
              rp_text(pick->rp_low, low), rp_text(pick->rp_high, high));
    return;
  }
  const scree_pick *pick = choose_default_pick(run, &run->choices[0]);
  if (pick->most > pick->fewest)
    fprintf(out, "From %s up to %s triangles there are levels with an Ip within a tenth of it.\n",
            cli_count_text(pick->fewest, low), cli_count_text(pick->most, high));
}

static void print_advice(FILE *out, const choose_run *run) {
  const scree_choice *c = &run->choices[0];
  char count[32], rp[16], percent[16];
  if (run->count > 1) {
    print_set_advice(out, run);
    return;
  }
  const scree_pick *pick = choose_default_pick(run, c);
  fprintf(out, "Use %s triangles (Rp = %s): area within %s of the scan's.\n",
          cli_count_text(pick->triangle_count, count), rp_text(rp_of(c, pick), rp),
          percent_text(run->arguments->paper ? pick->level_eps_s : pick->eps_s, percent));
}

static void print_accidents(FILE *out, const choose_run *run) {
  size_t accidents = 0, differ = 0;
  for (size_t i = 0; i < run->count; i++) {
    const scree_choice *c = &run->choices[i];
    accidents += c->paper_is_accident;
    differ +=
        ratio((double)c->paper.triangle_count, (double)c->robust.triangle_count) > NOTABLE_RATIO;
  }
  if (accidents)
    fputs("* by accident: the area crosses the scan's there; finer meshes are further off.\n", out);
  else if (differ)
    fprintf(out, "Grid and robust choice differ by more than %.1f times for %zu of %zu.\n",
            NOTABLE_RATIO, differ, run->count);
}

/* Said where the choice would be another: the object's, or the set's. */
static void print_noise(FILE *out, const choose_run *run) {
  const scree_choice *c = &run->choices[0];
  double most = 0;
  bool moved = run->count > 1 ? ratio(run->set.smooth.rp, run->set.robust.rp) > NOTABLE_RATIO
                              : ratio((double)c->smooth.triangle_count,
                                      (double)c->robust.triangle_count) > NOTABLE_RATIO;
  for (size_t i = 0; i < run->count; i++)
    if (run->choices[i].noise.found) most = fmax(most, run->choices[i].noise.fraction);
  char percent[16], rp[16];
  if (moved && most > 0 && run->options.reference == SCREE_REFERENCE_SCAN)
    fprintf(out,
            "Scan noise adds up to %s of area and misleads eps_s: --reference smooth takes it\n"
            "out and gives Rp = %s.\n",
            percent_text(most, percent),
            rp_text(run->count > 1 ? run->set.smooth.rp : run->choices[0].smooth.rp, rp));
}

/* How many times the triangles at half the spacing, by the choice that meshes are written by. */
static double growth_of(const choose_run *run) {
  const scree_choice *c = &run->choices[0];
  bool paper = run->arguments->paper;
  if (run->count > 1) return paper ? run->set.paper_growth : run->set.robust_growth;
  return (double)(paper ? c->paper_finer_count : c->finer_count) /
         (double)choose_default_pick(run, c)->triangle_count;
}

static void print_resolution(FILE *out, const choose_run *run) {
  double least = INFINITY, most = 0, growth = growth_of(run);
  for (size_t i = 0; i < run->count; i++) {
    const scree_choice *c = &run->choices[i];
    least = fmin(least, (double)c->triangle_count);
    most = fmax(most, (double)c->triangle_count);
  }
  bool unlike = ratio(most, least) > NOTABLE_RESOLUTION ||
                ratio(least, PAPER_COUNT) > NOTABLE_RESOLUTION ||
                ratio(most, PAPER_COUNT) > NOTABLE_RESOLUTION;
  if (unlike && fabs(growth - 1) >= NOTABLE_GROWTH)
    fprintf(out,
            "At half the scan's spacing Nr would be about %.*f times this, if the curve stays as "
            "it is.\n",
            growth < 9.95, growth);
}

static void print_floor(FILE *out, const choose_run *run) {
  size_t index = run->count;
  for (size_t i = 0; i < run->count; i++)
    if (!run->choices[i].levels[0].reached && run->choices[i].floor_count > PAPER_FLOOR &&
        (index == run->count || run->choices[i].floor_count > run->choices[index].floor_count))
      index = i;
  char count[32], rp[16];
  if (index < run->count)
    fprintf(out, "Rp = %s was not reached%s: %s stops at %s triangles.\n",
            rp_text(run->options.rp_min, rp), run->count > 1 ? " by all" : "",
            run->objects[index].name, cli_count_text(run->choices[index].floor_count, count));
}

static void print_notes(FILE *out, const choose_run *run) {
  for (size_t i = 0; i < run->count; i++)
    if (run->objects[i].note[0])
      fprintf(out, "%s: %s\n", run->objects[i].name, run->objects[i].note);
}

/* Where other errors were asked for: the grid's choice by each. */
static void print_other_errors(FILE *out, const choose_run *run) {
  if (!run->arguments->errors && !run->arguments->distances) return;
  fprintf(out, "\nRp of the least error + Nr/Nm on the grid, by other errors than area:\n%-13s",
          "object");
  for (int e = 1; e < SCREE_SHAPE_ERROR_COUNT; e++)
    fprintf(out, "%14s", scree_shape_error_name((scree_shape_error)e));
  putc('\n', out);
  for (size_t i = 0; i < run->count; i++) {
    const scree_choice *c = &run->choices[i];
    cli_print_cell(out, run->objects[i].name, 13, 13);
    for (int e = 1; e < SCREE_SHAPE_ERROR_COUNT; e++) {
      char rp[16];
      bool known = c->best[e] < c->level_count;
      fprintf(out, "%14s", known ? rp_text(c->levels[c->best[e]].rp, rp) : "-");
    }
    putc('\n', out);
  }
}

void choose_print(FILE *out, const choose_run *run) {
  print_table(out, run);
  putc('\n', out);
  if (run->failed_count) choose_print_failed(out, run);
  print_advice(out, run);
  print_similar(out, run);
  print_accidents(out, run);
  print_noise(out, run);
  print_resolution(out, run);
  print_floor(out, run);
  print_notes(out, run);
  const char *folder = run->arguments->output;
  char shown[CLI_PRINTABLE_BYTES];
  if (folder)
    fprintf(out,
            "In %s: report.html, %s, figure.png, choice.json\n"
            "*.mass.json: mass, centre, inertia at %g kg/m3. Placed otherwise: scree export\n",
            cli_printable(folder, shown),
            run->count > 1 ? "*.stl (own choice), set/*.stl" : "*.stl", run->arguments->density);
  print_other_errors(out, run);
}
