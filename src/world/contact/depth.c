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
 * Nothing lies inside unless the surfaces cross. Along an edge the distance from one face is
 * convex, so that it lies below its chord, and the distance from the surface below the chords of
 * the faces that are nearest at both ends of a stretch: where these meet is the next place to look
 * at, until no chord lies above the deepest place that is known. */
#include "world/broad/candidates.h"
#include "world/contact/contact.h"
#include "world/contact/law.h"
#include "world/contact/overlap.h"

#include "particle/closest.h"

/* Points of a mesh are looked for in the other from the start: corners, drawn towards the centre.
 */
static const double drawn_in[] = {0.9, 0.5, 0};
enum { MOST_STRETCHES = 64, DRAWN_COUNT = sizeof drawn_in / sizeof *drawn_in };

/* The edges of one body against the surface of the other. */
typedef struct side {
  const scree_particle *from, *to;
  mat3 rotation; /* from's frame into to's */
  vec3 shift;
  double sharing;
  bool of_a;
} side;

static void make_sides(const scree_world *world, const scree_pair *pair,
                       const scree_frame *relative, side sides[2]) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  mat3 back = mat3_transpose(&relative->rotation);
  sides[0] = (side){a, b, relative->rotation, relative->position, world->options.sharing, true};
  sides[1] = (side){
      b, a, back, vec3_neg(mat3_mul_vec(&back, relative->position)), world->options.sharing, false};
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

/* False where nothing of the edge lies within the box. */
static bool make_line(const side *sd, const scree_edge *edge, double above, line *l) {
  *l = (line){vec3_add(mat3_mul_vec(&sd->rotation, edge->start), sd->shift),
              mat3_mul_vec(&sd->rotation, edge->along), 0, edge->length};
  scree_box box = scree_box_grown(sd->to->face_tree.nodes[0].box, -above);
  return scree_box_cut(&box, l->start, l->along, &l->from, &l->to);
}

static vec3 at_of(const line *l, double s) {
  return vec3_mad(l->start, l->along, s);
}

static double face_distance(const scree_particle *to, uint32_t face, vec3 p) {
  int region;
  return vec3_distance(p, scree_closest_on_face(&to->faces[face], p, &region));
}

/* A place on the line, its distance from the surface, and the face that is nearest. */
typedef struct place {
  double s, distance;
  uint32_t face;
} place;

/* `near` and `other` are faces that are likely near. */
static place place_at(const scree_particle *to, const line *l, double s, uint32_t near,
                      uint32_t other) {
  const uint32_t root = 0;
  vec3 p = at_of(l, s);
  place here = {s, face_distance(to, near, p), near};
  double of_other = other == near ? here.distance : face_distance(to, other, p);
  if (of_other < here.distance) here = (place){s, of_other, other};
  double nearer = scree_nearest_face(to, &root, 1, p, here.distance, &here.face);
  here.distance = scree_smaller(nearer, here.distance);
  return here;
}

/* Part of the line that lies inside. */
typedef struct stretch {
  place low, high;
} stretch;

/* Where the chords of the nearest faces at both ends meet, and how far from the surface the stretch
 * is at most. */
static double chords_meet(const scree_particle *to, const line *l, const stretch *in,
                          double *most) {
  const place *low = &in->low, *high = &in->high;
  double rise = face_distance(to, high->face, at_of(l, low->s)) - low->distance,
         fall = face_distance(to, low->face, at_of(l, high->s)) - high->distance;
  if (low->face == high->face || !(rise + fall > 0)) {
    *most = scree_larger(low->distance, high->distance);
    return low->s;
  }
  double share = rise / (rise + fall);
  *most = low->distance + (high->distance + fall - low->distance) * share;
  return low->s + (high->s - low->s) * share;
}

static void keep_deeper(const place *here, place *deepest) {
  if (here->distance > deepest->distance) *deepest = *here;
}

static void search(const scree_particle *to, const line *l, const stretch *whole, place *deepest) {
  stretch stack[MOST_STRETCHES];
  int count = 0, looked_at = 0;
  stack[count++] = *whole;
  while (count > 0 && looked_at++ < MOST_STRETCHES) {
    const stretch in = stack[--count];
    double most, s = chords_meet(to, l, &in, &most);
    if (!(most > deepest->distance * (1 + depth_tolerance)) || !(s > in.low.s && s < in.high.s))
      continue;
    place here = place_at(to, l, s, in.low.face, in.high.face);
    keep_deeper(&here, deepest);
    if (count + 2 > MOST_STRETCHES) continue;
    stack[count++] = (stretch){in.low, here};
    stack[count++] = (stretch){here, in.high};
  }
}

