// What a recipe is made of: its function, the size and seed asked for, and a parallel loop that reports
// progress. Internal to the library of recipes.
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>

#include "datasets_gen/dataset.hpp"
#include "datasets_gen/portable.hpp"

namespace treeline::datasets {

/// Sums the shares of the work that all threads have done; tells the progress function from two seconds on,
/// ten times a second.
class Ticker {
 public:
  explicit Ticker(const Progress& progress) : progress_(progress) {}

  void add(double share);

 private:
  using Clock = std::chrono::steady_clock;

  const Progress& progress_;
  Clock::time_point next_ = Clock::now() + std::chrono::seconds(2);
  std::atomic<double> done_ = 0;
  std::mutex mutex_;
};

/// What a recipe gets.
struct Job {
  std::size_t n;
  std::uint64_t seed;
  Ticker& ticker;

  /// Calls make(i) for every i below count, on all threads. make must depend on i and the seed alone.
  /// share: the part of the recipe's work that this loop is.
  template <class Make>
  void each(std::size_t count, const Make& make, double share = 1, std::size_t grain = 4096) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) make(i);
      ticker.add(share * static_cast<double>(range.size()) / static_cast<double>(count));
    });
  }
  /// A cloud of count points, the i-th being make(i).
  template <class Make>
  geometry::Cloud3f cloud(std::size_t count, const Make& make) const {
    geometry::Cloud3f r;
    r.points.resize(count);
    each(count, [&](std::size_t i) { r.points[i] = rounded(make(i)); });
    return r;
  }
  /// n rows, the i-th being what make(i, row) writes.
  template <class Make>
  Vectors vectors(std::size_t columns, const Make& make) const {
    Vectors r;
    r.columns = columns;
    r.scalars.resize(n * columns);
    const auto row = [&](std::size_t i) { make(i, std::span(r.scalars).subspan(i * columns, columns)); };
    each(n, row, 1, 256);
    return r;
  }
  /// The square image nearest to n pixels; make(x, y, pixel) writes a pixel's channels.
  template <class Make>
  shading::Image image(int channels, const Make& make) const {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)) + 0.5);
    shading::Image r(static_cast<int>(side), static_cast<int>(side), channels);
    const auto pixel = [&](std::size_t i) {
      const auto x = static_cast<int>(i % side), y = static_cast<int>(i / side);
      make(x, y, std::span(r.values).subspan(r.index(x, y), static_cast<std::size_t>(channels)));
    };
    each(side * side, pixel);
    return r;
  }
};

// One function per recipe; the table is in recipes.cpp.
geometry::Cloud3f uniform_cube(const Job&);
geometry::Cloud3f uniform_ball(const Job&);
geometry::Cloud3f displaced_sphere(const Job&);
geometry::Cloud3f clusters(const Job&);
geometry::Cloud3f lidar(const Job&);
geometry::Cloud3f filaments(const Job&);
geometry::Cloud3f grid(const Job&);
geometry::Cloud3d georeferenced(const Job&);

geometry::Mesh3f icosphere(const Job&);
geometry::Mesh3f terrain(const Job&);
geometry::Mesh3f architecture(const Job&);
geometry::Mesh3f forest(const Job&);
geometry::Mesh3f nested_shells(const Job&);
geometry::Mesh3f torus_knot(const Job&);
geometry::Mesh3f needles(const Job&);
geometry::Mesh3f caps(const Job&);

Vectors uniform_vectors(const Job&, std::size_t columns);
Vectors descriptors(const Job&, std::size_t columns);

shading::Image noise(const Job&);
shading::Image ramp(const Job&);
shading::Image checkers(const Job&);
shading::Image mask(const Job&);
shading::Image star(const Job&);
shading::Image marble(const Job&);

}  // namespace treeline::datasets
