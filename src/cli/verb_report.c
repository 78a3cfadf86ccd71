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
    .summary = "one HTML page of results, with the shapes in 3D",
    .inputs = "DIR...",
    .description =
        "Makes one self-contained HTML page of the folders that scree choose -o, scree repose -o, "
        "scree drop and scree study write. Of a choice: the answer, the curve with a slider that "
        "shows the mesh at every level beside the scan, the tables. Of a heap: its angles, and the "
        "particles in 3D to turn around and play through time beside the curves; of a pour the "
        "same without angles. Of a study: angle of repose, its spread, rotation and computation "
        "time with their curves and tables, and a heap of each point. And how each was made. It "
        "opens by double-click, also from a mail, and asks nothing of any network.\n\n"
        "These verbs already leave such a page as DIR/report.html; this one makes it of several "
        "folders, or makes it again.",
    .examples = "scree choose --samples -o devices\n"
                "scree report devices heap -o both.html\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1000,
    .run = run,
};
