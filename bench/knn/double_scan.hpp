// The truth of this task: brute force in double over the finite points.
//
// Differences of floats are exact in double unless their exponents differ by more than 29, so squared
// distances carry at most a few roundings of 2^-53, far below any float method. Cost: one pass over all
// points per query, vectorised; a few hundred queries of a million points take a second. Weakness: none but
// cost; a second witness in exact arithmetic is exact_oracle.hpp.
#pragma once

#include <span>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/box.hpp"

namespace treeline::bench::knn {

/// What a radius or box query must return, and what it may: points on the border (within `border` of it,
/// relative to the radius or the box's width) are left open, because conventions differ there.
struct RangeAnswer {
  std::vector<accel::Id> must, may;  // sorted, disjoint
};
inline constexpr double border = 1e-6;

class DoubleScan {
 public:
  struct Found {
    double distance2;
    accel::Id id;
    bool operator<(const Found& o) const {
      return distance2 < o.distance2 || (distance2 == o.distance2 && id < o.id);
    }
  };

  /// Keeps those points of which all coordinates are finite; ids stay those of the input.
  explicit DoubleScan(std::span<const geometry::Vec3f> points);

  std::size_t size() const { return ids_.size(); }
  std::span<const accel::Id> ids() const { return ids_; }
  geometry::Vec3f point(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  geometry::Box3f box() const;

  /// The min(k, size) nearest by squared distance, nearest first.
  std::vector<Found> nearest(const geometry::Vec3f& query, std::size_t k) const;
  /// The same by the largest coordinate difference, squared: half the width of the cube that holds them.
  std::vector<Found> nearest_by_cube(const geometry::Vec3f& query, std::size_t k) const;
  /// Nothing for a negative radius.
  RangeAnswer within(const geometry::Vec3f& query, double radius) const;
  RangeAnswer inside(const geometry::Box3f& box) const;

 private:
  template <class Distance2>
  std::vector<Found> select(std::size_t k, Distance2 distance2) const;

  std::vector<float> x_, y_, z_;
  std::vector<accel::Id> ids_;
};

}  // namespace treeline::bench::knn
