#include "bench/brdf_integral/rules.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "bench/brdf_integral/reference.hpp"
#include "geometry/gauss_legendre.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::brdf_integral {
namespace {

using std::numbers::pi;

template <int n>
Rule of() {
  const auto& rule = geometry::GaussLegendre<n>::rule();
  return {rule.node, rule.weight};
}

}  // namespace

Rule gauss_rule(int n) {
  switch (n) {
    case 4:
      return of<4>();
    case 8:
      return of<8>();
    case 16:
      return of<16>();
    case 32:
      return of<32>();
    case 64:
      return of<64>();
    default:
      throw std::invalid_argument("there is no rule of " + std::to_string(n) + " nodes here");
  }
}

Integrand::Integrand(const Material& m, bool masked) : material_(m), bsdf_(m), masked_(masked) {
  if (bsdf_.delta())
    throw std::invalid_argument("a mirror's reflection is no function that could be integrated");
}

Vec3d Integrand::operator()(const Vec3d& wi, const Vec3d& wo, const Sky& sky) const {
  if (masked_) return bsdf_.eval(wi, wo) * (wi[2] * sky(wi));
  if (!(wi[2] > 0 && wo[2] > 0)) return {};
  const Vec3d h = normalized(wi + wo);
  const auto f = reference::facet(material_, std::min(1.0, dot(wi, h)));
  return Vec3d{f[0], f[1], f[2]} * (reference::distribution(material_, h) / (4 * wo[2]) * sky(wi));
}

Vec3d over_directions(const Integrand& f, const Vec3d& wo, const Sky& sky, int nodes) {
  const Rule rule = gauss_rule(nodes);
  const bool light = sky.kind == SkyKind::cap;
  const geometry::Frame<double> frame(sky.axis);
  const double lowest = light ? sky.cosine : 0, half = 0.5 * (1 - lowest);
  Vec3d sum{};
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double z = lowest + half * (1 + rule.nodes[k]), s = std::sqrt((1 - z) * (1 + z));
    for (int i = 0; i < 2 * nodes; ++i) {
      const double turn = pi * (i + 0.5) / nodes;
      const Vec3d w{s * std::cos(turn), s * std::sin(turn), z};
      const Vec3d wi = light ? frame(w) : w;
      if (wi[2] > 0) sum += f(wi, wo, sky) * rule.weights[k];
    }
  }
  return sum * (half * pi / nodes);
}

Vec3d over_facets(const Integrand& f, const Vec3d& wo, const Sky& sky, int nodes) {
  const Rule rule = gauss_rule(nodes);
  const Material& m = f.material();
  const bool rough = m.kind == shading::SurfaceKind::microfacet;
  const double ax = rough ? m.alpha_x : 1, ay = rough ? m.alpha_y : 1;
  Vec3d sum{};
  for (int i = 0; i < 2 * nodes; ++i) {
    const double turn = pi * (i + 0.5) / nodes;
    const double x = ax * std::cos(turn), y = ay * std::sin(turn), slope = std::hypot(x, y);
    // Facets steeper than this reflect to below the surface.
    const double across = (x * wo[0] + y * wo[1]) / slope;
    const double steepest = std::tan(std::min(0.5 * std::atan2(across, wo[2]) + 0.25 * pi, 0.5 * pi));
    const double end = steepest / (slope + steepest);
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double t = 0.5 * end * (1 + rule.nodes[k]), r = t / (1 - t);
      const double c = 1 / std::sqrt(1 + (x * x + y * y) * r * r);
      const Vec3d h{x * r * c, y * r * c, c};
      const double oh = dot(wo, h);
      const Vec3d wi = h * (2 * oh) - wo;
      if (!(wi[2] > 0 && oh > 0)) continue;
      const double measure = 4 * oh * c * c * c * ax * ay * r / ((1 - t) * (1 - t));
      sum += f(wi, wo, sky) * (rule.weights[k] * 0.5 * end * measure);
    }
  }
  return sum * (pi / nodes);
}

}  // namespace treeline::bench::brdf_integral
