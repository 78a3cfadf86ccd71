/* scree calibrate: parameters from measurements. */
#include "cli/calibrate.h"

static int run(const cli_call *call) {
  return calibrate_run(call, false);
}

const cli_verb cli_verb_calibrate = {
    .name = "calibrate",
    .summary = "the parameters that measurements can tell, and those that they cannot",
    .inputs = "FILE.yaml | status DIR",
    .description =
        "Runs scenes at settings of their parameters, compares their answers with what was "
        "measured, and says which settings agree: of every parameter the mean and an interval, "
        "which pairs trade against each other, what the answers would be in scenes that were not "
        "fitted, and which further measurement would tell most. The next runs are made where they "
        "tell most, until the budget is spent or more would tell no more. In place of a scene a "
        "command may give the answers, any other program.\n"
        "\n"
        "The runs are those of studies, one for each experiment: the same command goes on where it "
        "was interrupted, and any number of processes and machines that share the folder work on "
        "it together. With the word status and its folder it shows what is known so far. "
        "docs/reference/calibrate.md describes the file.",
    .examples = "scree calibrate heap.yaml -o heap --jobs 4\n"
                "scree calibrate status heap\n",
    .options = calibrate_options,
    .option_count = CALIBRATE_OPTIONS,
    .defaults = &calibrate_defaults,
    .options_size = sizeof calibrate_defaults,
    .input_minimum = 1,
    .input_maximum = 2,
    .partners = "tasks:slurm dry-run:slurm",
    .run = run,
};
