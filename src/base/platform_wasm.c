/* What a browser (Emscripten) answers beside platform_posix.c: one thread, no processes, no
 * signals, no terminal. */
#include "base/platform.h"

#include <emscripten.h>
#include <errno.h>

int scree_processor_count(void) {
  return 1;
}
size_t scree_machine_memory(void) {
  return (size_t)4 << 28;
}
void scree_processor_name(char text[SCREE_SYSTEM_TEXT]) {
  snprintf(text, SCREE_SYSTEM_TEXT, "WebAssembly");
}
void scree_machine_identity(char text[SCREE_SYSTEM_TEXT]) {
  snprintf(text, SCREE_SYSTEM_TEXT, "browser");
}

bool scree_thread_start(void *(*work)(void *argument), void *argument) {
  (void)work, (void)argument;
  return false;
}
unsigned long long scree_process_start(long process) {
  return process == scree_process_number();
}
bool scree_program_path(char *path, size_t size) {
  (void)path, (void)size;
  return false;
}
int scree_process_run(const char *const *words, const char *output, const char *errors,
                      long *process) {
  (void)words, (void)output, (void)errors, (void)process;
  return ENOSYS;
}
scree_process_state scree_process_look(long process, bool wait, int *code) {
  (void)process, (void)wait;
  *code = 1;
  return SCREE_PROCESS_ENDED;
}
void scree_process_kill(long process) {
  (void)process;
}
void scree_process_stop(long process) {
  (void)process;
}

void scree_program_begin(int *count, char ***words) {
  (void)count, (void)words;
}
/* Only who runs the module knows. */
EM_JS(int, is_terminal, (int descriptor),
      { return Module.isTerminal && Module.isTerminal(descriptor) ? 1 : 0; });
bool scree_is_terminal(FILE *stream) {
  return is_terminal(fileno(stream)) != 0;
}
int scree_terminal_columns(void) {
  return 0;
}
void scree_signals_catch(void (*handler)(int number), bool restart) {
  (void)handler, (void)restart;
}
void scree_signals_hold(void) {}
void scree_signals_go_on(void) {}
void scree_signals_release(void (*handler)(int number)) {
  (void)handler;
}
void scree_signal_end(int number) {
  (void)number;
}
