/* kill -9 at any moment leaves a readable checkpoint. A child saves a world three times over the
 * same file; it is traced, and killed at its first system call, at its second, and so on until it
 * lives to the end: before and after every open, write, sync, close and rename. */
#define _DEFAULT_SOURCE
#include "base/file.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/mixed.h"
#include "support/threads.h"

#include <dirent.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SAVES = 3 };

/* What the child does between its first and its last traced call. */
static int save_three_times(scree_world *world, const char *path) {
  for (int i = 0; i < SAVES; i++)
    if (scree_world_step(world, 1, NULL) || scree_world_save(world, path, true, NULL)) return 1;
  return 0;
}

static pid_t start_child(scree_world *world, const char *path) {
  pid_t child = fork();
  if (child != 0) return child;
  if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0) _exit(77);
  raise(SIGSTOP); /* the tracer counts from here */
  _exit(save_three_times(world, path));
}

/* Lets the child make `calls` stops at system calls, then kills it; false when it ended before. */
static bool kill_after(pid_t child, size_t calls, int *status) {
  if (waitpid(child, status, 0) != child) fail_msg("no child to wait for");
  if (WIFEXITED(*status)) return false;
  for (size_t i = 0; i < calls; i++) {
    if (ptrace(PTRACE_SYSCALL, child, NULL, NULL) != 0 || waitpid(child, status, 0) != child)
      fail_msg("the child cannot be traced");
    if (WIFEXITED(*status)) return false;
    if (WIFSIGNALED(*status)) fail_msg("the child died of signal %d", WTERMSIG(*status));
  }
  kill(child, SIGKILL);
  waitpid(child, status, 0);
  return true;
}

static void empty_folder(void) {
  DIR *entries = opendir(in_folder("."));
  assert_non_null(entries);
  for (struct dirent *entry; (entry = readdir(entries));)
    if (entry->d_name[0] != '.') unlink(in_folder(entry->d_name));
  closedir(entries);
}

static void every_moment_leaves_a_checkpoint(void **state) {
  (void)state;
  scree_error error;
  scree_checksum hashes[SAVES + 1];
  use_threads(1); /* a fork carries no threads along */
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  CHECK_OK(scree_world_save(world, in_folder(".first"), true, &error), error);
  size_t kills = 0, seen[SAVES + 1] = {0};
  for (bool killed = true; killed; kills += killed) {
    scree_world *loaded = NULL;
    int status;
    CHECK_OK(scree_world_save(world, in_folder("world"), true, &error), error);
    killed = kill_after(start_child(world, in_folder("world")), kills, &status);
    if (!killed && WEXITSTATUS(status) == 77) {
      print_message("skipped: tracing is not allowed here\n");
      break;
    }
    CHECK_OK(scree_world_load(in_folder("world"), &loaded, &error), error);
    uint64_t steps = scree_world_step_count(loaded);
    assert_true(steps <= SAVES && (killed || steps == SAVES));
    scree_checksum hash = scree_world_hash(loaded);
    if (!seen[steps]++) { /* the state of so many steps, made here */
      scree_world *expected = NULL;
      CHECK_OK(scree_world_load(in_folder(".first"), &expected, &error), error);
      CHECK_OK(scree_world_step(expected, steps, &error), error);
      hashes[steps] = scree_world_hash(expected);
      scree_world_free(expected);
    }
    assert_true(hash.high == hashes[steps].high && hash.low == hashes[steps].low);
    scree_world_free(loaded);
    empty_folder();
  }
  print_message("%zu kills: found %zu %zu %zu %zu of the states\n", kills, seen[0], seen[1],
                seen[2], seen[3]);
  if (kills) assert_true(seen[0] && seen[1] && seen[2] && seen[3]);
  scree_world_free(world);
  use_threads(0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_moment_leaves_a_checkpoint)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
