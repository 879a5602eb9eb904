// How far a look-up in a sampled distance field can be from the distance: a bound for each brick, and proof.
//
// Let d be 1-Lipschitz (a signed distance is), x_i the corners of a cell of side h, w_i the trilinear weights
// of a point p in it, T = Σ w_i d(x_i), and y any offset by whole cells. Then d(p) ≤ d(x_i + y) + |p - x_i -
// y| for every i, and so for their mean by w_i. As |v - y| ≤ |y| - v·y / |y| + |v|² / (2 |y|), as Σ w_i (p -
// x_i) = 0 and Σ w_i |p - x_i|² ≤ ¾ h²,
//   d(p) - T ≤ max_i (d(x_i + y) + |y| - d(x_i)) + 3 h² / (8 |y|),
// and in the same way for T - d(p) with y going outward. With y along the gradient the first term is what the
// surface's curvature and the lattice's directions leave of it, so that the bound is of order h² / |y|: twice
// as many samples in a band of the same width divide it by four. Where y leads out of the band, another
// argument helps: d² - |p|² is a minimum of affine functions, hence concave, so that on one side of the
// surface d² ≥ Σ w_i d(x_i)² - ¾ h², and |T| - |d| ≤ m - √(m² - ¾ h²) for m the smallest of the |d(x_i)|.
// Where nothing is better, y = 0 gives √3 h / 2. A sample that is only known to be far serves as its lower
// bound. Tricubic look-ups (Catmull and Rom 1974) differ from T by K_x C_y C_z + L_x K_y C_z + L_x L_y K_z,
// with L linear, C cubic and K = C - L along an axis: |K| is at most 1/8 of the second differences, |C| at
// most 5/4 of the values. Cost: some 100 sums a cell. Known weakness: one bound a brick, so that an edge of
// the mesh spoils 8³ cells; and the cubic's is that of T and more, though it is nearer.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>

#include "accel/bvh/build_tasks.hpp"
#include "accel/field/bricks.hpp"

namespace treeline::accel::field {

namespace detail {

/// The samples around one brick, and bounds over its cells.
template <class S>
class BrickBound {
 public:
  struct Found {
    double linear = 0, cubic = 0;  // bounds on the error
    double steep_linear = 0, steep_cubic = 0;
  };

  explicit BrickBound(const S& samples)
      : samples_(samples),
        far_(static_cast<float>(samples.widths().far)),
        h_(samples.lattice().spacing),
        worst_(0.5 * std::sqrt(3.0) * h_) {}

  Found operator()(const std::array<int, 3>& brick) {
    load(brick);
    widen_differences();
    Found found;
    for (int k = 0; k < 8; ++k)
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) add_cell(i, j, k, found);
    const double rounding = 2 * samples_.widths().rounding;  // of the look-up's samples, and of the bound's
    found.linear += rounding, found.cubic += rounding;
    return found;
  }

 private:
  static constexpr int reach = 4;  // of y along an axis
  static constexpr int n = 8 + 1 + 2 * reach, row = n, layer = n * n, count = n * n * n;
  static constexpr double up = 1 + 0x1p-20;  // for the roundings here

  static int at(int i, int j, int k) { return ((k + reach) * n + j + reach) * n + i + reach; }

  void load(const std::array<int, 3>& brick) {
    float* out = value_.data();
    for (int k = -reach; k <= 8 + reach; ++k)
      for (int j = -reach; j <= 8 + reach; ++j)
        for (int i = -reach; i <= 8 + reach; ++i)
          *out++ = samples_.value(8 * brick[0] + i, 8 * brick[1] + j, 8 * brick[2] + k);
  }

  /// For each cell the largest first and second differences along the lines that its cubic look-up takes, and
  /// the largest sample: maxima over windows, one axis after the other.
  void widen_differences() {
    static constexpr int step[3] = {1, row, layer};
    for (int m = layer + row + 1; m < count - layer - row - 1; ++m) {
      largest_[std::size_t(m)] = std::abs(value_[std::size_t(m)]);
      for (std::size_t a = 0; a < 3; ++a) {
        const float before = value_[std::size_t(m - step[a])], here = value_[std::size_t(m)],
                    after = value_[std::size_t(m + step[a])];
        first_[a][std::size_t(m)] = std::abs(after - here);
        second_[a][std::size_t(m)] = std::abs(after - 2 * here + before);
      }
    }
    for (int a = 0; a < 3; ++a) {
      window(largest_, step[a], 1, 2);
      for (int b = 0; b < 3; ++b) {
        window(second_[std::size_t(b)], step[a], a == b ? 0 : 1, a == b ? 1 : 2);
        if (a != b) window(first_[std::size_t(b)], step[a], 1, 2);
      }
    }
  }
  /// Each element becomes the largest of those `before` steps before it to `after` steps after it.
  void window(std::array<float, count>& x, int step, int before, int after) {
    const int margin = 2 * (layer + row + 1);
    scratch_ = x;
    for (int shift = -before; shift <= after; ++shift)
      if (shift != 0)
        for (int m = margin; m < count - margin; ++m)
          x[std::size_t(m)] = std::max(x[std::size_t(m)], scratch_[std::size_t(m + shift * step)]);
  }

