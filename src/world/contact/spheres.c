/* Spheres have one distance, one normal and one feature, which needs no lists, no memory of faces
 * and no depth: their overlap is that of the pair, and the normal force no moment. All is reckoned
 * in space, where the springs of sliding and rolling are kept too; they turn with the mean of both
 * bodies' rotations. Spring, slider and rolling are those of every pair (law.h), and what is left
 * of the step is a pair's (contact.c).
 *
 * There is a pair only while they touch. Neighbours that are apart sleep until the paths of their
 * centres could have brought them together. */
#include "world/contact/spheres.h"
#include "base/atomic.h"
#include "world/contact/contact.h"
#include "world/contact/law.h"
#include "world/state/walls.h"

/* Where they meet: so far from the centres of spheres, a's behind the normal, b's before it; from a
 * wall's position at `at`. All in space. */
typedef struct meeting {
  vec3 normal, at; /* normal: towards a */
  double of_a, of_b;
  double overlap; /* not above 0: they are apart, and all else is not known */
} meeting;

static double radius_of(const scree_world *world, uint32_t body) {
  return world->bodies.particle[body]->point_radii[0];
}

static meeting meet(vec3 between, double radius_a, double radius_b) {
  double distance = vec3_norm(between);
  meeting m = {.overlap = radius_a + radius_b - distance};
  if (!(m.overlap > 0)) return m;
  m.normal = distance > 0 ? vec3_scale(between, 1 / distance) : (vec3){0, 0, 1};
  m.of_a = radius_a - 0.5 * m.overlap;
  m.of_b = radius_b - 0.5 * m.overlap;
  return m;
}

static meeting meet_sphere(const scree_world *world, uint32_t a, uint32_t b) {
  const scree_frame *frames = world->bodies.frame;
  return meet(scree_nearest_image(world, vec3_sub(frames[a].position, frames[b].position)),
              radius_of(world, a), radius_of(world, b));
}

/* On this side of a sheet, 0: where it is. */
static meeting meet_wall(const scree_world *world, uint32_t a, const scree_world_wall *wall,
                         double *side) {
  const mat3 *turned = &wall->frame.rotation;
  vec3 p = mat3_tmul_vec(turned, vec3_sub(world->bodies.frame[a].position, wall->frame.position)),
       c, n;
  double distance = scree_wall_distance_from(wall, p, side, &c, &n), radius = radius_of(world, a);
  meeting m = {.overlap = radius - distance};
  if (!(m.overlap > 0)) return m;
  m.normal = mat3_mul_vec(turned, n);
  m.at = vec3_mad(mat3_mul_vec(turned, c), m.normal, -0.5 * m.overlap);
  m.of_a = radius - 0.5 * m.overlap;
  return m;
}

static double path_of(const scree_world *world, const scree_neighbours *n) {
  return world->bodies.path[n->a] + world->walls.items[n->b].path;
}

bool scree_spheres_stay_apart(scree_world *world, size_t k) {
  scree_neighbours *n = &world->list.neighbours.items[k];
  double side = 0;
  meeting m = meet_wall(world, n->a, &world->walls.items[n->b], &side);
  if (m.overlap > 0) return false;
  n->asleep = true;
  world->list.slots.items[k].wake = n->wake = path_of(world, n) - m.overlap;
  return true;
}

/* On which side of a sheet it was before: a step by which it woke may have taken it in. */
static double side_before(const scree_world *world, const scree_pair *pair) {
  if (!pair->wall) return 0;
  if (pair->sphere.side != 0 || !pair->asleep) return pair->sphere.side;
  const scree_frame *a = &world->bodies.frame[pair->a];
  const scree_world_wall *wall = &world->walls.items[pair->b];
  vec3 between = vec3_sub(a->position, wall->frame.position),
       v = vec3_sub(vec3_sub(a->velocity, wall->frame.velocity),
                    vec3_cross(wall->frame.spin, between)),
       before = mat3_tmul_vec(&wall->frame.rotation, vec3_mad(between, v, -2 * world->time_step));
  return scree_wall_side_at(wall, before);
}

/* Without what is along n. */
static vec3 across(vec3 v, vec3 n) {
  return vec3_mad(v, n, -vec3_dot(v, n));
}

