/* scree drop: pour shapes into a container, watch them come to rest. */
#include "base/platform.h"
#include "cli/drop.h"
#include "cli/output.h"
#include "cli/terminal.h"
#include "report/provenance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
     "The folder for drop.pvd, frame-*.vtp, series.csv, drop.png and report.html, made if need be. "
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
    {"no-picture", CLI_FLAG, AT(no_picture), NULL, "Do not render drop.png.", 0, 0, NULL},
    {"rays", CLI_COUNT, AT(rays), "N", "Rays a pixel of drop.png. Default: 24.", 1, 65536, NULL},
    {"force", CLI_FLAG, AT(overwrite), NULL,
     "Begin anew in a folder with an earlier drop, whose files go.", 0, 0, NULL},
};

/* The diameter of the largest particle: of the shapes, or of the pour that goes on. */
static double largest_size(const drop_run *run) {
  double largest = 0;
  size_t count = run->pour ? scree_pour_shape_count(run->pour) : run->shape_count;
  for (size_t i = 0; i < count; i++) {
    scree_particle_measures m;
    scree_particle_measure(
        run->pour ? scree_pour_get_shape(run->pour, i).particle : run->shapes[i].particle, &m);
    largest = fmax(largest, 2 * m.bounding_radius);
  }
  return largest;
}

static void take(double *value, double usual_value) {
  if (isnan(*value)) *value = usual_value;
}

static void settle(drop_run *run) {
  drop_arguments *a = &run->settled;
  double share = fmin(1, largest_size(run) / usual_size), root = sqrt(share);
  take(&a->drop_height, share * usual.drop_height);
  take(&a->speed, root * usual.speed);
  take(&a->time, root * usual.time);
  take(&a->still, share * share * share * share * usual.still); /* mass times height */
  take(&a->frame_interval, root * usual.frame_interval);
  run->schedule = (scree_pour_schedule){.time = a->time,
                                        .still = a->still,
                                        .rest = root * usual.still_time,
                                        .frames = a->frame_interval,
                                        .series = root * usual.line_interval,
                                        .checkpoint = a->checkpoint_interval};
}

static scree_pour_options pour_options(const drop_arguments *a) {
  scree_pour_options o = scree_default_pour_options();
  o.world.law = (scree_law)a->law;
  o.world.steps_per_contact = a->steps_per_contact;
  o.world.stiffness_factor = a->stiffness_factor;
  o.particles = (scree_material){.stiffness = a->young,
                                 .density = a->density,
                                 .restitution = a->restitution,
                                 .friction = a->friction};
  o.walls = o.particles;
  o.walls.stiffness = a->young_wall;
  o.walls.friction = a->friction_wall;
  o.container = (scree_container)a->container;
  o.width = a->width;
  o.depth = a->depth;
  o.drop_height = a->drop_height;
  o.entry_speed = a->speed;
  o.seed = a->seed;
  return o;
}

static void say_pour(const drop_run *run, scree_pour *pour) {
  scree_pour_options o;
  if (run->call->quiet) return;
  size_t count = scree_pour_particle_count(pour);
  scree_pour_get_options(pour, &o);
  if (o.container == SCREE_CONTAINER_BOX)
    printf("%zu particle%s into a box of %.4g x %.4g mm\n", count, cli_plural(count), 1e3 * o.width,
           1e3 * o.depth);
  else
    printf("%zu particle%s into a cylinder of %.4g mm\n", count, cli_plural(count), 1e3 * o.width);
  printf("time step %.4g us, %g steps per quarter period of the fastest contact\n",
         1e6 * scree_world_time_step(scree_pour_world(pour), NULL), o.world.steps_per_contact);
  cli_flush();
}

/* ---- the run ---- */

/* Draws the progress; false after Ctrl-C. */
static bool watch(void *context, const scree_pour *pour, double fraction) {
  drop_run *run = context;
  const scree_progress *p = run->call->progress;
  if (scree_now() - run->shown < p->interval) return !cli_interrupted();
  run->shown = scree_now();
  bool all = scree_pour_entered_count(pour) == scree_pour_particle_count(pour);
  return p->report(p->context, all ? "settling, at most" : "pouring", fraction);
}

