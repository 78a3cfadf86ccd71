/* Cutting by keys. A face is a SET of directed edges, so that holes and faces that are not convex
 * need no case: a plane keeps, shortens or drops each edge, and what it cuts of a face is paired
 * along the line where the two meet, each way out with the next way in. A vertex is a KEY, the
 * planes that meet in it, and has its place from the mesh and the sites alone: the cells on all
 * sides of it get the same bits. Where a point lies too near to a plane to tell its side, or to
 * another on a line to tell their order, the sites, which are ours, are moved: no exact arithmetic,
 * no special position. */
#include "mesh/fracture/cut.h"
#include "base/array.h"
#include "mesh/adjacency.h"

#include <stdlib.h>

/* The margin as a share of the body's size. Coordinates round by 1e-16 of it, planes that meet at
 * some degrees lose two or three digits: 1e-10 is far above both, and a point in a million comes as
 * near. */
static const double margin_share = 1e-10;
/* Points of one line, in margins; they are rarely near each other, so that less will do. */
static const double least_apart = 1e-3;
/* The determinant of three unit normals. */
static const double least_determinant = 1e-11;

/* How many of its four numbers are of the mesh: a triangle, or the two vertices of an edge. */
enum { KEY_SITES, KEY_TRIANGLE, KEY_EDGE };

typedef struct scree_cut_crossing {
  double along;
  uint32_t vertex;
  bool leaves;
} scree_cut_crossing;

void scree_cut_cell_free(scree_cut_cell *cell) {
  scree_free(cell->faces.items);
  scree_free(cell->edges.items);
  *cell = (scree_cut_cell){.faces = {0}};
}

void scree_cutter_free(scree_cutter *c) {
  SCREE_FREE_ALL(c->normals, c->neighbours, c->vertices.items, c->table, c->crossings.items);
  *c = (scree_cutter){.mesh = NULL};
}

static scree_status fill(scree_cutter *c, scree_error *error) {
  size_t triangles = c->mesh->triangle_count;
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY_ALLOC(c->normals, triangles, error);
  SCREE_TRY_ALLOC(c->neighbours, 3 * triangles, error);
  SCREE_TRY(scree_adjacency_build(c->mesh, &adjacency, error));
  for (size_t h = 0; h < 3 * triangles; h++) c->neighbours[h] = adjacency.ring[h] / 3;
  for (size_t t = 0; t < triangles; t++) c->normals[t] = vec3_unit(scree_facet_normal(c->mesh, t));
  c->table_size = 1024;
  SCREE_TRY_ALLOC_ZERO(c->table, c->table_size, error);
  for (size_t v = 0; v < c->mesh->vertex_count; v++)
    SCREE_TRY_PUSH(&c->vertices, error, (scree_cut_vertex){.at = scree_mesh_vertex(c->mesh, v)});
  return SCREE_OK;
}

scree_status scree_cutter_make(const scree_mesh *mesh, const vec3 *sites, size_t site_count,
                               scree_cutter *cutter, scree_error *error) {
  scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  double size = vec3_distance(box.low, box.high);
  *cutter = (scree_cutter){.mesh = mesh,
                           .sites = sites,
                           .site_count = site_count,
                           .size = size,
                           .margin = margin_share * size};
  return fill(cutter, error);
}

uint32_t scree_cut_stamp(scree_cutter *c) {
  return (uint32_t)++c->stamp;
}

/* ---- planes ---- */

vec3 scree_cut_bisector(const scree_cutter *c, size_t i, size_t j, double *offset) {
  vec3 low = c->sites[i < j ? i : j], high = c->sites[i < j ? j : i];
  vec3 normal = vec3_unit(vec3_sub(high, low));
  double at = vec3_dot(normal, vec3_scale(vec3_add(low, high), 0.5));
  if (offset) *offset = i < j ? at : -at;
  return i < j ? normal : vec3_neg(normal);
}

vec3 scree_cut_normal(const scree_cutter *c, size_t cell, uint32_t face) {
  size_t triangles = c->mesh->triangle_count;
  return face < triangles ? c->normals[face] : scree_cut_bisector(c, cell, face - triangles, NULL);
}

