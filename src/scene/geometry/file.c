/* Meshes from files. */
#include "scene/geometry/kind.h"

#include "base/alloc.h"

#include <string.h>

static scree_texts files(const scree_plan_geometry *g) {
  return g->file;
}

static scree_status add(const scree_geometry_making *m, const char *name, scree_error *error) {
  scree_read_options o = scree_default_read_options();
  scree_scan scan;
  o.unit_m = scree_plan_unit(m->copy.unit);
  SCREE_CLEANUP(scree_free_at) char *path = scree_scene_path(m->folder, name);
  if (!path) return scree_fail_memory(error, strlen(name), "a path");
  SCREE_TRY(scree_scan_read(path, &o, &scan, error));
  return scree_geometry_add_mesh(m, true, &scan.mesh, error);
}

static scree_status walls(const scree_geometry_making *m, scree_error *error) {
  for (size_t k = 0; k < m->copy.file.count; k++) SCREE_TRY(add(m, m->copy.file.items[k], error));
  return SCREE_OK;
}

const scree_geometry_kind scree_geometry_file = {
    .closes = true, .runs = true, .files = files, .walls = walls};
