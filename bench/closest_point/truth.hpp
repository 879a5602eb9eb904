// The truth of a closest-point query: every triangle tried, and the nearest found without an error.
//
// Method: brute force. The distance to a triangle's box, in double, throws out the triangles that are surely
// farther than one already measured; brackets of the distance in double leave a few, and those are measured
// exactly (geometry/exact/triangle_distance.hpp). A thin sample of all triangles is measured first, so that
// the boxes throw out nearly all, most of them by the box of a run of triangles, where those of like numbers
// are neighbours. Cost: at most about a nanosecond a triangle and query, and a microsecond for each that is
// left.
//
// Conventions, the same for every judge and oracle of this task:
//   - triangles are closed sets; one of no area is the segment or point that it covers;
//   - a triangle with a coordinate that is not finite is left out; a query that is not finite has no answer.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/mesh.hpp"

namespace treeline::bench::closest_point {

struct TrueClosest {
  double distance2 = std::numeric_limits<double>::infinity();  // the exact one, rounded once
  accel::Id primitive = accel::no_id;                          // ties: the lowest id

  explicit operator bool() const { return primitive != accel::no_id; }
  bool operator==(const TrueClosest&) const = default;
};

/// threads = 1 starts no thread pool.
std::vector<TrueClosest> true_closest(const geometry::Mesh3f& mesh, std::span<const geometry::Vec3f> queries,
                                      int threads);

}  // namespace treeline::bench::closest_point
