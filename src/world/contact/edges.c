/* Edge against edge: signed overlap, normal and contact point of one feature pair.
 *
 * Closest points of the segments; while apart, direction and distance are theirs. Deeper, the
 * crossing normal: which of the two the normals of the faces say where only one is a normal of both
 * edges, else (two blades) the reference kept from outside. A crossing counts deep down when it was
 * seen to come about from outside ("armed"), where only one of the two normals is one of both edges
 * and a closest point lies in the other body as it begins, or where the pair presses that way
 * already: an edge that comes in behind a corner was last seen from the wrong side. It counts as
 * far as its normal is one of both edges: edges that slid around a corner inside each other would
 * claim any depth. Nearly parallel edges have no crossing: their ends, which are points against
 * faces, stand for them; the taper fades below sin = 4e-3.
 *
 * Ends, where crossings come and go. With e the way from an end to the plane of the other edge and
 * the normal, the taper fades within a tenth of contact radii and overlap from the nearest. What
 * the overlap has more than that of the corner at an end tapers over a way as long as itself: the
 * corner goes on alone, and is pushed out by the nearer face where the crossing asks for the whole
 * depth of the edge. The end that leaves least counts. Both slopes are in the force.
 *
 * A crossing that begins to count other than at its ends, or had no normal of both edges, does so
 * from nothing, or from what the pair has already: what is more is held back, until the edges are
 * apart. */
#include "world/broad/candidates.h"
#include "world/contact/contact.h"
#include "world/contact/law.h"

#include "particle/closest.h"

/* An end of one of the two edges. */
typedef struct edge_end {
  bool of_a, at_start;
  double way; /* to the plane of the other edge and `across` */
} edge_end;

/* Closest points of a pair's two edges, in the frame of b. */
typedef struct crossing {
  const scree_edge *ea, *eb;
  vec3 on_a, on_b, offset; /* from on_b to on_a */
  double distance;
  /* Where the points lie within both edges, and these are not parallel: */
  vec3 ua, ub;    /* along the edges, unit */
  double ways[4]; /* from the start and the end of a's, and of b's */
  int nearest;    /* of these */
  vec3 across;    /* unit, to both edges */
  double sine;    /* of the angle between the edges */
  vec3 axis_a;    /* outward at the edge of a */
  const scree_frame *relative;
  double drift; /* s, since the last look */
} crossing;

/* The closest points lie at s and t along the edges. */
static void measure_ends(crossing *x, double s, double t) {
  x->ways[0] = s, x->ways[1] = x->ea->length - s;
  x->ways[2] = t, x->ways[3] = x->eb->length - t;
  x->nearest = 0;
  for (int k = 1; k < 4; k++)
    if (x->ways[k] < x->ways[x->nearest]) x->nearest = k;
}

static edge_end end_of(const crossing *x, int k) {
  return (edge_end){k < 2, k % 2 == 0, x->ways[k] * x->sine};
}

static double way_from_end(const crossing *x) {
  return x->ways[x->nearest] * x->sine;
}

/* By which a has come here since the last look. */
static double way_since(const crossing *x) {
  vec3 turning = vec3_cross(x->relative->spin, x->on_b);
  return x->drift * vec3_norm(vec3_add(x->relative->velocity, turning));
}

/* Along which the way from the end grows as a moves. */
static vec3 inward(const crossing *x, const edge_end *end) {
  vec3 u = end->of_a ? x->ua : x->ub, other = end->of_a ? x->ub : x->ua;
  double sign = end->of_a == end->at_start ? -1 : 1;
  return vec3_scale(vec3_mad(u, other, -vec3_dot(u, other)), sign / x->sine);
}

