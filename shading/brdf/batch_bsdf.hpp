// What a surface does to light, for many pairs of directions at once, by channel: Bsdf's eval, pdf and sample
// on structures of arrays and vector registers.
//
// Diffuse surfaces, facets of GGX or Beckmann, with Fresnel's factor and what makes good for lost light,
// mirrors and glass (mirror.hpp, glass.hpp).
// Answers as Bsdf<double> of the same material does for the same numbers, within a relative error of 1e-5.
// Cost: that of the lobe (batch_ggx.hpp, batch_beckmann.hpp) and of Fresnel's factor (batch_fresnel.hpp); the
// lobe of many bounces as much again to sample. Known weakness: one material for all of a batch.
#pragma once

#include <variant>

#include "shading/brdf/batch_albedo.hpp"
#include "shading/brdf/batch_beckmann.hpp"
#include "shading/brdf/batch_fresnel.hpp"
#include "shading/brdf/batch_ggx.hpp"
#include "shading/brdf/batch_lambert.hpp"

namespace treeline::shading::brdf {

namespace batch {

struct SurfaceSample {
  Floats3 wi, weight;
  Floats pdf;
};

[[gnu::always_inline]] inline Floats3 scaled(const Floats3& a, Floats s) {
  return {a.x * s, a.y * s, a.z * s};
}

/// 0 where the mask says no, whatever was there.
[[gnu::always_inline]] inline Floats3 kept(Ints mask, const Floats3& a) {
  return {kept(mask, a.x), kept(mask, a.y), kept(mask, a.z)};
}

class Diffuse {
 public:
  explicit Diffuse(const Material& m) : reflectance_(m.reflectance) {}

  [[gnu::always_inline]] Floats3 eval(const Floats3& wi, const Floats3& wo) const {
    return scaled(colour(), kept(above(wi, wo), floats(std::numbers::inv_pi_v<float>)));
  }
  [[gnu::always_inline]] Floats pdf(const Floats3& wi, const Floats3& wo) const {
    return kept(above(wi, wo), lambert_pdf(wi));
  }
  [[gnu::always_inline]] SurfaceSample sample(const Floats3& wo, Floats, Floats u, Floats v) const {
    const Floats3 wi = sample_lambert(u, v);
    return {wi, scaled(colour(), kept(above(wi, wo), floats(1))), pdf(wi, wo)};
  }

 private:
  Rgb reflectance_;

  [[gnu::always_inline]] Floats3 colour() const {
    return {floats(reflectance_[0]), floats(reflectance_[1]), floats(reflectance_[2])};
  }
};

template <class Lobe>
class Facets {
 public:
  explicit Facets(const Material& m)
      : lobe_(m.alpha_x, m.alpha_y, m.masking), fresnel_(m), compensations_(m) {}

  [[gnu::always_inline]] Floats3 eval(const Floats3& wi, const Floats3& wo) const {
    const Floats3 h = wi + wo;
    const Floats hh = dot(h, h);
    Floats3 f = scaled(once_colour(wo, 0.5f * root(hh)), lobe_.eval(wi, wo, h, hh));
    if (compensations_.many_bounces()) f = f + compensations_.many(wi, wo);
    return kept(above(wi, wo), f);
  }

  [[gnu::always_inline]] Floats pdf(const Floats3& wi, const Floats3& wo) const {
    const Floats3 h = wi + wo;
    const Floats once = lobe_.pdf(wi, wo, h, dot(h, h));
    if (!compensations_.many_bounces()) return once;
    return kept(above(wi, wo), once + (lambert_pdf(wi) - once) * compensations_.share(wo));
  }

