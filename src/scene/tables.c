/* Tables of sensors: what has more numbers than columns of the series. */
#include "scene/grid.h"
#include "scene/impacts.h"

#include "base/alloc.h"
#include "base/file.h"

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

/* FOLDER/sensor-NAME-WHAT, a file of its own until it is whole. */
static scree_status open_table(const char *folder, const scree_scene_sensor *sensor,
                               const char *what, scree_output *output, scree_error *error) {
  const char *name = sensor->plan->place.name;
  size_t size = strlen(folder) + 3 * strlen(name) + strlen(what) + 16;
  char *path = scree_alloc(size, 1);
  if (!path) return scree_fail_memory(error, size, "a path");
  char *at = path + snprintf(path, size, "%s/sensor-", folder);
  put_name(at, name);
  snprintf(path + strlen(path), size - strlen(path), "-%s", what);
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
  SCREE_TRY(open_table(folder, sensor, "spectra.csv", &output, error));
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
  SCREE_TRY(open_table(folder, sensor, "bodies.csv", &output, error));
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

/* ---- grids ---- */

static void begin_array(FILE *stream, const char *name, int components) {
  fprintf(stream,
          "        <DataArray type=\"Float32\" Name=\"%s\" NumberOfComponents=\"%d\" "
          "format=\"ascii\">\n",
          name, components);
}

static void put_numbers(FILE *stream, const double *values, int count) {
  for (int k = 0; k < count; k++) fprintf(stream, "%.7g%c", values[k], k + 1 < count ? ' ' : '\n');
}

/* One field of all cells: `count` numbers of the record from `offset` on. */
static void put_field(FILE *stream, const scree_scene *scene, const scree_scene_sensor *sensor,
                      const char *name, size_t offset, int count) {
  begin_array(stream, name, count);
  for (size_t c = 0; c < sensor->grid->cell_count; c++) {
    scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
    put_numbers(stream, (const double *)(const void *)((const char *)&f + offset), count);
  }
  fputs("        </DataArray>\n", stream);
}

static void put_shares(FILE *stream, const scree_scene *scene, const scree_scene_sensor *sensor) {
  for (size_t s = 0; s < scene->plan.families.count; s++) {
    char name[96];
    snprintf(name, sizeof name, "share of %s", scene->plan.families.items[s].place.name);
    begin_array(stream, name, 1);
    for (size_t c = 0; c < sensor->grid->cell_count; c++) {
      scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
      double n = (double)(sensor->grid->sample_count ? sensor->grid->sample_count : 1),
             share = f.density > 0 ? f.shares[s] / n / f.density : 0;
      put_numbers(stream, &share, 1);
    }
    fputs("        </DataArray>\n", stream);
  }
}

static void put_corners(FILE *stream, const scree_plan_grid *plan, const size_t n[3]) {
  for (size_t k = 0; k <= n[2]; k++)
    for (size_t j = 0; j <= n[1]; j++)
      for (size_t i = 0; i <= n[0]; i++) {
        double at[3];
        vec3_store(at, scree_grid_corner(plan, i, j, k));
        put_numbers(stream, at, 3);
      }
}

/* VTK's XML of a structured grid, as text. */
static scree_status write_grid(const scree_scene *scene, const scree_scene_sensor *sensor,
                               const char *folder, scree_error *error) {
  const scree_plan_grid *plan = sensor->plan->grid;
  const size_t n[3] = {(size_t)plan->cells[0], (size_t)plan->cells[1], (size_t)plan->cells[2]};
  scree_output output;
  SCREE_TRY(open_table(folder, sensor, "grid.vts", &output, error));
  FILE *out = output.stream;
  fprintf(out,
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\" version=\"1.0\">\n"
          "  <StructuredGrid WholeExtent=\"0 %zu 0 %zu 0 %zu\">\n"
          "    <Piece Extent=\"0 %zu 0 %zu 0 %zu\">\n      <CellData>\n",
          n[0], n[1], n[2], n[0], n[1], n[2]);
#define FIELD(name, member, count)                                                                 \
  put_field(out, scene, sensor, name, offsetof(scree_grid_fields, member), count)
  FIELD("solid fraction", solid, 1);
  FIELD("density [kg/m3]", density, 1);
  FIELD("velocity [m/s]", velocity, 3);
  FIELD("granular temperature [m2/s2]", temperature, 1);
  FIELD("stress [Pa]", stress, 6);
#undef FIELD
  put_shares(out, scene, sensor);
  fputs("      </CellData>\n      <Points>\n", out);
  begin_array(out, "Points", 3);
  put_corners(out, plan, n);
  fputs("        </DataArray>\n      </Points>\n    </Piece>\n  </StructuredGrid>\n</VTKFile>\n",
        out);
  return scree_output_commit(&output, error);
}

/* ---- residence ---- */

static scree_status write_residence(const scree_scene *scene, const scree_scene_sensor *sensor,
                                    const char *folder, scree_error *error) {
  scree_output output;
  SCREE_TRY(open_table(folder, sensor, "residence.csv", &output, error));
  scree_scene_put_stays(scene, sensor, output.stream);
  scree_status status = scree_output_commit(&output, error);
  if (status == SCREE_OK) status = open_table(folder, sensor, "histogram.csv", &output, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_put_histogram(scene, sensor, output.stream, error);
  if (status == SCREE_OK) return scree_output_commit(&output, error);
  scree_output_discard(&output);
  return status;
}

scree_status scree_scene_write_tables(const scree_scene *scene, const char *folder,
                                      scree_error *error) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *sensor = &scene->sensors[i];
    if (sensor->plan->residence) SCREE_TRY(write_residence(scene, sensor, folder, error));
    if (sensor->grid) SCREE_TRY(write_grid(scene, sensor, folder, error));
    if (sensor->impacts) SCREE_TRY(write_spectra(scene, sensor, folder, error));
    if (sensor->impacts) SCREE_TRY(write_bodies(scene, sensor, folder, error));
  }
  return SCREE_OK;
}
