#include "cli/output.h"
#include "base/file.h"
#include "base/owned.h"
#include "base/path.h"
#include "base/platform.h"
#include "cli/args.h"
#include "cli/input.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* What lies behind a word of the call: of "phone.stl=30" that is no file, phone.stl. */
static bool stat_input(const char *word, scree_path_info *info) {
  char name[4096];
  if (!strcmp(word, "-")) return scree_descriptor_look(fileno(stdin), info);
  if (cli_is_sample(word, NULL)) return false;
  if (scree_path_look(word, info)) return true;
  const char *equals = strrchr(word, '=');
  if (!equals || (size_t)(equals - word) >= sizeof name) return false;
  snprintf(name, sizeof name, "%.*s", (int)(equals - word), word);
  return scree_path_look(name, info);
}

static bool is_file(const char *word, const scree_path_info *file) {
  scree_path_info info;
  return stat_input(word, &info) && info.device == file->device && info.number == file->number;
}

/* The word of the call that names this file as one to read; NULL where none does. */
static const char *find_reader(const cli_call *call, const scree_path_info *file) {
  for (size_t i = 0; i < call->input_count; i++)
    if (is_file(call->inputs[i], file)) return call->inputs[i];
  for (size_t i = 0; i < call->verb->option_count; i++) {
    const cli_option *option = &call->verb->options[i];
    const char *word;
    if (option->kind != CLI_FILE) continue;
    memcpy(&word, (const char *)call->options + option->offset, sizeof word);
    if (word && is_file(word, file)) return word;
  }
  return NULL;
}

scree_status cli_check_output(const cli_call *call, const char *path, bool overwrite,
                              scree_error *error) {
  scree_path_info info;
  bool is_stream = !strcmp(path, "-");
  const char *word = NULL;
  if (!is_stream && scree_path_look(path, &info) && info.kind == SCREE_PATH_FILE)
    word = find_reader(call, &info);
  if (!word) return scree_output_check(path, overwrite, error);
  char reason[300];
  snprintf(reason, sizeof reason, "is the input %.200s; what is read is never written over",
           strcmp(word, "-") != 0 ? word : "on stdin");
  return cli_refuse(error, SCREE_BAD_ARGUMENT, path, reason);
}

bool cli_has_ending(const char *path, const char *ending) {
  const char *dot = strrchr(path, '.');
  return dot && !strcasecmp(dot, ending);
}

scree_status cli_check_ending(const cli_verb *verb, const char *path, cli_content content) {
  static const struct {
    const char *what, *named;
    const char *endings[5];
  } contents[] = {
      [CLI_MESH] = {"mesh", ".stl, .ply, .obj, .off or .3mf", {NULL}},
      [CLI_FIGURE] = {"figure",
                      ".png, .svg, .pdf, .csv or .gnuplot",
                      {".png", ".svg", ".pdf", ".csv", ".gnuplot"}},
      [CLI_PICTURE] = {"picture", ".png", {".png"}},
      [CLI_VTP] = {"ParaView file", ".vtp", {".vtp"}},
      [CLI_PAGE] = {"page", ".html", {".html", ".htm"}},
  };
  bool stream = !strcmp(path, "-") && content != CLI_MESH && content != CLI_FIGURE;
  bool good = stream || (content == CLI_MESH && scree_file_format_of(path) != SCREE_FORMAT_AUTO);
  for (int i = 0; i < 5 && contents[content].endings[i]; i++)
    good = good || cli_has_ending(path, contents[content].endings[i]);
  return good ? SCREE_OK
              : cli_misuse(verb, "%s: the name of a %s must end in %s", path,
                           contents[content].what, contents[content].named);
}

/* ---- what is printed ---- */

static int
    printing_failure; /* errno of the first flush that failed: the stream keeps a mark only */

void cli_flush(void) {
  if (fflush(stdout) != 0 && !printing_failure) printing_failure = errno;
}