  [[gnu::always_inline]] SurfaceSample sample(const Floats3& wo, Floats choice, Floats u, Floats v) const {
    const LobeSample s = lobe_.sample(wo, u, v);
    if (!compensations_.many_bounces())
      return {s.wi, kept(above(s.wi, wo), scaled(once_colour(wo, s.cosine), s.weight)), s.pdf};
    const Floats3 spread = sample_lambert(u, v);
    const Ints many = choice < compensations_.share(wo);
    const Floats3 wi{many ? spread.x : s.wi.x, many ? spread.y : s.wi.y, many ? spread.z : s.wi.z};
    const Floats density = pdf(wi, wo);
    const Floats per_density = kept(density > 0, wi.z * inverse(largest(density, floats(1e-36f))));
    return {wi, scaled(eval(wi, wo), per_density), density};
  }

 private:
  Lobe lobe_;
  Fresnel fresnel_;
  Compensations compensations_;

  [[gnu::always_inline]] Floats3 once_colour(const Floats3& wo, Floats cosine) const {
    Floats3 f = fresnel_(least(cosine, floats(1)));
    compensations_.scale(wo, f);
    return f;
  }
};

/// What mirrors and glass share: only sampling meets the directions that they send light to.
class Delta {
 public:
  [[gnu::always_inline]] Floats3 eval(const Floats3&, const Floats3&) const {
    return {Floats{}, Floats{}, Floats{}};
  }
  [[gnu::always_inline]] Floats pdf(const Floats3&, const Floats3&) const { return Floats{}; }
};

class Mirror : public Delta {
 public:
  explicit Mirror(const Material& m) : reflectance_(m.reflectance) {}

  [[gnu::always_inline]] SurfaceSample sample(const Floats3& wo, Floats, Floats, Floats) const {
    const Ints above = wo.z > 0;
    const Floats3 weight{kept(above, floats(reflectance_[0])), kept(above, floats(reflectance_[1])),
                         kept(above, floats(reflectance_[2]))};
    return {{-wo.x, -wo.y, wo.z}, weight, Floats{}};
  }

 private:
  Rgb reflectance_;
};

class Glass : public Delta {
 public:
  explicit Glass(const Material& m)
      : into_{static_cast<float>((m.index - 1) * (m.index + 1)), static_cast<float>(1 / m.index)},
        out_{static_cast<float>((1 / m.index - 1) * (1 / m.index + 1)), static_cast<float>(m.index)} {}

  [[gnu::always_inline]] SurfaceSample sample(const Floats3& wo, Floats choice, Floats, Floats) const {
    const Ints outside = wo.z >= 0;
    const Floats bend = outside ? floats(into_.bend) : floats(out_.bend),
                 scale = outside ? floats(into_.scale) : floats(out_.scale);
    const Floats cosine = least(largest(wo.z, -wo.z), floats(1));
    const Ints reflects = choice < dielectric_reflectance(bend, cosine);
    const Floats far = scale * root(largest(bend + cosine * cosine, Floats{}));
    const Floats weight = reflects ? floats(1) : scale * scale;
    const Floats turn = reflects ? floats(-1) : -scale;
    return {{turn * wo.x, turn * wo.y, reflects ? wo.z : (outside ? -far : far)},
            {weight, weight, weight},
            Floats{}};
  }

 private:
  struct Side {
    float bend, scale;  // of the index ahead over that behind: its square less 1, and one over it
  };
  Side into_, out_;
};

}  // namespace batch

class BatchBsdf {
 public:
  /// Throws InvalidMaterial.
  explicit BatchBsdf(const Material& m) : surface_(surface_of(m)) {}

  // The view: by entry, or one for all. As many entries as the last argument has; std::invalid_argument if
  // another array's size differs.

  /// By channel, 1/sr, without the cosine; 0 where a direction is below the surface.
  void eval(const Directions& wi, const Directions& wo, const ColoursOut& f) const { eval_all(wi, wo, f); }
  void eval(const Directions& wi, const geometry::Vec3f& wo, const ColoursOut& f) const {
    eval_all(wi, wo, f);
  }

  /// Density of sample's wi, per steradian; 0 where a direction is below the surface.
  void pdf(const Directions& wi, const Directions& wo, std::span<float> p) const { pdf_all(wi, wo, p); }
  void pdf(const Directions& wi, const geometry::Vec3f& wo, std::span<float> p) const { pdf_all(wi, wo, p); }