/* A spring along the surface, turned by the angle r: to second order, by which its length stays. */
static vec3 turned_by(vec3 spring, vec3 r) {
  vec3 change = vec3_cross(r, spring);
  return vec3_add(spring, vec3_mad(change, vec3_cross(r, change), 0.5));
}

static void let_go(scree_pair *pair) {
  pair->touching = false;
  pair->contact.count = 0;
  pair->contact.elastic = pair->contact.tangential_elastic = pair->contact.overlap =
      pair->history.age = pair->book.kick = 0;
  pair->history.largest = 0;
  pair->book.spring = (scree_wrench){{0, 0, 0}, {0, 0, 0}};
  pair->history.rolled = pair->sphere.slid = (vec3){0, 0, 0};
}

/* All that the law is told of a touch. The velocities of a against b where they meet: of the last
 * drift, of the moment, and as dashpots see them. */
typedef struct touch {
  meeting at;
  scree_sphere_motion a, b;
  vec3 drift, now, seen;
  vec3 turned;        /* rad, by which both turned in the last drift, in the mean */
  vec3 along, couple; /* N, the tangential force on a; N m, the couple of rolling on a */
  double dashpot;     /* N, along the normal */
  double lead;        /* of what dashpots see */
  double lasts;       /* scree_lasting */
  scree_touch_time time;
} touch;

static vec3 velocity_of(const meeting *m, vec3 slip, vec3 spin_a, vec3 spin_b) {
  vec3 turning = vec3_mad(vec3_scale(spin_a, m->of_a), spin_b, m->of_b);
  return vec3_sub(slip, vec3_cross(turning, m->normal));
}

static vec3 seen_of(const touch *t, vec3 drift, vec3 now) {
  return vec3_mad(drift, vec3_sub(now, drift), t->lead);
}

static void find_motions(const scree_world *world, const scree_pair *pair, touch *t) {
  const scree_sphere_motion *a = &t->a, *b = &t->b;
  const meeting *at = &t->at;
  t->drift = velocity_of(at, vec3_sub(a->velocity, b->velocity), a->spin, b->spin);
  t->now = velocity_of(at, vec3_sub(a->velocity_now, b->velocity_now), a->spin_now, b->spin_now);
  if (pair->wall) {
    t->drift = vec3_sub(t->drift, vec3_cross(b->spin, at->at));
    t->now = vec3_sub(t->now, vec3_cross(b->spin_now, at->at));
  }
  t->lasts = scree_lasting(pair);
  t->lead = scree_dashpot_lead(t->lasts);
  t->seen = seen_of(t, t->drift, t->now);
  t->turned = vec3_scale(vec3_add(a->spin, b->spin), 0.5 * world->time_step);
}

/* How a belt moves along itself where they meet. */
static vec3 belt_velocity(const scree_world *world, const scree_pair *pair, const meeting *m) {
  if (!pair->wall || !scree_wall_is_belt(&world->walls.items[pair->b])) return (vec3){0, 0, 0};
  const scree_world_wall *wall = &world->walls.items[pair->b];
  const mat3 *turned = &wall->frame.rotation;
  return mat3_mul_vec(turned, scree_belt_velocity(wall, mat3_tmul_vec(turned, m->at),
                                                  mat3_tmul_vec(turned, m->normal)));
}

static double press(const scree_world *world, scree_pair *pair, touch *t,
                    const scree_scratch *scratch) {
  const vec3 n = t->at.normal;
  if (scree_is_settled(pair, t->lasts)) {
    pair->book.spring = (scree_wrench){{0, 0, 0}, {0, 0, 0}};
    t->time = (scree_touch_time){1, world->time_step, false};
    return scree_press_settled(world->options.law == SCREE_LAW_HYSTERETIC, pair);
  }
  const double pace = pair->law.contact_time / 3.14159265358979323846;
  scree_overlap_motion moves =
      scree_overlap_moves(world, pair, scratch, -vec3_dot(t->drift, n), -vec3_dot(t->now, n));
  moves.inverse = 1 / (pair->law.stiffness * pace * pace);
  t->time = scree_touch_time_of(pair, &moves);
  const double spring = scree_press_moving(pair, &moves);
  pair->book.spring =
      (scree_wrench){vec3_scale(n, spring), vec3_cross(t->at.at, vec3_scale(n, spring))};
  return spring;
}

