#include "base/yaml.h"

#include "base/alloc.h"
#include "base/file.h"

#include <stdio.h>
#include <string.h>
#include <yaml.h>

enum { LARGEST_FILE = 1 << 20, DEEPEST = 16, LONGEST_KEY = 128 };

void scree_yaml_free(scree_yaml *root) {
  if (!root) return;
  for (size_t i = 0; i < root->item_count; i++) scree_yaml_free(&root->items[i]);
  scree_free(root->items);
  scree_free(root->key);
  scree_free(root->text);
  *root = (scree_yaml){0};
}

static char *copy_text(const char *text, bool *good) {
  char *copy = text ? scree_strdup(text) : NULL;
  *good = *good && (copy || !text);
  return copy;
}

scree_status scree_yaml_copy(const scree_yaml *node, scree_yaml *copy, scree_error *error) {
  bool good = true;
  *copy = *node;
  copy->key = copy_text(node->key, &good);
  copy->text = copy_text(node->text, &good);
  copy->item_count = 0;
  copy->items = node->item_count ? scree_alloc(node->item_count, sizeof *node) : NULL;
  good = good && (copy->items || !node->item_count);
  scree_status status = good ? SCREE_OK : scree_fail_memory(error, sizeof *node, "a copy");
  for (size_t i = 0; status == SCREE_OK && i < node->item_count; i++) {
    status = scree_yaml_copy(&node->items[i], &copy->items[i], error);
    if (status == SCREE_OK) copy->item_count++;
  }
  if (status != SCREE_OK) scree_yaml_free(copy);
  return status;
}

const scree_yaml *scree_yaml_find(const scree_yaml *mapping, const char *key) {
  for (size_t i = 0; i < mapping->item_count; i++)
    if (mapping->items[i].key && !strcmp(mapping->items[i].key, key)) return &mapping->items[i];
  return NULL;
}

typedef struct reader {
  yaml_parser_t parser;
  const char *bytes, *name;
  size_t byte_count;
  scree_error *error;
} reader;

static scree_status fail_at(reader *r, const yaml_mark_t *mark, const char *what) {
  return scree_fail(r->error, SCREE_BAD_FILE, "%s, line %zu, column %zu: %s", r->name,
                    mark->line + 1, mark->column + 1, what);
}

/* Bytes that are no text: the parser reads ahead and knows only their place in the file. */
static scree_status fail_encoding(reader *r, const char *problem) {
  yaml_mark_t mark = {0};
  size_t end = r->parser.problem_offset < r->byte_count ? r->parser.problem_offset : r->byte_count;
  for (size_t i = 0; i < end; i++, mark.column++)
    if (r->bytes[i] == '\n') mark = (yaml_mark_t){.line = mark.line + 1, .column = (size_t)-1};
  bool foreign = strstr(problem, "UTF-8") != NULL;
  return fail_at(r, &mark, foreign ? "no UTF-8 text: save the file as UTF-8" : problem);
}

static bool is_tab(const reader *r, const yaml_mark_t *mark) {
  const char *p = r->bytes, *end = r->bytes + r->byte_count;
  for (size_t line = 0; p && line < mark->line; line++) {
    p = memchr(p, '\n', (size_t)(end - p));
    if (p) p++;
  }
  return p && mark->column < (size_t)(end - p) && p[mark->column] == '\t';
}

static scree_status next_event(reader *r, yaml_event_t *event) {
  if (yaml_parser_parse(&r->parser, event)) return SCREE_OK;
  const char *problem = r->parser.problem ? r->parser.problem : "cannot be read as YAML";
  if (r->parser.error == YAML_MEMORY_ERROR) return scree_fail_memory(r->error, 0, r->name);
  if (r->parser.context && strstr(r->parser.context, "simple key"))
    return fail_at(r, &r->parser.context_mark, "must be `key: value`");
  if (r->parser.error == YAML_READER_ERROR) return fail_encoding(r, problem);
  if (is_tab(r, &r->parser.problem_mark))
    return fail_at(r, &r->parser.problem_mark, "a tab: lines are indented by blanks");
  return fail_at(r, &r->parser.problem_mark, problem);
}

static char *copy_scalar(const yaml_event_t *event) {
  return scree_strdup((const char *)event->data.scalar.value);
}

static scree_status read_node(reader *r, const yaml_event_t *event, int depth, scree_yaml *node);

/* A new empty item at the end, or NULL after filling the error. */
static scree_yaml *append(reader *r, scree_yaml *parent, size_t *capacity) {
  if (parent->item_count == *capacity) {
    size_t grown = *capacity ? 2 * *capacity : 8;
    scree_yaml *items = scree_resize(parent->items, grown, sizeof *items);
    if (!items) {
      scree_fail_memory(r->error, grown * sizeof *items, r->name);
      return NULL;
    }
    parent->items = items;
    *capacity = grown;
  }
  scree_yaml *item = &parent->items[parent->item_count++];
  *item = (scree_yaml){0};
  return item;
}

