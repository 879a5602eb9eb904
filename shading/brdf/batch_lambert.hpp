// Diffuse reflection's samples and density on vector registers: as lambert.hpp, by the same map from the
// square to the disc (Shirley and Chiu 1997), whose angles need no reduction.
#pragma once

#include <numbers>

#include "shading/brdf/batch_directions.hpp"
#include "shading/brdf/batch_math.hpp"

namespace treeline::shading::brdf::batch {

/// Density cos / π per steradian; u, v in [0, 1).
[[gnu::always_inline]] inline Floats3 sample_lambert(Floats u, Floats v) {
  const Floats x = 2.0f * u - 1.0f, y = 2.0f * v - 1.0f;
  const Ints wide = largest(x, -x) > largest(y, -y);
  const Floats r = wide ? x : y, other = wide ? y : x;
  const SineCosine turn = sine_cosine_of_quarters(0.5f * other / (r == 0 ? floats(1) : r));
  return {r * (wide ? turn.cosine : turn.sine), r * (wide ? turn.sine : turn.cosine),
          root((1.0f - r) * (1.0f + r))};
}

[[gnu::always_inline]] inline Floats lambert_pdf(const Floats3& wi) {
  return std::numbers::inv_pi_v<float> * wi.z;
}

}  // namespace treeline::shading::brdf::batch
