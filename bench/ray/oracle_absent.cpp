// Stands in for oracle.cpp in builds without CGAL.
#ifdef TREELINE_WITHOUT_ORACLE
#include "bench/ray/oracle.hpp"

namespace treeline::bench::ray {

std::optional<std::vector<TrueHit>> oracle_closest(const geometry::Mesh3f&, std::span<const geometry::Rayf>) {
  return std::nullopt;
}

}  // namespace treeline::bench::ray
#endif
