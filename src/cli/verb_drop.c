/* scree drop: the scene of a template, shapes poured into a container until they lie still. */
#include "base/platform.h"
#include "cli/output.h"
#include "cli/scene_run.h"
#include "cli/terminal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct drop_arguments {
  const char *output;
  cli_source source;
  double rp;
  size_t triangles, clump, seed, particles, rays;
  double width, depth, drop_height, speed;
  double time, still, frame_interval, checkpoint_interval;
  double young, young_wall, density, restitution, friction, friction_wall;
  double steps_per_contact, stiffness_factor;
  int container, law;
  bool no_repair, no_picture, overwrite, resume;
} drop_arguments;

enum { NAME_BYTES = 4096 };

typedef struct drop {
  const cli_call *call;
  const drop_arguments *arguments;
  scree_scene_file *file;
  scree_shape_store *store;
  cli_poured poured;
  char (*names)[NAME_BYTES]; /* words without their counts */
  double *counts;
  scree_error error;
} drop;

/* What is not asked for is as for particles of this size; of smaller ones heights shrink with the
 * size, speeds and times with its root: a fall by one's own size looks the same at every size. */
static const double usual_size = 0.01; /* m */
static const struct {
  double drop_height, speed, time, still, frame_interval, line_interval;
  double still_time; /* below the still energy before it counts */
} usual = {0.05, 1, 2, 1e-8, 0.02, 0.01, 0.05};

static const drop_arguments defaults = {.output = "drop",
                                        .source = CLI_SOURCE_DEFAULTS,
                                        .particles = 30,
                                        .seed = 1,
                                        .rays = 24,
                                        .drop_height = NAN,
                                        .speed = NAN,
                                        .time = NAN,
                                        .still = NAN,
                                        .frame_interval = NAN,
                                        .checkpoint_interval = 60,
                                        .young = 1e8,
                                        .young_wall = 1e11,
                                        .density = 2000,
                                        .restitution = 0.3,
                                        .friction = 0.5,
                                        .friction_wall = 0.5,
                                        .steps_per_contact = 20,
                                        .stiffness_factor = 1};

