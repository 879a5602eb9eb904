// Where a sampled field has its samples: a lattice of cubes around a mesh, in bricks of 8³ samples; and the
// options that say how fine it is, with the checks that keep it within memory.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "accel/concepts.hpp"
#include "accel/field/concepts.hpp"
#include "geometry/box.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel::field {

inline constexpr int brick_side = 8;
inline constexpr int brick_size = brick_side * brick_side * brick_side;

/// How many samples on either side of a point its look-up takes, along each axis.
enum class Support { trilinear = 1, tricubic = 2 };

struct FieldOptions {
  int resolution = 128;  ///< cells along the longest side of the mesh's box, at least 1
  double spacing = 0;    ///< side of a cell in units of the mesh; overrides the resolution where > 0
  /// Half width, in cells, of where distances are known. Infinity: everywhere within the lattice, which
  /// reaches some 3 cells beyond the mesh's box; outside of it they are lower bounds all the same.
  double band = 3;
  Support support = Support::tricubic;           ///< the widest look-up that answers in all of the band
  int threads = 1;                               ///< that build; the field does not depend on it
  std::size_t max_bytes = std::size_t{4} << 30;  ///< a field that would take more is refused
};

/// Sample (i, j, k) lies at origin + spacing · (i, j, k), i < samples(0), and so on.
struct Lattice {
  Vec3d origin;
  double spacing = 1;
  std::array<int, 3> bricks{};

  int samples(int axis) const { return brick_side * bricks[static_cast<std::size_t>(axis)]; }
  std::size_t brick_count() const {
    return std::size_t(bricks[0]) * std::size_t(bricks[1]) * std::size_t(bricks[2]);
  }
  std::size_t sample_count() const { return brick_count() * brick_size; }
  std::size_t brick_index(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(bricks[1]) + std::size_t(y)) * std::size_t(bricks[0]) +
           std::size_t(x);
  }
  Vec3d position(int i, int j, int k) const {
    return {origin[0] + spacing * i, origin[1] + spacing * j, origin[2] + spacing * k};
  }
  /// Of the cells of bricks low, …, high - 1: those between a brick's samples and on to the next brick.
  geometry::Box3d cells_of(const std::array<int, 3>& low, const std::array<int, 3>& high) const {
    return {position(brick_side * low[0], brick_side * low[1], brick_side * low[2]),
            position(brick_side * high[0], brick_side * high[1], brick_side * high[2])};
  }
  bool operator==(const Lattice&) const = default;
};

/// A field's numbers apart from its samples, in units of the mesh.
struct Widths {
  double band = 0;  ///< distances up to this are known wherever they occur
  double far = 0;   ///< samples farther than this are kept as this: no more than a lower bound
  /// How far a sample may be from the distance at its place: what float leaves open of the place, of the
  /// tree's choice of the nearest triangle, and of the distance itself.
  double rounding = 0;
};

/// For messages: a number of any size in few digits.
inline std::string shown(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", x);
  return text.data();
}

/// Throws InvalidInput for options out of range.
inline void check(const FieldOptions& o) {
  if (o.resolution < 1)
    throw InvalidInput("resolution is " + std::to_string(o.resolution) + "; it must be at least 1");
  if (!(o.spacing >= 0) || std::isinf(o.spacing))
    throw InvalidInput("spacing is " + std::to_string(o.spacing) + "; it must be finite and not negative");
  if (!(o.band > 0)) throw InvalidInput("band is " + std::to_string(o.band) + "; it must be positive");
  if (o.support != Support::trilinear && o.support != Support::tricubic)
    throw InvalidInput("support is " + std::to_string(static_cast<int>(o.support)) +
                       "; it must be trilinear (1) or tricubic (2)");
  if (o.threads < 1)
    throw InvalidInput("threads is " + std::to_string(o.threads) + "; it must be at least 1");
}

inline void refuse_bytes(double bytes, std::size_t most, const std::string& what) {
  if (bytes > double(most))
    throw InvalidInput("a field of " + what + " takes " +
                       std::to_string(std::uint64_t(std::min(bytes, 1e19))) + " bytes; max_bytes is " +
                       std::to_string(most));
}

/// The lattice for a mesh with this box (not empty), and the widths that go with it. Throws InvalidInput as
/// check(), for a lattice that leaves single precision, and for one of more than 2^31 - 8 samples along an
/// axis or whose table of bricks alone is more than max_bytes.
inline std::pair<Lattice, Widths> lattice_around(const geometry::Box3d& box, const FieldOptions& o) {
  check(o);
  const Vec3d extent = box.extent();
  const double longest = std::max({extent[0], extent[1], extent[2]});
  const double h = o.spacing > 0 ? o.spacing : longest / o.resolution;
  if (!(h > 0)) throw InvalidInput("the mesh is a single point: give a spacing");
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach = std::max({reach, std::abs(box.low[k]), std::abs(box.high[k])});
  if (h < 0x1p-20 * reach)
    throw InvalidInput("the largest coordinate is " + shown(reach / h) +
                       " cells: single precision has no room for more than 2^20");

  Lattice lattice;
  lattice.spacing = h;
  const int support = static_cast<int>(o.support);
  // A look-up's samples lie within support · √3 cells of its point; a thousandth for rounding.
  const double margin = support * std::sqrt(3.0) * 1.001;
  const bool bounded = std::isfinite(o.band);
  // Outside of the lattice nothing is known: it reaches beyond the band, by a look-up's support.
  const double pad = (bounded ? std::ceil(o.band) : 3) + support + 1;
  double count = 1;
  const double largest = reach;
  for (int k = 0; k < 3; ++k) {
    const double cells = std::ceil(extent[k] / h) + 2 * pad + 1;
    const double bricks = std::ceil(cells / brick_side);
    count *= bricks;
    if (bricks * brick_side > 0x1p31 - brick_side) count = std::numeric_limits<double>::infinity();
    lattice.bricks[static_cast<std::size_t>(k)] = bricks < 0x1p28 ? int(bricks) : 0;
    lattice.origin[k] = 0.5 * (box.low[k] + box.high[k]) - 0.5 * h * (bricks * brick_side - 1);
  }
  const std::string what = std::to_string(std::uint64_t(std::min(count, 1e18))) + " bricks";
  refuse_bytes(count * 12, o.max_bytes, what);

  for (int k = 0; k < 3; ++k)
    reach =
        std::max({reach, std::abs(lattice.origin[k]), std::abs(lattice.origin[k] + h * lattice.samples(k))});
  if (!(reach <= double(std::numeric_limits<float>::max())))
    throw InvalidInput("the mesh's largest coordinate is " + shown(largest) + ", the spacing " + shown(h) +
                       ": samples would lie at " + shown(reach) + ", beyond single precision");
  Widths widths;
  widths.rounding = geometry::tolerance::sample_slack<float> * reach;
  widths.band = bounded ? o.band * h : std::numeric_limits<double>::infinity();
  widths.far =
      bounded ? (o.band + margin) * h + 2 * widths.rounding : std::numeric_limits<double>::infinity();
  return {lattice, widths};
}

}  // namespace treeline::accel::field
