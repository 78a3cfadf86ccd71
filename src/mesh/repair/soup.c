/* Any triangle soup as a wall.
 *
 * First places: what lies closer together than the coordinates are exact is one vertex, facets
 * without area go, vertices are set into edges that run past them, of facets with the same vertices
 * one stays (soup_tidy.c). Then edges. Two facets at an edge are joined. Where three or more meet,
 * those of one surface stay joined, else the two that go on most straightly; the others begin a
 * piece of their own with a rim there. A piece is wound one way, that of most of its facets; where
 * its surface comes back as its own other side, it is parted along that line. Last, facets that lie
 * on others of open pieces, or of closed ones without volume, are dropped one after another as they
 * hang together: of a two-sided sheet one half stays. Facets of solids are left, so that boxes that
 * touch stay boxes.
 *
 * Vertices are shared within a piece by facets that hang together around them, and only there: so
 * each edge of the result belongs to one or two facets, and each vertex to one fan. */
#include "mesh/repair/soup.h"

#include "base/alloc.h"
#include "base/radix.h"
#include "mesh/adjacency.h"
#include "mesh/index/closest.h"
#include "mesh/index/facet_tree.h"
#include "mesh/measure/solid_angle.h"
#include "mesh/repair/repair.h"
#include "mesh/repair/rim.h"
#include "mesh/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* T-junctions (mesh/repair/rim.h) are looked for on edges of one facet alone: the others have what
 * they need. A dropped sliver leaves such a junction behind too. */

static const double share = 2e-6; /* of the diagonal: 2 um in 1 m, far below any body */
static const double ulp = 1.2e-7; /* of a coordinate in single precision, as STL has them */
enum { PASSES = 8 };              /* an edge of each corner, and of what these leave */

/* m: what lies closer than this is at one place. */
static double soup_tolerance(const scree_mesh *mesh) {
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  vec3 far = vec3_max(vec3_neg(box.low), box.high);
  double largest = scree_larger(far.x, scree_larger(far.y, far.z));
  return scree_larger(share * vec3_distance(box.low, box.high), 4 * ulp * largest);
}

/* ---- vertices ---- */

static scree_status weld(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                         scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh welded = {0};
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  double diagonal = vec3_distance(box.low, box.high);
  if (!(diagonal > 0)) return SCREE_OK; /* all of it is flat */
  SCREE_TRY(scree_mesh_copy(mesh, &welded, error));
  SCREE_TRY(scree_weld_near(&welded, tolerance / diagonal, error));
  if (welded.vertex_count == mesh->vertex_count) return SCREE_OK;
  mending->welded = mesh->vertex_count - welded.vertex_count;
  mending->flat = mesh->triangle_count - welded.triangle_count;
  scree_mesh kept = *mesh;
  *mesh = welded;
  welded = kept;
  return SCREE_OK;
}

