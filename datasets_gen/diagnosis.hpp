// What is wrong with a mesh, for people and for programs: the answer of `treeline_gen --check`.
#pragma once

#include <optional>
#include <string>

#include "accel/self_intersections.hpp"
#include "datasets_gen/dataset.hpp"
#include "datasets_gen/files/half_edges.hpp"
#include "geometry/mesh_check.hpp"

namespace treeline::datasets {

struct Diagnosis {
  geometry::MeshCheck mesh;
  accel::SelfIntersections crossings;        // among the mesh's sound faces
  std::optional<HalfEdgeReport> half_edges;  // where OpenMesh is there

  /// Closed, oriented outward, and nothing found.
  bool clean() const;
};

/// Keeps so many examples of each finding.
Diagnosis diagnose(const geometry::Mesh3f& mesh, std::size_t examples, int threads);

/// Several lines: counts of everything, and the first examples with their coordinates. Numbers of faces and
/// vertices count from 0, here and in the JSON; faces are the mesh's triangles.
std::string as_text(const Dataset& dataset, const Diagnosis& diagnosis);
/// One object, on one line. Coordinates that are not finite are null. Positions are those of the vertices; of
/// a crossing, a point of it.
std::string as_json(const Dataset& dataset, const Diagnosis& diagnosis);

}  // namespace treeline::datasets
