// Light that walks between microfacets until it leaves them: how much of it a rough metal reflects, with all
// bounces. The truth for what compensations of lost light approximate.
//
// Source: Heitz, Hanika, d'Eon and Dachsbacher 2016, "Multiple-scattering microfacet BSDFs with the Smith
// model": heights are uniform and of no memory; a ray goes on to a height by Smith's shadowing from its own,
// and is reflected by a facet that it sees. GGX, masked by heights. Cost: two to three facets a walk.
// Known weakness: stochastic; the standard error says how much.
#pragma once

#include <cstdint>
#include <functional>

namespace treeline::bench::brdf_integral {

struct Walked {
  double albedo = 0, standard_error = 0;  ///< over all viewers, weighed by their cosine
};

/// fresnel: share that a facet reflects, of the cosine to its normal. The same for any number of threads.
Walked bounce_walk(double alpha, const std::function<double(double)>& fresnel, std::size_t walks,
                   std::uint64_t seed, int threads);

}  // namespace treeline::bench::brdf_integral