/* A key and its value into the mapping; *event is the key's. */
static scree_status read_pair(reader *r, yaml_event_t *event, int depth, scree_yaml *mapping,
                              size_t *capacity) {
  if (event->type != YAML_SCALAR_EVENT)
    return fail_at(r, &event->start_mark, "a key must be a word");
  if (scree_yaml_find(mapping, (const char *)event->data.scalar.value))
    return fail_at(r, &event->start_mark, "this key stands here twice");
  char *key = copy_scalar(event);
  if (!key) return scree_fail_memory(r->error, 0, r->name);
  scree_yaml *item = append(r, mapping, capacity);
  if (!item) {
    scree_free(key);
    return SCREE_OUT_OF_MEMORY;
  }
  item->key = key;
  item->key_line = event->start_mark.line + 1;
  item->key_column = event->start_mark.column + 1;
  SCREE_CLEANUP(yaml_event_delete) yaml_event_t value = {0};
  SCREE_TRY(next_event(r, &value));
  return read_node(r, &value, depth + 1, item);
}

static scree_status read_items(reader *r, int depth, scree_yaml *node, yaml_event_type_t end) {
  size_t capacity = 0;
  for (;;) {
    yaml_event_t event;
    scree_status status = next_event(r, &event);
    if (status != SCREE_OK) return status;
    bool done = event.type == end;
    if (!done && node->kind == SCREE_YAML_MAPPING) {
      status = read_pair(r, &event, depth, node, &capacity);
    } else if (!done) {
      scree_yaml *item = append(r, node, &capacity);
      status = item ? read_node(r, &event, depth + 1, item) : SCREE_OUT_OF_MEMORY;
    }
    yaml_event_delete(&event);
    if (done || status != SCREE_OK) return status;
  }
}

static scree_status read_node(reader *r, const yaml_event_t *event, int depth, scree_yaml *node) {
  node->line = event->start_mark.line + 1;
  node->column = event->start_mark.column + 1;
  if (depth > DEEPEST) return fail_at(r, &event->start_mark, "nested too deeply");
  switch (event->type) {
  case YAML_SCALAR_EVENT:
    node->kind = SCREE_YAML_SCALAR;
    node->text = copy_scalar(event);
    return node->text ? SCREE_OK : scree_fail_memory(r->error, 0, r->name);
  case YAML_SEQUENCE_START_EVENT:
    node->kind = SCREE_YAML_SEQUENCE;
    return read_items(r, depth, node, YAML_SEQUENCE_END_EVENT);
  case YAML_MAPPING_START_EVENT:
    node->kind = SCREE_YAML_MAPPING;
    return read_items(r, depth, node, YAML_MAPPING_END_EVENT);
  default:
    return fail_at(r, &event->start_mark, "aliases are not understood here");
  }
}

/* stream start, document start, one node, document end, stream end */
static scree_status read_stream(reader *r, scree_yaml *root) {
  bool seen = false;
  *root = (scree_yaml){.kind = SCREE_YAML_MAPPING, .line = 1, .column = 1};
  for (;;) {
    yaml_event_t event;
    scree_status status = next_event(r, &event);
    if (status != SCREE_OK) return status;
    bool end = event.type == YAML_STREAM_END_EVENT;
    bool frame =
        end || event.type == YAML_STREAM_START_EVENT || event.type == YAML_DOCUMENT_END_EVENT;
    if (event.type == YAML_DOCUMENT_START_EVENT && seen)
      status = fail_at(r, &event.start_mark, "a second document; one is expected");
    else if (!frame && event.type != YAML_DOCUMENT_START_EVENT) {
      seen = true;
      status = read_node(r, &event, 0, root);
    }
    yaml_event_delete(&event);
    if (end || status != SCREE_OK) return status;
  }
}

scree_status scree_yaml_parse(const char *bytes, size_t byte_count, const char *name,
                              scree_yaml *root, scree_error *error) {
  reader r = {.bytes = bytes, .name = name, .byte_count = byte_count, .error = error};
  if (!yaml_parser_initialize(&r.parser)) return scree_fail_memory(error, 0, name);
  yaml_parser_set_input_string(&r.parser, (const unsigned char *)bytes, byte_count);
  scree_yaml made;
  scree_status status = read_stream(&r, &made);
  yaml_parser_delete(&r.parser);
  if (status == SCREE_OK)
    *root = made;
  else
    scree_yaml_free(&made);
  return status;
}

scree_status scree_yaml_read(const char *path, scree_yaml *root, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  size_t byte_count;
  SCREE_TRY(scree_file_read(path, LARGEST_FILE, &bytes, &byte_count, error));
  return scree_yaml_parse(bytes, byte_count, path, root, error);
}

