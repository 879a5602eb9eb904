// What taking the visibility out of the integral does: V · ∫ L f cosθ instead of ∫ V L f cosθ.
//
// Error of a receiver: the difference between the share of the light's area that is seen, and the share of
// what the whole light would bring to the eye by way of the surface: each point of the light weighted by the
// cosines at both ends, the distance, and the surface's f. Surfaces are diffuse, or GGX of a roughness α with
// correlated masking; the eye is where the middle of the light is mirrored to, so that every receiver lies in
// a highlight, which is where a smooth surface shows its light at all. As α goes to 0 the share goes to the
// visibility of the light's middle alone.
//
// The RMS of it is from the product of two estimates that know nothing of each other, so that their noise,
// which grows where a lobe is narrow and few samples hold it, adds nothing on average. It is over at most
// `most` of the receivers in penumbra, evenly taken; the others have no error. Cost: two rays a sample and
// receiver. Known weakness: where α is so small that most estimates hold no sample, nothing is told.
#pragma once

#include <array>
#include <span>

#include "bench/shadow/lights.hpp"
#include "bench/shadow/receivers.hpp"

namespace treeline::bench::shadow {

struct Truth;

/// α of the surfaces, falling; infinite: a diffuse one.
inline constexpr std::array split_roughness{std::numeric_limits<double>::infinity(), 0.5, 0.2, 0.1, 0.05};

struct SplitOptions {
  int samples = 128;        ///< of each estimate
  std::size_t most = 4096;  ///< receivers
};

/// RMS over all receivers, of each roughness; 0 of a light without extent, and where the product of the
/// estimates is negative on average.
std::array<double, split_roughness.size()> split_errors(const shading::Scene&, const Tree&,
                                                        std::span<const Receiver>, const Truth&,
                                                        const SplitOptions&, int threads);

/// What a point of the light brings to the eye by a surface of roughness α, but for a factor that all points
/// share. to: from the receiver towards it; eye: unit, above the surface.
double split_weight(const Light&, const ToLight& to, const Vec3d& normal, const Vec3d& eye, double alpha);

/// Where the middle of the light is mirrored to.
Vec3d mirrored_light(const Light&, const Receiver&);

}  // namespace treeline::bench::shadow
