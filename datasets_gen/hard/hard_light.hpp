// Hard cases for the transport of light: as hard_case.hpp, with a room; what is seen is the task's.
#pragma once

#include <functional>

#include "datasets_gen/hard/hard_case.hpp"
#include "shading/scene.hpp"

namespace treeline::datasets {

struct HardLight {
  std::string name;  // unique, over all other hard cases too
  std::string source, law;
  std::function<shading::LitScene()> make;  // each time the same
  Expect expect = Expect::answers;
  bool meaningless = false;              // no answer is right: to be refused
  std::optional<shading::Rgb> radiance;  // the same along every ray that the camera has
  bool by_name = false;                  // what is known of the recipe that the room is named after holds
  bool seldom = false;                   // lamps are met, or reached by aiming, too seldom for a test of bias
};

/// Deterministic.
std::vector<HardLight> hard_lights();

}  // namespace treeline::datasets
