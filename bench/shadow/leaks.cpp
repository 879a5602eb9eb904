#include "bench/shadow/leaks.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/tolerances.hpp"

namespace treeline::bench::shadow {
namespace {

using Shares = std::vector<double>;
namespace tolerance = geometry::tolerance;

/// What float may have done to a mean of powers of depth, none of which is beyond [-1, 1]: 7 roundings to
/// interpolate it and 7 for the fourth power; the blur's two passes add up `side` products each.
double of_moments(int side) { return (2 * (side + 2) + 14) * tolerance::unit_roundoff<float>; }

/// Where it is largest, and how far off. off(at): by what rounding may change what passes there.
template <class Passes, class Off>
Leak worst(const Passes& passes, const Off& off, double step) {
  constexpr int steps = 4000;
  Leak r;
  double where = 0, upper = 0;
  for (int k = 0; k <= steps; ++k) {
    const double at = 1 - 2.0 * k / steps, here = passes(at);
    if (here > r.most) r.most = here, where = at;
    upper = std::max(upper, here + off(at));
  }
  // Some receiver is within half a step of the place.
  const double beside = std::min(passes(where - 0.5 * step), passes(where + 0.5 * step));
  r.slack = std::max(upper - r.most, r.most - beside + off(where));
  return r;
}

/// c[0] + c[1] z + c[2] z², with depths from -1 to 1 as moments have them.
struct Quadratic {
  double c[3] = {};
  double least = 0;  ///< its mean square over the blockers
  double slope = 0;  ///< at the receiver
};

/// The q of the header. Over two blockers it vanishes at both. Over three it has the values
/// λ L(t)/p there, with Lagrange's polynomials L, the shares p and λ = 1/Σ L(t)²/p its mean square.
Quadratic least_quadratic(const Stack& stack, const Shares& shares) {
  const double t = 2 * stack.receiver - 1;
  std::vector<double> z;
  for (const double d : stack.blockers) z.push_back(2 * d - 1);
  Quadratic q;
  if (z.size() == 2) {
    const double at_receiver = (t - z[0]) * (t - z[1]);
    q.c[0] = z[0] * z[1] / at_receiver, q.c[1] = -(z[0] + z[1]) / at_receiver, q.c[2] = 1 / at_receiver;
  } else {
    constexpr double least_share = 1e-9;  // one that is not in sight has the limit's value
    double lagrange[3], share[3], sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = z[(i + 1) % 3], b = z[(i + 2) % 3];
      lagrange[i] = (t - a) * (t - b) / ((z[i] - a) * (z[i] - b));
      share[i] = std::max(shares[i], least_share);
      sum += lagrange[i] * lagrange[i] / share[i];
    }
    q.least = 1 / sum;
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = z[(i + 1) % 3], b = z[(i + 2) % 3];
      const double v = q.least * lagrange[i] / share[i] / ((z[i] - a) * (z[i] - b));
      q.c[0] += v * a * b, q.c[1] -= v * (a + b), q.c[2] += v;
    }
  }
  q.slope = q.c[1] + 2 * q.c[2] * t;
  return q;
}

}  // namespace

Leak leak_of_two_moments(const Stack& stack, const Sweep& sweep) {
  struct Statistics {
    double variance, behind;
  };
  const auto of = [&](double at) {
    const Shares p = sweep.shares(at);
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      mean += p[i] * stack.blockers[i], square += p[i] * stack.blockers[i] * stack.blockers[i];
    return Statistics{std::max(0.0, square - mean * mean), stack.receiver - mean};
  };
  const auto passes = [&](double at) {
    const auto [variance, behind] = of(at);
    return variance / (variance + behind * behind);
  };
  // The variance may be off by three times what a moment is; the receiver's depth by its slack.
  const double moment = of_moments(sweep.side);
  const auto off = [&](double at) {
    const auto [v, d] = of(at);
    const double sum = v + d * d;
    return (3 * moment * d * d + 2 * d * (moment + tolerance::shadow_depth_slack) * v) / (sum * sum);
  };
  return worst(passes, off, sweep.step);
}

Leak leak_of_four_moments(const Stack& stack, const Sweep& sweep, double alpha) {
  const auto passes = [&](double at) { return least_quadratic(stack, sweep.shares(at)).least; };
  // E[q²] = Σ c_i c_j m_(i+j): where each moment may be off by as much, it is so by that times (Σ |c|)². The
  // moments (0, .63, 0, .63) that take their place to a share of alpha have an E[q²] of their own.
  const double moment = of_moments(sweep.side), depth = 2 * tolerance::shadow_depth_slack;
  const auto off = [&](double at) {
    const Quadratic q = least_quadratic(stack, sweep.shares(at));
    const auto& c = q.c;
    const double sum = std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]);
    const double of_others = c[0] * c[0] + 0.63 * (2 * c[0] * c[2] + c[1] * c[1] + c[2] * c[2]);
    return alpha * std::max(of_others, q.least) + moment * sum * sum +
           2 * depth * std::abs(q.slope) * q.least;
  };
  return worst(passes, off, sweep.step);
}

}  // namespace treeline::bench::shadow
