#include "bench/shadow/judge.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace treeline::bench::shadow {

Errors judged(std::span<const float> answers, std::span<const double> truth, double floor) {
  Errors e;
  const std::size_t n = truth.size();
  if (n == 0) return e;
  std::vector<double> off(n);
  double sum = 0, squares = 0, bias = 0, between = 0;
  std::size_t penumbra = 0, lit = 0, dark = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float a = answers[i];
    double d = double(a) - truth[i];
    if (!(a >= -share_slack && a <= 1 + share_slack)) {
      if (e.within_claim)
        e.reason = "receiver " + std::to_string(i) + " is answered " + std::to_string(a) + ", no share";
      e.within_claim = false;
      d = truth[i] < 0.5 ? 1 : -1;
    }
    off[i] = std::abs(d);
    sum += off[i], squares += d * d, bias += d;
    lit += d > much, dark += d < -much;
    if (truth[i] > penumbra_low && truth[i] < penumbra_high) ++penumbra, between += d * d;
  }
  const auto count = static_cast<double>(n);
  std::ranges::sort(off);
  e.error = std::sqrt(squares / count), e.mean = sum / count, e.bias = bias / count, e.floor = floor;
  e.extra = {
      {"shadow_max", off.back()},
      {"shadow_p99", off[static_cast<std::size_t>(0.99 * (count - 1))]},
      {"shadow_penumbra", penumbra > 0 ? Knobs(std::sqrt(between / double(penumbra))) : Knobs(nullptr)},
      {"shadow_penumbra_share", double(penumbra) / count},
      {"shadow_false_lit", double(lit) / count},
      {"shadow_false_dark", double(dark) / count},
      {"shadow_wrong", double(lit + dark) / count}};
  return e;
}

}  // namespace treeline::bench::shadow
