/* Particles for a run from a scan: a level of its decimation, or the sphere of its volume. */
#include "base/error.h"
#include "base/math.h"

#include <math.h>

scree_grain_options scree_default_grain_options(void) {
  return (scree_grain_options){.rp = 1, .mass_rule = SCREE_MASS_FROM_MESH};
}

void scree_grain_free(scree_grain *grain) {
  if (!grain) return;
  scree_particle_free(grain->run.particle);
  *grain = (scree_grain){0};
}

/* The level of the scan in the order of its curve; *mesh is to be freed. */
static scree_status take_level(const scree_mesh *scan, const scree_curve *curve, double rp,
                               const scree_progress *progress, scree_mesh *mesh,
                               scree_error *error) {
  size_t target = scree_choice_target(rp, scan->triangle_count);
  scree_curve *own = NULL;
  if (!curve) {
    scree_simplify_options o = scree_default_simplify_options();
    o.stop_count = target;
    scree_status status = scree_curve_build(scan, &o, progress, &own, error);
    if (status != SCREE_OK) return status;
    curve = own;
  }
  scree_status status = scree_curve_mesh(curve, scree_curve_find(curve, target), mesh, error);
  scree_curve_free(own);
  return status;
}

/* In canonical order: a study, which reads its levels from files, has the same bits. */
static scree_status make_level(const scree_mesh *scan, const scree_curve *curve, double rp,
                               const scree_progress *progress, scree_mesh *mesh,
                               scree_error *error) {
  scree_mesh made = {0};
  scree_status status = rp < 1 ? take_level(scan, curve, rp, progress, &made, error)
                               : scree_mesh_copy(scan, &made, error);
  if (status == SCREE_OK) status = scree_mesh_canonicalize(&made, error);
  if (status == SCREE_OK)
    *mesh = made;
  else
    scree_mesh_free(&made);
  return status;
}

static scree_status make_particle(const scree_mesh *mesh, const scree_grain_options *options,
                                  double volume, const scree_progress *progress,
                                  scree_particle **particle, scree_error *error) {
  if (options->clump) return scree_clump_fit(mesh, options->clump, progress, particle, error);
  if (options->sphere)
    return scree_particle_sphere(scree_cbrt(0.75 * volume / 3.14159265358979324), particle, error);
  scree_particle_options o = scree_default_particle_options();
  o.rounding = options->rounding;
  return scree_particle_from_mesh(mesh, &o, particle, error);
}

scree_status scree_grain_make(const scree_mesh *scan, const scree_curve *curve,
                              const scree_grain_options *options, const scree_progress *progress,
                              scree_grain *grain, scree_error *error) {
  const scree_grain_options defaults = scree_default_grain_options();
  if (!options) options = &defaults;
  if (!(options->rp > 0 && options->rp <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "Rp %g: must be above 0 and at most 1",
                      options->rp);
  scree_grain made = {.run = {.density_factor = 1}, .scan_triangle_count = scan->triangle_count};
  scree_status status = scree_mesh_area_volume(scan, NULL, &made.scan_volume, error);
  if (status != SCREE_OK) return status;
  if (!(made.scan_volume > 0))
    return scree_fail(error, SCREE_BAD_MESH, "the volume is %g m3: not an outward surface",
                      made.scan_volume);
  scree_mesh level = {0};
  if (!options->sphere || options->clump)
    status = make_level(scan, curve, options->rp, progress, &level, error);
  if (status == SCREE_OK)
    status = make_particle(&level, options, made.scan_volume, progress, &made.run.particle, error);
  scree_mesh_free(&level);
  if (status != SCREE_OK) return status;
  scree_particle_measures m;
  scree_particle_measure(made.run.particle, &m);
  made.volume = m.volume;
  made.triangle_count = m.triangle_count;
  made.rp_reached = (double)m.triangle_count / (double)scan->triangle_count;
  if (options->mass_rule == SCREE_MASS_FROM_SCAN)
    made.run.density_factor = made.scan_volume / made.volume;
  *grain = made;
  return SCREE_OK;
}