bool cli_finish_printing(void) {
  cli_flush();
  if (!printing_failure && !ferror(stdout)) return true;
  fprintf(stderr, "scree: cannot write to standard output: %s\n",
          printing_failure ? strerror(printing_failure)
                           : "the disk is full, or a limit is reached");
  return false;
}

/* ---- what a run leaves in its folder ---- */

/* Whether the file is called so; of a # in the name, any digits, of a *, anything. */
static bool is_called(const char *file, const char *name) {
  for (; *name; name++) {
    size_t left = strlen(name + 1), there = strlen(file);
    if (*name == '*') return there >= left && !strcmp(file + there - left, name + 1);
    size_t digits = *name == '#' ? strspn(file, "0123456789") : 0;
    if (*name == '#' ? digits == 0 : *file != *name) return false;
    file += digits ? digits : 1;
  }
  return *file == 0;
}

typedef scree_status run_file_visit(const cli_call *call, const char *path, scree_error *error);

/* Visits the files that a name with a # or a * stands for, or the one of another name, there or
 * not. */
static scree_status visit_files(const cli_call *call, const char *folder, const char *name,
                                run_file_visit *visit, scree_error *error) {
  if (!strpbrk(name, "#*")) return visit(call, SCREE_PATH_IN(folder, name), error);
  SCREE_CLEANUP(scree_folder_close_at) scree_folder *entries = scree_folder_open(folder);
  if (!entries) return cli_refuse(error, SCREE_IO, folder, strerror(errno));
  for (const char *found; (found = scree_folder_next(entries));)
    if (is_called(found, name)) SCREE_TRY(visit(call, SCREE_PATH_IN(folder, found), error));
  return SCREE_OK;
}

static scree_status check_new(const cli_call *call, const char *path, scree_error *error) {
  return cli_check_output(call, path, false, error);
}

static scree_status check_replaced(const cli_call *call, const char *path, scree_error *error) {
  return cli_check_output(call, path, true, error);
}

scree_status cli_check_run_output(const cli_call *call, const char *folder,
                                  const cli_run_files *files, bool overwrite, scree_error *error) {
  for (size_t i = 0; i < files->count; i++) {
    scree_status status =
        visit_files(call, folder, files->names[i], overwrite ? check_replaced : check_new, error);
    if (status == SCREE_EXISTS && i == 0)
      return cli_refuse(error, SCREE_BAD_ARGUMENT, SCREE_PATH_IN(folder, files->names[i]),
                        "exists already: --resume goes on, -f begins anew");
    if (status != SCREE_OK) return status;
  }
  return SCREE_OK;
}

static scree_status remove_file(const cli_call *call, const char *path, scree_error *error) {
  scree_path_info info;
  if (!scree_path_look_at_link(path, &info) || info.kind == SCREE_PATH_FOLDER ||
      find_reader(call, &info))
    return SCREE_OK;
  return scree_path_remove(path) ? SCREE_OK : cli_refuse(error, SCREE_IO, path, strerror(errno));
}

scree_status cli_clear_run_output(const cli_call *call, const char *folder,
                                  const cli_run_files *files, scree_error *error) {
  for (size_t i = 0; i < files->count; i++)
    SCREE_TRY(visit_files(call, folder, files->names[i], remove_file, error));
  return SCREE_OK;
}

/* ---- folders and names ---- */

/* The folders made by this call, outer ones first. */
static char **made_folders;
static size_t made_count;

static bool remember_folder(char *path) {
  char **grown = realloc(made_folders, (made_count + 1) * sizeof *grown);
  if (!grown) return false;
  made_folders = grown;
  made_folders[made_count++] = path;
  return true;
}

scree_status cli_make_folder(const char *path, scree_error *error) {
  for (size_t end = 1; *path && end <= strlen(path); end++) {
    if (path[end] && path[end] != '/') continue;
    char *part = strdup(path);
    if (part) part[end] = 0;
    if (part && scree_path_exists(part)) {
      free(part);
    } else if (!part || !remember_folder(part)) {
      free(part);
      return cli_refuse(error, SCREE_OUT_OF_MEMORY, path, "out of memory");
    }
  }
  return scree_folder_create(path, error);
}

