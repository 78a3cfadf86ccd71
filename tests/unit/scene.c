/* Scenes at work: in = inside + out at every moment; any cut into calls, any number of threads and
 * any checkpoint give the same bits, in every template; inlets queue what does not fit and keep
 * shares and rates; what is killed leaves a checkpoint that goes on. */
#include "base/file.h"
#include "base/platform.h"
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/threads.h"

static scree_scene_file *parse(const char *text) {
  scree_error error;
  scree_scene_file *file = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
  return file;
}

static scree_scene *create(scree_scene_file *file) {
  scree_error error;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  return scene;
}

static void set(scree_scene_file *file, const char *field, const char *value) {
  scree_error error;
  CHECK_OK(scree_scene_file_set(file, field, value, &error), error);
}

static void advance(scree_scene *scene, size_t steps) {
  scree_error error;
  CHECK_OK(scree_scene_advance(scene, steps, &error), error);
}

static bool same_state(const scree_scene *a, const scree_scene *b) {
  size_t rows, rows_b, columns = scree_scene_column_count(a);
  scree_checksum h = scree_world_hash(scree_scene_view(a)),
                 k = scree_world_hash(scree_scene_view(b));
  const double *s = scree_scene_series(a, &rows), *t = scree_scene_series(b, &rows_b);
  return h.high == k.high && h.low == k.low && rows == rows_b &&
         (rows == 0 || !memcmp(s, t, rows * columns * sizeof *s));
}

/* Balls fall through a box with an outlet; bricks come along. */
static const char stream_text[] =
    "time: 0.6\n"
    "materials: {grain: {young: 1e6, density: 1000, restitution: 0.3, friction: 0.4}}\n"
    "shapes:\n"
    "  ball: {sphere: 0.01}\n"
    "  brick: {box: [0.012, 0.009, 0.008]}\n"
    "geometry: {chute: {box: [0.2, 0.2, 0.02], turn: {axis: [0, 1, 0], angle_deg: 35}}}\n"
    "inlets: {feed: {box: {min: [-0.05, -0.03, 0.06], max: [0, 0.03, 0.12]}, shapes: {ball: 3, "
    "brick: 1}, "
    "rate: 200, until: 0.3, velocity: [0, 0, -0.5]}}\n"
    "outlets: {low: {box: {min: [-1, -1, -1], max: [1, 1, -0.1]}}}\n"
    "domain: {min: [-0.4, -0.2, -0.5], max: [0.4, 0.2, 0.4]}\n"
    "sensors: {gone: {flow: {through: [0, 0, -0.05], normal: [0, 0, -1]}}, stay: {residence: {}}, "
    "mix: {segregation: {cells: 0.03}}, load: {wall: chute}}\n"
    "output: {series: 0.05}\n";

