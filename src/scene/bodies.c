/* Bodies from a table, and into one: a line of names, then a line for each body, between commas.
 * Names are x, y, z; qw, qx, qy, qz, which turn the particle's axes into space; vx, vy, vz; wx, wy,
 * wz in space; size; shape. Behind a name its unit may stand: `x [mm]`. */
#include "base/arena.h"
#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"
#include "scene/named_table.h"
#include "scene/scene.h"
#include "world/state/save.h"
#include "world/step/checkpoint.h"

#include <float.h>
#include <string.h>

enum { REALS = 14, SHAPE = REALS, COLUMNS = REALS + 1, MOST_BYTES = 1 << 30 };
static const scree_named_column known[COLUMNS] = {
    {"x", "m"},      {"y", "m"},      {"z", "m"},      {"qw", ""},    {"qx", ""},
    {"qy", ""},      {"qz", ""},      {"vx", "m/s"},   {"vy", "m/s"}, {"vz", "m/s"},
    {"wx", "rad/s"}, {"wy", "rad/s"}, {"wz", "rad/s"}, {"size", "m"}, {"shape", NULL}};

static scree_status check_names(const scree_named_table *t, const scree_scene *scene) {
  if (!t->there[0] || !t->there[1] || !t->there[2])
    return scree_rows_fail(&t->rows, "needs columns x, y and z");
  bool turned = t->there[3] || t->there[4] || t->there[5] || t->there[6];
  if (turned && !(t->there[3] && t->there[4] && t->there[5] && t->there[6]))
    return scree_rows_fail(&t->rows, "an orientation needs qw, qx, qy and qz");
  if (!t->there[SHAPE] && scene->plan.families.count > 1)
    return scree_rows_fail(&t->rows, "needs a column shape: there are several");
  return SCREE_OK;
}

/* One of that name, or of the family of that name, and of the size where one is given: the nearest
 * of that name, where it is none. */
static scree_status find_shape(const scree_named_table *t, const scree_scene *scene,
                               const char *name, double size, size_t *index) {
  double nearest = INFINITY;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    const scree_plan_shape *s = &scene->plan.shapes.items[i];
    const char *family = scene->plan.families.items[s->family].place.name;
    double own = scene->shapes[i].particle->measures.size;
    double off = isnan(size) ? 0 : fabs(size - own) / own;
    if (name && strcmp(name, s->place.name) != 0 && strcmp(name, family) != 0) continue;
    if (off >= nearest) continue;
    nearest = off;
    *index = i;
  }
  if (isinf(nearest)) return scree_rows_fail(&t->rows, "no shape '%.40s'", name ? name : "");
  if (nearest <= 1e-4) return SCREE_OK;
  return scree_rows_fail(&t->rows,
                         "no shape '%.40s' of size %.6g mm, the nearest has %.6g mm: other sizes "
                         "are those that the shape's `size` in the scene lists",
                         name ? name : scene->plan.families.items[0].place.name, 1e3 * size,
                         1e3 * scene->shapes[*index].particle->measures.size);
}

static scree_status admit(const scree_named_table *t, const double v[REALS], const char *shape,
                          scree_scene *scene, scree_error *error) {
  size_t index = 0;
  SCREE_TRY(find_shape(t, scene, shape, v[13], &index));
  scree_body body = scree_default_body();
  memcpy(body.position, v, sizeof body.position);
  for (int k = 0; k < 3; k++) {
    scene->table_low[k] = fmin(scene->table_low[k], v[k]);
    scene->table_high[k] = fmax(scene->table_high[k], v[k]);
  }
  memcpy(body.orientation, v + 3, sizeof body.orientation);
  memcpy(body.velocity, v + 7, sizeof body.velocity);
  memcpy(body.angular_velocity, v + 10, sizeof body.angular_velocity);
  scree_error why;
  scree_status status = scree_scene_admit(scene, index, &body, &why);
  double length2 = 0;
  for (int k = 3; k < 7; k++) length2 += v[k] * v[k];
  if (status == SCREE_OK && !scene->shapes[index].piece_count &&
      fabs(length2 - 1) <= 4 * DBL_EPSILON) /* as a world wrote it */
    scree_body_keep_orientation(scene->world, scene->shape_of.count - 1, v + 3);
  return status == SCREE_BAD_ARGUMENT ? scree_rows_fail(&t->rows, "%s", why.message)
         : status == SCREE_OK         ? status
                                      : scree_fail(error, status, "%s", why.message);
}

static scree_status read_table(const char *name, char *text, size_t size, scree_scene *scene,
                               scree_error *error) {
  scree_named_table t;
  SCREE_TRY(scree_named_open(&t, name, text, size, known, COLUMNS, error));
  SCREE_TRY(check_names(&t, scene));
  for (bool there = true; there;) {
    double v[COLUMNS] = {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, NAN};
    const char *words[COLUMNS] = {NULL};
    SCREE_TRY(scree_named_row(&t, v, words, &there));
    if (there) SCREE_TRY(admit(&t, v, words[SHAPE], scene, error));
  }
  return SCREE_OK;
}

