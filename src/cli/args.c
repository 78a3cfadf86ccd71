#include "cli/args.h"
#include "base/alloc.h"
#include "base/error.h"
#include "base/number.h"
#include "base/platform.h"
#include "base/unit.h"
#include "cli/options.h"
#include "cli/terminal.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define ARGUMENTS cli_common
const cli_option cli_common_options[] = {
    CLI_RANGE_ROW(
        CLI_COUNT, "threads", threads, "N", 0, 4096,
        "Threads to use; 0 is one per processor, the default. The results do not depend on it."),
    CLI_ROW(CLI_TEXT, "backend", backend, "NAME",
            "Where worlds are stepped: cpu, the default, cuda, or cuda:N for the NVIDIA device N. "
            "The results are the same bits."),
    CLI_ROW(CLI_BYTES, "max-memory", max_memory, "SIZE",
            "Fail rather than hold more than SIZE bytes (suffixes K, M, G); 0, the default, is no "
            "limit."),
    CLI_FLAG_ROW(
        "progress", progress,
        "Draw progress also where stderr is no terminal; a log gets a line now and then anyway."),
    CLI_FLAG_ROW("quiet", quiet, "Only results and errors."),
    CLI_FLAG_ROW(
        "verbose", verbose,
        "Show details, and at the end what it cost, on stderr: time, processor time, memory."),
    CLI_FLAG_ROW("help", help, "Show this help."),
};
const size_t cli_common_option_count = sizeof cli_common_options / sizeof *cli_common_options;

static const struct {
  const char *name;
  double metres;
} units[] = {{"m", 1},    {"mm", 1e-3},     {"cm", 1e-2},   {"um", 1e-6},
             {"km", 1e3}, {"inch", 0.0254}, {"in", 0.0254}, {"ft", 0.3048}};

bool cli_unit_from_text(const char *text, double *metres) {
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (!strcmp(text, units[i].name)) {
      *metres = units[i].metres;
      return true;
    }
  return false;
}

const char *cli_unit_name(double metres) {
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (units[i].metres == metres) return units[i].name;
  return "?";
}

/* The number that the text begins with, and what is behind; NULL: it begins with none. */
static const char *parse_decimal(const char *text, double *value) {
  const char *end = scree_number_parse(text, text + strlen(text), value);
  return end && isfinite(*value) ? end : NULL;
}

const char *cli_plural(size_t count) {
  return count == 1 ? "" : "s";
}

bool cli_real_from_text(const char *text, double *value) {
  return scree_number_read(text, value);
}

bool cli_fraction_from_text(const char *text, double *value) {
  const char *end = parse_decimal(text, value);
  if (!end) return false;
  if (*end == '%') *value /= 100;
  return end[*end == '%'] == 0;
}

scree_status cli_fail(const scree_error *error) {
  bool spared = error->status == SCREE_EXISTS;
  bool limited = error->status == SCREE_OUT_OF_MEMORY && scree_memory_failed_at_limit();
  cli_terminal_end();
  fprintf(stderr, "scree: %s%s%s\n", error->message, spared ? "; -f overwrites" : "",
          limited ? "; --max-memory sets it" : "");
  return CLI_TOLD;
}

const char *cli_printable(const char *text, char buffer[CLI_PRINTABLE_BYTES]) {
  snprintf(buffer, CLI_PRINTABLE_BYTES, "%s", text);
  scree_make_printable(buffer, '?');
  return buffer;
}

scree_status cli_refuse(scree_error *error, scree_status status, const char *path,
                        const char *reason) {
  error->status = status;
  snprintf(error->message, sizeof error->message, "%.700s: %.300s", path, reason);
  scree_make_printable(error->message, '?');
  return status;
}

/* Where messages name a file: "NAME: why", "out of memory: so many bytes for NAME". */
static bool names(const char *message, const char *word) {
  size_t length = strlen(word), all = strlen(message);
  return !strncmp(message, word, length) || (all > length && message[all - length - 1] == ' ' &&
                                             !strcmp(message + all - length, word));
}

