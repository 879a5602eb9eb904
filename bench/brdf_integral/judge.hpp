// How far answers are off, by what was asked.
#pragma once

#include <functional>
#include <span>

#include "bench/brdf_integral/method.hpp"
#include "bench/brdf_integral/surface_truth.hpp"

namespace treeline::bench::brdf_integral {

/// Root mean square of answer - truth over the mean of the truth, each viewer's truth held against all of its
/// answers; max, p99, mean and bias alike. Negative answers and such that are no numbers are outside of every
/// claim.
Errors judge_integrals(const Set&, std::span<const float> answers, const Truth&);

/// Adds what the spread of the answers and of their contributions says: brdf_integral_z, how many standard
/// errors the mean answer is off; _kurtosis and _largest_share, of the contributions to a viewer's answers,
/// the worst of all viewers. Where enough of them count for something, a z beyond `most_z` breaks the claim
/// of a stochastic method.
void judge_spread(const Set&, std::span<const float> answers, const Truth&, std::span<const Moments>,
                  Errors&);
inline constexpr double most_z = 5;

/// Relative errors, of values below a millionth of the mean over that; brdf_integral_negative (share of the
/// answers).
Errors judge_values(std::span<const float> answers, std::span<const double> truth);

/// Of a method that answers `evaluate`: brdf_integral_reciprocity and brdf_integral_rotation, the largest
/// relative changes when wi and wo trade places, and when both turn around the normal.
void judge_laws(Answerer&, const Set&, const Knobs&, std::span<const float> answers, Errors&);

/// Absolute errors, as of shares of light; or relative ones.
Errors judge_numbers(std::span<const float> answers, const Truth&, bool relative);

}  // namespace treeline::bench::brdf_integral
