/* scree repose: the scene of the template of that name, with shapes of the call. */
#include "cli/pour.h"

/* Options and the template's parameters that they set. What has no option is set by its field, with
 * --set. */
#define SETTINGS(X)                                                                                \
  X(PARTICLES, "particles", "particles", CLI_TEXT, "N",                                            \
    "How many particles, in equal shares of the shapes.")                                          \
  X(SEED, "seed", "seed", CLI_TEXT, "N", "Of positions, orientations and order.")                  \
  X(DENSITY, "density", "density", CLI_TEXT, "KG/M3", "Of the particles.")                         \
  X(MASS_FROM, "mass-from", "mass_from", CLI_TEXT, "WHAT",                                         \
    "mesh: mass by each decimated mesh's own volume, as a simulator that reads the mesh has it; "  \
    "scan: by the scan's at every level.")                                                         \
  X(CYLINDER, "cylinder", "cylinder.diameter", CLI_LENGTH_TEXT, "LENGTH",                          \
    "Inner diameter of the cylinder.")                                                             \
  X(DISC, "disc", "disc.diameter", CLI_LENGTH_TEXT, "LENGTH", "Diameter of the bottom disc.")      \
  X(PACK_TIME, "pack-time", "phases.pack_time", CLI_TEXT, "S",                                     \
    "While the particles are filled in.")                                                          \
  X(SETTLE_TIME, "settle-time", "phases.settle_time", CLI_TEXT, "S", "While they come to rest.")   \
  X(LIFT_SPEED, "lift-speed", "phases.lift_speed", CLI_TEXT, "M/S", "Of the cylinder.")            \
  X(LIFT_TIME, "lift-time", "phases.lift_time", CLI_TEXT, "S", "How long it rises.")               \
  X(HOLD_TIME, "hold-time", "phases.hold_time", CLI_TEXT, "S",                                     \
    "After the lift, at most, until still.")                                                       \
  X(STOP_WHEN_STILL, "stop-when-still", "phases.stop_when_still", CLI_TEXT, "BOOL",                \
    "true: phases end early when still.")                                                          \
  X(STILL_ENERGY, "still", "phases.still_energy", CLI_TEXT, "J",                                   \
    "Kinetic energy a particle: less is still.")                                                   \
  X(INLET, "inlet", "phases.inlet", CLI_TEXT, "WHERE",                                             \
    "top: particles fall from above where the packed heap will end; heap: from near the heap.")    \
  X(DROP_HEIGHT, "drop-height", "phases.drop_height", CLI_LENGTH_TEXT, "LENGTH",                   \
    "From the heap's top to the inlet, at least.")                                                 \
  X(YOUNG, "young", "contact.young_particle", CLI_TEXT, "PA", "Young's modulus of the particles.") \
  X(YOUNG_WALL, "young-wall", "contact.young_wall", CLI_TEXT, "PA",                                \
    "Young's modulus of the walls.")                                                               \
  X(RESTITUTION, "restitution", "contact.restitution", CLI_TEXT, "E", "Of every contact.")         \
  X(FRICTION, "friction", "contact.friction_particle", CLI_TEXT, "MU", "Particle on particle.")    \
  X(FRICTION_WALL, "friction-wall", "contact.friction_wall", CLI_TEXT, "MU", "Particle on wall.")  \
  X(LAW, "law", "contact.law", CLI_TEXT, "NAME", "linear or hysteretic.")                          \
  X(STEPS, "steps", "contact.steps", CLI_TEXT, "N",                                                \
    "Time steps in a quarter of a contact's period, at least 15.")                                 \
  X(STIFFNESS, "stiffness", "contact.stiffness_factor", CLI_TEXT, "F",                             \
    "Multiplies every stiffness; 0.2 is 2.2 times faster, with overlaps 5 times deeper.")          \
  X(GRAVITY, "gravity", "gravity", CLI_TEXT, "M/S2", "Downwards.")                                 \
  X(FRAMES, "frames", "output.frame_interval", CLI_TEXT, "S",                                      \
    "Simulated time between frames; 0: only the last.")                                            \
  X(CHECKPOINT, "checkpoint", "output.checkpoint_interval", CLI_TEXT, "S",                         \
    "Clock time between checkpoints.")                                                             \
  X(SERIES, "series", "output.series_interval", CLI_TEXT, "S",                                     \
    "Simulated time between points of the series.")                                                \
  X(ANGLES, "angles", "output.angle_interval", CLI_TEXT, "S", "And between those with angles.")    \
  X(CELL, "cell", "measure.cell", CLI_LENGTH_TEXT, "LENGTH",                                       \
    "Of the height field; 0: a tenth of the particle size.")                                       \
  X(SECTORS, "sectors", "measure.sectors", CLI_TEXT, "N", "Azimuth sectors.")                      \
  X(BAND_LOW, "band-low", "measure.band_low", CLI_SHARE_TEXT, "SHARE",                             \
    "The flank begins at this share of the height.")                                               \
  X(BAND_HIGH, "band-high", "measure.band_high", CLI_SHARE_TEXT, "SHARE", "And ends at this one.")

