#include "bench/shadow/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/shadow/leaks.hpp"
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

/// The floor and the lit face of a wall across the light, as the texels of a map see them; along x.
struct FloorAndWall {
  double along;     ///< the light's part across the wall
  double on_floor;  ///< how far the floor at a texel's centre may be from the receiver
  double on_wall;   ///< how far the wall's face would have to be moved to have the depth at the centre
  double deeper;    ///< how much deeper than at the centre the floor may be
  FloorAndWall(const shading::shadow::LightView& view, int n) : along(std::abs(view.forward[0])) {
    const double down = view.forward[1];
    const auto half_texel = [&](double right_part, double down_part) {
      return 0.5 *
             (std::abs(right_part) * view.texel_width(n, 1) + std::abs(down_part) * view.texel_height(n, 1));
    };
    const auto& r = view.right;
    const auto& d = view.down;
    // Across the map and then along the light, back to the floor.
    on_floor = half_texel(r[0] - view.forward[0] * r[1] / down, d[0] - view.forward[0] * d[1] / down);
    on_wall = half_texel(r[0], d[0]);
    deeper = half_texel(r[1], d[1]) / std::abs(down);
  }
};

/// A bias b along the light lifts the receiver by b, and so over the wall if it is nearer to its lit face
/// than b times the light's part across the wall. By the slope it is the bound of shading/shadow/bias.hpp. An
/// offset along the normal lifts the receiver straight up: past the wall's top at its tip, and nothing at its
/// foot. What is told is how far along the line from its first receiver, behind the wall, all is lit.
/// Slack: a texel's depth is that at its centre. As the wall's face there may be nearer or farther, so may
/// the shadow's begin; a centre before the wall sees the floor, and then the receiver is lit, unless the bias
/// is too small for that; receivers stand a step apart.
std::optional<Figure> gap(const shading::Scene& scene, std::span<const Receiver> receivers,
                          const Knobs& build, const Knobs& query) {
  if (query.value("plane", false)) return std::nullopt;
  const auto view = view_of(scene);
  const FloorAndWall seen(view, build.at("resolution").get<int>());
  double b = query.value("constant", 0.0) * (view.far - view.near);
  b += query.value("bias", 0.0) * seen.deeper;
  const double allowed = geometry::tolerance::shadow_depth_slack * (view.far - view.near + seen.deeper);
  // From the lit face, which is at minus half the thickness.
  const double first = receivers.front().position[0] + 0.5 * scene_knobs(scene.name, "wall_on_floor")[0];
  const double lit = std::max(first, b * seen.along);
  const double shifted = seen.on_wall + allowed * seen.along;
  const double most = std::max(lit + shifted, seen.on_floor);
  const double least = b < seen.deeper && first < seen.on_floor ? first : lit - shifted;
  const auto& last = receivers.back().position;
  const double askew = distance(receivers.front().position, last) / (last[0] - receivers.front().position[0]);
  const double step = (last[0] - receivers.front().position[0]) / double(receivers.size() - 1);
  return Figure{"shadow_gap", (lit - first) * askew, b,
                (std::max(most - lit, lit - std::max(first, least)) + step) * askew};
}

/// What is above the cut, scaled to begin at 0.
double above_cut(double share, double cut) { return std::max(0.0, (share - cut) / (1 - cut)); }

/// Beneath the edges of blockers in level sheets: where they lie, and how receivers on the line pass them.
Stack stack_of(const shading::shadow::LightView& view, std::initializer_list<double> heights) {
  Stack stack;
  const auto depth = [&](double height) { return view.place({0, height, 0}).depth; };
  for (const double h : heights) stack.blockers.push_back(depth(h));
  stack.receiver = depth(0);
  return stack;
}
Sweep sweep_of(const shading::shadow::LightView& view, std::span<const Receiver> receivers,
               const Knobs& build) {
  Sweep sweep;
  sweep.side = 2 * build.at("radius").get<int>() + 1;
  // The floor's x runs down the map.
  const double texel = view.texel_height(build.at("resolution").get<int>(), 1);
  const double apart = std::abs(receivers[1].position[0] - receivers[0].position[0]);
  sweep.step = apart / (sweep.side * texel);
  return sweep;
}
Figure leak_figure(double most, double slack, double cut) {
  return {"shadow_max", above_cut(most, cut), std::nullopt, slack / (1 - cut)};
}

