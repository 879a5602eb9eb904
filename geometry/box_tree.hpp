// Which of many boxes meet something: a binary tree over them.
//
// Problem: all pairs of n boxes are n². Method: boxes are parted by rank at the middle of their centres,
// along the axis on which these are spread widest, down to four; what misses the box of a node misses all
// below it. For checks made once; trees that are asked more often are in accel. Cost: O(n log n) to build;
// O(log n) a query, and what it meets, where boxes are of about one size. Known weakness: a few boxes far
// larger than the others are in the way of everybody.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/box.hpp"

namespace treeline::geometry {

template <class T>
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Box<T, 3>>& boxes) {
    for (const auto& box : boxes) items_.push_back({box, static_cast<std::uint32_t>(items_.size())});
    if (items_.empty()) return;
    nodes_.reserve(items_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(items_.size()));
  }

  /// Around them all.
  Box<T, 3> box() const { return nodes_.empty() ? Box<T, 3>{} : nodes_[0].box; }

  /// Calls visit(number) for each box of which near(box) holds; it must hold of every box that contains such
  /// a one.
  template <class Near, class Visit>
  void each(Near&& near, Visit&& visit) const {
    if (nodes_.empty() || !near(nodes_[0].box)) return;
    std::array<std::uint32_t, most_open> open;
    std::size_t n = 0;
    open[n++] = 0;
    while (n > 0) {
      const Node& node = nodes_[open[--n]];
      if (node.count == 0) {
        for (const std::uint32_t child : {node.first, node.first + 1})
          if (near(nodes_[child].box)) open[n++] = child;
      } else {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          if (near(items_[i].box)) visit(items_[i].number);
      }
    }
  }

 private:
  static constexpr std::uint32_t leaf_size = 4;
  static constexpr std::size_t most_open = 40;  // ranks are halved: 32 levels, and one more node each

  struct Item {
    Box<T, 3> box;
    std::uint32_t number;
  };
  struct Node {
    Box<T, 3> box;
    std::uint32_t first = 0;  // inner: its children are nodes first and first + 1; leaf: its first item
    std::uint32_t count = 0;  // items of a leaf; 0 for an inner node
  };

  void build(std::uint32_t number, std::uint32_t begin, std::uint32_t end) {
    Box<T, 3> box, centres;
    for (std::uint32_t i = begin; i < end; ++i) box.grow(items_[i].box), centres.grow(items_[i].box.centre());
    nodes_[number].box = box;
    if (end - begin <= leaf_size) {
      nodes_[number].first = begin, nodes_[number].count = end - begin;
      return;
    }
    const int axis = centres.widest_axis();
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::uint32_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](const Item& a, const Item& b) {
      const T x = a.box.centre()[axis], y = b.box.centre()[axis];
      return x < y || (x == y && a.number < b.number);
    });
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[number].first = first;
    nodes_.resize(nodes_.size() + 2);
    build(first, begin, middle), build(first + 1, middle, end);
  }

  std::vector<Item> items_;  // leaf by leaf
  std::vector<Node> nodes_;  // the root first
};

}  // namespace treeline::geometry
