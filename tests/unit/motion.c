/* The motion of a scene on disk and in the page: against the scene stepped beside it, through
 * interruptions and damage; what the page gets of it against a plain decoder. */
#include "base/alloc.h"
#include "base/codec.h"
#include "base/file.h"
#include "report/page_parts.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/law.h"
#include "support/pot.h"
#include "support/scene.h"

#include <meshoptimizer.h>
#include <unistd.h>

enum { WALLS = 2, BODIES = 12 };

/* Six spheres and six chips. */
static scree_scene_file *make_pot(void) {
  scree_error error;
  scree_mesh chip;
  scree_sample_options options = scree_default_sample_options();
  scree_write_options written = scree_default_write_options();
  written.overwrite = true;
  options.resolution = 4e-3;
  CHECK_OK(scree_sample_make("icosphere-2", &options, NULL, &chip, &error), error);
  for (size_t i = 0; i < 3 * chip.vertex_count; i++)
    chip.positions[i] *= (i % 3 == 2 ? 0.3 : 1) * 0.012 / 0.05;
  CHECK_OK(scree_mesh_write(&chip, in_folder("chip.ply"), &written, &error), error);
  scree_mesh_free(&chip);
  const scree_poured shapes[] = {{"ball", "sphere", "0.02", 1},
                                 {"chip", "file", in_folder("chip.ply"), 1}};
  scree_scene_file *file = pot_file("12", shapes, 2);
  set_field(file, "disc.diameter", "0.1"); /* some fall off and are taken out */
  set_field(file, "phases.hold_time", "0.8");
  set_field(file, "friction_all", "0.05");
  return file;
}

static bool count_down(void *context, const scree_scene_state *state) {
  (void)state;
  size_t *left = context;
  return *left == 0 || (*left)-- == 0;
}

/* The whole scene in a folder, cancelled so many times. */
static void complete(const scree_scene_file *file, const char *name, size_t cancel_count) {
  scree_scene *scene = NULL;
  scree_error error;
  scree_status status;
  size_t left = cancel_count, cancelled = 0;
  scree_scene_job job = {.file = file,
                         .folder = in_folder(name),
                         .states = true,
                         .resume = cancel_count > 0,
                         .overwrite = true,
                         .watch = count_down,
                         .context = &left};
  while ((status = scree_scene_complete(&job, &scene, &error)) == SCREE_CANCELLED) {
    char path[80];
    cancelled++;
    scree_scene_free(scene);
    scene = NULL;
    snprintf(path, sizeof path, "%s/motion.scree", name);
    FILE *stream = fopen(in_folder(path), "ab"); /* as if killed while a frame was written */
    fputs("part of a frame, which is longer than its header alone", stream);
    fclose(stream);
    job.folder = in_folder(name);
  }
  CHECK_OK(status, error);
  assert_int_equal(cancelled, cancel_count);
  scree_scene_free(scene);
}

static scree_motion read_motion(const char *name) {
  scree_motion m;
  scree_error error;
  CHECK_OK(scree_motion_read(in_folder(name), &m, &error), error);
  return m;
}

/* Steps the scene to a time and compares every wall and body. */
static size_t check_frame(scree_scene *scene, const scree_motion *m, size_t frame) {
  scree_error error;
  const scree_world *world = scree_scene_view(scene);
  size_t there = 0;
  while (scree_world_time(world) < m->time[frame])
    CHECK_OK(scree_scene_advance(scene, 1, &error), error);
  assert_true(scree_world_time(world) == m->time[frame]);
  for (size_t w = 0; w < WALLS; w++) {
    scree_wall wall;
    scree_world_get_wall(world, w, &wall);
    for (int k = 0; k < 3; k++)
      assert_true(m->poses[7 * (frame * m->body_count + w) + (size_t)k] == (float)wall.position[k]);
  }
  for (size_t b = 0; b < BODIES; b++) {
    const float *pose = m->poses + 7 * (frame * m->body_count + WALLS + b);
    scree_body body;
    bool in = b < scree_world_body_count(world) && !scree_world_body_removed(world, b);
    assert_int_equal(in, !isnan(pose[0]));
    if (!in) continue;
    there++;
    scree_world_get_body(world, b, &body);
    for (int k = 0; k < 3; k++) assert_true(pose[k] == (float)body.position[k]);
    for (int k = 0; k < 4; k++)
      CHECK_NEAR((double)pose[3 + k], body.orientation[k], 0.5 / 32767 + 1e-7);
  }
  return there;
}