/* The closest points; whether they lie within both edges, as far as that can matter. */
static bool find_crossing(const scree_world *world, const scree_pair *pair,
                          const scree_feature_pair *feature, const scree_frame *relative,
                          crossing *x) {
  x->ea = &world->bodies.particle[pair->a]->edges[feature->a];
  x->eb = &scree_pair_shape_b(world, pair)->edges[feature->b];
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
  bool heard = x->distance < pair->law.reach + pair->law.smoothing + scree_pair_edge_reach(pair);
  if (!(heard || feature->inside)) return false;
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
static double normal_taper(const scree_edge *edge, double cosine) {
  const scree_cone *n = &edge->normals;
  double none = n->cosine * beyond_cosines[0] - n->sine * beyond_sines[0],
         full = n->cosine * beyond_cosines[1] - n->sine * beyond_sines[1];
  return scree_smooth_step(none, full, cosine);
}

/* How far a normal, towards a, is one of both edges. */
static double common_taper(const crossing *x, vec3 n) {
  return normal_taper(x->ea, -vec3_dot(x->axis_a, n)) *
         normal_taper(x->eb, vec3_dot(x->eb->normals.axis, n));
}

/* How far two edges have normals in common, by the cones of these: lists leave out edges whose
 * cones, widened by the slack each, do not meet, and while a list holds bodies turn by no more than
 * the slack. So 0 from the slack beyond the cones' meeting on, whatever the lists hold. */
static double facing_taper(const crossing *x) {
  const scree_cone *a = &x->ea->normals, *b = &x->eb->normals;
  double cosine = a->cosine * b->cosine - a->sine * b->sine,
         sine = a->sine * b->cosine + a->cosine * b->sine;
  if (sine <= 0) return 1; /* together more than half around */
  double none = cosine * slack_cosines[0] + sine * slack_sines[0],
         full = cosine * slack_cosines[1] + sine * slack_sines[1];
  return scree_smooth_step(none, full, -vec3_dot(x->axis_a, b->axis));
}

/* Below half the contact radii: which of the two crossing normals is the separation direction the
 * faces say where only one of them is a normal of both edges. Edges of two blades may have it
 * either way: there the reference says it where it lies along the crossing normals; where it lies
 * across them (of a corner that came in beside the edge, for one) the faces do. Where the two
 * disagree the taper passes through 0 from one to the other. */
static vec3 separation_side(const scree_feature_pair *feature, const crossing *x, double *taper) {
  double toward = vec3_dot(x->across, feature->reference),
         facing = vec3_dot(x->across, x->eb->normals.axis) - vec3_dot(x->across, x->axis_a);
  vec3 back = vec3_neg(x->across);
  if ((toward < 0) != (facing < 0)) {
    double one = common_taper(x, x->across), other = common_taper(x, back),
           doubt = one > 0 && other > 0 ? 2 * scree_min(one, other) / (one + other) : 0,
           known =
               doubt * scree_smooth_step(crossing_cosines[0], crossing_cosines[1], fabs(toward));
    *taper *= fabs(2 * known - 1);
    if (known < 0.5) toward = facing;
  }
  return toward < 0 ? back : x->across;
}

/* Whether edges that claim to have crossed deeply have: a closest point lies in the other body. The
 * claim is stale when the edges went around each other instead. Where an edge is so sharp that the
 * crossing's normal points back into no material, neither does. */
static bool is_crossed(const scree_world *world, const scree_pair *pair,
                       const scree_frame *relative, const crossing *x) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  if (!(a->measures.volume > 0)) return true; /* cannot tell */
  if (b->measures.volume > 0 && scree_is_inside(b, x->on_a)) return true;
  vec3 of_a = mat3_tmul_vec(&relative->rotation, vec3_sub(x->on_b, relative->position));
  return scree_is_inside(a, of_a);
}

/* Within this of an end the taper fades. */
static double fading_way(double overlap, double reach) {
  return scree_min(end_share * (reach + scree_max(overlap, 0)), 0.5 * reach);
}

/* The taper near an end, and how it falls. Of u = way/fading way the taper w = (kappa v/(1 -
 * (1 - kappa) v))^2 lets the pair's overlap fall as v = u (2 - u), if nothing else touches: of a w
 * that is a polynomial it would fall as 1/u, and all at once in the end. */
static void fade(scree_contact_point *contact, const crossing *x, double reach, double sharing) {
  double way = fading_way(contact->overlap, reach), grown = end_share * (reach + contact->overlap),
         end = way_from_end(x);
  if (end >= way) return;
  double kappa = scree_max(sharing, least_sharing), u = end / way, v = u * (2 - u),
         rest = 1 - (1 - kappa) * v, root = kappa * v / rest,
         fall = contact->taper * 4 * kappa * root * (1 - u) / (rest * rest * way),
         longer = contact->overlap > 0 && way == grown ? end_share * u : 0;
  edge_end nearest = end_of(x, x->nearest);
  vec3 along = inward(x, &nearest);
  contact->taper *= root * root;
  contact->fading = vec3_scale(vec3_mad(along, contact->normal, longer), -fall);
}

