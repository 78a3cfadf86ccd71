/* What no feature may miss: how deep the edges of one body lie inside the other
 * (docs/background/physics.md, "Depths").
 *
 * The depth of an edge is that of its deepest point: the largest distance from the other's surface
 * over the part that lies inside. It follows from the pose alone, and changes by no more than what
 * moves. Where the deepest point lies between two faces, its slope is the mean of both that stands
 * across the edge. To move the bodies apart takes at least the depth, so that features that feel
 * rightly feel more, and the pair's smooth maximum leaves depths out (o <= t). Where features fail
 * depths take over.
 *
 * How far a point is from a surface changes by no more than its own way, so that every sample along
 * an edge tells how far to go on. */
#include "world/contact.h"

#include "particle/closest.h"

/* Bodies that lie deeper in each other from the start, of the limit, are refused. */
static const double start_share = 0.05;
static const double near_share = 0.25;   /* of the roundings: depths are asked for from here on */
static const double apart_share = 0.9;   /* of the roundings: bodies that part are apart */
static const double stride_share = 0.25; /* of the depth, while an edge is gone along */
static const double least_stride = 1.0 / 64; /* of the edge's way within the other's box */
static const double flat_bend = 1e-12;       /* of slopes along an edge */
/* Points of a mesh are looked for in the other from the start: corners, drawn towards the centre.
 */
static const double drawn_in[] = {0.9, 0.5, 0};
enum { REFINEMENTS = 24, HALVE_EVERY = 4, DRAWN_COUNT = sizeof drawn_in / sizeof *drawn_in };

/* The edges of one body against the surface of the other. */
typedef struct side {
  const scree_particle *from, *to;
  mat3 rotation; /* from's frame into to's */
  vec3 shift;
  bool of_a;
} side;

static void make_sides(const scree_world *world, const scree_pair *pair,
                       const scree_frame *relative, side sides[2]) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  mat3 back = mat3_transpose(&relative->rotation);
  sides[0] = (side){a, b, relative->rotation, relative->position, true};
  sides[1] = (side){b, a, back, vec3_neg(mat3_mul_vec(&back, relative->position)), false};
}

static bool is_solid(const scree_particle *particle) {
  return particle->face_count > 0 && particle->measures.volume > 0;
}

/* ---- one edge ---- */

/* An edge in the frame of the other body, and its part within that body's box. */
typedef struct line {
  vec3 start, along;
  double from, to;
} line;

typedef scree_depth sample; /* contact.h */

/* False where nothing of the edge lies within the box. */
static bool make_line(const side *sd, const scree_edge *edge, double above, line *l) {
  *l = (line){vec3_add(mat3_mul_vec(&sd->rotation, edge->start), sd->shift),
              mat3_mul_vec(&sd->rotation, edge->along), 0, edge->length};
  scree_box box = scree_box_grown(sd->to->face_tree.nodes[0].box, -above);
  const double start[3] = {l->start.x, l->start.y, l->start.z},
               along[3] = {l->along.x, l->along.y, l->along.z},
               low[3] = {box.low.x, box.low.y, box.low.z},
               high[3] = {box.high.x, box.high.y, box.high.z};
  for (int k = 0; k < 3; k++) {
    if (along[k] == 0 && (start[k] < low[k] || start[k] > high[k])) return false;
    if (along[k] == 0) continue;
    double t0 = (low[k] - start[k]) / along[k], t1 = (high[k] - start[k]) / along[k];
    l->from = scree_larger(l->from, scree_smaller(t0, t1));
    l->to = scree_smaller(l->to, scree_larger(t0, t1));
  }
  return l->from <= l->to;
}

static sample sample_at(const scree_particle *to, const line *l, double s) {
  const uint32_t root = 0;
  uint32_t face = 0;
  int region;
  vec3 p = vec3_mad(l->start, l->along, s);
  double d = scree_nearest_face(to, &root, 1, p, INFINITY, &face);
  if (!(d < INFINITY)) return (sample){s, -INFINITY, 0, {0, 0, 0}}; /* no number, or too far */
  vec3 offset = vec3_sub(p, scree_closest_on_face(&to->faces[face], p, &region)),
       outward = scree_outward(to, face, region);
  bool outside = vec3_dot(offset, outward) >= 0;
  vec3 slope =
      d > 1e-12 ? vec3_scale(offset, (outside ? -1 : 1) / d) : vec3_neg(vec3_unit(outward));
  return (sample){s, outside ? -d : d, vec3_dot(slope, l->along), slope};
}

/* Where the tangents at two points meet. */
static double meeting_of(const sample *low, const sample *high) {
  return (high->depth - low->depth + low->rate * low->s - high->rate * high->s) /
         (low->rate - high->rate);
}

