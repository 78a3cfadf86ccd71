/* Studies whose base is a command: any program that takes its parameters as words and prints its
 * answers, a line each: NAME: NUMBER or NAME = NUMBER. All other lines are its own. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "study/record.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { LONGEST_WORD = 1024, MOST_WORDS = 60, LARGEST_OUTPUT = 64 << 20 };
enum { MOST_PRINTED = 40, LARGEST_TAIL = 400 };
static const double first_look_s = 0.002, longest_look_s = 0.2;
static const double grace_s = 2; /* between asking a command to end and ending it */

static scree_status add_word(scree_study *study, const char *text, size_t length,
                             scree_error *error) {
  char word[LONGEST_WORD];
  if (length >= sizeof word)
    return scree_fail(error, SCREE_LIMIT, "command: a word of more than %zu bytes", sizeof word);
  snprintf(word, sizeof word, "%.*s", (int)length, text);
  const char *kept = scree_arena_text(&study->arena, word);
  study->command.items[study->command.count++] = kept;
  return kept ? SCREE_OK : scree_fail_memory(error, length, "a command");
}

scree_status scree_study_read_command(scree_study *study, const scree_yaml *command,
                                      scree_error *error) {
  bool list = command->kind == SCREE_YAML_SEQUENCE;
  char full[4096];
  if (!scree_path_full(study->path, full, sizeof full)) snprintf(full, sizeof full, "./");
  *strrchr(full, '/') = 0;
  if (!(study->here = scree_arena_text(&study->arena, full)))
    return scree_fail_memory(error, 0, "a command");
  size_t most = list ? command->item_count : command->text ? strlen(command->text) : 0;
  SCREE_TRY_TAKE(study->command.items, &study->arena, most, error);
  for (size_t i = 0; list && i < most; i++) {
    const char *text = command->items[i].text;
    SCREE_TRY(command->items[i].kind == SCREE_YAML_SCALAR
                  ? add_word(study, text, strlen(text), error)
                  : scree_fail(error, SCREE_BAD_FILE, "command: its words must be single values"));
  }
  for (const char *rest = list || !most ? "" : command->text;;) {
    rest += strspn(rest, " \t\n");
    size_t length = strcspn(rest, " \t\n");
    if (length == 0) break;
    SCREE_TRY(add_word(study, rest, length, error));
    rest += length;
  }
  if (study->command.count == 0)
    return scree_fail(error, SCREE_BAD_FILE, "command: must be a program and its words");
  if (study->command.count > MOST_WORDS)
    return scree_fail(error, SCREE_BAD_FILE, "command: %zu words, at most %d", study->command.count,
                      MOST_WORDS);
  return SCREE_OK;
}

bool scree_command_has(const scree_texts *command, const char *key) {
  char braces[140];
  snprintf(braces, sizeof braces, "{%.130s}", key);
  for (size_t i = 0; i < command->count; i++)
    if (strstr(command->items[i], braces)) return true;
  return false;
}

/* What stands for {NAME} in a run; NULL: nothing does. */
static const char *value_of(const scree_study *study, size_t run, const char *name,
                            const char *folder, char buffer[32]) {
  const scree_study_point *point = &study->points[scree_study_run_point(study, run)];
  for (size_t f = 0; f < study->factor_count; f++)
    if (strcmp(name, "seed") != 0 && !strcmp(study->factors[f].key, name)) return point->values[f];
  if (!strcmp(name, "folder")) return folder ? folder : "{folder}";
  if (!strcmp(name, "here")) return folder ? study->here : "{here}"; /* names no run */
  if (strcmp(name, "seed") != 0) return NULL;
  snprintf(buffer, 32, "%" PRIu64, scree_study_run_seed(study, run));
  return buffer;
}

