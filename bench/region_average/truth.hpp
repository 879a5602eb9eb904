// The true means: every texel times the area that the footprint covers of it, or the share of the Gaussian
// that lies over it, summed in double with the sums' own rounding added back (Neumaier 1974).
//
// Weights are closed forms (shading/texture/coverage.hpp); Gaussians are cut off at three deviations along
// each axis. A second witness, samples on a fine grid, agrees in the tests. Boxes without area are the limit
// of thin ones. A footprint over a texel that is not finite has no mean: NaN.
#pragma once

#include <span>
#include <vector>

#include "bench/region_average/method.hpp"

namespace treeline::bench::region_average {

/// Those of footprint i from i * channels on.
std::vector<double> true_means(const Image&, std::span<const Footprint>, int threads);

}  // namespace treeline::bench::region_average