/* ---- setting ---- */

static void forget_places(scree_yaml *node) {
  node->line = node->column = node->key_line = node->key_column = 0;
  for (size_t i = 0; i < node->item_count; i++) forget_places(&node->items[i]);
}

/* The item of that number in a list; SIZE_MAX: there is none. */
static size_t item_of(const scree_yaml *list, const char *number) {
  size_t index = *number ? 0 : SIZE_MAX;
  for (const char *c = number; *c && index < list->item_count; c++)
    index = *c >= '0' && *c <= '9' ? 10 * index + (size_t)(*c - '0') : SIZE_MAX;
  return index < list->item_count ? index : SIZE_MAX;
}

const scree_yaml *scree_yaml_at(const scree_yaml *root, const char *keys) {
  while (root && *keys) {
    char name[LONGEST_KEY];
    size_t length = strcspn(keys, "."), index;
    snprintf(name, sizeof name, "%.*s", (int)length, keys);
    if (length >= sizeof name || root->kind == SCREE_YAML_SCALAR) return NULL;
    if (root->kind == SCREE_YAML_MAPPING)
      root = scree_yaml_find(root, name);
    else
      root = (index = item_of(root, name)) != SIZE_MAX ? &root->items[index] : NULL;
    keys += length + (keys[length] == '.');
  }
  return root;
}

/* The item that a key or a number names in a node; one that a mapping lacks is made. */
static scree_status step_into(scree_yaml **node, const char *key, size_t length, const char *keys,
                              scree_error *error) {
  scree_yaml *at = *node;
  char name[LONGEST_KEY];
  if (length == 0 || length >= sizeof name)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: names no field", keys);
  snprintf(name, sizeof name, "%.*s", (int)length, key);
  if (at->kind == SCREE_YAML_SCALAR)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: there is nothing named '%s' in one value",
                      keys, name);
  if (at->kind == SCREE_YAML_SEQUENCE) {
    size_t index = item_of(at, name);
    if (index == SIZE_MAX)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "%s: '%s': a list of %zu is counted from 0 to %zu", keys, name,
                        at->item_count, at->item_count ? at->item_count - 1 : 0);
    *node = &at->items[index];
    return SCREE_OK;
  }
  for (size_t i = 0; i < at->item_count; i++)
    if (!strcmp(at->items[i].key, name)) {
      *node = &at->items[i];
      return SCREE_OK;
    }
  char *copy = scree_strdup(name);
  scree_yaml *items = scree_resize(at->items, at->item_count + 1, sizeof *items);
  if (items) at->items = items;
  if (!copy || !items) {
    scree_free(copy);
    return scree_fail_memory(error, (at->item_count + 1) * sizeof *items, keys);
  }
  *node = &items[at->item_count++];
  **node = (scree_yaml){.kind = SCREE_YAML_MAPPING, .key = copy};
  return SCREE_OK;
}

scree_status scree_yaml_set(scree_yaml *root, const char *keys, const char *value,
                            scree_error *error) {
  scree_yaml made, *node = root;
  scree_status status = scree_yaml_parse(value, strlen(value), keys, &made, error);
  if (status != SCREE_OK) return status;
  forget_places(&made);
  for (const char *key = keys; status == SCREE_OK; key++) {
    size_t length = strcspn(key, ".");
    status = step_into(&node, key, length, keys, error);
    key += length;
    if (!*key) break;
  }
  if (status != SCREE_OK) {
    scree_yaml_free(&made);
    return status;
  }
  made.key = node->key;
  node->key = NULL;
  scree_yaml_free(node);
  *node = made;
  return SCREE_OK;
}

/* ---- merging ---- */

static void take_node(scree_yaml *to, scree_yaml *from) {
  scree_yaml_free(to);
  *to = *from;
  *from = (scree_yaml){.kind = SCREE_YAML_SCALAR};
}

/* What was moved leaves an empty scalar behind. */
static scree_status merge(scree_yaml *root, scree_yaml *over, scree_error *error) {
  if (root->kind != SCREE_YAML_MAPPING || over->kind != SCREE_YAML_MAPPING) {
    take_node(root, over);
    return SCREE_OK;
  }
  for (size_t i = 0; i < over->item_count; i++) {
    scree_yaml *node = root;
    const char *key = over->items[i].key;
    SCREE_TRY(step_into(&node, key, strlen(key), key, error));
    SCREE_TRY(merge(node, &over->items[i], error));
  }
  return SCREE_OK;
}

scree_status scree_yaml_merge(scree_yaml *root, scree_yaml *over, scree_error *error) {
  scree_status status = merge(root, over, error);
  scree_yaml_free(over);
  return status;
}
