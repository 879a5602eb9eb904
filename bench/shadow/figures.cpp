#include "bench/shadow/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets_gen/hard/hard_shadows.hpp"
#include "geometry/tolerances.hpp"
#include "shading/shadow/light_view.hpp"
#include "shading/shadow/second_depth.hpp"
#include "shading/shadow/taps.hpp"

namespace treeline::bench::shadow {
namespace {

using datasets::is_scene_of;
using datasets::scene_knobs;

shading::shadow::LightView view_of(const shading::Scene& scene) {
  const auto box = scene.mesh.box();
  return shading::shadow::fit_view(scene.light, {geometry::Vec3d(box.low), geometry::Vec3d(box.high)});
}

/// Of receivers on one plane under a directional light, in a map of n² texels: how the plane's depth changes
/// from one texel to the next, and how much deeper each receiver is than the plane at its texel's centre. x
/// and y are even in [−½, ½] texels where receivers are many and in no step with the texels, and so the
/// latter is a sum of two even variables.
class PlaneInTexels {
 public:
  PlaneInTexels(const shading::shadow::LightView& view, int n, std::span<const Receiver> receivers)
      : range_(view.far - view.near) {
    const auto& normal = receivers.front().normal;
    const double per_depth = -1 / dot(normal, view.forward);
    const double x = dot(normal, view.right) * view.texel_width(n, 1) * per_depth,
                 y = dot(normal, view.down) * view.texel_height(n, 1) * per_depth;
    for (const Receiver& r : receivers) {
      const auto at = view.place(r.position);
      const auto beside_centre = [n](double share) { return share * n - std::floor(share * n) - 0.5; };
      beyond_.push_back(x * beside_centre(at.x) + y * beside_centre(at.y));
    }
    std::ranges::sort(beyond_);
    wide_ = 0.5 * std::max(std::abs(x), std::abs(y)), narrow_ = 0.5 * std::min(std::abs(x), std::abs(y));
  }

  double most() const { return wide_ + narrow_; }                 ///< that a receiver may be deeper
  double rise() const { return 2 * std::hypot(wide_, narrow_); }  ///< s tan θ
  /// The share that is deeper by more than b, if even.
  double deeper(double b) const {
    if (b < 0) return 1 - deeper(-b);
    if (b >= most()) return 0;
    if (b <= wide_ - narrow_) return 0.5 - b / (2 * wide_);
    return (most() - b) * (most() - b) / (8 * wide_ * narrow_);
  }
  /// False shadow under a bias b: what is deeper by more than that, and than what is allowed for rounding.
  Figure acne(double b) const {
    const double allowed = geometry::tolerance::shadow_depth_slack * (range_ + most());
    return {"shadow_false_dark", deeper(b + allowed), b, unevenness() + allowed / (2 * wide_)};
  }

 private:
  /// The most by which any share of these receivers differs from that of even ones (Kolmogorov's distance).
  double unevenness() const {
    double most = 0;
    const auto n = double(beyond_.size());
    for (std::size_t i = 0; i < beyond_.size(); ++i) {
      const double even = 1 - deeper(beyond_[i]);
      most = std::max({most, even - double(i) / n, double(i + 1) / n - even});
    }
    return most;
  }

