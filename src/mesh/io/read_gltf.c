/* glTF 2.0 (ISO/IEC 12113), text and binary. cgltf reads the JSON; the walk over nodes and every
 * access to buffers is here, checked against their lengths, in double precision.
 *
 * What a file requires is refused by name unless it changes no shape (materials, textures, lights)
 * or is read: KHR_mesh_quantization. Data lie in the file, in its text, or in files beside it. Of
 * primitives triangles, strips and fans are taken; skins and weights of morph targets are not
 * applied and told, animations not applied; hidden nodes are left out and told. The unit is the
 * metre. */
#include "base/array.h"
#include "mesh/io/placed.h"
#include "mesh/io/vendor/cgltf.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { MOST_DEPTH = 256 };

/* cgltf's blocks in a ring: what it forgets is freed with the others, and whether memory was out is
 * known, which not all its answers tell. */
typedef struct links {
  struct links *next, *previous;
} links;

typedef struct block {
  links links;
  _Alignas(64) unsigned char bytes[];
} block;

typedef struct pool {
  links ring;
  bool is_out;
} pool;

static void *give(void *context, size_t size) {
  pool *p = context;
  block *b = size <= SIZE_MAX - sizeof *b ? scree_alloc(sizeof *b + size, 1) : NULL;
  if (!b) {
    p->is_out = true;
    return NULL;
  }
  b->links = (links){p->ring.next, &p->ring};
  b->links.next->previous = p->ring.next = &b->links;
  return b->bytes;
}

static void drop(links *l) {
  l->next->previous = l->previous;
  l->previous->next = l->next;
  scree_free(l); /* the block begins with it */
}

static void take_back(void *context, void *bytes) {
  (void)context;
  if (bytes) drop((links *)(void *)((unsigned char *)bytes - offsetof(block, bytes)));
}

static void empty(pool *p) {
  while (p->ring.next != &p->ring) drop(p->ring.next);
}

typedef struct model {
  scree_reading *r;
  cgltf_options options;
  pool pool;
  cgltf_data *data;
  scree_placed placed;
  struct {
    double *items;
    size_t count, capacity;
  } vertices;                      /* of one primitive */
  size_t hidden, morphed, skinned; /* nodes */
} model;

static scree_status fail(model *m, scree_status status, const char *what) {
  return scree_reading_fail(m->r, status, "as %s: %s", m->r->scan->format, what);
}

/* ---- Extensions ---- */

static bool is_harmless(const char *extension) {
  static const char *const beginnings[] = {
      "KHR_node_visibility", "KHR_materials_", "KHR_texture_", "EXT_texture_",
      "MSFT_texture_",       "KHR_lights_",    "KHR_xmp",      "KHR_mesh_quantization"};
  for (size_t i = 0; i < sizeof beginnings / sizeof *beginnings; i++)
    if (!strncmp(extension, beginnings[i], strlen(beginnings[i]))) return true;
  return false;
}

static scree_status check_extensions(model *m) {
  static const char instancing[] = "EXT_mesh_gpu_instancing";
  const cgltf_data *d = m->data;
  for (size_t i = 0; i < d->extensions_required_count; i++)
    if (!is_harmless(d->extensions_required[i]))
      return scree_reading_fail(m->r, SCREE_UNSUPPORTED,
                                "as %s: the file requires the extension %.60s, which is not read; "
                                "save it without",
                                m->r->scan->format, d->extensions_required[i]);
  for (size_t i = 0; i < d->nodes_count; i++)
    if (d->nodes[i].has_mesh_gpu_instancing)
      return scree_reading_fail(m->r, SCREE_UNSUPPORTED,
                                "as %s: node %zu uses the extension %s, which is not read; save "
                                "it without",
                                m->r->scan->format, i, instancing);
  return SCREE_OK;
}

/* ---- Buffers ---- */

/* In place, what cgltf leaves to its callers; false where the text would hold a NUL. */
static bool decode(char *uri, cgltf_size (*decoder)(char *text)) {
  size_t length = decoder(uri);
  return length == strlen(uri);
}

