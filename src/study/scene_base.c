/* What a study varies is a scene: of a file or a template, with any field as a factor, any column
 * of its sensors as an answer, and shapes of its own where the study names some. It stands in the
 * study as its own text. */
#include "base/file.h"
#include "base/platform.h"
#include "base/schema.h"
#include "study/record.h"

#include "base/error.h"
#include "base/vec.h"
#include "particle/shape.h"
#include "scene/scene.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* The highest point of a triangle at x lies on one of its edges: edges that cross x are enough. */

static double mesh_height(const scree_mesh *mesh, const scree_body *body, double x) {
  mat3 turn = quat_to_mat3(scree_body_turn(body));
  double best = -INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 p[3];
    for (size_t k = 0; k < 3; k++) {
      vec3 local = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k]);
      p[k] = vec3_add(mat3_mul_vec(&turn, local), vec3_load(body->position));
    }
    for (size_t k = 0; k < 3; k++) {
      vec3 a = p[k], b = p[(k + 1) % 3];
      if (fmin(a.x, b.x) > x || fmax(a.x, b.x) < x) continue;
      double part = a.x == b.x ? 0 : (x - a.x) / (b.x - a.x);
      best = fmax(best, fmax(a.z + part * (b.z - a.z), a.x == b.x ? b.z : -INFINITY));
    }
  }
  return best;
}

static double spheres_height(scree_particle *particle, size_t count, const scree_body *body,
                             double x) {
  mat3 turn = quat_to_mat3(scree_body_turn(body));
  double best = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    double local[3], radius;
    scree_particle_point(particle, i, local, &radius);
    vec3 centre = vec3_add(mat3_mul_vec(&turn, vec3_load(local)), vec3_load(body->position));
    double left = radius * radius - (x - centre.x) * (x - centre.x);
    if (left >= 0) best = fmax(best, centre.z + sqrt(left));
  }
  return best;
}

/* The greatest z of all bodies' surfaces where x is this, m; 0 where there are none: the floor. */
static double outline_height(const scree_world *world, double x) {
  double best = -INFINITY;
  for (size_t b = 0; b < scree_world_body_count(world); b++) {
    scree_body body;
    scree_particle_measures m;
    if (scree_world_body_removed(world, b)) continue;
    scree_particle *particle = scree_world_body_particle(world, b);
    scree_world_get_body(world, b, &body);
    scree_particle_measure(particle, &m);
    if (fabs(body.position[0] - x) > m.bounding_radius) continue;
    best = fmax(best, m.kind == SCREE_PARTICLE_MESH
                          ? mesh_height(scree_particle_mesh(particle), &body, x)
                          : spheres_height(particle, m.point_count, &body, x));
  }
  return best > -INFINITY ? best : 0;
}

static const char copy_name[] = "scene.yaml";

/* ---- the file ---- */

static const char copy_mark[] = "# scene of ";

/* Beside the study's file; in a study's folder its copy. To be freed; NULL when memory is out. */
static char *scene_path(const scree_study *study, const char *name) {
  const char *slash = strrchr(study->path, '/');
  int folder = slash ? (int)(slash + 1 - study->path) : 0;
  size_t size = (size_t)folder + strlen(name) + sizeof copy_name + 1;
  char *path = scree_alloc(size, 1);
  if (!path) return NULL;
  snprintf(path, size, "%.*s%s", *name == '/' ? 0 : folder, study->path, name);
  if (scree_path_exists(path)) return path;
  char *copy = scree_alloc(size, 1);
  if (copy) snprintf(copy, size, "%.*s%s", folder, study->path, copy_name);
  if (!copy || !scree_path_exists(copy)) {
    scree_free(copy);
    return path;
  }
  scree_free(path);
  return copy;
}