#define AT(field) offsetof(drop_arguments, field)
static const cli_option options[] = {
    {"output", CLI_TEXT, AT(output), "DIR",
     "The folder for bodies.pvd, frame-*.vtp, series.csv, scene.png and report.html, made if need "
     "be. "
     "Default: drop.",
     0, 0, NULL},
    {"container", CLI_CHOICE, AT(container), "KIND", "cylinder or box. Default: cylinder.", 0, 0,
     "cylinder|box"},
    {"width", CLI_LENGTH, AT(width), "LENGTH",
     "Diameter of the cylinder or side of the box, inside, as in 300mm. Default: about the height "
     "the heap will have, and room for three abreast.",
     1e-6, 1e6, NULL},
    {"depth", CLI_LENGTH, AT(depth), "LENGTH", "The box's other side. Default: the width.", 1e-6,
     1e6, NULL},
    {"particles", CLI_COUNT, AT(particles), "COUNT",
     "Particles of a shape without =COUNT. Default: 30.", 1, 10000000, NULL},
    {"count", CLI_COUNT, AT(triangles), "COUNT",
     "Decimate every shape to at most this many triangles. Default: shapes of more than 2000 are "
     "decimated to what `scree choose` chooses for them.",
     4, 4294967295.0, NULL},
    {"rp", CLI_SHARE, AT(rp), "RP",
     "Decimate every shape to this share of its triangles, as in 1e-3.", 1e-12, 1, NULL},
    {"clump", CLI_COUNT, AT(clump), "N",
     "Clumps of so many spheres in place of the scans' surfaces, with their mass and inertia.", 1,
     300, NULL},
    {"time", CLI_REAL, AT(time), "S",
     "Seconds simulated after the last layer entered, at most. Default: 2; less of particles under "
     "10 "
     "mm, as their falls are shorter.",
     0, 1e6, NULL},
    {"still", CLI_REAL, AT(still), "J",
     "End early when the mean kinetic energy of a particle stays below this; 0: never. Default: "
     "1e-8 J; less of particles under 10 mm.",
     0, 1e6, NULL},
    {"frames", CLI_REAL, AT(frame_interval), "S",
     "Simulated seconds between frames; 0 writes none. Default: 0.02; less of particles under 10 "
     "mm.",
     0, 1e6, NULL},
    {"checkpoint", CLI_REAL, AT(checkpoint_interval), "S",
     "Seconds of the clock between checkpoints. Default: 60.", 0.01, 1e6, NULL},
    {"resume", CLI_FLAG, AT(resume), NULL,
     "Go on from DIR/checkpoint.scree where there is one: with the same call, or with -o alone and "
     "the options that are not of the pour itself (time, still, frames, picture).",
     0, 0, NULL},
    {"drop-height", CLI_LENGTH, AT(drop_height), "LENGTH",
     "From the floor to the first layer. Later ones enter above what is there. Default: 50mm, or "
     "five "
     "times the largest particle where that is less.",
     0, 1e3, NULL},
    {"speed", CLI_REAL, AT(speed), "M/S",
     "Speed of entering, downwards. Default: 1 m/s; less of particles under 10 mm.", 0, 100, NULL},
    {"density", CLI_REAL, AT(density), "KG/M3", "Default: 2000 kg/m3.", 1e-6, 1e6, NULL},
    {"young", CLI_REAL, AT(young), "PA",
     "Young's modulus of the particles: stiffness of a contact over particle size. Default: 1e8.",
     1, 1e14, NULL},
    {"young-wall", CLI_REAL, AT(young_wall), "PA", "The walls'. Default: 1e11.", 1, 1e16, NULL},
    {"restitution", CLI_REAL, AT(restitution), "E", "From 0.01 to 1. Default: 0.3.", 0.01, 1, NULL},
    {"friction", CLI_REAL, AT(friction), "MU", "Between particles. Default: 0.5.", 0, 100, NULL},
    {"friction-wall", CLI_REAL, AT(friction_wall), "MU", "Against walls. Default: 0.5.", 0, 100,
     NULL},
    {"law", CLI_CHOICE, AT(law), "LAW",
     "linear (spring, dashpot, slider) or hysteretic (Walton and Braun). Default: linear.", 0, 0,
     "linear|hysteretic"},
    {"steps", CLI_REAL, AT(steps_per_contact), "N",
     "Time steps in a quarter period of the fastest contact. Default: 20; 40 for energies to 2 %.",
     15, 1e6, NULL},
    {"stiffness", CLI_REAL, AT(stiffness_factor), "X",
     "Multiplies all stiffnesses: 0.01 is 10 times faster, with 100 times the overlaps at rest. "
     "Default: 1.",
     1e-9, 1e9, NULL},
    {"seed", CLI_COUNT, AT(seed), "N", "Another seed, another pour. Default: 1.", 0,
     9007199254740992.0, NULL},
    {"unit", CLI_UNIT, AT(source.unit), "UNIT", "The files' unit of length. Default: mm.", 0, 0,
     NULL},
    CLI_SAMPLE_OPTIONS(drop_arguments, source),
    {"no-repair", CLI_FLAG, AT(no_repair), NULL,
     "Refuse files that cannot serve as they are, instead of repairing them.", 0, 0, NULL},
    {"no-picture", CLI_FLAG, AT(no_picture), NULL, "Do not render scene.png.", 0, 0, NULL},
    {"rays", CLI_COUNT, AT(rays), "N", "Rays a pixel of scene.png. Default: 24.", 1, 65536, NULL},
    {"force", CLI_FLAG, AT(overwrite), NULL,
     "Begin anew in a folder with an earlier drop, whose files go.", 0, 0, NULL},
};

/* ---- words ---- */

/* A shape by its name alone. */
static bool is_known(const char *name) {
  return cli_is_sample(name, NULL) || !strncmp(name, "sphere:", 7) || scree_path_exists(name);
}

