#include "datasets_gen/hard/hard_surfaces.hpp"

#include <limits>

namespace treeline::datasets {
namespace {

using shading::Material;

Material rough(double alpha_x, double alpha_y) {
  Material m;
  m.kind = shading::SurfaceKind::microfacet;
  m.alpha_x = alpha_x, m.alpha_y = alpha_y;
  return m;
}
Material rough(double alpha) { return rough(alpha, alpha); }

}  // namespace

std::vector<HardSurface> hard_surfaces() {
  using enum shading::FresnelKind;
  using enum shading::Compensation;
  const std::vector<double> around{0.15, 0.4, 0.7, 0.95}, grazing{1e-4, 1e-3, 0.01, 0.05};
  const std::string sum = "what is reflected is what two quadratures in double say";
  const std::string or_refused = "a refusal";
  std::vector<HardSurface> all;
  const auto add = [&](std::string name, std::string source, std::string law, Material m,
                       std::vector<double> cosines) -> HardSurface& {
    all.push_back({.name = std::move(name),
                   .source = std::move(source),
                   .law = std::move(law),
                   .material = std::move(m),
                   .cosines = std::move(cosines)});
    all.back().material.name = all.back().name;
    return all.back();
  };
  add("surface_alpha_0.001", "measured: the textbook's D in float is 2.6 % low at its peak", sum, rough(1e-3),
      around);
  add("surface_alpha_0.0002", "measured: the textbook's D in float is 55 % low at its peak", sum, rough(2e-4),
      around);
  add("surface_alpha_0.0001", "measured: the textbook's D in float divides by zero at its peak", sum,
      rough(1e-4), around);
  add("surface_alpha_1e-06", "derivation: D beyond 1e11, a lobe that no sample of a light meets",
      "samples of what is seen weigh nearly 1", rough(1e-6), around);
  Material beckmann = rough(1e-3);
  beckmann.distribution = shading::Distribution::beckmann;
  add("surface_beckmann_0.001", "derivation: the tangent's square over the roughness's is 0 / 0 at the peak",
      sum, beckmann, around);
  beckmann.alpha_x = beckmann.alpha_y = 1;
  add("surface_beckmann_grazing", "derivation: erf and its complement cancel at grazing angles", sum,
      beckmann, grazing);
  add("surface_grazing_0.3", "derivation: cosines in the divisor", sum, rough(0.3), grazing);
  add("surface_grazing_0.05", "derivation: cosines in the divisor, and a narrow lobe", sum, rough(0.05),
      grazing);
  add("surface_grazing_1", "derivation: half of the facets seen lie behind", sum, rough(1), grazing);
  add("surface_streak", "derivation: a thousand times rougher along one tangent", sum, rough(1e-3, 1),
      around);
  add("surface_beyond_one", "derivation: slopes steeper than 45 degrees are no error", sum, rough(2.5),
      around);
  Material inside = rough(0.2);
  inside.fresnel = dielectric, inside.index = 1 / 1.5;
  add("surface_total_reflection",
      "derivation: all is reflected beyond the critical angle, with an edge there", sum, inside, around);
  Material even = rough(0.3);
  even.fresnel = dielectric, even.index = 1;
  add("surface_no_boundary", "derivation: equal indices reflect nothing", "nothing is reflected", even,
      around);
  Material dark = rough(0.3);
  dark.fresnel = conductor;
  dark.conductor_index = shading::Rgb::filled(0.2f), dark.conductor_extinction = shading::Rgb::filled(0.2f);
  add("surface_dark_metal", "measured: Schlick's approximation is off by 0.4", sum, dark, around);
  Material smooth = rough(1e-4);
  smooth.fresnel = schlick, smooth.reflectance = shading::Rgb::filled(1.0f),
  smooth.compensation = kulla_conty;
  add("surface_nothing_to_give_back", "measured: 1 - E of near-mirrors is 0, and so is what it is divided by",
      sum, smooth, around);
  Material black = rough(0.5);
  black.fresnel = schlick, black.reflectance = shading::Rgb::filled(0.0f), black.compensation = kulla_conty;
  add("surface_black", "derivation: a compensation of what reflects at grazing angles alone", sum, black,
      around);

  const auto refused = [&](std::string name, const std::string& source, Material m) {
    add(std::move(name), "derivation: " + source, or_refused, std::move(m), around).expect =
        Expect::answers_or_refuses;
  };
  refused("surface_alpha_0", "a mirror by another name", rough(0));
  refused("surface_alpha_negative", "its square hides it", rough(-0.3));
  refused("surface_alpha_nan", "no number", rough(std::numeric_limits<double>::quiet_NaN()));
  Material bright;
  bright.reflectance = shading::Rgb::filled(1.5f);
  refused("surface_albedo_above_1", "makes light", bright);
  Material mirror;
  mirror.kind = shading::SurfaceKind::mirror;
  refused("surface_mirror", "no function reflects like it", mirror);
  return all;
}

}  // namespace treeline::datasets
