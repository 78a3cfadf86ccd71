/* Each polygon has two sides, and a piece is a set of sides that hang together: those of one cell
 * that share a vertex, and those of pieces that joined. A polygon with both sides in one piece lies
 * inside it and is left out. */
#include "mesh/fracture/pieces.h"
#include "base/alloc.h"
#include "base/sum.h"
#include "mesh/adjacency.h"
#include "mesh/fracture/section.h"
#include "mesh/measure/bounds.h"
#include "mesh/measure/solid_angle.h"
#include "mesh/repair/repair.h"

typedef struct work {
  const scree_cut_body *body;
  const scree_fracture_options *options;
  size_t polygon_count, side_count;
  uint32_t *piece;  /* union-find of sides; by root, a piece */
  double *volumes;  /* by root */
  vec3 origin;      /* of volumes */
  uint32_t *local;  /* by vertex: of a piece */
  uint32_t *stamps; /* by vertex: the piece that `local` is of */
  uint32_t stamp;
  uint32_t *polygon; /* by triangle of the last mesh */
  size_t joined;
} work;

static const uint32_t *triangle_of(const work *w, size_t triangle) {
  return w->body->polygons->corners.items + 3 * triangle;
}
static const scree_polygon *polygon_of(const work *w, size_t side) {
  return &w->body->polygons->list.items[side / 2];
}
static double area_of(const work *w, size_t polygon) {
  return w->body->polygons->list.items[polygon].area;
}
static uint32_t cell_of(work *w, size_t side) {
  return polygon_of(w, side)->of[side % 2];
}
static uint32_t root_of(work *w, size_t side) {
  return scree_find_root(w->piece, (uint32_t)side);
}
/* Whether a polygon lies between two pieces. */
static bool is_between(work *w, size_t polygon) {
  return cell_of(w, 2 * polygon + 1) != SCREE_NO_CELL &&
         root_of(w, 2 * polygon) != root_of(w, 2 * polygon + 1);
}
/* Of a side on the surface of a piece. */
static uint32_t piece_of(work *w, size_t side) {
  bool there = cell_of(w, side) != SCREE_NO_CELL,
       inner = there && cell_of(w, side ^ 1) != SCREE_NO_CELL && !is_between(w, side / 2);
  return there && !inner ? root_of(w, side) : SCREE_NO_CELL;
}

/* Six times the volume between a side and the origin. */
static double volume6(const work *w, size_t side) {
  const scree_polygon *p = polygon_of(w, side);
  scree_sum sum = {0, 0};
  for (size_t t = p->first; t < p->first + p->count; t++) {
    const uint32_t *c = triangle_of(w, t);
    vec3 q[3];
    for (int k = 0; k < 3; k++) q[k] = vec3_sub(w->body->places[c[k]], w->origin);
    scree_sum_add(&sum, vec3_dot(q[0], vec3_cross(q[1], q[2])));
  }
  return side % 2 ? -scree_sum_value(sum) : scree_sum_value(sum);
}

/* ---- what hangs together ---- */

/* Sides by a key below `keys`, or SCREE_NO_CELL: those of key k are sorted[first[k]] on. */
static void sort_sides(work *w, uint32_t (*key_of)(work *, size_t), size_t keys, uint32_t *first,
                       uint32_t *sorted) {
  memset(first, 0, (keys + 1) * sizeof *first);
  for (int pass = 0; pass < 2; pass++) {
    for (size_t s = w->side_count; s-- > 0;) {
      uint32_t key = key_of(w, s);
      if (key == SCREE_NO_CELL) continue;
      if (pass)
        sorted[--first[key]] = (uint32_t)s;
      else
        first[key]++;
    }
    for (size_t k = 1; k <= keys && !pass; k++) first[k] += first[k - 1];
  }
}

static void join_side(work *w, uint32_t side) {
  const scree_polygon *p = polygon_of(w, side);
  for (size_t c = 3 * (size_t)p->first; c < 3 * ((size_t)p->first + p->count); c++) {
    uint32_t vertex = w->body->polygons->corners.items[c];
    if (w->stamps[vertex] == w->stamp) scree_join(w->piece, side, w->local[vertex]);
    w->stamps[vertex] = w->stamp;
    w->local[vertex] = side;
  }
}

