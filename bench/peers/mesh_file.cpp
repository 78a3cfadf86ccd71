#include "harness.hpp"

#include <cstdio>
#include <limits>
#include <scree.h>
#include <stdexcept>

namespace bench {

Mesh read_mesh(const std::string &path) {
  scree_read_options options = scree_default_read_options();
  options.unit_m = 1; // the peers see the file's own numbers
  scree_scan scan;
  scree_error error;
  if (scree_scan_read(path.c_str(), &options, &scan, &error) != SCREE_OK)
    throw std::runtime_error(error.message);
  const scree_mesh &read = scan.mesh;
  Mesh mesh;
  mesh.positions.assign(read.positions, read.positions + 3 * read.vertex_count);
  mesh.triangles.assign(read.triangles, read.triangles + 3 * read.triangle_count);
  scree_scan_free(&scan);
  return mesh;
}

void write_mesh(const Mesh &mesh, const std::string &path) {
  const uint32_t unused = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> number(mesh.vertex_count(), unused);
  std::vector<double> positions;
  for (uint32_t v : mesh.triangles)
    if (number[v] == unused) {
      number[v] = uint32_t(positions.size() / 3);
      positions.insert(positions.end(), &mesh.positions[3 * v], &mesh.positions[3 * v] + 3);
    }
  FILE *file = fopen(path.c_str(), "wb");
  if (!file) throw std::runtime_error(path + ": cannot write");
  fprintf(file,
          "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty double x\n"
          "property double y\nproperty double z\nelement face %zu\n"
          "property list uchar int vertex_indices\nend_header\n",
          positions.size() / 3, mesh.triangle_count());
  fwrite(positions.data(), sizeof(double), positions.size(), file);
  for (size_t t = 0; t < mesh.triangle_count(); t++) {
    const unsigned char three = 3;
    const uint32_t corners[3] = {number[mesh.triangles[3 * t]], number[mesh.triangles[3 * t + 1]],
                                 number[mesh.triangles[3 * t + 2]]};
    fwrite(&three, 1, 1, file);
    fwrite(corners, sizeof(uint32_t), 3, file);
  }
  if (fclose(file) != 0) throw std::runtime_error(path + ": cannot write");
}

} // namespace bench
