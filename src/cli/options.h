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
/* "; did you mean 'choose'?" or "". */
void cli_verb_hint(const char *word, char *buffer, size_t size);