  /// By entry a wi, its weight f cos / pdf by channel and its density, for choice, u and v in [0, 1): weight
  /// and density are 0 where the light is lost. Of mirrors and glass the density is 0, and the weight is that
  /// of all light from wi; below the surface is inside of glass.
  void sample(const Directions& wo, std::span<const float> choice, std::span<const float> u,
              std::span<const float> v, const DirectionsOut& wi, const ColoursOut& weight,
              std::span<float> pdf) const {
    sample_all(wo, choice, u, v, wi, weight, pdf);
  }
  void sample(const geometry::Vec3f& wo, std::span<const float> choice, std::span<const float> u,
              std::span<const float> v, const DirectionsOut& wi, const ColoursOut& weight,
              std::span<float> pdf) const {
    sample_all(wo, choice, u, v, wi, weight, pdf);
  }

 private:
  using Surface = std::variant<batch::Diffuse, batch::Facets<batch::GgxLobe>,
                               batch::Facets<batch::BeckmannLobe>, batch::Mirror, batch::Glass>;
  Surface surface_;

  static Surface surface_of(const Material& m) {
    check_material(m);
    if (m.kind == SurfaceKind::diffuse) return batch::Diffuse(m);
    if (m.kind == SurfaceKind::mirror) return batch::Mirror(m);
    if (m.kind == SurfaceKind::glass) return batch::Glass(m);
    if (m.distribution == Distribution::ggx) return batch::Facets<batch::GgxLobe>(m);
    return batch::Facets<batch::BeckmannLobe>(m);
  }

  template <class Wo>
  void eval_all(const Directions& wi, const Wo& wo, const ColoursOut& f) const {
    const std::size_t n = f.z.size();
    batch::check_size(n, wi, "wi"), batch::check_size(n, wo, "wo"), batch::check_size(n, f, "f");
    std::visit(
        [&](const auto& surface) {
          batch::for_registers(
              n, [ s = surface, in = batch::Each(wi), out = batch::source(wo), to = batch::Out3(f) ](auto at)
                     __attribute__((always_inline)) { to.store(at, s.eval(in.load(at), out.load(at))); });
        },
        surface_);
  }

  template <class Wo>
  void pdf_all(const Directions& wi, const Wo& wo, std::span<float> p) const {
    const std::size_t n = p.size();
    batch::check_size(n, wi, "wi"), batch::check_size(n, wo, "wo");
    std::visit(
        [&](const auto& surface) {
          batch::for_registers(
              n, [ s = surface, in = batch::Each(wi), out = batch::source(wo), to = p.data() ](auto at)
                     __attribute__((always_inline)) { at.store(to, s.pdf(in.load(at), out.load(at))); });
        },
        surface_);
  }

  template <class Wo>
  void sample_all(const Wo& wo, std::span<const float> choice, std::span<const float> u,
                  std::span<const float> v, const DirectionsOut& wi, const ColoursOut& weight,
                  std::span<float> pdf) const {
    const std::size_t n = pdf.size();
    batch::check_size(n, wo, "wo"), batch::check_size(n, choice.size(), "choice");
    batch::check_size(n, u.size(), "u"), batch::check_size(n, v.size(), "v");
    batch::check_size(n, wi, "wi"), batch::check_size(n, weight, "weight");
    std::visit(
        [&](const auto& surface) {
          batch::for_registers(
              n, [
                s = surface, in = batch::source(wo), cs = choice.data(), us = u.data(), vs = v.data(),
                to = batch::Out3(wi), w = batch::Out3(weight), p = pdf.data()
              ](auto at) __attribute__((always_inline)) {
                const batch::SurfaceSample r = s.sample(in.load(at), at.load(cs), at.load(us), at.load(vs));
                to.store(at, r.wi), w.store(at, r.weight), at.store(p, r.pdf);
              });
        },
        surface_);
  }
};

}  // namespace treeline::shading::brdf
