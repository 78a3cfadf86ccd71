/* Changing a scene's file: fields by their place, parameters that set several, presets, the shapes
 * that are poured, and settings from a file of their own. */
#include "scene/file.h"

#include "base/alloc.h"
#include "base/number.h"
#include "base/quote.h"

#include <string.h>

enum { MOST_NAMES = 64, PATH_BYTES = 300 };

/* ---- single fields ---- */

static const char *text_of(const scree_yaml *item, const char *key) {
  const scree_yaml *node = item->kind == SCREE_YAML_MAPPING ? scree_yaml_find(item, key) : NULL;
  return node && node->kind == SCREE_YAML_SCALAR ? node->text : NULL;
}

static double number_of(const scree_yaml *item, const char *key) {
  double value;
  const char *text = text_of(item, key);
  return text && scree_number_read(text, &value) ? value : (double)NAN;
}

/* Whether the fields of a parameter follow the size of the shapes. */
static bool scales(const scree_yaml *parameter) {
  return number_of(parameter, "power") > 0;
}

/* The group of things with names of the user's that a field lies in; NULL: in none. */
static const scree_field *named_group(const char *field) {
  size_t length = strcspn(field, ".");
  for (size_t i = 0; i < scree_plan_record.field_count; i++) {
    const scree_field *f = &scree_plan_record.fields[i];
    if (f->kind == SCREE_FIELD_NAMED && !strncmp(f->key, field, length) && !f->key[length])
      return f;
  }
  return NULL;
}

static bool is_called(const scree_yaml *item, const char *name, size_t length) {
  return item->key && strlen(item->key) == length && !strncmp(item->key, name, length);
}

/* A name that is not there, on the way to a field of it, is a slip: a thing would be made of it
 * that nothing uses. */
static scree_status need_named(const scree_scene_file *file, const char *field,
                               scree_error *error) {
  const scree_field *f = named_group(field);
  const char *name = strchr(field, '.'), *end = name ? strchr(++name, '.') : NULL;
  if (!f || !end) return SCREE_OK;
  const scree_yaml *group = scree_yaml_find(&file->root, f->key);
  const char *names[MOST_NAMES] = {NULL}, *blank = strchr(f->record->what, ' ');
  size_t count = 0;
  for (size_t i = 0; group && i < group->item_count && group->items[i].key; i++) {
    if (is_called(&group->items[i], name, (size_t)(end - name))) return SCREE_OK;
    if (count < MOST_NAMES) names[count++] = group->items[i].key;
  }
  char word[64];
  snprintf(word, sizeof word, "%.*s", (int)(end - name), name);
  scree_reader reader = {file->name, NULL, error, ""};
  scree_place place = {.path = f->key};
  return scree_fail_name(&reader, &place, blank ? blank + 1 : f->record->what, word, names, count);
}

/* Field `index` of those that a parameter sets; NULL: there are no more. */
static const scree_yaml *field_of(const scree_yaml *parameter, size_t index) {
  const scree_yaml *sets =
      parameter->kind == SCREE_YAML_MAPPING ? scree_yaml_find(parameter, "sets") : NULL;
  if (!sets || sets->kind == SCREE_YAML_SCALAR) return index ? NULL : sets;
  return index < sets->item_count ? &sets->items[index] : NULL;
}

/* Whether it sets the field, or one in it. */
static bool sets(const scree_yaml *parameter, const char *field) {
  size_t length = strlen(field);
  const scree_yaml *set;
  for (size_t i = 0; (set = field_of(parameter, i)); i++)
    if (set->kind == SCREE_YAML_SCALAR && !strncmp(set->text, field, length) &&
        (!set->text[length] || set->text[length] == '.'))
      return true;
  return false;
}

