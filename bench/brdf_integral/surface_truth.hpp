// How much light a surface reflects, to about eight digits: two quadratures in double that share neither
// coordinates nor formulas, so that what they differ by is what the truth is worth.
//
// One goes over facets' normals, by slopes stretched by the roughness, and asks shading/brdf in double; the
// other over the light's directions, by polar coordinates around the mirror's, and asks reference.hpp. Of a
// small light: polar coordinates around its middle, and Cartesian ones of its tangent plane. Where a material
// gives back what a bounce loses, reference.hpp has no word, and both ask shading/brdf.
// Cost: 0.05 to 1 million evaluations a viewer. Known weakness: below α = 1e-5 the second cannot tell slopes
// apart.
#pragma once

#include <vector>

#include "bench/brdf_integral/method.hpp"

namespace treeline::bench::brdf_integral {

struct Truth {
  std::vector<double> values;  ///< `channels` a viewer
  double floor = 0;            ///< the most by which the two quadratures differ
};

/// Of integrals: of a set's viewers, one each; of the average, a single one. Throws std::invalid_argument for
/// mirrors and glass, whose reflection is no function.
Truth surface_truth(const Material&, const Set&, int threads);

/// Shares of the light reflected from normal incidence that leave more than 10, 20, … 80 degrees off the
/// mirror's direction (all channels together), and how far two quadratures differ in them.
Truth tail_shares(const Material&);

/// Largest of E(μ) at the viewer's angle of which `cosine` is the cosine, were no facet ever in the way of
/// another (G = 1).
double unmasked_albedo(const Material&, double cosine);

}  // namespace treeline::bench::brdf_integral