/* A copy's first line says where its original lies, beside which the files are that it names. */
static scree_status keep_text(scree_study *study, const char *path, const char *text,
                              scree_error *error) {
  char original[4096] = "";
  if (!strncmp(text, copy_mark, sizeof copy_mark - 1)) {
    text += sizeof copy_mark - 1;
    snprintf(original, sizeof original, "%.*s", (int)strcspn(text, "\n"), text);
    text += strcspn(text, "\n");
    text += *text != 0;
    path = original;
  }
  study->scene_text = scree_arena_text(&study->arena, text);
  study->scene_path = scree_arena_text(&study->arena, path);
  return study->scene_text && study->scene_path ? SCREE_OK : scree_fail_memory(error, 0, path);
}

scree_status scree_study_read_scene(scree_study *study, const char *name, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *path = scene_path(study, name);
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  size_t count;
  study->scene_is_file = false;
  if (!path) return scree_fail_memory(error, strlen(name), "a path");
  SCREE_TRY(scree_file_read(path, 1 << 20, &bytes, &count, error));
  SCREE_TRY(keep_text(study, path, bytes, error));
  study->scene_is_file = true;
  return SCREE_OK;
}

scree_status scree_study_take_template(scree_study *study, const char *name, scree_error *error) {
  scree_scene_file *file; /* tells which there are */
  SCREE_TRY(scree_scene_file_template(name, &file, error));
  scree_scene_file_free(file);
  study->scene_is_file = false;
  return keep_text(study, name, scree_scene_template(name), error);
}

scree_status scree_study_add_setting(scree_study *study, const char *key, const char *value,
                                     scree_error *error) {
  const char **setting = study->settings[study->setting_count];
  setting[0] = scree_arena_text(&study->arena, key);
  setting[1] = scree_arena_text(&study->arena, value);
  if (!setting[0] || !setting[1]) return scree_fail_memory(error, 0, study->path);
  study->setting_count++;
  return SCREE_OK;
}

/* A field of each shape of the set. */
static scree_status set_in_shapes(const scree_study *study, size_t set_index, const char *key,
                                  const char *value, scree_scene_file *file, scree_error *error) {
  const scree_shape_set *set = &study->sets[set_index];
  for (size_t i = 0; i < set->count; i++) {
    char field[160];
    snprintf(field, sizeof field, "shapes.%s.%s", study->shapes[set->shapes[i]].name, key);
    SCREE_TRY(scree_scene_file_set(file, field, value, error));
  }
  return SCREE_OK;
}

/* The shapes that the study names, in place of the scene's. */
static scree_status pour_set(const scree_study *study, size_t set_index, scree_scene_file *file,
                             scree_error *error) {
  const scree_shape_set *set = &study->sets[set_index];
  SCREE_SCRATCH(scree_poured, shapes, set->count, error);
  for (size_t i = 0; i < set->count; i++) {
    const scree_study_shape *s = &study->shapes[set->shapes[i]];
    shapes[i] =
        (scree_poured){s->name, s->path ? "file" : "sample", s->path ? s->word : s->word + 7, 1};
  }
  SCREE_TRY(scree_scene_file_pour(file, shapes, set->count, error));
  return study->method == SCREE_METHOD_QECD
             ? set_in_shapes(study, set_index, "method", "qecd", file, error)
             : SCREE_OK;
}

scree_status scree_study_scene(const scree_study *study, const scree_study_point *point,
                               scree_scene_file **file, scree_error *error) {
  SCREE_OWNED(scree_scene_file, made);
  bool pours = point && study->own_shapes;
  SCREE_TRY(scree_scene_file_parse(study->scene_text, strlen(study->scene_text), study->scene_path,
                                   &made, error));
  if (pours) SCREE_TRY(pour_set(study, point->set, made, error));
  for (size_t i = 0; i < study->setting_count; i++)
    SCREE_TRY(scree_scene_file_set(made, study->settings[i][0], study->settings[i][1], error));
  if (pours) SCREE_TRY(set_in_shapes(study, point->set, "rp", point->rp, made, error));
  for (size_t f = 0; point && f < study->factor_count; f++)
    if (!scree_study_is_own(study, study->factors[f].key))
      SCREE_TRY(scree_scene_file_set(made, study->factors[f].key, point->values[f], error));
  *file = made;
  made = NULL;
  return SCREE_OK;
}

