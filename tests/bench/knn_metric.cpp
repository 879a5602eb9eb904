// The error metric of knn on answers that are wrong in known ways.
#include "bench/knn/metric.hpp"

#include <gtest/gtest.h>

namespace treeline::bench::knn {
namespace {

using accel::Id;
using accel::no_id;
using geometry::Vec3f;

// Points at 0, 1, 2, 4, 8 on a line; asked at 0 for the 3 nearest, so at distances 0, 1, 2.
class KnnMetric : public testing::Test {
 protected:
  Errors judge(std::vector<Id> ids, Claim claim = Claim::exact) const {
    return nearest_errors(points, queries, 3, ids, truth, claim);
  }
  const std::vector<Vec3f> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {8, 0, 0}, {0, 0, NAN}};
  const std::vector<Vec3f> queries{{0, 0, 0}};
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 3, {0}, 1);
};

TEST_F(KnnMetric, RightAnswersHaveNoError) {
  const Errors e = judge({0, 1, 2});
  EXPECT_TRUE(e.within_claim) << e.reason;
  EXPECT_EQ(e.error, 0);
  EXPECT_EQ(e.max, 0);
  EXPECT_EQ(e.bias, 0);
  EXPECT_EQ(e.extra["knn_recall"], 1.0);
  EXPECT_EQ(e.extra["knn_missing"], 0.0);
  EXPECT_EQ(e.extra["knn_wrong"], 0.0);
}

TEST_F(KnnMetric, OrderDoesNotMatter) { EXPECT_EQ(judge({2, 0, 1}).error, 0); }

TEST_F(KnnMetric, FartherPointCountsByItsExcess) {
  const Errors e = judge({0, 1, 3});  // 4 instead of 2: twice as far
  EXPECT_EQ(e.error, 1);
  EXPECT_EQ(e.max, 1);
  EXPECT_DOUBLE_EQ(*e.bias, 1.0 / 3);
  EXPECT_DOUBLE_EQ(e.extra["knn_recall"].get<double>(), 2.0 / 3);
  EXPECT_FALSE(e.within_claim);
  EXPECT_TRUE(judge({0, 1, 3}, Claim::approximate).within_claim);
}

TEST_F(KnnMetric, ErrorIsCutOffAtOneButTheLargestIsNot) {
  const Errors e = judge({0, 1, 4});  // 8 instead of 2: an excess of 3
  EXPECT_EQ(e.error, 1);
  EXPECT_EQ(e.max, 3);
}

TEST_F(KnnMetric, MissingCountsAsOneAndIsWrongForAnyClaim) {
  for (const Claim claim : {Claim::exact, Claim::approximate}) {
    const Errors e = judge({0, 1, no_id}, claim);
    EXPECT_EQ(e.error, 1);
    EXPECT_DOUBLE_EQ(e.extra["knn_missing"].get<double>(), 1.0 / 3);
    EXPECT_FALSE(e.within_claim);
    EXPECT_NE(e.reason.find("query 0"), std::string::npos) << e.reason;
  }
}

TEST_F(KnnMetric, RepeatedAndInvalidIdsAreWrongForAnyClaim) {
  for (const std::vector<Id>& ids :
       {std::vector<Id>{0, 1, 1}, std::vector<Id>{0, 1, 77}, std::vector<Id>{0, 1, 5 /* a NaN point */}})
    for (const Claim claim : {Claim::exact, Claim::approximate}) {
      const Errors e = judge(ids, claim);
      EXPECT_EQ(e.error, 1);
      EXPECT_FALSE(e.within_claim);
      EXPECT_FALSE(e.reason.empty());
    }
}

TEST_F(KnnMetric, PositiveDistanceWhereTheTrueOneIsZeroCountsAsOne) {
  const Errors e = judge({1, 2, 3});
  EXPECT_EQ(e.error, 1);
  EXPECT_FALSE(e.within_claim);
}

TEST(KnnMetricQueries, TiesAreFree) {
  const std::vector<Vec3f> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}}, queries{{0, 0, 0}};
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 1, {0}, 1);
  for (Id id = 0; id < 3; ++id)
    EXPECT_EQ(nearest_errors(points, queries, 1, std::vector<Id>{id}, truth, Claim::exact).error, 0);
}

TEST(KnnMetricQueries, RoundingBelowTheFloorIsNoError) {
  // Nearer by less than a float's rounding of the distance, and by well more than it.
  const std::vector<Vec3f> points{{1, 0, 0}, {1, 1e-4f, 0}, {1, 1e-2f, 0}}, queries{{0, 0, 0}};
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 1, {0}, 1);
  const auto judge = [&](Id id) {
    return nearest_errors(points, queries, 1, std::vector<Id>{id}, truth, Claim::exact);
  };
  EXPECT_TRUE(judge(1).within_claim);
  EXPECT_GT(*judge(1).error, 0);
  EXPECT_LT(*judge(1).error, float_floor());
  EXPECT_FALSE(judge(2).within_claim);
}

TEST(KnnMetricQueries, MoreThanThereIsIsNotExpected) {
  const std::vector<Vec3f> points{{1, 0, 0}}, queries{{0, 0, 0}};
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 3, {0}, 1);
  const auto judge = [&](std::vector<Id> ids) {
    return nearest_errors(points, queries, 3, ids, truth, Claim::exact).within_claim;
  };
  EXPECT_TRUE(judge({0, no_id, no_id}));
  EXPECT_FALSE(judge({0, 0, no_id}));
  EXPECT_FALSE(judge({no_id, no_id, no_id}));
}

