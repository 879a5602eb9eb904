// Batches say what single queries say, in order, whatever the number of threads.
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T, int D>
void expect_batches_equal_singles() {
  const auto points = uniform_cloud<T, D>(3000);
  const auto queries = uniform_cloud<T, D>(1000, 5);  // several chunks, the last one short
  const T radius = D == 2 ? T(0.04) : T(0.1);
  std::vector<geometry::Box<T, D>> boxes(queries.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].grow(queries[i]);
    boxes[i].grow(queries[i] + geometry::Vec<T, D>::filled(i % 3 == 0 ? T(0) : T(0.1)));
  }
  for_each_tree<T, D>(points, [&](const std::string&, const auto& tree) {
    for (const int threads : {1, 2, 5}) {
      SCOPED_TRACE(threads);
      constexpr std::size_t k = 4;
      std::vector<Neighbor<T>> batch(queries.size() * k), single(k);
      tree.nearest(queries, k, batch, threads);
      Lists<Neighbor<T>> near;
      Lists<Id> in;
      near.items.resize(3), near.offsets = {0, 3};  // of an earlier batch
      tree.within(queries, radius, near, threads);
      tree.inside(boxes, in, threads);
      ASSERT_EQ(near.size(), queries.size());
      ASSERT_EQ(in.size(), boxes.size());
      std::vector<Neighbor<T>> list;
      std::vector<Id> ids;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        tree.nearest(queries[i], k, single);
        ASSERT_TRUE(std::ranges::equal(single, std::span(batch).subspan(i * k, k))) << "query " << i;
        tree.within(queries[i], radius, list);
        ASSERT_TRUE(std::ranges::equal(list, near[i])) << "query " << i;
        tree.inside(boxes[i], ids);
        ASSERT_TRUE(std::ranges::equal(ids, in[i])) << "box " << i;
      }
    }
  });
}

TEST(PointBatches, EqualSingleQueriesInFloat3) { expect_batches_equal_singles<float, 3>(); }
TEST(PointBatches, EqualSingleQueriesInDouble2) { expect_batches_equal_singles<double, 2>(); }

TEST(PointBatches, PadWhatIsMissing) {
  const auto points = uniform_cloud<float, 3>(3);
  const auto queries = uniform_cloud<float, 3>(700, 2);
  for (const std::size_t n : {0, 3})
    for_each_tree<float, 3>({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n)},
                            [&](const std::string&, const auto& tree) {
                              std::vector<Neighbor<float>> out(queries.size() * 5, {-1.f, 77});
                              tree.nearest(queries, 5, out, 2);
                              for (std::size_t i = 0; i < out.size(); ++i) {
                                ASSERT_EQ(out[i].id == no_id, i % 5 >= n);
                                ASSERT_EQ(std::isinf(out[i].distance2), i % 5 >= n);
                              }
                            });
}

TEST(PointBatches, MayBeEmpty) {
  for_each_tree<float, 3>(uniform_cloud<float, 3>(20), [](const std::string&, const auto& tree) {
    const std::vector<geometry::Vec3f> none;
    std::vector<Neighbor<float>> out;
    tree.nearest(none, 3, out, 2);
    Lists<Neighbor<float>> lists;
    tree.within(none, 1.f, lists, 2);
    EXPECT_EQ(lists.size(), 0u);
    Lists<Id> ids;
    tree.inside(std::span<const geometry::Box3f>(), ids, 2);
    EXPECT_EQ(ids.size(), 0u);
  });
}

}  // namespace
}  // namespace treeline::accel::test
