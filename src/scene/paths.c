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
  scree_status status = scree_named_open(t, name, text, known, COLUMNS, error);
  if (status == SCREE_OK && (!t->there[TIME] || t->column_count < 2))
    status = scree_named_fail(t, error, "needs a column t and one of a way or an angle");
  for (bool there = true; status == SCREE_OK && there;) {
    double row[COLUMNS];
    status = scree_named_row(t, row, NULL, &there, error);
    if (status != SCREE_OK || !there) break;
    if (rows->count && !(row[TIME] > rows->items[rows->count - 1][TIME]))
      return scree_named_fail(t, error, "t %g s: must come after the row before, %g s", row[TIME],
                              rows->items[rows->count - 1][TIME]);
    if (!SCREE_RESERVE(rows, rows->count + 1))
      return scree_fail_memory(error, sizeof row, "a path");
    memcpy(rows->items[rows->count++], row, sizeof row);
  }
  if (status == SCREE_OK && rows->count == 0)
    status = scree_named_fail(t, error, "no row after the names");
  return status;
}

static scree_status keep(scree_scene *scene, const scree_named_table *t, const row_list *rows,
                         scree_plan_path *path, scree_error *error) {
  for (int k = 0; k < SCREE_PATH_COLUMNS; k++) {
    scree_table *table = &path->tables[k];
    if (!t->there[k]) continue;
    table->items = scree_arena_take(&scene->arena, rows->count, sizeof *table->items);
    if (!table->items)
      return scree_fail_memory(error, rows->count * sizeof *table->items, "a path");
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
  char *bytes, *name = scree_scene_path(folder, path->file);
  size_t count;
  row_list rows = {NULL, 0, 0};
  scree_named_table t;
  if (!name) return scree_fail_memory(error, strlen(path->file), "a path");
  scree_status status = scree_file_read(name, MOST_BYTES, &bytes, &count, error);
  if (status == SCREE_OK) {
    status = read_rows(name, bytes, &t, &rows, error);
    if (status == SCREE_OK) status = keep(scene, &t, &rows, path, error);
    scree_free(bytes);
  }
  scree_free(rows.items);
  scree_free(name);
  return status;
}

scree_status scree_scene_read_paths(scree_scene *scene, size_t geometry, const char *folder,
                                    scree_error *error) {
  const scree_plan_geometry *g = &scene->plan.geometry.items[geometry];
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < g->motion.count; i++) {
    scree_plan_path *path = g->motion.items[i].path;
    if (path && !path->is_read) status = read_path(scene, path, folder, error);
    if (path) path->is_read = status == SCREE_OK;
  }
  return status;
}
