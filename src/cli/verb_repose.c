/* scree repose: the scene of the template of that name, with shapes of the call. */
#include "cli/pour.h"

static const cli_pour_arguments defaults = {CLI_POUR_DEFAULTS, .preset = "heap"};

/* What has no option is set by its field, with --set. */

#define ARGUMENTS cli_pour_arguments
static const cli_option options[] = {
    CLI_WORDS_ROW(
        CLI_TEXT, "preset", preset, "NAME", "heap|paper|small|demo",
        "What the file and the options change: heap (the default), paper, small or demo."),
    CLI_ROW(CLI_TEXT, "output", scene.output, "DIR",
            "A folder, made if need be, for checkpoints, frames, result.json, series.csv, "
            "scene.yaml, scene.png and report.html; with several runs, a folder in it for each, "
            "and one report.html."),
    CLI_POUR_OPTIONS,
    CLI_FIELD_ROW(CLI_TEXT, "particles", "particles", "N",
                  "How many particles, in equal shares of the shapes."),
    CLI_FIELD_ROW(CLI_TEXT, "seed", "seed", "N", "Of positions, orientations and order."),
    CLI_FIELD_ROW(CLI_TEXT, "density", "density", "KG/M3", "Of the particles."),
    CLI_FIELD_ROW(CLI_TEXT, "mass-from", "mass_from", "WHAT",
                  "mesh: mass by each decimated mesh's own volume, as a simulator that reads the "
                  "mesh has it; scan: by the scan's at every level."),
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "cylinder", "cylinder.diameter", "LENGTH",
                  "Inner diameter of the cylinder."),
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "disc", "disc.diameter", "LENGTH",
                  "Diameter of the bottom disc."),
    CLI_FIELD_ROW(CLI_TEXT, "pack-time", "phases.pack_time", "S",
                  "While the particles are filled in."),
    CLI_FIELD_ROW(CLI_TEXT, "settle-time", "phases.settle_time", "S", "While they come to rest."),
    CLI_FIELD_ROW(CLI_TEXT, "lift-speed", "phases.lift_speed", "M/S", "Of the cylinder."),
    CLI_FIELD_ROW(CLI_TEXT, "lift-time", "phases.lift_time", "S", "How long it rises."),
    CLI_FIELD_ROW(CLI_TEXT, "hold-time", "phases.hold_time", "S",
                  "After the lift, at most, until still."),
    CLI_FIELD_ROW(CLI_TEXT, "stop-when-still", "phases.stop_when_still", "BOOL",
                  "true: phases end early when still."),
    CLI_FIELD_ROW(CLI_TEXT, "still", "phases.still_energy", "J",
                  "Kinetic energy a particle: less is still."),
    CLI_FIELD_ROW(
        CLI_TEXT, "inlet", "phases.inlet", "WHERE",
        "top: particles fall from above where the packed heap will end; heap: from near the heap."),
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "drop-height", "phases.drop_height", "LENGTH",
                  "From the heap's top to the inlet, at least."),
    CLI_FIELD_ROW(CLI_TEXT, "young", "contact.young_particle", "PA",
                  "Young's modulus of the particles."),
    CLI_FIELD_ROW(CLI_TEXT, "young-wall", "contact.young_wall", "PA",
                  "Young's modulus of the walls."),
    CLI_FIELD_ROW(CLI_TEXT, "restitution", "contact.restitution", "E", "Of every contact."),
    CLI_FIELD_ROW(CLI_TEXT, "friction", "friction", "MU", "Particle on particle."),
    CLI_FIELD_ROW(CLI_TEXT, "friction-wall", "friction_wall", "MU", "Particle on wall."),
    CLI_FIELD_ROW(CLI_TEXT, "law", "contact.law", "NAME", "linear or hysteretic."),
    CLI_FIELD_ROW(CLI_TEXT, "steps", "contact.steps", "N",
                  "Time steps in a quarter of a contact's period, at least 15."),
    CLI_FIELD_ROW(
        CLI_TEXT, "stiffness", "contact.stiffness_factor", "F",
        "Multiplies every stiffness; 0.2 is 2.2 times faster, with overlaps 5 times deeper."),
    CLI_FIELD_ROW(CLI_TEXT, "gravity", "gravity", "M/S2", "Downwards."),
    CLI_FIELD_ROW(CLI_TEXT, "frames", "output.frame_interval", "S",
                  "Simulated time between frames; 0: only the last."),
    CLI_FIELD_ROW(CLI_TEXT, "checkpoint", "output.checkpoint_interval", "S",
                  "Clock time between checkpoints."),
    CLI_FIELD_ROW(CLI_TEXT, "series", "output.series_interval", "S",
                  "Simulated time between points of the series."),
    CLI_FIELD_ROW(CLI_TEXT, "angles", "output.angle_interval", "S",
                  "And between those with angles."),
    CLI_FIELD_ROW(CLI_LENGTH_TEXT, "cell", "measure.cell", "LENGTH",
                  "Of the height field; 0: a tenth of the particle size."),
    CLI_FIELD_ROW(CLI_TEXT, "sectors", "measure.sectors", "N", "Azimuth sectors."),
    CLI_FIELD_ROW(CLI_SHARE_TEXT, "band-low", "measure.band_low", "SHARE",
                  "The flank begins at this share of the height."),
    CLI_FIELD_ROW(CLI_SHARE_TEXT, "band-high", "measure.band_high", "SHARE",
                  "And ends at this one."),
    CLI_SOURCE_OPTIONS,
};

static scree_status run(const cli_call *call, scree_error *error) {
  return cli_pour_run(call, "repose", true, error);
}

const cli_verb cli_verb_repose = {
    .name = "repose",
    .group = CLI_SIMULATE,
    .summary = "pour a heap and measure its angle of repose",
    .inputs = "SHAPE[=COUNT]...",
    .description =
        "Runs the experiment of Katagiri and Koyanaka (2020): particles of the shapes fall into a "
        "cylinder, come to rest, the cylinder is raised, and the heap is measured three ways. A "
        "SHAPE is a scan, sample:NAME, or NAME.csv with the spheres of a clump (x, y, z, radius a "
        "line). Without --rp a scan of more than 2,000 triangles is taken at the level that choose "
        "recommends, which is said. The default, the preset heap, has 400 particles in a "
        "cylinder ten of them wide; lengths, times, speeds and stiffness scale with the particles, "
        "so that it takes minutes at any size. paper is the paper's protocol (1197 particles of "
        "about 50 mm: hours); small and demo are smaller heaps, and no number should be taken "
        "from demo. It is a scene, the template repose of `scree run`: everything can be changed "
        "by a YAML file and "
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
    .exclusive = CLI_POUR_EXCLUSIVE,
    .run = run,
};
