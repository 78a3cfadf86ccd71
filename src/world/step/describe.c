/* What is wrong after a step, in a sentence. */
#include "world/contact/law.h"
#include "world/contact/spheres.h"
#include "world/step/stages.h"

#include "base/error.h"

static const double pi = 3.14159265358979323846;

/* A body's shape in a few words. */
static const char *describe_shape(const scree_particle *p, char text[64]) {
  const scree_particle_measures *m = &p->measures;
  if (m->kind == SCREE_PARTICLE_MESH)
    snprintf(text, 64, "%zu triangles, size %.3g m", m->triangle_count, m->size);
  else
    snprintf(text, 64, "%zu sphere%s, size %.3g m", m->point_count, m->point_count == 1 ? "" : "s",
             m->size);
  return text;
}

/* The two of a trouble, as neighbours; where a pair of them is. */
static scree_neighbours neighbours_at(const scree_world *world, uint32_t k) {
  if (!(k & scree_of_spheres)) return world->list.neighbours.items[k];
  const scree_pair pair = scree_sphere_pair_of(world, k & ~scree_of_spheres);
  return (scree_neighbours){.a = pair.a, .b = pair.b, .spheres = true, .law = pair.law};
}

/* Their pair; one that touches nothing where they have none. */
static scree_pair pair_at(const scree_world *world, uint32_t k) {
  if (k & scree_of_spheres) return scree_sphere_pair_of(world, k & ~scree_of_spheres);
  const scree_pair *pair = scree_pair_of(world, k);
  const scree_neighbours *n = &world->list.neighbours.items[k];
  return pair ? *pair : (scree_pair){.a = n->a, .b = n->b, .wall = n->wall, .list = n->list};
}

/* "body 3 (60 triangles, size 0.022 m) VERB wall 0 (mesh)". */
static void describe_both(const scree_world *world, const scree_neighbours *n, const char *verb,
                          char text[256]) {
  static const char *const walls[] = {"plane", "disc", "cylinder", "mesh"};
  char a[64], b[64];
  describe_shape(world->bodies.particle[n->a], a);
  if (n->wall)
    snprintf(b, sizeof b, "%s", walls[world->walls.items[n->b].given.kind]);
  else
    describe_shape(world->bodies.particle[n->b], b);
  snprintf(text, 256, "body %u (%s) %s %s %u (%s)", n->a, a, verb, n->wall ? "wall" : "body", n->b,
           b);
}

/* Where the first is, and by how much stiffer springs would hold by what this one bears, and by the
 * speed at which they met; 0: that is not known. */
static void describe_demand(const scree_world *world, uint32_t k, double speed, char text[256]) {
  const scree_neighbours two = neighbours_at(world, k), *n = &two;
  const scree_pair pair = pair_at(world, k);
  const scree_pair_law *law = &n->law;
  const double asked = speed * law->contact_time / pi,
               borne = pair.touching ? scree_stiffness_missing(world, &pair) : 0,
               factor = scree_max(borne, asked * asked / (law->limit * law->limit));
  vec3 at = world->bodies.frame[n->a].position;
  size_t used = (size_t)snprintf(text, 256, "; at %.4g %.4g %.4g m", at.x, at.y, at.z);
  if (speed > 0) used += (size_t)snprintf(text + used, 256 - used, ", met at %.3g m/s", speed);
  if (factor > 1)
    snprintf(text + used, 256 - used,
             ": materials %.3g times as stiff would hold within the overlap limit of %.3g m",
             factor, law->limit);
}

static double relative_speed(const scree_world *world, const scree_neighbours *n) {
  const scree_frame *b = n->wall ? &world->walls.items[n->b].frame : &world->bodies.frame[n->b];
  vec3 arm = vec3_sub(world->bodies.frame[n->a].position, b->position);
  return vec3_distance(world->bodies.frame[n->a].velocity,
                       n->wall ? vec3_add(b->velocity, vec3_cross(b->spin, arm)) : b->velocity);
}

/* Finds what else presses most against the body of neighbours k, where that is
 * more than half of what k press with; scree_none in an impact. */
static uint32_t find_counterforce(const scree_world *world, uint32_t k, bool of_b) {
  const scree_pair two = pair_at(world, k);
  const uint32_t body = of_b ? two.b : two.a;
  const size_t neighbours = world->list.neighbours.count, pairs = world->spheres.list.pairs.count;
  double most = 0.5 * vec3_norm2(two.contact.wrench.force);
  uint32_t found = scree_none;
  for (size_t i = 0; i < neighbours + pairs; i++) {
    const uint32_t at = (uint32_t)(i < neighbours ? i : (i - neighbours) | scree_of_spheres);
    const scree_pair other = pair_at(world, at);
    const bool is_b = !other.wall && other.b == body;
    if (at == k || !other.touching || !(other.a == body || is_b)) continue;
    double against =
        vec3_dot(two.contact.wrench.force, other.contact.wrench.force) * (is_b == of_b ? -1 : 1);
    if (against > most) most = against, found = at;
  }
  return found;
}

