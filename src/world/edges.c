/* Edge against edge: signed overlap, normal and contact point of one item.
 *
 * Closest points of the segments; while apart, direction and distance are theirs. Deeper, the
 * crossing normal: which of the two the normals of the faces say where only one is a normal of both
 * edges, else (two blades) the reference kept from outside. A crossing counts deep down when it was
 * seen to come about from outside ("armed"), or where the pair presses that way already and deeper:
 * an edge that comes in behind a corner was last seen from the wrong side. It counts as far as its
 * normal is one of both edges: edges that slid around a corner inside each other would claim any
 * depth. Nearly parallel edges have no crossing: their ends, which are points against faces, stand
 * for them; the weight fades below sin = 4e-3.
 *
 * Ends. A crossing that was seen from outside has a weight that fades within a tenth of the
 * roundings, since the corners there take over. One that came in behind a corner, which may be
 * outside again, has an overlap that tapers to nothing, over a way as long as itself, and the force
 * is the slope of what is left. */
#include "world/world.h"

#include "particle/closest.h"

static const double parallel_sines[2] = {1e-3, 4e-3};
static const double beyond_cosines[2] = {0.8660254, 0.9659258}; /* 30 and 15 degrees */
static const double beyond_sines[2] = {0.5, 0.2588190};
static const double crossing_cosines[2] = {0.3, 0.6}; /* crossing normal against the reference */
static const double beside_cosines[2] = {-0.6, -0.3}; /* the way out against the reference */
static const double pressing_cosine = 0.2;            /* 78 degrees */
/* of the slack of cones, and of twice that */
static const double slack_cosines[2] = {0.9982005, 0.9928086};
static const double slack_sines[2] = {0.0599640, 0.1197122};
static const double end_shares[2] = {0.1, 1};

/* Closest points of a pair's two edges, in the frame of b. */
typedef struct crossing {
  const scree_edge *ea, *eb;
  vec3 on_a, on_b, offset; /* from on_b to on_a */
  double distance;
  /* Where the points lie within both edges, and these are not parallel: */
  double end;          /* way from the nearest end to the plane of the other edge and `across` */
  vec3 ua, ub;         /* along the edges, unit */
  bool of_a, at_start; /* which end that is */
  vec3 across;         /* unit, to both edges */
  double sine;         /* of the angle between the edges */
  vec3 axis_a;         /* outward at the edge of a */
} crossing;

/* From the ends: s and t along the edges. */
static void measure_ends(crossing *x, double s, double t) {
  double far_s = x->ea->length - s, far_t = x->eb->length - t, end_a = s < far_s ? s : far_s,
         end_b = t < far_t ? t : far_t;
  x->of_a = end_a < end_b;
  x->at_start = x->of_a ? s < far_s : t < far_t;
  x->end = (x->of_a ? end_a : end_b) * x->sine;
}

/* Along which the way from the nearest end grows as a moves. */
static vec3 inward(const crossing *x) {
  vec3 u = x->of_a ? x->ua : x->ub, other = x->of_a ? x->ub : x->ua;
  double sign = x->of_a == x->at_start ? -1 : 1;
  return vec3_scale(vec3_mad(u, other, -vec3_dot(u, other)), sign / x->sine);
}

/* The closest points; whether they lie within both edges, as far as that can matter. */
static bool find_crossing(const scree_world *world, const scree_pair *pair, const scree_item *item,
                          const scree_frame *relative, crossing *x) {
  x->ea = &world->bodies.particle[pair->a]->edges[item->a];
  x->eb = &scree_pair_shape_b(world, pair)->edges[item->b];
  const mat3 *r = &relative->rotation;
  vec3 p = vec3_add(mat3_mul_vec(r, x->ea->start), relative->position);
  x->ua = mat3_mul_vec(r, x->ea->along);
  x->ub = x->eb->along;
  double s, t;
  scree_closest_on_segments(p, x->ua, x->ea->length, x->eb->start, x->ub, x->eb->length, &s, &t);
  x->on_a = vec3_mad(p, x->ua, s);
  x->on_b = vec3_mad(x->eb->start, x->ub, t);
  x->offset = vec3_sub(x->on_a, x->on_b);
  x->distance = vec3_norm(x->offset);
  bool heard = x->distance < pair->reach + pair->smoothing + scree_pair_claim(pair);
  if (!(heard || item->inside)) return false;
  vec3 across = vec3_cross(x->ua, x->ub);
  x->sine = vec3_norm(across);
  bool within = s > 0 && s < x->ea->length && t > 0 && t < x->eb->length;
  if (!within || x->sine <= parallel_sines[0]) return false;
  x->across = vec3_scale(across, 1 / x->sine);
  x->axis_a = mat3_mul_vec(r, x->ea->normals.axis);
  measure_ends(x, s, t);
  return true;
}

