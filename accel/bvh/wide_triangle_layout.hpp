// Memory of the wide tree over triangles: nodes of 4, 8 or 16 child boxes and leaves of up to 4 or 8
// triangles, both coordinate by coordinate, so that one pass of vector instructions measures them all.
//
// Nodes and leaves lie in one array in depth-first order, a leaf close to the node above it; a reference
// counts lines of 64 bytes from its start and tells a leaf from a node by its lowest bit. With eight of both,
// 256 bytes a node, 320 a leaf. Absent children have boxes that no ray meets; in place of absent triangles
// the last one is there again.
#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <span>

#include "accel/bvh/wide_layout.hpp"
#include "accel/concepts.hpp"
#include "accel/simd/sorted_lanes.hpp"

namespace treeline::accel::wide {

template <int N>
struct alignas(64) RayNode {
  float plane[3][2][N];    // of each child: axis by axis, low and high
  std::uint32_t child[N];  // those most worth a visit of any-hit rays last; then absent ones
};

template <int N>
struct alignas(64) RayLeaf {
  float corner[3][3][N];  // of each triangle: a, b, c by axis
  Id id[N];               // ascending
};

/// Where a node or leaf lies: twice the number of steps from the start, and one for a leaf.
using Ref = std::uint32_t;
inline constexpr Ref no_ref = 0xffffffffu;

inline constexpr bool is_leaf(Ref ref) { return (ref & 1) != 0; }
inline constexpr Ref ref_to(std::size_t step, bool leaf) {
  return static_cast<Ref>(step * 2 + (leaf ? 1 : 0));
}

inline constexpr std::size_t line = 64;
struct alignas(64) Line {
  unsigned char bytes[line];
};

/// What a node is made from: boxes and places of its children, in order of `RayNode::child`.
struct NodeParts {
  std::span<const geometry::Box<float, 3>> boxes;
  std::span<const Ref> children;
};

template <int Width, int LeafSize>
struct PlainLayout {
  static_assert((Width == 4 || Width == 8 || Width == 16) && (LeafSize == 4 || LeafSize == 8));
  static constexpr int width = Width;         // children of a node
  static constexpr int leaf_size = LeafSize;  // triangles of a leaf
  static constexpr std::size_t step = line;   // bytes that references count in
  static constexpr std::uint32_t plane_bytes = Width * sizeof(float);
  static constexpr std::size_t asked_lines = sizeof(RayNode<Width>) / line;  // ahead of a visit
  static constexpr bool families = false;                                    // a subtree is in one piece
  static constexpr std::size_t overrun = 0;  // bytes that reading may pass the end by
  using Node = RayNode<Width>;
  using Leaf = RayLeaf<LeafSize>;

  static int count(const Node& node) {
    return static_cast<int>(std::find(node.child, node.child + Width, no_ref) - node.child);
  }
  static Ref child(const Node& node, std::uint32_t lane) { return node.child[lane]; }
  static const std::uint32_t (&children(const Node& node))[Width] { return node.child; }
  static const Leaf& triangles(const Leaf& leaf) { return leaf; }
  static geometry::Box<float, 3> box(const Node& node, int i) {
    geometry::Box<float, 3> b;
    for (int k = 0; k < 3; ++k) b.low[k] = node.plane[k][0][i], b.high[k] = node.plane[k][1][i];
    return b;
  }

  static constexpr std::size_t node_steps = sizeof(Node) / step;
  static std::size_t leaf_steps(const Leaf& /*triangles*/, std::uint32_t /*count*/) {
    return sizeof(Leaf) / step;
  }
  static void write(Node& node, const NodeParts& parts) {
    for (int i = 0; i < width; ++i) {
      const bool present = static_cast<std::size_t>(i) < parts.boxes.size();
      set_box(node, i, present ? parts.boxes[static_cast<std::size_t>(i)] : geometry::Box<float, 3>{});
      node.child[i] = present ? parts.children[static_cast<std::size_t>(i)] : no_ref;
    }
    // Nothing is left as it was: equal trees are equal bytes.
    auto* const bytes = reinterpret_cast<unsigned char*>(&node);
    std::fill(bytes + offsetof(Node, child) + sizeof node.child, bytes + sizeof node, 0);
  }
  static void set_box(Node& node, int i, const geometry::Box<float, 3>& box) {
    for (int k = 0; k < 3; ++k) node.plane[k][0][i] = box.low[k], node.plane[k][1][i] = box.high[k];
  }
  static void write(Leaf& leaf, const Leaf& triangles, std::uint32_t /*count*/) { leaf = triangles; }
};

/// Which of the layouts a tree has: layouts of other names specialise it.
template <class Name>
struct LayoutOf;
template <>
struct LayoutOf<Wide> {
  using Type = PlainLayout<8, 8>;
};
template <int Children, int LeafSize>
struct LayoutOf<WideOf<Children, LeafSize>> {
  using Type = PlainLayout<Children, LeafSize>;
};
template <class Name>
concept TriangleLayout = requires {
  typename LayoutOf<Name>::Type;
};

template <class Layout>
const unsigned char* at(const Line* lines, Ref ref) {
  return reinterpret_cast<const unsigned char*>(lines) + std::size_t{ref} * (Layout::step / 2);
}
template <class Layout>
const typename Layout::Node& node_at(const Line* lines, Ref ref) {
  return *reinterpret_cast<const typename Layout::Node*>(at<Layout>(lines, ref));
}
template <class Layout>
const typename Layout::Leaf& leaf_at(const Line* lines, Ref ref) {
  return *reinterpret_cast<const typename Layout::Leaf*>(at<Layout>(lines, ref) - Layout::step / 2);
}
/// Asks for the lines of a node or leaf.
template <class Layout>
void prefetch(const Line* lines, Ref ref) {
  const unsigned char* const p = at<Layout>(lines, ref & ~1u);
  for (std::size_t i = 0; i < Layout::asked_lines; ++i) __builtin_prefetch(p + i * line);
}

/// No stack of waiting children grows beyond: all but one a level, and room for a store of all.
template <class Layout>
inline constexpr int ray_stack_size = (Layout::width - 1) * 64 + Layout::width;

}  // namespace treeline::accel::wide
