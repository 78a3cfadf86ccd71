/* Shapes that break or come apart: cells of a surface (mesh/fracture), parts of an assembly or
 * spheres of a table, each a shape of its own behind those of the file, and joints between them.
 * The gallery has them as they hang together; what enters is a copy of that, with strengths of its
 * own. */
#include "base/alloc.h"
#include "base/array.h"
#include "base/math.h"
#include "base/rng.h"
#include "mesh/adjacency.h"
#include "mesh/measure/hull.h"
#include "mesh/mesh.h"
#include "particle/particle.h"
#include "scene/scene.h"
#include "world/state/joints.h"

#include <ctype.h>
#include <string.h>

/* Where a file gives no stiffness, joints stretch by no more than this when they break. */
static const double longest_strain = 0.005;
/* Where it gives no gap: of the whole's size. */
static const double usual_gap = 0.002;
/* The stream of strengths, behind those of inlets, of which there are fewer. */
enum { STRENGTHS = 1 << 20 };
enum { MOST_SPHERES = 10000 }; /* of a cable, as of a table */

typedef struct piece {
  scree_mesh mesh; /* or a sphere: */
  vec3 at;
  double radius;
  const char *part; /* its name, in the scene's arena; NULL: of what is no assembly */
  uint32_t group;   /* which of the parts */
} piece;

/* One shape's, in its whole's frame, until the gallery has it. */
struct scree_scene_assembly {
  SCREE_LIST(piece) pieces;
  SCREE_LIST(scree_fracture_face) faces;
};
typedef struct scree_scene_assembly assembly;

static const scree_plan_shape *plan_of(const scree_scene *scene, size_t shape) {
  return &scene->plan.shapes.items[shape];
}

/* What the file says of a part; NULL: nothing. */
static const scree_plan_component *component_of(const scree_plan_shape *plan, const char *part) {
  size_t k = part ? SCREE_PLAN_FIND(plan->parts, part) : plan->parts.count;
  return k < plan->parts.count ? &plan->parts.items[k] : NULL;
}

/* ---- what holds two pieces ---- */

static void fill_bond(scree_plan_bond *bond, scree_plan_bond from) {
  double *to = (double *)bond, *with = (double *)&from; /* it is numbers alone */
  for (size_t k = 0; k < sizeof from / sizeof *to; k++)
    if (isnan(to[k])) to[k] = with[k];
}

/* "stud*" is all names that begin so. */
static bool is_name(const char *name, const char *part) {
  size_t star = strcspn(name, "*");
  return name[star] && !name[star + 1] ? !strncmp(name, part, star) : !strcmp(name, part);
}

static bool is_between(const scree_texts *between, const char *a, const char *b) {
  const char *p = between->items[0], *q = between->items[1];
  return (is_name(p, a) && is_name(q, b)) || (is_name(p, b) && is_name(q, a));
}

