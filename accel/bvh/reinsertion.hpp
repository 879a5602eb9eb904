// Makes a binary tree cheaper by moving subtrees to where they cost least (Bittner, Hapala and Havran 2013;
// searched for all at once, as Meister and Bittner 2018).
//
// A pass takes the nodes with the largest boxes. For each it searches the tree, outward from where the node
// is, for the node beside which it would do best: what the boxes above it would shrink by if it left, less
// what those above its new place would grow by; a subtree is left out where even growing by nothing could
// not beat the best so far. The searches change nothing and run on any number of threads. The moves are then
// made in order of their promise, one after the other; as each changes what others were promised, it is kept
// only if the whole tree became cheaper, so no pass ever makes it worse. Cost: O(n) nodes a pass, some
// hundred steps each. Known weakness: leaves stay as they are; a tree of small leaves gains more, and what
// already is the best of a full sweep little.
#pragma once

#include "accel/bvh/binary_order.hpp"
#include "accel/bvh/build_tasks.hpp"

namespace treeline::accel {

struct ReinsertionOptions {
  int passes = 3;
  double share = 0.25;      ///< of the nodes, the largest first, that a pass tries to move
  std::size_t steps = 512;  ///< of one search at most
  int threads = 1;          ///< that search; the tree does not depend on it
};

class Reinsertion {
 public:
  Reinsertion(const BinaryTree& tree, const ReinsertionOptions& options)
      : tree_(tree), options_(options), tasks_(options.threads) {
    check_threads(options.threads);
    if (options.passes < 0) throw InvalidInput("passes is " + std::to_string(options.passes));
    if (!(options.share > 0 && options.share <= 1))
      throw InvalidInput("share is " + std::to_string(options.share) + "; it must be in (0, 1]");
  }

  BinaryTree build() {
    const std::size_t n = tree_.nodes.size();
    nodes_.resize(n), area_.resize(n), parent_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const BinaryNode& node = tree_.nodes[i];
      nodes_[i] = simd::packed(node.box);
      if (node.count > 0) {
        make_leaf(nodes_[i], node.first, node.count);
      } else {
        make_inner(nodes_[i], node.first, node.first + 1);
        parent_[node.first] = parent_[node.first + 1] = static_cast<std::uint32_t>(i);
      }
    }
    scale_ = area_scale(nodes_[0]);
    for (std::size_t i = 0; i < n; ++i) area_[i] = PackedBox::load(nodes_[i]).half_area(scale_);
    tasks_.run([&] {
      for (int pass = 0; pass < options_.passes; ++pass)
        if (!improve()) break;
    });
    return ordered(nodes_.data(), 0, n, tree_.references.size(),
                   [&](std::size_t i) { return tree_.references[i]; });
  }

 private:
  using PackedBox = simd::PackedBox;

  struct Move {
    float gain = 0;
    std::uint32_t from = 0, to = 0;
  };

  std::uint32_t sibling(std::uint32_t i) const {
    const LinkedNode& p = nodes_[parent_[i]];
    return p.tag(0) == i ? p.tag(1) : p.tag(0);
  }
  PackedBox box(std::uint32_t i) const { return PackedBox::load(nodes_[i]); }

