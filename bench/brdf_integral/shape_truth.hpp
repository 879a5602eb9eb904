// Solid angles by two quadratures in double: over the shape's area, of cosine over the square of the
// distance, and around its border, of one less the cosine to its middle. They agree to 1e-9 or so.
#pragma once

#include "bench/brdf_integral/method.hpp"

namespace treeline::bench::brdf_integral {

struct SolidAngle {
  double value = 0, apart = 0;  ///< steradians; by how much the quadratures differ
};
/// Seen from the origin, which is outside of the shape or inside of a box.
SolidAngle solid_angle_truth(const Shape&);

/// Area that faces the viewer, and the same less what its tilt takes, both per distance to its middle
/// squared: what textbooks offer.
double area_over_r2(const Shape&, bool tilted);

}  // namespace treeline::bench::brdf_integral
