/* Pouring: every particle enters once, inside the container, clear of the others; any cut into
 * calls and any number of threads give the same bits; what is recorded of it is where the bodies
 * were. */
#include "base/alloc.h"
#include "base/codec.h"
#include "base/file.h"
#include "report/pile_pack.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

#include <string.h>
#include <unistd.h>

static scree_particle *box_particle(double x, double y, double z) {
  return shape_particle(shape_box(x, y, z));
}

static scree_pour *make_pour(const scree_pour_options *options, size_t boxes, size_t balls) {
  scree_error error;
  scree_particle *box = box_particle(0.05, 0.03, 0.02), *ball = NULL;
  scree_pour *pour = NULL;
  CHECK_OK(scree_particle_sphere(0.012, &ball, &error), error);
  const scree_pour_shape shapes[] = {{box, boxes, "box", "box.stl, 12 triangles"},
                                     {.particle = ball, .count = balls}};
  CHECK_OK(scree_pour_create(shapes, 2, options, &pour, &error), error);
  scree_particle_free(box);
  scree_particle_free(ball);
  return pour;
}

static scree_pour_options soft_options(scree_container container, double width) {
  scree_pour_options o = scree_default_pour_options();
  o.world.stiffness_factor = 0.2;
  o.container = container;
  o.width = width;
  return o;
}

/* Bodies that entered since `before` are inside and apart from all that is there. */
static void check_entered(scree_pour *pour, size_t before) {
  scree_pour_options o;
  scree_pour_get_options(pour, &o);
  scree_world *world = scree_pour_world(pour);
  for (size_t i = before; i < scree_pour_entered_count(pour); i++) {
    scree_body a, b;
    scree_particle_measures ma, mb;
    scree_world_get_body(world, i, &a);
    scree_particle_measure(scree_world_body_particle(world, i), &ma);
    double x = fabs(a.position[0]), y = fabs(a.position[1]), r = ma.bounding_radius;
    if (o.container == SCREE_CONTAINER_BOX)
      assert_true(x + r <= 0.5 * o.width && y + r <= 0.5 * o.depth);
    else
      assert_true(sqrt(x * x + y * y) + r <= 0.5 * o.width);
    for (size_t j = 0; j < i; j++) {
      scree_world_get_body(world, j, &b);
      scree_particle_measure(scree_world_body_particle(world, j), &mb);
      double d2 = 0;
      for (int k = 0; k < 3; k++) d2 += pow(a.position[k] - b.position[k], 2);
      assert_true(sqrt(d2) > r + mb.bounding_radius);
    }
  }
}

static void all_enter_apart_from_each_other(void **state) {
  (void)state;
  const double widths[] = {0, 0.0645, 0.1, 0.21};
  for (int c = 0; c < 2; c++)
    for (int w = 0; w < 4; w++) {
      scree_pour_options o =
          soft_options(c ? SCREE_CONTAINER_BOX : SCREE_CONTAINER_CYLINDER, widths[w]);
      if (c && w == 2) o.depth = 0.3;
      scree_pour *pour = make_pour(&o, 7, 6);
      scree_error error;
      size_t shapes[2] = {0, 0}, entered = 0;
      for (int i = 0; i < 400000 && entered < 13; i++) {
        CHECK_OK(scree_pour_advance(pour, 1, &error), error);
        if (scree_pour_entered_count(pour) == entered) continue;
        check_entered(pour, entered);
        entered = scree_pour_entered_count(pour);
      }
      assert_int_equal(entered, 13);
      CHECK_NEAR(scree_world_time(scree_pour_world(pour)), scree_pour_filling_time(pour), 1e-4);
      for (size_t i = 0; i < 13; i++) shapes[scree_pour_shape_of(pour, i)]++;
      assert_int_equal(shapes[0], 7);
      assert_int_equal(shapes[1], 6);
      scree_pour_free(pour);
    }
}

static void cuts_and_threads_change_nothing(void **state) {
  (void)state;
  scree_checksum first = {0};
  const size_t cuts[] = {3000, 1, 77};
  for (int c = 0; c < 3; c++) {
    scree_error error;
    scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0.1);
    scree_set_threads(c + 1);
    scree_pour *pour = make_pour(&o, 9, 9);
    for (size_t done = 0; done < 3000;) {
      size_t steps = 3000 - done < cuts[c] ? 3000 - done : cuts[c];
      CHECK_OK(scree_pour_advance(pour, steps, &error), error);
      done += steps;
    }
    scree_checksum hash = scree_world_hash(scree_pour_world(pour));
    if (c == 0) first = hash;
    assert_true(hash.high == first.high && hash.low == first.low);
    scree_pour_free(pour);
  }
  scree_set_threads(0);
}

