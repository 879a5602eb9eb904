// Coordinates that are floats but whose squares are not: above 1.8e19 they are infinite, below 1e-23 zero,
// and from 1e-19 down they lose digits. Infinite distances all tie, and so do vanished ones.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> float_range() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source) -> HardCase& {
    HardCase c;
    c.family = "float_range", c.name = std::move(name), c.source = std::move(source);
    c.law = "the k distances equal those of brute force in double, which has room for these squares";
    return all.emplace_back(std::move(c));
  };
  {
    HardCase& c = add("squares_overflow",
                      "measured: at coordinates to 3e38 nanoflann misses 88 %, FLANN crashes, PCL aborts or "
                      "finds nothing, CGAL is wrong");
    c.cloud.points = random_points(111, 4000, {-3e38, -3e38, -3e38}, {3e38, 3e38, 3e38});
    c.queries = random_points(112, 200, {-2e38, -2e38, -2e38}, {2e38, 2e38, 2e38});
    c.radius = 1e38f;
  }
  {
    HardCase& c =
        add("squares_underflow",
            "measured: at coordinates to 1e-22 nanoflann and CGAL are wrong in 53 %, FLANN in 55 %, "
            "PCL in 62 %, and its octree aborts");
    c.cloud.points = random_points(113, 4000, {0, 0, 0}, {1e-22, 1e-22, 1e-22});
    c.queries = random_points(114, 200, {0, 0, 0}, {1e-22, 1e-22, 1e-22});
    c.radius = 1e-23f;
  }
  {
    HardCase& c =
        add("squares_lose_digits", "derivation: at 1e-20 squares are denormal floats of 20 bits and fewer");
    c.cloud.points = random_points(115, 4000, {0, 0, 0}, {1e-20, 1e-20, 1e-20});
    c.queries = random_points(116, 200, {0, 0, 0}, {1e-20, 1e-20, 1e-20});
    c.radius = 1e-21f;
  }
  {
    HardCase& c = add("tiny_pile_in_a_large_cloud",
                      "derivation: no one scale keeps the squares of 1e-21 and of 1 among the floats");
    c.cloud.points = random_points(117, 1000, {0, 0, 0}, {1e-21, 1e-21, 1e-21});
    for (const Vec3f& p : random_points(118, 1000, {1, 1, 1}, {2, 2, 2})) c.cloud.points.push_back(p);
    c.queries = random_points(119, 100, {0, 0, 0}, {1e-21, 1e-21, 1e-21});
    for (const Vec3f& q : random_points(120, 100, {1, 1, 1}, {2, 2, 2})) c.queries.push_back(q);
  }
  return all;
}

}  // namespace treeline::datasets::hard
