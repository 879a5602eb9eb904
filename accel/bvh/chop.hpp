// The boxes of the pieces into which planes across an axis cut a triangle, rounded outward.
//
// Problem: spatial splits cut a long triangle many times, and no point of it may end outside all of its
// pieces' boxes. Method: a piece's box is that of its corners and of the edges' crossings with the planes
// about it (as Stich, Friedrich and Dietrich 2009 chop into bins). All three edges are tried at every plane
// and those that do not cross are masked: which they are, no machine foresees. Cost: some 25 operations on
// four floats a plane. Known weakness: a piece is clipped along one axis only; met with the box of what was
// cut before, it may be larger than the true piece.
#pragma once

#include "accel/simd/packed_box.hpp"
#include "geometry/tolerances.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

class Chopper {
 public:
  explicit Chopper(const geometry::Triangle<float>& t) {
    corner_[0] = four(t.a), corner_[1] = four(t.b), corner_[2] = four(t.c);
    Four magnitude{};
    for (int i = 0; i < 3; ++i) {
      edge_[i] = corner_[(i + 1) % 3] - corner_[i];
      magnitude = largest(magnitude, largest(corner_[i], -corner_[i]));
    }
    pad_ = magnitude * geometry::tolerance::crossing_slack<float> + Limits::min();
    overflows_ = any(magnitude > Limits::max() / 4);
    along(0);
  }

  /// Turns to planes across this axis.
  void along(int axis) {
    start_ = Four{corner_[0][axis], corner_[1][axis], corner_[2][axis], 0};
    end_ = Four{start_[1], start_[2], start_[0], 0};
    const Four length = end_ - start_, size = largest(length, -length);
    inverse_ = 1.0f / length;
    no_slope_ = overflows_ || any((size > 0.0f) & (size < Limits::min()));
  }

  /// Of corner i along the axis.
  float at(int i) const { return start_[i]; }
  simd::PackedBox corner(int i) const { return simd::PackedBox::of(-corner_[i], corner_[i]); }

  /// Of the triangle's section with a plane; empty if that does not cross it.
  simd::PackedBox crossing(float plane) const {
    if (no_slope_) [[unlikely]]
      return merged(corner(0), merged(corner(1), corner(2)));
    const Four t = (plane - start_) * inverse_;
    const Mask crosses = (start_ < plane) ^ (end_ < plane);
    Four low = Four{} + std::numeric_limits<float>::infinity(), high = -low;
    const auto add = [&](int i, Four share, Mask valid) {
      const Four p = corner_[i] + edge_[i] * share;
      low = valid ? smallest(p, low) : low, high = valid ? largest(p, high) : high;
    };
    add(0, __builtin_shufflevector(t, t, 0, 0, 0, 0), __builtin_shufflevector(crosses, crosses, 0, 0, 0, 0));
    add(1, __builtin_shufflevector(t, t, 1, 1, 1, 1), __builtin_shufflevector(crosses, crosses, 1, 1, 1, 1));
    add(2, __builtin_shufflevector(t, t, 2, 2, 2, 2), __builtin_shufflevector(crosses, crosses, 2, 2, 2, 2));
    return simd::PackedBox::of(pad_ - low, high + pad_);
  }

 private:
  using Limits = std::numeric_limits<float>;
  using Four = float __attribute__((vector_size(16)));
  using Mask = std::int32_t __attribute__((vector_size(16)));

  static Four four(const geometry::Vec3f& p) { return Four{p[0], p[1], p[2], 0}; }
  static Four largest(Four a, Four b) { return a > b ? a : b; }
  static Four smallest(Four a, Four b) { return a < b ? a : b; }
  static bool any(Mask m) { return (m[0] | m[1] | m[2]) != 0; }

  Four corner_[3], edge_[3], pad_, start_, end_, inverse_;  // edge i leads from corner i to the next
  bool overflows_, no_slope_;                               // edges too long, or too short to divide by
};

}  // namespace treeline::accel
