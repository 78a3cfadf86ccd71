/* What every peer shares: a mesh in plain arrays, exchange files, and the run of one peer at one or
 * several levels in a process of its own, so that CPU time and peak memory are the peer's alone.
 *
 * A peer program defines `peers`, a table ended by a null name; harness.cpp owns main():
 *     peer_NAME METHOD INPUT.ply PREFIX COUNT...
 * writes PREFIX_COUNT.ply per level and one CSV line per level to stdout:
 *     peer,count asked,count got,CPU seconds,peak bytes above the mesh in memory,file */
#ifndef SCREE_BENCH_HARNESS_HPP
#define SCREE_BENCH_HARNESS_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace bench {

struct Mesh {
  std::vector<double> positions;   // 3 per vertex
  std::vector<uint32_t> triangles; // 3 per triangle
  size_t triangle_count() const { return triangles.size() / 3; }
  size_t vertex_count() const { return positions.size() / 3; }
};

/* Any file that scree reads, welded, in the file's unit; throws std::runtime_error with one
 * sentence. */
Mesh read_mesh(const std::string &path);
/* PLY, binary little endian, double coordinates; vertices that no triangle uses are left out. */
void write_mesh(const Mesh &mesh, const std::string &path);

/* Takes the peer's levels. A peer calls start() when its own structure stands and stop() when the
 * wanted level is reached; the time between counts, building included separately. */
class Run {
public:
  Run(std::string peer, std::string prefix, const Mesh &input);
  void start();                                 // the clock runs
  void stop();                                  // the clock stands
  void level(const Mesh &level, size_t wanted); // writes the file and its CSV line; clock stands

private:
  std::string peer_, prefix_;
  double seconds_ = 0, started_ = 0;
  size_t resident_ = 0;
};

struct Peer {
  const char *name;
  bool chained; // all levels in one run, each from the one before; else each from the input
  void (*decimate)(const Mesh &input, const std::vector<size_t> &counts, Run &run);
};

} // namespace bench

extern const bench::Peer peers[];

#endif