/* The bond of two pieces, by their shapes; all but young is given. */
static scree_plan_bond bond_between(const scree_scene *scene, size_t whole, size_t a, size_t b) {
  const scree_scene_shape *x = &scene->shapes[a], *y = &scene->shapes[b];
  const scree_plan_shape *plan = plan_of(scene, whole);
  const scree_plan_component *component = component_of(plan, x->part);
  scree_plan_bond bond = {NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  if (plan->fracture) {
    bond = SCREE_BOND_OF(plan->fracture);
  } else if (x->group == y->group && component && component->fracture) {
    bond = SCREE_BOND_OF(component->fracture);
  } else {
    for (size_t k = 0; k < plan->joints->pairs.count; k++)
      if (is_between(&plan->joints->pairs.items[k].between, x->part, y->part))
        fill_bond(&bond, SCREE_BOND_OF(&plan->joints->pairs.items[k]));
    fill_bond(&bond, SCREE_BOND_OF(plan->joints));
  }
  fill_bond(&bond, (scree_plan_bond){NAN, 3 * bond.tension, 0.6, 0, 0, NAN, 0.05});
  return bond;
}

/* ---- parts as they lie in their files ---- */

static scree_status take_assembly(scree_scene *scene, size_t index, assembly **taken,
                                  scree_error *error) {
  if (!scene->assemblies) SCREE_TRY_ALLOC_ZERO(scene->assemblies, scene->named_count, error);
  *taken = &scene->assemblies[index];
  return SCREE_OK;
}

static scree_status add_piece(assembly *to, scree_mesh *mesh, const char *part, uint32_t group,
                              scree_error *error) {
  piece made = {.mesh = *mesh, .part = part, .group = group};
  SCREE_TRY_PUSH(&to->pieces, error, made);
  *mesh = (scree_mesh){0};
  return SCREE_OK;
}

static void move(scree_mesh *mesh, const mat3 *turn, vec3 by) {
  for (size_t v = 0; v < mesh->vertex_count; v++)
    vec3_store(mesh->positions + 3 * v,
               vec3_add(mat3_mul_vec(turn, vec3_load(mesh->positions + 3 * v)), by));
}

/* A name of the file as one that tables and other programs read. */
static const char *plain_name(scree_scene *scene, const char *name, size_t number) {
  char text[80];
  snprintf(text, sizeof text, "%.63s", name);
  if (!*name) snprintf(text, sizeof text, "part-%zu", number);
  for (char *p = text; *p; p++)
    if (!isalnum((unsigned char)*p) && *p != '_') *p = '-';
  return scree_arena_text(&scene->arena, text);
}

static scree_status make_part(scree_scene *scene, size_t index, size_t k, const char *folder,
                              const scree_scene_making *making, size_t *count, scree_error *error) {
  scree_plan_shape one = *plan_of(scene, index);
  const scree_plan_component *c = one.file ? NULL : &one.parts.items[k];
  scree_shape_made made = {0};
  assembly *to;
  SCREE_TRY(take_assembly(scene, index, &to, error));
  if (c) {
    one.file = c->file, one.sample = c->sample, one.unit = c->unit, one.triangles = c->triangles;
    memcpy(one.box, c->box, sizeof one.box);
  }
  SCREE_TRY(scree_scene_make_unscaled(&one, folder, c ? 0 : k + 1, making->store, making->progress,
                                      &made, error));
  const scree_particle_measures *m = &made.particle->measures;
  mat3 turn = quat_to_mat3(quat_load(m->orientation));
  vec3 at = vec3_add(vec3_load(m->centre), c ? vec3_load(c->at) : (vec3){0, 0, 0});
  const char *name = c ? c->place.name : plain_name(scene, made.part_name, k + 1);
  scree_mesh mesh = {0};
  scree_status status = scree_mesh_copy(&made.particle->mesh, &mesh, error);
  if (status == SCREE_OK) move(&mesh, &turn, at);
  if (status == SCREE_OK) status = add_piece(to, &mesh, name, (uint32_t)k, error);
  scree_mesh_free(&mesh);
  if (!c) *count = made.part_count;
  scree_particle_free(made.particle);
  return status;
}

/* The particle that stands for the pieces where they enter: their hull. */
static scree_status make_hull(const assembly *of, scree_particle **particle, scree_error *error) {
  size_t count = 0, n = 0;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  for (size_t p = 0; p < of->pieces.count; p++) count += of->pieces.items[p].mesh.vertex_count;
  SCREE_SCRATCH(vec3, points, count, error);
  for (size_t p = 0; p < of->pieces.count; p++)
    for (size_t v = 0; v < of->pieces.items[p].mesh.vertex_count; v++)
      points[n++] = scree_mesh_vertex(&of->pieces.items[p].mesh, v);
  vec3 middle = points[0];
  for (size_t i = 0; i < n; i++) points[i] = vec3_sub(points[i], middle);
  SCREE_TRY(scree_hull_mesh(points, n, &mesh, error));
  for (size_t v = 0; v < mesh.vertex_count; v++)
    vec3_store(mesh.positions + 3 * v, vec3_add(scree_mesh_vertex(&mesh, v), middle));
  SCREE_TRY(scree_mesh_canonicalize(&mesh, error));
  return scree_particle_from_mesh(&mesh, NULL, particle, error);
}

/* Spheres along the path, so far apart that together they have a wire's volume. */
static scree_status make_cable(const scree_plan_cable *plan, scree_particle **particle,
                               scree_error *error) {
  const scree_plan_point *points = plan->path.items;
  const double radius = 0.5 * plan->diameter;
  double length = 0, before = 0;
  for (size_t k = 1; k < plan->path.count; k++)
    length += vec3_distance(vec3_load(points[k - 1].at), vec3_load(points[k].at));
  const double steps = floor(length / (4. / 3 * radius) + 0.5);
  if (!(steps >= 1 && steps < MOST_SPHERES))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "cable: a path of %.4g m is %.4g spheres %.4g m thick; 2 to %d are possible",
                      length, steps + 1, plan->diameter, MOST_SPHERES);
  const size_t count = (size_t)steps + 1;
  SCREE_SCRATCH(double, centres, 3 * count, error);
  SCREE_SCRATCH(double, radii, count, error);
  for (size_t i = 0, k = 0; i < count; i++) {
    const double along = length * (double)i / steps;
    vec3 from, to;
    double part;
    for (;; k++, before += part) {
      from = vec3_load(points[k].at), to = vec3_load(points[k + 1].at);
      part = vec3_distance(from, to);
      if (along <= before + part || k + 2 == plan->path.count) break;
    }
    vec3_store(centres + 3 * i, vec3_lerp(from, to, part > 0 ? (along - before) / part : 0));
    radii[i] = radius;
  }
  return scree_particle_clump(centres, radii, count, NULL, particle, error);
}

