// Beckmann reflection of many pairs of directions at once: evaluation and density of visible normals, on
// vector registers.
//
// Sources: Walter et al. 2007 (distribution), Heitz 2014 (masking). Masking is the exact form with erf:
// aΛ(a), for a = 1/(α tan θ), has no pole and nearly vanishes for a above 3; one polynomial stands for it, so
// that neither erf nor a second exponential is evaluated. Cost: some 100 instructions for a register of
// entries.
#pragma once

#include "shading/brdf/batch_ggx.hpp"

namespace treeline::shading::brdf {

namespace batch {

class BeckmannLobe {
 public:
  BeckmannLobe(double alpha_x, double alpha_y, Masking masking)
      : alpha_(alpha_x, alpha_y), correlated_(masking == Masking::correlated) {}

  /// f without Fresnel's factor. `h` = wi + wo and `hh` its square.
  [[gnu::always_inline]] Floats eval(const Floats3& wi, const Floats3& wo, const Floats3& h,
                                     Floats hh) const {
    const Floats li = hidden(wi), lo = hidden(wo);
    // (1+Λi+Λo) or (1+Λi)(1+Λo), times cos cos.
    const Floats masked = correlated_ ? wi.z * wo.z + (li * wo.z + lo * wi.z) : (wi.z + li) * (wo.z + lo);
    return kept(above(wi, wo), 0.25f * distribution(h, hh) * inverse(masked));
  }

  /// Of visible normals' reflections, per steradian; 0 where wi is below the surface.
  [[gnu::always_inline]] Floats pdf(const Floats3& wi, const Floats3& wo, const Floats3& h, Floats hh) const {
    return kept(above(wi, wo), 0.25f * distribution(h, hh) * inverse(wo.z + hidden(wo)));
  }

 private:
  Roughness alpha_;
  bool correlated_;

  [[gnu::always_inline]] Floats distribution(const Floats3& h, Floats hh) const {
    const Floats x = alpha_.inverse_x * h.x, y = alpha_.inverse_y * h.y;
    const Floats per_zz = inverse(largest(h.z * h.z, floats(smallest_square)));
    // Where 1/cos² is larger than that the exponential is 0.
    const Floats ratio = least(hh * per_zz, floats(1e18f));
    return exp_of_negative((x * x + y * y) * per_zz) * ratio * ratio * alpha_.peak;
  }

  /// cos Λ of a direction.
  [[gnu::always_inline]] Floats hidden(const Floats3& w) const {
    const Floats x = alpha_.x * w.x, y = alpha_.y * w.y;
    const Floats square = largest(x * x + y * y, floats(smallest_square));
    const Floats per_sine = inverse_root(square);
    return square * per_sine * scaled_lambda(w.z * per_sine);
  }

  /// aΛ(a) = e^(-a²)/(2√π) - a erfc(a)/2; absolute error up to 1.5e-7, from a = 3.25 on 3e-7.
  [[gnu::always_inline]] static Floats scaled_lambda(Floats a) {
    constexpr float end = 3.25f;
    const Floats x = least(a, floats(end)) * (2 / end) - 1.0f;
    constexpr float coefficients[] = {0.0004896217724f, -0.001400075038f, -0.00151737046f, 0.008291080594f,
                                      -0.003918204922f, -0.01821727119f,  0.03138458729f,  -0.0034829129f,
                                      -0.05646263435f,  0.1001308982f,    -0.09350841492f, 0.05312216654f,
                                      -0.01751482487f,  0.002603618428f};
    Floats p = floats(coefficients[0]);
    for (std::size_t i = 1; i < std::size(coefficients); ++i) p = p * x + coefficients[i];
    return p;
  }
};

}  // namespace batch

/// Beckmann reflection without Fresnel's factor: arguments alpha_x, alpha_y, masking.
using BatchBeckmann = Batch<batch::BeckmannLobe>;

}  // namespace treeline::shading::brdf
