// How far shares of light are off: sums over all receivers, without a look at how they came about.
#pragma once

#include <span>

#include "bench/core/row.hpp"

namespace treeline::bench::shadow {

/// A truth in the open interval between is penumbra; an answer that is off by more than much is false.
inline constexpr double penumbra_low = 0.01, penumbra_high = 0.99, much = 0.1;
/// What float may leave of a share beyond 0 and 1.
inline constexpr float share_slack = 1e-5f;

/// error: the root of the mean square; mean: of the absolute; bias: signed, positive where too light. In
/// extra, shadow_max and shadow_p99 (of the absolute), _penumbra (RMSE where the truth is between, null
/// without any), _penumbra_share, _false_lit, _false_dark and _wrong (shares of receivers that are much too
/// light, dark, or either). A share that is not a number, or not in [0, 1] but for share_slack, is wrong
/// whatever the claim; it counts as the worst there is.
Errors judged(std::span<const float> answers, std::span<const double> truth, double floor);

}  // namespace treeline::bench::shadow
