// The table of surfaces.
#include <stdexcept>
#include <vector>

#include "datasets_gen/recipe_table.hpp"
#include "datasets_gen/surfaces/surface.hpp"

namespace treeline::datasets {
namespace {

using Numbers = std::vector<double>;

struct Entry {
  KnobRecipe recipe;
  shading::Material (*make)(const Numbers& knobs);
};

/// As rough along both tangents where no second roughness is given.
shading::Material rough(double alpha_x, double alpha_y) {
  shading::Material m;
  m.kind = shading::SurfaceKind::microfacet;
  m.alpha_x = alpha_x, m.alpha_y = alpha_y > 0 ? alpha_y : alpha_x;
  return m;
}

shading::Material lambert(const Numbers& knobs) {
  shading::Material m;
  m.reflectance = shading::Rgb::filled(static_cast<float>(knobs[0]));
  return m;
}

template <shading::Distribution distribution, shading::Masking masking>
shading::Material white(const Numbers& knobs) {
  shading::Material m = rough(knobs[0], knobs[1]);
  m.distribution = distribution, m.masking = masking;
  return m;
}

template <shading::Compensation compensation>
shading::Material compensated(const Numbers& knobs) {
  shading::Material m = rough(knobs[0], 0);
  m.compensation = compensation;
  m.fresnel = shading::FresnelKind::schlick;
  m.reflectance = shading::Rgb::filled(static_cast<float>(knobs[1]));
  return m;
}

shading::Material dielectric(const Numbers& knobs) {
  shading::Material m = rough(knobs[1], 0);
  m.fresnel = shading::FresnelKind::dielectric;
  m.index = knobs[0];
  return m;
}

/// Index and extinction at about 650, 550 and 450 nm.
shading::Material metal(double alpha, const shading::Rgb& index, const shading::Rgb& extinction) {
  shading::Material m = rough(alpha, 0);
  m.fresnel = shading::FresnelKind::conductor;
  m.conductor_index = index, m.conductor_extinction = extinction;
  return m;
}
shading::Material gold(const Numbers& knobs) {
  const shading::Material m;  // whose metal is gold
  return metal(knobs[0], m.conductor_index, m.conductor_extinction);
}
shading::Material aluminium(const Numbers& knobs) {
  return metal(knobs[0], {1.35f, 0.97f, 0.62f}, {7.47f, 6.40f, 5.30f});
}
shading::Material chromium(const Numbers& knobs) {
  return metal(knobs[0], {3.11f, 3.18f, 2.32f}, {3.31f, 3.33f, 3.14f});
}

shading::Material mirror(const Numbers& knobs) {
  shading::Material m;
  m.kind = shading::SurfaceKind::mirror;
  m.reflectance = shading::Rgb::filled(static_cast<float>(knobs[0]));
  return m;
}
shading::Material glass(const Numbers& knobs) {
  shading::Material m;
  m.kind = shading::SurfaceKind::glass;
  m.index = knobs[0];
  return m;
}

const std::vector<Entry>& table() {
  using enum shading::Distribution;
  using enum shading::Masking;
  using enum shading::Compensation;
  constexpr double least = 1e-4, most = 1;
  const Knob along{"alpha", 0.3, least, most}, across{"alpha_across", 0, 0, most};  // 0: the same
  const Knob rough{"alpha", 0.5, least, most}, head_on{"reflectance", 1, 0, 1};
  const Knob smooth{"alpha", 0.2, least, most}, index{"index", 1.5, 0.2, 5};
  static const std::vector<Entry> entries{
      {{"lambert", "the same radiance in all directions", {{"albedo", 0.5, 0, 1}}}, lambert},
      {{"ggx", "GGX facets that reflect all, masked by height", {along, across}}, white<ggx, correlated>},
      {{"separable_ggx", "the same, masked on both ways independently", {along, across}},
       white<ggx, separable>},
      {{"beckmann", "Beckmann facets that reflect all, masked by height", {along, across}},
       white<beckmann, correlated>},
      {{"separable_beckmann", "the same, masked on both ways independently", {along, across}},
       white<beckmann, separable>},
      {{"compensated_ggx",
        "GGX that gives back what a bounce loses, as Kulla and Conty do",
        {rough, head_on}},
       compensated<kulla_conty>},
      {{"textbook_ggx", "the same, with a colour that counts the first bounce twice", {rough, head_on}},
       compensated<kulla_conty_textbook>},
      {{"directional_ggx", "the same, with a colour by the viewer's direction", {rough, head_on}},
       compensated<kulla_conty_directional>},
      {{"turquin_ggx", "the same, by scaling as Turquin does", {rough, head_on}}, compensated<turquin>},
      {{"gold", "GGX facets of gold", {smooth}}, gold},
      {{"aluminium", "GGX facets of aluminium", {smooth}}, aluminium},
      {{"chromium", "GGX facets of chromium", {smooth}}, chromium},
      {{"dielectric", "GGX facets of a dielectric, seen from outside", {index, smooth}}, dielectric},
      {{"mirror", "a perfect mirror", {{"reflectance", 0.9, 0, 1}}}, mirror},
      {{"glass", "smooth glass", {{"index", 1.5, 0.2, 5}}}, glass},
  };
  return entries;
}

}  // namespace

std::span<const KnobRecipe> surface_recipes() {
  static const std::vector<KnobRecipe> list = recipes_in(table());
  return list;
}

bool is_surface(std::string_view name) { return find_entry(table(), name) != nullptr; }

shading::Material make_surface(std::string_view name) {
  const Entry& entry = entry_called(table(), "surface", name);
  shading::Material material = entry.make(read_knobs("surface", name, entry.recipe));
  material.name = name;
  return material;
}

}  // namespace treeline::datasets
