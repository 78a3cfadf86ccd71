/* Materials and what two of them do to each other.
 *
 * The dashpot's eta follows from the restitution e of a linear spring and dashpot whose force is
 * cut off at zero (Schwager and Poeschel 2007, Granular Matter 9, 465, eq. 20 to 22), with w =
 * sqrt(|1 - eta^2|): eta < 1:  e = exp(-eta/w (pi - atan2(2 eta w, 1 - 2 eta^2))) eta > 1:  e =
 * exp(-eta/w ln((eta + w)/(eta - w))) e falls monotonically with eta, so bisection finds it. */
#include "world/world.h"

scree_material scree_default_material(void) {
  return (scree_material){.stiffness = 1e8, .density = 2000, .restitution = 0.3, .friction = 0.5};
}

scree_material scree_default_wall_material(void) {
  return (scree_material){.stiffness = 1e11, .density = 2000, .restitution = 0.3, .friction = 0.5};
}

static double restitution_of(double eta) {
  const double pi = 3.14159265358979323846;
  if (eta == 1) return exp(-2);
  double w = sqrt(fabs(1 - eta * eta));
  if (eta < 1) return exp(-eta / w * (pi - atan2(2 * eta * w, 1 - 2 * eta * eta)));
  return exp(-eta / w * log((eta + w) * (eta + w))); /* (eta - w)(eta + w) = 1 */
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

static scree_status check_contact(double restitution, double friction, scree_error *error) {
  if (!(restitution > 0 && restitution <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: restitution %g; above 0, at most 1",
                      restitution);
  if (!(friction >= 0 && isfinite(friction)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: friction %g; at least 0", friction);
  return SCREE_OK;
}

static scree_material_pair make_contact(double restitution, double friction, bool given) {
  return (scree_material_pair){restitution, friction, scree_damping_ratio(restitution), given};
}

scree_status scree_world_add_material(scree_world *world, const scree_material *material,
                                      size_t *index, scree_error *error) {
  if (world->material_count == SCREE_MATERIALS)
    return scree_fail(error, SCREE_LIMIT, "world: at most %d materials", SCREE_MATERIALS);
  if (!(material->stiffness > 0 && isfinite(material->stiffness)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: stiffness %g N/m2; above 0",
                      material->stiffness);
  if (!(material->density > 0 && isfinite(material->density)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: density %g kg/m3; above 0",
                      material->density);
  scree_status status = check_contact(material->restitution, material->friction, error);
  if (status) return status;
  size_t k = world->material_count++;
  world->materials[k] = *material;
  for (size_t i = 0; i <= k; i++) {
    const scree_material *other = &world->materials[i];
    world->contacts[i][k] = world->contacts[k][i] =
        make_contact(fmin(material->restitution, other->restitution),
                     fmin(material->friction, other->friction), false);
  }
  if (index) *index = k;
  return SCREE_OK;
}

scree_status scree_world_set_contact(scree_world *world, size_t a, size_t b, double restitution,
                                     double friction, scree_error *error) {
  if (a >= world->material_count || b >= world->material_count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: material %zu of %zu", a > b ? a : b,
                      world->material_count);
  scree_status status = check_contact(restitution, friction, error);
  if (status) return status;
  world->contacts[a][b] = world->contacts[b][a] = make_contact(restitution, friction, true);
  scree_neighbours_set_up(world);
  return SCREE_OK;
}
