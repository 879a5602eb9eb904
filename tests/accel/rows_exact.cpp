// Every index against distances computed here in a wider type, against brute force bit for bit, and within
// what epsilon promises.
#include "rows_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
class RowIndices : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RowIndices, Scalars);

const std::vector<std::size_t> dimensions{1, 2, 7, 33, 130};

TYPED_TEST(RowIndices, NearestAreThoseOfTheTruth) {
  using T = TypeParam;
  for (const std::size_t d : dimensions)
    for (const Matrix<T>& m : matrices<T>(d)) {
      SCOPED_TRACE(m.name + " of " + std::to_string(d) + " columns");
      const Matrix<T> queries = queries_for(m);
      const Wide error = row_distance2_error<T>(d);
      std::vector<std::vector<Wide>> truths;
      for (std::size_t i = 0; i < queries.rows; ++i)
        truths.push_back(sorted_distances2<T>(m, std::as_const(queries).row(i)));
      for_each_index<T>(m.view(), [&](const auto& index) {
        for (std::size_t i = 0; i < queries.rows; ++i) {
          const auto q = queries.row(i);
          const auto& truth = truths[i];
          for (const std::size_t k : {std::size_t{1}, std::size_t{6}, std::size_t{120}, m.rows + 3}) {
            const auto found = index.nearest(q, k);
            expect_distinct(found, m.rows);
            for (std::size_t j = 0; j < found.size(); ++j) {
              const Wide exact = wide_distance2<T>(m.row(found[j].id), q);
              ASSERT_LE(exact, truth[j] * (1 + 3 * error)) << "rank " << j << " of " << k;
              if (exact < static_cast<Wide>(std::numeric_limits<T>::max())) {
                ASSERT_LE(std::abs(static_cast<Wide>(found[j].distance2) - exact),
                          exact * error + std::numeric_limits<T>::min());
              }
            }
          }
        }
      });
    }
}

// Ties by lowest id included.
TYPED_TEST(RowIndices, AllFindWhatBruteForceFindsBitForBit) {
  using T = TypeParam;
  for (const std::size_t d : dimensions)
    for (const Matrix<T>& m : matrices<T>(d))
      for (const int leaf_size : {1, 8, 50}) {
        SCOPED_TRACE(m.name + " of " + std::to_string(d) + " columns");
        const Matrix<T> queries = queries_for(m, 4);
        std::vector<std::vector<Neighbor<T>>> brute;  // the first index is brute force
        for_each_index<T>(
            m.view(),
            [&](const auto& index) {
              std::size_t asked = 0;
              for (const std::size_t k : {1, 10, 200})
                for (std::size_t i = 0; i < queries.rows; ++i, ++asked) {
                  const auto found = index.nearest(queries.row(i), k);
                  if (brute.size() <= asked) brute.push_back(found);
                  ASSERT_EQ(found, brute[asked]) << "query " << i << ", k = " << k;
                }
            },
            leaf_size);
      }
}

TYPED_TEST(RowIndices, FartherThanEpsilonAllowsIsNeverFound) {
  using T = TypeParam;
  for (const std::size_t d : {2, 16, 33})
    for (const Matrix<T>& m : {uniform_rows<T>(3000, d), latent_rows<T>(3000, d, 3)}) {
      const Matrix<T> queries = queries_for(m, 5);
      for_each_index<T>(m.view(), [&](const auto& index) {
        for (const double epsilon : {0.0, 0.1, 1.0, 10.0})
          for (std::size_t i = 0; i < queries.rows; ++i) {
            const auto q = queries.row(i);
            RowSearch search;
            search.epsilon = epsilon;
            const auto found = index.nearest(q, 10, search);
            const auto truth = sorted_distances2<T>(m, q);
            expect_distinct(found, m.rows);
            for (std::size_t j = 0; j < found.size(); ++j)
              EXPECT_LE(std::sqrt(wide_distance2<T>(m.row(found[j].id), q)),
                        std::sqrt(truth[j]) * (1 + epsilon) * (1 + row_distance2_error<T>(d)));
          }
      });
    }
}

TYPED_TEST(RowIndices, QueriesFromVeryFarRankRight) {
  using T = TypeParam;
  // On a line of steps that the query's own size does not drown.
  Matrix<T> m("line", 300, 5);
  for (std::size_t i = 0; i < m.rows; ++i)
    m.row(i)[2] = static_cast<T>(i + 1) * (sizeof(T) == 4 ? T(1e30) : T(1e300));
  for_each_index<T>(m.view(), [&](const auto& index) {
    std::vector<T> q(5, T(0));
    q[2] = sizeof(T) == 4 ? T(-3e38) : T(-1.7e308);
    const auto low = index.nearest(q, 4);
    for (Id i = 0; i < 4; ++i) EXPECT_EQ(low[i].id, i);
    q[2] = -q[2];
    const auto high = index.nearest(q, 4);
    for (Id i = 0; i < 4; ++i) EXPECT_EQ(high[i].id, 299 - i);
    // In a batch, between queries of ordinary size.
    Matrix<T> batch("batch", 50, 5);
    for (std::size_t i = 0; i < batch.rows; ++i) batch.row(i)[2] = i % 7 == 3 ? q[2] : m.row(2 * i)[2];
    std::vector<Neighbor<T>> found(batch.rows * 4);
    index.nearest(batch.view(), 4, {}, found, 2);
    for (std::size_t i = 0; i < batch.rows; ++i) {
      const auto single = index.nearest(std::as_const(batch).row(i), 4);
      EXPECT_TRUE(std::ranges::equal(single, std::span(found).subspan(4 * i, 4))) << i;
    }
  });
}

}  // namespace
}  // namespace treeline::accel::test