scree_status scree_study_run_scene(const scree_study *study, size_t run, scree_scene_file **file,
                                   scree_error *error) {
  char seed[32];
  SCREE_OWNED(scree_scene_file, made);
  SCREE_TRY(
      scree_study_scene(study, &study->points[scree_study_run_point(study, run)], &made, error));
  snprintf(seed, sizeof seed, "%" PRIu64, scree_study_run_seed(study, run));
  SCREE_TRY(scree_scene_file_set(made, "seed", seed, error));
  *file = made;
  made = NULL;
  return SCREE_OK;
}

scree_status scree_study_try(const scree_study *study, const char *key, const char *value,
                             scree_error *error) {
  SCREE_OWNED(scree_scene_file, file);
  SCREE_TRY(scree_study_scene(study, NULL, &file, error));
  return scree_scene_file_try(file, key, value, error);
}

/* The plan's phases, and which is the first in which something moves; its seed and pile. */
scree_status scree_study_look(scree_study *study, scree_error *error) {
  SCREE_OWNED(scree_scene_file, file);
  scree_plan plan;
  SCREE_TRY(scree_study_scene(study, NULL, &file, error));
  SCREE_TRY(scree_scene_file_plan(file, &study->arena, &plan, error));
  study->seed = plan.seed;
  study->phase_count = plan.phases.count;
  SCREE_TRY_TAKE(study->phases, &study->arena, plan.phases.count, error);
  study->moving_phase = 0;
  for (size_t i = 0; i < plan.phases.count; i++) study->phases[i] = plan.phases.items[i].place.name;
  for (size_t i = 0; i < plan.geometry.count; i++) {
    const scree_plan_geometry *g = &plan.geometry.items[i];
    const scree_plan_motion *m = g->motion.items;
    if (g->motion.count && m->during) study->moving_phase = SCREE_PLAN_FIND(plan.phases, m->during);
  }
  study->has_pile = false;
  for (size_t i = 0; i < plan.sensors.count; i++)
    study->has_pile = study->has_pile || plan.sensors.items[i].pile != NULL;
  return SCREE_OK;
}

scree_status scree_study_keep_scene(const scree_study *study, scree_error *error) {
  char full[4096];
  if (!study->scene_is_file) return SCREE_OK;
  if (!scree_path_full(study->scene_path, full, sizeof full))
    return scree_fail(error, SCREE_IO, "%s: cannot be found", study->scene_path);
  scree_output output;
  SCREE_TRY(scree_output_open(SCREE_STUDY_PATH(study, "", copy_name, ""), true, &output, error));
  fprintf(output.stream, "%s%s\n%s", copy_mark, full, study->scene_text);
  return scree_output_commit(&output, error);
}

/* ---- the shapes of a run ---- */

scree_status scree_study_stock(const scree_study *study, size_t run, const scree_scene_file *file,
                               scree_shape_store *store, double *triangle_count,
                               scree_error *error) {
  size_t point = scree_study_run_point(study, run);
  const scree_shape_set *set = &study->sets[study->points[point].set];
  SCREE_CLEANUP(scree_arena_free) scree_arena arena = {0};
  scree_plan plan;
  if (!study->own_shapes) return SCREE_OK;
  SCREE_TRY(scree_scene_file_plan(file, &arena, &plan, error));
  for (size_t i = 0; i < set->count; i++) {
    const scree_plan_shape *shape = &plan.shapes.items[i];
    SCREE_CLEANUP(scree_free_at)
    char *path = scree_scene_path(file->folder, shape->file ? shape->file : shape->sample);
    scree_shape_made made;
    if (!path) return scree_fail_memory(error, 0, "a path");
    SCREE_TRY(scree_study_make_shape(study, set->shapes[i], study->points[point].rp, &made, error));
    scree_shape_spec spec = scree_scene_shape_spec(shape, path);
    scree_status status = scree_shape_store_put(store, &spec, &made, error);
    *triangle_count += (double)made.triangle_count / (double)set->count;
    scree_particle_free(made.particle);
    SCREE_TRY(status);
  }
  return SCREE_OK;
}

