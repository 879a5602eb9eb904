// Memory of the wide tree over triangles: nodes of eight child boxes and leaves of up to eight triangles,
// both coordinate by coordinate, so that one pass of vector instructions measures them all.
//
// Nodes and leaves lie in one array in depth-first order, a leaf close to the node above it; a reference
// counts lines of 64 bytes from its start and tells a leaf from a node by its lowest bit. 256 bytes a node,
// 320 a leaf. Absent children have boxes that no ray meets; absent triangles are all NaN.
#pragma once

#include "accel/bvh/wide_layout.hpp"
#include "accel/concepts.hpp"

namespace treeline::accel::wide {

inline constexpr int width = 8;  // children of a node, triangles of a leaf

struct alignas(64) RayNode {
  float plane[3][2][width];    // of each child: axis by axis, low and high
  std::uint32_t child[width];  // those most worth a visit of any-hit rays last; then absent ones
  std::uint32_t spare[width];
};

struct alignas(64) RayLeaf {
  float corner[3][3][width];  // of each triangle: a, b, c by axis
  Id id[width];               // ascending
};

/// Where a node or leaf lies, in lines.
using Ref = std::uint32_t;
inline constexpr std::size_t line = 64;
inline constexpr std::size_t node_lines = sizeof(RayNode) / line, leaf_lines = sizeof(RayLeaf) / line;
inline constexpr Ref no_ref = 0xffffffffu;

inline constexpr bool is_leaf(Ref ref) { return (ref & 1) != 0; }
inline constexpr Ref ref_to(std::size_t first_line, bool leaf) {
  return static_cast<Ref>(first_line * 2 + (leaf ? 1 : 0));
}

struct alignas(64) Line {
  unsigned char bytes[line];
};

inline const RayNode& node_at(const Line* lines, Ref ref) {
  return *reinterpret_cast<const RayNode*>(reinterpret_cast<const unsigned char*>(lines) +
                                           std::size_t{ref} * (line / 2));
}
inline const RayLeaf& leaf_at(const Line* lines, Ref ref) {
  return *reinterpret_cast<const RayLeaf*>(reinterpret_cast<const unsigned char*>(lines) +
                                           std::size_t{ref} * (line / 2) - line / 2);
}

/// No stack of waiting children grows beyond: seven a level, and room for a store of eight.
inline constexpr int ray_stack_size = 7 * 64 + width;

}  // namespace treeline::accel::wide
