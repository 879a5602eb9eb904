// Whether a mesh is closed and oriented: the boundary of its faces, as a chain, is nothing; and whether its
// faces look inward, as a whole or in parts that lie by themselves.
//
// Parts are faces that hang together by vertices, found by union-find (Tarjan 1975). Cost: some 10 ns a face
// for the whole, 20 more to find that it has one part, 40 where it has more. Known weakness: closedness is a
// fingerprint, which one open mesh in 2^64 shares.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/mesh.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"
#include "geometry/weld.hpp"

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

namespace detail {

/// The parts of a mesh: for each vertex, one that stands for its part.
inline std::vector<std::uint32_t> part_of_vertices(std::span<const std::array<std::uint32_t, 3>> faces,
                                                   std::size_t vertices) {
  std::vector<std::uint32_t> part(vertices);
  std::iota(part.begin(), part.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  for (const auto& face : faces)
    for (const std::size_t i : {1u, 2u})
      if (part[face[i]] != part[face[0]]) part[find(face[i])] = find(face[0]);
  for (std::uint32_t v = 0; v < vertices; ++v) part[v] = find(v);
  return part;
}

/// Whether every part is closed by itself, by the numbers of its vertices.
inline bool parts_are_closed(std::span<const std::array<std::uint32_t, 3>> faces,
                             const std::vector<std::uint32_t>& part) {
  std::vector<std::uint64_t> sum(part.size());
  for (const auto& face : faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t from = face[i], to = face[(i + 1) % 3];
      const std::uint64_t key =
          (std::min(from, to) * 0x9e3779b97f4a7c15u ^ std::max(from, to)) * 0xff51afd7ed558ccdu;
      sum[part[from]] += from < to ? key : from > to ? 0 - key : 0;
    }
  return std::ranges::all_of(sum, [](std::uint64_t s) { return s == 0; });
}

}  // namespace detail

/// Of a closed mesh: how many of its parts are inside out and lie within no other one, so that what they go
/// around is not inside (a hollow looks inward, too, but within another part). inside(p): whether the whole
/// mesh goes around a point more than 0 times.
template <class Inside>
std::size_t parts_inside_out(const geometry::Mesh3f& mesh, Inside&& inside) {
  std::vector<std::array<std::uint32_t, 3>> welded;
  std::span<const std::array<std::uint32_t, 3>> faces = mesh.faces;
  std::vector<std::uint32_t> part = detail::part_of_vertices(faces, mesh.vertices.size());
  if (std::ranges::all_of(faces, [&](const auto& face) { return part[face[0]] == part[faces[0][0]]; }))
    return is_inside_out(mesh) ? 1 : 0;
  if (!detail::parts_are_closed(faces, part)) {  // a soup: by the positions of corners
    const std::vector<std::uint32_t> first = geometry::first_at_position(mesh.vertices);
    welded = mesh.faces;
    for (auto& face : welded)
      for (std::uint32_t& v : face) v = first[v];
    faces = welded, part = detail::part_of_vertices(faces, mesh.vertices.size());
  }
  struct Sum {
    double volume = 0, size = 0;  // six times
    std::size_t faces = 0;
    std::uint32_t outermost = 0;  // of its vertices, along x
  };
  std::vector<Sum> sums(mesh.vertices.size());
  for (const auto& face : faces) {
    const std::uint32_t p = part[face[0]];
    Sum& s = sums[p];
    const geometry::Vec3d from(mesh.vertices[p]), a = geometry::Vec3d(mesh.vertices[face[0]]) - from,
                                                  b = geometry::Vec3d(mesh.vertices[face[1]]) - from,
                                                  c = geometry::Vec3d(mesh.vertices[face[2]]) - from;
    s.volume += dot(a, cross(b, c)), s.size += std::sqrt(length2(a) * length2(b) * length2(c));
    if (s.faces++ == 0) s.outermost = face[0];
    for (const std::uint32_t v : face)
      if (mesh.vertices[v][0] > mesh.vertices[s.outermost][0]) s.outermost = v;
  }
  std::size_t count = 0;
  for (const Sum& s : sums) {
    if (!(s.volume < -(double(s.faces) + 16) * geometry::tolerance::unit_roundoff<double> * s.size)) continue;
    geometry::Vec3f beside = mesh.vertices[s.outermost];  // the part does not go around that
    beside[0] = std::nextafter(beside[0], std::numeric_limits<float>::infinity());
    count += !inside(beside);
  }
  return count;
}

}  // namespace treeline::accel::field