scree_status scree_study_command_word(const scree_study *study, size_t run, size_t word,
                                      const char *folder, char *text, size_t size,
                                      scree_error *error) {
  size_t used = 0;
  *text = 0;
  for (const char *at = study->command.items[word]; *at;) {
    char name[64], number[32];
    size_t length = *at == '{' ? strcspn(at, "}") : 0;
    const char *value = NULL;
    if (length > 0 && at[length] == '}' && length < sizeof name) {
      snprintf(name, sizeof name, "%.*s", (int)length - 1, at + 1);
      value = value_of(study, run, name, folder, number);
    }
    int put = value ? snprintf(text + used, size - used, "%s", value)
                    : snprintf(text + used, size - used, "%c", *at);
    used += (size_t)put;
    if (used >= size)
      return scree_fail(error, SCREE_LIMIT, "command: a word of more than %zu bytes", size);
    at += value ? length + 1 : 1;
  }
  return SCREE_OK;
}

/* ---- running ---- */

static scree_status start(const scree_study *study, size_t run, const char *folder, long *process,
                          scree_error *error) {
  size_t count = study->command.count;
  SCREE_SCRATCH(const char *, words, count + 1, error);
  SCREE_SCRATCH(char, texts, LONGEST_WORD *count, error);
  for (size_t i = 0; i < count; i++) {
    char *text = texts + i * LONGEST_WORD;
    words[i] = text;
    SCREE_TRY(scree_study_command_word(study, run, i, folder, text, LONGEST_WORD, error));
  }
  words[count] = NULL;
  int code = scree_process_run(words, SCREE_PATH_IN(folder, "output.txt"),
                               SCREE_PATH_IN(folder, "errors.txt"), process);
  if (code == 0) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT, "command: cannot start %s: %s", words[0],
                    strerror(code));
}

/* The last line of what it printed of errors, behind ": "; "" where there is none. */
static const char *last_error(const char *folder, char text[LARGEST_TAIL]) {
  SCREE_CLEANUP(scree_free_at) char *all = NULL;
  size_t size = 0;
  *text = 0;
  if (scree_file_read(SCREE_PATH_IN(folder, "errors.txt"), LARGEST_OUTPUT, &all, &size, NULL) !=
      SCREE_OK)
    return text;
  while (size > 0 && isspace((unsigned char)all[size - 1])) all[--size] = 0;
  const char *line = size ? strrchr(all, '\n') : NULL;
  if (size) snprintf(text, LARGEST_TAIL, ": %.390s", line ? line + 1 : all);
  scree_make_printable(text, '?');
  return text;
}

/* Asks it to end; after a while it is ended. */
static void stop(long process) {
  int code;
  double begun = scree_now();
  scree_process_stop(process);
  while (scree_process_look(process, false, &code) == SCREE_PROCESS_RUNS) {
    if (scree_now() - begun > grace_s) {
      scree_process_kill(process);
      scree_process_look(process, true, &code);
      break;
    }
    scree_sleep(first_look_s);
  }
}

/* Looks more seldom the longer it takes: what ends at once is not waited for. Whatever it started
 * ends with it. */
static scree_status wait_for(const scree_study *study, const char *folder, long process,
                             bool (*watch)(void *context), void *context, scree_error *error) {
  int code = 0;
  double pause = first_look_s, begun = scree_now();
  char said[LARGEST_TAIL];
  scree_process_state state;
  while ((state = scree_process_look(process, false, &code)) == SCREE_PROCESS_RUNS) {
    bool goes_on = watch(context), late = scree_now() - begun > study->timeout;
    if (!goes_on || late) {
      stop(process);
      scree_process_kill(process);
      if (!goes_on) return scree_fail(error, SCREE_CANCELLED, "cancelled");
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "the command had not ended after its timeout of %g s%s", study->timeout,
                        last_error(folder, said));
    }
    scree_sleep(pause);
    pause = fmin(1.5 * pause, longest_look_s);
  }
  scree_process_kill(process);
  if (state == SCREE_PROCESS_KILLED)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the command was killed by signal %d%s", code,
                      last_error(folder, said));
  if (code != 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the command ended with code %d%s", code,
                      last_error(folder, said));
  return SCREE_OK;
}

/* ---- its answers ---- */

/* The name and the number of a line NAME: NUMBER or NAME = NUMBER; NULL: it is none. */
static const char *name_of(const char *line, size_t *length) {
  while (*line == ' ' || *line == '\t' || *line == '"') line++;
  const char *end = line + strcspn(line, ":=\"\n"), *at = end + (*end == '"');
  while (at > line && *at && (*at == ' ' || *at == '\t')) at++;
  while (end > line && (end[-1] == ' ' || end[-1] == '\t')) end--;
  *length = (size_t)(end - line);
  return (*at == ':' || *at == '=') && *length ? line : NULL;
}

