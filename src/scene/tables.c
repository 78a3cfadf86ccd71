/* Tables of sensors: what has more numbers than columns of the series. */
#include "scene/impacts.h"

#include "base/alloc.h"
#include "base/file.h"

#include <stdlib.h>
#include <string.h>

/* What may stand in the name of a file as it is; all else becomes %XX. */
static void put_name(char *to, const char *name) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  for (; *name; name++) {
    bool good = strchr(plain, *name) != NULL;
    to += good ? (*to = *name, 1) : sprintf(to, "%%%02X", (unsigned)(unsigned char)*name);
  }
  *to = 0;
}

/* FOLDER/sensor-NAME-WHAT.csv, a file of its own until it is whole. */
static scree_status open_table(const char *folder, const scree_scene_sensor *sensor,
                               const char *what, scree_output *output, scree_error *error) {
  const char *name = sensor->plan->place.name;
  size_t size = strlen(folder) + 3 * strlen(name) + strlen(what) + 16;
  char *path = scree_alloc(size, 1);
  if (!path) return scree_fail_memory(error, size, "a path");
  char *at = path + snprintf(path, size, "%s/sensor-", folder);
  put_name(at, name);
  strcat(strcat(strcat(at, "-"), what), ".csv");
  scree_status status = scree_output_open(path, true, output, error);
  scree_free(path);
  return status;
}

/* ---- impacts ---- */

static void put_spectra(FILE *stream, const scree_scene *scene, const scree_scene_sensor *sensor,
                        const double window[2], const double *spectra) {
  const scree_scene_impacts *impacts = sensor->impacts;
  const size_t bins = impacts->bin_count;
  for (size_t c = 0; c < impacts->class_count; c++, spectra += SCREE_IMPACT_SPECTRA * bins) {
    const char *names[2];
    scree_impact_class_names(scene, sensor, c, names);
    for (size_t b = 0; b < bins; b++) {
      double low = b ? scree_impact_bin(sensor->plan->impacts, b) : 0,
             high =
                 b + 1 < bins ? scree_impact_bin(sensor->plan->impacts, b + 1) : (double)INFINITY;
      if (spectra[b] + spectra[bins + b] + spectra[2 * bins + b] == 0) continue;
      fprintf(stream, "%.9g,%.9g,%s,%s,%.6g,%.6g,%.0f,%.0f,%.0f\n", window[0], window[1], names[0],
              names[1], low, high, spectra[b], spectra[bins + b], spectra[2 * bins + b]);
    }
  }
}

static scree_status write_spectra(const scree_scene *scene, const scree_scene_sensor *sensor,
                                  const char *folder, scree_error *error) {
  const scree_scene_impacts *impacts = sensor->impacts;
  const size_t width = impacts->class_count * SCREE_IMPACT_SPECTRA * impacts->bin_count + 2;
  scree_output output;
  scree_status status = open_table(folder, sensor, "spectra", &output, error);
  if (status != SCREE_OK) return status;
  fputs("from [s],until [s],a,b,energy_from [J],energy_until [J],approach,normal,tangential\n",
        output.stream);
  for (size_t at = 0; at + width <= impacts->windows.count; at += width)
    put_spectra(output.stream, scene, sensor, impacts->windows.items + at,
                impacts->windows.items + at + 2);
  const double last[2] = {impacts->window_from, scree_world_time(scene->world)};
  put_spectra(output.stream, scene, sensor, last, impacts->spectra);
  return scree_output_commit(&output, error);
}

static scree_status write_bodies(const scree_scene *scene, const scree_scene_sensor *sensor,
                                 const char *folder, scree_error *error) {
  const scree_scene_impacts *impacts = sensor->impacts;
  scree_output output;
  scree_status status = open_table(folder, sensor, "bodies", &output, error);
  if (status != SCREE_OK) return status;
  fputs("body,shape,count,approach [J],normal [J],tangential [J],damage [J],largest [J]\n",
        output.stream);
  for (size_t b = 0; b < impacts->bodies.count / SCREE_IMPACT_OF_BODY; b++) {
    const double *v = impacts->bodies.items + b * SCREE_IMPACT_OF_BODY;
    if (v[SCREE_IMPACT_COUNT] + v[SCREE_IMPACT_NORMAL] + v[SCREE_IMPACT_TANGENTIAL] == 0) continue;
    fprintf(output.stream, "%zu,%s,%.0f,%.9g,%.9g,%.9g,%.9g,%.9g\n", b,
            scree_scene_shape_name(scene, scree_scene_body_shape(scene, b)), v[SCREE_IMPACT_COUNT],
            v[SCREE_IMPACT_APPROACH], v[SCREE_IMPACT_NORMAL], v[SCREE_IMPACT_TANGENTIAL],
            v[SCREE_IMPACT_DAMAGE], v[SCREE_IMPACT_LARGEST]);
  }
  return scree_output_commit(&output, error);
}

scree_status scree_scene_write_tables(const scree_scene *scene, const char *folder,
                                      scree_error *error) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *sensor = &scene->sensors[i];
    if (sensor->impacts) status = write_spectra(scene, sensor, folder, error);
    if (sensor->impacts && status == SCREE_OK) status = write_bodies(scene, sensor, folder, error);
  }
  return status;
}
