// The nodes of a tree over rows, and its construction by a rule that says along what to split.
//
// An inner node orders its rows by a key (a coordinate, or the projection onto a direction) and cuts at the
// middle rank, so that n rows lie at most log2 n levels deep whatever is equal. It keeps both ends of the gap
// between its halves, for bounds, and its middle, for the order of the search. Halves are rounded to full
// leaves: with SIMD a full leaf costs little more than a half-full one.
#pragma once

#include <algorithm>
#include <vector>

#include "accel/rows/row_set.hpp"

namespace treeline::accel {

/// An inner node has its left child right behind it: keys there are <= left_end, those right >= right_start.
template <class T>
struct RowNode {
  T left_end, right_start;
  std::uint32_t split;           // inner: column, or number of the direction; leaf: first place
  std::uint32_t right;           // inner: right child; leaf: 0
  std::uint32_t count : 31;      // leaf: rows
  std::uint32_t coincident : 1;  // leaf: all rows are equal, and in order of id

  bool leaf() const { return right == 0; }
  std::uint32_t first() const { return split; }
  T middle() const { return left_end + (right_start - left_end) / T(2); }
};

template <class T>
struct RowTree {
  std::vector<RowNode<T>> nodes;
  AlignedScalars<T> directions;       // stride scalars each; of trees that cut across directions
  std::vector<std::uint32_t> places;  // of the leaves' rows; empty: a leaf holds places first, first + 1 …

  std::size_t bytes() const {
    return nodes.capacity() * sizeof(RowNode<T>) + directions.capacity() * sizeof(T) +
           places.capacity() * sizeof(std::uint32_t);
  }
};

/// How an inner node is cut.
struct RowCut {
  std::uint32_t split = 0;
  double overlap = 0;  // share of the node's rows that both halves get
};

/// Builds a RowTree. Rule: RowCut cut(places, tree, overlap allowed) chooses and may append to
/// tree.directions; T key(place, split, tree) is what rows are ordered by.
template <class T, class Rule>
class RowTreeBuilder {
 public:
  RowTreeBuilder(const RowSet<T>& set, Rule rule, int leaf_size, TreeStats& stats)
      : set_(set), rule_(std::move(rule)), leaf_size_(static_cast<std::size_t>(leaf_size)), stats_(stats) {}

  /// The finished tree lists its places; see own_leaves.
  RowTree<T> build() {
    const std::size_t n = set_.size();
    if (n == 0) return std::move(tree_);
    keyed_.resize(n);
    std::vector<std::uint32_t> all(n);
    for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<std::uint32_t>(i);
    tree_.nodes.reserve(4 * (n / leaf_size_) + 1);
    divide(all, 0, 1);
    tree_.nodes.shrink_to_fit(), tree_.directions.shrink_to_fit(), tree_.places.shrink_to_fit();
    return std::move(tree_);
  }

 private:
  struct Keyed {
    T key;
    std::uint32_t place;
  };
  /// Rows that the leaves may hold over all, in units of n.
  static constexpr double most_copies = 4;

