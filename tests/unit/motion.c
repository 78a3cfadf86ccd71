/* The motion of a run on disk and in the report's page: against the run stepped beside it, through
 * interruptions and damage; what the page gets of it against a plain decoder. */
#include "base/alloc.h"
#include "base/codec.h"
#include "base/file.h"
#include "report/pile_pack.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"

#include <meshoptimizer.h>
#include <unistd.h>

/* Six spheres and six chips. */
typedef struct pot {
  scree_experiment experiment;
  scree_run_shape shapes[2];
} pot;

static pot make_pot(void) {
  pot p = {0};
  scree_error error;
  scree_mesh chip;
  scree_sample_options options = scree_default_sample_options();
  CHECK_OK(scree_experiment_preset("paper", &p.experiment, &error), error);
  scree_experiment *e = &p.experiment;
  e->particle_count = 12;
  e->cylinder_diameter = 0.08;
  e->disc_diameter = 0.1; /* some fall off and are taken out */
  e->pack_time = 0.1;
  e->settle_time = 0.05;
  e->lift_speed = 1;
  e->lift_time = 0.08;
  e->hold_time = 0.8;
  e->friction_particle = e->friction_wall = 0.05;
  e->drop_height = 0.01;
  e->young_particle = 1e7; /* fewer steps */
  options.resolution = 4e-3;
  CHECK_OK(scree_sample_make("icosphere-2", &options, NULL, &chip, &error), error);
  for (size_t i = 0; i < 3 * chip.vertex_count; i++)
    chip.positions[i] *= (i % 3 == 2 ? 0.3 : 1) * 0.012 / 0.05;
  CHECK_OK(scree_particle_sphere(0.01, &p.shapes[0].particle, &error), error);
  CHECK_OK(scree_particle_from_mesh(&chip, NULL, &p.shapes[1].particle, &error), error);
  scree_mesh_free(&chip);
  p.shapes[0].density_factor = p.shapes[1].density_factor = 1;
  p.shapes[1].name = "chip";
  return p;
}

static void free_pot(pot *p) {
  for (int i = 0; i < 2; i++) scree_particle_free(p->shapes[i].particle);
  scree_experiment_free(&p->experiment);
}

static bool count_down(void *context, const scree_run_state *state) {
  (void)state;
  size_t *left = context;
  return *left == 0 || (*left)-- == 0;
}

/* The whole run in a folder, cancelled so many times. */
static void complete(const pot *p, const char *name, size_t cancel_count) {
  scree_run *run;
  scree_error error;
  scree_status status;
  size_t left = cancel_count, cancelled = 0;
  scree_run_job job = {.experiment = &p->experiment,
                       .shapes = p->shapes,
                       .shape_count = 2,
                       .folder = in_folder(name),
                       .motion = true,
                       .resume = cancel_count > 0,
                       .overwrite = true,
                       .watch = count_down,
                       .context = &left};
  while ((status = scree_run_complete(&job, &run, &error)) == SCREE_CANCELLED) {
    char file[80];
    cancelled++;
    snprintf(file, sizeof file, "%s/motion.scree", name);
    FILE *stream = fopen(in_folder(file), "ab"); /* as if killed while a frame was written */
    fputs("part of a frame, which is longer than its header alone", stream);
    fclose(stream);
    job.folder = in_folder(name);
  }
  CHECK_OK(status, error);
  assert_int_equal(cancelled, cancel_count);
  scree_run_free(run);
}

static scree_motion read_motion(const char *name) {
  scree_motion m;
  scree_error error;
  CHECK_OK(scree_motion_read(in_folder(name), &m, &error), error);
  return m;
}

