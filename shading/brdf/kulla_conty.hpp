// Gives back the light that facets reflect more than once and that a single bounce loses (Kulla and Conty
// 2017, "Revisiting physically based shading at Imageworks").
//
// f = (1 - E(i)) (1 - E(o)) / (π (1 - Ē)) · colour: reciprocal, and with colour 1 a white furnace stays
// white. The colour for facets that reflect F̄ on average: a share Ē leaves after each bounce and 1 - Ē goes
// on, so of what has bounced once and is still there F̄ Ē Σ_{k>=1} (F̄ (1 - Ē))^k / (1 - Ē)... = F̄² Ē / (1 - F̄
// (1 - Ē)). Two forms in circulation are here to be measured: F̄ Ē / (1 - F̄ (1 - Ē)) counts the first bounce
// again (at α = 1 and F = 0.2 the albedo is 42 % too high); and with the viewer's E(o) in place of Ē the
// function is not reciprocal. Cost: two table look-ups (albedo_table.hpp). Known weakness: the light of many
// bounces does leave with more shape than this; a walk over the facets gives up to 7 % more than the right
// colour at α = 1.
#pragma once

#include <memory>
#include <numbers>

#include "shading/brdf/albedo_table.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
T kulla_conty_colour(T fresnel, T albedo) {
  return fresnel * fresnel * albedo / (T(1) - fresnel * (T(1) - albedo));
}
template <std::floating_point T>
T kulla_conty_colour_textbook(T fresnel, T albedo) {
  return fresnel * albedo / (T(1) - fresnel * (T(1) - albedo));
}

/// Where less than this is lost, nothing is given back: the lobe would be 0/0.
inline constexpr double least_loss = 1e-5;

template <std::floating_point T>
class KullaConty {
 public:
  KullaConty(std::shared_ptr<const AlbedoTable> table, Compensation form, const Colour<T>& fresnel_average)
      : table_(std::move(table)), form_(form), fresnel_(fresnel_average) {
    const double loss = 1 - table_->average();
    lost_ = loss > least_loss;
    if (!lost_) return;
    scale_ = T(std::numbers::inv_pi / loss);
    for (int i = 0; i < 3; ++i)
      colour_[i] = form == Compensation::kulla_conty_textbook
                       ? kulla_conty_colour_textbook(fresnel_[i], T(table_->average()))
                       : kulla_conty_colour(fresnel_[i], T(table_->average()));
  }

  /// By channel, per steradian; both above the surface.
  Colour<T> eval(const Direction<T>& wi, const Direction<T>& wo) const {
    if (!lost_) return {};
    const T eo = (*table_)(wo);
    return colour(eo) * (scale_ * (T(1) - (*table_)(wi)) * (T(1) - eo));
  }

  /// Of the light that goes to wo, the share that comes by this lobe rather than by a single bounce: about;
  /// to choose which to sample.
  T share(const Direction<T>& wo) const {
    if (!lost_) return T(0);
    const T e = (*table_)(wo), many = (T(1) - e) * sum(colour(e)), once = e * sum(fresnel_);
    return many > T(0) ? many / (many + once) : T(0);
  }

 private:
  static T sum(const Colour<T>& c) { return c[0] + c[1] + c[2]; }
  Colour<T> colour(T viewer) const {
    if (form_ != Compensation::kulla_conty_directional) return colour_;
    Colour<T> c;
    for (int i = 0; i < 3; ++i) c[i] = kulla_conty_colour(fresnel_[i], viewer);
    return c;
  }

  std::shared_ptr<const AlbedoTable> table_;
  Compensation form_;
  Colour<T> fresnel_, colour_{};
  T scale_ = 0;
  bool lost_ = false;
};

}  // namespace treeline::shading::brdf
