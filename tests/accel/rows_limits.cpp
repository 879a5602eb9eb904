// Searches that stop early, batches, and the work and statistics of indices over rows.
#include "rows_common.hpp"

namespace treeline::accel::test {
namespace {

TEST(RowLimits, AreKeptAndStillFindKRows) {
  for (const Matrix<float>& m : {latent_rows<float>(4000, 20, 4), uniform_rows<float>(4000, 20)}) {
    const Matrix<float> queries = queries_for(m, 10);
    for_each_index<float>(m.view(), [&](const auto& index) {
      if (index.name == "brute force") return;
      for (const std::size_t k : {1, 10, 300})
        for (const std::size_t limit : {1, 64, 500})
          for (const bool by_leaves : {false, true})
            for (std::size_t i = 0; i < queries.rows; ++i) {
              RowSearch search;
              (by_leaves ? search.max_leaves : search.max_rows) = limit;
              std::vector<Neighbor<float>> found(k);
              Work work;
              ASSERT_EQ(index.nearest(queries.row(i), k, search, found, work), k);
              expect_distinct(found, m.rows);
              for (const auto& n : found) ASSERT_NE(n.id, no_id);
              const std::size_t most = std::max(k, by_leaves ? 8 * limit : limit) + 8;
              EXPECT_LE(work.primitives, most);
            }
    });
  }
}

double recall(const AnyRows<float>& index, const Matrix<float>& queries, std::size_t k,
              const RowSearch& search) {
  std::size_t met = 0;
  for (std::size_t i = 0; i < queries.rows; ++i) {
    const auto truth = index.nearest(queries.row(i), k);
    for (const auto& n : index.nearest(queries.row(i), k, search))
      met += n.distance2 <= truth.back().distance2 ? 1u : 0u;
  }
  return static_cast<double>(met) / static_cast<double>(k * queries.rows);
}

// A tenth of the rows holds nearly all neighbours where the rows fill few dimensions, and rows looked at more
// cost nothing but time.
TEST(RowLimits, MoreRowsFindMore) {
  const Matrix<float> m = latent_rows<float>(8000, 32, 5), queries = latent_rows<float>(60, 32, 5, 9);
  for_each_index<float>(m.view(), [&](const auto& index) {
    double before = 0;
    for (const std::size_t limit : {50, 200, 800}) {
      RowSearch search;
      search.max_rows = limit;
      const double r = recall(index, queries, 10, search);
      EXPECT_GE(r, before - 0.01);
      before = r;
    }
    EXPECT_GT(before, 0.9);
  });
}

// What makes trees worth it: the work of an exact search where rows fill few dimensions.
TEST(RowLimits, ExactSearchOfFewDimensionsLooksAtFewRows) {
  const Matrix<float> m = latent_rows<float>(20000, 32, 3), queries = latent_rows<float>(50, 32, 3, 9);
  for_each_index<float>(m.view(), [&](const auto& index) {
    Work work;
    std::vector<Neighbor<float>> out(10);
    for (std::size_t i = 0; i < queries.rows; ++i) index.nearest(queries.row(i), 10, {}, out, work);
    const std::size_t each = work.primitives / queries.rows;
    if (index.name == "brute force") {
      EXPECT_EQ(each, m.rows);
    } else {
      EXPECT_LT(each, index.name == "bsp wide spill" ? 4000 : 1500);
    }
  });
}

TEST(RowLimits, EqualRowsCostLittle) {
  Matrix<float> m("lump", 60000, 9);
  const Matrix<float> uniform = uniform_rows<float>(10000, 9);
  std::copy(uniform.scalars.begin(), uniform.scalars.end(), m.scalars.begin());
  for (std::size_t i = 10000; i < m.rows; ++i) std::copy_n(uniform.scalars.begin(), 9, m.row(i));
  for_each_index<float>(m.view(), [&](const auto& index) {
    if (index.name == "brute force") return;
    EXPECT_LE(index.stats().depth, 24u);
    Work work;
    std::vector<Neighbor<float>> out(8);
    index.nearest(uniform.row(0), 8, {}, out, work);
    EXPECT_EQ(out[0].id, 0u);
    EXPECT_EQ(out[7].id, 10006u);
    EXPECT_LT(work.primitives, 5000u);  // of 10000 that differ, in 9 dimensions
  });
}

TEST(RowBatches, EqualSinglesWhateverTheThreads) {
  const Matrix<float> m = latent_rows<float>(3000, 19, 4), queries = uniform_rows<float>(700, 19, 4);
  RowSearch limited;
  limited.max_rows = 100;
  for_each_index<float>(m.view(), [&](const auto& index) {
    for (const RowSearch& search : {RowSearch{}, limited})
      for (const int threads : {1, 2, 5}) {
        constexpr std::size_t k = 5;
        std::vector<Neighbor<float>> batch(queries.rows * k, {-1.f, 7});
        index.nearest(queries.view(), k, search, batch, threads);
        for (std::size_t i = 0; i < queries.rows; ++i)
          ASSERT_TRUE(std::ranges::equal(index.nearest(queries.row(i), k, search),
                                         std::span(batch).subspan(i * k, k)))
              << "query " << i;
      }
  });
}

TEST(RowBatches, PadWhatIsMissingAndMayBeEmpty) {
  for (const std::size_t n : {0, 3}) {
    const Matrix<float> m = uniform_rows<float>(n, 6), queries = uniform_rows<float>(300, 6, 2);
    for_each_index<float>(m.view(), [&](const auto& index) {
      std::vector<Neighbor<float>> out(queries.rows * 5, {-1.f, 77});
      index.nearest(queries.view(), 5, {}, out, 2);
      for (std::size_t i = 0; i < out.size(); ++i) {
        ASSERT_EQ(out[i].id == no_id, i % 5 >= n);
        ASSERT_EQ(std::isinf(out[i].distance2), i % 5 >= n);
      }
      index.nearest(RowsView<float>{}, 5, {}, {}, 2);
    });
  }
}

TEST(RowBatches, RowsMayLieApart) {
  const Matrix<float> wide = uniform_rows<float>(200, 9);
  Matrix<float> narrow("narrow", 200, 4);
  for (std::size_t i = 0; i < 200; ++i) std::copy_n(wide.row(i).data(), 4, narrow.row(i));
  const RowsView<float> view(wide.scalars.data(), 200, 4, 9);
  std::vector<std::vector<Neighbor<float>>> expected;
  for_each_index<float>(narrow.view(), [&](const auto& index) {
    expected.emplace_back(200 * 3), index.nearest(narrow.view(), 3, {}, expected.back(), 1);
  });
  std::size_t number = 0;
  for_each_index<float>(view, [&](const auto& index) {
    std::vector<Neighbor<float>> out(200 * 3);
    index.nearest(view, 3, {}, out, 1);
    EXPECT_EQ(out, expected[number++]);
  });
}

TEST(RowShape, StatisticsAgreeWithEachOther) {
  for (const Matrix<float>& m : matrices<float>(11))
    for (const int leaf_size : {1, 8}) {
      SCOPED_TRACE(m.name);
      for_each_index<float>(
          m.view(),
          [&](const auto& index) {
            const TreeStats s = index.stats();
            EXPECT_EQ(index.size(), m.rows);
            EXPECT_EQ(index.columns(), 11u);
            EXPECT_EQ(s.primitives, m.rows);
            EXPECT_EQ(index.bytes(), s.bytes);
            EXPECT_GE(s.bytes, m.rows * 11 * sizeof(float));
            EXPECT_GE(s.references, m.rows);
            const std::size_t trees = index.name == "forest random axis"         ? 4
                                      : index.name == "forest random projection" ? 3
                                                                                 : 1;
            EXPECT_LE(s.references, (index.name.ends_with("spill") ? 4 : trees) * m.rows);
            EXPECT_LE(s.depth, 16u);
            if (m.rows > 0) {
              EXPECT_EQ(s.leaves, s.inner_nodes + trees);
            }
          },
          leaf_size);
    }
}

}  // namespace
}  // namespace treeline::accel::test