/* The overlap of the corner at an end with the faces at the other edge that look the separation
 * direction, and the way along which it falls as a moves; at most the crossing's. */
typedef struct corner {
  double overlap;
  vec3 slope;
} corner;

static corner corner_at_end(const scree_frame *relative, const crossing *x, const edge_end *end,
                            const scree_contact_point *contact, double reach) {
  const bool of_a = end->of_a;
  const scree_edge *own = of_a ? x->ea : x->eb, *other = of_a ? x->eb : x->ea;
  vec3 at = end->at_start ? own->start : own->end;
  if (of_a) at = vec3_add(mat3_mul_vec(&relative->rotation, at), relative->position);
  vec3 away = vec3_sub(at, of_a ? x->on_b : x->on_a), axis = of_a ? other->normals.axis : x->axis_a,
       side = vec3_cross(axis, of_a ? x->ub : x->ua),
       out = of_a ? contact->normal : vec3_neg(contact->normal);
  const scree_cone *n = &other->normals; /* without the slack: from face to face */
  double cosine = n->cosine * slack_cosines[0] + n->sine * slack_sines[0],
         sine = n->sine * slack_cosines[0] - n->cosine * slack_sines[0];
  corner least = {contact->overlap, out};
  for (int k = 0; k < 2; k++) {
    vec3 face = vec3_mad(vec3_scale(axis, cosine), side, k ? -sine : sine);
    double lies = scree_smooth_step(0, corner_facing_cosine, vec3_dot(face, out)),
           below = reach - vec3_dot(away, face),
           overlap = contact->overlap + lies * (below - contact->overlap);
    if (overlap >= least.overlap) continue;
    vec3 slope = vec3_mad(vec3_scale(out, 1 - lies), face, lies);
    least = (corner){overlap, slope};
  }
  if (least.overlap < 0) return (corner){0, {0, 0, 0}};
  return of_a ? least : (corner){least.overlap, vec3_neg(least.slope)};
}

/* Towards an end the overlap tapers to that of the corner there, over a way as long as what goes;
 * the force is the slope of what is left. */
static corner tapered(const scree_contact_point *contact, const scree_frame *relative,
                      const crossing *x, const edge_end *end, double reach) {
  const corner whole = {contact->overlap, contact->normal};
  if (end->way >= end_share * reach + contact->overlap) return whole;
  corner c = corner_at_end(relative, x, end, contact, reach);
  double excess = contact->overlap - c.overlap, way = end_share * reach + excess,
         t = end->way / way;
  if (t >= 1 || excess <= 0) return whole;
  double share = t * (2 - t), by_end = 2 * (1 - t) * excess / way, by_overlap = share - t * by_end;
  vec3 slope = vec3_mad(vec3_scale(contact->normal, by_overlap), c.slope, 1 - by_overlap);
  slope = vec3_mad(slope, inward(x, end), -by_end); /* the overlap falls along it */
  return (corner){c.overlap + excess * share, slope};
}

/* By all ends, of which more than one may be near: an overlap by the nearest alone would leap where
 * that changes. */
static void taper(scree_contact_point *contact, const scree_frame *relative, const crossing *x,
                  double reach) {
  if (contact->overlap <= 0 || way_from_end(x) >= end_share * reach + contact->overlap) return;
  corner least = {contact->overlap, contact->normal};
  for (int k = 0; k < 4; k++) {
    edge_end end = end_of(x, k);
    corner c = tapered(contact, relative, x, &end, reach);
    if (c.overlap < least.overlap) least = c;
  }
  if (!(least.overlap < contact->overlap)) return;
  contact->overlap = least.overlap;
  contact->gap_gradient = vec3_norm(least.slope);
  contact->normal = vec3_unit(least.slope);
}

/* Whether a direction with this cosine from the edge's outward one has a taper above 0. */
static bool has_normal(const scree_edge *edge, double cosine) {
  const scree_cone *n = &edge->normals;
  return cosine > n->cosine * beyond_cosines[0] - n->sine * beyond_sines[0];
}

