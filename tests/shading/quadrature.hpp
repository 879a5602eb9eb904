// Integrals over rectangles by halving until two rules agree: a witness that knows no closed form, and that
// edges do not mislead.
#pragma once

#include <array>
#include <cmath>

namespace treeline::shading::test {

/// Gauss and Legendre's rule of 4 × 4 points.
template <class F>
double gauss_4x4(const F& f, double x0, double x1, double y0, double y1) {
  constexpr std::array<double, 4> at{-0.86113631159405258, -0.33998104358485626, 0.33998104358485626,
                                     0.86113631159405258},
      weight{0.34785484513745386, 0.65214515486254614, 0.65214515486254614, 0.34785484513745386};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      sum += weight[i] * weight[j] *
             f(0.5 * (x0 + x1) + 0.5 * (x1 - x0) * at[i], 0.5 * (y0 + y1) + 0.5 * (y1 - y0) * at[j]);
  return 0.25 * (x1 - x0) * (y1 - y0) * sum;
}

/// Of f(x, y) over [x0, x1] × [y0, y1], to an absolute error of about `tolerance`; or, at edges that f has,
/// as near as `depth` halvings bring it.
template <class F>
double integral(const F& f, double x0, double x1, double y0, double y1, double tolerance, int depth = 12) {
  const auto refine = [&](const auto& self, double a, double b, double c, double d, double whole,
                          double allowed, int left) -> double {
    const double x = 0.5 * (a + b), y = 0.5 * (c + d);
    const std::array<double, 4> parts{gauss_4x4(f, a, x, c, y), gauss_4x4(f, x, b, c, y),
                                      gauss_4x4(f, a, x, y, d), gauss_4x4(f, x, b, y, d)};
    const double sum = parts[0] + parts[1] + parts[2] + parts[3];
    if (left == 0 || std::abs(sum - whole) <= allowed) return sum;
    return self(self, a, x, c, y, parts[0], allowed / 4, left - 1) +
           self(self, x, b, c, y, parts[1], allowed / 4, left - 1) +
           self(self, a, x, y, d, parts[2], allowed / 4, left - 1) +
           self(self, x, b, y, d, parts[3], allowed / 4, left - 1);
  };
  return refine(refine, x0, x1, y0, y1, gauss_4x4(f, x0, x1, y0, y1), tolerance, depth);
}

}  // namespace treeline::shading::test
