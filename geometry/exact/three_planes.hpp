// On which side of a plane the point lies where three others meet, without an error.
//
// Conventions: planes are { x : normal · x = offset } with normals of any length but zero; 1 on the side the
// normal points to, 0 on the plane, -1 behind; nothing if the three do not meet in one point. Any finite
// doubles.
//
// By Cramer's rule the point is (o1 n2 x n3 + o2 n3 x n1 + o3 n1 x n2) / D with D = n1 · (n2 x n3), and the
// sign is that of two determinants. Filter: with S1, S2, S3 the largest components of each normal, D has six
// terms of at most S1 S2 S3 and 5 roundings (2 products, 3 sums): 32 u S1 S2 S3 covers them. The other has 24
// terms, of at most Oi Sj Sk S4 or S1 S2 S3 O4 with O the offsets' magnitudes, and 8 roundings: 24 · 8.1 =
// 195; 200 u times S4 (O1 S2 S3 + S1 O2 S3 + S1 S2 O3) + S1 S2 S3 O4 covers it generously (each of these
// stands for six terms). Cost: some 45 operations and the maxima. Known weakness: planes given in doubles are
// rarely concurrent, so that the exact path is for those that are whole numbers.
#pragma once

#include <optional>

#include "geometry/exact/sign.hpp"
#include "geometry/plane.hpp"

namespace treeline::geometry {

namespace detail {
struct PlaneDeterminant {  // of three normals
  const Plane3d &a, &b, &c;
  template <class N>
  N operator()() const {
    using V = Vec<N, 3>;
    return dot(V(a.normal), cross(V(b.normal), V(c.normal)));
  }
};
struct PlaneIncidence {  // D times the point's height above d
  const Plane3d &a, &b, &c, &d;
  template <class N>
  N operator()() const {
    using V = Vec<N, 3>;
    const V p(a.normal), q(b.normal), r(c.normal), n(d.normal);
    const V qr = cross(q, r);
    const N first = N(a.offset) * dot(n, qr) + N(b.offset) * dot(n, cross(r, p));
    return first + N(c.offset) * dot(n, cross(p, q)) - N(d.offset) * dot(p, qr);
  }
};
inline double largest(const Vec3d& v) {
  const double x = std::abs(v[0]), y = std::abs(v[1]), z = std::abs(v[2]), xy = x > y ? x : y;
  return xy > z ? xy : z;
}
}  // namespace detail

inline std::optional<int> side_of_meeting_point(const Plane3d& a, const Plane3d& b, const Plane3d& c,
                                                const Plane3d& d) {
  const Vec3d bc = cross(b.normal, c.normal), ca = cross(c.normal, a.normal), ab = cross(a.normal, b.normal);
  const double whole = dot(a.normal, bc);
  const double height = dot(d.normal, bc * a.offset + ca * b.offset + ab * c.offset) - d.offset * whole;
  const double p = detail::largest(a.normal), q = detail::largest(b.normal), r = detail::largest(c.normal);
  const double s = detail::largest(d.normal), pqr = p * q * r;
  const double size =
      s * (std::abs(a.offset) * (q * r) + p * (std::abs(b.offset) * r + q * std::abs(c.offset))) +
      pqr * std::abs(d.offset);
  constexpr double u = 0x1p-53;
  // Factors below 2^200, and sums above 2^-600: underflow's errors, at most 2^-1074 · 2^400, are below u² of
  // them.
  const double factors =
      p + q + r + s + std::abs(a.offset) + std::abs(b.offset) + std::abs(c.offset) + std::abs(d.offset);
  const bool in_range = factors < 0x1p200 && pqr > 0x1p-600 && size > 0x1p-600;
  if (in_range && std::abs(whole) > 32 * u * pqr && std::abs(height) > 200 * u * size) [[likely]]
    return (whole > 0) == (height > 0) ? 1 : -1;
  const int sign = exact_sign(detail::PlaneDeterminant{a, b, c});
  if (sign == 0) return {};
  return sign * exact_sign(detail::PlaneIncidence{a, b, c, d});
}

}  // namespace treeline::geometry
