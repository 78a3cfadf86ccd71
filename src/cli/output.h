/* What a verb may write to. */
#pragma once

#include "base/error.h"
#include "cli/args.h"

/* scree_output_check for a verb's output, before any work; and an input is never an output, not
 * even where existing files may be overwritten: SCREE_BAD_ARGUMENT for a path that is a file the
 * call reads (an input, or the value of a CLI_FILE option), by whatever name. */
scree_status cli_check_output(const cli_call *call, const char *path, bool overwrite,
                              scree_error *error);

/* Whether the name ends so, ".vtp" for example, in upper or lower case. */
bool cli_has_ending(const char *path, const char *ending);

/* What is written, which its name must say by its ending. */
typedef enum cli_content { CLI_MESH, CLI_FIGURE, CLI_PICTURE, CLI_VTP, CLI_PAGE } cli_content;
/* CLI_MISUSED after telling that the name has none of the endings. A stream, which has no name, is
 * right for all but a mesh and a figure: these have several formats. */
scree_status cli_check_ending(const cli_verb *verb, const char *path, cli_content content);

/* The files that a run leaves in its folder, by their names; a # in a name stands for the number of
 * a frame. The first stands for them all. */
typedef struct cli_run_files {
  const char *const *names;
  size_t count;
} cli_run_files;

/* cli_check_output of all of them. Where the first exists, the error says that --resume goes on and
 * -f begins anew. */
scree_status cli_check_run_output(const cli_call *call, const char *folder,
                                  const cli_run_files *files, bool overwrite, scree_error *error);
/* Removes those that are there, but for what the call reads. */
scree_status cli_clear_run_output(const cli_call *call, const char *folder,
                                  const cli_run_files *files, scree_error *error);

/* Writes out what was printed so far. */
void cli_flush(void);
/* Likewise, at the end of the call; false after telling stderr why not all of it could be written.
 */
bool cli_finish_printing(void);

/* scree_folder_create for a verb's output; the folders made are remembered. */
scree_status cli_make_folder(const char *path, scree_error *error);
/* Takes away those that are still empty, the last made first: a call that fails before it has
 * written anything leaves nothing. */
void cli_remove_empty_folders(void);

/* FOLDER/before name after. SCREE_LIMIT where it does not fit. */
scree_status cli_join_path(const char *folder, const char *before, const char *name,
                           const char *after, char *buffer, size_t size, scree_error *error);

/* How a mesh is written by this call, in a unit (m); "-" is an STL. */
scree_write_options cli_write_options(const cli_call *call, const char *path, double unit,
                                      bool overwrite);

/* The path with another ending, as "p.json" of "p.stl": a file beside it. SCREE_LIMIT where it does
 * not fit. */
scree_status cli_beside(const char *path, const char *ending, char *buffer, size_t size,
                        scree_error *error);

/* Locks a folder that is there until the call ends, however it does. SCREE_EXISTS with the process
 * that has it, and since when; a file system without locks has none. */
scree_status cli_lock_folder(const char *folder, scree_error *error);
/* Ends it, and removes its file. */
void cli_unlock_folder(void);

/* A folder that is there whole or not at all: its files are written into another one and moved when
 * all is written. */
enum { CLI_STAGE_BYTES = 4096 };

typedef struct cli_stage {
  const char *folder;         /* as asked for; borrowed */
  bool existed;               /* then the other folder lies in it, else beside it */
  char path[CLI_STAGE_BYTES]; /* of the other one: NAME.PROCESS-N.part; "" where there is none */
} cli_stage;

/* Makes the folder to write into, and what is missing above it. */
scree_status cli_stage_open(const char *folder, cli_stage *stage, scree_error *error);
/* Renames it to what was asked for; only where that was not there before. */
scree_status cli_stage_rename(cli_stage *stage, scree_error *error);
/* Removes it with all that it holds; nothing where it was renamed. */
void cli_stage_discard(cli_stage *stage);
/* Has an error name the folder that was asked for. */
void cli_stage_hide(const cli_stage *stage, scree_error *error);
/* Removes a file, or a folder with what this program puts into one. */
void cli_remove_tree(const char *path);
