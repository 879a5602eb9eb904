// GGX reflection of many pairs of directions at once: evaluation, density and sampling of visible normals, on
// vector registers.
//
// Sources: Walter et al. 2007 and Heitz 2014 (distribution and masking), Dupuy and Benyoub 2023 (visible
// normals from a spherical cap), Eto and Tokuyoshi 2023 (a smaller cap: fewer reflections below the surface).
// The samples are those of ggx_visible.hpp for the same numbers. What makes it fast besides the registers:
// the half vector is never brought to unit length, D and the masking take it as wi + wo; masking over 4 cos
// cos has no tangents left; the cap needs no frame around the view; the reflected direction takes one inverse
// and no root. All terms are products of positive numbers, so that small roughness costs no digits. Cost: 40
// to 70 instructions for a register of entries. Known weakness: one roughness for all of a batch.
#pragma once

#include <algorithm>

#include "shading/brdf/batch.hpp"
#include "shading/brdf/batch_math.hpp"
#include "shading/brdf/batch_roughness.hpp"

namespace treeline::shading::brdf {

/// Which visible normals are sampled: all, or only part of those whose reflection is below the surface.
enum class VisibleNormals { caps, bounded };

namespace batch {

class GgxLobe {
 public:
  GgxLobe(double alpha_x, double alpha_y, Masking masking, VisibleNormals normals = VisibleNormals::bounded)
      : alpha_(alpha_x, alpha_y),
        correlated_(masking == Masking::correlated),
        bounded_(normals == VisibleNormals::bounded) {
    const float a = std::min({alpha_.x, alpha_.y, 1.0f});
    aa_ = a * a, rest_ = (1 - a) * (1 + a);
  }

  /// f without Fresnel's factor. `h` = wi + wo and `hh` its square.
  [[gnu::always_inline]] Floats eval(const Floats3& wi, const Floats3& wo, const Floats3& h,
                                     Floats hh) const {
    const Floats si = stretched_length(wi), so = stretched_length(wo);
    // (1+Λi+Λo) or (1+Λi)(1+Λo), times 4 cos cos.
    const Floats masked = correlated_ ? 2.0f * (wi.z * so + wo.z * si) : (wi.z + si) * (wo.z + so);
    const Floats d = distribution_root(h, hh);
    return kept(above(wi, wo), alpha_.peak * d * d * inverse(masked));
  }

  /// Of sample(), per steradian; 0 where wi is below the surface.
  [[gnu::always_inline]] Floats pdf(const Floats3& wi, const Floats3& wo, const Floats3& h, Floats hh) const {
    const Floats d = distribution_root(h, hh);
    return kept(above(wi, wo),
                (0.5f * alpha_.peak) * d * d * inverse(sampled_area(wo, stretched_length(wo), share(wo))));
  }

  [[gnu::always_inline]] LobeSample sample(const Floats3& wo, Floats u, Floats v) const {
    // The view in the space where the surface is a hemisphere.
    const Floats3 stretched{alpha_.x * wo.x, alpha_.y * wo.y, wo.z};
    const Floats square = largest(dot(stretched, stretched), floats(smallest_square));
    const Floats scale = inverse_root(square), so = square * scale;
    const Floats3 view{stretched.x * scale, stretched.y * scale, stretched.z * scale};
    // A point of the unit sphere above -below; the visible normal is along its sum with the view.
    const Floats kept_share = share(wo), below = kept_share * view.z;
    const Floats cap = 1.0f + below, down = v * cap;  // 1 - z of the point
    const Floats across = root(largest(down * (2.0f - down), Floats{}));
    const SineCosine turn = sine_cosine_of_turns(u);
    const Floats3 n{across * turn.cosine + view.x, across * turn.sine + view.y,
                    (1.0f - v) * cap + (view.z - below)};
    const Floats3 m{alpha_.x * n.x, alpha_.y * n.y, n.z};
    const Floats mm = largest(dot(m, m), floats(smallest_square)),
                 nn = largest(dot(n, n), floats(smallest_square));
    const Floats om = dot(wo, m), per_mm = inverse(mm), twice = 2.0f * om * per_mm;
    LobeSample s;
    s.wi = {twice * m.x - wo.x, twice * m.y - wo.y, twice * m.z - wo.z};
    const Floats ratio = mm * inverse(nn), si = stretched_length(s.wi),
                 area = sampled_area(wo, so, kept_share);
    const Ints up = above(s.wi, wo);
    s.pdf = kept(up, (0.5f * alpha_.peak) * ratio * ratio * inverse(area));
    const Floats masked = correlated_ ? so * s.wi.z + si * wo.z : 0.5f * (s.wi.z + si) * (wo.z + so);
    s.weight = kept(up, s.wi.z * area * inverse(masked));
    s.cosine = om * inverse_root(mm);
    return s;
  }

 private:
  Roughness alpha_;
  bool correlated_, bounded_;
  float aa_, rest_;  ///< square of the smaller roughness, and 1 less that; 1 and 0 from roughness 1 on

  /// cos (1 + 2Λ) of a direction.
  [[gnu::always_inline]] Floats stretched_length(const Floats3& w) const {
    const Floats x = alpha_.x * w.x, y = alpha_.y * w.y;
    return root(x * x + y * y + w.z * w.z);
  }
  /// √(D over its peak).
  [[gnu::always_inline]] Floats distribution_root(const Floats3& h, Floats hh) const {
    const Floats x = alpha_.inverse_x * h.x, y = alpha_.inverse_y * h.y;
    return hh * inverse(x * x + y * y + h.z * h.z);
  }
  /// Of the cap below the horizon, how much is sampled.
  [[gnu::always_inline]] Floats share(const Floats3& wo) const {
    if (!bounded_) return floats(1);
    const Floats s = 1.0f + root(wo.x * wo.x + wo.y * wo.y), ss = s * s;
    return rest_ * ss * inverse(ss + aa_ * wo.z * wo.z);
  }
  /// Twice the area, seen from wo, of the facets that are sampled.
  [[gnu::always_inline]] static Floats sampled_area(const Floats3& wo, Floats stretched, Floats share) {
    return share * wo.z + stretched;
  }
};

}  // namespace batch

/// GGX reflection without Fresnel's factor: arguments alpha_x, alpha_y, masking, normals to sample.
using BatchGgx = Batch<batch::GgxLobe>;

}  // namespace treeline::shading::brdf