scree_status scree_scene_make_parts(scree_scene *scene, size_t index, const char *folder,
                                    const scree_scene_making *making, scree_error *error) {
  const scree_plan_shape *plan = plan_of(scene, index);
  size_t count = plan->file || plan->clump ? 1 : plan->parts.count;
  scree_particle_free(making->made->particle);
  *making->made = (scree_shape_made){0};
  if (plan->cable) return make_cable(plan->cable, &making->made->particle, error);
  if (plan->clump || (plan->file && scree_is_clump_table(plan->file)))
    return scree_scene_make_unscaled(plan, folder, 0, making->store, making->progress, making->made,
                                     error);
  for (size_t k = 0; k < count; k++) {
    scree_error why;
    scree_status status = make_part(scene, index, k, folder, making, &count, &why);
    if (status != SCREE_OK)
      return scree_fail(error, why.status, "part %zu%s%.60s: %.800s", k + 1, plan->file ? "" : ", ",
                        plan->file ? "" : plan->parts.items[k].place.name, why.message);
  }
  if (count < 2)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "joints need parts: there is one, no other node or separate body");
  return make_hull(&scene->assemblies[index], &making->made->particle, error);
}

/* ---- shapes of pieces ---- */

scree_status scree_scene_append_pieces(scree_scene *scene, const scree_scene_piece *pieces,
                                       size_t count, scree_error *error) {
  size_t named = scene->named_count, all = named + count;
  scree_plan_shape *rows;
  scree_scene_shape *shapes;
  if (count == 0) return SCREE_OK;
  SCREE_TRY_TAKE(rows, &scene->arena, all, error);
  SCREE_TRY_TAKE(shapes, &scene->arena, all, error);
  memcpy(rows, scene->plan.shapes.items, named * sizeof *rows);
  memcpy(shapes, scene->shapes, named * sizeof *shapes);
  for (size_t k = 0, number = 0; k < count; k++) {
    const scree_scene_piece *p = &pieces[k];
    scree_scene_shape *whole = &shapes[p->assembly];
    scree_plan_shape *row = &rows[named + k];
    const char *name = rows[p->assembly].place.name, *part = p->part ? p->part : "";
    const scree_plan_component *c = component_of(&rows[p->assembly], p->part);
    size_t room = strlen(name) + strlen(part) + 24;
    char *text = scree_arena_take(&scene->arena, room, 1);
    bool first = k == 0 || pieces[k - 1].assembly != p->assembly || pieces[k - 1].group != p->group,
         last = k + 1 == count || pieces[k + 1].assembly != p->assembly ||
                pieces[k + 1].group != p->group;
    if (!text) return scree_fail_memory(error, room, "names of pieces");
    if (whole->piece_count++ == 0) whole->first_piece = named + k;
    number = first ? 1 : number + 1;
    int used = snprintf(text, room, "%s%s%s", name, *part ? "-" : "", part);
    if (!*part || !first || !last) snprintf(text + used, room - (size_t)used, "-%zu", number);
    *row = rows[p->assembly];
    row->place.name = text;
    row->fracture = NULL;
    row->joints = NULL;
    if (c && c->material) row->material = c->material;
    if (c && (c->material || !isnan(c->density))) row->density = c->density;
    shapes[named + k].assembly = p->assembly;
    shapes[named + k].group = p->group;
    shapes[named + k].part = p->part ? scree_arena_text(&scene->arena, p->part) : NULL;
    if (p->part && !shapes[named + k].part) return scree_fail_memory(error, room, "names of parts");
  }
  scene->plan.shapes = (scree_plan_shape_list){rows, all};
  scene->shapes = shapes;
  return scree_scene_plan_forces(scene, error);
}

