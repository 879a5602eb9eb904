// Hard cases for reflection: as hard_case.hpp, with a material and the angles that it is seen at.
#pragma once

#include "datasets_gen/hard/hard_case.hpp"
#include "shading/material.hpp"

namespace treeline::datasets {

struct HardSurface {
  std::string name;  // unique, over all other hard cases too
  std::string source, law;
  Expect expect = Expect::answers;
  shading::Material material;
  std::vector<double> cosines;  // of the viewers' angles to the normal
};

/// Deterministic.
std::vector<HardSurface> hard_surfaces();

}  // namespace treeline::datasets
