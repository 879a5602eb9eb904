// The border to PCL: plain arrays only. PCL's side is built without -m flags, because PCL and Eigen types of
// different alignment must not meet (a cloud filled on one side and freed on the other crashes).
#pragma once

#include <string>
#include <vector>

namespace treeline::datasets::files {

/// Appends x, y, z of every point of a PCD file. Returns what went wrong, or nothing.
std::string pcl_read_pcd(const std::string& path, std::vector<double>& xyz);

}  // namespace treeline::datasets::files
