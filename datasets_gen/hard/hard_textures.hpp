// Hard cases for means of regions of textures: as hard_case.hpp, with an image; the regions are the task's.
#pragma once

#include <functional>

#include "datasets_gen/hard/hard_case.hpp"
#include "shading/image.hpp"

namespace treeline::datasets {

struct HardTexture {
  std::string name;  // unique, over all other hard cases too
  std::string source, law;
  Expect expect = Expect::answers;
  bool moments = false;                  // channels are z and z²: variances are asked for, too
  bool independent = false;              // each texel of all others, of a positive mean
  std::function<shading::Image()> make;  // each time the same; they are large
};

/// Deterministic.
std::vector<HardTexture> hard_textures();

}  // namespace treeline::datasets
