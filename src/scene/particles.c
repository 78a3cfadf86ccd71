/* From what a shape is made from to its particle. A scan is read, checked, repaired where need be,
 * and decimated to what is asked for. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "base/number.h"
#include "choice/criterion.h"

#include <stdlib.h>
#include <string.h>

typedef struct making {
  const scree_plan_shape *shape;
  const scree_progress *progress;
  scree_mesh mesh; /* metres times 1 / scale */
  double scale;
  size_t triangle_count; /* of the scan */
  scree_checksum checksum;
} making;

static scree_status make_sample(making *m, scree_error *error) {
  scree_sample_options o = scree_default_sample_options();
  if (!isnan(m->shape->resolution)) o.resolution = m->shape->resolution;
  if (o.noise > 0.25 * o.resolution) o.noise = 0.25 * o.resolution;
  return scree_sample_make(m->shape->sample, &o, m->progress, &m->mesh, error);
}

/* As if in millimetres: levels must not hang on the unit. */
static scree_status read_scan(making *m, const char *path, scree_error *error) {
  scree_read_options o = scree_default_read_options();
  scree_repair_options repair = scree_default_repair_options();
  scree_scan scan;
  scree_status status = scree_scan_read(path, &o, &scan, error);
  if (status != SCREE_OK) return status;
  m->scale = scan.states_unit ? 1 : scree_plan_unit(m->shape->unit) / o.unit_m;
  m->checksum = scan.checksum;
  status = scree_mesh_prepare(&scan.mesh, &repair, m->progress, &scan.mesh, NULL, error);
  if (status == SCREE_OK)
    m->mesh = scan.mesh;
  else
    scree_scan_free(&scan);
  return status;
}

/* The level asked for; where it is left to scree, the one that `scree choose` chooses. */
static scree_status pick_level(const making *m, const scree_curve *curve, size_t *level,
                               scree_error *error) {
  const scree_plan_shape *s = m->shape;
  double rp;
  size_t count = s->triangles ? strtoul(s->triangles, NULL, 10) : 0;
  if (scree_plan_spheres(s) && !s->triangles) count = SCREE_CLUMP_TRIANGLES;
  if (s->rp && scree_number_read(s->rp, &rp)) count = scree_choice_target(rp, m->triangle_count);
  if (count) {
    *level = scree_curve_find(curve, count);
    return SCREE_OK;
  }
  scree_choice choice;
  scree_status status = scree_choose(curve, &m->mesh, NULL, m->progress, &choice, error);
  if (status != SCREE_OK) return status;
  *level = choice.recommended.level_index;
  if (s->rp && scree_choice_is_recommended(s->rp, &rp)) {
    rp = fmin(1, rp * choice.recommended.rp);
    *level = scree_curve_find(curve, scree_choice_target(rp, m->triangle_count));
  }
  scree_choice_free(&choice);
  return SCREE_OK;
}

static bool stays_whole(const making *m) {
  const scree_plan_shape *s = m->shape;
  if (s->triangles && !strcmp(s->triangles, "all")) return true;
  if (!s->triangles && !s->rp) return m->triangle_count <= SCREE_DENSE_SCAN;
  return s->triangles && strtoul(s->triangles, NULL, 10) >= m->triangle_count;
}

static scree_status decimate(making *m, scree_error *error) {
  scree_simplify_options o = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_mesh level_mesh;
  size_t level = 0;
  if (stays_whole(m)) {
    if (m->scale != 1) scree_mesh_scale(&m->mesh, m->scale);
    return SCREE_OK;
  }
  scree_status status =
      scree_curve_build_scaled(&m->mesh, m->scale, &o, m->progress, &curve, error);
  if (status == SCREE_OK) status = pick_level(m, curve, &level, error);
  if (status == SCREE_OK) status = scree_curve_mesh(curve, level, &level_mesh, error);
  scree_curve_free(curve);
  if (status != SCREE_OK) return status;
  scree_mesh_free(&m->mesh);
  m->mesh = level_mesh;
  return SCREE_OK;
}

