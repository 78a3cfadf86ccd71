/* Walls that move by a law of time.
 *
 * Each motion is a way f(t) along a direction or an angle f(t) about an axis; the first moves the
 * wall as it stood when the motions were set, each later one what those before it have done:
 *   translation: x' = x + a f,          v' = v + a df/dt
 *   rotation:    x' = p + R (x - p),    v' = R v + w' x (x' - p),   w' = R w + a df/dt
 * with R the rotation about a by f; or f is a way round two wheels (loop.h). So a wall's place is a
 * closed function of time, its velocity the derivative, and nothing drifts however long it runs.
 * The frame's velocity and spin are the means over the last drift, as those of bodies are: springs
 * stretch and the ledger counts by them.
 */
#include "world/state/loop.h"
#include "world/state/remote.h"
#include "world/state/walls.h"

#include "base/array.h"
#include "base/math.h"
#include "base/table.h"

#include <string.h>

static const double two_pi = 6.28318530717958647693;

scree_wall_motion scree_default_wall_motion(void) {
  return (scree_wall_motion){.axis = {0, 0, 1}, .frequency = 1, .until = INFINITY};
}

/* ---- the laws ---- */

/* Columns of a table's rows. */
enum { TIME, VALUE, SUM, WIDTH };

/* The way that the speeds of the rows have led since the first. */
static double way_of_speeds(const scree_rows *rows, double t, double speed) {
  const double *row = scree_rows_last(rows, t);
  return row[SUM] + 0.5 * (row[VALUE] + speed) * (t - row[TIME]);
}

/* The way of a sliding crank, and its slope by the angle. */
static double crank(double radius, double rod, double angle, double *slope) {
  const double sine = scree_sin(angle), cosine = scree_cos(angle),
               leg = sqrt(rod * rod - radius * radius * sine * sine);
  *slope = -radius * sine * (1 + radius * cosine / leg);
  return radius * cosine + leg;
}

/* f and df/dt at time t, but for a constant. */
static double law_at(const scree_motion_state *m, const scree_motion_row *rows, double t,
                     double *rate) {
  bool moving = t >= m->from && t < m->until;
  t = t < m->from ? m->from : t > m->until ? m->until : t;
  double value = 0, slope = 0, turn = two_pi * m->frequency;
  const scree_rows lines = {m->row_count ? &rows->time : NULL, WIDTH, m->row_count};
  switch ((scree_motion_law)m->law) {
  case SCREE_MOTION_CONSTANT:
    value = m->speed * (t - m->from);
    slope = m->speed;
    break;
  case SCREE_MOTION_SINE:
    value = m->amplitude * scree_sin(turn * (t - m->from) + m->phase);
    slope = m->amplitude * turn * scree_cos(turn * (t - m->from) + m->phase);
    break;
  case SCREE_MOTION_POSITIONS:
    if (lines.rows) value = scree_rows_at(&lines, t, &slope);
    break;
  case SCREE_MOTION_SPEEDS: {
    double unused;
    if (!lines.rows) break;
    slope = scree_rows_at(&lines, t, &unused);
    value = way_of_speeds(&lines, t, slope);
    break;
  }
  case SCREE_MOTION_CRANK:
    value = crank(m->amplitude, m->rod, turn * (t - m->from) + m->phase, &slope);
    slope *= turn;
    break;
  }
  *rate = moving ? slope : 0;
  return value;
}

typedef struct wall_pose {
  vec3 position, velocity, spin;
  quat orientation;
} wall_pose;

static void carry_round(const scree_motion_state *m, double way, double rate, wall_pose *pose) {
  const scree_loop loop = {m->axis, m->through, m->span, m->radius};
  const scree_loop_place was = scree_loop_at(&loop, m->start),
                         is = scree_loop_at(&loop, m->start + way);
  const quat turn = quat_mul(is.turn, quat_conjugate(was.turn));
  const mat3 r = quat_to_mat3(turn);
  const vec3 spin = vec3_scale(is.spin, rate);
  pose->position = scree_loop_carry(&loop, &is, scree_loop_bring_back(&loop, &was, pose->position));
  pose->velocity = vec3_add(vec3_mad(mat3_mul_vec(&r, pose->velocity), is.along, rate),
                            vec3_cross(spin, vec3_sub(pose->position, is.middle)));
  pose->spin = vec3_add(mat3_mul_vec(&r, pose->spin), spin);
  pose->orientation = quat_unit(quat_mul(turn, pose->orientation));
}