/* Reads the places of a table; of many every second, fourth, ... is kept. */
static scree_status read_places(const char *name, char *text, size_t size, scree_scene *scene,
                                scree_error *error) {
  enum { MOST_PLACES = 512 };
  scree_named_table t;
  SCREE_TRY(scree_named_open(&t, name, text, size, known, COLUMNS, error));
  SCREE_TRY(check_names(&t, scene));
  SCREE_TRY_TAKE(scene->table_places, &scene->arena, MOST_PLACES, error);
  size_t every = 1;
  for (size_t row = 0;; row++) {
    double v[COLUMNS] = {0};
    const char *words[COLUMNS] = {NULL};
    bool there;
    SCREE_TRY(scree_named_row(&t, v, words, &there));
    if (!there) return SCREE_OK;
    if (row % every) continue;
    if (scene->table_place_count == MOST_PLACES) {
      for (size_t i = 0; i < MOST_PLACES / 2; i++)
        memcpy(scene->table_places[i], scene->table_places[2 * i], sizeof *scene->table_places);
      scene->table_place_count = MOST_PLACES / 2;
      every *= 2;
    }
    memcpy(scene->table_places[scene->table_place_count++], v, sizeof *scene->table_places);
  }
}

static scree_status read_file(scree_scene *scene, const char *folder,
                              scree_status (*read)(const char *name, char *text, size_t size,
                                                   scree_scene *scene, scree_error *error),
                              scree_error *error) {
  const scree_plan_bodies *plan = scene->plan.bodies;
  char *bytes;
  size_t count;
  if (!plan) return SCREE_OK;
  char *path = scree_scene_path(folder, plan->file);
  if (!path) return scree_fail_memory(error, 0, "a path");
  scree_error why;
  scree_status status = scree_file_read(path, MOST_BYTES, &bytes, &count, &why);
  if (status == SCREE_OK) {
    status = read(path, bytes, count, scene, &why);
    scree_free(bytes);
  }
  scree_free(path);
  return scree_scene_blame(scene, &plan->place, status, &why, error);
}

scree_status scree_scene_read_places(scree_scene *scene, const char *folder, scree_error *error) {
  return read_file(scene, folder, read_places, error);
}

scree_status scree_scene_read_bodies(scree_scene *scene, const char *folder, scree_error *error) {
  SCREE_TRY(read_file(scene, folder, read_table, error));
  return scree_scene_check_pierced(scene, error);
}

typedef struct deepest {
  const scree_scene *scene;
  scree_contact contact;
  double share; /* of the size of the smaller */
} deepest;

static double size_of(const scree_scene *scene, size_t body) {
  return scene->shapes[scene->shape_of.items[body]].particle->measures.size;
}

static bool keep_deepest(void *context, const scree_contact *contact) {
  deepest *d = context;
  double size = size_of(d->scene, contact->body);
  if (!contact->wall) size = fmin(size, size_of(d->scene, contact->other));
  if (contact->overlap > d->share * size)
    *d = (deepest){d->scene, *contact, contact->overlap / size};
  return true;
}

/* Contacts are known from the first step on: it is made by a copy, and may fail by what is looked
 * for. */
bool scree_scene_bodies_overlap(const scree_scene *scene, char text[SCREE_REMARK]) {
  if (!scene->plan.bodies || scree_world_step_count(scene->world) > 0) return false;
  unsigned char *bytes;
  size_t count;
  deepest d = {scene, {0}, scene->world->options.overlap_limit};
  if (scree_world_pack(scene->world, true, &bytes, &count, NULL) != SCREE_OK) return false;
  scree_world *copy = NULL;
  if (scree_world_unpack(bytes, count, "", &copy, NULL) == SCREE_OK) {
    copy->options.time_step *= 1e-6; /* nothing is to move yet */
    (void)scree_world_step(copy, 1, NULL);
    (void)scree_world_visit_contacts(copy, keep_deepest, &d, NULL);
  }
  scree_world_free(copy);
  scree_free(bytes);
  const scree_contact *c = &d.contact;
  if (!(c->overlap > 0)) return false;
  char other[100];
  if (c->wall)
    snprintf(other, sizeof other, "'%.60s'",
             scree_scene_geometry_name(scene, scree_scene_wall_geometry(scene, c->other)));
  else
    snprintf(other, sizeof other, "body %zu", c->other);
  snprintf(text, SCREE_REMARK,
           "bodies: some begin inside of each other or of walls, and are thrown apart: body %zu, "
           "counted from 0, and %s overlap by %.3g mm at %.4g %.4g %.4g m, %.2g of the size",
           c->body, other, 1e3 * c->overlap, c->position[0], c->position[1], c->position[2],
           d.share);
  return true;
}

static void put_reals(FILE *stream, const double *values, int count) {
  for (int k = 0; k < count; k++) {
    char text[SCREE_NUMBER_SIZE];
    scree_number_format(values[k], text);
    fprintf(stream, ",%s", text);
  }
}

scree_status scree_scene_bodies_write(const scree_scene *scene, const char *path, bool overwrite,
                                      scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  FILE *out = output.stream;
  fputs("shape", out);
  for (int k = 0; k < REALS; k++)
    fprintf(out, *known[k].unit ? ",%s [%s]" : ",%s", known[k].name, known[k].unit);
  putc('\n', out);
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    size_t shape = scene->shape_of.items[b];
    scree_quote(out, SCREE_QUOTE_CSV, scree_scene_shape_name(scene, shape));
    put_reals(out, body.position, 3);
    put_reals(out, body.orientation, 4);
    put_reals(out, body.velocity, 3);
    put_reals(out, body.angular_velocity, 3);
    put_reals(out, &scene->shapes[shape].particle->measures.size, 1);
    putc('\n', out);
  }
  return scree_output_commit(&output, error);
}
