#include "harness.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bench {

static double cpu_seconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* A line of /proc/self/status in bytes, for example "VmHWM:". */
static size_t status_bytes(const char *key) {
  size_t kib = 0;
  char line[256];
  FILE *file = fopen("/proc/self/status", "r");
  while (file && fgets(line, sizeof line, file))
    if (!strncmp(line, key, strlen(key))) kib = strtoull(line + strlen(key), nullptr, 10);
  if (file) fclose(file);
  return kib * 1024;
}

/* "5" sets the high-water mark back to what is resident now (proc(5)). */
static void reset_peak() {
  if (FILE *file = fopen("/proc/self/clear_refs", "w")) {
    fputs("5", file);
    fclose(file);
  }
}

Run::Run(std::string peer, std::string prefix, const Mesh &)
    : peer_(std::move(peer)), prefix_(std::move(prefix)) {
  reset_peak();
  resident_ = status_bytes("VmRSS:");
}

void Run::start() {
  started_ = cpu_seconds();
}
void Run::stop() {
  seconds_ += cpu_seconds() - started_;
}

void Run::level(const Mesh &mesh, size_t wanted) {
  const size_t peak = status_bytes("VmHWM:");
  const std::string path = prefix_ + "_" + std::to_string(wanted) + ".ply";
  write_mesh(mesh, path);
  printf("%s,%zu,%zu,%.4f,%zu,%s\n", peer_.c_str(), wanted, mesh.triangle_count(), seconds_,
         peak - std::min(peak, resident_), path.c_str());
  fflush(stdout);
}

/* In a child, so that a crash or an endless loop (one hour) costs one level only. */
static bool run_apart(const Peer &peer, const Mesh &mesh, const std::string &prefix,
                      const std::vector<size_t> &counts) {
  fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    alarm(3600);
    Run run(peer.name, prefix, mesh);
    try {
      peer.decimate(mesh, counts, run);
    } catch (const std::exception &failure) {
      fprintf(stderr, "%s: %s\n", peer.name, failure.what());
      _exit(1);
    }
    fflush(stdout);
    _exit(0);
  }
  int status = 1;
  waitpid(child, &status, 0);
  if (status != 0) fprintf(stderr, "%s failed at %zu triangles\n", peer.name, counts.front());
  return status == 0;
}

} // namespace bench

int main(int argc, char **argv) {
  if (argc < 5) {
    fprintf(stderr, "usage: %s METHOD INPUT.ply PREFIX COUNT...\nmethods:", argv[0]);
    for (const bench::Peer *peer = peers; peer->name; peer++) fprintf(stderr, " %s", peer->name);
    fputc('\n', stderr);
    return 2;
  }
  const bench::Peer *peer = peers;
  while (peer->name && strcmp(peer->name, argv[1]) != 0) peer++;
  if (!peer->name) {
    fprintf(stderr, "%s: no method %s\n", argv[0], argv[1]);
    return 2;
  }
  try {
    const bench::Mesh mesh = bench::read_mesh(argv[2]);
    std::vector<size_t> counts;
    for (int i = 4; i < argc; i++) counts.push_back(strtoull(argv[i], nullptr, 10));
    std::sort(counts.rbegin(), counts.rend());
    bool good = true;
    if (peer->chained) return bench::run_apart(*peer, mesh, argv[3], counts) ? 0 : 1;
    for (size_t count : counts) good = bench::run_apart(*peer, mesh, argv[3], {count}) && good;
    return good ? 0 : 1;
  } catch (const std::exception &failure) {
    fprintf(stderr, "%s\n", failure.what());
    return 1;
  }
}
