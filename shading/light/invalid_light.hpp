// What is thrown where a light cannot be one.
#pragma once

#include <stdexcept>

namespace treeline::shading::light {

/// Says which light, or which of a scene's faces, and what is wrong with it.
struct InvalidLight : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

}  // namespace treeline::shading::light
