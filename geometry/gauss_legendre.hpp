// Integrals over an interval by the Gauss-Legendre rule: n samples are exact for polynomials of degree 2 n
// - 1.
//
// Nodes are the roots of the Legendre polynomial, by Newton from Tricomi's estimate (Press et al., "Numerical
// recipes", 4.6). Cost: n evaluations; n²/2 operations per rule, once. Known weakness: converges slowly where
// the integrand has a kink or a narrow peak inside the interval: split it there.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace treeline::geometry {

/// Nodes in (-1, 1) in rising order, weights that add up to 2.
template <int N>
struct GaussLegendre {
  static_assert(N > 0);
  std::array<double, N> node{}, weight{};

  GaussLegendre() {
    for (int i = 0; i < (N + 1) / 2; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (N + 0.5)), slope = 1;
      for (int iteration = 0; iteration < 8; ++iteration) {
        double p = 1, before = 0;  // P_k and P_{k-1} at x
        for (int k = 1; k <= N; ++k) {
          const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
          before = p, p = next;
        }
        slope = N * (x * p - before) / (x * x - 1);
        x -= p / slope;
      }
      node[std::size_t(N - 1 - i)] = x, node[std::size_t(i)] = -x;
      weight[std::size_t(i)] = weight[std::size_t(N - 1 - i)] = 2 / ((1 - x * x) * slope * slope);
    }
    if constexpr (N % 2 == 1) node[N / 2] = 0;
  }

  /// The rule of N samples, made at the first use.
  static const GaussLegendre& rule() {
    static const GaussLegendre made;
    return made;
  }
};

/// Integral of f over [a, b] in `panels` equal parts, N samples each. f takes a double.
template <int N, class F>
auto integrate(F&& f, double a, double b, int panels = 1) {
  const auto& rule = GaussLegendre<N>::rule();
  const double half = 0.5 * (b - a) / panels;
  decltype(f(a)) sum{};
  for (int p = 0; p < panels; ++p)
    for (std::size_t k = 0; k < N; ++k)
      sum += f(a + half * (2 * p + 1 + rule.node[k])) * (half * rule.weight[k]);
  return sum;
}

}  // namespace treeline::geometry
