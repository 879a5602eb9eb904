// Directions to a ball, evenly over the cap that it subtends.
//
// Source: Archimedes; Shirley, Wang and Zimmerman 1996. Cost: a sine and a cosine a sample. 1 - cos of the
// angle is computed, not the cosine: far balls keep their digits. Known weakness: none of its own; a ball in
// part below a receiver's horizon is sampled as a whole.
#pragma once

#include "geometry/sampling.hpp"
#include "shading/light/solid_angle.hpp"

namespace treeline::shading::light {

class SphericalCap {
 public:
  /// All directions within the angle, in [0, pi], of the unit axis.
  SphericalCap(const Vec3d& axis, double angle)
      : frame_(axis), extent_(2 * std::sin(angle / 2) * std::sin(angle / 2)) {}
  /// That a ball of radius > 0 subtends at a point; all directions from within it.
  SphericalCap(const Vec3d& middle, double radius, const Vec3d& from)
      : frame_(middle == from ? Vec3d{0, 0, 1} : normalized(middle - from)),
        extent_(detail::ball_one_minus_cosine(radius, distance(middle, from))) {}

  double solid_angle() const { return hemisphere_solid_angle * extent_; }
  /// Per steradian, of each direction within the cap.
  double pdf() const { return 1 / solid_angle(); }
  /// Unit; u, v in [0, 1).
  Vec3d sample(double u, double v) const {
    const Vec2d q = geometry::sample_disc(u, v);
    const double t = std::min(1.0, length2(q)) * extent_, stretch = std::sqrt(extent_ * (2 - t));
    return frame_(Vec3d{q[0] * stretch, q[1] * stretch, 1 - t});
  }
  bool contains(const Vec3d& direction) const {
    const Vec3d off = direction - frame_.z;  // half its square is 1 - cos
    return length2(off) <= 2 * extent_;
  }

 private:
  geometry::Frame<double> frame_;
  double extent_;  // 1 - cos of the angle
};

}  // namespace treeline::shading::light
