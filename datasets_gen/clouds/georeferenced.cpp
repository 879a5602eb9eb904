// The street of lidar.cpp where it might lie: in metres of UTM zone 32, to the millimetre, as surveyors
// deliver it.
//
// Coordinates have seven digits before the point. Float leaves half a metre of the northing and three
// centimetres of the easting, more than the points are apart; doubles hold all of it.
#include <cmath>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Cloud3d georeferenced(const Job& job) {
  constexpr double millimetres = 1000, easting = 512'345, northing = 5'403'210, elevation = 345;
  const Vec3d origin{easting, northing, elevation};
  geometry::Cloud3d r;
  for (const geometry::Vec3f& p : lidar(job).points) {
    Vec3d q;
    for (int a = 0; a < 3; ++a) q[a] = origin[a] + std::round(double(p[a]) * millimetres) / millimetres;
    r.points.push_back(q);
  }
  return r;
}

}  // namespace treeline::datasets
