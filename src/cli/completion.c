/* Completion for bash, zsh and fish, from the tables that the help is made of. */
#include "cli/options.h"

#include <string.h>

static bool has_choices(const cli_option *option) {
  return option->words || option->each;
}

/* The words that an option offers, with blanks between. */
static void print_choices(FILE *stream, const cli_option *option) {
  for (const char *c = option->words; c && *c; c++) fputc(*c == '|' ? ' ' : *c, stream);
  for (size_t i = 0; option->each && option->each(i); i++)
    fprintf(stream, "%s%s", i ? " " : "", option->each(i));
}

/* Whether built-in samples are among its inputs: their spacing is its option. */
static bool takes_samples(const cli_verb *verb) {
  return cli_has_option(verb, "resolution");
}

static void print_samples(FILE *stream, const char *before) {
  for (size_t i = 0; i < scree_sample_count(); i++)
    fprintf(stream, "%s%s%s", i ? " " : "", before, scree_sample_name(i));
}

static bool takes_file(const cli_option *option) {
  return option->kind == CLI_FILE || option->kind == CLI_TEXT || option->kind == CLI_TEXTS;
}

static const char *meaning_of(const cli_option *option) {
  const cli_meaning *meaning = cli_find_meaning(option->name);
  return meaning ? meaning->meaning : "";
}

/* Calls print for every option of the verb and every common one. */
static void each_option(FILE *stream, const cli_verb *verb,
                        void (*print)(FILE *, const cli_verb *, const cli_option *)) {
  for (size_t i = 0; i < verb->option_count; i++) print(stream, verb, &verb->options[i]);
  for (size_t i = 0; i < cli_common_option_count; i++) print(stream, verb, &cli_common_options[i]);
}

/* ---- bash ---- */

static void print_bash_name(FILE *stream, const cli_verb *verb, const cli_option *option) {
  (void)verb;
  fprintf(stream, " --%s", option->name);
}

static void print_bash_choices(FILE *stream, const cli_verb *verb, const cli_option *option) {
  char letter = cli_letter(option->name);
  if (!has_choices(option)) return;
  fprintf(stream, "    %s:--%s", verb->name, option->name);
  if (letter) fprintf(stream, "|%s:-%c", verb->name, letter);
  fputs(") words=\"", stream);
  print_choices(stream, option);
  fputs("\" ;;\n", stream);
}

