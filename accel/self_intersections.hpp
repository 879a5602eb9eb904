// Which faces of a mesh run through each other, decided exactly.
//
// Problem: inside and outside have no meaning where a surface crosses itself, and files do not tell. Method:
// a binary BVH over the faces of each class of sizes; each face asks those of its own and of smaller ones for
// faces whose boxes meet its own, are not on one side of its plane and not beside it; the exact predicate
// decides (geometry/exact/triangle_triangle.hpp has its convention: faces that share corners or an edge cross
// only where they meet beyond those). Cost: O(n log n) and the pairs of boxes that overlap, some ten a face
// on a surface. Known weakness: n faces on one spot are n² pairs; of equal faces, ask about one.
#pragma once

#include <mutex>
#include <numeric>
#include <optional>

#include "accel/batch.hpp"
#include "accel/bvh/build_triangles.hpp"
#include "geometry/exact/triangle_triangle.hpp"

namespace treeline::accel {

struct SelfIntersectionOptions {
  std::size_t kept = 10;  ///< pairs listed, those of lowest numbers; all are counted
  int threads = 1;
};

struct SelfIntersections {
  using Pair = std::array<std::uint32_t, 2>;  // numbers of faces, the lower first

  std::size_t count = 0;     ///< pairs
  std::vector<Pair> pairs;   ///< in ascending order
  std::size_t examined = 0;  ///< pairs whose boxes meet
};

namespace detail {

/// Whether a box lies on one side of a triangle's plane for certain: large slanting triangles meet the boxes
/// of many that are nowhere near.
class FarFromPlane {
 public:
  explicit FarFromPlane(const geometry::Triangle3f& t) : origin_(t.a) {
    const geometry::Vec3d p = geometry::Vec3d(t.b) - origin_, q = geometry::Vec3d(t.c) - origin_;
    for (int k = 0; k < 3; ++k) {
      const double m = p[(k + 1) % 3] * q[(k + 2) % 3], n = p[(k + 2) % 3] * q[(k + 1) % 3];
      normal_[k] = m - n, slack_[k] = error * (std::abs(m) + std::abs(n));
    }
  }
  bool operator()(const geometry::Box3f& box) const {
    double centre = 0, reach = 0;
    for (int k = 0; k < 3; ++k) {
      const double low = double(box.low[k]) - origin_[k], high = double(box.high[k]) - origin_[k];
      const double c = 0.5 * (low + high), h = 0.5 * (high - low);
      centre += normal_[k] * c;
      reach += std::abs(normal_[k]) * h + slack_[k] * (std::abs(c) + h);
    }
    return std::abs(centre) > reach;
  }

 private:
  // Roundings of a term: 4 of the normal (whose size, in the end, is the sum of its two products), 3 of the
  // box, 4 of the sums. Products of three differences of floats stay in the range of double.
  static constexpr double error = 32 * 0x1p-53;

  geometry::Vec3d origin_, normal_, slack_;
};

/// Whether a box lies beside a triangle for certain, seen along an axis: long thin triangles across the axes
/// have large boxes that they hardly fill, and planes that say nothing of where in them they lie. The other
/// nine axes of the test by separating axes (Akenine-Moller 2001).
class FarFromEdges {
 public:
  explicit FarFromEdges(const geometry::Triangle3f& t) : origin_(t.a) {
    const geometry::Vec3d corner[3] = {{}, geometry::Vec3d(t.b) - origin_, geometry::Vec3d(t.c) - origin_};
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < 3; ++i) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Side& s = side_[axis][i];
        const geometry::Vec3d &from = corner[i], along = corner[(i + 1) % 3] - from,
                              across = corner[(i + 2) % 3] - from;
        s.u = along[v], s.v = -along[u];
        const double start = s.u * from[u] + s.v * from[v], width = s.u * across[u] + s.v * across[v];
        s.least = start + std::min(width, 0.0), s.most = start + std::max(width, 0.0);
        s.slack = error * (std::abs(s.u) * (std::abs(from[u]) + std::abs(across[u])) +
                           std::abs(s.v) * (std::abs(from[v]) + std::abs(across[v])));
      }
  }
  bool operator()(const geometry::Box3f& box) const {
    double centre[3], half[3];
    for (int k = 0; k < 3; ++k) {
      const double low = double(box.low[k]) - origin_[k], high = double(box.high[k]) - origin_[k];
      centre[k] = 0.5 * (low + high), half[k] = 0.5 * (high - low);
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const Side& s : side_[axis]) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double middle = s.u * centre[u] + s.v * centre[v];
        const double reach = std::abs(s.u) * half[u] + std::abs(s.v) * half[v];
        const double slack = s.slack + error * (std::abs(s.u) * (std::abs(centre[u]) + half[u]) +
                                                std::abs(s.v) * (std::abs(centre[v]) + half[v]));
        if (middle - reach > s.most + slack || middle + reach < s.least - slack) return true;
      }
    return false;
  }

 private:
  /// Across an edge, in the plane of the other two axes: where the triangle lies.
  struct Side {
    double u, v, least, most, slack;
  };
  // Roundings of a term: 3 of the edge, 3 of the corner or box, 5 of the product and the sums.
  static constexpr double error = 32 * 0x1p-53;

  geometry::Vec3d origin_;
  Side side_[3][3];
};

