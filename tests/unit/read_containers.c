/* 3MF and glTF: small files made here, their units and placements, and what hostile ones cost.
 * Formats that are not read are refused by name. */
#include "base/error.h"
#include "base/rng.h"
#include "mesh/io/read.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"

#include <sys/stat.h>
#include <unistd.h>

static unsigned char file[3 << 20];
static size_t file_size;

static void put(const void *bytes, size_t count) {
  assert_true(file_size + count <= sizeof file);
  memcpy(file + file_size, bytes, count);
  file_size += count;
}
static void put_text(const char *text) {
  put(text, strlen(text));
}
static void put_little(uint32_t value, size_t byte_count) {
  for (size_t i = 0; i < byte_count; i++) put(&(unsigned char){(value >> 8 * i) & 255}, 1);
}
static void set32(size_t at, uint32_t value) {
  for (size_t i = 0; i < 4; i++) file[at + i] = (value >> 8 * i) & 255;
}

/* ---- a zip of stored members ---- */

static uint32_t crc_of(const char *text) {
  uint32_t crc = UINT32_MAX;
  for (; *text; text++) {
    crc ^= (unsigned char)*text;
    for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (0xedb88320u & (0 - (crc & 1)));
  }
  return ~crc;
}

static bool wide; /* sizes stand in zip64's extra field */

static void put_member_fields(const char *name, const char *content) {
  uint32_t size = wide ? UINT32_MAX : (uint32_t)strlen(content);
  put_little(20, 2), put_little(0, 2), put_little(0, 2), put_little(0, 2), put_little(33, 2);
  put_little(crc_of(content), 4), put_little(size, 4), put_little(size, 4);
  put_little((uint32_t)strlen(name), 2), put_little(wide ? 20 : 0, 2);
}

static void put_name(const char *name, const char *content) {
  uint32_t size = (uint32_t)strlen(content);
  put_text(name);
  if (wide)
    put_little(1, 2), put_little(16, 2), put_little(size, 4), put_little(0, 4), put_little(size, 4),
        put_little(0, 4);
}

/* zip64's end record and where it lies; what it says is not in the other one. */
static void put_wide_end(uint32_t count, uint32_t length, uint32_t directory) {
  uint32_t at = (uint32_t)file_size;
  put_text("PK\6\6"), put_little(44, 4), put_little(0, 4), put_little(45, 2), put_little(45, 2);
  put_little(0, 4), put_little(0, 4), put_little(count, 4), put_little(0, 4);
  put_little(count, 4), put_little(0, 4), put_little(length, 4), put_little(0, 4);
  put_little(directory, 4), put_little(0, 4);
  put_text("PK\6\7"), put_little(0, 4), put_little(at, 4), put_little(0, 4), put_little(1, 4);
}

static const char *made[8][2];
static size_t made_count;

static void make_zip(const char *const (*members)[2], size_t count) {
  uint32_t starts[8];
  file_size = 0;
  made_count = count;
  for (size_t i = 0; i < count; i++) {
    made[i][0] = members[i][0], made[i][1] = members[i][1];
    starts[i] = (uint32_t)file_size;
    put_text("PK\3\4"), put_member_fields(members[i][0], members[i][1]);
    put_name(members[i][0], members[i][1]), put_text(members[i][1]);
  }
  uint32_t directory = (uint32_t)file_size;
  for (size_t i = 0; i < count; i++) {
    put_text("PK\1\2"), put_little(20, 2), put_member_fields(members[i][0], members[i][1]);
    put_little(0, 2), put_little(0, 2), put_little(0, 2), put_little(0, 4);
    put_little(starts[i], 4), put_name(members[i][0], members[i][1]);
  }
  uint32_t length = (uint32_t)file_size - directory;
  if (wide) put_wide_end((uint32_t)count, length, directory), directory = UINT32_MAX;
  put_text("PK\5\6"), put_little(0, 4), put_little((uint32_t)count, 2);
  put_little((uint32_t)count, 2), put_little(length, 4), put_little(directory, 4), put_little(0, 2);
}

/* The same archive with one more. */
static void add_member(const char *name, const char *content) {
  const char *members[8][2];
  memcpy(members, made, sizeof members);
  members[made_count][0] = name, members[made_count][1] = content;
  make_zip(members, made_count + 1);
}

/* ---- cubes ---- */

