// Builder of a binary BVH over triangles: binned surface area heuristic (Wald 2007, "On fast construction of
// SAH-based bounding volume hierarchies").
//
// Each node tries planes between bins of centroids on every axis and takes the cheapest split; where none is
// better than a leaf, and the leaf is not too big, it stops. Centroids that coincide, areas that overflow,
// and nodes near the depth limit are split by rank in half, so the depth is bounded whatever the input. Cost:
// O(n log n).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "accel/triangle_set.hpp"

namespace treeline::accel {

struct BvhTriangleOptions : BuildOptions {
  int bins = 16;  ///< candidate planes per axis and node, and one
};

/// A child as its parent holds it: 32 bytes for float.
template <class T>
struct BvhChild {
  geometry::Vec<T, 3> corner[2];  ///< low and high corner of its box
  std::uint32_t first = 0;        ///< inner: index of its node; leaf: its first triangle
  std::uint32_t count = 0;        ///< triangles of a leaf; 0 for an inner node

  geometry::Box<T, 3> box() const { return {corner[0], corner[1]}; }
};

template <class T>
struct alignas(sizeof(T) == 4 ? 64 : 16) BvhNode {
  BvhChild<T> child[2];
};

/// No root-to-leaf path is longer; traversal stacks have this size.
inline constexpr std::size_t bvh_max_depth = 64;

template <class T>
class BvhBuilder {
 public:
  /// Reorders the set's items into leaf order.
  BvhBuilder(TriangleSet<T>& set, const BvhTriangleOptions& options)
      : leaf_size_(static_cast<std::size_t>(options.leaf_size)), bins_(options.bins) {
    if (bins_ < 2 || bins_ > max_bins)
      throw InvalidInput("bins is " + std::to_string(bins_) + "; it must be in [2, " +
                         std::to_string(max_bins) + "]");
    const std::size_t n = set.items.size();
    if (n == 0) return;
    refs_.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      refs_[i] = {set.items[i].triangle.box(), static_cast<std::uint32_t>(i)};
    nodes.reserve(n / 2);
    root = build(0, n, 0);
    nodes.shrink_to_fit();
    std::vector<StoredTriangle<T>> ordered(n);
    for (std::size_t i = 0; i < n; ++i) ordered[i] = set.items[refs_[i].index];
    set.items = std::move(ordered);
  }

  BvhChild<T> root;
  std::vector<BvhNode<T>> nodes;
  std::size_t leaves = 0, depth = 0, largest_leaf = 0;

 private:
  using Box = geometry::Box<T, 3>;
  using Point = geometry::Vec<T, 3>;
  static constexpr int max_bins = 64;
  static constexpr double step_cost = 5;  // of a node, in triangle tests, which go eight at a time

  struct Ref {
    Box box;
    std::uint32_t index;
  };
  struct Bin {
    Box box;
    std::size_t count = 0;
  };
  struct Split {
    double cost = std::numeric_limits<double>::infinity();  // times the area of the node
    int axis = -1, bin = 0;
  };
  /// Which bin a centroid falls into, by the same arithmetic wherever asked.
  struct Binning {
    T low, scale;
    int last;
    int operator()(T centre) const { return std::min(last, static_cast<int>((centre - low) * scale)); }
  };

  static double area(const Box& box) {
    return box.empty()
               ? 0
               : surface_area(geometry::Box<double, 3>{geometry::Vec3d(box.low), geometry::Vec3d(box.high)});
  }
  static T centre(const Ref& ref, int axis) {
    return ref.box.low[axis] * T(0.5) + ref.box.high[axis] * T(0.5);
  }

  BvhChild<T> build(std::size_t begin, std::size_t end, std::size_t level) {
    BvhChild<T> made;
    Box box, centres;
    for (std::size_t i = begin; i < end; ++i) {
      box.grow(refs_[i].box);
      centres.grow(refs_[i].box.centre());
    }
    const std::size_t n = end - begin, middle = split(begin, end, box, centres, level);
    made.corner[0] = box.low, made.corner[1] = box.high;
    if (middle == begin) {
      made.first = static_cast<std::uint32_t>(begin);
      made.count = static_cast<std::uint32_t>(n);
      ++leaves;
      depth = std::max(depth, level);
      largest_leaf = std::max(largest_leaf, n);
      return made;
    }
    made.first = static_cast<std::uint32_t>(nodes.size());
    nodes.emplace_back();
    const BvhChild<T> left = build(begin, middle, level + 1), right = build(middle, end, level + 1);
    nodes[made.first] = {{left, right}};
    return made;
  }

  /// Partitions [begin, end) and returns the border; begin for a leaf.
  std::size_t split(std::size_t begin, std::size_t end, const Box& box, const Box& centres,
                    std::size_t level) {
    const std::size_t n = end - begin;
    if (n == 1) return begin;
    const std::size_t levels_by_rank = static_cast<std::size_t>(std::bit_width(n - 1));
    if (level + levels_by_rank < bvh_max_depth) {
      const Split best = best_split(begin, end, centres);
      const double leaf_cost = static_cast<double>(n) * area(box);
      if (n <= leaf_size_ && !(best.cost + step_cost * area(box) < leaf_cost)) return begin;
      if (best.axis >= 0) {
        const Binning bin = binning(centres, best.axis);
        const auto middle =
            std::partition(refs_.begin() + std::ptrdiff_t(begin), refs_.begin() + std::ptrdiff_t(end),
                           [&](const Ref& r) { return bin(centre(r, best.axis)) <= best.bin; });
        const auto border = static_cast<std::size_t>(middle - refs_.begin());
        if (begin < border && border < end) return border;
      }
    }
    if (n <= leaf_size_) return begin;
    const std::size_t middle = begin + n / 2;
    const int axis = centres.widest_axis();
    std::nth_element(refs_.begin() + std::ptrdiff_t(begin), refs_.begin() + std::ptrdiff_t(middle),
                     refs_.begin() + std::ptrdiff_t(end), [&](const Ref& a, const Ref& b) {
                       const T ca = centre(a, axis), cb = centre(b, axis);
                       return ca < cb || (ca == cb && a.index < b.index);
                     });
    return middle;
  }

  Binning binning(const Box& centres, int axis) const {
    const T extent = centres.high[axis] - centres.low[axis];
    return {centres.low[axis], static_cast<T>(bins_) / extent, bins_ - 1};
  }

  Split best_split(std::size_t begin, std::size_t end, const Box& centres) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const Binning bin = binning(centres, axis);
      if (!std::isfinite(bin.scale) || !(bin.scale > T(0))) continue;
      std::array<Bin, max_bins> bins;
      for (std::size_t i = begin; i < end; ++i) {
        Bin& b = bins[static_cast<std::size_t>(bin(centre(refs_[i], axis)))];
        b.box.grow(refs_[i].box);
        ++b.count;
      }
      std::array<double, max_bins> right_cost;
      Bin right;
      for (int i = bins_ - 1; i > 0; --i) {
        right.box.grow(bins[i].box), right.count += bins[i].count;
        right_cost[i] = area(right.box) * static_cast<double>(right.count);
      }
      Bin left;
      for (int i = 0; i + 1 < bins_; ++i) {
        left.box.grow(bins[i].box), left.count += bins[i].count;
        if (left.count == 0 || left.count == end - begin) continue;
        const double cost = area(left.box) * static_cast<double>(left.count) + right_cost[i + 1];
        if (cost < best.cost) best = {cost, axis, i};
      }
    }
    return best;
  }

  std::size_t leaf_size_;
  int bins_;
  std::vector<Ref> refs_;
};

}  // namespace treeline::accel
