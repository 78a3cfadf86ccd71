/* What every reader must keep to, whatever the bytes. */
#pragma once

#include "fuzz/fuzz.h"
#include "mesh/io/read.h"
#include "scree.h"

#include <math.h>
#include <string.h>

/* Memory stays below a fixed multiple of the file's length, and below the tables' least sizes. */
#define FUZZ_BYTES_PER_BYTE ((size_t)250)
#define FUZZ_LEAST_BYTES    ((size_t)1 << 20)

static inline void fuzz_check_mesh(const scree_mesh *mesh) {
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++) FUZZ_CHECK(isfinite(mesh->positions[i]));
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
    FUZZ_CHECK(mesh->triangles[i] < mesh->vertex_count);
}

/* Parses, and checks that a result is a mesh, a refusal a sentence, that memory stays in proportion
 * and nothing leaks. */
static inline void fuzz_parse(const uint8_t *data, size_t size, double weld_tolerance) {
  scree_read_options options = scree_default_read_options();
  options.weld_tolerance = weld_tolerance;
  scree_scan scan = {0};
  scree_error error = {0};
  size_t used = scree_memory_used();
  scree_reset_memory_peak();
  scree_set_threads(1);
  scree_status status = scree_scan_parse(data, size, "fuzz", &options, &scan, &error);
  FUZZ_CHECK(scree_memory_peak() - used <= FUZZ_BYTES_PER_BYTE * size + FUZZ_LEAST_BYTES);
  fuzz_taken += status == SCREE_OK;
  if (status != SCREE_OK) {
    FUZZ_CHECK(error.status == status && status != SCREE_OUT_OF_MEMORY && error.message[0]);
    FUZZ_CHECK(!strchr(error.message, '\n'));
  } else {
    FUZZ_CHECK(scan.mesh.triangle_count > 0);
    FUZZ_CHECK(scan.facet_count >= scan.mesh.triangle_count + scan.degenerate_count ||
               weld_tolerance > 0);
    fuzz_check_mesh(&scan.mesh);
  }
  scree_scan_free(&scan);
  FUZZ_CHECK(scree_memory_used() == used);
}
