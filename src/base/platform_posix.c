/* Linux and macOS; what a browser has of POSIX too comes first, the rest is in
 * platform_unix.c or platform_wasm.c. */
#define _GNU_SOURCE /* for renameat2 */
#include "base/platform.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

/* ---- machine ---- */

void scree_system_name(char text[SCREE_SYSTEM_TEXT]) {
  struct utsname system = {.sysname = "unknown"};
  uname(&system);
  snprintf(text, SCREE_SYSTEM_TEXT, "%.60s %.60s, %.60s", system.sysname, system.release,
           system.machine);
}

void scree_host_name(char text[SCREE_SYSTEM_TEXT]) {
  if (gethostname(text, SCREE_SYSTEM_TEXT) != 0) snprintf(text, SCREE_SYSTEM_TEXT, "unknown");
  text[SCREE_SYSTEM_TEXT - 1] = 0;
}

/* ---- time ---- */

static double read_clock(clockid_t clock) {
  struct timespec t = {0, 0};
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double scree_now(void) {
  return read_clock(CLOCK_MONOTONIC);
}
double scree_processor_time(void) {
  return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}
double scree_calendar_time(void) {
  return read_clock(CLOCK_REALTIME);
}

void scree_format_time(double calendar, char text[32]) {
  *text = 0;
  if (!(calendar > 0 && calendar < SCREE_TIME_END)) return;
  time_t seconds = (time_t)calendar;
  struct tm parts;
  if (gmtime_r(&seconds, &parts)) strftime(text, 32, "%Y-%m-%dT%H:%M:%SZ", &parts);
}

void scree_sleep(double seconds) {
  struct timespec pause = {(time_t)seconds, 0};
  pause.tv_nsec = (long)(1e9 * (seconds - (double)pause.tv_sec));
  nanosleep(&pause, NULL);
}

/* ---- files by path ---- */

static double modified_time(const struct stat *found) {
#ifdef __APPLE__
  const struct timespec *t = &found->st_mtimespec;
#else
  const struct timespec *t = &found->st_mtim;
#endif
  return (double)t->tv_sec + 1e-9 * (double)t->tv_nsec;
}

static bool tell(int result, const struct stat *found, scree_path_info *info) {
  if (result != 0) return false;
  if (!info) return true;
  *info = (scree_path_info){.kind = S_ISREG(found->st_mode)   ? SCREE_PATH_FILE
                                    : S_ISDIR(found->st_mode) ? SCREE_PATH_FOLDER
                                    : S_ISCHR(found->st_mode) ? SCREE_PATH_DEVICE
                                                              : SCREE_PATH_OTHER,
                            .locked = !(found->st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)),
                            .byte_count = (uint64_t)found->st_size,
                            .device = (uint64_t)found->st_dev,
                            .number = (uint64_t)found->st_ino,
                            .modified = modified_time(found)};
  return true;
}

bool scree_path_look(const char *path, scree_path_info *info) {
  struct stat found;
  return tell(stat(path, &found), &found, info);
}
bool scree_path_look_at_link(const char *path, scree_path_info *info) {
  struct stat found;
  return tell(lstat(path, &found), &found, info);
}
bool scree_descriptor_look(int descriptor, scree_path_info *info) {
  struct stat found;
  return tell(fstat(descriptor, &found), &found, info);
}
bool scree_path_exists(const char *path) {
  return access(path, F_OK) == 0;
}
bool scree_path_may_write(const char *path) {
  return faccessat(AT_FDCWD, path, W_OK, AT_EACCESS) == 0;
}

bool scree_path_full(const char *path, char *full, size_t size) {
  char *found = realpath(path, NULL);
  bool fits = found && strlen(found) < size;
  if (fits) memcpy(full, found, strlen(found) + 1);
  if (found && !fits) errno = ENAMETOOLONG;
  free(found);
  return fits;
}

int scree_open_read(const char *path) {
  return open(path, O_RDONLY | O_CLOEXEC);
}

