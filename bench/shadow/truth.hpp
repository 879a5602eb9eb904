// What share of the light each receiver truly sees: rays through our own tree to points of the light.
//
// Scrambled Sobol points (geometry/sobol.hpp), other ones for every receiver and for each of two halves that
// know nothing of each other. Their mean is the truth, the RMS of their difference over all receivers what is
// told of its error: the mean is off by half of that, if they are independent. Samples are doubled until the
// halves differ by less than wanted, or a cap is reached; a receiver all of whose samples agree with each
// other and with those of its neighbours takes no more. Where there is a closed form (closed_form.hpp), no
// ray is cast. A hard light takes one ray. Rays begin a little off the surface, so that it does not shade
// itself.
//
// Cost: a float ray of the wide tree, some 0.1 µs. Known weakness: what is missed by 128 samples of a
// receiver and of all its neighbours is never seen.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/shadow/lights.hpp"
#include "bench/shadow/receivers.hpp"

namespace treeline::bench::shadow {

struct TruthOptions {
  int first = 64, most = 1024;  ///< samples of a half; powers of two
  double wanted = 1e-3;         ///< RMS of the halves' difference
  std::uint64_t seed = 1;
};

struct Truth {
  std::vector<double> visibility;
  double halves = 0;   ///< RMS of their difference; 0 where they cannot differ
  double samples = 0;  ///< mean of a receiver, both halves
  bool closed_form = false;
};

/// Where the light sees a receiver by a formula.
using ClosedForm = std::function<double(const Receiver&)>;

/// What a receiver's rays leave it by, along its normal.
double ray_offset(const shading::Scene&);

/// From a receiver to a point of the light, short of what carries it.
geometry::Rayf shadow_ray(const Receiver&, const ToLight&, double offset);

/// Rays alone. `width` is that of the image whose pixels the receivers are; without, they are a line in
/// order. Throws std::invalid_argument where pixels and receivers do not fit.
Truth traced_truth(const shading::Scene&, const Tree&, std::span<const Receiver>,
                   std::span<const std::uint32_t> pixel, int width, const TruthOptions&, int threads);

/// A hash of all that the truth depends on but for the mesh: light, receivers and options.
std::uint64_t truth_hash(const shading::Scene&, std::span<const Receiver>, const TruthOptions&);

}  // namespace treeline::bench::shadow
