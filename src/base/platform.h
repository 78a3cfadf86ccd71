/* What differs between systems, and nothing else. platform_posix.c has it for Linux and macOS, with
 * platform_wasm.c in its system part for a browser, platform_windows.c for Windows. Functions that
 * can fail set errno, so that strerror tells why. Paths are UTF-8. POSIX threads are taken for
 * granted: all three have them. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Marks a function whose arguments from `first` on follow the format at `format`, as printf's do.
 */
#ifdef _WIN32
#define SCREE_PRINTF(format_place, first) __attribute__((format(gnu_printf, format_place, first)))
#else
#define SCREE_PRINTF(format_place, first) __attribute__((format(printf, format_place, first)))
#endif

/* ---- machine ---- */

/* Processors that this process may use, at least 1. */
int scree_processor_count(void);
/* Bytes of memory; 0 where the system does not tell. */
size_t scree_machine_memory(void);

enum { SCREE_SYSTEM_TEXT = 200 };
/* System, release and kind of machine; the processor's name; the machine's own. */
void scree_system_name(char text[SCREE_SYSTEM_TEXT]);
void scree_processor_name(char text[SCREE_SYSTEM_TEXT]);
void scree_host_name(char text[SCREE_SYSTEM_TEXT]);

/* Advice about pages of memory, which may be refused: large pages, to be touched now, and no longer
 * needed (their content is lost). */
void scree_pages_large(void *block, size_t size);
void scree_pages_touch(void *block, size_t size);
void scree_pages_drop(void *block, size_t size);
/* The C library gives freed blocks above 1 MB back to the system at once. */
void scree_pages_give_back(void);

/* ---- time ---- */

/* Seconds on a clock that only goes forward: for timers and reports, never for results. */
double scree_now(void);
/* Seconds of processor time of this process. */
double scree_processor_time(void);
/* Seconds since 1970. */
double scree_calendar_time(void);
#define SCREE_TIME_END 253402300800.0 /* the end of the year 9999, of four digits */
/* As 2020-06-01T12:00:00Z; empty where it is not known: NaN, 0 or beyond the year 9999. */
void scree_format_time(double calendar, char text[32]);
void scree_sleep(double seconds);

/* ---- files by path ---- */

typedef enum scree_path_kind {
  SCREE_PATH_FILE,
  SCREE_PATH_FOLDER,
  SCREE_PATH_DEVICE, /* a terminal, /dev/null */
  SCREE_PATH_OTHER,  /* a pipe, a socket */
} scree_path_kind;

typedef struct scree_path_info {
  scree_path_kind kind;
  bool locked; /* nobody may write to it, not even its owner */
  uint64_t byte_count;
  uint64_t device, number; /* both the same: one file under two names */
  double modified;         /* s since 1970, by the folder's own clock */
} scree_path_info;

/* What lies behind a path, links followed; false where nothing does. `info` may be NULL. */
bool scree_path_look(const char *path, scree_path_info *info);
/* A link itself. */
bool scree_path_look_at_link(const char *path, scree_path_info *info);
bool scree_descriptor_look(int descriptor, scree_path_info *info);
bool scree_path_exists(const char *path);
bool scree_path_may_write(const char *path);
/* The path from the root, without links; false where there is none, or no room. */
bool scree_path_full(const char *path, char *full, size_t size);

/* A descriptor of bytes, closed in child processes; -1. */
int scree_open_read(const char *path);
/* A regular file below a folder ("": the current one), by a path of names with '/' between them, of
 * which none may be a link, "..", or a place of the system's own. */
int scree_open_beneath(const char *folder, const char *path);
/* Opens what is there already. */
int scree_open_write(const char *path);
/* Fails with EEXIST where something has that name. */
int scree_open_new(const char *path);
/* A file, made where it is missing, that nobody else may open so until it is closed or its process
 * ends: EWOULDBLOCK. */
int scree_lock_open(const char *path);
/* As fopen. */
FILE *scree_open_stream(const char *path, const char *mode);
/* As read, write, close. */
ptrdiff_t scree_read(int descriptor, void *bytes, size_t count);
ptrdiff_t scree_write(int descriptor, const void *bytes, size_t count);
void scree_close(int descriptor);
/* From a place in the file, also by several threads at once. */
ptrdiff_t scree_read_at(int descriptor, void *bytes, size_t count, uint64_t place);
/* Waits until what was written is on disk. */
bool scree_sync(int descriptor);
/* Cuts the file off there and goes on from there. */
bool scree_cut(FILE *stream, uint64_t length);

