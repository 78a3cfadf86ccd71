/* Windows, as mingw-w64 has it. Paths are UTF-8 here and wide in the system's calls. Not tried: a
 * study whose folder is shared with machines of other systems. */
#define WIN32_LEAN_AND_MEAN
#include "base/platform.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <math.h>
#include <process.h>
#include <pthread.h>
#include <share.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <wchar.h>
#include <windows.h>

#include <shellapi.h>

enum { MOST_PATH = 32768 / 8 };

/* ---- paths ---- */

typedef struct wide_path {
  wchar_t text[MOST_PATH];
} wide_path;

/* Paths of more than 260 characters want a prefix, and then no slashes. */
static bool widen(const char *path, wide_path *wide) {
  wchar_t plain[MOST_PATH];
  int length = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, plain, MOST_PATH);
  if (length <= 0) {
    errno = EILSEQ;
    return false;
  }
  if (length < MAX_PATH - 12) {
    wcscpy(wide->text, plain);
    return true;
  }
  DWORD full = GetFullPathNameW(plain, MOST_PATH - 4, wide->text + 4, NULL);
  if (full == 0 || full >= MOST_PATH - 4 || !wcsncmp(wide->text + 4, L"\\\\", 2)) {
    wcscpy(wide->text, plain);
    return true;
  }
  memcpy(wide->text, L"\\\\?\\", 4 * sizeof *wide->text);
  return true;
}

static bool narrow(const wchar_t *wide, char *path, size_t size) {
  return WideCharToMultiByte(CP_UTF8, 0, wide, -1, path, (int)size, NULL, NULL) > 0;
}

static int errno_of(DWORD code) {
  switch (code) {
  case ERROR_FILE_NOT_FOUND:
  case ERROR_PATH_NOT_FOUND:
  case ERROR_INVALID_NAME:
  case ERROR_BAD_NETPATH:
    return ENOENT;
  case ERROR_ALREADY_EXISTS:
  case ERROR_FILE_EXISTS:
    return EEXIST;
  case ERROR_ACCESS_DENIED:
  case ERROR_SHARING_VIOLATION:
  case ERROR_LOCK_VIOLATION:
  case ERROR_WRITE_PROTECT:
    return EACCES;
  case ERROR_DISK_FULL:
  case ERROR_HANDLE_DISK_FULL:
    return ENOSPC;
  case ERROR_DIR_NOT_EMPTY:
    return ENOTEMPTY;
  case ERROR_FILENAME_EXCED_RANGE:
    return ENAMETOOLONG;
  case ERROR_NOT_ENOUGH_MEMORY:
    return ENOMEM;
  default:
    return EIO;
  }
}

/* Sets errno where the call failed. */
static bool done(BOOL result) {
  if (!result) errno = errno_of(GetLastError());
  return result;
}

/* ---- machine ---- */

int scree_processor_count(void) {
  DWORD_PTR process, all;
  int count = 0;
  if (GetProcessAffinityMask(GetCurrentProcess(), &process, &all))
    for (; process; process &= process - 1) count++;
  return count > 0 ? count : 1;
}

size_t scree_machine_memory(void) {
  MEMORYSTATUSEX state = {.dwLength = sizeof state};
  return GlobalMemoryStatusEx(&state) ? (size_t)state.ullTotalPhys : 0;
}

void scree_system_name(char text[SCREE_SYSTEM_TEXT]) {
  snprintf(text, SCREE_SYSTEM_TEXT, "Windows, %s", sizeof(void *) == 8 ? "x86_64" : "x86");
}

void scree_processor_name(char text[SCREE_SYSTEM_TEXT]) {
  DWORD size = SCREE_SYSTEM_TEXT;
  if (RegGetValueA(HKEY_LOCAL_MACHINE, "HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0",
                   "ProcessorNameString", RRF_RT_REG_SZ, NULL, text, &size) != ERROR_SUCCESS)
    snprintf(text, SCREE_SYSTEM_TEXT, "unknown");
}