scree_status scree_scene_box_mesh(const double sides[3], scree_mesh *mesh, scree_error *error) {
  static const unsigned char faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                             {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                             {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  double corners[12 * 9];
  for (int t = 0; t < 12; t++)
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 3; k++)
        corners[9 * t + 3 * c + k] = sides[k] * (faces[t][c] >> k & 1 ? 0.5 : -0.5);
  return scree_mesh_weld(corners, 12, 0, mesh, NULL, error);
}

static scree_status from_mesh(making *m, scree_particle **particle, scree_error *error) {
  scree_status status = scree_mesh_canonicalize(&m->mesh, error);
  size_t spheres = scree_plan_spheres(m->shape);
  if (status == SCREE_OK)
    status = spheres ? scree_clump_fit(&m->mesh, spheres, m->progress, particle, error)
                     : scree_particle_from_mesh(&m->mesh, NULL, particle, error);
  scree_mesh_free(&m->mesh);
  return status;
}

/* "phone.stl, CHECKSUM, 120 of 40000 triangles" */
static char *describe(const making *m, const char *word, const scree_particle *particle) {
  char text[700], sum[SCREE_CHECKSUM_TEXT];
  scree_particle_measures measures;
  scree_particle_measure(particle, &measures);
  if (!*word) return scree_strdup(""); /* the scene says it all */
  int used = snprintf(text, sizeof text, "%.300s", word);
  if (scree_checksum_text(m->checksum, sum))
    used += snprintf(text + used, sizeof text - (size_t)used, ", %s", sum);
  if (m->triangle_count > measures.triangle_count && measures.triangle_count)
    snprintf(text + used, sizeof text - (size_t)used, ", %zu of %zu triangles",
             measures.triangle_count, m->triangle_count);
  else if (measures.triangle_count)
    snprintf(text + used, sizeof text - (size_t)used, ", %zu triangles", measures.triangle_count);
  size_t pieces = scree_particle_piece_count(particle);
  if (pieces > 1)
    snprintf(text + strlen(text), sizeof text - strlen(text),
             ", spheres in %zu pieces that do not touch", pieces);
  return scree_strdup(text);
}

/* The table of spheres that the shape is; NULL: it is none. */
static const char *table_of(const scree_plan_shape *s) {
  if (s->file && scree_is_clump_table(s->file)) return s->file;
  return s->clump && !scree_plan_spheres(s) ? s->clump : NULL;
}

/* What a file's name means: beside the scene's file, unless it begins at the root. */
char *scree_scene_path(const char *folder, const char *name) {
  size_t size = strlen(folder) + strlen(name) + 1;
  char *path = scree_alloc(size, 1);
  if (path) snprintf(path, size, "%s%s", *name == '/' ? "" : folder, name);
  return path;
}

static scree_status make(making *m, const char *path, scree_particle **particle,
                         scree_error *error) {
  const scree_plan_shape *s = m->shape;
  if (!isnan(s->sphere)) return scree_particle_sphere(0.5 * s->sphere, particle, error);
  if (table_of(s)) {
    scree_read_options o = scree_default_read_options();
    o.unit_m = scree_plan_unit(s->unit);
    return scree_particle_clump_read(path, &o, particle, error);
  }
  scree_status status;
  if (s->sample)
    status = make_sample(m, error);
  else if (s->file)
    status = read_scan(m, path, error);
  else
    status = scree_scene_box_mesh(s->box, &m->mesh, error);
  m->triangle_count = m->mesh.triangle_count;
  if (status == SCREE_OK) status = decimate(m, error);
  return status == SCREE_OK ? from_mesh(m, particle, error) : status;
}

scree_status scree_scene_make_particle(const scree_plan_shape *shape, const char *folder,
                                       const scree_progress *progress, scree_particle **particle,
                                       char **source, scree_error *error) {
  making m = {.shape = shape, .progress = progress, .scale = 1};
  const char *table = table_of(shape);
  const char *word = shape->file     ? shape->file
                     : table         ? table
                     : shape->sample ? shape->sample
                                     : shape->place.path;
  char *path = scree_scene_path(folder, word);
  if (!path) return scree_fail_memory(error, strlen(word), "a path");
  scree_particle *made;
  scree_status status = make(&m, path, &made, error);
  scree_free(path);
  if (status != SCREE_OK) {
    scree_mesh_free(&m.mesh);
    return status;
  }
  *source = describe(&m, shape->file || table || shape->sample ? word : "", made);
  if (*source) {
    *particle = made;
    return SCREE_OK;
  }
  scree_particle_free(made);
  return scree_fail_memory(error, 0, "a shape's source");
}

scree_status scree_scene_make_scaled(const scree_plan_shape *shape, const char *folder,
                                     const scree_progress *progress, scree_particle **unscaled,
                                     scree_scene_shape *made, scree_error *error) {
  char *source = NULL;
  scree_status status = SCREE_OK;
  if (!*unscaled)
    status = scree_scene_make_particle(shape, folder, progress, unscaled, &source, error);
  scree_free(source);
  if (status != SCREE_OK) return status;
  double factor = shape->scaled / (*unscaled)->measures.size;
  made->source = scree_strdup(shape->file ? shape->file : shape->sample ? shape->sample : "");
  if (!made->source) return scree_fail_memory(error, 0, "a shape's source");
  return scree_particle_scaled(*unscaled, factor, &made->particle, error);
}
