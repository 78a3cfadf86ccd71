/* The one table of options: what a name means, in every verb that has it, and its letter. */
#pragma once

#include "cli/args.h"

typedef struct cli_meaning {
  const char *name;
  char letter; /* or 0 */
  const char *meaning;
  double least, most;   /* values beyond these are named; both 0: any */
  const char *expected; /* of such a value: what the option takes */
} cli_meaning;

/* Sorted by name. */
extern const cli_meaning cli_meanings[];
extern const size_t cli_meaning_count;

/* NULL where the table lacks the name, as a test forbids. */
const cli_meaning *cli_find_meaning(const char *name);
/* 0 where the option has no letter. */
char cli_letter(const char *name);

/* Whether the verb's own table has it. */
bool cli_has_option(const cli_verb *verb, const char *name);

/* "; did you mean '--tolerance'?", "; it is now '--points'", or "", for a word that is no option of
 * the verb; name is without dashes, of one letter for -x. */
void cli_option_hint(const cli_verb *verb, const char *name, char *buffer, size_t size);
/* "; did you mean 'choose'?" or "", of the words in "one|two". */
void cli_word_hint(const char *words, const char *word, char *buffer, size_t size);
void cli_verb_hint(const char *word, char *buffer, size_t size);

/* --grid: the levels of a table. */
typedef struct cli_grid {
  double least, most; /* Rp */
  int per_decade;
} cli_grid;

#define CLI_GRID_DEFAULT "1e-5:1e-1:9"
#define CLI_GRID_OPTION                                                                            \
  CLI_ROW(CLI_TEXT, "grid", grid, "MIN:MAX:N",                                                     \
          "Grid of Rp: from MIN upward with N points per factor of ten, as far as MAX, which "     \
          "belongs to it only where a step meets it. Default: " CLI_GRID_DEFAULT ".")

/* CLI_MISUSED after telling what is wrong with the text. */
scree_status cli_parse_grid(const cli_verb *verb, const char *text, cli_grid *grid);
