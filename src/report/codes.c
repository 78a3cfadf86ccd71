/* A particle as the input of another code: about its centre of mass, along its principal axes, with
 * its mass and inertia, and scripts that let it fall alone and in a heap. What a code reads is text
 * with marks, a file of codes/ for each code and kind of particle:
 *
 *   @file NAME          the lines up to the next go into this file; @glb NAME: as a binary glTF's
 *                       JSON, with the mesh behind it
 *   @each LIST ... @end the lines between for each item of a list (lists[] below)
 *   @let NAME SUM       a number of its own
 *   {{SUM}}             a number: names, numbers, + - * / ( ) and the functions of call(); or one
 *                       of the texts of text_of()
 */
#include "report/codes.h"

#include "base/codec.h"
#include "base/file.h"
#include "base/path.h"
#include "base/quote.h"
#include "base/vec.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Of the scripts, to be edited there. */
static const double poisson = 0.3, friction = 0.5, gravity = 9.81;

enum { FIELDS = 8, DEEPEST = 3, OWN = 16 };

typedef struct code_job {
  const scree_particle *particle;
  const scree_mesh *mesh;
  const scree_code_write_options *options;
  scree_particle_measures m;
  scree_convex convex;
  double young, least, side; /* Pa; the least radius, or the mesh's size over two, m; bodies */
  scree_measures box;        /* of the mesh */
  double cubes;              /* of the spheres' radii */
  char name[128];            /* letters, digits, points, - and _ */
  scree_codec text;          /* of the file that is being written */
  char path[SCREE_PATH_BYTES];
  bool binary;
  /* The items that the loops stand at, the outermost first. */
  struct {
    int list;
    size_t index;
    double values[FIELDS];
  } at[DEEPEST];
  int depth;
  struct {
    char name[16];
    double value;
  } own[OWN]; /* of the template */
  int own_count;
  scree_error *error;
} code_job;

static scree_sphere sphere_of(const code_job *j, size_t index) {
  scree_sphere s;
  scree_particle_point(j->particle, index, s.centre, &s.radius);
  return s;
}

/* So that a sphere of the body's volume that falls from the script's height presses itself a tenth
 * of its radius into the floor (Hertz: overlap = (15 m v2 / (16 E* sqrt(r)))^(2/5)): softer bodies
 * of any size would fall through it, and stiffer ones take more steps. */
static double softened_modulus(const code_job *j) {
  double height = 4 * j->m.bounding_radius * (2 + j->side);
  const double share = 0.1, speed2 = 2 * gravity * height;
  double plane = 15. / 16 * (4. / 3 * pi) * j->options->density * speed2 / pow(share, 2.5);
  return fmax(1e6, plane * (1 - poisson * poisson));
}

/* The share of a sphere's surface that lies in no other, by points on a spiral. */
static double exposed_share(const code_job *j, size_t index) {
  enum { POINTS = 1000 };
  size_t exposed = 0;
  scree_sphere own = sphere_of(j, index);
  for (int k = 0; k < POINTS; k++) {
    double z = 1 - (2 * k + 1.) / POINTS, ring = sqrt(1 - z * z), turn = 2.399963229728653 * k;
    vec3 p =
        vec3_mad(vec3_load(own.centre), (vec3){ring * cos(turn), ring * sin(turn), z}, own.radius);
    bool covered = false;
    for (size_t i = 0; i < j->m.point_count && !covered; i++) {
      scree_sphere other = sphere_of(j, i);
      vec3 d = vec3_sub(p, vec3_load(other.centre));
      covered = i != index && vec3_dot(d, d) < other.radius * other.radius;
    }
    exposed += !covered;
  }
  return (double)exposed / POINTS;
}

/* ---- Lists ---- */

enum { SPHERES, EXPOSED, VERTICES, FACES, EDGES, PIECES, CORNERS, BODIES, LISTS };
static const struct {
  const char *name, *fields[FIELDS];
} lists[] = {
    {"spheres", {"x", "y", "z", "radius"}},
    {"exposed", {"x", "y", "z", "radius", "share"}},
    {"vertices", {"x", "y", "z"}},
    {"faces", {"a", "b", "c"}},
    {"edges", {"a", "b"}},
    {"pieces", {"piece"}},
    {"corners", {"x", "y", "z"}}, /* of a piece */
    {"bodies", {"x", "y", "z", "qw", "qx", "qy", "qz"}},
};

