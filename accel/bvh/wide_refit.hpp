// A wide tree for the same triangles with moved corners: boxes anew from the leaves up, the structure kept.
//
// What animation asks for every frame (Wald, Boulos and Shirley 2007). Cost: O(n), 3.6 to 6.6 times less than
// a build (bench_ray --moving, 1e4 to 1e6 triangles). Large subtrees are refitted side by side; the result
// does not depend on the number of threads. A triangle that has lost its area or become infinite stays where
// it is, as a point that no ray hits, and may come back. Known weakness: the structure was made for other
// places, and rays pay for it the more the farther triangles that were together have come apart; pieces of
// triangles that spatial splits made grow into whole ones; children keep the order in which any-hit rays take
// them.
#pragma once

#include "accel/bvh/wide_collapse.hpp"

namespace treeline::accel::wide {

/// Layouts whose leaves hold each triangle by itself.
template <class Layout>
concept Refits = requires(typename Layout::Node& node, const geometry::Box<float, 3>& box) {
  Layout::set_box(node, 0, box);
};

template <class Layout>
requires Refits<Layout>
class Refit {
 public:
  using Triangle = geometry::Triangle<float>;
  using Box = geometry::Box<float, 3>;

  /// ids[i] belongs to triangles[i], ascending; if empty, i does.
  Refit(RayTree& tree, std::span<const Triangle> triangles, std::span<const Id> ids)
      : tree_(tree), triangles_(triangles), ids_(ids) {}

  /// Throws InvalidInput, with nothing done, if some triangle is in no leaf. `total`: those of the input,
  /// with those that are not among `triangles`.
  void check(std::size_t total) const {
    std::vector<bool> has(total);
    if (tree_.root != no_ref) mark(tree_.root, has);
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      if (const std::size_t id = ids_.empty() ? i : ids_[i]; !has[id])
        throw InvalidInput(
            "triangle " + std::to_string(id) +
            " was left out when the tree was built, and could be hit now: it must be built anew");
  }
  void run(int threads) {
    if (tree_.root == no_ref) return;
    Part all;
    const auto go = [&] { all = part(tree_.root, threads > 1 ? parallel_levels : 0); };
    if (threads == 1) {
      go();
    } else {
      tbb::task_arena arena(allowed_threads(threads));
      arena.execute(go);
    }
    const double area = half_area(all.box);
    tree_.sah_cost = area > 0 ? all.cost / area : 0;
  }

 private:
  using Node = typename Layout::Node;
  using Leaf = typename Layout::Leaf;
  static constexpr int parallel_levels = 3;  // below which subtrees are not shared out

  struct Part {
    Box box;
    double cost = 0;
  };
  static double half_area(const Box& box) {
    if (box.empty()) return 0;
    const auto e = geometry::Vec3d(box.high) - geometry::Vec3d(box.low);
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }
  unsigned char* bytes() const { return tree_.lines.data()->bytes; }
  Node& node_at(Ref ref) const { return const_cast<Node&>(wide::node_at<Layout>(tree_.lines.data(), ref)); }
  Leaf& leaf_at(Ref ref) const { return const_cast<Leaf&>(wide::leaf_at<Layout>(tree_.lines.data(), ref)); }

  void mark(Ref ref, std::vector<bool>& has) const {
    if (is_leaf(ref)) {
      for (const Id id : leaf_at(ref).id) has[id] = true;
      return;
    }
    const Node& node = node_at(ref);
    for (int i = 0; i < Layout::count(node); ++i)
      mark(Layout::child(node, static_cast<std::uint32_t>(i)), has);
  }

  /// Null if it can no longer be hit.
  const Triangle* triangle(Id id) const {
    if (ids_.empty()) return &triangles_[id];
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
    return at != ids_.end() && *at == id ? &triangles_[static_cast<std::size_t>(at - ids_.begin())] : nullptr;
  }

  Part part(Ref ref, int parallel) const {
    if (is_leaf(ref)) return refit(leaf_at(ref));
    Node& node = node_at(ref);
    const int count = Layout::count(node);
    Part parts[Layout::width];
    for (int i = 0; i < count; ++i) prefetch_triangles(Layout::child(node, static_cast<std::uint32_t>(i)));
    const auto below = [&](int i) {
      parts[i] = part(Layout::child(node, static_cast<std::uint32_t>(i)), parallel - 1);
    };
#ifndef __SANITIZE_THREAD__
    if (parallel > 0)
      tbb::parallel_for(0, count, below);
    else
#endif
      for (int i = 0; i < count; ++i) below(i);
    Part all;
    for (int i = 0; i < count; ++i) {
      Layout::set_box(node, i, parts[i].box);
      all.box.grow(parts[i].box), all.cost += parts[i].cost;
    }
    all.cost += half_area(all.box);
    return all;
  }

  /// Those of a leaf lie anywhere.
  void prefetch_triangles(Ref ref) const {
    if (!is_leaf(ref) || !ids_.empty()) return;
    for (const Id id : leaf_at(ref).id) {
      const auto* p = reinterpret_cast<const char*>(&triangles_[id]);
      __builtin_prefetch(p), __builtin_prefetch(p + sizeof(Triangle) - 1);
    }
  }

  Part refit(Leaf& leaf) const {
    Part part;
    int live = 0;
    for (int j = 0; j < Layout::leaf_size; ++j) {
      const Triangle* const t = triangle(leaf.id[j]);
      static constexpr Triangle point{};
      const Triangle& now = t ? *t : point;
      for (int k = 0; k < 3; ++k)
        leaf.corner[0][k][j] = now.a[k], leaf.corner[1][k][j] = now.b[k], leaf.corner[2][k][j] = now.c[k];
      if (!t || (j > 0 && leaf.id[j] == leaf.id[j - 1])) continue;
      part.box.grow(t->a), part.box.grow(t->b), part.box.grow(t->c);
      ++live;
    }
    part.cost = half_area(part.box) * live;
    return part;
  }

  RayTree& tree_;
  std::span<const Triangle> triangles_;
  std::span<const Id> ids_;
};

}  // namespace treeline::accel::wide
