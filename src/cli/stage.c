#include "cli/stage.h"
#include "base/file.h"
#include "base/platform.h"
#include "cli/output.h"

#include <errno.h>
#include <string.h>

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
static void remove_tree(const char *path, int depth) {
  scree_folder *entries = depth > 0 ? scree_folder_open(path) : NULL;
  for (const char *name; entries && (name = scree_folder_next(entries));) {
    char inner[2 * CLI_STAGE_BYTES];
    int used = snprintf(inner, sizeof inner, "%s/%s", path, name);
    if (used < (int)sizeof inner && !scree_path_remove(inner)) remove_tree(inner, depth - 1);
  }
  if (entries) scree_folder_close(entries);
  (void)scree_folder_remove(path);
}

void cli_stage_discard(cli_stage *stage) {
  enum { DEPTH = 3 };
  if (stage->path[0]) remove_tree(stage->path, DEPTH);
  stage->path[0] = 0;
}

void cli_stage_hide(const cli_stage *stage, scree_error *error) {
  size_t length = strlen(stage->path);
  char *at = length ? strstr(error->message, stage->path) : NULL, rest[sizeof error->message];
  if (!at) return;
  snprintf(rest, sizeof rest, "%s", at + length);
  snprintf(at, sizeof error->message - (size_t)(at - error->message), "%s%s", stage->folder, rest);
}
