// Adaptive integrals of several numbers at once, in double: the rules of Gauss and Kronrod with 7 and 15
// points, halved where the two differ (Piessens et al. 1983, QUADPACK).
//
// Cost: 15 evaluations an interval. Known weakness: what lies between the first 15 points is not seen; give
// the places where the integrand is narrow as breaks.
#pragma once

#include <array>
#include <cmath>
#include <span>

namespace treeline::bench::brdf_integral {

template <std::size_t K>
using Values = std::array<double, K>;

namespace detail {

// Kronrod's nodes in [0, 1) and their weights; every second node, from the middle, is one of Gauss's.
inline constexpr double kronrod_node[8] = {0,
                                           0.207784955007898467600689403773245,
                                           0.405845151377397166906606412076961,
                                           0.586087235467691130294144691693260,
                                           0.741531185599394439863864773280788,
                                           0.864864423359769072789712788640926,
                                           0.949107912342758524526189684047851,
                                           0.991455371120812639206854697526329};
inline constexpr double kronrod_weight[8] = {
    0.209482141084727828012999174891714, 0.204432940075298892414161999234649,
    0.190350578064785409913256402421014, 0.169004726639267902826583426598550,
    0.140653259715525918745189590510238, 0.104790010322250183839876322541518,
    0.063092092629978553290700663189204, 0.022935322010529224963732008058970};
inline constexpr double gauss_weight[4] = {
    0.417959183673469387755102040816327, 0.381830050505118944950369775488975,
    0.279705391489276667901467771423780, 0.129484966168869693270611432679082};

template <std::size_t K, class F>
Values<K> halve(const F& f, double a, double b, double tolerance, int depth) {
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  Values<K> fine{}, coarse{};
  const auto add = [&](double x, double kronrod, double gauss) {
    const Values<K> y = f(x);
    for (std::size_t k = 0; k < K; ++k) fine[k] += kronrod * y[k], coarse[k] += gauss * y[k];
  };
  add(middle, kronrod_weight[0], gauss_weight[0]);
  for (int i = 1; i < 8; ++i) {
    const double gauss = i % 2 == 0 ? gauss_weight[i / 2] : 0;
    add(middle - half * kronrod_node[i], kronrod_weight[i], gauss);
    add(middle + half * kronrod_node[i], kronrod_weight[i], gauss);
  }
  double apart = 0;
  for (std::size_t k = 0; k < K; ++k) {
    fine[k] *= half;
    apart = std::max(apart, std::abs(fine[k] - coarse[k] * half));
  }
  if (!(apart > tolerance) || depth == 0) return fine;
  fine = halve<K>(f, a, middle, 0.5 * tolerance, depth - 1);
  const Values<K> right = halve<K>(f, middle, b, 0.5 * tolerance, depth - 1);
  for (std::size_t k = 0; k < K; ++k) fine[k] += right[k];
  return fine;
}

}  // namespace detail

/// Integral of f from the first to the last of the breaks, which rise. f takes a double and gives Values<K>.
template <std::size_t K, class F>
Values<K> integrate(const F& f, std::span<const double> breaks, double tolerance) {
  constexpr int depth = 14;
  Values<K> sum{};
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    if (!(breaks[i + 1] > breaks[i])) continue;
    const Values<K> part = detail::halve<K>(f, breaks[i], breaks[i + 1], tolerance, depth);
    for (std::size_t k = 0; k < K; ++k) sum[k] += part[k];
  }
  return sum;
}

}  // namespace treeline::bench::brdf_integral
