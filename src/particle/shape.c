/* From what a shape is made from to its particle. A scan is read, checked, repaired where need be,
 * decimated to the level that is asked for, put into canonical order and made a particle, a clump
 * that stands for it, or the sphere of its volume. */
#include "particle/shape.h"
#include "base/alloc.h"
#include "base/array.h"
#include "base/math.h"
#include "base/number.h"
#include "choice/criterion.h"
#include "particle/particle.h"

#include <math.h>
#include <string.h>

enum { MOST_SPHERES = 300, KEY_BYTES = 700 };
static const char clump_prefix[] = "clump:";
static const double pi = 3.14159265358979324;

scree_shape_spec scree_default_shape_spec(void) {
  return (scree_shape_spec){.sample_seed = 1, .noise = NAN, .method = SCREE_METHOD_VOLUME};
}

/* ---- levels ---- */

/* Spheres of "clump:20"; 0: it is no such level. */
static size_t clump_of(const char *level) {
  double count;
  if (!level || strncmp(level, clump_prefix, sizeof clump_prefix - 1) != 0) return 0;
  bool good = scree_number_read(level + sizeof clump_prefix - 1, &count) && count >= 1 &&
              count <= MOST_SPHERES && count == floor(count);
  return good ? (size_t)count : 0;
}

static bool is_whole(const char *level) {
  return level && (!strcmp(level, "all") || !strcmp(level, "scan"));
}
static bool is_spheres(const char *level) {
  return level && !strcmp(level, "spheres");
}

const char *scree_shape_level_error(const char *level) {
  double rp;
  if (is_whole(level) || is_spheres(level) || clump_of(level) ||
      scree_choice_is_recommended(level, &rp) ||
      (scree_number_read(level, &rp) && rp > 0 && rp <= 1))
    return NULL;
  return "must be a number above 0 and at most 1, recommended, a multiple as 0.5*recommended, "
         "scan, "
         "spheres, or clump:N with N from 1 to 300";
}

/* ---- the store ---- */

typedef struct kept {
  char *key;
  scree_shape_made made;
} kept;

/* The scan at hand: in metres once its mesh is multiplied by the scale. */
typedef struct scan {
  char *key; /* NULL: there is none */
  scree_mesh mesh;
  double scale;
  scree_checksum checksum;
  bool repaired;
  size_t part_count;
  char part_name[64];
  double volume;      /* m3 */
  scree_curve *curve; /* NULL: not yet */
  double recommended; /* Rp; NaN: not yet */
  int order;          /* of the curve in which that is */
} scan;

struct scree_shape_store {
  struct {
    kept *items;
    size_t count, capacity;
  } shapes;
  scan scan;
};

scree_status scree_shape_store_create(scree_shape_store **store, scree_error *error) {
  *store = scree_alloc_zero(1, sizeof **store);
  return *store ? SCREE_OK : scree_fail_memory(error, sizeof **store, "shapes");
}

static void forget_scan(scan *s) {
  scree_free(s->key);
  scree_mesh_free(&s->mesh);
  scree_curve_free(s->curve);
  *s = (scan){0};
}

void scree_shape_store_free(scree_shape_store *store) {
  if (!store) return;
  for (size_t i = 0; i < store->shapes.count; i++) {
    scree_free(store->shapes.items[i].key);
    scree_particle_free(store->shapes.items[i].made.particle);
  }
  scree_free(store->shapes.items);
  forget_scan(&store->scan);
  scree_free(store);
}

/* ---- reading ---- */

static scree_status read_sample(const scree_shape_spec *spec, const scree_progress *progress,
                                scan *s, scree_error *error) {
  scree_sample_options o = scree_default_sample_options();
  if (spec->resolution > 0) o.resolution = spec->resolution;
  if (isnan(spec->noise))
    o.noise = fmin(o.noise, 0.25 * o.resolution); /* more would fold the surface */
  else
    o.noise = spec->noise;
  o.seed = spec->sample_seed;
  return scree_sample_make(spec->sample, &o, progress, &s->mesh, error);
}

