// Bullet on a scene of bench_world dump: GImpact meshes against each other.
//
//   peer_bullet SCENE SECONDS [TIME_STEP]      time step in s, default 2e-3
#include "scene.hpp"

#include <btBulletDynamicsCommon.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

namespace {

btTriangleIndexVertexArray *mesh_of(const std::vector<double> &positions,
                                    const std::vector<int> &triangles) {
  // the arrays stay for the life of the program
  btScalar *vertices = new btScalar[positions.size()];
  for (size_t i = 0; i < positions.size(); i++) vertices[i] = btScalar(positions[i]);
  int *indices = new int[triangles.size()];
  for (size_t i = 0; i < triangles.size(); i++) indices[i] = triangles[i];
  return new btTriangleIndexVertexArray(int(triangles.size() / 3), indices, 3 * sizeof(int),
                                        int(positions.size() / 3), vertices, 3 * sizeof(btScalar));
}

btRigidBody *add_body(btDiscreteDynamicsWorld &world, double mass, btCollisionShape *shape,
                      const btVector3 &inertia, const btTransform &at, double friction) {
  btRigidBody *body = new btRigidBody(btScalar(mass), new btDefaultMotionState(at), shape, inertia);
  body->setFriction(btScalar(std::sqrt(friction))); // the pair's is the product
  body->setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(body);
  return body;
}

} // namespace

int main(int argc, char **argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s SCENE SECONDS [TIME_STEP]\n", argv[0]);
    return 2;
  }
  const Scene scene = read_scene(argv[1]);
  const double time_step = argc > 3 ? std::atof(argv[3]) : 2e-3;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
  btDbvtBroadphase broad;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broad, &solver, &configuration);
  world.setGravity(btVector3(0, 0, btScalar(-9.81)));
  add_body(world, 0, new btStaticPlaneShape(btVector3(0, 0, 1), 0), btVector3(0, 0, 0),
           btTransform::getIdentity(), scene.friction);
  add_body(world, 0,
           new btBvhTriangleMeshShape(mesh_of(scene.wall_positions, scene.wall_triangles), true),
           btVector3(0, 0, 0), btTransform::getIdentity(), scene.friction);
  std::vector<btGImpactMeshShape *> shapes;
  for (const SceneShape &s : scene.shapes) {
    shapes.push_back(new btGImpactMeshShape(mesh_of(s.positions, s.triangles)));
    shapes.back()->setMargin(btScalar(1e-4));
    shapes.back()->updateBound();
  }
  for (const SceneBody &b : scene.bodies) {
    const SceneShape &s = scene.shapes[b.shape];
    const double *q = b.orientation, *x = b.position;
    const btQuaternion turn{btScalar(q[1]), btScalar(q[2]), btScalar(q[3]), btScalar(q[0])};
    const btVector3 place{btScalar(x[0]), btScalar(x[1]), btScalar(x[2])};
    const btTransform at{turn, place};
    add_body(world, s.mass, shapes[b.shape],
             btVector3(btScalar(s.inertia[0]), btScalar(s.inertia[1]), btScalar(s.inertia[2])), at,
             scene.friction);
  }
  time_steps("Bullet GImpact", scene, time_step, std::atof(argv[2]),
             [&] { world.stepSimulation(btScalar(time_step), 0); });
  return 0;
}
