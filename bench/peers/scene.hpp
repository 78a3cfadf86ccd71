// A settled scene as bench_world dumps it, and the loop that times a peer on it. One header, read
// by the peers of the world only.
#pragma once
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

struct SceneShape {
  double mass, inertia[3];
  std::vector<double> positions;
  std::vector<int> triangles;
};
struct SceneBody {
  size_t shape;
  double position[3], orientation[4]; // w x y z
};
struct Scene {
  double radius, friction, restitution;
  std::vector<SceneShape> shapes;
  std::vector<SceneBody> bodies;
  // the cylinder as an inward mesh
  std::vector<double> wall_positions;
  std::vector<int> wall_triangles;
};

inline void need(bool good, const char *path) {
  if (good) return;
  std::fprintf(stderr, "peer: %s is no scene\n", path);
  std::exit(1);
}

inline void add_wall(Scene &scene, int sides, double height) {
  const double pi = 3.14159265358979323846, outer = scene.radius / std::cos(pi / sides);
  for (int i = 0; i < sides; i++)
    for (int top = 0; top < 2; top++) {
      const double angle = 2 * pi * i / sides;
      scene.wall_positions.insert(scene.wall_positions.end(),
                                  {outer * std::cos(angle), outer * std::sin(angle), top * height});
    }
  for (int i = 0; i < sides; i++) {
    const int a = 2 * i, b = 2 * ((i + 1) % sides);
    for (int corner : {a, a + 1, b, b, a + 1, b + 1}) scene.wall_triangles.push_back(corner);
  }
}

inline Scene read_scene(const char *path) {
  Scene scene;
  size_t shapes = 0, bodies = 0;
  FILE *file = std::fopen(path, "r");
  need(file && std::fscanf(file, "%lf %lf %lf %zu %zu", &scene.radius, &scene.friction,
                           &scene.restitution, &shapes, &bodies) == 5,
       path);
  for (size_t i = 0; i < shapes; i++) {
    SceneShape s;
    size_t vertices = 0, triangles = 0;
    need(std::fscanf(file, "%lf %lf %lf %lf %zu %zu", &s.mass, &s.inertia[0], &s.inertia[1],
                     &s.inertia[2], &vertices, &triangles) == 6,
         path);
    s.positions.resize(3 * vertices);
    s.triangles.resize(3 * triangles);
    for (double &x : s.positions) need(std::fscanf(file, "%lf", &x) == 1, path);
    for (int &v : s.triangles) need(std::fscanf(file, "%d", &v) == 1, path);
    scene.shapes.push_back(s);
  }
  for (size_t i = 0; i < bodies; i++) {
    SceneBody b;
    need(std::fscanf(file, "%zu", &b.shape) == 1, path);
    for (double &x : b.position) need(std::fscanf(file, "%lf", &x) == 1, path);
    for (double &x : b.orientation) need(std::fscanf(file, "%lf", &x) == 1, path);
    scene.bodies.push_back(b);
  }
  std::fclose(file);
  add_wall(scene, 64, 20);
  return scene;
}

inline double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Steps for about that many CPU seconds after a tenth of them to warm up; prints bodies, time step,
// steps, CPU s, particle-steps per second, simulated seconds per CPU second.
template <class Step>
void time_steps(const char *name, const Scene &scene, double time_step, double wanted, Step step) {
  for (double start = cpu_seconds(); cpu_seconds() - start < 0.1 * wanted;) step();
  long steps = 0;
  const double start = cpu_seconds();
  while (cpu_seconds() - start < wanted) {
    step();
    steps++;
  }
  const double used = cpu_seconds() - start;
  std::printf("%s,%zu,%g,%ld,%.3f,%.0f,%.4f\n", name, scene.bodies.size(), time_step, steps, used,
              double(steps) * double(scene.bodies.size()) / used, double(steps) * time_step / used);
}
