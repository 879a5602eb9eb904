#include "bench/light_transport/known.hpp"

#include <cmath>
#include <numbers>

#include "datasets_gen/knobs.hpp"
#include "datasets_gen/rooms/room.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Rayf;
using geometry::Vec3f;

constexpr float before_wall = 1e-2f;  // metres: where rays at walls begin

bool lit(const LitScene& room) {
  const auto bright = [](const Rgb& c) { return c[0] > 0 || c[1] > 0 || c[2] > 0; };
  for (const std::uint32_t m : room.face_materials)
    if (bright(room.materials[m].emission)) return true;
  return bright(room.background);
}

bool is_room_of(const std::string& name, std::string_view recipe) {
  return name == recipe || name.starts_with(std::string(recipe) + '_');
}
std::vector<double> knobs_of(const std::string& name, std::string_view recipe) {
  for (const datasets::KnobRecipe& r : datasets::room_recipes())
    if (r.name == recipe) return datasets::read_knobs("room", name, r);
  throw std::invalid_argument("no room is called '" + std::string(recipe) + "'");
}

/// The room near_contact: a ray goes up to the lamp or down to the floor.
RadianceForm near_contact(const LitScene& room, double h) {
  const double albedo = static_cast<double>(room.materials[0].reflectance[0]);
  return [=](const Rayf& ray) {
    const double up = static_cast<double>(ray.direction[1]), y = static_cast<double>(ray.origin[1]);
    const double t = up > 0 ? (h - y) / up : -y / up;
    const double x = double(ray.origin[0]) + t * double(ray.direction[0]),
                 z = double(ray.origin[2]) + t * double(ray.direction[2]);
    if (up > 0) return Rgb::filled(std::max(std::abs(x), std::abs(z)) <= 0.5 ? 1 : 0);
    if (!(std::max(std::abs(x), std::abs(z)) <= 1)) return Rgb{};
    return Rgb::filled(
        static_cast<float>(albedo * rectangle_form_factor(-0.5 - x, 0.5 - x, -0.5 - z, 0.5 - z, h)));
  };
}

}  // namespace

double rectangle_form_factor(double x0, double x1, double y0, double y1, double h) {
  // Of a corner straight above the point; the rectangle is four of them, with signs.
  const auto corner = [h](double x, double y) {
    const double a = x / h, b = y / h, ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * std::numbers::pi);
  };
  return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

RadianceForm radiance_form(const std::string& name, const LitScene& room) {
  if (is_room_of(name, "furnace_room") || is_room_of(name, "furnace_spheres"))
    return [](const Rayf&) { return Rgb::filled(1); };
  if (is_room_of(name, "near_contact")) return near_contact(room, knobs_of(name, "near_contact")[0]);
  if (!lit(room)) return [](const Rayf&) { return Rgb{}; };
  return {};
}

std::optional<BoxOfWalls> box_of_walls(const std::string& name, const LitScene& room) {
  if (!is_room_of(name, "closed_box")) return std::nullopt;
  const auto knobs = knobs_of(name, "closed_box");
  const auto number = [](float x) { return static_cast<double>(x); };
  const auto& lamp = room.materials[static_cast<std::size_t>(BoxWall::lamp)];
  return BoxOfWalls{number(room.materials[0].reflectance[0]), knobs[1], number(lamp.emission[0])};
}

RaySource rays_at_walls(double lamp_side) {
  const auto lamp = static_cast<float>(0.5 * lamp_side);
  return [lamp](std::size_t pixel, float u, float v) -> Rayf {
    const float a = 2 * u - 1, b = 2 * v - 1;
    const auto towards = [](const Vec3f& point, const Vec3f& normal) {
      return Rayf{point + normal * before_wall, -normal};
    };
    switch (static_cast<BoxWall>(pixel % box_walls)) {
      case BoxWall::floor:
        return towards({a, 0, b}, {0, 1, 0});
      case BoxWall::left:
        return towards({-1, 1 + a, b}, {1, 0, 0});
      case BoxWall::right:
        return towards({1, 1 + a, b}, {-1, 0, 0});
      case BoxWall::back:
        return towards({a, 1 + b, -1}, {0, 0, 1});
      case BoxWall::front:
        return towards({a, 1 + b, 1}, {0, 0, -1});
      case BoxWall::lamp:
        return towards({lamp * a, 2, lamp * b}, {0, -1, 0});
      case BoxWall::ceiling:
        break;
    }
    // The frame about the lamp: four strips of equal shape, each turned by a quarter.
    const float scaled = 4 * u, quarter = std::floor(scaled), rest = scaled - quarter;
    const float x = -1 + (1 + lamp) * rest, z = lamp + (1 - lamp) * v;  // from the corner to the lamp's end
    const Vec3f turned[] = {{x, 2, z}, {z, 2, -x}, {-x, 2, -z}, {-z, 2, x}};
    return towards(turned[std::min(3, static_cast<int>(quarter))], {0, -1, 0});
  };
}

}  // namespace treeline::bench::light_transport
