/* Joints as they are made, grouped and kept; step/joints.c evaluates them. */
#include "world/state/joints.h"
#include "world/state/remote.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/sum.h"

enum { POWER_ROUNDS = 100 };
/* Step times highest frequency. At 0.1 the energy of a body that is shaken all over is kept within
 * 1e-3, at 0.2 within 3e-3, and steps are unstable beyond 1 where joints are damped as little as
 * here (docs/reference/scenes.md). */
static const double pace = 0.2;
static const double usual_damping = 0.05;

void scree_joints_free(scree_joints *joints) {
  scree_free(joints->all.items);
  scree_free(joints->begin.items);
  scree_free(joints->sides.items);
  scree_free(joints->fragment.items);
}

/* ---- who is joined ---- */

static void group(scree_joints *joints, size_t body_count) {
  uint32_t *begin = joints->begin.items;
  memset(begin, 0, (body_count + 1) * sizeof *begin);
  for (int pass = 0; pass < 2; pass++) {
    for (size_t k = joints->all.count; k-- > 0;)
      for (int s = 1; s >= 0; s--) {
        const scree_world_joint *j = &joints->all.items[k];
        uint32_t body = s ? j->b : j->a;
        if (body == scree_none) continue;
        if (pass)
          joints->sides.items[--begin[body]] = (uint32_t)(2 * k + (size_t)s);
        else
          begin[body]++;
      }
    for (size_t i = 1; i <= body_count && !pass; i++) begin[i] += begin[i - 1];
  }
}

