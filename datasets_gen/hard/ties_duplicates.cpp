// Equal distances and equal points. Splits by coordinate cannot part equal points; answers by id are not
// unique.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> ties_duplicates() {
  std::vector<HardCase> all;
  const std::string by_distance =
      "the k distances equal those of brute force; which of equals is returned is free";
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "ties_duplicates", c.name = std::move(name), c.source = std::move(source),
    c.law = std::move(law);
    return all.emplace_back(std::move(c));
  };

  {  // A grid of spacing 1/16, queried at its points (6 at one distance) and at its cell centres (8 at one
     // distance).
    HardCase& c =
        add("grid_ties", "derivation: a lattice point has 6 neighbours at one distance, a cell centre 8",
            by_distance);
    for (int k = 0; k < 16; ++k)
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i) c.cloud.points.push_back({i / 16.f, j / 16.f, k / 16.f});
    c.queries = every(c.cloud.points, 9);
    for (int i = 0; i < 15; ++i)
      for (int j = 0; j < 15; ++j) c.queries.push_back({(i + 0.5f) / 16, (j + 0.5f) / 16, (i + 0.5f) / 16});
    c.k = 5;              // cuts through both groups of equals
    c.radius = 1 / 16.f;  // exactly the spacing: closed balls hold 7 points
  }
  {
    HardCase& c =
        add("equal_points_1e5",
            "measured: CGAL 5.5 Kd_tree and pico_tree overflow the stack on 1e5 equal points; CGAL #3077",
            "all k neighbours are at the one distance there is");
    c.cloud.points.assign(100'000, {0.25f, 0.5f, 0.75f});
    c.queries = random_points(11, 49);
    c.queries.push_back(c.cloud.points[0]);
  }
  {
    HardCase& c =
        add("equal_points_1e6",
            "measured: CGAL and pico_tree do not end within 20 s; PCL's octree takes 35 ms a query, "
            "FLANN 13 ms, nanoflann 8.5 ms, as brute force does",
            "all k neighbours are at the one distance there is");
    c.cloud.points.assign(1'000'000, {0.25f, 0.5f, 0.75f});
    c.queries = random_points(17, 9);
    c.queries.push_back(c.cloud.points[0]);
  }
  {
    HardCase& c =
        add("more_duplicates_than_a_leaf",
            "kiddo #78: a bucket that overflows with equal coordinates cannot be split", by_distance);
    c.cloud.points = random_points(12, 300);
    for (std::size_t i = 0; i < 20; ++i)
      for (int copy = 0; copy < 70; ++copy) c.cloud.points.push_back(c.cloud.points[15 * i]);
    c.queries = every(c.cloud.points, 7);
    for (const Vec3f& q : random_points(13, 100)) c.queries.push_back(q);
    c.k = 32;
    c.radius = 0.1f;
  }
  {
    HardCase& c = add("one_shared_coordinate",
                      "kiddo #475: many points with one equal coordinate on the split axis", by_distance);
    c.cloud.points = random_points(14, 4000);
    for (std::size_t i = 0; i < c.cloud.points.size(); ++i) c.cloud.points[i][0] = i % 50 == 0 ? 0.9f : 0.5f;
    c.queries = random_points(15, 200);
  }
  {
    HardCase& c = add("two_far_piles", "derivation: every split but one leaves a side empty", by_distance);
    c.cloud.points.assign(600, {0, 0, 0});
    c.cloud.points.insert(c.cloud.points.end(), 600, {1, 1, 1});
    c.queries = random_points(16, 100);
    c.radius = 0.7f;
  }
  return all;
}

}  // namespace treeline::datasets::hard
