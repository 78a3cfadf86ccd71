/* Mesh walls: any soup mended (mesh/repair/soup.h), and on which side of what is closed the bodies
 * are.
 *
 * Closed pieces divide space into regions, each within its outermost pieces. An inlet marks the
 * region that most of it lies in: bodies are there. Between a region with bodies and one without,
 * the piece is solid on the side without: a container holds what is in it. With bodies on both
 * sides it is a sheet. Where no body is on either side it is solid. What is solid is one wall,
 * sheets are another; sheets all inside of solids are left out. */
#include "scene/walls.h"
#include "scene/region.h"

#include "base/alloc.h"
#include "mesh/adjacency.h"

#include <stdarg.h>
#include <string.h>

enum { GRID = 4, LOOKS = 8 };
typedef enum piece_side {
  OUTSIDE,
  INSIDE,
  BOTH
} piece_side; /* where bodies are; as plan->side - 1 */

typedef struct division {
  scree_pieces pieces;
  uint32_t *parent; /* of a closed piece: the closed one that it lies in, or their count */
  uint32_t *level;  /* how many it lies in */
  uint8_t *side;
  bool *bodies;  /* by region: within that piece; the last: outside all */
  size_t hidden; /* sheets left out */
} division;

static void free_division(division *d) {
  scree_pieces_free(&d->pieces);
  scree_free(d->parent);
  scree_free(d->level);
  scree_free(d->side);
  scree_free(d->bodies);
}

/* ---- how pieces lie in each other ---- */

static vec3 middle_of(const scree_mesh *mesh, size_t facet) {
  vec3 sum = {0, 0, 0};
  for (int k = 0; k < 3; k++) sum = vec3_add(sum, scree_mesh_corner(mesh, facet, k));
  return vec3_scale(sum, 1.0 / 3);
}

static bool is_within(vec3 p, const scree_piece *piece) {
  return p.x >= piece->low.x && p.y >= piece->low.y && p.z >= piece->low.z &&
         p.x <= piece->high.x && p.y <= piece->high.y && p.z <= piece->high.z;
}

/* Whether places all over it are in the other: what crosses it or touches it is not. */
static bool lies_in(const scree_pieces *p, size_t piece, size_t other) {
  const scree_piece *one = &p->items[piece];
  if (!is_within(one->low, &p->items[other]) || !is_within(one->high, &p->items[other]))
    return false;
  for (size_t i = 0; i < LOOKS; i++) {
    size_t facet = one->first + i * (one->count - 1) / (LOOKS - 1);
    if (!scree_piece_winding(p, other, middle_of(&p->mesh, facet))) return false;
  }
  return true;
}

static void nest(division *d) {
  const scree_pieces *p = &d->pieces;
  for (size_t i = 0; i < p->count; i++)
    for (size_t k = 0; k < p->count; k++)
      d->level[i] += k != i && p->items[i].closed && p->items[k].closed && lies_in(p, i, k);
  for (size_t i = 0; i < p->count; i++) {
    d->parent[i] = (uint32_t)p->count;
    for (size_t k = 0; k < p->count; k++)
      if (k != i && p->items[i].closed && p->items[k].closed && d->level[k] + 1 == d->level[i] &&
          lies_in(p, i, k))
        d->parent[i] = (uint32_t)k;
  }
}

/* The innermost closed piece around p, or their count. */
static size_t region_at(const division *d, vec3 p) {
  const scree_pieces *pieces = &d->pieces;
  size_t found = pieces->count;
  for (size_t i = 0; i < pieces->count; i++)
    if (pieces->items[i].closed && (found == pieces->count || d->level[i] > d->level[found]) &&
        scree_piece_winding(pieces, i, p))
      found = i;
  return found;
}

/* ---- where bodies are ---- */

