// Pictures of our trees: the cells that a plane through the middle of the cloud cuts, over the points near
// it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

/// An SVG of cells (coloured by depth, light to dark) and of the points within half a percent of the plane.
/// The plane is normal to `axis`; the picture's axes are the other two, ascending.
std::string slice_svg(std::span<const Vec3f> points, const std::vector<accel::SliceCell>& cells,
                      const Box3f& box, int axis, double offset);

/// Writes a picture of the cloud's density and one for each method that has cells to show into a folder, and
/// appends them to its index, pictures.jsonl. The plane is normal to the box's shortest side. Throws
/// std::runtime_error naming the file that cannot be written.
void write_pictures(const std::vector<Method>&, std::span<const Vec3f> points, const std::string& dataset,
                    const std::string& folder);

}  // namespace treeline::bench::knn
