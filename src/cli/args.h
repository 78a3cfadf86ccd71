/* One table of options per verb drives parsing, help, the man page and shell completion. */
#pragma once

#include "base/error.h"
#include "scree.h"

typedef enum cli_kind {
  CLI_FLAG,        /* bool: set to true */
  CLI_TEXT,        /* const char * */
  CLI_TEXTS,       /* cli_texts: every time it is given, one more */
  CLI_FILE,        /* const char *: a file that is read */
  CLI_COUNT,       /* size_t in [minimum, maximum]; SIZE_MAX for the word in `words` */
  CLI_REAL,        /* double in [minimum, maximum] */
  CLI_SHARE,       /* double, as 0.5 or 50% */
  CLI_LENGTH,      /* double in metres; the value may carry its unit, as in 0.27mm */
  CLI_UNIT,        /* double: metres per unit, from m, cm, mm, um, inch, ft, km */
  CLI_BYTES,       /* size_t, with suffix K, M, G */
  CLI_CHOICE,      /* int: index of the word in `words`, which reads "one|two|three" */
  CLI_LENGTH_TEXT, /* const char *, a length as given: cli_si_text makes it metres */
  CLI_SHARE_TEXT,  /* const char *, a share alike */
} cli_kind;

enum { CLI_MOST_TEXTS = 64 };
typedef struct cli_texts {
  const char *items[CLI_MOST_TEXTS];
  size_t count;
} cli_texts;

typedef struct cli_option {
  const char *name;        /* long name without dashes; its letter is in cli/options.c */
  cli_kind kind;           /* */
  size_t offset;           /* of the value in the verb's struct */
  const char *value_name;  /* in the help, as RP; NULL for flags */
  const char *help;        /* one or more sentences; says unit and default */
  double minimum, maximum; /* of a number; both 0: any value not below 0 */
  const char *words; /* "one|two": of CLI_CHOICE all that is taken, of CLI_COUNT one that stands
                        beside numbers, of texts what completion offers; else NULL */
  const char *field; /* of a scene: the value is one of cli_fields; else NULL */
  /* What completion offers for a text, up to NULL, where `words` cannot say it. */
  const char *(*each)(size_t index);
} cli_option;
/* Rows of a table whose verb has named its struct ARGUMENTS. */
#define CLI_ROW(kind, name, member, value, help)                                                   \
  CLI_RANGE_ROW(kind, name, member, value, 0, 0, help)
#define CLI_RANGE_ROW(kind, name, member, value, least, most, help)                                \
  { name, kind, offsetof(ARGUMENTS, member), value, help, least, most, NULL, NULL, NULL }
#define CLI_CHOICE_ROW(name, member, value, words, help)                                           \
  { name, CLI_CHOICE, offsetof(ARGUMENTS, member), value, help, 0, 0, words, NULL, NULL }
/* What takes more than the words that completion offers. */
#define CLI_WORDS_ROW(kind, name, member, value, words, help)                                      \
  { name, kind, offsetof(ARGUMENTS, member), value, help, 0, 0, words, NULL, NULL }
#define CLI_EACH_ROW(name, member, value, each, help)                                              \
  { name, CLI_TEXT, offsetof(ARGUMENTS, member), value, help, 0, 0, NULL, NULL, each }
#define CLI_FLAG_ROW(name, member, help) CLI_ROW(CLI_FLAG, name, member, NULL, help)
/* What sets a field or parameter of a scene, kept in the member `fields`. */
#define CLI_FIELD_ROW(kind, name, field, value, help)                                              \
  { name, kind, offsetof(ARGUMENTS, fields), value, help, 0, 0, NULL, field, NULL }

/* Fields of a scene that options set, as they were given. */
typedef struct cli_fields {
  const cli_option *options[CLI_MOST_TEXTS];
  const char *values[CLI_MOST_TEXTS];
  size_t count;
} cli_fields;

/* What a verb answers besides a status of the library, when it has told stderr why. */
#define CLI_TOLD    ((scree_status)1001) /* exit code 1 */
#define CLI_MISUSED ((scree_status)1002) /* exit code 2 */

struct cli_call;

/* What a verb is for, in the order of the work. */
typedef enum cli_group {
  CLI_PREPARE,
  CLI_SIMULATE,
  CLI_DECIDE,
  CLI_SHOW,
  CLI_GROUP_COUNT
} cli_group;
/* "Prepare a particle from a scan" */
const char *cli_group_title(cli_group group);

typedef struct cli_verb {
  const char *name;
  cli_group group;
  const char *summary;     /* one line, lower case, no full stop */
  const char *inputs;      /* as in the usage line: "FILE..." */
  const char *description; /* paragraphs, wrapped at 80 columns */
  const char *examples;    /* lines "scree ...", or NULL */
  const cli_option *options;
  size_t option_count;
  const void *defaults; /* the verb's struct with its default values */
  size_t options_size;  /* its size, at most CLI_OPTIONS_BYTES */
  size_t input_minimum, input_maximum;
  const char *partners;  /* "samples:distance to:from|until": options that do nothing without (one
                            of) the others, so that they are refused; "noise:sample:": without an
                            input that begins so, "rp::": without any; or NULL */
  const char *exclusive; /* "json|csv rp|count": options that exclude each other; or NULL */
  scree_status (*run)(const struct cli_call *call, scree_error *error);
} cli_verb;