static const int cube[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
static double corner(int v, int axis) {
  return axis == 0 ? v % 4 == 1 || v % 4 == 2 : axis == 1 ? v % 4 >= 2 : v >= 4;
}

static const char types_part[] =
    "<?xml version=\"1.0\"?><Types "
    "xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"/>";
static const char relations_part[] =
    "<?xml version=\"1.0\"?><Relationships "
    "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
    "Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/* attributes for <model>, and what is built: object 1 is a cube; what is behind the objects. */
static void make_3mf_of(const char *attributes, const char *others, const char *build) {
  static char model[6000];
  int n = snprintf(model, sizeof model,
                   "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- <model unit=\"foot\"> -->\n"
                   "<model%s xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">"
                   "<resources><object id=\"1\" type=\"model\"><mesh><vertices>",
                   attributes);
  for (int v = 0; v < 8; v++)
    n += snprintf(model + n, sizeof model - (size_t)n, "<vertex x=\"%g\" y=\"%g\" z=\"%g\"/>",
                  corner(v, 0), corner(v, 1), corner(v, 2));
  n += snprintf(model + n, sizeof model - (size_t)n, "</vertices><triangles>");
  for (int t = 0; t < 12; t++)
    n += snprintf(model + n, sizeof model - (size_t)n, "<triangle v1=\"%d\" v2=\"%d\" v3=\"%d\"/>",
                  cube[t][0], cube[t][1], cube[t][2]);
  snprintf(model + n, sizeof model - (size_t)n,
           "</triangles></mesh></object>%s</resources><build>%s</build></model>", others, build);
  const char *const members[][2] = {{"[Content_Types].xml", types_part},
                                    {"_rels/.rels", relations_part},
                                    {"3D/3dmodel.model", model}};
  make_zip(members, 3);
}

static void make_3mf(const char *attributes, const char *build) {
  make_3mf_of(attributes, "", build);
}
static void make_composed_3mf(void) {
  make_3mf_of("", "<object id=\"2\"><components><component objectid=\"1\"/></components></object>",
              "<item objectid=\"2\"/>");
}

/* The JSON of a cube whose data has `count` indices, placed by `node`. */
static const char *gltf_json(long count, const char *node, const char *uri) {
  static char json[2000];
  snprintf(json, sizeof json,
           "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
           "\"nodes\":[{\"mesh\":0%s}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
           "\"POSITION\":0},\"indices\":1}]}],\"buffers\":[{%s\"byteLength\":168}],"
           "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":96},"
           "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72}],\"accessors\":["
           "{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\","
           "\"min\":[0,0,0],\"max\":[1,1,1]},{\"bufferView\":1,\"componentType\":5123,"
           "\"count\":%ld,\"type\":\"SCALAR\"}]}",
           node, uri, count);
  return json;
}

static void put_cube_data(void) {
  for (int v = 0; v < 8; v++)
    for (int i = 0; i < 3; i++) put(&(float){(float)corner(v, i)}, 4);
  for (int t = 0; t < 12; t++)
    for (int c = 0; c < 3; c++) put_little((uint32_t)cube[t][c], 2);
}

static void make_glb(long index_count, const char *node) {
  const char *json = gltf_json(index_count, node, "");
  size_t length = strlen(json), padding = (4 - length % 4) % 4;
  file_size = 0;
  put_text("glTF"), put_little(2, 4), put_little(0, 4);
  put_little((uint32_t)(length + padding), 4), put_text("JSON"), put_text(json);
  for (size_t i = 0; i < padding; i++) put_text(" ");
  put_little(168, 4), put("BIN\0", 4), put_cube_data();
  set32(8, (uint32_t)file_size);
}

/* A cube of 100 units with positions of the component type; `members` for their accessor. */
static void make_quantized(const char *members, int type, const char *extension) {
  char json[1200];
  int size = type == 5122 ? 2 : 1;
  int n = snprintf(
      json, sizeof json,
      "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"%s\"],\"extensionsUsed\":[\"%s\"]"
      ","
      "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
      "\"indices\":1}]}],\"buffers\":[{\"byteLength\":136}],\"bufferViews\":[{\"buffer\":0,"
      "\"byteOffset\":0,\"byteLength\":64,\"byteStride\":8},{\"buffer\":0,\"byteOffset\":64,"
      "\"byteLength\":72}],\"accessors\":[{\"bufferView\":0,\"componentType\":%d,\"count\":8,"
      "\"type\":\"VEC3\"%s},{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":"
      "\"SCALAR\"}]}",
      extension, extension, type, members);
  while (n % 4) json[n++] = ' ';
  json[n] = 0;
  file_size = 0;
  put_text("glTF"), put_little(2, 4), put_little(0, 4);
  put_little((uint32_t)n, 4), put_text("JSON"), put_text(json);
  put_little(136, 4), put("BIN\0", 4);
  for (int v = 0; v < 8; v++) {
    for (int i = 0; i < 3; i++) put_little((uint32_t)(100 * corner(v, i)), (size_t)size);
    for (int i = 3 * size; i < 8; i++) put_little(0, 1);
  }
  for (int t = 0; t < 12; t++)
    for (int c = 0; c < 3; c++) put_little((uint32_t)cube[t][c], 2);
  set32(8, (uint32_t)file_size);
}