/* Place `index` of GRID^3 in an inlet's region; of layers in what the first covers. */
static vec3 place_in(const scree_scene *scene, const scree_plan_inlet *inlet, int index) {
  const double share[3] = {(index % GRID + 0.5) / GRID, (index / GRID % GRID + 0.5) / GRID,
                           (index / GRID / GRID + 0.5) / GRID};
  double thick = 0;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    thick = fmax(thick, 2 * scene->shapes[i].extent.radius);
  if (inlet->layers && inlet->layers->in) {
    size_t k = 0;
    while (scene->inlets[k].plan != inlet) k++;
    const scree_scene_layers *l = &scene->inlets[k].layers;
    double x = l->radius > 0 ? 0.7 * l->radius : l->half[0],
           y = l->radius > 0 ? 0.7 * l->radius : l->half[1];
    return vec3_add(l->middle,
                    (vec3){(2 * share[0] - 1) * x, (2 * share[1] - 1) * y, share[2] * thick});
  }
  return scree_region_place(&SCREE_REGION_OF(inlet), share, inlet->layers ? thick : 0);
}

/* The region that most of the inlet lies in. */
static size_t region_of_inlet(const scree_scene *scene, const division *d,
                              const scree_plan_inlet *inlet, vec3 at) {
  size_t best = d->pieces.count, most = 0, found[GRID * GRID * GRID];
  for (int i = 0; i < GRID * GRID * GRID; i++)
    found[i] = region_at(d, vec3_sub(place_in(scene, inlet, i), at));
  for (int i = 0; i < GRID * GRID * GRID; i++) {
    size_t same = 0;
    for (int k = 0; k < GRID * GRID * GRID; k++) same += found[k] == found[i];
    if (same > most) most = same, best = found[i];
  }
  return best;
}

/* Where some of a table's bodies are; a few out of many are mistakes, which the run tells. */
static void mark_table(const scree_scene *scene, vec3 at, division *d) {
  static const double least_share = 0.02;
  for (size_t region = 0; region <= d->pieces.count; region++) {
    size_t within = 0;
    for (size_t i = 0; i < scene->table_place_count; i++)
      within += region_at(d, vec3_sub(vec3_load(scene->table_places[i]), at)) == region;
    if ((double)within > least_share * (double)scene->table_place_count) d->bodies[region] = true;
  }
}

static void mark_bodies(const scree_scene *scene, const scree_plan_geometry *g, division *d) {
  size_t count = d->pieces.count;
  for (size_t i = 0; i < scene->plan.inlets.count && g->side == 0; i++) {
    const scree_plan_inlet *inlet = &scene->plan.inlets.items[i];
    d->bodies[region_of_inlet(scene, d, inlet, vec3_load(g->at))] = true;
  }
  if (g->side == 0) mark_table(scene, vec3_load(g->at), d);
  if (g->side == 0) return;
  d->bodies[count] = g->side - 1 != INSIDE;
  for (size_t i = 0; i < count && g->side - 1 != OUTSIDE; i++)
    if (d->pieces.items[i].closed && (d->level[i] == 0 || g->side - 1 == BOTH)) d->bodies[i] = true;
}

static void decide_sides(division *d) {
  for (size_t i = 0; i < d->pieces.count; i++) {
    const scree_piece *piece = &d->pieces.items[i];
    if (!piece->closed) continue;
    bool within = d->bodies[i], around = d->bodies[d->parent[i]], inwards = piece->volume < 0;
    d->side[i] = within && around ? BOTH : within ? INSIDE : OUTSIDE;
    if (d->side[i] != BOTH && inwards != (d->side[i] == INSIDE)) scree_piece_turn(&d->pieces, i);
  }
}

/* ---- the walls ---- */

static bool is_solid(const division *d, size_t piece) {
  return d->pieces.items[piece].closed && d->side[piece] != BOTH;
}

static bool is_in_solid(const division *d, vec3 p) {
  int winding = 0;
  double volume = 0;
  for (size_t i = 0; i < d->pieces.count; i++) {
    if (!is_solid(d, i)) continue;
    volume += d->pieces.items[i].volume;
    winding += scree_piece_winding(&d->pieces, i, p);
  }
  return winding + (volume < 0) > 0;
}

