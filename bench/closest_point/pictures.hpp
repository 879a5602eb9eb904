// Pictures of one block: a slice through the middle of the mesh, a query a pixel.
#pragma once

#include <string>
#include <vector>

#include "bench/closest_point/method.hpp"

namespace treeline::bench::closest_point {

/// Writes what each tree visits for every pixel, side by side, and for each method where its answers are off
/// by more than 1e-6 of the diagonal, if anywhere; and the index of them. Nothing in builds without
/// OpenImageIO. Throws std::logic_error if the truth of the picture disagrees with brute force.
void draw_pictures(const std::vector<Method>& methods, const std::string& dataset,
                   const geometry::Mesh3f& mesh, int threads, const std::string& folder);

}  // namespace treeline::bench::closest_point
