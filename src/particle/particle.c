/* Making particles. A mesh is moved into its principal frame first, so that everything the physics
 * reads is in one frame. The radius of the rounding is 0.002 of the size: small against the shape,
 * large against resting overlaps (micrometres), so that resting contacts see separated surfaces
 * whose closest points and normals are exact. The surface stands out by as much, but by no more
 * than a 250th of the thickness: what is rounded is a core that lies deeper by the difference
 * (inset.c), and thin plates are stacked right to 1 %. */
#include "particle/particle.h"

#include "base/owned.h"
#include "base/radix.h"
#include "particle/closest.h"
#include "particle/mass.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double rounding_radius = 0.002;   /* of the size, at least */
static const double most_rounding = 1.0 / 250; /* of the thickness */
enum { RIM_SIDES = 720 };

scree_particle_options scree_default_particle_options(void) {
  return (scree_particle_options){.rounding = 0};
}

void scree_particle_retain(scree_particle *particle) {
  atomic_fetch_add(&particle->reference_count, 1);
}

static void drop_features(scree_particle *p) {
  scree_free(p->faces);
  scree_free(p->face_signs);
  scree_free(p->points);
  scree_free(p->point_radii);
  scree_free(p->edges);
  scree_free(p->core);
  scree_tree_free(&p->face_tree);
  scree_tree_free(&p->edge_tree);
  scree_tree_free(&p->point_tree);
  p->faces = NULL, p->face_signs = NULL, p->points = NULL, p->point_radii = NULL;
  p->edges = NULL, p->core = NULL, p->point_count = p->edge_count = 0;
}

void scree_particle_free(scree_particle *p) {
  if (!p || atomic_fetch_sub(&p->reference_count, 1) > 1) return;
  scree_mesh_free(&p->mesh);
  drop_features(p);
  scree_free(p);
}

static scree_status make(scree_particle_kind kind, scree_particle **particle, scree_error *error) {
  scree_particle *p;
  SCREE_TRY_ALLOC_ZERO(p, 1, error);
  atomic_init(&p->reference_count, 1);
  p->measures.kind = kind;
  p->measures.orientation[0] = 1;
  *particle = p;
  return SCREE_OK;
}

/* Hands what was made over. */
static scree_status give(scree_particle **made, scree_particle **particle) {
  *particle = *made;
  *made = NULL;
  return SCREE_OK;
}

/* Volume, size, centre, orientation and moments of inertia. */
static void set_solid(scree_particle_measures *m, const scree_solid *solid) {
  vec3 moments;
  quat q;
  scree_solid_principal(solid, &moments, &q);
  m->volume = solid->volume;
  m->size = scree_cbrt(6 * solid->volume / pi);
  vec3_store(m->centre, solid->centre);
  vec3_store(m->inertia, moments);
  const double orientation[4] = {q.w, q.x, q.y, q.z};
  memcpy(m->orientation, orientation, sizeof orientation);
}

/* From the coordinates it was made from into its own frame. */
static vec3 into_frame(const scree_particle_measures *m, const double *position) {
  mat3 r = quat_to_mat3(quat_load(m->orientation));
  return mat3_tmul_vec(&r, vec3_sub(vec3_load(position), vec3_load(m->centre)));
}

static void set_bounding_radius(scree_particle *p) {
  double r = 0;
  for (size_t i = 0; i < p->mesh.vertex_count; i++)
    r = scree_max(r, vec3_norm(vec3_load(&p->mesh.positions[3 * i])) + p->measures.rounding);
  for (size_t i = 0; i < p->point_count; i++)
    r = scree_max(r, vec3_norm(p->points[i]) + p->point_radii[i]);
  p->measures.bounding_radius = r;
}

typedef struct wall_sample {
  double depth, area;
} wall_sample;

SCREE_ORDER_BY(compare_walls, wall_sample, depth)

static const double least_across = 0.8; /* cosine, of walls that count as facing away */

/* Distance through the solid from a face's middle against its normal, to a wall that faces away:
 * the depth that 1 % of the surface stays below (single rays graze corners and notches). */