/* ---- answers ---- */

bool scree_study_has_column(const scree_study *study, const char *column, const char **unit) {
  SCREE_OWNED(scree_scene_file, file);
  char name[96] = "?";
  if (scree_study_scene(study, NULL, &file, NULL) != SCREE_OK) return false;
  for (size_t i = 0; *name; i++) {
    if (scree_scene_file_column(file, i, name, unit, NULL) != SCREE_OK) return false;
    if (!strcmp(name, column)) return true;
  }
  return false;
}

const char *scree_study_column_hint(scree_study *study, const char *column) {
  enum { MOST = 200 };
  SCREE_OWNED(scree_scene_file, file);
  char names[MOST][96], hint[SCREE_NAME_HINT];
  const char *known[MOST];
  size_t count = 0;
  if (scree_study_scene(study, NULL, &file, NULL) != SCREE_OK) return "";
  for (size_t i = 0; count < MOST; i++) {
    if (scree_scene_file_column(file, i, names[count], NULL, NULL) != SCREE_OK || !*names[count])
      break;
    known[count] = names[count];
    count += strchr(names[count], '.') != NULL;
  }
  scree_name_hint(column, known, count, hint);
  const char *kept = scree_arena_text(&study->arena, hint);
  return kept ? kept : "";
}

static size_t column_of(const scree_scene *scene, const char *name) {
  size_t columns = scree_scene_column_count(scene), k = 0;
  while (k < columns && strcmp(scree_scene_column_name(scene, k), name) != 0) k++;
  return k;
}

/* Between two rows of the series as on a straight line. */
static double at_time(const double *series, size_t rows, size_t columns, size_t k, double time) {
  size_t i = 0;
  while (i < rows && series[i * columns] < time) i++;
  if (i == rows) return NAN;
  const double *row = series + i * columns, *before = i ? row - columns : row;
  if (i == 0 && row[0] > time) return NAN;
  double part = row[0] > before[0] ? (time - before[0]) / (row[0] - before[0]) : 1;
  return part == 1 ? row[k] : before[k] + part * (row[k] - before[k]);
}

static double answer_of(const scree_answer *answer, const scree_scene *scene) {
  size_t rows, columns = scree_scene_column_count(scene), k = column_of(scene, answer->column);
  const double *series = scree_scene_series(scene, &rows);
  if (answer->outline) return outline_height(scree_scene_view(scene), answer->at);
  if (k == columns || rows == 0) return NAN;
  if (!isnan(answer->at)) return at_time(series, rows, columns, k, answer->at);
  scree_scene_summary s = scree_scene_summarise(scene, k, answer->from, answer->until);
  return answer->mean ? s.mean : answer->sd ? s.sd : s.last;
}

/* ---- what is kept of a run ---- */

static double value_at(const scree_scene *scene, size_t row, const char *name) {
  size_t rows, columns = scree_scene_column_count(scene), k = column_of(scene, name);
  const double *series = scree_scene_series(scene, &rows);
  return k < columns ? series[row * columns + k] : (double)NAN;
}

/* The column of a record's series; the column count: the scene has none such. */
static size_t column_in(const scree_scene *scene, const char *of_scene) {
  const char *pile = scree_scene_pile_name(scene, 0);
  char name[96];
  if (*of_scene != '*') return column_of(scene, of_scene);
  snprintf(name, sizeof name, "%s%s", pile ? pile : "", of_scene + 1);
  return column_of(scene, name);
}

