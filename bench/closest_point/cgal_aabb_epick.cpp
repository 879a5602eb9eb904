// CGAL's AABB tree over doubles with exact predicates and rounded constructions. Claim: approximate; which of
// two distances is the smaller is decided exactly, but between points that were rounded.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "bench/closest_point/cgal_aabb.hpp"

namespace treeline::bench::closest_point {
namespace {
const bool registered = register_cgal_aabb<CGAL::Exact_predicates_inexact_constructions_kernel>(
    "cgal_aabb_epick", Claim::approximate, 50'000);
}
}  // namespace treeline::bench::closest_point
