// Balls as bounds of points (Omohundro 1989): a centre and a radius.
//
// Problem: the distance from a query to a ball is a difference of two rounded numbers, so that a ball, unlike
// a box, prunes true neighbours unless rounding is allowed for; see ball_bound in geometry/tolerances.hpp.
// The centre is that of the points' box: neither the points' mean nor steps towards the smallest ball (Badoiu
// and Clarkson 2003) let queries visit fewer leaves on all clouds tried. Cost: one pass over the points of a
// node, a square root a bound. Known weakness: the balls of uneven or flat sets are much larger than they;
// squared distances that overflow or vanish bound nothing.
#pragma once

#include "accel/point_set.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

template <class T, int D>
struct Ball {
  geometry::Vec<T, D> centre{};
  T radius = 0;  // no point is farther away, rounding included

  /// Holds if one of its points is in the box: such a point is no nearer to the centre than the box is, as
  /// computed, too.
  bool overlaps(const geometry::Box<T, D>& box) const {
    return !(std::sqrt(squared_distance(box, centre)) > radius);
  }
};

/// No more than the squared distance from q to any point of the ball, as squared_distance computes it.
template <class T, int D>
T squared_distance(const Ball<T, D>& ball, const geometry::Vec<T, D>& q) {
  constexpr T slack = geometry::tolerance::ball_bound<T>(D);
  const T square = squared_distance(ball.centre, q);
  const T gap = std::sqrt(square) * (T(1) - slack) - ball.radius;
  if (!(gap > 0) || !(square <= std::numeric_limits<T>::max())) return T(0);
  const T distance = gap * (T(1) - slack), bound = distance * distance;
  return bound < std::numeric_limits<T>::min() ? T(0) : bound;
}

/// Whether the second of two bounds, whose distances are given, should be visited first. A query is often
/// inside several balls: the nearer centre decides, or it would descend anywhere, and visit three times as
/// much.
template <class T, int D>
bool second_first(const Ball<T, D> (&balls)[2], const geometry::Vec<T, D>& q, T, T) {
  return squared_distance(balls[1].centre, q) < squared_distance(balls[0].centre, q);
}
template <class T, int D>
bool second_first(const geometry::Box<T, D> (&)[2], const geometry::Vec<T, D>&, T first, T second) {
  return second < first;
}

/// Of a run of entries, whose box is given.
template <class T, int D>
Ball<T, D> ball_of(const PointSet<T, D>& set, std::size_t first, std::size_t last,
                   const geometry::Box<T, D>& box) {
  const geometry::Vec<T, D> centre = box.centre();
  T square = std::numeric_limits<T>::min();  // squares that vanish are taken for the smallest that do not
  for (std::size_t i = first; i < last; ++i)
    square = std::max(square, squared_distance(set.entries[i].point, centre));
  return {centre, std::sqrt(square) * (T(1) + geometry::tolerance::ball_bound<T>(D))};
}

}  // namespace treeline::accel
