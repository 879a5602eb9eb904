// The second witness: every triangle measured in CGAL's exact kernel, in which nothing rounds. For small
// sets. Same conventions as truth.hpp. Nothing in builds without CGAL.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bench/closest_point/truth.hpp"

namespace treeline::bench::closest_point {

std::optional<std::vector<TrueClosest>> oracle_closest(const geometry::Mesh3f& mesh,
                                                       std::span<const geometry::Vec3f> queries);

}  // namespace treeline::bench::closest_point