static void print_bash(FILE *stream) {
  /* A colon is a word of its own there: sample:NAME is three. */
  fputs("_scree() {\n  local word=${COMP_WORDS[COMP_CWORD]} words=\n"
        "  local last=${COMP_WORDS[COMP_CWORD-1]} before=${COMP_WORDS[COMP_CWORD-2]}\n"
        "  [ \"$last$word\" = sample: ] && before=$last last=: word=\n"
        "  [ \"$before$last\" = sample: ] && words=\"",
        stream);
  print_samples(stream, "");
  fputs("\"\n  case ${COMP_WORDS[1]}:$last in\n", stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
    each_option(stream, *verb, print_bash_choices);
  fputs("  esac\n  if [ -n \"$words\" ]; then\n"
        "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n    return\n  fi\n"
        "  if [ \"$COMP_CWORD\" = 1 ]; then\n    words=\"help version",
        stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
    fprintf(stream, " %s", (*verb)->name);
  fputs("\"\n  else\n    case ${COMP_WORDS[1]} in\n", stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
    fprintf(stream, "      %s) words=\"", (*verb)->name);
    each_option(stream, *verb, print_bash_name);
    if (takes_samples(*verb)) fputs(" sample:", stream);
    fputs("\" ;;\n", stream);
  }
  fputs("    esac\n  fi\n"
        "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\") $(compgen -f -- \"$word\"))\n}\n"
        "complete -F _scree scree\n",
        stream);
}

/* ---- zsh ---- */

/* Within single quotes, and within [...] or after a colon of _arguments. */
static void print_zsh_text(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (*text == '\'') {
      fputs("'\\''", stream);
      continue;
    }
    if (strchr("[]:\\", *text)) fputc('\\', stream);
    fputc(*text, stream);
  }
}

static void print_zsh_option(FILE *stream, const cli_verb *verb, const cli_option *option) {
  char letter = cli_letter(option->name);
  (void)verb;
  if (letter)
    fprintf(stream, "        '(-%c --%s)'{-%c,--%s}'[", letter, option->name, letter, option->name);
  else
    fprintf(stream, "        '--%s[", option->name);
  print_zsh_text(stream, meaning_of(option));
  fputc(']', stream);
  if (option->value_name) {
    fputc(':', stream);
    print_zsh_text(stream, option->value_name);
    fputc(':', stream);
    if (has_choices(option)) {
      fputc('(', stream);
      print_choices(stream, option);
      fputc(')', stream);
    } else if (takes_file(option)) {
      fputs("_files", stream);
    }
  }
  fputs("' \\\n", stream);
}

static void print_zsh(FILE *stream) {
  fputs("#compdef scree\n\n_scree_scans() {\n  _files\n  compadd -- ", stream);
  print_samples(stream, "sample:");
  fputs("\n}\n\n_scree() {\n  if (( CURRENT == 2 )); then\n    local -a verbs=(\n", stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
    fprintf(stream, "      '%s:", (*verb)->name);
    print_zsh_text(stream, (*verb)->summary);
    fputs("'\n", stream);
  }
  fputs("      'help:show the help of a verb'\n      'version:show the version'\n    )\n"
        "    _describe verb verbs\n    return\n  fi\n  local verb=$words[2]\n"
        "  shift words\n  (( CURRENT-- ))\n  case $verb in\n",
        stream);
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
    fprintf(stream, "    %s)\n      _arguments -s \\\n", (*verb)->name);
    each_option(stream, *verb, print_zsh_option);
    fprintf(stream, "        '*:input:%s'\n      ;;\n",
            takes_samples(*verb) ? "_scree_scans" : "_files");
  }
  fputs("  esac\n}\n\n_scree \"$@\"\n", stream);
}

/* ---- fish ---- */

static void print_fish_text(FILE *stream, const char *text) {
  cli_print_escaped(stream, text, "'\\");
}

static void print_fish_option(FILE *stream, const cli_verb *verb, const cli_option *option) {
  char letter = cli_letter(option->name);
  fprintf(stream, "complete -c scree -n '__fish_seen_subcommand_from %s' -l %s", verb->name,
          option->name);
  if (letter) fprintf(stream, " -s %c", letter);
  if (has_choices(option)) {
    fputs(" -x -a '", stream);
    print_choices(stream, option);
    fputc('\'', stream);
  } else if (option->value_name) {
    fputs(takes_file(option) ? " -r" : " -x", stream);
  }
  fputs(" -d '", stream);
  print_fish_text(stream, meaning_of(option));
  fputs("'\n", stream);
}

static void print_fish(FILE *stream) {
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) {
    fprintf(stream, "complete -c scree -n __fish_use_subcommand -a %s -d '", (*verb)->name);
    print_fish_text(stream, (*verb)->summary);
    fputs("'\n", stream);
    each_option(stream, *verb, print_fish_option);
    if (!takes_samples(*verb)) continue;
    fprintf(stream, "complete -c scree -n '__fish_seen_subcommand_from %s' -a '", (*verb)->name);
    print_samples(stream, "sample:");
    fputs("'\n", stream);
  }
  fputs("complete -c scree -n __fish_use_subcommand -a 'help version'\n", stream);
}

bool cli_print_completion(FILE *stream, const char *shell) {
  static const struct {
    const char *name;
    void (*print)(FILE *);
  } shells[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};
  for (size_t i = 0; i < sizeof shells / sizeof *shells; i++)
    if (!strcmp(shell, shells[i].name)) {
      shells[i].print(stream);
      return true;
    }
  return false;
}
