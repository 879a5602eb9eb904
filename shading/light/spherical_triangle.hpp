// Directions to a triangle, evenly over the spherical triangle that it subtends.
//
// Source: Arvo 1995: u cuts off a smaller triangle by its area, v goes along the cut. His formulas take
// angles of the corners, whose sum less pi is the area: for small triangles nothing is left of it. Here the
// area E stands in tan(E / 2) = tan(b / 2) tan(c / 2) sin A / (1 + tan(b / 2) tan(c / 2) cos A), which gives
// the cut side b directly; sides and angles come from the triangle's edges, not from differences of
// directions. Relative errors stay at some 1e-15 for triangles of any size, over the sine of the elevation
// above their plane. Cost: some 200 ns to set up, 40 a sample. Known weakness: no cosine, no horizon.
#pragma once

#include "shading/light/solid_angle.hpp"

namespace treeline::shading::light {

class SphericalTriangle {
 public:
  /// From any side. From a point of its plane, within rounding, and of a triangle without area, the solid
  /// angle is 0, and there is nothing to sample.
  SphericalTriangle(const Triangle3d& triangle, const Vec3d& from) : triangle_(triangle), from_(from) {
    solid_angle_ = triangle_solid_angle(triangle, from);
    if (!(solid_angle_ > 0)) return;
    // The corners from the one where the shortest side starts: sides of nearly half a turn, from a point that
    // all but touches them, are then no side of a formula.
    std::array<Vec3d, 3> corners{triangle.a, triangle.b, triangle.c};
    const std::array<Vec3d, 3> to{normalized(corners[0] - from), normalized(corners[1] - from),
                                  normalized(corners[2] - from)};
    const std::array<double, 3> cosines{dot(to[0], to[1]), dot(to[1], to[2]), dot(to[2], to[0])};
    std::rotate(corners.begin(),
                corners.begin() + (std::max_element(cosines.begin(), cosines.end()) - cosines.begin()),
                corners.end());
    const Vec3d a = corners[0] - from, b = corners[1] - from;
    const Vec3d ab = corners[1] - corners[0], ac = corners[2] - corners[0];
    const double la = length(a), lb = length(b), volume = dot(a, cross(ab, ac));
    // Normals of the planes through the point and the edges at a: the angle between them is the corner's.
    const Vec3d nb = cross(a, ab), nc = cross(a, ac);
    const double sine = la * std::abs(volume), cosine = dot(nb, nc), scale = std::hypot(sine, cosine);
    sin_a_ = sine / scale, cos_a_ = cosine / scale;
    one_minus_cos_a_ = cos_a_ > 0 ? sin_a_ * sin_a_ / (1 + cos_a_) : 1 - cos_a_;
    tan_half_c_ = length(nb) / (la * lb + dot(a, b));
    unit_b_ = b / lb;
    const Vec3d across = cross(cross(unit_b_, -ab), unit_b_);
    if (!(length2(across) > 0)) {  // one corner hides another: what is left of the triangle is rounding
      solid_angle_ = 0;
      return;
    }
    toward_a_ = normalized(across);
    inward_ = cross(unit_b_, toward_a_);  // its sign: to the side of c
    if (volume > 0) inward_ = -inward_;
  }

  double solid_angle() const { return solid_angle_; }
  /// Per steradian, of each direction within the triangle.
  double pdf() const { return 1 / solid_angle_; }

  /// Unit; u, v in [0, 1). The solid angle must not be 0.
  Vec3d sample(double u, double v) const {
    const double half = 0.5 * u * solid_angle_, s = std::sin(half), c = std::cos(half);
    const double p = tan_half_c_, q = s,
                 r = std::max(0.0, p * (sin_a_ * c - cos_a_ * s));  // tan(b / 2) = q / r
    // Of the cut-off side b and of side c: sines, cosines, and what is common to both.
    const double nb = q * q + r * r, nc = 1 + p * p;
    const double sin_b = 2 * q * r / nb, sin_c = 2 * p / nc, cos_c = (1 - p * p) / nc;
    const double cross_half = q - p * r, dot_half = r + p * q;  // of half the difference b - c
    // The cut from corner b to the end of the cut-off side: 1 - cos by the law of haversines, its direction
    // by the rule of four parts.
    const double cut = 2 * cross_half * cross_half / (nb * nc) + sin_b * sin_c * one_minus_cos_a_;
    const double y = sin_a_ * sin_b,
                 x = -2 * cross_half * dot_half / (nb * nc) + cos_c * sin_b * one_minus_cos_a_;
    const double scale = std::hypot(x, y), t = v * cut, along = std::sqrt(std::max(0.0, t * (2 - t)));
    if (!(scale > 0)) return unit_b_;
    return unit_b_ * (1 - t) + toward_a_ * (along * x / scale) + inward_ * (along * y / scale);
  }

  bool contains(const Vec3d& direction) const { return triangle_covers(triangle_, from_, direction); }

 private:
  Triangle3d triangle_;
  Vec3d from_;
  double solid_angle_ = 0;
  double sin_a_ = 0, cos_a_ = 1, one_minus_cos_a_ = 0, tan_half_c_ = 0;
  Vec3d unit_b_{}, toward_a_{}, inward_{};  // unit; the last two span what is across the first
};

}  // namespace treeline::shading::light