/* What is set is as it is meant: it follows the size of the shapes no more. */
static scree_status set_field(scree_scene_file *file, const char *field, const char *value,
                              scree_error *error) {
  SCREE_TRY(need_named(file, field, error));
  SCREE_TRY(scree_yaml_set(&file->root, field, value, error));
  const scree_yaml *parameters = scree_yaml_find(&file->root, "parameters");
  for (size_t i = 0; parameters && i < parameters->item_count; i++) {
    char path[64];
    if (!scales(&parameters->items[i]) || !sets(&parameters->items[i], field)) continue;
    snprintf(path, sizeof path, "parameters.%zu.power", i);
    SCREE_TRY(scree_yaml_set(&file->root, path, "0", error));
  }
  return SCREE_OK;
}

/* "shapes.*.rp": of everything in the group. */
static scree_status set_all(scree_scene_file *file, const char *field, const char *value,
                            scree_error *error) {
  const char *star = strstr(field, ".*.");
  if (!star) return set_field(file, field, value, error);
  char group[PATH_BYTES], path[2 * PATH_BYTES];
  snprintf(group, sizeof group, "%.*s", (int)(star - field), field);
  const scree_yaml *items = scree_yaml_find(&file->root, group);
  for (size_t i = 0; items && i < items->item_count; i++) {
    snprintf(path, sizeof path, "%s.%.100s.%.100s", group, items->items[i].key, star + 3);
    SCREE_TRY(scree_yaml_set(&file->root, path, value, error));
  }
  return SCREE_OK;
}

/* ---- parameters and presets ---- */

/* The group of a list whose `key` is that name; NULL: there is none. */
static const scree_yaml *find_by(const scree_scene_file *file, const char *list, const char *key,
                                 const char *name) {
  const scree_yaml *items = scree_yaml_find(&file->root, list);
  for (size_t i = 0; items && items->kind == SCREE_YAML_SEQUENCE && i < items->item_count; i++) {
    const char *text = text_of(&items->items[i], key);
    if (text && !strcmp(text, name)) return &items->items[i];
  }
  return NULL;
}

static const scree_yaml *find_item(const scree_scene_file *file, const char *list,
                                   const char *name) {
  return find_by(file, list, "name", name);
}

static size_t list_names(const scree_scene_file *file, const char *list,
                         const char *names[MOST_NAMES]) {
  const scree_yaml *items = scree_yaml_find(&file->root, list);
  size_t count = 0;
  for (size_t i = 0; items && i < items->item_count && count < MOST_NAMES; i++)
    if ((names[count] = text_of(&items->items[i], "name"))) count++;
  return count;
}

/* The value times the parameter's factor, with its unit; in its range where it has none. */
static scree_status scale_value(const scree_yaml *parameter, const char *name, const char *value,
                                char *scaled, size_t size, scree_error *error) {
  double factor = number_of(parameter, "factor"), least = number_of(parameter, "least"),
         most = number_of(parameter, "most"), number;
  char text[SCREE_NUMBER_SIZE];
  const char *end = value + strlen(value), *unit = scree_number_parse(value, end, &number);
  if ((size_t)snprintf(scaled, size, "%s", value) >= size)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: '%.60s': is too long", name, value);
  if (isnan(factor) && isnan(least) && isnan(most)) return SCREE_OK;
  if (!unit)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: '%.60s': must be a number", name, value);
  if (!*unit && (number < least || number > most))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: %g: must be %g to %g", name, number, least,
                      most);
  if (isnan(factor)) return SCREE_OK;
  scree_number_format_digits(factor * number, 17, text);
  snprintf(scaled, size, "%s%s", text, unit);
  return SCREE_OK;
}

static scree_status set_parameter(scree_scene_file *file, const scree_yaml *parameter,
                                  const char *name, const char *value, scree_error *error) {
  char scaled[PATH_BYTES];
  const scree_yaml *field = field_of(parameter, 0);
  SCREE_TRY(field ? scale_value(parameter, name, value, scaled, sizeof scaled, error)
                  : scree_scene_file_check(file, error));
  for (size_t i = 0; (field = field_of(parameter, i)); i++) {
    if (field->kind != SCREE_YAML_SCALAR) return scree_scene_file_check(file, error);
    SCREE_TRY(set_all(file, field->text, scaled, error));
  }
  return SCREE_OK;
}

