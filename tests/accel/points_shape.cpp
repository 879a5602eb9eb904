// What trees tell of themselves: statistics, pictures, and the work of queries on clouds made to be hard.
#include "accel/brute_force/points.hpp"
#include "accel/bvh/points.hpp"
#include "accel/kd_tree/points.hpp"
#include "accel/slice.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

TEST(PointShape, StatisticsAgreeWithEachOther) {
  for (const auto& cloud : clouds<float, 3>())
    for (const int leaf_size : {1, 8}) {
      SCOPED_TRACE(cloud.name);
      for_each_tree<float, 3>(
          cloud.points,
          [&](const std::string& name, const auto& tree) {
            const TreeStats s = tree.stats();
            EXPECT_EQ(s.primitives, cloud.points.size());
            EXPECT_EQ(s.references, cloud.points.size());
            EXPECT_EQ(tree.size(), cloud.points.size());
            EXPECT_EQ(tree.bytes(), s.bytes);
            EXPECT_GE(s.bytes, cloud.points.size() * sizeof(geometry::Vec3f));
            EXPECT_LE(s.depth, s.inner_nodes);
            EXPECT_LE(s.primitives, s.leaves * s.largest_leaf);
            if (name.starts_with("bvh wide")) {  // every leaf full but the last, every node but one a level
              EXPECT_EQ(s.leaves, (cloud.points.size() + 15) / 16);
              std::size_t nodes = 0, level = s.leaves;
              while (level > 1) nodes += level = (level + 15) / 16;
              EXPECT_EQ(s.inner_nodes, nodes);
              EXPECT_EQ(s.largest_leaf, std::min<std::size_t>(16, cloud.points.size()));
              return;
            }
            EXPECT_EQ(s.leaves, cloud.points.empty() ? 0 : s.inner_nodes + 1);  // binary
            EXPECT_LE(s.leaves, std::size_t{1} << std::min<std::size_t>(s.depth, 40));
            // Points that can be told apart share a leaf only up to the leaf size.
            std::size_t equal = 0;
            auto sorted = cloud.points;
            std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
              return std::lexicographical_compare(a.v, a.v + 3, b.v, b.v + 3);
            });
            for (std::size_t i = 0, run = 0; i < sorted.size(); ++i)
              equal = std::max(equal, run = i > 0 && sorted[i] == sorted[i - 1] ? run + 1 : 1);
            if (name != "brute force") {
              EXPECT_LE(s.largest_leaf, std::max<std::size_t>(equal, static_cast<std::size_t>(leaf_size)));
            }
          },
          leaf_size);
    }
}

// A perfect tree over the corners of the unit cube, one a leaf: every box and cell is known.
TEST(PointShape, SurfaceAreaCostOfTheCube) {
  Vecs<float, 3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({float(i & 1), float(i >> 1 & 1), float(i >> 2)});
  BvhPointOptions bvh;
  bvh.leaf_size = 1;
  // Children of the root are faces (area 2 of 6), theirs are edges and corners, which no random line meets.
  EXPECT_DOUBLE_EQ((Bvh<Points<float, 3>>(corners, bvh).stats().sah_cost), 1 + 2 * (2.0 / 6));
  KdPointOptions kd;
  kd.leaf_size = 1;
  // Cells halve: 1, then 2 of area 4, 4 of area 2.5, and 8 leaves of area 1.5.
  EXPECT_DOUBLE_EQ((KdTree<Points<float, 3>>(corners, kd).stats().sah_cost),
                   (6 + 2 * 4 + 4 * 2.5 + 8 * 1.5) / 6);
  EXPECT_DOUBLE_EQ((BruteForce<Points<float, 3>>(corners).stats().sah_cost), 8);
}

