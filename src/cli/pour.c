/* One call: its words as shapes, the file of its template with what options set, its levels, and a
 * run at each. */
#include "cli/pour.h"
#include "base/platform.h"
#include "cli/output.h"
#include "cli/terminal.h"

#include <stdlib.h>
#include <string.h>

/* What came of one level. */
typedef struct level_result {
  scree_pile pile;
  bool is_pile;
  double triangles, coordination, seconds;
} level_result;

enum { MOST_LEVELS = 40, LEVEL_BYTES = 40, NAME_BYTES = 4096, PATH_BYTES = 4200 };

typedef struct cli_pour {
  const cli_call *call;
  const cli_pour_kind *kind;
  const cli_pour_arguments *arguments;
  scree_work_start start;
  scree_scene_file *file;
  scree_shape_store *store;
  cli_poured poured;
  double particles;                          /* by the words' counts; 0: they have none */
  char levels[MOST_LEVELS + 1][LEVEL_BYTES]; /* "": as given */
  char names[MOST_LEVELS + 1][LEVEL_BYTES];  /* of folders and in tables */
  size_t level_count;
  level_result results[MOST_LEVELS + 1];
  scree_error error;
} cli_pour;

/* ---- words ---- */

/* A shape by its name alone. */
static bool is_known(const char *name) {
  return cli_is_sample(name, NULL) || !strncmp(name, "sphere:", 7) || scree_path_exists(name);
}

/* "phone.stl=30": the name, and the count behind the last '='. A file may have a name like that. */
static int read_count(const cli_pour *r, const char *word, char *name, double *count) {
  const char *equals = strrchr(word, '='), *digits = equals ? equals + 1 : "";
  bool counted = *digits && digits[strspn(digits, "0123456789")] == 0;
  size_t length = equals ? (size_t)(equals - word) : strlen(word);
  *count = (double)r->arguments->each;
  if (length == 0 || strlen(word) >= NAME_BYTES)
    return cli_misuse(r->call->verb, "'%.40s': not a name", word);
  snprintf(name, NAME_BYTES, "%.*s", (int)length, word);
  if (equals && !counted && (scree_path_exists(word) || !is_known(name))) {
    snprintf(name, NAME_BYTES, "%s", word);
    return 0;
  }
  if (!equals) return 0;
  *count = counted ? strtod(digits, NULL) : 0;
  if (*count >= 1 && *count <= 1e7) return 0;
  return cli_misuse(r->call->verb,
                    "%s: the count behind '=' must be a whole number from 1 to 10000000", word);
}

static int check_sphere(const cli_pour *r, const char *word, const char *name) {
  double diameter;
  char *unit = NULL;
  if (strncmp(name, "sphere:", 7) != 0) return 0;
  bool has_unit = strtod(name + 7, &unit) > 0 && *unit;
  if (has_unit && cli_length_from_text(name + 7, &diameter) && diameter > 0) return 0;
  return cli_misuse(r->call->verb, "%s: not a sphere such as sphere:40mm", word);
}

/* Words without their counts into names; all have one, or none has. */
static int read_words(cli_pour *r, const char **words, size_t word_count, char (*names)[NAME_BYTES],
                      double *counts) {
  size_t counted = 0;
  int code = 0;
  for (size_t i = 0; code == 0 && i < word_count; i++) {
    code = read_count(r, words[i], names[i], &counts[i]);
    if (code == 0) code = check_sphere(r, words[i], names[i]);
    words[i] = names[i];
    counted += counts[i] > 0;
    r->particles += counts[i];
  }
  if (code == 0 && counted > 0 && counted < word_count)
    return cli_misuse(r->call->verb, "%zu of %zu shapes have =COUNT: all need one, or none",
                      counted, word_count);
  if (code || word_count == 0) return code;
  scree_status status =
      cli_make_poured(words, counted ? counts : NULL, word_count, &r->poured, &r->error);
  return status == SCREE_OK ? 0 : cli_fail(&r->error);
}

