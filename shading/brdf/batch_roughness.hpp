// Roughness along the two tangents as the kernels of batches need it.
#pragma once

#include <numbers>

#include "shading/brdf/batch.hpp"

namespace treeline::shading::brdf::batch {

struct Roughness {
  float x, y, inverse_x, inverse_y;
  float peak;  ///< 1/(π αx αy), the distribution at the normal

  Roughness(double alpha_x, double alpha_y)
      : x(static_cast<float>(alpha_x)),
        y(static_cast<float>(alpha_y)),
        inverse_x(static_cast<float>(1 / alpha_x)),
        inverse_y(static_cast<float>(1 / alpha_y)),
        peak(static_cast<float>(1 / (std::numbers::pi * alpha_x * alpha_y))) {}
};

}  // namespace treeline::shading::brdf::batch
