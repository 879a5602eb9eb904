// A picture of how dense a cloud is: what decides which tree suits it.
//
// The density at a position is k over the volume of the ball that reaches its k-th nearest point
// (Loftsgaarden and Quesenberry 1965); it is finite everywhere and follows the cloud over any range. Cost:
// one k-nearest query a square. Known weakness: off a surface it falls with the cube of the distance, where
// there are no points at all.
#pragma once

#include <span>
#include <string>

#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

struct DensityPicture {
  std::string svg;
  double least = 0, most = 0;  // points per unit volume, at the lightest and the darkest shade
};

/// Of a plane normal to `axis`; the picture's axes are the other two, ascending. Logarithmic shades, light to
/// dark. The svg is empty if all points coincide.
DensityPicture density_picture(std::span<const Vec3f> points, const Box3f& box, int axis, double offset);

}  // namespace treeline::bench::knn
