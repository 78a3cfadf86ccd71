/* Shapes that break: how many fragments there are, how fine, and what that took. A fragment is what
 * hangs together by whole joints; its size is the diameter of the sphere of its volume. */
#include "base/alloc.h"
#include "scene/sensors/sensor.h"

#include <stdlib.h>
#include <string.h>

#define SCREE_PLAN_FRAGMENTS(ROW, T)                                                               \
  ROW(T, TEXT, of, "a shape that breaks; not given: all that do")                                  \
  ROW(T, TEXT, part, "a part whose liberation is told: share in fragments of nothing else")        \
  ROW(T, REAL, fine, 0.1, 1e-3, 1, "",                                                             \
      "share of the shape's size below which a fragment is fine: t10 is their mass's share")
SCREE_RECORD_TYPE(scree_plan_fragments, SCREE_PLAN_FRAGMENTS)
SCREE_RECORD_TABLE(scree_plan_fragments, SCREE_PLAN_FRAGMENTS, "fragments", NULL, NULL)

/* Who is in which. */
typedef struct fragment {
  double mass, volume, whole; /* whole: size of the shape that it is of, m */
  double part;                /* kg of the part that is asked about, */
  size_t others;              /* and bodies that are not of it */
  vec3 at;                    /* sum of mass times place */
  size_t bodies, shape;
} fragment;

static bool is_of(const scree_scene *scene, const scree_plan_fragments *plan, size_t shape) {
  if (shape < scene->named_count) return false;
  size_t whole = scene->shapes[shape].assembly, family = scene->shapes[whole].family;
  return !plan->of || !strcmp(plan->of, scene->plan.families.items[family].place.name);
}

static scree_status check(const scree_reader *reader, const scree_plan *plan,
                          const scree_plan_sensor *sensor) {
  const scree_plan_fragments *f = sensor->fragments;
  for (size_t i = 0; i < plan->shapes.count; i++)
    if ((plan->shapes.items[i].fracture || plan->shapes.items[i].joints) &&
        (!f->of || !strcmp(f->of, plan->shapes.items[i].place.name)))
      return SCREE_OK;
  return scree_fail_place(reader, &f->place,
                          "no shape%s%.60s breaks: give it a fracture, or parts and joints",
                          f->of ? " " : "", f->of ? f->of : "");
}

static double size_of(double volume) {
  return cbrt(volume / 0.52359877559829887);
}

/* Every fragment of the shape; to be freed. */
static scree_status find(const scree_scene *scene, const scree_plan_fragments *plan,
                         const char *part, fragment **found, size_t *count, scree_error *error) {
  size_t bodies = scene->shape_of.count, kept = 0;
  SCREE_SCRATCH(size_t, of, bodies, error);
  fragment *all;
  SCREE_TRY_ALLOC_ZERO(all, bodies, error);
  *count = scree_world_fragments(scene->world, of);
  for (size_t b = 0; b < bodies; b++) {
    size_t shape = scene->shape_of.items[b];
    if (of[b] == SIZE_MAX || !is_of(scene, plan, shape)) continue;
    fragment *f = &all[of[b]];
    double mass = scree_world_body_mass(scene->world, b);
    scree_body body;
    scree_world_get_body(scene->world, b, &body);
    f->mass += mass;
    f->volume += scene->shapes[shape].volume;
    f->at = vec3_mad(f->at, vec3_load(body.position), mass);
    f->shape = scene->shapes[shape].assembly;
    f->whole = size_of(scene->shapes[f->shape].volume);
    bool asked = part && scene->shapes[shape].part && !strcmp(part, scene->shapes[shape].part);
    f->part += asked ? mass : 0;
    f->others += !asked;
    f->bodies++;
  }
  for (size_t i = 0; i < *count; i++)
    if (all[i].bodies > 0) all[kept++] = all[i];
  *count = kept;
  *found = all;
  return SCREE_OK;
}

/* Share of the part's mass that is in fragments of it alone; NaN: there is none of it. */
static double liberation(const fragment *all, size_t count, double *mass) {
  double alone = 0;
  *mass = 0;
  for (size_t i = 0; i < count; i++) {
    *mass += all[i].part;
    if (!all[i].others) alone += all[i].part;
  }
  return alone / *mass;
}

/* Joules that the breaks of the shape's joints freed, and how many broke. */
static void sum_breaks(const scree_scene *scene, const scree_plan_fragments *plan, double *energy,
                       double *broken) {
  *energy = *broken = 0;
  for (size_t k = 0; k < scree_world_joint_count(scene->world); k++) {
    scree_joint_observation j;
    scree_world_observe_joint(scene->world, k, &j);
    if (j.mode == SCREE_JOINT_NOT_BROKEN || !is_of(scene, plan, scene->shape_of.items[j.a]))
      continue;
    *energy += j.fracture;
    ++*broken;
  }
}

/* kg that entered. */
static double mass_in(const scree_scene *scene, const scree_plan_fragments *plan) {
  double mass = 0;
  for (size_t b = 0; b < scene->shape_of.count; b++)
    if (is_of(scene, plan, scene->shape_of.items[b]))
      mass += scree_world_body_mass(scene->world, b);
  return mass;
}

