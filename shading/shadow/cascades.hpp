// Cascaded shadow maps: the view cut into slices by distance, each with a map of its own, so that texels are
// small where the camera is near. (Parallel split: Zhang et al. 2006. Fitted to the visible samples:
// Lauritzen, Salvi and Lefohn 2011.)
//
// The practical split puts border i of m between n and f at lambda n (f/n)^(i/m) + (1 - lambda) (n + (f - n)
// i/m). A slice of [a, b] needs (b - a) / a texels of depth for texels as small, on the screen, as at its
// near end: over f/n = 1000 one map needs 999 of them, four of lambda = 1 need 4 · 4.62 = 18.5 in all. A
// slice's map holds either the sphere around that slice of the camera's frustum, whose size does not change
// as the camera turns, with its corner on a whole number of texels, so that texels stay where they are as the
// camera moves (crawl is then 0); or the box around the visible samples of the slice, which is the smallest
// there is, and crawls.
// Cost: a map each, one query. Known weakness: the density of texels is all that improves, bias and leaks
// stay; seams appear where slices meet; parallel light alone.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

/// m + 1 distances, from near to far. Throws InvalidScene unless 0 < near < far, m >= 1 and lambda in [0, 1].
inline std::vector<double> practical_splits(double near, double far, int m, double lambda) {
  if (!(near > 0 && far > near && std::isfinite(far)))
    throw InvalidScene("the distances to split are from " + std::to_string(near) + " to " +
                       std::to_string(far));
  detail::check_knob("cascades", m, 1, 64);
  detail::check_knob("lambda", lambda, 0, 1);
  std::vector<double> r;
  for (int i = 0; i <= m; ++i) {
    const double s = double(i) / m;
    r.push_back(lambda * near * std::pow(far / near, s) + (1 - lambda) * (near + (far - near) * s));
  }
  r.front() = near, r.back() = far;
  return r;
}

struct CascadeOptions {
  int count = 4;
  double lambda = 1;
  /// Distances along the camera's axis; 0: those of the visible samples. Texels stay only where these do.
  double near = 0, far = 0;
  int resolution = 1024;  ///< texels along each side of each map
  /// Sides of maps are those of the visible samples; if not, of the frustum's slices.
  bool fitted = true;
  bool snapped = true;  ///< corners of maps that are not fitted lie on whole texels
  double margin = 4;    ///< texels left free around what a map must hold, for filters
};

/// Where the slices end and what each one's map sees.
struct CascadeViews {
  std::vector<double> splits;    ///< count + 1 distances along the camera's axis
  std::vector<LightView> views;  ///< one a slice
  Vec3d eye{}, axis{0, 0, -1};   ///< of the camera

  double distance(const Vec3d& p) const { return dot(p - eye, axis); }
  /// The slice of a point's distance; if its map does not hold the point, the next farther one whose map
  /// does.
  std::size_t slice(const Vec3d& p) const {
    const double z = distance(p);
    std::size_t own = 0;
    while (own + 1 < views.size() && !(z < splits[own + 1])) ++own;
    for (std::size_t i = own; i < views.size(); ++i) {
      const LightView::Place q = views[i].place(p);
      if (q.x >= 0 && q.x < 1 && q.y >= 0 && q.y < 1) return i;
    }
    return own;
  }
};

namespace detail {

/// A window of the whole view, from x0 to x1 along its right and y0 to y1 along its down, in world units from
/// the world's origin.
inline LightView window(const LightView& whole, double x0, double x1, double y0, double y1) {
  LightView v = whole;
  const double x = 0.5 * (x0 + x1), y = 0.5 * (y0 + y1), z = dot(whole.origin, whole.forward);
  v.origin = whole.right * x + whole.down * y + whole.forward * z;
  v.half_width = 0.5 * (x1 - x0), v.half_height = 0.5 * (y1 - y0);
  return v;
}

}  // namespace detail