bool scree_path_remove(const char *path);
/* A file of the new name is replaced. */
bool scree_path_rename(const char *from, const char *to);
/* Fails with EEXIST where something has that name already, as far as the file system can tell. */
bool scree_path_rename_new(const char *from, const char *to);
/* A second name of one file; fails with EEXIST where something has it, which makes it a lock. */
bool scree_path_link(const char *from, const char *to);

/* A file without a name in a folder, gone with the process however that ends; -1 where the file
 * system has none. */
int scree_nameless_open(const char *folder);
/* Gives it a name that nobody has. */
bool scree_nameless_link(int descriptor, const char *path);
/* Another descriptor, which reads it from its beginning. */
int scree_nameless_read(int descriptor);

/* ---- folders ---- */

bool scree_folder_make(const char *path);
/* Only an empty one. */
bool scree_folder_remove(const char *path);

typedef struct scree_folder scree_folder;
/* NULL where it cannot be read. */
scree_folder *scree_folder_open(const char *path);
/* The next name, "." and ".." left out, in any order; NULL at the end. It lasts until the next
 * call. */
const char *scree_folder_next(scree_folder *folder);
void scree_folder_close(scree_folder *folder);

/* ---- streams ---- */

/* A stream that becomes a text in memory, to be freed with free; it is there when the stream was
 * closed with scree_memory_close. NULL: out of memory. */
FILE *scree_memory_open(char **text, size_t *size);
bool scree_memory_close(FILE *stream);
/* Takes what is written to it and keeps nothing. */
FILE *scree_null_open(void);

/* ---- threads and processes ---- */

/* Starts a thread that gets no signals and that nobody waits for. */
bool scree_thread_start(void *(*work)(void *argument), void *argument);
/* Called in the child after each fork, where this system forks. */
void scree_at_fork(void (*child)(void));

long scree_process_number(void);
/* When a process of this machine started, in units of the system; 0 where there is none. */
unsigned long long scree_process_start(long process);
/* Names the machine since its last start, as process numbers count: two processes that see the same
 * may ask after each other. */
void scree_machine_identity(char text[SCREE_SYSTEM_TEXT]);
/* 64 bits that nobody else has. */
uint64_t scree_random_number(void);

/* Starts a program with its words, the first its name (NULL: this program again, under the name
 * "scree"), the last NULL. What it prints goes to the file `output`, made new, what it prints of
 * errors to `errors`, and it leads a group of all that it starts; NULL, both: where ours goes. 0,
 * or errno's number. */
int scree_process_run(const char *const *words, const char *output, const char *errors,
                      long *process);
typedef enum scree_process_state {
  SCREE_PROCESS_RUNS,
  SCREE_PROCESS_ENDED,  /* by itself: *code is its exit code */
  SCREE_PROCESS_KILLED, /* *code is the signal's number */
} scree_process_state;
/* Once a process has ended, it is forgotten. */
scree_process_state scree_process_look(long process, bool wait, int *code);
/* Asks it to end, and all of its group; ends all of its group, where it leads one. */
void scree_process_stop(long process);
void scree_process_kill(long process);
/* This program's own file; false where it is not known. */
bool scree_program_path(char *path, size_t size);

/* ---- the program's surroundings ---- */

/* To be called first: standard streams that came closed lead nowhere, data go through them as they
 * are, a limit on the size of files fails as a full disk does, and the words are UTF-8. */
void scree_program_begin(int *count, char ***words);

bool scree_is_terminal(FILE *stream);
/* Columns of the terminal behind stderr; 0: none, or not known. */
int scree_terminal_columns(void);

/* What ends a program from outside: Ctrl-C, the request to terminate, a terminal that goes away
 * (unless that is ignored already). The handler is called at the first; the second ends the
 * program. With `restart` what is being read or written goes on. */
void scree_signals_catch(void (*handler)(int number), bool restart);
/* Between these two none comes. */
void scree_signals_hold(void);
void scree_signals_go_on(void);
/* As before scree_signals_catch, where the handler is still that one. */
void scree_signals_release(void (*handler)(int number));
/* Ends the program as the signal would have. */
void scree_signal_end(int number);