/* The couple of rolling resistance. */
static vec3 roll(const scree_world *world, scree_pair *pair, const touch *t, double pressed,
                 double *energy, double *power) {
  if (!(pair->law.rolling > 0)) return (vec3){0, 0, 0};
  const scree_sphere_motion *a = &t->a, *b = &t->b;
  const vec3 n = t->at.normal, spin = vec3_sub(a->spin, b->spin),
             seen = seen_of(t, spin, vec3_sub(a->spin_now, b->spin_now)), turning = across(spin, n),
             rolled = vec3_mad(turned_by(pair->history.rolled, t->turned), turning, t->time.slid),
             couple = scree_roll(world->options.rolling == SCREE_ROLLING_EPSD, pair, n, rolled,
                                 across(seen, n), t->time.damped, pressed, energy);
  *power += vec3_dot(couple, turning);
  return couple;
}

static vec3 slide(const scree_world *world, scree_pair *pair, const touch *t, double before,
                  double pressed, double *energy, double *power) {
  const scree_slider law = scree_slider_of(pair, world->options.tangential_ratio, t->lasts);
  const vec3 n = t->at.normal;
  const vec3 belt = belt_velocity(world, pair, &t->at), v = vec3_sub(across(t->drift, n), belt),
             seen = vec3_sub(across(t->seen, n), belt);
  scree_anchor spring = {.weight = before > 0 && pair->law.hertz > 0 ? sqrt(before) : law.grown};
  vec3 xi = vec3_mad(turned_by(pair->sphere.slid, t->turned), v, t->time.slid),
       force = scree_slide(&law, &spring, law.grown, n, xi, seen, pressed, energy);
  pair->sphere.slid = spring.stretch;
  pair->contact.belt_power = (float)vec3_dot(force, belt);
  *power += vec3_dot(force, v);
  return force;
}

/* The forces along the surface and along the normal, of which the dashpot has its part, and the
 * couple; the ledger's parts about the position of a wall, without moment between spheres. */
static void store_wrenches(scree_pair *pair, const meeting *m, vec3 along, vec3 couple,
                           double normal, double dashpot) {
  const vec3 force = vec3_mad(along, m->normal, normal), twist = vec3_cross(m->normal, along);
  scree_wrench damps = {vec3_scale(m->normal, dashpot), {0, 0, 0}}, rubs = {along, {0, 0, 0}};
  pair->contact.wrench.force = force;
  pair->contact.wrench.torque_a = vec3_mad(couple, twist, -m->of_a);
  pair->contact.wrench.torque_b = vec3_neg(vec3_mad(couple, twist, m->of_b));
  if (pair->wall) {
    damps.moment = vec3_cross(m->at, damps.force);
    rubs.moment = vec3_add(vec3_cross(m->at, along), couple);
    pair->contact.wrench.torque_b = vec3_neg(vec3_add(vec3_cross(m->at, force), couple));
  }
  pair->book.dashpot = scree_kept(&damps);
  pair->book.tangential = scree_kept(&rubs);
}

static void apply_law(const scree_world *world, scree_pair *pair, touch *t,
                      scree_scratch *scratch) {
  const meeting *at = &t->at;
  const vec3 n = at->normal;
  scree_pair_work *work = &scratch->work;
  const double largest = pair->history.largest, spring = press(world, pair, t, scratch),
               pull = pair->law.pull,
               damping =
                   t->time.damped * scree_hardened_damping(pair) *
                   (pair->law.damping * scree_dashpot_grown(&pair->law, pair->contact.overlap)),
               pressing = spring + pull,
               pressed = scree_max(0, pressing - damping * vec3_dot(t->seen, n)),
               dashpot = pressed - pressing, half = 0.5 * world->time_step;
  double energy = 0, power = 0;
  t->along = slide(world, pair, t, scratch->overlap_before, pressed, &energy, &power);
  t->couple = roll(world, pair, t, pressed, &energy, &power);
  t->dashpot = dashpot;
  store_wrenches(pair, at, t->along, t->couple, pressed - pull, dashpot);
  pair->contact.tangential_elastic = energy;
  pair->contact.elastic += energy;
  pair->book.kick = world->time_step;
  work->dashpot = half * dashpot * vec3_dot(t->drift, n);
  work->tangential = half * power;
  if (world->options.law == SCREE_LAW_HYSTERETIC && pair->history.largest > largest)
    work->lost = scree_hysteresis_loss(pair, largest);
}

