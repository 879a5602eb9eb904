// Whether a mesh is closed and oriented: the boundary of its faces, as a chain, is nothing.
//
// Known weakness: closedness is a fingerprint, which one open mesh in 2^64 shares.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/mesh.hpp"
#include "geometry/random.hpp"

namespace treeline::accel::field {

/// Throws InvalidInput for a face that names a vertex that is not there.
inline void check_faces(const geometry::Mesh3f& mesh) {
  for (std::size_t i = 0; i < mesh.faces.size(); ++i)
    for (const std::uint32_t corner : mesh.faces[i])
      if (corner >= mesh.vertices.size())
        throw InvalidInput("face " + std::to_string(i) + " names vertex " + std::to_string(corner) + " of " +
                           std::to_string(mesh.vertices.size()));
}

/// Whether at every edge as many faces run one way as the other. Edges go by the positions of their ends, so
/// that a soup of triangles that fit is closed; a mesh with a face that is not finite is not, as trees leave
/// that out. Each directed edge adds a hash of its ends or takes it away; the sum over a closed, oriented
/// mesh is 0, and over any other as good as never. Throws as check_faces().
inline bool is_closed_cycle(const geometry::Mesh3f& mesh) {
  check_faces(mesh);
  std::vector<std::uint64_t> of_vertex(mesh.vertices.size());
  for (std::size_t v = 0; v < of_vertex.size(); ++v)
    for (int k = 0; k < 3; ++k)
      of_vertex[v] =
          geometry::mix_bits(of_vertex[v] * 3 + std::bit_cast<std::uint32_t>(mesh.vertices[v][k] + 0.0f));
  std::uint64_t sum = 0;
  for (const auto& face : mesh.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      if (!is_finite(mesh.vertices[face[i]])) return false;
      const std::uint64_t a = of_vertex[face[i]], b = of_vertex[face[(i + 1) % 3]];
      if (a < b) sum += geometry::mix_bits(a ^ geometry::mix_bits(b));
      if (b < a) sum -= geometry::mix_bits(b ^ geometry::mix_bits(a));
    }
  return sum == 0;
}

}  // namespace treeline::accel::field
