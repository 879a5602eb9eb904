// Point clouds: a plain array of points.
#pragma once

#include <span>
#include <vector>

#include "geometry/box.hpp"

namespace treeline::geometry {

template <class T, int D>
struct Cloud {
  std::vector<Vec<T, D>> points;

  std::size_t size() const { return points.size(); }
  Box<T, D> box() const {
    Box<T, D> b;
    for (const auto& p : points) b.grow(p);
    return b;
  }
};

using Cloud3f = Cloud<float, 3>;
using Cloud3d = Cloud<double, 3>;

}  // namespace treeline::geometry
