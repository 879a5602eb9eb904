// A subtree in the making: what the builders of KD and BSP trees over triangles hand to each other.
//
// Problem: nodes and references stand in one array each, a node's first child right behind it, so two threads
// cannot write them at once. Method: subtrees of many triangles are built apart and appended, their links
// moved by what was there before. Whether a subtree is one of these depends on its triangles alone, so the
// tree does not depend on the threads. Cost: a subtree is copied once for each level above it, some 1 % of
// the build.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "accel/concepts.hpp"

namespace treeline::accel {

/// Of a Node: leaf(), and link, which names a node, or in leaves the first reference.
template <class Node>
struct TriangleBranch {
  std::vector<Node> nodes;
  std::vector<std::uint32_t> references;  // indices into the set's items
  std::size_t leaves = 0, oblique_nodes = 0, depth = 0, largest_leaf = 0;
  double cost = 0;

  void append(TriangleBranch&& other) {
    if (references.size() + other.references.size() > 0xffffffffu)
      throw InvalidInput("more than 2^32 references; lower max_references");
    const auto nodes_before = static_cast<std::uint32_t>(nodes.size());
    const auto references_before = static_cast<std::uint32_t>(references.size());
    for (Node node : other.nodes) {
      node.link += node.leaf() ? references_before : nodes_before;
      nodes.push_back(node);
    }
    references.insert(references.end(), other.references.begin(), other.references.end());
    leaves += other.leaves, oblique_nodes += other.oblique_nodes, cost += other.cost;
    depth = std::max(depth, other.depth), largest_leaf = std::max(largest_leaf, other.largest_leaf);
    other = {};
  }
};

}  // namespace treeline::accel
