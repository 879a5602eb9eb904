#include "bench/light_transport/judge.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "bench/light_transport/truth.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Vec3d;

/// Skewness of the differences over the root of their number: a sixth of it is the first term that z's
/// distribution has beyond the normal one (Edgeworth).
constexpr double most_skew = 0.3;
constexpr std::size_t least_differences = 64;
constexpr int least_samples = 16;  // in a pixel

constexpr const char* wall_names[] = {"floor", "left", "right", "back", "front", "ceiling", "lamp"};

double grey(const Vec3d& c) { return (c[0] + c[1] + c[2]) / 3; }

/// Of all pixels and samples: how much of the light is one sample's.
double largest_share(const Film& film) {
  double all = 0, largest = 0;
  for (std::size_t p = 0; p < film.size(); ++p) {
    const double sum = grey(film.mean(p)) * static_cast<double>(film.samples(p));
    all += sum, largest = std::max(largest, film.largest_share(p) * sum);
  }
  return all > 0 ? largest / all : 0;
}

/// Of the mean over all pixels; infinite below two independent sets of samples a pixel.
double mean_error(const Film& film) {
  double squares = 0;
  for (std::size_t p = 0; p < film.size(); ++p) squares += std::pow(grey(film.standard_error(p)), 2);
  return std::sqrt(squares) / double(film.size());
}

Knobs finite(double x) { return std::isfinite(x) ? Knobs(x) : Knobs(nullptr); }

}  // namespace

double relative_rms(std::span<const Vec3d> off, std::span<const Vec3d> truth) {
  double mean = 0, sum = 0;
  for (const Vec3d& t : truth) mean += grey(t) / double(truth.size());
  for (std::size_t p = 0; p < off.size(); ++p)
    for (int c = 0; c < 3; ++c) {
      const double scale = truth[p][c] * truth[p][c] + dark * dark * mean * mean;
      sum += off[p][c] == 0 ? 0 : off[p][c] * off[p][c] / scale;
    }
  return std::sqrt(sum / (3 * double(std::max<std::size_t>(1, off.size()))));
}

ZTest z_test(std::span<const double> off, double besides) {
  const double n = static_cast<double>(off.size());
  double sum = 0;
  for (const double d : off) sum += d;
  const double mean = sum / n;
  double squares = 0, cubes = 0;
  for (const double d : off) squares += (d - mean) * (d - mean), cubes += std::pow(d - mean, 3);
  const double variance = squares / n / std::max(1.0, n - 1) + besides * besides;
  ZTest test;
  test.z = variance > 0 ? mean / std::sqrt(variance) : mean == 0 ? 0 : std::copysign(1e9, mean);
  test.skew = squares > 0 ? std::abs(cubes) / std::pow(squares, 1.5) : 0;
  test.applies = off.size() >= least_differences && test.skew <= most_skew;
  return test;
}

Errors judged(const Film& film, const Truth& truth, bool unbiased, std::span<const Vec3d> mean) {
  Errors e;
  const std::size_t n = film.size(), groups = truth.walls ? truth.radiance.size() : 1;
  std::vector<Vec3d> off(n), is(n);
  std::vector<double> all;
  std::vector<std::vector<double>> of_group(groups);
  double mean_true = 0, mean_off = 0, absolute = 0;
  for (std::size_t p = 0; p < n; ++p) {
    is[p] = truth.radiance[truth.walls ? p % groups : p];
    off[p] = film.mean(p) - is[p];
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(off[p][c])) {
        e.within_claim = false, e.reason = "pixel " + std::to_string(p) + " is answered by no finite number";
        off[p][c] = is[p][c] == 0 ? 1 : is[p][c];
      }
    mean_true += grey(is[p]), mean_off += grey(off[p]);
    const double aside = mean.empty() ? 0 : grey(is[p]) - grey(mean[truth.walls ? p % groups : p]);
    of_group[p % groups].push_back(grey(off[p]) + aside);
  }
  mean_true /= double(n), mean_off /= double(n);
  for (std::size_t p = 0; p < n; ++p) {
    absolute += std::abs(grey(off[p])) / double(n);
    const double t = grey(is[p]);
    all.push_back(std::abs(grey(off[p])) / std::sqrt(t * t + dark * dark * mean_true * mean_true));
    if (all.back() != all.back()) all.back() = 0;  // black, and answered so
  }
  std::ranges::sort(all);
  const double scale = mean_true > 0 ? mean_true : 1;
  e.error = relative_rms(off, is);
  e.mean = absolute / scale, e.bias = mean_off / scale, e.floor = truth.floor;

  ZTest worst{0, 0, true};
  std::size_t at = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    const ZTest test = z_test(of_group[g], truth.walls ? truth.floor * grey(truth.radiance[g]) : 0);
    worst.applies = worst.applies && test.applies, worst.skew = std::max(worst.skew, test.skew);
    if (std::abs(test.z) > std::abs(worst.z)) worst.z = test.z, at = g;
  }
  const bool tested = unbiased && worst.applies && film.samples() >= least_samples;
  if (e.within_claim && tested && std::abs(worst.z) > rejected_z) {
    e.within_claim = false;
    e.reason = std::string(truth.walls ? std::string("the wall ") + wall_names[at] : "the image") +
               " is off by " + std::to_string(worst.z) + " standard errors, bias " + std::to_string(*e.bias);
  }
  e.extra = {{"light_transport_rel_mse", *e.error * *e.error},
             {"light_transport_max", all.back()},
             {"light_transport_p99", all[static_cast<std::size_t>(0.99 * (double(n) - 1))]},
             {"light_transport_z", worst.z},
             {"light_transport_z_skew", worst.skew},
             {"light_transport_z_tested", tested},
             {"light_transport_bias_error", finite(mean_error(film) / scale)},
             {"light_transport_told_error", finite(film.relative_error())},
             {"light_transport_largest_share", largest_share(film)},
             {"light_transport_truth_samples", truth.samples}};
  double kurtosis = 0;
  for (std::size_t p = 0; p < n; ++p) kurtosis += film.kurtosis(p) / double(n);
  e.extra["light_transport_kurtosis"] = kurtosis;
  return e;
}

}  // namespace treeline::bench::light_transport
