// A second witness of the truth: exact rational arithmetic, by CGAL's number types. For small sets only:
// about a microsecond a distance. Points must be finite.
#pragma once

#include <span>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/box.hpp"

namespace treeline::bench::knn {

/// Ids of the min(k, points) nearest, ties by lower id, decided exactly.
std::vector<accel::Id> exact_nearest(std::span<const geometry::Vec3f> points, const geometry::Vec3f& query,
                                     std::size_t k);
/// Ids of the points at a distance ≤ radius, ascending.
std::vector<accel::Id> exact_within(std::span<const geometry::Vec3f> points, const geometry::Vec3f& query,
                                    float radius);
/// -1, 0 or 1 as a is nearer than, as near as, or farther than b.
int exact_compare(const geometry::Vec3f& query, const geometry::Vec3f& a, const geometry::Vec3f& b);

}  // namespace treeline::bench::knn
