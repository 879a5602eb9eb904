// Across which direction a BSP node cuts: the principal axis of its rows (Sproull 1991; McNames 2001), or the
// one of a few random directions along which they spread most (Dasgupta and Freund 2008).
#pragma once

#include <numbers>

#include "accel/rows/split_axis.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

template <class T>
class DirectionSplit {
 public:
  struct Options {
    int projections = 0;  // random directions tried; 0: the principal axis
    double overlap = 0;
    std::uint64_t seed = 1;
  };
  /// Projections are of rows relative to `centre` (stride scalars), so that they round relative to the size
  /// of the set and not to where it lies.
  DirectionSplit(const RowSet<T>& set, const AlignedScalars<T>& centre, const Options& options)
      : set_(&set), centre_(&centre), options_(options), random_(options.seed), relative_(set.stride) {}

  RowCut cut(std::span<const std::uint32_t> places, RowTree<T>& tree, double overlap_allowed) {
    moments_.take(*set_, places);
    take_sample(places);
    std::vector<double> direction = options_.projections > 0 ? widest_projection() : principal_axis();
    if (direction.empty()) {
      direction.assign(set_->columns, 0);
      direction[widest_column(*set_, places)] = 1;
    }
    const auto number = static_cast<std::uint32_t>(tree.directions.size() / set_->stride);
    tree.directions.resize(tree.directions.size() + set_->stride, T(0));
    // Shortened, so that it is not longer than 1 after all roundings: offsets then never exceed distances.
    const double shorter = 1 - geometry::tolerance::gamma<double>(static_cast<int>(set_->columns) + 8) -
                           2 * static_cast<double>(geometry::tolerance::unit_roundoff<T>);
    T* const to = tree.directions.data() + number * set_->stride;
    for (std::size_t a = 0; a < set_->columns; ++a) to[a] = static_cast<T>(direction[a] * shorter);
    return {number, options_.overlap <= overlap_allowed ? options_.overlap : 0};
  }
  T key(std::uint32_t place, std::uint32_t split, const RowTree<T>& tree) {
    const T* const row = set_->row(place);
    for (std::size_t a = 0; a < set_->columns; ++a) relative_[a] = row[a] - (*centre_)[a];
    return project_row(relative_.data(), tree.directions.data() + split * set_->stride, set_->stride);
  }

 private:
  // The sample relative to its mean, in units of its largest deviation: nothing overflows or vanishes.
  void take_sample(std::span<const std::uint32_t> places) {
    const double largest = *std::max_element(moments_.variance.begin(), moments_.variance.end());
    unit_ = largest > 0 ? 1 / std::sqrt(largest) : 0;
    sample_.clear();
    for_sample(places, [&](std::uint32_t place) {
      for (std::size_t a = 0; a < set_->columns; ++a)
        sample_.push_back((static_cast<double>(set_->row(place)[a]) - moments_.mean[a]) * unit_);
    });
  }

  /// Power iteration on the covariance, which is never formed: a step costs two passes over the sample. Empty
  /// if the sample's rows are equal.
  std::vector<double> principal_axis() const {
    const std::size_t d = set_->columns;
    if (unit_ == 0) return {};
    // The standard deviations are a start that no axis is orthogonal to by symmetry.
    std::vector<double> axis(d), next(d);
    for (std::size_t a = 0; a < d; ++a)
      axis[a] = std::sqrt(moments_.variance[a]) * unit_ * (1 + 0.1 * random_.template uniform<double>());
    for (int step = 0; step < steps && normalise(axis); ++step) {
      std::fill(next.begin(), next.end(), 0);
      for (std::size_t i = 0; i < sample_.size(); i += d) {
        double along = 0;
        for (std::size_t a = 0; a < d; ++a) along += axis[a] * sample_[i + a];
        for (std::size_t a = 0; a < d; ++a) next[a] += along * sample_[i + a];
      }
      std::swap(axis, next);
    }
    return normalise(axis) ? axis : std::vector<double>{};
  }

  std::vector<double> widest_projection() const {
    const std::size_t d = set_->columns;
    if (unit_ == 0) return {};
    std::vector<double> best, direction(d);
    double most = 0;
    for (int j = 0; j < options_.projections; ++j) {
      for (double& x : direction) x = normal_deviate();
      if (!normalise(direction)) continue;
      double spread = 0;
      for (std::size_t i = 0; i < sample_.size(); i += d) {
        double along = 0;
        for (std::size_t a = 0; a < d; ++a) along += direction[a] * sample_[i + a];
        spread += along * along;
      }
      if (spread > most) most = spread, best = direction;
    }
    return best;
  }

  /// Box and Muller 1958.
  double normal_deviate() const {
    const double u = 1 - random_.template uniform<double>(), v = random_.template uniform<double>();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }
  static bool normalise(std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) sum += x * x;
    if (!(sum > 0)) return false;
    for (double& x : v) x /= std::sqrt(sum);
    return true;
  }
  // 3 to 30 steps move what an exact search looks at by 5 %, and recall after 256 rows by 0.02 (8, 32 and 128
  // clustered columns); 30 take twice as long to build.
  static constexpr int steps = 6;

  const RowSet<T>* set_;
  const AlignedScalars<T>* centre_;
  Options options_;
  mutable geometry::Pcg32 random_;
  SampleMoments<T> moments_;
  std::vector<double> sample_;
  double unit_ = 0;
  AlignedScalars<T> relative_;
};

}  // namespace treeline::accel
