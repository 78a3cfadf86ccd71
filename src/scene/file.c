/* A scene's file: a tree that knows its places, changed field by field, and read into a plan. */
#include "scene/file.h"
#include "scene/geometry.h"

#include "base/alloc.h"
#include "base/platform.h"

#include <stdlib.h>
#include <string.h>

scree_status scree_scene_file_keep(scree_yaml *root, const char *name, scree_scene_file **file,
                                   scree_error *error) {
  const char *slash = strrchr(name, '/');
  scree_scene_file *made = scree_alloc_zero(1, sizeof *made);
  if (made) {
    made->name = scree_strdup(strcmp(name, "-") != 0 ? name : "standard input");
    made->folder = scree_strdup(slash ? name : "");
  }
  if (!made || !made->name || !made->folder) {
    scree_yaml_free(root);
    scree_scene_file_free(made);
    return scree_fail_memory(error, sizeof *made, name);
  }
  if (slash) made->folder[slash + 1 - name] = 0;
  made->root = *root;
  *file = made;
  return SCREE_OK;
}

scree_status scree_scene_file_read(const char *path, scree_scene_file **file, scree_error *error) {
  scree_yaml root;
  SCREE_TRY(scree_yaml_read(path, &root, error));
  return scree_scene_file_keep(&root, path, file, error);
}

scree_status scree_scene_file_parse(const char *text, size_t byte_count, const char *name,
                                    scree_scene_file **file, scree_error *error) {
  scree_yaml root;
  SCREE_TRY(scree_yaml_parse(text, byte_count, name, &root, error));
  return scree_scene_file_keep(&root, name, file, error);
}

void scree_scene_file_free(scree_scene_file *file) {
  if (!file) return;
  scree_yaml_free(&file->root);
  scree_free(file->name);
  scree_free(file->folder);
  scree_free(file);
}

scree_status scree_scene_file_plan(const scree_scene_file *file, scree_arena *arena,
                                   scree_plan *plan, scree_error *error) {
  scree_reader reader = {file->name, arena, error, ""};
  return scree_plan_read(&reader, &file->root, plan);
}

scree_status scree_scene_file_check(const scree_scene_file *file, scree_error *error) {
  SCREE_CLEANUP(scree_arena_free) scree_arena arena = {0};
  scree_plan plan;
  return scree_scene_file_plan(file, &arena, &plan, error);
}

scree_status scree_scene_file_print(const scree_scene_file *file, FILE *stream,
                                    scree_error *error) {
  SCREE_CLEANUP(scree_arena_free) scree_arena arena = {0};
  scree_plan plan;
  SCREE_TRY(scree_scene_file_plan(file, &arena, &plan, error));
  scree_record_print(&scree_plan_record, &plan, 0, true, stream);
  return SCREE_OK;
}

scree_status scree_scene_file_text(const scree_scene_file *file, char **text, scree_error *error) {
  char *printed = NULL;
  size_t size;
  FILE *stream = scree_memory_open(&printed, &size);
  if (!stream) return scree_fail_memory(error, 0, file->name);
  scree_status status = scree_scene_file_print(file, stream, error);
  bool good = scree_memory_close(stream);
  if (status == SCREE_OK) {
    *text = good ? scree_strdup(printed) : NULL;
    if (!*text) status = scree_fail_memory(error, size, file->name);
  }
  free(printed);
  return status;
}

/* The name of file `index` of the plan; NULL: there are no more. */
static const char *input_at(const scree_plan *plan, size_t index) {
  for (size_t i = 0; i < plan->shapes.count; i++) {
    const scree_plan_shape *s = &plan->shapes.items[i];
    const char *name = s->file || scree_plan_spheres(s) ? s->file : s->clump;
    if (name && index-- == 0) return name;
    for (size_t k = 0; k < s->parts.count; k++)
      if (s->parts.items[k].file && index-- == 0) return s->parts.items[k].file;
  }
  if (plan->bodies && index-- == 0) return plan->bodies->file;
  for (size_t i = 0; i < plan->geometry.count; i++) {
    const char *name;
    for (size_t k = 0; (name = scree_geometry_file_name(&plan->geometry.items[i], k)); k++)
      if (index-- == 0) return name;
  }
  return NULL;
}

scree_status scree_scene_file_find_input(const scree_scene_file *file, size_t index, char *path,
                                         size_t size, scree_error *error) {
  SCREE_CLEANUP(scree_arena_free) scree_arena arena = {0};
  scree_plan plan;
  *path = 0;
  SCREE_TRY(scree_scene_file_plan(file, &arena, &plan, error));
  const char *name = input_at(&plan, index);
  const char *folder = name && *name != '/' ? file->folder : "";
  if ((size_t)snprintf(path, size, "%s%s", folder, name ? name : "") >= size)
    return scree_fail(error, SCREE_BAD_FILE, "%s: the path of file %zu is longer than %zu bytes",
                      file->name, index + 1, size - 1);
  return SCREE_OK;
}

bool scree_scene_file_input(const scree_scene_file *file, size_t index, char *path, size_t size) {
  return scree_scene_file_find_input(file, index, path, size, NULL) == SCREE_OK && *path;
}

/* ---- templates ---- */

const char *scree_scene_template_name(size_t index) {
  for (size_t i = 0; i < index; i++)
    if (!scree_templates[i].name) return NULL;
  return scree_templates[index].name;
}

const char *scree_scene_template(const char *name) {
  for (const scree_template *t = scree_templates; t->name; t++)
    if (!strcmp(t->name, name)) return t->text;
  return NULL;
}
