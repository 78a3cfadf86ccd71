/* From words to particles. A shape is read, checked, repaired and decimated once for all runs; its
 * levels go to files which every worker, the one that made them too, reads back: all have the same
 * bits. One process makes a shape, under a lease; the others wait for it. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "base/quote.h"
#include "base/yaml.h"
#include "choice/criterion.h"
#include "study/lease.h"
#include "study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is known ---- */

static bool number_of(const scree_yaml *root, const char *key, double *value) {
  const scree_yaml *node = scree_yaml_find(root, key);
  return node && node->kind == SCREE_YAML_SCALAR && scree_number_read(node->text, value);
}

static bool take_facts(const scree_yaml *root, scree_study_shape *shape) {
  const scree_yaml *word = scree_yaml_find(root, "source"),
                   *sum = scree_yaml_find(root, "checksum");
  double count;
  char high[20];
  bool good = word && sum && word->kind == SCREE_YAML_SCALAR && sum->kind == SCREE_YAML_SCALAR &&
              strlen(sum->text) == 32 && number_of(root, "triangle_count", &count) &&
              number_of(root, "area", &shape->area) && number_of(root, "volume", &shape->volume) &&
              number_of(root, "paper_rp", &shape->paper_rp) &&
              number_of(root, "robust_rp", &shape->robust_rp) &&
              number_of(root, "recommended_rp", &shape->recommended_rp);
  if (!good) return false;
  shape->triangle_count = (uint64_t)count;
  snprintf(high, sizeof high, "%.16s", sum->text);
  shape->checksum = (scree_checksum){strtoull(high, NULL, 16), strtoull(sum->text + 16, NULL, 16)};
  return true;
}

/* Reads NAME.yaml where there is one. */
static scree_status know_shape(const scree_study *study, scree_study_shape *shape,
                               scree_error *error) {
  const char *path = SCREE_STUDY_PATH(study, "shapes", shape->name, ".yaml");
  SCREE_CLEANUP(scree_yaml_free) scree_yaml root = {0};
  if (shape->known || !scree_path_exists(path)) return SCREE_OK;
  SCREE_TRY(scree_yaml_read(path, &root, error));
  shape->known = root.kind == SCREE_YAML_MAPPING && take_facts(&root, shape);
  const scree_yaml *word = shape->known ? scree_yaml_find(&root, "source") : NULL;
  if (!word)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: is damaged; delete it and its shape is made again", path);
  if (strcmp(word->text, shape->word) != 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: is of '%s', not of '%s': use another folder",
                      path, word->text, shape->word);
  return SCREE_OK;
}

scree_status scree_study_know_shapes(scree_study *study, scree_error *error) {
  bool all = true;
  for (size_t i = 0; i < study->shape_count; i++) {
    SCREE_TRY(know_shape(study, &study->shapes[i], error));
    all = all && study->shapes[i].known;
  }
  return all ? scree_study_make_keys(study, error) : SCREE_OK;
}

static bool uses(const scree_study *study, size_t point, size_t shape) {
  const scree_shape_set *set = &study->sets[study->points[point].set];
  for (size_t i = 0; i < set->count; i++)
    if (set->shapes[i] == shape) return true;
  return false;
}

/* Whether everything that any run wants of the shape is there. */
static bool is_complete(const scree_study *study, size_t shape) {
  bool complete = study->shapes[shape].known;
  for (size_t p = 0; complete && p < study->point_count; p++)
    if (uses(study, p, shape) && strcmp(study->points[p].rp, "spheres") != 0)
      complete =
          scree_path_exists(SCREE_LEVEL_PATH(study, &study->shapes[shape], study->points[p].rp));
  return complete;
}

/* ---- making a shape ---- */

/* Progress that also keeps the lease. */
typedef struct keeper {
  const scree_progress *progress;
  scree_lease *lease;
  double interval;
  const char *name;
} keeper;

static bool keep(void *context, const char *phase, double fraction) {
  keeper *k = context;
  bool kept;
  char text[160];
  if (scree_now() - k->lease->last_renewal > k->interval)
    scree_lease_renew(k->lease, "making a shape", &kept, NULL);
  snprintf(text, sizeof text, "%s: %s", k->name, phase);
  return !k->progress || !k->progress->report ||
         k->progress->report(k->progress->context, text, fraction);
}

static scree_status read_sample(const scree_study *study, const scree_study_shape *shape,
                                const scree_progress *progress, scree_mesh *mesh,
                                scree_checksum *sum, scree_error *error) {
  char text[256], resolution[SCREE_NUMBER_SIZE], noise[SCREE_NUMBER_SIZE];
  scree_number_format_digits(study->sample.resolution, 17, resolution);
  scree_number_format_digits(study->sample.noise, 17, noise);
  int size = snprintf(text, sizeof text, "%s %s %s %llu", shape->word, resolution, noise,
                      (unsigned long long)study->sample.seed);
  *sum = scree_checksum_of(text, (size_t)size);
  return scree_sample_make(shape->word + 7, &study->sample, progress, mesh, error);
}

