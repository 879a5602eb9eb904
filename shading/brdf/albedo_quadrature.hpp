// Integrals over the directions of light that a rough surface reflects towards one viewer: by two independent
// quadratures in double, so that each is the other's witness.
//
//  integrate_by_normals: over the slopes of the half vector, in polar coordinates, each azimuth up to where
//  the
//    reflection meets the horizon (2θ = atan2(cosθo, -o·e)). There the integrand is smooth at any roughness.
//  integrate_by_directions: over the light's own polar angles about the surface's normal, adaptively,
//  starting
//    from panels that narrow towards the mirror direction.
//
// f(wi) returns a double or a Vec of doubles: what to integrate, per steradian, its cosine included. It may
// have a peak as wide as the roughness about the mirror direction and features as wide as the cosine of the
// viewer near the horizon, and should be smooth otherwise; lamps with an edge want an integral of their own.
// Cost: some 10⁴ evaluations of f by normals, 10⁵ to 10⁶ by directions. Accuracy: they agree to 1e-8 for α
// from 0.02 up and viewers down to cosθ = 0.02. Known weakness of the second: time grows as 1/α.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "geometry/gauss_legendre.hpp"
#include "shading/brdf/directions.hpp"

namespace treeline::shading::brdf {

namespace detail {

/// Calls part(a, b) for panels from `fine` to `end` (on either side of it), four times as wide each, the
/// first `width` wide.
template <class Part>
void graded(double fine, double end, double width, Part&& part) {
  const double sign = end < fine ? -1 : 1, whole = std::abs(end - fine);
  for (double low = 0, high = std::min(width, whole); low < whole;
       low = high, high = std::min(4 * high, whole)) {
    if (4 * high > whole && high < whole && 2 * high > whole) high = whole;  // no sliver at the end
    part(fine + sign * low, fine + sign * high);
  }
}
/// The same from both ends of an interval; a, b: the order of each part's ends is as it comes.
template <class Part>
void graded_from_both(double a, double b, double width, Part&& part) {
  const double middle = 0.5 * (a + b);
  graded(a, middle, width, part);
  graded(b, middle, width, [&](double from, double to) { part(to, from); });
}

inline double magnitude(double x) { return std::abs(x); }
template <int D>
double magnitude(const geometry::Vec<double, D>& x) {
  double m = 0;
  for (int i = 0; i < D; ++i) m = std::max(m, std::abs(x[i]));
  return m;
}

/// Halves [a, b] until 10 samples on the whole and on the halves agree to the tolerance (absolute).
template <class F>
auto integrate_adaptively(F&& f, double a, double b, double tolerance, int depth = 24) {
  const auto step = [&](const auto& self, double low, double high, const auto& whole, int left) {
    const double middle = 0.5 * (low + high);
    const auto first = geometry::integrate<10>(f, low, middle),
               second = geometry::integrate<10>(f, middle, high);
    const auto sum = first + second;
    if (left == 0 || !(magnitude(sum - whole) > tolerance)) return sum;
    return self(self, low, middle, first, left - 1) + self(self, middle, high, second, left - 1);
  };
  return step(step, a, b, geometry::integrate<10>(f, a, b), depth);
}

}  // namespace detail

/// N: samples per panel and dimension; 12 for truths, 5 for tables. wo above the surface.
template <int N = 12, class F>
auto integrate_by_normals(double ax, double ay, const Direction<double>& wo, F&& f) {
  using Value = std::decay_t<decltype(f(wo))>;
  constexpr double pi = std::numbers::pi;
  const double across = std::hypot(wo[0], wo[1]), azimuth = std::atan2(wo[1], wo[0]);
  // Along one azimuth: slopes r/q with r = sinh s, q the slope's scale there.
  const auto along = [&](double phi) {
    const double c = std::cos(phi), s = std::sin(phi), q = std::hypot(c / ax, s / ay);
    const double forward = wo[0] * c + wo[1] * s;
    const double end = std::asinh(q * std::tan(0.5 * std::atan2(wo[2], -forward)));
    const auto at = [&](double t) {
      const double r = std::sinh(t), slope = r / q, z = 1 / std::sqrt(1 + slope * slope);
      const Direction<double> h{slope * z * c, slope * z * s, z};
      const double facing = geometry::dot(wo, h);
      return f(reflected(wo, h)) * (4 * facing * z * z * z * r * std::cosh(t) / (q * q));
    };
    // Shadowing of the light changes within α of the horizon.
    Value sum{};
    double width = std::clamp(2 * std::min(ax, ay), 1e-3, 0.7);
    for (double high = end; high > 0; width = std::min(4 * width, 0.7)) {
      const double low = std::max(high - width, 0.0);
      sum += geometry::integrate<N>(at, low, high);
      high = low;
    }
    return sum;
  };
  // Around: the horizon's distance jumps where the azimuth is square to the view, and the scale q has a peak
  // along the axis of the rougher tangent.
  struct Mark {
    double phi, width;
  };
  Mark marks[4];
  int count = 0;
  const auto turned = [&](double phi) { return phi - 2 * pi * std::floor(phi / (2 * pi)); };
  const double view = std::clamp(wo[2] / std::max(across, 1e-300), 1e-9, 1.0);
  for (const double side : {-0.5, 0.5}) marks[count++] = {turned(azimuth + side * pi), view};
  if (ax != ay)
    for (const double side : {0.0, pi})
      marks[count++] = {ax > ay ? side : side + 0.5 * pi, std::min(ax, ay) / std::max(ax, ay)};
  const Mark given[4] = {marks[0], marks[1], marks[2], marks[3]};
  for (int m = 0; m < count; ++m)  // one next to a narrower one is as narrow as the distance
    for (int k = 0; k < count; ++k) {
      const double apart = std::abs(std::remainder(given[m].phi - given[k].phi, 2 * pi));
      marks[m].width = std::min(marks[m].width, given[k].width + apart);
    }
  std::sort(marks, marks + count, [](const Mark& a, const Mark& b) { return a.phi < b.phi; });
  Value sum{};
  for (int m = 0; m < count; ++m) {
    const Mark from = marks[m],
               to = m + 1 < count ? marks[m + 1] : Mark{marks[0].phi + 2 * pi, marks[0].width};
    const double middle = 0.5 * (from.phi + to.phi);
    if (!(to.phi > from.phi)) continue;
    detail::graded(from.phi, middle, from.width,
                   [&](double a, double b) { sum += geometry::integrate<N>(along, a, b); });
    detail::graded(to.phi, middle, to.width,
                   [&](double a, double b) { sum += geometry::integrate<N>(along, b, a); });
  }
  return sum;
}

/// tolerance: absolute, of each panel. wo above the surface.
template <class F>
auto integrate_by_directions(double ax, double ay, const Direction<double>& wo, F&& f,
                             double tolerance = 1e-10) {
  using Value = std::decay_t<decltype(f(wo))>;
  constexpr double pi = std::numbers::pi;
  const double across = std::hypot(wo[0], wo[1]), mirror = std::atan2(across, wo[2]);
  const double azimuth = across > 0 ? std::atan2(-wo[1], -wo[0]) : 0, width = 0.25 * std::min({ax, ay, 1.0});
  const auto along = [&](double phi) {
    const double c = std::cos(phi), s = std::sin(phi);
    const auto at = [&](double theta) {
      const double sine = std::sin(theta);
      return f(Direction<double>{sine * c, sine * s, std::cos(theta)}) * sine;
    };
    Value sum{};
    const auto part = [&](double a, double b) {
      sum += detail::integrate_adaptively(at, std::min(a, b), std::max(a, b), tolerance);
    };
    if (mirror > 0) detail::graded(mirror, 0, width, part);
    detail::graded(mirror, 0.5 * pi, width, part);
    return sum;
  };
  Value sum{};
  const auto part = [&](double a, double b) {
    sum += detail::integrate_adaptively(along, std::min(a, b), std::max(a, b), tolerance);
  };
  const double wide = width * std::min(1.0, wo[2] / std::max(across, 1e-300));
  detail::graded(azimuth, azimuth - pi, wide, part);
  detail::graded(azimuth, azimuth + pi, wide, part);
  return sum;
}

}  // namespace treeline::shading::brdf
