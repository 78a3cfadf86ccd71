/* The report as one page: the fixed part, the results of the folders as one JSON text, the levels'
 * files and piles as base64 (page_parts.c), the script. It asks nothing of any network, and its
 * content security policy allows nothing but the one script and the one style sheet that it names
 * by their hashes. Texts from files are escaped where they stand: in the JSON `<` as \u003c, which
 * its strings alone can hold, so that no name ends the script element it is in; the script shows
 * texts as text only. web/ holds the page's sources; page.inc and page_script.inc are what
 * web/build.mjs makes of them.
 */
#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"
#include "base/platform.h"
#include "report/json.h"
#include "report/json_check.h"
#include "report/page_parts.h"
#include "report/program.h"
#include "report/shapes.h"

#include <stdlib.h>
#include <string.h>

#include "report/page.inc"

enum {
  MOST_RESULT_BYTES = 64 << 20,
  PAGE_BYTES = 6000000, /* what mail takes; reached only where results alone have more */
  SPARE_BYTES = 20000,  /* for what stands around the parts */
  PATH_BYTES = 4096
};
static const char ending[] = ".levels";

/* What a folder may hold: the file, the page's name for it, what says it to readers without
 * JavaScript, and the picture that stands in for the 3D view (NULL: none). */
enum { CHOICE, STUDY, CLUMP, SCENE, CALIBRATION, RESULT_COUNT };
static const struct {
  const char *file, *key, *text, *picture;
} results[RESULT_COUNT] = {{"choice.json", "choice", "choice.txt", NULL},
                           {"study.json", "study", NULL, NULL},
                           {"clump.json", "clump", "clump.txt", NULL},
                           {"result.json", "scene", "result.txt", "scene.png"},
                           {"calibration.json", "calibration", "calibration.txt", "corner.png"}};
static const char scene_file[] = "scene.yaml"; /* beside a scene's result.json */

typedef struct page {
  FILE *stream;
  const char *name; /* what the one folder is called; NULL: by its path */
  scree_error *error;
  scree_page_parts parts;
  size_t result_bytes; /* of all JSON and texts */
} page;

static void put_all(FILE *stream, const char *const *texts) {
  for (; *texts; texts++) fputs(*texts, stream);
}

static size_t length_of(const char *const *texts) {
  size_t length = 0;
  for (; *texts; texts++) length += strlen(*texts);
  return length;
}

static void put_html(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (strchr("<>&\"'", *text))
      fprintf(stream, "&#%d;", *text);
    else
      putc(*text, stream);
  }
}

static void put_json(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (*text == '<')
      fputs("\\u003c", stream);
    else
      putc(*text, stream);
  }
}

/* ---- a folder's files ---- */

/* Reads folder/name, whose path is left in `path`; *bytes is NULL where there is none. */
static scree_status read_part(const char *folder, const char *name, char path[PATH_BYTES],
                              char **bytes, size_t *size, scree_error *error) {
  int length = snprintf(path, PATH_BYTES, "%s/%s", folder, name);
  if (length < 0 || length >= PATH_BYTES)
    return scree_fail(error, SCREE_LIMIT, "%.200s: the path is too long", folder);
  *bytes = NULL;
  if (!scree_path_exists(path)) return SCREE_OK;
  return scree_file_read(path, MOST_RESULT_BYTES, bytes, size, error);
}

static bool has_file(const char *folder, const char *name) {
  char path[PATH_BYTES];
  int length = snprintf(path, sizeof path, "%s/%s", folder, name);
  return length < PATH_BYTES && scree_path_exists(path);
}

/* Whether the folder has that result. */
static bool is_there(const char *folder, size_t result) {
  if (result == SCENE && !has_file(folder, scene_file)) return false;
  return has_file(folder, results[result].file);
}

/* One JSON file as a member of the page's data. *text gets its content, to be freed, or NULL where
 * there is none; text may be NULL. */
static scree_status put_member(page *p, const char *folder, const char *name, const char *key,
                               char **text) {
  char *bytes, path[PATH_BYTES];
  size_t size;
  if (text) *text = NULL;
  scree_status status = read_part(folder, name, path, &bytes, &size, p->error);
  if (status != SCREE_OK || !bytes) return status;
  p->result_bytes += size;
  status = scree_json_check(bytes, size, path, p->error);
  if (status == SCREE_OK) {
    fprintf(p->stream, ",\n\"%s\": ", key);
    put_json(p->stream, bytes);
  }
  if (text && status == SCREE_OK)
    *text = bytes;
  else
    scree_free(bytes);
  return status;
}

/* ---- parts ---- */

/* A row [name, id] of the page's data. */
static void put_row(scree_json *json, const char *name, const char *id) {
  scree_json_row_array(json, NULL);
  scree_json_text(json, NULL, name);
  scree_json_text(json, NULL, id);
  scree_json_end(json);
}

typedef struct name_list {
  char **items;
  size_t count, capacity;
} name_list;

static void free_names(name_list *names) {
  for (size_t i = 0; i < names->count; i++) scree_free(names->items[i]);
  scree_free(names->items);
}