/* Whether the part of a cell with this root winds round a point of another. */
static bool winds_round(work *w, const uint32_t *sides, size_t count, uint32_t root, vec3 point) {
  double sum = 0;
  for (size_t k = 0; k < count; k++) {
    const scree_polygon *p = polygon_of(w, sides[k]);
    if (root_of(w, sides[k]) != root) continue;
    for (size_t t = p->first; t < p->first + p->count; t++) {
      vec3 q[3];
      for (int i = 0; i < 3; i++) q[i] = vec3_sub(w->body->places[triangle_of(w, t)[i]], point);
      sum += (sides[k] % 2 ? -1 : 1) * scree_half_solid_angle(q[0], q[1], q[2]);
    }
  }
  return fabs(sum) > 3;
}

static void unite(work *w, uint32_t a, uint32_t b) {
  double both = w->volumes[a] + w->volumes[b];
  scree_join(w->piece, a, b);
  w->volumes[root_of(w, a)] = both;
}

/* A part of a cell that is wound inwards is the wall of a cavity: it belongs to the smallest part
 * around it. */
static void join_cavities(work *w, const uint32_t *sides, size_t count) {
  for (size_t k = 0; k < count; k++) {
    uint32_t root = sides[k], best = UINT32_MAX;
    if (root_of(w, root) != root || w->volumes[root] >= 0) continue;
    vec3 point = w->body->places[triangle_of(w, polygon_of(w, root)->first)[0]];
    for (size_t i = 0; i < count; i++) {
      uint32_t other = sides[i];
      if (root_of(w, other) == other && w->volumes[other] > 0 &&
          (best == UINT32_MAX || w->volumes[other] < w->volumes[best]) &&
          winds_round(w, sides, count, other, point))
        best = other;
    }
    if (best != UINT32_MAX) unite(w, root, best);
  }
}

static scree_status split_cells(work *w, size_t *apart, scree_error *error) {
  SCREE_SCRATCH(uint32_t, first, w->body->cell_count + 1, error);
  SCREE_SCRATCH(uint32_t, sorted, w->side_count, error);
  sort_sides(w, cell_of, w->body->cell_count, first, sorted);
  for (size_t i = 0; i < w->body->cell_count; i++) {
    const uint32_t *sides = sorted + first[i];
    size_t count = first[i + 1] - first[i], roots = 0;
    w->stamp++;
    for (size_t k = 0; k < count; k++) join_side(w, sides[k]);
    for (size_t k = 0; k < count; k++) w->volumes[root_of(w, sides[k])] += volume6(w, sides[k]) / 6;
    join_cavities(w, sides, count);
    for (size_t k = 0; k < count; k++) roots += root_of(w, sides[k]) == sides[k];
    *apart += roots > 1;
  }
  return SCREE_OK;
}

/* ---- what joins a neighbour ---- */

/* The root of the piece with which that of `root` has most area in common; itself: none. */
static uint32_t main_neighbour(work *w, uint32_t root, double *areas) {
  uint32_t best = root;
  for (size_t p = 0; p < w->polygon_count; p++) {
    if (!is_between(w, p)) continue;
    uint32_t a = root_of(w, 2 * p), b = root_of(w, 2 * p + 1);
    if (a != root && b != root) continue;
    uint32_t other = a == root ? b : a;
    areas[other] += area_of(w, p);
    if (best == root || areas[other] > areas[best]) best = other;
  }
  for (size_t p = 0; p < w->side_count; p++) areas[p] = 0;
  return best;
}

static scree_status join_small(work *w, double least, scree_error *error) {
  SCREE_SCRATCH_ZERO(double, areas, w->side_count, error);
  for (uint32_t s = 0; s < w->side_count; s++) {
    if (cell_of(w, s) == SCREE_NO_CELL || w->piece[s] != s || w->volumes[s] >= least) continue;
    uint32_t other = main_neighbour(w, s, areas);
    if (other == s) continue;
    unite(w, s, other);
    w->joined++;
    s = UINT32_MAX; /* what was small may have grown, and what it joined may be small: again */
  }
  return SCREE_OK;
}

/* ---- as meshes ---- */

