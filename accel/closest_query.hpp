// One closest-point query on its way through a tree: the leaf test, and the nearest point so far.
//
// Cells may be skipped only if no triangle in them could win, rounding included. prunes() therefore compares
// against a limit enlarged by the roundings of both distances; bounds from planes are taken from planes
// stored widened (padded_ray.hpp) and have slack() taken off, by which together a computed closest point may
// lie off its triangle. Ties in distance go to the lower id.
#pragma once

#include "accel/concepts.hpp"
#include "accel/triangle_leaves.hpp"
#include "geometry/distance.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

template <class T>
class ClosestQuery {
 public:
  using Point = geometry::Vec<T, 3>;

  /// `centre` is the tree's.
  ClosestQuery(const Point& point, T max_distance, const Point& centre)
      : point_(point), max_distance2_(max_distance * max_distance), limit_(enlarged(max_distance2_)) {
    T largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(point[k]), std::abs(centre[k])});
    slack_ = geometry::tolerance::closest_slack<T> * largest;
  }

  const Point& point() const { return point_; }
  T slack() const { return slack_; }
  const ClosestPoint<T>& best() const { return best_; }
  /// The triangle that is nearest, as the tree keeps it; null if none.
  const StoredTriangle<T>* stored() const { return best_ ? &stored_ : nullptr; }
  /// Whether triangles at least this far (squared) are of no interest.
  bool prunes(T bound2) const { return bound2 > limit_; }

  /// Tests the leaf of count triangles that begins at reference `first`. Never inlined, so that all trees
  /// compute the same bits.
  [[gnu::noinline]] void test(const TriangleLeaves<T>& leaves, std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const StoredTriangle<T> candidate = leaves.get(first, count, i);
      const auto found = geometry::closest_point_on_triangle(point_, candidate.triangle);
      if (!(found.distance2 <= max_distance2_)) continue;
      if (found.distance2 > best_.distance2 ||
          (found.distance2 == best_.distance2 && candidate.id >= best_.primitive))
        continue;
      best_ = {found.distance2, candidate.id, static_cast<Feature>(found.feature), found.point};
      stored_ = candidate;
      limit_ = enlarged(found.distance2);
    }
  }

 private:
  static T enlarged(T distance2) {  // both squared distances carry up to 4 roundings
    return distance2 * (T(1) + geometry::tolerance::gamma<T>(10));
  }

  Point point_;
  T max_distance2_, limit_, slack_;
  ClosestPoint<T> best_;
  StoredTriangle<T> stored_;
};

}  // namespace treeline::accel
