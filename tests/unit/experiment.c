#include "base/alloc.h"
#include "base/yaml.h"
#include "support/check.h"
#include "support/folder.h"

static const char *file_with(const char *text) {
  const char *path = in_folder("e.yaml");
  FILE *file = fopen(path, "w");
  fputs(text, file);
  fclose(file);
  return path;
}

static scree_experiment preset(const char *name) {
  scree_experiment e;
  scree_error error;
  CHECK_OK(scree_experiment_preset(name, &e, &error), error);
  return e;
}

static void every_preset_prints_and_reads_back_the_same(void **state) {
  (void)state;
  for (size_t i = 0; scree_preset_name(i); i++) {
    scree_experiment e = preset(scree_preset_name(i)), back = preset("paper");
    scree_error error;
    const char *path = in_folder("print.yaml");
    e.density = 1234.5678901234567;
    e.contact_law = SCREE_LAW_HYSTERETIC;
    FILE *file = fopen(path, "w");
    scree_experiment_print(&e, file);
    fclose(file);
    CHECK_OK(scree_experiment_read(path, &back, &error), error);
    assert_string_equal(back.preset, e.preset);
    assert_memory_equal((char *)&back + sizeof back.preset, (char *)&e + sizeof e.preset,
                        sizeof e - sizeof e.preset);
    scree_experiment_free(&e);
    scree_experiment_free(&back);
  }
}

static void values_are_set_by_yaml_json_and_key(void **state) {
  (void)state;
  scree_experiment e = preset("paper");
  scree_error error;
  CHECK_OK(scree_experiment_read(file_with("cylinder: {diameter: 0.3}\nseed: 7\n"), &e, &error),
           error);
  CHECK_NEAR(e.cylinder_diameter, 0.3, 0);
  assert_int_equal(e.seed, 7);
  CHECK_OK(scree_experiment_read(file_with("{\"contact\": {\"friction_wall\": 0.25}}"), &e, &error),
           error);
  CHECK_NEAR(e.friction_wall, 0.25, 0);
  CHECK_OK(scree_experiment_set(&e, "phases.stop_when_still", "true", &error), error);
  assert_true(e.stop_when_still);
  CHECK_OK(scree_experiment_read(file_with(""), &e, &error), error);
  scree_experiment_free(&e);
}

static void errors_say_line_column_value_and_limit(void **state) {
  (void)state;
  static const struct {
    const char *text, *message;
  } cases[] = {
      {"seed: 1\ndensity: heavy\n",
       "line 2, column 10: density: 'heavy': must be a number in kg/m3"},
      {"contact:\n  restitution: 1.5\n",
       "line 2, column 16: contact.restitution: 1.5: must be 0.01 to 1"},
      {"colour: red\n", "line 1, column 1: no field 'colour'"},
      {"phases: {lift_sped: 1}\n", "column 10: no field 'phases.lift_sped'; did you mean "
                                   "'phases.lift_speed'?"},
      {"disc: {diameter: 2 kg}\n", "disc.diameter: '2 kg'"},
      {"contact:\n  law: cubic\n",
       "line 2, column 8: contact.law: 'cubic': must be one of linear|hysteretic"},
      {"seed: 1\nseed: 2\n", "line 2, column 1: this key stands here twice"},
      {"a: &x 1\nb: *x\n", "line 2, column 4: aliases are not understood here"},
      {"- 1\n", "line 1, column 1: an experiment is `key: value` lines"},
      {"preset: huge\n", "line 1, column 9: preset: must be one of paper, small, demo"},
      {"measure: {band_low: 0.9}\n", "measure.band_low 0.9 must be below band_high 0.8"},
      {"[[[[[[[[[[[[[[[[[[[[", "nested too deeply"},
      {"a: b: c\n", "mapping values are not allowed in this context"},
      {"seed: 1\n---\nseed: 2\n", "a second document"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    scree_experiment e = preset("paper"), before = e;
    scree_error error;
    assert_int_not_equal(scree_experiment_read(file_with(cases[i].text), &e, &error), SCREE_OK);
    if (!strstr(error.message, cases[i].message))
      fail_msg("got '%s', expected '%s'", error.message, cases[i].message);
    assert_memory_equal(&e, &before, sizeof e);
    scree_experiment_free(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_preset_prints_and_reads_back_the_same),
      cmocka_unit_test(values_are_set_by_yaml_json_and_key),
      cmocka_unit_test(errors_say_line_column_value_and_limit),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