/* Whether no body can come to the sheet. */
static bool is_hidden(const division *d, size_t piece) {
  const scree_piece *sheet = &d->pieces.items[piece];
  for (size_t i = 0; i < LOOKS; i++)
    if (!is_in_solid(
            d, middle_of(&d->pieces.mesh, sheet->first + i * (sheet->count - 1) / (LOOKS - 1))))
      return false;
  return true;
}

/* The pieces that are marked, as a mesh; without triangles where there are none. */
static scree_status gather(const division *d, const bool *chosen, scree_mesh *mesh,
                           scree_error *error) {
  const scree_mesh *all = &d->pieces.mesh;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  SCREE_SCRATCH(uint32_t, number, all->vertex_count, error);
  memset(number, 0xff, all->vertex_count * sizeof *number);
  SCREE_TRY_ALLOC(made.positions, 3 * all->vertex_count, error);
  SCREE_TRY_ALLOC(made.triangles, 3 * all->triangle_count, error);
  for (size_t i = 0; i < d->pieces.count; i++) {
    if (!chosen[i]) continue;
    const scree_piece *piece = &d->pieces.items[i];
    memcpy(made.triangles + 3 * made.triangle_count, all->triangles + 3 * piece->first,
           3 * piece->count * sizeof *made.triangles);
    made.triangle_count += piece->count;
  }
  for (size_t c = 0; c < 3 * made.triangle_count; c++) number[made.triangles[c]] = 0;
  for (size_t v = 0; v < all->vertex_count; v++) {
    if (number[v]) continue;
    number[v] = (uint32_t)made.vertex_count;
    memcpy(made.positions + 3 * made.vertex_count++, all->positions + 3 * v, 3 * sizeof(double));
  }
  for (size_t c = 0; c < 3 * made.triangle_count; c++)
    made.triangles[c] = number[made.triangles[c]];
  *mesh = made;
  memset(&made, 0, sizeof made);
  return SCREE_OK;
}

static scree_status make_walls(division *d, const scree_plan_belt *belt, scree_scene_walls *walls,
                               scree_error *error) {
  size_t count = d->pieces.count, solids = 0, open = 0;
  SCREE_SCRATCH_ZERO(bool, chosen, count, error);
  for (size_t i = 0; i < count; i++) solids += chosen[i] = is_solid(d, i);
  if (belt) SCREE_TRY(scree_scene_wind_belts(belt, &d->pieces, chosen, error));
  if (solids) SCREE_TRY(gather(d, chosen, &walls->solid, error));
  for (size_t i = 0; i < count; i++) {
    bool hidden = !d->pieces.items[i].closed && solids && is_hidden(d, i);
    chosen[i] = !is_solid(d, i) && !hidden;
    d->hidden += hidden;
    open += chosen[i];
  }
  return open ? gather(d, chosen, &walls->sheet, error) : SCREE_OK;
}

/* ---- what is told ---- */

typedef struct line {
  char *text;
  size_t size;
} line;

SCREE_PRINTF(2, 3)
static void add(const line *l, const char *format, ...) {
  size_t used = strlen(l->text);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(l->text + used, l->size - used, format, arguments);
  va_end(arguments);
}

/* Separated from what is there. */
static void add_count(const line *l, const char *before, size_t count, const char *one,
                      const char *many) {
  if (count) add(l, "%s%zu %s", before, count, count == 1 ? one : many);
}

