/* Linux and macOS beyond what a browser has: processes, signals, pages of memory. What only Linux
 * tells (/proc) is left out elsewhere. */
#define _GNU_SOURCE /* for O_TMPFILE, sched_getaffinity */
#include "base/platform.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <malloc.h>
#include <sched.h>
#endif

extern char **environ;

/* ---- machine ---- */

int scree_processor_count(void) {
#ifdef __linux__
  cpu_set_t processors;
  if (sched_getaffinity(0, sizeof processors, &processors) == 0) return CPU_COUNT(&processors);
#endif
  long count = sysconf(_SC_NPROCESSORS_ONLN);
  return count > 0 ? (int)count : 1;
}

size_t scree_machine_memory(void) {
  long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0 ? (size_t)pages * (size_t)page : 0;
}

void scree_processor_name(char text[SCREE_SYSTEM_TEXT]) {
  char line[SCREE_SYSTEM_TEXT];
  FILE *stream = fopen("/proc/cpuinfo", "r");
  snprintf(text, SCREE_SYSTEM_TEXT, "unknown");
  while (stream && fgets(line, sizeof line, stream)) {
    const char *colon = strchr(line, ':');
    if (!colon || strncmp(line, "model name", 10) != 0) continue;
    line[strcspn(line, "\n")] = 0;
    snprintf(text, SCREE_SYSTEM_TEXT, "%s", colon + 1 + strspn(colon + 1, " "));
    break;
  }
  if (stream) fclose(stream);
}

void scree_pages_large(void *block, size_t size) {
#ifdef MADV_HUGEPAGE
  (void)madvise(block, size, MADV_HUGEPAGE);
#else
  (void)block, (void)size;
#endif
}

void scree_pages_touch(void *block, size_t size) {
#ifdef MADV_POPULATE_WRITE
  (void)madvise(block, size, MADV_POPULATE_WRITE);
#else
  (void)block, (void)size;
#endif
}

void scree_pages_drop(void *block, size_t size) {
#ifdef MADV_DONTNEED
  (void)madvise(block, size, MADV_DONTNEED);
#else
  (void)block, (void)size;
#endif
}

