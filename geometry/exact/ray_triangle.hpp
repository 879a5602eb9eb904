// Whether a ray meets a triangle and where, without an error: for doubles of any size.
//
// Conventions: the triangle is a closed set, hit from both sides, its edges and corners included; a ray in
// its plane does not hit it, and a triangle of no area is never hit. The ray is the closed interval [t_min,
// t_max], either end may be infinite. t is the true one, rounded once to the type asked for: rounded times
// are ordered as the true ones are, but for ties.
//
// The three edge functions det(d, p, q) of the direction and two corners seen from the origin decide; they
// sum up to the determinant of the whole, d · n. Filter: with X, Y, Z the corners' largest distances along
// each axis, each has two terms of at most |dx| Y Z, two of |dy| Z X and two of |dz| X Y; 7 roundings a term
// (2 differences, 2 products, 3 sums) make the error at most gamma(7) (1 + u)^2 times the sum of the six.
// Twice 8 u times half that sum, which as computed may have lost 4 u, covers it. Range as for orientations. t
// is the quotient n · (a - o) / n · d: rounded to float, double with a bound on its error settles it nearly
// always; rounded to double, pairs of doubles do. exact_ray_triangle.hpp is the same for a tree's leaves:
// floats alone, and prepared once a ray. Cost: 9 absolute values, 6 maxima and 9 products more than the three
// edge functions; a hit some 100 ns.
#pragma once

#include <optional>

#include "geometry/exact/sign.hpp"
#include "geometry/ray.hpp"

namespace treeline::geometry {

namespace detail {

struct EdgeFunction {
  const Vec3d &o, &d, &p, &q;
  template <class N>
  N operator()() const {
    using V = Vec<N, 3>;
    const V origin(o);
    return dot(V(d), cross(V(p) - origin, V(q) - origin));
  }
};

struct RayTime {  // n · (a - o) - limit · (n · d)
  const Rayd& ray;
  const Triangle3d& triangle;
  double limit;
  template <class N>
  void quotient(N& above, N& below) const {
    using V = Vec<N, 3>;
    const V a(triangle.a), n = cross(V(triangle.b) - a, V(triangle.c) - a);
    above = dot(n, a - V(ray.origin)), below = dot(n, V(ray.direction));
  }
  template <class N>
  N operator()() const {
    N above, below;
    quotient(above, below);
    return above - N(limit) * below;
  }
};

/// The quotient rounded to T, if the bounds on the errors leave one value only.
template <class T>
std::optional<T> rounded_if_certain(const BoundedDouble& a, const BoundedDouble& b) {
  const double q = a.value() / b.value();
  if (!(std::abs(b.value()) > 0x1p20 * b.error()) || !(0x1p-900 < std::abs(q) && std::abs(q) < 0x1p1000))
    return {};
  const double rest = (std::fma(-q, b.value(), a.value()) + (a.rest() - q * b.rest())) / b.value();
  // The errors of both, and some 10 u² of the quotient for the division; doubled for the bound's own
  // roundings.
  const double error =
      2 * ((a.error() + std::abs(q) * b.error()) / std::abs(b.value()) + 0x1p-102 * std::abs(q));
  const Split s = two_sum(q, rest);
  double low = s.value + (s.error - error), high = s.value + (s.error + error);
  if constexpr (sizeof(T) < sizeof(double))  // rounded a second time below: once more outward
    low = std::nextafter(low, -INFINITY), high = std::nextafter(high, INFINITY);
  if (!std::isfinite(low) || static_cast<T>(low) != static_cast<T>(high)) return {};
  return static_cast<T>(low);
}

}  // namespace detail

/// The sign of t - limit, where t is where the ray meets the triangle's plane, which it must not run along.
inline int exact_time_against(const Rayd& ray, const Triangle3d& triangle, double limit, int facing) {
  if (std::isinf(limit)) return limit > 0 ? -1 : 1;
  return facing * exact_sign(detail::RayTime{ray, triangle, limit});
}

/// 1 if the ray's line hits the triangle along its normal, -1 if against it, 0 if it misses. (Not inlined: as
/// for orientations.)
[[gnu::noinline]] inline int line_meets(const Rayd& ray, const Triangle3d& triangle) {
  const Vec3d &o = ray.origin, &d = ray.direction;
  const Vec3d a = triangle.a - o, b = triangle.b - o, c = triangle.c - o;
  double m[3], s[3];
  for (int k = 0; k < 3; ++k) {
    const double x = std::abs(a[k]), y = std::abs(b[k]), z = std::abs(c[k]);
    const double xy = x > y ? x : y;
    m[k] = xy > z ? xy : z, s[k] = std::abs(d[k]);
  }
  const double size = s[0] * (m[1] * m[2]) + s[1] * (m[2] * m[0]) + s[2] * (m[0] * m[1]);
  const double bound = 16 * 0x1p-53 * size;
  const double e[3] = {dot(d, cross(b, c)), dot(d, cross(c, a)), dot(d, cross(a, b))};
  const bool in_range = (size > 0x1p-600) & (m[0] + m[1] + m[2] < 0x1p330) & (s[0] + s[1] + s[2] < 0x1p330);
  // Without a branch a test: which of them fails is anyone's guess.
  const bool above = (e[0] > bound) | (e[1] > bound) | (e[2] > bound);
  const bool below = (e[0] < -bound) | (e[1] < -bound) | (e[2] < -bound);
  const bool all = (std::abs(e[0]) > bound) & (std::abs(e[1]) > bound) & (std::abs(e[2]) > bound);
  if (in_range & ((above & below) | all)) [[likely]]
    return int(above) - int(below);
  const Vec3d* const corner[3] = {&triangle.a, &triangle.b, &triangle.c};
  bool positive = false, negative = false;
  for (int i = 0; i < 3; ++i) {
    int sign;
    if (in_range && std::abs(e[i]) > bound) [[likely]]
      sign = e[i] > 0 ? 1 : -1;
    else
      sign = exact_sign(detail::EdgeFunction{o, d, *corner[(i + 1) % 3], *corner[(i + 2) % 3]});
    positive = positive || sign > 0, negative = negative || sign < 0;
  }
  // Both: outside; neither: in the plane, or no area. A degenerate triangle's functions sum up to 0.
  return positive == negative ? 0 : positive ? 1 : -1;
}

/// The t of the hit in [t_min, t_max], rounded once, or none. Every number must be finite but the ends.
template <class T = double>
std::optional<T> exact_hit(const Rayd& ray, const Triangle3d& triangle) {
  const int facing = line_meets(ray, triangle);
  if (facing == 0) return {};
  const detail::RayTime time{ray, triangle, 0};
  BoundedDouble above, below;
  time.quotient(above, below);
  // Against the ends of the interval: by the quotient with a generous error, else exactly.
  const double q = above.value() / below.value();
  const bool sound = below.error() < 0x1p-60 * std::abs(below.value());
  const double error = 0x1p-50 * std::abs(q) + 2 * above.error() / std::abs(below.value());
  const auto sign_against = [&](double limit) {
    if (sound && std::abs(q - limit) > error) return q < limit ? -1 : 1;
    return exact_time_against(ray, triangle, limit, facing);
  };
  if (sign_against(ray.t_min) < 0 || sign_against(ray.t_max) > 0) return {};
  if (const auto t = detail::rounded_if_certain<T>(above, below)) return t;
  Dyadic n, d;
  time.quotient(n, d);
  return rounded_quotient<T>(n, d);
}

}  // namespace treeline::geometry
