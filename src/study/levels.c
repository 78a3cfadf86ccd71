/* Levels of a study's shapes: the file of each in the study's folder, and the particle in it. */
#include "base/math.h"
#include "base/number.h"
#include "study/study.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979324;
enum { MOST_SPHERES = 300 };

size_t scree_study_spheres(const char *rp) {
  static const char prefix[] = "clump:";
  double count;
  if (strncmp(rp, prefix, sizeof prefix - 1) != 0) return 0;
  bool good = scree_number_read(rp + sizeof prefix - 1, &count) && count >= 1 &&
              count <= MOST_SPHERES && count == floor(count);
  return good ? (size_t)count : 0;
}

double scree_study_rp(const scree_study_shape *shape, const char *text) {
  double rp = NAN, factor;
  if (!strcmp(text, "scan")) return 1;
  if (scree_choice_is_recommended(text, &factor)) return fmin(1, factor * shape->recommended_rp);
  scree_number_read(text, &rp);
  return rp;
}

const char *scree_study_level_path(const scree_study *study, const scree_study_shape *shape,
                                   const char *rp, char path[SCREE_PATH_BYTES]) {
  char ending[64], number[SCREE_NUMBER_SIZE];
  double factor;
  if (!strcmp(rp, "scan")) {
    snprintf(ending, sizeof ending, "-scan.ply");
  } else if (scree_study_spheres(rp)) {
    snprintf(ending, sizeof ending, "-clump%zu.csv", scree_study_spheres(rp));
  } else if (scree_choice_is_recommended(rp, &factor)) {
    scree_number_format_digits(factor, 9, number);
    snprintf(ending, sizeof ending, "-%s-recommended.ply", number);
  } else {
    scree_number_format_digits(scree_study_rp(shape, rp), 9, number);
    snprintf(ending, sizeof ending, "-rp%s.ply", number);
  }
  return scree_study_path(study, "shapes", shape->name, ending, path);
}

static scree_status read_mesh_particle(const char *path, scree_particle **particle,
                                       scree_error *error) {
  scree_read_options read = scree_default_read_options();
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  read.unit_m = 1;
  SCREE_TRY(scree_scan_read(path, &read, &scan, error));
  return scree_particle_from_mesh(&scan.mesh, NULL, particle, error);
}

static scree_status make_particle(const scree_study *study, const scree_study_shape *shape,
                                  const char *rp, scree_particle **particle, scree_error *error) {
  if (!strcmp(rp, "spheres"))
    return scree_particle_sphere(scree_cbrt(0.75 * shape->volume / pi), particle, error);
  scree_read_options read = scree_default_read_options();
  read.unit_m = 1;
  const char *path = SCREE_LEVEL_PATH(study, shape, rp);
  scree_status status = scree_study_spheres(rp)
                            ? scree_particle_clump_read(path, &read, particle, error)
                            : read_mesh_particle(path, particle, error);
  if (status == SCREE_OK || !error) return status;
  scree_error inner = *error;
  return scree_fail(error, status, "%s at rp %s: %.700s", shape->name, rp, inner.message);
}

scree_status scree_study_make_shape(const scree_study *study, size_t shape, const char *rp,
                                    scree_shape_made *made, scree_error *error) {
  const scree_study_shape *known = &study->shapes[shape];
  scree_shape_made result = {.scan_triangle_count = (size_t)known->triangle_count,
                             .scan_volume = known->volume,
                             .recommended = known->recommended_rp,
                             .checksum = known->checksum};
  scree_particle_measures m;
  SCREE_TRY(make_particle(study, known, rp, &result.particle, error));
  scree_particle_measure(result.particle, &m);
  result.triangle_count = m.triangle_count;
  *made = result;
  return SCREE_OK;
}