/* Records of scenes in phases how fast bodies turn while something moves. */
static scree_status record_series(const scree_study *study, const scree_scene *scene,
                                  scree_study_record *record, scree_error *error) {
  size_t rows, columns = scree_scene_column_count(scene);
  const double *series = scree_scene_series(scene, &rows);
  if (study->phase_count == 0) return SCREE_OK;
  SCREE_TRY_ALLOC(record->series, rows, error);
  record->series_count = rows;
  for (size_t c = 0; c < SCREE_RECORD_COLUMNS; c++) {
    size_t k = column_in(scene, scree_record_of_scene[c]);
    for (size_t i = 0; i < rows; i++)
      *scree_record_number(&record->series[i], c) =
          k < columns ? series[i * columns + k] : (double)NAN;
  }
  for (size_t i = 0; i < rows; i++) {
    record->series[i].phase = (size_t)value_at(scene, i, "phase");
    record->series[i].body_count = (size_t)value_at(scene, i, "inside");
    record->series[i].kinetic += value_at(scene, i, "rotational");
  }
  return SCREE_OK;
}

static double largest_overlap(const scree_scene *scene) {
  size_t rows;
  double largest = 0;
  (void)scree_scene_series(scene, &rows);
  for (size_t i = 0; i < rows; i++) largest = fmax(largest, value_at(scene, i, "largest_overlap"));
  return largest;
}

static void record_costs(const scree_scene *scene, scree_record_costs *costs) {
  scree_scene_costs c = scree_scene_get_costs(scene);
  *costs = (scree_record_costs){.time_step = scree_world_time_step(scree_scene_view(scene), NULL),
                                .step_count = scree_world_step_count(scree_scene_view(scene)),
                                .particle_steps = c.body_steps,
                                .wall_seconds = c.wall_seconds,
                                .processor_seconds = c.processor_seconds,
                                .piece_count = c.piece_count,
                                .largest_overlap = largest_overlap(scene)};
}

/* Whether it ended with all at rest, by the threshold of its last phase. */
static bool ends_still(const scree_scene *scene, const scree_observation *o) {
  size_t count = scene->plan.phases.count;
  if (count == 0) return scree_scene_end(scene) && !strcmp(scree_scene_end(scene), "still");
  const scree_plan_phase *last = &scene->plan.phases.items[count - 1];
  return o->kinetic + o->rotational < last->still * (double)o->body_count;
}

scree_status scree_study_answer_scene(const scree_study *study, const scree_scene *scene,
                                      scree_study_record *record, scree_error *error) {
  scree_free(record->answers);
  record->answer_count = 0;
  SCREE_TRY_ALLOC(record->answers, study->answer_count, error);
  record->answer_count = study->answer_count;
  for (size_t i = 0; i < study->answer_count; i++)
    record->answers[i] = answer_of(&study->answers[i], scene);
  scree_study_answers_mark(study, record->answered);
  return SCREE_OK;
}

scree_status scree_study_record_scene(const scree_study *study, const scree_scene *scene,
                                      scree_study_record *record, scree_error *error) {
  const scree_world *world = scree_scene_view(scene);
  scree_scene_book book;
  scree_observation o;
  scree_pile pile = scree_no_pile();
  if (scree_scene_pile_name(scene, 0))
    SCREE_TRY(scree_scene_measure_pile(scene, 0, NULL, &pile, error));
  scree_scene_get_book(scene, &book);
  scree_world_observe(world, &o);
  scree_checksum_text(scree_world_hash(world), record->hash);
  SCREE_TRY(scree_study_answer_scene(study, scene, record, error));
  record_costs(scene, &record->costs);
  size_t bodies = scree_scene_pile_name(scene, 0) ? pile.body_count : book.inside_count;
  record->result = (scree_record_result){.pile = pile,
                                         .body_count = bodies,
                                         .left_count = book.inside_count + book.left_count - bodies,
                                         .coordination = o.coordination,
                                         .kinetic = o.kinetic + o.rotational,
                                         .time = o.time,
                                         .still = ends_still(scene, &o)};
  return record_series(study, scene, record, error);
}
