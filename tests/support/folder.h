/* A folder of a test's own, removed with all that is in it. As setup and teardown of a group:
 *
 *   return cmocka_run_group_tests(tests, make_folder, remove_folder);
 *
 * SCREE_TEST_FOLDER names another, made by hand, in which everything stays to be looked at. */
#pragma once

int make_folder(void **state);
/* Fails where a file half-written (.part) was left behind. */
int remove_folder(void **state);

/* The path of a name in the folder; good until the eighth call after it. */
const char *in_folder(const char *name);
/* A text as a file in it. */
void put_in_folder(const char *name, const char *text);
/* The sum of a column, from 0, of the rows of a CSV file in it that begin so. */
double sum_in_folder(const char *name, const char *begin, int column);
