#include "base/file.h"

#include "base/parallel.h"
#include "base/path.h"
#include "base/platform.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#define XXH_INLINE_ALL /* no library to link */
#include <xxhash.h>

enum {
  STREAM_START_BYTES = 1 << 20,
  TEMPORARY_NAMES = 1000,
  TAIL_BYTES = 32,
  NAME_BYTES = 255, /* of one name in a folder, on every system */
};

/* What a stream may hold where no limit was given: one that never ends must not take the machine's
 * memory with it. A buffer that doubles, and what is made of it, take several times as much. */
static size_t stream_limit(void) {
  size_t memory = scree_machine_memory();
  return memory > 0 ? memory / 8 : SIZE_MAX;
}

/* Where a file is left: judge is NULL where that is at its end. */
typedef struct ending {
  scree_file_judge *judge;
  size_t whole_count; /* of the file that was left, or SCREE_NO_END; 0: it was not */
} ending;

/* Whether enough was read, which is cut to that. */
static bool is_enough(ending *e, const char *bytes, size_t *used, bool all) {
  if (!e->judge || (*used < SCREE_JUDGED_BYTES && !all)) return false;
  size_t judged = *used < SCREE_JUDGED_BYTES ? *used : SCREE_JUDGED_BYTES;
  size_t enough = e->judge(bytes, judged, SCREE_NO_END);
  if (*used <= enough) return false;
  e->whole_count = SCREE_NO_END;
  *used = enough;
  return true;
}

/* Reads a stream of unknown length, doubling. */
static scree_status read_stream(int fd, const char *name, size_t max_bytes, ending *end,
                                char **bytes, size_t *byte_count, scree_error *error) {
  size_t capacity = STREAM_START_BYTES, used = 0, most = max_bytes ? max_bytes : stream_limit();
  char *buffer = scree_alloc(capacity, 1);
  if (!buffer) return scree_fail_memory(error, capacity, name);
  for (;;) {
    if (used + 1 >= capacity) {
      char *grown = capacity > SIZE_MAX / 2 ? NULL : scree_resize(buffer, capacity * 2, 1);
      if (!grown) {
        scree_free(buffer);
        return scree_fail_memory(error, capacity, name);
      }
      buffer = grown;
      capacity *= 2;
    }
    ptrdiff_t got = scree_read(fd, buffer + used, capacity - used - 1);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      int reason = errno;
      scree_free(buffer);
      return scree_fail(error, SCREE_IO, "%s: cannot read at byte %zu: %s", name, used,
                        strerror(reason));
    }
    used += (size_t)got;
    if (is_enough(end, buffer, &used, got == 0) || got == 0) break;
    if (used > most) {
      scree_free(buffer);
      return scree_fail(error, SCREE_LIMIT, "%s: more than the limit of %zu bytes%s", name, most,
                        max_bytes ? "" : ", an eighth of this machine's memory");
    }
  }
  buffer[used] = 0;
  *bytes = buffer;
  *byte_count = used;
  return SCREE_OK;
}

/* A part of a file: up to where it was read, and why no farther. */
typedef struct part {
  size_t end;
  int reason; /* errno, or 0 */
} part;

typedef struct regular_file {
  int fd;
  char *buffer;
  part *parts;
} regular_file;

enum { PART_BYTES = 1 << 22 };

/* The file's bytes from begin to end. */
static part read_range(int fd, char *bytes, size_t begin, size_t end) {
  part p = {begin, 0};
  while (p.end < end) {
    ptrdiff_t got = scree_read_at(fd, bytes + (p.end - begin), end - p.end, p.end);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) p.reason = errno;
    if (got <= 0) break;
    p.end += (size_t)got;
  }
  return p;
}

static void read_part(void *context, scree_block block) {
  const regular_file *file = context;
  file->parts[block.index] =
      read_range(file->fd, file->buffer + block.begin, block.begin, block.end);
}

/* Reads a regular file of known size into one block; in parts on all threads, for half of the time
 * goes into memory that is touched for the first time. */