static void every_frame_is_the_scene_at_its_time(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  scree_error error;
  complete(file, "whole", 0);
  scree_motion m = read_motion("whole/motion.scree");
  scree_scene *scene = pot_scene(file);
  size_t there = 0, most = 0;
  double interval = (0.1 + 0.05 + 0.08 + 0.8) / 240;
  assert_int_equal(m.body_count, WALLS + BODIES);
  assert_true(m.frame_count > 200 && m.frame_count <= 242);
  for (size_t f = 0; f < m.frame_count; f++) {
    if (f + 1 < m.frame_count) CHECK_NEAR(m.time[f], (double)f * interval, interval);
    there = check_frame(scene, &m, f);
    most = there > most ? there : most;
  }
  CHECK_OK(scree_scene_advance(scene, 1, &error), error); /* finds that it is over */
  assert_non_null(scree_scene_end(scene));
  assert_true(scree_world_time(scree_scene_view(scene)) == m.time[m.frame_count - 1]);
  assert_true(most == BODIES && there < most); /* some fell off */
  scree_motion_free(&m);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

static void an_interrupted_scene_leaves_the_same_file(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  char *whole, *pieces;
  size_t whole_size, pieces_size;
  scree_error error;
  complete(file, "pieces", 9);
  CHECK_OK(scree_file_read(in_folder("whole/motion.scree"), 0, &whole, &whole_size, &error), error);
  CHECK_OK(scree_file_read(in_folder("pieces/motion.scree"), 0, &pieces, &pieces_size, &error),
           error);
  assert_int_equal(pieces_size, whole_size);
  assert_memory_equal(pieces, whole, whole_size);
  scree_free(whole);
  scree_free(pieces);
  scree_scene_file_free(file);
}

static void write_bytes(const char *name, const char *bytes, size_t count) {
  FILE *stream = fopen(in_folder(name), "wb");
  assert_int_equal(fwrite(bytes, 1, count, stream), count);
  fclose(stream);
}

static void what_is_cut_or_damaged_ends_the_motion(void **state) {
  (void)state;
  char *bytes;
  size_t size;
  scree_error error;
  scree_motion whole = read_motion("whole/motion.scree"), m;
  CHECK_OK(scree_file_read(in_folder("whole/motion.scree"), 0, &bytes, &size, &error), error);
  size_t frame = 40 + 20 * whole.body_count;
  for (size_t cut = 1; cut <= frame + 1; cut += 13) {
    write_bytes("cut", bytes, size - cut);
    m = read_motion("cut");
    assert_int_equal(m.frame_count, whole.frame_count - 1 - (cut > frame));
    scree_motion_free(&m);
  }
  bytes[size - frame + 45] ^= 1; /* in a body of the last frame */
  write_bytes("cut", bytes, size);
  m = read_motion("cut");
  assert_int_equal(m.frame_count, whole.frame_count - 1);
  scree_motion_free(&m);
  for (size_t count = 0; count < 56; count += 8) { /* no frame at all */
    write_bytes("cut", bytes, count);
    assert_int_equal(scree_motion_read(in_folder("cut"), &m, &error), SCREE_BAD_FILE);
  }
  bytes[9] ^= 1; /* the version */
  write_bytes("cut", bytes, size);
  assert_int_equal(scree_motion_read(in_folder("cut"), &m, &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "no motion of a run"));
  scree_motion_free(&whole);
  scree_free(bytes);
}

/* ---- the page's ---- */

typedef struct packed {
  unsigned char *bytes;
  size_t size;
  scree_codec in;
  double low[3], step, *times;
  size_t frame_count, body_count, triangle_count[2];
  double *walls; /* 7 per moment, moments of a wall together */
  uint32_t *shapes;
  uint16_t *tracks; /* 8 per moment, moments of a body together */
} packed;

static uint32_t u32(packed *f) {
  uint32_t value = 0;
  scree_code_u32(&f->in, &value);
  return value;
}

static void *vertices(packed *f, size_t count, size_t size) {
  size_t bytes = u32(f);
  void *out = calloc(count + 1, size);
  assert_int_equal(
      meshopt_decodeVertexBuffer(out, count, size, f->in.source + f->in.position, bytes), 0);
  f->in.position += bytes;
  return out;
}

/* Its triangles in the shape itself. */
static size_t skip_surface(packed *f) {
  f->in.position += u32(f) + 4 + 32; /* its name, count and grid */
  uint32_t vertex_count = u32(f), triangle_count = u32(f);
  free(vertices(f, vertex_count, 8));
  f->in.position += u32(f);
  return triangle_count;
}

static packed pack(const char *name, size_t limit) {
  packed f = {0};
  scree_error error;
  char file[80];
  snprintf(file, sizeof file, "%s/last.scree", name);
  CHECK_OK(scree_pile_pack(in_folder(file), limit, &f.bytes, &f.size, &error), error);
  f.in = (scree_codec){.source = f.bytes, .count = f.size, .loading = true};
  assert_int_equal(u32(&f), WALLS);
  for (size_t i = 0; i < WALLS; i++) {
    (void)u32(&f); /* whether it is endless */
    (void)skip_surface(&f);
    assert_int_equal(u32(&f), 0); /* maps: no sensor looks at a wall */
  }
  assert_int_equal(u32(&f), 2);
  for (size_t i = 0; i < 2; i++) f.triangle_count[i] = skip_surface(&f);
  f.body_count = u32(&f);
  f.shapes = vertices(&f, f.body_count, 4);
  assert_int_equal(u32(&f), 0); /* fragments: there are no joints */
  scree_code_reals(&f.in, f.low, 3);
  scree_code_real(&f.in, &f.step);
  f.frame_count = u32(&f);
  f.times = calloc(f.frame_count, sizeof *f.times);
  scree_code_reals(&f.in, f.times, f.frame_count);
  f.walls = calloc(WALLS * f.frame_count, 7 * sizeof *f.walls);
  scree_code_reals(&f.in, f.walls, WALLS * f.frame_count * 7);
  f.tracks = vertices(&f, f.frame_count * f.body_count, 16);
  assert_false(f.in.failed);
  assert_int_equal(f.in.position, f.in.count);
  return f;
}

static void free_packed(packed *f) {
  scree_free(f->bytes);
  free(f->times);
  free(f->walls);
  free(f->shapes);
  free(f->tracks);
}

static void check_packed(const packed *f, const scree_motion *m) {
  size_t frame = 0;
  for (size_t k = 0; k < f->frame_count; k++) {
    while (frame < m->frame_count && m->time[frame] != f->times[k]) frame++;
    assert_true(frame < m->frame_count);
    for (size_t i = 0; i < 7 * WALLS; i++)
      assert_true(f->walls[7 * (i / 7 * f->frame_count + k) + i % 7] ==
                  (double)m->poses[7 * frame * m->body_count + i]);
    for (size_t b = 0; b < f->body_count; b++) {
      const uint16_t *moment = f->tracks + 8 * (b * f->frame_count + k);
      const float *pose = m->poses + 7 * (frame * m->body_count + WALLS + b);
      assert_int_equal(moment[3], !isnan(pose[0]));
      double sign = 0;
      for (int i = 0; i < 4; i++) sign += (double)pose[3 + i] * (int16_t)moment[4 + i];
      sign = sign < 0 ? -1 : 1;
      for (int i = 0; i < 3 && moment[3]; i++)
        CHECK_NEAR(f->low[i] + f->step * moment[i], (double)pose[i], 0.501 * f->step);
      for (int i = 0; i < 4 && moment[3]; i++)
        CHECK_NEAR(sign * (int16_t)moment[4 + i] / 32767, (double)pose[3 + i], 1e-6);
    }
  }
  assert_int_equal(frame, m->frame_count - 1); /* the end is always there */
}

static void the_page_gets_every_frame_or_those_that_fit(void **state) {
  (void)state;
  scree_motion m = read_motion("whole/motion.scree");
  packed all = pack("whole", 1 << 20), some = pack("whole", 24000), one = pack("whole", 1);
  assert_int_equal(all.frame_count, m.frame_count);
  assert_int_equal(all.triangle_count[0], 320); /* the sphere */
  assert_int_equal(all.triangle_count[1], 320);
  check_packed(&all, &m);
  assert_true(some.size <= 24000 && some.frame_count < all.frame_count && some.frame_count > 20);
  check_packed(&some, &m);
  assert_int_equal(one.frame_count, 2);
  check_packed(&one, &m);
  for (size_t b = 0; b < all.body_count; b++) assert_true(all.shapes[b] < 2);
  free_packed(&all);
  free_packed(&some);
  free_packed(&one);
  scree_motion_free(&m);
}

/* A motion that another scene left: its last frame is not that of last.scree. */
static void a_motion_of_another_scene_is_not_shown(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  set_field(file, "seed", "2");
  complete(file, "other", 0);
  const char *from = in_folder("whole/motion.scree"), *to = in_folder("other/motion.scree");
  packed own = pack("other", 1 << 20);
  assert_true(own.frame_count > 200);
  assert_int_equal(rename(from, to), 0);
  packed mixed = pack("other", 1 << 20), still = pack("whole", 1 << 20);
  assert_int_equal(mixed.frame_count, 1);
  assert_int_equal(still.frame_count, 1);
  assert_true(mixed.times[0] == own.times[own.frame_count - 1]);
  assert_int_equal(rename(to, from), 0);
  free_packed(&own);
  free_packed(&mixed);
  free_packed(&still);
  scree_scene_file_free(file);
}

/* Pixels left of the scale bar that are as green as the middle of its map; of a build without
 * pictures `missing`. */
static size_t count_green(const scree_scene *scene, size_t missing) {
  scree_render_options o = scree_default_render_options();
  scree_image image = {0};
  scree_error error;
  size_t green = 0;
  o.width = 400, o.height = 300;
  o.joints = true;
  scree_status status = scree_scene_picture(scene, &o, NULL, &image, &error);
  if (status == SCREE_UNSUPPORTED) return missing;
  CHECK_OK(status, error);
  for (size_t i = 0; i < o.width * o.height; i++) {
    const uint8_t *p = image.pixels + 3 * i;
    green += i % o.width < o.width / 2 && p[1] > p[0] + 30;
  }
  scree_image_free(&image);
  return green;
}

/* Three parts in a row, of which the first is drawn half as far as its joint bears. */
static void page_and_pictures_show_the_stress_of_joints(void **state) {
  (void)state;
  static const char text[] =
      "time: 1\n"
      "gravity: [0, 0, 0]\n"
      "materials: {m: {young: 1e7, density: 1000}}\n"
      "shapes:\n"
      "  rod:\n"
      "    parts:\n"
      "      one: {box: [0.01, 0.01, 0.01]}\n"
      "      two: {box: [0.01, 0.01, 0.01], at: [0.01, 0, 0]}\n"
      "      three: {box: [0.01, 0.01, 0.01], at: [0.02, 0, 0]}\n"
      "    joints: {tension: 1e5, young: 1e7, damping: 0}\n"
      "inlets: {i: {box: {min: [-0.1, -0.1, -0.1], max: [0.1, 0.1, 0.1]}, shapes: rod, count: 1, "
      "orientation: fixed}}\n";
  static const double wanted[3] = {0.5, 0.5, 0};
  scree_error error;
  scree_scene *scene = create(text);
  CHECK_OK(scree_scene_advance(scene, 1, &error), error);
  scree_world *world = (scree_world *)(uintptr_t)scree_scene_view(scene);
  assert_int_equal(count_green(scene, 0), 0);
  scree_body one = body_of(scene, 0);
  one.position[0] -= 0.5 * 1e5 / 1e7 * 0.01;
  law_place(world, 0, &one);
  CHECK_OK(scree_scene_advance(scene, 1, &error), error);
  assert_true(count_green(scene, 1) > 0);
  CHECK_OK(scree_scene_save(scene, in_folder("rod.scree"), true, &error), error);
  scree_scene_free(scene);
  packed f = {0};
  CHECK_OK(scree_pile_pack(in_folder("rod.scree"), 1 << 20, &f.bytes, &f.size, &error), error);
  f.in = (scree_codec){.source = f.bytes, .count = f.size, .loading = true};
  assert_int_equal(u32(&f), 0);
  for (uint32_t left = u32(&f); left > 0; left--) (void)skip_surface(&f);
  assert_int_equal(u32(&f), 3);
  free(vertices(&f, 3, 4));
  assert_int_equal(u32(&f), 1);
  uint32_t *fragments = vertices(&f, 3, 4);
  float *loads = vertices(&f, 3, 4);
  for (int b = 0; b < 3; b++) {
    assert_int_equal(fragments[b], 0);
    CHECK_NEAR((double)loads[b], wanted[b], 0.02);
  }
  free(fragments);
  free(loads);
  scree_free(f.bytes);
}

static scree_status read_again(void *context, scree_error *error) {
  scree_motion m = {0};
  scree_status status = scree_motion_read(context, &m, error);
  scree_motion_free(&m);
  return status;
}

static scree_status pack_again(void *context, scree_error *error) {
  unsigned char *bytes = NULL;
  size_t size;
  scree_status status = scree_pile_pack(context, 20000, &bytes, &size, error);
  if (status == SCREE_OK) scree_free(bytes);
  return status;
}

static void out_of_memory_is_told(void **state) {
  (void)state;
  check_allocation_failures(read_again, (void *)(uintptr_t)in_folder("whole/motion.scree"));
  check_allocation_failures(pack_again, (void *)(uintptr_t)in_folder("whole/last.scree"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_frame_is_the_scene_at_its_time),
      cmocka_unit_test(an_interrupted_scene_leaves_the_same_file),
      cmocka_unit_test(what_is_cut_or_damaged_ends_the_motion),
      cmocka_unit_test(the_page_gets_every_frame_or_those_that_fit),
      cmocka_unit_test(a_motion_of_another_scene_is_not_shown),
      cmocka_unit_test(page_and_pictures_show_the_stress_of_joints),
      cmocka_unit_test(out_of_memory_is_told),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