static void compose(const scree_motion_state *m, double way, double rate, wall_pose *pose) {
  if (m->radius > 0) {
    carry_round(m, way, rate, pose);
    return;
  }
  if (!m->turns) {
    pose->position = vec3_mad(pose->position, m->axis, way);
    pose->velocity = vec3_mad(pose->velocity, m->axis, rate);
    return;
  }
  quat turn = quat_from_rotation_vector(vec3_scale(m->axis, way));
  mat3 r = quat_to_mat3(turn);
  vec3 arm = mat3_mul_vec(&r, vec3_sub(pose->position, m->through)),
       spin = vec3_scale(m->axis, rate);
  pose->position = vec3_add(m->through, arm);
  pose->velocity = vec3_add(mat3_mul_vec(&r, pose->velocity), vec3_cross(spin, arm));
  pose->spin = vec3_add(mat3_mul_vec(&r, pose->spin), spin);
  pose->orientation = quat_unit(quat_mul(turn, pose->orientation));
}

/* Where the wall is at time t; its motions and their rows begin at these. */
static wall_pose pose_at(const scree_world_wall *wall, const scree_motion_state *motion,
                         const scree_motion_row *rows, double t) {
  wall_pose pose = {wall->start_position, {0, 0, 0}, {0, 0, 0}, wall->start_orientation};
  for (size_t i = 0; i < wall->motion_count; i++, motion++) {
    double rate, way = law_at(motion, rows, t, &rate) - motion->origin;
    compose(motion, way, rate, &pose);
    rows += motion->row_count;
  }
  return pose;
}

/* ---- moving ---- */

/* The rotation vector of a turn by less than a half circle. */
static vec3 rotation_vector(quat q) {
  vec3 v = {q.x, q.y, q.z};
  if (q.w < 0) v = vec3_neg(v);
  double s = vec3_norm(v);
  return vec3_scale(v, s > 1e-4 ? 2 * scree_atan2(s, fabs(q.w)) / s : 2 + s * s / 3);
}

/* The way and the turn from where the wall is to a pose. */
static void way_to(const scree_world_wall *wall, const wall_pose *pose, vec3 *way, vec3 *turn) {
  *way = vec3_sub(pose->position, wall->frame.position);
  *turn = rotation_vector(quat_mul(pose->orientation, quat_conjugate(wall->orientation)));
}

static double travel_by(const scree_world_wall *wall, vec3 way, vec3 turn) {
  return vec3_norm(way) + wall->reach * vec3_norm(turn);
}

/* To time t, and how far it will move in the step after. */
static void follow_motions(scree_world_wall *wall, const scree_motion_state *motions,
                           const scree_motion_row *rows, double t, double dt) {
  wall_pose pose = pose_at(wall, motions, rows, t), next = pose_at(wall, motions, rows, t + dt);
  scree_frame *frame = &wall->frame;
  vec3 way, turn;
  way_to(wall, &pose, &way, &turn);
  double travel = travel_by(wall, way, turn);
  frame->velocity = vec3_scale(way, 1 / dt);
  frame->spin = vec3_scale(turn, 1 / dt);
  frame->velocity_now = pose.velocity;
  frame->spin_now = pose.spin;
  frame->position = pose.position;
  frame->rotation = quat_to_mat3(pose.orientation);
  wall->orientation = pose.orientation;
  way_to(wall, &next, &way, &turn);
  wall->travel = scree_max(travel, travel_by(wall, way, turn));
  wall->path += travel;
}

static void follow_velocity(scree_world_wall *wall, double dt) {
  scree_frame *frame = &wall->frame;
  vec3 way = vec3_scale(frame->velocity, dt), by = vec3_scale(frame->spin, dt);
  wall->travel = travel_by(wall, way, by);
  wall->path += wall->travel;
  frame->position = vec3_mad(frame->position, frame->velocity, dt);
  if (!(vec3_norm2(frame->spin) > 0)) return;
  quat turn = quat_from_rotation_vector(by);
  wall->orientation = quat_unit(quat_mul(turn, wall->orientation));
  frame->rotation = quat_to_mat3(wall->orientation);
}

/* A wall's own motions and rows, behind those of the walls before it. */
static const scree_motion_state *motions_before(const scree_world *world, size_t w,
                                                const scree_motion_row **rows) {
  const scree_motion_state *motions = world->motions.items;
  *rows = world->motion_rows.items;
  for (size_t before = 0; before < w; before++)
    for (size_t i = 0; i < world->walls.items[before].motion_count; i++)
      *rows += motions++->row_count;
  return motions;
}

void scree_wall_place(const scree_world *world, size_t w, double time, vec3 *position,
                      mat3 *rotation) {
  const scree_world_wall *wall = &world->walls.items[w];
  const scree_motion_row *rows;
  const scree_motion_state *motions = motions_before(world, w, &rows);
  wall_pose pose = {.position = wall->frame.position, .orientation = wall->orientation};
  if (wall->motion_count) pose = pose_at(wall, motions, rows, time);
  *position = pose.position;
  *rotation = quat_to_mat3(pose.orientation);
}

