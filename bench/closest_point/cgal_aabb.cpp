// CGAL's AABB tree over plain doubles. Claim: approximate; signs that decide where on a triangle the nearest
// point is are rounded, and of slivers they can be wrong.
#include <CGAL/Simple_cartesian.h>

#include "bench/closest_point/cgal_aabb.hpp"

namespace treeline::bench::closest_point {
namespace {
const bool registered =
    register_cgal_aabb<CGAL::Simple_cartesian<double>>("cgal_aabb", Claim::approximate, SIZE_MAX);
}
}  // namespace treeline::bench::closest_point
