/* OpenMesh: its quadric module alone, which collapses onto an existing vertex (half-edge collapse).
 */
#include "harness.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <stdexcept>

using bench::Mesh;
using bench::Run;

struct Traits : OpenMesh::DefaultTraits {
  typedef OpenMesh::Vec3d Point;
  typedef OpenMesh::Vec3d Normal;
};
using Surface = OpenMesh::TriMesh_ArrayKernelT<Traits>;

static void quadric(const Mesh &input, const std::vector<size_t> &counts, Run &run) {
  Surface surface;
  surface.request_face_normals();
  std::vector<Surface::VertexHandle> handles(input.vertex_count());
  for (size_t v = 0; v < handles.size(); v++)
    handles[v] = surface.add_vertex(
        {input.positions[3 * v], input.positions[3 * v + 1], input.positions[3 * v + 2]});
  for (size_t t = 0; t < input.triangle_count(); t++)
    if (!surface
             .add_face(handles[input.triangles[3 * t]], handles[input.triangles[3 * t + 1]],
                       handles[input.triangles[3 * t + 2]])
             .is_valid())
      throw std::runtime_error("OpenMesh takes manifold meshes only");
  run.start();
  surface.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Surface> decimater(surface);
  OpenMesh::Decimater::ModQuadricT<Surface>::Handle module;
  decimater.add(module);
  decimater.module(module).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, counts[0]);
  surface.garbage_collection();
  run.stop();
  Mesh level;
  for (auto v : surface.vertices())
    for (int k = 0; k < 3; k++) level.positions.push_back(surface.point(v)[k]);
  for (auto f : surface.faces())
    for (auto v : surface.fv_range(f)) level.triangles.push_back((uint32_t)v.idx());
  run.level(level, counts[0]);
}

const bench::Peer peers[] = {{"openmesh", false, quadric}, {nullptr, false, nullptr}};
