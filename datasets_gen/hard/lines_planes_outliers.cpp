// Clouds of lower dimension than space, of very uneven extent, or with one point far from all others: cells
// get long and thin, and a midpoint split can need one level per power of two.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> lines_planes_outliers() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source) -> HardCase& {
    HardCase c;
    c.family = "lines_planes_outliers", c.name = std::move(name), c.source = std::move(source);
    c.law = "the k distances equal those of brute force";
    return all.emplace_back(std::move(c));
  };
  const auto line = [](const Vec3d& direction) {
    std::vector<Vec3f> r;
    for (std::size_t i = 0; i < 4000; ++i) r.push_back(rounded(scaled(direction, Draws(21, i).uniform())));
    return r;
  };
  {
    HardCase& c =
        add("axis_line", "measured: pico_tree 4300 µs per query off an axis line, slower than brute force");
    c.cloud.points = line({1, 0, 0});
    c.queries = random_points(22, 200, {-1, -1, -1}, {2, 1, 1});
    c.radius = 0.5f;
  }
  {
    HardCase& c = add("diagonal_line", "measured: 200 to 1400 µs per query in every library tried");
    c.cloud.points = line({1, 1, 1});
    c.queries = random_points(23, 200, {-1, -1, -1}, {2, 2, 2});
  }
  {
    HardCase& c = add("plane", "derivation: one extent is zero, so a split along it parts nothing");
    c.cloud.points = random_points(24, 4000);
    for (Vec3f& p : c.cloud.points) p[2] = 0.125f;
    c.queries = random_points(25, 200);
    c.radius = 0.2f;
  }
  {
    HardCase& c = add("box_1e6_to_1", "measured: FLANN's forest is 83 % wrong on a box of 1e6 : 1 : 1");
    c.cloud.points = random_points(26, 4000, {0, 0, 0}, {1e6, 1, 1});
    c.queries = random_points(27, 200, {0, 0, 0}, {1e6, 1, 1});
    c.radius = 500;
  }
  {
    HardCase& c =
        add("outlier_1e30",
            "measured: one point at 1e30 makes PCL's octree find nothing and unibn's wrong in 78 %");
    c.cloud.points = random_points(28, 4000);
    c.cloud.points[1234] = {1e30f, -1e30f, 1e30f};
    c.queries = random_points(29, 200);
    c.radius = 0.1f;
  }
  {
    HardCase& c = add("halving_towards_a_corner",
                      "derivation: the i-th point lies at 2^-i, so every midpoint split takes one point off");
    for (int i = 0; i < 60; ++i) {
      const float x = std::ldexp(1.f, -i);
      for (int copy = 0; copy < 20; ++copy)
        c.cloud.points.push_back({x, x, x * static_cast<float>(copy + 1) / 32});
    }
    c.queries = random_points(30, 100);
    c.k = 4;
  }
  return all;
}

}  // namespace treeline::datasets::hard
