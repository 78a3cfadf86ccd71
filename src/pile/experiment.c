/* The experiment's fields in one table (base/schema.h): key, unit, range, what it is and where the
 * default comes from. The table reads YAML, sets single fields and prints the commented file. */
#include "base/alloc.h"
#include "base/schema.h"
#include "base/yaml.h"

#include "scree.h"

#include <string.h>

#define AT(name) offsetof(scree_experiment, name)
/* Sources: [p] the paper, section 2.3; [p*] the paper, read as docs/background/method.md says; [s]
 * scree. */
static const scree_field fields[] = {
    {"particles", SCREE_FIELD_COUNT, AT(particle_count), 1, 1e7, "",
     "how many, in equal shares of the shapes [p]", NULL},
    {"seed", SCREE_FIELD_SEED, AT(seed), 0, 0, "",
     "of positions, orientations and order; replicates add 1", NULL},
    {"density", SCREE_FIELD_REAL, AT(density), 1, 1e5, "kg/m3", "not given in the paper [s]", NULL},
    {"mass_from", SCREE_FIELD_WORD, AT(mass_rule), 0, 0, "mesh|scan",
     "volume that gives the mass: of each decimated mesh, or of the scan at every level [s]", NULL},
    {"cylinder.diameter", SCREE_FIELD_REAL, AT(cylinder_diameter), 1e-4, 1e3, "m", "inside [p*]",
     NULL},
    {"disc.diameter", SCREE_FIELD_REAL, AT(disc_diameter), 1e-4, 1e4, "m",
     "bottom; what leaves it falls off [p*]", NULL},
    {"phases.pack_time", SCREE_FIELD_REAL, AT(pack_time), 0, 1e4, "s",
     "particles are filled in from above [p]", NULL},
    {"phases.settle_time", SCREE_FIELD_REAL, AT(settle_time), 0, 1e4, "s", "they come to rest [p]",
     NULL},
    {"phases.lift_speed", SCREE_FIELD_REAL, AT(lift_speed), 1e-5, 10, "m/s",
     "of the cylinder, upwards [p]", NULL},
    {"phases.lift_time", SCREE_FIELD_REAL, AT(lift_time), 0, 1e5, "s", "[p]", NULL},
    {"phases.hold_time", SCREE_FIELD_REAL, AT(hold_time), 0, 1e5, "s",
     "after the lift, at most, until still [s]", NULL},
    {"phases.stop_when_still", SCREE_FIELD_FLAG, AT(stop_when_still), 0, 0, "",
     "end settling, lifting (once the cylinder is clear) and holding early when still [s]", NULL},
    {"phases.still_energy", SCREE_FIELD_REAL, AT(still_energy), 0, 1, "J",
     "kinetic energy a particle below which the heap is still [s]", NULL},
    {"phases.inlet", SCREE_FIELD_WORD, AT(inlet), 0, 0, "top|heap",
     "particles fall from above where the packed heap will end [p], or from near the heap as it "
     "grows: slower hits [s]",
     NULL},
    {"phases.drop_height", SCREE_FIELD_REAL, AT(drop_height), 0, 100, "m",
     "from the heap's top to the layer filled in, at least [s]", NULL},
    {"contact.young_particle", SCREE_FIELD_REAL, AT(young_particle), 1e3, 1e13, "Pa", "[p]", NULL},
    {"contact.young_wall", SCREE_FIELD_REAL, AT(young_wall), 1e3, 1e13, "Pa", "[p]", NULL},
    {"contact.restitution", SCREE_FIELD_REAL, AT(restitution), 0.01, 1, "", "[p]", NULL},
    {"contact.friction_particle", SCREE_FIELD_REAL, AT(friction_particle), 0, 10, "",
     "particle on particle [p]", NULL},
    {"contact.friction_wall", SCREE_FIELD_REAL, AT(friction_wall), 0, 10, "",
     "particle on wall [p]", NULL},
    {"contact.law", SCREE_FIELD_WORD, AT(contact_law), 0, 0, "linear|hysteretic", "[p]: linear",
     NULL},
    {"contact.steps", SCREE_FIELD_REAL, AT(steps_per_contact), 15, 1000, "",
     "time steps in a quarter of a contact's period; below 15 corners are not resolved [s]", NULL},
    {"contact.stiffness_factor", SCREE_FIELD_REAL, AT(stiffness_factor), 1e-4, 10, "",
     "multiplies every stiffness: below 1 the time step grows with its root, overlaps with its "
     "inverse [s]",
     NULL},
    {"gravity", SCREE_FIELD_REAL, AT(gravity), 0, 1e3, "m/s2", "downwards", NULL},
    {"output.frame_interval", SCREE_FIELD_REAL, AT(frame_interval), 0, 1e5, "s",
     "of simulated time; 0: only the last [s]", NULL},
    {"output.checkpoint_interval", SCREE_FIELD_REAL, AT(checkpoint_interval), 0.01, 1e6, "s",
     "of wall-clock time: what a crash costs at most [s]", NULL},
    {"output.series_interval", SCREE_FIELD_REAL, AT(series_interval), 1e-5, 1e4, "s",
     "of simulated time between the points of the series [s]", NULL},
    {"output.angle_interval", SCREE_FIELD_REAL, AT(angle_interval), 0, 1e5, "s",
     "between points with angles, while lifting and holding; 0: only the last [s]", NULL},
    {"measure.cell", SCREE_FIELD_REAL, AT(height_cell), 0, 1, "m",
     "of the height field; 0: a tenth of the particle size [s]", NULL},
    {"measure.sectors", SCREE_FIELD_COUNT, AT(sector_count), 1, 3600, "", "azimuth sectors [s]",
     NULL},
    {"measure.band_low", SCREE_FIELD_REAL, AT(band_low), 0, 1, "",
     "the flank begins at this share of the height [s]", NULL},
    {"measure.band_high", SCREE_FIELD_REAL, AT(band_high), 0, 1, "", "and ends at this one [s]",
     NULL},
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

static const scree_field *find_field(const char *key) {
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
  const scree_field *f = find_field(key);
  return f ? f->unit : NULL;
}
const char *scree_experiment_comment(const char *key) {
  const scree_field *f = find_field(key);
  return f ? f->comment : NULL;
}

scree_status scree_experiment_set(scree_experiment *experiment, const char *key, const char *value,
                                  scree_error *error) {
  const scree_field *f = find_field(key);
  scree_error why;
  scree_reader reader = {"", NULL, &why, ""};
  char text[200];
  if (!f)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "no field '%s' in an experiment; print one to see all", key);
  snprintf(text, sizeof text, "%s", value);
  scree_yaml node = {.kind = SCREE_YAML_SCALAR, .text = text};
  scree_status status = scree_field_read(&reader, &node, f, experiment);
  if (status == SCREE_OK) return status;
  return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: %s", key, why.message);
}