static uint32_t root_of(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Joined to space is not joined to each other. The lower root wins. */
static void find_fragments(scree_joints *joints) {
  uint32_t *parent = joints->fragment.items;
  for (uint32_t i = 0; i < joints->fragment.count; i++) parent[i] = i;
  for (size_t k = 0; k < joints->all.count; k++) {
    const scree_world_joint *j = &joints->all.items[k];
    if (j->state != SCREE_JOINT_WHOLE || !(j->area > 0) || j->b == scree_none) continue;
    uint32_t a = root_of(parent, j->a), b = root_of(parent, j->b);
    parent[a > b ? a : b] = a > b ? b : a;
  }
  for (uint32_t i = 0; i < joints->fragment.count; i++) parent[i] = root_of(parent, i);
}

void scree_joints_regroup(scree_world *world) {
  find_fragments(&world->joints);
  world->list.stale = true; /* who was held may touch */
}

scree_status scree_joints_prepare(scree_world *world, scree_error *error) {
  scree_joints *joints = &world->joints;
  size_t bodies = world->bodies.count;
  if (joints->all.count == 0 || (!joints->stale && joints->fragment.count == bodies))
    return SCREE_OK;
  SCREE_TRY(scree_world_change(world, SCREE_PART_JOINTS, error));
  if (!SCREE_RESERVE(&joints->begin, bodies + 1) || !SCREE_RESERVE(&joints->fragment, bodies) ||
      !SCREE_RESERVE(&joints->sides, 2 * joints->all.count))
    return scree_fail_memory(error, bodies * sizeof(uint32_t), "joints");
  joints->begin.count = joints->fragment.count = bodies;
  group(joints, bodies);
  find_fragments(joints);
  joints->stale = false;
  return SCREE_OK;
}

/* ---- the time step ---- */

/* Adds J^T K J of one side to the 6 x 6 of its body, scaled by mass and inertia: the body's own
 * axes, translation then rotation. */
static void add_stiffness(const scree_world *world, const scree_world_joint *j, bool of_b,
                          double sum[6][6]) {
  const scree_bodies *bodies = &world->bodies;
  uint32_t body = of_b ? j->b : j->a;
  vec3 p = of_b ? j->pb : j->pa, in = bodies->inertia[body];
  mat3 r = quat_to_mat3(of_b ? j->fb : j->fa);
  const double m = bodies->mass[body], mass[6] = {m, m, m, in.x, in.y, in.z},
               k[6] = {j->stiffness.x, j->stiffness.y, j->stiffness.z,
                       j->turning.x,   j->turning.y,   j->turning.z};
  for (int c = 0; c < 3; c++) {
    vec3 e = {r.m[0][c], r.m[1][c], r.m[2][c]}, pe = vec3_cross(p, e);
    const double way[6] = {e.x, e.y, e.z, pe.x, pe.y, pe.z}, turn[6] = {0, 0, 0, e.x, e.y, e.z};
    for (int u = 0; u < 6; u++)
      for (int w = 0; w < 6; w++)
        sum[u][w] +=
            (k[c] * way[u] * way[w] + k[c + 3] * turn[u] * turn[w]) / sqrt(mass[u] * mass[w]);
  }
}

/* The largest eigenvalue of a symmetric matrix that has none below 0, by powers. */
static double largest_eigenvalue(double a[6][6]) {
  double x[6] = {1, 0.9, 0.8, 0.7, 0.6, 0.5}, largest = 0;
  for (int round = 0; round < POWER_ROUNDS; round++) {
    double y[6] = {0}, square = 0;
    for (int u = 0; u < 6; u++)
      for (int w = 0; w < 6; w++) y[u] += a[u][w] * x[w];
    for (int u = 0; u < 6; u++) square += y[u] * y[u];
    largest = sqrt(square);
    if (!(largest > 0)) return 0;
    for (int u = 0; u < 6; u++) x[u] = y[u] / largest;
  }
  return largest;
}

/* w^2 is at most twice the largest eigenvalue of any body alone with its joints; breaks lower it.
 */
static void find_frequency(scree_world *world) {
  scree_joints *joints = &world->joints;
  double most = 0;
  for (size_t i = 0; i < joints->fragment.count; i++) {
    double sum[6][6] = {{0}};
    for (uint32_t k = joints->begin.items[i]; k < joints->begin.items[i + 1]; k++) {
      const scree_world_joint *j = &joints->all.items[joints->sides.items[k] >> 1];
      if (j->area > 0) add_stiffness(world, j, joints->sides.items[k] & 1, sum);
    }
    double own = largest_eigenvalue(sum);
    if (own > most) most = own, joints->stiffest = i;
  }
  joints->frequency = sqrt(2 * most);
}

double scree_joints_time_step(const scree_world *of, size_t *body) {
  scree_world *world = (scree_world *)(uintptr_t)of; /* groups and frequency follow from it */
  const scree_joints *joints = &world->joints;
  if (joints->all.count == 0 || scree_joints_prepare(world, NULL) ||
      scree_world_bring(world, SCREE_PART_JOINTS, NULL))
    return INFINITY;
  if (!(joints->frequency > 0)) find_frequency(world);
  *body = joints->stiffest;
  return joints->frequency > 0 ? pace / joints->frequency : INFINITY;
}

/* ---- what is asked of them ---- */

scree_joint_sums scree_joints_sum(const scree_world *world) {
  scree_sum sums[4] = {{0, 0}};
  size_t broken = 0;
  (void)scree_world_bring(world, SCREE_PART_JOINTS, NULL);
  for (size_t k = 0; k < scree_world_joint_count(world); k++) {
    const scree_world_joint *j = &world->joints.all.items[k];
    const double of[] = {j->energy, j->spent.fracture, j->spent.rubbed, j->spent.damped};
    for (int i = 0; i < 4; i++) scree_sum_add(&sums[i], of[i]);
    broken += j->mode != SCREE_JOINT_NOT_BROKEN;
  }
  return (scree_joint_sums){scree_sum_value(sums[0]), scree_sum_value(sums[1]),
                            scree_sum_value(sums[2]), scree_sum_value(sums[3]), broken};
}

size_t scree_world_joint_count(const scree_world *world) {
  return world->joints.all.count;
}

size_t scree_world_leader(const scree_world *world, size_t body) {
  const scree_joints *joints = &world->joints;
  (void)scree_joints_prepare((scree_world *)(uintptr_t)world, NULL); /* groups follow from it;
      without memory, those of the last step */
  return body < joints->fragment.count ? joints->fragment.items[body] : body;
}

size_t scree_world_fragments(const scree_world *world, size_t *fragments) {
  size_t count = 0;
  for (size_t i = 0; i < world->bodies.count; i++) {
    size_t leader = scree_world_leader(world, i);
    fragments[i] = leader == i ? SIZE_MAX : fragments[leader];
    if (world->bodies.removed[i]) fragments[i] = SIZE_MAX;
    /* a root that was removed leaves its fragment to the next */
    else if (fragments[i] == SIZE_MAX)
      fragments[i] = count++;
  }
  return count;
}

/* ---- making them ---- */

scree_joint scree_default_joint(void) {
  return (scree_joint){.normal = {1, 0, 0}, .axis = {0, 1, 0}, .damping = usual_damping};
}

static scree_status check_numbers(const scree_world *world, const scree_joint *joint,
                                  scree_error *error) {
  const double *numbers = joint->stiffness; /* and all that follow */
  size_t count = (sizeof *joint - offsetof(scree_joint, stiffness)) / sizeof *numbers;
  size_t bodies = world->bodies.count;
  if (joint->a >= bodies || (joint->b >= bodies && joint->b != SCREE_SPACE) || joint->a == joint->b)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: a joint of bodies %zu and %zu of %zu",
                      joint->a, joint->b, bodies);
  for (size_t i = 0; i < count; i++)
    if (!(numbers[i] >= 0 && isfinite(numbers[i])))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: a joint of bodies %zu and %zu with the number %g; at least 0",
                        joint->a, joint->b, numbers[i]);
  bool stiff = joint->stiffness[0] > 0 && joint->moduli[0] > 0 && joint->moduli[1] > 0 &&
               joint->moduli[2] > 0 && joint->damping <= 1;
  if (joint->area > 0 && !stiff)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: a joint of bodies %zu and %zu with no stiffness or modulus, or a "
                      "damping of %g above 1",
                      joint->a, joint->b, joint->damping);
  vec3 normal = vec3_load(joint->normal), axis = vec3_load(joint->axis);
  if (joint->area > 0 && !(vec3_norm(vec3_cross(normal, axis)) > 1e-6 * vec3_norm(normal)))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: a joint of bodies %zu and %zu whose axis lies along its normal",
                      joint->a, joint->b);
  return SCREE_OK;
}

