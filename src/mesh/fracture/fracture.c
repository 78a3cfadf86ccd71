/* The driver: places of the cells, their cutting, their faces as triangles, pieces. All is done in
 * a space in which the body's middle is the origin and the grain is as short as what lies across.
 */
#include "base/progress.h"
#include "base/rng.h"
#include "mesh/fracture/halve.h"
#include "mesh/fracture/pieces.h"
#include "mesh/fracture/sites.h"
#include "mesh/measure/bounds.h"

#include <float.h>

/* How far places are moved where there is a doubt, of the body's size; and how often. */
static const double nudge = 1e-6;
enum { MOST_RESTARTS = 40 };
/* Of a cell, in roundings of the coordinates. */
static const double least_cell = 1e5;

scree_fracture_options scree_default_fracture_options(void) {
  return (scree_fracture_options){.cell_count = 60,
                                  .seed = 1,
                                  .rounds = 8,
                                  .grain_stretch = 1,
                                  .grain = {0, 0, 1},
                                  .least_volume = 0.01,
                                  .usable = true};
}

void scree_fracture_free(scree_fracture *fracture) {
  for (size_t p = 0; fracture->pieces && p < fracture->piece_count; p++)
    scree_mesh_free(&fracture->pieces[p]);
  scree_free(fracture->pieces);
  scree_free(fracture->faces);
  *fracture = (scree_fracture){.pieces = NULL};
}

typedef struct breaking {
  const scree_mesh *given;
  const scree_fracture_options *options;
  const vec3 *places; /* of the cells, in the given mesh's space; NULL: drawn */
  scree_mesh mesh;    /* in the space of the cutting */
  mat3 there;         /* from it to the given one, but for the middle */
  vec3 middle;
  vec3 *sites;
  scree_cutter cutter;
  scree_polygons polygons;
} breaking;

static scree_status check_options(const scree_fracture_options *o, scree_error *error) {
  bool places = isfinite(vec3_norm2(vec3_load(o->near))) && isfinite(o->near_distance);
  double grain = vec3_norm2(vec3_load(o->grain));
  if (o->cell_count < 1 || o->cell_count > SCREE_MOST_CELLS)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu cells: must be 1 to %d", o->cell_count,
                      SCREE_MOST_CELLS);
  if (o->rounds > 1000)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu rounds: must be at most 1000", o->rounds);
  if (!places || o->near_distance < 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "near: must be finite, its distance not below 0");
  if (!(o->grain_stretch >= 1 && o->grain_stretch <= 100) || !(grain > 0) || !isfinite(grain))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "a grain of %g: must be 1 to 100, along a direction", o->grain_stretch);
  if (!(o->least_volume >= 0 && o->least_volume <= 0.5))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "least volume %g: must be 0 to 0.5",
                      o->least_volume);
  return SCREE_OK;
}

/* flat: it may have facets without area, as pieces of a cut have. */
static scree_status check_mesh(const scree_mesh *mesh, bool flat, double *volume,
                               scree_error *error) {
  scree_topology t;
  SCREE_TRY(scree_mesh_topology(mesh, &t, error));
  if (!t.closed || !t.manifold || !t.oriented || (t.degenerate_facet_count > 0 && !flat))
    return scree_fail(error, SCREE_BAD_MESH,
                      "cannot be broken: %zu boundary edges, %zu non-manifold edges and vertices, "
                      "%zu edges wound unlike, %zu facets without area; repair it first",
                      t.boundary_edge_count,
                      t.non_manifold_edge_count + t.non_manifold_vertex_count,
                      t.inconsistent_edge_count, t.degenerate_facet_count);
  SCREE_TRY(scree_mesh_area_volume(mesh, NULL, volume, error));
  if (!(*volume > 0))
    return scree_fail(error, SCREE_BAD_MESH, "cannot be broken: its volume is %g mm3",
                      *volume * 1e9);
  return SCREE_OK;
}

/* x + (stretch - 1) (grain . x) grain, or its inverse. */
static mat3 stretch(const scree_fracture_options *o, bool back) {
  vec3 g = vec3_unit(vec3_load(o->grain));
  double by = (back ? 1 / o->grain_stretch : o->grain_stretch) - 1, n[3] = {g.x, g.y, g.z};
  mat3 m;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) m.m[i][j] = (i == j) + by * n[i] * n[j];
  return m;
}

