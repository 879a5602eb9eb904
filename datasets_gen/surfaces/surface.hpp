// Surfaces: one material each, whose reflection is to be integrated.
//
// A surface may have knobs, numbers after its name: "ggx_0.1" is GGX of roughness 0.1; treeline_gen --list
// shows them.
#pragma once

#include <span>
#include <string_view>

#include "datasets_gen/knobs.hpp"
#include "shading/material.hpp"

namespace treeline::datasets {

std::span<const KnobRecipe> surface_recipes();

/// True if make_surface takes the name, knobs included, or refuses it for its knobs alone.
bool is_surface(std::string_view name);

/// Throws std::invalid_argument for an unknown name (listing those known) and for a knob that is no number or
/// out of its range.
shading::Material make_surface(std::string_view name);

}  // namespace treeline::datasets
