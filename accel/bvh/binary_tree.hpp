// What builders of bounding volume hierarchies over triangles leave behind, and what layouts are made from: a
// plain binary tree over references to triangles.
//
// Every builder (binned, sweep, spatial splits, Morton order) fills this one form and every optimiser
// improves it, so that any of them can be combined with any layout of nodes and leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/box.hpp"

namespace treeline::accel {

struct BinaryNode {
  geometry::Box<float, 3> box;
  std::uint32_t first = 0;  ///< inner: its children are nodes first and first + 1; leaf: its first reference
  std::uint32_t count = 0;  ///< references of a leaf; 0 for an inner node
};

struct BinaryTree {
  std::vector<BinaryNode> nodes;          ///< the root first; empty if there are no triangles
  std::vector<std::uint32_t> references;  ///< numbers of triangles, leaf by leaf; spatial splits repeat some
};

/// What all builders ask.
struct BinaryBuildOptions {
  int block = 8;         ///< triangles that one leaf test takes at once; a leaf of n costs ceil(n / block)
  int largest_leaf = 8;  ///< triangles in a leaf at most, however they lie
  double node_cost = 1;  ///< of a step through a binary node, in leaf tests
  int threads = 1;       ///< that build; the tree does not depend on it
};

/// No leaf lies deeper, whatever the input.
inline constexpr std::size_t binary_max_depth = 64;

}  // namespace treeline::accel