/* "phone.stl=30": the name, and the count behind the last '='. A file may have a name like that. */
static int read_count(drop *d, size_t index) {
  const char *word = d->call->inputs[index], *equals = strrchr(word, '='),
             *digits = equals ? equals + 1 : "";
  char *name = d->names[index];
  bool counted = *digits && digits[strspn(digits, "0123456789")] == 0;
  size_t length = equals ? (size_t)(equals - word) : strlen(word);
  d->counts[index] = (double)d->arguments->particles;
  if (length == 0 || strlen(word) >= NAME_BYTES)
    return cli_misuse(d->call->verb, "'%.40s': not a name", word);
  snprintf(name, NAME_BYTES, "%.*s", (int)length, word);
  if (equals && !counted && (scree_path_exists(word) || !is_known(name))) {
    snprintf(name, NAME_BYTES, "%s", word);
    return 0;
  }
  if (!equals) return 0;
  double count = counted ? strtod(digits, NULL) : 0;
  if (!(count >= 1 && count <= 1e7))
    return cli_misuse(d->call->verb,
                      "%s: the count behind '=' must be a whole number from 1 to 10000000", word);
  d->counts[index] = count;
  return 0;
}

static int check_sphere(const drop *d, size_t index) {
  const char *name = d->names[index];
  double diameter;
  char *unit = NULL;
  if (strncmp(name, "sphere:", 7) != 0) return 0;
  bool has_unit = strtod(name + 7, &unit) > 0 && *unit;
  if (has_unit && cli_length_from_text(name + 7, &diameter) && diameter > 0) return 0;
  return cli_misuse(d->call->verb, "%s: not a sphere such as sphere:40mm", d->call->inputs[index]);
}

static int read_words(drop *d) {
  size_t count = d->call->input_count;
  d->names = calloc(count + 1, sizeof *d->names);
  d->counts = calloc(count + 1, sizeof *d->counts);
  const char **words = calloc(count + 1, sizeof *words);
  int code = 0;
  scree_status status = SCREE_OK;
  if (!d->names || !d->counts || !words) {
    free(words);
    cli_refuse(&d->error, SCREE_OUT_OF_MEMORY, "shapes", "out of memory");
    return cli_fail(&d->error);
  }
  for (size_t i = 0; code == 0 && i < count; i++) {
    code = read_count(d, i);
    if (code == 0) code = check_sphere(d, i);
    words[i] = d->names[i];
  }
  cli_poured made = {0};
  scree_error error = {0};
  if (code == 0 && count) status = cli_make_poured(words, d->counts, count, &made, &error);
  d->poured = made;
  d->error = error;
  free(words);
  return status == SCREE_OK ? code : cli_fail(&d->error);
}

/* ---- the scene ---- */

/* NaN: not asked for. */
static scree_status set(drop *d, const char *field, double value) {
  char text[40];
  if (isnan(value)) return SCREE_OK;
  snprintf(text, sizeof text, "%.17g", value);
  return scree_scene_file_set(d->file, field, text, &d->error);
}

static double given(double value, double usual_value) {
  return isnan(value) ? usual_value : value;
}

/* What is as usual hangs on the particles. */
static scree_status set_usual(drop *d) {
  const drop_arguments *a = d->arguments;
  double largest;
  scree_status status =
      scree_scene_file_largest(d->file, d->store, d->call->progress, &largest, &d->error);
  if (status != SCREE_OK) return status;
  double share = fmin(1, largest / usual_size), root = sqrt(share);
  const struct {
    const char *field;
    double value;
  } fields[] = {
      {"drop_height", given(a->drop_height, share * usual.drop_height)},
      {"speed", given(a->speed, root * usual.speed)},
      {"time", given(a->time, root * usual.time)},
      {"still", given(a->still, share * share * share * share * usual.still)}, /* mass x height */
      {"stop.rest", root * usual.still_time},
      {"output.frames", given(a->frame_interval, root * usual.frame_interval)},
      {"output.series", root * usual.line_interval},
  };
  for (size_t i = 0; status == SCREE_OK && i < sizeof fields / sizeof *fields; i++)
    status = set(d, fields[i].field, fields[i].value);
  return status;
}