/* As if in millimetres: levels must not hang on the unit. unit_m 0: that one; else in that unit. */
static scree_status read_file(const scree_shape_spec *spec, double unit_m,
                              const scree_progress *progress, scan *s, scree_error *error) {
  scree_read_options o = scree_default_read_options();
  scree_repair_options repair = scree_default_repair_options();
  scree_repair_report report = {.before.usable = true};
  SCREE_CLEANUP(scree_scan_free) scree_scan read = {0};
  double usual = o.unit_m;
  if (unit_m > 0) o.unit_m = unit_m;
  o.ignore_comment_unit = true;
  o.part = spec->part;
  SCREE_TRY(scree_scan_read(spec->file, &o, &read, error));
  double unit = spec->unit_m > 0          ? spec->unit_m
                : read.comment_unit_m > 0 ? read.comment_unit_m
                                          : usual;
  s->scale = read.states_unit ? 1 : unit / usual;
  s->checksum = read.checksum;
  if (spec->thickness > 0) {
    double thickness = unit_m > 0 ? spec->thickness : spec->thickness / s->scale;
    return scree_mesh_thicken(&read.mesh, thickness, &s->mesh, error);
  }
  if (spec->part && !read.part_count) repair.keep_body = spec->part;
  SCREE_TRY(scree_mesh_prepare(&read.mesh, spec->no_repair ? NULL : &repair, progress, &read.mesh,
                               &report, error));
  s->repaired = !report.before.usable;
  s->part_count =
      read.part_count ? read.part_count : 1 + report.before.defects[SCREE_DEFECT_EXTRA_BODY];
  memcpy(s->part_name, read.part_name, sizeof s->part_name);
  s->mesh = read.mesh;
  read.mesh = (scree_mesh){0};
  return SCREE_OK;
}

scree_status scree_box_mesh(const double sides[3], scree_mesh *mesh, scree_error *error) {
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

static scree_status read_scan(const scree_shape_spec *spec, const scree_progress *progress, scan *s,
                              scree_error *error) {
  s->scale = 1;
  s->recommended = NAN;
  SCREE_TRY(spec->sample ? read_sample(spec, progress, s, error)
            : spec->file ? read_file(spec, 0, progress, s, error)
                         : scree_box_mesh(spec->box, &s->mesh, error));
  SCREE_TRY(scree_mesh_area_volume(&s->mesh, NULL, &s->volume, error));
  s->volume *= s->scale * s->scale * s->scale;
  if (s->volume > 0) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH, "the volume is %g m3: not an outward surface",
                    s->volume);
}

/* ---- decimation ---- */

/* Triangles that the level may have; 0: it is the one that `choose` recommends, by *factor. */
static size_t target_of(const scree_shape_spec *spec, size_t triangles, double *factor) {
  double rp;
  *factor = 1;
  if (spec->triangle_count) return spec->triangle_count;
  if (clump_of(spec->level) || (!spec->level && spec->spheres)) return SCREE_CLUMP_TRIANGLES;
  if (!spec->level || scree_choice_is_recommended(spec->level, factor)) return 0;
  return scree_number_read(spec->level, &rp) ? scree_choice_target(rp, triangles) : triangles;
}

/* Whether the scan is taken as it is. */
static bool stays_whole(const scree_shape_spec *spec, size_t triangles) {
  double factor;
  if (is_whole(spec->level) || is_spheres(spec->level)) return true;
  if (!spec->level && !spec->triangle_count) return triangles <= SCREE_DENSE_SCAN;
  size_t target = target_of(spec, triangles, &factor);
  return target >= triangles;
}

static scree_status choose(scan *s, const scree_progress *progress, scree_error *error) {
  scree_choice choice;
  if (!isnan(s->recommended)) return SCREE_OK;
  SCREE_TRY(scree_choose(s->curve, &s->mesh, NULL, progress, &choice, error));
  s->recommended = choice.recommended.rp;
  s->order = choice.order;
  scree_choice_free(&choice);
  return SCREE_OK;
}