static int by_name(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The names in a folder that do not begin with a point, sorted; none where there is no folder. */
static scree_status list_names(const char *folder, name_list *names, scree_error *error) {
  scree_folder *directory = scree_folder_open(folder);
  *names = (name_list){0};
  if (!directory) return SCREE_OK;
  scree_status status = SCREE_OK;
  for (const char *name; status == SCREE_OK && (name = scree_folder_next(directory));) {
    if (name[0] == '.') continue;
    char *copy = scree_strdup(name);
    if (!copy || !SCREE_PUSH(names, copy)) {
      scree_free(copy);
      status = scree_fail_memory(error, 256, "a name");
    }
  }
  scree_folder_close(directory);
  if (names->count > 1) qsort(names->items, names->count, sizeof *names->items, by_name);
  return status;
}

static bool is_levels(const char *name) {
  size_t length = strlen(name);
  return length >= sizeof ending && !strcmp(name + length - (sizeof ending - 1), ending);
}

/* Whether the JSON text holds the name as a string: what an earlier choice left is no part. */
static bool holds_string(const char *json, const char *name) {
  char *quoted = NULL;
  size_t size;
  FILE *stream = scree_memory_open(&quoted, &size);
  if (!stream) return false;
  scree_json writer = scree_json_start(stream);
  scree_json_text(&writer, NULL, name);
  bool held = scree_memory_close(stream) && strstr(json, quoted);
  free(quoted);
  return held;
}

/* What the page calls each file of levels: [name, id]. */
static scree_status put_levels(page *p, const char *folder, const char *choice) {
  name_list names;
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%.4000s/levels", folder);
  scree_status status = list_names(path, &names, p->error);
  fputs(",\n\"levels\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  for (size_t i = 0; i < names.count && status == SCREE_OK; i++) {
    const char *id;
    char *name = names.items[i], file[PATH_BYTES];
    if (!is_levels(name)) continue;
    snprintf(file, sizeof file, "levels/%s", name);
    name[strlen(name) - (sizeof ending - 1)] = 0;
    if (!holds_string(choice, name)) continue;
    status = scree_page_part_add(&p->parts, SCREE_PART_LEVELS, folder, file, &id, p->error);
    if (id) put_row(&json, name, id);
  }
  scree_json_end(&json);
  free_names(&names);
  return status;
}

/* The next run that a study's points name as the pile to look at; NULL: no more. */
static const char *next_pile(const char *json, char key[64]) {
  static const char name[] = "\"pile\"";
  while ((json = strstr(json, name))) {
    json += sizeof name - 1;
    const char *at = json + strspn(json, " \t\n:");
    size_t length = *at == '"' ? strspn(at + 1, "0123456789abcdef") : 0;
    if (length == 0 || length >= 64 || at[1 + length] != '"') continue;
    memcpy(key, at + 1, length);
    key[length] = 0;
    return at;
  }
  return NULL;
}

static scree_status put_pile(page *p, const char *folder, const char *file, const char *name,
                             scree_json *json) {
  const char *id;
  scree_status status =
      scree_page_part_add(&p->parts, SCREE_PART_PILE, folder, file, &id, p->error);
  if (id) put_row(json, name, id);
  return status;
}

/* Piles to look at: [run, id] of a study's points; [key, id] of a scene. */
static scree_status put_piles(page *p, const char *folder, char *const *found) {
  const char *study = found[STUDY];
  const bool scene = found[SCENE];
  char key[64], run[PATH_BYTES];
  scree_status status = SCREE_OK;
  fputs(",\n\"piles\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  while (status == SCREE_OK && study && (study = next_pile(study, key))) {
    snprintf(run, sizeof run, "%.4000s/runs/%s", folder, key);
    status = put_pile(p, run, "last.scree", key, &json);
  }
  if (status == SCREE_OK && scene)
    status = put_pile(p, folder, "checkpoint.scree", results[SCENE].key, &json);
  scree_json_end(&json);
  return status;
}

static scree_status put_picture(page *p, const char *folder, int result) {
  const char *id;
  scree_status status = scree_page_part_add(&p->parts, SCREE_PART_PICTURE, folder,
                                            results[result].picture, &id, p->error);
  if (id) fprintf(p->stream, ",\n\"%s_picture\": \"%s\"", results[result].key, id);
  return status;
}

/* ---- the page ---- */

static scree_status put_folder(page *p, const char *folder) {
  char *found[RESULT_COUNT] = {NULL};
  fputs("{\n\"folder\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, p->name ? p->name : folder);
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < RESULT_COUNT && status == SCREE_OK; i++)
    if (is_there(folder, i))
      status = put_member(p, folder, results[i].file, results[i].key, &found[i]);
  if (status == SCREE_OK) status = put_member(p, folder, "provenance.json", "provenance", NULL);
  if (status == SCREE_OK && found[CHOICE]) status = put_levels(p, folder, found[CHOICE]);
  if (status == SCREE_OK && (found[STUDY] || found[SCENE])) status = put_piles(p, folder, found);
  for (int i = SCENE; i < RESULT_COUNT && status == SCREE_OK; i++)
    if (found[i]) status = put_picture(p, folder, i);
  fputs("}", p->stream);
  for (size_t i = 0; i < RESULT_COUNT; i++) scree_free(found[i]);
  return status;
}

static bool has_results(const char *folder) {
  for (size_t i = 0; i < RESULT_COUNT; i++)
    if (is_there(folder, i)) return true;
  return false;
}

static scree_status add_name(page *p, name_list *folders, const char *path) {
  char *copy = scree_strdup(path);
  if (copy && SCREE_PUSH(folders, copy)) return SCREE_OK;
  scree_free(copy);
  return scree_fail_memory(p->error, strlen(path), "a path");
}

/* The folder itself, or those in it that have results: heaps at several levels. */
static scree_status find_results(page *p, const char *folder, name_list *found) {
  scree_path_info info;
  name_list names;
  size_t before = found->count;
  if (!scree_path_look(folder, &info) || info.kind != SCREE_PATH_FOLDER)
    return scree_fail(p->error, SCREE_IO,
                      "%s: is no folder: a report is of what `-o DIR` of choose, clump, drop, "
                      "repose, run or study wrote",
                      folder);
  if (has_results(folder)) return add_name(p, found, folder);
  scree_status status = list_names(folder, &names, p->error);
  for (size_t i = 0; i < names.count && status == SCREE_OK; i++) {
    char path[PATH_BYTES];
    int length = snprintf(path, sizeof path, "%s/%s", folder, names.items[i]);
    if (length < PATH_BYTES && has_results(path)) status = add_name(p, found, path);
  }
  free_names(&names);
  if (status == SCREE_OK && found->count == before)
    status =
        scree_fail(p->error, SCREE_BAD_FILE,
                   "%s: holds no results: no choice.json (scree choose), result.json with "
                   "scene.yaml (run, repose, drop), study.json, clump.json or calibration.json",
                   folder);
  return status;
}

/* What a reader without JavaScript sees. */
static scree_status put_summaries(page *p, const name_list *folders) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < RESULT_COUNT * folders->count && status == SCREE_OK; i++) {
    const char *name = results[i % RESULT_COUNT].text;
    char *text, path[PATH_BYTES];
    size_t size;
    if (!name || !is_there(folders->items[i / RESULT_COUNT], i % RESULT_COUNT)) continue;
    status = read_part(folders->items[i / RESULT_COUNT], name, path, &text, &size, p->error);
    if (status == SCREE_OK && text) put_html(p->stream, text), p->result_bytes += size;
    if (status == SCREE_OK) scree_free(text);
  }
  return status;
}

