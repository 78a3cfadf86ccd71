/* One call: its words as shapes, the file of its template with what options set, its levels, and a
 * run at each. */
#include "cli/pour.h"
#include "base/owned.h"
#include "base/path.h"
#include "base/platform.h"
#include "cli/output.h"
#include "cli/terminal.h"

#include <stdlib.h>
#include <string.h>

/* ---- what is poured ---- */

/* Words of the command line as what is poured: FILE, sample:NAME, sphere:LENGTH, NAME.csv, each in
 * its share. */
typedef struct poured_words {
  scree_poured *shapes;
  char (*texts)[4300]; /* name and value of each */
  size_t count;
} poured_words;

/* A name as scenes have them: without points, and not twice. */
static void name_shape(const char *word, const poured_words *p, size_t index) {
  char *name = p->texts[index];
  cli_distinct_name(word, p->texts[0], sizeof *p->texts, index, 60);
  for (char *c = name; *c; c++)
    if (*c == '.' || *c == '*' || (unsigned char)*c < ' ' || *c == 127) *c = '_';
}

/* The kind of a word; its value, in the scene's terms, into `value`. */
static const char *kind_of(const char *word, char *value, size_t size) {
  static const char sphere[] = "sphere:";
  const char *sample;
  snprintf(value, size, "%s", word);
  if (cli_is_sample(word, &sample)) {
    snprintf(value, size, "%s", sample);
    return "sample";
  }
  if (!strncmp(word, sphere, sizeof sphere - 1)) {
    double diameter = 0;
    if (cli_length_from_text(word + sizeof sphere - 1, &diameter))
      snprintf(value, size, "%.17g", diameter);
    return "sphere";
  }
  return scree_is_clump_table(word) ? "clump" : "file";
}

static scree_status make_poured(const char *const *words, const double *shares, size_t count,
                                poured_words *p, scree_error *error) {
  p->count = count;
  SCREE_TRY_ALLOC_ZERO(p->shapes, count, error);
  SCREE_TRY_ALLOC_ZERO(p->texts, count, error);
  for (size_t i = 0; i < count; i++) {
    char *value = p->texts[i] + 100;
    name_shape(words[i], p, i);
    const char *kind = kind_of(words[i], value, sizeof *p->texts - 100);
    p->shapes[i] = (scree_poured){p->texts[i], kind, value, shares ? shares[i] : 1};
  }
  return SCREE_OK;
}

static void free_poured(poured_words *p) {
  scree_free(p->shapes);
  scree_free(p->texts);
  *p = (poured_words){0};
}

static scree_status set_shape(scree_scene_file *file, const scree_poured *shape, const char *field,
                              const char *value, scree_error *error) {
  char path[200];
  snprintf(path, sizeof path, "shapes.%s.%s", shape->name, field);
  return scree_scene_file_set(file, path, value, error);
}

static scree_status set_length(scree_scene_file *file, const scree_poured *shape, const char *field,
                               double value, double usual, scree_error *error) {
  char text[40];
  snprintf(text, sizeof text, "%.17g", value);
  return value == usual ? SCREE_OK : set_shape(file, shape, field, text, error);
}

static bool is_scan(const scree_poured *shape) {
  return !strcmp(shape->kind, "file") || !strcmp(shape->kind, "sample");
}