static void tell(const scree_world *world, const scree_pair *pair, const meeting *at,
                 scree_contact_point *contact) {
  const mat3 *turned = &scree_pair_frame_b(world, pair)->rotation;
  vec3 place = pair->wall ? at->at : vec3_scale(at->normal, at->of_b);
  *contact = (scree_contact_point){.at = mat3_tmul_vec(turned, place),
                                   .normal = mat3_tmul_vec(turned, at->normal),
                                   .force = mat3_tmul_vec(turned, pair->contact.wrench.force),
                                   .overlap = at->overlap,
                                   .taper = 1,
                                   .weight = 1,
                                   .gap_gradient = 1};
}

/* The second half of the last step's work, as scree_pair_begin_work, between spheres: torques come
 * of tangential forces and couples alone. */
static void begin_work(const scree_pair *pair, const touch *t, scree_scratch *scratch) {
  scratch->work = (scree_pair_work){0};
  scratch->spring_work = 0;
  if (!pair->touching) return;
  const vec3 slip = vec3_sub(t->a.velocity, t->b.velocity);
  const double half = 0.5 * pair->book.kick;
  scratch->spring_work = half * vec3_dot(pair->book.spring.force, slip);
  scratch->work.later_dashpot =
      half * vec3_dot(scree_kept_as_wrench(&pair->book.dashpot).force, slip);
  scratch->work.later_tangential =
      half * (vec3_dot(scree_kept_as_wrench(&pair->book.tangential).force, slip) +
              vec3_dot(pair->contact.wrench.torque_a, t->a.spin) +
              vec3_dot(pair->contact.wrench.torque_b, t->b.spin));
}

/* Where they meet and how they move being known; false where they are apart. */
static bool evaluate(const scree_world *world, scree_pair *pair, touch *t, scree_scratch *scratch) {
  scratch->step = scratch->drift = world->time_step;
  scratch->overlap_before = pair->contact.overlap;
  scratch->before.was_depenetrating = false;
  if (!(t->at.overlap > 0)) {
    let_go(pair);
    return false;
  }
  pair->touching = true;
  pair->contact.count = 1;
  pair->history.age += world->time_step;
  pair->contact.overlap = t->at.overlap;
  find_motions(world, pair, t);
  pair->list.travel = vec3_norm(t->drift) * world->time_step;
  apply_law(world, pair, t, scratch);
  scree_note_pressed(world, pair, scratch, &scratch->work);
  scratch->work.too_fast = !pair->wall && !(pair->list.travel <= 2 * pair->law.thin);
  return true;
}

static scree_sphere_motion motion_of(const scree_frame *f) {
  return (scree_sphere_motion){f->velocity, f->spin, f->velocity_now, f->spin_now};
}

void scree_spheres_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                            scree_contact_point *contact) {
  touch t = {.a = motion_of(&world->bodies.frame[pair->a]),
             .b = motion_of(scree_pair_frame_b(world, pair))};
  if (pair->wall)
    scree_pair_begin_work(world, pair, scratch);
  else
    begin_work(pair, &t, scratch);
  double side = side_before(world, pair);
  t.at = pair->wall ? meet_wall(world, pair->a, &world->walls.items[pair->b], &side)
                    : meet_sphere(world, pair->a, pair->b);
  pair->sphere.side = side;
  pair->asleep = !evaluate(world, pair, &t, scratch);
  if (pair->asleep && pair->wall)
    scratch->neighbours->wake = path_of(world, scratch->neighbours) - t.at.overlap;
  if (pair->asleep) return;
  if (pair->wall) scratch->work.wall += scree_half_work_of_wall(world, pair);
  if (contact) tell(world, pair, &t.at, contact);
}

/* ---- two spheres ---- */

static void keep(float to[3], vec3 v) {
  to[0] = (float)v.x, to[1] = (float)v.y, to[2] = (float)v.z;
}

static vec3 kept(const float from[3]) {
  return (vec3){from[0], from[1], from[2]};
}