void cli_remove_empty_folders(void) {
  for (size_t i = made_count; i-- > 0;) (void)scree_folder_remove(made_folders[i]);
}

scree_status cli_beside(const char *path, const char *ending, char *buffer, size_t size,
                        scree_error *error) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  int stem = (int)(dot ? (size_t)(dot - path) : strlen(path));
  if (snprintf(buffer, size, "%.*s%s", stem, path, ending) < (int)size) return SCREE_OK;
  return scree_fail(error, SCREE_LIMIT, "the output's name is too long");
}

scree_status cli_join_path(const char *folder, const char *before, const char *name,
                           const char *after, char *buffer, size_t size, scree_error *error) {
  int length = snprintf(buffer, size, "%s/%s%s%s", folder, before, name, after);
  if (length >= 0 && (size_t)length < size) return SCREE_OK;
  return cli_refuse(error, SCREE_LIMIT, folder, "the path is too long");
}

scree_write_options cli_write_options(const cli_call *call, const char *path, double unit,
                                      bool overwrite) {
  scree_write_options write = scree_default_write_options();
  write.unit_m = unit;
  write.overwrite = overwrite;
  write.comment = call->command_line;
  if (!strcmp(path, "-")) write.format = SCREE_FORMAT_STL;
  return write;
}

/* A file in the folder, locked by the system: it knows when a process has gone, and a file that a
 * killed one left behind stops nobody. Whoever gets the lock of a file that was removed meanwhile
 * tries again with the new one. */

static const char lock_name[] = ".scree-lock";
static char lock_path[SCREE_PATH_BYTES];
static int lock = -1;

/* Who has it, as its file says. */
static scree_status tell_holder(const char *folder, scree_error *error) {
  char text[64] = "", reason[200];
  scree_path_info info = {.modified = scree_calendar_time()};
  int fd = scree_open_read(lock_path);
  if (fd >= 0) {
    scree_descriptor_look(fd, &info);
    if (scree_read(fd, text, sizeof text - 1) < 0) text[0] = 0;
    scree_close(fd);
  }
  double age = scree_calendar_time() - info.modified;
  snprintf(reason, sizeof reason,
           "process %ld writes into it, since %.0f %s ago: wait for it, stop it, or name another "
           "folder",
           strtol(text, NULL, 10), age < 120 ? age : age / 60, age < 120 ? "s" : "minutes");
  return cli_refuse(error, SCREE_BAD_ARGUMENT, folder, reason);
}

static bool is_still_there(void) {
  scree_path_info own, named;
  return scree_descriptor_look(lock, &own) && scree_path_look(lock_path, &named) &&
         own.number == named.number && own.device == named.device;
}

scree_status cli_lock_folder(const char *folder, scree_error *error) {
  enum { TRIES = 100 };
  if (lock >= 0) return SCREE_OK;
  scree_path_put(lock_path, folder, lock_name);
  for (int i = 0; i < TRIES; i++) {
    lock = scree_lock_open(lock_path);
    if (lock < 0) return errno == EWOULDBLOCK ? tell_holder(folder, error) : SCREE_OK;
    if (is_still_there()) break;
    scree_close(lock);
    lock = -1;
  }
  char text[32]; /* as long for every process */
  int length = snprintf(text, sizeof text, "%20ld\n", scree_process_number());
  if (lock >= 0) (void)scree_write(lock, text, (size_t)length);
  return SCREE_OK;
}

void cli_unlock_folder(void) {
  if (lock < 0) return;
  scree_path_remove(lock_path); /* stays, and stops nobody, where a file that is open cannot be */
  scree_close(lock);
  lock = -1;
}

enum { TEMPORARY_NAMES = 1000 };

/* Up to the last slash, without those at the end. */
static int parent_length(const char *folder, int length) {
  while (length > 0 && folder[length - 1] != '/') length--;
  while (length > 1 && folder[length - 1] == '/') length--;
  return length;
}

