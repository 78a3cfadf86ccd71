/* A lease is a small file made complete under another name and then linked to its own: link fails
 * where the name exists, also on network file systems, so one of several wins. Signs of life
 * replace the file and so its modification time; its age is told against a file just written to the
 * same folder, so that the clocks of the machines do not matter, only the file server's. A dead
 * holder's file is moved away, which again one of several wins; the mover looks whether it got the
 * one it had judged, and puts a younger one back.
 *
 * Content: token, machine, process, its start time, worker, note; a line each. Machine is host
 * name, boot and process namespace: only where all agree does the process number mean something
 * here. */
#include "study/lease.h"

#include "base/alloc.h"
#include "base/file.h"
#include "base/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { CONTENT = 1024, MACHINE = 256, MOST_TRIES = 8 };

typedef struct content {
  char token[64], machine[MACHINE], worker[SCREE_LEASE_NAME], note[SCREE_LEASE_NOTE];
  long pid;
  unsigned long long start;
  double modified;
} content;

/* ---- this process ---- */

static bool read_small(const char *path, char *buffer, size_t size, double *modified) {
  int fd = open(path, O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  ssize_t got = read(fd, buffer, size - 1);
  int reason = errno;
  struct stat info;
  bool good = got >= 0 && fstat(fd, &info) == 0;
  if (good && modified)
    *modified = (double)info.st_mtim.tv_sec + 1e-9 * (double)info.st_mtim.tv_nsec;
  close(fd);
  errno = reason;
  buffer[got > 0 ? got : 0] = 0;
  return good;
}

static void host_name(char *buffer, size_t size) {
  if (gethostname(buffer, size) != 0) snprintf(buffer, size, "unknown");
  buffer[size - 1] = 0;
}

static void machine_name(char machine[MACHINE]) {
  char host[96], boot[64] = "", namespace[64] = "";
  host_name(host, sizeof host);
  read_small("/proc/sys/kernel/random/boot_id", boot, sizeof boot, NULL);
  boot[strcspn(boot, "\n")] = 0;
  ssize_t length = readlink("/proc/self/ns/pid", namespace, sizeof namespace - 1);
  namespace[length > 0 ? length : 0] = 0;
  snprintf(machine, MACHINE, "%s %s %s", host, boot, namespace);
}

/* When the process started, in the kernel's ticks; 0 where there is none, or a dead one not yet
 * waited for. */
static unsigned long long start_time(long pid) {
  char path[48], text[CONTENT], state = 0;
  unsigned long long start = 0;
  snprintf(path, sizeof path, "/proc/%ld/stat", pid);
  if (!read_small(path, text, sizeof text, NULL)) return 0;
  const char *after = strrchr(text, ')'); /* the name may hold anything */
  if (!after || sscanf(after + 1,
                       " %c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %*u %*u %*d %*d %*d %*d %*d "
                       "%*d %llu",
                       &state, &start) != 2)
    return 0;
  return state == 'Z' || state == 'X' ? 0 : start;
}

static void make_token(char token[64]) {
  static unsigned counter;
  uint64_t noise = 0;
  int fd = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
  if (fd >= 0) {
    if (read(fd, &noise, sizeof noise) != sizeof noise) noise = 0;
    close(fd);
  }
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  snprintf(token, 64, "%016llx-%llx-%ld-%u", (unsigned long long)noise,
           (unsigned long long)now.tv_nsec, (long)getpid(), counter++);
}

void scree_lease_default_worker(char worker[SCREE_LEASE_NAME]) {
  char host[96];
  host_name(host, sizeof host);
  snprintf(worker, SCREE_LEASE_NAME, "%s.%ld", host, (long)getpid());
}

/* ---- files ---- */

static char *join(const char *folder, const char *name, const char *ending) {
  size_t size = strlen(folder) + strlen(name) + strlen(ending) + 2;
  char *path = scree_alloc(size, 1);
  if (path) snprintf(path, size, "%s/%s%s", folder, name, ending);
  return path;
}

static void take_line(const char **text, char *line, size_t size) {
  size_t length = strcspn(*text, "\n");
  snprintf(line, size, "%.*s", (int)length, *text);
  *text += length + ((*text)[length] == '\n');
}

static bool read_content(const char *path, content *c) {
  char text[CONTENT], pid[32], start[32];
  if (!read_small(path, text, sizeof text, &c->modified)) return false;
  const char *rest = text;
  take_line(&rest, c->token, sizeof c->token);
  take_line(&rest, c->machine, sizeof c->machine);
  take_line(&rest, pid, sizeof pid);
  take_line(&rest, start, sizeof start);
  take_line(&rest, c->worker, sizeof c->worker);
  take_line(&rest, c->note, sizeof c->note);
  c->pid = strtol(pid, NULL, 10);
  c->start = strtoull(start, NULL, 10);
  return true;
}

/* A complete file beside the lease, *modified its time; NULL after filling the error. */
static char *write_aside(const char *folder, const char *token, const char *worker,
                         const char *note, double *modified, scree_error *error) {
  char machine[MACHINE], text[CONTENT];
  char *path = join(folder, ".new-", token);
  if (!path) {
    scree_fail_memory(error, 0, "a lease");
    return NULL;
  }
  machine_name(machine);
  int size = snprintf(text, sizeof text, "%s\n%s\n%ld\n%llu\n%.150s\n%.90s\n", token, machine,
                      (long)getpid(), start_time(getpid()), worker, note);
  int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  errno = fd < 0 ? errno : 0;
  bool good = fd >= 0 && write(fd, text, (size_t)size) == size && fsync(fd) == 0;
  int reason = errno ? errno : ENOSPC;
  struct stat info;
  if (good) good = fstat(fd, &info) == 0;
  if (fd >= 0) close(fd);
  if (good) {
    *modified = (double)info.st_mtim.tv_sec + 1e-9 * (double)info.st_mtim.tv_nsec;
    return path;
  }
  scree_fail(error, SCREE_IO, "%s: cannot write: %s", path, strerror(reason));
  unlink(path);
  scree_free(path);
  return NULL;
}

static bool is_dead(const content *c, double now, double lease_s) {
  char machine[MACHINE];
  machine_name(machine);
  if (!strcmp(machine, c->machine)) return start_time(c->pid) != c->start;
  return now - c->modified > lease_s;
}

static void note_death(const char *folder, const char *name, const content *c) {
  char *path = join(folder, name, ".deaths");
  FILE *stream = path ? fopen(path, "a") : NULL;
  if (stream) {
    fprintf(stream, "%s\n", c->worker);
    fclose(stream);
  }
  scree_free(path);
}

/* Moves the dead holder's file away; false where it is not the one that was judged any more. */
static bool bury(const char *path, const char *aside, const content *dead) {
  size_t size = strlen(aside) + 8;
  char *grave = scree_alloc(size, 1);
  content found;
  bool moved = false;
  if (!grave) return false;
  snprintf(grave, size, "%s.dead", aside);
  if (rename(path, grave) == 0) {
    moved = read_content(grave, &found) && !strcmp(found.token, dead->token) &&
            found.modified == dead->modified;
    if (!moved && link(grave, path) != 0) moved = false; /* somebody was quicker: both go on */
    unlink(grave);
  }
  scree_free(grave);
  return moved;
}

scree_status scree_lease_take(const char *folder, const char *name, double lease_s,
                              const char *worker, bool *taken, scree_lease *lease,
                              scree_error *error) {
  scree_lease made = {.folder = scree_strdup(folder), .path = join(folder, name, "")};
  double now = 0;
  scree_status status = SCREE_OK;
  make_token(made.token);
  snprintf(made.worker, sizeof made.worker, "%s", worker);
  char *aside = NULL;
  *taken = false;
  if (!made.folder || !made.path)
    status = scree_fail_memory(error, 0, "a lease");
  else if (!(aside = write_aside(folder, made.token, worker, "leased", &now, error)))
    status = error ? error->status : SCREE_IO;
  for (int i = 0; status == SCREE_OK && !*taken && i < MOST_TRIES; i++) {
    content holder;
    *taken = link(aside, made.path) == 0;
    if (*taken) break;
    if (errno != EEXIST) {
      status =
          scree_fail(error, SCREE_IO, "%s: cannot make the lease: %s", made.path, strerror(errno));
      break;
    }
    if (!read_content(made.path, &holder)) continue; /* given back meanwhile */
    if (!is_dead(&holder, now, lease_s)) break;
    if (bury(made.path, aside, &holder)) note_death(folder, name, &holder);
  }
  if (aside) unlink(aside);
  scree_free(aside);
  made.last_renewal = scree_now();
  if (status == SCREE_OK && *taken) {
    *lease = made;
    return SCREE_OK;
  }
  scree_free(made.folder);
  scree_free(made.path);
  return status;
}

static bool still_ours(const scree_lease *lease) {
  content c;
  return read_content(lease->path, &c) && !strcmp(c.token, lease->token);
}

scree_status scree_lease_renew(scree_lease *lease, const char *note, bool *kept,
                               scree_error *error) {
  double now;
  *kept = still_ours(lease);
  if (!*kept) return SCREE_OK;
  char *aside = write_aside(lease->folder, lease->token, lease->worker, note, &now, error);
  if (!aside) return error ? error->status : SCREE_IO;
  scree_status status = SCREE_OK;
  if (rename(aside, lease->path) != 0)
    status = scree_fail(error, SCREE_IO, "%s: cannot renew: %s", lease->path, strerror(errno));
  scree_free(aside);
  lease->last_renewal = scree_now();
  return status;
}

void scree_lease_release(scree_lease *lease) {
  if (lease->path && still_ours(lease)) unlink(lease->path);
  scree_free(lease->folder);
  scree_free(lease->path);
  *lease = (scree_lease){0};
}

scree_status scree_lease_look(const char *folder, const char *name, double lease_s,
                              scree_lease_view *view, scree_error *error) {
  content c;
  scree_lease_view seen = {0};
  char *path = join(folder, name, ""), token[64];
  if (!path) return scree_fail_memory(error, 0, "a lease");
  seen.held = read_content(path, &c);
  scree_free(path);
  if (seen.held) {
    struct timespec clock;
    double now;
    make_token(token);
    char *aside = write_aside(folder, token, "", "", &now, NULL);
    clock_gettime(CLOCK_REALTIME, &clock);
    if (!aside) now = (double)clock.tv_sec; /* a folder we may only read */
    if (aside) unlink(aside);
    scree_free(aside);
    seen.age = now - c.modified;
    seen.alive = !is_dead(&c, now, lease_s);
    memcpy(seen.worker, c.worker, sizeof seen.worker);
    memcpy(seen.note, c.note, sizeof seen.note);
  }
  *view = seen;
  return SCREE_OK;
}

size_t scree_lease_deaths(const char *folder, const char *name, char last[SCREE_LEASE_NAME]) {
  char *path = join(folder, name, ".deaths"), line[SCREE_LEASE_NAME];
  FILE *stream = path ? fopen(path, "r") : NULL;
  size_t count = 0;
  while (stream && fgets(line, sizeof line, stream)) {
    line[strcspn(line, "\n")] = 0;
    if (last) memcpy(last, line, sizeof line);
    count++;
  }
  if (stream) fclose(stream);
  scree_free(path);
  return count;
}

void scree_lease_forget_deaths(const char *folder, const char *name) {
  char *path = join(folder, name, ".deaths");
  if (path) unlink(path);
  scree_free(path);
}
