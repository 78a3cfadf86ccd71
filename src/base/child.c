/* The child sees the parent's memory as it was at the fork, and nothing else: every descriptor but
 * its pipe is closed, none can be opened, no file can grow. The parent reads the pipe until its end
 * or the deadline, and always buries the child.
 *
 * RLIMIT_AS counts what is mapped already, which may be much (the parent's scans, the shadow of a
 * sanitizer): the limit is that, read from /proc/self/statm, and the allowance. The work runs on
 * the forking thread alone: OpenMP's other threads do not exist in the child. */
#define _GNU_SOURCE
#include "base/child.h"

#include "base/array.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { READ_BYTES = 1 << 16, EXIT_GAVE_UP = 1, EXIT_NO_LIMITS = 2 };

bool scree_child_write(int output, const void *bytes, size_t byte_count) {
  const char *p = bytes;
  while (byte_count > 0) {
    ssize_t written = write(output, p, byte_count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    p += written;
    byte_count -= (size_t)written;
  }
  return true;
}

/* ---- in the child ---- */

static bool set_limit(int resource, rlim_t soft, rlim_t hard) {
  struct rlimit now;
  if (getrlimit(resource, &now) != 0) return false;
  if (now.rlim_max != RLIM_INFINITY && hard > now.rlim_max) hard = now.rlim_max;
  if (soft > hard) soft = hard;
  return setrlimit(resource, &(struct rlimit){soft, hard}) == 0;
}

/* Bytes of address space mapped now; 0 where the system does not tell. */
static size_t mapped_bytes(void) {
  char text[64];
  int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  ssize_t length = read(file, text, sizeof text - 1);
  close(file);
  if (length <= 0) return 0;
  text[length] = 0;
  return (size_t)strtoull(text, NULL, 10) * (size_t)sysconf(_SC_PAGESIZE);
}

static bool confine(const scree_child_limits *limits, int *output) {
  static const int restored[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE,  SIGILL, SIGTERM,
                                 SIGINT,  SIGPIPE, SIGHUP, SIGXCPU, SIGXFSZ};
  for (size_t i = 0; i < sizeof restored / sizeof *restored; i++) signal(restored[i], SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  size_t mapped = mapped_bytes(), most;
  if (mapped == 0 || __builtin_add_overflow(mapped, limits->memory_bytes, &most)) return false;
  int null = open("/dev/null", O_RDWR);
  if (null < 0) return false;
  int moved = fcntl(*output, F_DUPFD, 3);
  if (moved < 0) return false;
  for (int i = 0; i < 3; i++)
    if (dup2(null, i) < 0) return false;
  if (moved != 3 && dup2(moved, 3) < 0) return false;
  *output = 3;
  closefrom(4);
  rlim_t seconds = (rlim_t)limits->processor_s;
  return set_limit(RLIMIT_CORE, 0, 0) && set_limit(RLIMIT_FSIZE, 0, 0) &&
         set_limit(RLIMIT_NOFILE, 0, 0) && set_limit(RLIMIT_CPU, seconds, seconds + 1) &&
         set_limit(RLIMIT_AS, most, most);
}

_Noreturn static void be_child(scree_child_work *work, void *context,
                               const scree_child_limits *limits, int output) {
  /* should the parent die, so does the child */
  alarm((unsigned)limits->wall_s + 5);
  signal(SIGALRM, SIG_DFL);
  if (!confine(limits, &output)) _exit(EXIT_NO_LIMITS);
  _exit(work(context, output) ? 0 : EXIT_GAVE_UP);
}

/* ---- in the parent ---- */

static int64_t now_ms(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

typedef struct collection {
  const scree_child_limits *limits;
  const char *what;
  scree_child_answer *answer;
  int64_t deadline_ms;
  scree_error *error;
} collection;

static scree_status fail_time(const collection *c) {
  return scree_fail(c->error, SCREE_LIMIT, "%s was stopped: it took more than %d s", c->what,
                    c->limits->wall_s);
}

/* Reads to the end of the pipe. */
static scree_status collect(const collection *c, int input) {
  scree_child_answer *a = c->answer;
  for (;;) {
    int64_t left = c->deadline_ms - now_ms();
    if (left <= 0) return fail_time(c);
    struct pollfd ready = {.fd = input, .events = POLLIN};
    int found = poll(&ready, 1, left > 1000000 ? 1000000 : (int)left);
    if (found <= 0) continue; /* the deadline, or a signal of ours */
    if (!SCREE_RESERVE(a, a->count + READ_BYTES))
      return scree_fail_memory(c->error, a->count + READ_BYTES, "the answer of a child process");
    ssize_t length = read(input, a->items + a->count, a->capacity - a->count);
    if (length < 0 && errno == EINTR) continue;
    if (length < 0)
      return scree_fail(c->error, SCREE_IO, "%s: the pipe from the child process: %s", c->what,
                        strerror(errno));
    if (length == 0) return SCREE_OK;
    a->count += (size_t)length;
    if (a->count > c->limits->output_bytes)
      return scree_fail(c->error, SCREE_LIMIT, "%s was stopped: it gives more than %zu bytes",
                        c->what, c->limits->output_bytes);
  }
}

/* Waits until the child has ended, killing it at the deadline or at once where nothing more is
 * wanted of it. */
static scree_status bury(const collection *c, pid_t child, bool kill_now, int *ended) {
  const struct timespec pause = {0, 1000000};
  bool killed = kill_now, late = false;
  if (kill_now) kill(child, SIGKILL);
  for (;;) {
    pid_t found = waitpid(child, ended, killed ? 0 : WNOHANG);
    if (found == child) break;
    if (found < 0 && errno != EINTR) { /* the program ignores SIGCHLD: nothing is left to know */
      *ended = 0;
      break;
    }
    if (!killed && now_ms() >= c->deadline_ms) {
      kill(child, SIGKILL);
      killed = late = true;
    } else if (!killed)
      nanosleep(&pause, NULL);
  }
  return late ? fail_time(c) : SCREE_OK;
}

static scree_status judge(const collection *c, int ended) {
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == 0) return SCREE_OK;
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == EXIT_NO_LIMITS)
    return scree_fail(c->error, SCREE_IO, "%s: the child process cannot be given its limits",
                      c->what);
  if (WIFEXITED(ended))
    return scree_fail(c->error, SCREE_BAD_FILE, "%s gave up without a reason (exit code %d)",
                      c->what, WEXITSTATUS(ended));
  int number = WTERMSIG(ended);
  if (number == SIGXCPU || number == SIGKILL)
    return scree_fail(
        c->error, SCREE_LIMIT,
        "%s was stopped: it took more than %d s of processor time, or the system killed it",
        c->what, c->limits->processor_s);
  return scree_fail(c->error, SCREE_BAD_FILE,
                    "%s crashed (signal %d, %s; it had %zu MB): the file is damaged or means harm",
                    c->what, number, strsignal(number), c->limits->memory_bytes >> 20);
}

scree_status scree_child_run(scree_child_work *work, void *context,
                             const scree_child_limits *limits, const char *what,
                             scree_child_answer *answer, scree_error *error) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return scree_fail(error, SCREE_IO, "%s: no pipe: %s", what, strerror(errno));
  scree_child_answer made = {0};
  collection c = {limits, what, &made, now_ms() + (int64_t)limits->wall_s * 1000, error};
  pid_t child = fork();
  if (child == 0) be_child(work, context, limits, ends[1]);
  int fork_errno = errno, ended = 0;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return scree_fail(error, SCREE_IO, "%s: no child process: %s", what, strerror(fork_errno));
  }
  scree_status status = collect(&c, ends[0]);
  close(ends[0]);
  scree_status burial = bury(&c, child, status != SCREE_OK, &ended);
  if (status == SCREE_OK) status = burial;
  if (status == SCREE_OK) status = judge(&c, ended);
  if (status != SCREE_OK) {
    scree_free(made.items);
    return status;
  }
  *answer = made;
  return SCREE_OK;
}