scree_status cli_name_in_error(const char *word, scree_error *error) {
  char message[sizeof error->message], name[sizeof error->message];
  snprintf(name, sizeof name, "%s", strcmp(word, "-") != 0 ? word : "standard input");
  scree_make_printable(name, '?');
  if (error->status == SCREE_CANCELLED || names(error->message, name)) return error->status;
  memcpy(message, error->message, sizeof message);
  snprintf(error->message, sizeof error->message, "%.300s: %.700s", name, message);
  return error->status;
}

const char *cli_comma_hint(const char *text) {
  for (const char *c = strchr(text, ','); c; c = strchr(c + 1, ','))
    if (c > text && isdigit((unsigned char)c[-1]) && isdigit((unsigned char)c[1]))
      return ": has a decimal comma; write a point, as in 0.5";
  return "";
}

scree_status cli_misuse(const cli_verb *verb, const char *format, ...) {
  va_list arguments;
  char message[CLI_PRINTABLE_BYTES];
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  scree_make_printable(message, '?'); /* the words of the call come in as they are */
  fprintf(stderr, "scree%s%s: %s", verb ? " " : "", verb ? verb->name : "", message);
  if (verb)
    fprintf(stderr, "\nusage: scree %s [options] %s\n`scree help %s` lists the options.\n",
            verb->name, verb->inputs, verb->name);
  else
    fprintf(stderr, "\nusage: scree VERB [options] INPUT...\n`scree help` lists the verbs.\n");
  return CLI_MISUSED;
}

/* ---- values ---- */

static bool in_range(const cli_option *option, double value) {
  if (option->minimum == 0 && option->maximum == 0) return value >= 0;
  return value >= option->minimum && value <= option->maximum;
}

/* In mm, as the help has it; large ones in m. */
static const char *length_text(double metres, char buffer[32]) {
  bool large = metres >= 1;
  snprintf(buffer, 32, "%g%s", large ? metres : 1e3 * metres, large ? "m" : "mm");
  return buffer;
}

static scree_status out_of_range(const cli_verb *verb, const cli_option *option, const char *text) {
  bool open = option->minimum == 0 && option->maximum == 0;
  if (option->kind == CLI_COUNT && open)
    return cli_misuse(verb, "--%s %s: too large", option->name, text);
  if (open) return cli_misuse(verb, "--%s %s: must not be below 0", option->name, text);
  if (option->kind == CLI_COUNT)
    return cli_misuse(verb, "--%s %s: outside the range %.0f to %.0f", option->name, text,
                      option->minimum, option->maximum);
  char low[32], high[32];
  double number;
  bool bare = cli_real_from_text(text, &number) && number != 0;
  if (option->kind == CLI_LENGTH)
    return cli_misuse(verb, "--%s %s%s: outside the range %s to %s", option->name, text,
                      bare ? ", which is in m without a unit" : "",
                      length_text(option->minimum, low), length_text(option->maximum, high));
  bool percent = option->kind == CLI_SHARE && bare && number > 1 && number <= 100;
  return cli_misuse(verb, "--%s %s: outside the range %g to %g%s%s%s", option->name, text,
                    option->minimum, option->maximum, percent ? "; did you mean " : "",
                    percent ? text : "", percent ? "%?" : "");
}

static scree_status parse_count(const cli_verb *verb, const cli_option *option, const char *text,
                                void *value) {
  char *end;
  errno = 0;
  if (option->words && !strcmp(text, option->words)) {
    *(size_t *)value = SIZE_MAX;
    return SCREE_OK;
  }
  unsigned long long parsed = strtoull(text, &end, 10);
  if (*text < '0' || *text > '9' || *end)
    return cli_misuse(verb, "--%s %s: not a whole number%s%s", option->name, text,
                      option->words ? " nor " : "", option->words ? option->words : "");
  if (errno || !in_range(option, (double)parsed)) return out_of_range(verb, option, text);
  *(size_t *)value = (size_t)parsed;
  return SCREE_OK;
}

/* As scree_render takes. */
static bool read_side(const char **text, size_t *side) {
  enum { LEAST = 64, MOST = 20000 };
  *side = 0;
  for (; **text >= '0' && **text <= '9' && *side <= MOST; ++*text)
    *side = 10 * *side + (size_t)(**text - '0');
  return *side >= LEAST && *side <= MOST;
}

