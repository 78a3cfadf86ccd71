/* Motions by a table in a file: t, and any of x, y, z, angle_x, angle_y, angle_z over it. */
#include "scene/motions/kind.h"
#include "scene/named_table.h"
#include "scene/scene.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"

#include <string.h>

enum { TIME = SCREE_MOST_MOTIONS, COLUMNS, MOST_BYTES = 1 << 28 };

#define SCREE_PLAN_PATH(ROW, T)                                                                    \
  ROW(T, TEXT, file,                                                                               \
      "a table: t and any of x, y, z, angle_x, angle_y, angle_z, with units as `x [mm]`")          \
  ROW(T, VECTOR, through, SCREE_ZERO, -1e6, 1e6, "m", "about which it turns, by angle_x first")    \
  ROW(T, OWN, scree_table tables[TIME], tables, {{0}}) /* one for each column but the time */      \
  ROW(T, OWN, bool is_read, is_read, false)
SCREE_RECORD_TYPE(scree_plan_path, SCREE_PLAN_PATH)
SCREE_RECORD_TABLE(scree_plan_path, SCREE_PLAN_PATH, "a path", "a file", NULL)

static const scree_named_column known[COLUMNS] = {
    {"x", "m"},         {"y", "m"},         {"z", "m"}, {"angle_x", "rad"},
    {"angle_y", "rad"}, {"angle_z", "rad"}, {"t", "s"}};

typedef struct row_list {
  double (*items)[COLUMNS];
  size_t count, capacity;
} row_list;

static scree_status read_rows(const char *name, char *text, size_t size, scree_named_table *t,
                              row_list *rows, scree_error *error) {
  bool moves = false;
  SCREE_TRY(scree_named_open(t, name, text, size, known, COLUMNS, error));
  for (int k = 0; k < TIME; k++) moves = moves || t->there[k];
  if (!t->there[TIME] || !moves)
    return scree_rows_fail(&t->rows, "needs a column t and one of a way or an angle");
  for (bool there;;) {
    double row[COLUMNS];
    SCREE_TRY(scree_named_row(t, row, NULL, &there));
    if (!there) break;
    if (rows->count && !(row[TIME] > rows->items[rows->count - 1][TIME]))
      return scree_rows_fail(&t->rows, "t %g s: must come after the row before, %g s", row[TIME],
                             rows->items[rows->count - 1][TIME]);
    if (!SCREE_RESERVE(rows, rows->count + 1))
      return scree_fail_memory(error, sizeof row, "a path");
    memcpy(rows->items[rows->count++], row, sizeof row);
  }
  return rows->count ? SCREE_OK : scree_rows_fail(&t->rows, "no row after the names");
}

static void free_rows(row_list *rows) {
  scree_free(rows->items);
}

static scree_status keep(scree_scene *scene, const scree_named_table *t, const row_list *rows,
                         scree_plan_path *path, scree_error *error) {
  for (int k = 0; k < TIME; k++) {
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

static scree_status read(scree_scene *scene, const scree_plan_motion *plan, const char *folder,
                         scree_error *error) {
  scree_plan_path *path = plan->path;
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_CLEANUP(scree_free_at) char *name = scree_scene_path(folder, path->file);
  SCREE_CLEANUP(free_rows) row_list rows = {NULL, 0, 0};
  size_t count;
  scree_named_table t;
  if (path->is_read) return SCREE_OK;
  if (!name) return scree_fail_memory(error, strlen(path->file), "a path");
  SCREE_TRY(scree_file_read(name, MOST_BYTES, &bytes, &count, error));
  SCREE_TRY(read_rows(name, bytes, count, &t, &rows, error));
  SCREE_TRY(keep(scene, &t, &rows, path, error));
  path->is_read = true;
  return SCREE_OK;
}

/* The angles first, then the ways. */
static size_t put(const scree_plan_geometry *g, const scree_plan_motion *plan, size_t copy,
                  scree_wall_motion *m) {
  const scree_plan_path *path = plan->path;
  size_t count = 0;
  (void)g, (void)copy;
  for (int k = 0; k < TIME; k++) {
    const scree_table *table = &path->tables[(k + 3) % TIME];
    if (!table->count) continue;
    m[count].axis[2] = 0;
    m[count].axis[k % 3] = 1;
    m[count].turns = k < 3;
    memcpy(m[count].through, path->through, sizeof path->through);
    scree_motion_take_table(&m[count++], table, SCREE_MOTION_POSITIONS);
  }
  return count;
}

static double fastest(const scree_scene *scene, size_t geometry, const scree_plan_motion *plan) {
  const scree_plan_path *path = plan->path;
  double speed = 0;
  for (int k = 0; k < TIME; k++) {
    const double axis[3] = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
    const double arm = k < 3 ? 1 : scree_motion_arm(scene, geometry, axis, path->through);
    speed += arm * scree_motion_steepest(&path->tables[k]);
  }
  return speed;
}

const scree_motion_kind scree_motion_path = {.read = read, .put = put, .fastest = fastest};
