// Directions across which a set of points is cut: where it spreads most, or nearly so.
//
// The principal axis (Sproull 1991), by power iteration on the covariance; or the widest of a few random
// projections (Dasgupta and Freund 2008). Cost: both look at about a thousand points whatever their number.
// Known weakness: a sample may miss what makes the points differ; any unit vector makes a correct tree.
#pragma once

#include <array>
#include <numbers>
#include <span>
#include <string>

#include "accel/point_set.hpp"
#include "geometry/random.hpp"

namespace treeline::accel {

struct PlaneDirections {
  enum class Split { principal_axis, random_projection } split = Split::principal_axis;
  int projections = 8;     ///< random directions tried per node
  std::uint64_t seed = 1;  ///< of the random directions
};

inline void check(const PlaneDirections& options) {
  if (options.projections < 1)
    throw InvalidInput("projections is " + std::to_string(options.projections) + "; it must be at least 1");
}

/// Every so many entries of a run, so that about a thousand are looked at: enough for a direction.
inline std::size_t sample_stride(std::size_t count) { return std::max<std::size_t>(1, count / 1024); }

/// A few steps make a good direction. `box` is that of the entries, and not a single position.
template <class T, int D>
geometry::Vec<double, D> principal_axis(std::span<const PointEntry<T, D>> entries,
                                        const geometry::Box<T, D>& box) {
  using Direction = geometry::Vec<double, D>;
  // Relative to the box, so that covariances neither overflow nor vanish.
  const int widest = box.widest_axis();
  const double unit = static_cast<double>(box.high[widest]) - static_cast<double>(box.low[widest]);
  const std::size_t stride = sample_stride(entries.size());
  const auto relative = [&](std::size_t i) {
    return (Direction(entries[i].point) - Direction(box.low)) / unit;
  };
  Direction mean{};
  std::size_t samples = 0;
  for (std::size_t i = 0; i < entries.size(); i += stride, ++samples) mean += relative(i);
  mean = mean / static_cast<double>(samples);
  std::array<Direction, D> covariance{};
  for (std::size_t i = 0; i < entries.size(); i += stride) {
    const Direction d = relative(i) - mean;
    for (int a = 0; a < D; ++a) covariance[static_cast<std::size_t>(a)] += d * d[a];
  }
  Direction axis{};
  axis[widest] = 1;
  for (int step = 0; step < 12; ++step) {
    Direction next;
    for (int a = 0; a < D; ++a) next[a] = dot(covariance[static_cast<std::size_t>(a)], axis);
    if (!(length2(next) > 0)) break;  // the sample missed what makes the points differ
    axis = normalized(next);
  }
  return axis;
}

/// `number` tells the nodes of a tree apart.
template <class T, int D>
geometry::Vec<double, D> widest_projection(std::span<const PointEntry<T, D>> entries,
                                           const geometry::Vec<T, D>& centre, const PlaneDirections& options,
                                           std::size_t number) {
  using Direction = geometry::Vec<double, D>;
  const auto stream = geometry::hash_u64(options.seed, number);
  const auto uniform = [&](int i) {  // in (0, 1]
    return 1 - geometry::unit_interval<double>(geometry::hash_u64(stream, static_cast<std::uint64_t>(i)));
  };
  const std::size_t stride = sample_stride(entries.size());
  Direction best{};
  double best_spread = -1;
  for (int j = 0, drawn = 0; j < options.projections; ++j) {
    // Normal deviates (Box and Muller 1958) point in all directions alike.
    Direction d;
    for (int a = 0; a < D; ++a, drawn += 2)
      d[a] = std::sqrt(-2 * std::log(uniform(drawn))) * std::cos(2 * std::numbers::pi * uniform(drawn + 1));
    if (!(length2(d) > 0)) d[0] = 1;
    d = normalized(d);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < entries.size(); i += stride) {
      const double s = dot(d, Direction(entries[i].point - centre));
      low = std::min(low, s), high = std::max(high, s);
    }
    if (high - low > best_spread) best_spread = high - low, best = d;
  }
  return best;
}

template <class T, int D>
geometry::Vec<T, D> plane_normal(std::span<const PointEntry<T, D>> entries, const geometry::Box<T, D>& box,
                                 const geometry::Vec<T, D>& centre, const PlaneDirections& options,
                                 std::size_t number) {
  return geometry::Vec<T, D>(options.split == PlaneDirections::Split::principal_axis
                                 ? principal_axis(entries, box)
                                 : widest_projection(entries, centre, options, number));
}

}  // namespace treeline::accel