/* Where three planes meet; false where they nearly share a line. */
static bool meet(const vec3 n[3], const double offset[3], vec3 *at) {
  vec3 a = vec3_cross(n[1], n[2]), b = vec3_cross(n[2], n[0]), d = vec3_cross(n[0], n[1]);
  double determinant = vec3_dot(n[0], a);
  if (fabs(determinant) < least_determinant) return false;
  vec3 sum = vec3_add(vec3_add(vec3_scale(a, offset[0]), vec3_scale(b, offset[1])),
                      vec3_scale(d, offset[2]));
  *at = vec3_scale(sum, 1 / determinant);
  return true;
}

/* ---- vertices ---- */

static bool place(const scree_cutter *c, const scree_cut_key *key, vec3 *at) {
  const uint32_t *of = key->of;
  vec3 n[3];
  double offset[3];
  if (key->kind == KEY_EDGE) {
    vec3 a = scree_mesh_vertex(c->mesh, of[0]), b = scree_mesh_vertex(c->mesh, of[1]);
    n[0] = scree_cut_bisector(c, of[2], of[3], offset);
    double da = vec3_dot(n[0], a) - offset[0], db = vec3_dot(n[0], b) - offset[0];
    *at = vec3_lerp(a, b, da / (da - db));
    return true;
  }
  if (key->kind == KEY_TRIANGLE) {
    n[0] = c->normals[of[0]];
    offset[0] = vec3_dot(n[0], scree_mesh_corner(c->mesh, of[0], 0));
    n[1] = scree_cut_bisector(c, of[1], of[2], offset + 1);
    n[2] = scree_cut_bisector(c, of[1], of[3], offset + 2);
  } else {
    for (int k = 0; k < 3; k++) n[k] = scree_cut_bisector(c, of[0], of[1 + k], offset + k);
  }
  return meet(n, offset, at);
}

static uint64_t hash(const scree_cut_key *key) {
  uint64_t h = key->kind;
  for (int k = 0; k < 4; k++) h = (h ^ key->of[k]) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
  return h;
}

/* The place of the key in the table, or where it would stand. */
static uint32_t *look(const scree_cutter *c, const scree_cut_key *key) {
  for (size_t at = hash(key);; at++) {
    uint32_t *entry = &c->table[at & (c->table_size - 1)];
    if (*entry == 0 || memcmp(&c->vertices.items[*entry].key, key, sizeof *key) == 0) return entry;
  }
}

static scree_status grow(scree_cutter *c, scree_error *error) {
  uint32_t *larger;
  SCREE_TRY_ALLOC_ZERO(larger, 2 * c->table_size, error);
  scree_free(c->table);
  c->table = larger;
  c->table_size *= 2;
  for (size_t v = c->mesh->vertex_count; v < c->vertices.count; v++)
    *look(c, &c->vertices.items[v].key) = (uint32_t)v;
  return SCREE_OK;
}

static scree_status vertex_of(scree_cutter *c, const scree_cut_key *key, uint32_t *vertex,
                              bool *doubtful, scree_error *error) {
  if (2 * (c->vertices.count - c->mesh->vertex_count) >= c->table_size) SCREE_TRY(grow(c, error));
  uint32_t *entry = look(c, key);
  if (*entry == 0) {
    scree_cut_vertex made = {.key = *key};
    if (!place(c, key, &made.at)) {
      *doubtful = true;
      return SCREE_OK;
    }
    SCREE_TRY_PUSH(&c->vertices, error, made);
    *entry = (uint32_t)(c->vertices.count - 1);
  }
  *vertex = *entry;
  return SCREE_OK;
}