/* A particle of each piece, where it lies in the whole. */
static scree_status fill_pieces(scree_scene *scene, size_t index, scree_error *error) {
  const assembly *of = &scene->assemblies[index];
  for (size_t p = 0; p < of->pieces.count; p++) {
    const piece *from = &of->pieces.items[p];
    scree_scene_shape *s = &scene->shapes[scene->shapes[index].first_piece + p];
    scree_error why;
    scree_status status = from->radius > 0
                              ? scree_particle_sphere(from->radius, &s->particle, &why)
                              : scree_particle_from_mesh(&from->mesh, NULL, &s->particle, &why);
    if (status != SCREE_OK)
      return scree_fail(error, why.status, "piece %zu of %zu: %.800s", p + 1, of->pieces.count,
                        why.message);
    const scree_particle_measures *m = &s->particle->measures;
    s->at = from->radius > 0 ? from->at : vec3_load(m->centre);
    s->turned = quat_load(m->orientation);
    s->source = scree_strdup("");
    if (!s->source) return scree_fail_memory(error, 0, "a piece's source");
  }
  return SCREE_OK;
}

/* Adds the cells of a surface, and the faces between them. */
static scree_status add_cells(assembly *to, const scree_mesh *mesh, const scree_plan_fracture *plan,
                              const char *part, uint32_t group, const scree_progress *progress,
                              scree_error *error) {
  scree_fracture_options o = scree_default_fracture_options();
  SCREE_CLEANUP(scree_fracture_free) scree_fracture made = {0};
  uint32_t first = (uint32_t)to->pieces.count;
  o.cell_count = plan->cells;
  o.seed = plan->seed;
  SCREE_TRY(scree_mesh_fracture(mesh, &o, progress, &made, error));
  for (size_t p = 0; p < made.piece_count; p++)
    SCREE_TRY(add_piece(to, &made.pieces[p], part, group, error));
  for (size_t f = 0; f < made.face_count; f++) {
    scree_fracture_face face = made.faces[f];
    face.a += first;
    face.b += first;
    SCREE_TRY_PUSH(&to->faces, error, face);
  }
  return SCREE_OK;
}

/* ---- parts that hold each other ---- */

static scree_status break_parts(const scree_plan_shape *plan, assembly *of, const mat3 *turn,
                                vec3 by, const scree_progress *progress, scree_error *error) {
  assembly parts = *of;
  scree_status status = SCREE_OK;
  of->pieces.items = NULL;
  of->pieces.count = of->pieces.capacity = 0;
  for (size_t k = 0; k < parts.pieces.count; k++) {
    piece *p = &parts.pieces.items[k];
    const scree_plan_component *c = component_of(plan, p->part);
    scree_error why;
    move(&p->mesh, turn, by);
    if (status == SCREE_OK && c && c->fracture) {
      status = add_cells(of, &p->mesh, c->fracture, p->part, p->group, progress, &why);
      if (status != SCREE_OK) scree_fail(error, status, "part %.60s: %.800s", p->part, why.message);
    } else if (status == SCREE_OK) {
      status = add_piece(of, &p->mesh, p->part, p->group, error);
    }
    scree_mesh_free(&p->mesh);
  }
  scree_free(parts.pieces.items);
  return status;
}

