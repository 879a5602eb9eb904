// The wide tree over points in double prunes by boxes of floats: that these are bounds, that answers are
// those of brute force bit for bit where float alone knows nothing, and that it does not visit more for it.
#include <numeric>

#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

using Vd = geometry::Vec<double, 3>;
using P = Points<double, 3>;
using WideTree = Bvh<P, accel::Wide>;
using Found = Neighbor<double>;
using Cloud = Vecs<double, 3>;

Cloud mapped(Cloud points, auto f) {
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = f(points[i], i);
  return points;
}

/// Places of 1 to 300 around five cities on a planet: float tells points of none of them apart.
Cloud cities(std::size_t n) {
  return mapped(uniform_cloud<double, 3>(n), [](Vd p, std::size_t i) {
    const auto city = static_cast<double>(i % 5);
    return Vd{p[0] * 300 + 4e6 + 1e6 * city, p[1] * 300 + 3e6 - 4e5 * city * city, p[2] * 20 + 1e5 * city};
  });
}

std::vector<NamedCloud<double, 3>> far_clouds(std::size_t n) {
  const Cloud even = uniform_cloud<double, 3>(n);
  std::vector<NamedCloud<double, 3>> all;
  const auto add = [&](const char* name, auto f) { all.push_back({name, mapped(even, f)}); };
  add("1e6 away", [](Vd p, std::size_t) { return p * 1e-3 + Vd::filled(1e6); });
  add("1e9 away", [](Vd p, std::size_t) { return p * 1e-4 + Vd{1e9, -1e9, 1e9}; });
  add("at the last digits", [](Vd p, std::size_t) { return p * 1e-6 + Vd::filled(1e9); });
  add("1e-200", [](Vd p, std::size_t) { return p * 1e-200; });
  add("1e200", [](Vd p, std::size_t) { return p * 1e200 + Vd::filled(1e200); });
  add("one at 1e30", [](Vd p, std::size_t i) { return i == 77 ? Vd{1e30, -1e30, 1e30} : p; });
  add("one at 1e300", [](Vd p, std::size_t i) { return i == 77 ? Vd{1e300, 0, 0} : p; });
  add("two scales", [](Vd p, std::size_t i) { return i % 2 ? p * 1e-9 + Vd::filled(0.5) : p; });
  add("float ties", [](Vd p, std::size_t i) { return Vd::filled(0.5) + p * (i % 3 ? 1e-8 : 1.0); });
  add("lump", [](Vd p, std::size_t i) { return i % 2 ? Vd{0.3, 0.4, 0.5} : p; });
  add("thirds", [](Vd p, std::size_t) {  // ties, at places that no float holds
    for (double& x : p.v) x = std::floor(x * 12) / 3 + 1e5;
    return p;
  });
  all.push_back({"cities", cities(n)});
  return all;
}

/// In, on, around and far off the cloud, and between its points and the floats beside them.
Cloud far_queries(const Cloud& points) {
  Cloud queries = queries_for(points, 6);
  const std::size_t near = queries.size();
  for (std::size_t i = 1; i < near; i += 3)
    for (const double step : {1e-12, 1e-7, 1.0, 1e5, 1e12})
      queries.push_back(queries[i] + Vd{step, -step, step / 3} * (1 + std::abs(queries[i][0])));
  return queries;
}