static uint32_t local_vertex(work *w, uint32_t vertex, scree_mesh *mesh) {
  if (w->stamps[vertex] != w->stamp) {
    w->stamps[vertex] = w->stamp;
    w->local[vertex] = (uint32_t)mesh->vertex_count;
    vec3_store(mesh->positions + 3 * mesh->vertex_count++, w->body->places[vertex]);
  }
  return w->local[vertex];
}

/* The surface of a piece, given its sides that lie on it. */
static scree_status make_mesh(work *w, const uint32_t *sides, size_t count, scree_mesh *mesh,
                              scree_error *error) {
  size_t triangles = 0, n = 0;
  for (size_t k = 0; k < count; k++) triangles += polygon_of(w, sides[k])->count;
  SCREE_TRY(scree_mesh_make(3 * triangles, triangles, mesh, error));
  mesh->vertex_count = 0;
  w->stamp++;
  for (size_t k = 0; k < count; k++) {
    const scree_polygon *p = polygon_of(w, sides[k]);
    for (size_t t = p->first; t < p->first + p->count; t++, n++) {
      uint32_t *to = mesh->triangles + 3 * n;
      for (int i = 0; i < 3; i++) to[i] = local_vertex(w, triangle_of(w, t)[i], mesh);
      if (sides[k] % 2) scree_corners_turn(to);
      w->polygon[n] = sides[k] / 2;
    }
  }
  return SCREE_OK;
}

/* The larger of the polygons between pieces that two triangles belong to; SIZE_MAX: neither does.
 */
static size_t joint_of(work *w, size_t t, size_t u) {
  size_t best = SIZE_MAX;
  for (int k = 0; k < 2; k++) {
    size_t p = w->polygon[k ? u : t];
    if (is_between(w, p) && (best == SIZE_MAX || area_of(w, p) > area_of(w, best))) best = p;
  }
  return best;
}

/* Joins the piece with a neighbour at the first place that a particle may not have. */
static scree_status mend(work *w, const scree_mesh *mesh, bool *mended, bool *doubtful,
                         scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY(scree_adjacency_build(mesh, &adjacency, error));
  for (uint32_t h = 0; h < 3 * mesh->triangle_count && !*mended && !*doubtful; h++) {
    uint32_t g = adjacency.ring[h];
    *doubtful = g == SCREE_NO_HALF_EDGE || g == h || adjacency.ring[g] != h ||
                scree_half_edge_from(mesh, g) == scree_half_edge_from(mesh, h);
    if (*doubtful || !w->options->usable ||
        !(scree_edge_is_sharp(mesh, &adjacency, h) || scree_facet_is_flat(mesh, h / 3)))
      continue;
    size_t polygon = joint_of(w, h / 3, g / 3);
    if (polygon == SIZE_MAX) continue;
    unite(w, root_of(w, 2 * polygon), root_of(w, 2 * polygon + 1));
    w->joined++;
    *mended = true;
  }
  return SCREE_OK;
}

/* Looks at every piece until none is joined any more. */
static scree_status mend_all(work *w, uint32_t *first, uint32_t *sorted, bool *doubtful,
                             scree_error *error) {
  SCREE_SCRATCH_ZERO(bool, sound, w->side_count, error);
  for (bool again = true; again && !*doubtful;) {
    again = false;
    sort_sides(w, piece_of, w->side_count, first, sorted);
    for (uint32_t s = 0; s < w->side_count && !*doubtful; s++) {
      bool mended = false;
      SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
      if (first[s + 1] == first[s] || w->piece[s] != s || sound[s]) continue;
      SCREE_TRY(make_mesh(w, sorted + first[s], first[s + 1] - first[s], &mesh, error));
      SCREE_TRY(mend(w, &mesh, &mended, doubtful, error));
      sound[s] = sound[root_of(w, s)] = !mended;
      again |= mended;
      if (mended) sort_sides(w, piece_of, w->side_count, first, sorted);
    }
  }
  return SCREE_OK;
}

/* ---- faces between pieces ---- */

