#define _GNU_SOURCE /* for O_TMPFILE */
#include "base/alloc.h"
#include "base/arena.h"
#include "base/array.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "base/sum.h"
#include "support/check.h"
#include "support/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static void memory_is_aligned_and_counted(void **state) {
  (void)state;
  size_t before = scree_memory_used();
  for (size_t size = 0; size < 300; size += 7) {
    char *block = scree_alloc(size, 1);
    assert_non_null(block);
    assert_int_equal((uintptr_t)block % 64, 0);
    memset(block, 1, size);
    scree_free(block);
  }
  assert_int_equal(scree_memory_used(), before);
  volatile size_t huge = SIZE_MAX / 2;
  assert_null(scree_alloc(huge, 3));
  scree_set_memory_limit(before + 1000);
  assert_null(scree_alloc(2000, 1));
  scree_set_memory_limit(0);
  char *block = scree_alloc(4, 1);
  memcpy(block, "abc", 4);
  block = scree_resize(block, 100, 1);
  assert_string_equal(block, "abc");
  scree_free(block);
}

static scree_status take(size_t count, scree_error *error) {
  double *block;
  SCREE_ALLOC_OR(block, count, error, out_of_memory);
  scree_free(block);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void memory_says_why_it_is_out(void **state) {
  (void)state;
  scree_error error;
  scree_set_memory_limit(100 << 10);
  assert_int_equal(take(1 << 20, &error), SCREE_OUT_OF_MEMORY);
  assert_string_equal(error.message, "out of memory: more than the limit of 100 KiB is needed");
  assert_null(scree_alloc(1 << 20, 1));
  scree_fail_memory(&error, 1 << 20, "a mesh");
  assert_string_equal(error.message,
                      "out of memory: more than the limit of 100 KiB is needed for a mesh");
  scree_set_memory_limit(0);
  volatile size_t huge = SIZE_MAX / 2;
  assert_null(scree_alloc(huge, 3));
  scree_fail_memory(&error, 77, "a mesh");
  assert_string_equal(error.message, "out of memory: 77 bytes for a mesh");
  scree_fail_memory(&error, 0, "a mesh");
  assert_string_equal(error.message, "out of memory for a mesh");
}

static void arena_gives_blocks_of_its_own(void **state) {
  (void)state;
  enum { BLOCKS = 2000 };
  static unsigned char *blocks[BLOCKS];
  scree_arena arena = {0};
  size_t before = scree_memory_used();
  for (size_t i = 0; i < BLOCKS; i++) { /* some larger than a chunk */
    blocks[i] = scree_arena_take(&arena, i % 500 ? i % 97 : 300000, 1);
    assert_non_null(blocks[i]);
    assert_int_equal((uintptr_t)blocks[i] % 64, 0);
    memset(blocks[i], (int)(i % 251), i % 500 ? i % 97 : 300000);
  }
  for (size_t i = 0; i < BLOCKS; i++)
    for (size_t k = 0; k < (i % 500 ? i % 97 : 300000); k++)
      assert_int_equal(blocks[i][k], i % 251);
  assert_null(scree_arena_take(&arena, SIZE_MAX / 2, 3));
  scree_arena_free(&arena);
  assert_int_equal(scree_memory_used(), before);
}

static void block_sum(void *context, scree_block block) {
  double sum = 0;
  for (size_t i = block.begin; i < block.end; i++) sum += 1.0 / (double)(i + 1);
  ((double *)context)[block.index] = sum;
}

static void blocks_do_not_depend_on_threads(void **state) {
  (void)state;
  double reference[64], other[64];
  scree_set_threads(1);
  scree_parallel_for(6301, 100, block_sum, reference);
  for (int threads = 2; threads <= 8; threads++) {
    scree_set_threads(threads);
    memset(other, 0, sizeof other);
    scree_parallel_for(6301, 100, block_sum, other);
    assert_memory_equal(reference, other, sizeof other);
  }
  scree_set_threads(0);
}

static void compensated_sum_is_exact_where_plain_is_not(void **state) {
  (void)state;
  scree_sum s = {0};
  double terms[] = {1e100, 1, -1e100, 1};
  for (int i = 0; i < 4; i++) scree_sum_add(&s, terms[i]);
  assert_true(scree_sum_value(s) == 2);
}

static void random_numbers_have_the_moments_they_claim(void **state) {
  (void)state;
  scree_rng rng = {.seed = 7};
  double mean = 0, mean_square = 0, normal2 = 0;
  const int n = 200000;
  for (int i = 0; i < n; i++) {
    double u = scree_rng_uniform(&rng), z = scree_rng_normal(&rng);
    assert_true(u >= 0 && u < 1);
    mean += u / n;
    mean_square += u * u / n;
    normal2 += z * z / n;
  }
  CHECK_NEAR(mean, 0.5, 0.003);
  CHECK_NEAR(mean_square, 1.0 / 3, 0.003);
  CHECK_NEAR(normal2, 1, 0.015);
  assert_true(scree_rng_bits(1, 2, 3) != scree_rng_bits(1, 3, 2));
  for (int i = 0; i < 1000; i++) assert_true(scree_rng_below(&rng, 7) < 7);
  mat3 r = quat_to_mat3(scree_rng_rotation(&rng)), t = mat3_transpose(&r), one = mat3_mul(&r, &t);
  for (int i = 0; i < 9; i++) CHECK_NEAR(one.m[i / 3][i % 3], i % 4 == 0, 1e-15);
}

static void a_shuffle_gives_every_order_alike(void **state) {
  (void)state;
  enum { ITEMS = 4, ORDERS = 24, TRIES = 24000 };
  size_t seen[256] = {0}, orders = 0;
  scree_rng rng = {.seed = 11};
  for (int t = 0; t < TRIES; t++) {
    double items[ITEMS] = {0, 1, 2, 3};
    unsigned taken = 0, order = 0;
    scree_rng_shuffle(&rng, items, ITEMS, sizeof *items);
    for (int i = 0; i < ITEMS; i++) {
      taken |= 1u << (unsigned)items[i];
      order = 4 * order + (unsigned)items[i];
    }
    assert_int_equal(taken, 15);
    seen[order]++;
  }
  for (int i = 0; i < 256; i++) {
    if (!seen[i]) continue;
    orders++;
    assert_in_range(seen[i], TRIES / ORDERS - 160, TRIES / ORDERS + 160); /* 5 SD */
  }
  assert_int_equal(orders, ORDERS);
}

static void files_are_whole_or_absent(void **state) {
  (void)state;
  scree_error error;
  CHECK_OK(scree_folder_create(in_folder("a/b"), &error), error);
  const char *path = in_folder("a/b/file");
  scree_output output;
  CHECK_OK(scree_output_open(path, false, &output, &error), error);
  fputs("hello", output.stream);
  assert_int_not_equal(access(path, F_OK), 0);
  CHECK_OK(scree_output_commit(&output, &error), error);
  assert_int_equal(scree_output_open(path, false, &output, &error), SCREE_EXISTS);
  CHECK_OK(scree_output_open(path, true, &output, &error), error);
  fputs("other", output.stream);
  scree_output_discard(&output);
  char *bytes;
  size_t count;
  CHECK_OK(scree_file_read(path, 0, &bytes, &count, &error), error);
  assert_int_equal(count, 5);
  assert_string_equal(bytes, "hello");
  scree_free(bytes);
  assert_int_equal(scree_file_read(path, 3, &bytes, &count, &error), SCREE_LIMIT);
  assert_int_equal(scree_file_read(in_folder("a"), 0, &bytes, &count, &error), SCREE_IO);
}

#ifdef O_TMPFILE
/* Of the program instead of the system's: a file system that has none, if asked. */
static bool without_links;
int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags) {
  if (!without_links) return (int)syscall(SYS_linkat, from_folder, from, to_folder, to, flags);
  errno = EPERM;
  return -1;
}

