// How often a mesh goes around points, exactly: the columns above them, counted through a grid.
//
// Method: the faces whose shadows along z meet a cell of a square grid are listed there, and
// column_crossing() looks at those of the point's cell. Around a closed, oriented mesh the sum is the winding
// number: 1 within, 0 without, -1 within one that is inside out, and more where parts lie in one another. Of
// a mesh with holes it is that of this one column, which depends on where the holes are. Cost: a cell per
// face, and some microseconds a point; more where faces stand on top of one another. Known weakness: faces
// that are long and slanting in the shadow are listed in all cells of its box.
#pragma once

#include <algorithm>
#include <cmath>
#include <ranges>
#include <span>
#include <vector>

#include "geometry/exact/column.hpp"
#include "geometry/mesh.hpp"

namespace treeline::geometry {

/// Where a point lies by the faces above it.
struct Enclosure {
  int winding = 0;          ///< faces up less faces down that the column passes; of no meaning on the surface
  bool on_surface = false;  ///< the point is on a face
};

class ColumnGrid {
 public:
  /// Faces with a coordinate that is not finite, and those of no area, which bound nothing, are left out. The
  /// mesh must outlive the grid.
  explicit ColumnGrid(const Mesh3f& mesh) : ColumnGrid(mesh, std::views::iota(std::size_t{0}, mesh.size())) {}
  /// Of some of its faces alone.
  template <std::ranges::input_range Faces>
  ColumnGrid(const Mesh3f& mesh, const Faces& faces) : mesh_(mesh) {
    for (const std::size_t f : faces)
      if (const auto t = mesh.triangle(f); is_finite(t) && !is_degenerate(t))
        faces_.push_back(static_cast<std::uint32_t>(f)), box_.grow(Triangle3d(t).box());
    cells_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(faces_.size()))),
                                     1, most_cells);
    // Faces far larger than a cell would be in too many.
    while (cells_ > 1 && references() > 16 * faces_.size() + 1'000'000) cells_ /= 2;
    fill();
  }

  /// The point must be finite.
  Enclosure operator()(const Vec3d& p) const {
    Enclosure r;
    if (!in_shadow(p)) return r;
    const std::size_t c = cell(p[1], 1) * cells_ + cell(p[0], 0);
    for (const std::uint32_t f : std::span(list_).subspan(first_[c], first_[c + 1] - first_[c])) {
      const Triangle3d t(mesh_.triangle(f));
      r.on_surface = r.on_surface || is_on_triangle(p, t);
      r.winding += column_crossing(p, t);
    }
    return r;
  }
  Enclosure operator()(const Vec3f& p) const { return (*this)(Vec3d(p)); }

 private:
  static constexpr std::size_t most_cells = 2048;  // along a side: 16 MB of first_

  bool in_shadow(const Vec3d& p) const {
    return box_.low[0] <= p[0] && p[0] <= box_.high[0] && box_.low[1] <= p[1] && p[1] <= box_.high[1] &&
           p[2] <= box_.high[2];
  }
  /// Monotone in x, so that no rounding can part a point from the faces whose shadows hold it.
  std::size_t cell(double x, int axis) const {
    const double low = box_.low[axis], extent = box_.high[axis] - low;
    if (!(extent > 0)) return 0;
    return static_cast<std::size_t>(
        std::clamp((x - low) / extent * static_cast<double>(cells_), 0.0, static_cast<double>(cells_ - 1)));
  }
  template <class F>
  void each_cell(std::uint32_t face, F&& f) const {
    const Box3d box = Triangle3d(mesh_.triangle(face)).box();
    for (std::size_t y = cell(box.low[1], 1); y <= cell(box.high[1], 1); ++y)
      for (std::size_t x = cell(box.low[0], 0); x <= cell(box.high[0], 0); ++x) f(y * cells_ + x);
  }
  std::size_t references() const {
    std::size_t n = 0;
    for (const std::uint32_t f : faces_) {
      const Box3d box = Triangle3d(mesh_.triangle(f)).box();
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
  Box3d box_;
  std::size_t cells_ = 1;
  std::vector<std::size_t> first_;  // of each cell, in the list
};

}  // namespace treeline::geometry
