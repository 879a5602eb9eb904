// Stands in for oracle.cpp in builds without CGAL.
#ifdef TREELINE_WITHOUT_ORACLE
#include "bench/closest_point/oracle.hpp"

namespace treeline::bench::closest_point {

std::optional<std::vector<TrueClosest>> oracle_closest(const geometry::Mesh3f&,
                                                       std::span<const geometry::Vec3f>) {
  return std::nullopt;
}

}  // namespace treeline::bench::closest_point
#endif