CLI_SETTINGS(SETTINGS)

static const cli_pour_arguments defaults = {CLI_POUR_DEFAULTS, .preset = "demo"};

static const cli_option options[] = {
    {"preset", CLI_TEXT, CLI_POUR_AT(preset), "NAME",
     "What the file and the options change: paper, small or demo (the default).", 0, 0, NULL},
    {"output", CLI_TEXT, CLI_POUR_AT(output), "DIR",
     "A folder, made if need be, for checkpoints, frames, result.json, series.csv, scene.yaml, "
     "scene.png and report.html; with several runs, a folder in it for each, and one report.html.",
     0, 0, NULL},
    CLI_POUR_OPTIONS(CLI_POUR_OPTION) SETTINGS(CLI_SETTING_OPTION)
        CLI_SOURCE_OPTIONS(cli_pour_arguments)};

static int run(const cli_call *call) {
  const cli_pour_kind kind = {"repose", settings, SETTING_COUNT, true};
  return cli_pour_run(call, &kind);
}

const cli_verb cli_verb_repose = {
    .name = "repose",
    .summary = "pour a heap and measure its angle of repose",
    .inputs = "SHAPE[=COUNT]...",
    .description =
        "Runs the experiment of Katagiri and Koyanaka (2020): particles of the shapes fall into a "
        "cylinder, come to rest, the cylinder is raised, and the heap is measured three ways. A "
        "SHAPE is a scan, sample:NAME, or NAME.csv with the spheres of a clump (x, y, z, radius a "
        "line). Without --rp a scan of more than 2,000 triangles is taken at the level that choose "
        "recommends, which is said. The preset paper is the paper's protocol (1197 particles: "
        "hours); small has 360 particles and softer contacts (its heap scatters more); demo, the "
        "default, shows a heap in about a minute and no number should be taken from it. It is a "
        "scene, the template repose of `scree run`: everything can be changed by a YAML file and "
        "by options, which have the last word. With -o the run writes checkpoints: after Ctrl-C, "
        "or a crash, --resume goes on with the same bits. The same seed gives the same heap on any "
        "number of threads. \"No heap\" is a result: spheres give it.",
    .examples = "scree repose phone_762.stl -o heap\n"
                "scree repose --samples --rp 1e-4,1e-3 --spheres -p small -o levels\n"
                "scree repose --resume -o heap\n"
                "scree repose -p paper --friction 0.4 --print > mine.yaml\n"
                "scree repose -c mine.yaml --samples --rp 1e-3 -o night\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 0,
    .input_maximum = SCREE_MOST_SHAPES,
    .partners = CLI_POUR_PARTNERS " view:output",
    .run = run,
};
