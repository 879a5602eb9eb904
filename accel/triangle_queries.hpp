// The public queries that all trees over triangles share: checks of what is asked, batches, containment. A
// tree derives from this (statically; nothing is virtual), is made from a TriangleSet and the options, and
// supplies two traversals:
//   template <bool any, class W> void trace(RayQuery<Primitives>&, W&) const;
//   template <class W> void approach(ClosestQuery<T>&, W&) const;
// Triangles of no area are kept in a tree of their own of the same kind, which rays do not enter.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "accel/batch.hpp"
#include "accel/closest_query.hpp"
#include "accel/concepts.hpp"
#include "accel/ray_checks.hpp"
#include "accel/ray_query.hpp"
#include "accel/triangle_set.hpp"
#include "accel/volume.hpp"

namespace treeline::accel {

/// A ray test that takes one triangle at a time.
template <class Test, class T>
concept SingleRayTest = requires {
  typename Test::template Prepared<T>;
};

template <class Tree, class Primitives>
class TriangleQueries {
  static_assert(
      SingleRayTest<typename Primitives::Test, typename Primitives::Scalar>,
      "this tree takes the ray tests geometry::Watertight and geometry::MollerTrumbore; rays decided "
      "exactly: accel::Bvh<accel::Triangles<float, geometry::Exact>, accel::Wide>");

 public:
  using Scalar = typename Primitives::Scalar;
  using Point = typename Primitives::Point;
  using Box = typename Primitives::Box;
  using Ray = typename Primitives::Ray;

