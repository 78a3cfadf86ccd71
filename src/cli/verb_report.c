#include "cli/output.h"

#include <string.h>

typedef struct report_arguments {
  const char *output;
  bool overwrite;
} report_arguments;

static const report_arguments defaults = {.output = "report.html"};

#define ARGUMENTS report_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "FILE",
            "The page to write, .html; - is stdout. Default: report.html."),
    CLI_FLAG_ROW("force", overwrite, "Overwrite an existing file."),
};

static scree_status run(const cli_call *call, scree_error *error) {
  const report_arguments *a = call->options;
  char shown[CLI_PRINTABLE_BYTES];
  SCREE_TRY(cli_check_ending(call->verb, a->output, CLI_PAGE));
  SCREE_TRY(cli_check_output(call, a->output, a->overwrite, error));
  SCREE_TRY(scree_page_write(call->inputs, call->input_count, a->output, a->overwrite, error));
  if (!call->quiet && strcmp(a->output, "-") != 0)
    printf("%s: open it in any browser; it needs no network\n", cli_printable(a->output, shown));
  return SCREE_OK;
}

const cli_verb cli_verb_report = {
    .name = "report",
    .group = CLI_SHOW,
    .summary = "one HTML page of results, with the shapes in 3D",
    .inputs = "DIR...",
    .description =
        "Makes one self-contained HTML page of the folders that choose, clump, repose, drop, run, "
        "study, calibrate and optimise write: the answer in a sentence, a picture beside a few "
        "numbers, what to do next, charts, tables, and how it was made. Meshes at every level and "
        "heaps through time are there in 3D. It opens by double-click, also from a mail, and asks "
        "nothing of any network.\n\n"
        "These verbs already leave such a page as DIR/report.html; this one makes it of several "
        "folders, or makes it again.",
    .examples = "scree choose --samples -o devices\n"
                "scree report devices heap -o both.html\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1000,
    .run = run,
};