/* The maximum between two points of which the depth grows towards the other: where tangents meet,
 * until none lies above the depth there. Its slope is the mean that stands across the edge. */
static sample refine(const scree_particle *to, const line *l, sample low, sample high) {
  for (int k = 1; k <= REFINEMENTS && low.rate - high.rate > flat_bend; k++) {
    double s = meeting_of(&low, &high);
    if (!(s > low.s && s < high.s) || k % HALVE_EVERY == 0) s = 0.5 * (low.s + high.s);
    sample here = sample_at(to, l, s);
    bool met = fabs(here.depth - (low.depth + low.rate * (s - low.s))) <= 1e-12;
    if (met || high.s - low.s < 1e-9 * (1e-6 + low.depth)) break;
    *(here.rate > 0 ? &low : &high) = here;
  }
  sample best = low.depth > high.depth ? low : high;
  double bend = low.rate - high.rate, share = bend > flat_bend ? -high.rate / bend : 0.5;
  share = share < 0 ? 0 : share > 1 ? 1 : share;
  double s = bend > flat_bend ? meeting_of(&low, &high) : best.s;
  if (s >= low.s && s <= high.s && bend > flat_bend) {
    best.s = s;
    best.depth = low.depth + low.rate * (s - low.s);
  }
  best.slope = vec3_add(vec3_scale(low.slope, share), vec3_scale(high.slope, 1 - share));
  return best;
}

/* The deepest point of an edge where it is deeper than `above`; else no deeper than that. */
static sample find_deepest(const side *sd, const scree_edge *edge, double above) {
  line l;
  sample deepest = {.depth = above};
  if (!make_line(sd, edge, above, &l)) return deepest;
  double least = scree_max(least_stride * (l.to - l.from), 1e-9 * edge->length);
  sample before = sample_at(sd->to, &l, l.from);
  deepest = before;
  if (!(before.depth > above)) deepest.depth = above;
  while (before.s < l.to) {
    double way = before.depth < above ? above - before.depth : stride_share * fabs(before.depth);
    sample here = sample_at(sd->to, &l, scree_min(before.s + scree_max(way, least), l.to));
    bool peak = before.rate > 0 && here.rate < 0 &&
                0.5 * (before.depth + here.depth + here.s - before.s) > deepest.depth;
    if (here.depth > deepest.depth) deepest = here;
    if (peak) {
      sample top = refine(sd->to, &l, before, here);
      if (top.depth > deepest.depth) deepest = top;
    }
    before = here;
  }
  return deepest;
}

/* ---- the edges of a pair ---- */

/* A place among the touches of depths: a new one, or that of the least deep. */
static bool make_place(scree_scratch *scratch, double overlap) {
  scree_touch *touches = scratch->touches.items;
  size_t count = scratch->touches.count, depths = 0, least = count;
  for (size_t i = count; i > 0 && touches[i - 1].of_depth; i--, depths++)
    if (least == count || touches[i - 1].overlap < touches[least].overlap) least = i - 1;
  if (depths < SCREE_DEPTHS) return true;
  if (touches[least].overlap >= overlap) return false;
  touches[least] = touches[--scratch->touches.count];
  return true;
}

static void add_depth(const side *sd, scree_pair *pair, vec3 p, const sample *deep,
                      scree_scratch *scratch) {
  double lever = vec3_norm(deep->slope), overlap = deep->depth - pair->law.smoothing;
  bool slopes = lever > 1e-6; /* in the midst of a wall it is as deep however it moves */
  vec3 out = slopes ? vec3_scale(deep->slope, -1 / lever) : (vec3){0, 0, 1},
       at = vec3_mad(p, out, overlap);
  const double values[4] = {-overlap, 0, 0, 1};
  if (!make_place(scratch, overlap)) return;
  if (!sd->of_a) {
    at = mat3_tmul_vec(&sd->rotation, vec3_sub(p, sd->shift));
    out = vec3_neg(mat3_tmul_vec(&sd->rotation, out));
  }
  size_t count = scratch->touches.count;
  scree_add_touch(scratch, pair, at, out, values, &scratch->no_anchor);
  if (scratch->touches.count == count) return;
  scree_touch *touch = &scratch->touches.items[count];
  touch->lever = slopes ? lever : 0;
  touch->of_depth = true;
}

/* Adds an edge as a touch whose deepest point lies deeper than `above`; answers that depth, or
 * `above`. */
static double touch_edge(const side *sd, scree_pair *pair, const scree_edge *edge, double above,
                         const sample *deep, scree_scratch *scratch) {
  if (!(deep->depth > above)) return above;
  vec3 along = vec3_mad(edge->start, edge->along, deep->s),
       p = vec3_add(mat3_mul_vec(&sd->rotation, along), sd->shift);
  if (deep->depth <= -pair->law.smoothing) return deep->depth;
  /* pseudonormals of folds may lie */
  if (deep->depth > pair->law.smoothing && !scree_is_inside(sd->to, p)) return above;
  add_depth(sd, pair, p, deep, scratch);
  return deep->depth;
}