static scree_status on_begin(void *context, scree_pour *pour, bool resumed, scree_error *error) {
  drop_run *run = context;
  say_pour(run, pour);
  if (!resumed) return SCREE_OK;
  return cli_frames_recall(&run->frames, run->schedule.frames, scree_pour_view(pour), error);
}

static scree_status on_frame(void *context, scree_pour *pour, scree_error *error) {
  return drop_write_frame(context, pour, error);
}

static scree_status simulate(drop_run *run, scree_error *error) {
  scree_pour_options o = pour_options(run->arguments);
  scree_pour_shape *shapes = calloc(run->shape_count + 1, sizeof *shapes);
  if (!shapes) return drop_no_memory(error);
  for (size_t i = 0; i < run->shape_count; i++)
    shapes[i] = (scree_pour_shape){run->shapes[i].particle, run->shapes[i].count,
                                   run->shapes[i].title, run->shapes[i].source};
  const scree_pour_job job = {.shapes = shapes,
                              .shape_count = run->shape_count,
                              .options = &o,
                              .schedule = run->schedule,
                              .folder = run->arguments->output,
                              .resume = run->arguments->resume,
                              .overwrite = run->arguments->overwrite,
                              .watch = watch,
                              .begun = on_begin,
                              .frame = on_frame,
                              .context = run};
  scree_status status = scree_pour_complete(&job, &run->pour, error);
  free(shapes);
  return status;
}

static bool is_still(const drop_run *run) {
  const char *end = scree_scene_end(scree_pour_scene(run->pour));
  return end && !strcmp(end, "still");
}

static void print_summary(FILE *stream, const drop_run *run, bool still) {
  scree_observation o;
  const scree_world *world = scree_pour_view(run->pour);
  double entered = scree_pour_entered_energy(run->pour);
  unsigned long long steps = scree_world_step_count(world);
  scree_world_observe(world, &o);
  double sum = drop_energy(&o);
  size_t count = scree_pour_particle_count(run->pour);
  fprintf(stream, "%s after %.4g s, %llu step%s; %zu of %zu particle%s %s in\n",
          still ? "still" : "stopped", o.time, steps, cli_plural(steps),
          scree_pour_entered_count(run->pour), count, cli_plural(count), count == 1 ? "is" : "are");
  fprintf(stream, "contacts          %zu in %zu touching pair%s, %.3g neighbours a particle\n",
          o.contact_count, o.pair_count, cli_plural(o.pair_count), o.coordination);
  fprintf(stream, "largest overlap   %.4g um\n", 1e6 * o.largest_overlap);
  fprintf(stream, "highest speed     %.3g m/s\n", o.highest_speed);
  fprintf(stream,
          "energy            %.5g J came in; kinetic %.3g, potential %.5g, elastic %.3g, lost to "
          "dashpots %.5g, to friction %.5g; unaccounted %.2g of what came in\n",
          entered, o.kinetic + o.rotational, o.potential, o.elastic, o.dissipated_dashpot + 0.0,
          o.dissipated_friction + 0.0, entered > 0 ? (sum - entered) / entered : 0);
}

static void print_costs(const drop_run *run, double seconds) {
  const scree_world *world = scree_pour_view(run->pour);
  double steps = (double)scree_world_step_count(world);
  if (run->call->quiet) return;
  fprintf(stderr, "%.1f s of computing: %.3g steps/s, %.3g particle-steps/s\n", seconds,
          steps / seconds, steps * (double)scree_pour_entered_count(run->pour) / seconds);
  if (run->arguments->stiffness_factor != 1)
    fprintf(stderr, "stiffness times %g: overlaps are larger by its inverse\n",
            run->arguments->stiffness_factor);
}

/* Prints how the pour stands at its end and leaves it in the folder. stopped: NULL, or why it did
 * not come to its end. */
static scree_status tell(drop_run *run, const char *stopped, double seconds, scree_error *error) {
  char *text = NULL;
  size_t size;
  FILE *stream = scree_memory_open(&text, &size);
  if (stream) print_summary(stream, run, is_still(run));
  if (!stream || !scree_memory_close(stream)) {
    free(text);
    return drop_no_memory(error);
  }
  cli_terminal_end();
  fputs(text, stdout);
  cli_flush();
  print_costs(run, seconds);
  scree_status status = drop_write_report(run, stopped, text, error);
  free(text);
  return status;
}

