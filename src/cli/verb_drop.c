/* scree drop: the scene of a template, shapes poured into a container until they lie still. */
#include "cli/pour.h"

static const cli_pour_arguments defaults = {CLI_POUR_DEFAULTS, .scene.output = "drop", .each = 30};

#define ARGUMENTS cli_pour_arguments
static const cli_option options[] = {
    CLI_ROW(
        CLI_TEXT, "output", scene.output, "DIR",
        "The folder for bodies.pvd, frame-*.vtp, series.csv, scene.png and report.html, made if "
        "need be; with several runs, a folder in it for each, and one report.html. Default: drop."),
    CLI_CHOICE_ROW("container", container, "KIND", "cylinder|box",
                   "cylinder or box. Default: cylinder."),
    CLI_RANGE_ROW(CLI_COUNT, "particles", each, "COUNT", 1, 10000000,
                  "Particles of a shape without =COUNT. Default: 30."),
    CLI_POUR_OPTIONS,
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "width", "width", "LENGTH",
                  "Diameter of the cylinder or side of the box, inside, as in 300mm. Default: "
                  "about the height the heap will have, and room for three abreast."),
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "depth", "depth", "LENGTH",
                  "The box's other side. Default: the width."),
    CLI_FIELD_ROW(CLI_TEXT, "time", "time", "S",
                  "Seconds simulated after the last layer entered, at most. Default: 2; less of "
                  "particles under 10 mm, as their falls are shorter."),
    CLI_FIELD_ROW(CLI_TEXT, "still", "still", "J",
                  "End early when the mean kinetic energy of a particle stays below this; 0: "
                  "never. Default: 1e-8 J; less of particles under 10 mm."),
    CLI_FIELD_ROW(CLI_TEXT, "frames", "frames", "S",
                  "Simulated seconds between frames; 0 writes none. Default: 0.02; less of "
                  "particles under 10 mm."),
    CLI_FIELD_ROW(CLI_TEXT, "checkpoint", "output.checkpoint", "S",
                  "Seconds of the clock between checkpoints. Default: 60."),
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "drop-height", "drop_height", "LENGTH",
                  "From the floor to the first layer. Later ones enter above what is there. "
                  "Default: 50mm, or five times the largest particle where that is less."),
    CLI_FIELD_ROW(CLI_TEXT, "speed", "speed", "M/S",
                  "Speed of entering, downwards. Default: 1 m/s; less of particles under 10 mm."),
    CLI_FIELD_ROW(CLI_TEXT, "density", "density", "KG/M3", "Default: 2000 kg/m3."),
    CLI_FIELD_ROW(CLI_TEXT, "young", "young", "PA",
                  "Young's modulus of the particles: stiffness of a contact over particle size. "
                  "Default: 1e8."),
    CLI_FIELD_ROW(CLI_TEXT, "young-wall", "young_wall", "PA", "The walls'. Default: 1e11."),
    CLI_FIELD_ROW(CLI_TEXT, "restitution", "restitution", "E", "From 0.01 to 1. Default: 0.3."),
    CLI_FIELD_ROW(CLI_TEXT, "friction", "friction", "MU", "Between particles. Default: 0.5."),
    CLI_FIELD_ROW(CLI_TEXT, "friction-wall", "friction_wall", "MU", "Against walls. Default: 0.5."),
    CLI_FIELD_ROW(
        CLI_TEXT, "law", "contact.law", "LAW",
        "linear (spring, dashpot, slider) or hysteretic (Walton and Braun). Default: linear."),
    CLI_FIELD_ROW(CLI_TEXT, "steps", "contact.steps", "N",
                  "Time steps in a quarter period of the fastest contact. Default: 20; 40 for "
                  "energies to 2 %."),
    CLI_FIELD_ROW(CLI_TEXT, "stiffness", "contact.stiffness_factor", "X",
                  "Multiplies all stiffnesses: 0.01 is 10 times faster, with 100 times the "
                  "overlaps at rest. Default: 1."),
    CLI_FIELD_ROW(CLI_TEXT, "seed", "seed", "N", "Another seed, another pour. Default: 1."),
    CLI_SOURCE_OPTIONS,
};

static scree_status run(const cli_call *call, scree_error *error) {
  const cli_pour_arguments *a = call->options;
  return cli_pour_run(call, a->container ? "drop-box" : "drop", false, error);
}

const cli_verb cli_verb_drop = {
    .name = "drop",
    .group = CLI_SIMULATE,
    .summary = "pour shapes into a container and watch them come to rest",
    .inputs = "SHAPE[=COUNT]...",
    .description =
        "Simulates rigid particles falling into a cylinder or a box, layer by layer, until they "
        "are still. A SHAPE is a mesh file, sample:NAME, sphere:DIAMETER with its unit, as in "
        "sphere:40mm, or NAME.csv with the spheres of a clump (x, y, z, radius a line, in the "
        "files' unit); =COUNT says how many. Files are checked, repaired where need be, and "
        "decimated.\n\n"
        "It is a scene, the template drop or drop-box of `scree run`. Writes into DIR: "
        "report.html, which shows and plays it, made of result.json and motion.scree; scene.yaml; "
        "bodies.pvd with frame-*.vtp (surfaces; body, shape and speeds by triangle) for ParaView; "
        "series.csv with energies, contacts and overlaps over time; scene.png. The same options "
        "give the same bits for any number of threads. Ctrl-C stops: what was written stays, the "
        "report shows it, and --resume goes on from checkpoint.scree with the same bits, as after "
        "a crash. A drop that leaves the range of the contact law stops with step, body and cause, "
        "and leaves the state shortly before in stopped.scree.",
    .examples =
        "scree drop phone.stl=50\n"
        "scree drop sample:fp-1=20 sample:dc-2=20 -n 100 --container box --width 300mm -o mixed\n"
        "scree drop sphere:40mm=200 --frames 0.01 --seed 2\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 0,
    .input_maximum = SCREE_MOST_SHAPES,
    .partners = CLI_POUR_PARTNERS " depth:container particles::|samples",
    .exclusive = CLI_POUR_EXCLUSIVE,
    .run = run,
};