static double touch_side(const side *sd, scree_pair *pair, double above, scree_scratch *scratch) {
  if (!sd->from->edge_count || !is_solid(sd->to)) return above;
  const scree_tree *tree = &sd->from->edge_tree;
  scree_box within = scree_box_grown(sd->to->face_tree.nodes[0].box, -above);
  double deepest = above;
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const scree_tree_node *node = &tree->nodes[stack[--depth]];
    scree_box box = scree_box_moved(&node->box, &sd->rotation, sd->shift);
    if (!scree_box_meets(&box, &within)) continue;
    for (uint32_t k = 0; k < node->count; k++) {
      const scree_edge *edge = &sd->from->edges[tree->order[node->first + k]];
      sample deep = find_deepest(sd, edge, above);
      deepest = scree_max(deepest, touch_edge(sd, pair, edge, above, &deep, scratch));
    }
    if (node->count) continue;
    stack[depth++] = node->first + 1;
    stack[depth++] = node->first;
  }
  return deepest;
}

double scree_touch_depths(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                          double above, scree_scratch *scratch) {
  side sides[2];
  make_sides(world, pair, relative, sides);
  double of_a = touch_side(&sides[0], pair, above, scratch);
  return scree_max(of_a, touch_side(&sides[1], pair, above, scratch));
}

/* ---- bodies in each other from the start ---- */

/* How deep a point of `from`, in its frame and with a radius, lies in `to`, where deeper than
 * `deepest`. */
static double depth_of_point(const side *sd, vec3 own, double radius, double deepest) {
  const uint32_t root = 0;
  uint32_t face;
  vec3 p = vec3_add(mat3_mul_vec(&sd->rotation, own), sd->shift);
  if (scree_box_distance2(&sd->to->face_tree.nodes[0].box, p) > 0) return deepest;
  double d = scree_nearest_face(sd->to, &root, 1, p, INFINITY, &face) + radius;
  bool deeper = d > deepest && scree_is_inside(sd->to, p);
  return deeper && (!is_solid(sd->from) || scree_is_inside(sd->from, own)) ? d : deepest;
}

/* Of bodies that were made in each other no edge need be inside: the deepest of a drawn-in corner,
 * or of a sphere. */
static double depth_of_corner(const side *sd, size_t i) {
  const scree_particle *from = sd->from;
  if (!is_solid(sd->to) || (from->face_count && !is_solid(from))) return 0;
  if (!from->face_count) return depth_of_point(sd, from->points[i], from->point_radii[i], 0);
  double deepest = 0;
  for (int k = 0; k < DRAWN_COUNT; k++)
    deepest = depth_of_point(sd, vec3_scale(from->points[i], drawn_in[k]), 0, deepest);
  return deepest;
}

static double start_depth(const scree_world *world, const scree_pair *pair,
                          const scree_frame *relative) {
  side sides[2];
  double deepest = 0;
  make_sides(world, pair, relative, sides);
  for (int k = 0; k < 2; k++)
    for (size_t i = 0; i < sides[k].from->point_count; i++)
      deepest = scree_max(deepest, depth_of_corner(&sides[k], i));
  return deepest;
}

/* ---- when depths are asked for ---- */

/* Nothing lies inside: what features that hold the bodies remember is from the wrong side. */
static void start_anew(const scree_pair *pair, scree_scratch *scratch) {
  for (uint32_t i = 0; i < pair->active.count; i++) {
    scree_item *item = &scratch->items[i];
    *item = (scree_item){.kind = item->kind, .a = item->a, .b = item->b};
  }
  scratch->touches.count = 0;
}

/* What the features feel. */
static scree_smooth_maximum felt_overlap(const scree_world *world, const scree_pair *pair,
                                         const scree_touch_list *touches) {
  scree_smooth_maximum felt;
  if (scree_solve_smooth_maximum(touches->items, touches->count, pair->law.smoothing,
                                 world->options.sharing, &felt))
    return felt;
  return (scree_smooth_maximum){.cutoff = -pair->law.smoothing};
}

/* Bodies that part are apart here: once they are pushed, where their springs would hardly press. */
static double apart_depth(const scree_pair *pair) {
  bool pushed = vec3_norm2(pair->way) > 0;
  return pushed ? -apart_share * pair->law.reach : 0;
}

static void note_start(const scree_pair *pair, double depth, scree_pair_work *work) {
  if (depth > scree_max(start_share * pair->law.limit, pair->law.reach))
    work->start_depth = scree_max(work->start_depth, depth);
}