static scree_status pour_shapes(scree_scene_file *file, const poured_words *p,
                                const cli_source *source, bool no_repair, scree_error *error) {
  const cli_source usual = CLI_SOURCE_DEFAULTS;
  cli_input_options input = cli_source_options(source);
  SCREE_TRY(scree_scene_file_pour(file, p->shapes, p->count, error));
  for (size_t i = 0; i < p->count; i++) {
    const scree_poured *s = &p->shapes[i];
    bool sample = !strcmp(s->kind, "sample"), read = is_scan(s) || !strcmp(s->kind, "clump");
    if (read && !sample && input.read.ignore_comment_unit)
      SCREE_TRY(set_shape(file, s, "unit", cli_unit_name(source->unit), error));
    if (sample)
      SCREE_TRY(set_length(file, s, "resolution", source->resolution, usual.resolution, error));
    if (sample) SCREE_TRY(set_length(file, s, "noise", source->noise, -1, error));
    if (sample) SCREE_TRY(set_length(file, s, "sample_seed", (double)source->seed, 1, error));
    if (no_repair && !strcmp(s->kind, "file"))
      SCREE_TRY(set_shape(file, s, "repair", "false", error));
  }
  return SCREE_OK;
}

/* Sets a field of all shapes that are made from scans. */
static scree_status set_scans(scree_scene_file *file, const poured_words *p, const char *field,
                              const char *value, scree_error *error) {
  for (size_t i = 0; i < p->count; i++)
    if (is_scan(&p->shapes[i])) SCREE_TRY(set_shape(file, &p->shapes[i], field, value, error));
  return SCREE_OK;
}

/* ---- the call ---- */

/* What came of one level. */
typedef struct level_result {
  scree_pile pile;
  bool is_pile;
  double triangles, coordination, seconds;
} level_result;

enum { MOST_LEVELS = 40, LEVEL_BYTES = 40, NAME_BYTES = 4096 };

typedef struct cli_pour {
  const cli_call *call;
  const cli_pour_arguments *arguments;
  const char *template_name;
  bool states; /* frames can be measured again */
  scree_work_start start;
  scree_scene_file *file;
  scree_shape_store *store;
  poured_words poured;
  double particles;                          /* by the words' counts; 0: they have none */
  char levels[MOST_LEVELS + 1][LEVEL_BYTES]; /* "": as given */
  char names[MOST_LEVELS + 1][LEVEL_BYTES];  /* of folders and in tables */
  size_t level_count;
  level_result results[MOST_LEVELS + 1];
  scree_error *error;
} cli_pour;

static void free_pour(cli_pour *r) {
  scree_shape_store_free(r->store);
  free_poured(&r->poured);
  scree_scene_file_free(r->file);
}

/* ---- words ---- */

/* A shape by its name alone. */
static bool is_known(const char *name) {
  return cli_is_sample(name, NULL) || !strncmp(name, "sphere:", 7) || scree_path_exists(name);
}

/* "phone.stl=30": the name, and the count behind the last '='. A file may have a name like that. */
static scree_status read_count(const cli_pour *r, const char *word, char *name, double *count) {
  const char *equals = strrchr(word, '='), *digits = equals ? equals + 1 : "";
  bool counted = *digits && digits[strspn(digits, "0123456789")] == 0;
  size_t length = equals ? (size_t)(equals - word) : strlen(word);
  *count = (double)r->arguments->each;
  if (length == 0 || strlen(word) >= NAME_BYTES)
    return cli_misuse(r->call->verb, "'%.40s': not a name", word);
  snprintf(name, NAME_BYTES, "%.*s", (int)length, word);
  if (equals && !counted && (scree_path_exists(word) || !is_known(name))) {
    snprintf(name, NAME_BYTES, "%s", word);
    return SCREE_OK;
  }
  if (!equals) return SCREE_OK;
  *count = counted ? strtod(digits, NULL) : 0;
  if (*count >= 1 && *count <= 1e7) return SCREE_OK;
  return cli_misuse(r->call->verb,
                    "%s: the count behind '=' must be a whole number from 1 to 10000000", word);
}

static scree_status check_sphere(const cli_pour *r, const char *word, const char *name) {
  double diameter;
  char *unit = NULL;
  if (strncmp(name, "sphere:", 7) != 0) return SCREE_OK;
  bool has_unit = strtod(name + 7, &unit) > 0 && *unit;
  if (has_unit && cli_length_from_text(name + 7, &diameter) && diameter > 0) return SCREE_OK;
  return cli_misuse(r->call->verb, "%s: not a sphere such as sphere:40mm", word);
}

