/* The experiment's fields in one table: key, unit, range, what it is and where the default comes
 * from. The table reads YAML, sets single fields and prints the commented file. */
#include "base/alloc.h"
#include "base/number.h"
#include "base/yaml.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

typedef enum field_kind { FIELD_COUNT, FIELD_SEED, FIELD_REAL, FIELD_FLAG, FIELD_WORD } field_kind;

typedef struct field {
  const char *key; /* "group.name" or "name" */
  field_kind kind;
  size_t offset;
  double minimum, maximum;
  const char *unit; /* of FIELD_REAL; "" for a pure number; the words of FIELD_WORD */
  const char *comment;
} field;

#define AT(name) offsetof(scree_experiment, name)
/* Sources: [p] the paper, section 2.3; [p*] the paper, read as docs/background/method.md says; [s]
 * scree. */
static const field fields[] = {
    {"particles", FIELD_COUNT, AT(particle_count), 1, 1e7, "",
     "how many, in equal shares of the shapes [p]"},
    {"seed", FIELD_SEED, AT(seed), 0, 0, "",
     "of positions, orientations and order; replicates add 1"},
    {"density", FIELD_REAL, AT(density), 1, 1e5, "kg/m3", "not given in the paper [s]"},
    {"mass_from", FIELD_WORD, AT(mass_rule), 0, 0, "mesh|scan",
     "volume that gives the mass: of each decimated mesh, or of the scan at every level [s]"},
    {"cylinder.diameter", FIELD_REAL, AT(cylinder_diameter), 1e-4, 1e3, "m", "inside [p*]"},
    {"disc.diameter", FIELD_REAL, AT(disc_diameter), 1e-4, 1e4, "m",
     "bottom; what leaves it falls off [p*]"},
    {"phases.pack_time", FIELD_REAL, AT(pack_time), 0, 1e4, "s",
     "particles are filled in from above [p]"},
    {"phases.settle_time", FIELD_REAL, AT(settle_time), 0, 1e4, "s", "they come to rest [p]"},
    {"phases.lift_speed", FIELD_REAL, AT(lift_speed), 1e-5, 10, "m/s",
     "of the cylinder, upwards [p]"},
    {"phases.lift_time", FIELD_REAL, AT(lift_time), 0, 1e5, "s", "[p]"},
    {"phases.hold_time", FIELD_REAL, AT(hold_time), 0, 1e5, "s",
     "after the lift, at most, until still [s]"},
    {"phases.stop_when_still", FIELD_FLAG, AT(stop_when_still), 0, 0, "",
     "end settling, lifting (once the cylinder is clear) and holding early when still [s]"},
    {"phases.still_energy", FIELD_REAL, AT(still_energy), 0, 1, "J",
     "kinetic energy a particle below which the heap is still [s]"},
    {"phases.inlet", FIELD_WORD, AT(inlet), 0, 0, "top|heap",
     "particles fall from above where the packed heap will end [p], or from near the heap as it "
     "grows: slower hits [s]"},
    {"phases.drop_height", FIELD_REAL, AT(drop_height), 0, 100, "m",
     "from the heap's top to the layer filled in, at least [s]"},
    {"contact.young_particle", FIELD_REAL, AT(young_particle), 1e3, 1e13, "Pa", "[p]"},
    {"contact.young_wall", FIELD_REAL, AT(young_wall), 1e3, 1e13, "Pa", "[p]"},
    {"contact.restitution", FIELD_REAL, AT(restitution), 0.01, 1, "", "[p]"},
    {"contact.friction_particle", FIELD_REAL, AT(friction_particle), 0, 10, "",
     "particle on particle [p]"},
    {"contact.friction_wall", FIELD_REAL, AT(friction_wall), 0, 10, "", "particle on wall [p]"},
    {"contact.law", FIELD_WORD, AT(contact_law), 0, 0, "linear|hysteretic", "[p]: linear"},
    {"contact.steps", FIELD_REAL, AT(steps_per_contact), 15, 1000, "",
     "time steps in a quarter of a contact's period; below 15 corners are not resolved [s]"},
    {"contact.stiffness_factor", FIELD_REAL, AT(stiffness_factor), 1e-4, 10, "",
     "multiplies every stiffness: below 1 the time step grows with its root, overlaps with its "
     "inverse [s]"},
    {"gravity", FIELD_REAL, AT(gravity), 0, 1e3, "m/s2", "downwards"},
    {"output.frame_interval", FIELD_REAL, AT(frame_interval), 0, 1e5, "s",
     "of simulated time; 0: only the last [s]"},
    {"output.checkpoint_interval", FIELD_REAL, AT(checkpoint_interval), 0.01, 1e6, "s",
     "of wall-clock time: what a crash costs at most [s]"},
    {"output.series_interval", FIELD_REAL, AT(series_interval), 1e-5, 1e4, "s",
     "of simulated time between the points of the series [s]"},
    {"output.angle_interval", FIELD_REAL, AT(angle_interval), 0, 1e5, "s",
     "between points with angles, while lifting and holding; 0: only the last [s]"},
    {"measure.cell", FIELD_REAL, AT(height_cell), 0, 1, "m",
     "of the height field; 0: a tenth of the particle size [s]"},
    {"measure.sectors", FIELD_COUNT, AT(sector_count), 1, 3600, "", "azimuth sectors [s]"},
    {"measure.band_low", FIELD_REAL, AT(band_low), 0, 1, "",
     "the flank begins at this share of the height [s]"},
    {"measure.band_high", FIELD_REAL, AT(band_high), 0, 1, "", "and ends at this one [s]"},
};
enum { FIELD_COUNT_ALL = sizeof fields / sizeof *fields };

