/* Materials and what two of them do to each other.
 *
 * The dashpot's eta follows from the restitution e of a linear spring and dashpot whose force is
 * cut off at zero (Schwager and Poeschel 2007, Granular Matter 9, 465, eq. 20 to 22), with w =
 * sqrt(|1 - eta^2|): eta < 1:  e = exp(-eta/w (pi - atan2(2 eta w, 1 - 2 eta^2))) eta > 1:  e =
 * exp(-eta/w ln((eta + w)/(eta - w))) e falls monotonically with eta, so bisection finds it.
 *
 * Hertz's spring h m^3/2 with the dashpot alpha (m* h)^1/2 m^1/4 of Tsuji, Tanaka and Ishida
 * (Powder Technology 71, 239, 1992) has an e that no speed changes. Theirs is of a force that may
 * pull; here it is cut off at zero too, and e follows from the motion itself: x'' = -max(0, x^3/2 +
 * alpha x^1/4 x') from x = 0, x' = 1. */
#include "world/state/materials.h"
#include "world/state/parameters.h"
#include "world/state/remote.h"

scree_material scree_default_material(void) {
  return (scree_material){
      .young = 1e8, .density = 2000, .restitution = 0.3, .friction = 0.5, .poisson = 0.3};
}

scree_material scree_default_wall_material(void) {
  return (scree_material){
      .young = 1e11, .density = 2000, .restitution = 0.3, .friction = 0.5, .poisson = 0.3};
}

static double restitution_of(double eta) {
  const double pi = 3.14159265358979323846;
  if (eta == 1) return scree_exp(-2);
  double w = sqrt(fabs(1 - eta * eta));
  if (eta < 1) return scree_exp(-eta / w * (pi - scree_atan2(2 * eta * w, 1 - 2 * eta * eta)));
  return scree_exp(-eta / w * scree_log((eta + w) * (eta + w))); /* (eta - w)(eta + w) = 1 */
}