/* (normal, axis, normal x axis) as a rotation. */
static quat frame_of(vec3 normal, vec3 axis) {
  vec3 x = vec3_unit(normal), y = vec3_unit(vec3_mad(axis, x, -vec3_dot(axis, x))),
       z = vec3_cross(x, y);
  const mat3 m = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
  return quat_from_mat3(&m);
}

/* Where b would be in the image of a that is nearest, as told in the joint's space. */
static void place(const scree_world *world, const scree_joint *given, scree_world_joint *j) {
  const scree_frame space = SCREE_SPACE_FRAME;
  const scree_joint_side a = scree_joint_side_of(world, j->a, &space),
                         b = scree_joint_side_of(world, j->b, &space);
  quat frame = frame_of(vec3_load(given->normal), vec3_load(given->axis));
  vec3 centre = vec3_load(given->centre);
  j->pa = mat3_tmul_vec(&a.frame->rotation, vec3_sub(centre, a.frame->position));
  j->pb = mat3_tmul_vec(&b.frame->rotation, vec3_sub(centre, b.frame->position));
  j->fa = quat_mul(quat_conjugate(a.orientation), frame);
  j->fb = quat_mul(quat_conjugate(b.orientation), frame);
}

/* By what the two faces together have of mass along each axis, and of inertia about it. */
static void add_dashpots(const scree_world *world, double share, scree_world_joint *j) {
  const double k[] = {j->stiffness.x, j->stiffness.y, j->stiffness.z,
                      j->turning.x,   j->turning.y,   j->turning.z};
  double damping[6];
  for (int c = 0; c < 3; c++) {
    double give = 0, turn = 0; /* by a force and a moment of 1 */
    for (int side = 0; side < (j->b == scree_none ? 1 : 2); side++) {
      size_t body = side ? j->b : j->a;
      mat3 r = quat_to_mat3(side ? j->fb : j->fa);
      vec3 in = world->bodies.inertia[body], e = {r.m[0][c], r.m[1][c], r.m[2][c]},
           arm = vec3_cross(side ? j->pb : j->pa, e);
      turn += e.x * e.x / in.x + e.y * e.y / in.y + e.z * e.z / in.z;
      give += 1 / world->bodies.mass[body] + arm.x * arm.x / in.x + arm.y * arm.y / in.y +
              arm.z * arm.z / in.z;
    }
    damping[c] = 2 * share * sqrt(k[c] / give);
    damping[c + 3] = 2 * share * sqrt(k[c + 3] / turn);
  }
  j->damping = vec3_load(damping);
  j->turning_damping = vec3_load(damping + 3);
}

