// Points as PCL takes them. Only for PCL's own files, which are compiled without -m flags: PCL's clouds rest
// on Eigen's aligned allocation, which differs between instruction sets, so nothing of PCL's or Eigen's
// crosses the border; method.hpp passes plain arrays of floats.
#pragma once

#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

inline pcl::PointXYZ pcl_point(const Vec3f& p) { return {p[0], p[1], p[2]}; }

/// is_dense is set truly: PCL leaves out points that are not finite if it is false, and believes it if true.
inline pcl::PointCloud<pcl::PointXYZ>::Ptr pcl_cloud(const Input& input) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(input.points.size());
  for (const Vec3f& p : input.points) cloud->push_back(pcl_point(p));
  cloud->is_dense = input.finite;
  return cloud;
}

}  // namespace treeline::bench::knn
