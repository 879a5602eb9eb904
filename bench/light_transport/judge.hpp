// How far a film is from the truth, and whether it is biased.
#pragma once

#include <span>
#include <vector>

#include "bench/core/row.hpp"
#include "bench/light_transport/method.hpp"

namespace treeline::bench::light_transport {

struct Truth;

/// Squares of errors are held against the square of the truth and of a tenth of its mean: what is all but
/// black does not outweigh the rest.
inline constexpr double dark = 0.1;

/// The root of relMSE: of the mean over pixels and channels of off² / (truth² + (dark · mean truth)²).
double relative_rms(std::span<const geometry::Vec3d> off, std::span<const geometry::Vec3d> truth);

/// By how many of its standard errors the mean of independent differences is off zero; their own spread tells
/// the standard error, and `besides` is one that all have in common.
struct ZTest {
  double z = 0;
  double skew = 0;  ///< of the differences, over the root of their number
  /// Whether the normal distribution may be taken for that of z: a few differences do not make up the rest.
  bool applies = false;
};
ZTest z_test(std::span<const double> off, double besides = 0);

/// |z| of more than this is no chance: in ten thousand tests of what is right it happens once in 170 runs.
inline constexpr double rejected_z = 5;

/// Errors of a film; `unbiased`: more than chance explains breaks the method's claim. Of walls z is the worst
/// of theirs. `mean`: what z is taken from, by pixel or wall, where that is not the truth: of paths that end
/// early, what they leave.
Errors judged(const Film&, const Truth&, bool unbiased, std::span<const geometry::Vec3d> mean = {});

}  // namespace treeline::bench::light_transport