/* keeps: whether other levels may be asked for, so that the curve must be whole. */
static scree_status decimate(const scree_shape_spec *spec, scan *s, bool keeps,
                             const scree_progress *progress, scree_mesh *level,
                             scree_error *error) {
  size_t triangles = s->mesh.triangle_count;
  double factor;
  size_t target = target_of(spec, triangles, &factor);
  scree_simplify_options o = scree_default_simplify_options();
  o.method = spec->method;
  if (target && !keeps) o.stop_count = target;
  if (!s->curve)
    SCREE_TRY(scree_curve_build_scaled(&s->mesh, s->scale, &o, progress, &s->curve, error));
  const bool chosen = !target; /* else a level is that of the first order, whatever was chosen */
  if (chosen) {
    SCREE_TRY(choose(s, progress, error));
    target = scree_choice_target(fmin(1, factor * s->recommended), triangles);
  }
  SCREE_TRY(scree_curve_reorder(s->curve, chosen ? s->order : 0, error));
  return scree_curve_mesh(s->curve, scree_curve_find(s->curve, target), level, error);
}

/* In metres; read anew where that is another unit, because a multiplication may miss the numbers of
 * the file by rounding. */
static scree_status take_whole(const scree_shape_spec *spec, const scan *s,
                               const scree_progress *progress, scree_mesh *level,
                               scree_error *error) {
  if (s->scale == 1 || !strcmp(spec->file, "-")) {
    SCREE_TRY(scree_mesh_copy(&s->mesh, level, error));
    if (s->scale != 1) scree_mesh_scale(level, s->scale);
    return SCREE_OK;
  }
  scan again = {0};
  double unit = s->scale * scree_default_read_options().unit_m;
  SCREE_TRY(read_file(spec, unit, progress, &again, error));
  *level = again.mesh;
  return SCREE_OK;
}

static scree_status from_level(const scree_shape_spec *spec, scree_mesh *level,
                               const scree_progress *progress, scree_particle **particle,
                               scree_error *error) {
  size_t spheres = clump_of(spec->level) ? clump_of(spec->level) : spec->spheres;
  if (!spheres && level->triangle_count > SCREE_MOST_TRIANGLES)
    return scree_fail(error, SCREE_LIMIT,
                      "%zu triangles are too many for a particle (at most %d): give an Rp, or "
                      "decimate first (scree choose, scree simplify)",
                      level->triangle_count, SCREE_MOST_TRIANGLES);
  SCREE_TRY(scree_mesh_canonicalize(level, error));
  return spheres ? scree_clump_fit(level, spheres, progress, particle, error)
                 : scree_particle_from_mesh(level, NULL, particle, error);
}

static scree_status from_scan(const scree_shape_spec *spec, scan *s, bool keeps,
                              const scree_progress *progress, scree_shape_made *made,
                              scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh level = {0};
  if (is_spheres(spec->level)) {
    SCREE_TRY(scree_particle_sphere(scree_cbrt(0.75 * s->volume / pi), &made->particle, error));
  } else {
    SCREE_TRY(stays_whole(spec, s->mesh.triangle_count)
                  ? take_whole(spec, s, progress, &level, error)
                  : decimate(spec, s, keeps, progress, &level, error));
    SCREE_TRY(from_level(spec, &level, progress, &made->particle, error));
  }
  made->scan_triangle_count = s->mesh.triangle_count;
  made->scan_volume = s->volume;
  made->recommended = s->recommended;
  made->repaired = s->repaired;
  made->part_count = s->part_count;
  memcpy(made->part_name, s->part_name, sizeof made->part_name);
  made->checksum = s->checksum;
  return SCREE_OK;
}

static scree_status from_table(const scree_shape_spec *spec, scree_shape_made *made,
                               scree_error *error) {
  scree_read_options o = scree_default_read_options();
  scree_particle_measures m;
  if (spec->unit_m > 0) o.unit_m = spec->unit_m;
  o.ignore_comment_unit = spec->unit_m > 0;
  SCREE_TRY(scree_particle_clump_read(spec->table, &o, &made->particle, error));
  scree_particle_measure(made->particle, &m);
  made->scan_volume = m.volume;
  if (!is_spheres(spec->level)) return SCREE_OK;
  scree_particle_free(made->particle);
  return scree_particle_sphere(0.5 * m.size, &made->particle, error);
}

/* ---- all together ---- */