/* Steps another pour to each moment of the motion and compares; the last is that of the world
 * saved. */
static void check_motion(const scree_motion *m, const scree_pour_options *o) {
  scree_error error;
  scree_pour *beside = make_pour(o, 9, 9);
  const scree_world *world = scree_pour_view(beside);
  for (size_t f = 0; f < m->frame_count; f++) {
    assert_true(scree_world_time(world) <= m->time[f]);
    while (scree_world_time(world) < m->time[f])
      CHECK_OK(scree_pour_advance(beside, 1, &error), error);
    if (f + 1 < m->frame_count) /* a layer that enters at this moment is in */
      assert_true(m->time[f] >= (double)f * 1e-3 && m->time[f] < (double)(f + 1) * 1e-3);
    assert_true(m->time[f] == scree_world_time(world));
    for (size_t b = 0; b < scree_world_body_count(world); b++) {
      scree_body body;
      scree_world_get_body(world, b, &body);
      for (int k = 0; k < 3; k++)
        assert_true(m->poses[7 * (f * m->body_count + b) + (size_t)k] == (float)body.position[k]);
    }
  }
  scree_pour_free(beside);
}

/* Saved; a bit further, which is lost; and loaded again. */
static scree_pour *gone_on(scree_pour *pour) {
  scree_error error;
  CHECK_OK(scree_pour_save(pour, in_folder("saved"), true, &error), error);
  CHECK_OK(scree_pour_advance(pour, 300, &error), error);
  scree_pour_free(pour);
  CHECK_OK(scree_pour_load(in_folder("saved"), &pour, &error), error);
  CHECK_OK(scree_pour_record(pour, in_folder("motion.scree"), 1e-3, &error), error);
  return pour;
}

static void what_is_recorded_is_where_the_bodies_were(void **state) {
  (void)state;
  scree_checksum first = {0};
  const size_t cuts[] = {4000, 77, 1, 1500}; /* the last one is saved and goes on */
  scree_pour_options o = soft_options(SCREE_CONTAINER_BOX, 0.2);
  o.depth = 0.25;
  for (int c = 0; c < 4; c++) {
    scree_error error;
    scree_motion motion;
    scree_pour *pour = make_pour(&o, 9, 9);
    CHECK_OK(scree_pour_record(pour, in_folder("motion.scree"), 1e-3, &error), error);
    for (size_t done = 0; done < 4000;) {
      size_t steps = 4000 - done < cuts[c] ? 4000 - done : cuts[c];
      CHECK_OK(scree_pour_advance(pour, steps, &error), error);
      done += steps;
      if (c == 3) pour = gone_on(pour);
    }
    CHECK_OK(scree_pour_record_end(pour, &error), error);
    CHECK_OK(scree_world_save(scree_pour_view(pour), in_folder("last.world"), true, &error), error);
    CHECK_OK(scree_motion_read(in_folder("motion.scree"), &motion, &error), error);
    assert_true(motion.frame_count > 20 && motion.body_count == 18);
    scree_checksum sum =
        scree_checksum_of(motion.poses, 28 * motion.frame_count * motion.body_count);
    if (c == 0) first = sum;
    assert_true(sum.high == first.high && sum.low == first.low);
    if (c == 0) check_motion(&motion, &o);
    scree_motion_free(&motion);
    scree_pour_free(pour);
  }
}

/* The head of what the page gets: no disc, no cylinder, the box, two shapes; and that a motion of
 * another pour is not taken for this one's. */
static void the_page_gets_the_box(void **state) {
  (void)state;
  unsigned char *bytes = NULL, *still = NULL;
  size_t size, still_size;
  double sizes[4];
  scree_error error;
  CHECK_OK(scree_pile_pack(in_folder("last.world"), 1 << 20, &bytes, &size, &error), error);
  scree_codec in = {.source = bytes, .count = size, .loading = true};
  scree_code_reals(&in, sizes, 4);
  uint32_t shapes = 0;
  scree_code_u32(&in, &shapes); /* walls, which only scenes have */
  assert_int_equal(shapes, 0);
  scree_code_u32(&in, &shapes);
  assert_int_equal(shapes, 2);
  assert_true(sizes[0] == 0 && sizes[1] == 0);
  CHECK_NEAR(sizes[2], 0.2, 1e-12);
  CHECK_NEAR(sizes[3], 0.25, 1e-12);
  scree_pour_options o = soft_options(SCREE_CONTAINER_BOX, 0.1);
  scree_pour *other = make_pour(&o, 9, 9);
  CHECK_OK(scree_pour_record(other, in_folder("motion.scree"), 1e-3, &error), error);
  CHECK_OK(scree_pour_advance(other, 100, &error), error);
  scree_pour_free(other);
  CHECK_OK(scree_pile_pack(in_folder("last.world"), 1 << 20, &still, &still_size, &error), error);
  assert_true(still_size < size);
  scree_free(bytes);
  scree_free(still);
  CHECK_OK(scree_pile_pack(in_folder("none.world"), 1 << 20, &still, &still_size, &error), error);
  assert_null(still);
}