static bool wall_moves(const scree_world *world, const scree_neighbours *n) {
  if (!n->wall) return false;
  const scree_frame *frame = &world->walls.items[n->b].frame;
  return vec3_norm2(frame->velocity) + vec3_norm2(frame->spin) > 0;
}

/* A wall that moves does so whatever stands against it. */
static bool describe_pinch(const scree_world *world, uint32_t k, char text[256]) {
  const scree_neighbours two = neighbours_at(world, k), *n = &two;
  bool of_b = false;
  uint32_t other = find_counterforce(world, k, of_b);
  if (other == scree_none && !n->wall) other = find_counterforce(world, k, of_b = true);
  if (other == scree_none) return false;
  const scree_neighbours others = neighbours_at(world, other), *m = &others;
  if (!wall_moves(world, n) && !wall_moves(world, m)) return false;
  const uint32_t body = of_b ? n->b : n->a;
  vec3 at = world->bodies.frame[body].position;
  snprintf(text, 256,
           "; at %.4g %.4g %.4g m, body %u is pinched between %s %u and %s %u with %.3g N: a wall "
           "that moves presses as hard as it takes, leave it more room there or less friction",
           at.x, at.y, at.z, body, n->wall ? "wall" : "body", of_b ? n->a : n->b,
           m->wall ? "wall" : "body", m->a == body ? m->b : m->a,
           vec3_norm(pair_at(world, k).contact.wrench.force));
  return true;
}

static scree_status describe_pressed(scree_world *world, uint32_t k) {
  const scree_neighbours two = neighbours_at(world, k), *n = &two;
  char demand[256];
  if (!describe_pinch(world, k, demand)) describe_demand(world, k, 0, demand);
  return scree_fail(&world->failure, SCREE_DIVERGED,
                    "world: step %llu, body %u is pressed through %s %u: by %.3g m, which no "
                    "spring holds%s",
                    (unsigned long long)world->step_count, n->a, n->wall ? "wall" : "body", n->b,
                    pair_at(world, k).contact.overlap, demand);
}

static scree_status describe_passed(scree_world *world, uint32_t k) {
  const scree_neighbours two = neighbours_at(world, k), *n = &two;
  const bool apart = !(k & scree_of_spheres) && !scree_pair_of(world, k);
  char both[256], demand[256];
  describe_both(world, n, "has come through", both);
  describe_demand(world, k, apart ? relative_speed(world, n) : pair_at(world, k).watch.speed,
                  demand);
  return scree_fail(&world->failure, SCREE_DIVERGED, "world: step %llu, %s%s",
                    (unsigned long long)world->step_count, both, demand);
}

static scree_status describe_speed(scree_world *world, uint32_t k) {
  const scree_neighbours two = neighbours_at(world, k), *n = &two;
  return scree_fail(&world->failure, SCREE_DIVERGED,
                    "world: step %llu, body %u moved past %s %u by more than %.3g m (the thinnest "
                    "wall of the two, or twice the overlap limit) in one step of %.3g s: shorter "
                    "steps see it",
                    (unsigned long long)world->step_count, n->a, n->wall ? "wall" : "body", n->b,
                    2 * n->law.thin, world->time_step);
}

static scree_status describe_start(scree_world *world, const scree_trouble *trouble) {
  const scree_neighbours two = neighbours_at(world, trouble->start), *n = &two;
  char both[256];
  describe_both(world, n, "and", both);
  return scree_fail(&world->failure, SCREE_DIVERGED,
                    "world: step %llu, %s lie %.3g m deep in each other from the start, or since "
                    "one was put there: put them apart",
                    (unsigned long long)world->step_count, both, trouble->start_depth);
}

scree_status scree_describe_trouble(scree_world *world, const scree_trouble *trouble) {
  const uint32_t found[] = {trouble->start, trouble->pressed, trouble->passed, trouble->too_fast};
  size_t first = 0;
  while (first < 3 && found[first] == scree_none) first++;
  const scree_neighbours two = neighbours_at(world, found[first]), *n = &two;
  world->failed_wall = n->wall ? (size_t)n->b + 1 : 0;
  if (trouble->start != scree_none) return describe_start(world, trouble);
  if (trouble->pressed != scree_none) return describe_pressed(world, trouble->pressed);
  if (trouble->passed != scree_none) return describe_passed(world, trouble->passed);
  return describe_speed(world, trouble->too_fast);
}
