// NaN and infinity in points, vertices, queries and rays. A method may refuse with a clear error. If it
// answers, the answer must be right over the finite part: comparisons with NaN are false both ways and must
// not steer it.
#include <limits>

#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> nan_infinity() {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinity = std::numeric_limits<float>::infinity();
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "nan_infinity", c.name = std::move(name), c.source = std::move(source), c.law = std::move(law);
    c.expect = Expect::answers_or_refuses;
    return all.emplace_back(std::move(c));
  };
  const std::string finite_part = "refused with a clear error, or the neighbours among the finite points";
  const auto cloud_case = [&](std::string name, std::string source) -> HardCase& {
    HardCase& c = add(std::move(name), std::move(source), finite_part);
    c.cloud.points = random_points(71, 4000);
    c.queries = random_points(72, 200);
    return c;
  };
  {
    HardCase& c = cloud_case("one_point_in_1000_nan",
                             "measured: nanoflann 1.12.1 is 86 % wrong in silence; FLANN #320");
    for (std::size_t i = 500; i < c.cloud.points.size(); i += 1000) c.cloud.points[i] = {nan, nan, nan};
  }
  cloud_case("first_point_nan", "measured: nanoflann is 84 to 96 % wrong, FLANN 63 %").cloud.points[0] = {
      nan, nan, nan};
  cloud_case("one_coordinate_nan", "derivation: the other two coordinates still sort it into a leaf")
      .cloud.points[2000][1] = nan;
  {
    HardCase& c = cloud_case("infinite_points", "measured: unibn's octree crashes on one infinite point");
    c.cloud.points[10] = {infinity, 0, 0};
    c.cloud.points[20] = {0, -infinity, infinity};
  }
  {
    HardCase& c = add("all_points_nan", "derivation: no finite point is left", "refused, or nothing found");
    c.cloud.points.assign(100, {nan, nan, nan});
    c.queries = random_points(73, 10);
  }
  {
    HardCase& c =
        add("nan_queries", "measured: PCL aborts, pico_tree returns one id eight times, CGAL any ids",
            "refused with a clear error, or nothing found");
    c.cloud.points = random_points(74, 1000);
    c.queries = {{nan, nan, nan}, {0.5f, nan, 0.5f}, {nan, 0.5f, 0.5f}};
  }
  {
    HardCase& c = add("infinite_queries", "derivation: every distance is infinite, so all points tie",
                      "refused with a clear error, or every distance infinite");
    c.cloud.points = random_points(75, 1000);
    c.queries = {{infinity, 0, 0}, {-infinity, infinity, 0}};
  }

  const std::string finite_faces = "refused with a clear error, or the hits of the finite triangles";
  const auto mesh_case = [&](std::string name, std::string source) -> HardCase& {
    HardCase& c = add(std::move(name), std::move(source), finite_faces);
    c.mesh = snapped_sphere(10);
    c.rays = rays_from_around(76, 500, 3);
    return c;
  };
  mesh_case("nan_vertices", "measured: tinybvh's spatial-split build loses 1,200 hits in 1e6")
      .mesh.vertices[300] = {nan, nan, nan};
  mesh_case("first_vertex_nan", "derivation: a box that starts from NaN never grows").mesh.vertices[0][0] =
      nan;
  {
    HardCase& c = mesh_case("infinite_vertices", "measured: tinybvh crashes on infinite vertices");
    c.mesh.vertices[100] = {infinity, 0, 0};
    c.mesh.vertices[200] = {0, -infinity, infinity};
  }
  {
    HardCase& c = mesh_case("vertex_at_1e25", "measured: tinybvh crashes on vertices at 1e25");
    c.mesh.vertices[100] = {1e25f, 0, 0};
    c.expect = Expect::answers;
    c.law = "hits are those of all triangles, among them six of which one corner is far out";
  }
  {
    HardCase& c = mesh_case("nan_rays", "derivation: every comparison with NaN is false");
    c.law = "refused with a clear error, or no hit";
    c.rays = {{.origin = {nan, 0, 0}, .direction = {1, 0, 0}},
              {.origin = {0, 0, 0}, .direction = {nan, 0, 0}},
              {.origin = {0, nan, 0}, .direction = {1, nan, 0}}};
  }
  return all;
}

}  // namespace treeline::datasets::hard