void scree_host_name(char text[SCREE_SYSTEM_TEXT]) {
  wchar_t name[MAX_COMPUTERNAME_LENGTH + 1];
  DWORD size = MAX_COMPUTERNAME_LENGTH + 1;
  if (!GetComputerNameW(name, &size) || !narrow(name, text, SCREE_SYSTEM_TEXT))
    snprintf(text, SCREE_SYSTEM_TEXT, "unknown");
}

/* ---- time ---- */

double scree_now(void) {
  LARGE_INTEGER count, rate;
  QueryPerformanceCounter(&count);
  QueryPerformanceFrequency(&rate);
  return (double)count.QuadPart / (double)rate.QuadPart;
}

/* In units of 100 ns. */
static double seconds_of(FILETIME t) {
  return 1e-7 * (double)((uint64_t)t.dwHighDateTime << 32 | t.dwLowDateTime);
}
static const double windows_1970 = 11644473600.0; /* s; files count from 1601 */

double scree_processor_time(void) {
  FILETIME begun, ended, kernel, user;
  if (!GetProcessTimes(GetCurrentProcess(), &begun, &ended, &kernel, &user)) return 0;
  return seconds_of(kernel) + seconds_of(user);
}

double scree_calendar_time(void) {
  FILETIME now;
  GetSystemTimeAsFileTime(&now);
  return seconds_of(now) - windows_1970;
}

void scree_format_time(double calendar, char text[32]) {
  *text = 0;
  if (!(calendar > 0 && calendar < SCREE_TIME_END)) return;
  time_t seconds = (time_t)calendar;
  const struct tm *parts = gmtime(&seconds);
  if (parts) strftime(text, 32, "%Y-%m-%dT%H:%M:%SZ", parts);
}

void scree_sleep(double seconds) {
  Sleep((DWORD)ceil(1e3 * seconds));
}

/* ---- files by path ---- */

static bool look_at_handle(HANDLE handle, scree_path_info *info) {
  BY_HANDLE_FILE_INFORMATION found;
  scree_path_info made = {.kind = SCREE_PATH_OTHER};
  DWORD type = GetFileType(handle);
  if (type == FILE_TYPE_CHAR) made.kind = SCREE_PATH_DEVICE;
  if (type == FILE_TYPE_DISK) {
    if (!done(GetFileInformationByHandle(handle, &found))) return false;
    made = (scree_path_info){.kind = found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY
                                         ? SCREE_PATH_FOLDER
                                         : SCREE_PATH_FILE,
                             .locked = found.dwFileAttributes & FILE_ATTRIBUTE_READONLY,
                             .byte_count = (uint64_t)found.nFileSizeHigh << 32 | found.nFileSizeLow,
                             .device = found.dwVolumeSerialNumber,
                             .number = (uint64_t)found.nFileIndexHigh << 32 | found.nFileIndexLow,
                             .modified = seconds_of(found.ftLastWriteTime) - windows_1970};
  }
  if (info) *info = made;
  return true;
}

static bool look(const char *path, DWORD flags, scree_path_info *info) {
  wide_path wide;
  if (!widen(path, &wide)) return false;
  HANDLE handle = CreateFileW(wide.text, FILE_READ_ATTRIBUTES,
                              FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                              OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS | flags, NULL);
  if (!done(handle != INVALID_HANDLE_VALUE)) return false;
  bool found = look_at_handle(handle, info);
  CloseHandle(handle);
  return found;
}

bool scree_path_look(const char *path, scree_path_info *info) {
  return look(path, 0, info);
}
bool scree_path_look_at_link(const char *path, scree_path_info *info) {
  return look(path, FILE_FLAG_OPEN_REPARSE_POINT, info);
}
bool scree_descriptor_look(int descriptor, scree_path_info *info) {
  return look_at_handle((HANDLE)_get_osfhandle(descriptor), info);
}
bool scree_path_exists(const char *path) {
  return scree_path_look(path, NULL);
}
bool scree_path_may_write(const char *path) {
  wide_path wide;
  return widen(path, &wide) && _waccess(wide.text, 2) == 0;
}

