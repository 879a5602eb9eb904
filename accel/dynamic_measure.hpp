// How DynamicPoints measures: all its points alike, as one tree over them would, whichever part holds them.
//
// Every tree scales its own points, so that two trees may round the same distance differently, or one may
// lose digits where the other does not. What one tree over all the points would say depends on the exponents
// of their coordinates only, which are counted as points come and go. Where a part is scaled the same way and
// all squares keep their digits, its answers are that tree's; elsewhere its points are measured again, here.
#pragma once

#include "accel/candidates.hpp"

namespace treeline::accel {

/// A query against points in the caller's units, by a cloud's measure: what PointSet and WideQuery do with
/// the scaled points that they keep.
template <class T, int D>
class DynamicQuery {
 public:
  using Wide = SquareOf<T>;
  using Point = geometry::Vec<T, D>;

  DynamicQuery(const PointMeasure<T, D>& measure, const Point& q)
      : measure_(measure),
        scaled_(measure.scaled(q)),
        wide_(measure.wide_scaled(q)),
        small_(measure.is_small(scaled_)) {}

  struct Square {
    T distance2;  // scaled
    Wide wide;
  };
  Square square(const Point& p) const {
    return {squared_distance(p * measure_.scale, scaled_), squared_distance(measure_.wide_scaled(p), wide_)};
  }
  Wide rank(const Square& s) const { return rank_of<T>(s.distance2, s.wide, small_); }
  T told_square(Wide rank) const { return measure_.told_square(rank, small_); }

  /// A radius, in the caller's units, within which every point lies that does not rank above; infinite where
  /// there is none.
  T radius_of(Wide rank) const {
    Wide square = rank;
    // Ranks that are T's squares may be less than the true ones: by rounding, or all if they have vanished.
    if (square < static_cast<Wide>(vague_square<T>())) square = static_cast<Wide>(vague_square<T>());
    return widened(std::sqrt(square) * static_cast<Wide>(measure_.inverse_scale));
  }
  /// A radius within which every point lies that is within reach of the given one, as rounded.
  static T widened(Wide radius) {
    const Wide wider = radius * (1 + 2 * static_cast<Wide>(geometry::tolerance::gamma<T>(D + 4)));
    if (!(wider <= static_cast<Wide>(std::numeric_limits<T>::max())))
      return std::numeric_limits<T>::infinity();
    return std::nextafter(static_cast<T>(wider), std::numeric_limits<T>::infinity());
  }

 private:
  const PointMeasure<T, D>& measure_;
  Point scaled_;
  geometry::Vec<Wide, D> wide_;
  bool small_;
};

}  // namespace treeline::accel