/* The memory of a pair from that of the contact, which has a part of it in other words. */
static void recall(const scree_sphere_contact *c, double radius_a, double radius_b,
                   scree_pair *pair) {
  const vec3 n = kept(c->normal), along = kept(c->rubs), couple = kept(c->couple),
             twist = vec3_cross(n, along), none = {0, 0, 0};
  const double inside = 0.5 * c->overlap;
  pair->touching = c->overlap > 0;
  pair->contact.overlap = c->overlap;
  pair->history.largest = c->largest;
  pair->history.age = c->age;
  pair->book.kick = c->kick;
  pair->sphere.slid = c->slid;
  pair->history.rolled = kept(c->rolled);
  pair->book.spring = (scree_wrench){vec3_scale(n, c->springs), none};
  const scree_wrench damps = {vec3_scale(n, c->damps), none}, rubs = {along, none};
  pair->book.dashpot = scree_kept(&damps);
  pair->book.tangential = scree_kept(&rubs);
  pair->contact.wrench.torque_a = vec3_mad(couple, twist, inside - radius_a);
  pair->contact.wrench.torque_b = vec3_neg(vec3_mad(couple, twist, radius_b - inside));
}

static void remember(const scree_pair *pair, const touch *t, scree_sphere_contact *c) {
  c->slid = pair->sphere.slid;
  c->overlap = pair->contact.overlap;
  c->largest = pair->history.largest;
  c->kick = pair->book.kick;
  keep(c->normal, t->at.normal);
  c->damps = (float)t->dashpot;
  keep(c->rubs, t->along);
  c->springs = (float)vec3_dot(pair->book.spring.force, t->at.normal);
  keep(c->couple, t->couple);
  c->age = (float)pair->history.age;
  keep(c->rolled, pair->history.rolled);
}

static void forget(scree_sphere_contact *c) {
  *c = (scree_sphere_contact){.dashpot = c->dashpot, .tangential = c->tangential};
}

/* J, of the spring, of those of sliding and rolling; of what it remembers. */
static void find_energies(const scree_world *world, scree_pair *pair) {
  const bool hysteretic = world->options.law == SCREE_LAW_HYSTERETIC;
  const scree_felt none = {0, 0};
  scree_spring_force(hysteretic, pair, pair->contact.overlap, none);
  const scree_slider sliding = scree_slider_of(pair, world->options.tangential_ratio, 0);
  double tangential = 0.5 * sliding.stiffness * sliding.grown * vec3_norm2(pair->sphere.slid);
  if (pair->law.rolling > 0)
    tangential += 0.5 * scree_rolling_stiffness(pair) * pair->law.rolling * pair->law.rolling *
                  vec3_norm2(pair->history.rolled);
  pair->contact.tangential_elastic = tangential;
  pair->contact.elastic += tangential;
}

scree_pair scree_sphere_pair_of(const scree_world *world, size_t k) {
  const scree_spheres *s = &world->spheres;
  const scree_sphere_pair *two = &s->list.pairs.items[k];
  const uint32_t a = s->list.body[two->a], b = s->list.body[two->b];
  scree_pair pair = {.a = a,
                     .b = b,
                     .spheres = true,
                     .substeps.count = 1,
                     .depth = -INFINITY,
                     .law = s->laws.items[two->law]};
  if (two->contact == scree_none) return pair;
  const scree_sphere_contact *c = &s->list.contacts.items[two->contact & ~scree_sphere_touches];
  recall(c, radius_of(world, a), radius_of(world, b), &pair);
  if (!pair.touching) return pair;
  pair.contact.count = 1;
  const scree_bodies *bodies = &world->bodies;
  pair.list.travel =
      vec3_distance(bodies->frame[a].velocity, bodies->frame[b].velocity) * world->time_step;
  find_energies(world, &pair);
  vec3 pressed = vec3_scale(kept(c->normal), scree_spring_at(&pair, pair.contact.overlap).force);
  pair.contact.wrench.force = vec3_add(pressed, kept(c->rubs));
  return pair;
}

