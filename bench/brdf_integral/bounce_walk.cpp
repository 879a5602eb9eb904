#include "bench/brdf_integral/bounce_walk.hpp"

#include <cmath>
#include <vector>

#include "bench/brdf_integral/share.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"
#include "shading/brdf/ggx_visible.hpp"

namespace treeline::bench::brdf_integral {
namespace {

using geometry::Vec3d;

/// Smith's Λ for directions up and down: Λ(-w) = -1 - Λ(w).
double lambda(double alpha, const Vec3d& w) {
  const double a = alpha * std::hypot(w[0], w[1]) / std::abs(w[2]);
  const double root = std::sqrt(1 + a * a);
  return 0.5 * ((w[2] > 0 ? root : -root) - 1);
}

/// The share of facets below a height, where the ray that goes from `below` along w meets one; 1 or more:
/// none.
double next_facet(double alpha, const Vec3d& w, double below, double u) {
  if (std::abs(w[2]) < 1e-9) return below;
  const double l = lambda(alpha, w);
  if (std::abs(l) < 1e-12) return 1;  // straight up
  return below * std::pow(1 - u, -1 / l);
}

double walk(double alpha, const std::function<double(double)>& fresnel, geometry::Pcg32& random) {
  constexpr int most_bounces = 10000;
  const shading::brdf::Ggx<double> facets{alpha, alpha};
  const auto viewer = [&] {
    const double u = random.uniform(), v = random.uniform();
    return geometry::sample_hemisphere_cosine(u, v);
  }();
  Vec3d w = -viewer;
  double below = 1, weight = 1;
  for (int bounce = 0; bounce < most_bounces; ++bounce) {
    below = next_facet(alpha, w, below, random.uniform());
    if (below >= 1 && w[2] > 0) return weight;
    const Vec3d seen = -w;
    const double u = random.uniform(), v = random.uniform();
    const Vec3d h = shading::brdf::sample_visible_caps(facets, seen, u, v);
    const double cosine = dot(seen, h);
    weight *= fresnel(std::min(1.0, std::abs(cosine)));
    w = h * (2 * cosine) - seen;
  }
  return weight;
}

}  // namespace

Walked bounce_walk(double alpha, const std::function<double(double)>& fresnel, std::size_t walks,
                   std::uint64_t seed, int threads) {
  constexpr std::size_t parts = 64;
  std::vector<double> means(parts);
  const std::size_t each = (walks + parts - 1) / parts;
  share(parts, threads, [&](std::size_t p) {
    geometry::Pcg32 random(seed, 900 + p);
    double sum = 0;
    for (std::size_t i = 0; i < each; ++i) sum += walk(alpha, fresnel, random);
    means[p] = sum / double(each);
  });
  Walked r;
  for (const double m : means) r.albedo += m / double(parts);
  double squares = 0;
  for (const double m : means) squares += (m - r.albedo) * (m - r.albedo);
  r.standard_error = std::sqrt(squares / double(parts * (parts - 1)));
  return r;
}

}  // namespace treeline::bench::brdf_integral