/// Blockers at depths a < b before the receiver t, r = (t - b)/(b - a), in shares p and 1 - p of the filter:
/// two moments leak p(1 - p)/(p(1 - p) + (r + p)²), at most 1/(1 + 2r)², where p = r/(1 + 2r). Four moments
/// tell two depths apart: nothing leaks but what rounding and the bias of the moments, alpha, let through.
Figure leak_of_two(const shading::Scene& scene, std::span<const Receiver> receivers,
                   const std::string& method, const Knobs& build, const Knobs& query) {
  const double r = scene_knobs(scene.name, "two_stacked")[0], cut = query.value("cut", 0.0), upper = 4;
  const auto view = view_of(scene);
  const Stack stack = stack_of(view, {upper, upper * r / (1 + r)});
  Sweep sweep = sweep_of(view, receivers, build);
  sweep.shares = [](double at) {
    const double p = std::clamp(0.5 + at, 0.0, 1.0);
    return std::vector{p, 1 - p};
  };
  if (method == "msm")
    return leak_figure(0, leak_of_four_moments(stack, sweep, query.at("alpha").get<double>()).slack, cut);
  const Leak leak = leak_of_two_moments(stack, sweep);
  const double most = 1 / ((1 + 2 * r) * (1 + 2 * r));
  return leak_figure(most, leak.slack + std::abs(leak.most - most), cut);
}

/// Blockers at depths 0, 1, 2 before the receiver at t = 2 + g, in shares p of the filter. Two moments leak
/// their Chebyshev bound. Four leak what the deepest support point may weigh, 1/(vᵀ B⁻¹ v) with B the matrix
/// of moments and v = (1, t, t²); that is 1/Σ L²/p with Lagrange's polynomials L at t. The most over the
/// line of receivers, which passes from one side of the edges' crossing to the other at a slope of 0.9, while
/// a square filter sees the first blocker in a share u, the second in w of the rest.
Figure leak_of_three(const shading::Scene& scene, std::span<const Receiver> receivers,
                     const std::string& method, const Knobs& build, const Knobs& query) {
  const double g = scene_knobs(scene.name, "three_layers")[0], slope = 0.9, cut = query.value("cut", 0.0);
  const auto view = view_of(scene);
  const Stack stack = stack_of(view, {g + 2, g + 1, g});
  Sweep sweep = sweep_of(view, receivers, build);
  sweep.shares = [slope](double at) {
    const double u = std::clamp(0.5 + at, 0.0, 1.0), w = std::clamp(0.5 + slope * at, 0.0, 1.0);
    return std::vector{u, (1 - u) * w, (1 - u) * (1 - w)};
  };
  const Leak leak = method == "msm" ? leak_of_four_moments(stack, sweep, query.at("alpha").get<double>())
                                    : leak_of_two_moments(stack, sweep);
  return leak_figure(leak.most, leak.slack, cut);
}

/// Points on a circle of length 1, from a pattern over [-1, 1] whose ends meet.
class OnCircle {
 public:
  explicit OnCircle(const std::vector<shading::shadow::Tap>& taps) {
    for (const auto& t : taps) at_.push_back(0.5 * (double(t.x) + 1));
    std::ranges::sort(at_);
  }
  std::size_t size() const { return at_.size(); }
  /// From one of them to that so many places on, over all of them: the shortest and the longest way.
  std::pair<double, double> ways(std::size_t places) const {
    double least = 1, most = 0;
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const std::size_t k = i + places;
      const double way = at_[k % at_.size()] - at_[i] + double(k / at_.size());
      least = std::min(least, way), most = std::max(most, way);
    }
    return {least, most};
  }

 private:
  std::vector<double> at_;
};