/* ---- presets ---- */

static const scree_experiment paper = {
    .particle_count = 1197,
    .seed = 1,
    .density = 2000,
    .cylinder_diameter = 0.4,
    .disc_diameter = 3,
    .pack_time = 6,
    .settle_time = 3,
    .lift_speed = 0.1,
    .lift_time = 11,
    .hold_time = 10,
    .still_energy = 1e-7,
    .drop_height = 0.1,
    .gravity = 9.81,
    .young_particle = 1e8,
    .young_wall = 1e11,
    .restitution = 0.3,
    .friction_particle = 0.5,
    .friction_wall = 0.5,
    .steps_per_contact = 20,
    .stiffness_factor = 1,
    .checkpoint_interval = 60,
    .series_interval = 0.05,
    .angle_interval = 0.5,
    .sector_count = 36,
    .band_low = 0.2,
    .band_high = 0.8,
};

static const struct {
  const char *name, *difference;
} presets[] = {
    {"paper", "the protocol of Katagiri and Koyanaka (2020), section 2.3"},
    {"small",
     "360 particles in a cylinder of 0.3 m on a disc of 2 m, contacts 2.5 times softer, filled in "
     "from near the heap, phases end when still: a smaller heap, whose angle scatters more"},
    {"demo", "180 particles in a cylinder of 0.3 m lifted at 0.2 m/s, contacts 2.5 times softer, "
             "filled in "
             "from near the heap, phases end when still: it shows a heap; take no number from it"},
};

static void make_small(scree_experiment *e) {
  e->particle_count = 360;
  e->cylinder_diameter = 0.3;
  e->disc_diameter = 2;
  e->settle_time = 1.5;
  e->lift_time = 8;
  e->hold_time = 5;
  e->stiffness_factor = 0.4;
  e->still_energy = 1e-6;
  e->stop_when_still = true;
  e->inlet = SCREE_INLET_HEAP;
  e->drop_height = 0.03;
}

