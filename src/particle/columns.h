/* The columns of a table of spheres, as its first line names them. */
#pragma once

#include "mesh/io/text.h"

enum { SCREE_MOST_COLUMNS = 64 };

typedef struct scree_columns {
  size_t count; /* of columns; 0: no line names them, and they are x, y, z, radius */
  size_t at[4]; /* which of them is x, y, z and the size */
  double share; /* of the size that is the radius: 1, or 0.5 of a diameter */
  char separator;
  double unit_m; /* that the names say, as "x (mm)"; 0: none */
} scree_columns;

/* The cells of the line at t, up to its end or `end`, of which at most SCREE_MOST_COLUMNS are
 * written; answers how many there are. Separator 0: blanks, commas and semicolons alike. */
size_t scree_columns_split(const char *begin, const char *end, char separator,
                           scree_token cells[SCREE_MOST_COLUMNS]);

/* Whether the line names x, y, z and radius or diameter. Names that mean nothing here are passed
 * over. False with the reason where one is missing or stands twice, "" where there is none of
 * them. */
bool scree_columns_name(const char *begin, const char *end, scree_columns *columns,
                        char reason[160]);
