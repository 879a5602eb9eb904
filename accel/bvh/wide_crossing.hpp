// How rays cross the surface, exactly: which side of what they first meet they come from, and how often they
// cross in all. What inside and outside are decided by (accel/signed_distance).
//
// Problem: the nearest hit alone does not tell the side for certain. t is rounded, so a sheet behind another
// one may seem to lie in front; an edge belongs to two triangles that may face either way. Method: every
// triangle that may be met is decided exactly (exact_ray_triangle.hpp), with bounds on its t. The first
// crossing is kept as an interval: what lies behind it for certain is left out, what lies before it for
// certain takes its place, and of what overlaps it nobody asks which is first as long as all are crossed the
// same way; else the answer is `unclear`, and the caller tries another direction. A ray through an edge, a
// corner or along a triangle is unclear if nothing comes before. Cost: as of the exact nearest hit; the t
// that prunes the search is rounded up. Known weakness: none for rays that start in the mesh's box; of
// triangles whose coordinates vanish beside the typical ones (triangle_scale.hpp) what is left counts.
#pragma once

#include "accel/bvh/wide_triangles.hpp"

namespace treeline::accel {

/// What a ray, all of it from its origin on, tells of its origin.
enum class FirstCrossing : std::uint8_t {
  none,     ///< nothing is met
  inward,   ///< what is met first is met from its front
  outward,  ///< from behind
  surface,  ///< the origin is on the surface
  unclear   ///< an edge or corner comes first, or several triangles that face both ways at one place
};

/// All crossings of a ray.
struct CrossingCount {
  std::size_t inward = 0, outward = 0;
  bool surface = false;  ///< the origin is on the surface
  bool unclear = false;  ///< an edge, a corner or a triangle's plane is met: the numbers mean nothing
};

namespace wide {

/// Leaf test that remembers the first crossing; hits() reports what may prune the search.
template <int N>
class FirstCrossingTest {
 public:
  using Leaf = RayLeaf<N>;
  FirstCrossingTest(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre,
                    const geometry::Box<float, 3>& bounds, float reach)
      : exact_(ray, centre, bounds, reach) {}

  [[gnu::always_inline]] std::uint32_t hits(const Leaf& leaf, float limit, float (&t)[N]) const {
    std::uint32_t bits = 0;
    for (std::uint32_t maybe = exact_.maybe(leaf); maybe != 0; maybe &= maybe - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(maybe));
      if (!take(exact_.crossing(leaf, lane))) continue;
      t[lane] = rounded_up(high_);
      bits |= (t[lane] <= limit ? 1u : 0u) << lane;
    }
    return bits;
  }
  FirstCrossing first() const {
    return along_plane_ && first_ != FirstCrossing::surface ? FirstCrossing::unclear : first_;
  }

 private:
  using Kind = geometry::Crossing::Kind;
  static float rounded_up(double t) {
    return static_cast<float>(t) *
           (1 + 4 * geometry::tolerance::unit_roundoff<float>)+std::numeric_limits<float>::denorm_min();
  }
  /// Whether the interval ends earlier than before.
  bool take(const geometry::Crossing& c) const {
    if (c.kind == Kind::none || first_ == FirstCrossing::surface) return false;
    if (c.kind == Kind::start) {
      first_ = FirstCrossing::surface, low_ = high_ = 0;
      return true;
    }
    if (c.kind == Kind::touch && c.high == 0) return along_plane_ = true, false;
    if (c.low > high_) return false;
    const FirstCrossing kind = c.kind == Kind::inward    ? FirstCrossing::inward
                               : c.kind == Kind::outward ? FirstCrossing::outward
                                                         : FirstCrossing::unclear;
    if (c.high < low_ || first_ == FirstCrossing::none)
      first_ = kind, low_ = c.low;
    else
      first_ = kind == first_ ? kind : FirstCrossing::unclear, low_ = std::min(low_, c.low);
    const bool earlier = c.high < high_;
    high_ = std::min(high_, c.high);
    return earlier;
  }

  ExactTest<N> exact_;
  mutable double low_ = std::numeric_limits<double>::infinity(), high_ = low_;
  mutable FirstCrossing first_ = FirstCrossing::none;
  mutable bool along_plane_ = false;
};

/// Leaf test that counts all crossings, each triangle once.
template <int N>
class CrossingCountTest {
 public:
  using Leaf = RayLeaf<N>;
  CrossingCountTest(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre,
                    const geometry::Box<float, 3>& bounds, float reach)
      : exact_(ray, centre, bounds, reach) {}