static scree_status describe(const work *w, const scree_polygon *p, scree_fracture_face *f,
                             scree_error *error) {
  SCREE_SCRATCH(vec3, corners, 3 * (size_t)p->count, error);
  for (size_t k = 0; k < 3 * (size_t)p->count; k++)
    corners[k] = w->body->places[triangle_of(w, p->first)[k]];
  scree_section_describe(corners, p->count, f);
  return SCREE_OK;
}

/* number: of the piece with this root. */
static scree_status make_faces(work *w, const uint32_t *number, const vec3 *sites,
                               scree_fracture *out, scree_error *error) {
  double area = 0, count = 0;
  for (size_t p = 0; p < w->polygon_count; p++)
    if (is_between(w, p)) area += area_of(w, p), count++;
  SCREE_TRY_ALLOC(out->faces, (size_t)count, error);
  for (size_t p = 0; p < w->polygon_count; p++) {
    const scree_polygon *polygon = &w->body->polygons->list.items[p];
    if (!is_between(w, p)) continue;
    if (polygon->area < scree_least_face * area / count) {
      out->small_face_count++;
      continue;
    }
    scree_fracture_face *f = &out->faces[out->face_count++];
    *f = (scree_fracture_face){.a = number[root_of(w, 2 * p)], .b = number[root_of(w, 2 * p + 1)]};
    SCREE_TRY(describe(w, polygon, f, error));
    vec3 between = vec3_sub(sites[polygon->of[1]], sites[polygon->of[0]]);
    f->distance = fabs(vec3_dot(between, vec3_load(f->normal)));
  }
  return SCREE_OK;
}

/* ---- all ---- */

static scree_status make_pieces(work *w, const uint32_t *first, const uint32_t *sorted,
                                uint32_t *number, scree_fracture *out, scree_error *error) {
  size_t count = 0;
  for (uint32_t s = 0; s < w->side_count; s++) count += first[s + 1] > first[s];
  SCREE_TRY_ALLOC_ZERO(out->pieces, count, error);
  for (uint32_t s = 0; s < w->side_count; s++) {
    if (first[s + 1] == first[s]) continue;
    number[s] = (uint32_t)out->piece_count;
    SCREE_TRY(make_mesh(w, sorted + first[s], first[s + 1] - first[s],
                        &out->pieces[out->piece_count++], error));
  }
  return SCREE_OK;
}

scree_status scree_fracture_pieces(const scree_cut_body *body,
                                   const scree_fracture_options *options, const vec3 *sites,
                                   scree_fracture *out, bool *doubtful, scree_error *error) {
  size_t polygons = body->polygons->list.count, vertices = body->cutter->vertices.count;
  vec3 low, high;
  scree_mesh_bounds(body->mesh, &low, &high);
  work w = {.body = body,
            .options = options,
            .polygon_count = polygons,
            .side_count = 2 * polygons,
            .origin = vec3_scale(vec3_add(low, high), 0.5)};
  SCREE_SCRATCH(uint32_t, piece, w.side_count, error);
  SCREE_SCRATCH_ZERO(double, volumes, w.side_count, error);
  SCREE_SCRATCH(uint32_t, local, vertices, error);
  SCREE_SCRATCH_ZERO(uint32_t, stamps, vertices, error);
  SCREE_SCRATCH(uint32_t, polygon, 2 * body->polygons->corners.count / 3, error);
  SCREE_SCRATCH(uint32_t, first, w.side_count + 1, error);
  SCREE_SCRATCH(uint32_t, sorted, w.side_count, error);
  SCREE_SCRATCH(uint32_t, number, w.side_count, error);
  for (size_t s = 0; s < w.side_count; s++) piece[s] = (uint32_t)s;
  w.piece = piece;
  w.volumes = volumes;
  w.local = local;
  w.stamps = stamps;
  w.polygon = polygon;
  double least = options->least_volume * out->volume / (double)body->cell_count;
  SCREE_TRY(split_cells(&w, &out->apart_count, error));
  SCREE_TRY(join_small(&w, least, error));
  SCREE_TRY(mend_all(&w, first, sorted, doubtful, error));
  if (*doubtful) return SCREE_OK;
  SCREE_TRY(make_pieces(&w, first, sorted, number, out, error));
  out->joined_count = w.joined;
  return make_faces(&w, number, sites, out, error);
}