static scree_status read_regular(int fd, const char *path, size_t size, char **bytes,
                                 size_t *byte_count, scree_error *error) {
  size_t parts = scree_block_count(size, PART_BYTES);
  regular_file file = {fd, scree_alloc(size + 1, 1), scree_alloc(parts, sizeof *file.parts)};
  scree_status status = SCREE_OK;
  if (!file.buffer || !file.parts) {
    status = scree_fail_memory(error, size, path);
    goto done;
  }
  scree_parallel_for(size, PART_BYTES, read_part, &file);
  for (size_t i = 0; i < parts && status == SCREE_OK; i++) {
    const part *p = &file.parts[i];
    if (p->end == (i + 1 < parts ? (i + 1) * PART_BYTES : size)) continue;
    status = scree_fail(error, SCREE_IO, "%s: cannot read past byte %zu of %zu: %s", path, p->end,
                        size, p->reason ? strerror(p->reason) : "the file became shorter");
  }
  if (status != SCREE_OK) goto done;
  file.buffer[size] = 0;
  *bytes = file.buffer;
  *byte_count = size;
  file.buffer = NULL;
done:
  scree_free(file.buffer);
  scree_free(file.parts);
  return status;
}

/* The beginning of a regular file that is not worth reading; *bytes stays where it is. */
static scree_status judge_regular(int fd, const char *path, size_t size, ending *end, char **bytes,
                                  size_t *byte_count, scree_error *error) {
  if (!end->judge || size <= SCREE_JUDGED_BYTES) return SCREE_OK;
  char *beginning = scree_alloc(SCREE_JUDGED_BYTES + 1, 1);
  if (!beginning) return scree_fail_memory(error, SCREE_JUDGED_BYTES, path);
  size_t got = read_range(fd, beginning, 0, SCREE_JUDGED_BYTES).end;
  size_t enough = got < SCREE_JUDGED_BYTES ? SIZE_MAX : end->judge(beginning, got, size);
  if (enough >= size) {
    scree_free(beginning);
    return SCREE_OK;
  }
  end->whole_count = size;
  *byte_count = enough < got ? enough : got;
  beginning[*byte_count] = 0;
  *bytes = beginning;
  return SCREE_OK;
}

static scree_status read_file(const char *path, size_t max_bytes, ending *end, char **bytes,
                              size_t *byte_count, scree_error *error) {
  if (!strcmp(path, "-"))
    return read_stream(fileno(stdin), "standard input", max_bytes, end, bytes, byte_count, error);
  int fd = scree_open_read(path);
  if (fd < 0) return scree_fail(error, SCREE_IO, "%s: cannot open: %s", path, strerror(errno));
  scree_path_info info;
  scree_status status;
  errno = 0;
  if (!scree_descriptor_look(fd, &info))
    status = scree_fail(error, SCREE_IO, "%s: cannot open: %s", path, strerror(errno));
  else if (info.kind == SCREE_PATH_FOLDER)
    status = scree_fail(error, SCREE_IO, "%s: is a folder, not a file", path);
  else if (info.kind != SCREE_PATH_FILE)
    status = read_stream(fd, path, max_bytes, end, bytes, byte_count, error);
  else if (max_bytes && info.byte_count > max_bytes)
    status = scree_fail(error, SCREE_LIMIT, "%s: %zu bytes, more than the limit of %zu", path,
                        (size_t)info.byte_count, max_bytes);
  else {
    status = judge_regular(fd, path, (size_t)info.byte_count, end, bytes, byte_count, error);
    if (status == SCREE_OK && !end->whole_count)
      status = read_regular(fd, path, (size_t)info.byte_count, bytes, byte_count, error);
  }
  scree_close(fd);
  return status;
}

scree_status scree_file_read(const char *path, size_t max_bytes, char **bytes, size_t *byte_count,
                             scree_error *error) {
  return read_file(path, max_bytes, &(ending){NULL, 0}, bytes, byte_count, error);
}

scree_status scree_file_read_judged(const char *path, size_t max_bytes, scree_file_judge *judge,
                                    char **bytes, size_t *byte_count, size_t *whole_count,
                                    scree_error *error) {
  ending end = {judge, 0};
  SCREE_TRY(read_file(path, max_bytes, &end, bytes, byte_count, error));
  *whole_count = end.whole_count ? end.whole_count : *byte_count;
  return SCREE_OK;
}

/* Why a name does not lead down from a folder, on any system; NULL: it does. */
static const char *leads_elsewhere(const char *name) {
  for (const char *p = name; *p; p++)
    if ((unsigned char)*p < ' ' || *p == '\\' || *p == ':' || *p == 127)
      return "it holds a character that no such name has";
  if (*name == '/') return "it begins at the root";
  for (const char *p = name; p; p = strchr(p, '/') ? strchr(p, '/') + 1 : NULL)
    if (!strncmp(p, "..", 2) && (p[2] == '/' || !p[2])) return "it leads out of the folder";
  return *name ? NULL : "it is empty";
}