scree_status cli_parse_size(const cli_verb *verb, const char *text, size_t *width, size_t *height) {
  const char *at = text;
  if (read_side(&at, width) && *at++ == 'x' && read_side(&at, height) && !*at) return SCREE_OK;
  return cli_misuse(verb, "--size %s: not a size such as 1200x900, each side from 64 to 20000",
                    text);
}

static scree_status parse_bytes(const cli_verb *verb, const cli_option *option, const char *text,
                                void *value) {
  double parsed;
  const char *end = parse_decimal(text, &parsed);
  const char *suffixes = "KMG", *suffix = end && *end ? strchr(suffixes, *end) : NULL;
  if (!end || !(parsed >= 0) || (*end && (!suffix || end[1])))
    return cli_misuse(verb, "--%s %s: not a size such as 500M or 4G", option->name, text);
  for (const char *s = suffixes; suffix && s <= suffix; s++) parsed *= 1024;
  if (parsed > 1e18) return cli_misuse(verb, "--%s %s: too large", option->name, text);
  *(size_t *)value = (size_t)parsed;
  return SCREE_OK;
}

bool cli_length_from_text(const char *text, double *metres) {
  double number, unit = 1;
  const char *end = parse_decimal(text, &number);
  if (!end) return false;
  if (*end && !cli_unit_from_text(end, &unit)) return false;
  *metres = number * unit;
  return true;
}

/* The unit in which the number is meant: the value's name in the help, where that is one. */
static const char *unit_of(const cli_option *option) {
  static const char *const wanted[][2] = {{"KG/M3", "kg/m3"}, {"PA", "Pa"}, {"DEG", "deg"}};
  for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
    if (!strcmp(option->value_name, wanted[i][0])) return wanted[i][1];
  return "";
}

/* A number that stands for itself, a length or a share. */
static scree_status parse_number(const cli_verb *verb, const cli_option *option, const char *text,
                                 double *value) {
  const char *what = "number", *wanted = "";
  bool good;
  if (option->kind == CLI_LENGTH || option->kind == CLI_LENGTH_TEXT) {
    what = "length such as 0.27mm (m, cm, mm, um, km, inch, ft; without a unit, m)";
    good = cli_length_from_text(text, value);
  } else if (option->kind == CLI_SHARE || option->kind == CLI_SHARE_TEXT) {
    what = "share such as 0.005 or 0.5%";
    good = cli_fraction_from_text(text, value);
  } else {
    const char *rest = parse_decimal(text, value);
    wanted = unit_of(option);
    if (rest) rest += strspn(rest, " ");
    good = rest && (!*rest || scree_unit_convert(rest, wanted, value) == SCREE_UNIT_FITS);
  }
  if (!good)
    return cli_misuse(verb, "--%s %s: not a %s%s%s%s", option->name, text, what,
                      *wanted ? " in " : "", wanted, cli_comma_hint(text));
  return in_range(option, *value) ? SCREE_OK : out_of_range(verb, option, text);
}

const char *cli_si_text(cli_kind kind, const char *text, char buffer[CLI_NUMBER_BYTES]) {
  double value;
  if (kind == CLI_LENGTH_TEXT ? !cli_length_from_text(text, &value)
                              : kind != CLI_SHARE_TEXT || !cli_fraction_from_text(text, &value))
    return text;
  snprintf(buffer, CLI_NUMBER_BYTES, "%.15g", value);
  return buffer;
}

static scree_status parse_choice(const cli_verb *verb, const cli_option *option, const char *text,
                                 void *value) {
  size_t length = strlen(text);
  int index = 0;
  for (const char *word = option->words; word; index++) {
    const char *bar = strchr(word, '|');
    size_t word_length = bar ? (size_t)(bar - word) : strlen(word);
    if (word_length == length && !strncmp(word, text, length)) {
      *(int *)value = index;
      return SCREE_OK;
    }
    word = bar ? bar + 1 : NULL;
  }
  char hint[64];
  cli_word_hint(option->words, text, hint, sizeof hint);
  return cli_misuse(verb, "--%s %s: must be one of %s%s", option->name, text, option->words, hint);
}

