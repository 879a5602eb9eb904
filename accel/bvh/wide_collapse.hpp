// From a binary tree over triangles to the wide one: nodes take the place of up to seven binary ones each.
//
// Which ones is chosen so that the expected cost of a line through the tree is least: bottom up, the cheapest
// way for each binary node to stand for one to eight children of a wide one (Ylitie, Karras and Laine 2017,
// section 3.1). Against opening the child with the largest box first, nodes become fewer by a third, and
// fuller. Then one pass tells how much room each subtree takes, and one writes, large subtrees side by side.
// Cost: O(n).
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include "accel/batch.hpp"
#include "accel/bvh/binary_tree.hpp"
#include "accel/bvh/wide_triangle_layout.hpp"
#include "accel/simd/lanes8.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel::wide {

/// A tree in memory; `root` is no_ref if there are no triangles.
struct RayTree {
  AlignedArray<Line> lines;
  Ref root = no_ref;
  std::size_t nodes = 0, leaves = 0, depth = 0, references = 0, largest_leaf = 0;
  double sah_cost = 0;  // as in TreeStats
};

class Collapse {
 public:
  using Triangle = geometry::Triangle<float>;

  /// ids[i] belongs to triangles[i]; if empty, i does.
  Collapse(const BinaryTree& tree, std::span<const Triangle> triangles, std::span<const Id> ids, int threads)
      : tree_(tree), triangles_(triangles), ids_(ids), threads_(threads) {}

  RayTree run() {
    RayTree out;
    if (tree_.nodes.empty()) return out;
    plans_.resize(tree_.nodes.size()), room_.resize(tree_.nodes.size());
    plan(0);
    out.lines = AlignedArray<Line>(measure(0, 0, out));
    if (out.lines.size() >= (std::size_t{1} << 31))
      throw InvalidInput("more triangles than references reach");
    lines_ = out.lines.data();
    in_arena([&] { write(0, 0); });
    out.root = ref_to(0, is_leaf_node(0));
    out.references = tree_.references.size();
    out.sah_cost = area(0) > 0 ? out.sah_cost / double(area(0)) : 0;
    return out;
  }

 private:
  static constexpr float most = 1e28f;
  static constexpr std::size_t task_lines = 1 << 14;  // 1 MiB of tree: worth a task

  /// Up to eight binary nodes that become the children of one wide node.
  struct Children {
    std::uint32_t node[width];
    int count = 0;
  };

  template <class F>
  void in_arena(F&& f) {
    if (threads_ == 1) return f();
    tbb::task_arena arena(allowed_threads(threads_));
    arena.execute(f);
  }
  bool is_leaf_node(std::uint32_t i) const { return tree_.nodes[i].count > 0; }
  /// Half the area of a box, held where sums of it stay finite.
  float area(std::uint32_t i) const {
    const auto e = tree_.nodes[i].box.extent();
    const float a = simd::opaque(e[0] * e[1]) + simd::opaque(e[1] * e[2]) + simd::opaque(e[2] * e[0]);
    return a < most ? a : most;
  }

  /// The least cost of a subtree as at most so many children of one node (and one), and how many of them each
  /// of the two binary children then is; none: the subtree is one child.
  struct Plan {
    float cost[width];
    struct Share {
      std::uint8_t left, right;
    } share[width], as_node;
  };

  void plan(std::uint32_t i) {
    Plan& p = plans_[i];
    if (is_leaf_node(i)) {
      std::fill(p.cost, p.cost + width, area(i));
      std::fill(p.share, p.share + width, Plan::Share{0, 0});
      return;
    }
    const std::uint32_t first = tree_.nodes[i].first;
    plan(first), plan(first + 1);
    const Plan &left = plans_[first], &right = plans_[first + 1];
    for (int slots = 2; slots <= width; ++slots) {
      float& best = p.cost[slots - 1] = infinity;
      for (int l = 1; l < slots; ++l)
        if (const float cost = left.cost[l - 1] + right.cost[slots - l - 1]; cost < best) {
          best = cost;
          p.share[slots - 1] = {static_cast<std::uint8_t>(l), static_cast<std::uint8_t>(slots - l)};
        }
    }
    p.as_node = p.share[width - 1];
    p.cost[0] = area(i) + p.cost[width - 1], p.share[0] = {0, 0};
    for (int slots = 2; slots <= width; ++slots)
      if (!(p.cost[slots - 1] < p.cost[slots - 2]))
        p.cost[slots - 1] = p.cost[slots - 2], p.share[slots - 1] = p.share[slots - 2];
  }

  void collect(std::uint32_t i, int slots, Children& c) const {
    const auto share = plans_[i].share[slots - 1];
    if (share.left == 0) return static_cast<void>(c.node[c.count++] = i);
    const std::uint32_t first = tree_.nodes[i].first;
    collect(first, share.left, c), collect(first + 1, share.right, c);
  }

  Children children_of(std::uint32_t root) const {
    Children c;
    const auto share = plans_[root].as_node;
    const std::uint32_t first = tree_.nodes[root].first;
    collect(first, share.left, c), collect(first + 1, share.right, c);
    return c;
  }