static scree_status read_beside(model *m, cgltf_buffer *b, size_t index) {
  scree_reading *r = m->r;
  char *bytes;
  if (!r->path || !decode(b->uri, cgltf_decode_uri))
    return scree_reading_fail(
        r, SCREE_BAD_FILE, "as %s: buffer %zu lies in '%.100s'; %s", r->scan->format, index, b->uri,
        r->path ? "only files beside this one are read" : "a stream has no files beside it");
  if (r->options->max_bytes && b->size > r->options->max_bytes)
    return scree_reading_fail(r, SCREE_LIMIT, "as %s: buffer %zu has more than %zu bytes",
                              r->scan->format, index, r->options->max_bytes);
  SCREE_TRY(scree_file_read_beneath(r->path, b->uri, b->size, &bytes, r->error));
  scree_checksum sums[2] = {r->beside, scree_checksum_of(bytes, b->size)};
  r->beside = scree_checksum_of(sums, sizeof sums);
  b->data = give(&m->pool, b->size);
  b->data_free_method = cgltf_data_free_method_memory_free;
  if (b->data) memcpy(b->data, bytes, b->size);
  scree_free(bytes);
  return b->data ? SCREE_OK : scree_fail_memory(r->error, b->size, "a buffer of a glTF");
}

static scree_status decode_text(model *m, cgltf_buffer *b, size_t index) {
  static const char mark[] = ";base64,";
  const char *comma = strchr(b->uri, ','), *text = comma + 1;
  const size_t length = sizeof mark - 1;
  if (comma && (size_t)(text - b->uri) >= length && !memcmp(text - length, mark, length) &&
      b->size / 3 <= strlen(text) / 4) {
    cgltf_result result = cgltf_load_buffer_base64(&m->options, b->size, text, &b->data);
    b->data_free_method = cgltf_data_free_method_memory_free;
    if (result == cgltf_result_success) return SCREE_OK;
    if (m->pool.is_out) return scree_fail_memory(m->r->error, b->size, "a buffer of a glTF");
  }
  return scree_reading_fail(m->r, SCREE_BAD_FILE, "as %s: buffer %zu is not %zu bytes in base64",
                            m->r->scan->format, index, b->size);
}

static scree_status load_buffers(model *m) {
  cgltf_data *d = m->data;
  for (size_t i = 0; i < d->buffers_count; i++) {
    cgltf_buffer *b = &d->buffers[i];
    if (b->uri && !decode(b->uri, cgltf_decode_string))
      return fail(m, SCREE_BAD_FILE, "a buffer's place holds a NUL");
    if (i == 0 && !b->uri && d->bin) {
      if (d->bin_size < b->size)
        return scree_reading_fail(m->r, SCREE_BAD_FILE,
                                  "as %s: buffer 0 should have %zu bytes; the file has %zu of it",
                                  m->r->scan->format, b->size, d->bin_size);
      b->data = (void *)(uintptr_t)d->bin;
    } else if (b->uri && !strncmp(b->uri, "data:", 5)) {
      SCREE_TRY(decode_text(m, b, i));
    } else if (b->uri) {
      SCREE_TRY(read_beside(m, b, i));
    } /* else: what nothing that is read may need */
  }
  return SCREE_OK;
}

/* ---- Accessors ---- */

static size_t size_of_component(cgltf_component_type type) {
  switch (type) {
  case cgltf_component_type_r_8:
  case cgltf_component_type_r_8u:
    return 1;
  case cgltf_component_type_r_16:
  case cgltf_component_type_r_16u:
    return 2;
  case cgltf_component_type_r_32u:
  case cgltf_component_type_r_32f:
    return 4;
  default:
    return 0;
  }
}

/* One number of a buffer, as the type says. */
static double load_component(const unsigned char *p, cgltf_component_type type,
                             bool is_normalized) {
  uint32_t bits = p[0];
  float real;
  size_t size = size_of_component(type);
  for (size_t k = 1; k < size; k++) bits |= (uint32_t)p[k] << 8 * k;
  switch (type) {
  case cgltf_component_type_r_8:
    return is_normalized ? fmax((int8_t)bits / 127., -1) : (int8_t)bits;
  case cgltf_component_type_r_16:
    return is_normalized ? fmax((int16_t)bits / 32767., -1) : (int16_t)bits;
  case cgltf_component_type_r_8u:
    return is_normalized ? bits / 255. : bits;
  case cgltf_component_type_r_16u:
    return is_normalized ? bits / 65535. : bits;
  case cgltf_component_type_r_32f:
    memcpy(&real, &bits, sizeof real);
    return (double)real;
  default:
    return bits;
  }
}

