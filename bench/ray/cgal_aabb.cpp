// CGAL's AABB tree over plain doubles. Claim: approximate. Distances are right to double, but its signs are
// rounded: about one in two hundred rays aimed at a shared edge or vertex slips through.
#include <CGAL/Simple_cartesian.h>

#include "bench/ray/cgal_aabb.hpp"

namespace treeline::bench::ray {
namespace {
const bool registered = register_cgal_aabb<CGAL::Simple_cartesian<double>>("cgal_aabb", Claim::approximate);
}
}  // namespace treeline::bench::ray