static scree_status set_options(drop *d) {
  const drop_arguments *a = d->arguments;
  double count = 0;
  for (size_t i = 0; i < d->poured.count; i++) count += d->counts[i];
  const struct {
    const char *field;
    double value;
  } fields[] = {
      {"inlets.fill.count", count},
      {"seed", (double)a->seed},
      {"width", a->width > 0 ? a->width : (double)NAN},
      {"depth", a->depth > 0 ? a->depth : (double)NAN},
      {"density", a->density},
      {"young", a->young},
      {"young_wall", a->young_wall},
      {"restitution", a->restitution},
      {"friction", a->friction},
      {"friction_wall", a->friction_wall},
      {"contact.steps", a->steps_per_contact},
      {"contact.stiffness_factor", a->stiffness_factor},
      {"output.checkpoint", a->checkpoint_interval},
  };
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < sizeof fields / sizeof *fields; i++)
    status = set(d, fields[i].field, fields[i].value);
  if (status == SCREE_OK && a->law)
    status = scree_scene_file_set(d->file, "contact.law", "hysteretic", &d->error);
  return status;
}

static scree_status set_levels(drop *d) {
  const drop_arguments *a = d->arguments;
  const struct {
    const char *field;
    double value;
  } fields[] = {{"rp", a->rp}, {"triangles", (double)a->triangles}, {"clump", (double)a->clump}};
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < sizeof fields / sizeof *fields; i++) {
    char text[40];
    snprintf(text, sizeof text, "%.17g", fields[i].value);
    if (fields[i].value > 0)
      status = cli_set_scans(d->file, &d->poured, fields[i].field, text, &d->error);
  }
  return status;
}

static scree_status make_file(drop *d) {
  const drop_arguments *a = d->arguments;
  const char *name = a->container ? "drop-box" : "drop";
  scree_status status = scree_scene_file_template(name, &d->file, &d->error);
  if (status == SCREE_OK)
    status = cli_pour(d->file, &d->poured, &a->source, a->no_repair, &d->error);
  if (status == SCREE_OK) status = set_levels(d);
  if (status == SCREE_OK) status = set_options(d);
  if (status == SCREE_OK) status = set_usual(d);
  return status == SCREE_OK ? scree_scene_file_check(d->file, &d->error) : status;
}

/* Without shapes it is that of the checkpoint, with what may be asked of any. */
static scree_status take_file(drop *d) {
  const drop_arguments *a = d->arguments;
  char path[NAME_BYTES + 32];
  scree_scene *scene;
  snprintf(path, sizeof path, "%.4000s/checkpoint.scree", a->output);
  if (!scree_path_exists(path))
    return cli_refuse(&d->error, SCREE_IO, path, "no checkpoint to go on from");
  scree_status status = scree_scene_load(path, &scene, &d->error);
  if (status != SCREE_OK) return status;
  const char *text = scree_scene_text(scene);
  status = scree_scene_file_parse(text, strlen(text), path, &d->file, &d->error);
  scree_scene_free(scene);
  if (status == SCREE_OK) status = set(d, "time", a->time);
  if (status == SCREE_OK) status = set(d, "still", a->still);
  if (status == SCREE_OK) status = set(d, "output.frames", a->frame_interval);
  if (status == SCREE_OK && a->checkpoint_interval != defaults.checkpoint_interval)
    status = set(d, "output.checkpoint", a->checkpoint_interval);
  return status;
}