static scree_world_joint joint_from(const scree_world *world, const scree_joint *g) {
  scree_world_joint j = {.a = (uint32_t)g->a,
                         .b = g->b == SCREE_SPACE ? scree_none : (uint32_t)g->b,
                         .stiffness = vec3_load(g->stiffness),
                         .turning = vec3_load(g->turning),
                         .moduli = vec3_load(g->moduli),
                         .area = g->area,
                         .reach = {g->reach[0], g->reach[1]},
                         .strength.tension = g->tension,
                         .strength.cohesion = g->cohesion,
                         .strength.friction = g->friction,
                         .strength.toughness = g->toughness,
                         .broke_at = NAN};
  if (!(g->area > 0)) return j;
  place(world, g, &j);
  add_dashpots(world, g->damping, &j);
  return j;
}

static scree_status push(scree_world *world, const scree_world_joint *joint, scree_error *error) {
  scree_joints *joints = &world->joints;
  SCREE_TRY(scree_world_change(world, SCREE_PART_JOINTS, error));
  if (joints->all.count > UINT32_MAX / 4)
    return scree_fail(error, SCREE_LIMIT, "world: at most %u joints", UINT32_MAX / 4);
  SCREE_TRY_PUSH(&joints->all, error, *joint);
  joints->stale = world->list.stale = world->time_step_stale = true;
  joints->frequency = 0;
  return SCREE_OK;
}

scree_status scree_world_add_joint(scree_world *world, const scree_joint *joint, size_t *index,
                                   scree_error *error) {
  SCREE_TRY(check_numbers(world, joint, error));
  SCREE_TRY(scree_world_change(world, SCREE_PART_BODIES | SCREE_PART_POSES, error));
  const scree_world_joint made = joint_from(world, joint);
  SCREE_TRY(push(world, &made, error));
  if (index) *index = world->joints.all.count - 1;
  return SCREE_OK;
}

scree_status scree_world_copy_joint(scree_world *to, const scree_world_joint *joint, uint32_t shift,
                                    double strength, scree_error *error) {
  scree_world_joint j = *joint;
  j.a += shift;
  if (j.b != scree_none) j.b += shift;
  j.strength.tension *= strength;
  j.strength.cohesion *= strength;
  j.strength.toughness *= strength * strength;
  return push(to, &j, error);
}

/* ---- sections ---- */

/* Saint-Venant's torsion of a rectangle, within 0.2 %. */
static double torsion_of_rectangle(double width, double thickness) {
  double b = scree_larger(width, thickness), t = scree_smaller(width, thickness), r = t / b;
  return b * t * t * t * (1. / 3 - 0.21 * r * (1 - r * r * r * r / 12));
}

static void fill_section(scree_joint *joint, double area, double along, double across,
                         double torsion) {
  joint->area = area;
  joint->moduli[0] = torsion / scree_smaller(joint->reach[0], joint->reach[1]);
  joint->moduli[1] = across / joint->reach[1];
  joint->moduli[2] = along / joint->reach[0];
}