static void mass_is_booked(void **state) {
  (void)state;
  scree_scene_file *file = parse(stream_text);
  scree_scene *scene = create(file);
  size_t left = 0, ball = 0;
  while (!scree_scene_end(scene)) {
    scree_scene_book b;
    advance(scene, 25);
    scree_scene_get_book(scene, &b);
    assert_int_equal(b.entered_count, b.inside_count + b.left_count);
    CHECK_NEAR(b.entered_mass, b.inside_mass + b.left_mass, 1e-12 * (1 + b.entered_mass));
    assert_true(b.left_count >= left);
    left = b.left_count;
  }
  size_t bodies = scree_world_body_count(scree_scene_view(scene));
  assert_int_equal(bodies, 60); /* 200 a second for 0.3 s */
  for (size_t i = 0; i < bodies; i++) ball += scree_scene_body_shape(scene, i) == 0;
  assert_int_equal(ball, 45);
  assert_true(left > 20);
  scree_scene_book b;
  scree_scene_get_book(scene, &b);
  CHECK_NEAR(b.ledger, 0, 1e-2);
  double mass;
  size_t waiting, entered = scree_scene_inlet_count(scene, 0, &mass, &waiting);
  assert_int_equal(entered, 60);
  assert_int_equal(waiting, 0);
  size_t out = scree_scene_outlet_count(scene, 0, NULL) + scree_scene_outlet_count(scene, 1, NULL);
  assert_int_equal(out, left);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* A region that holds a few, and more that are due: the rest waits, and nothing overlaps. */
static void what_does_not_fit_waits(void **state) {
  (void)state;
  scree_scene_file *file = parse(stream_text);
  set(file, "inlets.feed",
      "{box: {min: [-0.05, -0.02, 0.06], max: [0, 0.02, 0.08]}, shapes: ball, "
      "count: 500}");
  scree_scene *scene = create(file);
  advance(scene, 1);
  const scree_world *world = scree_scene_view(scene);
  size_t count = scree_world_body_count(world), waiting;
  scree_scene_inlet_count(scene, 0, NULL, &waiting);
  assert_true(count > 5 && count < 40);
  assert_int_equal(count + waiting, 500);
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j < i; j++) {
      scree_body a, b;
      double d2 = 0;
      scree_world_get_body(world, i, &a);
      scree_world_get_body(world, j, &b);
      for (int k = 0; k < 3; k++) d2 += pow(a.position[k] - b.position[k], 2);
      assert_true(sqrt(d2) > 0.01);
    }
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* A mass rate: what is in follows it, no more than one body ahead. */
static void mass_rate(void **state) {
  (void)state;
  scree_scene_file *file = parse(stream_text);
  set(file, "inlets.feed",
      "{box: {min: [-0.05, -0.05, 0.06], max: [0, 0.05, 0.16]}, shapes: ball, "
      "mass_rate: 0.1, from: 0.05, until: 0.25, velocity: [0, 0, -1]}");
  scree_scene *scene = create(file);
  double body = 1000 * 4.18879020478639 * 0.005 * 0.005 * 0.005, mass;
  while (!scree_scene_end(scene)) {
    advance(scene, 50);
    double time = scree_world_time(scree_scene_view(scene));
    double due = 0.1 * fmax(0, fmin(time, 0.25) - 0.05);
    scree_scene_inlet_count(scene, 0, &mass, NULL);
    assert_true(mass < due + body && mass > due - 3 * body);
  }
  CHECK_NEAR(mass, 0.02, body);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* ---- the same bits ---- */

static scree_scene *run_cut(scree_scene_file *file, size_t piece, int threads) {
  use_threads(threads);
  scree_scene *scene = create(file);
  while (!scree_scene_end(scene)) advance(scene, piece);
  use_threads(0);
  return scene;
}

static void any_cut_and_any_threads(void **state) {
  (void)state;
  scree_scene_file *file = parse(stream_text);
  set(file, "time", "0.3");
  scree_scene *whole = run_cut(file, SIZE_MAX, 1), *pieces = run_cut(file, 7, 3);
  assert_true(same_state(whole, pieces));
  scree_scene_free(whole);
  scree_scene_free(pieces);
  scree_scene_file_free(file);
}

/* Saved and loaded once in a while, in the middle of everything, and on three threads. */
static void check_resumed(scree_scene_file *file, size_t steps, size_t piece) {
  scree_error error;
  scree_scene *whole = create(file), *cut = create(file);
  const char *path = in_folder("checkpoint.scree");
  use_threads(1);
  advance(whole, steps);
  use_threads(3);
  for (size_t done = 0; done < steps; done += piece) {
    advance(cut, piece < steps - done ? piece : steps - done);
    CHECK_OK(scree_scene_save(cut, path, true, &error), error);
    scree_scene_free(cut);
    CHECK_OK(scree_scene_load(path, &cut, &error), error);
  }
  use_threads(0);
  assert_true(same_state(whole, cut));
  scree_scene_free(whole);
  scree_scene_free(cut);
}

static void resumed_from_any_moment(void **state) {
  (void)state;
  scree_scene_file *file = parse(stream_text);
  check_resumed(file, 3000, 611);
  scree_scene_file_free(file);
  for (size_t i = 0; scree_scene_template_name(i); i++) {
    file = parse(scree_scene_template(scree_scene_template_name(i)));
    check_resumed(file, 900, 271);
    scree_scene_file_free(file);
  }
}

/* ---- in a folder ---- */

static bool stop_at_once(void *context, const scree_scene_state *state) {
  size_t *calls = context;
  (void)state;
  return ++*calls < 2;
}

static void text_of(const char *path, char **text, size_t *size) {
  scree_error error;
  CHECK_OK(scree_file_read(path, 0, text, size, &error), error);
}

/* Cancelled over and over and gone on with: the same files as of a run in one piece. */
static void completed_in_pieces(void **state) {
  (void)state;
  scree_error error;
  scree_scene_file *file = parse(stream_text);
  scree_scene *scene = NULL;
  char *one, *other;
  size_t m, n;
  set(file, "time", "0.25");
  scree_scene_job job = {.file = file, .folder = in_folder("whole")};
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  scree_checksum hash = scree_world_hash(scree_scene_view(scene));
  scree_scene_free(scene);
  assert_int_equal(scree_scene_complete(&job, &scene, &error), SCREE_EXISTS);
  size_t calls = 0, pieces = 0;
  scree_status status = SCREE_CANCELLED;
  job = (scree_scene_job){.file = file,
                          .folder = in_folder("pieces"),
                          .resume = true,
                          .watch = stop_at_once,
                          .context = &calls};
  while (status == SCREE_CANCELLED && ++pieces < 200) {
    calls = 0;
    scree_scene_free(scene);
    status = scree_scene_complete(&job, &scene, &error);
  }
  CHECK_OK(status, error);
  scree_checksum other_hash = scree_world_hash(scree_scene_view(scene));
  assert_true(hash.high == other_hash.high && hash.low == other_hash.low);
  scree_scene_free(scene);
  text_of(in_folder("whole/series.csv"), &one, &m);
  text_of(in_folder("pieces/series.csv"), &other, &n);
  assert_true(m == n && !memcmp(one, other, n));
  scree_free(one);
  scree_free(other);
  /* another scene is refused, and says what differs; more time is not another scene */
  set(file, "inlets.feed.rate", "100");
  assert_int_equal(scree_scene_complete(&job, &scene, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "inlets.feed.rate is 200 there and 100 here"));
  set(file, "inlets.feed.rate", "200");
  set(file, "time", "0.3");
  job.watch = NULL;
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  scree_scene *whole = run_cut(file, SIZE_MAX, 1);
  assert_true(same_state(whole, scene));
  scree_scene_free(whole);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

static bool same_file(const char *path, const char *text, size_t size) {
  char *now;
  size_t now_size;
  text_of(path, &now, &now_size);
  bool same = now_size == size && !memcmp(now, text, size);
  scree_free(now);
  return same;
}

/* A scene that its `stop` ended is not begun anew by going on with it; another `stop` takes it on,
 * as if it had been there from the start. */
static void gone_on_with_after_its_end(void **state) {
  (void)state;
  static const char *const files[] = {"ended/series.csv", "ended/motion.scree"};
  scree_error error;
  scree_scene_file *file = parse(stream_text);
  scree_scene *scene = NULL;
  char *texts[2];
  size_t sizes[2];
  set(file, "stop", "{still: 1e9}");
  scree_scene_job job = {.file = file, .folder = in_folder("ended"), .resume = true};
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  assert_string_equal(scree_scene_end(scene), "still");
  scree_scene_free(scene);
  for (int i = 0; i < 2; i++) text_of(in_folder(files[i]), &texts[i], &sizes[i]);
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  scree_scene_free(scene);
  for (int i = 0; i < 2; i++) {
    assert_true(same_file(in_folder(files[i]), texts[i], sizes[i]));
    scree_free(texts[i]);
  }
  set(file, "stop.after", "0.4");
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  scree_scene *whole = run_cut(file, SIZE_MAX, 1);
  assert_true(same_state(whole, scene));
  scree_scene_free(whole);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

static void damaged_checkpoints(void **state) {
  (void)state;
  scree_error error;
  scree_scene_file *file = parse(stream_text);
  scree_scene *scene = create(file), *loaded = NULL;
  const char *path = in_folder("damaged.scree");
  char *bytes;
  size_t count;
  advance(scene, 200);
  CHECK_OK(scree_scene_save(scene, path, true, &error), error);
  text_of(path, &bytes, &count);
  for (size_t at = 41; at < count; at += count / 37) {
    FILE *stream = fopen(path, "wb");
    bytes[at] ^= 16;
    fwrite(bytes, 1, count, stream);
    fclose(stream);
    bytes[at] ^= 16;
    assert_int_equal(scree_scene_load(path, &loaded, &error), SCREE_BAD_FILE);
  }
  scree_free(bytes);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* ---- memory ---- */

static scree_status live(void *context, scree_error *error) {
  scree_scene_file *file;
  scree_scene *scene = NULL, *loaded = NULL;
  (void)context;
  scree_status status =
      scree_scene_file_parse(stream_text, strlen(stream_text), "test.yaml", &file, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_file_set(file, "output.series", "0.002", error);
  char column[96];
  if (status == SCREE_OK) status = scree_scene_file_check(file, error);
  if (status == SCREE_OK) status = scree_scene_file_column(file, 3, column, NULL, error);
  if (status == SCREE_OK) status = scree_scene_create(file, NULL, &scene, error);
  scree_scene_file_free(file);
  double values[200]; /* the columns of its sensors, and more */
  if (status == SCREE_OK) status = scree_scene_advance(scene, 40, error);
  if (status == SCREE_OK) status = scree_scene_measure(scene, values, error);
  if (status == SCREE_OK) status = scree_scene_save(scene, in_folder("memory.scree"), true, error);
  if (status == SCREE_OK) status = scree_scene_load(in_folder("memory.scree"), &loaded, error);
  scree_scene_free(scene);
  scree_scene_free(loaded);
  return status;
}

static scree_status complete(void *context, scree_error *error) {
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  scree_status status =
      scree_scene_file_parse(stream_text, strlen(stream_text), "test.yaml", &file, error);
  (void)context;
  if (status == SCREE_OK) status = scree_scene_file_set(file, "time", "0.001", error);
  if (status == SCREE_OK) {
    scree_scene_job job = {.file = file, .folder = in_folder("memory"), .overwrite = true};
    status = scree_scene_complete(&job, &scene, error);
    scree_scene_free(scene);
  }
  scree_scene_file_free(file);
  return status;
}

static scree_status read_and_print(void *context, scree_error *error) {
  scree_scene_file *file;
  scree_status status = scree_scene_file_read(context, &file, error);
  if (status != SCREE_OK) return status;
  FILE *stream = fopen("/dev/null", "w");
  status = scree_scene_file_print(file, stream, error);
  fclose(stream);
  scree_scene_file_free(file);
  return status;
}

static scree_status write_json(void *context, scree_error *error) {
  scree_scene_entry entry = {.scene = context};
  return scree_scene_json_write(&entry, in_folder("memory.json"), true, error);
}

static scree_status write_walls(void *context, scree_error *error) {
  return scree_scene_walls_vtp_write(context, in_folder("memory.vtp"), true, error);
}

static scree_status write_bodies(void *context, scree_error *error) {
  scree_status status =
      scree_scene_shape_vtp_write(context, 0, in_folder("shape.vtp"), true, error);
  if (status != SCREE_OK) return status;
  return scree_scene_bodies_vtp_write(context, in_folder("bodies.vtp"), true, error);
}

static scree_status draw(void *context, scree_error *error) {
  scree_render_options o = scree_default_render_options();
  scree_image image = {0};
  o.width = o.height = 64;
  o.samples = 1;
  scree_status status = scree_scene_picture(context, &o, NULL, &image, error);
  scree_image_free(&image);
  return status;
}

static void out_of_memory(void **state) {
  (void)state;
  scree_error error;
  CHECK_OK(scree_text_write(stream_text, in_folder("stream.yaml"), true, &error), error);
  check_allocation_failures(read_and_print, (void *)(uintptr_t)in_folder("stream.yaml"));
  scree_scene_file *file = parse(stream_text);
  scree_scene *scene = create(file);
  advance(scene, 200);
  /* A doubt about a sensor needs memory of its own, and is left out where there is none. */
  check_allocation_failures_survivable(write_json, scene);
  check_allocation_failures(write_walls, scene);
  check_allocation_failures(write_bodies, scene);
  if (draw(scene, &error) == SCREE_OK) check_allocation_failures(draw, scene);
  scree_scene_free(scene);
  scree_scene_file_free(file);
  check_allocation_failures(live, NULL);
  check_allocation_failures(complete, NULL);
}

/* By its file alone, before any shape is made. */
static void columns_are_known_before_it_is_made(void **state) {
  (void)state;
  scree_error error;
  scree_scene_file *file = parse(stream_text);
  scree_scene *scene = create(file);
  char name[96];
  const char *unit;
  for (size_t k = 0; k < scree_scene_column_count(scene); k++) {
    CHECK_OK(scree_scene_file_column(file, k, name, &unit, &error), error);
    assert_string_equal(name, scree_scene_column_name(scene, k));
    assert_string_equal(unit, scree_scene_column_unit(scene, k));
  }
  CHECK_OK(scree_scene_file_column(file, scree_scene_column_count(scene), name, &unit, &error),
           error);
  assert_string_equal(name, "");
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* Of a size that is given, and without a disc that would say how far. */
static void a_pile_of_no_bodies(void **state) {
  (void)state;
  scree_error error;
  scree_scene_file *file =
      parse("time: 0.1\nshapes: {a: {sphere: 0.012}}\n"
            "geometry: {floor: {disc: {radius: 0.15}}}\n"
            "inlets: {top: {box: {min: [-0.05, -0.05, 0.1], max: [0.05, 0.05, 0.2]}, "
            "shapes: {a: 1}, rate: 100}}\nsensors: {heap: {pile: {size: 0.012}}}\n");
  scree_scene *scene = create(file);
  scree_pile pile;
  CHECK_OK(scree_scene_measure_pile(scene, 0, NULL, &pile, &error), error);
  assert_true(pile.body_count == 0 && isnan(pile.repose.sector_deg));
  assert_string_equal(pile.repose.reason, "there are no bodies");
  advance(scene, 50);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(columns_are_known_before_it_is_made),
      cmocka_unit_test(a_pile_of_no_bodies),
      cmocka_unit_test(mass_is_booked),
      cmocka_unit_test(what_does_not_fit_waits),
      cmocka_unit_test(mass_rate),
      cmocka_unit_test(any_cut_and_any_threads),
      cmocka_unit_test(resumed_from_any_moment),
      cmocka_unit_test(completed_in_pieces),
      cmocka_unit_test(gone_on_with_after_its_end),
      cmocka_unit_test(damaged_checkpoints),
      cmocka_unit_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