static int compare_numbers(const void *a, const void *b) {
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

/* What meets where the bisector with j crosses the edge of two faces of the cell i: of these first
 * what is of the mesh, then the sites, both ascending. */
static scree_cut_key key_of(const scree_cutter *c, uint32_t f, uint32_t g, size_t i, size_t j) {
  uint32_t triangles = (uint32_t)c->mesh->triangle_count, low = f < g ? f : g, high = f < g ? g : f;
  uint32_t of_mesh = (low < triangles) + (high < triangles), h = 3 * low;
  scree_cut_key key = {of_mesh, {low, high - triangles, (uint32_t)i, (uint32_t)j}};
  if (of_mesh == KEY_SITES) key.of[0] -= triangles;
  if (of_mesh == KEY_EDGE) {
    while (h % 3 < 2 && c->neighbours[h] != high) h++;
    key.of[0] = scree_half_edge_from(c->mesh, h);
    key.of[1] = scree_half_edge_to(c->mesh, h);
  }
  qsort(key.of, of_mesh, sizeof *key.of, compare_numbers);
  qsort(key.of + of_mesh, 4 - of_mesh, sizeof *key.of, compare_numbers);
  return key;
}

/* ---- a plane and a cell ---- */

typedef struct slice {
  scree_cutter *c;
  size_t i, j;
  vec3 normal;
  double offset;
  uint32_t stamp;
  scree_cut_cell *from, *to;
  SCREE_LIST(scree_cut_edge) cap; /* its edges */
  bool doubtful;
} slice;

static bool is_out(slice *s, uint32_t vertex) {
  scree_cut_vertex *v = &s->c->vertices.items[vertex];
  if (v->stamp != s->stamp) {
    double height = vec3_dot(s->normal, v->at) - s->offset;
    s->doubtful |= fabs(height) < s->c->margin;
    v->stamp = s->stamp;
    v->out = height > 0;
  }
  return v->out;
}

static int compare_crossings(const void *a, const void *b) {
  double x = ((const scree_cut_crossing *)a)->along, y = ((const scree_cut_crossing *)b)->along;
  return (x > y) - (x < y);
}

/* In order along the line of the face and the plane. Of two, one leaves and one comes back: nothing
 * is to be ordered. */
static void order_crossings(slice *s, uint32_t face) {
  scree_cut_crossing *x = s->c->crossings.items;
  size_t count = s->c->crossings.count;
  if (count == 2) {
    s->doubtful |= x[0].leaves == x[1].leaves;
    if (!x[0].leaves) {
      scree_cut_crossing second = x[1];
      x[1] = x[0];
      x[0] = second;
    }
    return;
  }
  vec3 line = vec3_unit(vec3_cross(scree_cut_normal(s->c, s->i, face), s->normal));
  for (size_t k = 0; k < count; k++)
    x[k].along = vec3_dot(line, s->c->vertices.items[x[k].vertex].at);
  qsort(x, count, sizeof *x, compare_crossings);
  s->doubtful |= count % 2 != 0;
  for (size_t k = 0; k + 1 < count; k += 2)
    s->doubtful |=
        !x[k].leaves || x[k + 1].leaves || x[k + 1].along - x[k].along < least_apart * s->c->margin;
}

static scree_status cut_edge(slice *s, uint32_t face, const scree_cut_edge *edge,
                             scree_error *error) {
  bool from = is_out(s, edge->from), to = is_out(s, edge->to);
  scree_cut_edge kept = *edge;
  uint32_t vertex = 0;
  if (from && to) return SCREE_OK;
  if (from != to) {
    scree_cut_key key = key_of(s->c, face, edge->other, s->i, s->j);
    SCREE_TRY(vertex_of(s->c, &key, &vertex, &s->doubtful, error));
    if (from)
      kept.from = vertex;
    else
      kept.to = vertex;
    scree_cut_crossing crossing = {.vertex = vertex, .leaves = to};
    SCREE_TRY_PUSH(&s->c->crossings, error, crossing);
  }
  SCREE_TRY_PUSH(&s->to->edges, error, kept);
  return SCREE_OK;
}

static scree_status cut_face(slice *s, const scree_cut_face *face, scree_error *error) {
  scree_cut_face kept = {face->face, (uint32_t)s->to->edges.count, 0};
  uint32_t plane = (uint32_t)(s->c->mesh->triangle_count + s->j);
  s->c->crossings.count = 0;
  for (size_t e = face->first; e < face->first + face->count; e++)
    SCREE_TRY(cut_edge(s, face->face, &s->from->edges.items[e], error));
  if (s->c->crossings.count > 0) order_crossings(s, face->face);
  for (size_t k = 0; k + 1 < s->c->crossings.count && !s->doubtful; k += 2) {
    uint32_t x = s->c->crossings.items[k].vertex, y = s->c->crossings.items[k + 1].vertex;
    scree_cut_edge side = {x, y, plane}, rim = {y, x, face->face};
    SCREE_TRY_PUSH(&s->to->edges, error, side);
    SCREE_TRY_PUSH(&s->cap, error, rim);
  }
  kept.count = (uint32_t)s->to->edges.count - kept.first;
  if (kept.count > 0) SCREE_TRY_PUSH(&s->to->faces, error, kept);
  return SCREE_OK;
}

/* from, less what lies beyond the plane, into to. */
static scree_status cut_cell(slice *s, scree_error *error) {
  s->to->faces.count = s->to->edges.count = s->cap.count = 0;
  for (size_t f = 0; f < s->from->faces.count && !s->doubtful; f++)
    SCREE_TRY(cut_face(s, &s->from->faces.items[f], error));
  if (s->cap.count == 0) return SCREE_OK;
  scree_cut_face face = {(uint32_t)(s->c->mesh->triangle_count + s->j),
                         (uint32_t)s->to->edges.count, (uint32_t)s->cap.count};
  for (size_t e = 0; e < s->cap.count; e++) SCREE_TRY_PUSH(&s->to->edges, error, s->cap.items[e]);
  SCREE_TRY_PUSH(&s->to->faces, error, face);
  return SCREE_OK;
}

static scree_status whole_mesh(const scree_cutter *c, scree_cut_cell *cell, scree_error *error) {
  cell->faces.count = cell->edges.count = 0;
  for (uint32_t h = 0; h < 3 * c->mesh->triangle_count; h++) {
    scree_cut_edge edge = {scree_half_edge_from(c->mesh, h), scree_half_edge_to(c->mesh, h),
                           c->neighbours[h]};
    if (h % 3 == 0) SCREE_TRY_PUSH(&cell->faces, error, (scree_cut_face){h / 3, h, 3});
    SCREE_TRY_PUSH(&cell->edges, error, edge);
  }
  return SCREE_OK;
}

/* ---- all planes ---- */

typedef struct other_site {
  double distance2;
  uint32_t site;
} other_site;

static int compare_sites(const void *a, const void *b) {
  const other_site *x = a, *y = b;
  if (x->distance2 != y->distance2) return x->distance2 < y->distance2 ? -1 : 1;
  return (x->site > y->site) - (x->site < y->site);
}

/* Squared, from the site to the farthest vertex of the cell: no plane beyond matters. */
static double reach2(const scree_cutter *c, size_t site, const scree_cut_cell *cell) {
  double most = 0;
  for (size_t e = 0; e < cell->edges.count; e++) {
    vec3 off = vec3_sub(c->vertices.items[cell->edges.items[e].from].at, c->sites[site]);
    most = scree_larger(most, vec3_norm2(off));
  }
  return most;
}

static scree_status cut_by_all(slice *s, const other_site *others, scree_error *error) {
  SCREE_TRY(whole_mesh(s->c, s->from, error));
  for (size_t k = 0; k + 1 < s->c->site_count && s->from->faces.count > 0; k++) {
    if (others[k].distance2 > 4 * reach2(s->c, s->i, s->from)) break;
    s->j = others[k].site;
    s->normal = scree_cut_bisector(s->c, s->i, s->j, &s->offset);
    s->stamp = scree_cut_stamp(s->c);
    SCREE_TRY(cut_cell(s, error));
    if (s->doubtful) break;
    scree_cut_cell swap = *s->from;
    *s->from = *s->to;
    *s->to = swap;
  }
  return SCREE_OK;
}

scree_status scree_cut_cell_of(scree_cutter *c, size_t site, scree_cut_cell *cell, bool *doubtful,
                               scree_error *error) {
  SCREE_CLEANUP(scree_cut_cell_free) scree_cut_cell spare = {.faces = {0}};
  SCREE_SCRATCH(other_site, others, c->site_count, error);
  slice s = {.c = c, .i = site, .from = cell, .to = &spare};
  size_t count = 0;
  for (size_t j = 0; j < c->site_count; j++)
    if (j != site)
      others[count++] =
          (other_site){vec3_norm2(vec3_sub(c->sites[j], c->sites[site])), (uint32_t)j};
  qsort(others, count, sizeof *others, compare_sites);
  scree_status status = cut_by_all(&s, others, error);
  scree_free(s.cap.items);
  *doubtful = s.doubtful;
  return status;
}