  /// One pass; false if nothing moved.
  bool improve() {
    std::vector<Move> moves(nodes_.size() - 1);
    for (std::size_t i = 0; i < moves.size(); ++i) moves[i].from = static_cast<std::uint32_t>(i + 1);
    const auto tried =
        static_cast<std::size_t>(std::ceil(static_cast<double>(moves.size()) * options_.share));
    std::nth_element(moves.begin(), moves.begin() + static_cast<std::ptrdiff_t>(tried - 1), moves.end(),
                     [&](const Move& a, const Move& b) {
                       const float x = area_[a.from], y = area_[b.from];
                       return x > y || (x == y && a.from < b.from);
                     });
    moves.resize(tried);
    tasks_.pieces(
        tried,
        [&](std::size_t begin, std::size_t end) {
          std::vector<Open> open;
          for (std::size_t i = begin; i < end; ++i) moves[i] = best_move(moves[i].from, open);
        },
        256);
    std::erase_if(moves, [](const Move& m) { return !(m.gain > 0); });
    std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
      return a.gain > b.gain || (a.gain == b.gain && a.from < b.from);
    });
    bool moved = false;
    for (const Move& m : moves) moved |= make(m);
    return moved;
  }

  // ---- search -----------------------------------------------------------------------------------------

  struct Open {
    std::uint32_t node;
    float saved;  // of what leaving saves, what is left once the boxes above this node have grown
  };

  Move best_move(std::uint32_t x, std::vector<Open>& open) const {
    Move best{0, x, x};
    std::uint32_t pivot = parent_[x];
    if (pivot == 0) return best;
    const PackedBox moved = box(x);
    const float least = area_[x];
    float saved = area_[pivot];
    PackedBox shrunk = box(sibling(x));
    std::size_t steps = options_.steps;
    open.clear();
    open.push_back({sibling(x), saved});
    for (;;) {
      while (!open.empty() && steps > 0) {
        --steps;
        const auto [y, left] = open.back();
        open.pop_back();
        if (left - least <= best.gain) continue;
        const float with = merged(box(y), moved).half_area(scale_);
        if (left - with > best.gain && y != sibling(x)) best.gain = left - with, best.to = y;
        const float below = left - (with - area_[y]);
        if (is_leaf(nodes_[y]) || below - least <= best.gain) continue;
        open.push_back({nodes_[y].tag(0), below}), open.push_back({nodes_[y].tag(1), below});
      }
      if (pivot == 0 || steps == 0) return best;
      const std::uint32_t other = sibling(pivot), above = parent_[pivot];
      open.clear();
      open.push_back({other, saved});
      shrunk = merged(shrunk, box(other));
      saved += area_[above] - shrunk.half_area(scale_);
      pivot = above;
    }
  }

  // ---- moves ------------------------------------------------------------------------------------------

  /// Returns whether it was made and kept.
  bool make(const Move& m) {
    const std::uint32_t p = parent_[m.from], back = sibling(m.from);
    if (p == 0 || m.to == 0 || m.to == p || m.to == back) return false;
    for (std::uint32_t i = m.to; i != 0; i = parent_[i])
      if (i == m.from) return false;  // it has been moved below
    double before = 0;
    const double change = relink(m.from, m.to, before);
    if (change < -1e-9 * before) return true;
    relink(m.from, back, before);
    return false;
  }

  /// Moves x, and its parent with it, above `to`. Returns the change of all areas, and adds those that
  /// changed.
  double relink(std::uint32_t x, std::uint32_t to, double& before) {
    const std::uint32_t p = parent_[x], s = sibling(x), above = parent_[p];
    replace(above, p, s);
    const std::uint32_t new_above = parent_[to];
    replace(new_above, to, p);
    make_inner(nodes_[p], to, x);
    parent_[to] = p;
    double change = refit(p, before);
    change += refit_up(above, before);
    return change + refit_up(new_above, before);
  }
  void replace(std::uint32_t parent, std::uint32_t child, std::uint32_t by) {
    LinkedNode& node = nodes_[parent];
    node.set_tag(node.tag(0) == child ? 0 : 1, by);
    parent_[by] = parent;
  }
  double refit(std::uint32_t i, double& before) {
    LinkedNode& node = nodes_[i];
    const std::uint32_t left = node.tag(0), right = node.tag(1);
    const double old = exact_area(node);
    const PackedBox now = merged(box(left), box(right));
    now.store(node);
    make_inner(node, left, right);
    area_[i] = now.half_area(scale_);
    before += old;
    return exact_area(node) - old;
  }
  double refit_up(std::uint32_t i, double& before) {
    double change = 0;
    for (;;) {
      const geometry::Box3f old = nodes_[i].box();
      change += refit(i, before);
      if (i == 0 || nodes_[i].box() == old) return change;
      i = parent_[i];
    }
  }
  static double exact_area(const LinkedNode& node) {
    const geometry::Box3f b = node.box();
    return surface_area(geometry::Box3d{geometry::Vec3d(b.low), geometry::Vec3d(b.high)});
  }

  const BinaryTree& tree_;
  ReinsertionOptions options_;
  BuildTasks tasks_;
  std::vector<LinkedNode> nodes_;
  std::vector<float> area_;
  std::vector<std::uint32_t> parent_;
  float scale_ = 1;
};

/// Leaves the tree as it is where no cheaper one is found.
inline void reinsert(BinaryTree& tree, const ReinsertionOptions& options = {}) {
  Reinsertion reinsertion(tree, options);
  if (tree.nodes.size() < 5) return;  // too few for a node to go anywhere else
  BinaryTree better = reinsertion.build();
  if (sah_cost(better, {}) < sah_cost(tree, {})) tree = std::move(better);
}

}  // namespace treeline::accel