static const char *number_in(const char *name, size_t length) {
  const char *at = name + length + strspn(name + length, " \t\"");
  return at + 1 + strspn(at + 1, " \t");
}

/* The number behind NAME: or NAME = on the last line that begins so. */
static scree_status find_answer(const char *text, const char *name, double *value, bool *found,
                                scree_error *error) {
  *found = false;
  for (const char *line = text; *line; line += strcspn(line, "\n"), line += *line == '\n') {
    size_t length;
    const char *has = name_of(line, &length);
    if (!has || length != strlen(name) || strncmp(has, name, length) != 0) continue;
    const char *at = number_in(has, length), *line_end = at + strcspn(at, "\n"),
               *end = scree_number_parse(at, line_end, value);
    if (end && *end == ',' && isdigit((unsigned char)end[1]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "%s: '%.*s': the number ends in a comma: a point is needed", name,
                        (int)(line_end - at < 60 ? line_end - at : 60), at);
    if (!end && (tolower((unsigned char)*at) != 'n')) continue; /* nan, null: none in this run */
    if (!end) *value = NAN;
    *found = true;
  }
  return SCREE_OK;
}

/* Whether the answer's name is a slip of one that it printed. SCREE_UNSUPPORTED then, for all runs
 * will miss it; SCREE_BAD_ARGUMENT where this run alone may. */
static scree_status tell_missing(const scree_study *study, const char *text, const char *name,
                                 scree_error *error) {
  char printed[MOST_PRINTED][64], hint[SCREE_NAME_HINT] = "";
  const char *names[MOST_PRINTED];
  size_t count = 0;
  bool asked_for = false;
  double value;
  for (const char *line = text; *line && count < MOST_PRINTED;
       line += strcspn(line, "\n"), line += *line == '\n') {
    size_t length;
    const char *has = name_of(line, &length), *at = has ? number_in(has, length) : NULL;
    if (!has || length >= 64 || !scree_number_parse(at, at + strcspn(at, "\n"), &value)) continue;
    snprintf(printed[count], 64, "%.*s", (int)length, has);
    names[count] = printed[count];
    for (size_t a = 0; a < study->answer_count; a++)
      asked_for = asked_for || !strcmp(printed[count], study->answers[a].column);
    count++;
  }
  if (count) scree_name_hint(name, names, count, hint);
  bool slip = count && (!asked_for || strstr(hint, "did you mean"));
  return scree_fail(error, slip ? SCREE_UNSUPPORTED : SCREE_BAD_ARGUMENT,
                    "the command printed no line '%s: NUMBER'%.380s", name, hint);
}

scree_status scree_study_answer_command(const scree_study *study, const char *folder,
                                        scree_study_record *record, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *text = NULL;
  size_t size, count = study->answer_count;
  SCREE_TRY(
      scree_file_read(SCREE_PATH_IN(folder, "output.txt"), LARGEST_OUTPUT, &text, &size, error));
  SCREE_SCRATCH(double, answers, count, error);
  for (size_t i = 0; i < count; i++) {
    bool found;
    SCREE_TRY(find_answer(text, study->answers[i].column, &answers[i], &found, error));
    if (!found) return tell_missing(study, text, study->answers[i].column, error);
  }
  scree_free(record->answers);
  record->answers = answers;
  answers = NULL;
  record->answer_count = count;
  scree_study_answers_mark(study, record->answered);
  return SCREE_OK;
}

scree_status scree_study_record_command(const scree_study *study, size_t run, const char *folder,
                                        bool (*watch)(void *context), void *context,
                                        scree_study_record *record, scree_error *error) {
  long process;
  SCREE_TRY(start(study, run, folder, &process, error));
  SCREE_TRY(wait_for(study, folder, process, watch, context, error));
  SCREE_TRY(scree_study_answer_command(study, folder, record, error));
  record->result = scree_no_result();
  return SCREE_OK;
}
