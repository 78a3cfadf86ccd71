/* Comma-separated values by RFC 4180, with '\n' line ends. */
#pragma once

#include "base/quote.h"

/* The shortest form that reads back the same; nothing for NaN and infinities. */
void scree_csv_number(FILE *stream, double value);
/* A comma before each. */
void scree_csv_numbers(FILE *stream, const double *values, size_t count);