  Hit<Scalar> closest_hit(const Ray& ray) const {
    NoWork work;
    return closest_hit(ray, work);
  }
  template <WorkCounter W>
  Hit<Scalar> closest_hit(const Ray& ray, W& work) const {
    check(ray);
    return answer<false>(ray, work);
  }
  void closest_hit(std::span<const Ray> rays, std::span<Hit<Scalar>> hits, int threads) const {
    check(rays, hits.size());
    parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      for (std::size_t i = begin; i < end; ++i) hits[i] = answer<false>(rays[i], work);
    });
  }

  bool any_hit(const Ray& ray) const {
    NoWork work;
    return any_hit(ray, work);
  }
  template <WorkCounter W>
  bool any_hit(const Ray& ray, W& work) const {
    check(ray);
    return static_cast<bool>(answer<true>(ray, work));
  }
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> any, int threads) const {
    check(rays, any.size());
    parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      for (std::size_t i = begin; i < end; ++i) any[i] = answer<true>(rays[i], work) ? 1 : 0;
    });
  }

  ClosestPoint<Scalar> closest_point(const Point& query, Scalar max_distance = infinity) const {
    NoWork work;
    return closest_point(query, max_distance, work);
  }
  template <WorkCounter W>
  ClosestPoint<Scalar> closest_point(const Point& query, Scalar max_distance, W& work) const {
    check(max_distance);
    check(query);
    return answer(query, max_distance, work);
  }
  void closest_point(std::span<const Point> queries, Scalar max_distance, std::span<ClosestPoint<Scalar>> out,
                     int threads) const {
    check(max_distance);
    check(queries, out.size());
    parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      for (std::size_t i = begin; i < end; ++i) out[i] = answer(queries[i], max_distance, work);
    });
  }

  bool contains(const Point& query) const {
    check(query);
    return inside(query);
  }
  void contains(std::span<const Point> queries, std::span<std::uint8_t> out, int threads) const {
    check(queries, out.size());
    parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = inside(queries[i]) ? 1 : 0;
    });
  }

  /// Number of triangles that rays can hit: those kept.
  std::size_t size() const { return stats_.primitives; }
  std::size_t bytes() const { return stats_.bytes; }
  TreeStats stats() const { return stats_; }
  /// Encloses all triangles that rays can hit; empty if there are none.
  Box bounds() const { return place_.given(bounds_); }

 protected:
  explicit TriangleQueries(const TriangleSet<Scalar>& set)
      : bounds_(set.bounds), centre_(set.centre), place_(set.place) {
    stats_.primitives = set.items.size();
    stats_.dropped = set.dropped + set.flat.size();
  }
  /// To be called once the tree stands, its bytes counted.
  template <class Options>
  void keep_flat(TriangleSet<Scalar>&& set, const Options& options) {
    if (set.flat.empty()) return;
    flat_ = std::make_shared<const Tree>(Tree(std::move(set).flat_only(), options));
    stats_.bytes += flat_->bytes();
  }

  Box bounds_;    // like everything that a tree keeps: where place_ puts it
  Point centre_;  // see padded_ray.hpp
  TrianglePlace<Scalar> place_;
  TreeStats stats_;

 private:
  static constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();

  std::shared_ptr<const Tree> flat_;  // of the triangles of no area, if there are any

  const Tree& tree() const { return static_cast<const Tree&>(*this); }

  // Queries and answers in the user's space.
  template <bool any, class W>
  Hit<Scalar> answer(const Ray& ray, W& work) const {
    int shift;
    const Ray kept = place_.kept(ray, shift);
    Hit<Scalar> hit = cast<any>(kept, work).hit();
    if (shift != 0 && hit) hit.t = place_.scale().unscaled_t(hit.t, shift, ray);
    return hit;
  }
  template <class W>
  ClosestPoint<Scalar> answer(const Point& point, Scalar max_distance, W& work) const {
    if (!place_.changes()) return nearest(point, max_distance, work);
    const TriangleScale<Scalar>& scale = place_.scale();
    const bool is_near = place_.is_near(point);
    auto best = nearest(place_.kept_query(point), is_near ? max_distance * scale.factor() : infinity, work);
    if (!best) return best;
    best.point = place_.given(best.point);
    best.distance2 = is_near ? scale.unscaled_square(best.distance2) : distance2(point, best.point);
    if (!is_near && !(best.distance2 <= max_distance * max_distance)) return {};
    return best;
  }

  // The same in the tree's space.
  template <bool any, class W>
  RayQuery<Primitives> cast(const Ray& ray, W& work) const {
    RayQuery<Primitives> query(ray, centre_);
    if (size() > 0) tree().template trace<any>(query, work);
    return query;
  }
  template <class W>
  ClosestQuery<Scalar> approached(const Point& point, Scalar max_distance, W& work) const {
    ClosestQuery<Scalar> query(point, max_distance, centre_);
    if (size() > 0) tree().approach(query, work);
    if (flat_) flat_->approach(query, work);
    return query;
  }
  template <class W>
  ClosestPoint<Scalar> nearest(const Point& point, Scalar max_distance, W& work) const {
    return approached(point, max_distance, work).best();
  }
  /// Within rounding of the triangle that is nearest: of its own coordinates and the point's, so that what
  /// lies far away does not blur the surface here.
  template <class W>
  bool on_surface(const Point& point, W& work) const {
    constexpr Scalar slack = geometry::tolerance::on_surface<Scalar>;
    const Scalar furthest = std::max(place_.magnitude(bounds_.low), place_.magnitude(bounds_.high));
    const auto query = approached(point, slack * furthest, work);
    if (query.stored() == nullptr) return false;
    const geometry::Triangle<Scalar>& t = query.stored()->triangle;
    const auto size = [&](const Point& p) { return place_.magnitude(p); };
    const Scalar near = slack * std::max({size(point), size(t.a), size(t.b), size(t.c)});
    return query.best().distance2 <= near * near;
  }

  bool inside(const Point& given) const {
    const Point point = place_.kept(given);
    if (!bounds_.contains(point)) return false;
    NoWork work;
    if (on_surface(point, work)) return true;
    return votes_inside(point, [&](const Ray& ray) { return cast<false>(ray, work); });
  }

  static void check(const Ray& ray) { check_ray(ray); }
  static void check(std::span<const Ray> rays, std::size_t answers) { check_rays(rays, answers); }

  static void check(const Point& query) {
    if (!is_finite(query)) throw InvalidInput("query has a coordinate that is not finite");
  }
  static void check(std::span<const Point> queries, std::size_t answers) {
    check_room(queries.size(), answers);
    for (std::size_t i = 0; i < queries.size(); ++i)
      if (!is_finite(queries[i]))
        throw InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
  }
  static void check(Scalar max_distance) {
    if (!(max_distance >= Scalar(0)))
      throw InvalidInput("max_distance is " + std::to_string(max_distance) + "; it must not be negative");
  }
};

/// A type that models every surface that concepts.hpp defines for triangles.
template <class I>
concept TriangleIndex = RayIndex<I> && ClosestPointIndex<I> && VolumeIndex<I> && Inspectable<I>;

}  // namespace treeline::accel
