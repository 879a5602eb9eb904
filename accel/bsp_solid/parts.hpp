// Whether the parts of a surface that hang together bound one solid: there is some of it behind each, and
// none of them lies in another that faces the same way.
//
// Problem: such parts do not meet, so that the tree, which looks at nothing but what meets, would call the
// space between two of them outside as one of them says, or inside as the other does. Method: how often the
// surface goes around two points just behind and just in front of a face of each part (winding_tree.hpp): 1
// and 0, but where another solid touches there. Cost: a tree over the faces and two queries a part; nothing
// where there is one part. Known weakness: one face speaks for its part, which is enough unless parts run
// through each other (build.hpp) or lie flush.
#pragma once

#include <numeric>

#include "accel/bsp_solid/build.hpp"
#include "accel/signed_distance/winding_tree.hpp"
#include "geometry/adjacency.hpp"

namespace treeline::accel::solid {

/// faces: triangles of whole coordinates, called names[i] in the mesh that the adjacency is of. Throws
/// NotASolid.
inline void check_parts(const Pieces<ExactSpace>& pieces, std::span<const Piece> faces,
                        std::span<const Id> names, const geometry::Adjacency& adjacency) {
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
  for (const auto& [part, b] : best) {
    const Triangle3d t = triangle(faces[b.face]);
    const Vec3d normal = t.area_normal();
    const int axis = largest_axis(normal);
    constexpr double off = 0x1p-20;  // of a step: far more than a rounding, far less than what is kept apart
    Vec3d front = t.centroid(), back = front;
    front[axis] += std::copysign(off, normal[axis]), back[axis] -= std::copysign(off, normal[axis]);
    const double behind = winding(back).value, before = winding(front).value;
    const std::string who = "solid: the part of the surface that has face " + std::to_string(names[b.face]);
    if (behind < 0.5) throw NotASolid(who + " is inside out");
    if (behind > 1.5 && before > 0.5) throw NotASolid(who + " lies in another one that faces the same way");
  }
}

}  // namespace treeline::accel::solid