/// `whole` is the view of all that casts shadows. `visible` are points that will be shaded: they tell the
/// distances, and if wanted the sides. Throws InvalidScene for a perspective view, a camera without
/// direction, and if no visible point is in front of it.
inline CascadeViews fit_cascades(const LightView& whole, const Camera& camera, std::span<const Vec3d> visible,
                                 const CascadeOptions& options = {}) {
  if (whole.perspective) throw InvalidScene("cascades take parallel light; this view is perspective");
  detail::check_knob("resolution", options.resolution, 16, 65536);
  detail::check_knob("margin", options.margin, 0, options.resolution / 4);
  CascadeViews r;
  r.eye = camera.position, r.axis = camera.target - camera.position;
  if (!(length(r.axis) > 0)) throw InvalidScene("the camera has no direction");
  r.axis = normalized(r.axis);
  double near = INFINITY, far = 0;
  for (const Vec3d& p : visible) {
    const double z = r.distance(p);
    if (z > 0) near = std::min(near, z), far = std::max(far, z);
  }
  constexpr double apart = 1e-6;  // relative: samples all at one distance still have a slice
  near = options.near > 0 ? options.near : near * (1 - apart);
  far = options.far > 0 ? options.far : far * (1 + apart);
  if (!(far > 0)) throw InvalidScene("no visible point is in front of the camera");
  r.splits = practical_splits(near, far, options.count, options.lambda);
  const double held = options.resolution - 2 * options.margin;  // texels for what the map must hold
  const double tangent = std::tan(0.5 * camera.height_angle);
  const double corner = tangent * tangent * (1 + std::pow(double(camera.width) / camera.height, 2));
  for (std::size_t i = 0; i + 1 < r.splits.size(); ++i) {
    const double a = r.splits[i], b = r.splits[i + 1];
    double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
    if (options.fitted) {
      for (const Vec3d& p : visible) {
        const double z = r.distance(p);
        if (!(z >= a && z <= b)) continue;
        const double x = dot(p, whole.right), y = dot(p, whole.down);
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
      }
      if (x0 > x1) {  // nothing to see here: the eye's own place will do
        x0 = x1 = dot(r.eye, whole.right), y0 = y1 = dot(r.eye, whole.down);
      }
      const double least = 1e-6 * b, sx = std::max(x1 - x0, least), sy = std::max(y1 - y0, least);
      const double px = 0.5 * (sx * options.resolution / held - (x1 - x0)),
                   py = 0.5 * (sy * options.resolution / held - (y1 - y0));
      x0 -= px, x1 += px, y0 -= py, y1 += py;
    } else {
      // The smallest sphere around the eight corners, which lie on the axis' distances a and b.
      const double middle = std::min(b, 0.5 * (a + b) * (1 + corner));
      const double radius = std::sqrt(std::pow(b - middle, 2) + b * b * corner);
      // One texel more: snapping moves the map by up to one.
      const double texel = 2 * radius / (held - 1), half = 0.5 * texel * options.resolution;
      const Vec3d centre = r.eye + r.axis * middle;
      x0 = dot(centre, whole.right) - half, y0 = dot(centre, whole.down) - half;
      if (options.snapped) x0 = std::floor(x0 / texel) * texel, y0 = std::floor(y0 / texel) * texel;
      x1 = x0 + 2 * half, y1 = y0 + 2 * half;
    }
    r.views.push_back(detail::window(whole, x0, x1, y0, y1));
  }
  return r;
}

/// Any method of its own for each slice.
template <ShadowMethod Method>
class Cascades {
 public:
  /// map_of(view) makes the map of a slice, of options.resolution squared texels; method_of(map) the method.
  template <class MapOf, class MethodOf>
  Cascades(CascadeViews views, MapOf&& map_of, MethodOf&& method_of) : views_(std::move(views)) {
    for (const LightView& view : views_.views) {
      maps_.push_back(std::make_unique<DepthMap>(map_of(view)));
      methods_.push_back(method_of(std::as_const(*maps_.back())));
    }
    if (methods_.empty()) throw InvalidScene("there are no cascades");
  }

  float visibility(const Receiver& receiver) const {
    return methods_[views_.slice(receiver.position)].visibility(receiver);
  }
  std::size_t bytes() const {
    std::size_t n = 0;
    for (const Method& method : methods_) n += method.bytes();
    return n;
  }
  const CascadeViews& views() const { return views_; }
  const DepthMap& map(std::size_t i) const { return *maps_[i]; }

 private:
  CascadeViews views_;
  std::vector<std::unique_ptr<DepthMap>> maps_;  // methods refer to them
  std::vector<Method> methods_;
};

}  // namespace treeline::shading::shadow