static void make_gltf(const char *uri) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char data[168], text[400] = "\"uri\":\"data:application/octet-stream;base64,";
  file_size = 0;
  put_cube_data();
  memcpy(data, file, sizeof data);
  size_t n = strlen(text);
  for (size_t i = 0; i < sizeof data; i += 3) {
    const unsigned char *b = (const unsigned char *)data + i;
    uint32_t bits = (uint32_t)b[0] << 16 | (uint32_t)b[1] << 8 | b[2];
    for (int k = 18; k >= 0; k -= 6) text[n++] = digits[bits >> k & 63];
  }
  snprintf(text + n, sizeof text - n, "\",");
  file_size = 0;
  put_text(gltf_json(36, "", uri ? uri : text));
}

/* ---- checks ---- */

#define PRODUCTION " xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\""

static void write_in_folder(const char *name) {
  FILE *out = fopen(in_folder(name), "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(file, 1, file_size, out), file_size);
  assert_int_equal(fclose(out), 0);
}

static scree_status parse(scree_scan *scan, scree_error *error) {
  /* a unit that must not matter: the files state their own */
  scree_read_options options = {.unit_m = 17};
  *error = (scree_error){0};
  return scree_scan_parse(file, file_size, "made", &options, scan, error);
}

/* count cubes whose least corner and volume are these. */
static void expect_cubes(const char *format, size_t count, double x, double volume) {
  scree_scan scan = {0};
  scree_error error;
  scree_measures m;
  CHECK_OK(parse(&scan, &error), error);
  assert_string_equal(scan.format, format);
  assert_int_equal(scan.facet_count, 12 * count);
  assert_int_equal(scan.mesh.vertex_count, 8 * count);
  CHECK_NEAR(scan.mesh.positions[0], x, 1e-6 * fabs(x));
  CHECK_OK(scree_mesh_measure(&scan.mesh, &m, &error), error);
  CHECK_NEAR(m.volume, volume, 1e-5 * volume);
  scree_scan_free(&scan);
}

static void expect_unit(double metres) {
  scree_scan scan = {0};
  scree_error error;
  CHECK_OK(parse(&scan, &error), error);
  assert_true(scan.unit_m == metres);
  scree_scan_free(&scan);
}

static void expect_error(scree_status status, const char *part) {
  scree_scan scan = {0};
  scree_error error;
  scree_status found = parse(&scan, &error);
  if (found != status || !strstr(error.message, part) || strncmp(error.message, "made: ", 6) != 0)
    fail_msg("%s: '%s', expected '%s'", scree_status_text(found), error.message, part);
  assert_null(scan.mesh.positions);
}

static void expect_warning(const char *warning) {
  scree_scan scan = {0};
  scree_error error;
  CHECK_OK(parse(&scan, &error), error);
  assert_string_equal(scan.warning, warning);
  scree_scan_free(&scan);
}

/* Whole or cut off behind its beginning: one sentence says what it is and what converts it. */
static void refused_by_name(void **state) {
  (void)state;
  static const struct {
    const char *begin, *sentence;
    size_t count; /* of begin; 0: to its end */
  } known[] = {{"<?xml version=\"1.0\"?>\n<amf unit=\"inch\">",
                "is an AMF model, which scree does not read", 0},
               {"<?xml version=\"1.0\"?>\n<!-- <amf> -->\n<!DOCTYPE X3D>\n<X3D version=\"3.0\">",
                "`assimp export in.x3d out.ply`", 0},
               {"<COLLADA version=\"1.4.1\">",
                "is a COLLADA model, which scree does not read; convert it, for example by `assimp "
                "export in.dae out.ply`",
                0},
               {"; FBX 7.3.0 project file\n", "is an FBX model", 0},
               {"Kaydara FBX Binary  \0\x1a\0", "`assimp export in.fbx out.ply`", 23},
               {"MM\x88\x13\0\0\2\0\n\0\0\0\3\0\0\0\0\0\0\0", "is a 3DS model", 20}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    for (int padded = 0; padded < 2; padded++) {
      file_size = 0;
      put(known[i].begin, known[i].count ? known[i].count : strlen(known[i].begin));
      for (int k = 0; padded && k < 3000; k++) put(known[i].count ? "\1\0" : "x\n", 2);
      expect_error(SCREE_UNSUPPORTED, known[i].sentence);
      write_in_folder("a.model");
      scree_scan scan = {0};
      scree_error error = {0};
      assert_int_equal(scree_scan_read(in_folder("a.model"), NULL, &scan, &error),
                       SCREE_UNSUPPORTED);
      assert_non_null(strstr(error.message, known[i].sentence));
    }
}

static void reads_3mf(void **state) {
  (void)state;
  static const char item[] = "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/>";
  make_3mf("", "<item objectid=\"1\"/>");
  expect_cubes("3MF, millimeter", 1, 0, 1e-9);
  make_3mf(" unit='inch'", item);
  expect_cubes("3MF, inch", 1, 0.254, 0.0254 * 0.0254 * 0.0254);
  expect_unit(0.0254);
  make_3mf(" xml:lang = \"en\"  unit = \"micron\" ", item);
  expect_cubes("3MF, micron", 1, 1e-5, 1e-18);
  make_3mf(" unit=\"meter\"", "<item objectid=\"1\"/><item objectid=\"1\" transform=\"-1 0 0 0 1 0 "
                              "0 0 1 -10 0 0\"/>"); /* mirrored: still outward */
  expect_cubes("3MF, meter", 2, -11, 2);
  expect_unit(1);
  wide = true;
  make_3mf(" unit='inch'", item);
  expect_cubes("3MF, inch", 1, 0.254, 0.0254 * 0.0254 * 0.0254);
  wide = false;
}

/* Objects made of others, each with its place; then the same with the others in a file of their
 * own, as slicers save it. */
static void parts_of_3mf(void **state) {
  (void)state;
  static const char open_model[] =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"centimeter\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
      "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"><resources>";
  static const char corner_object[] =
      "<object id=\"1\" type=\"model\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>"
      "<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/>"
      "<vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles>"
      "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>"
      "<triangle v1=\"0\" v2=\"3\" v3=\"2\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/>"
      "</triangles></mesh></object>";
  char text[3000];
  for (int split = 0; split < 2; split++) {
    const char *path = split ? " p:path=\"/3D/Objects/one.model\"" : "";
    snprintf(text, sizeof text,
             "%s%s<object id=\"2\" type=\"model\"><components><component objectid=\"1\"%s/>"
             "<component objectid=\"1\"%s transform=\"2 0 0 0 2 0 0 0 2 5 0 0\"/></components>"
             "</object></resources><build><item objectid=\"2\" "
             "transform=\"1 0 0 0 1 0 0 0 1 0 0 7\"/></build></model>",
             open_model, split ? "" : corner_object, path, path);
    char other[3000];
    snprintf(other, sizeof other, "%s%s</resources><build/></model>", open_model, corner_object);
    const char *const members[][2] = {{"[Content_Types].xml", types_part},
                                      {"_rels/.rels", relations_part},
                                      {"3D/3dmodel.model", text},
                                      {"3D/Objects/one.model", other}};
    make_zip(members, split ? 4 : 3);
    scree_scan scan = {0};
    scree_error error;
    scree_measures m;
    CHECK_OK(parse(&scan, &error), error);
    assert_int_equal(scan.facet_count, 8);
    CHECK_OK(scree_mesh_measure(&scan.mesh, &m, &error), error);
    CHECK_NEAR(m.volume, 1.5e-6, 1e-12);
    CHECK_NEAR(m.box_min[0], 0, 1e-9);
    CHECK_NEAR(m.box_max[0], 0.07, 1e-9);
    CHECK_NEAR(m.box_min[2], 0.07, 1e-9);
    scree_scan_free(&scan);
  }
}

/* Extensions that change shapes are refused where they are required, told where they are used; the
 * others do no harm. */
static void extensions_of_3mf(void **state) {
  (void)state;
  static const struct {
    const char *uri, *refusal;
  } known[] = {
      {"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02", "'beam lattice'"},
      {"http://schemas.microsoft.com/3dmanufacturing/slice/2015/07", "'slices'"},
      {"http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07", "'boolean operations'"},
      {"http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01", "'volumetric'"},
      {"http://example.org/own", "the extension e, http://example.org/own"},
      {"http://schemas.microsoft.com/3dmanufacturing/material/2015/02", NULL},
      {"http://schemas.microsoft.com/3dmanufacturing/production/2015/06", NULL}};
  char attributes[300];
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    snprintf(attributes, sizeof attributes, " requiredextensions=\"e\" xmlns:e=\"%s\"",
             known[i].uri);
    make_3mf(attributes, "<item objectid=\"1\"/>");
    if (known[i].refusal)
      expect_error(SCREE_UNSUPPORTED, known[i].refusal);
    else
      expect_cubes("3MF, millimeter", 1, 0, 1e-9);
  }
  snprintf(attributes, sizeof attributes, " xmlns:e=\"%s\"", known[0].uri);
  make_3mf(attributes, "<item objectid=\"1\"/><e:beams/>");
  expect_warning("its beam lattice, which it can do without, is not read");
  make_3mf(" requiredextensions=\"q\"", "<item objectid=\"1\"/>");
  expect_error(SCREE_UNSUPPORTED, "requires the extension q");
}

/* Two cubes in one object, of which the second is what the slicer says. */
static void volumes_of_slicers(void **state) {
  (void)state;
  static const struct {
    const char *config, *warning;
    size_t facets;
  } known[] = {{"<volume firstid=\"0\" lastid=\"5\"/><volume firstid=\"6\" lastid=\"11\"><metadata "
                "type=\"volume\" key=\"volume_type\" value=\"NegativeVolume\"/></volume>",
                "1 negative volume is left out: what the slicer cuts away is there", 6},
               {"<volume firstid=\"0\" lastid=\"5\"/><volume firstid=\"6\" lastid=\"11\"><metadata "
                "type=\"volume\" key=\"modifier\" value=\"1\"/></volume>",
                "1 modifier or support is left out", 6},
               {"<volume firstid=\"0\" lastid=\"5\"/><volume firstid=\"6\" lastid=\"11\"><metadata "
                "type=\"volume\" key=\"volume_type\" value=\"ModelPart\"/></volume>",
                "", 12}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    char config[600];
    snprintf(config, sizeof config, "<config><object id=\"1\">%s</object></config>",
             known[i].config);
    make_3mf("", "<item objectid=\"1\"/>");
    add_member("Metadata/Slic3r_PE_model.config", config);
    scree_scan scan = {0};
    scree_error error;
    CHECK_OK(parse(&scan, &error), error);
    assert_int_equal(scan.facet_count, known[i].facets);
    assert_string_equal(scan.warning, known[i].warning);
    scree_scan_free(&scan);
  }
  /* Bambu Studio and OrcaSlicer: components are parts of their object */
  make_3mf("", "<item objectid=\"2\"/>");
  expect_error(SCREE_BAD_FILE, "object 2");
  make_composed_3mf();
  add_member(
      "Metadata/model_settings.config",
      "<config><object id=\"2\"><part id=\"1\" subtype=\"negative_part\"/></object></config>");
  expect_error(SCREE_BAD_FILE, "with no facets");
  make_composed_3mf();
  add_member("Metadata/model_settings.config",
             "<config><object id=\"2\"><part id=\"1\" subtype=\"normal_part\"/></object></config>");
  expect_cubes("3MF, millimeter", 1, 0, 1e-9);
}

static void reads_gltf(void **state) {
  (void)state;
  make_glb(36, "");
  expect_cubes("glTF binary, meter", 1, 0, 1);
  make_glb(36, ",\"scale\":[2,2,2],\"translation\":[5,0,0]");
  expect_cubes("glTF binary, meter", 1, 5, 8);
  make_gltf(NULL);
  expect_cubes("glTF text, meter", 1, 0, 1);
  make_glb(36, ",\"scale\":[-1,1,1]"); /* mirrored: still outward */
  expect_cubes("glTF binary, meter", 1, -1, 1);
  make_glb(36, ",\"rotation\":[0,0,0.7071067811865476,0.7071067811865476]"); /* x becomes y */
  expect_cubes("glTF binary, meter", 1, -1, 1);
}

/* One by one, by names and places; all, where none is asked for. */
static void parts_of_gltf(void **state) {
  (void)state;
  static const char *const names[] = {"lid", "base"};
  scree_scan scan = {0};
  scree_error error;
  make_glb(36, ",\"name\":\"lid\",\"children\":[1]},{\"mesh\":0,\"name\":\"base\",\"translation\":"
               "[3,0,0]");
  expect_cubes("glTF binary, meter", 2, 0, 2);
  for (size_t k = 0; k < 2; k++) {
    scree_read_options options = {.unit_m = 1, .part = k + 1};
    CHECK_OK(scree_scan_parse(file, file_size, "made", &options, &scan, &error), error);
    assert_int_equal(scan.part_count, 2);
    assert_string_equal(scan.part_name, names[k]);
    assert_int_equal(scan.mesh.vertex_count, 8);
    CHECK_NEAR(scan.mesh.positions[0], 3. * (double)k, 1e-6);
    scree_scan_free(&scan);
  }
}

/* Positions of 8 or 16 bits, as numbers or as shares of their range; what is required and unknown
 * is refused by name. */
static void extensions_of_gltf(void **state) {
  (void)state;
  static const struct {
    const char *members;
    int type;
    double size;
  } known[] = {{"", 5122, 100},
               {",\"normalized\":true", 5122, 100. / 32767},
               {"", 5121, 100},
               {",\"normalized\":true", 5121, 100. / 255}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    make_quantized(known[i].members, known[i].type, "KHR_mesh_quantization");
    expect_cubes("glTF binary, meter", 1, 0, known[i].size * known[i].size * known[i].size);
  }
  static const char *const others[] = {"EXT_meshopt_compression", "KHR_draco_mesh_compression",
                                       "EXT_mesh_gpu_instancing", "OWN_shape"};
  for (int i = 0; i < 4; i++) {
    make_quantized("", 5122, others[i]);
    expect_error(SCREE_UNSUPPORTED, others[i]);
  }
  make_quantized("", 5122, "KHR_materials_unlit");
  expect_cubes("glTF binary, meter", 1, 0, 1e6);
  make_glb(36,
           ",\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0}}}");
  expect_error(SCREE_UNSUPPORTED, "node 0 uses the extension EXT_mesh_gpu_instancing");
}

/* What a file says of its own shape and is not done is told; what it hides is left out. */
static void left_out_and_told(void **state) {
  (void)state;
  static const char both[] = "<item objectid=\"1\"/><item objectid=\"1\" printable=\"0\" "
                             "transform=\"1 0 0 0 1 0 0 0 1 5 0 0\"/>";
  make_3mf("", both);
  expect_cubes("3MF, millimeter", 1, 0, 1e-9);
  expect_warning("1 item not to be printed is left out");
  make_3mf("", "<item objectid=\"1\" printable=\"0\"/>"); /* all that there is */
  expect_cubes("3MF, millimeter", 1, 0, 1e-9);
  expect_warning("");
  make_3mf("", "<item objectid=\"1\" printable=\"1\"/>");
  expect_warning("");
  make_glb(36, ",\"weights\":[0,0.5]");
  expect_cubes("glTF binary, meter", 1, 0, 1);
  expect_warning("1 node is morphed in the file: its weights are not applied");
  make_glb(36, ",\"weights\":[0,0]");
  expect_warning("");
  make_glb(36, ",\"extensions\":{\"KHR_node_visibility\":{\"visible\": false}}");
  expect_error(SCREE_BAD_FILE, "with no facets");
  make_glb(36, ",\"extensions\":{\"KHR_node_visibility\":{\"visible\":true}}");
  expect_cubes("glTF binary, meter", 1, 0, 1);
  expect_warning("");
}

/* A tag is read again with each piece of it: its length is limited, and a text's is not. */
static void limits_of_3mf(void **state) {
  (void)state;
  static char model[2500000];
  for (int i = 0; i < 4; i++) {
    size_t length = i % 2 ? 2000000 : 900000;
    char *at = model + sprintf(model, i < 2 ? "<model a=\"" : "<model>");
    memset(at, 'a', length);
    sprintf(at + length, "%s", i < 2 ? "\"/>" : "</model>");
    const char *const members[][2] = {{"3D/3dmodel.model", model}};
    make_zip(members, 1);
    if (i == 1)
      expect_error(SCREE_LIMIT, "a tag of more than 1048576 bytes");
    else
      expect_error(SCREE_BAD_FILE, "with no facets");
  }
  make_3mf("", "<item objectid=\"1\"/>");
  for (size_t at = 0; at + 12 < file_size; at++)
    if (!memcmp(file + at, "PK\1\2", 4)) file[at + 10] = 12;
  expect_error(SCREE_UNSUPPORTED, "3D/3dmodel.model is compressed by a method that is not read");
}

/* Data in a file beside it: found by the file's folder, and nowhere else. */
static void gltf_beside(void **state) {
  (void)state;
  static const struct {
    const char *uri, *error;
  } known[] = {{"the data 1.bin", NULL},
               {"the%20data%201.bin", NULL},
               {"none.bin", "none.bin"},
               {"/the data 1.bin", "only files beside this one are read"},
               {"http://a/b", "only files"},
               {"short.bin", "'short.bin' should have 168 bytes, and has 100"},
               {"the\\u0020data\\u00201.bin", NULL},
               {"long.bin", NULL}};
  scree_error error;
  scree_scan scan = {0};
  char json[200], first[33], second[33];
  file_size = 0, put_cube_data();
  write_in_folder("the data 1.bin"), file_size = 100, write_in_folder("short.bin");
  file_size = 0, put_cube_data(), file_size += 5000, write_in_folder("long.bin");
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    snprintf(json, sizeof json, "\"uri\":\"%s\",", known[i].uri);
    make_gltf(json);
    write_in_folder("a.gltf");
    scree_status status = scree_scan_read(in_folder("a.gltf"), NULL, &scan, &error);
    if (known[i].error) {
      assert_int_not_equal(status, SCREE_OK);
      if (!strstr(error.message, known[i].error)) fail_msg("'%s'", error.message);
      continue;
    }
    CHECK_OK(status, error);
    assert_int_equal(scan.mesh.vertex_count, 8);
    scree_checksum_text(scan.checksum, first);
    scree_scan_free(&scan);
    expect_error(SCREE_BAD_FILE, "a stream has no files beside it");
  }
  /* the checksum is of the data, too */
  make_gltf("\"uri\":\"the%20data%201.bin\",");
  write_in_folder("a.gltf");
  file_size = 0, put_cube_data(), file[0] = 1;
  write_in_folder("the data 1.bin");
  CHECK_OK(scree_scan_read(in_folder("a.gltf"), NULL, &scan, &error), error);
  scree_checksum_text(scan.checksum, second);
  scree_scan_free(&scan);
  assert_string_not_equal(first, second);
}

