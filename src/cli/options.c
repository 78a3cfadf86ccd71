#include "cli/options.h"
#include "base/schema.h"

#include <string.h>

/* A verb's own table adds the kind, the default and the limits of a value. */
const cli_meaning cli_meanings[] = {
    {.name = "angle", .meaning = "Greatest angle at which spheres of a bubble pack meet."},
    {.name = "angles", .meaning = "Simulated time between angles in a series."},
    {.name = "area", .meaning = "The area that an error of area is measured against."},
    {.name = "as", .meaning = "What a surface becomes for another code."},
    {.name = "azimuth", .meaning = "The camera's angle about the vertical."},
    {.name = "backend", .meaning = "Where worlds are stepped."},
    {.name = "band-high", .meaning = "Where a heap's flank ends, as a share of its height."},
    {.name = "band-low", .meaning = "Where a heap's flank begins, as a share of its height."},
    {.name = "body", .meaning = "Keep one of several separate bodies."},
    {.name = "cavities", .meaning = "How much volume of cavities is filled."},
    {.name = "cell", .meaning = "Side of the cells of a height field."},
    {.name = "centre", .meaning = "Put the centre of mass at the origin."},
    {.name = "change", .meaning = "Go on with another value of a field."},
    {.name = "checkpoint", .meaning = "Clock time between checkpoints."},
    {.name = "clump", .meaning = "Spheres of the clump that stands for each shape."},
    {.name = "color-by", .meaning = "What surfaces are coloured by."},
    {.name = "columns", .meaning = "Columns of views in a picture."},
    {"config", 'c', "An experiment in YAML.", 0, 0, NULL},
    {.name = "container", .meaning = "What particles are poured into."},
    {"count", 'n', "How many triangles, spheres of a clump or cells.", 0, 0, NULL},
    {.name = "csv", .meaning = "Print CSV instead of text."},
    {.name = "cut-plane", .meaning = "Cut off what lies below a plane."},
    {.name = "cylinder", .meaning = "Inner diameter of the lifted cylinder."},
    {.name = "debris", .meaning = "Shells below this share of the largest one's area go."},
    {"density", 'd', "Density of the solid.", 50, 25000,
     "kg/m3 is meant, as 2650 for quartz and 7850 for steel"},
    {.name = "depth", .meaning = "The second side of a box."},
    {.name = "disc", .meaning = "Diameter of the bottom disc."},
    {.name = "distance", .meaning = "Add distances to the scan."},
    {.name = "drop-cavities", .meaning = "Fill all cavities."},
    {.name = "drop-height", .meaning = "How high above the floor or the heap particles enter."},
    {.name = "dry-run", .meaning = "Prepare, do not run."},
    {.name = "edges", .meaning = "Draw the edges of the triangles."},
    {.name = "elevation", .meaning = "The camera's angle above the horizontal."},
    {"error", 'e', "Largest error of a collapse.", 0, 0, NULL},
    {.name = "errors", .meaning = "Also what each error alone would choose."},
    {.name = "fast", .meaning = "Do not look for self-intersections."},
    {.name = "fit", .meaning = "Move vertices nearer to the scan."},
    {.name = "flat", .meaning = "Fill holes without new vertices."},
    {"force", 'f', "Overwrite existing files.", 0, 0, NULL},
    {.name = "format", .meaning = "What many meshes are written as."},
    {.name = "frames", .meaning = "Simulated time between frames."},
    {"friction", 0, "Coefficient of friction between particles.", 0, 3,
     "the coefficient mu is meant, as 0.5"},
    {"friction-wall", 0, "Coefficient of friction against walls.", 0, 3,
     "the coefficient mu is meant, as 0.5"},
    {.name = "from", .meaning = "The side that a picture is seen from."},
    {.name = "gap", .meaning = "How exactly the Hausdorff distance is known."},
    {.name = "grain", .meaning = "Cells that are longer one way."},
    {"gravity", 0, "Acceleration downwards.", 0.01, 1000, "m/s2 is meant, as 9.81"},
    {"grid", 'g', "Levels of a table: least Rp, greatest Rp, levels per decade.", 0, 0, NULL},
    {"help", 'h', "Show the help.", 0, 0, NULL},
    {.name = "hold-time", .meaning = "After the lift, at most, until still."},
    {.name = "holes", .meaning = "Most of the area that a hole's filling may be."},
    {.name = "inlet", .meaning = "Where particles enter."},
    {"inside", 'i', "No sphere stands out of the surface.", 0, 0, NULL},
    {.name = "jobs", .meaning = "Runs at the same time."},
    {.name = "json", .meaning = "Print JSON instead of text."},
    {.name = "keep-failed", .meaning = "Do not try failed runs again."},
    {.name = "keep-handles", .meaning = "Cut no short handles."},
    {.name = "largest", .meaning = "Keep only the largest shell."},
    {.name = "law", .meaning = "The contact law."},
    {.name = "lease", .meaning = "When a silent worker's run is taken over."},
    {.name = "least", .meaning = "Smaller pieces join a neighbour."},
    {.name = "lift-speed", .meaning = "Speed of the lifted cylinder."},
    {.name = "lift-time", .meaning = "How long the cylinder rises."},
    {.name = "list", .meaning = "List the samples, write nothing."},
    {.name = "mass-from", .meaning = "Whether mass comes from the scan or from its level."},
    {.name = "max", .meaning = "Largest number of spheres tried."},
    {.name = "max-memory", .meaning = "Fail rather than hold more memory."},
    {.name = "merge-folds", .meaning = "Merge where a shell meets itself."},
    {"method", 'm', "The algorithm, by name.", 0, 0, NULL},
    {.name = "near", .meaning = "Where cells are denser."},
    {.name = "no-captions", .meaning = "No text in a picture."},
    {.name = "no-cut", .meaning = "Refuse a surface that meets itself."},
    {.name = "no-ground", .meaning = "No floor in a picture."},
    {.name = "no-merge", .meaning = "Refuse shells that cross."},
    {.name = "no-picture", .meaning = "Write no picture."},
    {.name = "no-repair", .meaning = "Refuse what is no closed surface."},
    {.name = "no-wait", .meaning = "Do not wait for others' runs."},
    {.name = "noise", .meaning = "Scanner noise of built-in samples."},
    {"one-way", '1', "Only from the first surface to the second.", 0, 0, NULL},
    {"output", 'o', "The file or folder to write.", 0, 0, NULL},
    {.name = "outside", .meaning = "How far spheres may stand out of the surface."},
    {.name = "pack-time", .meaning = "While particles are filled in."},
    {.name = "paper", .meaning = "Choose exactly as the paper did."},
    {.name = "particle-size", .meaning = "Size of the particles of a measured heap."},
    {"particles", 'N', "How many particles.", 0, 0, NULL},
    {.name = "picture-width", .meaning = "What a picture shows across."},
    {.name = "pieces", .meaning = "The most convex pieces of a mesh for another code."},
    {.name = "points", .meaning = "Points that a distance is measured at."},
    {"preset", 'p', "What an experiment starts from.", 0, 0, NULL},
    {.name = "principal", .meaning = "Turn the principal axes along x, y and z."},
    {.name = "print", .meaning = "Print the file as it would be run, and stop."},
    {.name = "progress", .meaning = "Show progress also where stderr is no terminal."},
    {"quiet", 'q', "Only results and errors.", 0, 0, NULL},
    {.name = "ratio", .meaning = "Least sphere of a bubble pack, in the largest one's radii."},
    {.name = "rays", .meaning = "Rays a pixel of a picture."},
    {.name = "reference", .meaning = "The surface that distances are measured to."},
    {.name = "resolution", .meaning = "Vertex spacing of built-in samples."},
    {.name = "restitution", .meaning = "Coefficient of restitution."},
    {.name = "resume", .meaning = "Go on from the last checkpoint."},
    {.name = "rounds", .meaning = "Rounds of relaxation of the cells' places."},
    {"rp", 'r', "Percentage reduction: triangles kept over those of the scan, as 1e-3 or 0.1%.", 0,
     0, NULL},
    {.name = "rule", .meaning = "Whose choice comes first."},
    {.name = "ruler", .meaning = "How long the ruler in a picture is."},
    {.name = "sample-seed", .meaning = "Seed of the noise of built-in samples."},
    {.name = "samples", .meaning = "Take the nine built-in devices."},
    {.name = "seam", .meaning = "How far apart the sides of a seam are united."},
    {.name = "sectors", .meaning = "Azimuth sectors of a heap."},
    {.name = "seed",
     .meaning = "Seed of the places of cells; of particles, of turns and order too."},
    {.name = "series", .meaning = "Simulated time between points of a series."},
    {.name = "set", .meaning = "Change a field of the file."},
    {.name = "settle-time", .meaning = "While particles come to rest."},
    {"size", 's', "Size of a picture in pixels.", 0, 0, NULL},
    {.name = "slivers", .meaning = "Keep pieces that are no particles."},
    {.name = "slurm", .meaning = "Run as a Slurm job array."},
    {.name = "speed", .meaning = "Speed at which particles enter."},
    {.name = "spheres", .meaning = "Also a run with spheres of the same volumes."},
    {.name = "steps", .meaning = "Time steps in a quarter period of the fastest contact."},
    {.name = "stiffness", .meaning = "Factor of every contact stiffness."},
    {.name = "still", .meaning = "Kinetic energy a particle below which all is still."},
    {.name = "stop-when-still", .meaning = "End phases early when still."},
    {.name = "tasks", .meaning = "Tasks of a job array."},
    {.name = "template", .meaning = "Print a scene to start from."},
    {"threads", 'j', "Threads to use.", 0, 0, NULL},
    {.name = "time", .meaning = "Simulated time, at most."},
    {.name = "to", .meaning = "Unit or DEM code that is written for."},
    {"tolerance", 't', "Errors that are kept to, as shares of the body's size.", 0, 0, NULL},
    {.name = "triangles", .meaning = "Triangles of the surface that spheres are fitted to."},
    {.name = "unchecked", .meaning = "Take a scan as it is."},
    {"unit", 'u', "Unit of length of the files.", 0, 0, NULL},
    {"verbose", 'v', "Show details, and at the end what it cost.", 0, 0, NULL},
    {.name = "view", .meaning = "What of a simulation goes into a .vtp file."},
    {.name = "volume-change", .meaning = "Most change of volume by a repair."},
    {.name = "vtp", .meaning = "Write a .vtp file."},
    {.name = "weight", .meaning = "Weight of the penalty in the criterion."},
    {.name = "weld", .meaning = "How far apart vertices are united."},
    {"width", 'w', "Inner diameter or side of a container.", 0, 0, NULL},
    {.name = "wire", .meaning = "Draw only edges."},
    {.name = "worker", .meaning = "Only work on the runs of a study."},
    {"young", 0, "Young's modulus of the particles.", 1e4, 1.3e12,
     "Pa is meant; diamond, the stiffest solid, has 1.2e12"},
    {"young-wall", 0, "Young's modulus of the walls.", 1e4, 1.3e12,
     "Pa is meant; diamond, the stiffest solid, has 1.2e12"},
    {"zingg", 'z', "Draw Zingg's plot.", 0, 0, NULL},
};
const size_t cli_meaning_count = sizeof cli_meanings / sizeof *cli_meanings;

