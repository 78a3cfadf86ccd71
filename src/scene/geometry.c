/* Geometry, of whatever kind (scene/geometry/kind.h): what it must be, and walls of a world. */
#include "scene/geometry.h"

#include "scene/motions.h"
#include "scene/scene.h"

#define GEOMETRY_KIND(T, row, key, ...) &scree_geometry_##key,
static const scree_geometry_kind *const kinds[] = {SCREE_GEOMETRY_KINDS(GEOMETRY_KIND, )};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const scree_geometry_kind *kind_of(const scree_plan_geometry *g) {
  return kinds[scree_plan_kind(&scree_plan_geometry_record, g)];
}

/* ---- the plan ---- */

SCREE_RECORD_TABLE(scree_plan_turn, SCREE_PLAN_TURN, "a turn", NULL, NULL)
SCREE_RECORD_TABLE(scree_plan_belt, SCREE_PLAN_BELT, "a belt", "a speed", NULL)

static scree_status check_surface(const scree_reader *r, const scree_plan_geometry *g) {
  if (g->side && !kind_of(g)->closes)
    return scree_fail_place(r, &g->place, "side is of a file or a box, which may be closed");
  if (g->belt && !kind_of(g)->runs)
    return scree_fail_place(r, &g->belt->place,
                            "is of a file or a loop; give a surface_velocity instead");
  if (g->belt && given(g->surface_velocity))
    return scree_fail_place(r, &g->place, "only one of surface_velocity, belt may be given");
  if (g->copies && (g->belt || given(g->surface_velocity)))
    return scree_fail_place(r, &g->copies->place, "of belts there are none: give each its own");
  return SCREE_OK;
}

static scree_status check_geometry(const scree_reader *r, const void *record) {
  const scree_plan_geometry *g = record;
  SCREE_TRY(scree_plan_one_kind(r, &scree_plan_geometry_record, g, KINDS));
  if (kind_of(g)->check) SCREE_TRY(kind_of(g)->check(r, g));
  SCREE_TRY(check_surface(r, g));
  if ((g->slide != NULL) + (g->hinge != NULL) + (g->motion.count > 0) > 1)
    return scree_fail_place(r, &g->place, "only one of motion, slide, hinge may be given");
  return scree_motions_check(r, g);
}
SCREE_RECORD_TABLE(scree_plan_geometry, SCREE_PLAN_GEOMETRY, "geometry", NULL, check_geometry)

static scree_status check_periodic(const scree_reader *r, const scree_plan_geometry *g) {
  const scree_geometry_kind *kind = kind_of(g);
  if (g->slide || g->hinge)
    return scree_fail_place(r, &g->place, "in a periodic domain nothing moves by forces");
  if (g->turn || !kind->goes_on || !kind->goes_on(g, false))
    return scree_fail_place(r, &g->place,
                            "in a periodic domain geometry must go on across its boundary: a "
                            "plane along the axis, or an endless cylinder about it");
  for (size_t k = 0; k < g->motion.count; k++)
    if (scree_motion_turns(&g->motion.items[k]) && !kind->goes_on(g, true))
      return scree_fail_place(r, &g->motion.items[k].place,
                              "in a periodic domain planes do not rotate");
  return SCREE_OK;
}

scree_status scree_geometry_check_periodic(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->geometry.count; i++)
    SCREE_TRY(check_periodic(r, &plan->geometry.items[i]));
  return SCREE_OK;
}

scree_container scree_geometry_container(const scree_plan_geometry *g) {
  const scree_geometry_kind *kind = kind_of(g);
  return kind->container ? kind->container(g) : (scree_container){0};
}

const char *scree_geometry_file_name(const scree_plan_geometry *g, size_t index) {
  const scree_texts files = kind_of(g)->files ? kind_of(g)->files(g) : (scree_texts){0};
  return index < files.count ? files.items[index] : NULL;
}

/* ---- in the world ---- */

static scree_status add_copy(const scree_geometry_making *m, scree_error *error) {
  const scree_geometry_kind *kind = kind_of(&m->copy);
  scree_mesh mesh;
  if (kind->walls) return kind->walls(m, error);
  SCREE_TRY(kind->mesh(&m->copy, &mesh, error));
  return scree_geometry_add_mesh(m, false, &mesh, error);
}

static scree_status add_one(scree_scene *scene, size_t index, const char *folder,
                            scree_world *world, scree_error *error) {
  const scree_plan_geometry *g = &scene->plan.geometry.items[index];
  scree_scene_geometry *made = &scene->geometry[index];
  const size_t copies = g->copies ? g->copies->count : 1;
  made->first_wall = scree_world_wall_count(world);
  for (size_t k = 0; k < copies; k++) {
    scree_plan_turn turn;
    const scree_geometry_making m = {scene,  index, scree_copy_of(g, k, &turn),
                                     folder, world, k == 0 && world == scene->gallery};
    SCREE_TRY(add_copy(&m, error));
    made->wall_count = scree_world_wall_count(world) - made->first_wall;
    if (made->wall_count % (k + 1))
      return scree_fail(error, SCREE_BAD_MESH,
                        "copies: they have bodies on different sides; set side: outside");
  }
  SCREE_TRY(scree_motions_read(scene, index, folder, error));
  return g->motion.count ? scree_motions_set(scene, index, world, error) : SCREE_OK;
}

scree_status scree_geometry_add(scree_scene *scene, const char *folder, scree_world *world,
                                scree_error *error) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    scree_error why;
    scree_status status = add_one(scene, i, folder, world, &why);
    SCREE_TRY(scree_scene_blame(scene, &scene->plan.geometry.items[i].place, status, &why, error));
  }
  return SCREE_OK;
}