/* In metres only once it is multiplied by *scale, as scree_curve_build_scaled does. */
static scree_status read_scan(const scree_study *study, const scree_study_shape *shape,
                              const scree_progress *progress, scree_mesh *mesh, double *scale,
                              scree_checksum *sum, scree_error *error) {
  scree_read_options read = scree_default_read_options();
  scree_repair_options repair = scree_default_repair_options();
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  read.ignore_comment_unit = true;
  SCREE_TRY(scree_scan_read(shape->path, &read, &scan, error));
  double unit = scan.comment_unit_m > 0 ? scan.comment_unit_m : study->unit_m;
  *scale = scan.states_unit ? 1 : unit / read.unit_m;
  *sum = scan.checksum;
  SCREE_TRY(scree_mesh_prepare(&scan.mesh, &repair, progress, &scan.mesh, NULL, error));
  *mesh = scan.mesh;
  scan.mesh = (scree_mesh){0};
  return SCREE_OK;
}

static scree_status write_mesh(const scree_mesh *mesh, const char *path, scree_error *error) {
  scree_write_options o = scree_default_write_options();
  o.unit_m = 1;
  o.overwrite = true;
  return scree_mesh_write(mesh, path, &o, error);
}

/* The table of the clump, or of as many spheres as the surface has use for. */
static scree_status write_clump(scree_mesh *mesh, size_t count, const scree_progress *progress,
                                const char *path, scree_error *error) {
  scree_clump_options o = scree_default_clump_options();
  SCREE_CLEANUP(scree_clumps_free) scree_clumps clumps = {0};
  o.most = count;
  SCREE_TRY(scree_mesh_canonicalize(mesh, error));
  SCREE_TRY(scree_clumps_make(mesh, &o, progress, &clumps, error));
  return scree_spheres_write(&clumps, scree_clumps_of_count(&clumps, count), 1, path, true, error);
}

static size_t find_level(const scree_study_shape *shape, const scree_curve *curve, const char *rp) {
  double count = (double)shape->triangle_count;
  if (!strcmp(rp, "scan")) return 0;
  double share =
      scree_study_spheres(rp) ? fmin(1, SCREE_CLUMP_TRIANGLES / count) : scree_study_rp(shape, rp);
  return scree_curve_find(curve, scree_choice_target(share, shape->triangle_count));
}

static scree_status write_level(const scree_study *study, const scree_study_shape *shape,
                                const char *rp, const scree_curve *curve,
                                const scree_progress *progress, scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  const char *path = SCREE_LEVEL_PATH(study, shape, rp);
  size_t spheres = scree_study_spheres(rp);
  if (scree_path_exists(path)) return SCREE_OK;
  SCREE_TRY(scree_curve_mesh(curve, find_level(shape, curve, rp), &mesh, error));
  return spheres ? write_clump(&mesh, spheres, progress, path, error)
                 : write_mesh(&mesh, path, error);
}

static scree_status write_facts(const scree_study *study, const scree_study_shape *shape,
                                scree_error *error) {
  char sum[40];
  const struct {
    const char *key;
    double value;
  } facts[] = {{"area", shape->area},
               {"volume", shape->volume},
               {"paper_rp", shape->paper_rp},
               {"robust_rp", shape->robust_rp},
               {"recommended_rp", shape->recommended_rp}};
  scree_output output;
  SCREE_TRY(scree_output_open(SCREE_STUDY_PATH(study, "shapes", shape->name, ".yaml"), true,
                              &output, error));
  scree_checksum_text(shape->checksum, sum);
  fputs("source: ", output.stream);
  scree_quote(output.stream, SCREE_QUOTE_YAML, shape->word);
  fprintf(output.stream, "\nchecksum: '%s'\ntriangle_count: %llu\n", sum,
          (unsigned long long)shape->triangle_count);
  for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) {
    char number[SCREE_NUMBER_SIZE];
    scree_number_format(facts[i].value, number);
    fprintf(output.stream, "%s: %s\n", facts[i].key, number);
  }
  return scree_output_commit(&output, error);
}

