#include "bench/inside/truth.hpp"

#include <algorithm>
#include <cmath>

#include "accel/batch.hpp"
#include "geometry/exact/column.hpp"

namespace treeline::bench::inside {
namespace {

using geometry::Mesh3f;
using geometry::Vec3f;

/// Faces by the cells of a square grid that the boxes of their shadows meet.
class Shadows {
 public:
  explicit Shadows(const Mesh3f& mesh) : mesh_(mesh) {
    for (std::uint32_t f = 0; f < mesh.size(); ++f)
      if (const auto t = mesh.triangle(f); geometry::is_finite(t)) faces_.push_back(f), box_.grow(t.box());
    cells_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(faces_.size()))),
                                     1, 2048);
    // Faces far larger than a cell would be in too many.
    while (cells_ > 1 && references() > 16 * faces_.size() + 1'000'000) cells_ /= 2;
    fill();
  }
  std::span<const std::uint32_t> above_or_below(const Vec3f& p) const {
    if (!box_.contains(p) && !below(p)) return {};
    const std::size_t c = cell(p[1], 1) * cells_ + cell(p[0], 0);
    return std::span(list_).subspan(first_[c], first_[c + 1] - first_[c]);
  }

 private:
  bool below(const Vec3f& p) const {
    return box_.low[0] <= p[0] && p[0] <= box_.high[0] && box_.low[1] <= p[1] && p[1] <= box_.high[1];
  }
  /// Monotone in x, so that no rounding can part a point from the faces whose shadows hold it.
  std::size_t cell(float x, int axis) const {
    const double low = box_.low[axis], extent = double(box_.high[axis]) - low;
    if (!(extent > 0)) return 0;
    return static_cast<std::size_t>(std::clamp((double(x) - low) / extent * static_cast<double>(cells_), 0.0,
                                               static_cast<double>(cells_ - 1)));
  }
  template <class F>
  void each_cell(std::uint32_t face, F&& f) const {
    const auto box = mesh_.triangle(face).box();
    for (std::size_t y = cell(box.low[1], 1); y <= cell(box.high[1], 1); ++y)
      for (std::size_t x = cell(box.low[0], 0); x <= cell(box.high[0], 0); ++x) f(y * cells_ + x);
  }
  std::size_t references() const {
    std::size_t n = 0;
    for (const std::uint32_t f : faces_) {
      const auto box = mesh_.triangle(f).box();
      n +=
          (cell(box.high[0], 0) - cell(box.low[0], 0) + 1) * (cell(box.high[1], 1) - cell(box.low[1], 1) + 1);
    }
    return n;
  }
  void fill() {
    first_.assign(cells_ * cells_ + 1, 0);
    for (const std::uint32_t f : faces_) each_cell(f, [&](std::size_t c) { ++first_[c + 1]; });
    for (std::size_t c = 0; c < cells_ * cells_; ++c) first_[c + 1] += first_[c];
    list_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const std::uint32_t f : faces_) each_cell(f, [&](std::size_t c) { list_[next[c]++] = f; });
  }

  const Mesh3f& mesh_;
  std::vector<std::uint32_t> faces_, list_;
  geometry::Box3f box_;
  std::size_t cells_ = 1;
  std::vector<std::size_t> first_;
};

}  // namespace

std::vector<Side> true_sides(const Mesh3f& mesh, std::span<const Vec3f> points, int threads) {
  const Shadows shadows(mesh);
  std::vector<Side> sides(points.size());
  accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f& p = points[i];
      int winding = 0;
      bool on = !geometry::is_finite(p);
      if (!on)
        for (const std::uint32_t f : shadows.above_or_below(p)) {
          const auto t = mesh.triangle(f);
          on = on || geometry::is_on_triangle(p, t);
          winding += geometry::column_crossing(p, t);
        }
      sides[i] = on ? Side::surface : winding != 0 ? Side::inside : Side::outside;
    }
  });
  return sides;
}

}  // namespace treeline::bench::inside
