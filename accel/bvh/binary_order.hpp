// From the nodes that a builder makes in whatever order to the plain binary tree: depth first, so that a
// subtree's nodes and references lie together and the result does not depend on which thread made what.
//
// Cost: one pass, O(n). Where merging or moving subtrees has made a path too long, the subtrees on it that
// no longer fit above the limit are cut by rank.
#pragma once

#include <memory>

#include "accel/bvh/binary_cost.hpp"
#include "accel/simd/packed_box.hpp"

namespace treeline::accel {

/// A node as builders keep it: the box, and in its tags the two children of an inner node, or the first
/// reference of a leaf and their number with the top bit set.
using LinkedNode = simd::BoxLanes;

inline constexpr std::uint32_t leaf_bit = 0x80000000u;

inline bool is_leaf(const LinkedNode& node) { return (node.tag(1) & leaf_bit) != 0; }
inline void make_leaf(LinkedNode& node, std::size_t first, std::size_t count) {
  node.set_tag(0, static_cast<std::uint32_t>(first));
  node.set_tag(1, static_cast<std::uint32_t>(count) | leaf_bit);
}
inline void make_inner(LinkedNode& node, std::uint32_t left, std::uint32_t right) {
  node.set_tag(0, left), node.set_tag(1, right);
}

inline simd::PackedBox box_of(const simd::BoxLanes* boxes, std::size_t n) {
  auto box = simd::PackedBox::empty();
  for (std::size_t i = 0; i < n; ++i) box = merged(box, simd::PackedBox::load(boxes[i]));
  return box;
}

/// A power of two by which to multiply a box's sides, so that areas within it neither vanish nor overflow.
inline float area_scale(const simd::BoxLanes& box) {
  float widest = 0;
  for (int axis = 0; axis < 3; ++axis)
    widest = std::max(widest, box.high(axis) * 0.5f - box.low(axis) * 0.5f);
  return widest > 0 ? std::ldexp(1.0f, std::clamp(-std::ilogb(widest), -126, 126)) : 1.0f;
}

/// Rebuilds in halves what lies too deep. The tree is in depth-first order.
inline void limit_depth(BinaryTree& tree) {
  const std::vector<BinaryNode>& old = tree.nodes;
  std::vector<std::uint32_t> leaves(old.size(), 1);  // below each node
  for (std::size_t i = old.size(); i-- > 0;)
    if (old[i].count == 0) leaves[i] = leaves[old[i].first] + leaves[old[i].first + 1];
  struct Open {
    std::uint32_t from, to;       // numbers of an old and a new node
    std::size_t level, leaf = 0;  // or of the first of `count` leaves to be halved
    std::size_t count = 0;
  };
  std::vector<BinaryNode> nodes(1);
  nodes.reserve(old.size());
  std::vector<BinaryNode> halved;
  std::vector<Open> open{{0, 0, 0}};
  while (!open.empty()) {
    Open top = open.back();
    open.pop_back();
    if (top.count == 0) {
      const BinaryNode& node = old[top.from];
      nodes[top.to] = node;
      if (node.count > 0) continue;
      const std::size_t m = leaves[top.from];
      if (top.level + 1 + static_cast<std::size_t>(std::bit_width(m - 1)) <= binary_max_depth) {
        const auto pair = static_cast<std::uint32_t>(nodes.size());
        nodes[top.to].first = pair;
        nodes.resize(nodes.size() + 2);
        open.push_back({node.first + 1, pair + 1, top.level + 1});
        open.push_back({node.first, pair, top.level + 1});
        continue;
      }
      // Its leaves, in order of their references.
      top.leaf = halved.size(), top.count = m;
      std::vector<std::uint32_t> below{top.from};
      while (!below.empty()) {
        const BinaryNode& n = old[below.back()];
        below.pop_back();
        if (n.count > 0)
          halved.push_back(n);
        else
          below.push_back(n.first + 1), below.push_back(n.first);
      }
    }
    if (top.count == 1) {
      nodes[top.to] = halved[top.leaf];
      continue;
    }
    geometry::Box3f box;
    for (std::size_t i = 0; i < top.count; ++i) box.grow(halved[top.leaf + i].box);
    const auto pair = static_cast<std::uint32_t>(nodes.size());
    nodes[top.to] = {box, pair, 0};
    nodes.resize(nodes.size() + 2);
    const std::size_t left = (top.count + 1) / 2;
    open.push_back({0, pair + 1, top.level + 1, top.leaf + left, top.count - left});
    open.push_back({0, pair, top.level + 1, top.leaf, left});
  }
  tree.nodes = std::move(nodes);
}

/// The tree below `root`. A node for which closed(number) holds becomes a leaf, whatever lies below it;
/// id(position) is the triangle of a reference.
template <class Closed, class IdOf>
BinaryTree ordered(const LinkedNode* linked, std::uint32_t root, std::size_t nodes, std::size_t references,
                   Closed&& closed, IdOf&& id) {
  BinaryTree tree;
  tree.nodes.reserve(nodes), tree.references.reserve(references);
  struct Open {
    std::uint32_t from, to, level;
  };
  std::vector<Open> open{{root, 0, 0}};
  std::vector<std::uint32_t> below;
  std::size_t depth = 0;
  tree.nodes.resize(1);
  while (!open.empty()) {
    const auto [from, to, level] = open.back();
    open.pop_back();
    const LinkedNode& node = linked[from];
    depth = std::max<std::size_t>(depth, level);
    if (!is_leaf(node) && !closed(from)) {
      const auto pair = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes[to] = {node.box(), pair, 0};
      tree.nodes.resize(tree.nodes.size() + 2);
      open.push_back({node.tag(1), pair + 1, level + 1}), open.push_back({node.tag(0), pair, level + 1});
      continue;
    }
    const std::size_t first = tree.references.size();
    below.push_back(from);
    while (!below.empty()) {
      const LinkedNode& n = linked[below.back()];
      below.pop_back();
      if (is_leaf(n)) {
        for (std::uint32_t i = 0; i < (n.tag(1) & ~leaf_bit); ++i)
          tree.references.push_back(id(n.tag(0) + i));
      } else {
        below.push_back(n.tag(1)), below.push_back(n.tag(0));
      }
    }
    tree.nodes[to] = {node.box(), static_cast<std::uint32_t>(first),
                      static_cast<std::uint32_t>(tree.references.size() - first)};
  }
  if (depth > binary_max_depth) limit_depth(tree);
  return tree;
}

template <class IdOf>
BinaryTree ordered(const LinkedNode* linked, std::uint32_t root, std::size_t nodes, std::size_t references,
                   IdOf&& id) {
  return ordered(
      linked, root, nodes, references, [](std::uint32_t) { return false; }, id);
}

}  // namespace treeline::accel
