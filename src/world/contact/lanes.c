/* Four contacts of spheres at once: what spheres.c and law.h do for one, the same operations in the
 * same order, so to the same bits. Contacts that begin or end within the step, or are hardened, and
 * some laws are left to them.
 *
 * This file alone is compiled for AVX2; whether the processor has it is asked before it is called.
 * With less than that four at once take longer than four one by one. */
#include "world/contact/law.h"
#include "world/contact/spheres.h"

#include <string.h>

#ifdef __AVX2__

#include <immintrin.h>

enum { LANES = SCREE_SPHERE_LANES };
typedef double lanes __attribute__((vector_size(32)));
typedef int64_t which __attribute__((vector_size(32))); /* of lanes: all bits, or none */
typedef float floats __attribute__((vector_size(16)));
typedef struct lanes3 {
  lanes x, y, z;
} lanes3;

/* What follows is vec.h, for lanes. */
static inline lanes3 add3(lanes3 a, lanes3 b) {
  return (lanes3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline lanes3 sub3(lanes3 a, lanes3 b) {
  return (lanes3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline lanes3 scale3(lanes3 a, lanes s) {
  return (lanes3){a.x * s, a.y * s, a.z * s};
}
static inline lanes3 mad3(lanes3 a, lanes3 b, lanes s) {
  return (lanes3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline lanes3 neg3(lanes3 a) {
  return (lanes3){-a.x, -a.y, -a.z};
}
static inline lanes dot3(lanes3 a, lanes3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline lanes3 cross3(lanes3 a, lanes3 b) {
  return (lanes3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline lanes root(lanes x) {
  return (lanes)_mm256_sqrt_pd((__m256d)x);
}
static inline lanes either(which where, lanes a, lanes b) {
  return (lanes)(((which)a & where) | ((which)b & ~where));
}
static inline lanes absolute(lanes x) {
  const lanes signs = {-0.0, -0.0, -0.0, -0.0};
  return (lanes)((which)x & ~(which)signs);
}
static inline lanes3 either3(which where, lanes3 a, lanes3 b) {
  return (lanes3){either(where, a.x, b.x), either(where, a.y, b.y), either(where, a.z, b.z)};
}
static inline bool any(which of) {
  return _mm256_movemask_pd((__m256d)of) != 0;
}
static inline lanes rounded(lanes x) {
  return __builtin_convertvector(__builtin_convertvector(x, floats), lanes);
}
static inline lanes3 across(lanes3 v, lanes3 n) {
  return mad3(v, n, -dot3(v, n));
}
static inline lanes3 turned_by(lanes3 spring, lanes3 r) {
  const lanes3 change = cross3(r, spring), more = cross3(r, change);
  const lanes half = {0.5, 0.5, 0.5, 0.5};
  return add3(spring, mad3(change, more, half));
}

/* Four numbers of each of four records become four of all, and back. */
static inline void turn(lanes r[LANES]) {
  const lanes a = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6),
              b = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7),
              c = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6),
              d = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  r[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
static inline lanes load(const double *from) {
  lanes to;
  memcpy(&to, from, sizeof to);
  return to;
}
static inline lanes load_floats(const float *from) {
  floats to;
  memcpy(&to, from, sizeof to);
  return __builtin_convertvector(to, lanes);
}
static inline void store_floats(float *to, lanes row) {
  const floats from = __builtin_convertvector(row, floats);
  memcpy(to, &from, sizeof from);
}

/* How four spheres move: as of a scree_sphere_place and a scree_sphere_motion. */
typedef struct spheres {
  lanes3 position, velocity, spin, velocity_now, spin_now;
  lanes radius;
} spheres;

_Static_assert(sizeof(scree_sphere_place) == 4 * sizeof(double), "read as four numbers");
_Static_assert(sizeof(scree_sphere_motion) == 12 * sizeof(double), "read as twelve");
_Static_assert(sizeof(scree_sphere_load) == 6 * sizeof(double), "written as six");

static inline void take_spheres(const scree_spheres *s, const uint32_t at[LANES], spheres *of) {
  lanes place[LANES], moves[3][LANES];
  for (int l = 0; l < LANES; l++) {
    const double *motion = &s->motion[at[l]].velocity.x;
    place[l] = load(&s->place[at[l]].position.x);
    for (int k = 0; k < 3; k++) moves[k][l] = load(motion + 4 * k);
  }
  turn(place);
  for (int k = 0; k < 3; k++) turn(moves[k]);
  of->position = (lanes3){place[0], place[1], place[2]};
  of->radius = place[3];
  of->velocity = (lanes3){moves[0][0], moves[0][1], moves[0][2]};
  of->spin = (lanes3){moves[0][3], moves[1][0], moves[1][1]};
  of->velocity_now = (lanes3){moves[1][2], moves[1][3], moves[2][0]};
  of->spin_now = (lanes3){moves[2][1], moves[2][2], moves[2][3]};
}

/* As of a scree_pair_law; the sliders as of scree_slider_of, over what grows with the overlap. */
static inline void take_laws(const scree_world *world, const uint32_t of[LANES],
                             scree_sphere_lanes *four) {
  if (!memcmp(four->law, of, sizeof four->law)) return;
  memcpy(four->law, of, sizeof four->law);
  const double ratio = world->options.tangential_ratio;
  for (int l = 0; l < LANES; l++) {
    const scree_pair_law *law = &world->spheres.laws.items[of[l]];
    const bool hertz = law->hertz > 0;
    four->stiffness[l] = hertz ? law->hertz : law->stiffness;
    four->damping[l] = law->damping;
    four->slides[l] = hertz ? law->mindlin : law->stiffness * ratio;
    four->slides_ratio[l] = sqrt(hertz ? law->mindlin / (1.5 * law->hertz) : ratio);
    four->friction[l] = law->friction;
    four->limit[l] = law->limit;
    four->thin[l] = law->thin;
    four->contact_time[l] = law->contact_time;
    four->pull[l] = law->pull;
    four->rolling[l] = law->rolling;
    four->rolling_damping[l] = law->rolling_damping;
  }
}

/* As of a scree_sphere_contact. */
typedef struct memory {
  lanes3 slid, normal, rubs, couple, rolled;
  lanes overlap, damps, springs, age, spare;
  lanes worked, dashpot, tangential, kick;
} memory;

static inline void recall(scree_sphere_contact *const at[LANES], memory *m) {
  lanes slid[LANES], books[LANES], normal[LANES], rubs[LANES], couple[LANES], rolled[LANES];
  for (int l = 0; l < LANES; l++) {
    slid[l] = load(&at[l]->slid.x);
    books[l] = load(&at[l]->largest);
    normal[l] = load_floats(at[l]->normal);
    rubs[l] = load_floats(at[l]->rubs);
    couple[l] = load_floats(at[l]->couple);
    rolled[l] = load_floats(at[l]->rolled);
  }
  turn(slid), turn(books), turn(normal), turn(rubs), turn(couple), turn(rolled);
  *m = (memory){.slid = {slid[0], slid[1], slid[2]},
                .overlap = slid[3],
                .worked = books[0],
                .dashpot = books[1],
                .tangential = books[2],
                .kick = books[3],
                .normal = {normal[0], normal[1], normal[2]},
                .damps = normal[3],
                .rubs = {rubs[0], rubs[1], rubs[2]},
                .springs = rubs[3],
                .couple = {couple[0], couple[1], couple[2]},
                .age = couple[3],
                .rolled = {rolled[0], rolled[1], rolled[2]},
                .spare = rolled[3]};
}

static inline void remember(const memory *m, scree_sphere_contact *const at[LANES], which stay) {
  lanes slid[LANES] = {m->slid.x, m->slid.y, m->slid.z, m->overlap},
        books[LANES] = {m->worked, m->dashpot, m->tangential, m->kick},
        normal[LANES] = {m->normal.x, m->normal.y, m->normal.z, m->damps},
        rubs[LANES] = {m->rubs.x, m->rubs.y, m->rubs.z, m->springs},
        couple[LANES] = {m->couple.x, m->couple.y, m->couple.z, m->age},
        rolled[LANES] = {m->rolled.x, m->rolled.y, m->rolled.z, m->spare};
  turn(slid), turn(books), turn(normal), turn(rubs), turn(couple), turn(rolled);
  for (int l = 0; l < LANES; l++) {
    if (!stay[l]) continue;
    memcpy(&at[l]->slid, &slid[l], sizeof slid[l]);
    memcpy(&at[l]->largest, &books[l], sizeof books[l]);
    store_floats(at[l]->normal, normal[l]);
    store_floats(at[l]->rubs, rubs[l]);
    store_floats(at[l]->couple, couple[l]);
    store_floats(at[l]->rolled, rolled[l]);
  }
}

/* The spring along the surface, stretched to xi, and its dashpot: scree_slide. `shrinks`: by `less`
 * where that is below 1. */
static inline lanes3 slide(lanes3 *xi, bool shrinks, lanes less, lanes k, lanes c, lanes most,
                           lanes3 n, lanes3 seen) {
  const lanes most2 = most * most;
  lanes3 x = across(*xi, n);
  if (shrinks) x = either3(less < 1, scale3(x, less), x);
  const lanes length2 = dot3(x, x);
  const which slips = k * k * length2 > most2;
  if (any(slips)) x = either3(slips, scale3(x, most / (k * root(length2))), x);
  const lanes3 force = mad3(scale3(x, -k), seen, -c);
  const lanes size2 = dot3(force, force);
  const which over = size2 > most2;
  *xi = x;
  return any(over) ? either3(over, scale3(force, most / root(size2)), force) : force;
}

static inline void put_rows(const lanes force[LANES], const lanes torque[LANES], int half,
                            scree_sphere_load to[LANES]) {
  for (int l = 0; l < LANES; l++) {
    memcpy(&to[l].force.x, &force[l], sizeof force[l]);
    memcpy(&to[l].torque.y, (const double *)&torque[l] + half, 2 * sizeof(double));
  }
}

static inline void put_loads(lanes3 force, lanes3 on_a, lanes3 on_b, scree_sphere_lanes *four) {
  const lanes3 back = neg3(force);
  lanes of_a[LANES] = {force.x, force.y, force.z, on_a.x},
        of_b[LANES] = {back.x, back.y, back.z, on_b.x},
        torque[LANES] = {on_a.y, on_a.z, on_b.y, on_b.z};
  turn(of_a), turn(of_b), turn(torque);
  put_rows(of_a, torque, 0, four->on_a);
  put_rows(of_b, torque, 2, four->on_b);
}

/* The second half of the last step's work: begin_work. */
static inline void add_later_work(const spheres *a, const spheres *b, lanes3 slip, const memory *m,
                                  lanes *dashpot, lanes *tangential, lanes *spring) {
  const lanes half = 0.5 * m->kick, inside = 0.5 * m->overlap;
  const lanes3 twist = cross3(m->normal, m->rubs), damps = scale3(m->normal, m->damps),
               on_a = mad3(m->couple, twist, inside - a->radius),
               on_b = neg3(mad3(m->couple, twist, b->radius - inside));
  *dashpot = half * dot3((lanes3){rounded(damps.x), rounded(damps.y), rounded(damps.z)}, slip);
  *spring = half * dot3(scale3(m->normal, m->springs), slip);
  *tangential = half * (dot3(m->rubs, slip) + dot3(on_a, a->spin) + dot3(on_b, b->spin));
}

/* Where they meet, and how they move there: meet, find_motions. */
typedef struct meeting {
  lanes3 normal, drift, seen, turned;
  lanes distance, overlap, of_a, of_b, travel, rate, rate_now, lasts, lead;
} meeting;

static inline lanes3 velocity_of(const meeting *at, lanes3 slip, lanes3 spin_a, lanes3 spin_b) {
  return sub3(slip, cross3(mad3(scale3(spin_a, at->of_a), spin_b, at->of_b), at->normal));
}

static inline lanes lasting(lanes age) {
  const lanes none = {0, 0, 0, 0}, part = (age - 1.5) / 1.5;
  return either(age < 1.5, none, either(age > 3, none + 1, part));
}

static inline meeting meet(const spheres *a, const spheres *b, lanes3 slip, lanes age, lanes dt) {
  const lanes3 between = sub3(a->position, b->position);
  meeting at = {.distance = root(dot3(between, between)), .lasts = lasting(age)};
  at.lead = scree_dashpot_lead(0) + (scree_dashpot_lead(1) - scree_dashpot_lead(0)) * at.lasts;
  at.overlap = a->radius + b->radius - at.distance;
  at.normal = scale3(between, 1 / at.distance);
  at.of_a = a->radius - 0.5 * at.overlap;
  at.of_b = b->radius - 0.5 * at.overlap;
  at.drift = velocity_of(&at, slip, a->spin, b->spin);
  const lanes3 now =
      velocity_of(&at, sub3(a->velocity_now, b->velocity_now), a->spin_now, b->spin_now);
  at.seen = mad3(at.drift, sub3(now, at.drift), at.lead);
  at.turned = scale3(add3(a->spin, b->spin), 0.5 * dt);
  at.travel = root(dot3(at.drift, at.drift)) * dt;
  at.rate = -dot3(at.drift, at.normal);
  at.rate_now = -dot3(now, at.normal);
  return at;
}

/* scree_soft_spring_at. `deep`: the overlap's root, of Hertz. */
typedef struct spring {
  lanes force, energy;
} spring;

static inline spring spring_at(lanes stiffness, bool hertz, lanes overlap, lanes deep) {
  const lanes force = hertz ? stiffness * overlap * deep : stiffness * overlap;
  return (spring){force, hertz ? 0.4 * force * overlap : 0.5 * stiffness * overlap * overlap};
}

/* scree_repaid. */
static inline lanes repaid(lanes lasts, lanes balance, lanes kick_work, lanes stored) {
  const lanes none = {0, 0, 0, 0}, size = absolute(balance) / stored,
              most = either(size < 1, size, none + 1) * (1 - lasts), share = -balance / kick_work,
              low = either(-most > share, -most, share), kept = either(share > most, most, low);
  return either((stored > 0) & (kick_work != 0), kept, none);
}

/* The force of springs that are not settled, and what they have worked: scree_press_moving. */
static inline lanes press_moving(const meeting *at, spring is, spring was, lanes before, lanes pull,
                                 lanes dt, lanes spring_work, lanes *worked) {
  const lanes half = -0.25 * (dt + dt) * at->rate, force = is.force - pull,
              between = 0.5 * (is.energy + was.energy) -
                        0.25 * (is.force - was.force) * (at->overlap - before),
              stored = between - 0.5 * pull * (at->overlap + before), sum = *worked + spring_work,
              felt = force * (1 + repaid(at->lasts, stored + sum, 2 * half * force, is.energy));
  *worked = sum + half * felt;
  return felt;
}

/* scree_is_edge_of_touch. */
static inline which is_edge(const meeting *at, lanes dt) {
  const lanes way = either(at->rate_now > 0, absolute(at->rate), absolute(at->rate_now)) * dt;
  return (at->overlap < steep_overlap * at->travel) & (way > at->overlap) & (at->rate != 0);
}

/* The couple of rolling, and its power: roll. */
static inline lanes3 roll(const spheres *a, const spheres *b, const meeting *at, lanes dt, lanes k,
                          const scree_sphere_lanes *four, lanes pressed, memory *m, lanes *power) {
  const lanes none = {0, 0, 0, 0}, arm = load(four->rolling);
  const which rolls = arm > 0;
  const lanes3 n = at->normal, spin = sub3(a->spin, b->spin), turning = across(spin, n),
               now = sub3(a->spin_now, b->spin_now), seen = mad3(spin, sub3(now, spin), at->lead);
  lanes3 rolled = mad3(turned_by(m->rolled, at->turned), turning, dt);
  const lanes3 couple = slide(&rolled, false, none, k * arm * arm, load(four->rolling_damping),
                              arm * pressed, n, across(seen, n));
  m->rolled = either3(rolls, rolled, m->rolled);
  *power = either(rolls, *power + dot3(couple, turning), *power);
  return either3(rolls, couple, (lanes3){none, none, none});
}

/* The springs' force along the normal, less the pull: press. Roots of the overlap now and before,
 * of Hertz. */
static inline lanes press(const meeting *at, const scree_sphere_lanes *four, bool hertz, lanes deep,
                          lanes was_deep, lanes dt, lanes spring_work, memory *m) {
  const lanes none = {0, 0, 0, 0}, stiffness = load(four->stiffness), pull = load(four->pull);
  const which settled = (at->lasts == 1) & (at->overlap >= steep_overlap * at->travel);
  const spring is = spring_at(stiffness, hertz, at->overlap, deep),
               was = spring_at(stiffness, hertz, m->overlap, was_deep);
  lanes force = is.force - pull;
  lanes3 kept = {none, none, none};
  if (any(~settled)) {
    lanes worked = m->worked;
    const lanes moving = press_moving(at, is, was, m->overlap, pull, dt, spring_work, &worked);
    m->worked = either(settled, m->worked, worked);
    kept = either3(settled, kept, scale3(at->normal, moving));
    force = either(settled, force, moving);
  }
  m->springs = dot3(kept, at->normal);
  return force;
}

/* The law: evaluate. For which of the four: of others what is found means nothing. */
static inline which apply_law(double time_step, bool hertz, const spheres *a, const spheres *b,
                              memory *m, scree_sphere_lanes *four) {
  const lanes none = {0, 0, 0, 0}, dt = none + time_step, half = 0.5 * dt,
              damping = load(four->damping), pull = load(four->pull),
              limit = hard_from * load(four->limit);
  const lanes3 slip = sub3(a->velocity, b->velocity);
  lanes later_dashpot, later_tangential, spring_work;
  add_later_work(a, b, slip, m, &later_dashpot, &later_tangential, &spring_work);
  m->age += dt;
  const meeting at = meet(a, b, slip, m->age / load(four->contact_time), dt);
  const lanes3 n = at.normal, v = across(at.drift, n);
  const which served = (m->overlap > 0) & (m->overlap <= limit) & (at.overlap > 0) &
                       (at.overlap <= limit) & (at.distance > 0) &
                       (at.travel <= 2 * load(four->thin)) & ~is_edge(&at, dt);
  const lanes deep = hertz ? root(at.overlap) : none + 1,
              was_deep = hertz ? root(m->overlap) : deep,
              pressing = press(&at, four, hertz, deep, was_deep, dt, spring_work, m) + pull,
              left = pressing - (hertz ? damping * root(deep) : damping) * dot3(at.seen, n),
              pressed = either(left > 0, left, none), dashpot = pressed - pressing,
              c_t = at.lasts * damping * load(four->slides_ratio),
              k_r = 2.25 * (hertz ? 1.5 * load(four->stiffness) * deep : load(four->stiffness));
  m->slid = mad3(turned_by(m->slid, at.turned), v, dt);
  const lanes3 along = slide(&m->slid, hertz, was_deep / deep, load(four->slides) * deep,
                             (hertz ? c_t / root(deep) : c_t) * deep,
                             load(four->friction) * pressed, n, across(at.seen, n));
  lanes power = none + dot3(along, v);
  const lanes3 couple = roll(a, b, &at, dt, k_r, four, pressed, m, &power),
               twist = cross3(n, along);
  put_loads(mad3(along, n, pressed - pull), mad3(couple, twist, -at.of_a),
            neg3(mad3(couple, twist, at.of_b)), four);
  memcpy(four->overlap, &at.overlap, sizeof four->overlap);
  m->overlap = at.overlap;
  m->dashpot += later_dashpot + half * dashpot * dot3(at.drift, n);
  m->tangential += later_tangential + half * power;
  m->kick = dt;
  m->normal = n;
  m->damps = dashpot;
  m->rubs = along;
  m->couple = couple;
  return served;
}

bool scree_sphere_lanes_serve(const scree_world *world) {
  const scree_world_options *o = &world->options;
  return __builtin_cpu_supports("avx2") && o->law != SCREE_LAW_HYSTERETIC &&
         o->rolling != SCREE_ROLLING_EPSD &&
         !(o->period[0] > 0 || o->period[1] > 0 || o->period[2] > 0) &&
         o->overlap_limit * hard_from <= 0.5; /* so deep none is through: scree_is_through */
}

unsigned scree_sphere_lanes_step(scree_world *world, const uint32_t k[SCREE_SPHERE_LANES],
                                 scree_sphere_lanes *four) {
  scree_spheres *s = &world->spheres;
  scree_sphere_contact *at[LANES], apart = {.slid = {0, 0, 0}};
  uint32_t of_a[LANES], of_b[LANES], law[LANES];
  unsigned served = 0, count = 0;
  for (int l = 0; l < LANES; l++) {
    const scree_sphere_pair *two = &s->list.pairs.items[k[l]];
    const bool touches = scree_spheres_touch(two);
    of_a[l] = two->a;
    of_b[l] = two->b;
    law[l] = two->law;
    at[l] = touches ? &s->list.contacts.items[two->contact & ~scree_sphere_touches] : &apart;
    count += touches;
  }
  if (count < 2) return 0; /* one alone costs less by itself */
  take_laws(world, law, four);
  spheres a, b;
  take_spheres(s, of_a, &a);
  take_spheres(s, of_b, &b);
  memory m;
  recall(at, &m);
  const which done = world->options.law == SCREE_LAW_HERTZ
                         ? apply_law(world->time_step, true, &a, &b, &m, four)
                         : apply_law(world->time_step, false, &a, &b, &m, four);
  remember(&m, at, done);
  for (int l = 0; l < LANES; l++) served |= done[l] ? 1u << l : 0;
  return served;
}

#else

bool scree_sphere_lanes_serve(const scree_world *world) {
  (void)world;
  return false;
}

unsigned scree_sphere_lanes_step(scree_world *world, const uint32_t k[SCREE_SPHERE_LANES],
                                 scree_sphere_lanes *four) {
  (void)world, (void)k, (void)four;
  return 0;
}

#endif
