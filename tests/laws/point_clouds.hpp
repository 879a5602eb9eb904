// Random clouds for laws, most of them degenerate in one way or another.
#pragma once

#include <rapidcheck.h>

#include <cmath>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/random.hpp"

namespace treeline::test {

using namespace treeline::geometry;

template <class T, int D>
struct CloudMaker {
  using Point = Vec<T, D>;
  enum Kind { even, grid, coincident, few_distinct, line, plane, far_away, mixed_scale, kinds };

  Pcg32 random;
  Kind kind;

  Point point() {
    Point p;
    for (int i = 0; i < D; ++i) p[i] = random.uniform<T>(-1, 1);
    const T pick = static_cast<T>(random.below(5));
    switch (kind) {
      case grid:
        for (int i = 0; i < D; ++i) p[i] = static_cast<T>(random.below(6));
        break;
      case coincident:
        p = Point::filled(T(0.25));
        break;
      case few_distinct:
        p = Point::filled(pick);
        break;
      case line:
        p = Point::filled(T(1)) * random.uniform<T>(-1, 1);
        break;
      case plane:
        p[0] = T(0.5);
        break;
      case far_away:
        p = p + Point::filled(T(1e5));
        break;
      case mixed_scale:
        p = p * std::pow(T(10), -T(random.below(12)));
        break;
      default:
        break;
    }
    return p;
  }
  std::vector<Point> points(std::size_t n) {
    std::vector<Point> r(n);
    for (auto& p : r) p = point();
    return r;
  }
  /// Near the cloud, at its points, far off.
  Point query(const std::vector<Point>& cloud) {
    if (!cloud.empty() && random.below(3) == 0)
      return cloud[random.below(static_cast<std::uint32_t>(cloud.size()))];
    const Point p = point();
    return random.below(4) ? p : p * T(50) + Point::filled(T(7));
  }
};

template <class T, int D>
CloudMaker<T, D> any_cloud() {
  using Maker = CloudMaker<T, D>;
  const auto kind = static_cast<typename Maker::Kind>(*rc::gen::inRange(0, int(Maker::kinds)));
  return {Pcg32(*rc::gen::arbitrary<std::uint64_t>()), kind};
}

}  // namespace treeline::test
