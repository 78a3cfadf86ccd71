/* How the facets hang together, from the rings of half-edges (mesh/adjacency.h).
 *
 * Shells are the pieces connected through shared edges, however many facets meet there. A vertex is
 * non-manifold where its facets form more than one fan, that is where not all of them are connected
 * through edges at that vertex (two cones touching at their tips); a vertex of a non-manifold edge
 * counts only if that holds as well. A facet is flat where its height over its longest edge is not
 * above the rounding of its coordinates: an exact zero would be lost when units are converted. The
 * genus g follows from Euler-Poincare, V - E + F = 2 (shells - g). */
#include "base/array.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"
#include "mesh/repair/shells.h"

#include <stdlib.h>

typedef struct counter {
  const scree_mesh *mesh;
  const scree_adjacency *adjacency;
  scree_topology *found;
} counter;

static void count_facets(counter *c) {
  size_t facets = 0, degenerate = 0;
  for (size_t t = 0; t < c->mesh->triangle_count; t++) {
    facets += scree_takes_part(c->adjacency, t);
    degenerate += !scree_takes_part(c->adjacency, t) || scree_facet_is_flat(c->mesh, t);
  }
  c->found->facet_count = facets;
  c->found->degenerate_facet_count = degenerate;
}

static void count_edges(counter *c) {
  const uint32_t *ring = c->adjacency->ring;
  scree_topology *found = c->found;
  found->edge_count = c->adjacency->edge_count;
  found->oriented = true;
  for (size_t e = 0; e < c->adjacency->edge_count; e++) {
    uint32_t first = c->adjacency->edges[e], second = ring[first];
    uint32_t from = scree_half_edge_from(c->mesh, first);
    if (second == first) {
      found->boundary_edge_count++;
    } else if (ring[second] == first) {
      found->inconsistent_edge_count += scree_half_edge_from(c->mesh, second) == from;
    } else {
      found->non_manifold_edge_count++;
      size_t same = 1, all = 1;
      for (uint32_t h = second; h != first; h = ring[h], all++)
        same += scree_half_edge_from(c->mesh, h) == from;
      if (all % 2 == 0 && same != all / 2) found->oriented = false;
    }
  }
  if (found->inconsistent_edge_count) found->oriented = false;
  found->closed = found->boundary_edge_count == 0;
}

/* The facets with the same three vertices share the edge of the two lower ones: there, count equal
 * third vertices. */
static int compare_vertices(const void *a, const void *b) {
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

static scree_status count_duplicates(counter *c, scree_error *error) {
  const scree_mesh *mesh = c->mesh;
  SCREE_CLEANUP(scree_free_at) struct {
    uint32_t *items;
    size_t count, capacity;
  } third = {0};
  for (size_t e = 0; e < c->adjacency->edge_count; e++) {
    uint32_t first = c->adjacency->edges[e], h = first;
    third.count = 0;
    if (c->adjacency->ring[first] == first) continue;
    do {
      uint32_t apex = mesh->triangles[scree_half_edge_previous(h)];
      bool counts = apex > scree_half_edge_from(mesh, h) && apex > scree_half_edge_to(mesh, h);
      if (counts && !SCREE_PUSH(&third, apex))
        return scree_fail_memory(error, third.capacity * sizeof apex, "facets at an edge");
      h = c->adjacency->ring[h];
    } while (h != first);
    if (third.count > 2) qsort(third.items, third.count, sizeof *third.items, compare_vertices);
    for (size_t i = 1; i < third.count; i++)
      c->found->duplicate_facet_count += third.items[i] == third.items[i - 1];
  }
  return SCREE_OK;
}

/* REACHED: the corner. The others, of a half-edge: the ring of its edge was gone through about the
 * vertex that it leaves, or leads to. */
enum { REACHED = 1, FROM_DONE = 2, TO_DONE = 4 };

/* Turns round the vertex of corner start through edges of two facets and marks the corners passed;
 * false, with none marked, where an edge of another kind is in the way. */
static bool walk_fan(const counter *c, uint32_t start, uint8_t *marks) {
  const uint32_t *ring = c->adjacency->ring, *corners = c->mesh->triangles;
  uint32_t vertex = corners[start], corner = start;
  do {
    uint32_t h = ring[corner];
    if (h == corner || ring[h] != corner || corners[h] == vertex) {
      for (uint32_t back = start; back != corner; back = scree_half_edge_next(ring[back]))
        marks[back] &= (uint8_t)~REACHED;
      return false;
    }
    marks[corner] |= REACHED;
    corner = scree_half_edge_next(h);
  } while (corner != start);
  return true;
}

/* Goes round the edge of `side` and puts the corners at the vertex that are new onto the stack.
 * Once for an edge and vertex: where many facets share an edge, each of them asks. */
static size_t flood_edge(const counter *c, uint32_t side, uint32_t vertex, uint8_t *marks,
                         uint32_t *stack, size_t depth) {
  const uint32_t *ring = c->adjacency->ring, *corners = c->mesh->triangles;
  if (marks[side] & (corners[side] == vertex ? FROM_DONE : TO_DONE)) return depth;
  uint32_t h = side;
  do {
    bool leaves = corners[h] == vertex;
    uint32_t other = leaves ? h : scree_half_edge_next(h);
    marks[h] |= leaves ? FROM_DONE : TO_DONE;
    if (!(marks[other] & REACHED)) {
      marks[other] |= REACHED;
      stack[depth++] = other;
    }
    h = ring[h];
  } while (h != side);
  return depth;
}

/* Floods the fan of corner start round its vertex; corners are marked as they are reached. */
static void flood_fan(const counter *c, uint32_t start, uint8_t *marks, uint32_t *stack) {
  uint32_t vertex = c->mesh->triangles[start];
  size_t depth = 0;
  stack[depth++] = start;
  marks[start] |= REACHED;
  while (depth > 0) {
    uint32_t corner = stack[--depth];
    depth = flood_edge(c, corner, vertex, marks, stack, depth);
    depth = flood_edge(c, scree_half_edge_previous(corner), vertex, marks, stack, depth);
  }
}

static scree_status count_vertices(counter *c, scree_error *error) {
  const scree_mesh *mesh = c->mesh;
  size_t corner_count = 3 * mesh->triangle_count;
  SCREE_SCRATCH_ZERO(uint32_t, valence, mesh->vertex_count, error);
  uint32_t largest = 0;
  for (size_t corner = 0; corner < corner_count; corner++)
    if (c->adjacency->ring[corner] != SCREE_NO_HALF_EDGE) {
      uint32_t now = ++valence[mesh->triangles[corner]];
      if (now > largest) largest = now;
    }
  SCREE_SCRATCH(uint32_t, stack, largest, error);
  SCREE_SCRATCH_ZERO(uint8_t, marks, corner_count, error);
  SCREE_SCRATCH_ZERO(uint8_t, fans, mesh->vertex_count, error);
  for (uint32_t corner = 0; corner < corner_count; corner++) {
    if (c->adjacency->ring[corner] == SCREE_NO_HALF_EDGE || marks[corner] & REACHED) continue;
    if (!walk_fan(c, corner, marks)) flood_fan(c, corner, marks, stack);
    uint8_t *at = &fans[mesh->triangles[corner]];
    if (*at < 2) c->found->non_manifold_vertex_count += ++*at == 2;
  }
  size_t unused = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++) unused += valence[v] == 0;
  c->found->unused_vertex_count = unused;
  c->found->vertex_count = mesh->vertex_count - unused;
  return SCREE_OK;
}