// Not only for ordinary clouds (points_exact.cpp has those): every query, bit for bit.
TEST(PointDouble, AnswersAreThoseOfBruteForce) {
  for (const auto& cloud : far_clouds(3000)) {
    SCOPED_TRACE(cloud.name);
    const BruteForce<P> brute(cloud.points);
    for (const auto split : {WidePointOptions::Split::rank, WidePointOptions::Split::perimeter}) {
      const WideTree tree(cloud.points, {.split = split});
      const Cloud queries = far_queries(cloud.points);
      for (const std::size_t k : {1, 7, 16, 30, 60, 200}) {
        std::vector<Found> mine(k), theirs(k), batch(k * queries.size());
        tree.nearest(queries, k, std::span(batch));
        for (std::size_t i = 0; i < queries.size(); ++i) {
          tree.nearest(queries[i], k, mine), brute.nearest(queries[i], k, theirs);
          ASSERT_EQ(mine, theirs) << "query " << i;
          ASSERT_TRUE(std::ranges::equal(std::span(batch).subspan(i * k, k), theirs)) << "query " << i;
        }
      }
      for (const Vd& q : queries) {
        std::vector<Found> near(40), mine, theirs, few(9), their_few(9);
        brute.nearest(q, near.size(), near);
        for (const std::size_t rank : {0, 5, 39}) {
          const double square = near[rank].distance2, radius = std::sqrt(square);
          tree.within(q, radius, WithinOptions{.sorted = true}, mine);
          brute.within(q, radius, WithinOptions{.sorted = true}, theirs);
          ASSERT_EQ(mine, theirs);
          ASSERT_EQ(tree.count_within(q, radius), theirs.size());
          tree.within_squared(q, square, mine), brute.within_squared(q, square, theirs);
          std::sort(mine.begin(), mine.end()), std::sort(theirs.begin(), theirs.end());
          ASSERT_EQ(mine, theirs);
          const NearestOptions<double> options{.max_distance = radius};
          const std::size_t n = tree.nearest(q, 9, options, few);
          ASSERT_EQ(n, brute.nearest(q, 9, options, their_few));
          few.resize(n), their_few.resize(n);
          ASSERT_EQ(few, their_few);
          few.resize(9), their_few.resize(9);
          std::vector<Id> in, their_in;
          WideTree::Box box;
          box.grow(q), box.grow(cloud.points[near[rank].id]);  // a point on its corner
          tree.inside(box, in), brute.inside(box, their_in);
          std::sort(in.begin(), in.end()), std::sort(their_in.begin(), their_in.end());
          ASSERT_EQ(in, their_in);
        }
      }
      std::vector<Found> all(3 * cloud.points.size()), their_all(all.size());
      tree.nearest_of_all(3, all, 2), brute.nearest_of_all(3, their_all, 2);
      ASSERT_EQ(all, their_all);
    }
  }
}

/// Points tested per query for its 8 nearest.
double tested(const Cloud& points, const Cloud& queries) {
  const WideTree tree(points);
  Work work;
  std::vector<Found> out(8);
  for (const Vd& q : queries) tree.nearest(q, 8, out, work);
  return static_cast<double>(work.primitives) / static_cast<double>(queries.size());
}
Cloud every(const Cloud& points, std::size_t step) {
  Cloud some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

// Moving a cloud away, scaling it, or adding an outlier changes next to nothing of what is visited. Parts
// that float cannot tell apart cost no more than parts that it can.
TEST(PointDouble, VisitsDoNotDependOnWhereTheCloudIs) {
  constexpr std::size_t n = 40000;
  const Cloud even = uniform_cloud<double, 3>(n), at = every(even, 97);
  const double plain = tested(even, at);
  EXPECT_LT(plain, 130);
  const auto moved = [&](auto f) { return tested(mapped(even, f), mapped(at, f)); };
  EXPECT_NEAR(moved([](Vd p, std::size_t) { return p * 1e-3 + Vd::filled(1e9); }), plain, 0.1 * plain);
  EXPECT_NEAR(moved([](Vd p, std::size_t) { return p * 1e-200; }), plain, 0.1 * plain);
  EXPECT_NEAR(moved([](Vd p, std::size_t) { return p * 1e200; }), plain, 0.1 * plain);
  Cloud outlier = even;
  outlier[5] = {1e30, -1e30, 1e30};
  EXPECT_NEAR(tested(outlier, at), plain, 0.1 * plain);
  const Cloud places = cities(n);
  EXPECT_LT(tested(places, every(places, 97)), 1.5 * plain);
  // From afar the cloud's near side is all there is to see, in double as near by.
  Cloud afar;
  for (const Vd& q : every(even, 97)) afar.push_back(q + Vd{2e7, 1e7, 3e7});
  EXPECT_LT(tested(even, afar), 20 * plain);
}

// Against floats rounded outward, for boxes and queries anywhere: what node_limit makes of a point's squared
// distance is never below what distances() makes of its box; what is said to lie within does.
TEST(PointDouble, FloatBoundsAreBounds) {
  geometry::Pcg32 random(5);
  const Cloud points = mapped(uniform_cloud<double, 3>(5000), [&](Vd p, std::size_t i) {
    return p * std::ldexp(1.0, -static_cast<int>(i % 40)) + Vd::filled(i % 2 ? 1000.0 / 3 : 0.0);
  });
  const PointSet<double, 3> set(points, {});
  const auto tree = wide::built(set, false, 1);
  std::size_t tight = 0, contained = 0, coarse = 0, trials = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t leaf = random.below(static_cast<std::uint32_t>(tree.leaves.size()));
    const int lane = static_cast<int>(random.below(4));
    const wide::Leaf<3, double>& of = tree.leaves[leaf];
    const Vd p{of.x[0][lane], of.x[1][lane], of.x[2][lane]};
    const auto direction = normalized(uniform_point<double, 3>(random, -1, 1));
    const Vd q = p + direction * std::ldexp(1.0, static_cast<int>(random.below(60)) - 45);
    const auto place = wide::placed(tree, q);
    const auto query = wide::query_of(tree, place);
    const double distance2 = squared_distance(p, q);
    for (int l = 1; l <= tree.top; ++l) {
      const std::size_t child = leaf >> (4 * (l - 1));
      const wide::Node<3>& node = tree.level(l)[child / 16];
      alignas(64) float d[16], far[16];
      wide::distances(node, query).store(d), wide::farthest(node, query).store(far);
      ASSERT_LE(d[child % 16], query.node_limit(distance2)) << "trial " << i << ", level " << l;
      if (!place.coarse) {
        const double exact = squared_distance(wide::child_box(tree, l, child), q);
        tight += d[child % 16] >= query.node_limit(exact) * 0.999f;
        if (far[child % 16] <= query.inner_limit(distance2 * 2)) {
          ++contained;
          ASSERT_LE(distance2, distance2 * 2);
          for (std::size_t j = 0; l == 1 && j < 16 && of.id[j] != no_id; ++j)
            ASSERT_LE(squared_distance(Vd{of.x[0][j], of.x[1][j], of.x[2][j]}, q), distance2 * 2);
        }
      }
      coarse += place.coarse, ++trials;
    }
  }
  // All of it happened, or this test tested nothing.
  EXPECT_GT(tight, trials / 8);
  EXPECT_GT(contained, trials / 20);
  EXPECT_GT(coarse, trials / 20);
}