static scree_status face_parts(assembly *of, double gap, scree_error *error) {
  SCREE_SCRATCH(scree_facing_part, parts, of->pieces.count, error);
  scree_fracture found = {.faces = of->faces.items, .face_count = of->faces.count};
  for (size_t p = 0; p < of->pieces.count; p++)
    parts[p] = (scree_facing_part){&of->pieces.items[p].mesh, of->pieces.items[p].part,
                                   of->pieces.items[p].group};
  scree_status status = scree_parts_face(parts, of->pieces.count, gap, &found, error);
  of->faces.items = found.faces;
  of->faces.count = of->faces.capacity = found.face_count;
  return status;
}

/* Faces between spheres are those of a wire as thick as the smaller; a cable has them only from
 * each to the next. */
static scree_status face_spheres(assembly *of, double gap, bool cable, scree_error *error) {
  static const double pi = 3.14159265358979323846;
  for (size_t i = 0; i < of->pieces.count; i++)
    for (size_t k = i + 1; k < of->pieces.count && (!cable || k == i + 1); k++) {
      const piece *p = &of->pieces.items[i], *q = &of->pieces.items[k];
      vec3 between = vec3_sub(q->at, p->at), n = vec3_unit(between), u, w;
      double distance = vec3_norm(between), r = fmin(p->radius, q->radius), area = pi * r * r;
      if (distance > p->radius + q->radius + gap) continue;
      if (!(distance > 1e-3 * r))
        return scree_fail(error, SCREE_BAD_ARGUMENT, "spheres %zu and %zu have one centre", i + 1,
                          k + 1);
      scree_fracture_face f = {.a = (uint32_t)i,
                               .b = (uint32_t)k,
                               .area = area,
                               .second_moments = {area * r * r / 4, area * r * r / 4},
                               .reach = {r, r},
                               .distance = distance};
      vec3_frame(n, &u, &w);
      vec3_store(f.normal, n);
      vec3_store(f.axis, u);
      vec3_store(f.centre, vec3_mad(p->at, n, 0.5 * (distance + p->radius - q->radius)));
      SCREE_TRY_PUSH(&of->faces, error, f);
    }
  return SCREE_OK;
}

/* The gap from corners to corners, which is told of pieces that nothing holds. */
static double gap_between(const piece *p, const piece *q) {
  double least = INFINITY;
  if (p->radius > 0) return vec3_distance(p->at, q->at) - p->radius - q->radius;
  for (size_t i = 0; i < p->mesh.vertex_count; i++)
    for (size_t k = 0; k < q->mesh.vertex_count; k++)
      least = fmin(least,
                   vec3_distance(scree_mesh_vertex(&p->mesh, i), scree_mesh_vertex(&q->mesh, k)));
  return least;
}

static bool is_named(const scree_texts *names, const char *part) {
  for (size_t k = 0; part && k < names->count; k++)
    if (is_name(names->items[k], part)) return true;
  return false;
}

/* Fails unless all pieces hang together with the first that is not named as loose. */
static scree_status check_held(const assembly *of, const scree_plan_joints *plan, double gap,
                               scree_error *error) {
  SCREE_SCRATCH(uint32_t, root, of->pieces.count, error);
  size_t first = 0;
  for (size_t k = 0; k < plan->loose.count; k++) {
    const scree_texts name = {plan->loose.items + k, 1};
    size_t p = 0;
    while (p < of->pieces.count && !is_named(&name, of->pieces.items[p].part)) p++;
    if (p == of->pieces.count)
      return scree_fail(error, SCREE_BAD_ARGUMENT, "joints.loose: there is no part '%.60s'",
                        plan->loose.items[k]);
  }
  for (uint32_t p = 0; p < of->pieces.count; p++) root[p] = p;
  for (size_t f = 0; f < of->faces.count; f++)
    scree_join(root, of->faces.items[f].a, of->faces.items[f].b);
  while (first + 1 < of->pieces.count && is_named(&plan->loose, of->pieces.items[first].part))
    first++;
  for (size_t p = 0; p < of->pieces.count; p++) {
    const piece *one = &of->pieces.items[p];
    double least = INFINITY;
    const char *nearest = "";
    if (is_named(&plan->loose, one->part) ||
        scree_find_root(root, (uint32_t)p) == scree_find_root(root, (uint32_t)first))
      continue;
    for (size_t q = 0; q < of->pieces.count; q++) {
      if (scree_find_root(root, (uint32_t)q) == scree_find_root(root, (uint32_t)p)) continue;
      double apart = gap_between(one, &of->pieces.items[q]);
      if (apart < least) least = apart, nearest = of->pieces.items[q].part;
    }
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "nothing holds '%.60s': no face within the gap of %.3g mm; its corners are "
                      "%.3g mm from those of '%.60s'. Widen gap, or name it in loose",
                      one->part, gap * 1e3, least * 1e3, nearest);
  }
  return SCREE_OK;
}