bool scree_path_full(const char *path, char *full, size_t size) {
  wide_path wide;
  wchar_t found[MOST_PATH];
  if (!scree_path_exists(path) || !widen(path, &wide)) return false;
  DWORD length = GetFullPathNameW(wide.text, MOST_PATH, found, NULL);
  return done(length > 0 && length < MOST_PATH) && narrow(found, full, size);
}

static int open_descriptor(const char *path, int flags) {
  wide_path wide;
  return widen(path, &wide) ? _wsopen(wide.text, flags | _O_BINARY | _O_NOINHERIT, _SH_DENYNO,
                                      _S_IREAD | _S_IWRITE)
                            : -1;
}
int scree_open_read(const char *path) {
  return open_descriptor(path, _O_RDONLY);
}
/* Names of devices (NUL, COM1) are found by what they open; a point where a folder leads elsewhere
 * is one of the links. */
int scree_open_beneath(const char *folder, const char *path) {
  char whole[MOST_PATH];
  scree_path_info info;
  wide_path wide;
  int start = snprintf(whole, sizeof whole, "%s%s", folder, *folder ? "/" : "");
  errno = EXDEV;
  if (strpbrk(path, "\\:") || start < 0 || (size_t)start + strlen(path) >= sizeof whole) return -1;
  for (const char *slash = path; slash; path = slash + 1) {
    slash = strchr(path, '/');
    int length = slash ? (int)(slash - path) : (int)strlen(path);
    start += snprintf(whole + start, sizeof whole - (size_t)start, "%.*s", length, path);
    errno = EXDEV;
    if (length == 2 && !strncmp(path, "..", 2)) return -1;
    if (!widen(whole, &wide)) return -1;
    DWORD marks = GetFileAttributesW(wide.text);
    if (!done(marks != INVALID_FILE_ATTRIBUTES)) return -1;
    errno = ELOOP;
    if (marks & FILE_ATTRIBUTE_REPARSE_POINT) return -1;
    whole[start++] = slash ? '/' : 0;
    whole[start] = 0;
  }
  errno = EINVAL;
  return scree_path_look(whole, &info) && info.kind == SCREE_PATH_FILE ? scree_open_read(whole)
                                                                       : -1;
}
int scree_open_write(const char *path) {
  return open_descriptor(path, _O_WRONLY);
}
int scree_open_new(const char *path) {
  return open_descriptor(path, _O_WRONLY | _O_CREAT | _O_EXCL);
}

/* A byte far behind what is in it is locked, so that others may read it. */
int scree_lock_open(const char *path) {
  int fd = open_descriptor(path, _O_RDWR | _O_CREAT);
  OVERLAPPED place = {.Offset = 1 << 20};
  if (fd < 0 || LockFileEx((HANDLE)_get_osfhandle(fd),
                           LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place))
    return fd;
  _close(fd);
  errno = EWOULDBLOCK;
  return -1;
}

FILE *scree_open_stream(const char *path, const char *mode) {
  wide_path wide;
  wchar_t words[16];
  bool binary = strchr(mode, 'b');
  if (!widen(path, &wide)) return NULL;
  swprintf(words, 16, L"%hs%ls", mode, binary ? L"" : L"b");
  return _wfopen(wide.text, words);
}

static unsigned at_most(size_t count) {
  enum { MOST = 1 << 30 };
  return count < MOST ? (unsigned)count : MOST;
}
ptrdiff_t scree_read(int descriptor, void *bytes, size_t count) {
  return _read(descriptor, bytes, at_most(count));
}
ptrdiff_t scree_write(int descriptor, const void *bytes, size_t count) {
  return _write(descriptor, bytes, at_most(count));
}
void scree_close(int descriptor) {
  _close(descriptor);
}

