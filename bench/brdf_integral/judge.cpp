#include "bench/brdf_integral/judge.hpp"

#include <algorithm>
#include <cmath>

#include "bench/core/tally.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::brdf_integral {
namespace {

constexpr double enough_samples = 200;  // that count, so that a mean is normally distributed about
constexpr double nothing = 1e-9;        // is reflected: errors are not held against it
constexpr double arithmetic = 1e-6;     // what a sample in floats is worth
constexpr double rounding = double(geometry::tolerance::unit_roundoff<float>);

void broken(Errors& e, std::string reason) {
  if (e.within_claim) e.reason = std::move(reason);
  e.within_claim = false;
}

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / double(values.size());
}

/// Sets error to the root of the mean of the squares, over scale as all else.
void write(ErrorTally& tally, double squares, double scale, double floor, Errors& e) {
  const auto n = double(std::max<std::size_t>(tally.errors.size(), 1));
  tally.write(e);
  if (tally.errors.empty()) return;
  e.error = std::sqrt(squares / n) / scale;
  *e.max /= scale, *e.p99 /= scale, *e.mean /= scale, *e.bias /= scale;
  e.floor = std::max(floor / scale, rounding);  // answers are floats
}

}  // namespace

Errors judge_integrals(const Set& set, std::span<const float> answers, const Truth& truth) {
  Errors e;
  ErrorTally tally;
  double squares = 0, largest = 0;
  const double mean = mean_of(truth.values), scale = mean > nothing ? mean : 1;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const double answer = double(answers[i]);
    if (!(answer >= 0 && std::isfinite(answer))) {
      broken(e, "query " + std::to_string(i / 3) + ": reflects " + std::to_string(answer));
      continue;
    }
    const double off = answer - truth.values[i / (3 * set.repeats) * 3 + i % 3];
    tally.add(std::abs(off), off);
    squares += off * off, largest = std::max(largest, answer);
  }
  write(tally, squares, scale, truth.floor, e);
  e.extra["brdf_integral_truth"] = mean;
  e.extra["brdf_integral_truth_max"] = truth.values.empty() ? 0 : *std::ranges::max_element(truth.values);
  e.extra["brdf_integral_answer_max"] = largest;
  return e;
}

void judge_spread(const Set& set, std::span<const float> answers, const Truth& truth,
                  std::span<const Moments> moments, Errors& e) {
  const std::size_t viewers = truth.values.size() / 3, each = set.repeats;
  double off = 0, variance = 0;
  for (std::size_t v = 0; v < viewers; ++v) {
    const double is = truth.values[3 * v] + truth.values[3 * v + 1] + truth.values[3 * v + 2];
    double sum = 0, squares = 0;
    for (std::size_t i = v * each; i < (v + 1) * each; ++i) {
      const double d = double(answers[3 * i]) + double(answers[3 * i + 1]) + double(answers[3 * i + 2]) - is;
      sum += d, squares += d * d;
    }
    off += sum / double(each);
    variance += (squares - sum * sum / double(each)) / (double(each) * double(each - 1));
  }
  double kurtosis = 0, share = 0, count = INFINITY;
  for (const Moments& m : moments) {
    if (!(m.sum > 0)) {
      count = 0;
      continue;
    }
    const double a = m.sum / m.n, v = m.sum2 / m.n - a * a;
    const double fourth = m.sum4 / m.n - 4 * a * m.sum3 / m.n + 6 * a * a * m.sum2 / m.n - 3 * a * a * a * a;
    if (v > rounding * a * a) kurtosis = std::max(kurtosis, fourth / (v * v));
    share = std::max(share, m.largest / m.sum);
    count = std::min(count, m.sum * m.sum / m.sum2);
  }
  const double sum = mean_of(truth.values) * 3 * double(viewers);
  const double error = std::max(std::sqrt(std::max(0.0, variance)),
                                arithmetic * sum + truth.floor * double(viewers) + nothing);
  const double z = off / error;
  e.extra["brdf_integral_z"] = z;
  e.extra["brdf_integral_kurtosis"] = kurtosis;
  e.extra["brdf_integral_largest_share"] = share;
  if (count >= enough_samples && std::abs(z) > most_z)
    broken(e, "the mean is " + std::to_string(z) + " standard errors off");
}

Errors judge_values(std::span<const float> answers, std::span<const double> truth) {
  Errors e;
  ErrorTally tally;
  double squares = 0;
  std::size_t negative = 0;
  const double least = 1e-6 * mean_of(truth);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const double answer = double(answers[i]);
    negative += !(answer >= 0);
    if (!std::isfinite(answer) || answer < 0) {
      broken(e, "pair " + std::to_string(i) + ": " + std::to_string(answer));
      continue;
    }
    const double off = (answer - truth[i]) / std::max(truth[i], std::max(least, 1e-300));
    tally.add(std::abs(off), off);
    squares += off * off;
  }
  write(tally, squares, 1, 0, e);
  e.extra["brdf_integral_negative"] = double(negative) / double(std::max<std::size_t>(answers.size(), 1));
  return e;
}

void judge_laws(Answerer& method, const Set& set, const Knobs& knobs, std::span<const float> answers,
                Errors& e) {
  const double least = [&] {
    double sum = 0;
    for (const float a : answers) sum += double(a);
    return 1e-6 * sum / double(std::max<std::size_t>(answers.size(), 1));
  }();
  std::vector<float> others(answers.size());
  const auto change = [&](const Set& other) {
    method.answer(other, knobs, 1, others);
    double most = 0;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const double a = double(answers[i]), b = double(others[i]);
      if (std::max(a, b) > least) most = std::max(most, std::max(a, b) / std::max(std::min(a, b), least) - 1);
    }
    return most;
  };
  Set swapped = set, turned = set;
  std::swap(swapped.wi, swapped.wo);
  e.extra["brdf_integral_reciprocity"] = change(swapped);
  const float c = 0.6f, s = 0.8f;
  for (Directions* d : {&turned.wi, &turned.wo})
    for (std::size_t i = 0; i < d->x.size(); ++i) {
      const float x = d->x[i], y = d->y[i];
      d->x[i] = c * x - s * y, d->y[i] = s * x + c * y;
    }
  e.extra["brdf_integral_rotation"] = change(turned);
}

Errors judge_numbers(std::span<const float> answers, const Truth& truth, bool relative) {
  Errors e;
  ErrorTally tally;
  double squares = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!std::isfinite(answers[i])) {
      broken(e, "query " + std::to_string(i) + ": no number");
      continue;
    }
    const double off = (double(answers[i]) - truth.values[i]) / (relative ? truth.values[i] : 1);
    tally.add(std::abs(off), off);
    squares += off * off;
  }
  write(tally, squares, 1, relative ? truth.floor / std::max(mean_of(truth.values), 1e-300) : truth.floor, e);
  e.extra["brdf_integral_truth"] = mean_of(truth.values);
  double sum = 0;
  for (const float a : answers) sum += double(a);
  e.extra["brdf_integral_answer"] = sum / double(std::max<std::size_t>(answers.size(), 1));
  return e;
}

}  // namespace treeline::bench::brdf_integral