static scree_status make_parent(const char *folder, int length, scree_error *error) {
  char parent[CLI_STAGE_BYTES];
  int above = parent_length(folder, length);
  snprintf(parent, sizeof parent, "%.*s", above, folder);
  return above ? cli_make_folder(parent, error) : SCREE_OK;
}

/* Under a name that nobody else has: a killed call may have left its folder. */
static scree_status make_beside(const char *stem, int length, cli_stage *stage,
                                scree_error *error) {
  for (int attempt = 0; attempt < TEMPORARY_NAMES; attempt++) {
    int used = snprintf(stage->path, sizeof stage->path, "%.*s%s.%ld-%d.part", length, stem,
                        stage->existed ? "/results" : "", scree_process_number(), attempt);
    if (used >= (int)sizeof stage->path) errno = ENAMETOOLONG;
    if (used < (int)sizeof stage->path && scree_folder_make(stage->path)) return SCREE_OK;
    if (errno != EEXIST) break;
  }
  char reason[256];
  snprintf(reason, sizeof reason, "cannot create the folder: %s", strerror(errno));
  stage->path[0] = 0;
  return cli_refuse(error, SCREE_IO, stage->folder, reason);
}

scree_status cli_stage_open(const char *folder, cli_stage *stage, scree_error *error) {
  int length = (int)strnlen(folder, CLI_STAGE_BYTES);
  *stage = (cli_stage){.folder = folder, .existed = scree_path_look_at_link(folder, NULL)};
  if (length >= CLI_STAGE_BYTES)
    return cli_refuse(error, SCREE_LIMIT, folder, "the path is too long");
  while (length > 1 && folder[length - 1] == '/') length--;
  SCREE_TRY(stage->existed || length == 0 ? scree_folder_create(folder, error)
                                          : make_parent(folder, length, error));
  return make_beside(folder, length, stage, error);
}

scree_status cli_stage_rename(cli_stage *stage, scree_error *error) {
  char target[CLI_STAGE_BYTES];
  size_t length = strlen(stage->folder);
  while (length > 1 && stage->folder[length - 1] == '/') length--;
  snprintf(target, sizeof target, "%.*s", (int)length, stage->folder);
  if (scree_path_rename(stage->path, target)) {
    stage->path[0] = 0;
    return SCREE_OK;
  }
  return cli_refuse(
      error, errno == ENOTEMPTY || errno == EEXIST ? SCREE_EXISTS : SCREE_IO, stage->folder,
      errno == ENOTEMPTY || errno == EEXIST ? "was made by somebody else meanwhile; not overwritten"
                                            : strerror(errno));
}

/* Folders in folders, as deep as they are made here. */
static void remove_to(const char *path, int depth) {
  scree_folder *entries = depth > 0 ? scree_folder_open(path) : NULL;
  for (const char *name; entries && (name = scree_folder_next(entries));) {
    char inner[2 * CLI_STAGE_BYTES];
    int used = snprintf(inner, sizeof inner, "%s/%s", path, name);
    if (used < (int)sizeof inner && !scree_path_remove(inner)) remove_to(inner, depth - 1);
  }
  if (entries) scree_folder_close(entries);
  (void)scree_folder_remove(path);
}

void cli_remove_tree(const char *path) {
  enum { DEPTH = 3 };
  if (!scree_path_remove(path)) remove_to(path, DEPTH);
}

void cli_stage_discard(cli_stage *stage) {
  if (stage->path[0]) cli_remove_tree(stage->path);
  stage->path[0] = 0;
}

void cli_stage_hide(const cli_stage *stage, scree_error *error) {
  size_t length = strlen(stage->path);
  char *at = length ? strstr(error->message, stage->path) : NULL, rest[sizeof error->message];
  if (!at) return;
  snprintf(rest, sizeof rest, "%s", at + length);
  snprintf(at, sizeof error->message - (size_t)(at - error->message), "%s%s", stage->folder, rest);
}