/* A preset for particles of a size: what has a power follows theirs from then on, but for what was
 * set before. */
static scree_status let_scale(scree_scene_file *file, const char *size, scree_error *error) {
  const scree_yaml *parameters = scree_yaml_find(&file->root, "parameters");
  for (size_t i = 0; parameters && i < parameters->item_count; i++) {
    char path[64];
    const char *power = text_of(&parameters->items[i], "scales");
    if (!power) continue;
    snprintf(path, sizeof path, "parameters.%zu.size", i);
    SCREE_TRY(scree_yaml_set(&file->root, path, size, error));
    snprintf(path, sizeof path, "parameters.%zu.power", i);
    SCREE_TRY(scree_yaml_set(&file->root, path, power, error));
  }
  return SCREE_OK;
}

static scree_status set_preset(scree_scene_file *file, const char *name, scree_error *error) {
  const scree_yaml *preset = find_item(file, "presets", name);
  if (!preset) {
    const char *names[MOST_NAMES] = {NULL};
    size_t count = list_names(file, "presets", names);
    scree_reader reader = {"", NULL, error, ""};
    return scree_fail_name(&reader, &(scree_place){.path = "preset"}, "preset", name, names, count);
  }
  const scree_yaml *set = scree_yaml_find(preset, "set");
  for (size_t i = 0; set && i < set->item_count; i++)
    if (set->items[i].kind == SCREE_YAML_SCALAR && strcmp(set->items[i].key, "preset") != 0)
      SCREE_TRY(scree_scene_file_set(file, set->items[i].key, set->items[i].text, error));
  if (text_of(preset, "size")) SCREE_TRY(let_scale(file, text_of(preset, "size"), error));
  return scree_yaml_set(&file->root, "preset", name, error);
}

scree_status scree_scene_file_set(scree_scene_file *file, const char *field, const char *value,
                                  scree_error *error) {
  if (file->root.kind != SCREE_YAML_MAPPING) return scree_scene_file_check(file, error);
  if (!strcmp(field, "preset")) return set_preset(file, value, error);
  const scree_yaml *parameter = find_item(file, "parameters", field),
                   *renamed = find_by(file, "parameters", "was", field);
  if (!parameter && renamed)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "'%s' is called '%s' now", field,
                      text_of(renamed, "name"));
  return parameter ? set_parameter(file, parameter, field, value, error)
                   : set_field(file, field, value, error);
}

/* ---- what follows the size of the particles ---- */

bool scree_scene_file_scales(const scree_scene_file *file) {
  const scree_yaml *parameters = scree_yaml_find(&file->root, "parameters");
  for (size_t i = 0; parameters && i < parameters->item_count; i++)
    if (scales(&parameters->items[i])) return true;
  return false;
}

static double factor_of(const scree_yaml *parameter, const scree_scene_extent *extent) {
  double size = number_of(parameter, "size"), power = number_of(parameter, "power"),
         share = size > 0 ? extent->mean / size
                          : fmin(1, extent->largest / number_of(parameter, "below")),
         factor = power > floor(power) ? sqrt(share) : 1;
  for (double whole = 1; whole <= power; whole++) factor *= share;
  return factor;
}

static scree_status scale(scree_scene_file *file, const scree_yaml *parameter, double factor,
                          scree_error *error) {
  const scree_yaml *field;
  double value;
  for (size_t i = 0; (field = field_of(parameter, i)); i++) {
    const scree_yaml *node = field->text ? scree_yaml_at(&file->root, field->text) : NULL;
    char text[SCREE_NUMBER_SIZE];
    if (!node || !node->text || !scree_number_read(node->text, &value)) continue;
    scree_number_format_digits(factor * value, 17, text);
    SCREE_TRY(set_field(file, field->text, text, error));
  }
  return SCREE_OK;
}