/* How far a direction with this cosine from the edge's outward one is a normal of the edge: 1
 * between those of its two faces and 15 degrees beyond, 0 from 30 degrees beyond. */
static double normal_share(const scree_edge *edge, double cosine) {
  const scree_cone *n = &edge->normals;
  double none = n->cosine * beyond_cosines[0] - n->sine * beyond_sines[0],
         full = n->cosine * beyond_cosines[1] - n->sine * beyond_sines[1];
  return scree_smooth_step(none, full, cosine);
}

/* How far a normal, towards a, is one of both edges. */
static double common_share(const crossing *x, vec3 n) {
  return normal_share(x->ea, -vec3_dot(x->axis_a, n)) *
         normal_share(x->eb, vec3_dot(x->eb->normals.axis, n));
}

/* How far two edges have normals in common, by the cones of these: lists leave out edges whose
 * cones, widened by the slack each, do not meet, and while a list holds bodies turn by no more than
 * the slack. So 0 from the slack beyond the cones' meeting on, whatever the lists hold. */
static double facing_share(const crossing *x) {
  const scree_cone *a = &x->ea->normals, *b = &x->eb->normals;
  double cosine = a->cosine * b->cosine - a->sine * b->sine,
         sine = a->sine * b->cosine + a->cosine * b->sine;
  if (sine <= 0) return 1; /* together more than half around */
  double none = cosine * slack_cosines[0] + sine * slack_sines[0],
         full = cosine * slack_cosines[1] + sine * slack_sines[1];
  return scree_smooth_step(none, full, -vec3_dot(x->axis_a, b->axis));
}

/* Below half the roundings: which of the two crossing normals is the way out the faces say where
 * only one of them is a normal of both edges. Edges of two blades may have it either way: there the
 * reference says it where it lies along the crossing normals; where it lies across them (of a
 * corner that came in beside the edge, for one) the faces do. Where the two disagree the weight
 * passes through 0 from one to the other. */
static vec3 way_out(const scree_item *item, const crossing *x, double *weight) {
  double toward = vec3_dot(x->across, item->reference),
         facing = vec3_dot(x->across, x->eb->normals.axis) - vec3_dot(x->across, x->axis_a);
  vec3 back = vec3_neg(x->across);
  if ((toward < 0) != (facing < 0)) {
    double one = common_share(x, x->across), other = common_share(x, back),
           doubt = one > 0 && other > 0 ? 2 * fmin(one, other) / (one + other) : 0,
           known =
               doubt * scree_smooth_step(crossing_cosines[0], crossing_cosines[1], fabs(toward));
    *weight *= fabs(2 * known - 1);
    if (known < 0.5) toward = facing;
  }
  return toward < 0 ? back : x->across;
}

/* Whether edges that claim to have crossed deeply have: a closest point lies in the other body. The
 * claim is stale when the edges went around each other instead. */
static bool is_crossed(const scree_world *world, const scree_pair *pair,
                       const scree_frame *relative, const crossing *x) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  if (!(a->measures.volume > 0)) return true; /* cannot tell */
  if (b->measures.volume > 0 && scree_is_inside(b, x->on_a)) return true;
  vec3 of_a = mat3_tmul_vec(&relative->rotation, vec3_sub(x->on_b, relative->position));
  return scree_is_inside(a, of_a);
}

/* What is left of `overlap` at this way from the end, and how it changes with either. */
typedef struct tapered {
  double overlap, by_overlap, by_end;
} tapered;

static tapered taper(double overlap, double end, double reach, double tapering) {
  double way = tapering * (end_shares[0] * reach + end_shares[1] * overlap);
  if (end >= way || overlap <= 0) return (tapered){overlap, 1, 0};
  double x = end / way;
  double share = x * (2 - x), rise = 2 * (1 - x) / way;
  return (tapered){overlap * share, share - overlap * x * rise * tapering * end_shares[1],
                   overlap * rise};
}

static void taper_touch(scree_touch *touch, const crossing *x, double reach, double tapering) {
  tapered left = taper(touch->overlap, x->end, reach, tapering);
  if (left.by_end == 0) return;
  vec3 slope = vec3_scale(touch->normal, left.by_overlap);
  slope = vec3_mad(slope, inward(x), -left.by_end); /* the overlap falls along it */
  touch->overlap = left.overlap;
  touch->lever = vec3_norm(slope);
  touch->normal = vec3_unit(slope);
}

/* How far edges that are inside crossed other than along the way on which they were seen apart. */
static double beside(const scree_item *item, vec3 normal) {
  return 1 -
         scree_smooth_step(beside_cosines[0], beside_cosines[1], vec3_dot(normal, item->reference));
}