static void put_colors(FILE *stream) {
  fputs(",\n\"shapeColors\": [", stream);
  for (size_t i = 0; i < SCREE_SHAPE_COLORS; i++)
    fprintf(stream, "%s\"#%06x\"", i ? ", " : "", (unsigned)scree_shape_color(i));
  fputs("]", stream);
}

static scree_status put_page(page *p, const name_list *folders) {
  put_all(p->stream, page_top);
  SCREE_TRY(put_summaries(p, folders));
  put_all(p->stream, page_middle);
  fputs("<script type=\"application/json\" id=\"data\">{\"version\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, scree_version());
  put_colors(p->stream);
  fputs(",\n\"folders\": [", p->stream);
  for (size_t i = 0; i < folders->count; i++) {
    if (i > 0) fputs(",\n", p->stream);
    SCREE_TRY(put_folder(p, folders->items[i]));
  }
  fputs("]}</script>\n", p->stream);
  size_t used = length_of(page_top) + length_of(page_middle) + length_of(scree_page_script) +
                p->result_bytes + SPARE_BYTES;
  size_t room = used < PAGE_BYTES ? (PAGE_BYTES - used) / 4 * 3 : 0; /* as base64 */
  SCREE_TRY(scree_page_parts_put(&p->parts, p->stream, room, p->error));
  fputs("<script type=\"module\">", p->stream);
  put_all(p->stream, scree_page_script);
  fputs("</script>\n</body>\n</html>\n", p->stream);
  return SCREE_OK;
}

static scree_status write_page(const char *const *folders, size_t folder_count, const char *name,
                               const char *path, bool overwrite, scree_error *error) {
  page p = {.name = name, .error = error};
  name_list found = {0};
  scree_output output;
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < folder_count && status == SCREE_OK; i++)
    status = find_results(&p, folders[i], &found);
  if (status == SCREE_OK) status = scree_output_open(path, overwrite, &output, error);
  if (status == SCREE_OK) {
    p.stream = output.stream;
    status = put_page(&p, &found);
    if (status == SCREE_OK)
      status = scree_output_commit(&output, error);
    else
      scree_output_discard(&output);
  }
  scree_page_parts_free(&p.parts);
  free_names(&found);
  return status;
}

scree_status scree_page_write(const char *const *folders, size_t folder_count, const char *path,
                              bool overwrite, scree_error *error) {
  return write_page(folders, folder_count, NULL, path, overwrite, error);
}

scree_status scree_page_write_named(const char *folder, const char *name, const char *path,
                                    bool overwrite, scree_error *error) {
  return write_page(&folder, 1, name, path, overwrite, error);
}
