// The truth of this task: brute force in double over the finite points.
//
// Differences of floats are exact in double unless their exponents differ by more than 29, so squared
// distances carry at most a few roundings of 2^-53, far below any float method. Those of doubles are exact
// where the two are within a factor of two, as far from the origin, and else off by one such rounding. Cost:
// one pass over all points per query, vectorised; a few hundred queries of a million points take a second.
// Weakness: none but cost; a second witness in exact arithmetic is exact_oracle.hpp.
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

struct ScanFound {
  double distance2;
  accel::Id id;
  bool operator<(const ScanFound& o) const {
    return distance2 < o.distance2 || (distance2 == o.distance2 && id < o.id);
  }
};

/// T: what the points consist of, float or double.
template <class T>
class ScanOf {
 public:
  using Found = ScanFound;
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;

  /// Keeps those points of which all coordinates are finite; ids stay those of the input.
  explicit ScanOf(std::span<const Point> points);

  std::size_t size() const { return ids_.size(); }
  std::span<const accel::Id> ids() const { return ids_; }
  Point point(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  Box box() const;

  /// The min(k, size) nearest by squared distance, nearest first.
  std::vector<Found> nearest(const Point& query, std::size_t k) const;
  /// The same by the largest coordinate difference, squared: half the width of the cube that holds them.
  std::vector<Found> nearest_by_cube(const Point& query, std::size_t k) const;
  /// Nothing for a negative radius.
  RangeAnswer within(const Point& query, double radius) const;
  RangeAnswer inside(const Box& box) const;

 private:
  template <class Distance2>
  std::vector<Found> select(std::size_t k, Distance2 distance2) const;

  std::vector<T> x_, y_, z_;
  std::vector<accel::Id> ids_;
};

extern template class ScanOf<float>;
extern template class ScanOf<double>;
using DoubleScan = ScanOf<float>;

}  // namespace treeline::bench::knn
