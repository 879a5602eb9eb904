#include "bench/ray/work_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treeline::bench::ray {
namespace {

constexpr int gap = 6;  // pixels

double steps(const accel::Work& w) { return static_cast<double>(w.nodes + w.primitives); }

/// Black, blue, purple, red, orange, yellow, white: lightness grows all the way, so that it reads in grey,
/// too.
constexpr std::array<std::array<double, 3>, 7> ramp{{{0.00, 0.00, 0.02},
                                                     {0.15, 0.10, 0.45},
                                                     {0.48, 0.12, 0.52},
                                                     {0.80, 0.22, 0.36},
                                                     {0.96, 0.49, 0.12},
                                                     {0.98, 0.81, 0.28},
                                                     {1.00, 1.00, 0.92}}};

}  // namespace

shading::Image beside(std::span<const shading::Image> panels, int columns) {
  const int width = panels.front().width, height = panels.front().height;
  const int count = static_cast<int>(panels.size()), rows = (count + columns - 1) / columns;
  const int across = std::min(columns, count);
  shading::Image all(across * width + (across - 1) * gap, rows * height + (rows - 1) * gap, 3);
  std::ranges::fill(all.values, 1.0f);
  for (int p = 0; p < count; ++p)
    for (int y = 0; y < height; ++y) {
      const auto from = panels[static_cast<std::size_t>(p)].values.begin() + std::ptrdiff_t{3} * y * width;
      const int row = p / columns * (height + gap) + y, column = p % columns * (width + gap);
      std::copy_n(from, 3 * width, all.values.begin() + 3 * (std::ptrdiff_t{row} * all.width + column));
    }
  return all;
}

shading::Image heat_map(std::span<const accel::Work> work, int width, int height, double most) {
  shading::Image image(width, height, 3);
  for (std::size_t p = 0; p < work.size(); ++p) {
    const double at = std::clamp(steps(work[p]) / std::max(most, 1.0), 0.0, 1.0) * (ramp.size() - 1);
    const auto low = std::min(static_cast<std::size_t>(at), ramp.size() - 2);
    const double share = at - static_cast<double>(low);
    for (std::size_t c = 0; c < 3; ++c)
      image.values[3 * p + c] = static_cast<float>(ramp[low][c] * (1 - share) + ramp[low + 1][c] * share);
  }
  return image;
}

double common_scale(std::span<const std::vector<accel::Work>> panels) {
  double most = 1;
  for (const auto& work : panels) {
    std::vector<double> sorted;
    for (const accel::Work& w : work) sorted.push_back(steps(w));
    if (sorted.empty()) continue;
    const auto at =
        sorted.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    most = std::max(most, *at);
  }
  return most;
}

}  // namespace treeline::bench::ray
