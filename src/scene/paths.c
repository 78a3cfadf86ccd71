/* Motions by a table in a file: t, and any of x, y, z, angle_x, angle_y, angle_z over it. */
#include "scene/named_table.h"
#include "scene/scene.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"

#include <string.h>

enum { TIME = SCREE_PATH_COLUMNS, COLUMNS, MOST_BYTES = 1 << 28 };
static const scree_named_column known[COLUMNS] = {
    {"x", "m"},         {"y", "m"},         {"z", "m"}, {"angle_x", "rad"},
    {"angle_y", "rad"}, {"angle_z", "rad"}, {"t", "s"}};

typedef struct row_list {
  double (*items)[COLUMNS];
  size_t count, capacity;
} row_list;

static scree_status read_rows(const char *name, char *text, scree_named_table *t, row_list *rows,
                              scree_error *error) {
  SCREE_TRY(scree_named_open(t, name, text, known, COLUMNS, error));
  if (!t->there[TIME] || t->column_count < 2)
    return scree_named_fail(t, error, "needs a column t and one of a way or an angle");
  for (bool there;;) {
    double row[COLUMNS];
    SCREE_TRY(scree_named_row(t, row, NULL, &there, error));
    if (!there) break;
    if (rows->count && !(row[TIME] > rows->items[rows->count - 1][TIME]))
      return scree_named_fail(t, error, "t %g s: must come after the row before, %g s", row[TIME],
                              rows->items[rows->count - 1][TIME]);
    if (!SCREE_RESERVE(rows, rows->count + 1))
      return scree_fail_memory(error, sizeof row, "a path");
    memcpy(rows->items[rows->count++], row, sizeof row);
  }
  return rows->count ? SCREE_OK : scree_named_fail(t, error, "no row after the names");
}

static void free_rows(row_list *rows) {
  scree_free(rows->items);
}

static scree_status keep(scree_scene *scene, const scree_named_table *t, const row_list *rows,
                         scree_plan_path *path, scree_error *error) {
  for (int k = 0; k < SCREE_PATH_COLUMNS; k++) {
    scree_table *table = &path->tables[k];
    if (!t->there[k]) continue;
    SCREE_TRY_TAKE(table->items, &scene->arena, rows->count, error);
    table->count = rows->count;
    for (size_t i = 0; i < rows->count; i++) {
      table->items[i][0] = rows->items[i][TIME];
      table->items[i][1] = rows->items[i][k];
    }
  }
  return SCREE_OK;
}

static scree_status read_path(scree_scene *scene, scree_plan_path *path, const char *folder,
                              scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_CLEANUP(scree_free_at) char *name = scree_scene_path(folder, path->file);
  SCREE_CLEANUP(free_rows) row_list rows = {NULL, 0, 0};
  size_t count;
  scree_named_table t;
  if (!name) return scree_fail_memory(error, strlen(path->file), "a path");
  SCREE_TRY(scree_file_read(name, MOST_BYTES, &bytes, &count, error));
  SCREE_TRY(read_rows(name, bytes, &t, &rows, error));
  return keep(scene, &t, &rows, path, error);
}

scree_status scree_scene_read_paths(scree_scene *scene, size_t geometry, const char *folder,
                                    scree_error *error) {
  const scree_plan_geometry *g = &scene->plan.geometry.items[geometry];
  for (size_t i = 0; i < g->motion.count; i++) {
    scree_plan_path *path = g->motion.items[i].path;
    if (!path || path->is_read) continue;
    SCREE_TRY(read_path(scene, path, folder, error));
    path->is_read = true;
  }
  return SCREE_OK;
}
