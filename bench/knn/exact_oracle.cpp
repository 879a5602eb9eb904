#include "bench/knn/exact_oracle.hpp"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <numeric>

namespace treeline::bench::knn {
namespace {

using Kernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Number = Kernel::FT;
using accel::Id;
using geometry::Vec3f;

Kernel::Point_3 point(const Vec3f& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

std::vector<Number> distances2(std::span<const Vec3f> points, const Vec3f& query) {
  const auto q = point(query);
  std::vector<Number> r;
  r.reserve(points.size());
  for (const Vec3f& p : points) r.push_back(CGAL::squared_distance(q, point(p)));
  return r;
}

}  // namespace

std::vector<Id> exact_nearest(std::span<const Vec3f> points, const Vec3f& query, std::size_t k) {
  const std::vector<Number> d2 = distances2(points, query);
  std::vector<Id> ids(points.size());
  std::iota(ids.begin(), ids.end(), Id{0});
  std::stable_sort(ids.begin(), ids.end(), [&](Id a, Id b) { return d2[a] < d2[b]; });
  ids.resize(std::min(k, ids.size()));
  return ids;
}

std::vector<Id> exact_within(std::span<const Vec3f> points, const Vec3f& query, float radius) {
  const std::vector<Number> d2 = distances2(points, query);
  const Number r = double(radius);
  const Number r2 = r * r;
  std::vector<Id> ids;
  for (std::size_t i = 0; i < d2.size(); ++i)
    if (d2[i] <= r2) ids.push_back(static_cast<Id>(i));
  return ids;
}

int exact_compare(const Vec3f& query, const Vec3f& a, const Vec3f& b) {
  const auto q = point(query);
  return static_cast<int>(
      CGAL::compare(CGAL::squared_distance(q, point(a)), CGAL::squared_distance(q, point(b))));
}

}  // namespace treeline::bench::knn
