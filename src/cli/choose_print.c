/* The answer for people: one row per object, one for the set, and what to do. Nine objects fit a
 * screen of 80 x 24. */
#include "base/number.h"
#include "cli/choose.h"
#include "report/program.h"

static void print_row(FILE *out, const choose_run *run, size_t index) {
  const scree_choice *c = &run->choices[index];
  const scree_fidelity *f = c->fidelity;
  char scan[32], n[4][32], share[3][SCREE_NUMBER_SIZE];
  cli_print_cell(out, run->objects[index].name, 12, 12);
  fprintf(
      out, "%10s |%7s%7s%8s |%7s%7s%c |%7s |%6s\n", scree_count_text(c->triangle_count, scan),
      scree_count_text(c->recommended.triangle_count, n[0]),
      scree_percent_text(scree_fidelity_error(f, c->recommended_row, SCREE_ERROR_MEAN), share[0]),
      scree_percent_text(scree_fidelity_error(f, c->recommended_row, SCREE_ERROR_HAUSDORFF),
                         share[1]),
      scree_count_text(c->paper.triangle_count, n[1]), scree_percent_text(c->paper.eps_s, share[2]),
      c->paper_is_accident ? '*' : ' ', scree_count_text(c->robust.triangle_count, n[2]),
      scree_count_text(c->cost.triangle_count, n[3]));
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

/* What the columns are. */
static void print_legend(FILE *out, const choose_run *run) {
  bool accident = false;
  for (size_t i = 0; i < run->count; i++) accident |= run->choices[i].paper_is_accident;
  fprintf(out,
          "recommended: fewest within tolerances of the distance to the scan, mean and largest\n"
          "paper: least Ip = eps_s + %g Nr/Nm, eps_s the error of area%s%s\n"
          "robust: the same, by the largest eps_s of this and all finer levels\n"
          "cost: least mean distance, over the body's size, + Nr/%g\n",
          run->options.weight, reference_text(run),
          accident ? " (* small by accident: finer levels are worse)" : "", SCREE_COST_COUNT);
  fprintf(out, "What follows and the files written are by: %s\n",
          scree_choice_rule_name(run->report.rule));
}

static void print_table(FILE *out, const choose_run *run) {
  char rp[SCREE_NUMBER_SIZE];
  fprintf(out, "Nr: triangles to use, of the Nm of the scan. Decimation by %s; coordinates in %s\n",
          scree_method_name(run->simplify.method), cli_unit_name(run->arguments->source.unit));
  fprintf(out, "%-22s |%-22s |%-15s |%7s |%6s\n", "", " recommended", " paper", "robust", "cost");
  fprintf(out, "%-12s%10s |%7s%7s%8s |%7s%7s  |%7s |%6s\n", "object", "triangles", "Nr", "mean",
          "largest", "Nr", "eps_s", "Nr", "Nr");
  for (size_t i = 0; i < run->count; i++) print_row(out, run, i);
  if (run->count > 1)
    fprintf(out, "the set, by the paper's criterion: one Rp = %s\n",
            scree_rp_text(run->set.paper.rp, rp));
}

/* Where other errors were asked for: the grid's choice by each. */
static void print_other_errors(FILE *out, const choose_run *run) {
  if (!run->arguments->errors) return;
  fprintf(out, "\nRp of the least error + Nr/Nm on the grid, by other errors than area:\n%-13s",
          "object");
  for (int e = 1; e < SCREE_SHAPE_ERROR_COUNT; e++)
    fprintf(out, "%14s", scree_shape_error_name((scree_shape_error)e));
  putc('\n', out);
  for (size_t i = 0; i < run->count; i++) {
    const scree_choice *c = &run->choices[i];
    cli_print_cell(out, run->objects[i].name, 13, 13);
    for (int e = 1; e < SCREE_SHAPE_ERROR_COUNT; e++) {
      char rp[SCREE_NUMBER_SIZE];
      bool known = c->best[e] < c->level_count;
      fprintf(out, "%14s", known ? scree_rp_text(c->levels[c->best[e]].rp, rp) : "-");
    }
    putc('\n', out);
  }
}

/* What the report and the JSON say, too; those of the set have no name before them. */
void choose_print_warnings(FILE *out, const choose_run *run) {
  char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES];
  size_t count = run->count > 1 ? scree_choice_warnings(&run->report, run->count, texts) : 0;
  for (size_t i = 0; i < count; i++) fprintf(out, "%s\n", texts[i]);
  for (size_t k = 0; k < run->count; k++) {
    count = scree_choice_warnings(&run->report, k, texts);
    for (size_t i = 0; i < count; i++) fprintf(out, "%s: %s\n", run->objects[k].name, texts[i]);
  }
}

static void print_answer(FILE *out, const choose_run *run) {
  char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES];
  size_t count = scree_choice_answer(&run->report, run->count > 1 ? run->count : 0, texts);
  for (size_t i = 0; i < count; i++) fprintf(out, "%s\n", texts[i]);
}

void choose_print(FILE *out, const choose_run *run) {
  print_table(out, run);
  print_legend(out, run);
  putc('\n', out);
  print_answer(out, run);
  choose_print_warnings(out, run);
  const char *folder = run->arguments->output;
  char shown[CLI_PRINTABLE_BYTES];
  if (folder)
    fprintf(
        out,
        "In %s: report.html, %s, %s, choice.json\n"
        "*.mass.json: mass, centre, inertia at %g kg/m3; scree export places a mesh otherwise\n",
        cli_printable(folder, shown), run->count > 1 ? "*.stl (own choice), set/*.stl" : "*.stl",
        choose_first_figure(), run->arguments->density);
  else
    fprintf(out, "Nothing was written: -o DIR writes the meshes and a report.\n");
  print_other_errors(out, run);
}