/* Steps the run to a time and compares every body. */
static size_t check_frame(scree_run *run, const scree_motion *m, size_t frame) {
  scree_error error;
  const scree_world *world = scree_run_view(run);
  size_t there = 0;
  while (scree_world_time(world) < m->time[frame])
    CHECK_OK(scree_run_advance(run, 1, &error), error);
  assert_true(scree_world_time(world) == m->time[frame]);
  assert_true(scree_run_cylinder_height(run) == m->cylinder_height[frame]);
  for (size_t b = 0; b < m->body_count; b++) {
    const float *pose = m->poses + 7 * (frame * m->body_count + b);
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

static void every_frame_is_the_run_at_its_time(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *run;
  scree_error error;
  complete(&p, "whole", 0);
  scree_motion m = read_motion("whole/motion.scree");
  CHECK_OK(scree_run_create(&p.experiment, p.shapes, 2, &run, &error), error);
  size_t there = 0, most = 0;
  double interval = (0.1 + 0.05 + 0.08 + 0.8) / 240;
  assert_int_equal(m.body_count, 12);
  assert_true(m.frame_count > 200 && m.frame_count <= 242);
  for (size_t f = 0; f < m.frame_count; f++) {
    if (f + 1 < m.frame_count) CHECK_NEAR(m.time[f], (double)f * interval, interval);
    there = check_frame(run, &m, f);
    most = there > most ? there : most;
  }
  CHECK_OK(scree_run_advance(run, 1, &error), error); /* finds that it is over */
  assert_int_equal(scree_run_phase(run), SCREE_PHASE_DONE);
  assert_true(scree_world_time(scree_run_view(run)) == m.time[m.frame_count - 1]);
  assert_true(most == 12 && there < most); /* some fell off */
  scree_motion_free(&m);
  scree_run_free(run);
  free_pot(&p);
}

static void an_interrupted_run_leaves_the_same_file(void **state) {
  (void)state;
  pot p = make_pot();
  char *whole, *pieces;
  size_t whole_size, pieces_size;
  scree_error error;
  complete(&p, "pieces", 9);
  CHECK_OK(scree_file_read(in_folder("whole/motion.scree"), 0, &whole, &whole_size, &error), error);
  CHECK_OK(scree_file_read(in_folder("pieces/motion.scree"), 0, &pieces, &pieces_size, &error),
           error);
  assert_int_equal(pieces_size, whole_size);
  assert_memory_equal(pieces, whole, whole_size);
  scree_free(whole);
  scree_free(pieces);
  free_pot(&p);
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

static void skip_shape(packed *f, size_t shape) {
  f->in.position += u32(f) + 4 + 32; /* its name, count and grid */
  uint32_t vertex_count = u32(f);
  f->triangle_count[shape] = u32(f);
  free(vertices(f, vertex_count, 8));
  f->in.position += u32(f);
}

static packed pack(const char *name, size_t limit) {
  packed f = {0};
  scree_error error;
  double sizes[4];
  char file[80];
  snprintf(file, sizeof file, "%s/last.scree", name);
  CHECK_OK(scree_pile_pack(in_folder(file), limit, &f.bytes, &f.size, &error), error);
  f.in = (scree_codec){.source = f.bytes, .count = f.size, .loading = true};
  scree_code_reals(&f.in, sizes, 4);
  CHECK_NEAR(sizes[0], 0.05, 1e-12);
  CHECK_NEAR(sizes[1], 0.04, 1e-12);
  assert_true(sizes[2] == 0 && sizes[3] == 0);
  assert_int_equal(u32(&f), 0); /* walls, which only scenes have */
  assert_int_equal(u32(&f), 2);
  for (size_t i = 0; i < 2; i++) skip_shape(&f, i);
  f.body_count = u32(&f);
  f.shapes = vertices(&f, f.body_count, 4);
  scree_code_reals(&f.in, f.low, 3);
  scree_code_real(&f.in, &f.step);
  f.frame_count = u32(&f);
  f.times = calloc(2 * f.frame_count, sizeof *f.times);
  scree_code_reals(&f.in, f.times, 2 * f.frame_count);
  f.tracks = vertices(&f, f.frame_count * f.body_count, 16);
  assert_false(f.in.failed);
  assert_int_equal(f.in.position, f.in.count);
  return f;
}

static void free_packed(packed *f) {
  scree_free(f->bytes);
  free(f->times);
  free(f->shapes);
  free(f->tracks);
}

static void check_packed(const packed *f, const scree_motion *m) {
  size_t frame = 0;
  for (size_t k = 0; k < f->frame_count; k++) {
    while (frame < m->frame_count && m->time[frame] != f->times[k]) frame++;
    assert_true(frame < m->frame_count);
    assert_true(f->times[f->frame_count + k] == m->cylinder_height[frame]);
    for (size_t b = 0; b < f->body_count; b++) {
      const uint16_t *moment = f->tracks + 8 * (b * f->frame_count + k);
      const float *pose = m->poses + 7 * (frame * m->body_count + b);
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
  packed all = pack("whole", 1 << 20), some = pack("whole", 12000), one = pack("whole", 1);
  assert_int_equal(all.frame_count, m.frame_count);
  assert_int_equal(all.triangle_count[0], 320); /* the sphere */
  assert_int_equal(all.triangle_count[1], 320);
  check_packed(&all, &m);
  assert_true(some.size <= 12000 && some.frame_count < all.frame_count && some.frame_count > 20);
  check_packed(&some, &m);
  assert_int_equal(one.frame_count, 2);
  check_packed(&one, &m);
  for (size_t b = 0; b < all.body_count; b++) assert_true(all.shapes[b] < 2);
  free_packed(&all);
  free_packed(&some);
  free_packed(&one);
  scree_motion_free(&m);
}

/* A motion that another run left: its last frame is not that of last.scree. */
static void a_motion_of_another_run_is_not_shown(void **state) {
  (void)state;
  pot p = make_pot();
  p.experiment.seed = 2;
  complete(&p, "other", 0);
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
  free_pot(&p);
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
      cmocka_unit_test(every_frame_is_the_run_at_its_time),
      cmocka_unit_test(an_interrupted_run_leaves_the_same_file),
      cmocka_unit_test(what_is_cut_or_damaged_ends_the_motion),
      cmocka_unit_test(the_page_gets_every_frame_or_those_that_fit),
      cmocka_unit_test(a_motion_of_another_run_is_not_shown),
      cmocka_unit_test(out_of_memory_is_told),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
