// The exponents of a cloud's coordinates, counted as points come and go: what its measure depends on (see
// point_measure.hpp), kept up to date for the price of a few additions a point.
//
// Cost: O(D) a point to add or remove; exponents() walks the exponents in use, some tens in ordinary clouds.
// 1 KiB for float, 16 KiB for double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/point_measure.hpp"

namespace treeline::accel {

template <class T, int D>
class ExponentCounts {
 public:
  using Point = geometry::Vec<T, D>;

  void add(const Point& p) { count(p, 1); }
  /// One that was added.
  void remove(const Point& p) { count(p, static_cast<std::uint32_t>(-1)); }

  Exponents exponents() const {
    Exponents all;
    std::size_t points = 0;
    for (int e = from_; e < to_; ++e) points += of_points_[at(e)];
    if (points == 0) return all;
    all.any = true;
    std::size_t below = 0;
    all.typical = from_;
    while ((below += of_points_[at(all.typical)]) <= points / 2) ++all.typical;
    all.largest = to_ - 1;
    while (of_points_[at(all.largest)] == 0) --all.largest;
    all.smallest = from_;
    while (of_coordinates_[at(all.smallest)] == 0) ++all.smallest;
    return all;
  }
  std::size_t bytes() const {
    return (of_points_.capacity() + of_coordinates_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  using Limits = std::numeric_limits<T>;
  static constexpr int lowest = Limits::min_exponent - Limits::digits, highest = Limits::max_exponent;
  static constexpr std::size_t at(int exponent) { return static_cast<std::size_t>(exponent - lowest); }

  void count(const Point& p, std::uint32_t one) {
    int largest = lowest - 1;
    for (int a = 0; a < D; ++a) {
      if (p[a] == 0) continue;
      const int e = std::ilogb(p[a]);
      of_coordinates_[at(e)] += one;
      largest = std::max(largest, e);
      from_ = std::min(from_, e), to_ = std::max(to_, e + 1);
    }
    if (largest >= lowest) of_points_[at(largest)] += one;
  }

  std::vector<std::uint32_t> of_points_ = std::vector<std::uint32_t>(highest - lowest),
                             of_coordinates_ = std::vector<std::uint32_t>(highest - lowest);
  int from_ = highest, to_ = lowest;  // what is counted lies between
};

}  // namespace treeline::accel