/* Whether edges that were not seen to cross have: the normal from b to a is one of both only the
 * other way round, and that is the way in which the pair presses already, deeper than they do. So
 * do edges that come in behind a corner which leaves by another face. */
static bool is_met_from_behind(const scree_world *world, const scree_pair *pair,
                               const scree_item *item, const scree_frame *relative,
                               const crossing *x) {
  if (!pair->touching || !item->has_reference) return false;
  vec3 behind = vec3_scale(x->offset, -1 / x->distance);
  double aside = beside(item, behind),
         claimed = taper(pair->reach + x->distance, x->end, pair->reach, aside).overlap;
  if (claimed > pair->overlap) return false;
  if (!(common_share(x, behind) > 0) || common_share(x, vec3_neg(behind)) > 0) return false;
  const float *along = pair->tangential.force;
  vec3 force = vec3_sub(pair->wrench.force, (vec3){along[0], along[1], along[2]});
  force = mat3_tmul_vec(&scree_pair_frame_b(world, pair)->rotation, force);
  return vec3_dot(behind, force) > pressing_cosine * vec3_norm(force) &&
         is_crossed(world, pair, relative, x);
}

/* The way out is the present one. */
static void keep_reference(scree_item *item, vec3 normal) {
  item->reference = normal;
  item->has_reference = true;
}

/* No crossing: the edges' points speak for themselves. */
static void leave_to_points(const scree_pair *pair, scree_item *item, const crossing *x) {
  bool apart = x->distance > 0.5 * pair->reach;
  if (apart && !pair->touching) item->inside = false;
  if (apart && !item->inside) keep_reference(item, vec3_scale(x->offset, 1 / x->distance));
}

/* How a crossing touches: normal towards a, signed distance, weight, and whether its overlap tapers
 * or its weight fades towards the ends. */
typedef struct edge_contact {
  vec3 normal;
  double distance, weight, tapering;
} edge_contact;

/* False where the crossing does not count. */
static bool find_contact(const scree_world *world, const scree_pair *pair, scree_item *item,
                         const scree_frame *relative, const crossing *x, edge_contact *c) {
  double half = 0.5 * pair->reach;
  *c = (edge_contact){.normal = vec3_scale(x->offset, 1 / fmax(x->distance, 1e-300)),
                      .distance = x->distance};
  c->weight = scree_smooth_step(parallel_sines[0], parallel_sines[1], x->sine) * facing_share(x);
  bool behind = !item->inside && is_met_from_behind(world, pair, item, relative, x);
  if (item->inside || behind || x->distance < half) {
    if (!item->has_reference) return false; /* not armed */
    c->normal = way_out(item, x, &c->weight);
    c->distance = vec3_dot(x->offset, c->normal);
    bool armed = item->inside || behind ||
                 (c->distance >= -2 * pair->travel &&
                  vec3_dot(c->normal, item->reference) >= -crossing_cosines[0]);
    bool stale = c->distance < -pair->thin && !is_crossed(world, pair, relative, x);
    item->inside = armed && !stale && c->distance < half;
    if (!armed || stale) return false;
  }
  if (!item->inside) keep_reference(item, c->normal);
  double out_a = -vec3_dot(x->axis_a, c->normal), out_b = vec3_dot(x->eb->normals.axis, c->normal);
  if (out_a <= x->ea->facing || out_b <= x->eb->facing) return false; /* seen through a body */
  if (item->inside) {
    c->weight *= common_share(x, c->normal);
    c->tapering = beside(item, c->normal);
  }
  double fading = end_shares[0] * pair->reach * (1 - c->tapering) * x->sine;
  if (fading > 0) c->weight *= scree_smooth_step(0, fading, x->end);
  return true;
}

double scree_touch_edges(const scree_world *world, const scree_pair *pair, scree_item *item,
                         const scree_frame *relative, scree_scratch *scratch) {
  crossing x;
  edge_contact c;
  bool crosses = find_crossing(world, pair, item, relative, &x);
  double far = x.distance - pair->reach - pair->smoothing;
  bool heard = far < scree_pair_claim(pair) || item->inside;
  if (!heard)
    keep_reference(item, vec3_scale(x.offset, 1 / x.distance));
  else if (!crosses)
    leave_to_points(pair, item, &x);
  if (!crosses || !find_contact(world, pair, item, relative, &x, &c)) {
    item->anchor.share = 0;
    return heard ? fmin(far, 0) : far;
  }
  double rounding = world->bodies.particle[pair->a]->measures.rounding;
  const double values[4] = {c.distance, rounding, pair->reach - rounding, c.weight};
  size_t touches = scratch->touches.count;
  double gap = scree_add_touch(scratch, pair, x.on_b, c.normal, values, &item->anchor);
  if (scratch->touches.count > touches)
    taper_touch(&scratch->touches.items[touches], &x, pair->reach, c.tapering);
  return gap;
}
