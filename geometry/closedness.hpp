// Whether a mesh is closed and consistently oriented, in one pass and without tables: for those who only need
// to know.
//
// Problem: adjacency.hpp sorts all half-edges, which takes as long as building a tree. Method: every directed
// edge u v counts with a 64-bit hash of its two ends, plus if u comes first, minus if v does. If as many
// faces run along each edge one way as the other, the sum over all half-edges is 0; else it is a random
// number, 0 with a probability of 2^-64 (fingerprints of multisets, as in Carter and Wegman 1979). The same
// with the sums of single bits finds whether each edge has an even number of faces. Ends are known by
// position, so that a soup of triangles whose corners coincide is closed. Cost: some 15 ns a face. Known
// weakness: says nothing of where.
#pragma once

#include <bit>
#include <stdexcept>
#include <string>

#include "geometry/mesh.hpp"
#include "geometry/random.hpp"

namespace treeline::geometry {

struct Closedness {
  bool closed = false;    ///< every edge has an even number of faces
  bool oriented = false;  ///< at every edge as many faces run one way as the other; implies closed
};

/// Corners that are equal, -0 and 0 among them, are the same; faces that name a corner twice do not count,
/// nor do those with a corner that is not finite: where they stand the mesh has a hole. A mesh without faces
/// is closed and oriented. Throws std::out_of_range for a face that names no vertex.
template <class T>
Closedness closedness(const Mesh<T>& mesh) {
  const auto key = [](const Vec<T, 3>& p) {
    std::uint64_t h = 0x243f6a8885a308d3ull;
    for (int k = 0; k < 3; ++k) h = mix_bits(h + std::bit_cast<std::uint64_t>(double(p[k]) + 0.0));
    return h;
  };
  std::uint64_t sum = 0, parity = 0;
  std::vector<std::uint64_t> of_vertex;
  of_vertex.reserve(mesh.vertices.size());
  for (const auto& p : mesh.vertices) of_vertex.push_back(key(p));
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const auto& face = mesh.faces[f];
    for (const std::uint32_t corner : face)
      if (corner >= of_vertex.size())
        throw std::out_of_range("closedness: face " + std::to_string(f) + " names vertex " +
                                std::to_string(corner) + " of " + std::to_string(of_vertex.size()));
    if (!is_finite(mesh.triangle(f))) continue;
    const std::uint64_t v[3] = {of_vertex[face[0]], of_vertex[face[1]], of_vertex[face[2]]};
    for (int i = 0; i < 3; ++i) {
      const std::uint64_t from = v[i], to = v[(i + 1) % 3];
      if (from == to) continue;
      const std::uint64_t h = mix_bits(mix_bits(std::min(from, to)) ^ std::rotl(std::max(from, to), 29));
      sum += from < to ? h : 0 - h, parity ^= h;
    }
  }
  return {parity == 0, sum == 0 && parity == 0};
}

}  // namespace treeline::geometry