void scree_spheres_load(scree_world *world, size_t place) {
  scree_spheres *s = &world->spheres;
  const uint32_t body = s->list.body[place];
  const scree_frame *frame = &world->bodies.frame[body];
  s->place[place] = (scree_sphere_place){frame->position, radius_of(world, body)};
  s->motion[place] = motion_of(frame);
  s->load[place] = (scree_sphere_load){{0, 0, 0}, {0, 0, 0}};
}

/* For its first contact. */
static scree_sphere_contact *contact_of(scree_spheres *s, scree_sphere_pair *two) {
  if (two->contact == scree_none) {
    const size_t block = two->a / SCREE_SPHERE_BLOCK;
    two->contact = s->list.begin[block * SCREE_SPHERE_BLOCK] +
                   scree_atomic_add(&s->blocks.items[block].contacts, 1);
    s->list.contacts.items[two->contact] = (scree_sphere_contact){.slid = {0, 0, 0}};
  }
  return &s->list.contacts.items[two->contact & ~scree_sphere_touches];
}

/* All that the law reads: the whole of it would take longer to clear than the law. */
static void begin_pair(const scree_spheres *s, const scree_sphere_pair *two, size_t k,
                       scree_pair *pair) {
  pair->a = s->list.body[two->a];
  pair->b = s->list.body[two->b];
  pair->wall = pair->asleep = pair->depenetrating = pair->was_depenetrating = false;
  pair->spheres = true;
  pair->neighbours = (uint32_t)k | scree_of_spheres;
  pair->law = s->laws.items[two->law];
  pair->contact.elastic = pair->contact.tangential_elastic = 0;
}

/* All that it calls becomes a part of it: a sixth of its time. */
__attribute__((flatten)) bool scree_sphere_pair_step(scree_world *world, size_t k,
                                                     scree_sphere_result *result) {
  scree_spheres *s = &world->spheres;
  scree_sphere_pair *two = &s->list.pairs.items[k];
  const scree_sphere_place *a = &s->place[two->a], *b = &s->place[two->b];
  touch t = {.at = meet(scree_nearest_image(world, vec3_sub(a->position, b->position)), a->radius,
                        b->radius),
             .a = s->motion[two->a],
             .b = s->motion[two->b]};
  if (two->contact == scree_none && !(t.at.overlap > 0)) return false;
  scree_sphere_contact *c = contact_of(s, two);
  scree_pair *pair = &result->pair;
  scree_scratch scratch;
  begin_pair(s, two, k, pair);
  recall(c, a->radius, b->radius, pair);
  begin_work(pair, &t, &scratch);
  const bool touches = evaluate(world, pair, &t, &scratch);
  const scree_pair_work *work = &scratch.work;
  c->dashpot += work->later_dashpot + work->dashpot - work->lost;
  c->tangential += work->later_tangential + work->tangential;
  two->contact &= ~scree_sphere_touches;
  if (!touches) {
    forget(c);
    return false;
  }
  two->contact |= scree_sphere_touches;
  remember(pair, &t, c);
  result->work = *work;
  result->on_a = (scree_sphere_load){pair->contact.wrench.force, pair->contact.wrench.torque_a};
  result->on_b =
      (scree_sphere_load){vec3_neg(pair->contact.wrench.force), pair->contact.wrench.torque_b};
  return true;
}

static void add(scree_sphere_load *to, const scree_sphere_load *load) {
  to->force = vec3_add(to->force, load->force);
  to->torque = vec3_add(to->torque, load->torque);
}

void scree_spheres_gather(scree_world *world, size_t place, const scree_sphere_load (*loads)[2]) {
  scree_spheres *s = &world->spheres;
  const scree_sphere_list *list = &s->list;
  const uint32_t *begin = s->seconds.items, *seconds = begin + list->count + 2,
                 own = list->begin[place / SCREE_SPHERE_BLOCK * SCREE_SPHERE_BLOCK];
  scree_sphere_load *to = &s->load[place];
  for (int others = 0; others < 2; others++) {
    for (uint32_t i = begin[place]; i < begin[place + 1]; i++)
      if ((seconds[i] < own) == others && scree_spheres_touch(&list->pairs.items[seconds[i]]))
        add(to, &loads[seconds[i]][1]);
    for (uint32_t k = list->begin[place]; k < list->begin[place + 1] && !others; k++)
      if (scree_spheres_touch(&list->pairs.items[k])) add(to, &loads[k][0]);
  }
}
