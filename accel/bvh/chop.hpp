// The boxes of the pieces into which planes across an axis cut a triangle, rounded outward.
//
// Problem: spatial splits cut a long triangle many times, and no point of it may end outside all of its
// pieces' boxes. Method: the corners are ordered along the axis once; a plane then crosses the long edge and
// one of the two short ones, and a piece's box is that of its corners and crossings (as Stich, Friedrich and
// Dietrich 2009 chop into bins). Cost: some 15 operations on four floats a plane. Known weakness: a piece is
// clipped along one axis only; met with the box of what was cut before, it may be larger than the true piece.
#pragma once

#include <utility>

#include "accel/simd/packed_box.hpp"
#include "geometry/tolerances.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

class Chopper {
 public:
  Chopper(const geometry::Triangle<float>& t, int axis) : axis_(axis) {
    corner_[0] = four(t.a), corner_[1] = four(t.b), corner_[2] = four(t.c);
    const auto order = [&](int i, int j) {
      if (corner_[j][axis] < corner_[i][axis]) std::swap(corner_[i], corner_[j]);
    };
    order(0, 1), order(1, 2), order(0, 1);
    const Four magnitude =
        largest(largest(corner_[0], -corner_[0]),
                largest(largest(corner_[1], -corner_[1]), largest(corner_[2], -corner_[2])));
    pad_ = magnitude * geometry::tolerance::crossing_slack<float> + std::numeric_limits<float>::min();
    edge_[0] = edge(0, 2), edge_[1] = edge(0, 1), edge_[2] = edge(1, 2);
  }

  /// Of corner i in order along the axis.
  float at(int i) const { return corner_[i][axis_]; }
  simd::PackedBox corner(int i) const { return packed(corner_[i], corner_[i]); }
  /// Of the triangle's section with a plane between its first and last corner.
  simd::PackedBox crossing(float plane) const {
    const auto [low, high] = section(edge_[0], plane);
    const auto [low2, high2] = section(edge_[plane < at(1) ? 1 : 2], plane);
    return packed(smallest(low, low2) - pad_, largest(high, high2) + pad_);
  }

 private:
  using Four = float __attribute__((vector_size(16)));
  struct Edge {
    Four from, along;
    float start, slope;  // slope 0: too short along the axis to divide by
  };

  static Four four(const geometry::Vec3f& p) { return Four{p[0], p[1], p[2], 0}; }
  static Four largest(Four a, Four b) { return a > b ? a : b; }
  static Four smallest(Four a, Four b) { return a < b ? a : b; }
  static simd::PackedBox packed(Four low, Four high) {
    const Four l = -low;
    return simd::PackedBox::load({{l[0], l[1], l[2], 0, high[0], high[1], high[2], 0}});
  }
  Edge edge(int i, int j) const {
    const float length = corner_[j][axis_] - corner_[i][axis_];
    const bool divides = length >= std::numeric_limits<float>::min();
    return {corner_[i], corner_[j] - corner_[i], corner_[i][axis_], divides ? 1 / length : 0};
  }
  /// Low and high corner; twice the same but for an edge almost in the plane.
  static std::pair<Four, Four> section(const Edge& e, float plane) {
    if (e.slope == 0) [[unlikely]] {
      const Four end = e.from + e.along;
      return {smallest(e.from, end), largest(e.from, end)};
    }
    const Four p = e.from + e.along * ((plane - e.start) * e.slope);
    return {p, p};
  }

  int axis_;
  Four corner_[3], pad_;
  Edge edge_[3];  // from the first to the last corner, to the middle one, from there to the last
};

}  // namespace treeline::accel
