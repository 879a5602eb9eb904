// The error metric of knn_nd on answers that are wrong in known ways.
#include "bench/knn_nd/metric.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace treeline::bench::knn_nd {
namespace {

using accel::no_id;

// Rows at 0, 1, 2, 4, 8 along the second of four columns, and one that is not finite; asked at 0 for 3.
class KnnNdMetric : public testing::Test {
 protected:
  Errors judge(std::vector<Id> ids, Claim claim = Claim::exact, double epsilon = 0) const {
    return errors_of(rows, query, 3, ids, truth_of(rows, query, 3, 1), claim, epsilon);
  }
  const std::vector<float> scalars{0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 8, 0, 0, 0, 0, 0, NAN};
  const RowsView rows{scalars.data(), 6, 4}, query{scalars.data(), 1, 4};
};

TEST_F(KnnNdMetric, RightAnswersInAnyOrderHaveNoError) {
  for (const auto& ids : {std::vector<Id>{0, 1, 2}, std::vector<Id>{2, 0, 1}}) {
    const Errors e = judge(ids);
    EXPECT_TRUE(e.within_claim) << e.reason;
    EXPECT_EQ(e.error, 0);
    EXPECT_EQ(e.mean, 0);
    EXPECT_EQ(e.bias, 0);
    EXPECT_EQ(e.extra["knn_nd_recall"], 1.0);
    EXPECT_DOUBLE_EQ(*e.floor, 0.5 / 3);
    EXPECT_FALSE(e.max || e.p99);
  }
}

TEST_F(KnnNdMetric, AFartherRowCostsRecallAndItsExcess) {
  const Errors e = judge({0, 1, 3});  // 4 instead of 2
  EXPECT_DOUBLE_EQ(*e.error, 1.0 / 3);
  EXPECT_DOUBLE_EQ(*e.mean, 1.0 / 3);
  EXPECT_DOUBLE_EQ(*e.bias, 1.0 / 3);
  EXPECT_EQ(e.extra["knn_nd_excess_max"], 1.0);
  EXPECT_FALSE(e.within_claim);
  EXPECT_TRUE(judge({0, 1, 3}, Claim::approximate).within_claim);
  EXPECT_TRUE(judge({0, 1, 3}, Claim::bounded, 1).within_claim);
  EXPECT_FALSE(judge({0, 1, 3}, Claim::bounded, 0.9).within_claim);
  // The excess is cut off at 1 in the means only.
  EXPECT_EQ(judge({0, 1, 4}).extra["knn_nd_excess_max"], 3.0);
  EXPECT_DOUBLE_EQ(*judge({0, 1, 4}).mean, 1.0 / 3);
}

TEST_F(KnnNdMetric, MissingRepeatedAndInvalidIdsAreWrongForAnyClaim) {
  for (const std::vector<Id>& ids : {std::vector<Id>{0, 1, no_id}, std::vector<Id>{0, 1, 1},
                                     std::vector<Id>{0, 1, 77}, std::vector<Id>{0, 1, 5 /* not finite */}})
    for (const Claim claim : {Claim::exact, Claim::bounded, Claim::approximate}) {
      const Errors e = judge(ids, claim, 10);
      EXPECT_DOUBLE_EQ(*e.error, 1.0 / 3);
      EXPECT_FALSE(e.within_claim);
      EXPECT_NE(e.reason.find("query 0"), std::string::npos) << e.reason;
    }
}

TEST(KnnNdMetricQueries, TiesAndRoundingAreFree) {
  const std::vector<float> scalars{1, 0, -1, 0, 0, 1, 1.00000012f, 0}, at{0, 0};
  const RowsView rows(scalars.data(), 4, 2), query(at.data(), 1, 2);
  const Truth truth = truth_of(rows, query, 1, 1);
  for (Id id = 0; id < 4; ++id) {
    const Errors e = errors_of(rows, query, 1, std::vector<Id>{id}, truth, Claim::exact);
    EXPECT_EQ(e.error, 0) << id;
    EXPECT_TRUE(e.within_claim) << id;
  }
}

TEST(KnnNdMetricQueries, MoreThanThereIsIsNotExpectedAndNanFindsNothing) {
  const std::vector<float> scalars{1, 0}, at{0, 0, NAN, 0};
  const RowsView rows(scalars.data(), 1, 2);
  const RowsView zero(at.data(), 1, 2), nan(at.data() + 2, 1, 2);
  const auto judge = [&](RowsView query, std::vector<Id> ids) {
    return errors_of(rows, query, 2, ids, truth_of(rows, query, 2, 1), Claim::approximate).within_claim;
  };
  EXPECT_TRUE(judge(zero, {0, no_id}));
  EXPECT_FALSE(judge(zero, {0, 0}));
  EXPECT_FALSE(judge(zero, {no_id, no_id}));
  EXPECT_TRUE(judge(nan, {no_id, no_id}));
  EXPECT_FALSE(judge(nan, {0, no_id}));
}

}  // namespace
}  // namespace treeline::bench::knn_nd
