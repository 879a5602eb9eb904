// Mean and variance of depth over any box of a shadow map, and its least and largest depth: a summed-area
// table (Crow 1984) of depth and its square, and a pyramid of extremes.
//
// Sums are doubles. In float the variance of a ramp over 9 x 9 texels of a map of 1024² is off by more than a
// hundred times itself, and often negative, as large sums are subtracted (the tests hold it to that).
// Cost: 16 bytes a texel for the sums, 8/3 for the pyramid; a box takes 16 reads of two sums each, or 4 of
// the pyramid. Known weakness: boxes along the axes alone; the pyramid's bounds are those of up to four
// texels that cover the box, each as large as it.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "shading/shadow/chebyshev.hpp"
#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

/// [x0, x1] × [y0, y1], in texels from the map's corner.
struct TexelBox {
  double x0, x1, y0, y1;
};

struct DepthStatistics {
  double mean = 0, variance = 0;
};

class VarianceSums {
 public:
  /// `slopes`: texels are patches of planes, as in vsm.hpp. Throws InvalidScene for a map that is none.
  explicit VarianceSums(const DepthMap& map, bool slopes = true) : width_(map.width), height_(map.height) {
    detail::check_map(map);
    sums_.resize(std::size_t(width_ + 1) * std::size_t(height_ + 1));
    for (int y = 0; y < height_; ++y) {
      Sums row{};
      for (int x = 0; x < width_; ++x) {
        const double z = map.first[map.index(x, y)];
        float sx = 0, sy = 0;
        if (slopes) detail::texel_slopes(map, x, y, sx, sy);
        row[0] += z, row[1] += z * z + 0.25 * (double(sx) * sx + double(sy) * sy);
        const Sums& above = at(x + 1, y);
        sums_[index(x + 1, y + 1)] = {above[0] + row[0], above[1] + row[1]};
      }
    }
  }

  /// Texels at the box's border count by the area within. What is outside the map counts as the map's border
  /// does, a box without area as the texel it is in.
  DepthStatistics over(const TexelBox& box) const {
    const auto clamped = [](double& a, double& b, int n) {
      const double least = 1e-3;  // texels: what is narrower would be lost in the sums' rounding
      a = std::clamp(a, 0.0, n - least), b = std::clamp(b, a + least, double(n));
    };
    TexelBox b = box;
    clamped(b.x0, b.x1, width_), clamped(b.y0, b.y1, height_);
    const Sums p = between(b.x0, b.y0), q = between(b.x1, b.y0), r = between(b.x0, b.y1),
               s = between(b.x1, b.y1);
    const double area = (b.x1 - b.x0) * (b.y1 - b.y0);
    const double mean = (s[0] - q[0] - r[0] + p[0]) / area, square = (s[1] - q[1] - r[1] + p[1]) / area;
    return {mean, std::max(0.0, square - mean * mean)};
  }
  std::size_t bytes() const { return sums_.size() * sizeof(Sums); }

 private:
  using Sums = std::array<double, 2>;
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width_ + 1) + std::size_t(x); }
  const Sums& at(int x, int y) const { return sums_[index(x, y)]; }
  /// The sums up to a place within a texel: linear along each axis, as the texel's depth is one.
  Sums between(double x, double y) const {
    const int i = std::min(int(x), width_ - 1), j = std::min(int(y), height_ - 1);
    const double a = x - i, b = y - j;
    const Sums &p = at(i, j), &q = at(i + 1, j), &r = at(i, j + 1), &s = at(i + 1, j + 1);
    Sums out;
    for (std::size_t k = 0; k < 2; ++k)
      out[k] = (1 - b) * ((1 - a) * p[k] + a * q[k]) + b * ((1 - a) * r[k] + a * s[k]);
    return out;
  }

  int width_, height_;
  std::vector<Sums> sums_;
};

class DepthPyramid {
 public:
  struct Range {
    float low, high;
  };
  /// Throws InvalidScene for a map that is none.
  explicit DepthPyramid(const DepthMap& map) {
    detail::check_map(map);
    Level level{map.width, map.height, {}};
    for (const float z : map.first) level.values.push_back({z, z});
    levels_.push_back(std::move(level));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
      const Level& fine = levels_.back();
      Level next{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
      for (int y = 0; y < next.height; ++y)
        for (int x = 0; x < next.width; ++x) {
          const int x1 = std::min(2 * x + 1, fine.width - 1), y1 = std::min(2 * y + 1, fine.height - 1);
          next.values.push_back(merged(merged(fine.at(2 * x, 2 * y), fine.at(x1, 2 * y)),
                                       merged(fine.at(2 * x, y1), fine.at(x1, y1))));
        }
      levels_.push_back(std::move(next));
    }
  }

  /// Of all depths in the box, at the least; outside the map there is depth 1.
  Range over(const TexelBox& box) const {
    const Level& base = levels_[0];
    const bool beyond = !(box.x0 >= 0 && box.y0 >= 0 && box.x1 <= base.width && box.y1 <= base.height);
    const auto texel = [](double x, int n) { return int(std::clamp(std::floor(x), 0.0, n - 1.0)); };
    int x0 = texel(box.x0, base.width), x1 = texel(box.x1, base.width);
    int y0 = texel(box.y0, base.height), y1 = texel(box.y1, base.height);
    std::size_t k = 0;
    for (; x1 - x0 > 1 || y1 - y0 > 1; ++k) x0 /= 2, x1 /= 2, y0 /= 2, y1 /= 2;
    const Level& level = levels_[k];
    Range r = merged(merged(level.at(x0, y0), level.at(x1, y0)), merged(level.at(x0, y1), level.at(x1, y1)));
    return beyond ? merged(r, {1, 1}) : r;
  }
  std::size_t bytes() const {
    std::size_t n = 0;
    for (const Level& level : levels_) n += level.values.size() * sizeof(Range);
    return n;
  }

 private:
  struct Level {
    int width, height;
    std::vector<Range> values;
    const Range& at(int x, int y) const {
      return values[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    }
  };
  static Range merged(const Range& a, const Range& b) {
    return {std::min(a.low, b.low), std::max(a.high, b.high)};
  }
  std::vector<Level> levels_;
};

}  // namespace treeline::shading::shadow
