/* meshoptimizer: one call per level, and all levels chained, each from the one before. Debian's
 * 0.18 keeps the original vertices; from 1.0 on meshopt_simplifyWithUpdate moves them, and is used
 * where the installed header has it. */
#include "harness.hpp"

#include <meshoptimizer.h>

using bench::Mesh;
using bench::Run;

struct State {
  std::vector<float> positions;
  std::vector<unsigned> triangles;
};

static State state_of(const Mesh &mesh) {
  return {{mesh.positions.begin(), mesh.positions.end()}, mesh.triangles};
}

static void simplify(State &state, size_t wanted) {
  std::vector<unsigned> made(state.triangles.size());
  const size_t count = meshopt_simplify(made.data(), state.triangles.data(), state.triangles.size(),
                                        state.positions.data(), state.positions.size() / 3,
                                        3 * sizeof(float), 3 * wanted, 1e9f, 0, nullptr);
  made.resize(count);
  state.triangles.swap(made);
}

#if MESHOPTIMIZER_VERSION >= 1000
static void simplify_update(State &state, size_t wanted) {
  state.triangles.resize(meshopt_simplifyWithUpdate(
      state.triangles.data(), state.triangles.size(), state.positions.data(),
      state.positions.size() / 3, 3 * sizeof(float), nullptr, 0, nullptr, 0, nullptr, 3 * wanted,
      1e9f, 0, nullptr));
}
#endif

template <void (*STEP)(State &, size_t)>
static void decimate(const Mesh &input, const std::vector<size_t> &counts, Run &run) {
  State state = state_of(input);
  for (size_t wanted : counts) {
    run.start();
    STEP(state, wanted);
    run.stop();
    run.level({{state.positions.begin(), state.positions.end()}, state.triangles}, wanted);
  }
}

const bench::Peer peers[] = {
    {"meshopt", false, decimate<simplify>},
    {"meshopt_chained", true, decimate<simplify>},
#if MESHOPTIMIZER_VERSION >= 1000
    {"meshopt_update", false, decimate<simplify_update>},
    {"meshopt_update_chained", true, decimate<simplify_update>},
#endif
    {nullptr, false, nullptr},
};