/* Elements of one size in a view. */
typedef struct elements {
  const unsigned char *first; /* NULL: zeros */
  size_t stride;
} elements;

static bool find_elements(const cgltf_buffer_view *view, size_t offset, size_t stride, size_t size,
                          size_t count, elements *e) {
  size_t length = 0;
  if (size == 0) return false; /* no type of numbers */
  if (!view || !view->buffer || !view->buffer->data || view->offset > view->buffer->size ||
      view->size > view->buffer->size - view->offset)
    return false;
  if (count && (__builtin_mul_overflow(stride, count - 1, &length) ||
                __builtin_add_overflow(length, offset, &length) ||
                __builtin_add_overflow(length, size, &length) || length > view->size))
    return false;
  *e = (elements){(const unsigned char *)view->buffer->data + view->offset + offset, stride};
  return true;
}

static bool elements_of(const cgltf_accessor *a, size_t numbers, elements *e) {
  *e = (elements){0};
  if (!a->buffer_view) return a->is_sparse;
  return find_elements(a->buffer_view, a->offset, a->stride,
                       numbers * size_of_component(a->component_type), a->count, e);
}

/* Those that stand elsewhere than the others. */
static bool load_sparse(const cgltf_accessor *a, double *out) {
  const cgltf_accessor_sparse *s = &a->sparse;
  size_t size = size_of_component(a->component_type),
         index_size = size_of_component(s->indices_component_type);
  elements indices, values;
  if (!find_elements(s->indices_buffer_view, s->indices_byte_offset, index_size, index_size,
                     s->count, &indices) ||
      !find_elements(s->values_buffer_view, s->values_byte_offset, 3 * size, 3 * size, s->count,
                     &values))
    return false;
  for (size_t i = 0; i < s->count; i++) {
    double index = load_component(indices.first + i * index_size, s->indices_component_type, false);
    if (!(index >= 0 && index < (double)a->count)) return false;
    for (int k = 0; k < 3; k++)
      out[3 * (size_t)index + (size_t)k] = load_component(values.first + (3 * i + (size_t)k) * size,
                                                          a->component_type, a->normalized);
  }
  return true;
}

/* Positions go to m->vertices. */
static scree_status load_positions(model *m, const cgltf_accessor *a) {
  static const char bad[] =
      "positions of a mesh lie out of range of their buffer, or are no triples";
  size_t size = size_of_component(a->component_type);
  elements e;
  if (a->type != cgltf_type_vec3 || !size || a->component_type == cgltf_component_type_r_32u ||
      !elements_of(a, 3, &e) || a->count > SCREE_PLACED_MOST)
    return fail(m, SCREE_BAD_FILE, bad);
  if (!SCREE_RESERVE(&m->vertices, 3 * a->count))
    return scree_fail_memory(m->r->error, 3 * a->count * sizeof(double), "positions of a glTF");
  m->vertices.count = 3 * a->count;
  for (size_t i = 0; i < 3 * a->count; i++)
    m->vertices.items[i] = e.first ? load_component(e.first + i / 3 * e.stride + i % 3 * size,
                                                    a->component_type, a->normalized)
                                   : 0;
  if (a->is_sparse && !load_sparse(a, m->vertices.items)) return fail(m, SCREE_BAD_FILE, bad);
  return SCREE_OK;
}

/* ---- Nodes ---- */

/* The corners of triangle i among the indices of a primitive. */
static void corners_of(cgltf_primitive_type type, size_t i, size_t at[3]) {
  bool is_odd = i % 2;
  if (type == cgltf_primitive_type_triangles)
    at[0] = 3 * i, at[1] = 3 * i + 1, at[2] = 3 * i + 2;
  else if (type == cgltf_primitive_type_triangle_strip)
    at[0] = i, at[1] = i + 1 + is_odd, at[2] = i + 2 - is_odd;
  else
    at[0] = 0, at[1] = i + 1, at[2] = i + 2;
}