scree_status scree_scene_file_scale(const scree_scene_file *file, const scree_scene_extent *extent,
                                    scree_scene_file **scaled, scree_error *error) {
  scree_yaml root;
  SCREE_OWNED(scree_scene_file, made);
  SCREE_TRY(scree_yaml_copy(&file->root, &root, error));
  SCREE_TRY(scree_scene_file_keep(&root, file->name, &made, error));
  const scree_yaml *parameters = scree_yaml_find(&made->root, "parameters");
  for (size_t i = 0; parameters && i < parameters->item_count; i++) {
    const scree_yaml *p = &parameters->items[i];
    if (scales(p)) SCREE_TRY(scale(made, p, factor_of(p, extent), error));
  }
  *scaled = made;
  made = NULL;
  return SCREE_OK;
}

/* ---- several, of which the first that cannot be is told ---- */

static const scree_field *field_named(const struct scree_record *record, const char *key,
                                      size_t length) {
  for (size_t i = 0; i < record->field_count; i++)
    if (strlen(record->fields[i].key) == length && !strncmp(record->fields[i].key, key, length))
      return &record->fields[i];
  return NULL;
}

/* The part of a thing that it has and that has the field, with a point behind; "": itself, or
 * none. */
static void part_with(const scree_yaml *item, const struct scree_record *record, const char *rest,
                      char part[64]) {
  size_t length = strcspn(rest, ".");
  *part = 0;
  if (field_named(record, rest, length)) return;
  for (size_t i = 0; i < item->item_count; i++) {
    const char *key = item->items[i].key;
    const scree_field *f = key ? field_named(record, key, strlen(key)) : NULL;
    if (f && f->kind == SCREE_FIELD_RECORD && field_named(f->record, rest, length))
      snprintf(part, 64, "%.60s.", key);
  }
}

/* Where a field that is none of a scene may have been meant: in the thing that its first word
 * names, or in every thing of a kind that has it. */
static bool find_meant(const scree_scene_file *file, const char *field, char *meant, size_t size) {
  size_t length = strcspn(field, ".");
  const char *rest = field[length] ? field + length + 1 : NULL;
  char part[64];
  for (size_t i = 0; i < scree_plan_record.field_count; i++) {
    const scree_field *f = &scree_plan_record.fields[i];
    const scree_yaml *group = scree_yaml_find(&file->root, f->key);
    if (f->kind != SCREE_FIELD_NAMED || !group) continue;
    if (!rest && field_named(f->record, field, length))
      return snprintf(meant, size, "%s.NAME.%.150s", f->key, field) > 0;
    for (size_t k = 0; rest && k < group->item_count; k++) {
      if (!is_called(&group->items[k], field, length)) continue;
      part_with(&group->items[k], f->record, rest, part);
      return snprintf(meant, size, "%s.%.*s.%s%.150s", f->key, (int)length, field, part, rest) > 0;
    }
  }
  return false;
}