  std::uint32_t hits(const Leaf& leaf, float /*limit*/, float (&)[N]) const {
    for (std::uint32_t maybe = exact_.maybe(leaf); maybe != 0; maybe &= maybe - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(maybe));
      if (lane > 0 && leaf.id[lane] == leaf.id[lane - 1]) continue;  // in place of an absent one
      take(leaf.id[lane], exact_.crossing(leaf, lane).kind);
    }
    return 0;
  }
  /// Triangles may lie in several leaves.
  CrossingCount count() const {
    CrossingCount r;
    std::sort(inward_.begin(), inward_.end()), std::sort(outward_.begin(), outward_.end());
    const auto distinct = [](const std::vector<Id>& ids) {
      std::size_t n = 0;
      for (std::size_t i = 0; i < ids.size(); ++i) n += i == 0 || ids[i] != ids[i - 1];
      return n;
    };
    r.inward = distinct(inward_), r.outward = distinct(outward_);
    r.surface = surface_, r.unclear = unclear_;
    return r;
  }

 private:
  using Kind = geometry::Crossing::Kind;
  void take(Id id, Kind kind) const {
    if (kind == Kind::inward) inward_.push_back(id);
    if (kind == Kind::outward) outward_.push_back(id);
    surface_ = surface_ || kind == Kind::start, unclear_ = unclear_ || kind == Kind::touch;
  }

  ExactTest<N> exact_;
  mutable std::vector<Id> inward_, outward_;
  mutable bool surface_ = false, unclear_ = false;
};

/// The crossings of rays with a wide tree's triangles; the tree's ray test policy does not matter.
template <class Tree>
class Crossings {
 public:
  using Ray = geometry::Ray<float>;
  using Point = geometry::Vec<float, 3>;
  static constexpr int leaf_size = Tree::Layout::leaf_size;

  explicit Crossings(const Tree& tree) : tree_(tree) {}

  /// Of a ray whose t_min and t_max do not matter; it must be finite and have a direction.
  FirstCrossing first(const Ray& ray) const {
    FirstCrossing r = FirstCrossing::none;
    firsts(
        1, 1, [&](std::size_t) { return ray; }, [&](std::size_t, FirstCrossing c) { r = c; });
    return r;
  }
  /// Of n rays, ray_of(i); calls take(i, first crossing), from several threads.
  template <class RayOf, class Take>
  void firsts(std::size_t n, int threads, RayOf&& ray_of, Take&& take) const {
    if (tree_.tree_.root == no_ref) {
      for (std::size_t i = 0; i < n; ++i) take(i, FirstCrossing::none);
      return;
    }
    using Test = FirstCrossingTest<leaf_size>;
    parallel_ranges(n, threads, [&](std::size_t begin, std::size_t end) {
      if (end - begin > 1 && tree_.flies(RayBatch::automatic)) {
        fly<ClosestFlight<typename Tree::Layout, Test>>(
            tree_.tree_.lines.data(), begin, end,
            [&](auto& flight, std::size_t i) {
              placed(ray_of(i), [&](const Ray& ray, const Point& centre) {
                flight.start(ray, centre, tree_.place_.bounds, tree_.tree_.root);
              });
              flight.index = i;
            },
            [&](const auto& flight) { take(flight.index, flight.test.first()); });
        return;
      }
      NoWork work;
      for (std::size_t i = begin; i < end; ++i)
        placed(ray_of(i), [&](const Ray& ray, const Point& centre) {
          const BoxRay<typename Tree::Layout> box_ray(ray, centre, tree_.place_.bounds);
          const Test test(ray, centre, tree_.place_.bounds, box_ray.reach);
          NearestHit<typename Tree::Layout> best{ray.t_max};
          closest(tree_.tree_.lines.data(), tree_.tree_.root, box_ray, test, best, work);
          take(i, test.first());
        });
    });
  }

  CrossingCount count(const Ray& given) const {
    if (tree_.tree_.root == no_ref) return {};
    return placed(given, [&](const Ray& ray, const Point& centre) {
      const BoxRay<typename Tree::Layout> box_ray(ray, centre, tree_.place_.bounds);
      const CrossingCountTest<leaf_size> test(ray, centre, tree_.place_.bounds, box_ray.reach);
      all(tree_.tree_.lines.data(), tree_.tree_.root, box_ray, test, ray.t_max,
          [](const auto&, Id, std::uint32_t, float) {});
      return test.count();
    });
  }

 private:
  template <class F>
  auto placed(Ray given, F&& f) const {
    given.t_min = 0, given.t_max = std::numeric_limits<float>::infinity();
    return tree_.placed(given, [&](const Ray& ray, const Point& centre, int) { return f(ray, centre); });
  }

  const Tree& tree_;
};

}  // namespace wide
}  // namespace treeline::accel