  std::size_t measure(std::uint32_t root, std::size_t level, RayTree& out) {
    std::size_t room = leaf_lines;
    const std::uint32_t triangles = tree_.nodes[root].count;
    out.depth = std::max(out.depth, level);
    if (is_leaf_node(root)) {
      if (triangles > width)
        throw InvalidInput("a leaf of " + std::to_string(triangles) + " triangles; at most " +
                           std::to_string(width) + " fit");
      ++out.leaves;
      out.largest_leaf = std::max<std::size_t>(out.largest_leaf, triangles);
      out.sah_cost += double(area(root)) * triangles;
    } else {
      const Children c = children_of(root);
      ++out.nodes;
      out.sah_cost += double(area(root));
      room = node_lines;
      for (int i = 0; i < c.count; ++i) room += measure(c.node[i], level + 1, out);
    }
    return room_[root] = static_cast<std::uint32_t>(room), room;
  }

  /// Leaves of a node first, then the subtrees below. Returns the triangles' areas, seen along the axes.
  float write(std::uint32_t root, std::size_t at) {
    if (is_leaf_node(root)) return write_leaf(root, at);
    const Children c = children_of(root);
    std::size_t next = at + node_lines, place[width];
    float covered[width];
    for (int i = 0; i < c.count; ++i) prefetch(tree_.nodes[c.node[i]]);
    for (const bool leaves : {true, false})
      for (int i = 0; i < c.count; ++i)
        if (is_leaf_node(c.node[i]) == leaves) place[i] = next, next += room_[c.node[i]];
    const auto below = [&](int i) { covered[i] = write(c.node[i], place[i]); };
    if (threads_ > 1 && room_[root] >= task_lines) {
#ifdef __SANITIZE_THREAD__
      for (int i = 0; i < c.count; ++i) below(i);
#else
      tbb::parallel_for(0, c.count, below);
#endif
    } else {
      for (int i = 0; i < c.count; ++i) below(i);
    }
    // Rays that ask for any hit take the last child first: that with the best chance of a hit for its cost.
    int order[width];
    float worth[width], sum = 0;
    for (int i = 0; i < c.count; ++i) {
      const float box = std::max(area(c.node[i]), std::numeric_limits<float>::min());
      worth[i] = std::min(1.0f, covered[i] / box) * box / plans_[c.node[i]].cost[0];
      sum += covered[i];
      int j = i;
      for (; j > 0 && !(worth[order[j - 1]] <= worth[i]); --j) order[j] = order[j - 1];
      order[j] = i;
    }
    RayNode& node = *reinterpret_cast<RayNode*>(lines_ + at);
    for (int i = 0; i < width; ++i) {
      const bool present = i < c.count;
      const int from = present ? order[i] : 0;
      const geometry::Box<float, 3> box = present ? tree_.nodes[c.node[from]].box : geometry::Box<float, 3>{};
      for (int k = 0; k < 3; ++k) node.plane[k][0][i] = box.low[k], node.plane[k][1][i] = box.high[k];
      node.child[i] = present ? ref_to(place[from], is_leaf_node(c.node[from])) : no_ref;
      node.spare[i] = 0;
    }
    return sum;
  }

  /// The triangles of a leaf lie anywhere.
  void prefetch(const BinaryNode& node) const {
    for (std::uint32_t j = 0; j < node.count; ++j) {
      const auto* p = reinterpret_cast<const char*>(&triangles_[tree_.references[node.first + j]]);
      __builtin_prefetch(p), __builtin_prefetch(p + sizeof(Triangle) - 1);
    }
  }

  float write_leaf(std::uint32_t i, std::size_t at) {
    const BinaryNode& from = tree_.nodes[i];
    RayLeaf& leaf = *reinterpret_cast<RayLeaf*>(lines_ + at);
    std::uint32_t sorted[width];
    for (std::uint32_t j = 0; j < from.count; ++j) {
      const std::uint32_t reference = tree_.references[from.first + j];
      std::uint32_t k = j;
      for (; k > 0 && sorted[k - 1] > reference; --k) sorted[k] = sorted[k - 1];
      sorted[k] = reference;
    }
    for (std::uint32_t j = 0; j < width; ++j) {
      // The last one again where there are no more: it can only be found twice, which changes nothing.
      const std::uint32_t t = sorted[std::min(j, from.count - 1)];
      const Triangle& triangle = triangles_[t];
      for (int k = 0; k < 3; ++k)
        leaf.corner[0][k][j] = triangle.a[k], leaf.corner[1][k][j] = triangle.b[k],
        leaf.corner[2][k][j] = triangle.c[k];
      leaf.id[j] = ids_.empty() ? t : ids_[t];
    }
    const auto side = [&](int corner, int k) {
      return simd::Floats8::load(leaf.corner[corner][k]) - simd::Floats8::load(leaf.corner[0][k]);
    };
    const auto normal = [&](int k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      return absolute(side(1, l) * side(2, m) - side(1, m) * side(2, l));
    };
    alignas(32) float twice[width];
    (normal(0) + normal(1) + normal(2)).store(twice);
    float sum = 0;
    for (std::uint32_t j = 0; j < from.count; ++j) sum += twice[j];
    return std::min(0.5f * sum, most);
  }

  const BinaryTree& tree_;
  std::span<const Triangle> triangles_;
  std::span<const Id> ids_;
  int threads_;
  Line* lines_ = nullptr;
  std::vector<Plan> plans_;
  std::vector<std::uint32_t> room_;  // lines that the subtree below a binary node takes
};

}  // namespace treeline::accel::wide
