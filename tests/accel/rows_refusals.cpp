// What indices over rows refuse, and in which words.
#include <cmath>

#include "accel/bsp_tree/rows.hpp"
#include "accel/forest/rows.hpp"
#include "accel/kd_tree/rows.hpp"
#include "rows_common.hpp"

namespace treeline::accel::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

template <class F>
void expect_refused(F&& f, const std::string& words) {
  try {
    f();
    ADD_FAILURE() << "accepted, instead of: " << words;
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what() << "\nlacks: " << words;
  }
}

TEST(RowRefusals, Queries) {
  for (const std::size_t n : {0, 500}) {
    const Matrix<float> m = uniform_rows<float>(n, 5);
    for_each_index<float>(m.view(), [&](const auto& index) {
      std::vector<Neighbor<float>> out(600 * 7);
      Work work;
      const std::vector<float> q(5, 0.f), longer(6, 0.f);
      const auto single = [&](std::span<const float> query, std::size_t k, const RowSearch& s = {}) {
        index.nearest(query, k, s, out, work);
      };
      expect_refused([&] { single(q, 0); }, "k is 0");
      expect_refused([&] { single(longer, 1); }, "query has 6 coordinates; rows have 5");
      expect_refused([&] { single(std::span(q).first(4), 1); }, "query has 4 coordinates; rows have 5");
      for (const float bad : {nan, inf, -inf}) {
        std::vector<float> broken = q;
        broken[3] = bad;
        expect_refused([&] { single(broken, 1); }, "query has a coordinate that is not finite");
        Matrix<float> queries = uniform_rows<float>(600, 5);
        queries.row(417)[4] = bad;
        for (const int threads : {1, 2})
          expect_refused([&] { index.nearest(queries.view(), 1, {}, out, threads); }, "query 417 ");
      }
      for (const double epsilon : {-1.0, -1e-9, std::nan(""), HUGE_VAL}) {
        RowSearch search;
        search.epsilon = epsilon;
        expect_refused([&] { single(q, 1, search); }, "epsilon is ");
      }
      RowSearch search;
      search.max_rows = 0;
      expect_refused([&] { single(q, 1, search); }, "max_rows is 0");
      search = {}, search.max_leaves = 0;
      expect_refused([&] { single(q, 1, search); }, "max_leaves is 0");
      const Matrix<float> queries = uniform_rows<float>(600, 5);
      expect_refused([&] { index.nearest(queries.view(), 7, {}, std::span(out).first(4199), 1); },
                     "out holds 4199 answers");
      expect_refused([&] { index.nearest(queries.view(), std::size_t{1} << 63, {}, out, 1); },
                     "out holds 4200");
      expect_refused([&] { index.nearest(queries.view(), 1, {}, out, 0); }, "threads is 0");
      const RowsView<float> overlapping(queries.scalars.data(), 600, 5, 4);
      expect_refused([&] { index.nearest(overlapping, 1, {}, out, 1); }, "stride of the queries is 4");
      if (n > 0)
        expect_refused([&] { index.nearest(q, 7, {}, std::span(out).first(6), work); },
                       "out holds 6 answers");
    });
  }
}

TEST(RowRefusals, RowsThatAreNotFinite) {
  for (const float bad : {nan, inf, -inf})
    for (const std::size_t at : {0, 250, 499}) {
      Matrix<float> m = uniform_rows<float>(500, 9);
      m.row(at)[8] = bad;
      const std::string words = "row " + std::to_string(at) + " has a coordinate that is not finite";
      expect_refused([&] { all_indices<float>(m.view(), 8); }, words);
      expect_refused([&] { KdTree<Rows<float>>{m.view()}; }, words);
      expect_refused([&] { BspTree<Rows<float>>{m.view()}; }, words);
      expect_refused([&] { Forest<Rows<float>>{m.view()}; }, words);
    }
}

TEST(RowRefusals, DroppedRowsAreCountedAndIdsStay) {
  Matrix<float> m = uniform_rows<float>(500, 6);
  for (std::size_t i = 0; i < m.rows; i += 7) m.row(i)[i % 6] = i % 2 ? nan : inf;
  for_each_index<float>(
      m.view(),
      [&](const auto& index) {
        EXPECT_EQ(index.stats().dropped, 72u);
        EXPECT_EQ(index.size(), 428u);
        for (std::size_t i = 0; i < m.rows; ++i) {
          if (i % 7 == 0) continue;
          EXPECT_EQ(index.nearest(std::as_const(m).row(i), 1)[0], (Neighbor<float>{0.f, static_cast<Id>(i)}));
        }
        EXPECT_EQ(index.nearest(std::as_const(m).row(1), 1000).size(), 428u);
      },
      8, NonFinite::drop);
}

TEST(RowRefusals, ShapesAndOptions) {
  const Matrix<float> m = uniform_rows<float>(10, 5);
  const float* const data = m.scalars.data();
  using Tree = KdTree<Rows<float>>;
  expect_refused([&] { Tree{RowsView<float>(data, 10, 0)}; }, "rows have 0 columns");
  expect_refused([&] { Tree{RowsView<float>()}; }, "rows have 0 columns");
  expect_refused([&] { Tree{RowsView<float>(data, 10, 5, 4)}; }, "stride is 4");
  expect_refused([&] { Tree{RowsView<float>(data, 1, std::size_t{1} << 20)}; }, "rows have 1048576 columns");
  expect_refused([&] { Tree{RowsView<float>(data, std::size_t{1} << 33, 5)}; }, "8589934592 rows");
  KdRowOptions kd;
  kd.leaf_size = 0;
  expect_refused([&] { Tree(m.view(), kd); }, "leaf_size is 0");
  BspRowOptions bsp;
  for (const double overlap : {-0.1, 1.0, std::nan("")}) {
    bsp.overlap = overlap;
    expect_refused([&] { BspTree<Rows<float>>(m.view(), bsp); }, "overlap is ");
  }
  bsp.overlap = 0, bsp.projections = 0;
  expect_refused([&] { BspTree<Rows<float>>(m.view(), bsp); }, "projections is 0");
  ForestRowOptions forest;
  forest.trees = 0;
  expect_refused([&] { Forest<Rows<float>>(m.view(), forest); }, "trees is 0");
  forest.trees = 1, forest.choices = 0;
  expect_refused([&] { Forest<Rows<float>>(m.view(), forest); }, "choices is 0");
}

}  // namespace
}  // namespace treeline::accel::test