static scree_status measure_thickness(scree_particle *p, scree_error *error) {
  SCREE_SCRATCH(wall_sample, walls, p->face_count, error);
  double total = 0, below = 0;
  for (size_t f = 0; f < p->face_count; f++) {
    const scree_face *face = &p->faces[f];
    vec3 middle = vec3_mad(face->corner, vec3_add(face->along1, face->along2), 1.0 / 3);
    const scree_ray_interval inwards = {middle, vec3_neg(face->normal), 0, INFINITY};
    uint32_t across;
    walls[f] = (wall_sample){scree_next_passage(p, &inwards, least_across, f, &across),
                             0.5 / sqrt(face->inverse)};
    total += walls[f].area;
  }
  qsort(walls, p->face_count, sizeof *walls, compare_walls);
  size_t k = 0;
  while (k + 1 < p->face_count && (below += walls[k].area) < 0.01 * total) k++;
  p->measures.thickness = walls[k].depth;
  return SCREE_OK;
}

static void set_counts(scree_particle *p) {
  p->measures.triangle_count = p->mesh.triangle_count;
  p->measures.point_count = p->point_count;
  p->measures.edge_count = p->edge_count;
}

/* Features, their trees, and what is counted and measured of them. */
static scree_status extract_all(scree_particle *p, bool is_wall, scree_error *error) {
  SCREE_TRY(scree_particle_extract_features(p, is_wall, error));
  SCREE_TRY(scree_particle_build_trees(p, error));
  set_bounding_radius(p);
  set_counts(p);
  return SCREE_OK;
}

static double radius_of(const scree_particle_measures *m) {
  return scree_max(m->rounding, rounding_radius * m->size);
}

static scree_status make_mesh_particle(scree_particle *p, double rounding, scree_error *error) {
  scree_solid solid = scree_solid_of_mesh(&p->mesh);
  if (!(solid.volume > 0 && isfinite(solid.volume)))
    return scree_fail(error, SCREE_BAD_MESH,
                      "particle: the mesh encloses a volume of %g m3: turned inside out?",
                      solid.volume);
  set_solid(&p->measures, &solid);
  for (size_t v = 0; v < p->mesh.vertex_count; v++) {
    double *position = &p->mesh.positions[3 * v];
    vec3_store(position, into_frame(&p->measures, position));
  }
  SCREE_TRY(extract_all(p, false, error));
  SCREE_TRY(measure_thickness(p, error));
  scree_particle_measures *m = &p->measures;
  double least = rounding_radius * m->size;
  m->rounding = rounding > 0 ? rounding : scree_min(least, most_rounding * m->thickness);
  p->radius = radius_of(m);
  drop_features(p);
  SCREE_TRY(extract_all(p, false, error));
  scree_particle_find_inner(p);
  return SCREE_OK;
}

/* What the features' extraction does not see: surfaces that meet themselves, shells in shells. */
static scree_status check_surface(const scree_mesh *mesh, scree_error *error) {
  scree_check check;
  SCREE_TRY(scree_mesh_check(mesh, NULL, NULL, &check, error));
  if (check.usable) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH, "particle: the mesh is %s", check.verdict);
}