/* Nothing but a regular file from the folder down, by whatever spelling, and at once. */
static void gltf_reads_nothing_else(void **state) {
  (void)state;
  static const char *const names[] = {"../secret.bin",
                                      "%2e%2e/secret.bin",
                                      "..%2Fsecret.bin",
                                      "%2E%2E%2fsecret.bin",
                                      "\\u002e\\u002e/secret.bin",
                                      "..\\/secret.bin",
                                      "./../secret.bin",
                                      "sub/../../secret.bin",
                                      "sub/..%2f..%2fsecret.bin",
                                      "%2Fdev%2Fzero",
                                      "\\/dev\\/zero",
                                      "../../../../../dev/zero",
                                      "..%5Csecret.bin",
                                      "c:%5csecret.bin",
                                      "c:secret.bin",
                                      "file:secret.bin",
                                      "good.bin%00.txt",
                                      "good.bin\\u0000",
                                      "link.bin",
                                      "inner_link.bin",
                                      "linked/good.bin",
                                      "fifo",
                                      "zero",
                                      "sub",
                                      ".",
                                      "..",
                                      "",
                                      "good.bin/",
                                      "good.bin/x",
                                      "%0agood.bin",
                                      "secret.bin"};
  char json[200];
  scree_error error;
  scree_scan scan = {0};
  scree_folder_create(in_folder("in/sub"), NULL);
  file_size = 0, put_cube_data(), write_in_folder("secret.bin");
  write_in_folder("in/good.bin"), write_in_folder("in/sub/deep.bin");
  assert_int_equal(symlink("../secret.bin", in_folder("in/link.bin")), 0);
  assert_int_equal(symlink("good.bin", in_folder("in/inner_link.bin")), 0);
  assert_int_equal(symlink(".", in_folder("in/linked")), 0);
  assert_int_equal(symlink("/dev/zero", in_folder("in/zero")), 0);
  assert_int_equal(mkfifo(in_folder("in/fifo"), 0600), 0);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    snprintf(json, sizeof json, "\"uri\":\"%s\",", names[i]);
    make_gltf(json);
    write_in_folder("in/a.gltf");
    if (scree_scan_read(in_folder("in/a.gltf"), NULL, &scan, &error) == SCREE_OK)
      fail_msg("'%s' is read", names[i]);
    if (!strstr(error.message, "only files beside this one are read") &&
        !strstr(error.message, "a buffer's place holds a NUL"))
      fail_msg("'%s': %s", names[i], error.message);
  }
  make_gltf("\"uri\":\"sub%2fdeep.bin\",");
  write_in_folder("in/a.gltf");
  CHECK_OK(scree_scan_read(in_folder("in/a.gltf"), NULL, &scan, &error), error);
  scree_scan_free(&scan);
}