static size_t length_of(const code_job *j, int list) {
  if (list == VERTICES) return j->mesh->vertex_count;
  if (list == FACES) return j->mesh->triangle_count;
  if (list == EDGES) return 3 * j->mesh->triangle_count / 2;
  if (list == PIECES) return j->convex.piece_count;
  if (list == CORNERS) return j->convex.pieces[j->at[0].index].vertex_count;
  if (list == BODIES) return j->options->count;
  return j->m.kind == SCREE_PARTICLE_MESH ? 0 : j->m.point_count;
}

/* Of the heap: in a cubic grid above the floor, turned by as many radians about one axis as its
 * index. */
static void load_body(const code_job *j, size_t index, double *v) {
  size_t side = (size_t)j->side, cell[3] = {index % side, index / side % side, index / side / side};
  double step = 2.2 * j->m.bounding_radius, turn = sin((double)index / 2) / sqrt(14);
  for (int k = 0; k < 3; k++) {
    v[k] = step * (k < 2 ? (double)cell[k] - (j->side - 1) / 2 : (double)cell[k] + 1);
    v[4 + k] = (k + 1) * turn;
  }
  v[3] = cos((double)index / 2);
}

/* False where the list has none there: edges are looked for at all corners of faces. */
static bool load_item(const code_job *j, int list, size_t index, double *v) {
  const scree_mesh *mesh = list == CORNERS ? &j->convex.pieces[j->at[0].index] : j->mesh;
  const bool of_mesh = list == VERTICES || list == CORNERS || list == FACES || list == EDGES;
  if (of_mesh && !mesh) return false;
  const uint32_t *corner = of_mesh ? mesh->triangles + (list == FACES ? 3 * index : 0) : NULL;
  if (list == BODIES)
    load_body(j, index, v);
  else if (list == VERTICES || list == CORNERS)
    memcpy(v, mesh->positions + 3 * index, 3 * sizeof *v);
  else if (list == FACES)
    for (int k = 0; k < 3; k++) v[k] = corner[k];
  else if (list == EDGES)
    v[0] = corner[index], v[1] = corner[index % 3 == 2 ? index - 2 : index + 1];
  else if (list == PIECES)
    v[0] = (double)index;
  else if (list == SPHERES || list == EXPOSED)
    scree_particle_point(j->particle, index, v, &v[3]);
  if (list == EXPOSED) v[4] = exposed_share(j, index);
  return list != EDGES || v[0] < v[1];
}

/* ---- Sums ---- */

/* A name of the job; false where there is none. */
static bool value_of(const code_job *j, const char *name, double *value) {
  const struct {
    const char *name;
    double value;
  } values[] = {
      {"mass", j->options->density * j->m.volume},
      {"inertia_x", j->options->density * j->m.inertia[0]},
      {"inertia_y", j->options->density * j->m.inertia[1]},
      {"inertia_z", j->options->density * j->m.inertia[2]},
      {"volume", j->m.volume},
      {"density", j->options->density},
      {"count", (double)j->options->count},
      {"side", j->side},
      {"reach", j->m.bounding_radius},
      {"rounding", j->m.rounding},
      {"least", j->least},
      {"young", j->young},
      {"poisson", poisson},
      {"friction", friction},
      {"gravity", gravity},
      {"pi", pi},
      {"cubes", j->cubes},
      {"low_x", j->box.box_min[0]},
      {"low_y", j->box.box_min[1]},
      {"low_z", j->box.box_min[2]},
      {"high_x", j->box.box_max[0]},
      {"high_y", j->box.box_max[1]},
      {"high_z", j->box.box_max[2]},
      {"volume_error", j->convex.volume_error},
      {"inertia_error", j->convex.inertia_error},
  };
  for (int d = j->depth; d-- > 0;) {
    if (!strcmp(name, "i") && d == j->depth - 1) return *value = (double)j->at[d].index, true;
    for (int f = 0; f < FIELDS && lists[j->at[d].list].fields[f]; f++)
      if (!strcmp(name, lists[j->at[d].list].fields[f])) return *value = j->at[d].values[f], true;
  }
  for (int k = 0; k < j->own_count; k++)
    if (!strcmp(name, j->own[k].name)) return *value = j->own[k].value, true;
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    if (!strcmp(name, values[k].name)) return *value = values[k].value, true;
  for (int l = 0; l < LISTS; l++) /* its length */
    if (!strcmp(name, lists[l].name)) return *value = (double)length_of(j, l), true;
  return false;
}

