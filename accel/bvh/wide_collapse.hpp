// From a binary tree over triangles to the wide one: nodes take the place of all but one binary one a child.
//
// Which ones is chosen so that the expected cost of a line through the tree is least: bottom up, the cheapest
// way for each binary node to stand for one or more children of a wide one (Ylitie, Karras and Laine 2017,
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
#include "geometry/triangle.hpp"

namespace treeline::accel::wide {

/// A tree in memory; `root` is no_ref if there are no triangles.
struct RayTree {
  AlignedArray<Line> lines;
  Ref root = no_ref;
  std::size_t nodes = 0, leaves = 0, depth = 0, references = 0, largest_leaf = 0;
  double sah_cost = 0;  // as in TreeStats
};

template <class Layout>
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
    const std::size_t steps = measure(0, 0, out);
    if (steps >= (std::size_t{1} << 31)) throw InvalidInput("more triangles than references reach");
    out.lines = AlignedArray<Line>((steps * Layout::step + Layout::overrun + line - 1) / line);
    bytes_ = out.lines.data()->bytes;
    in_arena([&] { write(0, 0, own(0)); });
    out.root = ref_to(0, is_leaf_node(0));
    out.references = tree_.references.size();
    out.sah_cost = area(0) > 0 ? out.sah_cost / double(area(0)) : 0;
    return out;
  }

 private:
  using Leaf = RayLeaf<Layout::leaf_size>;
  static constexpr int width = Layout::width;
  static constexpr float most = 1e28f;
  static constexpr std::size_t task_size = (std::size_t{1} << 20) / Layout::step;  // of a tree worth a task

  /// Binary nodes that become the children of one wide node.
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
      std::fill(p.share, p.share + width, typename Plan::Share{0, 0});
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
    std::size_t room;
    const std::uint32_t triangles = tree_.nodes[root].count;
    out.depth = std::max(out.depth, level);
    if (is_leaf_node(root)) {
      if (triangles > Layout::leaf_size)
        throw InvalidInput("a leaf of " + std::to_string(triangles) + " triangles; at most " +
                           std::to_string(Layout::leaf_size) + " fit");
      ++out.leaves;
      out.largest_leaf = std::max<std::size_t>(out.largest_leaf, triangles);
      out.sah_cost += double(area(root)) * triangles;
      Leaf leaf;
      if constexpr (Layout::families) fill(leaf, tree_.nodes[root]);
      room = Layout::leaf_steps(leaf, triangles);
    } else {
      const Children c = children_of(root);
      ++out.nodes;
      out.sah_cost += double(area(root));
      room = Layout::node_steps;
      for (int i = 0; i < c.count; ++i) room += measure(c.node[i], level + 1, out);
    }
    return room_[root] = static_cast<std::uint32_t>(room), room;
  }

  /// Steps of a node or leaf itself.
  std::size_t own(std::uint32_t i) const { return is_leaf_node(i) ? room_[i] : Layout::node_steps; }

  /// Writes a node or leaf, and from `next` on what is below. Of a node's children, leaves come first; then
  /// each subtree in one piece, or all child nodes and then what is below them. Returns the triangles' areas,
  /// seen along the axes.
  float write(std::uint32_t root, std::size_t at, std::size_t next) {
    if (is_leaf_node(root)) return write_leaf(root, at);
    const Children c = children_of(root);
    std::size_t place[width], rest[width];
    float covered[width];
    for (int i = 0; i < c.count; ++i) prefetch(tree_.nodes[c.node[i]]);
    for (const bool leaves : {true, false})
      for (int i = 0; i < c.count; ++i)
        if (const std::uint32_t child = c.node[i]; is_leaf_node(child) == leaves) {
          place[i] = next, rest[i] = next + own(child);
          next += Layout::families ? own(child) : room_[child];
        }
    if constexpr (Layout::families)
      for (int i = 0; i < c.count; ++i) rest[i] = next, next += room_[c.node[i]] - own(c.node[i]);
    const auto below = [&](int i) { covered[i] = write(c.node[i], place[i], rest[i]); };
    if (threads_ > 1 && room_[root] >= task_size) {
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
    geometry::Box<float, 3> boxes[width];
    Ref refs[width];
    for (int i = 0; i < c.count; ++i) {
      const std::uint32_t child = c.node[order[i]];
      boxes[i] = tree_.nodes[child].box, refs[i] = ref_to(place[order[i]], is_leaf_node(child));
    }
    const auto count = static_cast<std::size_t>(c.count);
    Layout::write(node_to(at), {{boxes, count}, {refs, count}});
    return sum;
  }

  typename Layout::Node& node_to(std::size_t at) const {
    return *reinterpret_cast<typename Layout::Node*>(bytes_ + at * Layout::step);
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
    Leaf leaf;
    fill(leaf, from);
    Layout::write(*reinterpret_cast<typename Layout::Leaf*>(bytes_ + at * Layout::step), leaf, from.count);
    using F = simd::Floats<Layout::leaf_size>;
    const auto side = [&](int corner, int k) {
      return F::load(leaf.corner[corner][k]) - F::load(leaf.corner[0][k]);
    };
    const auto normal = [&](int k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      return absolute(side(1, l) * side(2, m) - side(1, m) * side(2, l));
    };
    alignas(32) float twice[Layout::leaf_size];
    (normal(0) + normal(1) + normal(2)).store(twice);
    float sum = 0;
    for (std::uint32_t j = 0; j < from.count; ++j) sum += twice[j];
    return std::min(0.5f * sum, most);
  }

  void fill(Leaf& leaf, const BinaryNode& from) const {
    constexpr std::uint32_t size = Layout::leaf_size;
    std::uint32_t sorted[size];
    for (std::uint32_t j = 0; j < from.count; ++j) {
      const std::uint32_t reference = tree_.references[from.first + j];
      std::uint32_t k = j;
      for (; k > 0 && sorted[k - 1] > reference; --k) sorted[k] = sorted[k - 1];
      sorted[k] = reference;
    }
    for (std::uint32_t j = 0; j < size; ++j) {
      // The last one again where there are no more: it can only be found twice, which changes nothing.
      const std::uint32_t t = sorted[std::min(j, from.count - 1)];
      const Triangle& triangle = triangles_[t];
      for (int k = 0; k < 3; ++k)
        leaf.corner[0][k][j] = triangle.a[k], leaf.corner[1][k][j] = triangle.b[k],
        leaf.corner[2][k][j] = triangle.c[k];
      leaf.id[j] = ids_.empty() ? t : ids_[t];
    }
  }

  const BinaryTree& tree_;
  std::span<const Triangle> triangles_;
  std::span<const Id> ids_;
  int threads_;
  unsigned char* bytes_ = nullptr;
  std::vector<Plan> plans_;
  std::vector<std::uint32_t> room_;  // steps that the subtree below a binary node takes
};

}  // namespace treeline::accel::wide