/// A tree over triangles of about the same size.
class SizeClass {
 public:
  SizeClass(const std::vector<geometry::Triangle3f>& all, std::span<const std::uint32_t> members)
      : members_(members),
        triangles_(gathered(all, members)),
        set_(std::span<const geometry::Triangle3f>(triangles_), options()),
        tree_(exact(set_, triangles_), options()) {}

  /// Calls visit(number) for each that may meet a triangle.
  template <class Visit>
  void each_near(const geometry::Triangle3f& t, const Visit& visit) const {
    const geometry::Box3f box = t.box();
    const FarFromPlane far_from_plane(t);
    std::optional<FarFromEdges> far_from_edges;  // where there is much to keep away from
    const auto near = [&](const geometry::Box3f& other) {
      return box.overlaps(other) && !far_from_plane(other) && !(far_from_edges && (*far_from_edges)(other));
    };
    constexpr int many = 64;
    int visited = 0;
    std::array<std::uint32_t, bvh_max_depth + 1> open;
    std::size_t n = 0;
    const auto enter = [&](const BvhChild<float>& child) {
      if (!near(child.box())) return;
      if (child.count == 0) {
        open[n++] = child.first;
        return;
      }
      for (std::size_t j = child.first; j < child.first + child.count; ++j)
        if (near(set_.items[j].triangle.box())) visit(members_[set_.items[j].id]);
    };
    enter(tree_.root);
    while (n > 0) {
      const BvhNode<float>& node = tree_.nodes[open[--n]];
      if (++visited == many) far_from_edges.emplace(t);
      enter(node.child[0]), enter(node.child[1]);
    }
  }

 private:
  static BvhTriangleOptions options() {
    BvhTriangleOptions r;
    r.leaf_size = 4;
    return r;
  }
  static std::vector<geometry::Triangle3f> gathered(const std::vector<geometry::Triangle3f>& all,
                                                    std::span<const std::uint32_t> members) {
    std::vector<geometry::Triangle3f> r;
    r.reserve(members.size());
    for (const std::uint32_t i : members) r.push_back(all[i]);
    return r;
  }
  /// As given, not scaled.
  static TriangleSet<float>& exact(TriangleSet<float>& set,
                                   const std::vector<geometry::Triangle3f>& triangles) {
    for (auto& item : set.items) item.triangle = triangles[item.id];
    return set;
  }

  std::span<const std::uint32_t> members_;
  std::vector<geometry::Triangle3f> triangles_;
  TriangleSet<float> set_;
  BvhBuilder<float> tree_;
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
  std::vector<geometry::Triangle3f> triangles(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) triangles[i] = mesh.triangle(faces[i]);
  // The larger of two asks: its plane tells it more. Sizes in powers of two.
  std::vector<int> size(triangles.size());
  for (std::size_t i = 0; i < size.size(); ++i) {
    const geometry::Vec3f sides = triangles[i].box().extent();
    size[i] = std::ilogb(sides[0] + sides[1] + sides[2]);
  }
  // A tree for each class of sizes: boxes of the largest are in the way of all others. The classes one by
  // one.
  constexpr int classes = 3;  // sizes in each: a factor of eight
  const auto class_of = [&](std::uint32_t i) { return size[i] / classes - (size[i] % classes < 0); };
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, class_of);
  SelfIntersections all;
  std::mutex mutex;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && class_of(order[last]) == class_of(order[first])) ++last;
    const std::span members = std::span(order).subspan(first, last - first);
    const detail::SizeClass asked(triangles, members);
    const std::span asking = std::span(order).subspan(first);  // as large, or larger
    parallel_ranges(asking.size(), options.threads, [&](std::size_t begin, std::size_t end) {
      SelfIntersections mine;
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t i = asking[k];
        asked.each_near(triangles[i], [&](std::uint32_t j) {
          if (size[j] > size[i] || (size[j] == size[i] && j <= i)) return;  // that one asks
          ++mine.examined;
          if (!cross_each_other(triangles[i], triangles[j])) return;
          ++mine.count;
          mine.pairs.push_back({std::min(faces[i], faces[j]), std::max(faces[i], faces[j])});
        });
        if (mine.pairs.size() > 2 * options.kept + 64) {
          std::ranges::sort(mine.pairs);
          mine.pairs.resize(options.kept);
        }
      }
      const std::lock_guard lock(mutex);
      all.count += mine.count, all.examined += mine.examined;
      all.pairs.insert(all.pairs.end(), mine.pairs.begin(), mine.pairs.end());
      std::ranges::sort(all.pairs);
      if (all.pairs.size() > options.kept) all.pairs.resize(options.kept);
    });
  }
  return all;
}

}  // namespace treeline::accel
