/* Levels' meshes from the record alone.
 *
 * Vertex `gone` of each collapse becomes `kept`, whose position is the last one written; a triangle
 * lives while its corners are three. Going through the collapses backwards, the vertex that `kept`
 * finally became is known when it is asked for, so that no search is needed. */
#include "base/alloc.h"
#include "simplify/curve.h"
#include "simplify/halfmesh.h"

#include <string.h>

struct scree_replay {
  const scree_curve *curve;
  size_t level;
  uint32_t *root;   /* of the given mesh's vertices */
  double *position; /* of the given mesh's vertices, at the level */
  uint32_t *corner; /* triangles of the level, in the given mesh's vertices */
  size_t triangle_count;
  scree_mesh mesh;
  uint32_t *number; /* of the given mesh's vertices, in mesh */
};

const uint32_t *scree_replay_numbering(const scree_replay *replay) {
  return replay->number;
}

void scree_replay_free(scree_replay *replay) {
  if (!replay) return;
  scree_free(replay->root);
  scree_free(replay->position);
  scree_free(replay->corner);
  scree_free(replay->number);
  scree_mesh_free(&replay->mesh);
  scree_free(replay);
}

scree_status scree_replay_start(const scree_curve *curve, scree_replay **replay,
                                scree_error *error) {
  const scree_mesh *mesh = curve->mesh;
  SCREE_OWNED(scree_replay, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  made->curve = curve;
  made->triangle_count = mesh->triangle_count;
  SCREE_TRY_ALLOC(made->root, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(made->number, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(made->position, 3 * mesh->vertex_count, error);
  SCREE_TRY_ALLOC(made->corner, 3 * mesh->triangle_count, error);
  for (uint32_t v = 0; v < mesh->vertex_count; v++) made->root[v] = v;
  memcpy(made->position, mesh->positions, 3 * mesh->vertex_count * sizeof *made->position);
  memcpy(made->corner, mesh->triangles, 3 * mesh->triangle_count * sizeof *made->corner);
  *replay = made;
  made = NULL;
  return SCREE_OK;
}

static void replay_collapses(scree_replay *r, size_t level) {
  const scree_collapse_record *record = &r->curve->record;
  for (size_t i = level; i-- > r->level;)
    r->root[record->gone[i]] = r->root[scree_collapse_record_kept(record, i)];
  for (size_t i = r->level; i < level; i++)
    vec3_store(r->position + 3 * (size_t)scree_collapse_record_kept(record, i),
               record->position[i]);
  size_t count = 0;
  for (size_t t = 0; t < r->triangle_count; t++) {
    uint32_t c0 = r->root[r->corner[3 * t]], c1 = r->root[r->corner[3 * t + 1]],
             c2 = r->root[r->corner[3 * t + 2]];
    if (level > 0 && (c0 == c1 || c1 == c2 || c2 == c0)) continue;
    r->corner[3 * count] = c0;
    r->corner[3 * count + 1] = c1;
    r->corner[3 * count + 2] = c2;
    count++;
  }
  r->triangle_count = count;
}

/* The level's mesh with its own vertices, in the order of the mesh given. */
static scree_status number_vertices(scree_replay *r, scree_mesh *mesh, scree_error *error) {
  size_t vertex_count = r->curve->mesh->vertex_count, used = 0;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {.triangle_count = r->triangle_count};
  memset(r->number, 0xff, vertex_count * sizeof *r->number);
  for (size_t i = 0; i < 3 * r->triangle_count; i++) r->number[r->corner[i]] = 0;
  for (size_t v = 0; v < vertex_count; v++)
    if (r->number[v] == 0) r->number[v] = (uint32_t)used++;
  made.vertex_count = used;
  SCREE_TRY_ALLOC(made.positions, 3 * used, error);
  SCREE_TRY_ALLOC(made.triangles, 3 * r->triangle_count, error);
  for (size_t v = 0; v < vertex_count; v++)
    if (r->number[v] != SCREE_NONE)
      memcpy(made.positions + 3 * (size_t)r->number[v], r->position + 3 * v, 3 * sizeof(double));
  for (size_t i = 0; i < 3 * r->triangle_count; i++) made.triangles[i] = r->number[r->corner[i]];
  *mesh = made;
  memset(&made, 0, sizeof made);
  return SCREE_OK;
}

scree_status scree_replay_step(scree_replay *replay, size_t level_index, const scree_mesh **mesh,
                               scree_error *error) {
  size_t last = scree_curve_level_count(replay->curve) - 1;
  if (level_index < replay->level || level_index > last)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "level %zu is not within [%zu, %zu]", level_index,
                      replay->level, last);
  scree_mesh made;
  replay_collapses(replay, level_index);
  SCREE_TRY(number_vertices(replay, &made, error));
  scree_mesh_free(&replay->mesh);
  replay->mesh = made;
  replay->level = level_index;
  *mesh = &replay->mesh;
  return SCREE_OK;
}

scree_status scree_curve_mesh(const scree_curve *curve, size_t level_index, scree_mesh *mesh,
                              scree_error *error) {
  SCREE_OWNED(scree_replay, replay);
  const scree_mesh *level;
  SCREE_TRY(scree_replay_start(curve, &replay, error));
  SCREE_TRY(scree_replay_step(replay, level_index, &level, error));
  *mesh = replay->mesh;
  replay->mesh = (scree_mesh){0};
  return SCREE_OK;
}