static void make_demo(scree_experiment *e) {
  e->particle_count = 180;
  e->cylinder_diameter = 0.3;
  e->disc_diameter = 1.6;
  e->pack_time = 3;
  e->settle_time = 0.6;
  e->lift_speed = 0.2;
  e->lift_time = 3;
  e->hold_time = 1.5;
  e->stiffness_factor = 0.4;
  e->still_energy = 1e-4;
  e->stop_when_still = true;
  e->inlet = SCREE_INLET_HEAP;
  e->drop_height = 0.03;
  e->checkpoint_interval = 20;
}

const char *scree_preset_name(size_t index) {
  return index < sizeof presets / sizeof *presets ? presets[index].name : NULL;
}

static const char *preset_difference(const char *name) {
  for (size_t i = 0; i < sizeof presets / sizeof *presets; i++)
    if (!strcmp(presets[i].name, name)) return presets[i].difference;
  return NULL;
}

scree_status scree_experiment_preset(const char *name, scree_experiment *experiment,
                                     scree_error *error) {
  if (!preset_difference(name))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "no preset '%s'; there are paper, small, demo",
                      name);
  scree_experiment made = paper;
  made.preset = scree_strdup(name);
  if (!made.preset) return scree_fail_memory(error, strlen(name), "a preset's name");
  if (!strcmp(name, "small")) make_small(&made);
  if (!strcmp(name, "demo")) make_demo(&made);
  *experiment = made;
  return SCREE_OK;
}

void scree_experiment_free(scree_experiment *experiment) {
  if (!experiment) return;
  scree_free(experiment->preset);
  *experiment = (scree_experiment){0};
}

/* ---- setting a field ---- */

static bool word_index(const char *words, const char *text, int *index) {
  size_t length = strlen(text);
  *index = 0;
  for (const char *word = words;; (*index)++) {
    size_t word_length = strcspn(word, "|");
    if (word_length == length && !strncmp(word, text, length)) return true;
    if (!word[word_length]) return false;
    word += word_length + 1;
  }
}

/* Writes the value into the field, or tells in `reason` what is wrong with it. */
static bool set_field(const field *f, const char *text, scree_experiment *e, char *reason,
                      size_t size) {
  void *value = (char *)e + f->offset;
  char *end;
  errno = 0;
  switch (f->kind) {
  case FIELD_FLAG:
    if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0) {
      snprintf(reason, size, "must be true or false");
      return false;
    }
    *(bool *)value = text[0] == 't';
    return true;
  case FIELD_WORD:
    snprintf(reason, size, "must be one of %s", f->unit);
    return word_index(f->unit, text, value);
  case FIELD_SEED:
  case FIELD_COUNT: {
    unsigned long long whole = strtoull(text, &end, 10);
    snprintf(reason, size, "must be a whole number");
    if (*text < '0' || *text > '9' || *end || errno) return false;
    if (f->kind == FIELD_SEED) {
      *(uint64_t *)value = whole;
      return true;
    }
    snprintf(reason, size, "must be %g to %g", f->minimum, f->maximum);
    if ((double)whole < f->minimum || (double)whole > f->maximum) return false;
    *(size_t *)value = (size_t)whole;
    return true;
  }
  case FIELD_REAL: {
    double real;
    snprintf(reason, size, "must be a number");
    if (!scree_number_read(text, &real)) return false;
    snprintf(reason, size, "must be %g to %g%s%s", f->minimum, f->maximum, *f->unit ? " " : "",
             f->unit);
    if (real < f->minimum || real > f->maximum) return false;
    *(double *)value = real;
    return true;
  }
  }
  return false;
}

static const field *find_field(const char *key) {
  for (size_t i = 0; i < FIELD_COUNT_ALL; i++)
    if (!strcmp(fields[i].key, key)) return &fields[i];
  return NULL;
}

static scree_status check_together(const scree_experiment *e, const char *where,
                                   scree_error *error) {
  if (e->band_low >= e->band_high)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "%s: measure.band_low %g must be below band_high %g", where, e->band_low,
                      e->band_high);
  if (e->disc_diameter < e->cylinder_diameter)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "%s: disc.diameter %g m must not be below cylinder.diameter %g m", where,
                      e->disc_diameter, e->cylinder_diameter);
  return SCREE_OK;
}