static scree_status too_often(const cli_verb *verb, const cli_option *option) {
  return cli_misuse(verb, "--%s is given more than %d times", option->name, CLI_MOST_TEXTS);
}

static scree_status add_text(const cli_verb *verb, const cli_option *option, const char *text,
                             cli_texts *texts) {
  if (texts->count == CLI_MOST_TEXTS) return too_often(verb, option);
  texts->items[texts->count++] = text;
  return SCREE_OK;
}

/* As it was given. */
static scree_status keep_text(const cli_verb *verb, const cli_option *option, const char *text,
                              void *value) {
  cli_fields *fields = value;
  if (!*text)
    return cli_misuse(verb, "--%s: the value %s is empty", option->name, option->value_name);
  if (!option->field) {
    *(const char **)value = text;
    return SCREE_OK;
  }
  if (fields->count == CLI_MOST_TEXTS) return too_often(verb, option);
  fields->options[fields->count] = option;
  fields->values[fields->count++] = text;
  return SCREE_OK;
}

static scree_status store(const cli_verb *verb, const cli_option *option, const char *text,
                          void *base) {
  void *value = (char *)base + option->offset;
  double real = 0;
  switch (option->kind) {
  case CLI_FLAG:
    *(bool *)value = true;
    return SCREE_OK;
  case CLI_TEXT:
  case CLI_FILE:
    return keep_text(verb, option, text, value);
  case CLI_TEXTS:
    return add_text(verb, option, text, value);
  case CLI_COUNT:
    return parse_count(verb, option, text, value);
  case CLI_REAL:
  case CLI_LENGTH:
  case CLI_SHARE:
    SCREE_TRY(parse_number(verb, option, text, &real));
    break;
  case CLI_LENGTH_TEXT:
  case CLI_SHARE_TEXT:
    SCREE_TRY(parse_number(verb, option, text, &real));
    return keep_text(verb, option, text, value);
  case CLI_UNIT:
    if (cli_unit_from_text(text, &real)) break;
    return cli_misuse(verb, "--%s %s: no unit of length (m, cm, mm, um, km, inch, ft)",
                      option->name, text);
  case CLI_BYTES:
    return parse_bytes(verb, option, text, value);
  case CLI_CHOICE:
    return parse_choice(verb, option, text, value);
  }
  *(double *)value = real;
  return SCREE_OK;
}

/* ---- words ---- */

typedef struct found_option {
  const cli_option *option;
  void *base;
} found_option;

typedef struct parser {
  const cli_verb *verb;
  void *options;
  cli_common *common;
  int word_count;
  char **words;
  int next;
  const char *texts[CLI_MOST_OPTIONS]; /* what stood behind the verb's: "" of a flag */
  const char **inputs;
  size_t input_count;
} parser;

static found_option find_option(const parser *p, const char *name, size_t length, char letter) {
  for (int table = 0; table < 2; table++) {
    const cli_option *options = table ? cli_common_options : p->verb->options;
    size_t count = table ? cli_common_option_count : p->verb->option_count;
    for (size_t i = 0; i < count; i++)
      if (letter ? cli_letter(options[i].name) == letter
                 : strlen(options[i].name) == length && !strncmp(options[i].name, name, length))
        return (found_option){&options[i], table ? (void *)p->common : p->options};
  }
  return (found_option){NULL, NULL};
}

static bool is_given(const parser *p, const char *name, size_t length) {
  found_option found = find_option(p, name, length, 0);
  return found.option && found.base == p->options && p->texts[found.option - p->verb->options];
}

static scree_status take_value(parser *p, found_option found, const char *text) {
  if (found.base == p->options) p->texts[found.option - p->verb->options] = text ? text : "";
  return store(p->verb, found.option, text, found.base);
}

/* One that begins so; of ":" alone, any. */
static bool has_input(const parser *p, const char *beginning, size_t length) {
  for (size_t i = 0; i < p->input_count; i++)
    if (length == 1 || !strncmp(p->inputs[i], beginning, length)) return true;
  return false;
}