/* ---- YAML ---- */

/* Item `item` of the group, or of the whole where that is "". */
static scree_status read_value(const scree_reader *r, const scree_yaml *item, scree_experiment *e) {
  char key[128];
  snprintf(key, sizeof key, "%s%s%s", r->path, *r->path ? "." : "", item->key);
  const scree_field *f = find_field(key);
  if (f) return scree_field_read(r, item, f, e);
  const char *names[FIELD_COUNT_ALL];
  for (size_t i = 0; i < FIELD_COUNT_ALL; i++) names[i] = fields[i].key;
  const char *nearest = scree_nearest_name(key, names, FIELD_COUNT_ALL);
  scree_place place = {NULL, "", item->key_line, item->key_column};
  return scree_fail_place(r, &place, "no field '%s'%s%s%s", key, nearest ? "; did you mean '" : "",
                          nearest ? nearest : "", nearest ? "'?" : "");
}

static bool is_group(const char *name) {
  size_t length = strlen(name);
  for (size_t i = 0; i < FIELD_COUNT_ALL; i++)
    if (!strncmp(fields[i].key, name, length) && fields[i].key[length] == '.') return true;
  return false;
}

static scree_status read_group(const scree_reader *r, const scree_yaml *group,
                               scree_experiment *e) {
  scree_reader inner = *r;
  scree_status status = SCREE_OK;
  inner.path = group->key;
  for (size_t i = 0; status == SCREE_OK && i < group->item_count; i++)
    status = read_value(&inner, &group->items[i], e);
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
  scree_reader reader = {path, NULL, error, ""};
  scree_status status = read_preset(path, root, e, error);
  for (size_t i = 0; status == SCREE_OK && i < root->item_count; i++) {
    const scree_yaml *item = &root->items[i];
    if (!strcmp(item->key, "preset")) continue;
    status = item->kind == SCREE_YAML_MAPPING && is_group(item->key) ? read_group(&reader, item, e)
                                                                     : read_value(&reader, item, e);
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

bool scree_experiment_get(const scree_experiment *experiment, const char *key, char *buffer,
                          size_t size) {
  const scree_field *f = find_field(key);
  if (f) scree_field_text(f, experiment, buffer, size);
  return f != NULL;
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
    const scree_field *f = &fields[i];
    const char *dot = strchr(f->key, '.'), *name = dot ? dot + 1 : f->key;
    size_t length = dot ? (size_t)(dot - f->key) : 0;
    if (length && (length != group_length || strncmp(group, f->key, length) != 0))
      fprintf(stream, "%.*s:\n", (int)length, f->key);
    group = f->key;
    group_length = length;
    char value[64];
    scree_field_text(f, experiment, value, sizeof value);
    fprintf(stream, "%s%s: %s", length ? "  " : "", name, value);
    scree_field_print_comment(f, stream);
    putc('\n', stream);
  }
}