static double call(const char *name, double x) {
  if (!strcmp(name, "sqrt")) return sqrt(x);
  if (!strcmp(name, "cbrt")) return cbrt(x);
  if (!strcmp(name, "ceil")) return ceil(x);
  if (!strcmp(name, "single")) return (double)(float)x;
  if (!strcmp(name, "brief")) { /* for people */
    char digits[32];
    snprintf(digits, sizeof digits, "%.3g", x);
    return strtod(digits, NULL);
  }
  return NAN;
}

static double sum(const code_job *j, const char **s, int level);

/* The templates are ours: what is no sum is NaN, and a test looks for it. */
static double factor(const code_job *j, const char **s) {
  char word[32] = "";
  size_t length = 0;
  double value = NAN;
  while (**s == ' ') ++*s;
  if (**s == '-') return ++*s, -factor(j, s);
  if (isdigit((unsigned char)**s)) {
    char *end;
    value = strtod(*s, &end);
    return *s = end, value;
  }
  while ((isalpha((unsigned char)**s) || **s == '_') && length + 1 < sizeof word)
    word[length++] = *(*s)++;
  if (**s != '(') return value_of(j, word, &value) ? value : NAN;
  ++*s;
  value = sum(j, s, 0);
  *s += **s == ')';
  return length ? call(word, value) : value;
}

/* Level 0: of products; 1: a product, of factors. */
static double sum(const code_job *j, const char **s, int level) {
  static const char operators[2][3] = {"+-", "*/"};
  if (level == 2) return factor(j, s);
  double value = sum(j, s, level + 1);
  for (;;) {
    while (**s == ' ') ++*s;
    char c = **s;
    if (!c || !strchr(operators[level], c)) return value;
    ++*s;
    double next = sum(j, s, level + 1);
    value = c == '+'   ? value + next
            : c == '-' ? value - next
            : c == '*' ? value * next
                       : value / next;
  }
}

/* Of "name}}": one of the texts; NULL: it is a sum. */
static const char *text_of(const code_job *j, const char *name) {
  if (!strncmp(name, "name}", 5)) return j->name;
  if (!strncmp(name, "version}", 8)) return scree_version();
  if (strncmp(name, "modulus}", 8) != 0) return NULL;
  return j->options->young > 0 ? "as asked for"
                               : "softened, so that the fall presses a tenth of a radius";
}

/* ---- Text ---- */

static void put(code_job *j, const char *bytes, size_t count) {
  scree_code_bytes(&j->text, (void *)(uintptr_t)bytes, count);
}

/* With what stands in {{ }}. */
static void put_line(code_job *j, const char *line, const char *end) {
  while (line < end) {
    const char *open = line;
    while (open < end && !(open[0] == '{' && open[1] == '{')) open++;
    put(j, line, (size_t)(open - line));
    if (open == end) return;
    open += 2;
    const char *close = strstr(open, "}}"), *text = text_of(j, open);
    char number[32];
    if (!text) {
      snprintf(number, sizeof number, "%.12g", sum(j, &open, 0) + 0.0);
      text = number;
    }
    put(j, text, strlen(text));
    line = close + 2;
  }
}

static void put_word(scree_codec *out, size_t value) {
  uint32_t word = (uint32_t)value;
  scree_code_u32(out, &word);
}

