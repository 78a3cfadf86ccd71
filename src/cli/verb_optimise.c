/* scree optimise: the best settings of a design. */
#include "cli/study.h"

const cli_verb cli_verb_optimise = {
    .name = "optimise",
    .group = CLI_DECIDE,
    .summary = "the settings of a design that give the most or the least of an answer",
    .inputs = "FILE.yaml | status DIR",
    .description =
        "Runs scenes at settings of any of their fields and looks for those that minimise or "
        "maximise an answer of their sensors, under limits on others: angles, speeds and places of "
        "geometry, or meshes from a list. Answers scatter from seed to seed; the next runs are "
        "made where the best is expected to gain most. It says which settings are best, "
        "how sure that is, and which others are near.\n"
        "\n"
        "File, runs and folder are as of scree calibrate; docs/reference/calibrate.md describes "
        "them.",
    .examples = "scree optimise drum.yaml -o drum --jobs 4\n"
                "scree optimise status drum\n",
    CALIBRATION,
};
