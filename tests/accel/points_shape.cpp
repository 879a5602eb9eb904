// What trees tell of themselves: statistics, pictures, and the work of queries on clouds made to be hard.
#include <map>

#include "accel/brute_force/points.hpp"
#include "accel/bsp_tree/points.hpp"
#include "accel/bvh/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "accel/slice.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
void expect_statistics_agree() {
  for (const auto& cloud : clouds<T, 3>())
    for (const int leaf_size : {1, 8}) {
      SCOPED_TRACE(cloud.name);
      for_each_tree<T, 3>(
          cloud.points,
          [&](const std::string& name, const auto& tree) {
            const TreeStats s = tree.stats();
            EXPECT_EQ(s.primitives, cloud.points.size());
            if (name.starts_with("bsp spill"))
              EXPECT_GE(s.references, cloud.points.size());
            else
              EXPECT_EQ(s.references, cloud.points.size());
            EXPECT_EQ(tree.size(), cloud.points.size());
            EXPECT_EQ(tree.bytes(), s.bytes);
            EXPECT_GE(s.bytes, cloud.points.size() * sizeof(geometry::Vec<T, 3>));
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
TEST(PointShape, StatisticsAgreeWithEachOther) {
  expect_statistics_agree<float>();
  expect_statistics_agree<double>();
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
    // Outlines are in double: far off they lose the digits that areas need, and tiny areas vanish.
    if (sizeof(T) == 8 && (cloud.name == "far from the origin" || cloud.name == "tiny")) continue;
    SCOPED_TRACE(cloud.name);
    geometry::Box<T, D> box;
    for (const auto& p : cloud.points) box.grow(p);
    for_each_tree<T, D>(cloud.points, [&](const std::string& name, const auto& tree) {
      const bool balls = name.ends_with("balls");
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
            if (balls) continue;
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
            if (share == 0.31 && !balls) {
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
TEST(PointShape, SlicesTileTheBoxInDouble3) { expect_slices_tile<double, 3>(); }
TEST(PointShape, SlicesOfNothingAreEmpty) {
  for_each_tree<float, 3>(
      {}, [](const std::string&, const auto& tree) { EXPECT_TRUE(tree.slice(1, 0).empty()); });
}

// Many equal points neither deepen a tree nor make it slow: alone, or as a lump in a cloud.
template <class T>
void expect_equal_points_cost_little() {
  using V = geometry::Vec<T, 3>;
  Vecs<T, 3> equal(100000, {T(0.3), T(0.4), T(0.5)});
  Vecs<T, 3> lump = uniform_cloud<T, 3>(20000);
  lump.insert(lump.end(), equal.begin(), equal.end());
  for (const auto& points : {equal, lump})
    for_each_tree<T, 3>(points, [&](const std::string& name, const auto& tree) {
      if (name == "brute force") return;
      EXPECT_LE(tree.stats().depth, 40u);
      if (points.size() == equal.size() && !name.starts_with("bvh wide")) {
        EXPECT_EQ(tree.stats().largest_leaf, equal.size());
      }
      for (const V& q : {equal[0], V{T(0.31), T(0.41), T(0.52)}, V{T(0.301), T(0.4), T(0.5)},
                         V{T(0.2), T(0.45), T(0.5)}}) {
        Work work;
        std::vector<Neighbor<T>> out(8);
        ASSERT_EQ(tree.nearest(q, 8, out, work), 8u);
        EXPECT_LT(work.primitives, 1500u);
        EXPECT_LT(work.nodes, 1500u);
      }
    });
}
TEST(PointShape, EqualPointsCostLittle) {
  expect_equal_points_cost_little<float>();
  expect_equal_points_cost_little<double>();
}

// A million of them on the wide tree: a descent and a leaf or two, exact or hasty, at the points or off them.
template <class T>
void expect_a_million_equal_points_cost_little() {
  using V = geometry::Vec<T, 3>;
  const Vecs<T, 3> equal(1000000, {T(0.3), T(0.4), T(0.5)});
  const Bvh<Points<T, 3>, accel::Wide> tree(equal);
  for (const V& q :
       {equal[0], V{T(0.31), T(0.41), T(0.52)}, V{T(0.2), T(0.45), T(0.5)}, V{T(1e6), T(0), T(0)}})
    for (const auto& options : {NearestOptions<T>{}, NearestOptions<T>{.epsilon = 0.5}}) {
      Work work;
      std::vector<Neighbor<T>> out(8);
      ASSERT_EQ(tree.nearest(q, 8, options, out, work), 8u);
      for (std::size_t i = 0; i < 8; ++i) ASSERT_EQ(out[i].id, i);  // ties: the lowest come first
      EXPECT_LE(work.primitives, 4 * 16u);
      EXPECT_LE(work.nodes, 16u);
    }
}
TEST(PointShape, AMillionEqualPointsCostLittle) {
  expect_a_million_equal_points_cost_little<float>();
  expect_a_million_equal_points_cost_little<double>();
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

// Queries and points in line with the centre, where the bound is tight, at every size from below one rounding
// of the coordinates to far beyond them: whatever of it is rounded, it is no more than any distance compared.
template <class T, int D>
void expect_ball_bounds() {
  geometry::Pcg32 random(3);
  std::size_t tight = 0, trials = 200000;
  for (std::size_t i = 0; i < trials; ++i) {
    const T size = std::ldexp(T(1), static_cast<int>(random.below(30)) - 20);
    const auto direction = normalized(uniform_point<T, D>(random, T(-1), T(1)));
    Vecs<T, D> points{uniform_point<T, D>(random)};
    points.push_back(points[0] + direction * size);
    const PointSet<T, D> set(points, {});
    const auto ball = ball_of(set, 0, 2, set.box);
    const auto q = points[1] + direction * (size * std::ldexp(T(1), static_cast<int>(random.below(20)) - 10));
    const T bound = squared_distance(ball, q), least = squared_distance(points[1], q);
    ASSERT_LE(bound, least) << "trial " << i;
    tight += bound > least * T(0.999);
    geometry::Box<T, D> box;
    box.grow(points[i % 2]);
    ASSERT_TRUE(ball.overlaps(box)) << "trial " << i;
  }
  EXPECT_GT(tight, trials / 8);
}
TEST(PointShape, ABallBoundsAllDistancesToItInFloat3) { expect_ball_bounds<float, 3>(); }
TEST(PointShape, ABallBoundsAllDistancesToItInDouble2) { expect_ball_bounds<double, 2>(); }

// A node with a box or ball beyond what it holds as planes is told so in bytes.
TEST(PointShape, BoundsCostTheBytesTheySay) {
  const auto points = uniform_cloud<float, 3>(4096);  // 256 leaves of 16, 255 inner nodes
  using P = Points<float, 3>;
  const auto bytes = [&]<class Tree, class Bounds>(std::type_identity<Tree>, Bounds bounds) {
    typename Tree::Options options;
    options.leaf_size = 16, options.bounds = bounds;
    if constexpr (requires { Tree::Options::Split::median; }) options.split = Tree::Options::Split::median;
    const Tree tree(points, options);
    EXPECT_EQ(tree.stats().leaves, 256u);
    return tree.bytes();
  };
  using Kd = KdPointOptions::Bounds;
  using Bsp = BspPointOptions::Bounds;
  using Balls = BvhPointOptions::Bounds;
  const std::type_identity<KdTree<P>> kd;
  const std::type_identity<BspTree<P>> bsp;
  const std::type_identity<Bvh<P>> bvh;
  EXPECT_EQ(bytes(kd, Kd::tight_box) - bytes(kd, Kd::planes), 511u * 24);
  EXPECT_EQ(bytes(bsp, Bsp::box_and_plane) - bytes(bsp, Bsp::planes), 511u * 24);
  EXPECT_EQ(bytes(bvh, Balls::box) - bytes(bvh, Balls::ball), 255u * 16);
}

/// Points tested per query for its 8 nearest, by the tree's name, with leaves of 16.
std::map<std::string, double> points_tested(const Vecs<float, 3>& points, const Vecs<float, 3>& queries) {
  std::map<std::string, double> tested;
  for_each_tree<float, 3>(
      points,
      [&](const std::string& name, const auto& tree) {
        Work work;
        std::vector<Neighbor<float>> out(8);
        for (const auto& q : queries) tree.nearest(q, 8, out, work);
        tested[name] = static_cast<double>(work.primitives) / static_cast<double>(queries.size());
      },
      16);
  return tested;
}

// Same splits, same leaves: only the bound differs. In a filled cube it matters little. Seen from off a
// surface, planes alone let a query into ten times as many leaves, or more; the nodes that slide to keep
// cells fat suffer less.
TEST(PointShape, PlanesBoundBadlyOffASurface) {
  auto cube = uniform_cloud<float, 3>(40000);
  const auto queries = uniform_cloud<float, 3>(200, 9);
  const auto even = points_tested(cube, queries);
  EXPECT_LT(even.at("kd median"), 1.5 * even.at("kd median, boxes"));
  EXPECT_LT(even.at("bsp principal axis"), 2.5 * even.at("bsp principal axis, boxes"));
  EXPECT_LT(even.at("bvh rank, balls"), 1.5 * even.at("bvh rank"));

  for (auto& p : cube) p[2] = 0.5f + 0.2f * std::sin(6 * p[0]) * std::cos(5 * p[1]);
  const auto hills = points_tested(cube, queries);
  EXPECT_GT(hills.at("kd median"), 8 * hills.at("kd median, boxes"));
  EXPECT_GT(hills.at("bsp principal axis"), 8 * hills.at("bsp principal axis, boxes"));
  EXPECT_GT(hills.at("bsp random projection"), 8 * hills.at("bsp random projection, boxes"));
  EXPECT_GT(hills.at("kd median"), 3 * hills.at("kd sliding midpoint"));
  EXPECT_GT(hills.at("bvh rank, balls"), hills.at("bvh rank"));
  EXPECT_GT(hills.at("kd median"), 3 * hills.at("bvh rank, balls"));
  // A node's box is a box, whichever tree it is in.
  EXPECT_DOUBLE_EQ(hills.at("kd median, boxes"), hills.at("bvh rank"));
}

}  // namespace
}  // namespace treeline::accel::test