static scree_status place_triangles(model *m, const cgltf_primitive *p, size_t first,
                                    bool is_mirrored) {
  static const char bad[] = "indices of a mesh are out of range";
  size_t vertex_count = m->vertices.count / 3;
  size_t count = p->indices ? p->indices->count : vertex_count;
  elements e = {0};
  if (p->indices && (p->indices->is_sparse || !elements_of(p->indices, 1, &e)))
    return fail(m, SCREE_BAD_FILE, bad);
  size_t triangles = p->type == cgltf_primitive_type_triangles ? count / 3
                     : count < 3                               ? 0
                                                               : count - 2;
  for (size_t i = 0; i < triangles; i++) {
    size_t at[3];
    uint32_t corners[3];
    corners_of(p->type, i, at);
    for (int c = 0; c < 3; c++) {
      double index =
          p->indices ? load_component(e.first + at[c] * e.stride, p->indices->component_type, false)
                     : (double)at[c];
      if (!(index >= 0 && index < (double)vertex_count)) return fail(m, SCREE_BAD_FILE, bad);
      corners[c] = (uint32_t)index;
    }
    SCREE_TRY(scree_placed_add_triangle(m->r, &m->placed, first, corners, is_mirrored));
  }
  return SCREE_OK;
}

static scree_status place_primitive(model *m, const cgltf_primitive *p, const scree_affine *where) {
  const cgltf_accessor *positions = NULL;
  for (size_t i = 0; i < p->attributes_count; i++)
    if (p->attributes[i].type == cgltf_attribute_type_position) positions = p->attributes[i].data;
  if (!positions || p->type < cgltf_primitive_type_triangles) return SCREE_OK; /* no surface */
  size_t first = m->placed.positions.count / 3;
  SCREE_TRY(load_positions(m, positions));
  if (m->vertices.count)
    SCREE_TRY(scree_placed_add(m->r, &m->placed, where, m->vertices.items, m->vertices.count / 3));
  return place_triangles(m, p, first, scree_affine_mirrors(where));
}

/* cgltf's matrix of a node is in single precision. */
static scree_affine placement_of(const cgltf_node *n) {
  scree_affine p;
  double x = (double)n->rotation[0], y = (double)n->rotation[1], z = (double)n->rotation[2],
         w = (double)n->rotation[3];
  double length = sqrt(x * x + y * y + z * z + w * w);
  if (n->has_matrix) {
    for (int i = 0; i < 12; i++) p.m[i % 3][i / 3] = (double)n->matrix[i / 3 * 4 + i % 3];
    return p;
  }
  if (length > 0) x /= length, y /= length, z /= length, w /= length;
  const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) p.m[i][k] = turn[i][k] * (double)n->scale[k];
    p.m[i][3] = (double)n->translation[i];
  }
  return p;
}

/* KHR_node_visibility: a node that is not shown, with all below it. */
static bool is_hidden(const cgltf_node *n) {
  for (size_t i = 0; i < n->extensions_count; i++) {
    const cgltf_extension *e = &n->extensions[i];
    if (!e->name || !e->data || strcmp(e->name, "KHR_node_visibility") != 0) continue;
    const char *value = strstr(e->data, "\"visible\"");
    if (value) value = strchr(value, ':');
    return value && !strncmp(value + 1 + strspn(value + 1, " \t\r\n"), "false", 5);
  }
  return false;
}

/* What stands elsewhere, or is another shape, in the file's own opinion. */
static void count_unapplied(model *m, const cgltf_node *n) {
  const float *weights = n->weights ? n->weights : n->mesh->weights;
  size_t count = n->weights ? n->weights_count : n->mesh->weights_count, i = 0;
  while (i < count && weights[i] == 0) i++;
  m->morphed += i < count;
  m->skinned += n->skin != NULL;
}

