// ODE on a scene of bench_world dump: trimesh against trimesh, quick step.
//
//   peer_ode SCENE SECONDS [TIME_STEP]       time step in s, default 2e-3
#include "scene.hpp"

#include <ode/ode.h>

namespace {

dWorldID world;
dJointGroupID contacts;
double friction;

void collide(void *, dGeomID a, dGeomID b) {
  enum { MOST = 32 };
  dContact found[MOST];
  dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
  if (!body_a && !body_b) return;
  const int count = dCollide(a, b, MOST, &found[0].geom, sizeof(dContact));
  for (int i = 0; i < count; i++) {
    found[i].surface.mode = dContactApprox1;
    found[i].surface.mu = friction;
    dJointAttach(dJointCreateContact(world, contacts, &found[i]), body_a, body_b);
  }
}

dTriMeshDataID mesh_of(const std::vector<double> &positions, const std::vector<int> &triangles) {
  dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(data, positions.data(), 3 * sizeof(double), int(positions.size() / 3),
                              triangles.data(), int(triangles.size()), 3 * sizeof(int));
  return data;
}

} // namespace

int main(int argc, char **argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s SCENE SECONDS [TIME_STEP]\n", argv[0]);
    return 2;
  }
  const Scene scene = read_scene(argv[1]);
  const double time_step = argc > 3 ? std::atof(argv[3]) : 2e-3;
  dInitODE2(0);
  world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  contacts = dJointGroupCreate(0);
  friction = scene.friction;
  dWorldSetGravity(world, 0, 0, -9.81);
  dCreatePlane(space, 0, 0, 1, 0);
  dCreateTriMesh(space, mesh_of(scene.wall_positions, scene.wall_triangles), nullptr, nullptr,
                 nullptr);
  std::vector<dTriMeshDataID> meshes;
  for (const SceneShape &s : scene.shapes) meshes.push_back(mesh_of(s.positions, s.triangles));
  for (const SceneBody &b : scene.bodies) {
    const SceneShape &s = scene.shapes[b.shape];
    dBodyID body = dBodyCreate(world);
    dMass mass;
    dMassSetParameters(&mass, s.mass, 0, 0, 0, s.inertia[0], s.inertia[1], s.inertia[2], 0, 0, 0);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, b.position[0], b.position[1], b.position[2]);
    dBodySetQuaternion(body, b.orientation);
    dGeomID geom = dCreateTriMesh(space, meshes[b.shape], nullptr, nullptr, nullptr);
    dGeomSetBody(geom, body);
  }
  time_steps("ODE trimesh", scene, time_step, std::atof(argv[2]), [&] {
    dSpaceCollide(space, nullptr, collide);
    dWorldQuickStep(world, time_step);
    dJointGroupEmpty(contacts);
  });
  return 0;
}