static size_t count_files(const char *folder) {
  size_t count = 0;
  DIR *entries = opendir(folder);
  assert_non_null(entries);
  for (struct dirent *entry; (entry = readdir(entries));) count += entry->d_name[0] != '.';
  closedir(entries);
  return count;
}

/* What a killed process was writing is gone with it. */
static void a_killed_process_leaves_no_half_of_a_file(void **state) {
  (void)state;
  scree_error error;
  scree_output output;
  char folder[400], path[400]; /* in_folder has few */
  snprintf(folder, sizeof folder, "%s", in_folder("left"));
  snprintf(path, sizeof path, "%s", in_folder("left/file"));
  CHECK_OK(scree_folder_create(folder, &error), error);
  int probe = open(folder, O_WRONLY | O_TMPFILE, 0666);
  if (probe < 0) skip(); /* this file system has no files without names */
  close(probe);
  pid_t child = fork();
  if (child == 0) {
    if (scree_output_open(path, false, &output, &error) != SCREE_OK) _exit(1);
    fputs("half", output.stream);
    fflush(output.stream);
    raise(SIGKILL);
  }
  int code;
  assert_int_equal(waitpid(child, &code, 0), child);
  assert_true(WIFSIGNALED(code));
  assert_int_equal(count_files(folder), 0);

  umask(027);
  CHECK_OK(scree_output_open(path, false, &output, &error), error);
  assert_int_equal(count_files(folder), 0);
  fputs("whole", output.stream);
  CHECK_OK(scree_output_commit(&output, &error), error);
  assert_int_equal(count_files(folder), 1);
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  assert_int_equal(info.st_mode & 0777, 0640);
  umask(022);
  without_links = true;
  CHECK_OK(scree_output_open(path, true, &output, &error), error);
  for (int i = 0; i < 100000; i++) fputs("copy\n", output.stream);
  assert_int_equal(count_files(folder), 1);
  CHECK_OK(scree_output_commit(&output, &error), error);
  without_links = false;
  assert_int_equal(count_files(folder), 1);
  char *bytes;
  size_t count;
  CHECK_OK(scree_file_read(path, 0, &bytes, &count, &error), error);
  assert_int_equal(count, 500000);
  assert_memory_equal(bytes + 499995, "copy\n", 5);
  scree_free(bytes);
  CHECK_OK(scree_output_open(path, true, &output, &error), error);
  assert_int_equal(unlink(path), 0);
  assert_int_equal(rmdir(folder), 0);
  assert_int_equal(scree_output_commit(&output, &error), SCREE_IO);
  assert_non_null(strstr(error.message, "cannot write: No such file or directory"));
}
#endif