ptrdiff_t scree_read_at(int descriptor, void *bytes, size_t count, uint64_t place) {
  OVERLAPPED at = {.Offset = (DWORD)place, .OffsetHigh = (DWORD)(place >> 32)};
  DWORD got = 0;
  if (ReadFile((HANDLE)_get_osfhandle(descriptor), bytes, at_most(count), &got, &at)) return got;
  if (GetLastError() == ERROR_HANDLE_EOF) return 0;
  errno = errno_of(GetLastError());
  return -1;
}

bool scree_sync(int descriptor) {
  return _commit(descriptor) == 0;
}
bool scree_cut(FILE *stream, uint64_t length) {
  return _chsize_s(_fileno(stream), (int64_t)length) == 0 && fseek(stream, 0, SEEK_END) == 0;
}

bool scree_path_remove(const char *path) {
  wide_path wide;
  return widen(path, &wide) && done(DeleteFileW(wide.text));
}

static bool move(const char *from, const char *to, DWORD flags) {
  wide_path wide_from, wide_to;
  return widen(from, &wide_from) && widen(to, &wide_to) &&
         done(MoveFileExW(wide_from.text, wide_to.text, flags | MOVEFILE_WRITE_THROUGH));
}
bool scree_path_rename(const char *from, const char *to) {
  return move(from, to, MOVEFILE_REPLACE_EXISTING);
}
bool scree_path_rename_new(const char *from, const char *to) {
  return move(from, to, 0);
}
bool scree_path_link(const char *from, const char *to) {
  wide_path wide_from, wide_to;
  return widen(from, &wide_from) && widen(to, &wide_to) &&
         done(CreateHardLinkW(wide_to.text, wide_from.text, NULL));
}

/* ---- folders ---- */

bool scree_folder_make(const char *path) {
  wide_path wide;
  return widen(path, &wide) && done(CreateDirectoryW(wide.text, NULL));
}
bool scree_folder_remove(const char *path) {
  wide_path wide;
  return widen(path, &wide) && done(RemoveDirectoryW(wide.text));
}

struct scree_folder {
  HANDLE handle;
  WIN32_FIND_DATAW entry;
  bool first;
  char name[4 * MAX_PATH];
};

scree_folder *scree_folder_open(const char *path) {
  char pattern[MOST_PATH];
  wide_path wide;
  scree_folder *folder = malloc(sizeof *folder);
  if (!folder) return NULL;
  snprintf(pattern, sizeof pattern, "%s\\*", path);
  folder->first = true;
  folder->handle =
      widen(pattern, &wide) ? FindFirstFileW(wide.text, &folder->entry) : INVALID_HANDLE_VALUE;
  if (done(folder->handle != INVALID_HANDLE_VALUE)) return folder;
  free(folder);
  return NULL;
}

const char *scree_folder_next(scree_folder *folder) {
  while (folder->first || FindNextFileW(folder->handle, &folder->entry)) {
    folder->first = false;
    const wchar_t *name = folder->entry.cFileName;
    if (wcscmp(name, L".") != 0 && wcscmp(name, L"..") != 0 &&
        narrow(name, folder->name, sizeof folder->name))
      return folder->name;
  }
  return NULL;
}

void scree_folder_close(scree_folder *folder) {
  FindClose(folder->handle);
  free(folder);
}

/* ---- streams ---- */

/* Texts in memory are files that go when they are closed: nobody here has a stream of his own. */
typedef struct memory_stream {
  FILE *stream;
  char **text;
  size_t *size;
} memory_stream;
enum { MOST_MEMORY_STREAMS = 64 };
static memory_stream memory_streams[MOST_MEMORY_STREAMS];
static pthread_mutex_t memory_lock = PTHREAD_MUTEX_INITIALIZER;