/* Words without their counts into names; all have one, or none has. */
static scree_status read_words(cli_pour *r, const char **words, size_t word_count,
                               char (*names)[NAME_BYTES], double *counts) {
  size_t counted = 0;
  for (size_t i = 0; i < word_count; i++) {
    SCREE_TRY(read_count(r, words[i], names[i], &counts[i]));
    SCREE_TRY(check_sphere(r, words[i], names[i]));
    words[i] = names[i];
    counted += counts[i] > 0;
    r->particles += counts[i];
  }
  if (counted > 0 && counted < word_count)
    return cli_misuse(r->call->verb, "%zu of %zu shapes have =COUNT: all need one, or none",
                      counted, word_count);
  return make_poured(words, counted ? counts : NULL, word_count, &r->poured, r->error);
}

/* Those of --samples, then those of the call. */
static scree_status take_words(cli_pour *r) {
  typedef char word_name[NAME_BYTES];
  size_t samples = r->arguments->samples ? SCREE_SAMPLE_DEVICES : 0,
         count = samples + r->call->input_count;
  char sample_words[SCREE_SAMPLE_DEVICES][32];
  SCREE_SCRATCH(const char *, words, count, r->error);
  SCREE_SCRATCH(double, counts, count, r->error);
  SCREE_SCRATCH(word_name, names, count, r->error);
  for (size_t i = 0; i < count; i++) {
    if (i < samples)
      snprintf(sample_words[i], sizeof *sample_words, "sample:%s", scree_sample_name(i));
    words[i] = i < samples ? sample_words[i] : r->call->inputs[i - samples];
  }
  return count ? read_words(r, words, count, names, counts) : SCREE_OK;
}

/* ---- levels ---- */

/* For folders and tables. */
static void name_level(cli_pour *r, size_t index) {
  const char *level = r->levels[index];
  char *name = r->names[index];
  double value;
  if (!*level)
    snprintf(name, LEVEL_BYTES, "as-given");
  else if (cli_real_from_text(level, &value))
    snprintf(name, LEVEL_BYTES, "rp-%g", value);
  else
    snprintf(name, LEVEL_BYTES, "%s", level);
  for (char *c = name; *c; c++)
    if (*c == ':') *c = '-';
}

/* A word of --rp as a level of shapes; false where it is none, or there already. */
static bool add_level(cli_pour *r, const char *word) {
  double value;
  char *level = r->levels[r->level_count];
  snprintf(level, LEVEL_BYTES, "%s", word);
  if (cli_fraction_from_text(word, &value)) snprintf(level, LEVEL_BYTES, "%.17g", value);
  bool good = !strcmp(level, "recommended") || !strncmp(level, "clump:", 6) ||
              cli_real_from_text(level, &value);
  for (size_t i = 0; i < r->level_count; i++) good = good && strcmp(r->levels[i], level) != 0;
  if (!good || scree_shape_level_error(level)) return false;
  r->level_count++;
  return true;
}

static bool parse_levels(cli_pour *r, const char *text) {
  while (*text) {
    char word[LEVEL_BYTES];
    size_t length = strcspn(text, ",");
    if (length == 0 || length >= sizeof word || r->level_count == MOST_LEVELS) return false;
    snprintf(word, sizeof word, "%.*s", (int)length, text);
    if (!add_level(r, word)) return false;
    text += length;
    if (*text == ',' && !*++text) return false;
  }
  return r->level_count > 0;
}

/* Whether runs of several levels have folders called so. */
static bool is_level_name(const char *name) {
  double rp;
  return !strcmp(name, "spheres") || !strcmp(name, "recommended") ||
         (!strncmp(name, "rp-", 3) && cli_real_from_text(name + 3, &rp)) ||
         (!strncmp(name, "clump-", 6) && cli_real_from_text(name + 6, &rp));
}