/* Names in pairs are those of parts that hold each other. */
static scree_status check_pairs(const assembly *of, const scree_plan_joints *plan,
                                scree_error *error) {
  for (size_t k = 0; k < plan->pairs.count; k++) {
    const scree_plan_joined *pair = &plan->pairs.items[k];
    const piece *pieces = of->pieces.items;
    bool held = false;
    for (size_t f = 0; pieces && f < of->faces.count && !held; f++)
      held = is_between(&pair->between, pieces[of->faces.items[f].a].part,
                        pieces[of->faces.items[f].b].part);
    if (!held)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "joints.pairs.%zu: no faces of '%.60s' and '%.60s' lie within the gap: a "
                        "joint without area",
                        k, pair->between.items[0], pair->between.items[1]);
  }
  return SCREE_OK;
}

static scree_status hold_parts(scree_scene *scene, size_t index, const scree_progress *progress,
                               assembly *of, scree_error *error) {
  const scree_plan_shape *plan = plan_of(scene, index);
  const scree_particle *whole = scene->shapes[index].particle;
  const scree_particle_measures *m = &whole->measures;
  double gap = isnan(plan->joints->gap) ? usual_gap * m->size : plan->joints->gap;
  mat3 turn = quat_to_mat3(quat_conjugate(quat_load(m->orientation)));
  if (m->kind == SCREE_PARTICLE_CLUMP) {
    for (size_t i = 0; i < whole->point_count; i++) {
      const piece made = {.at = whole->points[i],
                          .radius = whole->point_radii[i],
                          .part = scree_arena_text(&scene->arena, "sphere"),
                          .group = (uint32_t)i};
      if (!made.part || !SCREE_PUSH(&of->pieces, made))
        return scree_fail_memory(error, sizeof made, "spheres");
    }
    SCREE_TRY(face_spheres(of, gap, plan->cable != NULL, error));
  } else {
    vec3 by = vec3_neg(mat3_mul_vec(&turn, vec3_load(m->centre)));
    SCREE_TRY(break_parts(plan, of, &turn, by, progress, error));
    SCREE_TRY(face_parts(of, gap, error));
  }
  SCREE_TRY(check_pairs(of, plan->joints, error));
  return check_held(of, plan->joints, gap, error);
}

static scree_status take_apart(scree_scene *scene, size_t index, const scree_progress *progress,
                               scree_error *error) {
  const scree_plan_shape *plan = plan_of(scene, index);
  const scree_particle *whole = scene->shapes[index].particle;
  assembly *of;
  SCREE_TRY(take_assembly(scene, index, &of, error));
  if (plan->joints) return hold_parts(scene, index, progress, of, error);
  if (whole->measures.kind != SCREE_PARTICLE_MESH)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "fracture: needs a surface, not spheres");
  return add_cells(of, &whole->mesh, plan->fracture, NULL, 0, progress, error);
}