/* Those of --samples, then those of the call. */
static int take_words(cli_pour *r) {
  size_t samples = r->arguments->samples ? SCREE_SAMPLE_DEVICES : 0,
         count = samples + r->call->input_count;
  char sample_words[SCREE_SAMPLE_DEVICES][32], (*names)[NAME_BYTES];
  const char **words = calloc(count + 1, sizeof *words);
  double *counts = calloc(count + 1, sizeof *counts);
  names = calloc(count + 1, sizeof *names);
  bool room = words && counts && names;
  for (size_t i = 0; room && i < count; i++) {
    if (i < samples)
      snprintf(sample_words[i], sizeof *sample_words, "sample:%s", scree_sample_name(i));
    words[i] = i < samples ? sample_words[i] : r->call->inputs[i - samples];
  }
  if (!room) cli_refuse(&r->error, SCREE_OUT_OF_MEMORY, "shapes", "out of memory");
  int code = room ? read_words(r, words, count, names, counts) : cli_fail(&r->error);
  free(names);
  free(counts);
  free(words);
  return code;
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

static int take_levels(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  if (a->rp && !parse_levels(r, a->rp))
    return cli_misuse(r->call->verb,
                      "--rp %s: must be up to %d different numbers in (0, 1], recommended, or "
                      "clumps of 1 to 300 spheres, as 1e-4,recommended,clump:20",
                      a->rp, MOST_LEVELS);
  if (a->spheres) snprintf(r->levels[r->level_count++], LEVEL_BYTES, "spheres");
  if (r->level_count == 0) r->level_count = 1;
  for (size_t i = 0; i < r->level_count; i++) name_level(r, i);
  return 0;
}

/* ---- the scene ---- */

/* That of the checkpoint which a call without shapes goes on from. */
static scree_status read_checkpoint(cli_pour *r, const char *path) {
  scree_scene *scene;
  if (!scree_path_exists(path))
    return cli_refuse(&r->error, SCREE_IO, path, "no checkpoint to go on from");
  SCREE_TRY(scree_scene_load(path, &scene, &r->error));
  const char *text = scree_scene_text(scene);
  scree_status status = scree_scene_file_parse(text, strlen(text), path, &r->file, &r->error);
  scree_scene_free(scene);
  return status;
}

static int read_base(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  const char *preset = a->preset,
             *usual = ((const cli_pour_arguments *)r->call->verb->defaults)->preset;
  bool alone = !r->poured.count && a->resume && !a->config && preset == usual;
  scree_status status = SCREE_OK;
  if (alone) {
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%.4100s/checkpoint.scree", a->output);
    status = read_checkpoint(r, path);
  } else if (a->config) {
    status =
        scree_scene_file_read_over(a->config, r->kind->template_name, preset, &r->file, &r->error);
  } else {
    status = scree_scene_file_template(r->kind->template_name, &r->file, &r->error);
    if (status == SCREE_OK && preset &&
        scree_scene_file_set(r->file, "preset", preset, &r->error) != SCREE_OK)
      return cli_misuse(r->call->verb, "--preset: %s", r->error.message);
  }
  return status == SCREE_OK ? 0 : cli_fail(&r->error);
}

static scree_status set_number(cli_pour *r, const char *field, double value, bool scans) {
  char text[CLI_NUMBER_BYTES];
  snprintf(text, sizeof text, "%.17g", value);
  if (value == 0) return SCREE_OK;
  return scans ? cli_set_scans(r->file, &r->poured, field, text, &r->error)
               : scree_scene_file_set(r->file, field, text, &r->error);
}

static scree_status pour_words(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  if (!r->poured.count) return SCREE_OK;
  SCREE_TRY(cli_pour_shapes(r->file, &r->poured, &a->source, a->no_repair, &r->error));
  if (a->method == SCREE_METHOD_QECD)
    SCREE_TRY(cli_set_scans(r->file, &r->poured, "method", "qecd", &r->error));
  SCREE_TRY(set_number(r, "triangles", (double)a->triangles, true));
  SCREE_TRY(set_number(r, "clump", (double)a->clump, true));
  return set_number(r, "particles", r->particles, false);
}

/* The scene of a level; of clumps in tables only spheres are another. */
static scree_status set_level(cli_pour *r, size_t index) {
  const char *level = r->levels[index];
  if (!*level || !r->poured.count) return SCREE_OK;
  SCREE_TRY(cli_set_scans(r->file, &r->poured, "rp", level, &r->error));
  for (size_t i = 0; i < r->poured.count; i++) {
    char field[200];
    if (strcmp(r->poured.shapes[i].kind, "clump") != 0) continue;
    snprintf(field, sizeof field, "shapes.%s.rp", r->poured.shapes[i].name);
    SCREE_TRY(
        scree_scene_file_set(r->file, field, strcmp(level, "spheres") ? "scan" : level, &r->error));
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
  const cli_pour_arguments *a = r->arguments;
  bool several = r->level_count > 1;
  const char *name = r->names[level];
  snprintf(folder, NAME_BYTES, "%.4000s%s%s", a->output ? a->output : "", several ? "/" : "",
           several ? name : "");
  return (cli_scene_run){.call = r->call,
                         .start = r->start,
                         .file = r->file,
                         .output = a->output ? folder : NULL,
                         .store = r->store,
                         .rays = a->rays,
                         .views = views_of(a->view),
                         .resume = a->resume,
                         .overwrite = a->force,
                         .json = a->json,
                         .no_picture = a->no_picture,
                         .states = r->kind->states,
                         .common_page = several,
                         .name = several ? name : NULL};
}

/* Refuses what a run that begins would refuse, before anything is written. */
static scree_status check_level(cli_pour *r, size_t level) {
  char folder[NAME_BYTES], checkpoint[PATH_BYTES];
  const cli_scene_run run = run_of(r, level, folder);
  scree_scene *scene;
  snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.scree", folder);
  if (run.resume && run.output && scree_path_exists(checkpoint)) return SCREE_OK;
  scree_status status = set_level(r, level);
  if (status == SCREE_OK)
    status = scree_scene_create_from(r->file, r->store, r->call->progress, &scene, &r->error);
  if (status == SCREE_OK) scree_scene_free(scene);
  return status;
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
  cli_scene_run run = run_of(r, level, folder);
  level_result *result = &r->results[level];
  scree_observation o;
  scree_status status = set_level(r, level);
  if (status == SCREE_OK) status = cli_run_scene(&run, &r->error);
  if (status == SCREE_OK && r->level_count > 1) {
    scree_world_observe(scree_scene_view(run.scene), &o);
    result->coordination = o.coordination;
    result->seconds = scree_scene_get_costs(run.scene).wall_seconds;
    result->triangles = mean_triangles(run.scene);
    result->is_pile = scree_scene_pile_name(run.scene, 0) != NULL;
    if (result->is_pile)
      status = scree_scene_measure_pile(run.scene, 0, NULL, &result->pile, &r->error);
  }
  if (status == SCREE_OK && !run.json && run.output)
    printf("  look at           %s/report.html; result.json and series.csv lie in %s\n",
           cli_printable(r->arguments->output, shown[0]), cli_printable(folder, shown[1]));
  cli_flush();
  cli_scene_run_free(&run);
  return status;
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
  const char *output = r->arguments->output;
  char path[PATH_BYTES];
  scree_status status = cli_clear_scene_output(r->call, output, &r->error);
  scree_folder *entries = status == SCREE_OK ? scree_folder_open(output) : NULL;
  for (const char *name; status == SCREE_OK && entries && (name = scree_folder_next(entries));) {
    scree_path_info info;
    snprintf(path, sizeof path, "%.3900s/%.255s", output, name);
    if (is_level_name(name) && scree_path_look(path, &info) && info.kind == SCREE_PATH_FOLDER)
      status = cli_clear_scene_output(r->call, path, &r->error);
  }
  if (entries) scree_folder_close(entries);
  return status;
}

/* Whether the folders can be written to, before scans are read and decimated. */
static scree_status check_folders(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  char path[PATH_BYTES], folder[NAME_BYTES];
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < r->level_count; i++) {
    const cli_scene_run run = run_of(r, i, folder);
    status = cli_check_scene_output(&run, &r->error);
  }
  if (status != SCREE_OK || r->level_count < 2 || a->resume) return status;
  snprintf(path, sizeof path, "%.4100s/report.html", a->output);
  return cli_check_output(r->call, path, a->force, &r->error);
}

static scree_status run_all(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  scree_status status = scree_shape_store_create(&r->store, &r->error);
  if (status == SCREE_OK && a->output) status = check_folders(r);
  for (size_t i = 0; status == SCREE_OK && i < r->level_count; i++) status = check_level(r, i);
  cli_terminal_end();
  if (status == SCREE_OK && a->output && a->force && !a->resume) status = clear_folders(r);
  for (size_t i = 0; status == SCREE_OK && i < r->level_count; i++) status = run_level(r, i);
  if (status != SCREE_OK || r->level_count < 2) return status;
  if (!a->json) print_table(r);
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%.4100s/report.html", a->output ? a->output : "");
  return a->output ? scree_page_write(&a->output, 1, path, true, &r->error) : SCREE_OK;
}

/* ---- the call ---- */

static int check_call(const cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  const cli_verb *verb = r->call->verb;
  if (!r->call->input_count && !a->samples && !(a->resume && a->output) && !a->print)
    return cli_misuse(verb, "needs a SHAPE, or --samples, or --resume with -o DIR");
  if (a->resume && !a->output) return cli_misuse(verb, "--resume needs -o DIR");
  return a->rp && a->triangles ? cli_misuse(verb, "-r and -n exclude each other") : 0;
}

static int run_file(cli_pour *r) {
  const cli_pour_arguments *a = r->arguments;
  scree_status status = a->print ? set_level(r, 0) : run_all(r);
  if (status == SCREE_OK && a->print) status = scree_scene_file_print(r->file, stdout, &r->error);
  if (status == SCREE_OK) return 0;
  int code = cli_fail(&r->error);
  if (r->error.status == SCREE_CANCELLED && a->output)
    fputs("scree: the same call with --resume goes on from there\n", stderr);
  return code;
}

int cli_pour_run(const cli_call *call, const cli_pour_kind *kind) {
  static cli_pour r; /* large */
  r = (cli_pour){
      .call = call, .kind = kind, .arguments = call->options, .start = scree_work_started()};
  int code = check_call(&r);
  if (code == 0) code = take_levels(&r);
  if (code == 0) code = take_words(&r);
  if (code == 0) code = read_base(&r);
  if (code == 0 && pour_words(&r) != SCREE_OK) code = cli_fail(&r.error);
  if (code == 0)
    code = cli_set_fields(call, r.file, kind->settings, r.arguments->settings, kind->setting_count,
                          &r.arguments->set);
  if (code == 0) code = run_file(&r);
  scree_shape_store_free(r.store);
  cli_poured_free(&r.poured);
  scree_scene_file_free(r.file);
  return code;
}
