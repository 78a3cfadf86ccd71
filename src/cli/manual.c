/* Man pages (scdoc) and the reference in Markdown, from the tables that the help is made of. */
#include "cli/options.h"

#include <string.h>

void cli_print_escaped(FILE *stream, const char *text, const char *marks) {
  for (; *text; text++) {
    if (strchr(marks, *text)) fputc('\\', stream);
    fputc(*text, stream);
  }
}

static void print_man_text(FILE *stream, const char *text) {
  cli_print_escaped(stream, text, "_*\\#");
}

static void print_man_options(FILE *stream, const cli_option *options, size_t count) {
  for (size_t i = 0; i < count; i++) {
    char letter = cli_letter(options[i].name);
    if (letter) fprintf(stream, "*-%c*, ", letter);
    fprintf(stream, "*--%s*", options[i].name);
    if (options[i].value_name) fprintf(stream, " _%s_", options[i].value_name);
    fputs("\n\t", stream);
    print_man_text(stream, options[i].help);
    fputs("\n\n", stream);
  }
}

static const char man_end[] =
    "# EXIT STATUS\n\n0 done, 1 failed (one sentence on stderr), 2 wrong usage.\n\n";

static void print_man_overview(FILE *stream) {
  fputs("scree(1)\n\n# NAME\n\nscree - triangle counts for DEM particles from 3D scans\n\n"
        "# SYNOPSIS\n\n*scree* _VERB_ [options] _INPUT_...\n\n# VERBS\n\n",
        stream);
  for (cli_group group = 0; group < CLI_GROUP_COUNT; group++) {
    fprintf(stream, "## %s\n\n", cli_group_title(group));
    for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
      if ((*verb)->group != group) continue;
      fprintf(stream, "*scree-%s*(1)\n\t", (*verb)->name);
      print_man_text(stream, (*verb)->summary);
      fputs("\n\n", stream);
    }
  }
  fputs("*scree help* [_VERB_]\n\tlist the verbs, or show what a verb does and its options\n\n"
        "*scree version*\n\tshow the version and which parts this build has\n\n"
        "# OPTIONS OF EVERY VERB\n\n",
        stream);
  print_man_options(stream, cli_common_options, cli_common_option_count);
  fputs("# VALUES\n\nA length may carry its unit (0.27mm); without one it is in metres. A share "
        "may be in percent (0.5%). Sizes of memory take the suffixes K, M and G.\n\n",
        stream);
  fputs(man_end, stream);
}

static void print_man_verb(FILE *stream, const cli_verb *verb) {
  fprintf(stream, "scree-%s(1)\n\n# NAME\n\nscree-%s - ", verb->name, verb->name);
  print_man_text(stream, verb->summary);
  fprintf(stream, "\n\n# SYNOPSIS\n\n*scree %s* [options] ", verb->name);
  print_man_text(stream, verb->inputs);
  fputs("\n\n# DESCRIPTION\n\n", stream);
  print_man_text(stream, verb->description);
  fputs("\n\n# OPTIONS\n\n", stream);
  print_man_options(stream, verb->options, verb->option_count);
  fputs("Options of every verb (*--threads*, *--quiet* and others) are in *scree*(1).\n\n", stream);
  fputs(man_end, stream);
  if (verb->examples) fprintf(stream, "# EXAMPLES\n\n```\n%s\n```\n\n", verb->examples);
  fputs("# SEE ALSO\n\n*scree*(1)\n", stream);
}

void cli_print_man(FILE *stream, const cli_verb *verb) {
  if (verb)
    print_man_verb(stream, verb);
  else
    print_man_overview(stream);
}

static void print_markdown_text(FILE *stream, const char *text) {
  cli_print_escaped(stream, text, "_*\\#<>|");
}

static void print_markdown_options(FILE *stream, const cli_option *options, size_t count) {
  fputs("| option | meaning |\n|---|---|\n", stream);
  for (size_t i = 0; i < count; i++) {
    char letter = cli_letter(options[i].name);
    fputs("| `", stream);
    if (letter) fprintf(stream, "-%c`, `", letter);
    fprintf(stream, "--%s", options[i].name);
    if (options[i].value_name) fprintf(stream, " %s", options[i].value_name);
    fputs("` | ", stream);
    print_markdown_text(stream, options[i].help);
    fputs(" |\n", stream);
  }
  fputc('\n', stream);
}

static void print_markdown_verb(FILE *stream, const cli_verb *verb) {
  fprintf(stream, "# scree %s\n\n", verb->name);
  print_markdown_text(stream, verb->summary);
  fprintf(stream, "\n\n    scree %s [options] %s\n\n", verb->name, verb->inputs);
  print_markdown_text(stream, verb->description);
  fputs("\n\n## Options\n\n", stream);
  if (verb->option_count) print_markdown_options(stream, verb->options, verb->option_count);
  fputs("[Options of every verb](index.md#options-of-every-verb) come besides.\n", stream);
  if (!verb->examples) return;
  fputs("\n## Examples\n\n", stream);
  for (const char *at = verb->examples; *at;) {
    size_t length = strcspn(at, "\n");
    fprintf(stream, "    %.*s\n", (int)length, at);
    at += length + (at[length] != 0);
  }
}

void cli_print_markdown(FILE *stream, const cli_verb *verb) {
  if (verb) {
    print_markdown_verb(stream, verb);
    return;
  }
  fputs("# Verbs\n", stream);
  for (cli_group group = 0; group < CLI_GROUP_COUNT; group++) {
    fprintf(stream, "\n## %s\n\n| verb | |\n|---|---|\n", cli_group_title(group));
    for (const cli_verb *const *one = cli_verbs; *one; one++)
      if ((*one)->group == group)
        fprintf(stream, "| [`scree %s`](%s.md) | %s |\n", (*one)->name, (*one)->name,
                (*one)->summary);
  }
  fputs("\n## Options of every verb\n\n", stream);
  print_markdown_options(stream, cli_common_options, cli_common_option_count);
  fputs("## All options\n\nAn option means the same in every verb that has it.\n\n"
        "| option | | meaning | verbs |\n|---|---|---|---|\n",
        stream);
  for (size_t i = 0; i < cli_meaning_count; i++) {
    const cli_meaning *m = &cli_meanings[i];
    fprintf(stream, "| `--%s` | %s%.1s%s | ", m->name, m->letter ? "`-" : "", &m->letter,
            m->letter ? "`" : "");
    print_markdown_text(stream, m->meaning);
    fputs(" |", stream);
    bool every = true;
    for (const cli_verb *const *one = cli_verbs; *one; one++)
      if (cli_has_option(*one, m->name)) {
        fprintf(stream, " %s", (*one)->name);
        every = false;
      }
    fprintf(stream, "%s |\n", every ? " all" : "");
  }
}

void cli_print_options(FILE *stream) {
  for (size_t i = 0; i < cli_meaning_count; i++) {
    const cli_meaning *m = &cli_meanings[i];
    fprintf(stream, "%s\t%s%.1s\t%s\n", m->name, m->letter ? "-" : "", &m->letter, m->meaning);
  }
}
