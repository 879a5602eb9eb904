// The perfect mirror: all light of one direction goes into one direction. f is a delta; only sampling meets
// it.
#pragma once

#include "shading/brdf/directions.hpp"

namespace treeline::shading::brdf {

/// The direction from which light comes that leaves towards wo.
template <std::floating_point T>
Direction<T> mirrored(const Direction<T>& wo) {
  return {-wo[0], -wo[1], wo[2]};
}

}  // namespace treeline::shading::brdf
