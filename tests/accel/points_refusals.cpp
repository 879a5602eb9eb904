// Input that has no answer is refused by name and index; input that has one is not.
#include "accel/bsp_tree/points.hpp"
#include "accel/bvh/points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
using V = geometry::Vec<T, 3>;
template <class T>
inline constexpr T nan = std::numeric_limits<T>::quiet_NaN();
template <class T>
inline constexpr T inf = std::numeric_limits<T>::infinity();

template <class F>
void expect_refused(F&& f, const std::string& what) {
  try {
    f();
    ADD_FAILURE() << "not refused; expected: " << what;
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
  }
}

template <class T>
void expect_queries_refused() {
  const auto points = uniform_cloud<T, 3>(600);
  for (const std::size_t n : {0, 600})
    for_each_tree<T, 3>(
        {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n)},
        [&](const std::string&, const auto& tree) {
          std::vector<Neighbor<T>> out(4000);
          std::vector<Id> ids;
          Lists<Neighbor<T>> lists;
          Lists<Id> id_lists;
          const V<T> q{};
          expect_refused([&] { tree.nearest(q, 0, out); }, "k is 0");
          expect_refused([&] { tree.nearest(points, 0, out, 1); }, "k is 0");
          for (const T bad : {nan<T>, inf<T>, -inf<T>}) {
            for (int axis = 0; axis < 3; ++axis) {
              V<T> p{};
              p[axis] = bad;
              expect_refused([&] { tree.nearest(p, 1, out); }, "query has a coordinate that is not finite");
              expect_refused([&] { tree.within(p, T(1), out); }, "query has a coordinate that is not finite");
            }
            auto queries = points;
            queries[417][1] = bad;
            for (const int threads : {1, 2}) {
              expect_refused([&] { tree.nearest(queries, 1, out, threads); }, "query 417 ");
              expect_refused([&] { tree.within(queries, T(1), lists, threads); }, "query 417 ");
            }
          }
          for (const T radius : {T(-1), T(-1e-30), nan<T>, -inf<T>}) {
            expect_refused([&] { tree.within(q, radius, out); }, "radius is ");
            expect_refused([&] { tree.within(points, radius, lists, 1); }, "radius is ");
          }
          geometry::Box<T, 3> box{{0, 0, 0}, {1, nan<T>, 1}};
          expect_refused([&] { tree.inside(box, ids); }, "box has a bound that is not a number");
          std::vector<geometry::Box<T, 3>> boxes(500);
          boxes[499] = box;
          expect_refused([&] { tree.inside(boxes, id_lists, 2); }, "box 499 ");
          expect_refused([&] { tree.nearest(points, 1, out, 0); }, "threads is 0");
          expect_refused([&] { tree.within(points, T(1), lists, -1); }, "threads is -1");
          expect_refused([&] { tree.inside(boxes, id_lists, 0); }, "box 499 ");
          std::vector<Neighbor<T>> short_out(600 * 7 - 1);
          expect_refused([&] { tree.nearest(points, 7, short_out, 1); },
                         "out holds 4199 answers; it must hold 4200");
          // A number of answers that wraps around to 0 or to little.
          for (const std::size_t k : {std::size_t{1} << 63, (std::size_t{1} << 63) + 1})
            expect_refused([&] { tree.nearest(std::span(points).first(2), k, short_out, 1); },
                           "out holds 4199 answers; it must hold 922337203685477580");
          if (n > 0)
            expect_refused([&] { tree.nearest(q, 7, std::span(out).first(6)); }, "out holds 6 answers");
          expect_refused([&] { tree.slice(3, 0.5); }, "slice axis is 3");
          expect_refused([&] { tree.slice(0, static_cast<double>(nan<T>)); }, "slice offset");

          // These have an answer.
          EXPECT_EQ(tree.nearest(q, 1000, std::span(out).first(n)),
                    n);  // room for all there are is room enough
          tree.within(q, T(-0.), out);
          EXPECT_TRUE(out.empty());
        });
}
TEST(PointRefusals, QueriesWithoutAnAnswer) {
  expect_queries_refused<float>();
  expect_queries_refused<double>();
}

template <class T>
void expect_points_refused() {
  for (const T bad : {nan<T>, inf<T>, -inf<T>})
    for (const std::size_t at : {0, 250, 499}) {
      auto points = uniform_cloud<T, 3>(500);
      points[at][2] = bad;
      expect_refused([&] { for_each_tree<T, 3>(points, [](const std::string&, const auto&) {}); },
                     "point " + std::to_string(at) + " ");
      using P = Points<T, 3>;
      expect_refused([&] { KdTree<P>{points}; }, "point " + std::to_string(at) + " ");
      expect_refused([&] { BspTree<P>{points}; }, "point " + std::to_string(at) + " ");
      expect_refused([&] { Bvh<P>{points}; }, "point " + std::to_string(at) + " ");
    }
}
TEST(PointRefusals, PointsThatAreNotFinite) {
  expect_points_refused<float>();
  expect_points_refused<double>();
}

template <class T>
void expect_points_dropped() {
  auto points = uniform_cloud<T, 3>(500);
  for (std::size_t i = 0; i < points.size(); i += 7)
    points[i][static_cast<int>(i % 3)] = i % 2 ? nan<T> : inf<T>;
  const std::size_t dropped = (points.size() + 6) / 7;
  for_each_tree<T, 3>(
      points,
      [&](const std::string&, const auto& tree) {
        EXPECT_EQ(tree.size(), points.size() - dropped);
        EXPECT_EQ(tree.stats().dropped, dropped);
        for (std::size_t i = 0; i < points.size(); ++i) {
          if (i % 7 == 0) continue;
          std::vector<Neighbor<T>> out(1);
          tree.nearest(points[i], 1, out);
          EXPECT_EQ(out[0], (Neighbor<T>{T(0), static_cast<Id>(i)}));
        }
        std::vector<Neighbor<T>> all;
        tree.within(V<T>{}, inf<T>, all);
        EXPECT_EQ(all.size(), tree.size());
      },
      8, NonFinite::drop);
}
TEST(PointRefusals, DroppedPointsAreCountedAndIdsStay) {
  expect_points_dropped<float>();
  expect_points_dropped<double>();
}

TEST(PointRefusals, OptionsOutOfRange) {
  const auto points = uniform_cloud<float, 3>(10);
  using P = Points<float, 3>;
  KdPointOptions kd;
  kd.leaf_size = 0;
  expect_refused([&] { KdTree<P>(points, kd); }, "leaf_size is 0");
  BspPointOptions bsp;
  bsp.projections = 0;
  expect_refused([&] { BspTree<P>(points, bsp); }, "projections is 0");
}

}  // namespace
}  // namespace treeline::accel::test