scree_status scree_scene_break_shapes(scree_scene *scene, const scree_progress *progress,
                                      scree_error *error) {
  size_t named = scene->named_count, count = 0;
  for (size_t i = 0; i < named; i++) {
    scree_error why;
    if (!plan_of(scene, i)->fracture && !plan_of(scene, i)->joints) continue;
    scree_status status = take_apart(scene, i, progress, &why);
    SCREE_TRY(scree_scene_blame(scene, &plan_of(scene, i)->place, status, &why, error));
    count += scene->assemblies[i].pieces.count;
  }
  SCREE_SCRATCH(scree_scene_piece, pieces, count, error);
  count = 0;
  for (size_t i = 0; count + 1 && scene->assemblies && i < named; i++)
    for (size_t p = 0; p < scene->assemblies[i].pieces.count; p++) {
      const piece *from = &scene->assemblies[i].pieces.items[p];
      pieces[count++] = (scree_scene_piece){(uint32_t)i, from->group, from->part};
    }
  SCREE_TRY(scree_scene_append_pieces(scene, pieces, count, error));
  for (size_t i = 0; scene->assemblies && i < named; i++) {
    scree_error why;
    scree_status status = fill_pieces(scene, i, &why);
    SCREE_TRY(scree_scene_blame(scene, &plan_of(scene, i)->place, status, &why, error));
  }
  return SCREE_OK;
}

void scree_scene_forget_assemblies(scree_scene *scene) {
  for (size_t i = 0; scene->assemblies && i < scene->named_count; i++) {
    assembly *a = &scene->assemblies[i];
    for (size_t p = 0; p < a->pieces.count; p++) scree_mesh_free(&a->pieces.items[p].mesh);
    scree_free(a->pieces.items);
    scree_free(a->faces.items);
  }
  scree_free(scene->assemblies);
  scene->assemblies = NULL;
}

/* ---- joints in the gallery ---- */

/* Pieces that no face joins do not touch either while they hang together, if they are near. */
static scree_status keep_others_apart(scree_world *world, const assembly *of, bool *known,
                                      size_t first, double near, scree_error *error) {
  size_t pieces = of->pieces.count;
  scree_joint touch = scree_default_joint();
  SCREE_SCRATCH(scree_box, boxes, pieces, error);
  for (size_t p = 0; p < pieces; p++) {
    const piece *one = &of->pieces.items[p];
    boxes[p] = one->radius > 0 ? scree_box_grown(scree_box_of(one->at, one->at), one->radius)
                               : scree_box_of_points(one->mesh.positions, one->mesh.vertex_count);
  }
  for (size_t p = 0; p < pieces; p++)
    for (size_t q = p + 1; q < pieces; q++) {
      scree_box grown = scree_box_grown(boxes[p], near);
      if (known[p * pieces + q] || !scree_box_meets(&grown, &boxes[q])) continue;
      touch.a = first + p;
      touch.b = first + q;
      SCREE_TRY(scree_world_add_joint(world, &touch, NULL, error));
    }
  return SCREE_OK;
}

/* What a sheet or a wire has instead of a solid's section. */
static void take_section(const scree_plan_shape *plan, const piece *a, double young, double poisson,
                         const scree_fracture_face *face, scree_joint *j) {
  double width = face->area / plan->thickness;
  if (a->radius > 0) {
    scree_joint_of_wire(young, poisson, face->reach[0], face->distance, j);
    for (int k = 0; k < 3; k++) j->turning[k] *= plan->joints->bending;
  } else if (width > plan->thickness) {
    scree_joint_of_rectangle(SCREE_SECTION_SHEET, young, poisson, width, plan->thickness,
                             face->distance, j);
  }
}