double scree_damping_ratio(double restitution) {
  if (restitution >= 1) return 0;
  double low = 0, high = 1;
  while (restitution_of(high) > restitution && high < 1e6) high *= 2;
  for (int i = 0; i < 100; i++) {
    double middle = 0.5 * (low + high);
    if (restitution_of(middle) > restitution)
      low = middle;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}

static double hertz_acceleration(double alpha, double x, double v) {
  if (!(x > 0)) return 0;
  double root = sqrt(x), force = x * root + alpha * sqrt(root) * v;
  return force > 0 ? -force : 0;
}

/* By Runge and Kutta's fourth order, in steps that grow from the begin, where x^1/4 has no slope.
 */
static double hertz_restitution_of(double alpha) {
  const double most = 100;
  double x = 0, v = 1, step = 1e-6;
  for (double t = 0; t < most && (x > 0 || v > 0); t += step, step = fmin(1.2 * step, 0.01)) {
    double a1 = hertz_acceleration(alpha, x, v), v2 = v + 0.5 * step * a1,
           a2 = hertz_acceleration(alpha, x + 0.5 * step * v, v2), v3 = v + 0.5 * step * a2,
           a3 = hertz_acceleration(alpha, x + 0.5 * step * v2, v3), v4 = v + step * a3,
           a4 = hertz_acceleration(alpha, x + step * v3, v4);
    x += step / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return -v;
}

double scree_hertz_damping(double restitution) {
  if (restitution >= 1) return 0;
  double low = 0, high = 1;
  while (hertz_restitution_of(high) > restitution && high < 1e3) high *= 2;
  for (int i = 0; i < 40; i++) {
    double middle = 0.5 * (low + high);
    if (hertz_restitution_of(middle) > restitution)
      low = middle;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}

static scree_status check_contact(const scree_material_contact *c, scree_error *error) {
  if (!(c->restitution > 0 && c->restitution <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: restitution %g; above 0, at most 1",
                      c->restitution);
  const struct {
    const char *name;
    double value;
  } others[] = {{"friction", c->friction},
                {"rolling friction", c->rolling_friction},
                {"pull-off force, N:", c->pull_off},
                {"surface energy, J/m2:", c->surface_energy}};
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    if (!(others[i].value >= 0 && isfinite(others[i].value)))
      return scree_fail(error, SCREE_BAD_ARGUMENT, "world: %s %g; at least 0", others[i].name,
                        others[i].value);
  return SCREE_OK;
}

static scree_material_pair make_contact(const scree_world *world,
                                        const scree_material_contact *given) {
  bool hertz = world->options.law == SCREE_LAW_HERTZ;
  return (scree_material_pair){*given, scree_damping_ratio(given->restitution),
                               hertz ? scree_hertz_damping(given->restitution) : 0};
}

static scree_material_contact contact_of(const scree_material *a, const scree_material *b) {
  return (scree_material_contact){
      .restitution = scree_min(a->restitution, b->restitution),
      .friction = scree_min(a->friction, b->friction),
      .rolling_friction = scree_min(a->rolling_friction, b->rolling_friction),
      .surface_energy = scree_min(a->surface_energy, b->surface_energy)};
}

scree_status scree_world_add_material(scree_world *world, const scree_material *material,
                                      size_t *index, scree_error *error) {
  if (world->materials.count == SCREE_MATERIALS)
    return scree_fail(error, SCREE_LIMIT, "world: at most %d materials", SCREE_MATERIALS);
  if (!(material->young > 0 && isfinite(material->young)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: young %g N/m2; above 0", material->young);
  if (!(material->density > 0 && isfinite(material->density)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: density %g kg/m3; above 0",
                      material->density);
  if (!(material->poisson >= 0 && material->poisson <= 0.5))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: Poisson's ratio %g; 0 to 0.5",
                      material->poisson);
  scree_material_contact own = contact_of(material, material);
  SCREE_TRY(check_contact(&own, error));
  SCREE_TRY(scree_world_change(world, SCREE_ALL_PARTS, error));
  size_t k = world->materials.count++;
  world->materials.items[k] = *material;
  for (size_t i = 0; i <= k; i++) {
    scree_material_contact contact = contact_of(material, &world->materials.items[i]);
    world->materials.contacts[i][k] = world->materials.contacts[k][i] =
        make_contact(world, &contact);
  }
  if (index) *index = k;
  return SCREE_OK;
}

static scree_status check_materials(const scree_world *world, size_t a, size_t b,
                                    scree_error *error) {
  if (a < world->materials.count && b < world->materials.count) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT, "world: material %zu of %zu", a > b ? a : b,
                    world->materials.count);
}

scree_status scree_world_get_pair(const scree_world *world, size_t a, size_t b,
                                  scree_material_contact *contact, scree_error *error) {
  SCREE_TRY(check_materials(world, a, b, error));
  *contact = world->materials.contacts[a][b].given;
  return SCREE_OK;
}

scree_status scree_world_set_pair(scree_world *world, size_t a, size_t b,
                                  const scree_material_contact *contact, scree_error *error) {
  SCREE_TRY(check_materials(world, a, b, error));
  SCREE_TRY(check_contact(contact, error));
  SCREE_TRY(scree_world_change(world, SCREE_ALL_PARTS, error));
  world->materials.contacts[a][b] = world->materials.contacts[b][a] = make_contact(world, contact);
  scree_neighbours_set_up(world);
  world->time_step_stale = true;
  return SCREE_OK;
}

scree_status scree_world_set_contact(scree_world *world, size_t a, size_t b, double restitution,
                                     double friction, scree_error *error) {
  scree_material_contact contact;
  SCREE_TRY(scree_world_get_pair(world, a, b, &contact, error));
  contact.restitution = restitution;
  contact.friction = friction;
  return scree_world_set_pair(world, a, b, &contact, error);
}