scree_status scree_file_read_beneath(const char *from, const char *name, size_t byte_count,
                                     char **bytes, scree_error *error) {
  char folder[SCREE_PATH_BYTES];
  const char *reason = leads_elsewhere(name), *slash = strrchr(from, '/');
  int length = !slash ? 0 : slash == from ? 1 : (int)(slash - from);
  snprintf(folder, sizeof folder, "%.*s", length, from);
  int fd = reason ? -1 : scree_open_beneath(folder, name);
  if (fd < 0 && !reason)
    reason = errno == ELOOP    ? "it is a link"
             : errno == EXDEV  ? "it leads out of the folder"
             : errno == EINVAL ? "it is no file"
                               : strerror(errno);
  if (fd < 0)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: only files beside this one are read: '%.100s': %s", from, name, reason);
  scree_path_info info = {.byte_count = 0};
  size_t count;
  scree_status status =
      scree_descriptor_look(fd, &info) && info.byte_count >= byte_count
          ? read_regular(fd, name, byte_count, bytes, &count, error)
          : scree_fail(error, SCREE_BAD_FILE, "%s: '%.100s' should have %zu bytes, and has %zu",
                       from, name, byte_count, (size_t)info.byte_count);
  scree_close(fd);
  return status;
}

bool scree_stream_open(const char *path, scree_stream *stream) {
  scree_path_info info;
  if (!scree_path_look(path, &info) || info.kind != SCREE_PATH_FILE)
    return false; /* to open a pipe may wait */
  int fd = scree_open_read(path);
  XXH3_state_t *hash = fd >= 0 ? XXH3_createState() : NULL;
  if (!hash || !scree_descriptor_look(fd, &info) || info.kind != SCREE_PATH_FILE) {
    XXH3_freeState(hash);
    if (fd >= 0) scree_close(fd);
    return false;
  }
  XXH3_128bits_reset(hash);
  *stream = (scree_stream){fd, (size_t)info.byte_count, 0, hash};
  return true;
}

bool scree_stream_read(scree_stream *stream, void *bytes, size_t byte_count) {
  size_t end = stream->done + byte_count;
  if (read_range(stream->fd, bytes, stream->done, end).end < end) return false;
  stream->done = end;
  XXH3_128bits_update(stream->hash, bytes, byte_count);
  return true;
}

scree_checksum scree_stream_checksum(const scree_stream *stream) {
  XXH128_hash_t hash = XXH3_128bits_digest(stream->hash);
  return (scree_checksum){hash.high64, hash.low64};
}

void scree_stream_close(scree_stream *stream) {
  scree_close(stream->fd);
  XXH3_freeState(stream->hash);
}

/* The length of path without what a name of NAME_BYTES bytes leaves no room for once `more` bytes
 * are put behind it; no character of UTF-8 is cut. */
static size_t room_beside(const char *path, size_t more) {
  const char *slash = strrchr(path, '/');
  size_t length = strlen(path), most = (slash ? (size_t)(slash + 1 - path) : 0) + NAME_BYTES - more;
  if (length <= most) return length;
  while (most > 0 && ((unsigned char)path[most] & 0xc0) == 0x80) most--;
  return most;
}

static size_t temporary_bytes(const char *path) {
  return strlen(path) + TAIL_BYTES;
}

/* The name of the attempt-th temporary file beside path. */
static void name_beside(const char *path, int attempt, char *name, size_t size) {
  char tail[TAIL_BYTES];
  int more = snprintf(tail, sizeof tail, ".%ld-%d.part", scree_process_number(), attempt);
  snprintf(name, size, "%.*s%s", (int)room_beside(path, (size_t)more), path, tail);
}

/* A new file beside path under a name that nobody else has: another machine that shares the folder
 * may have a process of the same number, and a killed one may have left its file. */
static int create_beside(const char *path, char *name, size_t size) {
  int fd = -1;
  for (int attempt = 0; attempt < TEMPORARY_NAMES; attempt++) {
    name_beside(path, attempt, name, size);
    fd = scree_open_new(name);
    if (fd >= 0 || errno != EEXIST) break;
  }
  return fd;
}

/* A file without a name in the folder of path. */
static int create_nameless(const char *path, char *name, size_t size) {
  const char *slash = strrchr(path, '/');
  int length = !slash ? 1 : slash == path ? 1 : (int)(slash - path);
  snprintf(name, size, "%.*s", length, slash ? path : ".");
  int fd = scree_nameless_open(name);
  if (fd >= 0) *name = 0;
  return fd;
}

