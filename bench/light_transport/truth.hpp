// What radiance each pixel truly shows, and each wall.
//
// Where there is a formula (known.hpp), it is averaged over a pixel. Else paths that aim at lamps and meet
// them, weighted (mis), with scrambled Sobol points, in two halves that know nothing of each other: their
// mean is the truth, half of the RMS of their difference, relative as errors are, what is told of its error.
// Samples are doubled until that is small enough, or a cap is reached. It is one estimator's word; that
// others say the same is what z-tests are for, and the walls' means are known without rays.
//
// Cost: some 0.5 µs a path. Known weakness: light that neither half ever met is missing in both.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/light_transport/known.hpp"

namespace treeline::bench::light_transport {

struct TruthOptions {
  int first = 128, most = 2048;  ///< samples of a half, in a pixel; powers of two
  double wanted = 2e-3;          ///< relative RMS error of the mean
  std::uint64_t seed = 1;
};

struct Truth {
  std::vector<geometry::Vec3d> radiance;  ///< one a pixel; or one a wall
  double floor = 0;                       ///< relative RMS error, as judge.hpp has it
  double samples = 0;                     ///< in a pixel, both halves; 0 of a formula
  bool walls = false;                     ///< pixel p is of entry p % size
  BoxLight bounces;                       ///< of walls
};

Truth formula_truth(const LitScene&, const RadianceForm&);
Truth traced_truth(const LitScene&, const TruthOptions&, int threads);
Truth wall_truth(const BoxOfWalls&);

std::uint64_t truth_hash(const TruthOptions&);

}  // namespace treeline::bench::light_transport
