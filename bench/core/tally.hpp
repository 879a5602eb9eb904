// Errors of single answers, summed up for a row.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "bench/core/row.hpp"

namespace treeline::bench {

struct ErrorTally {
  std::vector<double> errors;  // not negative
  double signed_sum = 0;

  void add(double error, double signed_error) { errors.push_back(error), signed_sum += signed_error; }
  /// Sets error and mean to the mean, max, p99 and bias; sorts the errors. Nothing without answers.
  void write(Errors& e) {
    if (errors.empty()) return;
    const auto n = static_cast<double>(errors.size());
    std::ranges::sort(errors);
    e.error = e.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
    e.max = errors.back();
    e.p99 = errors[static_cast<std::size_t>(0.99 * (n - 1))];
    e.bias = signed_sum / n;
  }
};

}  // namespace treeline::bench