static scree_status take_levels(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  if (a->rp && !parse_levels(r, a->rp))
    return cli_misuse(r->call->verb,
                      "--rp %s: must be up to %d different numbers in (0, 1], recommended, or "
                      "clumps of 1 to 300 spheres, as 1e-4,recommended,clump:20",
                      a->rp, MOST_LEVELS);
  if (a->spheres) snprintf(r->levels[r->level_count++], LEVEL_BYTES, "spheres");
  if (r->level_count == 0) r->level_count = 1;
  for (size_t i = 0; i < r->level_count; i++) name_level(r, i);
  return SCREE_OK;
}

/* ---- the scene ---- */

/* That of the checkpoint which a call without shapes goes on from. */
static scree_status read_checkpoint(cli_pour *r, const char *path) {
  SCREE_OWNED(scree_scene, scene);
  if (!scree_path_exists(path))
    return cli_refuse(r->error, SCREE_IO, path, "no checkpoint to go on from");
  SCREE_TRY(scree_scene_load(path, &scene, r->error));
  const char *text = scree_scene_text(scene);
  return scree_scene_file_parse(text, strlen(text), path, &r->file, r->error);
}

static scree_status read_base(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  const char *preset = a->preset,
             *usual = ((const cli_pour_arguments *)r->call->verb->defaults)->preset;
  if (!r->poured.count && a->scene.resume && !a->config && preset == usual)
    return read_checkpoint(r, SCREE_PATH_IN(a->scene.output, "checkpoint.scree"));
  if (a->config)
    return scree_scene_file_read_over(a->config, r->template_name, preset, &r->file, r->error);
  SCREE_TRY(scree_scene_file_template(r->template_name, &r->file, r->error));
  if (preset && scree_scene_file_set(r->file, "preset", preset, r->error) != SCREE_OK)
    return cli_misuse(r->call->verb, "--preset: %s", r->error->message);
  return SCREE_OK;
}

static scree_status set_number(cli_pour *r, const char *field, double value, bool scans) {
  char text[CLI_NUMBER_BYTES];
  snprintf(text, sizeof text, "%.17g", value);
  if (value == 0) return SCREE_OK;
  return scans ? set_scans(r->file, &r->poured, field, text, r->error)
               : scree_scene_file_set(r->file, field, text, r->error);
}

static scree_status pour_words(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  if (!r->poured.count) return SCREE_OK;
  SCREE_TRY(pour_shapes(r->file, &r->poured, &a->source, a->no_repair, r->error));
  if (a->method == SCREE_METHOD_QECD)
    SCREE_TRY(set_scans(r->file, &r->poured, "method", "qecd", r->error));
  SCREE_TRY(set_number(r, "triangles", (double)a->triangles, true));
  SCREE_TRY(set_number(r, "clump", (double)a->clump, true));
  return set_number(r, "particles", r->particles, false);
}

/* The scene of a level; of clumps in tables only spheres are another. */
static scree_status set_level(cli_pour *r, size_t index) {
  const char *level = r->levels[index];
  if (!*level || !r->poured.count) return SCREE_OK;
  SCREE_TRY(set_scans(r->file, &r->poured, "rp", level, r->error));
  for (size_t i = 0; i < r->poured.count; i++) {
    char field[200];
    if (strcmp(r->poured.shapes[i].kind, "clump") != 0) continue;
    snprintf(field, sizeof field, "shapes.%s.rp", r->poured.shapes[i].name);
    SCREE_TRY(
        scree_scene_file_set(r->file, field, strcmp(level, "spheres") ? "scan" : level, r->error));
  }
  return SCREE_OK;
}

/* ---- one level ---- */