/* Over its longest edge, m. */
static double height_of(const scree_mesh *mesh, size_t t) {
  vec3 c[3];
  double longest = 0;
  for (int k = 0; k < 3; k++) c[k] = scree_mesh_corner(mesh, t, k);
  for (int k = 0; k < 3; k++) longest = scree_larger(longest, vec3_distance(c[k], c[(k + 1) % 3]));
  double area2 = vec3_norm(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
  return longest > 0 ? area2 / longest : 0;
}

static scree_status drop_flat(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                              scree_error *error) {
  SCREE_SCRATCH(bool, gone, mesh->triangle_count, error);
  for (size_t t = 0; t < mesh->triangle_count; t++)
    gone[t] = scree_names_twice(mesh->triangles + 3 * t) || height_of(mesh, t) <= tolerance;
  mending->flat += scree_facets_drop(mesh, gone);
  return SCREE_OK;
}

/* ---- junctions and doubles ---- */

static scree_status join_once(scree_mesh *mesh, double tolerance, size_t *joined,
                              scree_error *error) {
  const scree_junction_rule rule = {tolerance, INFINITY, SIZE_MAX};
  SCREE_CLEANUP(scree_free_at) scree_junctions found = {0};
  SCREE_TRY(scree_junctions_find(mesh, &rule, &found, error));
  size_t count = mesh->triangle_count + found.count;
  uint32_t *grown = scree_resize(mesh->triangles, count, 3 * sizeof *grown);
  if (!grown) return scree_fail_memory(error, 3 * count * sizeof *grown, "a wall's facets");
  mesh->triangles = grown;
  *joined += scree_junctions_split(mesh, &found);
  return SCREE_OK;
}

static scree_status drop_doubles(scree_mesh *mesh, scree_wall_mending *mending,
                                 scree_error *error) {
  size_t dropped;
  SCREE_TRY(scree_facets_drop_doubles(mesh, &dropped, error));
  mending->doubled += dropped;
  return SCREE_OK;
}

/* Sets vertices into edges of one facet that run past them. */
static scree_status soup_join(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                              scree_error *error) {
  for (int pass = 0; pass < PASSES; pass++) {
    size_t before = mending->joined;
    SCREE_TRY(join_once(mesh, tolerance, &mending->joined, error));
    if (mending->joined == before) break;
  }
  return SCREE_OK;
}

/* Welds, drops what is flat, sets vertices into edges that run past them, drops facets that name
 * the same vertices as others. Vertices keep their order where none is welded. */
static scree_status soup_tidy(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                              scree_error *error) {
  SCREE_TRY(weld(mesh, tolerance, mending, error));
  SCREE_TRY(drop_flat(mesh, tolerance, mending, error));
  SCREE_TRY(drop_doubles(mesh, mending, error)); /* which have no rims */
  SCREE_TRY(soup_join(mesh, tolerance, mending, error));
  return drop_doubles(mesh, mending, error);
}

enum {
  NONE = SCREE_NO_HALF_EDGE,
  MOST_AT_EDGE = 64, /* facets: of more, none are joined */
  ROUNDS = 4,        /* of dropping what lies on others */
  SAMPLES = 7,       /* places of a facet, of which all must lie on others */
  UNSEEN = 2,
};

/* What is known of the facets at work. */
typedef struct sheets {
  const scree_mesh *mesh;
  scree_adjacency adjacency;
  uint32_t *partner; /* by half-edge: the one it is joined to, or NONE */
  uint8_t *turned;   /* by facet, against its own winding */
  uint32_t *piece;   /* by facet: the lowest facet of its piece */
  uint32_t *queue;
  size_t parted;
} sheets;

static void free_sheets(sheets *s) {
  scree_adjacency_free(&s->adjacency);
  SCREE_FREE_ALL(s->partner, s->turned, s->piece, s->queue);
}

static scree_status begin_sheets(sheets *s, const scree_mesh *mesh, scree_error *error) {
  size_t facets = mesh->triangle_count;
  s->mesh = mesh;
  SCREE_TRY_ALLOC(s->partner, 3 * facets, error);
  SCREE_TRY_ALLOC(s->turned, facets, error);
  SCREE_TRY_ALLOC(s->piece, facets, error);
  SCREE_TRY_ALLOC(s->queue, facets, error);
  return scree_adjacency_build(mesh, &s->adjacency, error);
}

/* ---- winding ---- */

/* Whether two facets are wound alike over the edge of these half-edges, as they stand turned. */
static bool wound_alike(const sheets *s, uint32_t h, uint32_t g) {
  bool against = scree_half_edge_from(s->mesh, h) != scree_half_edge_from(s->mesh, g);
  return against == (s->turned[h / 3] == s->turned[g / 3]);
}

static void part(sheets *s, uint32_t h) {
  s->partner[s->partner[h]] = NONE;
  s->partner[h] = NONE;
  s->parted++;
}

/* All that hangs together with a facet is wound as it is; `cut`: where that cannot be the two are
 * parted. */
static void wind_piece(sheets *s, uint32_t first, bool cut) {
  size_t count = 0, turned = 0;
  s->queue[count++] = first;
  s->turned[first] = 0;
  s->piece[first] = first;
  for (size_t i = 0; i < count; i++)
    for (uint32_t h = 3 * s->queue[i]; h < 3 * s->queue[i] + 3; h++) {
      uint32_t g = s->partner[h];
      if (g == NONE) continue;
      if (s->turned[g / 3] == UNSEEN) {
        s->turned[g / 3] = 0;
        s->turned[g / 3] = !wound_alike(s, h, g);
        s->piece[g / 3] = first;
        s->queue[count++] = g / 3;
      } else if (cut && !wound_alike(s, h, g)) {
        part(s, h);
      }
    }
  for (size_t i = 0; i < count; i++) turned += s->turned[s->queue[i]];
  for (size_t i = 0; i < count && 2 * turned > count; i++) s->turned[s->queue[i]] ^= 1;
}

static void wind_all(sheets *s, bool cut) {
  memset(s->turned, UNSEEN, s->mesh->triangle_count);
  for (uint32_t f = 0; f < s->mesh->triangle_count; f++)
    if (s->turned[f] == UNSEEN) wind_piece(s, f, cut);
}

/* ---- edges ---- */

/* Away from the edge, in the facet's plane; unit. */
static vec3 away_from_edge(const scree_mesh *mesh, uint32_t h) {
  vec3 a = scree_mesh_corner(mesh, h / 3, (int)(h % 3)),
       b = scree_mesh_corner(mesh, h / 3, (int)(h % 3 + 1) % 3),
       c = scree_mesh_corner(mesh, h / 3, (int)(h % 3 + 2) % 3);
  vec3 along = vec3_unit(vec3_sub(b, a)), way = vec3_sub(c, a);
  return vec3_unit(vec3_mad(way, along, -vec3_dot(way, along)));
}

/* The lower, the better two go together: 0 to 2 for how straightly they go on, less 3 for those of
 * one surface, more 3 where that would be its own other side. */
static double cost_of(const sheets *s, uint32_t h, uint32_t g) {
  double bend = 1 + vec3_dot(away_from_edge(s->mesh, h), away_from_edge(s->mesh, g));
  if (s->piece[h / 3] != s->piece[g / 3]) return bend;
  return wound_alike(s, h, g) ? bend - 3 : bend + 3;
}

static void join_best(sheets *s, const uint32_t *halves, size_t count) {
  for (size_t left = count; left > 1; left -= 2) {
    double best = INFINITY;
    uint32_t h = NONE, g = NONE;
    for (size_t i = 0; i < count; i++)
      for (size_t k = i + 1; k < count; k++) {
        if (s->partner[halves[i]] != NONE || s->partner[halves[k]] != NONE) continue;
        double cost = cost_of(s, halves[i], halves[k]);
        if (cost < best) best = cost, h = halves[i], g = halves[k];
      }
    if (h == NONE) return;
    s->partner[h] = g;
    s->partner[g] = h;
  }
}

static void join_at_edges(sheets *s, bool many) {
  for (size_t e = 0; e < s->adjacency.edge_count; e++) {
    uint32_t h = s->adjacency.edges[e], halves[MOST_AT_EDGE];
    size_t count = scree_edge_facet_count(&s->adjacency, h);
    if (many != (count > 2)) continue;
    if (count == 2) {
      s->partner[h] = s->adjacency.ring[h];
      s->partner[s->adjacency.ring[h]] = h;
    }
    if (count <= 2) continue;
    s->parted++;
    if (count > MOST_AT_EDGE) continue;
    for (size_t i = 0; i < count; i++, h = s->adjacency.ring[h]) halves[i] = h;
    join_best(s, halves, count);
  }
}

static void join_sheets(sheets *s) {
  for (size_t h = 0; h < 3 * s->mesh->triangle_count; h++) s->partner[h] = NONE;
  s->parted = 0;
  join_at_edges(s, false);
  wind_all(s, false); /* who is of one surface */
  join_at_edges(s, true);
  wind_all(s, true);
}

/* ---- what lies on other facets ---- */

static vec3 corner_turned(const sheets *s, uint32_t f, int k) {
  return scree_mesh_corner(s->mesh, f, s->turned[f] && k ? 3 - k : k);
}

typedef struct bulk {
  double volume, area;
  bool open;
} bulk;

/* The volume of each piece about the first corner of its lowest facet, kept at that facet. */
static void measure_pieces(const sheets *s, bulk *bulks) {
  for (uint32_t f = 0; f < s->mesh->triangle_count; f++) {
    bulk *b = &bulks[s->piece[f]];
    vec3 from = scree_mesh_corner(s->mesh, s->piece[f], 0), c[3];
    for (int k = 0; k < 3; k++) c[k] = vec3_sub(corner_turned(s, f, k), from);
    b->volume += vec3_dot(c[0], vec3_cross(c[1], c[2])) / 6;
    b->area += 0.5 * vec3_norm(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
    for (uint32_t h = 3 * f; h < 3 * f + 3; h++) b->open |= s->partner[h] == NONE;
  }
}

static bool is_solid(const bulk *b, double tolerance) {
  return !b->open && fabs(b->volume) > tolerance * b->area;
}

typedef struct cover {
  const sheets *sheets;
  const scree_facet_tree *tree;
  const uint8_t *loose; /* of a piece that is no solid */
  bool *gone;
  double tolerance;
} cover;

static bool lies_on(const cover *c, uint32_t facet, vec3 p) {
  const scree_box near = scree_box_grown((scree_box){p, p}, c->tolerance);
  scree_tree_walk walk;
  scree_tree_start(&walk, &c->tree->tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (!scree_box_meets(&node->box, &near) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
      uint32_t other = c->tree->tree.order[i];
      double corners[9];
      vec3 closest;
      if (other == facet || c->gone[other] || !c->loose[other]) continue;
      for (int k = 0; k < 3; k++)
        vec3_store(corners + 3 * k, scree_mesh_corner(c->sheets->mesh, other, k));
      if (scree_triangle_closest(corners, p, &closest) <= c->tolerance * c->tolerance) return true;
    }
  }
  return false;
}

/* Its middle, and places just inside its corners and edges. */
static bool is_covered(const cover *c, uint32_t facet) {
  static const double places[SAMPLES][3] = {{1, 1, 1},   {18, 1, 1},  {1, 18, 1}, {1, 1, 18},
                                            {10, 10, 1}, {10, 1, 10}, {1, 10, 10}};
  for (int i = 0; i < SAMPLES; i++) {
    vec3 p = {0, 0, 0};
    double sum = places[i][0] + places[i][1] + places[i][2];
    for (int k = 0; k < 3; k++)
      p = vec3_mad(p, scree_mesh_corner(c->sheets->mesh, facet, k), places[i][k] / sum);
    if (!lies_on(c, facet, p)) return false;
  }
  return true;
}

/* Facets that fold back onto each other are the two halves of a sheet. */
static bool folds_back(const sheets *s, uint32_t h) {
  return vec3_dot(away_from_edge(s->mesh, h), away_from_edge(s->mesh, s->partner[h])) > 0.9;
}

/* A covered facet goes, and all that are covered and hang together with it. */
static size_t drop_from(const cover *c, uint32_t first) {
  const sheets *s = c->sheets;
  size_t count = 0;
  if (c->gone[first] || !c->loose[first] || !is_covered(c, first)) return 0;
  c->gone[first] = 1;
  s->queue[count++] = first;
  for (size_t i = 0; i < count; i++)
    for (uint32_t h = 3 * s->queue[i]; h < 3 * s->queue[i] + 3; h++) {
      uint32_t other = s->partner[h] == NONE ? NONE : s->partner[h] / 3;
      if (other == NONE || c->gone[other] || folds_back(s, h) || !is_covered(c, other)) continue;
      c->gone[other] = 1;
      s->queue[count++] = other;
    }
  return count;
}

static scree_status find_covered(const sheets *s, double tolerance, bool *gone, size_t *count,
                                 scree_error *error) {
  size_t facets = s->mesh->triangle_count;
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree tree = {0};
  SCREE_SCRATCH(uint8_t, loose, facets, error);
  SCREE_SCRATCH_ZERO(bulk, bulks, facets, error);
  size_t loose_count = 0;
  measure_pieces(s, bulks);
  for (uint32_t f = 0; f < facets; f++)
    loose_count += loose[f] = !is_solid(&bulks[s->piece[f]], tolerance);
  if (loose_count == 0) return SCREE_OK;
  SCREE_TRY(scree_facet_tree_build(s->mesh, &tree, error));
  cover c = {s, &tree, loose, gone, tolerance};
  for (uint32_t f = 0; f < facets; f++) *count += drop_from(&c, f);
  return SCREE_OK;
}

/* ---- the pieces ---- */

/* The corner of the half-edge's facet at which the vertex is. */
static uint32_t corner_at(const sheets *s, uint32_t half, uint32_t vertex) {
  return scree_half_edge_from(s->mesh, half) == vertex ? half : scree_half_edge_next(half);
}

/* Corners that are one vertex of the result: those of facets that hang together around it. */
static void join_corners(const sheets *s, uint32_t *parent) {
  for (uint32_t h = 0; h < 3 * s->mesh->triangle_count; h++) parent[h] = h;
  for (uint32_t h = 0; h < 3 * s->mesh->triangle_count; h++) {
    uint32_t g = s->partner[h];
    if (g == NONE || g < h) continue;
    const uint32_t ends[2] = {scree_half_edge_from(s->mesh, h), scree_half_edge_to(s->mesh, h)};
    for (int k = 0; k < 2; k++)
      scree_join(parent, corner_at(s, h, ends[k]), corner_at(s, g, ends[k]));
  }
}

/* Whether two half-edges of an edge would be one in the result. */
static bool have_same_ends(const sheets *s, const uint32_t *parent, uint32_t h, uint32_t g) {
  const uint32_t a = scree_half_edge_from(s->mesh, h), b = scree_half_edge_to(s->mesh, h);
  return parent[corner_at(s, h, a)] == parent[corner_at(s, g, a)] &&
         parent[corner_at(s, h, b)] == parent[corner_at(s, g, b)];
}

/* Ends of their own for a half-edge and the one it is joined to. */
static void detach(const sheets *s, uint32_t *parent, uint32_t h) {
  const uint32_t alone = 1u << 31,
                 ends[2] = {scree_half_edge_from(s->mesh, h), scree_half_edge_to(s->mesh, h)};
  for (int k = 0; k < 2; k++) {
    uint32_t own = corner_at(s, h, ends[k]) | alone;
    parent[corner_at(s, h, ends[k])] = own;
    if (s->partner[h] != NONE) parent[corner_at(s, s->partner[h], ends[k])] = own;
  }
}

/* Facets that are not joined at an edge may still hang together around both of its ends: these get
 * ends of their own, and lie beside each other there and where they lose a neighbour by it. */
static void detach_facets(sheets *s, uint32_t *parent) {
  for (size_t e = 0; e < s->adjacency.edge_count; e++) {
    uint32_t first = s->adjacency.edges[e];
    for (uint32_t h = s->adjacency.ring[first]; h != first; h = s->adjacency.ring[h])
      for (uint32_t g = first; g != h; g = s->adjacency.ring[g])
        if (s->partner[h] != g && have_same_ends(s, parent, h, g)) detach(s, parent, h);
  }
  for (uint32_t h = 0; h < 3 * s->mesh->triangle_count; h++) {
    uint32_t g = s->partner[h];
    if (g != NONE && !have_same_ends(s, parent, h, g)) s->partner[h] = s->partner[g] = NONE;
  }
}

typedef struct corner_name {
  uint32_t vertex, class, corner;
} corner_name;

SCREE_ORDER_BY3(by_name, corner_name, vertex, class, corner)

/* The result's vertices, in the order of the soup's, and which each corner has. */
static scree_status number_vertices(sheets *s, uint32_t *number, scree_mesh *made,
                                    scree_error *error) {
  size_t corners = 3 * s->mesh->triangle_count, count = 0;
  SCREE_SCRATCH(corner_name, names, corners, error);
  join_corners(s, number);
  for (uint32_t c = 0; c < corners; c++) number[c] = scree_find_root(number, c);
  detach_facets(s, number);
  for (uint32_t c = 0; c < corners; c++)
    names[c] = (corner_name){s->mesh->triangles[c], number[c], c};
  qsort(names, corners, sizeof *names, by_name);
  for (size_t i = 0; i < corners; i++) {
    bool new =
        i == 0 || names[i].vertex != names[i - 1].vertex || names[i].class != names[i - 1].class;
    if (new)
      memcpy(made->positions + 3 * count++, s->mesh->positions + 3 * (size_t)names[i].vertex,
             3 * sizeof *made->positions);
    number[names[i].corner] = (uint32_t)(count - 1);
  }
  made->vertex_count = count;
  return SCREE_OK;
}

static void reach_out(scree_piece *piece, const scree_mesh *mesh, size_t facet) {
  for (int k = 0; k < 3; k++) {
    piece->low = vec3_min(piece->low, scree_mesh_corner(mesh, facet, k));
    piece->high = vec3_max(piece->high, scree_mesh_corner(mesh, facet, k));
  }
}

/* One facet more of the last piece. */
static void put_facet(const sheets *s, const uint32_t *number, uint32_t facet, scree_pieces *out) {
  scree_piece *piece = &out->items[out->count - 1];
  uint32_t *t = out->mesh.triangles + 3 * out->mesh.triangle_count;
  memcpy(t, number + 3 * (size_t)facet, 3 * sizeof *t);
  if (s->turned[facet]) scree_corners_turn(t);
  out->mending.turned += s->turned[facet];
  reach_out(piece, &out->mesh, out->mesh.triangle_count++);
  piece->count++;
}

static scree_piece piece_of(const bulk *b, size_t first) {
  return (scree_piece){.first = first,
                       .closed = !b->open,
                       .volume = b->open ? 0 : b->volume,
                       .low = {INFINITY, INFINITY, INFINITY},
                       .high = {-INFINITY, -INFINITY, -INFINITY}};
}

/* Piece by piece, the facets of each in the order of the soup. */
static void put_facets(const sheets *s, const uint32_t *number, const bulk *bulks, uint32_t *next,
                       scree_pieces *out) {
  uint32_t facets = (uint32_t)s->mesh->triangle_count, *last = s->queue;
  for (uint32_t f = 0; f < facets; f++) {
    next[f] = NONE;
    if (s->piece[f] != f) next[last[s->piece[f]]] = f;
    last[s->piece[f]] = f;
  }
  for (uint32_t f = 0; f < facets; f++) {
    if (s->piece[f] != f) continue;
    out->items[out->count++] = piece_of(&bulks[f], out->mesh.triangle_count);
    for (uint32_t g = f; g != NONE; g = next[g]) put_facet(s, number, g, out);
  }
}

static scree_status put_pieces(sheets *s, scree_pieces *out, scree_error *error) {
  size_t facets = s->mesh->triangle_count;
  SCREE_SCRATCH_ZERO(bulk, bulks, facets, error);
  SCREE_SCRATCH(uint32_t, number, 3 * facets, error);
  SCREE_SCRATCH(uint32_t, next, facets, error);
  SCREE_TRY_ALLOC(out->mesh.positions, 9 * facets, error);
  SCREE_TRY_ALLOC(out->mesh.triangles, 3 * facets, error);
  SCREE_TRY_ALLOC(out->items, facets, error);
  SCREE_TRY(number_vertices(s, number, &out->mesh, error));
  wind_all(s, false); /* by pieces as they were cut */
  measure_pieces(s, bulks);
  out->mending.parted += s->parted;
  put_facets(s, number, bulks, next, out);
  return SCREE_OK;
}

static scree_status divide(scree_mesh *mesh, double tolerance, scree_pieces *out,
                           scree_error *error) {
  for (int round = 0;; round++) {
    SCREE_CLEANUP(free_sheets) sheets s = {0};
    size_t covered = 0;
    SCREE_SCRATCH_ZERO(bool, gone, mesh->triangle_count, error);
    SCREE_TRY(begin_sheets(&s, mesh, error));
    join_sheets(&s);
    if (round < ROUNDS) SCREE_TRY(find_covered(&s, tolerance, gone, &covered, error));
    if (covered == 0) return put_pieces(&s, out, error);
    scree_facets_drop(mesh, gone);
    out->mending.doubled += covered; /* edges may have lost their other facet */
    SCREE_TRY(soup_join(mesh, tolerance, &out->mending, error));
  }
}

static scree_status refuse(const scree_mesh *soup, scree_error *error) {
  size_t largest = 0;
  double most = -1;
  for (size_t t = 0; t < soup->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      double length =
          vec3_distance(scree_mesh_corner(soup, t, k), scree_mesh_corner(soup, t, (k + 1) % 3));
      if (length > most) most = length, largest = t;
    }
  if (soup->triangle_count == 0) return scree_fail(error, SCREE_BAD_MESH, "wall: no facets");
  vec3 p = scree_mesh_corner(soup, largest, 0);
  return scree_fail(error, SCREE_BAD_MESH,
                    "wall: none of its %zu facets has an area; the longest begins at (%.6g, %.6g, "
                    "%.6g) m",
                    soup->triangle_count, p.x, p.y, p.z);
}

scree_status scree_pieces_make(const scree_mesh *soup, scree_pieces *pieces, scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  SCREE_CLEANUP(scree_pieces_free) scree_pieces made = {.count = 0};
  SCREE_TRY(scree_mesh_verify(soup, error));
  if (soup->triangle_count == 0) return refuse(soup, error);
  if (soup->triangle_count > UINT32_MAX / 8)
    return scree_fail(error, SCREE_LIMIT, "wall: %zu facets; at most %u", soup->triangle_count,
                      UINT32_MAX / 8);
  double tolerance = soup_tolerance(soup);
  SCREE_TRY(scree_mesh_copy(soup, &mesh, error));
  SCREE_TRY(soup_tidy(&mesh, tolerance, &made.mending, error));
  if (mesh.triangle_count == 0) return refuse(soup, error);
  SCREE_TRY(divide(&mesh, tolerance, &made, error));
  *pieces = made;
  made = (scree_pieces){.count = 0};
  return SCREE_OK;
}

void scree_pieces_free(scree_pieces *pieces) {
  scree_mesh_free(&pieces->mesh);
  scree_free(pieces->items);
  *pieces = (scree_pieces){.count = 0};
}

scree_status scree_wall_mend(const scree_mesh *soup, scree_mesh *wall, scree_wall_mending *mending,
                             scree_error *error) {
  scree_pieces pieces;
  SCREE_TRY(scree_pieces_make(soup, &pieces, error));
  if (mending) *mending = pieces.mending;
  *wall = pieces.mesh;
  pieces.mesh = (scree_mesh){0};
  scree_pieces_free(&pieces);
  return SCREE_OK;
}

/* ---- inside and outside ---- */

int scree_piece_winding(const scree_pieces *pieces, size_t index, vec3 p) {
  const scree_piece *piece = &pieces->items[index];
  const scree_box box = {piece->low, piece->high};
  if (scree_box_distance2(&box, p) > 0) return 0;
  return (int)floor(scree_winding_about(&pieces->mesh, piece->first, piece->count, p) + 0.5);
}

void scree_piece_turn(scree_pieces *pieces, size_t index) {
  scree_piece *piece = &pieces->items[index];
  for (size_t t = piece->first; t < piece->first + piece->count; t++)
    scree_corners_turn(pieces->mesh.triangles + 3 * t);
  piece->volume = -piece->volume;
}