/* What the scan follows from, and behind it what the particle does. */
static char *key_of(const scree_shape_spec *s, bool level) {
  char text[KEY_BYTES];
  const char *name = s->file ? s->file : s->sample ? s->sample : s->table ? s->table : "";
  size_t size = strlen(name) + sizeof text;
  char *key = scree_alloc(size, 1);
  snprintf(text, sizeof text,
           "%d%d%d %zu %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %llu %d %d", s->file != NULL,
           s->sample != NULL, s->table != NULL, s->part, s->thickness, s->sphere, s->box[0],
           s->box[1], s->box[2], s->unit_m, s->resolution, s->noise,
           (unsigned long long)s->sample_seed, s->no_repair, (int)s->method);
  if (key && level)
    snprintf(key, size, "%s %s %.200s %zu %zu", name, text, s->level ? s->level : "",
             s->triangle_count, s->spheres);
  else if (key)
    snprintf(key, size, "%s %s", name, text);
  return key;
}

static scree_status make_from_scan(const scree_shape_spec *spec, scree_shape_store *store,
                                   const scree_progress *progress, scree_shape_made *made,
                                   scree_error *error) {
  scan own = {0}, *s = store ? &store->scan : &own;
  SCREE_CLEANUP(scree_free_at) char *key = key_of(spec, false);
  if (!key) return scree_fail_memory(error, 0, "a shape");
  scree_status status = SCREE_OK;
  if (!s->key || strcmp(s->key, key) != 0) {
    forget_scan(s);
    status = read_scan(spec, progress, s, error);
    if (status == SCREE_OK) s->key = key, key = NULL;
  }
  if (status == SCREE_OK) status = from_scan(spec, s, store != NULL, progress, made, error);
  if (!store || !s->key) forget_scan(s);
  return status;
}

static scree_status make(const scree_shape_spec *spec, scree_shape_store *store,
                         const scree_progress *progress, scree_shape_made *made,
                         scree_error *error) {
  scree_shape_made result = {.recommended = NAN};
  if (spec->sphere > 0) {
    result.scan_volume = pi / 6 * spec->sphere * spec->sphere * spec->sphere;
    SCREE_TRY(scree_particle_sphere(0.5 * spec->sphere, &result.particle, error));
  } else if (spec->table) {
    SCREE_TRY(from_table(spec, &result, error));
  } else {
    SCREE_TRY(make_from_scan(spec, store, progress, &result, error));
  }
  scree_particle_measures m;
  scree_particle_measure(result.particle, &m);
  result.triangle_count = m.triangle_count;
  *made = result;
  return SCREE_OK;
}

scree_status scree_shape_store_put(scree_shape_store *store, const scree_shape_spec *spec,
                                   const scree_shape_made *made, scree_error *error) {
  kept one = {key_of(spec, true), *made};
  if (!one.key || !SCREE_PUSH(&store->shapes, one)) {
    scree_free(one.key);
    return scree_fail_memory(error, sizeof one, "shapes");
  }
  scree_particle_retain(made->particle);
  return SCREE_OK;
}

scree_status scree_shape_store_give(scree_shape_store *store, const char *file,
                                    scree_particle *particle, scree_error *error) {
  scree_shape_spec spec = scree_default_shape_spec();
  scree_particle_measures m;
  spec.file = file;
  scree_particle_measure(particle, &m);
  const scree_shape_made made = {.particle = particle,
                                 .scan_triangle_count = m.triangle_count,
                                 .triangle_count = m.triangle_count,
                                 .scan_volume = m.volume,
                                 .recommended = NAN};
  return scree_shape_store_put(store, &spec, &made, error);
}

scree_status scree_shape_make(const scree_shape_spec *spec, scree_shape_store *store,
                              const scree_progress *progress, scree_shape_made *made,
                              scree_error *error) {
  const char *wrong = spec->level ? scree_shape_level_error(spec->level) : NULL;
  if (wrong)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the level '%.60s': %s", spec->level, wrong);
  SCREE_CLEANUP(scree_free_at) char *key = store ? key_of(spec, true) : NULL;
  if (store && !key) return scree_fail_memory(error, 0, "a shape");
  for (size_t i = 0; store && i < store->shapes.count; i++) {
    if (strcmp(store->shapes.items[i].key, key) != 0) continue;
    *made = store->shapes.items[i].made;
    scree_particle_retain(made->particle);
    return SCREE_OK;
  }
  scree_shape_made one = {0};
  SCREE_TRY(make(spec, store, progress, &one, error));
  scree_status status = store ? scree_shape_store_put(store, spec, &one, error) : SCREE_OK;
  if (status == SCREE_OK)
    *made = one;
  else
    scree_particle_free(one.particle);
  return status;
}
