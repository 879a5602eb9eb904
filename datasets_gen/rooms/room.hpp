// Rooms: scenes that light is carried through, with materials, faces that emit, and a camera. The small ones
// have an answer in closed form or by quadrature; the large ones are what it is used for. Metres; y is up.
//
// A room may have knobs, numbers after its name; treeline_gen --list shows them.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "datasets_gen/knobs.hpp"
#include "shading/scene.hpp"

namespace treeline::datasets {

std::span<const KnobRecipe> room_recipes();

/// True if make_room takes the name, knobs included, or refuses it for its knobs alone.
bool is_room(std::string_view name);

/// A room of about n triangles (12 ≤ n ≤ 1e7), split ever finer if its shape takes fewer. The same name, n
/// and seed give the same bits on every machine and with any number of threads. Throws std::invalid_argument
/// for an unknown name (listing those known), a knob that is no number or out of its range, or n out of
/// range.
shading::LitScene make_room(std::string_view name, std::size_t n, std::uint64_t seed,
                            const Progress& progress = {});

/// Any mesh, as scene_of_mesh() stages it, under a lamp and an even sky: the mesh and the floor are diffuse,
/// and so is all of it seen from either side. Throws as scene_of_mesh() does.
shading::LitScene room_of_mesh(geometry::Mesh3f mesh, std::string name);

}  // namespace treeline::datasets