static unsigned views_of(int view) {
  enum { NONE, ALL = CLI_FRAME_KINDS + 1 };
  if (view == CLI_VIEW_UNSET) return CLI_BODIES;
  if (view == NONE) return 0;
  return view == ALL ? CLI_BODIES | CLI_POINTS | CLI_CONTACTS | CLI_GEOMETRY : 1u << (view - 1);
}

static cli_scene_run run_of(cli_pour *r, size_t level, char folder[NAME_BYTES]) {
  const cli_scene_options *o = &r->arguments->scene;
  bool several = r->level_count > 1;
  const char *name = r->names[level];
  snprintf(folder, NAME_BYTES, "%.4000s%s%s", o->output ? o->output : "", several ? "/" : "",
           several ? name : "");
  return (cli_scene_run){.call = r->call,
                         .options = o,
                         .start = r->start,
                         .file = r->file,
                         .output = o->output ? folder : NULL,
                         .store = r->store,
                         .views = views_of(r->arguments->view),
                         .states = r->states,
                         .brief = true,
                         .common_page = several,
                         .name = several ? name : NULL};
}

/* Refuses what a run that begins would refuse, before anything is written. */
static scree_status check_level(cli_pour *r, size_t level) {
  char folder[NAME_BYTES];
  const cli_scene_run run = run_of(r, level, folder);
  SCREE_OWNED(scree_scene, scene);
  if (run.options->resume && run.output &&
      scree_path_exists(SCREE_PATH_IN(folder, "checkpoint.scree")))
    return SCREE_OK;
  SCREE_TRY(set_level(r, level));
  return scree_scene_create_from(r->file, r->store, r->call->progress, &scene, r->error);
}

static double mean_triangles(const scree_scene *scene) {
  double sum = 0;
  size_t count = 0;
  for (; scree_scene_shape_name(scene, count); count++) {
    scree_particle_measures m;
    scree_particle_measure(scree_scene_shape_particle(scene, count), &m);
    sum += (double)m.triangle_count;
  }
  return sum / (double)count;
}

static scree_status run_level(cli_pour *r, size_t level) {
  char folder[NAME_BYTES], shown[2][CLI_PRINTABLE_BYTES];
  SCREE_CLEANUP(cli_scene_run_free) cli_scene_run run = run_of(r, level, folder);
  level_result *result = &r->results[level];
  scree_observation o;
  SCREE_TRY(set_level(r, level));
  SCREE_TRY(cli_run_scene(&run, r->error));
  if (r->level_count > 1) {
    scree_world_observe(scree_scene_view(run.scene), &o);
    result->coordination = o.coordination;
    result->seconds = scree_scene_get_costs(run.scene).wall_seconds;
    result->triangles = mean_triangles(run.scene);
    result->is_pile = scree_scene_pile_name(run.scene, 0) != NULL;
    if (result->is_pile)
      SCREE_TRY(scree_scene_measure_pile(run.scene, 0, NULL, &result->pile, r->error));
  }
  if (!run.options->json && run.output)
    printf("  look at           %s/report.html; result.json and series.csv lie in %s\n",
           cli_printable(run.options->output, shown[0]), cli_printable(folder, shown[1]));
  cli_flush();
  return SCREE_OK;
}

/* ---- all levels ---- */

static void print_table(const cli_pour *r) {
  bool piles = r->results[0].is_pile;
  printf("\n%-12s %10s", "run", "triangles");
  if (piles) printf(" %8s %8s %8s %8s", "sectors", "cone", "outline", "height");
  printf(" %8s %8s\n", "neighb.", "time");
  for (size_t level = 0; level < r->level_count; level++) {
    const level_result *result = &r->results[level];
    const scree_repose *h = &result->pile.repose;
    printf("%-12s %10.0f", r->names[level], result->triangles);
    if (piles && h->heap)
      printf(" %4.1f deg %4.1f deg %4.1f deg", h->sector_deg, h->cone_deg, h->silhouette_deg);
    else if (piles)
      printf(" %26s", "no heap");
    if (piles) printf(" %5.0f mm", 1e3 * h->height);
    printf(" %8.2f %6.0f s\n", result->coordination, result->seconds);
  }
}

