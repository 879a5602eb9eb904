// What is known of a room's light without a ray: by a formula, or by radiosity.
//
// Furnaces: all surfaces emit 1 less their albedo, so that the radiance is 1 everywhere (conservation of
// energy). near_contact: the floor sees nothing but the lamp, whose form factor from a point of a parallel
// plane has a closed form (Lambert 1760; Howell's catalogue, B-4). closed_box: the walls' means, by radiosity
// (box_radiosity.hpp). A room without lamps and background: 0.
#pragma once

#include <optional>
#include <string>

#include "bench/light_transport/box_radiosity.hpp"
#include "bench/light_transport/method.hpp"

namespace treeline::bench::light_transport {

/// Radiance along a ray; empty where it is not known.
using RadianceForm = std::function<Rgb(const geometry::Rayf&)>;

/// By the name of the room's recipe and its numbers.
RadianceForm radiance_form(const std::string& name, const LitScene&);

/// The share of the light that reaches a point of a plane from a rectangle over it, parallel to the plane:
/// from x0 to x1 and y0 to y1 relative to the point, at height h > 0.
double rectangle_form_factor(double x0, double x1, double y0, double y1, double h);

/// Of closed_box: what its radiosity is to be solved for; nothing of other rooms.
struct BoxOfWalls {
  double albedo, lamp_side, emission;
};
std::optional<BoxOfWalls> box_of_walls(const std::string& name, const LitScene&);

/// Rays at even points of the walls of closed_box, each from just before its wall: pixel p is on the wall
/// p % box_walls.
RaySource rays_at_walls(double lamp_side);

}  // namespace treeline::bench::light_transport