static scree_status decimate(const scree_study *study, size_t index, scree_mesh *mesh, double scale,
                             const scree_progress *progress, scree_study_shape *made,
                             scree_error *error) {
  scree_simplify_options simplify = scree_default_simplify_options();
  SCREE_OWNED(scree_curve, curve);
  SCREE_CLEANUP(scree_choice_free) scree_choice choice = {0};
  simplify.method = study->method;
  SCREE_TRY(scree_curve_build_scaled(mesh, scale, &simplify, progress, &curve, error));
  SCREE_TRY(scree_choose(curve, mesh, NULL, progress, &choice, error));
  made->triangle_count = choice.triangle_count;
  made->area = choice.area;
  made->volume = choice.volume;
  made->paper_rp = choice.paper.rp;
  made->robust_rp = choice.robust.rp;
  made->recommended_rp = choice.recommended.rp;
  if (!(made->volume > 0))
    return scree_fail(error, SCREE_BAD_MESH, "%s: the volume is %g m3: not an outward surface",
                      made->word, made->volume);
  for (size_t p = 0; p < study->point_count; p++)
    if (uses(study, p, index) && strcmp(study->points[p].rp, "spheres") != 0) {
      double factor;
      bool chosen = scree_choice_is_recommended(study->points[p].rp, &factor);
      SCREE_TRY(scree_curve_reorder(curve, chosen ? choice.order : 0, error));
      SCREE_TRY(write_level(study, made, study->points[p].rp, curve, progress, error));
    }
  return SCREE_OK;
}

/* Reads, decimates, writes; the facts last, for they say that all is there. */
static scree_status make_shape(const scree_study *study, size_t index,
                               const scree_progress *progress, scree_error *error) {
  scree_study_shape made = study->shapes[index];
  scree_checksum sum;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  double scale = 1;
  scree_status status = made.path ? read_scan(study, &made, progress, &mesh, &scale, &sum, error)
                                  : read_sample(study, &made, progress, &mesh, &sum, error);
  if (status != SCREE_OK) {
    if (error && status != SCREE_CANCELLED && !strstr(error->message, made.word)) {
      scree_error inner = *error;
      return scree_fail(error, status, "%.200s: %.700s", made.word, inner.message);
    }
    return status;
  }
  if (made.known && (made.checksum.high != sum.high || made.checksum.low != sum.low))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "%s: has changed since the study began: use another folder", made.word);
  made.checksum = sum;
  SCREE_TRY(decimate(study, index, &mesh, scale, progress, &made, error));
  return write_facts(study, &made, error);
}

/* Makes the shape, or waits until somebody else has. */
static scree_status prepare_shape(scree_study *study, size_t index,
                                  const scree_study_options *options,
                                  const scree_progress *progress, scree_error *error) {
  scree_study_shape *shape = &study->shapes[index];
  char name[160], worker[SCREE_LEASE_NAME];
  snprintf(name, sizeof name, "shape-%s", shape->name);
  scree_lease_default_worker(worker);
  const char *folder = SCREE_STUDY_PATH(study, "leases", "", "");
  for (;;) {
    bool taken;
    scree_lease lease;
    SCREE_TRY(know_shape(study, shape, error));
    if (is_complete(study, index)) return SCREE_OK;
    SCREE_TRY(scree_lease_take(folder, name, options->lease_s, worker, &taken, &lease, error));
    if (!taken) {
      SCREE_TRY(scree_study_pause(options, progress, "another process makes the shapes", error));
      continue;
    }
    keeper k = {progress, &lease, fmin(5, 0.2 * options->lease_s), shape->name};
    scree_progress keeping = {keep, &k, progress ? progress->interval : 0.2};
    scree_status status = make_shape(study, index, &keeping, error);
    scree_lease_release(&lease);
    SCREE_TRY(status);
  }
}

/* A file that is not the one the study began with must not be taken for it. */
static scree_status check_unchanged(const scree_study_shape *shape, scree_error *error) {
  char *bytes;
  size_t count;
  if (!shape->path || !scree_path_exists(shape->path))
    return SCREE_OK; /* the levels are all that is needed */
  SCREE_TRY(scree_file_read(shape->path, 0, &bytes, &count, error));
  scree_checksum sum = scree_checksum_of(bytes, count);
  scree_free(bytes);
  if (sum.high == shape->checksum.high && sum.low == shape->checksum.low) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "%s: has changed since the study began: use another folder", shape->path);
}

scree_status scree_study_prepare(scree_study *study, const scree_study_options *options,
                                 const scree_progress *progress, scree_error *error) {
  const scree_study_options defaults = scree_default_study_options();
  if (!options) options = &defaults;
  for (size_t i = 0; i < study->shape_count; i++) {
    SCREE_TRY(know_shape(study, &study->shapes[i], error));
    if (study->shapes[i].known) SCREE_TRY(check_unchanged(&study->shapes[i], error));
    SCREE_TRY(prepare_shape(study, i, options, progress, error));
  }
  return scree_study_make_keys(study, error);
}
