// A lobe of one channel for many pairs of directions in one call: the loop over arrays around the kernels of
// batch_ggx.hpp and batch_beckmann.hpp.
//
// One thread, no memory of its own; arrays may have any length and alignment. Outputs must not overlap
// inputs.
#pragma once

#include "shading/brdf/batch_directions.hpp"
#include "shading/brdf/check_material.hpp"

namespace treeline::shading::brdf {

namespace batch {

/// Cosines of both directions must be larger; others count as below the surface. Squares are still normal.
inline constexpr float horizon = 1e-18f;
/// Inverses of smaller numbers are not taken.
inline constexpr float smallest_square = 1e-36f;

/// Yes where both directions are above the surface; no where a cosine is NaN.
inline Ints above(const Floats3& wi, const Floats3& wo) { return (wi.z > horizon) & (wo.z > horizon); }

struct LobeSample {
  Floats3 wi;
  Floats weight;  ///< f cos / pdf without Fresnel's factor; 0 where wi is below the surface
  Floats pdf;     ///< per steradian; 0 where wi is below the surface
  Floats cosine;  ///< between either direction and the half vector
};

}  // namespace batch

template <class Lobe>
class Batch {
 public:
  /// Of the lobe. Throws InvalidMaterial.
  template <class... More>
  Batch(double alpha_x, double alpha_y, Masking masking, More... more)
      : lobe_(checked(alpha_x, "alpha_x"), checked(alpha_y, "alpha_y"), masking, more...) {}

  // The view: by entry, or one for all. As many entries as the last argument has; std::invalid_argument if
  // another array's size differs.

  /// f by entry, 1/sr, without the cosine; 0 where a direction is below the surface.
  void eval(const Directions& wi, const Directions& wo, std::span<float> f) const { eval_all(wi, wo, f); }
  void eval(const Directions& wi, const geometry::Vec3f& wo, std::span<float> f) const {
    eval_all(wi, wo, f);
  }

  /// Density of sample's wi, per steradian; 0 where a direction is below the surface.
  void pdf(const Directions& wi, const Directions& wo, std::span<float> p) const { pdf_all(wi, wo, p); }
  void pdf(const Directions& wi, const geometry::Vec3f& wo, std::span<float> p) const { pdf_all(wi, wo, p); }

  /// By entry a wi, its weight f cos / pdf and its density, for u and v in [0, 1): weight and density are 0
  /// where the light is lost.
  void sample(const Directions& wo, std::span<const float> u, std::span<const float> v,
              const DirectionsOut& wi, std::span<float> weight, std::span<float> pdf) const {
    sample_all(wo, u, v, wi, weight, pdf);
  }
  void sample(const geometry::Vec3f& wo, std::span<const float> u, std::span<const float> v,
              const DirectionsOut& wi, std::span<float> weight, std::span<float> pdf) const {
    sample_all(wo, u, v, wi, weight, pdf);
  }

 private:
  Lobe lobe_;

  template <class Wo>
  void eval_all(const Directions& wi, const Wo& wo, std::span<float> f) const {
    const std::size_t n = f.size();
    batch::check_size(n, wi, "wi"), batch::check_size(n, wo, "wo");
    batch::for_registers(
        n, [ lobe = lobe_, in = batch::Each(wi), out = batch::source(wo), to = f.data() ](auto at)
               __attribute__((always_inline)) {
                 const batch::Floats3 i = in.load(at), o = out.load(at), h = i + o;
                 at.store(to, lobe.eval(i, o, h, dot(h, h)));
               });
  }

  template <class Wo>
  void pdf_all(const Directions& wi, const Wo& wo, std::span<float> p) const {
    const std::size_t n = p.size();
    batch::check_size(n, wi, "wi"), batch::check_size(n, wo, "wo");
    batch::for_registers(
        n, [ lobe = lobe_, in = batch::Each(wi), out = batch::source(wo), to = p.data() ](auto at)
               __attribute__((always_inline)) {
                 const batch::Floats3 i = in.load(at), o = out.load(at), h = i + o;
                 at.store(to, lobe.pdf(i, o, h, dot(h, h)));
               });
  }

  template <class Wo>
  void sample_all(const Wo& wo, std::span<const float> u, std::span<const float> v, const DirectionsOut& wi,
                  std::span<float> weight, std::span<float> pdf) const {
    const std::size_t n = pdf.size();
    batch::check_size(n, wo, "wo"), batch::check_size(n, u.size(), "u"), batch::check_size(n, v.size(), "v");
    batch::check_size(n, wi, "wi"), batch::check_size(n, weight.size(), "weight");
    batch::for_registers(
        n, [
          lobe = lobe_, in = batch::source(wo), to = batch::Out3(wi), us = u.data(), vs = v.data(),
          w = weight.data(), p = pdf.data()
        ](auto at) __attribute__((always_inline)) {
          const batch::LobeSample s = lobe.sample(in.load(at), at.load(us), at.load(vs));
          to.store(at, s.wi), at.store(w, s.weight), at.store(p, s.pdf);
        });
  }

  static double checked(double alpha, const char* field) {
    if (!(alpha >= smallest_alpha && alpha <= largest_alpha))
      throw InvalidMaterial(std::string("batch: ") + field + " is " + std::to_string(alpha) +
                            ", must be in [" + std::to_string(smallest_alpha) + ", " +
                            std::to_string(largest_alpha) + "]");
    return alpha;
  }
};

}  // namespace treeline::shading::brdf