scree_status scree_particle_from_mesh(const scree_mesh *mesh, const scree_particle_options *options,
                                      scree_particle **particle, scree_error *error) {
  double rounding = options ? options->rounding : 0;
  if (!(rounding >= 0 && isfinite(rounding)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "particle: rounding %g m; at least 0", rounding);
  SCREE_OWNED(scree_particle, p);
  SCREE_TRY(make(SCREE_PARTICLE_MESH, &p, error));
  SCREE_TRY(scree_mesh_copy(mesh, &p->mesh, error));
  /* first as it stands, so that messages name what is wrong before the volume is asked for */
  SCREE_TRY(scree_particle_extract_features(p, false, error));
  drop_features(p);
  SCREE_TRY(check_surface(mesh, error));
  SCREE_TRY(make_mesh_particle(p, rounding, error));
  return give(&p, particle);
}

scree_status scree_particle_surface(const scree_mesh *mesh, double rounding, bool two_sided,
                                    scree_particle **particle, scree_error *error) {
  SCREE_OWNED(scree_particle, p);
  SCREE_TRY(make(SCREE_PARTICLE_MESH, &p, error));
  p->measures.rounding = p->radius = rounding;
  p->sheet = two_sided;
  SCREE_TRY(scree_mesh_copy(mesh, &p->mesh, error));
  SCREE_TRY(extract_all(p, true, error));
  double volume = p->sheet ? 0 : scree_solid_of_mesh(&p->mesh).volume;
  p->hollow = volume < 0;
  p->measures.volume = fabs(volume);
  SCREE_TRY(measure_thickness(p, error));
  return give(&p, particle);
}

scree_edge scree_rim_edge(vec3 start, vec3 end, vec3 outward) {
  vec3 along = vec3_sub(end, start);
  return (scree_edge){
      .start = start,
      .end = end,
      .along = vec3_unit(along),
      .length = vec3_norm(along),
      .normals = {outward, -scree_rim_slack, sqrt(1 - scree_rim_slack * scree_rim_slack)},
      .facing = -scree_rim_slack};
}

static void add_circle(scree_particle *p, const scree_circle *circle) {
  for (int k = 0; k < RIM_SIDES; k++) {
    vec3 at[2], way = {0, 0, 0};
    for (int end = 0; end < 2; end++) {
      double angle = 2 * pi * ((k + end) % RIM_SIDES) / RIM_SIDES, c = scree_cos(angle),
             s = scree_sin(angle);
      at[end] = (vec3){circle->radius * c, circle->radius * s, circle->height};
      way = vec3_add(way, (vec3){circle->radial * c, circle->radial * s, circle->axial});
    }
    p->points[p->point_count] = at[0];
    p->point_radii[p->point_count++] = 0;
    p->edges[p->edge_count++] = scree_rim_edge(at[0], at[1], vec3_unit(way));
  }
}

scree_status scree_particle_circles(const scree_circle *circles, size_t count,
                                    scree_particle **particle, scree_error *error) {
  SCREE_OWNED(scree_particle, p);
  SCREE_TRY(make(SCREE_PARTICLE_MESH, &p, error));
  SCREE_TRY_ALLOC(p->points, count * RIM_SIDES, error);
  SCREE_TRY_ALLOC(p->point_radii, count * RIM_SIDES, error);
  SCREE_TRY_ALLOC(p->edges, count * RIM_SIDES, error);
  for (size_t i = 0; i < count; i++) add_circle(p, &circles[i]);
  set_bounding_radius(p);
  set_counts(p);
  SCREE_TRY(scree_particle_build_trees(p, error));
  return give(&p, particle);
}

scree_status scree_particle_sphere(double radius, scree_particle **particle, scree_error *error) {
  if (!(radius > 0 && isfinite(radius)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "particle: sphere of radius %g m; above 0",
                      radius);
  const double centre[3] = {0};
  SCREE_TRY(scree_particle_clump(centre, &radius, 1, NULL, particle, error));
  (*particle)->measures.kind = SCREE_PARTICLE_SPHERE;
  return SCREE_OK;
}

static scree_solid solid_of_clump(const double *centres, const double *radii, size_t count) {
  if (count > 1) return scree_solid_of_spheres(centres, radii, count);
  double v = 4 * pi / 3 * radii[0] * radii[0] * radii[0], c = v * radii[0] * radii[0] / 5;
  return (scree_solid){v, vec3_load(centres), {{{c, 0, 0}, {0, c, 0}, {0, 0, c}}}};
}

static scree_status fill_clump(scree_particle *p, const double *centres, const double *radii,
                               size_t count, scree_error *error) {
  SCREE_TRY_ALLOC(p->points, count, error);
  SCREE_TRY_ALLOC(p->point_radii, count, error);
  p->point_count = count;
  double thinnest = INFINITY;
  for (size_t i = 0; i < count; i++) {
    p->points[i] = into_frame(&p->measures, &centres[3 * i]);
    p->point_radii[i] = radii[i];
    thinnest = scree_min(thinnest, 2 * radii[i]);
  }
  p->measures.thickness = thinnest;
  set_bounding_radius(p);
  set_counts(p);
  SCREE_TRY(scree_particle_build_trees(p, error));
  scree_particle_find_inner(p);
  return SCREE_OK;
}

scree_status scree_particle_clump(const double *centres, const double *radii, size_t count,
                                  const scree_particle *like, scree_particle **particle,
                                  scree_error *error) {
  if (count == 0 || count > UINT32_MAX / 8)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "particle: a clump of %zu spheres; 1 to %u", count,
                      UINT32_MAX / 8);
  for (size_t i = 0; i < count; i++)
    if (!(radii[i] > 0 &&
          isfinite(radii[i] + centres[3 * i] + centres[3 * i + 1] + centres[3 * i + 2])))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "particle: sphere %zu of the clump has radius %g m at %g %g %g", i,
                        radii[i], centres[3 * i], centres[3 * i + 1], centres[3 * i + 2]);
  SCREE_OWNED(scree_particle, p);
  SCREE_TRY(make(SCREE_PARTICLE_CLUMP, &p, error));
  if (like) {
    p->measures = like->measures;
    p->measures.kind = SCREE_PARTICLE_CLUMP;
    p->measures.rounding = 0;
  } else {
    scree_solid solid = solid_of_clump(centres, radii, count);
    set_solid(&p->measures, &solid);
  }
  if (!(p->measures.volume > 0)) return scree_fail_memory(error, count, "a clump");
  SCREE_TRY(fill_clump(p, centres, radii, count, error));
  return give(&p, particle);
}

