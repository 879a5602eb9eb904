// What is known of a texture by its recipe, and not by looking at it.
#pragma once

#include <string_view>

namespace treeline::datasets {

/// Whether the recipe draws every pixel by itself, regardless of all others and of where it lies, from values
/// that are not negative. False for what is no recipe of a texture: nothing is known of files.
bool pixels_are_independent(std::string_view recipe);

}  // namespace treeline::datasets