void scree_pages_give_back(void) {
#ifdef M_MMAP_THRESHOLD
  (void)mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

/* ---- files without a name ---- */

#ifdef __linux__
enum { OWN_LINK = 32 };
static void own_link(int descriptor, char text[static OWN_LINK]) {
  snprintf(text, OWN_LINK, "/proc/self/fd/%d", descriptor);
}

int scree_nameless_open(const char *folder) {
  int descriptor = open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
  if (descriptor < 0) return -1;
  char text[OWN_LINK];
  own_link(descriptor, text);
  if (access(text, F_OK) == 0) return descriptor; /* else it could never be given a name */
  close(descriptor);
  return -1;
}
bool scree_nameless_link(int descriptor, const char *path) {
  char text[OWN_LINK];
  own_link(descriptor, text);
  return linkat(AT_FDCWD, text, AT_FDCWD, path, AT_SYMLINK_FOLLOW) == 0;
}
int scree_nameless_read(int descriptor) {
  char text[OWN_LINK];
  own_link(descriptor, text);
  return open(text, O_RDONLY | O_CLOEXEC);
}
#endif

/* ---- threads and processes ---- */

bool scree_thread_start(void *(*work)(void *argument), void *argument) {
  pthread_attr_t attributes;
  pthread_t thread;
  sigset_t all, before;
  if (pthread_attr_init(&attributes) != 0) return false;
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  bool started = pthread_create(&thread, &attributes, work, argument) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  pthread_attr_destroy(&attributes);
  return started;
}

void scree_at_fork(void (*child)(void)) {
  (void)pthread_atfork(NULL, NULL, child);
}

static bool read_small(const char *path, char *buffer, size_t size) {
  int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  ssize_t got = read(descriptor, buffer, size - 1);
  close(descriptor);
  buffer[got > 0 ? got : 0] = 0;
  return got >= 0;
}

/* 0 also for a dead one that was not yet waited for. */
unsigned long long scree_process_start(long process) {
  char path[48], text[1024], state = 0;
  unsigned long long start = 0;
  snprintf(path, sizeof path, "/proc/%ld/stat", process);
  if (!read_small(path, text, sizeof text)) return 0;
  const char *after = strrchr(text, ')'); /* the name may hold anything */
  if (!after ||
      sscanf(after + 1,
             " %c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %*u %*u %*d %*d %*d %*d %*d %*d %llu",
             &state, &start) != 2)
    return 0;
  return state == 'Z' || state == 'X' ? 0 : start;
}

/* Host, boot and process namespace. */
void scree_machine_identity(char text[SCREE_SYSTEM_TEXT]) {
  char host[SCREE_SYSTEM_TEXT], boot[64] = "", namespace[64] = "";
  scree_host_name(host);
  read_small("/proc/sys/kernel/random/boot_id", boot, sizeof boot);
  boot[strcspn(boot, "\n")] = 0;
  ssize_t length = readlink("/proc/self/ns/pid", namespace, sizeof namespace - 1);
  namespace[length > 0 ? length : 0] = 0;
  snprintf(text, SCREE_SYSTEM_TEXT, "%.64s %s %s", host, boot, namespace);
}

bool scree_program_path(char *path, size_t size) {
  return scree_path_full("/proc/self/exe", path, size);
}

int scree_process_run(const char *const *words, const char *output, const char *errors,
                      long *process) {
  enum { MOST_WORDS = 64 };
  /* spawn takes no const words, and changes none */
  union {
    const char *fixed[MOST_WORDS];
    char *words[MOST_WORDS];
  } line;
  size_t count = 1;
  line.fixed[0] = words[0];
  for (; words[count] && count + 1 < MOST_WORDS; count++) line.fixed[count] = words[count];
  line.fixed[count] = NULL;
  bool self = !strcmp(words[0], "scree");
  pid_t started;
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  const char *files[] = {output, errors};
  int code = posix_spawn_file_actions_init(&actions);
  if (code != 0) return code;
  code = posix_spawnattr_init(&attributes);
  if (code != 0) {
    posix_spawn_file_actions_destroy(&actions);
    return code;
  }
  for (int i = 0; i < 2 && code == 0; i++)
    if (files[i])
      code = posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO + i, files[i],
                                              O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (output && code == 0) code = posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  if (code == 0)
    code = self
               ? posix_spawn(&started, "/proc/self/exe", &actions, &attributes, line.words, environ)
               : posix_spawnp(&started, words[0], &actions, &attributes, line.words, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (code == 0) *process = started;
  return code;
}

scree_process_state scree_process_look(long process, bool wait, int *code) {
  int status = 0;
  pid_t found;
  do found = waitpid((pid_t)process, &status, wait ? 0 : WNOHANG);
  while (wait && found < 0 && errno == EINTR);
  if (found != process) return SCREE_PROCESS_RUNS;
  *code = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
  return WIFEXITED(status) ? SCREE_PROCESS_ENDED : SCREE_PROCESS_KILLED;
}

void scree_process_stop(long process) {
  if (kill((pid_t)-process, SIGTERM) != 0) kill((pid_t)process, SIGTERM);
}
void scree_process_kill(long process) {
  kill((pid_t)-process, SIGKILL);
}

/* ---- the program's surroundings ---- */

/* A standard stream that came closed would be the number of the first file opened, and what is
 * printed would land in it. Reading /dev/null fails where it is written to, as it should. */
void scree_program_begin(int *count, char ***words) {
  (void)count, (void)words;
  for (int fd = 0; fd < 3; fd++)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd ? O_RDONLY : O_WRONLY) != fd) _exit(1);
  signal(SIGXFSZ, SIG_IGN);
  signal(SIGPIPE, SIG_DFL); /* a reader that has enough ends it, whoever started it */
  scree_pages_give_back();
}

bool scree_is_terminal(FILE *stream) {
  return isatty(fileno(stream));
}
int scree_terminal_columns(void) {
  struct winsize size;
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

static const int caught[] = {SIGINT, SIGTERM, SIGHUP};
enum { CAUGHT = sizeof caught / sizeof *caught };

void scree_signals_catch(void (*handler)(int number), bool restart) {
  struct sigaction action = {.sa_handler = handler, .sa_flags = (int)SA_RESETHAND}, before;
  if (restart) action.sa_flags |= (int)SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < CAUGHT; i++) {
    bool ignored = caught[i] == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 &&
                   before.sa_handler == SIG_IGN; /* nohup */
    if (!ignored) sigaction(caught[i], &action, NULL);
  }
}

static sigset_t before_hold;

void scree_signals_hold(void) {
  sigset_t ours;
  sigemptyset(&ours);
  for (size_t i = 0; i < CAUGHT; i++) sigaddset(&ours, caught[i]);
  sigprocmask(SIG_BLOCK, &ours, &before_hold);
}
void scree_signals_go_on(void) {
  sigprocmask(SIG_SETMASK, &before_hold, NULL);
}

void scree_signals_release(void (*handler)(int number)) {
  for (size_t i = 0; i < CAUGHT; i++) {
    struct sigaction before;
    if (sigaction(caught[i], NULL, &before) == 0 && before.sa_handler == handler)
      signal(caught[i], SIG_DFL);
  }
}

void scree_signal_end(int number) {
  signal(number, SIG_DFL);
  raise(number);
}
