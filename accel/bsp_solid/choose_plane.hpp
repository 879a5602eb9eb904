// Which plane cuts a set of pieces: the knob of a BSP tree.
//
// Problem: each cut piece is stored and cut again, and a bad choice makes n² of them (Paterson and Yao 1990);
// on a convex solid, every face's plane leaves all others on one side. Method: of k faces drawn at random the
// one with the least 8 · splits + imbalance, estimated on a sample; planes across an axis at the median for
// the first levels, which halve the set whatever its shape. Cost: k · sample side tests a node, so O(k ·
// sample · n) in all. Known weakness: greedy, and blind to what pieces become further down.
#pragma once

#include <algorithm>
#include <optional>

#include "accel/bsp_solid/pieces.hpp"
#include "geometry/random.hpp"

namespace treeline::accel {

struct SolidOptions {
  SolidGrid grid;               ///< none: the finest that holds the mesh
  int candidates = 16;          ///< faces whose planes are tried; 1: the first one
  int axis_levels = 24;         ///< so many levels are cut across an axis at the median …
  std::size_t axis_least = 26;  ///< … where a set has at least so many pieces
  std::size_t sample = 128;     ///< pieces that a plane is tried on
  double split_cost = 8;        ///< of a piece cut, where one of imbalance costs 1
  double epsilon = 1e-8;        ///< of the rounding variant alone, relative to the solid's reach
  /// Takes a solid that crosses or encloses itself, too: what lies within two sheets of it is unspecified.
  bool may_cross_itself = false;

  /// No help along axes: a list for convex solids.
  static SolidOptions best_face() {
    SolidOptions o;
    o.axis_levels = 0;
    return o;
  }
  static SolidOptions first_face() {
    SolidOptions o = best_face();
    o.candidates = 1;
    return o;
  }
};

namespace solid {

/// Throws InvalidInput for options out of range.
inline void check(const SolidOptions& o) {
  const auto need = [](bool holds, const std::string& name, double value, const char* what) {
    if (!holds)
      throw InvalidInput("solid: " + name + " is " + std::to_string(value) + "; it must be " + what);
  };
  int exponent = 0;
  const double spacing = o.grid.spacing;
  need(spacing == 0 || (std::isfinite(spacing) && std::frexp(spacing, &exponent) == 0.5), "grid.spacing",
       spacing, "0 or a power of two");
  need(o.candidates >= 1, "candidates", o.candidates, "at least 1");
  need(o.axis_levels >= 0, "axis_levels", o.axis_levels, "at least 0");
  need(o.sample >= 1, "sample", double(o.sample), "at least 1");
  need(std::isfinite(o.split_cost) && o.split_cost >= 0, "split_cost", o.split_cost, "finite, not negative");
  need(std::isfinite(o.epsilon) && o.epsilon >= 0, "epsilon", o.epsilon, "finite, not negative");
}

template <class Space>
class PlaneChooser {
 public:
  PlaneChooser(Pieces<Space>& pieces, const SolidOptions& options) : pieces_(pieces), options_(options) {}

  /// A face's plane, or one across an axis that has pieces on both sides for certain.
  PlaneId operator()(std::span<const Piece> set, int level) {
    if (level < options_.axis_levels && set.size() >= options_.axis_least)
      if (const auto plane = median(set)) return *plane;
    return best_face(set);
  }

 private:
  PlaneId best_face(std::span<const Piece> set) {
    const std::size_t tries =
        std::min<std::size_t>(set.size(), static_cast<std::size_t>(options_.candidates));
    if (tries <= 1) return set.front().plane;
    const std::size_t step = std::max<std::size_t>(1, set.size() / options_.sample);
    const std::size_t start = step > 1 ? random_.below(static_cast<std::uint32_t>(step)) : 0;
    PlaneId best = no_plane;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < tries; ++i) {
      const std::size_t which =
          tries == set.size() ? i : random_.below(static_cast<std::uint32_t>(set.size()));
      const PlaneId plane = set[which].plane;
      double splits = 0, front = 0, back = 0;
      for (std::size_t j = start; j < set.size(); j += step) {
        if (set[j].plane == plane) continue;
        bool above = false, below = false;
        for (const auto& c : pieces_.of(set[j])) {
          const double h = pieces_.space.height(plane, geometry::Vec3d(c.at));
          above = above || h > rough, below = below || h < -rough;
        }
        if (above && below)
          ++splits;
        else if (above)
          ++front;
        else
          ++back;
        if (options_.split_cost * splits >= least) break;
      }
      const double cost = options_.split_cost * splits + std::abs(front - back);
      if (cost < least) least = cost, best = plane;
    }
    return best;
  }

  /// Across the axis along which the pieces' centres spread most, at a step near the median of their lower
  /// ends.
  std::optional<PlaneId> median(std::span<const Piece> set) {
    geometry::Box<double, 3> box;
    for (const Piece& p : set) box.grow(geometry::Vec3d(pieces_.of(p).front().at));
    const int axis = largest_axis(box.high - box.low);
    values_.clear();
    for (const Piece& p : set) values_.push_back(double(pieces_.of(p).front().at[axis]));
    const auto middle = values_.begin() + static_cast<std::ptrdiff_t>(values_.size() / 2);
    std::nth_element(values_.begin(), middle, values_.end());
    const double where = std::rint(*middle);
    bool above = false, below = false;
    for (const Piece& p : set) {
      for (const auto& c : pieces_.of(p))
        above = above || c.at[axis] > where + 1, below = below || c.at[axis] < where - 1;
      if (above && below) return pieces_.space.axis_plane(axis, where).plane;
    }
    return {};
  }

  static constexpr double rough = 1e-3;  // an estimate: nothing hangs on it
  Pieces<Space>& pieces_;
  const SolidOptions& options_;
  geometry::Pcg32 random_{1};
  std::vector<double> values_;
};

}  // namespace solid
}  // namespace treeline::accel