  void add_cell(int i, int j, int k, Found& found) {
    const int m = at(i, j, k);
    std::array<double, 8> v;
    bool known = true;
    for (std::size_t c = 0; c < 8; ++c) {
      v[c] = double(value_[std::size_t(m + corner(int(c)))]);
      known &= std::abs(v[c]) < double(far_);
    }
    if (!known) return;
    geometry::Vec3d slope{};
    double steep2 = 0;
    for (int a = 0; a < 3; ++a) {
      double steepest = 0;
      for (std::size_t c = 0; c < 8; ++c) {
        if (c >> a & 1) continue;
        const double difference = v[c | std::size_t(1) << a] - v[c];
        slope[a] += difference, steepest = std::max(steepest, std::abs(difference));
      }
      steep2 += steepest * steepest;
    }
    const double linear = std::min(cell_bound(m, v, slope), worst_) * up;
    found.linear = std::max(found.linear, linear);
    found.steep_linear = std::max(found.steep_linear, std::sqrt(steep2) / h_ * up);
    const auto u = std::size_t(m);
    if (!(largest_[u] < far_)) return;
    const double bends =
        (1.5625 * double(second_[0][u]) + 1.25 * double(second_[1][u]) + double(second_[2][u])) / 8;
    found.cubic = std::max(found.cubic, linear + bends * up);
    double cubic2 = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double s = double(first_[a][u]) + 0.5 * double(second_[a][u]);
      cubic2 += s * s;
    }
    found.steep_cubic = std::max(found.steep_cubic, 1.5625 * std::sqrt(cubic2) / h_ * up);
  }
  static int corner(int c) { return (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer; }

  /// Of |T - d| in the cell, by several offsets along its slope.
  double cell_bound(int m, const std::array<double, 8>& v, const geometry::Vec3d& slope) const {
    const double steep = std::max({std::abs(slope[0]), std::abs(slope[1]), std::abs(slope[2])});
    if (!(steep > 0)) return worst_;
    double above = worst_, below = worst_;  // of d - T, and of T - d
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    if (*low > 0) below = std::min(below, outward(*low));
    if (*high < 0) above = std::min(above, outward(-*high));
    for (const double stride : {4.0, 3.0, 2.0, 1.0}) {
      int offset = 0;
      double length2 = 0;
      for (int a = 0; a < 3; ++a) {
        const double y = std::nearbyint(stride * slope[a] / steep);
        static constexpr int step[3] = {1, row, layer};
        offset += static_cast<int>(y) * step[a], length2 += y * y;
      }
      const double y = std::sqrt(length2) * h_, sag = 3 * h_ * h_ / (8 * y);
      double rise = -infinity, fall = -infinity;
      for (std::size_t c = 0; c < 8; ++c) {
        const auto here = static_cast<std::size_t>(m + corner(int(c)));
        const double in = double(value_[here - std::size_t(offset)]);
        const double out = double(value_[here + std::size_t(offset)]);
        rise = std::max(rise, in + y - v[c]);
        // Infinite: beyond the lattice, and unknown.
        fall = std::max(fall, out < infinity ? v[c] + y - out : infinity);
      }
      above = std::min(above, rise + sag), below = std::min(below, fall + sag);
    }
    return std::max({above, below, 0.0});
  }
  double outward(double least) const {
    const double rest = least * least - 0.75 * h_ * h_;
    return rest > 0 ? least - std::sqrt(rest) : worst_;
  }
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  const S& samples_;
  float far_;
  double h_, worst_;
  std::array<float, count> value_{}, largest_{}, scratch_{};
  std::array<std::array<float, count>, 3> first_{}, second_{};
};

}  // namespace detail

/// Fills in the bounds of the kept bricks, and how steep look-ups get anywhere. For the builder.
template <class S>
void bound_errors(const S& samples, const std::vector<std::array<int, 3>>& kept, const BuildTasks& tasks,
                  std::vector<BrickEntry>& table, std::array<double, 2>& steepest) {
  std::mutex mutex;
  tasks.pieces(
      kept.size(),
      [&](std::size_t begin, std::size_t end) {
        const auto bound = std::make_unique<detail::BrickBound<S>>(samples);
        double linear = 1, cubic = 1;
        for (std::size_t n = begin; n < end; ++n) {
          const auto found = (*bound)(kept[n]);
          BrickEntry& e = table[samples.lattice().brick_index(kept[n][0], kept[n][1], kept[n][2])];
          e.bound = std::nextafter(static_cast<float>(found.linear), 1e30f);
          e.cubic_bound = std::nextafter(static_cast<float>(found.cubic), 1e30f);
          linear = std::max(linear, found.steep_linear), cubic = std::max(cubic, found.steep_cubic);
        }
        const std::scoped_lock lock(mutex);
        steepest[0] = std::max(steepest[0], linear), steepest[1] = std::max(steepest[1], cubic);
      },
      16);
}

}  // namespace treeline::accel::field
