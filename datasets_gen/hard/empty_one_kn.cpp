// Nothing, one, and fewer than asked for.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> empty_one_kn() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "empty_one_kn", c.name = std::move(name), c.source = std::move(source), c.law = std::move(law);
    return all.emplace_back(std::move(c));
  };
  const std::string as_many = "all n points are returned where n < k, each once, in order of distance";
  {
    HardCase& c = add("empty_cloud", "measured: FLANN, pico_tree and unibn crash, PCL's octree aborts",
                      "nothing is found");
    c.queries = random_points(81, 10);
    c.radius = 1;
  }
  {
    HardCase& c = add("one_point", "derivation: a root that is a leaf", as_many);
    c.cloud.points = {{0.5f, 0.25f, 0.125f}};
    c.queries = random_points(82, 10);
    c.queries.push_back(c.cloud.points[0]);
    c.radius = 0.5f;
  }
  {
    HardCase& c = add("k_zero", "measured: FLANN, CGAL, nanoflann 1.4 and pico_tree crash on k = 0",
                      "refused with a clear error, or nothing found");
    c.expect = Expect::answers_or_refuses;
    c.cloud.points = random_points(93, 100);
    c.queries = random_points(94, 20);
    c.k = 0;
  }
  {
    HardCase& c =
        add("k_above_n", "nanoflann, FLANN, PCL and CGAL return n (measured); padding ids leak out of others",
            as_many);
    c.cloud.points = random_points(83, 5);
    c.queries = random_points(84, 20);
    c.k = 32;
  }
  {
    HardCase& c =
        add("k_equals_n", "derivation: the last pruning bound is infinite until the last point", as_many);
    c.cloud.points = random_points(85, 32);
    c.queries = random_points(86, 20);
    c.k = 32;
  }
  {
    HardCase& c = add("coincident_few", "derivation: an extent of zero, nothing to divide by", as_many);
    c.cloud.points.assign(20, {0.1f, 0.2f, 0.3f});
    c.queries = random_points(87, 10);
    c.queries.push_back(c.cloud.points[0]);
    c.k = 32;
    c.radius = 0.75f;
  }
  {
    HardCase& c =
        add("empty_mesh", "derivation: a root box that is empty must not be entered", "no ray hits");
    c.rays = rays_from_around(88, 20, 3);
  }
  {
    HardCase& c =
        add("one_triangle", "derivation: a root that is a leaf", "hits are those of the one triangle");
    add_triangle(c.mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    c.rays = rays_from_around(89, 100, 3);
  }
  {
    HardCase& c =
        add("one_degenerate_triangle", "derivation: no triangle is left to build over", "no ray hits");
    add_triangle(c.mesh, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    c.rays = rays_from_around(90, 20, 3);
    c.rays.push_back({.origin = {1, 0, 2}, .direction = {0, 0, -1}});
  }
  {
    HardCase& c = add("vertices_without_faces", "derivation: a cloud saved as a mesh", "no ray hits");
    c.mesh.vertices = random_points(91, 50);
    c.rays = rays_from_around(92, 20, 3);
  }
  return all;
}

}  // namespace treeline::datasets::hard
