/* Reading of what calls itself glTF, and of whatever stands as the model of a 3MF: the archive is
 * made here, so that its CRC-32 fits. */
#include "fuzz/reading.h"
#include "mesh/io/read.h"

enum { MOST_BYTES = 1 << 16 };
static const char name[] = "3D/3dmodel.model";
enum { NAME = sizeof name - 1, LOCAL = 30, ENTRY = 46, END = 22 };

static void put(uint8_t *out, uint32_t value, int count) {
  for (int i = 0; i < count; i++) out[i] = (value >> 8 * i) & 255;
}

static uint32_t crc_of(const uint8_t *bytes, size_t size) {
  uint32_t crc = UINT32_MAX;
  for (size_t i = 0; i < size; i++) {
    crc ^= bytes[i];
    for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (0xedb88320u & (0 - (crc & 1)));
  }
  return ~crc;
}

/* Local header and entry share the fields from the version to the name's length. */
static size_t make_archive(const uint8_t *data, size_t size, uint8_t *out) {
  uint32_t crc = crc_of(data, size), entry = (uint32_t)(LOCAL + NAME + size);
  memset(out, 0, LOCAL + NAME + size + ENTRY + NAME + END);
  static const uint8_t marks[3][4] = {{'P', 'K', 3, 4}, {'P', 'K', 1, 2}, {'P', 'K', 5, 6}};
  memcpy(out, marks[0], 4), memcpy(out + entry, marks[1], 4);
  put(out + 14, crc, 4), put(out + 18, (uint32_t)size, 4), put(out + 22, (uint32_t)size, 4);
  put(out + 26, NAME, 2);
  memcpy(out + entry + 16, out + 14, 14);
  memcpy(out + LOCAL, name, NAME), memcpy(out + LOCAL + NAME, data, size);
  memcpy(out + entry + ENTRY, name, NAME);
  uint8_t *end = out + entry + ENTRY + NAME;
  memcpy(end, marks[2], 4), put(end + 8, 1, 2), put(end + 10, 1, 2);
  put(end + 12, ENTRY + NAME, 4), put(end + 16, entry, 4);
  return entry + ENTRY + NAME + END;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static uint8_t archive[MOST_BYTES + 2 * (LOCAL + ENTRY + NAME)];
  bool is_gltf = size > 0 && (*data == '{' || *data == 'g');
  scree_scan scan = {0};
  scree_error error = {0};
  if (size > MOST_BYTES) return 0;
  if (!is_gltf) size = make_archive(data, size, archive);
  size_t used = scree_memory_used();
  scree_set_threads(1);
  scree_status status =
      scree_scan_parse(is_gltf ? data : archive, size, "fuzz", NULL, &scan, &error);
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK)
    fuzz_check_mesh(&scan.mesh);
  else
    FUZZ_CHECK(error.message[0] && !strchr(error.message, '\n'));
  scree_scan_free(&scan);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
