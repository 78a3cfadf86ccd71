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
    return path;
  }
  scree_fail(error, SCREE_IO, "%s: cannot write: %s", path, strerror(reason));
  scree_path_remove(path);
  scree_free(path);
  return NULL;
}

static bool is_dead(const content *c, double now, double lease_s) {
  char machine[MACHINE];
  scree_machine_identity(machine);
  if (!strcmp(machine, c->machine)) return scree_process_start(c->pid) != c->start;
  return now - c->modified > lease_s;
}

static void note_death(const char *folder, const char *name, const content *c) {
  char *path = join(folder, name, ".deaths");
  FILE *stream = path ? scree_open_stream(path, "a") : NULL;
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
  if (scree_path_rename(path, grave)) {
    moved = read_content(grave, &found) && !strcmp(found.token, dead->token) &&
            found.modified == dead->modified;
    if (!moved && !scree_path_link(grave, path))
      moved = false; /* somebody was quicker: both go on */
    scree_path_remove(grave);
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
  if (aside) scree_path_remove(aside);
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
  if (!scree_path_rename(aside, lease->path))
    status = scree_fail(error, SCREE_IO, "%s: cannot renew: %s", lease->path, strerror(errno));
  scree_free(aside);
  lease->last_renewal = scree_now();
  return status;
}

void scree_lease_release(scree_lease *lease) {
  if (lease->path && still_ours(lease)) scree_path_remove(lease->path);
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
    double now;
    make_token(token);
    char *aside = write_aside(folder, token, "", "", &now, NULL);
    if (!aside) now = scree_calendar_time(); /* a folder we may only read */
    if (aside) scree_path_remove(aside);
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
  FILE *stream = path ? scree_open_stream(path, "r") : NULL;
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
  if (path) scree_path_remove(path);
  scree_free(path);
}