static void hostile_3mf(void **state) {
  (void)state;
  make_3mf("", "<item objectid=\"1\"/>");
  size_t whole = file_size;
  for (size_t cut = 4; cut < whole; cut += 1 + whole / 20) {
    file_size = cut;
    expect_error(SCREE_BAD_FILE, "3D/3dmodel.model is not found: cut off, damaged, or no 3MF");
  }
  make_3mf(" unit=\"furlong\"", "");
  expect_error(SCREE_BAD_FILE, "the unit is 'furlong'; it should be micron");
  make_3mf("", "");
  expect_error(SCREE_BAD_FILE, "");
  make_3mf("", "<item objectid=\"7\"/>");
  expect_error(SCREE_BAD_FILE, "object 7, which is placed, is not in 3D/3dmodel.model");
  make_3mf(PRODUCTION, "<item objectid=\"7\" p:path=\"/3D/Objects/other.model\"/>");
  expect_error(SCREE_BAD_FILE, "3D/Objects/other.model is not found");
  make_3mf("", "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0\"/>");
  expect_error(SCREE_BAD_FILE, "it must be twelve numbers");
  make_3mf("", "<item objectid=\"1\" transform=\"1e308 0 0 0 1e308 0 0 0 1e308 0 0 0\"/>");
  expect_error(SCREE_BAD_FILE, "coordinates must be finite");
  make_3mf("", "<item objectid=\"1\"/>");
  file[file_size / 2] ^= 1;
  expect_error(SCREE_BAD_FILE, "3D/3dmodel.model");
  const char *const other[][2] = {{"word/document.xml", "<a/>"}};
  make_zip(other, 1);
  expect_error(SCREE_BAD_FILE, "is a zip archive with word/document.xml, and no 3MF");
  const char *const no_xml[][2] = {{"3D/3dmodel.model", "model"}};
  make_zip(no_xml, 1);
  expect_error(SCREE_BAD_FILE, "3D/3dmodel.model: line 1: syntax error");
  const char *const dtd[][2] = {
      {"3D/3dmodel.model", "<!DOCTYPE model [<!ENTITY a \"b\">]><model/>"}};
  make_zip(dtd, 1);
  expect_error(SCREE_BAD_FILE, "a DOCTYPE");
}