static scree_status draw(drop_run *run, scree_error *error) {
  if (run->arguments->no_picture) return SCREE_OK;
  scree_status status = drop_write_picture(run, error);
  if (status != SCREE_UNSUPPORTED) return status;
  fprintf(stderr, "no picture: %s\n", error->message);
  return SCREE_OK;
}

/* What is as usual hangs on the particles. */
static scree_status settle_by_particles(drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = SCREE_OK;
  if (run->shape_count) {
    status = drop_make_particles(run, error);
  } else {
    status = drop_path(run, "checkpoint.scree", path, error);
    if (status == SCREE_OK && !scree_path_exists(path))
      return cli_refuse(error, SCREE_IO, path, "no checkpoint to go on from");
    if (status == SCREE_OK) status = scree_pour_load(path, &run->pour, error);
  }
  if (status == SCREE_OK) settle(run);
  scree_pour_free(run->pour);
  run->pour = NULL;
  return status;
}

static scree_status pour(drop_run *run, scree_error *error) {
  scree_status status = drop_check_output(run, error);
  if (status == SCREE_OK) status = settle_by_particles(run, error);
  if (status == SCREE_OK && run->arguments->overwrite && !run->arguments->resume)
    status = drop_clear_output(run, error);
  if (status != SCREE_OK) return status;
  double start = scree_now();
  status = simulate(run, error);
  double seconds = scree_now() - start;
  if (!run->pour) return status;
  scree_error later; /* what happened first is what is told */
  scree_status listed = drop_list_frames(run, status == SCREE_OK ? error : &later);
  if (status == SCREE_OK) status = listed;
  if (status == SCREE_OK) status = draw(run, error);
  scree_status told = tell(run, status == SCREE_OK ? NULL : error->message, seconds,
                           status == SCREE_OK ? error : &later);
  return status != SCREE_OK ? status : told;
}

/* What may be asked of a pour that goes on without its shapes. */
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

static int run(const cli_call *call) {
  drop_run run = {.call = call,
                  .settled = *(const drop_arguments *)call->options,
                  .shape_count = call->input_count,
                  .start = scree_work_started()};
  run.arguments = &run.settled;
  if (run.arguments->rp > 0 && run.arguments->triangles)
    return cli_misuse(call->verb, "-r and -n exclude each other");
  if (run.arguments->source.noise > 0.25 * run.arguments->source.resolution)
    return cli_misuse(call->verb, "--noise %g mm: at most a quarter of the resolution, %g mm",
                      1e3 * run.arguments->source.noise, 0.25e3 * run.arguments->source.resolution);
  if (run.arguments->depth > 0 && run.shape_count &&
      run.arguments->container != SCREE_CONTAINER_BOX)
    return cli_misuse(call->verb, "--depth does nothing without --container box");
  if (run.shape_count == 0 && !run.arguments->resume)
    return cli_misuse(call->verb, "needs a SHAPE, or --resume with -o DIR");
  if (run.shape_count == 0 && shape_option(run.arguments))
    return cli_misuse(call->verb, "--%s does nothing without a SHAPE", shape_option(run.arguments));
  scree_error error = {SCREE_OUT_OF_MEMORY, "out of memory"};
  run.shapes = calloc(run.shape_count + 1, sizeof *run.shapes);
  if (!run.shapes) return cli_fail(&error);
  int code = drop_read_words(&run);
  if (code == 0 && pour(&run, &error) != SCREE_OK) code = cli_fail(&error);
  scree_pour_free(run.pour);
  for (size_t i = 0; i < run.shape_count; i++) scree_particle_free(run.shapes[i].particle);
  free(run.shapes);
  free(run.frames.times);
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
        "Writes into DIR: report.html, which shows and plays the pour, made of drop.json, "
        "motion.scree and last.world (a checkpoint: scree export takes it); drop.pvd with "
        "frame-*.vtp (surfaces; body, shape and speeds by triangle) for ParaView; series.csv with "
        "energies, contacts and overlaps over time; drop.png. The same options give the same bits "
        "for any number of threads. Ctrl-C stops: what was written stays, drop.pvd lists it, the "
        "report shows it, and --resume goes on from checkpoint.scree with the same bits, as after "
        "a crash. A pour that leaves the range of the contact law stops with step, body and "
        "cause, and leaves the state shortly before in stopped.scree.",
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