static bool copy_bytes(int from, int to) {
  enum { PIECE = 1 << 16 };
  char piece[PIECE];
  for (;;) {
    ptrdiff_t got = scree_read(from, piece, PIECE), done = 0;
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return got == 0;
    while (done < got) {
      ptrdiff_t put = scree_write(to, piece + done, (size_t)(got - done));
      if (put < 0 && errno != EINTR) return false;
      if (put > 0) done += put;
    }
  }
}

/* Copies a nameless file to one that has a name beside the target. */
static bool copy_beside(const scree_output *output) {
  int from = scree_nameless_read(fileno(output->stream));
  if (from < 0) return false;
  int to = create_beside(output->path, output->temporary_path, temporary_bytes(output->path));
  bool copied = to >= 0 && copy_bytes(from, to) && scree_sync(to);
  int reason = errno;
  if (to >= 0) scree_close(to);
  if (to >= 0 && !copied) scree_path_remove(output->temporary_path);
  scree_close(from);
  errno = reason;
  return copied;
}

/* Gives a nameless file a name beside the target, from which it can replace that; where the file
 * system has no links after all, its copy. */
static bool give_name(const scree_output *output) {
  for (int attempt = 0; attempt < TEMPORARY_NAMES; attempt++) {
    name_beside(output->path, attempt, output->temporary_path, temporary_bytes(output->path));
    if (scree_nameless_link(fileno(output->stream), output->temporary_path)) return true;
    if (errno != EEXIST) break;
  }
  if (copy_beside(output)) return true;
  int reason = errno;
  *output->temporary_path = 0;
  errno = reason;
  return false;
}

static int create_temporary(const char *path, char *name, size_t size) {
  int fd = create_nameless(path, name, size);
  return fd >= 0 ? fd : create_beside(path, name, size);
}

/* A file may be replaced by whoever may write to its folder; one that nobody may write to is left
 * alone even so, and by root as well. */
static bool is_protected(const char *path, const scree_path_info *info) {
  return info->locked || !scree_path_may_write(path);
}

/* A device or a pipe. */
static bool is_special(const scree_path_info *info) {
  return info->kind != SCREE_PATH_FILE && info->kind != SCREE_PATH_FOLDER;
}

scree_status scree_output_open(const char *path, bool overwrite, scree_output *output,
                               scree_error *error) {
  if (!strcmp(path, "-")) {
    *output = (scree_output){.stream = stdout};
    return SCREE_OK;
  }
  scree_path_info info;
  bool exists = scree_path_look(path, &info), direct = exists && is_special(&info);
  if (!exists && errno == ENAMETOOLONG) /* the temporary file's may be shorter */
    return scree_fail(error, SCREE_IO, "%s: cannot create: %s", path, strerror(errno));
  if (!exists && !overwrite && scree_path_look_at_link(path, &info)) /* a link that leads nowhere */
    return scree_fail(error, SCREE_EXISTS, "%s: exists already; not overwritten", path);
  if (exists && info.kind == SCREE_PATH_FOLDER)
    return scree_fail(error, SCREE_IO, "%s: is a folder, not a file", path);
  if (exists && !overwrite && !direct)
    return scree_fail(error, SCREE_EXISTS, "%s: exists already; not overwritten", path);
  if (exists && !direct && is_protected(path, &info))
    return scree_fail(error, SCREE_IO, "%s: is write-protected; not replaced", path);
  size_t size = temporary_bytes(path);
  scree_output opened = {NULL, scree_strdup(path), direct ? NULL : scree_alloc(size, 1), overwrite};
  int fd = -1;
  scree_status status = SCREE_OK;
  if (!opened.path || (!direct && !opened.temporary_path))
    status = scree_fail_memory(error, size, "a file name");
  else
    fd = direct ? scree_open_write(path) : create_temporary(path, opened.temporary_path, size);
  opened.stream = fd >= 0 ? fdopen(fd, "wb") : NULL;
  if (status == SCREE_OK && !opened.stream)
    status = scree_fail(error, SCREE_IO, "%s: cannot create: %s", path, strerror(errno));
  if (status == SCREE_OK) {
    *output = opened;
    return SCREE_OK;
  }
  if (fd >= 0) {
    scree_close(fd);
    if (!direct && *opened.temporary_path) scree_path_remove(opened.temporary_path);
  }
  scree_free(opened.path);
  scree_free(opened.temporary_path);
  return status;
}

