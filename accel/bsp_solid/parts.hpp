// Whether a surface bounds one solid: there is some of it behind each of its parts, and no space that it goes
// around twice.
//
// Problem: parts that lie in one another do not meet, and those that meet along edges, or lie flush, do not
// run through each other's faces; the tree would call the space between two of them outside as one of them
// says, or inside as the other does. Method: how often the surface goes around points just behind its faces
// (winding_tree.hpp): once. That changes from face to face only where some other one touches: of faces that
// none touches, and that hang together by edges of two, one is asked; of those that are touched every piece
// that the tree has cut, since only some of a face may border on what is enclosed twice. For parts that are
// inside out one face of each is asked. Cost: for touches what near_faces.hpp takes, O(n log n) around
// corners of many faces, too; where there is more than one part, or a touch, another tree over the faces and
// a query for each that is asked. Known weakness: pieces thinner than 2^-8 of a step are not asked.
#pragma once

#include <limits>
#include <numeric>
#include <optional>

#include "accel/bsp_solid/build.hpp"
#include "accel/near_faces.hpp"
#include "accel/signed_distance/winding_tree.hpp"
#include "geometry/adjacency.hpp"
#include "geometry/disjoint_sets.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "geometry/weld.hpp"

namespace treeline::accel::solid {

/// Which of a mesh's faces another one touches.
class TouchFinder {
 public:
  TouchFinder(const std::vector<geometry::Triangle3d>& triangles, std::vector<bool>& touched)
      : triangles_(triangles), touched_(touched) {}

  void operator()(std::uint32_t f, std::uint32_t g) const {
    if (touched_[f] && touched_[g]) return;
    const geometry::Triangle3d &t = triangles_[f], &u = triangles_[g];
    if (geometry::cross_each_other(t, u) || geometry::SharedCorners(t, u).count == 3)
      touched_[f] = touched_[g] = true;
  }

 private:
  const std::vector<geometry::Triangle3d>& triangles_;
  std::vector<bool>& touched_;
};

/// Of each triangle whether another one has a point in common with it beyond corners and edges that both have
/// (exact/triangle_triangle.hpp), or is the same. welded: the faces by the first vertices at their positions.
inline std::vector<bool> touched_faces(const geometry::Mesh3d& mesh,
                                       const std::vector<geometry::Mesh3d::Face>& welded) {
  std::vector<geometry::Triangle3d> triangles;
  for (std::size_t f = 0; f < mesh.size(); ++f) triangles.push_back(mesh.triangle(f));
  std::vector<bool> touched(mesh.size());
  constexpr int threads = 1;  // they would share the bits
  each_near_pair(triangles, welded, threads, TouchFinder(triangles, touched), [](const TouchFinder&) {});
  return touched;
}

/// faces: triangles of whole coordinates, called names[i] in the mesh that the adjacency is of; cut: what the
/// tree made of them. Throws NotASolid.
class PartsCheck {
 public:
  PartsCheck(const Pieces<ExactSpace>& pieces, std::span<const Piece> faces, std::span<const Id> names)
      : pieces_(pieces), faces_(faces), names_(names) {
    for (const Piece& p : faces) {
      const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
      for (const auto& c : pieces.of(p)) mesh_.vertices.push_back(c.at);
      mesh_.faces.push_back({first, first + 1, first + 2});
    }
  }

  void operator()(std::span<const Piece> cut, const geometry::Adjacency& adjacency) {
    if (faces_.empty()) return;
    const std::vector<std::uint32_t>& sides = adjacency.sorted_half_edges();
    geometry::DisjointSets parts(*std::ranges::max_element(sides) / 3 + std::size_t{1});
    for (const std::uint32_t side : sides)
      if (const std::uint32_t twin = adjacency.twin(side); twin != geometry::Adjacency::none)
        parts.join(side / 3, twin / 3);
    const std::vector<std::size_t> of_parts =
        highest([&](std::size_t i) { return std::optional(parts.find(names_[i])); });

    const std::vector<std::uint32_t> first = geometry::first_at_position(mesh_.vertices);
    auto welded = mesh_.faces;
    for (auto& f : welded)
      for (std::uint32_t& v : f) v = first[v];
    const std::vector<bool> touched = touched_faces(mesh_, welded);
    geometry::DisjointSets sheets = untouched_sheets(welded, touched);
    const std::vector<std::size_t> of_sheets = highest([&](std::size_t i) {
      return touched[i] ? std::nullopt : std::optional(sheets.find(static_cast<std::uint32_t>(i)));
    });
    const bool any = std::ranges::find(touched, true) != touched.end();
    if (of_parts.size() < 2 && of_sheets.size() < 2 && !any) return;

    winding_.emplace(mesh_, 2, 1);
    for (const std::size_t i : of_parts)
      if (turns_behind(triangle(i).centroid(), triangle(i).area_normal()) < 0.5)
        throw NotASolid(who(i) + " is inside out");
    for (const std::size_t i : of_sheets) refuse_twice(i, triangle(i).centroid());
    for (const Piece& p : cut)
      if (touched[p.face]) ask(p);
  }