TEST(KnnMetricQueries, NanQueryMustFindNothing) {
  const std::vector<Vec3f> points{{1, 0, 0}}, queries{{NAN, 0, 0}};
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 1, {0}, 1);
  EXPECT_TRUE(nearest_errors(points, queries, 1, std::vector<Id>{no_id}, truth, Claim::exact).within_claim);
  EXPECT_FALSE(
      nearest_errors(points, queries, 1, std::vector<Id>{0}, truth, Claim::approximate).within_claim);
}

TEST(KnnMetricQueries, MeanAndQuantilesAreOverQueries) {
  // 100 queries at 0, one of which gets 1.5 instead of 1.
  const std::vector<Vec3f> points{{1, 0, 0}, {1.5f, 0, 0}}, queries(100, Vec3f{0, 0, 0});
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 1, spread_sample(100, 100), 1);
  std::vector<Id> ids(100, 0);
  ids[42] = 1;
  const Errors e = nearest_errors(points, queries, 1, ids, truth, Claim::approximate);
  EXPECT_DOUBLE_EQ(*e.error, 0.005);
  EXPECT_DOUBLE_EQ(*e.max, 0.5);
  EXPECT_DOUBLE_EQ(*e.p99, 0);
  EXPECT_DOUBLE_EQ(*e.bias, 0.005);
}

TEST(KnnMetricQueries, RecallAllowsForALittleAndWrongCountsQueries) {
  // Four queries at 0 whose nearest is at 1; they get one at 1, 1.005, 1.05 and 1.5.
  const std::vector<Vec3f> points{{1, 0, 0}, {1.005f, 0, 0}, {1.05f, 0, 0}, {1.5f, 0, 0}},
      queries(4, Vec3f());
  const NearestTruth truth = nearest_truth(DoubleScan(points), queries, 1, spread_sample(4, 4), 1);
  const Errors e = nearest_errors(points, queries, 1, std::vector<Id>{0, 1, 2, 3}, truth, Claim::approximate);
  EXPECT_EQ(e.extra["knn_recall"], 0.25);
  EXPECT_EQ(e.extra["knn_recall_1pct"], 0.5);
  EXPECT_EQ(e.extra["knn_recall_10pct"], 0.75);
  EXPECT_EQ(e.extra["knn_wrong"], 0.75);
}

// Points at 1, 2, 3 on a line and one on the border; asked at 0 within 3, so 1 and 2 must, the others may.
class KnnRangeMetric : public testing::Test {
 protected:
  Errors judge(const std::vector<Id>& ids, Claim claim = Claim::exact) const {
    return range_errors({{0, ids.size()}, ids}, truth, claim);
  }
  const std::vector<Vec3f> points{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, queries{{0, 0, 0}};
  const RangeTruth truth = within_truth(DoubleScan(points), queries, 3, {0}, 1);
};

TEST_F(KnnRangeMetric, BorderIsFree) {
  EXPECT_EQ(judge({0, 1}).error, 0);
  EXPECT_EQ(judge({2, 1, 0}).error, 0);
  EXPECT_TRUE(judge({2, 1, 0}).within_claim);
}

TEST_F(KnnRangeMetric, MissingAndSurplusCountPerRightAnswer) {
  EXPECT_DOUBLE_EQ(*judge({0}).error, 0.5);
  EXPECT_DOUBLE_EQ(*judge({0}).bias, -0.5);
  EXPECT_DOUBLE_EQ(*judge({0, 1, 3}).error, 0.5);
  EXPECT_DOUBLE_EQ(*judge({0, 1, 3}).bias, 0.5);
  EXPECT_DOUBLE_EQ(*judge({0, 3}).error, 1);
  EXPECT_DOUBLE_EQ(*judge({0, 3}).bias, 0);
  EXPECT_DOUBLE_EQ(*judge({0, 1, 1}).error, 0.5);
  EXPECT_DOUBLE_EQ(*judge({0, 1, 99}).error, 0.5);
}

TEST_F(KnnRangeMetric, RecallIsWhatIsFoundAndWrongIsAnyError) {
  EXPECT_EQ(judge({0, 1}).extra["knn_recall"], 1.0);
  EXPECT_EQ(judge({0, 1}).extra["knn_wrong"], 0.0);
  EXPECT_EQ(judge({0}).extra["knn_recall"], 0.5);
  EXPECT_EQ(judge({0, 1, 3}).extra["knn_recall"], 1.0);
  EXPECT_EQ(judge({0, 1, 3}).extra["knn_wrong"], 1.0);
}

TEST_F(KnnRangeMetric, ApproximateMayMissButNotInvent) {
  EXPECT_FALSE(judge({0}).within_claim);
  EXPECT_TRUE(judge({0}, Claim::approximate).within_claim);
  EXPECT_FALSE(judge({0, 1, 3}, Claim::approximate).within_claim);
  EXPECT_FALSE(judge({0, 1, 1}, Claim::approximate).within_claim);
}

TEST_F(KnnRangeMetric, WhoeverRoundsThePointsMayCrossTheBorderBothWays) {
  const auto rounding = [&](const std::vector<Id>& ids) {
    return range_errors({{0, ids.size()}, ids}, truth, Claim::approximate, true);
  };
  EXPECT_TRUE(rounding({0, 3}).within_claim);
  EXPECT_DOUBLE_EQ(*rounding({0, 3}).error, 1);  // an error it is all the same
  EXPECT_FALSE(rounding({0, 1, 1}).within_claim);
}

}  // namespace
}  // namespace treeline::bench::knn