static void describe(const division *d, scree_scene_walls *walls) {
  const line l = {walls->note, sizeof walls->note};
  const scree_wall_mending *m = &d->pieces.mending;
  size_t counts[4] = {0};
  for (size_t i = 0; i < d->pieces.count; i++) counts[d->pieces.items[i].closed ? d->side[i] : 3]++;
  walls->is_plain = counts[INSIDE] + counts[BOTH] == 0;
  *l.text = 0;
  add_count(&l, "", d->pieces.mesh.triangle_count, "facet", "facets");
  add_count(&l, ", ", counts[OUTSIDE], "solid", "solids");
  add_count(&l, ", ", counts[INSIDE], "container: bodies are in it",
            "containers: bodies are in them");
  add_count(&l, ", ", counts[BOTH], "closed sheet with bodies on both sides",
            "closed sheets with bodies on both sides");
  add_count(&l, ", ", counts[3], "open sheet", "open sheets");
  const struct {
    size_t count;
    const char *one, *many;
  } done[] = {
      {m->welded, "vertex welded to another", "vertices welded to others"},
      {m->flat, "facet without area dropped", "facets without area dropped"},
      {m->joined, "vertex set into an edge that ran past it",
       "vertices set into edges that ran past them"},
      {m->doubled, "facet that lay on others dropped", "facets that lay on others dropped"},
      {m->parted, "edge of three facets or more parted", "edges of three facets or more parted"},
      {m->turned, "facet turned over", "facets turned over"},
      {d->hidden, "sheet inside of solids left out", "sheets inside of solids left out"},
  };
  const char *before = "; mended: ";
  for (size_t i = 0; i < sizeof done / sizeof *done; i++) {
    add_count(&l, before, done[i].count, done[i].one, done[i].many);
    if (done[i].count) before = ", ";
  }
}

/* A side was asked of what has none. */
static scree_status refuse_open(const scree_plan_geometry *g, const scree_mesh *mesh,
                                scree_error *error) {
  static const char *const sides[] = {"outside", "inside", "both"};
  scree_adjacency adjacency;
  SCREE_TRY(scree_adjacency_build(mesh, &adjacency, error));
  uint32_t h = 0;
  while (h + 1 < 3 * mesh->triangle_count && adjacency.ring[h] != h) h++;
  vec3 a = vec3_add(scree_mesh_corner(mesh, h / 3, (int)(h % 3)), vec3_load(g->at)),
       b = vec3_add(scree_mesh_corner(mesh, h / 3, (int)(h % 3 + 1) % 3), vec3_load(g->at));
  scree_adjacency_free(&adjacency);
  return scree_fail(error, SCREE_BAD_MESH,
                    "side: %s is of closed surfaces; the wall is open, as at the edge from (%.6g, "
                    "%.6g, %.6g) to (%.6g, %.6g, %.6g) m",
                    sides[g->side - 1], a.x, a.y, a.z, b.x, b.y, b.z);
}

scree_status scree_scene_make_walls(const scree_scene *scene, const scree_plan_geometry *g,
                                    const scree_mesh *mesh, scree_scene_walls *walls,
                                    scree_error *error) {
  SCREE_CLEANUP(free_division) division d = {.hidden = 0};
  SCREE_CLEANUP(scree_scene_walls_free) scree_scene_walls made = {.is_plain = true};
  SCREE_TRY(scree_pieces_make(mesh, &d.pieces, error));
  size_t count = d.pieces.count, closed = 0;
  for (size_t i = 0; i < count; i++) closed += d.pieces.items[i].closed;
  SCREE_TRY_ALLOC_ZERO(d.parent, count, error);
  SCREE_TRY_ALLOC_ZERO(d.level, count, error);
  SCREE_TRY_ALLOC_ZERO(d.side, count, error);
  SCREE_TRY_ALLOC_ZERO(d.bodies, count + 1, error);
  if (g->side && !closed) return refuse_open(g, &d.pieces.mesh, error);
  if (closed) {
    nest(&d);
    mark_bodies(scene, g, &d);
    decide_sides(&d);
  }
  SCREE_TRY(make_walls(&d, g->belt, &made, error));
  describe(&d, &made);
  *walls = made;
  made = (scree_scene_walls){0};
  return SCREE_OK;
}

void scree_scene_walls_free(scree_scene_walls *walls) {
  scree_mesh_free(&walls->solid);
  scree_mesh_free(&walls->sheet);
}
