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
#include "base/platform.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { CONTENT = 1024, MACHINE = SCREE_SYSTEM_TEXT, MOST_TRIES = 8 };

typedef struct content {
  char token[64], machine[MACHINE], worker[SCREE_LEASE_NAME], note[SCREE_LEASE_NOTE];
  long pid;
  unsigned long long start;
  double modified;
} content;

/* ---- this process ---- */

static bool read_small(const char *path, char *buffer, size_t size, double *modified) {
  int fd = scree_open_read(path);
  if (fd < 0) return false;
  ptrdiff_t got = scree_read(fd, buffer, size - 1);
  int reason = errno;
  scree_path_info info;
  bool good = got >= 0 && scree_descriptor_look(fd, &info);
  if (good) *modified = info.modified;
  scree_close(fd);
  errno = reason;
  buffer[got > 0 ? got : 0] = 0;
  return good;
}

static void make_token(char token[64]) {
  static unsigned counter;
  snprintf(token, 64, "%016llx-%ld-%u", (unsigned long long)scree_random_number(),
           scree_process_number(), counter++);
}

void scree_lease_default_worker(char worker[SCREE_LEASE_NAME]) {
  char host[SCREE_SYSTEM_TEXT];
  scree_host_name(host);
  snprintf(worker, SCREE_LEASE_NAME, "%.96s.%ld", host, scree_process_number());
}

/* ---- files ---- */

static const char *join(const char *folder, const char *name, const char *ending,
                        char path[SCREE_PATH_BYTES]) {
  snprintf(path, SCREE_PATH_BYTES, "%s/%s%s", folder, name, ending);
  return path;
}
#define JOIN(folder, name, ending) join(folder, name, ending, (char[SCREE_PATH_BYTES]){0})

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

/* A complete file beside the lease, *modified its time. */
static scree_status write_aside(const char *path, const char *token, const char *worker,
                                const char *note, double *modified, scree_error *error) {
  char machine[MACHINE], text[CONTENT];
  scree_machine_identity(machine);
  int size =
      snprintf(text, sizeof text, "%s\n%s\n%ld\n%llu\n%.150s\n%.90s\n", token, machine,
               scree_process_number(), scree_process_start(scree_process_number()), worker, note);
  int fd = scree_open_new(path);
  errno = fd < 0 ? errno : 0;
  bool good = fd >= 0 && scree_write(fd, text, (size_t)size) == size && scree_sync(fd);
  int reason = errno ? errno : ENOSPC;
  scree_path_info info;
  if (good) good = scree_descriptor_look(fd, &info);
  if (fd >= 0) scree_close(fd);
  if (good) {
    *modified = info.modified;
    return SCREE_OK;
  }
  scree_path_remove(path);
  return scree_fail(error, SCREE_IO, "%s: cannot write: %s", path, strerror(reason));
}

static bool is_dead(const content *c, double now, double lease_s) {
  char machine[MACHINE];
  scree_machine_identity(machine);
  if (!strcmp(machine, c->machine)) return scree_process_start(c->pid) != c->start;
  return now - c->modified > lease_s;
}

static void note_death(const char *folder, const char *name, const content *c) {
  FILE *stream = scree_open_stream(JOIN(folder, name, ".deaths"), "a");
  if (!stream) return;
  fprintf(stream, "%s\n", c->worker);
  fclose(stream);
}

/* Moves the dead holder's file away; false where it is not the one that was judged any more. */
static bool bury(const char *path, const char *aside, const content *dead) {
  char grave[SCREE_PATH_BYTES + sizeof ".dead"];
  content found;
  snprintf(grave, sizeof grave, "%s.dead", aside);
  if (!scree_path_rename(path, grave)) return false;
  bool moved = read_content(grave, &found) && !strcmp(found.token, dead->token) &&
               found.modified == dead->modified;
  if (!moved) (void)scree_path_link(grave, path); /* or somebody was quicker: both go on */
  scree_path_remove(grave);
  return moved;
}

scree_status scree_lease_take(const char *folder, const char *name, double lease_s,
                              const char *worker, bool *taken, scree_lease *lease,
                              scree_error *error) {
  scree_lease made = {.last_renewal = 0};
  double now = 0;
  make_token(made.token);
  join(folder, name, "", made.path);
  snprintf(made.worker, sizeof made.worker, "%s", worker);
  const char *aside = join(folder, ".new-", made.token, made.aside);
  *taken = false;
  scree_status status = write_aside(aside, made.token, worker, "leased", &now, error);
  for (int i = 0; status == SCREE_OK && !*taken && i < MOST_TRIES; i++) {
    content holder;
    *taken = scree_path_link(aside, made.path);
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
  scree_path_remove(aside);
  made.last_renewal = scree_now();
  if (status == SCREE_OK && *taken) *lease = made;
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
  SCREE_TRY(write_aside(lease->aside, lease->token, lease->worker, note, &now, error));
  lease->last_renewal = scree_now();
  if (scree_path_rename(lease->aside, lease->path)) return SCREE_OK;
  return scree_fail(error, SCREE_IO, "%s: cannot renew: %s", lease->path, strerror(errno));
}

void scree_lease_release(scree_lease *lease) {
  if (*lease->path && still_ours(lease)) scree_path_remove(lease->path);
  *lease = (scree_lease){0};
}

scree_lease_view scree_lease_look(const char *folder, const char *name, double lease_s) {
  content c;
  scree_lease_view seen = {0};
  char token[64];
  seen.held = read_content(JOIN(folder, name, ""), &c);
  if (seen.held) {
    double now = scree_calendar_time(); /* in a folder that we may only read */
    make_token(token);
    const char *aside = JOIN(folder, ".new-", token);
    if (write_aside(aside, token, "", "", &now, NULL) == SCREE_OK) scree_path_remove(aside);
    seen.age = now - c.modified;
    seen.alive = !is_dead(&c, now, lease_s);
    memcpy(seen.worker, c.worker, sizeof seen.worker);
    memcpy(seen.note, c.note, sizeof seen.note);
  }
  return seen;
}

size_t scree_lease_deaths(const char *folder, const char *name, char last[SCREE_LEASE_NAME]) {
  char line[SCREE_LEASE_NAME];
  FILE *stream = scree_open_stream(JOIN(folder, name, ".deaths"), "r");
  size_t count = 0;
  while (stream && fgets(line, sizeof line, stream)) {
    line[strcspn(line, "\n")] = 0;
    if (last) memcpy(last, line, sizeof line);
    count++;
  }
  if (stream) fclose(stream);
  return count;
}

void scree_lease_forget_deaths(const char *folder, const char *name) {
  scree_path_remove(JOIN(folder, name, ".deaths"));
}