/* A binary glTF's text is padded, and behind it come vertices and triangles. glTF's y is up. */
static void put_binary(code_job *j) {
  scree_codec *out = &j->text, json = j->text;
  size_t words = 3 * (j->mesh->vertex_count + j->mesh->triangle_count), pad = 3 & -json.count;
  const size_t head[] = {0x46546c67 /* "glTF" */, 2, 28 + json.count + pad + 4 * words,
                         json.count + pad, 0x4e4f534a /* "JSON" */};
  const size_t behind[] = {4 * words, 0x004e4942 /* "BIN" */};
  *out = (scree_codec){.out_of_memory = json.out_of_memory};
  for (int k = 0; k < 5; k++) put_word(out, head[k]);
  scree_code_bytes(out, json.bytes, json.count);
  put(j, "   ", pad);
  for (int k = 0; k < 2; k++) put_word(out, behind[k]);
  for (size_t v = 0; v < j->mesh->vertex_count; v++) {
    const double *p = j->mesh->positions + 3 * v;
    float turned[] = {(float)p[0], (float)p[2], (float)-p[1]};
    for (int k = 0; k < 3; k++) {
      uint32_t bits;
      memcpy(&bits, &turned[k], 4);
      put_word(out, bits);
    }
  }
  for (size_t c = 0; c < 3 * j->mesh->triangle_count; c++) put_word(out, j->mesh->triangles[c]);
  scree_codec_free(&json);
}

static scree_status write_file(code_job *j) {
  scree_output output;
  if (!*j->path) return SCREE_OK;
  if (j->binary) put_binary(j);
  if (!scree_codec_good(&j->text)) return scree_fail_memory(j->error, j->text.count, "a file");
  SCREE_TRY(scree_output_open(j->path, j->options->overwrite, &output, j->error));
  fwrite(j->text.bytes, 1, j->text.count, output.stream);
  j->text.count = 0;
  return scree_output_commit(&output, j->error);
}

static bool begins(const char *line, const char *word) {
  return !strncmp(line, word, strlen(word));
}
static const char *next_line(const char *line) {
  const char *end = strchr(line, '\n');
  return end ? end + 1 : line + strlen(line);
}

static scree_status put_lines(code_job *j, const char *line, const char *end, const char *folder);

/* The file before is whole. */
static scree_status begin_file(code_job *j, const char *line, const char *folder) {
  SCREE_TRY(write_file(j));
  j->binary = line[1] == 'g';
  put_line(j, strchr(line, ' ') + 1, next_line(line) - 1);
  int length = snprintf(j->path, sizeof j->path, "%s/%.*s", folder, (int)j->text.count,
                        (const char *)j->text.bytes);
  j->text.count = 0;
  if (length < (int)sizeof j->path) return SCREE_OK;
  return scree_fail(j->error, SCREE_LIMIT, "%.200s: the path is too long", folder);
}

/* The lines between for each item; *line: behind the loop. */
static scree_status put_each(code_job *j, const char **line, const char *folder) {
  const char *name = *line + strlen("@each "), *body = next_line(*line), *end = body;
  for (int deep = 0; deep > 0 || !begins(end, "@end"); end = next_line(end))
    deep += begins(end, "@each ") - begins(end, "@end");
  *line = next_line(end);
  int d = j->depth++, list = 0;
  while (!begins(name, lists[list].name)) list++;
  size_t count = length_of(j, list);
  j->at[d].list = list;
  for (size_t i = 0; i < (list == EDGES ? 2 * count : count); i++) {
    j->at[d].index = i;
    if (load_item(j, list, i, j->at[d].values)) SCREE_TRY(put_lines(j, body, end, folder));
  }
  j->depth--;
  return SCREE_OK;
}

static void let(code_job *j, const char *line) {
  int length = 0, k = j->own_count < OWN ? j->own_count++ : OWN - 1;
  sscanf(line, "@let %15s%n", j->own[k].name, &length);
  line += length;
  j->own[k].value = sum(j, &line, 0);
}

