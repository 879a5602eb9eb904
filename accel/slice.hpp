// Cells of a tree cut by an axis-aligned plane, as convex outlines for pictures. In two dimensions the cells
// themselves are the picture, and axis and offset are ignored.
#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "accel/concepts.hpp"

namespace treeline::accel {

using Outline = std::vector<geometry::Vec2d>;
template <class T, int D>
struct Ball;  // bvh/ball.hpp

/// The part of a convex outline where normal · x <= offset (Sutherland and Hodgman 1974); may be empty.
inline Outline clipped(const Outline& outline, const geometry::Vec2d& normal, double offset) {
  Outline kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto& a = outline[i];
    const auto& b = outline[(i + 1) % outline.size()];
    const double da = dot(normal, a) - offset, db = dot(normal, b) - offset;
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
  }
  return kept;
}

/// Positive for a counter-clockwise outline. Summed as triangles at the first corner, so that outlines far
/// from the origin keep their digits.
inline double area(std::span<const geometry::Vec2d> outline) {
  double twice = 0;
  for (std::size_t i = 2; i < outline.size(); ++i) {
    const geometry::Vec2d a = outline[i - 1] - outline[0], b = outline[i] - outline[0];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

/// The cutting plane, and the two axes of the picture in ascending order.
template <int D>
struct SlicePlane {
  static_assert(D >= 1);
  int axis, u, v;
  double offset;

  SlicePlane(int axis_, double offset_) : axis(axis_), u(0), v(1), offset(offset_) {
    if constexpr (D != 2 && D != 3) throw InvalidInput("slices exist in two and three dimensions only");
    if (D == 3 && (axis < 0 || axis > 2))
      throw InvalidInput("slice axis is " + std::to_string(axis) + "; it must be 0, 1 or 2");
    if (D == 3 && std::isnan(offset)) throw InvalidInput("slice offset is not a number");
    if (D == 3) u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  }

  template <class T>
  bool cuts(const geometry::Box<T, D>& box) const {
    if (box.empty()) return false;
    if constexpr (D != 3) return true;
    return static_cast<double>(box.low[axis]) <= offset && offset <= static_cast<double>(box.high[axis]);
  }
  /// Counter-clockwise.
  template <class T>
  Outline outline(const geometry::Box<T, D>& box) const {
    const double u0 = box.low[u], u1 = box.high[u], v0 = box.low[v], v1 = box.high[v];
    return {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
  }

  template <class T>
  bool cuts(const Ball<T, D>& ball) const {
    return radius_within(ball) > 0;
  }
  /// A polygon in the circle. A ball without bounds is not cut.
  template <class T>
  Outline outline(const Ball<T, D>& ball) const {
    constexpr int corners = 32;
    const double radius = radius_within(ball);
    Outline circle;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      circle.push_back({static_cast<double>(ball.centre[u]) + radius * std::cos(angle),
                        static_cast<double>(ball.centre[v]) + radius * std::sin(angle)});
    }
    return circle;
  }

 private:
  template <class T>
  double radius_within(const Ball<T, D>& ball) const {
    const double radius = ball.radius;
    const double away = D == 3 ? std::abs(static_cast<double>(ball.centre[axis]) - offset) : 0.0;
    if (!(away < radius) || std::isinf(radius)) return 0;
    return std::sqrt(radius - away) * std::sqrt(radius + away);
  }
};

/// Cells of a tree that keeps its primitives scaled, in the user's units again.
inline std::vector<SliceCell> scaled(std::vector<SliceCell> cells, double factor) {
  for (auto& cell : cells)
    for (auto& p : cell.outline) p = p * factor;
  return cells;
}

}  // namespace treeline::accel
