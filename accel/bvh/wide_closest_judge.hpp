// Which of the triangles that were measured in double is nearest.
//
// The least squared distance, of equals the lowest id. Where certified, squared distances are intervals
// (EightClosest::error), and what these leave open is decided exactly (wide_closest_exact.hpp).
#pragma once

#include "accel/bvh/wide_closest_double.hpp"
#include "accel/bvh/wide_closest_space.hpp"

namespace treeline::accel::wide {

template <bool certified>
class ClosestJudge {
 public:
  using Point = geometry::Vec3d;

  ClosestJudge(const ClosestSpace& space, const ClosestQuestion& question, ClosestSoFar& best)
      : space_(space), question_(question), best_(best), inverse2_(space.inverse2()) {}

  /// Looks at pairs [begin, end), which were measured from this question's point; leaf[i]: where the i-th is.
  void take(const EightClosest& eight, int begin, int end, const Ref* leaf) {
    int winner = -1;
    for (int i = begin; i < end; ++i)
      if (is_better(eight, i, winner)) winner = i;
    if (winner < 0) return;
    Point point;
    best_.feature = eight.nearest(winner, point);
    best_.point = space_.in_users(point);
    if (space_.gives_hints) best_.leaf = leaf[winner];
    if (certified && !best_.exact) best_.exact = user_triangle(eight, winner);
  }

 private:
  /// Takes the i-th as the best if it is. winner: the best so far, where it is among the eight; else -1.
  bool is_better(const EightClosest& eight, int i, int winner) {
    const double d2 = eight.distance2(i) * inverse2_, limit2 = question_.limit * question_.limit;
    const Id id = eight.id(i);
    if constexpr (!certified) {
      if (d2 > best_.distance2 || (d2 == best_.distance2 && id >= best_.id) || !(d2 <= limit2)) return false;
      best_.distance2 = d2, best_.id = id;
      return true;
    } else {
      if (id == best_.id) return false;
      double above, below;
      eight.error(i, above, below);
      const double low = d2 - above * inverse2_, high = d2 + below * inverse2_;
      if (low > best_.high) return false;
      std::optional<ExactlyNear> exact;
      if (high > limit2) {
        if (low > limit2) return false;
        if (!is_within(user_point(), *(exact = user_triangle(eight, i)), question_.limit)) return false;
      }
      if (!(high < best_.low)) {
        if (winner >= 0 && eight.share_feature(i, winner)) {
          if (id > best_.id) return false;
        } else {
          if (!exact) exact = user_triangle(eight, i);
          if (!best_.exact) best_.exact = user_triangle(eight, winner);
          const int order = compare(user_point(), *exact, *best_.exact);
          if (order > 0 || (order == 0 && id > best_.id)) return false;
        }
      }
      best_.distance2 = d2, best_.low = low, best_.high = high, best_.id = id;
      best_.exact = std::move(exact);
      return true;
    }
  }
  Point user_point() const { return Point(question_.point); }
  /// As the user gave it, but for coordinates that scaling has made denormal or 0 beside the typical one
  /// (triangle_scale.hpp): moving lost nothing.
  std::optional<ExactlyNear> user_triangle(const EightClosest& eight, int i) const {
    const auto t = eight.triangle(i);
    return ExactlyNear(user_point(), {space_.in_users(t.a), space_.in_users(t.b), space_.in_users(t.c)},
                       eight.certain_feature(i));
  }

  const ClosestSpace& space_;
  const ClosestQuestion& question_;
  ClosestSoFar& best_;
  double inverse2_;
};

}  // namespace treeline::accel::wide