/* The whole's own frame is the gallery's, but for where it stands. */
static scree_status join_pieces(const scree_scene *scene, size_t index, scree_error *error) {
  const assembly *of = &scene->assemblies[index];
  const scree_plan_shape *plan = plan_of(scene, index);
  size_t pieces = of->pieces.count, first = scene->shapes[index].first_piece;
  scree_material usual = scree_default_material();
  double contacts = usual.young, poisson = usual.poisson;
  if (scene->plan.materials.count) {
    const scree_plan_material *m = &scene->plan.materials.items[scene->shapes[index].material];
    contacts = m->young, poisson = m->poisson;
  }
  vec3 origin = scene->gallery->bodies.frame[index].position;
  SCREE_SCRATCH_ZERO(bool, known, pieces *pieces, error);
  for (size_t i = 0; i < of->faces.count; i++) {
    const scree_fracture_face *face = &of->faces.items[i];
    scree_plan_bond bond = bond_between(scene, index, first + face->a, first + face->b);
    double young = isnan(bond.young) ? fmax(bond.tension / longest_strain, contacts) : bond.young;
    scree_joint j = scree_default_joint();
    young *= scene->plan.contact->stiffness_factor;
    scree_joint_of_face(face, young, &j);
    take_section(plan, &of->pieces.items[face->a], young, poisson, face, &j);
    vec3_store(j.centre, vec3_add(vec3_load(j.centre), origin));
    j.a = first + face->a;
    j.b = first + face->b;
    j.damping = bond.damping;
    j.tension = bond.tension;
    j.cohesion = bond.cohesion;
    j.friction = bond.friction;
    j.toughness = bond.toughness;
    known[face->a * pieces + face->b] = known[face->b * pieces + face->a] = true;
    SCREE_TRY(scree_world_add_joint(scene->gallery, &j, NULL, error));
  }
  return keep_others_apart(scene->gallery, of, known, first,
                           usual_gap * scene->shapes[index].particle->measures.size, error);
}

/* Where its pieces lie, by the gallery: the same bits for one that was loaded. */
void scree_scene_place_pieces(scree_scene *scene) {
  const scree_bodies *b = &scene->gallery->bodies;
  for (size_t i = scene->named_count; i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_scene_shape *s = &scene->shapes[i];
    s->at = vec3_sub(b->frame[i].position, b->frame[s->assembly].position);
    s->turned = b->orientation[i];
  }
}

scree_status scree_scene_join_gallery(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; scene->assemblies && i < scene->named_count; i++) {
    scree_error why;
    if (scene->assemblies[i].pieces.count == 0) continue;
    scree_status status = join_pieces(scene, i, &why);
    SCREE_TRY(scree_scene_blame(scene, &plan_of(scene, i)->place, status, &why, error));
  }
  scree_scene_forget_assemblies(scene);
  scree_scene_place_pieces(scene);
  return SCREE_OK;
}

/* ---- what enters ---- */

/* Weibull's: 63 % of joints are below the strength that the file gives. */
static double draw_strength(const scree_scene *scene, double modulus) {
  if (!(modulus > 0)) return 1;
  scree_rng rng = {scene->plan.seed, STRENGTHS, scree_world_joint_count(scene->world)};
  return scree_power_of_ten(scree_log10(-scree_log(1 - scree_rng_uniform(&rng))) / modulus);
}

scree_status scree_scene_admit_assembly(scree_scene *scene, size_t shape, const scree_body *body,
                                        scree_error *error) {
  scree_scene_shape *whole = &scene->shapes[shape];
  size_t first = whole->first_piece, end = first + whole->piece_count,
         base = scree_world_body_count(scene->world);
  quat turn = quat_unit(scree_body_turn(body));
  mat3 rotation = quat_to_mat3(turn);
  vec3 spin = vec3_load(body->angular_velocity);
  for (size_t i = first; i < end; i++) {
    const scree_scene_shape *s = &scene->shapes[i];
    scree_body one = *body;
    vec3 at = mat3_mul_vec(&rotation, s->at);
    quat turned = quat_mul(turn, s->turned);
    vec3_store(one.position, vec3_add(vec3_load(body->position), at));
    vec3_store(one.velocity, vec3_add(vec3_load(body->velocity), vec3_cross(spin, at)));
    memcpy(one.orientation, (double[4]){turned.w, turned.x, turned.y, turned.z},
           sizeof one.orientation);
    SCREE_TRY(scree_scene_admit(scene, i, &one, error));
  }
  const scree_joints *joints = &scene->gallery->joints;
  for (size_t k = 0; k < joints->all.count; k++) {
    const scree_world_joint *j = &joints->all.items[k];
    if (j->a < first || j->a >= end) continue;
    double modulus = j->area > 0 ? bond_between(scene, shape, j->a, j->b).weibull : 0;
    SCREE_TRY(scree_world_copy_joint(scene->world, j, (uint32_t)(base - first),
                                     draw_strength(scene, modulus), error));
  }
  whole->entered++;
  return SCREE_OK;
}
