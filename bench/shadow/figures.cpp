#include "bench/shadow/figures.hpp"

#include <cmath>
#include <numbers>

#include "datasets_gen/hard/hard_shadows.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::bench::shadow {
namespace {

using datasets::is_scene_of;
using datasets::scene_knobs;

constexpr double degree = std::numbers::pi / 180;

shading::shadow::LightView view_of(const shading::Scene& scene) {
  const auto box = scene.mesh.box();
  return shading::shadow::fit_view(scene.light, {geometry::Vec3d(box.low), geometry::Vec3d(box.high)});
}

/// A texel's depth is that at its centre; a receiver of the same plane is deeper by s tan θ (x cos φ + y sin
/// φ), x and y even in [−½, ½] texels. The share of them with more than the bias b is in false shadow: along
/// an axis max(0, ½ − b/(s tan θ)), along the diagonal max(0, 1 − b √2/(s tan θ))²/2.
std::optional<Figure> acne(const shading::Scene& scene, const Knobs& build, const Knobs& query) {
  const auto knobs = scene_knobs(scene.name, "tilted_plane");
  const bool diagonal = knobs[1] == 45;
  if (!diagonal && knobs[1] != 0) return std::nullopt;
  const auto view = view_of(scene);
  const double s = view.texel_width(build.at("resolution").get<int>(), 1);
  const double rise = s * std::tan(knobs[0] * degree);
  double b = query.value("constant", 0.0) * (view.far - view.near);
  b += query.value("bias", 0.0) * 0.5 * rise * (diagonal ? std::numbers::sqrt2 : 1);
  b += query.value("offset", 0.0) * rise;
  if (query.value("plane", false)) b = rise;
  if (!diagonal) return Figure{"shadow_false_dark", std::max(0.0, 0.5 - b / rise), b};
  const double left = std::max(0.0, 1 - b * std::numbers::sqrt2 / rise);
  return Figure{"shadow_false_dark", 0.5 * left * left, b};
}

/// A bias b along the light lifts the receiver by b, and so over the wall if it is nearer to its foot than b
/// times the light's part across the wall; the wall's own thickness counts back.
std::optional<Figure> gap(const shading::Scene& scene, const Knobs& query) {
  if (!query.contains("constant")) return std::nullopt;
  const auto view = view_of(scene);
  const double thickness = scene_knobs(scene.name, "wall_on_floor")[0];
  const double b = query.at("constant").get<double>() * (view.far - view.near);
  return Figure{"shadow_gap", std::max(0.0, b * std::abs(scene.light.direction[0]) - thickness), b};
}

/// Blockers at depths a < b before the receiver t, r = (t - b)/(b - a), in shares p and 1 - p of the filter:
/// two moments leak p(1 - p)/(p(1 - p) + (r + p)²), at most 1/(1 + 2r)², where p = r/(1 + 2r). Cutting leaks
/// rescales what is above the cut.
std::optional<Figure> leak(const shading::Scene& scene, const Knobs& query) {
  const double r = scene_knobs(scene.name, "two_stacked")[0], cut = query.value("cut", 0.0);
  if (query.value("bias", 0.0) != 0) return std::nullopt;
  const double most = 1 / ((1 + 2 * r) * (1 + 2 * r));
  return Figure{"shadow_max", std::max(0.0, (most - cut) / (1 - cut))};
}

}  // namespace

std::optional<Figure> figure_of(const shading::Scene& scene, const std::string& set,
                                const std::string& method, const Knobs& build, const Knobs& query) {
  if (is_scene_of(scene.name, "tilted_plane") && set == "image" && method == "shadow_map")
    return acne(scene, build, query);
  if (is_scene_of(scene.name, "wall_on_floor") && set == "contact" && method == "shadow_map")
    return gap(scene, query);
  if (is_scene_of(scene.name, "two_stacked") && set == "leak" && method == "vsm" &&
      build.value("radius", 0) >= 1)
    return leak(scene, query);
  return std::nullopt;
}

}  // namespace treeline::bench::shadow