static memory_stream *find_memory(const FILE *stream) {
  for (size_t i = 0; i < MOST_MEMORY_STREAMS; i++)
    if (memory_streams[i].stream == stream) return &memory_streams[i];
  return NULL;
}

static FILE *open_temporary(void) {
  wchar_t folder[MAX_PATH + 1], path[MAX_PATH + 1];
  if (!GetTempPathW(MAX_PATH + 1, folder) || !GetTempFileNameW(folder, L"scr", 0, path))
    return NULL;
  return _wfopen(path, L"w+bTD");
}

FILE *scree_memory_open(char **text, size_t *size) {
  FILE *stream = open_temporary();
  if (!stream) return NULL;
  pthread_mutex_lock(&memory_lock);
  memory_stream *place = find_memory(NULL);
  if (place) *place = (memory_stream){stream, text, size};
  pthread_mutex_unlock(&memory_lock);
  if (place) return stream;
  fclose(stream);
  errno = EMFILE;
  return NULL;
}

bool scree_memory_close(FILE *stream) {
  pthread_mutex_lock(&memory_lock);
  memory_stream *place = find_memory(stream), found = {NULL, NULL, NULL};
  if (place) {
    found = *place;
    *place = (memory_stream){NULL, NULL, NULL};
  }
  pthread_mutex_unlock(&memory_lock);
  bool written = fflush(stream) == 0 && !ferror(stream) && found.text;
  int64_t length = written ? _ftelli64(stream) : 0;
  char *text = length >= 0 ? malloc((size_t)length + 1) : NULL;
  rewind(stream);
  written = written && text && fread(text, 1, (size_t)length, stream) == (size_t)length;
  fclose(stream);
  if (!found.text) return false;
  if (!written) free(text);
  if (written) text[length] = 0;
  *found.text = written ? text : NULL;
  *found.size = written ? (size_t)length : 0;
  return written;
}

FILE *scree_null_open(void) {
  return fopen("NUL", "wb");
}

/* ---- threads and processes ---- */

bool scree_thread_start(void *(*work)(void *argument), void *argument) {
  pthread_t thread;
  return pthread_create(&thread, NULL, work, argument) == 0 && pthread_detach(thread) == 0;
}

void scree_at_fork(void (*child)(void)) {
  (void)child; /* nothing forks */
}

long scree_process_number(void) {
  return (long)GetCurrentProcessId();
}

unsigned long long scree_process_start(long process) {
  FILETIME begun, ended, kernel, user;
  DWORD code = 0;
  HANDLE handle = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, (DWORD)process);
  if (!handle) return 0;
  bool alive = GetExitCodeProcess(handle, &code) && code == STILL_ACTIVE &&
               GetProcessTimes(handle, &begun, &ended, &kernel, &user);
  CloseHandle(handle);
  return alive ? (unsigned long long)begun.dwHighDateTime << 32 | begun.dwLowDateTime : 0;
}

void scree_machine_identity(char text[SCREE_SYSTEM_TEXT]) {
  char host[SCREE_SYSTEM_TEXT];
  scree_host_name(host);
  snprintf(text, SCREE_SYSTEM_TEXT, "%.100s windows", host);
}

uint64_t scree_random_number(void) {
  unsigned high = 0, low = 0;
  rand_s(&high);
  rand_s(&low);
  return (uint64_t)high << 32 | low;
}

bool scree_program_path(char *path, size_t size) {
  wchar_t wide[MOST_PATH];
  DWORD length = GetModuleFileNameW(NULL, wide, MOST_PATH);
  return length > 0 && length < MOST_PATH && narrow(wide, path, size);
}

