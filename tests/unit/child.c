/* Work in a child process: its answer, and every way in which it can fail. */
#define _DEFAULT_SOURCE
#include "base/child.h"
#include "base/error.h"
#include "support/alloc_fail.h"
#include "support/check.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

static const scree_child_limits limits = {(size_t)64 << 20, 20, 60, (size_t)32 << 20};
enum { NUMBERS = 1000000 };

static bool count_up(void *context, int output) {
  static uint32_t numbers[NUMBERS];
  for (uint32_t i = 0; i < NUMBERS; i++) numbers[i] = i * *(uint32_t *)context;
  return scree_child_write(output, numbers, sizeof numbers);
}
static bool crash(void *context, int output) {
  (void)context, (void)output;
  return raise(SIGSEGV) != 0;
}
static bool give_up(void *context, int output) {
  (void)context, (void)output;
  return false;
}
static bool spin(void *context, int output) {
  volatile unsigned *at = context;
  volatile bool forever = true;
  (void)output;
  while (forever) ++*at;
  return true;
}
static bool sleep_on(void *context, int output) {
  (void)context, (void)output;
  for (;;) pause();
  return true;
}
static bool close_and_sleep(void *context, int output) {
  close(output);
  return sleep_on(context, output);
}
static bool write_for_ever(void *context, int output) {
  while (scree_child_write(output, context, 4)) {
  }
  return true;
}
/* What it may not: more memory than granted, another file, a thing the parent has open. */
static bool try_all(void *context, int output) {
  void *block =
      mmap(NULL, (size_t)80 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  bool refused[3] = {block == MAP_FAILED, open("/dev/null", O_RDONLY) < 0 && errno == EMFILE,
                     fcntl(*(int *)context, F_GETFD) < 0};
  return scree_child_write(output, refused, sizeof refused);
}

static scree_status run(scree_child_work *work, const scree_child_limits *l,
                        scree_child_answer *answer, scree_error *error) {
  static int number = 7;
  *error = (scree_error){0};
  return scree_child_run(work, &number, l, "a test", answer, error);
}

static void answers(void **state) {
  (void)state;
  scree_error error;
  scree_child_answer answer = {0};
  CHECK_OK(run(count_up, &limits, &answer, &error), error);
  assert_int_equal(answer.count, NUMBERS * sizeof(uint32_t));
  for (uint32_t i = 0; i < NUMBERS; i++) {
    uint32_t found;
    memcpy(&found, answer.items + i * sizeof found, sizeof found);
    assert_int_equal(found, i * 7);
  }
  scree_free(answer.items);
}

static void is_confined(void **state) {
  (void)state;
  scree_error error;
  scree_child_answer answer = {0};
  int open_file = fcntl(open("/dev/null", O_RDONLY), F_DUPFD, 50);
  CHECK_OK(scree_child_run(try_all, &open_file, &limits, "a test", &answer, &error), error);
  close(open_file);
  assert_int_equal(answer.count, 3);
  for (int i = 0; i < 3; i++) assert_true(answer.items[i]);
  scree_free(answer.items);
}

static void expect(scree_child_work *work, const scree_child_limits *l, scree_status status,
                   const char *sentence) {
  scree_error error;
  scree_child_answer answer = {0};
  size_t used = scree_memory_used();
  scree_status found = run(work, l, &answer, &error);
  if (found != status || !strstr(error.message, sentence))
    fail_msg("%s: '%s', expected '%s'", scree_status_text(found), error.message, sentence);
  assert_null(answer.items);
  assert_int_equal(scree_memory_used(), used);
}

static void failures(void **state) {
  (void)state;
  scree_child_limits hasty = limits;
  expect(crash, &limits, SCREE_BAD_FILE, "a test crashed (signal 11, ");
  expect(give_up, &limits, SCREE_BAD_FILE, "a test gave up without a reason");
  hasty.output_bytes = 100000;
  expect(write_for_ever, &hasty, SCREE_LIMIT, "it gives more than 100000 bytes");
  hasty.processor_s = 1;
  expect(spin, &hasty, SCREE_LIMIT, "it took more than 1 s of processor time");
  hasty = limits;
  hasty.wall_s = 1;
  expect(sleep_on, &hasty, SCREE_LIMIT, "it took more than 1 s");
  expect(close_and_sleep, &hasty, SCREE_LIMIT, "it took more than 1 s");
}

static scree_status answer_once(void *context, scree_error *error) {
  (void)context;
  scree_child_answer answer = {0};
  scree_status status = run(count_up, &limits, &answer, error);
  scree_free(answer.items);
  return status;
}
static void allocations(void **state) {
  (void)state;
  assert_true(check_allocation_failures(answer_once, NULL) > 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(answers), cmocka_unit_test(is_confined),
                                     cmocka_unit_test(failures), cmocka_unit_test(allocations)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