 private:
  geometry::Triangle3d triangle(std::size_t face) const { return mesh_.triangle(face); }
  std::string who(std::size_t face) const {
    return "solid: the part of the surface that has face " + std::to_string(names_[face]);
  }

  /// Of each set of faces the one that is highest above its longest side: whose middle is farthest from its
  /// edges. set_of(face): none for those that are in no set.
  template <class SetOf>
  std::vector<std::size_t> highest(const SetOf& set_of) const {
    struct Best {
      double height = 0;
      std::size_t face = 0;
    };
    std::unordered_map<std::uint32_t, Best> best;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::optional<std::uint32_t> set = set_of(i);
      if (!set) continue;
      const geometry::Triangle3d t = triangle(i);
      const double longest2 = std::max({length2(t.b - t.a), length2(t.c - t.b), length2(t.a - t.c)});
      Best& b = best[*set];
      if (const double height = length(t.area_normal()) / std::sqrt(longest2); height > b.height)
        b = {height, i};
    }
    std::vector<std::size_t> r;
    for (const auto& [set, b] : best) r.push_back(b.face);
    std::ranges::sort(r);
    return r;
  }

  /// What hangs together by edges, at equal positions, of two faces that none touches.
  geometry::DisjointSets untouched_sheets(const std::vector<geometry::Mesh3d::Face>& welded,
                                          const std::vector<bool>& touched) const {
    const geometry::Adjacency adjacency(welded, mesh_.vertices.size());
    geometry::DisjointSets sheets(welded.size());
    for (const auto& edge : adjacency.edges()) {
      if (edge.count != 2) continue;
      const auto sides = adjacency.half_edges_of(edge);
      if (const std::uint32_t f = sides[0] / 3, g = sides[1] / 3; !touched[f] && !touched[g])
        sheets.join(f, g);
    }
    return sheets;
  }

  /// How often the surface goes around a point just behind one of a plane with that normal.
  double turns_behind(geometry::Vec3d at, const geometry::Vec3d& normal) const {
    constexpr double off = 0x1p-20;  // of a step: far more than a rounding, far less than what is kept apart
    const int axis = largest_axis(normal);
    at[axis] -= std::copysign(off, normal[axis]);
    return (*winding_)(at).value;
  }
  void refuse_twice(std::size_t face, const geometry::Vec3d& at) const {
    if (turns_behind(at, triangle(face).area_normal()) > 1.5)
      throw NotASolid(who(face) + " lies in another one that faces the same way, or runs through it");
  }
  void ask(const Piece& p) const {
    constexpr double thin = 0x1p-8;  // of a step
    const auto c = pieces_.of(p);
    geometry::Vec3d middle;
    const geometry::Vec3d normal = normalized(triangle(p.face).area_normal());
    for (const auto& corner : c) middle = middle + corner.at;
    middle = middle / static_cast<double>(c.size());
    double height = std::numeric_limits<double>::infinity();  // of the middle above the sides
    for (std::size_t i = 0; i < c.size(); ++i) {
      const geometry::Vec3d side = c[(i + 1) % c.size()].at - c[i].at;
      if (const double l = length(side); l > 0)
        height = std::min(height, dot(cross(normal, side), middle - c[i].at) / l);
    }
    if (height > thin) refuse_twice(p.face, middle);
  }

  const Pieces<ExactSpace>& pieces_;
  std::span<const Piece> faces_;
  std::span<const Id> names_;
  geometry::Mesh3d mesh_;  // of the faces, in steps
  std::optional<WindingTree<double>> winding_;
};

}  // namespace treeline::accel::solid
