/* The report as one page: the fixed part, the results of the folders as one JSON text, the levels'
 * files and piles as base64 (page_parts.c), the script. It asks nothing of any network, and its
 * content security policy allows nothing but the one script and the one style sheet that it names
 * by their hashes. Texts from files are escaped where they stand: in the JSON `<` as \u003c, which
 * its strings alone can hold, so that no name ends the script element it is in; the script shows
 * texts as text only. web/ holds the page's sources; page.inc and page_script.inc are what
 * web/build.mjs makes of them.
 */
#include "base/array.h"
#include "base/file.h"
#include "base/owned.h"
#include "base/path.h"
#include "base/platform.h"
#include "base/quote.h"
#include "report/json.h"
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
                           {"study.json", "study", NULL, "angle.png"},
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

static void put_json(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (*text == '<')
      fputs("\\u003c", stream);
    else
      putc(*text, stream);
  }
}

/* ---- a folder's files ---- */

static bool has_file(const char *folder, const char *name) {
  return scree_path_exists(SCREE_PATH_IN(folder, name));
}

/* Whether the folder has that result. */
static bool is_there(const char *folder, size_t result) {
  if (result == SCENE && !has_file(folder, scene_file)) return false;
  return has_file(folder, results[result].file);
}

/* folder/name; *bytes is NULL where there is none. */
static scree_status read_part(page *p, const char *folder, const char *name, char **bytes,
                              size_t *size) {
  const char *path = SCREE_PATH_IN(folder, name);
  *bytes = NULL;
  if (!scree_path_exists(path)) return SCREE_OK;
  SCREE_TRY(scree_file_read(path, MOST_RESULT_BYTES, bytes, size, p->error));
  p->result_bytes += *size;
  return SCREE_OK;
}

/* One JSON file as a member of the page's data. *text gets its content, to be freed, or NULL where
 * there is none. */