void scree_wall_advance(scree_world *world, size_t w) {
  double dt = world->time_step;
  scree_world_wall *wall = &world->walls.items[w];
  const scree_motion_row *rows;
  const scree_motion_state *motions = motions_before(world, w, &rows);
  if (wall->motion_count)
    follow_motions(wall, motions, rows, world->time + dt, dt);
  else
    follow_velocity(wall, dt);
  if (world->bodies.count > 0) scree_set_wall_wake_threshold(world, w);
}

/* ---- setting ---- */

static scree_status check_table(const scree_wall_motion *m, size_t wall, size_t number,
                                scree_error *error) {
  if (m->row_count == 0 || !m->table)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: motion %zu of wall %zu has an empty table",
                      number, wall);
  for (size_t i = 0; i < m->row_count; i++) {
    const double *row = &m->table[2 * i];
    if (!isfinite(row[0] + row[1]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: motion %zu of wall %zu, row %zu of its table is %g s, %g; finite",
                        number, wall, i, row[0], row[1]);
    if (i > 0 && !(row[0] > row[-2]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: motion %zu of wall %zu, row %zu of its table is at %g s, not after "
                        "the row before (%g s)",
                        number, wall, i, row[0], row[-2]);
  }
  return SCREE_OK;
}

static scree_status check_round(const scree_wall_motion *m, size_t wall, size_t number,
                                scree_error *error) {
  const vec3 span = vec3_load(m->span), axis = vec3_unit(vec3_load(m->axis));
  if (m->radius == 0 ||
      (m->radius > 0 && isfinite(m->radius + m->start) &&
       fabs(vec3_dot(span, axis)) <= 1e-9 * vec3_norm(span) && isfinite(vec3_norm(span))))
    return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "world: motion %zu of wall %zu is round wheels of radius %g m, (%g, %g, %g) m "
                    "apart; finite, square to the axis",
                    number, wall, m->radius, span.x, span.y, span.z);
}

static scree_status check_motion(const scree_wall_motion *m, size_t wall, size_t number,
                                 scree_error *error) {
  double axis2 = 0, through = 0;
  for (int i = 0; i < 3; i++) axis2 += m->axis[i] * m->axis[i], through += m->through[i];
  if (!(axis2 > 0 && isfinite(axis2 + through)))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: motion %zu of wall %zu has an axis of length %g; finite and above 0, "
                      "through a finite point",
                      number, wall, sqrt(axis2));
  if (!(isfinite(m->from) && m->until >= m->from))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: motion %zu of wall %zu is from %g s until %g s; from a finite time "
                      "to a later one",
                      number, wall, m->from, m->until);
  scree_status status = check_round(m, wall, number, error);
  if (status != SCREE_OK) return status;
  switch (m->law) {
  case SCREE_MOTION_CONSTANT:
    if (isfinite(m->speed)) return SCREE_OK;
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: motion %zu of wall %zu has speed %g; finite", number, wall, m->speed);
  case SCREE_MOTION_SINE:
    if (isfinite(m->amplitude + m->phase) && m->frequency > 0 && isfinite(m->frequency))
      return SCREE_OK;
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: motion %zu of wall %zu has amplitude %g, frequency %g Hz and phase "
                      "%g; finite, the frequency above 0",
                      number, wall, m->amplitude, m->frequency, m->phase);
  case SCREE_MOTION_POSITIONS:
  case SCREE_MOTION_SPEEDS:
    return check_table(m, wall, number, error);
  case SCREE_MOTION_CRANK:
    if (m->amplitude >= 0 && m->rod > m->amplitude && m->frequency > 0 &&
        isfinite(m->rod + m->frequency + m->phase))
      return SCREE_OK;
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: motion %zu of wall %zu has a crank of %g m, a rod of %g m, frequency "
                      "%g Hz and phase %g; finite, the rod longer than the crank, the frequency "
                      "above 0",
                      number, wall, m->amplitude, m->rod, m->frequency, m->phase);
  }
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "world: motion %zu of wall %zu is of law %d, which is none", number, wall,
                    (int)m->law);
}

/* The rows of a table, and the way of a table of speeds up to each. */
static void copy_rows(const scree_wall_motion *m, scree_motion_row *rows) {
  for (size_t i = 0; i < m->row_count; i++) {
    rows[i] = (scree_motion_row){m->table[2 * i], m->table[2 * i + 1], 0};
    if (i > 0)
      rows[i].sum = rows[i - 1].sum +
                    0.5 * (rows[i - 1].value + rows[i].value) * (rows[i].time - rows[i - 1].time);
  }
}

static bool has_table(const scree_wall_motion *m) {
  return m->law == SCREE_MOTION_POSITIONS || m->law == SCREE_MOTION_SPEEDS;
}