static scree_status put_lines(code_job *j, const char *line, const char *end, const char *folder) {
  while (line < end) {
    if (begins(line, "@each ")) {
      SCREE_TRY(put_each(j, &line, folder));
      continue;
    }
    if (begins(line, "@let "))
      let(j, line);
    else if (begins(line, "@file ") || begins(line, "@glb "))
      SCREE_TRY(begin_file(j, line, folder));
    else
      put_line(j, line, next_line(line));
    line = next_line(line);
  }
  return SCREE_OK;
}

/* ---- All of them ---- */

const char *scree_code_name(size_t index) {
  return index < scree_code_template_count ? scree_code_templates[index].name : NULL;
}

size_t scree_code_find(const char *name) {
  size_t code = 0;
  while (code < scree_code_template_count && strcmp(scree_code_templates[code].name, name) != 0)
    code++;
  return code;
}

static const char *template_of(size_t code, scree_particle_kind kind) {
  const scree_code_template *t = &scree_code_templates[code];
  return kind == SCREE_PARTICLE_MESH ? t->mesh : t->clump;
}

bool scree_code_takes(size_t code, scree_particle_kind kind) {
  return code < scree_code_template_count && template_of(code, kind);
}

scree_particle_kind scree_code_kind(size_t code) {
  return scree_code_templates[code].meshes_first ? SCREE_PARTICLE_MESH : SCREE_PARTICLE_CLUMP;
}

scree_code_write_options scree_default_code_write_options(void) {
  return (scree_code_write_options){
      .name = "particle", .density = 2000, .count = 50, .convex = scree_default_convex_options()};
}

static scree_status prepare(code_job *j, const char *text, scree_code_written *result) {
  /* Other characters mean something in one of the scripts; a file of this name is in sight, and no
   * option. */
  scree_quote_text(SCREE_QUOTE_NAME, j->options->name, j->name, sizeof j->name);
  if (*j->name == '-' || *j->name == '.') *j->name = '_';
  j->side = ceil(cbrt((double)j->options->count) - 1e-9);
  j->young = j->options->young > 0 ? j->options->young : softened_modulus(j);
  j->least = INFINITY;
  for (size_t i = 0; i < length_of(j, SPHERES); i++) {
    double r = sphere_of(j, i).radius;
    j->least = fmin(j->least, r);
    j->cubes += r * r * r;
  }
  if (j->m.kind != SCREE_PARTICLE_MESH) return SCREE_OK;
  j->least = j->m.size / 2;
  SCREE_TRY(scree_mesh_measure(j->mesh, &j->box, j->error));
  if (!strstr(text, "@each pieces")) return SCREE_OK;
  const scree_convex_options *o = &j->options->convex;
  SCREE_TRY(scree_mesh_convex(j->mesh, o, j->options->progress, &j->convex, j->error));
  result->piece_count = j->convex.piece_count;
  result->volume_error = j->convex.volume_error;
  result->inertia_error = j->convex.inertia_error;
  return SCREE_OK;
}

scree_status scree_code_write(const scree_particle *particle, size_t code,
                              const scree_code_write_options *options, const char *folder,
                              scree_code_written *result, scree_error *error) {
  scree_code_write_options used = options ? *options : scree_default_code_write_options();
  code_job j = {.particle = particle, .options = &used, .error = error};
  scree_code_written made = {0};
  scree_particle_measure(particle, &j.m);
  if (code >= scree_code_template_count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "no code has the number %zu", code);
  const char *text = template_of(code, j.m.kind);
  if (!text)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: %s takes %s", used.name,
                      scree_code_name(code),
                      j.m.kind == SCREE_PARTICLE_MESH ? "clumps, no meshes" : "meshes, no clumps");
  if (!(used.density > 0) || used.count < 1)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "density %g kg/m3 and %zu particles; both must be above 0", used.density,
                      used.count);
  j.mesh = scree_particle_mesh(particle);
  scree_status status = prepare(&j, text, &made);
  if (status == SCREE_OK) status = put_lines(&j, text, text + strlen(text), folder);
  if (status == SCREE_OK) status = write_file(&j);
  scree_convex_free(&j.convex);
  scree_codec_free(&j.text);
  if (status == SCREE_OK && result) *result = made;
  return status;
}
