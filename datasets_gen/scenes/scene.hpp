// Scenes for shadows: a mesh that casts and receives them, one light, one camera. The small ones are made so
// that what a technique gets wrong has a closed form; the large ones are what it is used for. Metres; y is
// up.
//
// A scene may have knobs, numbers after its name: "tilted_plane_85_30" is a plane tilted by 85 degrees about
// an axis turned by 30, "two_stacked" one of its default. treeline_gen --list shows them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets_gen/knobs.hpp"
#include "shading/scene.hpp"

namespace treeline::datasets {

std::span<const KnobRecipe> scene_recipes();

/// The names of scene_recipes(), in their order.
std::vector<std::string> scene_names();

/// True if make_scene takes the name, knobs included, or refuses it for its knobs alone.
bool is_scene(std::string_view name);

/// A scene of about n triangles (12 ≤ n ≤ 1e7), split ever finer if its shape takes fewer; small scenes have
/// some hundred at least. The same name, n and seed give the same bits on every machine and with any number
/// of threads. Throws std::invalid_argument for an unknown name (listing those known), a knob that is no
/// number or out of its range, or n out of range.
shading::Scene make_scene(std::string_view name, std::size_t n, std::uint64_t seed,
                          const Progress& progress = {});

struct Staging {
  geometry::Vec3d up{0, 1, 0};  ///< unit; the floor is perpendicular to it
  bool floor = true;
};

/// Any mesh, with a floor under its lowest point, three times as wide as it, a sun that stands 53 degrees
/// high and a camera that has it in view. Vertices that are not finite are kept, and left out of account.
/// Throws std::invalid_argument for a mesh without a face of finite corners, or with a face that names a
/// vertex that it does not have; and for an `up` that is not a unit vector.
shading::Scene scene_of_mesh(geometry::Mesh3f mesh, std::string name, const Staging& = {});

}  // namespace treeline::datasets
