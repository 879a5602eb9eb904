// Hard cases for inside and outside: a mesh that is whole, and points to tell. As hard_case.hpp.
#pragma once

#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::datasets {

struct HardInside {
  std::string name;  // unique, over all other hard cases too
  std::string source, law;
  Expect expect = Expect::answers;
  bool coincident = false;  // some faces lie in one another: what is nearest says nothing
  geometry::Mesh3f mesh;
  std::vector<geometry::Vec3f> points;
};

/// Deterministic.
std::vector<HardInside> hard_insides();

}  // namespace treeline::datasets