/* From `low` to `high`, of which those where the line passes through the surface are known: `ends`
 * of them. No point is deeper than its way from there. */
static void search_between(const scree_particle *to, const line *l, stretch in, const bool known[2],
                           place *deepest) {
  int ends = known[0] + known[1];
  if (ends && (in.high.s - in.low.s) / ends <= deepest->distance) return;
  if (!known[0]) in.low = place_at(to, l, in.low.s, in.high.face, in.high.face);
  if (!known[1]) in.high = place_at(to, l, in.high.s, in.low.face, in.low.face);
  keep_deeper(&in.low, deepest);
  keep_deeper(&in.high, deepest);
  search(to, l, &in, deepest);
}

/* The deepest place of the line inside, where it is deeper than `deepest`. */
static void search_inside(const scree_particle *to, const line *l, place *deepest) {
  const size_t none = SIZE_MAX;
  scree_ray_interval way = {l->start, l->along, l->from, l->to};
  stretch in = {.low = {.s = l->from}};
  bool known[2] = {false, true}, entered = false;
  while (known[1]) {
    uint32_t face = in.low.face;
    double s = scree_next_passage(to, &way, 0, none, &face);
    known[1] = s < INFINITY;
    in.high = (place){known[1] ? s : l->to, 0, face};
    bool inside = entered;
    if (known[1])
      inside = vec3_dot(to->faces[face].normal, l->along) > 0;
    else if (!known[0])
      inside = scree_is_inside(to, at_of(l, 0.5 * (l->from + l->to)));
    if (inside) search_between(to, l, in, known, deepest);
    entered = known[1] && !inside;
    in.low = in.high;
    known[0] = true;
    way.after = s;
  }
}

/* The slope of the depth: of the nearest faces those along which it grows most and falls most. */
static vec3 slope_at(const scree_particle *to, const line *l, const place *deepest) {
  scree_near near;
  vec3 p = at_of(l, deepest->s), up = {0, 0, 0}, down = {0, 0, 0};
  double most = -INFINITY, least = INFINITY;
  scree_closest_faces(to, p, INFINITY, 10 * depth_tolerance * deepest->distance, &near);
  for (int k = 0; k < near.count; k++) {
    int region;
    const scree_face *face = &to->faces[near.face[k]];
    vec3 slope = vec3_unit(vec3_sub(p, scree_closest_on_face(face, p, &region)));
    double rate = vec3_dot(slope, l->along);
    if (rate > most) most = rate, up = slope;
    if (rate < least) least = rate, down = slope;
  }
  if (!(most > 0 && least < 0)) return fabs(most) < fabs(least) ? up : down;
  double share = most / (most - least); /* the edge's own rate is 0 there */
  return vec3_add(vec3_scale(up, 1 - share), vec3_scale(down, share));
}

/* Least distance between a segment and a face's borders. */
static double border_distance(const scree_face *face, vec3 start, vec3 along, double length) {
  const vec3 sides[3] = {face->along1, vec3_sub(face->along2, face->along1),
                         vec3_neg(face->along2)};
  double least = INFINITY;
  vec3 corner = face->corner;
  for (int k = 0; k < 3; k++) {
    double s, t, size = vec3_norm(sides[k]);
    vec3 border = vec3_scale(sides[k], 1 / size);
    scree_closest_on_segments(start, along, length, corner, border, size, &s, &t);
    least =
        scree_smaller(least, vec3_distance(vec3_mad(start, along, s), vec3_mad(corner, border, t)));
    corner = vec3_add(corner, sides[k]);
  }
  return least;
}

/* Least distance of the line from the surface where it is below `reach`; else that. */
static double line_distance(const scree_particle *to, const line *l, double reach) {
  const scree_tree *tree = &to->face_tree;
  vec3 ends[2] = {at_of(l, l->from), at_of(l, l->to)};
  scree_tree_walk walk;
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    scree_box within = scree_box_grown(scree_box_of(ends[0], ends[1]), reach);
    if (!scree_box_meets(&within, &node->box) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t k = 0; k < node->count; k++) {
      uint32_t face = tree->order[node->first + k];
      for (int e = 0; e < 2; e++) reach = scree_smaller(reach, face_distance(to, face, ends[e]));
      reach = scree_smaller(reach,
                            border_distance(&to->faces[face], ends[0], l->along, l->to - l->from));
    }
  }
  return reach;
}

