// The truth of knn, double brute force, against exact rational arithmetic.
#include <gtest/gtest.h>

#include "bench/knn/double_scan.hpp"
#include "bench/knn/exact_oracle.hpp"
#include "bench/knn/truth.hpp"
#include "datasets_gen/hard/hard_case.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::knn {
namespace {

using accel::Id;
using geometry::Vec3f;

std::vector<Vec3f> finite_points(const geometry::Cloud3f& cloud, std::size_t most) {
  std::vector<Vec3f> r;
  for (const Vec3f& p : cloud.points)
    if (geometry::is_finite(p) && r.size() < most) r.push_back(p);
  return r;
}

// Both orders must rank the exact distances alike: the i-th of one is exactly as far as the i-th of the
// other, up to the few roundings of a double (relative 1e-14).
void expect_agreement(std::span<const Vec3f> points, const Vec3f& query, std::size_t k,
                      const std::string& where) {
  const DoubleScan scan(points);
  const auto found = scan.nearest(query, k);
  const std::vector<Id> exact = exact_nearest(points, query, k);
  ASSERT_EQ(found.size(), exact.size()) << where;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double right = geometry::distance(geometry::Vec3d(points[exact[i]]), geometry::Vec3d(query));
    ASSERT_NEAR(std::sqrt(found[i].distance2), right, 1e-14 * right) << where << ", rank " << i;
  }
}

TEST(KnnTruth, AgreesWithExactArithmeticOnRandomPoints) {
  geometry::Pcg32 random(3);
  for (const float scale : {1e-20f, 1.0f, 1e20f}) {
    std::vector<Vec3f> points(150);
    for (Vec3f& p : points)
      for (int a = 0; a < 3; ++a) p[a] = scale * random.uniform<float>(-1, 1);
    for (int i = 0; i < 10; ++i)
      expect_agreement(points, points[static_cast<std::size_t>(i)] * 1.5f, 32,
                       "scale " + std::to_string(scale));
  }
}

// On a lattice every squared distance is a small integer, exact in double: even the ids agree, ties by lower
// id.
TEST(KnnTruth, SameIdsAsExactArithmeticOnATieHeavyLattice) {
  std::vector<Vec3f> points;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) points.push_back({float(x), float(y), float(z)});
  points.insert(points.end(), points.begin(), points.begin() + 40);  // and some twice
  const DoubleScan scan(points);
  for (const Vec3f query : {Vec3f{2, 2, 2}, Vec3f{0.5f, 0.5f, 0.5f}, Vec3f{-3, 2, 7}}) {
    std::vector<Id> ids;
    for (const auto& f : scan.nearest(query, 60)) ids.push_back(f.id);
    EXPECT_EQ(ids, exact_nearest(points, query, 60));
  }
}

TEST(KnnTruth, AgreesWithExactArithmeticOnEveryHardCase) {
  for (const datasets::HardCase& c : datasets::hard_cases()) {
    if (!c.for_points()) continue;
    const std::vector<Vec3f> points = finite_points(c.cloud, 200);
    for (std::size_t i = 0; i < std::min<std::size_t>(c.queries.size(), 5); ++i)
      if (geometry::is_finite(c.queries[i])) expect_agreement(points, c.queries[i], c.k, c.name);
  }
}

// What must be returned lies within, what is neither must nor may does not, exactly.
TEST(KnnTruth, RadiusAgreesWithExactArithmetic) {
  geometry::Pcg32 random(5);
  std::vector<Vec3f> points(200);
  for (Vec3f& p : points)
    for (int a = 0; a < 3; ++a) p[a] = std::floor(random.uniform<float>(0, 8));
  const DoubleScan scan(points);
  for (const float radius : {0.0f, 1.0f, 2.5f, 3.0f}) {
    const RangeAnswer answer = scan.within(points[0], radius);
    const std::vector<Id> exact = exact_within(points, points[0], radius);
    std::vector<Id> all;
    std::merge(answer.must.begin(), answer.must.end(), answer.may.begin(), answer.may.end(),
               std::back_inserter(all));
    EXPECT_TRUE(std::includes(exact.begin(), exact.end(), answer.must.begin(), answer.must.end())) << radius;
    EXPECT_EQ(all, exact) << radius;  // on a lattice, nothing lies just outside the border
  }
}

TEST(KnnTruth, BoxLeavesOnlyItsBorderOpen) {
  const std::vector<Vec3f> points{
      {0.5f, 0.5f, 0.5f}, {1, 0.5f, 0.5f}, {1.001f, 0.5f, 0.5f}, {0, 0, 0}, {2, 2, 2}};
  const RangeAnswer answer = DoubleScan(points).inside({{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(answer.must, std::vector<Id>{0});
  EXPECT_EQ(answer.may, (std::vector<Id>{1, 3}));
}

TEST(KnnTruth, LeavesOutPointsThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> points{
      {nan, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<float>::infinity(), 0}, {2, 0, 0}};
  const auto found = DoubleScan(points).nearest({0, 0, 0}, 4);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].id, 1u);
  EXPECT_EQ(found[1].id, 3u);
}

TEST(KnnTruth, SampleIsSpreadAndComplete) {
  EXPECT_EQ(spread_sample(4, 4), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(spread_sample(100, 4), (std::vector<std::uint32_t>{0, 25, 50, 75}));
  EXPECT_EQ(spread_sample(3, 10).size(), 3u);
  EXPECT_EQ(checked_queries(1'000, 2'000), 2'000u);
  EXPECT_EQ(checked_queries(1'000'000, 2'000), 200u);
}

TEST(KnnTruth, SurvivesTheCacheAndRefusesDamage) {
  const std::vector<Vec3f> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  const DoubleScan scan(points);
  const std::string near = to_bytes(nearest_truth(scan, points, 2, {0, 2}, 1));
  const NearestTruth back = nearest_from_bytes(near);
  EXPECT_EQ(back.k, 2u);
  EXPECT_EQ(back.sample, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(back.distances, (std::vector<double>{0, 1, 0, 2}));
  EXPECT_THROW(nearest_from_bytes(std::string_view(near).substr(0, near.size() - 1)), std::invalid_argument);
  EXPECT_THROW(nearest_from_bytes(near + "x"), std::invalid_argument);

  const std::string range = to_bytes(within_truth(scan, points, 1.5, {0, 1, 2}, 1));
  const RangeTruth lists = range_from_bytes(range);
  EXPECT_EQ(lists.answers[0].must, (std::vector<Id>{0, 1}));
  EXPECT_EQ(lists.answers[2].must, std::vector<Id>{2});
  EXPECT_THROW(range_from_bytes(std::string_view(range).substr(0, 20)), std::invalid_argument);
}

}  // namespace
}  // namespace treeline::bench::knn