static scree_status simulate(drop *d) {
  const drop_arguments *a = d->arguments;
  cli_scene_run run = {.call = d->call,
                       .start = scree_work_started(),
                       .output = a->output,
                       .rays = a->rays,
                       .views = CLI_BODIES,
                       .resume = a->resume,
                       .overwrite = a->overwrite,
                       .no_picture = a->no_picture};
  scree_status status = cli_check_scene_output(&run, &d->error);
  if (status == SCREE_OK) status = scree_shape_store_create(&d->store, &d->error);
  if (status == SCREE_OK) status = d->poured.count ? make_file(d) : take_file(d);
  cli_terminal_end();
  if (status == SCREE_OK && a->overwrite && !a->resume)
    status = cli_clear_scene_output(d->call, a->output, &d->error);
  run.file = d->file;
  run.store = d->store;
  if (status == SCREE_OK) status = cli_run_scene(&run, &d->error);
  cli_scene_run_free(&run);
  return status;
}

/* ---- the call ---- */

/* What may be asked of a drop that goes on without its shapes. */
static const char *const of_any[] = {"output", "time",       "still", "frames", "checkpoint",
                                     "resume", "no-picture", "rays",  "force"};

/* An option, none of these, with another value than its default; NULL if none. */
static const char *shape_option(const drop_arguments *a) {
  for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
    const cli_option *o = &options[i];
    size_t size = o->kind == CLI_FLAG     ? sizeof(bool)
                  : o->kind == CLI_CHOICE ? sizeof(int)
                                          : sizeof(double);
    bool any = false;
    for (size_t k = 0; k < sizeof of_any / sizeof *of_any; k++)
      any = any || !strcmp(o->name, of_any[k]);
    if (!any && memcmp((const char *)a + o->offset, (const char *)&defaults + o->offset, size) != 0)
      return o->name;
  }
  return NULL;
}

static int check_call(const cli_call *call) {
  const drop_arguments *a = call->options;
  size_t shapes = call->input_count;
  if (a->rp > 0 && a->triangles) return cli_misuse(call->verb, "-r and -n exclude each other");
  if (a->source.noise > 0.25 * a->source.resolution)
    return cli_misuse(call->verb, "--noise %g mm: at most a quarter of the resolution, %g mm",
                      1e3 * a->source.noise, 0.25e3 * a->source.resolution);
  if (a->depth > 0 && shapes && !a->container)
    return cli_misuse(call->verb, "--depth does nothing without --container box");
  if (shapes == 0 && !a->resume)
    return cli_misuse(call->verb, "needs a SHAPE, or --resume with -o DIR");
  if (shapes == 0 && shape_option(a))
    return cli_misuse(call->verb, "--%s does nothing without a SHAPE", shape_option(a));
  return 0;
}

static int run(const cli_call *call) {
  drop d = {.call = call, .arguments = call->options};
  int code = check_call(call);
  if (code == 0) code = read_words(&d);
  if (code == 0 && simulate(&d) != SCREE_OK) code = cli_fail(&d.error);
  scree_scene_file_free(d.file);
  scree_shape_store_free(d.store);
  cli_poured_free(&d.poured);
  free(d.names);
  free(d.counts);
  return code;
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
        "report.html, "
        "which shows and plays it, made of result.json and motion.scree; scene.yaml; bodies.pvd "
        "with frame-*.vtp (surfaces; body, shape and speeds by triangle) for ParaView; series.csv "
        "with energies, contacts and overlaps over time; scene.png. The same options give the "
        "same bits for any number of threads. Ctrl-C stops: what was written stays, the report "
        "shows it, and --resume goes on from checkpoint.scree with the same bits, as after a "
        "crash. A drop that leaves the range of the contact law stops with step, body and cause, "
        "and leaves the state shortly before in stopped.scree.",
    .examples =
        "scree drop phone.stl=50\n"
        "scree drop sample:fp-1=20 sample:dc-2=20 -n 100 --container box --width 300mm -o mixed\n"
        "scree drop sphere:40mm=200 --frames 0.01 --seed 2\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .defaults = &defaults,
    .options_size = sizeof defaults,
    .input_minimum = 0,
    .input_maximum = SCREE_MOST_SHAPES,
    .partners = CLI_SAMPLE_PARTNERS,
    .run = run,
};
