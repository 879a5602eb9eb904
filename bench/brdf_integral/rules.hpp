// Quadratures of a fixed number of nodes, for methods; the truth's adapt (surface_truth.hpp).
#pragma once

#include <span>

#include "bench/brdf_integral/method.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::bench::brdf_integral {

/// Nodes in [-1, 1] and weights of Gauss's rule with 4, 8, 16, 32 or 64 nodes. Throws std::invalid_argument.
struct Rule {
  std::span<const double> nodes, weights;
};
Rule gauss_rule(int n);

/// What is integrated: f cosθ times the sky, by channel; `masked` without: as if no facet were ever in the
/// way of another (of microfacets without compensation).
class Integrand {
 public:
  Integrand(const Material&, bool masked);
  Vec3d operator()(const Vec3d& wi, const Vec3d& wo, const Sky& sky) const;
  const Material& material() const { return material_; }

 private:
  Material material_;
  shading::brdf::Bsdf<double> bsdf_;
  bool masked_;
};

/// Gauss's rule over cosines, midpoints over twice as many turns; of a small light over its cone.
Vec3d over_directions(const Integrand&, const Vec3d& wo, const Sky&, int nodes);
/// The same over facets' normals, by slopes in units of the roughness. Not of a small light.
Vec3d over_facets(const Integrand&, const Vec3d& wo, const Sky&, int nodes);

/// 2 ∫ E(μ) μ dμ with 16 nodes, and 8 turns of a quarter where these matter; reflect(wo) gives E.
template <class Reflect>
Vec3d over_viewers(const Material& m, const Reflect& reflect) {
  const Rule rule = gauss_rule(16);
  const int turns = m.kind == shading::SurfaceKind::microfacet && m.alpha_x != m.alpha_y ? 8 : 1;
  Vec3d sum{};
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double t = 0.5 * (1 + rule.nodes[k]), mu = t * t, s = std::sqrt((1 - mu) * (1 + mu));
    for (int i = 0; i < turns; ++i) {
      const double turn = 0.5 * std::numbers::pi * (i + 0.5) / turns;
      sum +=
          reflect(Vec3d{s * std::cos(turn), s * std::sin(turn), mu}) * (2 * rule.weights[k] * t * mu / turns);
    }
  }
  return sum;
}

}  // namespace treeline::bench::brdf_integral
