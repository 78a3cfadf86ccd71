/* Wear is the work of sliding, whatever lay in the memory of the program before: bricks so soft
 * that a table which comes up parts from some of them, by an allocator that hands out large
 * numbers. Files of the walls are written in between, and change nothing. */
#include "report/program.h"
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"

/* Memory that is read before it is written reads as 1.4e306; what grows, too. */
static void *dirty_reallocate(void *context, void *block, size_t size) {
  enum { HEAD = 64 };
  (void)context;
  unsigned char *old = block ? (unsigned char *)block - HEAD : NULL;
  size_t had = 0;
  if (old) memcpy(&had, old, sizeof had);
  if (size == 0) {
    free(old);
    return NULL;
  }
  unsigned char *made = realloc(old, size + HEAD);
  if (!made) return NULL;
  if (size > had) memset(made + HEAD + had, 0x7f, size - had);
  memcpy(made, &size, sizeof size);
  return made + HEAD;
}

static const char text[] =
    "time: 0.03\n"
    "contact: {steps: 60}\n"
    "gravity: [0, 0, 0]\n"
    "materials: {grain: {young: 1e5, density: 2500, restitution: 0.4, friction: 0.4}, steel: "
    "{young: 1e9}}\n"
    "shapes: {brick: {box: [0.02, 0.015, 0.01], material: grain}}\n"
    "geometry:\n"
    "  table: {box: [0.3, 0.3, 0.05], at: [0, 0, -0.025], material: steel, motion: [{translate: "
    "{velocity: [0, 0, 9]}}]}\n"
    "  bar: {box: [0.3, 0.02, 0.02], at: [0, 0, 0.03], turn: {axis: [1, 0, 0], angle_deg: 45}, "
    "material: steel}\n"
    "inlets: {feed: {box: {min: [-0.1, -0.05, 0.06], max: [0.1, 0.05, 0.16]}, shapes: brick, "
    "count: "
    "40, velocity: [1, 0, -4]}}\n"
    "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
    "sensors: {table: {wall: table}, bar: {wall: bar}}\n";

typedef struct outcome {
  double wear, friction; /* J */
  uint64_t partings;
} outcome;

static outcome run(bool frames) {
  scree_error error;
  outcome out = {0};
  scree_observation o;
  scree_scene *scene = create(text);
  while (!scree_scene_end(scene)) {
    CHECK_OK(scree_scene_advance(scene, 20, &error), error);
    if (frames)
      CHECK_OK(scree_scene_walls_vtp_write(scene, in_folder("walls.vtp"), true, &error), error);
    scree_world_observe(scree_scene_view(scene), &o);
  }
  out.wear = now_of(scene, "table.wear") + now_of(scene, "bar.wear");
  for (size_t w = 0; w < scree_world_wall_count(scree_scene_view(scene)); w++) {
    double wear[12];
    assert_int_equal(scree_scene_wall_cells(scene, w), 12);
    assert_true(scree_scene_wall_map(scene, w, SCREE_MAP_WEAR, wear));
    for (size_t i = 0; i < 12; i++) assert_true(wear[i] >= 0);
  }
  out.friction = o.dissipated_friction;
  out.partings = o.depenetration_count;
  scree_scene_free(scene);
  return out;
}

static void is_the_work_of_sliding(void **state) {
  (void)state;
  outcome clean = run(false);
  scree_set_allocator(dirty_reallocate, NULL);
  outcome dirty = run(true);
  scree_set_allocator(NULL, NULL);
  print_message("wear %.6g J, friction %.6g J, %llu partings\n", clean.wear, clean.friction,
                (unsigned long long)clean.partings);
  assert_true(clean.partings > 0 && clean.wear > 0);
  assert_true(clean.wear < 1.2 * clean.friction); /* looked at some steps only */
  assert_true(dirty.wear == clean.wear && dirty.friction == clean.friction);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(is_the_work_of_sliding)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