/* Spellings that are refused: of one verb, or of all. */
static const struct {
  const char *verb, *old, *now;
} renamed[] = {
    {"choose", "distance", "errors"},
    {"choose", "e", "errors"},
    {"choose", "p", "paper"},
    {"choose", "r", "area"},
    {"choose", "reference", "area"},
    {"choose", "w", "weight"},
    {"curve", "from", "grid"},
    {"curve", "per-decade", "grid"},
    {"curve", "samples", "points"},
    {"curve", "to", "grid"},
    {"distance", "n", "points"},
    {"distance", "samples", "points"},
    {"drop", "c", "container"},
    {"drop", "number", "particles"},
    {"drop", "reduction", "rp"},
    {"drop", "samples", "rays"},
    {"drop", "steps-per-contact", "steps"},
    {"drop", "stiffness-factor", "stiffness"},
    {"drop", "t", "time"},
    {"export", "c", "centre"},
    {"export", "p", "principal"},
    {"export", "r", "reference"},
    {"export", "s", "count"},
    {"export", "spheres", "count"},
    {"export", "t", "to"},
    {"export", "w", "view"},
    {"pile", "n", "rays"},
    {"pile", "picture", "output"},
    {"pile", "samples", "rays"},
    {"pile", "w", "picture-width"},
    {"pile", "width", "picture-width"},
    {"render", "c", "columns"},
    {"render", "l", "rp"},
    {"render", "levels", "rp"},
    {"render", "n", "rays"},
    {"render", "samples", "rays"},
    {"render", "view", "from"},
    {"repose", "print-config", "print"},
    {"repose", "still-energy", "still"},
    {"repose", "vtp", "view"},
    {"run", "s", "set"},
    {"run", "samples", "rays"},
    {"simplify", "reduction", "rp"},
    {NULL, "a", "azimuth"},
    {NULL, "e", "elevation"},
    {NULL, "seed", "sample-seed"},
};