/* Tells which option does nothing by itself. */
static scree_status check_partners(const parser *p) {
  for (const char *at = p->verb->partners; at && *at;) {
    size_t name = strcspn(at, ":"), all = strcspn(at, " ");
    bool missing = is_given(p, at, name);
    const char *first = at + name + 1;
    for (const char *one = first; one < at + all; one += strcspn(one, "| ") + 1) {
      size_t length = strcspn(one, "| ");
      bool is_input = one[length - 1] == ':';
      missing = missing && !(is_input ? has_input(p, one, length) : is_given(p, one, length));
    }
    size_t length = strcspn(first, "| ");
    if (missing && length == 1)
      return cli_misuse(p->verb, "--%.*s does nothing without a %.*s", (int)name, at,
                        (int)strcspn(p->verb->inputs, "[."), p->verb->inputs);
    if (missing && first[length - 1] == ':')
      return cli_misuse(p->verb, "--%.*s does nothing without an input %.*sNAME", (int)name, at,
                        (int)length, first);
    if (missing)
      return cli_misuse(p->verb, "--%.*s does nothing without --%.*s", (int)name, at, (int)length,
                        first);
    at += all + (at[all] != 0);
  }
  return SCREE_OK;
}

/* Tells which two do not go together. */
static scree_status check_exclusive(const parser *p) {
  for (const char *at = p->verb->exclusive; at && *at;) {
    size_t one = strcspn(at, "|"), all = strcspn(at, " ");
    const char *other = at + one + 1;
    int length = (int)(all - one - 1);
    if (is_given(p, at, one) && is_given(p, other, (size_t)length))
      return cli_misuse(p->verb, "--%.*s and --%.*s exclude each other", (int)one, at, length,
                        other);
    at += all + (at[all] != 0);
  }
  return SCREE_OK;
}

/* "-dash.stl" may be meant as the file of that name. */
static const char *file_hint(const char *word, char *buffer, size_t size) {
  buffer[0] = 0;
  if (scree_path_exists(word)) snprintf(buffer, size, "; the file of that name is ./%.200s", word);
  return buffer;
}

static scree_status unknown_option(const cli_verb *verb, const char *word, const char *name) {
  char hint[256];
  const char *dashes = name[1] ? "--" : "-";
  cli_option_hint(verb, name, hint, sizeof hint);
  if (*hint) return cli_misuse(verb, "unknown option '%s%s'%s", dashes, name, hint);
  return cli_misuse(verb, "unknown option '%s%s'%s", dashes, name,
                    file_hint(word, hint, sizeof hint));
}

/* With what stands behind the name in its own word, or else in the next. Its letter, where it was
 * called by that. */
static scree_status take_option(parser *p, found_option found, char letter, const char *behind) {
  const cli_option *option = found.option;
  if (option->kind == CLI_FLAG)
    return behind ? cli_misuse(p->verb, "--%s takes no value", option->name)
                  : take_value(p, found, NULL);
  if (behind) return take_value(p, found, behind);
  if (p->next < p->word_count) return take_value(p, found, p->words[p->next++]);
  return letter ? cli_misuse(p->verb, "-%c needs a value %s", letter, option->value_name)
                : cli_misuse(p->verb, "--%s needs a value %s", option->name, option->value_name);
}

static scree_status parse_long(parser *p, const char *word) {
  const char *equals = strchr(word, '=');
  size_t length = equals ? (size_t)(equals - word - 2) : strlen(word + 2);
  found_option found = find_option(p, word + 2, length, 0);
  if (found.option) return take_option(p, found, 0, equals ? equals + 1 : NULL);
  char name[64];
  snprintf(name, sizeof name, "%.*s", (int)length, word + 2);
  return unknown_option(p->verb, word, name);
}

/* -qv, -n100, -n 100 */
static scree_status parse_letters(parser *p, const char *word) {
  for (const char *letter = word + 1; *letter; letter++) {
    found_option found = find_option(p, NULL, 0, *letter);
    if (!found.option) return unknown_option(p->verb, word, (char[]){*letter, 0});
    bool flag = found.option->kind == CLI_FLAG;
    SCREE_TRY(take_option(p, found, *letter, flag || !letter[1] ? NULL : letter + 1));
    if (!flag) break;
  }
  return SCREE_OK;
}

