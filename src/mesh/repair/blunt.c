/* Sharp rims made blunt: the sides of each sharp edge part by a little, and a strip of facets comes
 * between them.
 *
 * Sharp edges cut the facets about a vertex into sectors. Where there are two or more, each gets
 * the vertex as its own, moved along the sector's mean normal: out of the material where this is
 * thin, into it where the gap is. About a vertex of three or more sharp edges a polygon joins the
 * strips' ends. An edge whose ends have one sector each stays. */
#include "base/alloc.h"
#include "mesh/repair/repair.h"

/* How far either side moves: this share of how far apart the sides are where their facets end. */
#define PARTING 0.05

#define NONE UINT32_MAX

typedef struct blunting {
  scree_repair *r;
  scree_adjacency adjacency;
  bool *sharp;      /* per edge */
  uint32_t *sector; /* of each corner: union-find */
  uint32_t *vertex; /* of each sector's root, or NONE */
  double *way;      /* per vertex: how far it moves outward */
  uint8_t *sectors; /* per vertex: 0, 1, or 2 and more */
  vec3 *normal;     /* per vertex: of its sector */
  uint32_t *next;   /* per vertex: of the polygon about the place where it was, or NONE */
} blunting;

static void free_blunting(blunting *b) {
  scree_adjacency_free(&b->adjacency);
  SCREE_FREE_ALL(b->sharp, b->sector, b->vertex, b->way, b->sectors, b->normal, b->next);
}

static vec3 corner_at(const blunting *b, uint32_t h) {
  return vec3_load(b->r->mesh.positions + 3 * (size_t)b->r->mesh.triangles[h]);
}

/* How far the facet beyond the edge of h ends above that of h. */
static double rise_of(const blunting *b, uint32_t h) {
  uint32_t apex = scree_half_edge_previous(b->adjacency.ring[h]);
  return vec3_dot(vec3_sub(corner_at(b, apex), corner_at(b, h)),
                  vec3_unit(scree_facet_normal(&b->r->mesh, h / 3)));
}

/* Sets the way of a sharp edge: the least that is asked for at its two ends. */
static void set_way(blunting *b, uint32_t h) {
  uint32_t g = b->adjacency.ring[h];
  double there = rise_of(b, h), back = rise_of(b, g),
         way = -PARTING * (fabs(there) < fabs(back) ? there : back);
  for (int end = 0; end < 2; end++) {
    double *of = &b->way[b->r->mesh.triangles[end ? g : h]];
    if (*of == 0 || fabs(way) < fabs(*of)) *of = way;
  }
}

/* Corners of facets that meet over an edge that is not sharp are of one sector. */
static void find_sectors(blunting *b) {
  const scree_adjacency *a = &b->adjacency;
  for (uint32_t c = 0; c < 3 * b->r->mesh.triangle_count; c++) b->sector[c] = c;
  for (size_t e = 0; e < a->edge_count; e++) {
    uint32_t h = a->edges[e], g = a->ring[h];
    if (b->sharp[e]) {
      set_way(b, h);
    } else {
      scree_join(b->sector, h, scree_half_edge_next(g));
      scree_join(b->sector, scree_half_edge_next(h), g);
    }
  }
}

/* Every sector but a vertex's first gets a vertex of its own. False: out of memory. */
static bool give_vertices(blunting *b) {
  scree_mesh *m = &b->r->mesh;
  for (uint32_t c = 0; c < 3 * m->triangle_count; c++) {
    uint32_t v = m->triangles[c], *own = &b->vertex[scree_find_root(b->sector, c)];
    if (b->way[v] == 0 || *own != NONE) continue;
    *own = v;
    if (b->sectors[v]++ == 0) continue;
    if (!scree_repair_add_vertex(b->r, m->positions + 3 * (size_t)v, own)) return false;
    b->way[*own] = b->way[v];
    b->sectors[v] = b->sectors[*own] = 2;
  }
  for (uint32_t c = 0; c < 3 * m->triangle_count; c++)
    if (b->way[m->triangles[c]] != 0) m->triangles[c] = b->vertex[scree_find_root(b->sector, c)];
  return true;
}