/* Whether of a normal and its opposite only the former is one of both edges. */
static bool is_only_normal(const crossing *x, vec3 n) {
  double out_a = -vec3_dot(x->axis_a, n), out_b = vec3_dot(x->eb->normals.axis, n);
  return has_normal(x->ea, out_a) && has_normal(x->eb, out_b) &&
         !(has_normal(x->ea, -out_a) && has_normal(x->eb, -out_b));
}

/* Whether edges that were not seen to cross have: the normal from b to a is one of both only the
 * other way round, and that is the way in which the pair presses already. So do edges that come in
 * behind a corner which leaves by another face. */
static bool is_met_from_behind(const scree_world *world, const scree_pair *pair,
                               const scree_feature_pair *feature, const scree_frame *relative,
                               const crossing *x) {
  if (!pair->touching || !feature->has_reference) return false;
  vec3 behind = vec3_scale(x->offset, -1 / x->distance);
  if (!is_only_normal(x, behind)) return false;
  const float *along = pair->book.tangential.force;
  vec3 force = vec3_sub(pair->contact.wrench.force, (vec3){along[0], along[1], along[2]});
  force = mat3_tmul_vec(&scree_pair_frame_b(world, pair)->rotation, force);
  return vec3_dot(behind, force) > pressing_cosine * vec3_norm(force) &&
         is_crossed(world, pair, relative, x);
}

/* The separation direction is the present one. */
static void keep_reference(scree_feature_pair *feature, vec3 normal) {
  feature->reference = normal;
  feature->has_reference = true;
}

/* No crossing: the edges' points speak for themselves. */
static void leave_to_points(const scree_pair *pair, scree_feature_pair *feature,
                            const crossing *x) {
  bool apart = x->distance > 0.5 * pair->law.reach;
  if (apart && !pair->touching) feature->inside = false;
  if (apart && !feature->inside) keep_reference(feature, vec3_scale(x->offset, 1 / x->distance));
}

/* How a crossing touches. */
typedef struct edge_contact {
  vec3 normal;            /* towards a */
  double distance, taper; /* signed; but for the ends */
  double first;           /* of its overlap, what may count when it begins to */
} edge_contact;

/* Whether edges that were not seen to cross lie across each other all the same. */
static bool is_clear(const scree_world *world, const scree_pair *pair,
                     const scree_feature_pair *feature, const scree_frame *relative,
                     const crossing *x, const edge_contact *c) {
  if (!is_only_normal(x, c->normal)) return false;
  return c->distance >= 0 ||
         (feature->crossing == SCREE_CROSSING_NONE && is_crossed(world, pair, relative, x));
}

/* What may count at once of a crossing that begins to: all where it begins at an end, where
 * nothing is left of it, or where the pair is new. */
static double first_overlap(const scree_pair *pair, const scree_feature_pair *feature,
                            const crossing *x) {
  bool at_end = feature->crossing == SCREE_CROSSING_NONE &&
                way_from_end(x) <= end_share * pair->law.reach + 2 * way_since(x);
  return at_end || scree_pair_is_new(pair) ? INFINITY : 0;
}

/* A crossing whose cores are near each other or have met: false where it does not count. */
static bool find_deep_contact(const scree_world *world, const scree_pair *pair,
                              scree_feature_pair *feature, const scree_frame *relative,
                              const crossing *x, bool behind, edge_contact *c) {
  if (!feature->has_reference) return false; /* not armed */
  c->normal = separation_side(feature, x, &c->taper);
  c->distance = vec3_dot(x->offset, c->normal);
  bool apart = c->distance >= -2 * way_since(x),
       armed = feature->inside || behind ||
               (apart && vec3_dot(c->normal, feature->reference) >= -crossing_cosines[0]);
  if (!armed && is_clear(world, pair, feature, relative, x, c)) {
    keep_reference(feature, c->normal);
    armed = true;
  }
  /* one that counted is followed: of sharp edges the closest points need not lie in the others */
  bool stale = feature->crossing != SCREE_CROSSING_COUNTS && c->distance < -pair->law.thin &&
               !is_crossed(world, pair, relative, x);
  feature->inside = armed && !stale && c->distance < 0.5 * pair->law.reach;
  if (!apart && !scree_pair_is_new(pair)) c->first = 0;
  if (behind) /* what changes nothing */
    c->first = scree_max(
        c->first,
        pair->contact.overlap -
            scree_blend_at(&pair->law, world->options.sharing, pair->contact.overlap).width);
  return armed && !stale;
}