const cli_meaning *cli_find_meaning(const char *name) {
  for (size_t i = 0; i < cli_meaning_count; i++)
    if (!strcmp(cli_meanings[i].name, name)) return &cli_meanings[i];
  return NULL;
}

char cli_letter(const char *name) {
  const cli_meaning *meaning = cli_find_meaning(name);
  return meaning ? meaning->letter : 0;
}

/* ---- words that are none ---- */

bool cli_has_option(const cli_verb *verb, const char *name) {
  for (size_t i = 0; i < verb->option_count; i++)
    if (!strcmp(verb->options[i].name, name)) return true;
  return false;
}

static const char *new_name(const cli_verb *verb, const char *old) {
  for (size_t i = 0; i < sizeof renamed / sizeof *renamed; i++)
    if (!strcmp(renamed[i].old, old) && cli_has_option(verb, renamed[i].now) &&
        (!renamed[i].verb || !strcmp(renamed[i].verb, verb->name)))
      return renamed[i].now;
  return NULL;
}

/* Writes which of the names was meant, as "; did you mean '--NAME'?", or nothing. */
static void hint_nearest(const char *word, const char *const *names, size_t count,
                         const char *dashes, char *buffer, size_t size) {
  const char *nearest = strlen(word) < 2 ? NULL : scree_nearest_name(word, names, count);
  *buffer = 0;
  if (nearest) snprintf(buffer, size, "; did you mean '%s%s'?", dashes, nearest);
}