static void what_cannot_be_poured_is_refused(void **state) {
  (void)state;
  scree_error error;
  scree_pour *pour = NULL;
  scree_particle *box = box_particle(0.05, 0.03, 0.02);
  scree_pour_shape shape = {.particle = box, .count = 5};
  scree_pour_options o = scree_default_pour_options();
  o.width = 0.06;
  assert_int_equal(scree_pour_create(&shape, 1, &o, &pour, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "too narrow"));
  o = scree_default_pour_options();
  o.world.gravity[2] = 0;
  assert_int_equal(scree_pour_create(&shape, 1, &o, &pour, &error), SCREE_BAD_ARGUMENT);
  shape.count = 0;
  assert_int_equal(scree_pour_create(&shape, 1, NULL, &pour, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "no particles"));
  assert_null(pour);
  scree_particle_free(box);
  o = soft_options(SCREE_CONTAINER_BOX, 0.1);
  pour = make_pour(&o, 1, 1);
  assert_int_equal(scree_pour_record(pour, in_folder("x"), 0, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_pour_record(pour, in_folder("no/x"), 1, &error), SCREE_IO);
  scree_pour_free(pour);
}

/* Saved, freed and loaded again every 2000 steps, while layers enter and after. */
static void a_pour_goes_on_with_the_same_bits(void **state) {
  (void)state;
  scree_error error;
  for (int c = 0; c < 2; c++) {
    scree_pour_options o = soft_options(c ? SCREE_CONTAINER_BOX : SCREE_CONTAINER_CYLINDER, 0.15);
    scree_pour *whole = make_pour(&o, 9, 9), *cut = make_pour(&o, 9, 9);
    for (int i = 0; i < 100 && scree_pour_entered_count(cut) < 18; i++) {
      CHECK_OK(scree_pour_advance(whole, 2000, &error), error);
      CHECK_OK(scree_pour_advance(cut, 2000, &error), error);
      CHECK_OK(scree_pour_save(cut, in_folder("saved"), true, &error), error);
      scree_pour_free(cut);
      CHECK_OK(scree_pour_load(in_folder("saved"), &cut, &error), error);
      scree_checksum a = scree_world_hash(scree_pour_world(whole)),
                     b = scree_world_hash(scree_pour_world(cut));
      assert_true(a.high == b.high && a.low == b.low);
      assert_true(scree_pour_entered_energy(whole) == scree_pour_entered_energy(cut));
      assert_int_equal(scree_pour_entered_count(whole), scree_pour_entered_count(cut));
    }
    assert_int_equal(scree_pour_entered_count(cut), 18);
    assert_true(scree_pour_filling_time(whole) == scree_pour_filling_time(cut));
    assert_int_equal(scree_pour_shape_count(cut), 2);
    scree_pour_shape first = scree_pour_get_shape(cut, 0), second = scree_pour_get_shape(cut, 1);
    assert_int_equal(first.count, 9);
    assert_string_equal(first.name, "box");
    assert_string_equal(first.source, "box.stl, 12 triangles");
    assert_null(second.name);
    assert_null(second.source);
    scree_pour_free(whole);
    scree_pour_free(cut);
  }
}

/* No cut and no flipped byte is taken for a checkpoint. */
static void damaged_checkpoints_are_refused(void **state) {
  (void)state;
  static unsigned char bytes[1 << 20];
  const char *file = in_folder("saved");
  scree_error error;
  scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0.1);
  scree_pour *pour = make_pour(&o, 2, 2);
  CHECK_OK(scree_pour_advance(pour, 100, &error), error);
  CHECK_OK(scree_pour_save(pour, file, true, &error), error);
  assert_int_equal(scree_pour_save(pour, file, false, &error), SCREE_EXISTS);
  scree_pour_free(pour);
  FILE *stream = fopen(file, "rb");
  size_t size = fread(bytes, 1, sizeof bytes, stream);
  fclose(stream);
  for (size_t i = 0; i < 40; i++) {
    size_t at = i * (size - 1) / 39, length = i & 1 ? at : size;
    bytes[at] ^= 0x10;
    stream = fopen(file, "wb");
    fwrite(bytes, 1, length, stream);
    fclose(stream);
    bytes[at] ^= 0x10;
    assert_int_equal(scree_pour_load(file, &pour, &error), SCREE_BAD_FILE);
    assert_non_null(strstr(error.message, file));
  }
}