scree_status scree_scene_file_try(scree_scene_file *file, const char *field, const char *value,
                                  scree_error *error) {
  scree_error why, before;
  scree_status sound = scree_scene_file_check(file, &before);
  if (sound == SCREE_OUT_OF_MEMORY) return scree_fail(error, sound, "%s", before.message);
  scree_status status = scree_scene_file_set(file, field, value, &why);
  if (status == SCREE_BAD_FILE) status = SCREE_BAD_ARGUMENT; /* no other field can mend it */
  if (status != SCREE_OK) return scree_fail(error, status, "%s", why.message);
  if (sound != SCREE_OK) status = scree_scene_file_check(file, &why);
  if (status == SCREE_OUT_OF_MEMORY) return scree_fail(error, status, "%s", why.message);
  if (status != SCREE_OK && !strcmp(why.message, before.message)) /* it is not of this setting */
    return scree_fail(error, SCREE_BAD_FILE, "%s", why.message);
  char *name = file->name, none[] = "";
  file->name = none; /* its errors say nothing of the file */
  status = scree_scene_file_check(file, &why);
  file->name = name;
  if (status == SCREE_OK || status == SCREE_OUT_OF_MEMORY) {
    if (status != SCREE_OK && error) *error = why;
    return status;
  }
  const char *names[MOST_NAMES] = {NULL};
  size_t count = list_names(file, "parameters", names);
  const char *nearest =
      find_item(file, "parameters", field) ? NULL : scree_nearest_name(field, names, count);
  if (nearest)
    return scree_fail(error, SCREE_BAD_FILE, "no field '%s'; did you mean '%s'?", field, nearest);
  if (strncmp(why.message, "no field", 8) != 0)
    return scree_fail(error, SCREE_BAD_FILE, "%s: %s", field, why.message);
  char meant[PATH_BYTES];
  if (find_meant(file, field, meant, sizeof meant))
    return scree_fail(error, SCREE_BAD_FILE, "no field '%.150s'; did you mean '%s'?", field, meant);
  return scree_fail(error, SCREE_BAD_FILE, "%s", why.message);
}

typedef struct applier {
  scree_scene_file *file;
  const char *name; /* of the file with the settings */
  scree_error first;
  scree_status status; /* of the first that failed; SCREE_BAD_FILE: all together may be good */
} applier;

static void blame(applier *a, const scree_yaml *node, scree_status status, const scree_error *why) {
  if (status == SCREE_OK || (a->status != SCREE_OK && a->status != SCREE_BAD_FILE)) return;
  if (a->status == SCREE_BAD_FILE && status == SCREE_BAD_FILE) return;
  a->status = status;
  bool unknown = !strncmp(why->message, "no field", 8);
  if (status == SCREE_OUT_OF_MEMORY)
    a->first = *why;
  else
    scree_fail(&a->first, SCREE_BAD_FILE, "%.300s, line %zu, column %zu: %.600s", a->name,
               unknown ? node->key_line : node->line, unknown ? node->key_column : node->column,
               why->message);
}

static void apply(applier *a, const scree_yaml *node, const char *path) {
  char key[PATH_BYTES];
  scree_error why;
  snprintf(key, sizeof key, "%.150s%s%.100s", path, *path ? "." : "", node->key);
  if (node->kind == SCREE_YAML_MAPPING) {
    for (size_t i = 0; i < node->item_count; i++) apply(a, &node->items[i], key);
    return;
  }
  scree_status status = node->kind == SCREE_YAML_SCALAR
                            ? scree_scene_file_try(a->file, key, node->text, &why)
                            : scree_fail(&why, SCREE_BAD_ARGUMENT, "%s: must be one value", key);
  blame(a, node, status, &why);
}

/* The settings of a tree over a file. */
static scree_status apply_all(scree_scene_file *file, const scree_yaml *settings, const char *name,
                              scree_error *error) {
  applier a = {.file = file, .name = name};
  const scree_yaml *preset = scree_yaml_find(settings, "preset");
  if (preset) apply(&a, preset, "");
  for (size_t i = 0; i < settings->item_count; i++)
    if (&settings->items[i] != preset) apply(&a, &settings->items[i], "");
  if (a.status == SCREE_OK) return SCREE_OK;
  if (a.status == SCREE_BAD_FILE && scree_scene_file_check(file, NULL) == SCREE_OK) return SCREE_OK;
  if (error) *error = a.first;
  return a.first.status;
}

/* ---- templates, and what is poured ---- */

scree_status scree_scene_file_template(const char *name, scree_scene_file **file,
                                       scree_error *error) {
  const char *text = scree_scene_template(name);
  if (text) return scree_scene_file_parse(text, strlen(text), "", file, error);
  const char *names[MOST_NAMES] = {NULL};
  size_t count = 0;
  while (count < MOST_NAMES && (names[count] = scree_scene_template_name(count))) count++;
  scree_reader reader = {"", NULL, error, ""};
  (void)scree_fail_name(&reader, &(scree_place){.path = ""}, "template", name, names, count);
  return SCREE_BAD_FILE;
}

