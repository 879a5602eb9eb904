// The GGX distribution of microfacet normals (Trowbridge and Reitz 1975; Walter et al. 2007), isotropic and
// anisotropic.
//
// D(h) = 1 / (π ax ay (x²/ax² + y²/ay² + z²)²): this form in components survives small roughness. The
// textbook's α² / (π (cos²θ (α² - 1) + 1)²) loses α² in a float: at the peak it is 2.6 % low at α = 1e-3, 55
// % at 2e-4, and divides by zero at 1e-4. Cost: some 10 operations, one division by D. Known weakness: its
// tails are long, so that its facets' heights have no variance, and 1 - E falls as slowly as α² log α.
#pragma once

#include <cmath>
#include <concepts>
#include <numbers>

#include "shading/brdf/directions.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
struct Ggx {
  using Scalar = T;
  T ax, ay;                      ///< roughness α along the two tangents, above 0
  T inverse_x, inverse_y, peak;  ///< of these, and 1 / (π ax ay)

  Ggx(T x, T y)
      : ax(x),
        ay(y),
        inverse_x(T(1) / x),
        inverse_y(T(1) / y),
        peak(T(1) / (std::numbers::pi_v<T> * x * y)) {}

  /// Facets' area per area of surface and steradian, by their normal h, a unit vector: ∫ D cosθ dω = 1.
  T d(const Direction<T>& h) const { return d_along(h, T(1)); }
  /// The same by a vector along the normal and its square.
  T d_along(const Direction<T>& m, T square) const {
    if (!(m[2] > T(0))) return T(0);
    const T x = m[0] * inverse_x, y = m[1] * inverse_y, s = square / (x * x + y * y + m[2] * m[2]);
    return peak * s * s;
  }

  /// Length of o stretched by the roughness: sqrt(ax² x² + ay² y² + z²).
  T stretched_length(const Direction<T>& o) const {
    const T x = ax * o[0], y = ay * o[1];
    return std::sqrt(x * x + y * y + o[2] * o[2]);
  }

  /// Facets' area that o sees, shadowed ones left out, were nothing on the far side in its way: cosθ (1 + Λ),
  /// from which Smith's masking is G1 = cosθ / projected_area. Not below cosθ; for all z.
  T projected_area(const Direction<T>& o) const {
    const T l = stretched_length(o);
    if (o[2] >= T(0)) return T(0.5) * (o[2] + l);
    const T x = ax * o[0], y = ay * o[1];  // l + z without the cancellation
    return T(0.5) * (x * x + y * y) / (l - o[2]);
  }

  /// Smith's Λ(o): facets masked per facet seen. o above the surface.
  T lambda(const Direction<T>& o) const {
    const T x = ax * o[0], y = ay * o[1];
    return T(0.5) * (x * x + y * y) / ((stretched_length(o) + o[2]) * o[2]);  // (sqrt(1 + α² tan²) - 1) / 2
  }

  /// A normal with density D(h) cosθ per steradian; u, v in [0, 1).
  Direction<T> sample_normal(T u, T v) const {
    const T r = std::sqrt(u), angle = T(2) * std::numbers::pi_v<T> * v;
    return geometry::normalized(
        Direction<T>{ax * r * std::cos(angle), ay * r * std::sin(angle), std::sqrt(T(1) - u)});
  }
};

}  // namespace treeline::shading::brdf