/* One word of a command line, quoted so that the program gets it back as it is. */
static size_t quote(const wchar_t *word, wchar_t *line, size_t used, size_t size) {
  if (used + 2 * wcslen(word) + 4 > size) return size;
  line[used++] = L'"';
  for (size_t slashes = 0;; word++) {
    if (*word == L'\\') {
      slashes++;
      continue;
    }
    size_t doubled = *word == 0 || *word == L'"' ? 2 * slashes + (*word == L'"') : slashes;
    while (doubled-- > 0) line[used++] = L'\\';
    slashes = 0;
    if (*word == 0) break;
    line[used++] = *word;
  }
  line[used++] = L'"';
  line[used++] = L' ';
  return used;
}

/* Processes are known by number; their handles are kept until they are looked at for the last time.
 */
typedef struct child {
  long process;
  HANDLE handle;
} child;
enum { MOST_CHILDREN = 2048 };
static child children[MOST_CHILDREN];

static child *find_child(long process) {
  for (size_t i = 0; i < MOST_CHILDREN; i++)
    if (children[i].process == process) return &children[i];
  return NULL;
}

/* A file that a child process may write to. */
static HANDLE open_for_child(const char *path) {
  SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
  wide_path wide;
  if (!widen(path, &wide)) return INVALID_HANDLE_VALUE;
  return CreateFileW(wide.text, GENERIC_WRITE, FILE_SHARE_READ, &inherited, CREATE_ALWAYS,
                     FILE_ATTRIBUTE_NORMAL, NULL);
}

int scree_process_run(const char *const *words, const char *output, const char *errors,
                      long *process) {
  enum { LINE = 32000 };
  static wchar_t line[LINE], word[LINE], program[MOST_PATH];
  STARTUPINFOW start = {.cb = sizeof start};
  PROCESS_INFORMATION made;
  size_t used = 0;
  bool self = !strcmp(words[0], "scree");
  for (size_t i = 0; words[i] && used < LINE - 1; i++)
    used = MultiByteToWideChar(CP_UTF8, 0, words[i], -1, word, LINE) > 0
               ? quote(word, line, used, LINE - 1)
               : LINE;
  child *place = find_child(0);
  if (used >= LINE - 1 || !place) return E2BIG;
  line[used] = 0;
  if (self && !GetModuleFileNameW(NULL, program, MOST_PATH)) return ENOENT;
  HANDLE file = output ? open_for_child(output) : INVALID_HANDLE_VALUE;
  HANDLE second = errors ? open_for_child(errors) : INVALID_HANDLE_VALUE;
  if (output && file == INVALID_HANDLE_VALUE) return errno_of(GetLastError());
  if (output) {
    start.dwFlags = STARTF_USESTDHANDLES;
    start.hStdOutput = file;
    start.hStdInput = GetStdHandle(STD_INPUT_HANDLE);
    start.hStdError = errors ? second : GetStdHandle(STD_ERROR_HANDLE);
  }
  bool started = CreateProcessW(self ? program : NULL, line, NULL, NULL, output != NULL,
                                CREATE_NEW_PROCESS_GROUP, NULL, NULL, &start, &made);
  DWORD reason = GetLastError();
  if (output) CloseHandle(file);
  if (second != INVALID_HANDLE_VALUE) CloseHandle(second);
  if (!started) return errno_of(reason);
  CloseHandle(made.hThread);
  *place = (child){(long)made.dwProcessId, made.hProcess};
  *process = place->process;
  return 0;
}

scree_process_state scree_process_look(long process, bool wait, int *code) {
  child *found = find_child(process);
  DWORD result = 1;
  *code = 1;
  if (!found) return SCREE_PROCESS_ENDED;
  if (WaitForSingleObject(found->handle, wait ? INFINITE : 0) == WAIT_TIMEOUT)
    return SCREE_PROCESS_RUNS;
  GetExitCodeProcess(found->handle, &result);
  CloseHandle(found->handle);
  *found = (child){0, NULL};
  /* how the system ends programs: 0xC000..., by Ctrl-C or a crash */
  *code = (int)(result & 0xff);
  return result >> 30 == 3 ? SCREE_PROCESS_KILLED : SCREE_PROCESS_ENDED;
}