scree_status scree_experiment_check(const scree_experiment *experiment, scree_error *error) {
  return check_together(experiment, "experiment", error);
}

const char *scree_experiment_key(size_t index) {
  return index < FIELD_COUNT_ALL ? fields[index].key : NULL;
}
const char *scree_experiment_unit(const char *key) {
  const field *f = find_field(key);
  return f ? f->unit : NULL;
}
const char *scree_experiment_comment(const char *key) {
  const field *f = find_field(key);
  return f ? f->comment : NULL;
}

scree_status scree_experiment_set(scree_experiment *experiment, const char *key, const char *value,
                                  scree_error *error) {
  const field *f = find_field(key);
  char reason[128];
  if (!f)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "no field '%s' in an experiment; print one to see all", key);
  scree_experiment changed = *experiment;
  if (!set_field(f, value, &changed, reason, sizeof reason))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: '%s': %s", key, value, reason);
  *experiment = changed;
  return SCREE_OK;
}

/* ---- YAML ---- */

static scree_status read_value(const char *path, const scree_yaml *node, const char *key,
                               scree_experiment *e, scree_error *error) {
  const field *f = find_field(key);
  char reason[128];
  if (!f)
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu, column %zu: no field '%s'", path,
                      node->line, node->column, key);
  if (node->kind != SCREE_YAML_SCALAR)
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu, column %zu: %s: must be one value",
                      path, node->line, node->column, key);
  if (!set_field(f, node->text, e, reason, sizeof reason))
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu, column %zu: %s: '%s': %s", path,
                      node->line, node->column, key, node->text, reason);
  return SCREE_OK;
}

static bool is_group(const char *name) {
  size_t length = strlen(name);
  for (size_t i = 0; i < FIELD_COUNT_ALL; i++)
    if (!strncmp(fields[i].key, name, length) && fields[i].key[length] == '.') return true;
  return false;
}

static scree_status read_group(const char *path, const scree_yaml *group, scree_experiment *e,
                               scree_error *error) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < group->item_count; i++) {
    char key[128];
    snprintf(key, sizeof key, "%s.%s", group->key, group->items[i].key);
    status = read_value(path, &group->items[i], key, e, error);
  }
  return status;
}

static scree_status read_preset(const char *path, const scree_yaml *root, scree_experiment *e,
                                scree_error *error) {
  const scree_yaml *preset = scree_yaml_find(root, "preset");
  if (!preset) return SCREE_OK;
  if (preset->kind != SCREE_YAML_SCALAR || !preset_difference(preset->text))
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s, line %zu, column %zu: preset: must be one of paper, small, demo", path,
                      preset->line, preset->column);
  return scree_experiment_preset(preset->text, e, error);
}

static scree_status read_root(const char *path, const scree_yaml *root, scree_experiment *e,
                              scree_error *error) {
  if (root->kind != SCREE_YAML_MAPPING)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s, line %zu, column %zu: an experiment is `key: value` lines", path,
                      root->line, root->column);
  scree_status status = read_preset(path, root, e, error);
  for (size_t i = 0; status == SCREE_OK && i < root->item_count; i++) {
    const scree_yaml *item = &root->items[i];
    if (!strcmp(item->key, "preset")) continue;
    status = item->kind == SCREE_YAML_MAPPING && is_group(item->key)
                 ? read_group(path, item, e, error)
                 : read_value(path, item, item->key, e, error);
  }
  return status == SCREE_OK ? check_together(e, path, error) : status;
}

/* The tree over a copy; *experiment changes only where all of it is good. */
static scree_status apply_root(const char *name, const scree_yaml *root,
                               scree_experiment *experiment, scree_error *error) {
  scree_experiment changed = *experiment;
  scree_status status = read_root(name, root, &changed, error);
  bool own = changed.preset != experiment->preset;
  if (status != SCREE_OK) {
    if (own) scree_experiment_free(&changed);
    return status;
  }
  if (own) scree_experiment_free(experiment);
  *experiment = changed;
  return SCREE_OK;
}