/* A table of options, and the verb's struct with their defaults. */
#define CLI_OPTIONS(table, usual)                                                                  \
  .options = table, .option_count = sizeof table / sizeof *table, .defaults = &usual,              \
  .options_size = sizeof usual
enum { CLI_OPTIONS_BYTES = 4096, CLI_MOST_OPTIONS = 128 };

/* What a verb is called with. */
typedef struct cli_call {
  const cli_verb *verb;
  const void *options; /* the verb's struct, filled */
  const char *const *inputs;
  size_t input_count;
  bool quiet, verbose;
  size_t max_memory;              /* bytes; 0: no limit */
  const char *backend;            /* for the workers of a study; NULL: the processor */
  const scree_progress *progress; /* draws on stderr where that is a terminal; Ctrl-C cancels */
  const char *command_line;       /* for provenance, words quoted where needed */
} cli_call;

/* The verbs in the order of the flow, ended by NULL. */
extern const cli_verb *const cli_verbs[];
const cli_verb *cli_find_verb(const char *name);

/* Options that every verb takes. */
typedef struct cli_common {
  bool help, quiet, verbose, progress;
  size_t threads, max_memory;
  bool unit_given;     /* the verb's own option --unit was */
  const char *backend; /* NULL: the processor */
} cli_common;
extern const cli_option cli_common_options[];
extern const size_t cli_common_option_count;

/* Parses words (without the verb) into the verb's struct, the common options and the inputs (an
 * array as long as words). CLI_MISUSED after telling stderr what is wrong with which word. */
scree_status cli_parse(const cli_verb *verb, int word_count, char **words, void *options,
                       cli_common *common, const char **inputs, size_t *input_count);

void cli_print_overview(FILE *stream);
void cli_print_help(FILE *stream, const cli_verb *verb);
/* For scdoc: the page of a verb, or with NULL scree(1). */
void cli_print_man(FILE *stream, const cli_verb *verb);
/* The reference of a verb, or with NULL that of all verbs and options. */
void cli_print_markdown(FILE *stream, const cli_verb *verb);
/* The one table of options, a line each: name, letter and meaning with tabs between. */
void cli_print_options(FILE *stream);
/* For bash, zsh or fish; false, and nothing printed, for another shell. */
bool cli_print_completion(FILE *stream, const char *shell);
/* Every character that is in `marks` escaped by a backslash. */
void cli_print_escaped(FILE *stream, const char *text, const char *marks);

enum { CLI_PRINTABLE_BYTES = 4200 };
/* A copy of a name as text may show it: scree_make_printable with a ?, as in errors. For people:
 * JSON and CSV keep names as they are. */
const char *cli_printable(const char *text, char buffer[CLI_PRINTABLE_BYTES]);

/* Prints "scree: message" on stderr; returns CLI_TOLD. */
scree_status cli_fail(const scree_error *error);
/* "path: reason" as an error of that status, which it returns. */
scree_status cli_refuse(scree_error *error, scree_status status, const char *path,
                        const char *reason);
/* Puts the word, "standard input" for "-", in front of an error that does not name it; returns the
 * error's status. */
scree_status cli_name_in_error(const char *word, scree_error *error);
/* Says what is wrong with the call on stderr and how to get help; returns CLI_MISUSED. */
scree_status cli_misuse(const cli_verb *verb, const char *format, ...) SCREE_PRINTF(2, 3);
/* What to add where a text is no number: a word on a comma between digits, else "". */
const char *cli_comma_hint(const char *text);

#define CLI_UNITS "m|cm|mm|um|inch|ft|km"
/* "mm" to 1e-3; false where the word is no unit of length. */
bool cli_unit_from_text(const char *text, double *metres);
/* 1e-3 to "mm"; "?" where it is none of ours. */
const char *cli_unit_name(double metres);
/* --size: "1200x900" to the pixels across and down of a picture, or CLI_MISUSED. */
scree_status cli_parse_size(const cli_verb *verb, const char *text, size_t *width, size_t *height);
/* What a word of so many ends in: "" of one, else "s". */
const char *cli_plural(size_t count);
/* A number, all of the text; false otherwise. Not locale-dependent: the program never sets one. */
bool cli_real_from_text(const char *text, double *value);
/* A share, all of the text, as 0.5 or 50%; false otherwise. */
bool cli_fraction_from_text(const char *text, double *value);
enum { CLI_NUMBER_BYTES = 32 };
/* What the kind's text means as a plain number in SI units; other kinds' text as it is. */
const char *cli_si_text(cli_kind kind, const char *text, char buffer[CLI_NUMBER_BYTES]);
/* A length, all of the text, as in 0.27mm, or in metres; false otherwise. */
bool cli_length_from_text(const char *text, double *metres);
