#include "datasets_gen/files/half_edges.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#ifdef TREELINE_HAVE_OPENMESH
#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/ImporterT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#endif

namespace treeline::datasets {

#ifdef TREELINE_HAVE_OPENMESH
namespace {

using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<>;

/// As OpenMesh's readers build it.
HalfEdgeReport build(const geometry::Mesh3f& mesh, HalfEdges& to) {
  omerr().disable();
  OpenMesh::IO::ImporterT<HalfEdges> importer(to);
  for (const auto& p : mesh.vertices) importer.add_vertex(OpenMesh::Vec3f(p[0], p[1], p[2]));
  HalfEdgeReport report;
  for (const auto& f : mesh.faces) {
    OpenMesh::IO::BaseImporter::VHandles corners;
    for (const std::uint32_t v : f) corners.push_back(OpenMesh::VertexHandle(static_cast<int>(v)));
    if (!importer.add_face(corners).is_valid()) ++report.lost_faces;
  }
  report.copied_vertices = to.n_vertices() - mesh.vertices.size();
  for (const auto edge : to.edges()) report.boundary_edges += to.is_boundary(edge);
  return report;
}

}  // namespace

bool has_half_edges() { return true; }

HalfEdgeReport half_edge_report(const geometry::Mesh3f& mesh) {
  HalfEdges half_edges;
  return build(mesh, half_edges);
}

Decimated decimated(const geometry::Mesh3f& mesh, double ratio) {
  if (!(ratio > 0 && ratio <= 1))
    throw std::invalid_argument("the ratio of faces to keep is " + std::to_string(ratio) +
                                "; it must be in (0, 1]");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!is_finite(mesh.vertices[v]))
      throw std::invalid_argument("vertex " + std::to_string(v) +
                                  " is not finite; such a mesh cannot be decimated");
  HalfEdges half_edges;
  Decimated r;
  r.input = build(mesh, half_edges);
  OpenMesh::Decimater::DecimaterT<HalfEdges> decimater(half_edges);
  OpenMesh::Decimater::ModQuadricT<HalfEdges>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();  // orders collapses and allows them all
  decimater.initialize();
  const auto wanted = static_cast<std::size_t>(std::floor(ratio * static_cast<double>(mesh.size())));
  decimater.decimate_to_faces(0, wanted);
  half_edges.garbage_collection();
  for (const auto v : half_edges.vertices()) {
    const auto& p = half_edges.point(v);
    r.mesh.vertices.push_back({p[0], p[1], p[2]});
  }
  for (const auto f : half_edges.faces()) {
    geometry::Mesh3f::Face corners;
    std::size_t k = 0;
    for (const auto v : half_edges.fv_range(f)) corners[k++] = static_cast<std::uint32_t>(v.idx());
    r.mesh.faces.push_back(corners);
  }
  return r;
}
#else
namespace {
[[noreturn]] void absent() { throw std::runtime_error("this program was built without OpenMesh"); }
}  // namespace

bool has_half_edges() { return false; }
HalfEdgeReport half_edge_report(const geometry::Mesh3f&) { absent(); }
Decimated decimated(const geometry::Mesh3f&, double) { absent(); }
#endif

}  // namespace treeline::datasets
