// The Beckmann distribution of microfacet normals (Beckmann and Spizzichino 1963; Cook and Torrance 1982),
// isotropic and anisotropic: slopes are normally distributed, with variance α²/2 along each tangent.
//
// D(h) = exp(-(x²/ax² + y²/ay²)/z²) / (π ax ay z⁴). Smith's masking with the error function, exactly; the
// rational fit in common use (Walter et al. 2007) is off by up to 0.31 %, and then sampled and evaluated
// albedo do not agree.
// Cost: an exponential by D, an exponential and an error function by the masking. Known weakness: sampling
// what is seen has no closed form (beckmann_visible.hpp).
#pragma once

#include <cmath>
#include <concepts>
#include <numbers>

#include "shading/brdf/directions.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
struct Beckmann {
  using Scalar = T;
  T ax, ay;  ///< roughness α along the two tangents, above 0

  /// Facets' area per area of surface and steradian, by their normal h, a unit vector: ∫ D cosθ dω = 1.
  T d(const Direction<T>& h) const { return d_along(h, T(1)); }
  /// The same by a vector along the normal and its square.
  T d_along(const Direction<T>& m, T square) const {
    if (!(m[2] > T(0))) return T(0);
    const T x = m[0] / (ax * m[2]), y = m[1] / (ay * m[2]), e = std::exp(-(x * x + y * y));
    const T z2 = m[2] * m[2] / square;
    return e > T(0) ? e / (std::numbers::pi_v<T> * (ax * z2) * (ay * z2)) : T(0);
  }

  /// As Ggx::projected_area. With a = z/t, t = sqrt(ax² x² + ay² y²): z (1 + erf a)/2 + t exp(-a²)/(2 sqrt
  /// π).
  T projected_area(const Direction<T>& o) const {
    const T x = ax * o[0], y = ay * o[1], t = std::sqrt(x * x + y * y);
    if (!(t > T(0))) return std::max(o[2], T(0));
    const T a = o[2] / t;
    return T(0.5) * (o[2] * std::erfc(-a) + t * std::exp(-a * a) * std::numbers::inv_sqrtpi_v<T>);
  }

  /// Smith's Λ(o): facets masked per facet seen; (erf a - 1)/2 + exp(-a²)/(2 a sqrt π). o above the surface.
  T lambda(const Direction<T>& o) const {
    const T x = ax * o[0], y = ay * o[1], a = o[2] / std::sqrt(x * x + y * y);
    if (!(a < T(10))) return T(0);  // below 1e-45
    return T(0.5) * (std::exp(-a * a) * std::numbers::inv_sqrtpi_v<T> / a - std::erfc(a));
  }

  /// A normal with density D(h) cosθ per steradian; u, v in [0, 1).
  Direction<T> sample_normal(T u, T v) const {
    const T r = std::sqrt(-std::log1p(-u)), angle = T(2) * std::numbers::pi_v<T> * v;
    return geometry::normalized(Direction<T>{ax * r * std::cos(angle), ay * r * std::sin(angle), T(1)});
  }
};

}  // namespace treeline::shading::brdf
