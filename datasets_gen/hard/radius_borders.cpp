// Radii at the borders of what a radius is: zero, negative, infinite, and exactly the distance of a point.
#include <limits>

#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> radius_borders() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "radius_borders", c.name = std::move(name), c.source = std::move(source),
    c.law = std::move(law);
    return all.emplace_back(std::move(c));
  };
  const std::string free = "; whether the border belongs to a ball is each library's own convention";
  {
    HardCase& c = add("radius_zero_on_a_point",
                      "measured: nanoflann, FLANN, PCL and CGAL leave the point out (they compare with <), "
                      "kiddo takes it",
                      "nothing but the point itself is found" + free);
    c.cloud.points = random_points(101, 2000);
    c.queries = every(c.cloud.points, 20);
    c.radius = 0.f;
  }
  {
    HardCase& c =
        add("points_exactly_at_the_radius",
            "measured: nanoflann, FLANN, CGAL and PCL's tree leave them out, PCL's octree and kiddo "
            "take them",
            "all nearer points are found and no farther ones" + free);
    // A lattice about the query with legs of 3, 4 and 5: (3, 4, 0) is at 5 exactly, in floats, too.
    for (int z = -6; z <= 6; ++z)
      for (int y = -6; y <= 6; ++y)
        for (int x = -6; x <= 6; ++x)
          c.cloud.points.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    c.queries = {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0.5f, 0.5f, 0}};
    c.radius = 5.f;
  }
  {
    HardCase& c = add("negative_radius",
                      "measured: nanoflann, pico_tree, FLANN and PCL square it and so take it for |r|; "
                      "nanoflann #128: users pass radii where squares are meant",
                      "refused with a clear error, or nothing found");
    c.expect = Expect::answers_or_refuses;
    c.cloud.points = random_points(103, 2000);
    c.queries = random_points(104, 50);
    c.radius = -0.25f;
  }
  {
    HardCase& c = add("infinite_radius", "derivation: r² is infinite, and so is the distance of padding",
                      "all points are found, each once");
    c.cloud.points = random_points(105, 1000);
    c.queries = random_points(106, 20);
    c.radius = std::numeric_limits<float>::infinity();
  }
  return all;
}

}  // namespace treeline::datasets::hard