static scree_status into_space(breaking *b, scree_error *error) {
  vec3 low, high;
  mat3 here = stretch(b->options, true);
  b->there = stretch(b->options, false);
  SCREE_TRY(scree_mesh_copy(b->given, &b->mesh, error));
  scree_mesh_bounds(b->given, &low, &high);
  b->middle = vec3_scale(vec3_add(low, high), 0.5);
  for (size_t v = 0; v < b->mesh.vertex_count; v++)
    vec3_store(b->mesh.positions + 3 * v,
               mat3_mul_vec(&here, vec3_sub(scree_mesh_vertex(b->given, v), b->middle)));
  return SCREE_OK;
}

/* ---- faces ---- */

static scree_status add_face(breaking *b, uint32_t cell, const scree_cut_cell *cut,
                             const scree_cut_face *face, bool *doubtful, scree_error *error) {
  const scree_cut_edge *edges = cut->edges.items + face->first;
  uint32_t triangles = (uint32_t)b->mesh.triangle_count, other = face->face - triangles;
  if (face->face < triangles) other = SCREE_NO_CELL;
  if (cell > other) return SCREE_OK; /* the other cell's triangles are taken */
  vec3 normal = scree_cut_normal(&b->cutter, cell, face->face);
  size_t first = b->polygons.list.count;
  SCREE_TRY(
      scree_polygons_add(&b->cutter, edges, face->count, normal, &b->polygons, doubtful, error));
  for (; first < b->polygons.list.count; first++)
    memcpy(b->polygons.list.items[first].of, (uint32_t[]){cell, other}, 2 * sizeof cell);
  return SCREE_OK;
}

/* ---- all cells ---- */

static scree_status cut_cells(breaking *b, scree_ticker *ticker, bool *doubtful,
                              scree_error *error) {
  SCREE_CLEANUP(scree_cut_cell_free) scree_cut_cell cell = {.faces = {0}};
  b->polygons.list.count = b->polygons.corners.count = 0;
  scree_cutter_free(&b->cutter);
  SCREE_TRY(scree_cutter_make(&b->mesh, b->sites, b->options->cell_count, &b->cutter, error));
  for (size_t i = 0; i < b->options->cell_count && !*doubtful; i++) {
    if (!scree_tick(ticker, "cutting", (double)i / (double)b->options->cell_count))
      return scree_fail(error, SCREE_CANCELLED, "cancelled");
    SCREE_TRY(scree_cut_cell_of(&b->cutter, i, &cell, doubtful, error));
    for (size_t f = 0; f < cell.faces.count && !*doubtful; f++)
      SCREE_TRY(add_face(b, (uint32_t)i, &cell, &cell.faces.items[f], doubtful, error));
  }
  return SCREE_OK;
}

/* Where all vertices and sites lie in the mesh's own space: its own vertices to the last bit. */
static void out_of_space(const breaking *b, vec3 *places, vec3 *sites) {
  for (size_t v = 0; v < b->cutter.vertices.count; v++) {
    vec3 at = mat3_mul_vec(&b->there, b->cutter.vertices.items[v].at);
    places[v] =
        v < b->given->vertex_count ? scree_mesh_vertex(b->given, v) : vec3_add(at, b->middle);
  }
  for (size_t i = 0; i < b->options->cell_count; i++)
    sites[i] = vec3_add(mat3_mul_vec(&b->there, b->sites[i]), b->middle);
}

static scree_status make_pieces(breaking *b, scree_fracture *out, bool *doubtful,
                                scree_error *error) {
  SCREE_SCRATCH(vec3, places, b->cutter.vertices.count, error);
  SCREE_SCRATCH(vec3, sites, b->options->cell_count, error);
  out_of_space(b, places, sites);
  out->apart_count = 0;
  const scree_cut_body body = {b->given, &b->cutter, places, &b->polygons, b->options->cell_count};
  return scree_fracture_pieces(&body, b->options, sites, out, doubtful, error);
}

static void move_sites(breaking *b, scree_rng *rng) {
  double by = nudge * b->cutter.size;
  for (size_t i = 0; i < b->options->cell_count; i++) {
    double x = scree_rng_uniform(rng), y = scree_rng_uniform(rng), z = scree_rng_uniform(rng);
    b->sites[i] = vec3_mad(b->sites[i], (vec3){x - 0.5, y - 0.5, z - 0.5}, by);
  }
}

