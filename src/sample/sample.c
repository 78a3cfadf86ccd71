/* The samples by name: drawing -> distance field -> net -> scanner noise -> mesh. */
#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "sample/device.h"
#include "sample/net.h"
#include "sample/scanner.h"
#include "sample/test_solid.h"

#include <string.h>

static const double sphere_radius = 25e-3; /* m */
static const double box_edge = 69.12e-3;   /* m: 256 cells of 0.27 mm, 786,432 triangles */
static const double resolution_low = 0.02e-3, resolution_high = 5e-3; /* m */
static const double noise_share = 0.25; /* of the resolution: more would fold the surface */

enum { ICOSPHERE_LEVELS = 11, SOLID_COUNT = 4 };

static const struct {
  const char *name, *description;
} solids[SOLID_COUNT] = {
    {"sphere", "sphere of 25 mm radius, meshed as the devices are"},
    {"box", "cube of 69.12 mm, its faces gridded at the resolution"},
    {"box-12", "the same cube of 12 triangles"},
    {"icosphere", "geodesic sphere of 25 mm radius; icosphere-0 to -11 name the level"},
};

static const scree_device *device_at(size_t index) {
  return index < 3   ? &scree_feature_phones[index]
         : index < 6 ? &scree_cameras[index - 3]
                     : &scree_smartphones[index - 6];
}

size_t scree_sample_count(void) {
  return SCREE_SAMPLE_DEVICES + SOLID_COUNT;
}

const char *scree_sample_name(size_t index) {
  return index < SCREE_SAMPLE_DEVICES   ? device_at(index)->name
         : index < scree_sample_count() ? solids[index - SCREE_SAMPLE_DEVICES].name
                                        : NULL;
}

const char *scree_sample_description(size_t index) {
  return index < SCREE_SAMPLE_DEVICES   ? device_at(index)->description
         : index < scree_sample_count() ? solids[index - SCREE_SAMPLE_DEVICES].description
                                        : NULL;
}

scree_sample_options scree_default_sample_options(void) {
  return (scree_sample_options){.resolution = 0.27e-3, .noise = 0.02e-3, .seed = 1};
}

/* ---- Making ---- */

static scree_status make_shape(const scree_piece_mm *lines, size_t line_count, double resolution,
                               scree_ticker *ticker, scree_mesh *mesh, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) scree_shape *shape = scree_alloc(1, sizeof *shape);
  if (!shape) return scree_fail_memory(error, sizeof *shape, "a sample's shape");
  bool built = scree_shape_build(lines, line_count, shape);
  SCREE_ASSERT(built);
  (void)built;
  return scree_net_mesh(shape, resolution, ticker, mesh, error);
}

static scree_status make_device(const scree_device *device, const scree_sample_options *options,
                                scree_ticker *ticker, scree_mesh *mesh, scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  SCREE_TRY(
      make_shape(device->lines, device->line_count, options->resolution, ticker, &made, error));
  scree_scanner scanner = {options->noise, options->seed};
  if (options->noise > 0) SCREE_TRY(scree_scanner_apply(&scanner, &made, error));
  *mesh = made;
  made = (scree_mesh){0};
  return SCREE_OK;
}

/* The least level whose edges are no longer than the resolution on average: an icosahedron's edge
 * is 1.0515 radii, and each level halves it, a little less so near the corners. */
static int icosphere_level(double resolution) {
  double edge = 1.13 * sphere_radius;
  int level = 0;
  for (; level < ICOSPHERE_LEVELS && edge > resolution; level++) edge *= 0.5;
  return level;
}

static scree_status make_solid(size_t index, double resolution, scree_ticker *ticker,
                               scree_mesh *mesh, scree_error *error) {
  static const scree_piece_mm ball[] = {{.kind = SCREE_PIECE_PART},
                                        {.kind = SCREE_PIECE_CAPSULE, .half = {25, 25, 0}}};
  switch (index) {
  case 0:
    return make_shape(ball, 2, resolution, ticker, mesh, error);
  case 1:
    return scree_sample_box(box_edge, (size_t)ceil(box_edge / resolution - 1e-6), mesh, error);
  case 2:
    return scree_sample_box(box_edge, 1, mesh, error);
  default:
    return scree_sample_icosphere(sphere_radius, icosphere_level(resolution), mesh, error);
  }
}

/* The level in "icosphere-7", or -1. */
static int level_in_name(const char *name) {
  const char *prefix = "icosphere-";
  size_t length = strlen(prefix);
  if (strncmp(name, prefix, length) != 0) return -1;
  int level = 0;
  const char *digit = name + length;
  if (digit[0] == 0 || strlen(digit) > 2 || (digit[0] == '0' && digit[1])) return -1;
  for (; *digit; digit++) {
    if (*digit < '0' || *digit > '9') return -1;
    level = 10 * level + (*digit - '0');
  }
  return level <= ICOSPHERE_LEVELS ? level : -1;
}

static scree_status check(const scree_sample_options *options, scree_error *error) {
  if (!(options->resolution >= resolution_low && options->resolution <= resolution_high))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a resolution of %g mm is outside %g mm to %g mm",
                      options->resolution * 1e3, resolution_low * 1e3, resolution_high * 1e3);
  if (!(options->noise >= 0 && options->noise <= noise_share * options->resolution))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "a noise of %g mm is outside 0 to %g mm, a quarter of the resolution",
                      options->noise * 1e3, noise_share * options->resolution * 1e3);
  return SCREE_OK;
}

scree_status scree_sample_make(const char *name, const scree_sample_options *options,
                               const scree_progress *progress, scree_mesh *mesh,
                               scree_error *error) {
  scree_sample_options defaults = scree_default_sample_options();
  if (!options) options = &defaults;
  SCREE_TRY(check(options, error));
  int level = level_in_name(name);
  if (level >= 0) return scree_sample_icosphere(sphere_radius, level, mesh, error);
  scree_ticker ticker = {.progress = progress};
  for (size_t i = 0; i < scree_sample_count(); i++) {
    if (strcmp(name, scree_sample_name(i)) != 0) continue;
    return i < SCREE_SAMPLE_DEVICES
               ? make_device(device_at(i), options, &ticker, mesh, error)
               : make_solid(i - SCREE_SAMPLE_DEVICES, options->resolution, &ticker, mesh, error);
  }
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "'%.64s' is no sample (fp-1 to fp-3, dc-1 to dc-3, sp-1 to sp-3, sphere, box, "
                    "box-12, icosphere, icosphere-0 to icosphere-%d)",
                    name, ICOSPHERE_LEVELS);
}