TEST(PointDouble, RoundingIsOutwardAndTight) {
  geometry::Pcg32 random(8);
  std::vector<double> values{0.0,   -0.0,  1.0, 0x1p-149, 0x1p-127, 0x1p127, 0x1.fffffffffffffp126,
                             1e300, 5e-324};
  for (int i = 0; i < 20000; ++i)
    values.push_back((1 + random.uniform()) * std::ldexp(1.0, static_cast<int>(random.below(400)) - 200));
  for (const double value : values)
    for (const double x : {value, -value}) {
      const float below = wide::float_below(x), above = wide::float_above(x);
      ASSERT_LT(static_cast<double>(below), x);
      ASSERT_GT(static_cast<double>(above), x);
      if (std::abs(x) < 0x1p127) {
        const double width = static_cast<double>(above) - static_cast<double>(below);
        ASSERT_LE(width, std::abs(x) * 0x1p-21 + 0x1p-124);
      }
    }
}

// Nobody reads the points of subtrees that lie inside: their leaves count as nodes, which are read, and not
// as points tested; a count reads not even those.
TEST(PointDouble, WhatLiesInsideIsReadButNotTested) {
  const auto check = [&]<class T>(T) {
    const auto points = uniform_cloud<T, 3>(4096);
    const Bvh<Points<T, 3>, accel::Wide> tree(points);
    Work all, half;
    std::vector<Id> ids;
    tree.inside({geometry::Vec<T, 3>::filled(T(-1)), geometry::Vec<T, 3>::filled(T(2))}, ids, all);
    EXPECT_EQ(ids.size(), points.size());
    // Clipped to the cloud's own box: what rounding leaves open on its sides is tested.
    EXPECT_LE(all.primitives, sizeof(T) == 4 ? 0u : 256 * 16u);
    EXPECT_GE(all.nodes, 256u + 1u);
    EXPECT_LE(all.nodes, 256u + 17u);
    tree.inside({geometry::Vec<T, 3>::filled(T(0.25)), geometry::Vec<T, 3>::filled(T(0.75))}, ids, half);
    EXPECT_LT(half.primitives, points.size());
    EXPECT_GE(half.nodes * 16, ids.size());  // every leaf that gave an id was counted
  };
  check(0.0f), check(0.0);
}

}  // namespace
}  // namespace treeline::accel::test