void cli_option_hint(const cli_verb *verb, const char *name, char *buffer, size_t size) {
  const char *now = new_name(verb, name), *names[CLI_MOST_OPTIONS];
  size_t count = 0;
  if (now) {
    snprintf(buffer, size, "; it is now '--%s'", now);
    return;
  }
  for (size_t i = 0; i < verb->option_count; i++) names[count++] = verb->options[i].name;
  for (size_t i = 0; i < cli_common_option_count; i++) names[count++] = cli_common_options[i].name;
  hint_nearest(name, names, count, "--", buffer, size);
}

void cli_word_hint(const char *words, const char *word, char *buffer, size_t size) {
  enum { BYTES = 512 };
  char copy[BYTES], *rest = copy;
  const char *names[CLI_MOST_OPTIONS];
  size_t count = 0;
  snprintf(copy, sizeof copy, "%s", words);
  while (rest && count < CLI_MOST_OPTIONS) {
    names[count++] = rest;
    rest = strchr(rest, '|');
    if (rest) *rest++ = 0;
  }
  hint_nearest(word, names, count, "", buffer, size);
}

void cli_verb_hint(const char *word, char *buffer, size_t size) {
  const char *names[CLI_MOST_OPTIONS];
  size_t count = 0;
  for (const cli_verb *const *verb = cli_verbs; *verb; verb++) names[count++] = (*verb)->name;
  hint_nearest(word, names, count, "", buffer, size);
}

/* "1e-5:1e-1:9" as three numbers. */
static bool split(const char *text, double numbers[3]) {
  for (int i = 0; i < 3; i++) {
    char part[32];
    size_t length = strcspn(text, ":");
    if (length == 0 || length >= sizeof part) return false;
    memcpy(part, text, length);
    part[length] = 0;
    text += length;
    if (*text != (i < 2 ? ':' : 0)) return false;
    text += i < 2;
    if (!(i < 2 ? cli_fraction_from_text : cli_real_from_text)(part, &numbers[i])) return false;
  }
  return true;
}

scree_status cli_parse_grid(const cli_verb *verb, const char *text, cli_grid *grid) {
  double n[3];
  if (!split(text, n) || !(n[0] >= 1e-12 && n[0] <= n[1] && n[1] <= 1) ||
      !(n[2] >= 1 && n[2] <= 1000) || n[2] != (double)(int)n[2])
    return cli_misuse(
        verb,
        "--grid '%s': must be MIN:MAX:N with 1e-12 <= MIN <= MAX <= 1 and a whole N from 1 to 1000",
        text);
  *grid = (cli_grid){n[0], n[1], (int)n[2]};
  return SCREE_OK;
}
