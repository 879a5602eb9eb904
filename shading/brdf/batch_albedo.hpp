// The directional albedo of facets from its table, for many directions at once, and what compensations make
// of it (kulla_conty.hpp, turquin.hpp), on vector registers.
//
// Kept as the loss 1 - E, which is small where E has lost its digits in a float.
// Cost: two gathers and a root a direction, four gathers and a logarithm more of an anisotropic surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "shading/brdf/albedo_table.hpp"
#include "shading/brdf/batch_directions.hpp"
#include "shading/brdf/batch_math.hpp"
#include "shading/brdf/fresnel_term.hpp"
#include "shading/brdf/kulla_conty.hpp"

namespace treeline::shading::brdf::batch {

/// Light that one bounce between facets loses, by direction; as AlbedoTable.
class LossTable {
 public:
  LossTable(const Material& m, const AlbedoTable& table)
      : columns_(table.columns()),
        rows_(table.rows()),
        xx_(static_cast<float>(m.alpha_x * m.alpha_x)),
        yy_(static_cast<float>(m.alpha_y * m.alpha_y)),
        lower_(static_cast<float>(std::min(m.alpha_x, m.alpha_y))),
        upper_(static_cast<float>(std::max(m.alpha_x, m.alpha_y))),
        per_lower_(static_cast<float>(1 / std::min(m.alpha_x, m.alpha_y))),
        rows_a_log_(static_cast<float>((rows_ - 1) / std::abs(std::log(m.alpha_x / m.alpha_y)))) {
    auto losses = std::make_shared<std::vector<float>>();
    for (const double e : table.values()) losses->push_back(static_cast<float>(1 - e));
    losses_ = std::move(losses);
  }

  /// 1 - E; of directions above the surface.
  [[gnu::always_inline]] Floats operator()(const Floats3& w) const {
    const Floats z = largest(w.z, Floats{});
    if (rows_ == 1) {
      const Place p = column(z, floats(lower_));
      return between(p.index, p.part);
    }
    const Floats xx = w.x * w.x, yy = w.y * w.y;
    const Floats per_square = inverse(largest(xx + yy, floats(1e-36f)));
    const Floats a = least(largest(root((xx_ * xx + yy_ * yy) * per_square), floats(lower_)), floats(upper_));
    const Place p = column(z, a), q = place(log_of(a * per_lower_) * rows_a_log_, rows_);
    const Ints index = q.index * columns_ + p.index;
    const Floats first = between(index, p.part), second = between(index + columns_, p.part);
    return first + (second - first) * q.part;
  }

 private:
  std::shared_ptr<const std::vector<float>> losses_;
  int columns_, rows_;
  float xx_, yy_, lower_, upper_;
  float per_lower_, rows_a_log_;  ///< of no meaning for one row

  struct Place {
    Ints index;   ///< of the value before, at most the last but one
    Floats part;  ///< of the way to the next
  };
  [[gnu::always_inline]] static Place place(Floats x, int count) {
    const Ints whole = __builtin_convertvector(x, Ints), last = Ints{} + (count - 2);
    // Within the table whatever the direction was.
    const Ints below_last = whole < last ? whole : last, index = below_last > 0 ? below_last : Ints{};
    return {index, x - __builtin_convertvector(index, Floats)};
  }
  [[gnu::always_inline]] Place column(Floats z, Floats a) const {
    return place(static_cast<float>(columns_ - 1) * root(z * (1.0f + a) * inverse(z + a)), columns_);
  }
  [[gnu::always_inline]] Floats between(Ints index, Floats part) const {
    const Floats first = gathered(losses_->data(), index), second = gathered(losses_->data() + 1, index);
    return first + (second - first) * part;
  }
};

class Compensations {
 public:
  /// Of a material of facets that check_material has accepted.
  explicit Compensations(const Material& m) : kind_(m.compensation) {
    if (kind_ == Compensation::none) return;
    const AlbedoTable table(m);
    const FresnelTerm<double> fresnel(m);
    loss_.emplace(m, table);
    const double albedo = table.average(), loss = 1 - albedo;
    if (kind_ == Compensation::turquin) {
      colour_ = Rgb(fresnel(1.0));
      return;
    }
    if (!(loss > least_loss)) kind_ = Compensation::none;
    scale_ = static_cast<float>(std::numbers::inv_pi / loss);
    const Colour<double> average = fresnel.average();
    fresnel_ = Rgb(average);
    for (int i = 0; i < 3; ++i)
      colour_[i] = static_cast<float>(kind_ == Compensation::kulla_conty_textbook
                                          ? kulla_conty_colour_textbook(average[i], albedo)
                                          : kulla_conty_colour(average[i], albedo));
  }

  /// Whether there is a lobe of many bounces.
  bool many_bounces() const { return kind_ != Compensation::none && kind_ != Compensation::turquin; }

  /// Scales the single bounce up, where that is the compensation.
  [[gnu::always_inline]] void scale(const Floats3& wo, Floats3& once) const {
    if (kind_ != Compensation::turquin) return;
    const Floats loss = (*loss_)(wo), ratio = loss * inverse(1.0f - loss);
    once.x *= 1.0f + colour_[0] * ratio, once.y *= 1.0f + colour_[1] * ratio,
        once.z *= 1.0f + colour_[2] * ratio;
  }

  /// The lobe of many bounces, by channel; both directions above the surface.
  [[gnu::always_inline]] Floats3 many(const Floats3& wi, const Floats3& wo) const {
    const Floats out = (*loss_)(wo), f = scale_ * (*loss_)(wi)*out;
    const Floats3 c = colour(out);
    return {f * c.x, f * c.y, f * c.z};
  }

  /// Probability of sampling it, as KullaConty::share.
  [[gnu::always_inline]] Floats share(const Floats3& wo) const {
    const Floats loss = (*loss_)(wo);
    const Floats3 c = colour(loss);
    const Floats many = loss * (c.x + c.y + c.z);
    const Floats once = (1.0f - loss) * (fresnel_[0] + fresnel_[1] + fresnel_[2]);
    return many * inverse(largest(many + once, floats(1e-30f)));
  }

 private:
  Compensation kind_;
  std::optional<LossTable> loss_;
  Rgb fresnel_{}, colour_{};  ///< Turquin's colour: at normal incidence
  float scale_ = 0;

  [[gnu::always_inline]] Floats3 colour(Floats loss) const {
    if (kind_ != Compensation::kulla_conty_directional)
      return {floats(colour_[0]), floats(colour_[1]), floats(colour_[2])};
    return {directional(fresnel_[0], loss), directional(fresnel_[1], loss), directional(fresnel_[2], loss)};
  }
  [[gnu::always_inline]] static Floats directional(float f, Floats loss) {
    return f * f * (1.0f - loss) * inverse(largest(1.0f - f * loss, floats(1e-30f)));
  }
};

}  // namespace treeline::shading::brdf::batch