void scree_joint_of_face(const scree_fracture_face *face, double young, scree_joint *joint) {
  double k = young * face->area / face->distance, area2 = face->area * face->area,
         along = face->second_moments[0], across = face->second_moments[1],
         torsion = area2 * area2 / (40 * (along + across));
  memcpy(joint->centre, face->centre, sizeof joint->centre);
  memcpy(joint->normal, face->normal, sizeof joint->normal);
  memcpy(joint->axis, face->axis, sizeof joint->axis);
  memcpy(joint->reach, face->reach, sizeof joint->reach);
  for (int c = 0; c < 3; c++) joint->stiffness[c] = k;
  joint->turning[0] = young * torsion / (4 * face->distance);
  joint->turning[1] = young * across / face->distance;
  joint->turning[2] = young * along / face->distance;
  fill_section(joint, face->area, along, across, torsion);
}

void scree_joint_of_rectangle(scree_section_kind kind, double young, double poisson, double width,
                              double thickness, double distance, scree_joint *joint) {
  double g = young / (2 * (1 + poisson)), area = width * thickness, h = distance,
         plate = young / (1 - poisson * poisson), along = thickness * width * width * width / 12,
         across = width * thickness * thickness * thickness / 12,
         torsion = torsion_of_rectangle(width, thickness);
  bool sheet = kind == SCREE_SECTION_SHEET, bar = kind == SCREE_SECTION_BAR;
  joint->reach[0] = width / 2;
  joint->reach[1] = thickness / 2;
  joint->stiffness[0] = (sheet ? plate : young) * area / h;
  joint->stiffness[1] = (bar ? 5. / 6 * g : young) * area / h;
  joint->stiffness[2] = (bar || sheet ? 5. / 6 * g : young) * area / h;
  joint->turning[0] = (sheet ? plate * across : bar ? g * torsion : young * torsion / 4) / h;
  joint->turning[1] = (sheet ? plate : young) * across / h;
  joint->turning[2] = young * along / h;
  fill_section(joint, area, along, across, torsion);
}

void scree_joint_of_wire(double young, double poisson, double radius, double distance,
                         scree_joint *joint) {
  double pi = 3.14159265358979323846, g = young / (2 * (1 + poisson)), area = pi * radius * radius,
         second = area * radius * radius / 4;
  joint->reach[0] = joint->reach[1] = radius;
  joint->stiffness[0] = young * area / distance;
  joint->stiffness[1] = joint->stiffness[2] = 0.9 * g * area / distance;
  joint->turning[0] = 2 * g * second / distance;
  joint->turning[1] = joint->turning[2] = young * second / distance;
  fill_section(joint, area, second, second, 2 * second);
}

/* ---- checkpoints ---- */

static void code_joint(scree_codec *codec, scree_world *world, scree_world_joint *j) {
  uint32_t state = j->state, mode = j->mode;
  scree_code_u32(codec, &j->a);
  scree_code_u32(codec, &j->b);
  scree_code_u32(codec, &state);
  scree_code_u32(codec, &mode);
  scree_code_reals(codec, (double *)&j->pa,
                   (sizeof *j - offsetof(scree_world_joint, pa)) / sizeof(double));
  j->state = (uint8_t)state;
  j->mode = (uint8_t)mode;
  size_t bodies = world->bodies.count;
  if (state > SCREE_JOINT_GONE || mode > SCREE_JOINT_BY_ENERGY || j->a >= bodies ||
      (j->b >= bodies && j->b != scree_none))
    codec->failed = true;
}

void scree_joints_code(scree_codec *codec, scree_world *world) {
  size_t count = scree_world_joint_count(world);
  scree_code_count(codec, &count, 4 * sizeof(uint32_t) + 60 * sizeof(double));
  for (size_t k = 0; k < count && scree_codec_good(codec); k++) {
    if (codec->loading && push(world, &(scree_world_joint){0}, NULL) != SCREE_OK)
      codec->out_of_memory = true;
    if (codec->out_of_memory) return;
    code_joint(codec, world, &world->joints.all.items[k]);
  }
  if (codec->loading && scree_joints_prepare(world, NULL) != SCREE_OK) codec->out_of_memory = true;
}
