/* Decimal numbers in and out, whatever the locale: the C library's strtod and printf read and write
 * a decimal comma where the surrounding program asked for one. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Reads [+-] digits [. digits] [e|E|d|D [+-] digits] at `begin`, never beyond `end`, correctly
 * rounded (nearest, ties to even; overflow gives infinity). Answers the first byte behind the
 * number, or NULL where none begins; a number needs one digit before or after the point. Words
 * (nan, inf) and hexadecimal are no numbers here. */
const char *scree_number_parse(const char *begin, const char *end, double *value);

/* All of text as one finite number; false where it is anything else. */
bool scree_number_read(const char *text, double *value);

enum { SCREE_NUMBER_SIZE = 32 };
/* Writes a finite value with the fewest of 15, 16 or 17 digits that scree_number_parse reads back
 * to the same bits; answers the length. */
size_t scree_number_format(double value, char text[SCREE_NUMBER_SIZE]);
/* The same with 6 to 9 digits for a float. */
size_t scree_number_format_float(float value, char text[SCREE_NUMBER_SIZE]);
/* What printf makes of %.*g, digits at most 17; answers the length. */
size_t scree_number_format_digits(double value, int digits, char text[SCREE_NUMBER_SIZE]);

/* For people, answering text: an Rp, 0.00123 as 1.2e-3 and 0.123 as 0.12; and a share as a
 * percentage, with three decimals below 0.1 %, two below 10 % and else none. */
const char *scree_rp_text(double rp, char text[SCREE_NUMBER_SIZE]);
const char *scree_percent_text(double share, char text[SCREE_NUMBER_SIZE]);
/* 12345 as 12,345 */
const char *scree_count_text(size_t count, char text[SCREE_NUMBER_SIZE]);
/* 12 s, 7 minutes, 3.5 hours */
const char *scree_seconds_text(double seconds, char text[SCREE_NUMBER_SIZE]);