static void hostile_gltf(void **state) {
  (void)state;
  make_glb(4000000000, ""); /* indices that the buffer has no room for */
  expect_error(SCREE_BAD_FILE, "out of range");
  make_quantized("},{\"bufferView\":1,\"count\":1000000000000,\"type\":\"SCALAR\"", 5122,
                 "KHR_mesh_quantization");
  expect_error(SCREE_BAD_FILE, "out of range"); /* indices that are of no type */
  make_glb(36, "");
  for (size_t i = 12; i < file_size; i++) file[i] = (unsigned char)(i * 181);
  expect_error(SCREE_BAD_FILE, "glTF binary");
  make_gltf("\"uri\":\"/etc/passwd\",");
  expect_error(SCREE_BAD_FILE, "a stream has no files beside it");
  make_glb(36, "");
  set32(4, 1);
  expect_error(SCREE_UNSUPPORTED, "is glTF 1.0");
  file_size = 0;
  put_text("{\"asset\": {\"version\": \"1.0\"}, \"meshes\": {}}");
  expect_error(SCREE_UNSUPPORTED, "is glTF 1.0");
}

/* Whatever is wrong, it is a result or one sentence. */
static void damaged_anywhere(void **state) {
  (void)state;
  scree_rng rng = {3, 0, 0};
  for (int round = 0; round < 200; round++) {
    if (round % 2)
      make_3mf("", "<item objectid=\"1\"/>");
    else
      make_glb(36, "");
    for (int i = 0; i < 4; i++)
      file[4 + scree_rng_below(&rng, file_size - 4)] = (unsigned char)scree_rng_below(&rng, 256);
    scree_scan scan = {0};
    scree_error error;
    if (parse(&scan, &error) != SCREE_OK && (!error.message[0] || strchr(error.message, '\n')))
      fail_msg("'%s'", error.message);
    scree_scan_free(&scan);
  }
}

static scree_status parse_once(void *context, scree_error *error) {
  (void)context;
  scree_scan scan = {0};
  scree_status status = parse(&scan, error);
  scree_scan_free(&scan);
  return status;
}
static void allocations(void **state) {
  (void)state;
  make_composed_3mf();
  assert_true(check_allocation_failures(parse_once, NULL) > 20);
  make_gltf(NULL);
  assert_true(check_allocation_failures(parse_once, NULL) > 20);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(refused_by_name),    cmocka_unit_test(reads_3mf),
      cmocka_unit_test(parts_of_3mf),       cmocka_unit_test(extensions_of_3mf),
      cmocka_unit_test(volumes_of_slicers), cmocka_unit_test(reads_gltf),
      cmocka_unit_test(parts_of_gltf),      cmocka_unit_test(extensions_of_gltf),
      cmocka_unit_test(gltf_beside),        cmocka_unit_test(gltf_reads_nothing_else),
      cmocka_unit_test(left_out_and_told),  cmocka_unit_test(limits_of_3mf),
      cmocka_unit_test(hostile_3mf),        cmocka_unit_test(hostile_gltf),
      cmocka_unit_test(damaged_anywhere),   cmocka_unit_test(allocations)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
