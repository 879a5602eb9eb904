// Whether a mesh is closed and oriented: the boundary of its faces, as a chain, is nothing; and whether its
// faces look inward as a whole.
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
#include "geometry/tolerances.hpp"

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

/// Of a closed mesh: whether its volume, counted positive where faces look outward, is negative beyond the
/// rounding of its sum in double.
inline bool is_inside_out(const geometry::Mesh3f& mesh) {
  if (mesh.faces.empty()) return false;
  const geometry::Vec3d from(mesh.vertices[mesh.faces[0][0]]);
  double volume = 0, size = 0;  // six times
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const geometry::Triangle3d t(mesh.triangle(i));
    const geometry::Vec3d a = t.a - from, b = t.b - from, c = t.c - from;
    volume += dot(a, cross(b, c)), size += length(a) * length(b) * length(c);
  }
  // Each term is off by some roundings of its size, the sum by one more for each term.
  return volume < -(double(mesh.size()) + 16) * geometry::tolerance::unit_roundoff<double> * size;
}

}  // namespace treeline::accel::field