/* Of two that write the same new file at once, one. */
static void the_second_of_two_does_not_overwrite(void **state) {
  (void)state;
  scree_error error;
  scree_output first, second;
  char path[400];
  snprintf(path, sizeof path, "%s", in_folder("raced"));
  CHECK_OK(scree_output_open(path, false, &first, &error), error);
  CHECK_OK(scree_output_open(path, false, &second, &error), error);
  fputs("first", first.stream);
  fputs("second", second.stream);
  CHECK_OK(scree_output_commit(&first, &error), error);
  assert_int_equal(scree_output_commit(&second, &error), SCREE_EXISTS);
  assert_non_null(strstr(error.message, "exists already; not overwritten"));
  CHECK_OK(scree_output_open(path, true, &second, &error), error);
  CHECK_OK(scree_output_open(path, true, &first, &error), error);
  fputs("third", second.stream);
  CHECK_OK(scree_output_commit(&second, &error), error);
  CHECK_OK(scree_output_commit(&first, &error), error);
  assert_int_equal(unlink(path), 0);
}

static void a_discarded_tail_can_be_used_again(void **state) {
  (void)state;
  const size_t size = (size_t)16 << 20, kept = (size_t)5 << 20;
  size_t used = scree_memory_used();
  unsigned char *block = scree_alloc(size, 1);
  assert_non_null(block);
  memset(block, 7, size);
  size_t with = scree_memory_used();
  scree_discard_tail(block, kept);
  assert_int_equal(scree_memory_used(), with);
  for (size_t i = 0; i < kept; i++) assert_int_equal(block[i], 7);
  memset(block, 9, size);
  for (size_t i = 0; i < size; i += 4096) assert_int_equal(block[i], 9);
  scree_discard_tail(block, size);
  assert_int_equal(block[size - 1], 9);
  scree_free(block);
  assert_int_equal(scree_memory_used(), used);
}

#ifdef MADV_POPULATE_WRITE
/* How many of the whole pages in the block are there. */
static size_t resident_pages(const unsigned char *block, size_t size, size_t *all) {
  size_t page = (size_t)sysconf(_SC_PAGESIZE), shift = (size_t)(-(uintptr_t)block & (page - 1));
  size_t count = (size - shift) / page, found = 0;
  unsigned char *there = calloc(count, 1);
  assert_non_null(there);
  /* mincore changes nothing, but asks for a pointer that could */
  assert_int_equal(mincore((void *)(uintptr_t)(block + shift), count * page, there), 0);
  for (size_t i = 0; i < count; i++) found += there[i] & 1;
  free(there);
  *all = count;
  return found;
}

static void a_populated_block_is_there_before_it_is_written(void **state) {
  (void)state;
  const size_t size = (size_t)24 << 20;
  unsigned char *block = scree_alloc(size, 1);
  size_t all;
  assert_non_null(block);
  size_t before = resident_pages(block, size, &all);
  scree_set_threads(2);
  scree_populate(block, size);
  size_t after = resident_pages(block, size, &all);
  bool able = madvise(block, size, MADV_POPULATE_WRITE) == 0;
  scree_free(block);
  /* written before, bytes stay; small blocks are left alone */
  block = scree_alloc(size, 1);
  assert_non_null(block);
  for (size_t i = 0; i < size; i += 1000) block[i] = (unsigned char)(i / 1000);
  scree_populate(block, size);
  for (size_t i = 0; i < size; i += 1000) assert_int_equal(block[i], (unsigned char)(i / 1000));
  scree_populate(block, 0);
  scree_populate(block, 100);
  scree_free(block);
  scree_set_threads(0);
  if (!able) {
    print_message("the system cannot populate memory: nothing to see\n");
    skip();
  }
  assert_true(before < all / 2);
  assert_true(after > all * 3 / 4);
}
#endif

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_discarded_tail_can_be_used_again),
#ifdef MADV_POPULATE_WRITE
      cmocka_unit_test(a_populated_block_is_there_before_it_is_written),
#endif
      cmocka_unit_test(memory_is_aligned_and_counted),
      cmocka_unit_test(memory_says_why_it_is_out),
      cmocka_unit_test(arena_gives_blocks_of_its_own),
      cmocka_unit_test(blocks_do_not_depend_on_threads),
      cmocka_unit_test(compensated_sum_is_exact_where_plain_is_not),
      cmocka_unit_test(random_numbers_have_the_moments_they_claim),
      cmocka_unit_test(a_shuffle_gives_every_order_alike),
      cmocka_unit_test(files_are_whole_or_absent),
      cmocka_unit_test(the_second_of_two_does_not_overwrite),
#ifdef O_TMPFILE
      cmocka_unit_test(a_killed_process_leaves_no_half_of_a_file),
#endif
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
