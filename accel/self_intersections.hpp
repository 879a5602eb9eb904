// Which faces of a mesh run through each other, decided exactly.
//
// Problem: inside and outside have no meaning where a surface crosses itself, and files do not tell. Method:
// near_faces.hpp tells which pairs may meet, the exact predicate decides
// (geometry/exact/triangle_triangle.hpp has its convention: faces that share corners or an edge cross only
// where they meet beyond those). Cost: O(n log n) and the pairs that are decided, six to eight a face on a
// surface. Known weakness: near_faces.hpp's; of equal faces, ask about one.
#pragma once

#include <string>

#include "accel/near_faces.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "geometry/predicates.hpp"
#include "geometry/weld.hpp"

namespace treeline::accel {

struct SelfIntersectionOptions {
  std::size_t kept = 10;  ///< pairs listed, those of lowest numbers; all are counted
  int threads = 1;
};

struct SelfIntersections {
  using Pair = std::array<std::uint32_t, 2>;  // numbers of faces, the lower first

  std::size_t count = 0;     ///< pairs
  std::vector<Pair> pairs;   ///< in ascending order
  std::size_t examined = 0;  ///< pairs that the exact predicate was asked about
  std::size_t boxes = 0;     ///< looked at on the way to them
};

namespace detail {

/// A thread's share of the pairs.
class CrossingFinder {
 public:
  CrossingFinder(const std::vector<geometry::Triangle3f>& triangles, std::span<const std::uint32_t> names,
                 std::size_t kept)
      : triangles_(triangles), names_(names), kept_(kept) {}

  void operator()(std::uint32_t i, std::uint32_t j) {
    ++found_.examined;
    if (!cross_each_other(triangles_[i], triangles_[j])) return;
    ++found_.count;
    found_.pairs.push_back({std::min(names_[i], names_[j]), std::max(names_[i], names_[j])});
    if (found_.pairs.size() > 2 * kept_ + 64) keep_the_first(found_.pairs);
  }
  void add_to(SelfIntersections& all) const {
    all.count += found_.count, all.examined += found_.examined;
    all.pairs.insert(all.pairs.end(), found_.pairs.begin(), found_.pairs.end());
    keep_the_first(all.pairs);
  }

 private:
  void keep_the_first(std::vector<SelfIntersections::Pair>& pairs) const {
    std::ranges::sort(pairs);
    if (pairs.size() > kept_) pairs.resize(kept_);
  }

  const std::vector<geometry::Triangle3f>& triangles_;
  std::span<const std::uint32_t> names_;
  std::size_t kept_;
  SelfIntersections found_;
};

}  // namespace detail

/// Among the given faces of a mesh. Throws InvalidInput for a face with a corner that is not there or not
/// finite, or without area.
inline SelfIntersections self_intersections(const geometry::Mesh3f& mesh,
                                            std::span<const std::uint32_t> faces,
                                            const SelfIntersectionOptions& options = {}) {
  for (const std::uint32_t f : faces) {
    if (f >= mesh.size())
      throw InvalidInput("face " + std::to_string(f) + " of " + std::to_string(mesh.size()));
    for (const std::uint32_t corner : mesh.faces[f])
      if (corner >= mesh.vertices.size())
        throw InvalidInput("face " + std::to_string(f) + " names vertex " + std::to_string(corner) + " of " +
                           std::to_string(mesh.vertices.size()));
    if (!is_finite(mesh.triangle(f)) || is_degenerate(mesh.triangle(f)))
      throw InvalidInput("face " + std::to_string(f) + " has no area, or a coordinate that is not finite");
  }
  const std::vector<std::uint32_t> first = geometry::first_at_position(mesh.vertices);
  std::vector<geometry::Triangle3f> triangles(faces.size());
  std::vector<std::array<std::uint32_t, 3>> corners(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    triangles[i] = mesh.triangle(faces[i]);
    for (std::size_t k = 0; k < 3; ++k) corners[i][k] = first[mesh.faces[faces[i]][k]];
  }
  SelfIntersections all;
  all.boxes = each_near_pair(triangles, corners, options.threads,
                             detail::CrossingFinder(triangles, faces, options.kept),
                             [&](const detail::CrossingFinder& finder) { finder.add_to(all); });
  return all;
}

}  // namespace treeline::accel