static scree_motion_state make_motion(const scree_wall_motion *m, const scree_motion_row *rows,
                                      double now) {
  scree_motion_state made = {.law = (uint32_t)m->law,
                             .turns = m->turns,
                             .axis = vec3_unit(vec3_load(m->axis)),
                             .through = vec3_load(m->through),
                             .span = vec3_load(m->span),
                             .speed = m->speed,
                             .amplitude = m->amplitude,
                             .frequency = m->frequency,
                             .phase = m->phase,
                             .rod = m->rod,
                             .radius = m->radius,
                             .start = m->start,
                             .from = m->from,
                             .until = m->until,
                             .row_count = has_table(m) ? m->row_count : 0};
  double rate;
  made.origin = law_at(&made, rows, now, &rate);
  return made;
}

/* Where the wall's motions and their rows lie. */
typedef struct motion_range {
  size_t motion, motion_count, row, row_count;
} motion_range;

static motion_range motions_of(const scree_world *world, size_t index) {
  motion_range r = {0, world->walls.items[index].motion_count, 0, 0};
  for (size_t w = 0; w < index; w++) r.motion += world->walls.items[w].motion_count;
  for (size_t i = 0; i < r.motion; i++) r.row += world->motions.items[i].row_count;
  for (size_t i = 0; i < r.motion_count; i++)
    r.row_count += world->motions.items[r.motion + i].row_count;
  return r;
}

/* Makes room for `count` items where there were `old` at `at`. */
static void splice(void *items, size_t size, size_t *total, size_t at, size_t old, size_t count) {
  char *bytes = items;
  size_t behind = *total - at - old;
  if (behind) memmove(bytes + (at + count) * size, bytes + (at + old) * size, behind * size);
  *total += count;
  *total -= old;
}

/* A wall that is carried round wheels already is somewhere on its way. */
static double start_of_first(const scree_world *world, const motion_range *r,
                             const scree_wall_motion *motions, size_t count) {
  if (count == 0) return 0;
  const scree_motion_state *old = &world->motions.items[r->motion];
  if (r->motion_count == 0 || !(old->radius > 0 && motions->radius > 0)) return motions->start;
  double rate;
  return old->start + law_at(old, &world->motion_rows.items[r->row], world->time, &rate) -
         old->origin;
}

scree_status scree_world_set_wall_motion(scree_world *world, size_t index,
                                         const scree_wall_motion *motions, size_t count,
                                         scree_error *error) {
  if (index >= world->walls.count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu of %zu", index,
                      world->walls.count);
  size_t row_count = 0;
  for (size_t i = 0; i < count; i++) {
    scree_status wrong = check_motion(&motions[i], index, i, error);
    if (wrong) return wrong;
    if (has_table(&motions[i])) row_count += motions[i].row_count;
  }
  SCREE_TRY(scree_world_change(world, SCREE_PART_WALLS, error));
  motion_range r = motions_of(world, index);
  if (!SCREE_RESERVE(&world->motions, world->motions.count + count) ||
      !SCREE_RESERVE(&world->motion_rows, world->motion_rows.count + row_count))
    return scree_fail_memory(error, row_count * sizeof(scree_motion_row), "motions of a wall");
  const double start = start_of_first(world, &r, motions, count);
  splice(world->motions.items, sizeof *world->motions.items, &world->motions.count, r.motion,
         r.motion_count, count);
  splice(world->motion_rows.items, sizeof *world->motion_rows.items, &world->motion_rows.count,
         r.row, r.row_count, row_count);
  scree_motion_row *rows = world->motion_rows.items + r.row;
  for (size_t i = 0; i < count; i++) {
    if (has_table(&motions[i])) copy_rows(&motions[i], rows);
    scree_motion_state *made = &world->motions.items[r.motion + i];
    *made = make_motion(&motions[i], rows, world->time);
    if (i == 0) made->start = start;
    rows += made->row_count;
  }
  scree_world_wall *wall = &world->walls.items[index];
  wall->motion_count = count;
  wall->start_position = wall->frame.position;
  wall->start_orientation = wall->orientation;
  wall_pose now =
      pose_at(wall, world->motions.items + r.motion, world->motion_rows.items + r.row, world->time);
  scree_wall_set_velocity(world, index, now.velocity, now.spin);
  return SCREE_OK;
}

scree_status scree_world_set_wall_velocity(scree_world *world, size_t index,
                                           const double velocity[3],
                                           const double angular_velocity[3], scree_error *error) {
  SCREE_TRY(scree_check_wall_velocities(world, index, velocity, angular_velocity, error));
  SCREE_TRY(scree_world_change(world, SCREE_PART_WALLS, error));
  if (world->walls.items[index].motion_count > 0)
    SCREE_TRY(scree_world_set_wall_motion(world, index, NULL, 0, error));
  scree_wall_set_velocity(world, index, vec3_load(velocity), vec3_load(angular_velocity));
  return SCREE_OK;
}
