/* The answer for people: what to do, and of several objects a row each; at most a dozen lines. With
 * -v, and in choice.txt, all warnings and the paper's choice follow. */
#include "base/number.h"
#include "cli/choose.h"
#include "report/program.h"

enum { MOST_ROWS = 9 }; /* of the short answer */

/* By the rule that is told. */
static void print_row(FILE *out, const choose_run *run, scree_choice_rule rule, size_t index) {
  const scree_choice *c = &run->choices[index];
  const scree_pick *pick = scree_choice_pick(c, rule);
  char scan[32], count[32], share[2][SCREE_NUMBER_SIZE];
  cli_print_cell(out, run->objects[index].name, 24, 24);
  fprintf(out, "%10s%10s", scree_count_text(c->triangle_count, scan),
          scree_count_text(pick->triangle_count, count));
  if (rule == SCREE_RULE_PAPER)
    fprintf(out, "%10s%s\n", scree_percent_text(pick->eps_s, share[0]),
            c->paper_is_accident ? "*" : "");
  else
    fprintf(out, "%10s%10s\n",
            scree_percent_text(
                scree_fidelity_error(c->fidelity, c->recommended_row, SCREE_ERROR_MEAN), share[0]),
            scree_percent_text(
                scree_fidelity_error(c->fidelity, c->recommended_row, SCREE_ERROR_HAUSDORFF),
                share[1]));
}

static void print_table(FILE *out, const choose_run *run, scree_choice_rule rule, size_t rows) {
  bool paper = rule == SCREE_RULE_PAPER;
  fprintf(out, "%-24s%10s%10s%10s%s\n", "object", "triangles", "use", paper ? "eps_s" : "mean",
          paper ? "" : "   largest");
  for (size_t i = 0; i < rows; i++) print_row(out, run, rule, i);
  if (rows < run->count) fprintf(out, "and %zu more, which -v tells\n", run->count - rows);
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

/* The paper's choice, and what the other costs more than it. */
static void print_paper(FILE *out, const choose_run *run) {
  bool accident = false;
  char rp[SCREE_NUMBER_SIZE], text[SCREE_CHOICE_SENTENCE_BYTES];
  for (size_t i = 0; i < run->count; i++) accident |= run->choices[i].paper_is_accident;
  fprintf(out, "\npaper: least Ip = eps_s + %g Nr/Nm, eps_s the error of area%s%s\n",
          run->options.weight, reference_text(run),
          accident ? " (* small by accident: finer levels are worse)" : "");
  print_table(out, run, SCREE_RULE_PAPER, run->count);
  if (run->count > 1)
    fprintf(out, "the set, by the paper's criterion: one Rp = %s\n",
            scree_rp_text(run->set.paper.rp, rp));
  for (size_t i = 0; i < run->count; i++)
    if (scree_choice_cost(&run->choices[i], text))
      fprintf(out, "%s: %s\n", run->objects[i].name, text);
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

void choose_print(FILE *out, const choose_run *run, bool whole) {
  char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES], shown[CLI_PRINTABLE_BYTES];
  const char *folder = run->arguments->output;
  bool all = whole || run->count <= MOST_ROWS;
  size_t count = scree_choice_answer(&run->report, run->count > 1 ? run->count : 0, texts);
  for (size_t i = 0; i < count; i++) fprintf(out, "%s\n", texts[i]);
  if (run->count > 1)
    print_table(out, run, run->report.rule, all ? run->count : (size_t)MOST_ROWS - 1);
  if (whole) choose_print_warnings(out, run);
  if (folder)
    fprintf(out, "In %s: report.html, %s, %s, choice.json; *.mass.json at %g kg/m3\n",
            cli_printable(folder, shown),
            run->count > 1 ? "*.stl (own choice), set/*.stl" : "*.stl", choose_first_figure(),
            run->arguments->density);
  else
    fprintf(out, "Nothing was written: -o DIR writes the meshes and a report.\n");
  if (whole && run->report.rule != SCREE_RULE_PAPER) print_paper(out, run);
  print_other_errors(out, run);
}