/* The deepest point of an edge where it is deeper than `above`; else no deeper than that. */
static scree_depth find_deepest(const side *sd, const scree_edge *edge, double above) {
  line l;
  if (!make_line(sd, edge, above, &l)) return (scree_depth){.depth = above};
  place deepest = {.distance = scree_max(above, 0)};
  double least = deepest.distance;
  search_inside(sd->to, &l, &deepest);
  if (deepest.distance > least)
    return (scree_depth){deepest.s, deepest.distance, slope_at(sd->to, &l, &deepest)};
  return (scree_depth){.depth = above < 0 ? -line_distance(sd->to, &l, -above) : above};
}

/* ---- the edges of a pair ---- */

/* A place among the contacts of depths: a new one, or that of the least deep. */
static bool make_place(scree_scratch *scratch, double overlap) {
  scree_contact_point *contacts = scratch->contacts.items;
  size_t count = scratch->contacts.count, depths = 0, least = count;
  for (size_t i = count; i > 0 && contacts[i - 1].of_depth; i--, depths++)
    if (least == count || contacts[i - 1].overlap < contacts[least].overlap) least = i - 1;
  if (depths < SCREE_DEPTHS) return true;
  if (contacts[least].overlap >= overlap) return false;
  contacts[least] = contacts[--scratch->contacts.count];
  return true;
}

static void add_depth(const side *sd, scree_pair *pair, vec3 p, const scree_depth *deep,
                      scree_scratch *scratch) {
  /* where features feel as much it counts for nothing: o <= t */
  const scree_blend blend = scree_blend_at(&pair->law, sd->sharing, deep->depth);
  double gap_gradient = vec3_norm(deep->slope), overlap = deep->depth - blend.width;
  bool slopes = gap_gradient > 1e-6; /* in the midst of a wall it is as deep however it moves */
  vec3 out = slopes ? vec3_scale(deep->slope, -1 / gap_gradient) : (vec3){0, 0, 1},
       at = vec3_mad(p, out, deep->depth - pair->law.smoothing);
  const double values[4] = {-overlap, 0, 0, 1};
  if (!make_place(scratch, overlap)) return;
  if (!sd->of_a) {
    at = mat3_tmul_vec(&sd->rotation, vec3_sub(p, sd->shift));
    out = vec3_neg(mat3_tmul_vec(&sd->rotation, out));
  }
  size_t count = scratch->contacts.count;
  scree_add_contact(scratch, pair, at, out, values, &scratch->no_anchor);
  if (scratch->contacts.count == count) return;
  scree_contact_point *contact = &scratch->contacts.items[count];
  contact->gap_gradient = slopes ? (1 - blend.slope) * gap_gradient : 0;
  contact->of_depth = true;
}

/* Adds an edge as a touch whose deepest point lies deeper than `above`; answers that depth, or
 * `above`. */
static double contact_edge(const side *sd, scree_pair *pair, const scree_edge *edge, double above,
                           const scree_depth *deep, scree_scratch *scratch) {
  if (!(deep->depth > above)) return above;
  if (!(deep->depth > 0)) return deep->depth;
  vec3 along = vec3_mad(edge->start, edge->along, deep->s),
       p = vec3_add(mat3_mul_vec(&sd->rotation, along), sd->shift);
  /* where a core is folded it passes through itself */
  if (deep->depth > pair->law.smoothing && !scree_is_inside(sd->to, p)) return above;
  add_depth(sd, pair, p, deep, scratch);
  return deep->depth;
}

/* Whether all that lies in the ball is outside, and farther from the surface than `beyond`. */
static bool is_outside(const scree_particle *to, vec3 centre, double radius, double beyond) {
  return !scree_is_near(to, centre, radius + beyond) && !scree_is_inside(to, centre);
}

static double contact_side(const side *sd, scree_pair *pair, double above, scree_scratch *scratch) {
  if (!sd->from->edge_count || !is_solid(sd->to)) return above;
  const scree_tree *tree = &sd->from->edge_tree;
  scree_box within = scree_box_grown(sd->to->face_tree.nodes[0].box, -above);
  double deepest = above;
  scree_tree_walk walk;
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    scree_box box = scree_box_moved(&node->box, &sd->rotation, sd->shift);
    if (!scree_box_meets(&box, &within)) continue;
    vec3 centre = vec3_scale(vec3_add(box.low, box.high), 0.5);
    double radius = 0.5 * vec3_distance(node->box.low, node->box.high);
    if (is_outside(sd->to, centre, radius, scree_max(-above, 0)) || scree_tree_enter(&walk, node))
      continue;
    for (uint32_t k = 0; k < node->count; k++) {
      const scree_edge *edge = &sd->from->edges[tree->order[node->first + k]];
      scree_depth deep = find_deepest(sd, edge, above);
      deepest = scree_max(deepest, contact_edge(sd, pair, edge, above, &deep, scratch));
    }
  }
  return deepest;
}

