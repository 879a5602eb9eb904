// Meshes as OpenMesh holds them: what its half-edges make of a mesh, and its decimation.
//
// Half-edges hold manifold meshes only. OpenMesh's readers give each face that would make an edge or a vertex
// non-manifold three vertices of its own, which tears the surface open there, and leave out faces that name a
// vertex twice; neither is reported. Here it is.
#pragma once

#include "geometry/mesh.hpp"

namespace treeline::datasets {

struct HalfEdgeReport {
  std::size_t copied_vertices = 0;
  std::size_t lost_faces = 0;
  std::size_t boundary_edges = 0;  ///< afterwards

  bool faithful() const { return copied_vertices == 0 && lost_faces == 0; }
};

/// Whether this program has OpenMesh; without it the functions below throw std::runtime_error.
bool has_half_edges();

HalfEdgeReport half_edge_report(const geometry::Mesh3f& mesh);

struct Decimated {
  geometry::Mesh3f mesh;
  HalfEdgeReport input;
};

/// Collapses edges in order of their quadric error (Garland and Heckbert 1997) until at most `ratio` of the
/// faces are left, or none can be collapsed any more: compare the number of faces. Throws
/// std::invalid_argument for a ratio out of (0, 1] or a vertex that is not finite.
Decimated decimated(const geometry::Mesh3f& mesh, double ratio);

}  // namespace treeline::datasets