scree_status scree_experiment_read(const char *path, scree_experiment *experiment,
                                   scree_error *error) {
  scree_yaml root;
  scree_status status = scree_yaml_read(path, &root, error);
  if (status != SCREE_OK) return status;
  status = apply_root(strcmp(path, "-") != 0 ? path : "standard input", &root, experiment, error);
  scree_yaml_free(&root);
  return status;
}

scree_status scree_experiment_parse(const char *text, size_t byte_count, const char *name,
                                    scree_experiment *experiment, scree_error *error) {
  scree_yaml root;
  scree_status status = scree_yaml_parse(text, byte_count, name, &root, error);
  if (status != SCREE_OK) return status;
  status = apply_root(name, &root, experiment, error);
  scree_yaml_free(&root);
  return status;
}

scree_status scree_experiment_copy(const scree_experiment *experiment, scree_experiment *copy,
                                   scree_error *error) {
  char *preset = scree_strdup(experiment->preset);
  if (!preset) return scree_fail_memory(error, 0, "a preset's name");
  *copy = *experiment;
  copy->preset = preset;
  return SCREE_OK;
}

/* The shortest of %.6g to %.17g that reads back as the same number. */
static void real_text(double value, char *buffer, size_t size) {
  char text[SCREE_NUMBER_SIZE];
  double back;
  for (int digits = 6; digits <= 17; digits++) {
    scree_number_format_digits(value, digits, text);
    if (scree_number_read(text, &back) && back == value) break;
  }
  snprintf(buffer, size, "%s", text);
}

bool scree_experiment_get(const scree_experiment *experiment, const char *key, char *buffer,
                          size_t size) {
  const field *f = find_field(key);
  if (!f) return false;
  const void *value = (const char *)experiment + f->offset;
  switch (f->kind) {
  case FIELD_FLAG:
    snprintf(buffer, size, "%s", *(const bool *)value ? "true" : "false");
    break;
  case FIELD_WORD: {
    const char *word = f->unit;
    for (int i = *(const int *)value; i > 0; i--) word += strcspn(word, "|") + 1;
    snprintf(buffer, size, "%.*s", (int)strcspn(word, "|"), word);
    break;
  }
  case FIELD_SEED:
    snprintf(buffer, size, "%llu", (unsigned long long)*(const uint64_t *)value);
    break;
  case FIELD_COUNT:
    snprintf(buffer, size, "%zu", *(const size_t *)value);
    break;
  case FIELD_REAL:
    real_text(*(const double *)value, buffer, size);
    break;
  }
  return true;
}

void scree_experiment_print(const scree_experiment *experiment, FILE *stream) {
  const char *group = "";
  size_t group_length = 0;
  fprintf(stream,
          "# An angle-of-repose experiment for scree %s. [p]: Katagiri and Koyanaka (2020);\n"
          "# [p*]: the same, read as docs/background/method.md says; [s]: scree's choice.\n",
          scree_version());
  fprintf(stream, "# %s\npreset: %s\n", preset_difference(experiment->preset), experiment->preset);
  for (size_t i = 0; i < FIELD_COUNT_ALL; i++) {
    const field *f = &fields[i];
    const char *dot = strchr(f->key, '.'), *name = dot ? dot + 1 : f->key;
    size_t length = dot ? (size_t)(dot - f->key) : 0;
    if (length && (length != group_length || strncmp(group, f->key, length) != 0))
      fprintf(stream, "%.*s:\n", (int)length, f->key);
    group = f->key;
    group_length = length;
    char value[64];
    scree_experiment_get(experiment, f->key, value, sizeof value);
    fprintf(stream, "%s%s: %s  # %s%s%s\n", length ? "  " : "", name, value, f->unit,
            *f->unit ? "; " : "", f->comment);
  }
}
