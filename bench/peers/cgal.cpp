/* CGAL: Lindstrom-Turk (memoryless, keeps volume) and Garland-Heckbert with plane quadrics, both as
 * the manual shows them, no filter added. */
#include "harness.hpp"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <stdexcept>

namespace sms = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using bench::Mesh;
using bench::Run;

static Surface surface_of(const Mesh &mesh) {
  Surface surface;
  surface.reserve(mesh.vertex_count(), 3 * mesh.triangle_count() / 2, mesh.triangle_count());
  for (size_t v = 0; v < mesh.vertex_count(); v++)
    surface.add_vertex(
        {mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]});
  for (size_t t = 0; t < mesh.triangle_count(); t++) {
    const Surface::Face_index face =
        surface.add_face(Surface::Vertex_index(mesh.triangles[3 * t]),
                         Surface::Vertex_index(mesh.triangles[3 * t + 1]),
                         Surface::Vertex_index(mesh.triangles[3 * t + 2]));
    if (face == Surface::null_face())
      throw std::runtime_error("CGAL's Surface_mesh takes manifold meshes only");
  }
  return surface;
}

static Mesh mesh_of(Surface &surface) {
  Mesh mesh;
  surface.collect_garbage();
  for (auto v : surface.vertices())
    for (int k = 0; k < 3; k++) mesh.positions.push_back(surface.point(v)[k]);
  for (auto f : surface.faces())
    for (auto v : CGAL::vertices_around_face(surface.halfedge(f), surface))
      mesh.triangles.push_back(v);
  return mesh;
}

/* Stops at the first count of triangles not above the wanted one: edges of a closed surface are 3/2
 * of its triangles. */
static sms::Count_stop_predicate<Surface> stop_at(size_t wanted) {
  return sms::Count_stop_predicate<Surface>(wanted * 3 / 2 + 1);
}

static void lindstrom_turk(const Mesh &input, const std::vector<size_t> &counts, Run &run) {
  Surface surface = surface_of(input);
  run.start();
  sms::edge_collapse(surface, stop_at(counts[0]),
                     CGAL::parameters::get_cost(sms::LindstromTurk_cost<Surface>())
                         .get_placement(sms::LindstromTurk_placement<Surface>()));
  run.stop();
  run.level(mesh_of(surface), counts[0]);
}

static void garland_heckbert(const Mesh &input, const std::vector<size_t> &counts, Run &run) {
  Surface surface = surface_of(input);
  run.start();
  sms::GarlandHeckbert_plane_policies<Surface, Kernel> policies(surface);
  sms::edge_collapse(
      surface, stop_at(counts[0]),
      CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  run.stop();
  run.level(mesh_of(surface), counts[0]);
}

const bench::Peer peers[] = {
    {"cgal_lt", false, lindstrom_turk},
    {"cgal_gh", false, garland_heckbert},
    {nullptr, false, nullptr},
};