static const scree_sensor_column columns[] = {{"count", "", SCREE_OF_ALL},
                                              {"largest", "kg", SCREE_OF_ALL},
                                              {"mean", "kg", SCREE_OF_ALL},
                                              {"fine", "", SCREE_OF_ALL},
                                              {"broken", "", SCREE_OF_ALL},
                                              {"energy", "J", SCREE_OF_ALL},
                                              {"specific", "J/kg", SCREE_OF_ALL},
                                              {"liberated", "", SCREE_OF_ALL},
                                              {0}};

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_plan_fragments *plan = sensor->plan->fragments;
  SCREE_CLEANUP(scree_free_at) fragment *all = NULL;
  size_t count;
  double mass = 0, fine = 0, largest = 0, in = mass_in(scene, plan);
  (void)now;
  SCREE_TRY(find(scene, plan, plan->part, &all, &count, error));
  for (size_t i = 0; i < count; i++) {
    mass += all[i].mass;
    largest = fmax(largest, all[i].mass);
    if (size_of(all[i].volume) < plan->fine * all[i].whole) fine += all[i].mass;
  }
  at[0] = (double)count;
  at[1] = largest;
  at[2] = count > 0 ? mass / (double)count : NAN;
  at[3] = mass > 0 ? fine / mass : NAN;
  sum_breaks(scene, plan, &at[5], &at[4]);
  at[6] = in > 0 ? at[5] / in : NAN;
  at[7] = liberation(all, count, &mass);
  return SCREE_OK;
}

static scree_status write_joints(const scree_scene *scene, const scree_plan_fragments *plan,
                                 const scree_sensor_folder *folder, scree_error *error) {
  static const char *const modes[] = {"", "tension", "shear", "energy"};
  scree_output output;
  SCREE_TRY(scree_sensor_open(folder, "joints.csv", &output, error));
  fputs("time [s],by,energy [J],area [m2],x [m],y [m],z [m],shape,body a,body b\n", output.stream);
  for (size_t k = 0; k < scree_world_joint_count(scene->world); k++) {
    scree_joint_observation j;
    scree_world_observe_joint(scene->world, k, &j);
    size_t shape = scene->shape_of.items[j.a];
    if (j.mode == SCREE_JOINT_NOT_BROKEN || !is_of(scene, plan, shape)) continue;
    fprintf(output.stream, "%.9g,%s,%.9g,%.9g,%.9g,%.9g,%.9g,%s,%zu,%zu\n", j.broke_at,
            modes[j.mode], j.fracture, j.area, j.position[0], j.position[1], j.position[2],
            scree_scene_shape_name(scene, scree_scene_named(scene, shape)), j.a, j.b);
  }
  return scree_output_commit(&output, error);
}

/* A row for all parts of a name together, in their order. */
static scree_status write_liberation(const scree_scene *scene, const scree_plan_fragments *plan,
                                     const scree_sensor_folder *folder, scree_error *error) {
  scree_output output = {0};
  for (size_t s = scene->named_count; s < scene->plan.shapes.count; s++) {
    SCREE_CLEANUP(scree_free_at) fragment *all = NULL;
    const char *part = scene->shapes[s].part;
    size_t count, before = scene->named_count;
    double mass;
    if (!part || !is_of(scene, plan, s)) continue;
    while (!scene->shapes[before].part || strcmp(scene->shapes[before].part, part) != 0 ||
           !is_of(scene, plan, before))
      before++;
    if (before < s) continue;
    SCREE_TRY(find(scene, plan, part, &all, &count, error));
    if (!output.stream) SCREE_TRY(scree_sensor_open(folder, "liberation.csv", &output, error));
    if (ftell(output.stream) == 0) fputs("part,mass [kg],liberated\n", output.stream);
    double share = liberation(all, count, &mass);
    fprintf(output.stream, "%s,%.9g,%.9g\n", part, mass, share);
  }
  return output.stream ? scree_output_commit(&output, error) : SCREE_OK;
}

static int compare_masses(const void *a, const void *b) {
  const fragment *x = a, *y = b;
  return (x->mass < y->mass) - (x->mass > y->mass);
}

/* Fragments, the heaviest first, and what broke. */
static scree_status write(const scree_scene *scene, const scree_scene_sensor *sensor,
                          const scree_sensor_folder *folder, scree_error *error) {
  const scree_plan_fragments *plan = sensor->plan->fragments;
  SCREE_CLEANUP(scree_free_at) fragment *all = NULL;
  size_t count;
  scree_output output;
  SCREE_TRY(find(scene, plan, NULL, &all, &count, error));
  SCREE_TRY(scree_sensor_open(folder, "fragments.csv", &output, error));
  qsort(all, count, sizeof *all, compare_masses);
  double left = 0, finer = 0;
  for (size_t i = 0; i < count; i++) left += all[i].mass;
  fputs("shape,pieces,mass [kg],size [m],finer,x [m],y [m],z [m]\n", output.stream);
  for (size_t i = 0; i < count; i++) {
    vec3 at = vec3_scale(all[i].at, 1 / all[i].mass);
    finer += all[i].mass;
    fprintf(output.stream, "%s,%zu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
            scree_scene_shape_name(scene, all[i].shape), all[i].bodies, all[i].mass,
            size_of(all[i].volume), i + 1 == count ? 0 : 1 - finer / left, at.x, at.y, at.z);
  }
  SCREE_TRY(scree_output_commit(&output, error));
  SCREE_TRY(write_liberation(scene, plan, folder, error));
  return write_joints(scene, plan, folder, error);
}

const scree_sensor_kind scree_sensor_fragments = {
    .check = check, .columns = columns, .read = read, .write = write};
