// The query sets of each kind of block.
#pragma once

#include <vector>

#include "bench/brdf_integral/method.hpp"

namespace treeline::bench::brdf_integral {

/// How much is asked: viewers of an integral, and how often each; estimates of the average over all viewers.
struct Amount {
  std::size_t views = 10, repeats = 12, averages = 20;
};

/// albedo, cosine_sky, small_light, average.
std::vector<Set> make_integral_sets(const Amount&, std::uint64_t seed);
/// For hard cases: viewers at the angles of which the cosines are given; albedo and small_light.
std::vector<Set> make_hard_integral_sets(std::span<const double> cosines, std::uint64_t seed);
/// evaluate, sample: n entries each; half of the pairs near the mirror's directions, samples for
/// `kernel_viewers` viewers in turn.
inline constexpr std::size_t kernel_viewers = 32;
std::vector<Set> make_kernel_sets(const Material&, std::size_t n, std::uint64_t seed);
/// white_…: facets that reflect all. colour_…: facets that reflect a share at normal incidence.
std::vector<Set> make_furnace_sets(bool all);
/// Angles from 0 to 90 degrees, by media.
std::vector<Set> make_fresnel_sets(std::size_t angles);
/// Shapes at 1, 3, 10 and 30 times their radius, in `each` directions; facing the viewer or tilted.
std::vector<Set> make_solid_angle_sets(std::size_t each, std::uint64_t seed);

}  // namespace treeline::bench::brdf_integral
