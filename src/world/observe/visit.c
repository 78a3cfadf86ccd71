/* Contacts for reports: every pair is evaluated once more at the present positions on a copy of its
 * memory, so that looking changes nothing. A pair that takes its step in parts moves by the mean of
 * their forces: its contacts share what this one lacks of it, by their weights. */
#include "world/contact/spheres.h"
#include "world/observe/replay.h"
#include "world/state/remote.h"

static bool report(const scree_world *world, const scree_pair *pair,
                   const scree_contact_point *point, scree_contact_visitor *visit, void *context) {
  const scree_frame *b = scree_pair_frame_b(world, pair);
  scree_contact contact = {.body = pair->a,
                           .other = pair->b,
                           .wall = pair->wall,
                           .overlap = point->overlap,
                           .weight = point->weight};
  const scree_frame *a = &world->bodies.frame[pair->a]; /* the contact lies where a is told to be */
  vec3 from_a =
      vec3_sub(mat3_mul_vec(&b->rotation, point->at), scree_pair_between(world, pair, a, b));
  bool folded = scree_world_is_periodic(world);
  vec3_store(contact.position, folded
                                   ? vec3_add(from_a, scree_world_fold(world, a->position))
                                   : vec3_add(mat3_mul_vec(&b->rotation, point->at), b->position));
  /* of spheres, which stand in the order of space, the first is named first too */
  const bool turned = !pair->wall && pair->a > pair->b;
  const vec3 normal = mat3_mul_vec(&b->rotation, point->normal),
             force = mat3_mul_vec(&b->rotation, point->force);
  vec3_store(contact.normal, turned ? vec3_neg(normal) : normal);
  vec3_store(contact.force, turned ? vec3_neg(force) : force);
  if (turned) contact.body = pair->b, contact.other = pair->a;
  return visit(context, &contact);
}

static void share_mean(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy) {
  scree_contact_list *contacts = &copy->scratch.contacts;
  if (pair->substeps.count <= 1) return;
  double weights = 0;
  for (size_t i = 0; i < contacts->count; i++) weights += fmax(0, contacts->items[i].weight);
  vec3 lacks = vec3_sub(pair->contact.wrench.force, copy->pair.contact.wrench.force);
  lacks = mat3_tmul_vec(&scree_pair_frame_b(world, pair)->rotation, lacks);
  for (size_t i = 0; i < contacts->count; i++)
    if (contacts->items[i].weight > 0)
      contacts->items[i].force =
          vec3_mad(contacts->items[i].force, lacks, contacts->items[i].weight / weights);
}

/* False when memory is out; *going: whether the visitor wants more. */
static bool visit_pair(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy,
                       scree_contact_visitor *visit, void *context, bool *going) {
  if (!pair || !pair->touching || scree_pair_is_removed(world, pair)) return true;
  if (!scree_copy_pair(world, pair, copy) || !scree_evaluate_copy(world, copy)) return false;
  share_mean(world, pair, copy);
  const scree_contact_list *contacts = &copy->scratch.contacts;
  for (size_t i = 0; i < contacts->count && *going && copy->pair.touching; i++)
    if (contacts->items[i].weight > 0)
      *going = report(world, &copy->pair, &contacts->items[i], visit, context);
  return true;
}

scree_status scree_world_visit_contacts(const scree_world *world, scree_contact_visitor *visit,
                                        void *context, scree_error *error) {
  SCREE_TRY(scree_world_bring(world, SCREE_ALL_PARTS, error));
  scree_pair_copy copy = {0};
  bool good = true, going = true;
  for (size_t k = 0; k < world->list.neighbours.count && good && going; k++)
    good = visit_pair(world, scree_pair_of(world, k), &copy, visit, context, &going);
  for (size_t k = 0; k < world->spheres.list.pairs.count && good && going; k++) {
    const scree_pair pair = scree_sphere_pair_of(world, k);
    good = visit_pair(world, &pair, &copy, visit, context, &going);
  }
  scree_free_pair_copy(&copy);
  return good ? SCREE_OK : scree_fail_memory(error, 0, "contacts");
}