/* The last one is looked at first: to open a device or a pipe may do something, or wait. */
static int open_step(int folder, const char *name, bool is_last) {
  struct stat found;
  const int flags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY;
  errno = EXDEV;
  if (!strcmp(name, "..")) return -1;
  if (fstatat(folder, name, &found, AT_SYMLINK_NOFOLLOW) != 0) return -1;
  errno = S_ISLNK(found.st_mode) ? ELOOP : EINVAL;
  if (is_last ? !S_ISREG(found.st_mode) : !S_ISDIR(found.st_mode)) return -1;
  int fd = openat(folder, name, flags | (is_last ? 0 : O_DIRECTORY));
  if (fd < 0 || !is_last || (fstat(fd, &found) == 0 && S_ISREG(found.st_mode))) return fd;
  close(fd);
  errno = EINVAL;
  return -1;
}

int scree_open_beneath(const char *folder, const char *path) {
  char name[NAME_MAX + 1];
  int at = open(*folder ? folder : ".", O_RDONLY | O_CLOEXEC | O_DIRECTORY);
  for (const char *slash = path; at >= 0 && slash; path = slash + 1) {
    slash = strchr(path, '/');
    int above = at, length = slash ? (int)(slash - path) : (int)strlen(path);
    errno = ENAMETOOLONG;
    snprintf(name, sizeof name, "%.*s", length, path);
    at = length <= NAME_MAX ? open_step(above, name, !slash) : -1;
    int reason = errno;
    close(above);
    errno = reason;
  }
  return at;
}
int scree_open_write(const char *path) {
  return open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
}
int scree_open_new(const char *path) {
  return open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}
int scree_lock_open(const char *path) {
  int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0 || flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  int reason = errno;
  close(fd);
  errno = reason;
  return -1;
}
FILE *scree_open_stream(const char *path, const char *mode) {
  return fopen(path, mode);
}
ptrdiff_t scree_read(int descriptor, void *bytes, size_t count) {
  return read(descriptor, bytes, count);
}
ptrdiff_t scree_write(int descriptor, const void *bytes, size_t count) {
  return write(descriptor, bytes, count);
}
void scree_close(int descriptor) {
  close(descriptor);
}
ptrdiff_t scree_read_at(int descriptor, void *bytes, size_t count, uint64_t place) {
  return pread(descriptor, bytes, count, (off_t)place);
}
bool scree_sync(int descriptor) {
  return fsync(descriptor) == 0;
}
bool scree_cut(FILE *stream, uint64_t length) {
  return ftruncate(fileno(stream), (off_t)length) == 0 && fseek(stream, 0, SEEK_END) == 0;
}

bool scree_path_remove(const char *path) {
  return unlink(path) == 0;
}
bool scree_path_rename(const char *from, const char *to) {
  return rename(from, to) == 0;
}
bool scree_path_rename_new(const char *from, const char *to) {
#ifdef RENAME_NOREPLACE
  if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
#endif
  return rename(from, to) == 0;
}
bool scree_path_link(const char *from, const char *to) {
  return link(from, to) == 0;
}

/* ---- folders ---- */

bool scree_folder_make(const char *path) {
  return mkdir(path, 0777) == 0;
}
bool scree_folder_remove(const char *path) {
  return rmdir(path) == 0;
}

scree_folder *scree_folder_open(const char *path) {
  return (scree_folder *)opendir(path);
}
const char *scree_folder_next(scree_folder *folder) {
  for (struct dirent *entry; (entry = readdir((DIR *)folder));)
    if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) return entry->d_name;
  return NULL;
}
void scree_folder_close(scree_folder *folder) {
  closedir((DIR *)folder);
}

/* ---- streams ---- */

FILE *scree_memory_open(char **text, size_t *size) {
  return open_memstream(text, size);
}
bool scree_memory_close(FILE *stream) {
  return fclose(stream) == 0;
}
FILE *scree_null_open(void) {
  return fopen("/dev/null", "w");
}

long scree_process_number(void) {
  return (long)getpid();
}

uint64_t scree_random_number(void) {
  uint64_t noise = 0;
  int random = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
  if (random >= 0) {
    if (read(random, &noise, sizeof noise) != sizeof noise) noise = 0;
    close(random);
  }
  return noise ^ (uint64_t)(1e9 * read_clock(CLOCK_REALTIME));
}