  double range_, wide_, narrow_;  // half of what the depth changes by, along the steeper axis and the other
  std::vector<double> beyond_;
};

/// A texel's depth is that at its centre; a receiver of the same plane is deeper by s tan θ (x cos φ + y sin
/// φ). The share of them with more than the bias b is in false shadow: along an axis max(0, ½ − b/(s tan θ)),
/// along the diagonal max(0, 1 − b √2/(s tan θ))²/2.
Figure acne(const shading::Scene& scene, std::span<const Receiver> receivers, const Knobs& build,
            const Knobs& query) {
  const auto view = view_of(scene);
  const PlaneInTexels plane(view, build.at("resolution").get<int>(), receivers);
  double b = query.value("constant", 0.0) * (view.far - view.near);
  b += query.value("bias", 0.0) * plane.most();
  b += query.value("offset", 0.0) * plane.rise();
  if (query.value("plane", false)) b = plane.most();
  return plane.acne(b);
}

/// A slab of thickness T along the light puts its midpoint T/2 below its top, and its second depth T: as much
/// as a bias that its top has besides. Woo's max(0, ½ − T/(2 s tan θ)), where the slope is along an axis.
std::optional<Figure> acne_of_slab(const shading::Scene& scene, std::span<const Receiver> receivers,
                                   const std::string& method, const Knobs& build, const Knobs& query) {
  if (query.at("radius") != 0) return std::nullopt;
  const auto view = view_of(scene);
  const double thickness = scene_knobs(scene.name, "slab_and_sheet")[0];
  const double along_light = thickness / -dot(view.forward, receivers.front().normal);
  const PlaneInTexels plane(view, build.at("resolution").get<int>(), receivers);
  const double most = shading::shadow::SecondDepthOptions{}.most * (view.far - view.near);
  const double beneath = method == "second_depth" ? along_light
                         : method == "dual_depth" ? std::min(0.5 * along_light, most)
                                                  : 0.5 * along_light;
  return plane.acne(beneath + query.value("bias", 0.0) * plane.most());
}

/// A bias b along the light lifts the receiver by b, and so over the wall if it is nearer to its foot than b
/// times the light's part across the wall; the wall's own thickness counts back. By the slope it is the bound
/// of shading/shadow/bias.hpp. An offset along the normal lifts the receiver straight up: past the wall's top
/// at its tip, and nothing at its foot.
std::optional<Figure> gap(const shading::Scene& scene, const Knobs& build, const Knobs& query) {
  const auto view = view_of(scene);
  const double thickness = scene_knobs(scene.name, "wall_on_floor")[0];
  if (query.value("plane", false)) return std::nullopt;
  if (query.contains("offset")) return Figure{"shadow_gap", 0, 0};
  double b = query.value("constant", 0.0) * (view.far - view.near);
  if (query.contains("bias")) {
    const geometry::Vec3d up{0, 1, 0};
    const double cosine = -dot(view.forward, up);
    const int n = build.at("resolution").get<int>();
    // Of the floor's depth, by texel: what its normal has across the map over what it has along the light.
    const double across = std::abs(dot(view.right, up)) * view.texel_width(n, 1),
                 down = std::abs(dot(view.down, up)) * view.texel_height(n, 1);
    b += query.at("bias").get<double>() * 0.5 * (across + down) / cosine;
  }
  return Figure{"shadow_gap", std::max(0.0, b * std::abs(scene.light.direction[0]) - thickness), b};
}

/// What is above the cut, scaled to begin at 0.
double above_cut(double share, double cut) { return std::max(0.0, (share - cut) / (1 - cut)); }

/// Blockers at depths a < b before the receiver t, r = (t - b)/(b - a), in shares p and 1 - p of the filter:
/// two moments leak p(1 - p)/(p(1 - p) + (r + p)²), at most 1/(1 + 2r)², where p = r/(1 + 2r). Four moments
/// tell two depths apart: nothing leaks but what the bias of the moments, alpha, lets through.
std::optional<Figure> leak_of_two(const shading::Scene& scene, const std::string& method,
                                  const Knobs& query) {
  const double r = scene_knobs(scene.name, "two_stacked")[0], cut = query.value("cut", 0.0);
  if (method == "msm") return Figure{"shadow_max", 0};
  return Figure{"shadow_max", above_cut(1 / ((1 + 2 * r) * (1 + 2 * r)), cut)};
}

/// Blockers at depths 0, 1, 2 before the receiver at t = 2 + g, in shares p of the filter. Two moments leak
/// their Chebyshev bound. Four leak what the deepest support point may weigh, 1/(vᵀ B⁻¹ v) with B the matrix
/// of moments and v = (1, t, t²); that is 1/Σ L²/p with Lagrange's polynomials L at t. The most over the
/// line of receivers, which passes from one side of the edges' crossing to the other at a slope of 0.9, while
/// a square filter sees the first blocker in a share u, the second in w of the rest.
Figure leak_of_three(const shading::Scene& scene, const std::string& method, const Knobs& query) {
  const double g = scene_knobs(scene.name, "three_layers")[0], t = 2 + g, slope = 0.9;
  const double lagrange[] = {0.5 * (t - 1) * (t - 2), -t * (t - 2), 0.5 * t * (t - 1)};
  double most = 0;
  constexpr int steps = 4000;
  for (int k = 0; k <= steps; ++k) {
    const double at = 1 - 2.0 * k / steps;
    const double u = std::clamp(0.5 + at, 0.0, 1.0), w = std::clamp(0.5 + slope * at, 0.0, 1.0);
    const double p[] = {u, (1 - u) * w, (1 - u) * (1 - w)};
    const double mean = p[1] + 2 * p[2], variance = p[1] + 4 * p[2] - mean * mean;
    double found = variance / (variance + (t - mean) * (t - mean));
    if (method == "msm") {
      double sum = 0;
      for (int i = 0; i < 3; ++i) sum += lagrange[i] * lagrange[i] / p[i];
      found = 1 / sum;  // 0 where one of the three is not in sight
    }
    most = std::max(most, found);
  }
  return {"shadow_max", above_cut(most, query.value("cut", 0.0))};
}

/// Across an edge that runs along the columns of a map a square filter of n = 2 radius + 1 texels is a ramp n
/// texels wide, of which 80 % lie between; unless it is smooth, a stair of n steps, and so of n + 1 levels.
/// The filter of blockers' depths makes the ramp as wide as the light is seen over the edge. Few taps are as
/// many steps, of those that pass the edge while the line lasts: it runs through a corner of four texels.
std::optional<Figure> penumbra(const shading::Scene& scene, const std::string& method, const Knobs& build,
                               const Knobs& query) {
  const auto knobs = scene_knobs(scene.name, "half_plane_edge");
  const auto line = datasets::known_shadows(scene.name).lines.front();
  // Along the line, which is a little askew.
  const double askew = distance(line.from, line.to) / std::abs(line.to[0] - line.from[0]);
  const auto view = view_of(scene);
  const double texel =
      view.texel_width(build.at("resolution").get<int>(), dot(line.from - view.origin, view.forward));
  if (method == "pcss") {
    if (query.contains("width") || query.value("taps", 0) < 64) return std::nullopt;
    return Figure{"shadow_width", 0.8 * knobs[1] * knobs[0] / (4 - knobs[0]) * askew};
  }
  if (method == "pcf_disc") {
    const int taps = query.at("taps").get<int>(), radius = query.at("radius").get<int>();
    if (taps > 2 * radius) return std::nullopt;  // some share a column of texels
    const double reach = std::abs(line.to[0]) / texel;
    if (reach >= radius) return Figure{"shadow_levels", taps + 1.0};
    if (query.value("turned", true)) return std::nullopt;  // each receiver's reach farther, or do not
    const auto set = shading::shadow::taps(shading::shadow::TapPattern::spiral, taps);
    // The floor's x runs along the map's columns.
    const auto passes = [&](const shading::shadow::Tap& t) { return std::abs(t.y * radius) < reach; };
    return Figure{"shadow_levels", 1.0 + double(std::ranges::count_if(set, passes))};
  }
  const int n = 2 * query.at("radius").get<int>() + 1;
  if (!query.at("smooth").get<bool>()) return Figure{"shadow_levels", n + 1.0};
  return Figure{"shadow_width", 0.8 * n * texel * askew};
}

/// Counts from an eye that is inside of a shadow's volume are less by one everywhere: what is lit counts -1,
/// which is not 0, and what is in the shadow counts 0.
Figure inside_volume() { return {"shadow_wrong", 1}; }

}  // namespace

std::optional<Figure> figure_of(const shading::Scene& scene, const std::string& set,
                                std::span<const Receiver> receivers, const std::string& method,
                                const Knobs& build, const Knobs& query) {
  if (is_scene_of(scene.name, "tilted_plane") && set == "image" && method == "shadow_map")
    return acne(scene, receivers, build, query);
  if (is_scene_of(scene.name, "slab_and_sheet") && set == "top") {
    if (method == "shadow_map") return acne(scene, receivers, build, query);
    if (method == "midpoint" || method == "dual_depth" || method == "second_depth")
      return acne_of_slab(scene, receivers, method, build, query);
  }
  if (is_scene_of(scene.name, "wall_on_floor") && set == "contact" && method == "shadow_map")
    return gap(scene, build, query);
  if (set == "leak" && (method == "vsm" || method == "msm") && build.value("radius", 0) >= 1 &&
      query.value("bias", 0.0) == 0) {
    if (is_scene_of(scene.name, "two_stacked")) return leak_of_two(scene, method, query);
    if (is_scene_of(scene.name, "three_layers")) return leak_of_three(scene, method, query);
  }
  if (is_scene_of(scene.name, "half_plane_edge") && set == "edge" &&
      (method == "pcf" || method == "pcf_disc" || method == "pcss"))
    return penumbra(scene, method, build, query);
  constexpr double box_ends = 1.5;
  if (is_scene_of(scene.name, "eye_inside_volume") && set == "image" && method == "shadow_volumes_z_pass" &&
      scene_knobs(scene.name, "eye_inside_volume")[0] < box_ends)
    return inside_volume();
  return std::nullopt;
}

}  // namespace treeline::bench::shadow