scree_status scree_particle_clump_of(const double *centres, const double *radii, size_t count,
                                     const scree_solid *solid, scree_particle **particle,
                                     scree_error *error) {
  if (!solid) return scree_particle_clump(centres, radii, count, NULL, particle, error);
  scree_particle like = {.measures = {0}};
  set_solid(&like.measures, solid);
  return scree_particle_clump(centres, radii, count, &like, particle, error);
}

static scree_status restore(scree_particle *p, const scree_mesh *mesh, const double *centres,
                            const double *radii, size_t count, scree_error *error) {
  if (p->measures.kind == SCREE_PARTICLE_MESH) {
    p->radius = radius_of(&p->measures);
    SCREE_TRY(scree_mesh_copy(mesh, &p->mesh, error));
    SCREE_TRY(scree_particle_extract_features(p, false, error));
  } else {
    SCREE_TRY_ALLOC(p->points, count, error);
    SCREE_TRY_ALLOC(p->point_radii, count, error);
    p->point_count = count;
    for (size_t i = 0; i < count; i++) p->points[i] = vec3_load(&centres[3 * i]);
    for (size_t i = 0; i < count; i++) p->point_radii[i] = radii[i];
  }
  set_counts(p);
  SCREE_TRY(scree_particle_build_trees(p, error));
  scree_particle_find_inner(p);
  return SCREE_OK;
}

scree_status scree_particle_restore(const scree_particle_measures *measures, const scree_mesh *mesh,
                                    const double *centres, const double *radii, size_t count,
                                    scree_particle **particle, scree_error *error) {
  SCREE_OWNED(scree_particle, p);
  SCREE_TRY(make(measures->kind, &p, error));
  p->measures = *measures;
  SCREE_TRY(restore(p, mesh, centres, radii, count, error));
  return give(&p, particle);
}

static void scale_measures(scree_particle_measures *m, double factor) {
  const double square = factor * factor;
  double *const lengths[] = {&m->size, &m->bounding_radius, &m->thickness, &m->rounding};
  m->volume *= factor * square;
  for (int k = 0; k < 3; k++) m->centre[k] *= factor, m->inertia[k] *= factor * square * square;
  for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) *lengths[i] *= factor;
}

scree_status scree_particle_scaled(const scree_particle *from, double factor,
                                   scree_particle **particle, scree_error *error) {
  scree_particle_measures m = from->measures;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  SCREE_SCRATCH(double, spheres, 4 * from->point_count, error);
  double *radii = spheres + 3 * from->point_count;
  scale_measures(&m, factor);
  for (size_t i = 0; i < from->point_count; i++) {
    vec3_store(spheres + 3 * i, vec3_scale(from->points[i], factor));
    radii[i] = factor * from->point_radii[i];
  }
  SCREE_TRY(scree_mesh_copy(&from->mesh, &mesh, error));
  scree_mesh_scale(&mesh, factor);
  return scree_particle_restore(&m, &mesh, spheres, radii, from->point_count, particle, error);
}

void scree_particle_measure(const scree_particle *particle, scree_particle_measures *measures) {
  *measures = particle->measures;
}

const scree_mesh *scree_particle_mesh(const scree_particle *particle) {
  return &particle->mesh;
}

void scree_particle_point(const scree_particle *particle, size_t index, double centre[3],
                          double *radius) {
  vec3_store(centre, particle->points[index]);
  *radius = particle->point_radii[index];
}
