// A shadow map as data: what the light sees first in each texel, and if asked for, what it sees next.
#pragma once

#include <cstddef>
#include <vector>

#include "shading/shadow/light_view.hpp"

namespace treeline::shading::shadow {

/// Row after row from the top; a texel is what the light sees through its centre. 1 where it sees nothing.
struct DepthMap {
  LightView view;
  int width = 0, height = 0;
  std::vector<float> first;   ///< as LightView::Place::depth
  std::vector<float> second;  ///< the next surface behind the first; empty: not kept

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  std::size_t bytes() const { return (first.size() + second.size()) * sizeof(float); }
};

/// What is shaded: a point of the scene with the unit normal of its surface, on the side that is seen.
struct Receiver {
  Vec3d position, normal;
};

}  // namespace treeline::shading::shadow
