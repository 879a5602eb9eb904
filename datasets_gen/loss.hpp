// What a mesh of fewer faces has lost of the one it was made from.
#pragma once

#include "geometry/mesh_check.hpp"

namespace treeline::datasets {

struct Loss {
  std::size_t parts = 0, parts_left = 0;  ///< whose faces hang together by edges
  double area = 0, area_left = 0;         ///< squared units of the mesh
  double volume = 0, volume_left = 0;     ///< signed; NaN of a mesh that is not closed and oriented
  /// The farthest that a vertex of the first lies from the faces of the other, in units of the mesh; infinite
  /// if there are none.
  double farthest = 0;
  double diagonal = 0;        ///< of the first's box
  std::size_t crossings = 0;  ///< pairs of faces of the other that cross or overlap
};

/// Vertices that no face names do not count. Faces of either that are not finite have no part in it.
Loss loss(const geometry::Mesh3f& given, const geometry::Mesh3f& left, int threads);

/// One line a figure, each ended by a newline.
std::string as_text(const Loss& loss);

}  // namespace treeline::datasets