static scree_status place_node(model *m, const cgltf_node *n, const scree_affine *outer,
                               int depth) {
  if (is_hidden(n)) {
    m->hidden++;
    return SCREE_OK;
  }
  scree_affine inner = placement_of(n), where = scree_affine_in(outer, &inner);
  if (depth > MOST_DEPTH)
    return scree_reading_fail(m->r, SCREE_LIMIT, "as %s: nodes lie more than %d deep in each other",
                              m->r->scan->format, MOST_DEPTH);
  if (n->mesh) count_unapplied(m, n);
  bool wanted = n->mesh && scree_placed_wants(m->r, n->name ? n->name : n->mesh->name);
  for (size_t i = 0; wanted && i < n->mesh->primitives_count; i++)
    SCREE_TRY(place_primitive(m, &n->mesh->primitives[i], &where));
  for (size_t i = 0; i < n->children_count; i++)
    SCREE_TRY(place_node(m, n->children[i], &where, depth + 1));
  return SCREE_OK;
}

/* The scene that the file shows, its first where it says none; without scenes all nodes. */
static scree_status place_scene(model *m) {
  const cgltf_data *d = m->data;
  const cgltf_scene *scene = d->scene ? d->scene : d->scenes_count ? d->scenes : NULL;
  for (size_t i = 0; scene && i < scene->nodes_count; i++)
    SCREE_TRY(place_node(m, scene->nodes[i], &scree_affine_none, 0));
  for (size_t i = 0; !scene && i < d->nodes_count; i++)
    if (!d->nodes[i].parent) SCREE_TRY(place_node(m, &d->nodes[i], &scree_affine_none, 0));
  return SCREE_OK;
}

static void tell_unapplied(const model *m) {
  const struct {
    size_t count;
    const char *what;
  } told[] = {{m->hidden, "hidden, and left out"},
              {m->morphed, "morphed in the file: its weights are not applied"},
              {m->skinned, "placed by bones: its skin is not applied"}};
  char *warning = m->r->scan->warning;
  for (size_t i = 0; i < sizeof told / sizeof *told; i++)
    if (told[i].count)
      SCREE_ADD_TEXT(m->r->scan->warning, "%s%zu node%s %s", *warning ? "; " : "", told[i].count,
                     told[i].count == 1 ? " is" : "s are", told[i].what);
}

static scree_status explain(model *m, cgltf_result result) {
  if (m->pool.is_out)
    return scree_fail_memory(m->r->error, m->r->byte_count, "the parts of a glTF");
  return fail(m, SCREE_BAD_FILE,
              result == cgltf_result_data_too_short ? "the file is cut off"
              : result == cgltf_result_invalid_json ? "its JSON is damaged"
              : result == cgltf_result_legacy_gltf  ? "it is glTF 1.0"
                                                    : "its JSON does not say what glTF must");
}

scree_status scree_read_gltf(scree_reading *r, bool is_binary) {
  model m = {.r = r};
  m.pool.ring.next = m.pool.ring.previous = &m.pool.ring;
  m.options.memory = (cgltf_memory_options){give, take_back, &m.pool};
  snprintf(r->scan->format, sizeof r->scan->format, "glTF %s", is_binary ? "binary" : "text");
  if (r->byte_count > INT_MAX) return fail(&m, SCREE_LIMIT, "longer than 2 GiB");
  cgltf_result result = cgltf_parse(&m.options, r->bytes, r->byte_count, &m.data);
  bool is_parsed = result == cgltf_result_success && m.data;
  scree_status status = is_parsed ? check_extensions(&m) : explain(&m, result);
  r->unit_m = 1;
  r->scan->states_unit = true;
  if (is_parsed && status == SCREE_OK) status = load_buffers(&m);
  if (is_parsed && status == SCREE_OK) status = place_scene(&m);
  strncat(r->scan->format, ", meter", sizeof r->scan->format - strlen(r->scan->format) - 1);
  if (status == SCREE_OK) status = scree_placed_weld(r, &m.placed);
  if (status == SCREE_OK) tell_unapplied(&m);
  scree_placed_free(&m.placed);
  scree_free(m.vertices.items);
  cgltf_free(m.data);
  empty(&m.pool);
  return status;
}
