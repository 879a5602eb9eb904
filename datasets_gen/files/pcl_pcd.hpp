// The border to PCL: plain arrays only. PCL's side is built without -m flags, because PCL and Eigen types of
// different alignment must not meet (a cloud filled on one side and freed on the other crashes).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace treeline::datasets::files {

/// Appends x, y, z of every point of a PCD file, given as its header and what follows. Returns what went
/// wrong, or nothing.
std::string pcl_read_pcd(const std::string& header, std::string_view body, std::vector<double>& xyz);

}  // namespace treeline::datasets::files
