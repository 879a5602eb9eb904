// The remedy for coordinates that float cannot hold is tried: what it says to subtract is subtracted.
#include "bench/core/rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace treeline::bench {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;

/// The farthest that float moves a coordinate of points less `middle`.
double moved(const std::vector<Vec3d>& points, const Vec3d& middle) {
  double most = 0;
  for (const Vec3d& p : points)
    for (int k = 0; k < 3; ++k) {
      const double x = p[k] - middle[k];
      most = std::max(most, std::abs(x - static_cast<double>(static_cast<float>(x))));
    }
  return most;
}

/// A hilly sheet of `size` by `size` with its lowest corner at `at`.
std::vector<Vec3d> sheet(const Vec3d& at, double size) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      points.push_back(at + Vec3d{i * size / 39.1, j * size / 39.3, 0.05 * size * std::sin(i * 0.7 + j)});
  return points;
}

datasets::Dataset mesh_of(const std::vector<Vec3d>& points) {
  datasets::Dataset out;
  out.kind = datasets::Kind::mesh;
  for (const Vec3d& p : points) out.mesh.vertices.emplace_back(p);
  out.mesh.faces = {{0, 1, 2}};
  out.rounding = moved(points, {0, 0, 0});
  return out;
}

TEST(Rounding, SubtractingWhatTheRemedySaysLeavesWhatItSays) {
  for (const double size : {0.5, 80.0, 2000.0}) {
    const auto points = sheet({456'123.4, 5'430'987.6, 312.5}, size);
    const datasets::Dataset input = mesh_of(points);
    const std::string remedy = format_remedy(input);
    Vec3d middle;
    double after = 0, before = 0;
    ASSERT_EQ(std::sscanf(remedy.c_str(), "subtract its middle, (%lf, %lf, %lf)", &middle[0], &middle[1],
                          &middle[2]),
              3)
        << remedy;
    ASSERT_EQ(std::sscanf(remedy.c_str() + remedy.find("up to about"), "up to about %lg in place of %lg",
                          &after, &before),
              2)
        << remedy;
    EXPECT_NEAR(before, input.rounding, 0.05 * before);
    EXPECT_LT(moved(points, middle), 1.5 * after) << remedy;  // one digit is told
    EXPECT_LT(moved(points, middle), 0.01 * input.rounding) << remedy;
    EXPECT_NE(format_rounding(input, false).find("remedy"), std::string::npos);
  }
}

TEST(Rounding, NoRemedyWhereThereIsNothingToGain) {
  EXPECT_EQ(format_remedy(mesh_of(sheet({-1, -1, 0}, 2))), "");       // about the origin already
  EXPECT_EQ(format_remedy(mesh_of(sheet({3, 5, 0}, 2))), "");         // near enough
  EXPECT_EQ(format_remedy(mesh_of({{1e6, 0, 0}, {1e6, 0, 0}})), "");  // no extent
  datasets::Dataset cloud = mesh_of(sheet({456'123.4, 5'430'987.6, 312.5}, 80));
  cloud.kind = datasets::Kind::cloud;  // those are measured as doubles
  EXPECT_EQ(format_remedy(cloud), "");
  datasets::Dataset exact = mesh_of(sheet({1, 1, 1}, 1));
  exact.rounding = 0;
  EXPECT_EQ(format_rounding(exact, false), "");
  datasets::Dataset broken = mesh_of(sheet({456'123.4, 5'430'987.6, 312.5}, 80));
  broken.mesh.vertices.push_back(Vec3f::filled(NAN));
  EXPECT_NE(format_remedy(broken), "");
}

}  // namespace
}  // namespace treeline::bench