double scree_depth_contacts(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                            double above, scree_scratch *scratch) {
  side sides[2];
  make_sides(world, pair, relative, sides);
  double of_a = contact_side(&sides[0], pair, above, scratch);
  return scree_max(of_a, contact_side(&sides[1], pair, above, scratch));
}

vec3 scree_separation_off_rims(const scree_world *world, const scree_pair *pair,
                               const scree_frame *relative) {
  side sides[2];
  vec3 way = {0, 0, 0};
  make_sides(world, pair, relative, sides);
  const side *sd = &sides[1];
  for (size_t i = 0; i < sd->from->edge_count; i++) {
    const scree_edge *edge = &sd->from->edges[i];
    if (!scree_is_rim(edge)) continue;
    scree_depth deep = find_deepest(sd, edge, 0);
    way = vec3_mad(way, edge->normals.axis, deep.depth);
  }
  return way;
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

/* The depth of a drawn-in corner, or of a sphere: of bodies that were made in each other no edge
 * need be inside. */
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

/* Nothing lies inside: what features that hold the bodies remember is from the wrong side. Points
 * keep to their side of a disc or cylinder. */
static void start_anew(const scree_pair *pair, scree_scratch *scratch) {
  for (uint32_t i = 0; i < pair->active.count; i++) {
    scree_feature_pair *feature = &scratch->features[i];
    if (feature->kind == SCREE_FEATURE_POINT_WALL) continue;
    *feature = (scree_feature_pair){.kind = feature->kind, .a = feature->a, .b = feature->b};
  }
  scratch->contacts.count = 0;
}

/* What the features feel. */
static scree_smooth_maximum felt_overlap(const scree_world *world, const scree_pair *pair,
                                         const scree_contact_list *contacts) {
  scree_smooth_maximum felt;
  if (scree_find_smooth_maximum(&pair->law, world->options.sharing, contacts, &felt)) return felt;
  return (scree_smooth_maximum){.cutoff = -pair->law.smoothing};
}

/* Bodies that part are apart here: once they are pushed, where their springs would hardly press;
 * before, where they are no deeper than their springs tell, up to the limit: so one is wedged in
 * the other. */
static double apart_depth(const scree_pair *pair) {
  const double reach = pair->law.reach,
               told = scree_min(pair->contact.overlap, pair->law.limit) - reach;
  return scree_is_pushed(pair) ? -apart_share * reach : scree_max(0, told);
}

/* But for what they came in by since the last step, in which they were not seen. */
static void note_start(const scree_pair *pair, double depth, scree_pair_work *work) {
  if (pair->list.eased > 0) return; /* they were joined */
  const double least = scree_max(start_share * pair->law.limit, pair->law.reach);
  if (depth > least + pair->list.travel) work->start_depth = scree_max(work->start_depth, depth);
}

/* How far apart the cores are, by features that meet from outside, less what these may be off by.
 */
static double gap_of_cores(const scree_pair *pair, const scree_scratch *scratch) {
  double touching = scree_min(scratch->found.least_gap, 0); /* what sleeps is farther */
  return scree_max(0, touching + (1 - near_share) * pair->law.reach + pair->law.smoothing);
}

/* Whether the cores were so far apart before the step that they cannot have met in it. */
static bool stay_apart(const scree_pair *pair, const scree_scratch *scratch) {
  double before = scratch->before.asleep ? (near_share - 1) * pair->law.reach : pair->depth;
  return !pair->depenetrating && !scratch->found.any_inside && !scratch->found.question.start &&
         before + pair->list.travel <= 0;
}

/* How far a point of body a can have come in b since the last look, whatever the lists hold. */
static double way_since(const scree_particle *a, const scree_scratch *scratch) {
  const scree_frame *relative = &scratch->relative;
  vec3 turning = vec3_cross(relative->spin, relative->position);
  return scratch->drift * (vec3_norm(vec3_add(relative->velocity, turning)) +
                           a->measures.bounding_radius * vec3_norm(relative->spin));
}

/* Bodies that part, and at `least` so deep, need no look. */
static bool part_still(const scree_pair *pair, double least) {
  return scree_is_pushed(pair) && least > (1 - depenetration_look_share) * pair->apart.found &&
         least > 0;
}

void scree_pair_ask_depths(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  scree_depth_question *question = &scratch->found.question;
  *question = (scree_depth_question){0};
  if (!b) return;
  question->start = scree_pair_is_new(pair);
  if (!scree_knows_depths(a, b)) return;
  double least = pair->depth - way_since(a, scratch);
  if (!question->start && part_still(pair, least)) {
    pair->depth = least;
    return;
  }
  if (!b->face_count) { /* rims alone are felt by features until they part */
    question->edges = pair->depenetrating;
    question->above = apart_depth(pair);
    return;
  }
  if (stay_apart(pair, scratch)) {
    pair->depth = -gap_of_cores(pair, scratch);
    return;
  }
  scree_smooth_maximum felt = felt_overlap(world, pair, &scratch->contacts);
  double above = felt.value, /* what lies lower counts for nothing */
      near = near_share * pair->law.reach;
  const double limit = pair->law.limit;
  if (felt.value > most_pressed * limit) pair->depenetrating = true;
  if (felt.value > sure_pressed * limit && !b->sheet) question->claimed = sure_share * felt.value;
  if (!pair->depenetrating && question->claimed == 0 && pair->depth > -INFINITY &&
      pair->depth + pair->list.travel < above) {
    pair->depth += pair->list.travel;
    return;
  }
  question->above = pair->depenetrating ? apart_depth(pair) : scree_max(0, above - near);
  if (question->claimed > 0) question->above = scree_min(question->above, question->claimed);
  question->edges = pair->depenetrating || scree_surfaces_cross(a, b, &scratch->relative);
  if (!question->edges) pair->depth = -gap_of_cores(pair, scratch);
  if (!question->edges && question->claimed > 0) pair->depenetrating = true;
}

/* Bodies are apart where their edges are; from a sheet, which has no inside, where it does not pass
 * through the body beside its rims either. */
static bool are_apart(const scree_world *world, const scree_pair *pair,
                      const scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  if (pair->depth > apart_depth(pair)) return false;
  return !b->sheet || !scree_surfaces_cross(a, b, &scratch->relative);
}

static void answer(const scree_world *world, scree_pair *pair, double start, double depth,
                   scree_scratch *scratch, scree_pair_work *work) {
  const scree_depth_question *question = &scratch->found.question;
  if (question->start) note_start(pair, start, work);
  if (!question->edges) return;
  pair->depth = pair->apart.found = depth;
  scratch->counters.depth_queries++;
  if (question->start) note_start(pair, pair->depth, work);
  const bool misled = pair->depth <= question->claimed && question->claimed > 0;
  if (misled) pair->depenetrating = true;
  if (!pair->depenetrating || !are_apart(world, pair, scratch)) return;
  const bool pushed = scree_is_pushed(pair);
  pair->depenetrating = false;
  if (!pushed && !misled) return; /* wedged */
  pair->was_depenetrating = true;
  pair->apart.direction = (vec3){0, 0, 0};
  start_anew(pair, scratch);
  work->let_go = pair->contact.elastic + pair->substeps.elastic_since; /* of the last step */
}

void scree_pair_find_depths(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                            scree_pair_work *work) {
  const scree_depth_question *question = &scratch->found.question;
  const scree_frame *relative = &scratch->relative;
  double start = question->start ? start_depth(world, pair, relative) : 0, depth = 0;
  if (question->edges)
    depth = scree_depth_contacts(world, pair, relative, question->above, scratch);
  answer(world, pair, start, depth, scratch, work);
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
    all.edges[k] = scratch->found.question.edges ? all.sides[k].from->edge_count : 0;
    all.points[k] = scratch->found.question.start ? all.sides[k].from->point_count : 0;
  }
  return all;
}

size_t scree_depth_count(const scree_world *world, const scree_pair *pair,
                         const scree_scratch *scratch) {
  if (!scree_asks_depths(&scratch->found.question)) return 0;
  entries all = entries_of(world, pair, scratch);
  return all.edges[0] + all.edges[1] + all.points[0] + all.points[1];
}

scree_depth scree_depth_of(const scree_world *world, const scree_pair *pair,
                           const scree_scratch *scratch, size_t entry) {
  const entries all = entries_of(world, pair, scratch);
  const double above = scratch->found.question.above;
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
  double start = 0, depth = scratch->found.question.above;
  for (int k = 0; k < 2; k++) {
    const side *sd = &all.sides[k];
    for (size_t i = 0; i < all.edges[k]; i++, found++) {
      const scree_edge *edge = &sd->from->edges[sd->from->edge_tree.order[i]];
      double own = contact_edge(sd, pair, edge, scratch->found.question.above, found, scratch);
      depth = scree_max(depth, own);
    }
  }
  for (size_t i = 0; i < all.points[0] + all.points[1]; i++)
    start = scree_max(start, found[i].depth);
  answer(world, pair, start, depth, scratch, work);
}