  void divide(std::span<std::uint32_t> places, std::size_t depth, double copies) {
    const std::size_t count = places.size(), index = tree_.nodes.size();
    tree_.nodes.emplace_back();
    const bool small = count <= leaf_size_;
    if (all_equal(places)) return leaf(index, places, depth, true);
    if (small) return leaf(index, places, depth, false);

    const RowCut cut = rule_.cut(places, tree_, most_copies / copies - 1);
    for (std::size_t i = 0; i < count; ++i) keyed_[i] = {rule_.key(places[i], cut.split, tree_), places[i]};
    const auto less = [](const Keyed& a, const Keyed& b) { return a.key < b.key; };
    const std::size_t extra =
        std::min(static_cast<std::size_t>(cut.overlap / 2 * static_cast<double>(count)), count / 2 - 1);
    const std::size_t half = extra > 0 ? count / 2 : full_leaves(count);
    const auto begin = keyed_.begin(), end = begin + static_cast<std::ptrdiff_t>(count);
    const auto at = [&](std::size_t i) { return begin + static_cast<std::ptrdiff_t>(i); };
    // Left: ranks below half + extra. Right: ranks from half - extra.
    std::nth_element(begin, at(half + extra), end, less);
    const T left_end = std::max_element(begin, at(half + extra), less)->key;
    if (extra > 0) std::nth_element(begin, at(half - extra), at(half + extra), less);
    const T right_start = keyed_[half - extra].key;
    ++stats_.inner_nodes;
    const double more = copies * (1 + cut.overlap);
    if (extra == 0) {
      for (std::size_t i = 0; i < count; ++i) places[i] = keyed_[i].place;
      divide(places.first(half), depth + 1, copies);
      finish(index, cut.split, left_end, right_start);
      divide(places.subspan(half), depth + 1, copies);
    } else {
      std::vector<std::uint32_t> left(half + extra), right(count - half + extra);
      for (std::size_t i = 0; i < left.size(); ++i) left[i] = keyed_[i].place;
      for (std::size_t i = 0; i < right.size(); ++i) right[i] = keyed_[half - extra + i].place;
      divide(left, depth + 1, more);
      finish(index, cut.split, left_end, right_start);
      divide(right, depth + 1, more);
    }
  }

  void finish(std::size_t index, std::uint32_t split, T left_end, T right_start) {
    tree_.nodes[index] = {left_end, right_start, split, static_cast<std::uint32_t>(tree_.nodes.size()), 0, 0};
  }

  void leaf(std::size_t index, std::span<std::uint32_t> places, std::size_t depth, bool coincident) {
    std::sort(places.begin(), places.end());  // places are in order of id until own_leaves
    tree_.nodes[index] = {T(0),
                          T(0),
                          static_cast<std::uint32_t>(tree_.places.size()),
                          0,
                          static_cast<std::uint32_t>(places.size()),
                          coincident};
    tree_.places.insert(tree_.places.end(), places.begin(), places.end());
    ++stats_.leaves;
    stats_.depth = std::max(stats_.depth, depth);
    stats_.largest_leaf = std::max(stats_.largest_leaf, places.size());
    stats_.references += places.size();
  }

  bool all_equal(std::span<const std::uint32_t> places) const {
    const T* const first = set_.row(places[0]);
    return std::all_of(places.begin(), places.end(), [&](std::uint32_t place) {
      return std::equal(first, first + set_.columns, set_.row(place));
    });
  }

  /// About half of count, so that it fills whole leaves.
  std::size_t full_leaves(std::size_t count) const {
    const std::size_t half = (count / 2 + leaf_size_ / 2) / leaf_size_ * leaf_size_;
    return half > 0 && half < count ? half : count / 2;
  }

  const RowSet<T>& set_;
  Rule rule_;
  std::size_t leaf_size_;
  TreeStats& stats_;
  RowTree<T> tree_;
  std::vector<Keyed> keyed_;
};

/// Puts the rows in the order in which the leaves first hold them. Leaves of a tree that holds each row once
/// then are runs of rows, and need no places.
template <class T>
void own_leaves(RowSet<T>& set, std::span<RowTree<T>> trees) {
  if (trees.empty() || trees[0].places.empty()) return;
  std::vector<std::uint32_t> order, place_of(set.size(), no_id);
  order.reserve(set.size());
  for (const std::uint32_t place : trees[0].places) {
    if (place_of[place] != no_id) continue;
    place_of[place] = static_cast<std::uint32_t>(order.size());
    order.push_back(place);
  }
  for (RowTree<T>& tree : trees)
    for (std::uint32_t& place : tree.places) place = place_of[place];
  if (trees[0].places.size() == set.size()) trees[0].places = {};
  set.reorder(order);
}

}  // namespace treeline::accel