scree_status scree_output_check(const char *path, bool overwrite, scree_error *error) {
  scree_path_info info;
  scree_output output;
  if (!strcmp(path, "-")) return SCREE_OK;
  /* to open a pipe is to wait for its reader, and to close it tells the reader that it was all */
  if (scree_path_look(path, &info) && is_special(&info)) {
    if (scree_path_may_write(path)) return SCREE_OK;
    return scree_fail(error, SCREE_IO, "%s: cannot create: %s", path, strerror(errno));
  }
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status == SCREE_OK) scree_output_discard(&output);
  return status;
}

/* The reason for an errno; for 0, where an earlier write that failed left only the stream's mark,
 * what is likely.
 */
static const char *reason_to_tell(int reason) {
  return reason ? strerror(reason) : "the disk is full, or a limit is reached";
}

/* The whole file takes its name. */
static bool take_place(scree_output *output) {
  const char *from = output->temporary_path, *to = output->path;
  if (!(output->overwrite ? scree_path_rename(from, to) : scree_path_rename_new(from, to)))
    return false;
  *output->temporary_path = 0; /* anybody's again */
  return true;
}

scree_status scree_output_commit(scree_output *output, scree_error *error) {
  if (!output->path) {
    errno = 0;
    if (fflush(output->stream) == 0 && !ferror(output->stream)) return SCREE_OK;
    return scree_fail(error, SCREE_IO, "standard output: cannot write: %s", reason_to_tell(errno));
  }
  errno = 0;
  bool direct = !output->temporary_path;
  bool written = fflush(output->stream) == 0 && !ferror(output->stream) &&
                 (direct || scree_sync(fileno(output->stream))) &&
                 (direct || *output->temporary_path || give_name(output));
  int reason = errno;
  if (fclose(output->stream) != 0 && written) {
    written = false;
    reason = errno;
  }
  output->stream = NULL;
  if (written && !direct && !take_place(output)) {
    written = false;
    reason = errno;
  }
  scree_status status = SCREE_OK;
  if (!written && reason == EEXIST)
    status = scree_fail(error, SCREE_EXISTS, "%s: exists already; not overwritten", output->path);
  else if (!written)
    status =
        scree_fail(error, SCREE_IO, "%s: cannot write: %s", output->path, reason_to_tell(reason));
  scree_output_discard(output);
  return status;
}

void scree_output_discard(scree_output *output) {
  if (output->path && output->stream) fclose(output->stream);
  if (output->temporary_path && *output->temporary_path) scree_path_remove(output->temporary_path);
  scree_free(output->path);
  scree_free(output->temporary_path);
  *output = (scree_output){0};
}

static bool folder_exists(const char *path) {
  scree_path_info info;
  return scree_path_look(path, &info) && info.kind == SCREE_PATH_FOLDER;
}

scree_status scree_folder_create(const char *path, scree_error *error) {
  if (!*path) return scree_fail(error, SCREE_BAD_ARGUMENT, "a folder's name is empty");
  char *partial = scree_strdup(path);
  if (!partial) return scree_fail_memory(error, strlen(path), "a folder name");
  scree_status status = SCREE_OK;
  for (char *end = partial + 1; status == SCREE_OK; end++) {
    if (*end != '/' && *end != 0) continue;
    char kept = *end;
    *end = 0;
    int reason = scree_folder_make(partial) ? 0 : errno;
    if (reason && !folder_exists(partial))
      status = scree_fail(error, SCREE_IO, "%s: cannot create the folder: %s", partial,
                          reason == EEXIST ? "a file has that name" : strerror(reason));
    *end = kept;
    if (!kept) break;
  }
  scree_free(partial);
  return status;
}

scree_checksum scree_checksum_of(const void *bytes, size_t byte_count) {
  XXH128_hash_t hash = XXH3_128bits(bytes, byte_count);
  return (scree_checksum){hash.high64, hash.low64};
}

const char *scree_checksum_text(scree_checksum checksum, char text[SCREE_CHECKSUM_TEXT]) {
  snprintf(text, SCREE_CHECKSUM_TEXT, "%016" PRIx64 "%016" PRIx64, checksum.high, checksum.low);
  return checksum.high || checksum.low ? text : NULL;
}

scree_status scree_text_write(const char *text, const char *path, bool overwrite,
                              scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  fputs(text, output.stream);
  return scree_output_commit(&output, error);
}
