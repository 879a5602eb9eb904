// What a binary tree over triangles is worth, and what every builder of one checks and shares: the surface
// area heuristic (MacDonald and Booth 1990) with leaves tested a block at a time, the depth, and the split
// that is left where no other is.
#pragma once

#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "accel/batch.hpp"
#include "accel/bvh/binary_tree.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

inline void check(const BinaryBuildOptions& options, std::size_t triangles) {
  check_threads(options.threads);
  const auto need = [](bool right, const char* name, double value, const char* what) {
    if (!right)
      throw InvalidInput(std::string(name) + " is " + std::to_string(value) + "; it must be " + what);
  };
  need(options.block >= 1, "block", options.block, "at least 1");
  need(options.largest_leaf >= 1, "largest_leaf", options.largest_leaf, "at least 1");
  check_cost("node_cost", options.node_cost);
  if (triangles >= (std::size_t{1} << 30))
    throw InvalidInput(std::to_string(triangles) + " triangles; a binary tree takes 2^30 - 1 at most");
}

/// Of a leaf, in leaf tests.
inline std::size_t leaf_tests(std::size_t count, const BinaryBuildOptions& options) {
  const auto block = static_cast<std::size_t>(options.block);
  return (count + block - 1) / block;
}

/// Expected cost of a ray that meets the root's box, in leaf tests; 0 for a tree whose root has no area.
inline double sah_cost(const BinaryTree& tree, const BinaryBuildOptions& options) {
  if (tree.nodes.empty()) return 0;
  const auto area = [](const geometry::Box3f& b) {
    return surface_area(geometry::Box3d{geometry::Vec3d(b.low), geometry::Vec3d(b.high)});
  };
  const double whole = area(tree.nodes[0].box);
  if (!(whole > 0)) return 0;
  double cost = 0;
  for (const BinaryNode& node : tree.nodes)
    cost += area(node.box) *
            (node.count > 0 ? static_cast<double>(leaf_tests(node.count, options)) : options.node_cost);
  return cost / whole;
}

/// Edges from the root to the deepest leaf.
inline std::size_t binary_depth(const BinaryTree& tree) {
  std::size_t depth = 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> open;
  if (!tree.nodes.empty()) open.push_back({0, 0});
  while (!open.empty()) {
    const auto [i, level] = open.back();
    open.pop_back();
    depth = std::max(depth, level);
    const BinaryNode& node = tree.nodes[i];
    if (node.count == 0) open.push_back({node.first, level + 1}), open.push_back({node.first + 1, level + 1});
  }
  return depth;
}

/// How many of n references go left where they are cut by rank: half of them, in full leaves.
inline std::size_t rank_half(std::size_t n, const BinaryBuildOptions& options) {
  const auto unit = static_cast<std::size_t>(std::min(options.block, options.largest_leaf));
  const std::size_t units = (n + unit - 1) / unit;
  return std::min(n - 1, (units + 1) / 2 * unit);
}

/// Whether a node at this level over n references must be cut by rank, lest a leaf end too deep.
inline bool must_halve(std::size_t level, std::size_t n) {
  return level + static_cast<std::size_t>(std::bit_width(n - 1)) >= binary_max_depth;
}

}  // namespace treeline::accel
