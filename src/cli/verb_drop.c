/* scree drop: the scene of a template, shapes poured into a container until they lie still. */
#include "cli/pour.h"

/* Options and the template's parameters that they set. */
#define SETTINGS(X)                                                                                \
  X(WIDTH, "width", "width", CLI_LENGTH_TEXT, "LENGTH",                                            \
    "Diameter of the cylinder or side of the box, inside, as in 300mm. Default: about the height " \
    "the heap will have, and room for three abreast.")                                             \
  X(DEPTH, "depth", "depth", CLI_LENGTH_TEXT, "LENGTH",                                            \
    "The box's other side. Default: the width.")                                                   \
  X(TIME, "time", "time", CLI_TEXT, "S",                                                           \
    "Seconds simulated after the last layer entered, at most. Default: 2; less of particles "      \
    "under 10 mm, as their falls are shorter.")                                                    \
  X(STILL, "still", "still", CLI_TEXT, "J",                                                        \
    "End early when the mean kinetic energy of a particle stays below this; 0: never. Default: "   \
    "1e-8 J; less of particles under 10 mm.")                                                      \
  X(FRAMES, "frames", "frames", CLI_TEXT, "S",                                                     \
    "Simulated seconds between frames; 0 writes none. Default: 0.02; less of particles under 10 "  \
    "mm.")                                                                                         \
  X(CHECKPOINT, "checkpoint", "output.checkpoint", CLI_TEXT, "S",                                  \
    "Seconds of the clock between checkpoints. Default: 60.")                                      \
  X(DROP_HEIGHT, "drop-height", "drop_height", CLI_LENGTH_TEXT, "LENGTH",                          \
    "From the floor to the first layer. Later ones enter above what is there. Default: 50mm, or "  \
    "five times the largest particle where that is less.")                                         \
  X(SPEED, "speed", "speed", CLI_TEXT, "M/S",                                                      \
    "Speed of entering, downwards. Default: 1 m/s; less of particles under 10 mm.")                \
  X(DENSITY, "density", "density", CLI_TEXT, "KG/M3", "Default: 2000 kg/m3.")                      \
  X(YOUNG, "young", "young", CLI_TEXT, "PA",                                                       \
    "Young's modulus of the particles: stiffness of a contact over particle size. Default: 1e8.")  \
  X(YOUNG_WALL, "young-wall", "young_wall", CLI_TEXT, "PA", "The walls'. Default: 1e11.")          \
  X(RESTITUTION, "restitution", "restitution", CLI_TEXT, "E", "From 0.01 to 1. Default: 0.3.")     \
  X(FRICTION, "friction", "friction", CLI_TEXT, "MU", "Between particles. Default: 0.5.")          \
  X(FRICTION_WALL, "friction-wall", "friction_wall", CLI_TEXT, "MU",                               \
    "Against walls. Default: 0.5.")                                                                \
  X(LAW, "law", "contact.law", CLI_TEXT, "LAW",                                                    \
    "linear (spring, dashpot, slider) or hysteretic (Walton and Braun). Default: linear.")         \
  X(STEPS, "steps", "contact.steps", CLI_TEXT, "N",                                                \
    "Time steps in a quarter period of the fastest contact. Default: 20; 40 for energies to 2 %.") \
  X(STIFFNESS, "stiffness", "contact.stiffness_factor", CLI_TEXT, "X",                             \
    "Multiplies all stiffnesses: 0.01 is 10 times faster, with 100 times the overlaps at rest. "   \
    "Default: 1.")                                                                                 \
  X(SEED, "seed", "seed", CLI_TEXT, "N", "Another seed, another pour. Default: 1.")

CLI_SETTINGS(SETTINGS)

static const cli_pour_arguments defaults = {CLI_POUR_DEFAULTS, .output = "drop", .each = 30};

static const cli_option options[] = {
    {"output", CLI_TEXT, CLI_POUR_AT(output), "DIR",
     "The folder for bodies.pvd, frame-*.vtp, series.csv, scene.png and report.html, made if need "
     "be; with several runs, a folder in it for each, and one report.html. Default: drop.",
     0, 0, NULL},
    {"container", CLI_CHOICE, CLI_POUR_AT(container), "KIND", "cylinder or box. Default: cylinder.",
     0, 0, "cylinder|box"},
    {"particles", CLI_COUNT, CLI_POUR_AT(each), "COUNT",
     "Particles of a shape without =COUNT. Default: 30.", 1, 10000000, NULL},
    CLI_POUR_OPTIONS(CLI_POUR_OPTION) SETTINGS(CLI_SETTING_OPTION)
        CLI_SOURCE_OPTIONS(cli_pour_arguments)};

static int run(const cli_call *call) {
  const cli_pour_arguments *a = call->options;
  const cli_pour_kind kind = {a->container ? "drop-box" : "drop", settings, SETTING_COUNT, false};
  return cli_pour_run(call, &kind);
}

const cli_verb cli_verb_drop = {
    .name = "drop",
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
    .run = run,
};
