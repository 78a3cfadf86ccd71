/* Help, man page and completion, all from the option tables. */
#include "cli/options.h"

#include <string.h>

enum { HELP_COLUMN = 26, LINE_WIDTH = 80 };

/* Prints text wrapped at LINE_WIDTH, every line after the first indented. */
static void print_wrapped(FILE *stream, const char *text, int column, int indent) {
  int spaces = 0; /* before the next word, where it stays on the line */
  while (*text) {
    size_t length = strcspn(text, " \n");
    if (column + spaces + (int)length > LINE_WIDTH && column > indent) {
      fprintf(stream, "\n%*s", indent, "");
      column = indent;
      spaces = 0;
    }
    if (length) column += fprintf(stream, "%*s%.*s", spaces, "", (int)length, text);
    if (length) spaces = 0;
    text += length;
    if (*text == ' ') spaces++;
    if (*text == '\n') {
      fprintf(stream, "\n%*s", indent, "");
      column = indent;
      spaces = 0;
    }
    text += *text != 0;
  }
  fputc('\n', stream);
}

static void print_examples(FILE *stream, const char *text) {
  fputs("\nexamples:\n", stream);
  while (*text) {
    size_t length = strcspn(text, "\n");
    fprintf(stream, "  %.*s\n", (int)length, text);
    text += length + (text[length] != 0);
  }
}

static void print_option(FILE *stream, const cli_option *option) {
  char left[64];
  char letter = cli_letter(option->name);
  int used = letter ? snprintf(left, sizeof left, "  -%c, --%s", letter, option->name)
                    : snprintf(left, sizeof left, "      --%s", option->name);
  if (option->value_name && used < (int)sizeof left)
    used += snprintf(left + used, sizeof left - (size_t)used, " %s", option->value_name);
  fputs(left, stream);
  if (used >= HELP_COLUMN) {
    fputc('\n', stream);
    used = 0;
  }
  fprintf(stream, "%*s", HELP_COLUMN - used, "");
  print_wrapped(stream, option->help, HELP_COLUMN, HELP_COLUMN);
}

void cli_print_help(FILE *stream, const cli_verb *verb) {
  fprintf(stream, "scree %s: %s\n\nusage: scree %s [options] %s\n\n", verb->name, verb->summary,
          verb->name, verb->inputs);
  print_wrapped(stream, verb->description, 0, 0);
  if (verb->option_count) fputs("\noptions:\n", stream);
  for (size_t i = 0; i < verb->option_count; i++) print_option(stream, &verb->options[i]);
  fputs("\noptions of every verb:\n", stream);
  for (size_t i = 0; i < cli_common_option_count; i++) print_option(stream, &cli_common_options[i]);
  if (verb->examples) print_examples(stream, verb->examples);
}

void cli_print_overview(FILE *stream) {
  fputs("scree: from a 3D scan to the triangle count a DEM particle needs, and the proof\n\n"
        "usage: scree VERB [options] INPUT...\n\n",
        stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
    fprintf(stream, "  %-10s %s\n", (*verb)->name, (*verb)->summary);
  fputs("  help       show this, or the help of a verb: scree help VERB\n"
        "  version    show the version\n"
        "\nExit codes: 0 done, 1 failed, 2 wrong usage.\n",
        stream);
}

/* Text for scdoc: what it takes as markup is escaped. */
static void print_scdoc_text(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (strchr("_*\\#", *text)) fputc('\\', stream);
    fputc(*text, stream);
  }
}

static void print_scdoc_options(FILE *stream, const cli_option *options, size_t count) {
  for (size_t i = 0; i < count; i++) {
    char letter = cli_letter(options[i].name);
    if (letter) fprintf(stream, "*-%c*, ", letter);
    fprintf(stream, "*--%s*", options[i].name);
    if (options[i].value_name) fprintf(stream, " _%s_", options[i].value_name);
    fputs("\n\t", stream);
    print_scdoc_text(stream, options[i].help);
    fputs("\n\n", stream);
  }
}

void cli_print_man(FILE *stream) {
  fputs("scree(1)\n\n# NAME\n\nscree - triangle counts for DEM particles from 3D scans\n\n"
        "# SYNOPSIS\n\n*scree* _VERB_ [options] _INPUT_...\n\n"
        "# OPTIONS OF EVERY VERB\n\n",
        stream);
  print_scdoc_options(stream, cli_common_options, cli_common_option_count);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
    fprintf(stream, "# SCREE %s\n\n*scree %s* [options] ", (*verb)->name, (*verb)->name);
    print_scdoc_text(stream, (*verb)->inputs);
    fputs("\n\n", stream);
    print_scdoc_text(stream, (*verb)->description);
    fputs("\n\n", stream);
    print_scdoc_options(stream, (*verb)->options, (*verb)->option_count);
    if ((*verb)->examples) fprintf(stream, "```\n%s\n```\n\n", (*verb)->examples);
  }
  fputs("# EXIT STATUS\n\n0 done, 1 failed (one sentence on stderr), 2 wrong usage.\n", stream);
}

void cli_print_options(FILE *stream) {
  for (size_t i = 0; i < cli_meaning_count; i++) {
    const cli_meaning *m = &cli_meanings[i];
    fprintf(stream, "%s\t%s%.1s\t%s\t", m->name, m->letter ? "-" : "", &m->letter, m->meaning);
    const char *space = "";
    for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
      if (cli_has_option(*verb, m->name)) {
        fprintf(stream, "%s%s", space, (*verb)->name);
        space = " ";
      }
    fprintf(stream, "%s\n", *space ? "" : "all");
  }
}

static void print_words(FILE *stream, const cli_option *options, size_t count) {
  for (size_t i = 0; i < count; i++) fprintf(stream, " --%s", options[i].name);
}

void cli_print_completion(FILE *stream) {
  fputs("_scree() {\n  local word=${COMP_WORDS[COMP_CWORD]} words=\n"
        "  if [ \"$COMP_CWORD\" = 1 ]; then\n    words=\"help version",
        stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
    fprintf(stream, " %s", (*verb)->name);
  fputs("\"\n  else\n    case ${COMP_WORDS[1]} in\n", stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
    fprintf(stream, "      %s) words=\"", (*verb)->name);
    print_words(stream, (*verb)->options, (*verb)->option_count);
    fputs("\" ;;\n", stream);
  }
  fputs("    esac\n    words=\"$words", stream);
  print_words(stream, cli_common_options, cli_common_option_count);
  fputs("\"\n  fi\n"
        "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\") $(compgen -f -- \"$word\"))\n}\n"
        "complete -F _scree scree\n",
        stream);
}