template <class T, int D>
void expect_slices_tile() {
  for (const auto& cloud : clouds<T, D>()) {
    if (cloud.points.empty()) continue;
    SCOPED_TRACE(cloud.name);
    geometry::Box<T, D> box;
    for (const auto& p : cloud.points) box.grow(p);
    for_each_tree<T, D>(cloud.points, [&](const std::string& name, const auto& tree) {
      for (int axis = 0; axis < (D == 3 ? 3 : 1); ++axis) {
        const int u = D == 3 && axis == 0 ? 1 : 0, v = D == 3 && axis == 2 ? 1 : (D == 3 ? 2 : 1);
        const auto side = [&](int a) {
          return static_cast<double>(box.high[a]) - static_cast<double>(box.low[a]);
        };
        for (const double share : {0.0, 0.31, 0.5, 1.0}) {
          const double at =
              static_cast<double>(box.low[axis]) * (1 - share) + static_cast<double>(box.high[axis]) * share;
          const auto cells = tree.slice(axis, at);
          double sum = 0;
          std::size_t points = 0;
          for (const auto& cell : cells) {
            ASSERT_GE(cell.outline.size(), 3u);
            EXPECT_LE(cell.depth, tree.stats().depth);
            EXPECT_GE(cell.primitives, 1u);
            sum += area(cell.outline), points += cell.primitives;
            for (const auto& p : cell.outline) {
              const double slack = 1e-9 * (1 + std::abs(p[0]) + std::abs(p[1]));
              EXPECT_TRUE(p[0] >= double(box.low[u]) - slack && p[0] <= double(box.high[u]) + slack);
              EXPECT_TRUE(p[1] >= double(box.low[v]) - slack && p[1] <= double(box.high[v]) + slack);
            }
          }
          if (D == 2 && name.starts_with("kd")) {
            EXPECT_EQ(points, tree.size());
          }
          if (name.starts_with("bvh")) {  // boxes leave gaps; where they touch, a cut meets both
            if (share == 0.31) {
              EXPECT_LE(sum, side(u) * side(v) * (1 + 1e-9));
            }
          } else if (std::isfinite(side(u) * side(v))) {
            EXPECT_NEAR(sum, side(u) * side(v), 1e-9 * side(u) * side(v));
          }
        }
      }
      EXPECT_TRUE(D == 2 || tree.slice(0, static_cast<double>(box.low[0]) - 1 -
                                              std::abs(static_cast<double>(box.low[0])))
                                .empty());
    });
  }
}
TEST(PointShape, SlicesTileTheBoxInFloat3) { expect_slices_tile<float, 3>(); }
TEST(PointShape, SlicesTileTheBoxInFloat2) { expect_slices_tile<float, 2>(); }
TEST(PointShape, SlicesOfNothingAreEmpty) {
  for_each_tree<float, 3>(
      {}, [](const std::string&, const auto& tree) { EXPECT_TRUE(tree.slice(1, 0).empty()); });
}

// Many equal points neither deepen a tree nor make it slow: alone, or as a lump in a cloud.
TEST(PointShape, EqualPointsCostLittle) {
  Vecs<float, 3> equal(100000, {0.3f, 0.4f, 0.5f});
  Vecs<float, 3> lump = uniform_cloud<float, 3>(20000);
  lump.insert(lump.end(), equal.begin(), equal.end());
  for (const auto& points : {equal, lump})
    for_each_tree<float, 3>(points, [&](const std::string& name, const auto& tree) {
      if (name == "brute force") return;
      EXPECT_LE(tree.stats().depth, 40u);
      if (points.size() == equal.size() && !name.starts_with("bvh wide")) {
        EXPECT_EQ(tree.stats().largest_leaf, equal.size());
      }
      for (const geometry::Vec3f q :
           {equal[0], {0.31f, 0.41f, 0.52f}, {0.301f, 0.4f, 0.5f}, {0.2f, 0.45f, 0.5f}}) {
        Work work;
        std::vector<Neighbor<float>> out(8);
        ASSERT_EQ(tree.nearest(q, 8, out, work), 8u);
        EXPECT_LT(work.primitives, 1500u);
        EXPECT_LT(work.nodes, 1500u);
      }
    });
}

// Gaps that halve: a midpoint rule alone would make the tree as deep as there are points to peel off.
TEST(PointShape, DepthIsBounded) {
  Vecs<double, 2> points;
  for (int i = 0; i < 2000; ++i)
    points.push_back({std::ldexp(1.0, -i / 2), i % 2 ? std::ldexp(1.0, -i / 2) : 0.0});
  for_each_tree<double, 2>(
      points, [&](const std::string&, const auto& tree) { EXPECT_LE(tree.stats().depth, 16u + 3 * 11u); }, 1);
}

// On an even cloud the work of a query must grow like log n, not like n.
TEST(PointShape, WorkIsLogarithmic) {
  const auto points = uniform_cloud<float, 3>(50000);
  const auto queries = uniform_cloud<float, 3>(200, 9);
  for_each_tree<float, 3>(points, [&](const std::string& name, const auto& tree) {
    Work work;
    std::vector<Neighbor<float>> out(8);
    for (const auto& q : queries) tree.nearest(q, 8, out, work);
    const auto per_query = static_cast<double>(work.primitives) / static_cast<double>(queries.size());
    if (name == "brute force") {
      EXPECT_EQ(per_query, 50000);
    } else {
      EXPECT_LT(per_query, 400);
    }
    EXPECT_GT(work.nodes, 0u);
  });
}

}  // namespace
}  // namespace treeline::accel::test
