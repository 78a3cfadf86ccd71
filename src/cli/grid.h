/* --grid: the levels of a table. */
#pragma once

#include "cli/args.h"

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