scree_status scree_scene_file_read_over(const char *path, const char *template_name,
                                        const char *preset, scree_scene_file **file,
                                        scree_error *error) {
  SCREE_OWNED(scree_scene_file, read);
  SCREE_OWNED(scree_scene_file, made);
  SCREE_TRY(scree_scene_file_read(path, &read, error));
  bool whole = read->root.kind != SCREE_YAML_MAPPING || scree_yaml_find(&read->root, "inlets");
  scree_scene_file **answer = whole ? &read : &made;
  if (!whole) SCREE_TRY(scree_scene_file_template(template_name, &made, error));
  if (!whole && preset && !scree_yaml_find(&read->root, "preset"))
    SCREE_TRY(scree_scene_file_set(made, "preset", preset, error));
  if (!whole) SCREE_TRY(apply_all(made, &read->root, read->name, error));
  *file = *answer;
  *answer = NULL;
  return SCREE_OK;
}

/* The first material that no geometry is of; NULL: none is left, or there is one for all. */
static const char *particle_material(const scree_scene_file *file) {
  const scree_yaml *materials = scree_yaml_find(&file->root, "materials"),
                   *geometry = scree_yaml_find(&file->root, "geometry");
  for (size_t i = 0; materials && i < materials->item_count; i++) {
    bool used = false;
    for (size_t k = 0; geometry && k < geometry->item_count; k++) {
      const char *of = text_of(&geometry->items[k], "material");
      used = used || (of && !strcmp(of, materials->items[i].key));
    }
    if (!used) return materials->items[i].key;
  }
  return NULL;
}

static scree_status add_shape(scree_scene_file *file, const scree_poured *shape,
                              scree_error *error) {
  const char *material = particle_material(file);
  const scree_yaml *inlets = scree_yaml_find(&file->root, "inlets");
  char path[PATH_BYTES], share[SCREE_NUMBER_SIZE];
  SCREE_CLEANUP(scree_free_at) char *value = scree_quoted(SCREE_QUOTE_YAML, shape->value);
  if (!value) return scree_fail_memory(error, strlen(shape->value), "a shape");
  snprintf(path, sizeof path, "shapes.%.64s", shape->name);
  SCREE_TRY(scree_yaml_set(&file->root, path, "{}", error));
  snprintf(path, sizeof path, "shapes.%.64s.%.32s", shape->name, shape->kind);
  SCREE_TRY(scree_yaml_set(&file->root, path, value, error));
  snprintf(path, sizeof path, "shapes.%.64s.material", shape->name);
  if (material) SCREE_TRY(scree_yaml_set(&file->root, path, material, error));
  scree_number_format_digits(shape->share, 17, share);
  for (size_t i = 0; inlets && i < inlets->item_count; i++) {
    snprintf(path, sizeof path, "inlets.%.64s.shapes.%.64s", inlets->items[i].key, shape->name);
    SCREE_TRY(scree_yaml_set(&file->root, path, share, error));
  }
  return SCREE_OK;
}

scree_status scree_scene_file_pour(scree_scene_file *file, const scree_poured *shapes, size_t count,
                                   scree_error *error) {
  const scree_yaml *inlets = scree_yaml_find(&file->root, "inlets");
  if (file->root.kind != SCREE_YAML_MAPPING) return scree_scene_file_check(file, error);
  SCREE_TRY(scree_yaml_set(&file->root, "shapes", "{}", error));
  for (size_t i = 0; inlets && i < inlets->item_count; i++) {
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "inlets.%.64s.shapes", inlets->items[i].key);
    SCREE_TRY(scree_yaml_set(&file->root, path, "{}", error));
  }
  for (size_t i = 0; i < count; i++) SCREE_TRY(add_shape(file, &shapes[i], error));
  return SCREE_OK;
}
