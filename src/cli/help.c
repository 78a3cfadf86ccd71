/* Help on the terminal, from the option tables. */
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

const char *cli_group_title(cli_group group) {
  static const char *const titles[CLI_GROUP_COUNT] = {
      [CLI_PREPARE] = "Prepare a particle from a scan",
      [CLI_SIMULATE] = "Simulate particles in a machine",
      [CLI_DECIDE] = "Decide, from heaps and many runs",
      [CLI_SHOW] = "Show and hand over",
  };
  return titles[group];
}

void cli_print_overview(FILE *stream) {
  fputs("scree: from a 3D scan to the particle that a DEM simulation needs\n\n"
        "usage: scree VERB [options] INPUT...\n\n",
        stream);
  for (cli_group group = 0; group < CLI_GROUP_COUNT; group++) {
    fprintf(stream, "%s:\n", cli_group_title(group));
    for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
      if ((*verb)->group == group) fprintf(stream, "  %-10s %s\n", (*verb)->name, (*verb)->summary);
  }
  fputs(
      "\n`scree help VERB` shows what a verb does and its options; `scree version`, the version.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted.\n",
      stream);
}