static scree_status work(breaking *b, scree_ticker *ticker, scree_fracture *out,
                         scree_error *error) {
  scree_rng rng = {b->options->seed, 2, 0};
  SCREE_TRY_ALLOC(b->sites, b->options->cell_count, error);
  SCREE_TRY(into_space(b, error));
  scree_fracture_options drawn = *b->options;
  vec3_store(drawn.near, vec3_sub(vec3_load(drawn.near), b->middle));
  for (size_t i = 0; b->places && i < b->options->cell_count; i++)
    b->sites[i] = vec3_sub(b->places[i], b->middle);
  if (!b->places) SCREE_TRY(scree_sites_draw(&b->mesh, &b->there, &drawn, b->sites, error));
  for (size_t restarts = 0; restarts < MOST_RESTARTS; restarts++) {
    bool doubtful = false;
    SCREE_TRY(cut_cells(b, ticker, &doubtful, error));
    if (!doubtful) SCREE_TRY(make_pieces(b, out, &doubtful, error));
    out->restart_count = restarts;
    if (!doubtful) return SCREE_OK;
    move_sites(b, &rng);
  }
  return scree_fail(
      error, SCREE_BAD_MESH,
      "cannot be broken into %zu cells: facets or edges are smaller than the rounding "
      "of the cuts (%.3g mm)",
      b->options->cell_count, 1e-10 * b->cutter.size * 1e3);
}

static scree_status check_volume(const scree_fracture *f, scree_error *error) {
  double sum = 0, volume;
  for (size_t p = 0; p < f->piece_count; p++) {
    SCREE_TRY(scree_mesh_area_volume(&f->pieces[p], NULL, &volume, error));
    sum += volume;
  }
  if (fabs(sum - f->volume) <= 1e-9 * f->volume) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH,
                    "cannot be broken: the pieces have %.12g mm3, the body %.12g mm3; does it meet "
                    "itself?",
                    sum * 1e9, f->volume * 1e9);
}

/* Where planes meet some digits are lost. */
static scree_status check_cells(const scree_mesh *mesh, const scree_fracture_options *o,
                                double volume, scree_error *error) {
  scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  vec3 far = vec3_max(vec3_abs(box.low), vec3_abs(box.high));
  double cell = cbrt(volume / (double)o->cell_count), rounding = DBL_EPSILON * vec3_norm(far);
  if (cell > least_cell * rounding) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH,
                    "cannot be broken into %zu cells: of %.3g mm each they are too near to the "
                    "rounding of the coordinates, %.3g mm; move it to the origin",
                    o->cell_count, cell * 1e3, rounding * 1e3);
}

static scree_status fracture_at(const scree_mesh *mesh, const scree_fracture_options *options,
                                const vec3 *places, const scree_progress *progress,
                                scree_fracture *fracture, scree_error *error) {
  scree_ticker ticker = {progress, 0};
  breaking b = {.given = mesh, .options = options, .places = places};
  scree_fracture made = {.pieces = NULL};
  SCREE_TRY(check_options(b.options, error));
  SCREE_TRY(check_mesh(mesh, places != NULL, &made.volume, error));
  SCREE_TRY(check_cells(mesh, options, made.volume, error));
  scree_status status = work(&b, &ticker, &made, error);
  scree_mesh_free(&b.mesh);
  scree_free(b.sites);
  scree_cutter_free(&b.cutter);
  scree_polygons_free(&b.polygons);
  if (status == SCREE_OK) status = check_volume(&made, error);
  if (status == SCREE_OK)
    *fracture = made;
  else
    scree_fracture_free(&made);
  return status;
}

scree_status scree_mesh_fracture(const scree_mesh *mesh, const scree_fracture_options *options,
                                 const scree_progress *progress, scree_fracture *fracture,
                                 scree_error *error) {
  scree_fracture_options defaults = scree_default_fracture_options();
  return fracture_at(mesh, options ? options : &defaults, NULL, progress, fracture, error);
}

scree_status scree_mesh_halve(const scree_mesh *mesh, vec3 at, vec3 normal, double size,
                              scree_fracture *halves, scree_error *error) {
  scree_fracture_options o = scree_default_fracture_options();
  o.cell_count = 2;
  o.least_volume = 0;
  o.usable = false;
  vec3 places[] = {vec3_mad(at, normal, -size), vec3_mad(at, normal, size)};
  return fracture_at(mesh, &o, places, NULL, halves, error);
}
