// Beckmann reflection of many pairs of directions at once: evaluation, density and sampling of visible
// normals, on vector registers.
//
// Sources: Walter et al. 2007 (distribution), Heitz 2014 (masking). Masking is the exact form with erf:
// aΛ(a), for a = 1/(α tan θ), has no pole and nearly vanishes for a above 3; one polynomial stands for it, so
// that neither erf nor a second exponential is evaluated. Cost: some 100 instructions for a register of
// entries, 350 to sample. Known weakness: one roughness for all of a batch.
#pragma once

#include "shading/brdf/batch_beckmann_visible.hpp"
#include "shading/brdf/batch_roughness.hpp"

namespace treeline::shading::brdf {

namespace batch {

class BeckmannLobe {
 public:
  BeckmannLobe(double alpha_x, double alpha_y, Masking masking)
      : alpha_(alpha_x, alpha_y), correlated_(masking == Masking::correlated) {}

  /// f without Fresnel's factor. `h` = wi + wo and `hh` its square.
  [[gnu::always_inline]] Floats eval(const Floats3& wi, const Floats3& wo, const Floats3& h,
                                     Floats hh) const {
    return kept(above(wi, wo),
                0.25f * distribution(h, hh) * inverse(masked(wi.z, hidden(wi), wo.z, hidden(wo))));
  }

  /// Of sample(), per steradian; 0 where wi is below the surface.
  [[gnu::always_inline]] Floats pdf(const Floats3& wi, const Floats3& wo, const Floats3& h, Floats hh) const {
    return kept(above(wi, wo), 0.25f * distribution(h, hh) * inverse(wo.z + hidden(wo)));
  }

  [[gnu::always_inline]] LobeSample sample(const Floats3& wo, Floats u, Floats v) const {
    // The view in the space of roughness 1, and its azimuth there.
    const Floats x = alpha_.x * wo.x, y = alpha_.y * wo.y;
    const Floats square = largest(x * x + y * y, floats(smallest_square)), per_across = inverse_root(square);
    const Floats across = square * per_across;
    const Floats scale = inverse_root(square + largest(wo.z * wo.z, floats(smallest_square)));
    const Floats cotangent = wo.z * per_across, lo = across * scaled_lambda(cotangent), area = wo.z + lo;
    const Floats along = visible_slope(wo.z * scale, across * scale, cotangent, area * scale, u);
    const Floats other =
        erf_inverse_of(least(largest(2.0f * v - 1.0f, floats(-1 + 0x1p-24f)), floats(1 - 0x1p-24f)));
    // Where the view is along the normal, any azimuth will do.
    const Ints tilted = square > smallest_square;
    const Floats c = tilted ? x * per_across : floats(1), s = kept(tilted, y * per_across);
    const Floats3 m{alpha_.x * (c * along - s * other), alpha_.y * (s * along + c * other), floats(1)};
    const Floats mm = dot(m, m), om = dot(wo, m), twice = 2.0f * om * inverse(mm);
    LobeSample r;
    r.wi = {twice * m.x - wo.x, twice * m.y - wo.y, twice - wo.z};
    const Ints up = above(r.wi, wo);
    const Floats d = exp_of_negative(along * along + other * other) * mm * mm * alpha_.peak;
    r.pdf = kept(up, 0.25f * d * inverse(area));
    r.weight = kept(up, r.wi.z * area * inverse(masked(r.wi.z, hidden(r.wi), wo.z, lo)));
    r.cosine = om * inverse_root(mm);
    return r;
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

  /// (1+Λi+Λo) or (1+Λi)(1+Λo), times cos cos, of cosines and what hidden() gives.
  [[gnu::always_inline]] Floats masked(Floats zi, Floats li, Floats zo, Floats lo) const {
    return correlated_ ? zi * zo + (li * zo + lo * zi) : (zi + li) * (zo + lo);
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
    return polynomial(x, coefficients);
  }
};

}  // namespace batch

/// Beckmann reflection without Fresnel's factor: arguments alpha_x, alpha_y, masking.
using BatchBeckmann = Batch<batch::BeckmannLobe>;

}  // namespace treeline::shading::brdf
