/* Shapes of a scene: their plan as what a particle is made from (particle/shape.c). */
#include "scene/scene.h"

#include "base/alloc.h"
#include "particle/particle.h"

#include <stdlib.h>
#include <string.h>

static bool is_count(const char *text) {
  return text && *text && !text[strspn(text, "0123456789")];
}

/* The table of spheres that the shape is; NULL: it is none. */
static const char *table_of(const scree_plan_shape *s) {
  if (s->file && scree_is_clump_table(s->file)) return s->file;
  return s->clump && !scree_plan_spheres(s) ? s->clump : NULL;
}

scree_shape_spec scree_scene_shape_spec(const scree_plan_shape *s, const char *path) {
  const bool table = table_of(s) != NULL;
  scree_shape_spec spec = scree_default_shape_spec();
  spec.file = s->file && !table ? path : NULL;
  spec.sample = s->sample;
  spec.table = table ? path : NULL;
  spec.sphere = isnan(s->sphere) ? 0 : s->sphere;
  if (!isnan(s->box[0])) memcpy(spec.box, s->box, sizeof spec.box);
  spec.thickness = isnan(s->thickness) ? 0 : s->thickness;
  spec.unit_m = s->unit < 0 ? 0 : scree_plan_unit(s->unit);
  spec.resolution = isnan(s->resolution) ? 0 : s->resolution;
  spec.noise = s->noise;
  spec.sample_seed = s->sample_seed;
  spec.no_repair = !s->repair;
  spec.method = (scree_method)s->method;
  spec.level = s->rp ? s->rp : is_count(s->triangles) ? NULL : s->triangles;
  spec.triangle_count = is_count(s->triangles) ? strtoul(s->triangles, NULL, 10) : 0;
  spec.spheres = scree_plan_spheres(s);
  return spec;
}

static const char *name_of(const scree_plan_shape *s) {
  const char *table = table_of(s);
  return table ? table : s->file ? s->file : s->sample;
}

/* "phone.stl, CHECKSUM, 120 of 40000 triangles" */
static char *describe(const scree_plan_shape *shape, const scree_shape_made *made) {
  char text[700], sum[SCREE_CHECKSUM_TEXT];
  const char *name = name_of(shape);
  if (!name) return scree_strdup(""); /* the scene says it all */
  int used = snprintf(text, sizeof text, "%.300s", name);
  if (scree_checksum_text(made->checksum, sum))
    used += snprintf(text + used, sizeof text - (size_t)used, ", %s", sum);
  if (made->scan_triangle_count > made->triangle_count && made->triangle_count)
    used += snprintf(text + used, sizeof text - (size_t)used, ", %zu of %zu triangles",
                     made->triangle_count, made->scan_triangle_count);
  else if (made->triangle_count)
    used +=
        snprintf(text + used, sizeof text - (size_t)used, ", %zu triangles", made->triangle_count);
  size_t pieces = scree_particle_piece_count(made->particle);
  if (pieces > 1)
    used += snprintf(text + used, sizeof text - (size_t)used,
                     ", spheres in %zu pieces that do not touch", pieces);
  if (made->repaired) snprintf(text + used, sizeof text - (size_t)used, ", repaired");
  return scree_strdup(text);
}

scree_status scree_scene_make_unscaled(const scree_plan_shape *plan, const char *folder,
                                       size_t part, scree_shape_store *store,
                                       const scree_progress *progress, scree_shape_made *made,
                                       scree_error *error) {
  const char *name = name_of(plan);
  SCREE_CLEANUP(scree_free_at) char *path = scree_scene_path(folder, name ? name : "");
  if (!path) return scree_fail_memory(error, 0, "a path");
  scree_shape_spec spec = scree_scene_shape_spec(plan, path);
  spec.part = part;
  return scree_shape_make(&spec, store, progress, made, error);
}

scree_status scree_scene_make_shape(scree_scene *scene, size_t index, const char *folder,
                                    const scree_scene_making *making, scree_error *error) {
  const scree_plan_shape *plan = &scene->plan.shapes.items[index];
  scree_scene_shape *s = &scene->shapes[index];
  scree_shape_made *made = making->made;
  bool again = index && plan->family == (plan - 1)->family; /* another size of the last one */
  scree_status status = SCREE_OK;
  if (!again && !plan->joints) {
    scree_particle_free(made->particle);
    *made = (scree_shape_made){0};
    status =
        scree_scene_make_unscaled(plan, folder, 0, making->store, making->progress, made, error);
  }
  if (status != SCREE_OK) return status;
  s->scan_volume = made->scan_volume;
  s->source = describe(plan, made);
  if (!s->source) return scree_fail_memory(error, 0, "a shape's source");
  if (isnan(plan->scaled)) {
    s->particle = made->particle;
    scree_particle_retain(s->particle);
    return SCREE_OK;
  }
  double factor = plan->scaled / made->particle->measures.size;
  s->scan_volume *= factor * factor * factor;
  return scree_particle_scaled(made->particle, factor, &s->particle, error);
}
