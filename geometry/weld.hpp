// Vertices at equal positions joined into one.
//
// Problem: files of triangle soups (STL) and seams of exporters name one point by several vertices;
// half-edges, decimation and normals of corners need one. Method: open addressing by a hash of the
// coordinates; equal means equal floats, -0 and 0 among them. Vertices that are not finite stand for
// themselves. Cost: O(n); some 30 ns a vertex. Known weakness: vertices that nearly coincide are different.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/random.hpp"

namespace treeline::geometry {

/// Of each vertex, the first at its position.
template <class T>
std::vector<std::uint32_t> first_at_position(const std::vector<Vec<T, 3>>& vertices) {
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> first(vertices.size());
  std::iota(first.begin(), first.end(), 0u);
  std::vector<std::uint32_t> table(std::bit_ceil(2 * vertices.size() + 1), none);
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    const auto& p = vertices[v];
    if (!is_finite(p)) continue;
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) h = mix_bits(h + std::bit_cast<std::uint64_t>(double(p[k]) + 0.0));
    std::size_t at = h & (table.size() - 1);
    while (table[at] != none && !(vertices[table[at]] == p)) at = (at + 1) & (table.size() - 1);
    if (table[at] == none)
      table[at] = v;
    else
      first[v] = table[at];
  }
  return first;
}

template <class T>
struct Welded {
  Mesh<T> mesh;
  std::size_t joined = 0;     ///< vertices that gave way to an earlier one
  std::size_t collapsed = 0;  ///< faces left out, as they would name a vertex twice
};

/// Faces keep their order; of vertices, those that stay. Throws std::out_of_range for a face that names no
/// vertex.
template <class T>
Welded<T> welded(const Mesh<T>& mesh) {
  const std::vector<std::uint32_t> first = first_at_position(mesh.vertices);
  Welded<T> r;
  std::vector<std::uint32_t> number(first.size());
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (first[v] == v) {
      number[v] = static_cast<std::uint32_t>(r.mesh.vertices.size());
      r.mesh.vertices.push_back(mesh.vertices[v]);
    } else {
      number[v] = number[first[v]], ++r.joined;
    }
  }
  for (auto face : mesh.faces) {
    for (std::uint32_t& v : face) v = number.at(v);
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
      ++r.collapsed;
    else
      r.mesh.faces.push_back(face);
  }
  return r;
}

}  // namespace treeline::geometry
