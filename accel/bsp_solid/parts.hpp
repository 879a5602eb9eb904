// Whether a surface bounds one solid: there is some of it behind each of its parts, and no space that it goes
// around twice.
//
// Problem: parts that lie in one another do not meet, and those that meet along edges, or lie flush, do not
// run through each other's faces; the tree would call the space between two of them outside as one of them
// says, or inside as the other does. Method: how often the surface goes around points just behind its faces
// (winding_tree.hpp): once. For parts that are inside out one face of each is asked; for space that is
// enclosed twice every piece that the tree has cut, since only some of a face may border on it. Cost: a tree
// over the faces, and a query a piece: seven times the build's time for shells of 80,000 faces; nothing where
// there is one part. Known weakness: pieces thinner than 2^-8 of a step are not asked, nor is a single part
// that lies flush with itself.
#pragma once

#include <limits>
#include <numeric>

#include "accel/bsp_solid/build.hpp"
#include "accel/signed_distance/winding_tree.hpp"
#include "geometry/adjacency.hpp"

namespace treeline::accel::solid {

/// faces: triangles of whole coordinates, called names[i] in the mesh that the adjacency is of; cut: what the
/// tree made of them. Throws NotASolid.
inline void check_parts(const Pieces<ExactSpace>& pieces, std::span<const Piece> faces,
                        std::span<const Piece> cut, std::span<const Id> names,
                        const geometry::Adjacency& adjacency) {
  using geometry::Triangle3d;
  using geometry::Vec3d;
  const std::vector<std::uint32_t>& sides = adjacency.sorted_half_edges();
  if (faces.empty()) return;
  std::vector<std::uint32_t> parent(*std::ranges::max_element(sides) / 3 + std::size_t{1});
  std::iota(parent.begin(), parent.end(), 0u);
  const auto part_of = [&](std::uint32_t f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  for (const std::uint32_t side : sides)
    if (const std::uint32_t twin = adjacency.twin(side); twin != geometry::Adjacency::none)
      parent[part_of(side / 3)] = part_of(twin / 3);

  const auto triangle = [&](const Piece& p) {
    const auto c = pieces.of(p);
    return Triangle3d{c[0].at, c[1].at, c[2].at};
  };
  /// Of each part the face that is highest above its longest side: whose middle is farthest from its edges.
  struct Best {
    double height = 0;
    std::size_t face = 0;
  };
  std::unordered_map<std::uint32_t, Best> best;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Triangle3d t = triangle(faces[i]);
    const double longest2 = std::max({length2(t.b - t.a), length2(t.c - t.b), length2(t.a - t.c)});
    Best& b = best[part_of(names[i])];
    if (const double height = length(t.area_normal()) / std::sqrt(longest2); height > b.height)
      b = {height, i};
  }
  if (best.size() < 2) return;

  geometry::Mesh3d mesh;
  for (const Piece& p : faces) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& c : pieces.of(p)) mesh.vertices.push_back(c.at);
    mesh.faces.push_back({first, first + 1, first + 2});
  }
  const WindingTree<double> winding(mesh, 2, 1);
  constexpr double off = 0x1p-20;  // of a step: far more than a rounding, far less than what is kept apart
  /// How often the surface goes around a point just behind one of a plane with that normal.
  const auto turns_behind = [&](Vec3d at, const Vec3d& normal) {
    const int axis = largest_axis(normal);
    at[axis] -= std::copysign(off, normal[axis]);
    return winding(at).value;
  };
  const auto who = [&](std::size_t face) {
    return "solid: the part of the surface that has face " + std::to_string(names[face]);
  };
  for (const auto& [part, b] : best) {
    const Triangle3d t = triangle(faces[b.face]);
    if (turns_behind(t.centroid(), t.area_normal()) < 0.5) throw NotASolid(who(b.face) + " is inside out");
  }
  constexpr double thin = 0x1p-8;  // of a step
  for (const Piece& p : cut) {
    const auto c = pieces.of(p);
    Vec3d middle, normal = triangle(faces[p.face]).area_normal();
    for (const auto& corner : c) middle = middle + corner.at;
    middle = middle / static_cast<double>(c.size());
    normal = normalized(normal);
    double height = std::numeric_limits<double>::infinity();  // of the middle above the sides
    for (std::size_t i = 0; i < c.size(); ++i) {
      const Vec3d side = c[(i + 1) % c.size()].at - c[i].at;
      if (const double l = length(side); l > 0)
        height = std::min(height, dot(cross(normal, side), middle - c[i].at) / l);
    }
    if (height > thin && turns_behind(middle, normal) > 1.5)
      throw NotASolid(who(p.face) + " lies in another one that faces the same way, or runs through it");
  }
}

}  // namespace treeline::accel::solid