/* Every vertex met first is a piece of its own; every edge that joins two pieces takes one away. */
static scree_status count_boundaries(counter *c, scree_error *error) {
  const uint32_t none = UINT32_MAX;
  if (c->found->closed) return SCREE_OK;
  SCREE_SCRATCH(uint32_t, parent, c->mesh->vertex_count, error);
  for (size_t v = 0; v < c->mesh->vertex_count; v++) parent[v] = none;
  for (size_t e = 0; e < c->adjacency->edge_count; e++) {
    uint32_t h = c->adjacency->edges[e];
    if (c->adjacency->ring[h] != h) continue;
    uint32_t ends[2] = {scree_half_edge_from(c->mesh, h), scree_half_edge_to(c->mesh, h)};
    for (int i = 0; i < 2; i++)
      if (parent[ends[i]] == none) {
        parent[ends[i]] = ends[i];
        c->found->boundary_count++;
      }
    if (scree_find_root(parent, ends[0]) == scree_find_root(parent, ends[1])) continue;
    scree_join(parent, ends[0], ends[1]);
    c->found->boundary_count--;
  }
  return SCREE_OK;
}

static void conclude(scree_topology *found) {
  found->manifold = !found->non_manifold_edge_count && !found->non_manifold_vertex_count;
  found->euler_characteristic =
      (long long)found->vertex_count - (long long)found->edge_count + (long long)found->facet_count;
  found->genus = found->closed && found->manifold && found->oriented && found->facet_count
                     ? (long long)found->shell_count - found->euler_characteristic / 2
                     : -1;
}

scree_status scree_topology_count(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                  size_t part, scree_topology *topology, scree_error *error) {
  counter c = {.mesh = mesh, .adjacency = adjacency, .found = topology};
  if (part == 0) return count_vertices(&c, error);
  if (part == 1) {
    count_facets(&c);
    return SCREE_OK;
  }
  count_edges(&c);
  return count_duplicates(&c, error);
}

scree_status scree_topology_finish(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                   scree_topology *topology, scree_error *error) {
  counter c = {.mesh = mesh, .adjacency = adjacency, .found = topology};
  SCREE_TRY(count_boundaries(&c, error));
  conclude(topology);
  return SCREE_OK;
}

scree_status scree_mesh_topology(const scree_mesh *mesh, scree_topology *topology,
                                 scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_CLEANUP(scree_shells_free) scree_shells shells = {0};
  SCREE_TRY(scree_mesh_verify(mesh, error));
  SCREE_TRY(scree_adjacency_build(mesh, &adjacency, error));
  scree_topology found = {0};
  for (size_t part = 0; part < SCREE_TOPOLOGY_PARTS; part++)
    SCREE_TRY(scree_topology_count(mesh, &adjacency, part, &found, error));
  SCREE_TRY(scree_shells_find(mesh, &adjacency, &shells, error));
  found.shell_count = shells.count;
  for (size_t i = 0; i < shells.count; i++)
    found.inward_shell_count += shells.items[i].closed && shells.items[i].volume < 0;
  SCREE_TRY(scree_topology_finish(mesh, &adjacency, &found, error));
  *topology = found;
  return SCREE_OK;
}