static scree_status check_input_count(const cli_verb *verb, const char *const *inputs,
                                      size_t count) {
  size_t streams = 0;
  for (size_t i = 0; i < count; i++) {
    if (!*inputs[i]) return cli_misuse(verb, "input %zu of %zu has an empty name", i + 1, count);
    streams += !strcmp(inputs[i], "-");
  }
  if (streams > 1) return cli_misuse(verb, "'-' is given twice; standard input can be read once");
  if (count < verb->input_minimum && verb->input_minimum == 1)
    return cli_misuse(verb, "needs at least one input");
  if (count < verb->input_minimum)
    return cli_misuse(verb, "needs %zu inputs, got %zu", verb->input_minimum, count);
  if (count > verb->input_maximum)
    return cli_misuse(verb, "takes at most %zu input%s; '%s' is one too many", verb->input_maximum,
                      cli_plural(verb->input_maximum), inputs[verb->input_maximum]);
  return SCREE_OK;
}

/* Names what is given and cannot be meant, on stderr. */
static void remark_values(const parser *p) {
  for (size_t i = 0; i < p->verb->option_count; i++) {
    const cli_option *option = &p->verb->options[i];
    const cli_meaning *meaning = cli_find_meaning(option->name);
    double number;
    if (!p->texts[i] || !meaning || !(meaning->most > 0)) continue;
    if (option->kind == CLI_REAL)
      memcpy(&number, (const char *)p->options + option->offset, sizeof number);
    else if (option->kind != CLI_TEXT || !cli_real_from_text(p->texts[i], &number))
      continue;
    if (number < meaning->least || number > meaning->most)
      fprintf(stderr, "scree: --%s %g: %s\n", option->name, number, meaning->expected);
  }
}

/* A number without a unit is in metres, and whoever thinks in the unit of the files means another.
 */
static void remark_lengths(const parser *p) {
  static const double far_apart = 100;
  double number, unit;
  found_option found = find_option(p, "unit", strlen("unit"), 0);
  if (!found.option || found.option->kind != CLI_UNIT) return;
  memcpy(&unit, (const char *)found.base + found.option->offset, sizeof unit);
  if (unit < far_apart && unit * far_apart > 1) return;
  for (size_t i = 0; i < p->verb->option_count; i++) {
    const cli_option *option = &p->verb->options[i];
    if ((option->kind != CLI_LENGTH && option->kind != CLI_LENGTH_TEXT) || !p->texts[i]) continue;
    if (!cli_real_from_text(p->texts[i], &number) || number == 0) continue;
    fprintf(stderr,
            "scree: --%s %s is in m, as lengths without a unit are, and the files are in %s: write "
            "%s%s or %sm\n",
            option->name, p->texts[i], cli_unit_name(unit), p->texts[i], cli_unit_name(unit),
            p->texts[i]);
  }
}

scree_status cli_parse(const cli_verb *verb, int word_count, char **words, void *options,
                       cli_common *common, const char **inputs, size_t *input_count) {
  parser p = {.verb = verb,
              .options = options,
              .common = common,
              .word_count = word_count,
              .words = words,
              .inputs = inputs};
  bool only_inputs = false;
  SCREE_ASSERT(verb->option_count <= CLI_MOST_OPTIONS);
  while (p.next < word_count) {
    const char *word = words[p.next++];
    if (only_inputs || word[0] != '-' || !word[1])
      inputs[p.input_count++] = word;
    else if (!strcmp(word, "--"))
      only_inputs = true;
    else
      SCREE_TRY(word[1] == '-' ? parse_long(&p, word) : parse_letters(&p, word));
    if (common->help) return SCREE_OK;
  }
  *input_count = p.input_count;
  common->unit_given = is_given(&p, "unit", strlen("unit"));
  SCREE_TRY(check_input_count(verb, inputs, p.input_count));
  SCREE_TRY(check_partners(&p));
  SCREE_TRY(check_exclusive(&p));
  if (common->quiet) return SCREE_OK;
  remark_values(&p);
  remark_lengths(&p);
  return SCREE_OK;
}
