#include "base/alloc.h"
#include "base/parts.h"
#include "base/platform.h"
#include "base/quote.h"
#include "cli/input.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/terminal.h"
#include "report/provenance.h"

#include <stdlib.h>
#include <string.h>

const cli_verb *cli_find_verb(const char *name) {
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++)
    if (!strcmp((*verb)->name, name)) return *verb;
  return NULL;
}

/* The words as one line that a shell reads back as the same words. */
static char *join_words(int count, char **words) {
  char *made = NULL, *kept = NULL;
  size_t size;
  FILE *stream = scree_memory_open(&made, &size);
  if (!stream) return NULL;
  fputs("scree", stream);
  for (int i = 1; i < count; i++) {
    putc(' ', stream);
    scree_quote(stream, SCREE_QUOTE_SHELL, words[i]);
  }
  if (scree_memory_close(stream)) kept = scree_strdup(made);
  free(made);
  return kept;
}

static scree_status unknown_verb(const char *word) {
  char hint[64];
  if (word[0] == '-') return cli_misuse(NULL, "unknown option '%s'; a verb comes first", word);
  cli_verb_hint(word, hint, sizeof hint);
  return cli_misuse(NULL, "unknown verb '%s'%s", word, hint);
}

/* scree help --man [VERB] and the like: what the build makes of the tables. */
static scree_status print_manual(const char *kind, const char *word) {
  const cli_verb *verb = word ? cli_find_verb(word) : NULL;
  if (!strcmp(kind, "--completion")) {
    if (cli_print_completion(stdout, word ? word : "bash")) return SCREE_OK;
    return cli_misuse(NULL, "--completion %s: must be bash, zsh or fish", word);
  }
  if (word && !verb) return unknown_verb(word);
  if (!strcmp(kind, "--man"))
    cli_print_man(stdout, verb);
  else if (!strcmp(kind, "--markdown"))
    cli_print_markdown(stdout, verb);
  else if (!strcmp(kind, "--options"))
    cli_print_options(stdout);
  else
    return cli_misuse(NULL, "unknown option '%s' of help", kind);
  return SCREE_OK;
}

static scree_status help(int word_count, char **words) {
  if (word_count == 0) {
    cli_print_overview(stdout);
    return SCREE_OK;
  }
  if (!strncmp(words[0], "--", 2)) return print_manual(words[0], word_count > 1 ? words[1] : NULL);
  if (!strcmp(words[0], "help") || !strcmp(words[0], "version")) {
    bool is_help = words[0][0] == 'h';
    printf(
        "usage: scree %s%s\n\n%s\n", words[0], is_help ? " [VERB]" : "",
        is_help
            ? "Lists the verbs, or shows what a verb does and its options."
            : "Shows the version, which parts this build has, and on what worlds can be stepped.");
    return SCREE_OK;
  }
  const cli_verb *verb = cli_find_verb(words[0]);
  if (!verb) return unknown_verb(words[0]);
  cli_print_help(stdout, verb);
  return SCREE_OK;
}

/* What it cost, on stderr. */
static void tell_costs(const scree_work_start *start) {
  scree_work_start now = scree_work_started();
  fprintf(stderr,
          "scree %s: %.1f s, %.1f s of processor time on up to %d threads, %.1f MB at most\n",
          scree_version(), now.elapsed - start->elapsed, now.processor - start->processor,
          scree_threads(), (double)scree_memory_peak() / 1e6);
}

static scree_status choose_backend(const cli_verb *verb, const char *name, scree_error *error) {
  scree_status status = name ? scree_set_backend(name, error) : SCREE_OK;
  return status == SCREE_BAD_ARGUMENT ? cli_misuse(verb, "%s", error->message) : status;
}

static scree_status run(const cli_verb *verb, int argc, char **argv, scree_error *error) {
  const scree_work_start start = scree_work_started();
  _Alignas(max_align_t) unsigned char options[CLI_OPTIONS_BYTES];
  cli_common common = {0};
  memcpy(options, verb->defaults, verb->options_size);
  SCREE_SCRATCH(const char *, inputs, (size_t)argc, error);
  SCREE_CLEANUP(scree_free_at) char *command_line = join_words(argc, argv);
  if (!command_line) return scree_fail_memory(error, 0, "the words of the call");
  size_t input_count = 0;
  SCREE_TRY(cli_parse(verb, argc - 2, argv + 2, options, &common, inputs, &input_count));
  if (common.help) {
    cli_print_help(stdout, verb);
    return SCREE_OK;
  }
  scree_set_threads((int)common.threads);
  scree_set_memory_limit(common.max_memory);
  cli_input_obeys(&common);
  SCREE_TRY(choose_backend(verb, common.backend, error));
  cli_progress_kind shown = common.progress             ? CLI_PROGRESS_LINE
                            : common.quiet              ? CLI_PROGRESS_NONE
                            : scree_is_terminal(stderr) ? CLI_PROGRESS_LINE
                                                        : CLI_PROGRESS_LOG;
  const cli_call call = {.verb = verb,
                         .options = options,
                         .inputs = inputs,
                         .input_count = input_count,
                         .quiet = common.quiet,
                         .verbose = common.verbose,
                         .max_memory = common.max_memory,
                         .backend = common.backend,
                         .progress = cli_terminal_start(shown),
                         .command_line = command_line};
  scree_status status = verb->run(&call, error);
  if (status != SCREE_OK && status < CLI_TOLD) status = cli_fail(error);
  cli_unlock_folder();
  if (status != SCREE_OK) cli_remove_empty_folders();
  cli_terminal_end();
  if (common.verbose) tell_costs(&start);
  if (cli_interrupted()) cli_terminal_reraise();
  return status;
}

static void print_backends(void) {
  static const char *const names[] = {"cpu", "cuda"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    char description[256];
    scree_error error;
    bool there = scree_check_backend(names[i], description, &error) == SCREE_OK;
    printf("backend %-5s %s%s\n", names[i],
           there ? "" : "not there: ", there ? description : error.message);
  }
}

static void print_version(bool parts) {
  printf("scree %s\n", scree_version());
  for (int part = 0; parts && part < SCREE_BUILD_COUNT; part++)
    printf("%s %s\n", scree_build_has((scree_build_part)part) ? " with  " : "without",
           scree_build_text((scree_build_part)part));
  if (parts) print_backends();
}

static scree_status act(int argc, char **argv, scree_error *error) {
  if (argc < 2) {
    cli_print_overview(stderr);
    return CLI_MISUSED;
  }
  const char *word = argv[1];
  if (!strcmp(word, "help") || !strcmp(word, "--help") || !strcmp(word, "-h"))
    return help(argc - 2, argv + 2);
  if (!strcmp(word, "version") || !strcmp(word, "--version")) {
    print_version(*word != '-');
    return SCREE_OK;
  }
  const cli_verb *verb = cli_find_verb(word);
  if (!verb && !strcmp(word, "study") && !scree_build_has(SCREE_BUILD_STUDY))
    return cli_misuse(NULL, "this build of scree has no studies (SCREE_STUDY=OFF)");
  return verb ? run(verb, argc, argv, error) : unknown_verb(word);
}

int main(int argc, char **argv) {
  scree_error error;
  scree_program_begin(&argc, &argv);
  scree_status status = act(argc, argv, &error);
  if (status == CLI_MISUSED) return 2;
  if (status != SCREE_OK && status != CLI_TOLD) cli_fail(&error);
  return status == SCREE_OK && cli_finish_printing() ? 0 : 1;
}
