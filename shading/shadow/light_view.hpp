// How a light sees a scene: the frame of its shadow maps. Depth is linear along the light's axis, 0 at the
// near plane and 1 at the far one, for parallel and for perspective views alike.
//
// An area light is seen from its middle. Known weakness: one view cannot hold what lies all around a point
// light, nor beside it; such a light is refused.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/box.hpp"
#include "shading/scene.hpp"

namespace treeline::shading {

/// A light, scene or knob that a technique cannot take; says which and why.
struct InvalidScene : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace shadow {

using geometry::Vec3d;

struct LightView {
  /// Where in the map, as shares of its sides from the top left, and how deep. Outside [0, 1] the map has
  /// nothing to say.
  struct Place {
    double x, y, depth;
  };

  Vec3d origin{}, right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};  ///< orthonormal but for the origin
  bool perspective = false;
  double half_width = 1, half_height = 1;  ///< world units; perspective: at distance 1
  double near = 0, far = 1;                ///< world units along forward

  Place place(const Vec3d& p) const {
    const Vec3d d = p - origin;
    const double z = dot(d, forward), scale = perspective ? z : 1;
    return {0.5 + 0.5 * dot(d, right) / (half_width * scale),
            0.5 + 0.5 * dot(d, down) / (half_height * scale), (z - near) / (far - near)};
  }
  /// The inverse of place().
  Vec3d at(const Place& q) const {
    const double z = near + q.depth * (far - near), scale = perspective ? z : 1;
    return origin + right * ((2 * q.x - 1) * half_width * scale) +
           down * ((2 * q.y - 1) * half_height * scale) + forward * z;
  }
  /// Sides of a texel in world units, at a depth along forward.
  double texel_width(int columns, double z) const { return 2 * half_width * (perspective ? z : 1) / columns; }
  double texel_height(int rows, double z) const { return 2 * half_height * (perspective ? z : 1) / rows; }
};

/// The view that holds the box, with `margin` of its extent around it. Throws InvalidScene for an empty box,
/// for a light without direction, and for one in the box or so near that the view would be wider than 160
/// degrees.
inline LightView fit_view(const Light& light, const geometry::Box3d& box, double margin = 0.01) {
  if (box.empty()) throw InvalidScene("there is nothing that casts or receives shadows");
  Vec3d forward = light.direction;
  if (light.kind == LightKind::point) forward = box.centre() - light.position;
  if (!(length(forward) > 0) || !is_finite(forward)) throw InvalidScene("the light has no direction");
  forward = normalized(forward);
  const Vec3d helper = std::abs(forward[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  LightView view;
  view.forward = forward;
  view.right = normalized(cross(forward, helper)), view.down = cross(forward, view.right);
  view.perspective = light.kind != LightKind::directional;
  view.origin = view.perspective ? light.position : box.centre();
  double x = 0, y = 0, z0 = INFINITY, z1 = -INFINITY;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? box.high[k] : box.low[k];
    const Vec3d d = p - view.origin;
    const double z = dot(d, forward);
    z0 = std::min(z0, z), z1 = std::max(z1, z);
    if (view.perspective && !(z > 0))
      throw InvalidScene("the light lies in or beside the scene: one view cannot hold what it lights");
    const double scale = view.perspective ? z : 1;
    x = std::max(x, std::abs(dot(d, view.right)) / scale),
    y = std::max(y, std::abs(dot(d, view.down)) / scale);
  }
  const double pad =
      std::max({z1 - z0, view.perspective ? 0.0 : std::max(x, y), 1e-6 * length(box.extent())}) * margin;
  view.near = view.perspective ? std::max(z0 - pad, 0.5 * z0) : z0 - pad, view.far = z1 + pad;
  // So that neither is 0; from far away all of the scene may be that narrow.
  const double least = 1e-9 * (view.perspective ? std::max(length(box.extent()), 1e-9) / z1 : 1);
  view.half_width = std::max(x, least) * (1 + margin), view.half_height = std::max(y, least) * (1 + margin);
  if (light.kind == LightKind::spot)
    view.half_width = std::min(view.half_width, std::tan(light.angle)),
    view.half_height = std::min(view.half_height, std::tan(light.angle));
  if (view.perspective && std::max(view.half_width, view.half_height) > 5.7)
    throw InvalidScene("the light is so near that its view would be wider than 160 degrees");
  return view;
}

}  // namespace shadow
}  // namespace treeline::shading
