// What is reflected under skies that look the same from all around the normal, by the viewer's angle, looked
// up in a table that quadrature has filled. Entries lie evenly in the root of the cosine, for what is
// reflected changes most at grazing angles; of surfaces that azimuths matter to, over a quarter turn too.
#include <cmath>

#include "bench/brdf_integral/rules.hpp"
#include "bench/brdf_integral/share.hpp"
#include "bench/core/registry.hpp"

namespace treeline::bench::brdf_integral {
namespace {

constexpr int nodes = 32;
constexpr double least_cosine = 1e-4;  // in the place of 0, where nothing is seen

class Table final : public Answerer {
 public:
  Table(const Input& input, int entries)
      : n_(entries),
        turns_(input.material.kind == shading::SurfaceKind::microfacet &&
                       input.material.alpha_x != input.material.alpha_y
                   ? std::max(2, entries / 2)
                   : 1) {
    const Integrand f(input.material, true);
    for (auto* table : {&constant_, &cosine_}) table->resize(std::size_t(n_ * turns_));
    share(constant_.size(), input.threads, [&](std::size_t i) {
      const double x = double(i % std::size_t(n_)) / (n_ - 1), mu = std::max(least_cosine, x * x);
      const double turn =
          turns_ == 1 ? 0 : 0.5 * std::numbers::pi * double(i / std::size_t(n_)) / (turns_ - 1);
      const double s = std::sqrt((1 - mu) * (1 + mu));
      const Vec3d wo{s * std::cos(turn), s * std::sin(turn), mu};
      constant_[i] = geometry::Vec3f(over_facets(f, wo, {SkyKind::constant}, nodes));
      cosine_[i] = geometry::Vec3f(over_facets(f, wo, {SkyKind::cosine}, nodes));
    });
    for (int t = 0; t < turns_; ++t)  // 2 E μ dμ = 4 E x³ dx, by trapezoids
      for (int k = 1; k < n_; ++k) {
        const double x = double(k) / (n_ - 1);
        const double end = (k == n_ - 1 ? 0.5 : 1.0) * (turns_ == 1                 ? 1
                                                        : t == 0 || t == turns_ - 1 ? 0.5
                                                                                    : 1.0);
        average_ += geometry::Vec3d(constant_[std::size_t(t * n_ + k)]) *
                    (4 * x * x * x * end / ((n_ - 1) * std::max(1, turns_ - 1)));
      }
  }

  void answer(const Set& set, const Knobs&, int threads, std::span<float> out) override {
    if (set.sky.kind == SkyKind::cap || set.sky.kind == SkyKind::both)
      throw Unsupported("the table was made for other skies");
    const auto& table = set.sky.kind == SkyKind::constant ? constant_ : cosine_;
    accel::parallel_ranges(set.queries(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t q = begin; q < end; ++q) {
        const geometry::Vec3f r = set.averages > 0 ? geometry::Vec3f(average_) : look_up(table, set.views[q]);
        for (int c = 0; c < 3; ++c) out[3 * q + std::size_t(c)] = r[c];
      }
    });
  }

 private:
  /// Between the four entries, or two, around a viewer.
  geometry::Vec3f look_up(const std::vector<geometry::Vec3f>& table, const Vec3d& wo) const {
    const float x = std::sqrt(static_cast<float>(wo[2])) * static_cast<float>(n_ - 1);
    const int k = std::min(static_cast<int>(x), n_ - 2);
    const float a = x - static_cast<float>(k);
    const auto row = [&](int t) {
      const std::size_t i = static_cast<std::size_t>(t * n_ + k);
      return table[i] * (1 - a) + table[i + 1] * a;
    };
    if (turns_ == 1) return row(0);
    const double turn = std::atan2(std::abs(wo[1]), std::abs(wo[0]));  // all quarters are alike
    const auto y = static_cast<float>(turn * 2 / std::numbers::pi * (turns_ - 1));
    const int t = std::min(static_cast<int>(y), turns_ - 2);
    const float b = y - static_cast<float>(t);
    return row(t) * (1 - b) + row(t + 1) * b;
  }

  int n_, turns_;
  std::vector<geometry::Vec3f> constant_, cosine_;
  Vec3d average_{};
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "table",
              .family = "table",
              .claim = Claim::approximate,
              .build_knobs = {{{"entries", 32}}, {{"entries", 8}}, {{"entries", 16}}, {{"entries", 64}}},
              .ladder = 0,
              .quick_builds = 3,
              .scales = false},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Answerer> {
       return std::make_unique<Table>(input, knobs.at("entries").get<int>());
     }});

}  // namespace
}  // namespace treeline::bench::brdf_integral
