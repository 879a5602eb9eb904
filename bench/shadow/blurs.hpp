// Knobs of maps that are blurred when they are made: resolution, and the box's radius in texels.
#pragma once

#include "bench/shadow/maps.hpp"
#include "shading/shadow/moment_map.hpp"

namespace treeline::bench::shadow {

/// The most telling first.
inline std::vector<Knobs> blurs() {
  std::vector<Knobs> r;
  for (const auto& [resolution, radius] :
       {std::pair{1024, 2}, {512, 4}, {1024, 8}, {256, 1}, {512, 1}, {1024, 0}, {2048, 4}, {2048, 16}})
    r.push_back({{"resolution", resolution}, {"radius", radius}});
  return r;
}
inline shading::shadow::MomentMapOptions blur_of(const Input& input, const Knobs& knobs) {
  return {.radius = knobs.at("radius").get<int>(), .threads = input.threads};
}

}  // namespace treeline::bench::shadow