/// By how much a penumbra of width 1 that is told by taps, each receiver's shifted by an amount of its own,
/// may differ from the 0.8 that lie between 10 and 90 % of the light. Lit are the taps on an arc of the
/// circle as long as the light's share r. It holds k of them for some shift if it is as long as the shortest
/// way from one to that k - 1 places on, and for any if as long as the longest way k places on; so for the
/// dark arc, 1 - r. And where the search misses the blockers, as its dark arc holds no tap, all is taken to
/// be lit.
double unevenness(const OnCircle& filter, const OnCircle& search) {
  const auto n = double(filter.size());
  const auto lit = static_cast<std::size_t>(std::ceil(0.1 * n)),
             dark = filter.size() - static_cast<std::size_t>(std::ceil(0.9 * n));
  const double first_low = filter.ways(lit - 1).first, last_low = filter.ways(lit).second;
  const double first_high = 1 - std::max(filter.ways(dark + 1).second, search.ways(1).second),
               last_high = 1 - filter.ways(dark).first;
  return std::max(last_high - first_low - 0.8, 0.8 - (first_high - last_low));
}

/// Across an edge that runs along the columns of a map a square filter of n = 2 radius + 1 texels is a ramp n
/// texels wide, of which 80 % lie between; unless it is smooth, a stair of n steps, and so of n + 1 levels.
/// The filter of blockers' depths makes the ramp as wide as the light is seen over the edge. Few taps are as
/// many steps, of those that pass the edge while the line lasts: it runs through a corner of four texels.
/// Slack of widths: either end lies between two receivers. Levels have none.
std::optional<Figure> penumbra(const shading::Scene& scene, std::span<const Receiver> receivers,
                               const std::string& method, const Knobs& build, const Knobs& query) {
  const auto knobs = scene_knobs(scene.name, "half_plane_edge");
  const auto line = datasets::known_shadows(scene.name).lines.front();
  // Along the line, which is a little askew.
  const double askew = distance(line.from, line.to) / std::abs(line.to[0] - line.from[0]);
  const auto view = view_of(scene);
  // The floor's x runs down the map.
  const double texel =
      view.texel_height(build.at("resolution").get<int>(), dot(line.from - view.origin, view.forward));
  const double two_steps = 2 * distance(receivers[1].position, receivers[0].position);
  const auto width = [&](double whole, double uneven) {
    return Figure{"shadow_width", 0.8 * whole * askew, std::nullopt, uneven * whole * askew + two_steps};
  };
  const auto levels = [](double n) { return Figure{"shadow_levels", n}; };
  using shading::shadow::TapPattern;
  if (method == "pcss") {
    if (query.contains("width") || query.value("taps", 0) < 64) return std::nullopt;
    const auto circle = [&](const char* knob) {
      return OnCircle(shading::shadow::taps(TapPattern::square, query.at(knob).get<int>()));
    };
    return width(knobs[1] * knobs[0] / (4 - knobs[0]), unevenness(circle("taps"), circle("search")));
  }
  if (method == "pcf_disc") {
    const int taps = query.at("taps").get<int>(), radius = query.at("radius").get<int>();
    if (taps > 2 * radius) return std::nullopt;  // some share a column of texels
    const double reach = std::abs(line.to[0]) / texel;
    if (reach >= radius) return levels(taps + 1.0);
    if (query.value("turned", true)) return std::nullopt;  // each receiver's reach farther, or do not
    const auto set = shading::shadow::taps(TapPattern::spiral, taps);
    const auto passes = [&](const shading::shadow::Tap& t) { return std::abs(t.y * radius) < reach; };
    return levels(1.0 + double(std::ranges::count_if(set, passes)));
  }
  const int n = 2 * query.at("radius").get<int>() + 1;
  if (!query.at("smooth").get<bool>()) return levels(n + 1.0);
  return width(n * texel, 0);
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
    return gap(scene, receivers, build, query);
  if (set == "leak" && (method == "vsm" || method == "msm") && build.value("radius", 0) >= 1 &&
      query.value("bias", 0.0) == 0) {
    if (is_scene_of(scene.name, "two_stacked")) return leak_of_two(scene, receivers, method, build, query);
    if (is_scene_of(scene.name, "three_layers")) return leak_of_three(scene, receivers, method, build, query);
  }
  if (is_scene_of(scene.name, "half_plane_edge") && set == "edge" &&
      (method == "pcf" || method == "pcf_disc" || method == "pcss"))
    return penumbra(scene, receivers, method, build, query);
  constexpr double box_ends = 1.5;
  if (is_scene_of(scene.name, "eye_inside_volume") && set == "image" && method == "shadow_volumes_z_pass" &&
      scene_knobs(scene.name, "eye_inside_volume")[0] < box_ends)
    return inside_volume();
  return std::nullopt;
}

}  // namespace treeline::bench::shadow