void scree_pair_ask_depths(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  scree_depth_question *question = &scratch->question;
  *question = (scree_depth_question){false, false, 0};
  if (!b || !a->face_count || !b->face_count) pair->parting = false; /* no depth is known */
  if (!b) return;
  question->start = scree_pair_is_new(pair);
  if (!a->face_count || !b->face_count) return;
  double near = near_share * pair->law.reach,
         far = near + 2 * pair->list.travel - pair->law.reach - pair->law.smoothing;
  if (!pair->parting && !scratch->any_inside && !(pair->depth > 0) && !question->start &&
      scratch->least_gap >= far) {
    pair->depth = -INFINITY; /* cores that were apart meet at features, of which none is near */
    return;
  }
  scree_smooth_maximum felt = felt_overlap(world, pair, &scratch->touches);
  double above = felt.cutoff + pair->law.smoothing; /* what lies lower counts for nothing */
  /* features that look the wrong way claim any depth */
  if (felt.value > pair->law.limit) pair->parting = true;
  if (!pair->parting && pair->depth > -INFINITY && pair->depth + pair->list.travel < above) {
    pair->depth += pair->list.travel;
    return;
  }
  question->edges = true;
  question->above = pair->parting ? apart_depth(pair) : scree_min(above - near, 0.5 * above);
}

static void answer(scree_pair *pair, double start, double depth, scree_scratch *scratch,
                   scree_pair_work *work) {
  const scree_depth_question *question = &scratch->question;
  if (question->start) note_start(pair, start, work);
  if (!question->edges) return;
  pair->depth = depth;
  scratch->depth_queries++;
  if (question->start) note_start(pair, pair->depth, work);
  if (!pair->parting || pair->depth > apart_depth(pair)) return;
  pair->parting = false;
  pair->parted = true;
  pair->way = (vec3){0, 0, 0};
  start_anew(pair, scratch);
  work->let_go = pair->elastic + pair->elastic_since; /* of the last step */
}

void scree_pair_find_depths(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                            scree_pair_work *work) {
  const scree_depth_question *question = &scratch->question;
  const scree_frame *relative = &scratch->relative;
  double start = question->start ? start_depth(world, pair, relative) : 0, depth = 0;
  if (question->edges) depth = scree_touch_depths(world, pair, relative, question->above, scratch);
  answer(pair, start, depth, scratch, work);
}

/* ---- the same in pieces ---- */

/* The edges of a and of b, where they are asked for, then their points. */
typedef struct entries {
  side sides[2];
  size_t edges[2], points[2];
} entries;

static entries entries_of(const scree_world *world, const scree_pair *pair,
                          const scree_scratch *scratch) {
  entries all;
  make_sides(world, pair, &scratch->relative, all.sides);
  for (int k = 0; k < 2; k++) {
    all.edges[k] = scratch->question.edges ? all.sides[k].from->edge_count : 0;
    all.points[k] = scratch->question.start ? all.sides[k].from->point_count : 0;
  }
  return all;
}

size_t scree_depth_count(const scree_world *world, const scree_pair *pair,
                         const scree_scratch *scratch) {
  if (!scree_asks_depths(&scratch->question)) return 0;
  entries all = entries_of(world, pair, scratch);
  return all.edges[0] + all.edges[1] + all.points[0] + all.points[1];
}

scree_depth scree_depth_of(const scree_world *world, const scree_pair *pair,
                           const scree_scratch *scratch, size_t entry) {
  const entries all = entries_of(world, pair, scratch);
  const double above = scratch->question.above;
  for (int k = 0; k < 2; k++) {
    const side *sd = &all.sides[k];
    if (entry < all.edges[k])
      return is_solid(sd->to)
                 ? find_deepest(sd, &sd->from->edges[sd->from->edge_tree.order[entry]], above)
                 : (scree_depth){.depth = above};
    entry -= all.edges[k];
  }
  int k = entry >= all.points[0];
  return (scree_depth){.depth = depth_of_corner(&all.sides[k], entry - (k ? all.points[0] : 0))};
}

void scree_pair_take_depths(const scree_world *world, scree_pair *pair, const scree_depth *found,
                            scree_scratch *scratch, scree_pair_work *work) {
  const entries all = entries_of(world, pair, scratch);
  double start = 0, depth = scratch->question.above;
  for (int k = 0; k < 2; k++) {
    const side *sd = &all.sides[k];
    for (size_t i = 0; i < all.edges[k]; i++, found++) {
      const scree_edge *edge = &sd->from->edges[sd->from->edge_tree.order[i]];
      double own = touch_edge(sd, pair, edge, scratch->question.above, found, scratch);
      depth = scree_max(depth, own);
    }
  }
  for (size_t i = 0; i < all.points[0] + all.points[1]; i++)
    start = scree_max(start, found[i].depth);
  answer(pair, start, depth, scratch, work);
}