static void move_vertices(blunting *b) {
  scree_mesh *m = &b->r->mesh;
  for (size_t c = 0; c < 3 * m->triangle_count; c++) {
    vec3 *normal = &b->normal[m->triangles[c]];
    *normal = vec3_add(*normal, scree_facet_normal(m, c / 3));
  }
  for (size_t v = 0; v < m->vertex_count; v++) {
    double *at = m->positions + 3 * v;
    if (b->sectors[v] > 1)
      vec3_store(at, vec3_mad(vec3_load(at), vec3_unit(b->normal[v]), b->way[v]));
  }
}

/* The strip of a sharp edge between facets t and g. False: out of memory. */
static bool add_strip(blunting *b, uint32_t h, size_t *blunted) {
  const uint32_t *corner = b->r->mesh.triangles;
  uint32_t g = b->adjacency.ring[h], from_h = corner[h], to_h = corner[scree_half_edge_next(h)],
           from_g = corner[g], to_g = corner[scree_half_edge_next(g)];
  bool room = true;
  if (from_h != to_g) room = scree_repair_add_facet(b->r, to_h, from_h, to_g);
  if (to_h != from_g) room = room && scree_repair_add_facet(b->r, to_h, to_g, from_g);
  if (from_h != to_g) b->next[to_g] = from_h;
  if (to_h != from_g) b->next[to_h] = from_g;
  *blunted += from_h != to_g || to_h != from_g;
  return room;
}

/* What the strips leave open about the place where v was. False: out of memory. */
static bool add_polygon(blunting *b, uint32_t v) {
  uint32_t second = b->next[v];
  bool room = true;
  for (uint32_t at = second; room && at != NONE && b->next[at] != v && b->next[at] != NONE;) {
    uint32_t after = b->next[at];
    room = scree_repair_add_facet(b->r, v, at, after);
    b->next[at] = NONE;
    at = after;
    if (b->next[at] == v) b->next[at] = NONE;
  }
  b->next[v] = NONE;
  return room;
}

static scree_status allocate(blunting *b, size_t sharp_count, scree_error *error) {
  const scree_mesh *m = &b->r->mesh;
  size_t vertex_most = m->vertex_count + 2 * sharp_count; /* an edge parts two places once each */
  SCREE_TRY_ALLOC(b->sector, 3 * m->triangle_count, error);
  SCREE_TRY_ALLOC(b->vertex, 3 * m->triangle_count, error);
  SCREE_TRY_ALLOC_ZERO(b->way, vertex_most, error);
  SCREE_TRY_ALLOC_ZERO(b->sectors, vertex_most, error);
  SCREE_TRY_ALLOC_ZERO(b->normal, vertex_most, error);
  SCREE_TRY_ALLOC(b->next, vertex_most, error);
  memset(b->vertex, 0xff, 3 * m->triangle_count * sizeof *b->vertex);
  memset(b->next, 0xff, vertex_most * sizeof *b->next);
  return SCREE_OK;
}

scree_status scree_repair_blunt(scree_repair *r, size_t *blunted, scree_error *error) {
  SCREE_CLEANUP(free_blunting) blunting b = {.r = r};
  size_t sharp_count = 0;
  *blunted = 0;
  SCREE_TRY(scree_adjacency_build(&r->mesh, &b.adjacency, error));
  SCREE_TRY_ALLOC(b.sharp, b.adjacency.edge_count, error);
  for (size_t e = 0; e < b.adjacency.edge_count; e++) {
    b.sharp[e] = scree_edge_is_sharp(&r->mesh, &b.adjacency, b.adjacency.edges[e]);
    sharp_count += b.sharp[e];
  }
  if (sharp_count == 0) return SCREE_OK;
  SCREE_TRY(allocate(&b, sharp_count, error));
  find_sectors(&b);
  bool room = give_vertices(&b);
  size_t vertex_count = r->mesh.vertex_count;
  if (room) move_vertices(&b);
  for (size_t e = 0; room && e < b.adjacency.edge_count; e++)
    if (b.sharp[e]) room = add_strip(&b, b.adjacency.edges[e], blunted);
  for (uint32_t v = 0; room && v < vertex_count; v++) room = add_polygon(&b, v);
  r->report.done[SCREE_REPAIR_BLUNT] += *blunted;
  return room ? SCREE_OK : scree_repair_no_memory(error);
}