static scree_status save_and_load(void *context, scree_error *error) {
  scree_pour *pour = NULL;
  scree_status status = scree_pour_save(context, in_folder("saved"), true, error);
  if (status == SCREE_OK) status = scree_pour_load(in_folder("saved"), &pour, error);
  scree_pour_free(pour);
  return status;
}

static scree_status pour_all(void *context, scree_error *error) {
  const scree_pour_shape shape = {context, 3, "box", "box.stl"};
  scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0);
  const char *name = "box";
  scree_pour_entry entry = {.names = &name};
  scree_pour *pour = NULL;
  scree_status status = scree_pour_create(&shape, 1, &o, &pour, error);
  if (status == SCREE_OK) status = scree_pour_record(pour, in_folder("m"), 1e-4, error);
  if (status == SCREE_OK) status = scree_pour_advance(pour, 10, error);
  if (status == SCREE_OK) status = scree_pour_record_end(pour, error);
  entry.pour = pour;
  if (status == SCREE_OK) status = scree_pour_json_write(&entry, in_folder("j"), true, error);
  scree_pour_free(pour);
  return status;
}

static scree_status complete(void *context, scree_error *error) {
  const scree_pour_shape shape = {context, 3, "box", "box.stl"};
  scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0);
  scree_pour *pour = NULL;
  scree_pour_job job = {.shapes = &shape,
                        .shape_count = 1,
                        .options = &o,
                        .schedule = {.time = 0, .series = 1, .checkpoint = 60},
                        .folder = in_folder("complete"),
                        .overwrite = true};
  scree_status status = scree_pour_complete(&job, &pour, error);
  scree_pour_free(pour);
  if (status != SCREE_OK) return status;
  pour = NULL;
  job.shape_count = 0; /* those of the checkpoint */
  job.resume = true;
  status = scree_pour_complete(&job, &pour, error);
  scree_pour_free(pour);
  return status;
}

/* Ends a second after the last has entered, or when it has been still for as long as is said. */
static void a_whole_pour_ends_as_asked(void **state) {
  (void)state;
  scree_error error;
  scree_particle *box = box_particle(0.05, 0.03, 0.02);
  const scree_pour_shape shape = {box, 5, "box", NULL};
  scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0.2);
  for (int still = 0; still < 2; still++) {
    scree_pour *pour = NULL;
    const scree_pour_job job = {.shapes = &shape,
                                .shape_count = 1,
                                .options = &o,
                                .schedule = {.time = still ? 5 : 0.02,
                                             .still = still ? 1e-3 : 0,
                                             .rest = 0.05,
                                             .series = 0.01,
                                             .checkpoint = 60}};
    CHECK_OK(scree_pour_complete(&job, &pour, &error), error);
    double time = scree_world_time(scree_pour_view(pour)), filled = scree_pour_filling_time(pour);
    assert_int_equal(scree_pour_entered_count(pour), 5);
    assert_string_equal(scree_scene_end(scree_pour_scene(pour)),
                        still ? "still" : "the time after filling is over");
    if (still)
      assert_true(time > filled + 0.05 && time < filled + 5);
    else
      CHECK_NEAR(time, filled + 0.02, 5e-3);
    scree_pour_free(pour);
  }
  scree_particle_free(box);
}

static void memory_running_out_is_told(void **state) {
  (void)state;
  scree_particle *box = box_particle(0.05, 0.03, 0.02);
  check_allocation_failures(pour_all, box);
  check_allocation_failures(complete, box);
  scree_particle_free(box);
  scree_error error;
  scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0.1);
  scree_pour *pour = make_pour(&o, 2, 2);
  CHECK_OK(scree_pour_advance(pour, 100, &error), error);
  check_allocation_failures(save_and_load, pour);
  scree_pour_free(pour);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_enter_apart_from_each_other),
      cmocka_unit_test(cuts_and_threads_change_nothing),
      cmocka_unit_test(what_is_recorded_is_where_the_bodies_were),
      cmocka_unit_test(the_page_gets_the_box),
      cmocka_unit_test(what_cannot_be_poured_is_refused),
      cmocka_unit_test(a_pour_goes_on_with_the_same_bits),
      cmocka_unit_test(damaged_checkpoints_are_refused),
      cmocka_unit_test(a_whole_pour_ends_as_asked),
      cmocka_unit_test(memory_running_out_is_told),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
