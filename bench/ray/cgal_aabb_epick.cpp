// CGAL's AABB tree over doubles with exact predicates and rounded constructions. Claim: bounded. Whether a
// ray meets a triangle is decided exactly; where, is computed in double from the plane, and for a triangle
// that is almost edge-on that is not the last digit. Which of two hits is nearer is decided by the rounded
// points.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "bench/ray/cgal_aabb.hpp"

namespace treeline::bench::ray {
namespace {
const bool registered = register_cgal_aabb<CGAL::Exact_predicates_inexact_constructions_kernel>(
    "cgal_aabb_epick", Claim::bounded);
}
}  // namespace treeline::bench::ray