/* Whether edges passed each other since the last step, over more than half the contact radii. */
static bool has_leapt(const scree_feature_pair *feature, const crossing *x, const edge_contact *c) {
  return feature->has_reference && vec3_dot(c->normal, feature->reference) < 0 &&
         c->distance < way_since(x);
}

/* False where the crossing does not count. */
static bool find_contact(const scree_world *world, const scree_pair *pair,
                         scree_feature_pair *feature, const scree_frame *relative,
                         const crossing *x, edge_contact *c) {
  *c = (edge_contact){.normal = vec3_scale(x->offset, 1 / scree_max(x->distance, 1e-300)),
                      .distance = x->distance};
  if (feature->crossing != SCREE_CROSSING_COUNTS) c->first = first_overlap(pair, feature, x);
  c->taper = scree_smooth_step(parallel_sines[0], parallel_sines[1], x->sine) * facing_taper(x);
  bool behind = !feature->inside && is_met_from_behind(world, pair, feature, relative, x),
       deep = feature->inside || behind || x->distance < 0.5 * pair->law.reach ||
              has_leapt(feature, x, c);
  if (deep && !find_deep_contact(world, pair, feature, relative, x, behind, c)) return false;
  if (!feature->inside) keep_reference(feature, c->normal);
  double out_a = -vec3_dot(x->axis_a, c->normal), out_b = vec3_dot(x->eb->normals.axis, c->normal);
  if (out_a <= x->ea->facing || out_b <= x->eb->facing) return false; /* seen through a body */
  if (feature->inside) c->taper *= common_taper(x, c->normal);
  /* edges in each other's bodies that turn until they have a normal in common begin anew then */
  return c->taper > 0 || !feature->inside;
}

/* A crossing that begins to count in the midst of both edges does so from what `first` allows: the
 * rest is held back. What is held falls with the overlap, so that nothing is once they are apart.
 */
static void hold_back(const crossing *x, scree_feature_pair *feature, scree_contact_point *contact,
                      double first) {
  double overlap = scree_max(contact->overlap, 0);
  if (feature->crossing != SCREE_CROSSING_COUNTS) {
    bool outside = overlap <= 2 * way_since(x); /* a step ago */
    feature->held = outside ? 0 : scree_max(overlap - first, 0);
  }
  feature->held = scree_min(feature->held, overlap);
  contact->overlap -= feature->held;
}

double scree_edge_contact(const scree_world *world, const scree_pair *pair,
                          scree_feature_pair *feature, const scree_frame *relative,
                          scree_scratch *scratch) {
  crossing x = {.relative = relative, .drift = scratch->drift};
  edge_contact c;
  bool crosses = find_crossing(world, pair, feature, relative, &x);
  double far = x.distance - pair->law.reach - pair->law.smoothing;
  bool heard = far < scree_pair_edge_reach(pair) || feature->inside;
  if (!heard)
    keep_reference(feature, vec3_scale(x.offset, 1 / x.distance));
  else if (!crosses)
    leave_to_points(pair, feature, &x);
  if (!crosses || !find_contact(world, pair, feature, relative, &x, &c)) {
    feature->anchor.weight = 0;
    feature->crossing = crosses ? SCREE_CROSSING_REFUSED : SCREE_CROSSING_NONE;
    return heard ? scree_min(far, 0) : far;
  }
  double rounding = scree_pair_contact_radius(world, pair, false);
  const double values[4] = {c.distance, rounding, pair->law.reach - rounding, c.taper};
  size_t contacts = scratch->contacts.count;
  double gap = scree_add_contact(scratch, pair, x.on_b, c.normal, values, &feature->anchor);
  if (scratch->contacts.count > contacts) {
    scree_contact_point *contact = &scratch->contacts.items[contacts];
    fade(contact, &x, pair->law.reach, world->options.sharing);
    taper(contact, relative, &x, pair->law.reach);
    hold_back(&x, feature, contact, c.first);
  } else {
    feature->held = 0;
  }
  feature->crossing = SCREE_CROSSING_COUNTS;
  return gap;
}