/* Its children end with the console's group, which is asked to. */
void scree_process_kill(long process) {
  child *found = find_child(process);
  if (found) TerminateProcess(found->handle, 1);
}

void scree_process_stop(long process) {
  GenerateConsoleCtrlEvent(CTRL_BREAK_EVENT, (DWORD)process);
}

/* ---- the program's surroundings ---- */

typedef struct word_list {
  char **items;
  int count;
  bool failed;
} word_list;

/* Slashes separate folders as well, and are what the program looks for. */
static void push_word(word_list *list, const wchar_t *wide) {
  size_t size = 4 * wcslen(wide) + 1;
  char *text = malloc(size),
       **items = realloc(list->items, ((size_t)list->count + 2) * sizeof *items);
  if (items) list->items = items;
  if (!text || !items || !narrow(wide, text, size)) {
    list->failed = true;
    free(text);
    return;
  }
  for (char *c = text; *c; c++)
    if (*c == '\\') *c = '/';
  list->items[list->count++] = text;
  list->items[list->count] = NULL;
}

/* Shells of Windows leave wildcards to the program: the files that match, or the word where none
 * does. */
static void push_matches(word_list *list, const wchar_t *wide) {
  wchar_t path[MOST_PATH];
  WIN32_FIND_DATAW found;
  size_t folder = 0;
  int before = list->count;
  for (size_t i = 0; wide[i]; i++)
    if (wide[i] == L'\\' || wide[i] == L'/') folder = i + 1;
  HANDLE search = wcspbrk(wide, L"*?") ? FindFirstFileW(wide, &found) : INVALID_HANDLE_VALUE;
  bool any = search != INVALID_HANDLE_VALUE;
  for (; any; any = FindNextFileW(search, &found)) {
    if (found.cFileName[0] == L'.' || folder + wcslen(found.cFileName) >= MOST_PATH) continue;
    wmemcpy(path, wide, folder);
    wcscpy(path + folder, found.cFileName);
    push_word(list, path);
  }
  if (search != INVALID_HANDLE_VALUE) FindClose(search);
  if (list->count == before) push_word(list, wide);
}

void scree_program_begin(int *count, char ***words) {
  int found = 0;
  wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &found);
  word_list list = {.failed = !wide};
  for (int i = 0; i < found && !list.failed; i++) push_matches(&list, wide[i]);
  if (!list.failed && list.items) {
    *count = list.count;
    *words = list.items;
  }
  for (int fd = 0; fd < 3; fd++) _setmode(fd, _O_BINARY);
  SetConsoleOutputCP(CP_UTF8);
}

bool scree_is_terminal(FILE *stream) {
  return _isatty(_fileno(stream));
}

int scree_terminal_columns(void) {
  CONSOLE_SCREEN_BUFFER_INFO info;
  return GetConsoleScreenBufferInfo(GetStdHandle(STD_ERROR_HANDLE), &info)
             ? info.srWindow.Right - info.srWindow.Left + 1
             : 0;
}

static void (*interrupt_handler)(int number);

/* Runs in a thread of its own; the second time the program is ended. */
static BOOL WINAPI on_control(DWORD event) {
  void (*handler)(int number) = interrupt_handler;
  interrupt_handler = NULL;
  if (!handler) return FALSE;
  handler(event == CTRL_C_EVENT ? SIGINT : SIGTERM);
  return TRUE;
}

void scree_signals_catch(void (*handler)(int number), bool restart) {
  (void)restart;
  interrupt_handler = handler;
  SetConsoleCtrlHandler(on_control, TRUE);
}
void scree_signals_hold(void) {}
void scree_signals_go_on(void) {}
void scree_signals_release(void (*handler)(int number)) {
  if (interrupt_handler == handler) interrupt_handler = NULL;
}
void scree_signal_end(int number) {
  (void)number;
  ExitProcess(STATUS_CONTROL_C_EXIT);
}
