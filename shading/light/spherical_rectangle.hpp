// Directions to a rectangle, evenly over the spherical quadrilateral that it subtends.
//
// Source: Ureña, Fajardo and King 2013: u cuts off a smaller rectangle by its solid angle, in closed form; v
// goes along the cut. Their solid angle is the sum of four angles less 2 pi, of which little is left where it
// is small: here it comes from parts that do not cancel (solid_angle.hpp), and below 1e-4 sr the cut is found
// by Newton's method on such parts, from an even division of the side. Cost: some 200 ns to set up, 60 a
// sample, 250 below 1e-4 sr. Known weakness: no cosine, no horizon.
#pragma once

#include "shading/light/solid_angle.hpp"

namespace treeline::shading::light {

class SphericalRectangle {
 public:
  /// Of middle ± u ± v, with u and v perpendicular and not zero; from any side. From a point of its plane the
  /// solid angle is 0, and there is nothing to sample.
  SphericalRectangle(const Vec3d& middle, const Vec3d& u, const Vec3d& v, const Vec3d& from)
      : x_(normalized(u)), y_(normalized(v)), z_(cross(x_, y_)) {
    const Vec3d to = middle - from;
    height_ = dot(to, z_);
    if (height_ < 0) z_ = -z_, height_ = -height_;
    const double x = dot(to, x_), y = dot(to, y_), half_x = length(u), half_y = length(v);
    x0_ = x - half_x, x1_ = x + half_x, y0_ = y - half_y, y1_ = y + half_y;
    solid_angle_ = solid_angle_up_to(x1_);
    const double h2 = height_ * height_;
    b0_ = -y0_ / std::sqrt(h2 + y0_ * y0_), b1_ = y1_ / std::sqrt(h2 + y1_ * y1_);
    const double n3 = -x0_ / std::sqrt(h2 + x0_ * x0_);
    k_ = 2 * std::numbers::pi - std::acos(-b1_ * n3) - std::acos(-n3 * b0_);
  }

  double solid_angle() const { return solid_angle_; }
  /// Per steradian, of each direction within the rectangle.
  double pdf() const { return 1 / solid_angle_; }

  /// Unit; u, v in [0, 1). The solid angle must not be 0.
  Vec3d sample(double u, double v) const {
    const double x = std::clamp(solid_angle_ < small ? cut_by_newton(u) : cut(u), x0_, x1_);
    const double d2 = x * x + height_ * height_;
    const double low = y0_ / std::sqrt(d2 + y0_ * y0_), high = y1_ / std::sqrt(d2 + y1_ * y1_);
    const double s = low + v * (high - low);  // y over the distance
    const double y = s * s < 1 ? std::clamp(s * std::sqrt(d2 / (1 - s * s)), y0_, y1_) : y1_;
    return normalized(x_ * x + y_ * y + z_ * height_);
  }

  bool contains(const Vec3d& direction) const {
    const double x = dot(direction, x_) * height_, y = dot(direction, y_) * height_, z = dot(direction, z_);
    return z > 0 && x >= x0_ * z && x <= x1_ * z && y >= y0_ * z && y <= y1_ * z;
  }

 private:
  static constexpr double small = 1e-4;  // sr

  double solid_angle_up_to(double x) const {
    return rectangle_solid_angle({0.5 * (x0_ + x), 0.5 * (y0_ + y1_), height_}, {0.5 * (x - x0_), 0, 0},
                                 {0, 0.5 * (y1_ - y0_), 0}, {});
  }
  double cut(double u) const {
    const double a = u * solid_angle_ + k_, sine = std::sin(a);
    if (sine == 0) return u < 0.5 ? x0_ : x1_;  // either end of a hemisphere
    const double f = (std::cos(a) * b0_ - b1_) / sine;
    const double c = std::clamp((f > 0 ? 1 : -1) / std::sqrt(f * f + b0_ * b0_), -1.0, 1.0);
    return c * height_ / std::sqrt((1 - c) * (1 + c));
  }
  double cut_by_newton(double u) const {
    const double target = u * solid_angle_;
    double low = x0_, high = x1_, x = low + u * (high - low);
    for (int i = 0; i < 60; ++i) {
      const double off = solid_angle_up_to(x) - target;
      (off > 0 ? high : low) = x;
      const double d2 = x * x + height_ * height_;
      const double slope = height_ / d2 * (y1_ / std::sqrt(d2 + y1_ * y1_) - y0_ / std::sqrt(d2 + y0_ * y0_));
      const double next = x - off / slope;
      x = next >= low && next <= high ? next : 0.5 * (low + high);
      if (std::abs(off) <= 1e-7 * solid_angle_) break;  // the step squares the error
    }
    return x;
  }

  Vec3d x_, y_, z_;  // the last towards the rectangle's plane
  double height_ = 0, x0_ = 0, x1_ = 0, y0_ = 0, y1_ = 0, solid_angle_ = 0;
  double b0_ = 0, b1_ = 0, k_ = 0;  // as in the paper
};

}  // namespace treeline::shading::light