/* What an earlier call left, of one level or of several: a page of the folder would show it. */
static scree_status clear_folders(cli_pour *r) {
  const char *output = r->arguments->scene.output;
  SCREE_TRY(cli_clear_scene_output(r->call, output, r->error));
  SCREE_CLEANUP(scree_folder_close_at) scree_folder *entries = scree_folder_open(output);
  for (const char *name; entries && (name = scree_folder_next(entries));) {
    scree_path_info info;
    const char *path = SCREE_PATH_IN(output, name);
    if (is_level_name(name) && scree_path_look(path, &info) && info.kind == SCREE_PATH_FOLDER)
      SCREE_TRY(cli_clear_scene_output(r->call, path, r->error));
  }
  return SCREE_OK;
}

/* Whether the folders can be written to, before scans are read and decimated. */
static scree_status check_folders(cli_pour *r) {
  const cli_scene_options *o = &r->arguments->scene;
  char folder[NAME_BYTES];
  for (size_t i = 0; i < r->level_count; i++) {
    const cli_scene_run run = run_of(r, i, folder);
    SCREE_TRY(cli_check_scene_output(&run, r->error));
  }
  if (r->level_count < 2 || o->resume) return SCREE_OK;
  return cli_check_output(r->call, SCREE_PATH_IN(o->output, "report.html"), o->overwrite, r->error);
}

static scree_status run_all(cli_pour *r) {
  const cli_scene_options *o = &r->arguments->scene;
  SCREE_TRY(scree_shape_store_create(&r->store, r->error));
  if (o->output) SCREE_TRY(check_folders(r));
  for (size_t i = 0; i < r->level_count; i++) SCREE_TRY(check_level(r, i));
  cli_terminal_end();
  if (o->output && o->overwrite && !o->resume) SCREE_TRY(clear_folders(r));
  for (size_t i = 0; i < r->level_count; i++) SCREE_TRY(run_level(r, i));
  if (r->level_count < 2) return SCREE_OK;
  if (!o->json) print_table(r);
  if (!o->output) return SCREE_OK;
  return scree_page_write(&o->output, 1, SCREE_PATH_IN(o->output, "report.html"), true, r->error);
}

/* ---- all of it ---- */

static scree_status check_call(const cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  const cli_scene_options *o = &a->scene;
  if (!r->call->input_count && !a->samples && !(o->resume && o->output) && !o->print)
    return cli_misuse(r->call->verb, "needs a SHAPE, or --samples, or --resume with -o DIR");
  if (o->resume && !o->output) return cli_misuse(r->call->verb, "--resume needs -o DIR");
  return SCREE_OK;
}

static scree_status run_file(cli_pour *r) {
  if (r->arguments->scene.print) {
    SCREE_TRY(set_level(r, 0));
    return scree_scene_file_print(r->file, stdout, r->error);
  }
  scree_status status = run_all(r);
  if (status != SCREE_CANCELLED || !r->arguments->scene.output) return status;
  status = cli_fail(r->error);
  fputs("scree: the same call with --resume goes on from there\n", stderr);
  return status;
}

scree_status cli_pour_run(const cli_call *call, const char *template_name, bool states,
                          scree_error *error) {
  SCREE_CLEANUP(free_pour)
  cli_pour r = {.call = call,
                .arguments = call->options,
                .template_name = template_name,
                .states = states,
                .start = scree_work_started(),
                .error = error};
  SCREE_TRY(check_call(&r));
  SCREE_TRY(take_levels(&r));
  SCREE_TRY(take_words(&r));
  SCREE_TRY(read_base(&r));
  SCREE_TRY(pour_words(&r));
  SCREE_TRY(cli_set_fields(call, r.file, &r.arguments->fields, &r.arguments->scene.set));
  return run_file(&r);
}