static scree_status put_member(page *p, const char *folder, const char *name, const char *key,
                               char **text) {
  size_t size;
  SCREE_TRY(read_part(p, folder, name, text, &size));
  if (!*text) return SCREE_OK;
  SCREE_TRY(scree_json_check(*text, size, SCREE_PATH_IN(folder, name), p->error));
  fprintf(p->stream, ",\n\"%s\": ", key);
  put_json(p->stream, *text);
  return SCREE_OK;
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

static scree_status add_name(name_list *names, const char *name, scree_error *error) {
  char *copy = scree_strdup(name);
  if (copy && SCREE_PUSH(names, copy)) return SCREE_OK;
  scree_free(copy);
  return scree_fail_memory(error, strlen(name), "a name");
}

/* The names in a folder that do not begin with a point, sorted; none where there is no folder. */
static scree_status list_names(const char *folder, name_list *names, scree_error *error) {
  SCREE_CLEANUP(scree_folder_close_at) scree_folder *directory = scree_folder_open(folder);
  for (const char *name; directory && (name = scree_folder_next(directory));)
    if (name[0] != '.') SCREE_TRY(add_name(names, name, error));
  if (names->count > 1) qsort(names->items, names->count, sizeof *names->items, by_name);
  return SCREE_OK;
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
  SCREE_CLEANUP(free_names) name_list names = {0};
  SCREE_TRY(list_names(SCREE_PATH_IN(folder, "levels"), &names, p->error));
  fputs(",\n\"levels\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  for (size_t i = 0; i < names.count; i++) {
    const char *id;
    char *name = names.items[i], file[PATH_BYTES];
    if (!scree_ends_with(name, ending)) continue;
    snprintf(file, sizeof file, "levels/%s", name);
    name[strlen(name) - (sizeof ending - 1)] = 0;
    if (!*name || !holds_string(choice, name)) continue;
    SCREE_TRY(scree_page_part_add(&p->parts, SCREE_PART_LEVELS, folder, file, &id, p->error));
    if (id) put_row(&json, name, id);
  }
  scree_json_end(&json);
  return SCREE_OK;
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
  SCREE_TRY(scree_page_part_add(&p->parts, SCREE_PART_PILE, folder, file, &id, p->error));
  if (id) put_row(json, name, id);
  return SCREE_OK;
}

/* Piles to look at: [run, id] of a study's points; [key, id] of a scene. */
static scree_status put_piles(page *p, const char *folder, char *const *found) {
  const char *study = found[STUDY];
  char key[64], run[PATH_BYTES];
  fputs(",\n\"piles\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  while (study && (study = next_pile(study, key))) {
    snprintf(run, sizeof run, "%.4000s/runs/%s", folder, key);
    SCREE_TRY(put_pile(p, run, "last.scree", key, &json));
  }
  if (found[SCENE]) SCREE_TRY(put_pile(p, folder, "checkpoint.scree", results[SCENE].key, &json));
  scree_json_end(&json);
  return SCREE_OK;
}

static scree_status put_picture(page *p, const char *folder, int result) {
  const char *id;
  SCREE_TRY(scree_page_part_add(&p->parts, SCREE_PART_PICTURE, folder, results[result].picture, &id,
                                p->error));
  if (id) fprintf(p->stream, ",\n\"%s_picture\": \"%s\"", results[result].key, id);
  return SCREE_OK;
}

/* ---- the page ---- */

/* Texts of the results, and of the provenance behind them. */
typedef struct folder_texts {
  char *found[RESULT_COUNT + 1];
} folder_texts;

static void free_texts(folder_texts *texts) {
  for (size_t i = 0; i <= RESULT_COUNT; i++) scree_free(texts->found[i]);
}

static scree_status put_folder(page *p, const char *folder) {
  SCREE_CLEANUP(free_texts) folder_texts texts = {.found = {NULL}};
  char **found = texts.found;
  fputs("{\n\"folder\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, p->name ? p->name : folder);
  for (size_t i = 0; i < RESULT_COUNT; i++)
    if (is_there(folder, i))
      SCREE_TRY(put_member(p, folder, results[i].file, results[i].key, &found[i]));
  SCREE_TRY(put_member(p, folder, "provenance.json", "provenance", &found[RESULT_COUNT]));
  if (found[CHOICE]) SCREE_TRY(put_levels(p, folder, found[CHOICE]));
  if (found[STUDY] || found[SCENE]) SCREE_TRY(put_piles(p, folder, found));
  for (int i = 0; i < RESULT_COUNT; i++)
    if (found[i] && results[i].picture) SCREE_TRY(put_picture(p, folder, i));
  fputs("}", p->stream);
  return SCREE_OK;
}

static bool has_results(const char *folder) {
  for (size_t i = 0; i < RESULT_COUNT; i++)
    if (is_there(folder, i)) return true;
  return false;
}

/* The folder itself, or those in it that have results: heaps at several levels. */
static scree_status find_results(const char *folder, name_list *found, scree_error *error) {
  scree_path_info info;
  SCREE_CLEANUP(free_names) name_list names = {0};
  size_t before = found->count;
  if (!scree_path_look(folder, &info) || info.kind != SCREE_PATH_FOLDER)
    return scree_fail(error, SCREE_IO,
                      "%s: is no folder: a report is of what `-o DIR` of choose, clump, drop, "
                      "repose, run or study wrote",
                      folder);
  if (has_results(folder)) return add_name(found, folder, error);
  SCREE_TRY(list_names(folder, &names, error));
  for (size_t i = 0; i < names.count; i++) {
    const char *path = SCREE_PATH_IN(folder, names.items[i]);
    if (has_results(path)) SCREE_TRY(add_name(found, path, error));
  }
  if (found->count > before) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_FILE,
                    "%s: holds no results: no choice.json (scree choose), result.json with "
                    "scene.yaml (run, repose, drop), study.json, clump.json or calibration.json",
                    folder);
}

/* The value of the first member of that name, without its escapes; "" where there is none. */
static void find_text(const char *json, const char *name, char *to, size_t size) {
  char key[32];
  size_t used = 0;
  snprintf(key, sizeof key, "\"%s\": \"", name);
  const char *at = json ? strstr(json, key) : NULL;
  if (at) at += strlen(key);
  for (; at && *at && *at != '"' && used + 1 < size; at++) {
    if (*at == '\\') at++;
    to[used++] = *at;
  }
  to[used] = 0;
}

/* The answer, before all else. */
static scree_status put_answer(page *p, const char *folder, size_t result) {
  static const char *const names[] = {"state", "sentence", "but", "next"};
  SCREE_CLEANUP(scree_free_at) char *json = NULL;
  size_t size;
  char text[1100];
  SCREE_TRY(read_part(p, folder, results[result].file, &json, &size));
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    find_text(json, names[k], text, sizeof text);
    scree_quote(p->stream, SCREE_QUOTE_HTML, text);
    if (*text) putc('\n', p->stream);
  }
  return SCREE_OK;
}

/* What a reader without JavaScript sees. */
static scree_status put_summaries(page *p, const name_list *folders) {
  for (size_t i = 0; i < RESULT_COUNT * folders->count; i++) {
    const char *name = results[i % RESULT_COUNT].text, *folder = folders->items[i / RESULT_COUNT];
    SCREE_CLEANUP(scree_free_at) char *text = NULL;
    size_t size;
    if (!is_there(folder, i % RESULT_COUNT)) continue;
    SCREE_TRY(put_answer(p, folder, i % RESULT_COUNT));
    if (!name) continue;
    SCREE_TRY(read_part(p, folder, name, &text, &size));
    if (text) scree_quote(p->stream, SCREE_QUOTE_HTML, text);
  }
  return SCREE_OK;
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

static void free_page(page *p) {
  scree_page_parts_free(&p->parts);
}

static scree_status write_page(const char *const *folders, size_t folder_count, const char *name,
                               const char *path, bool overwrite, scree_error *error) {
  SCREE_CLEANUP(free_page) page p = {.name = name, .error = error};
  SCREE_CLEANUP(free_names) name_list found = {0};
  scree_output output;
  for (size_t i = 0; i < folder_count; i++) SCREE_TRY(find_results(folders[i], &found, error));
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  p.stream = output.stream;
  scree_status status = put_page(&p, &found);
  if (status == SCREE_OK) return scree_output_commit(&output, error);
  scree_output_discard(&output);
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
