// What triangle trees refuse, batches and threads, and what trees tell of themselves: bounds on depth and
// references, areas of slices.
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class TriangleShape : public testing::Test {};
using ShapeTypes =
    testing::Types<BruteForce<Triangles<float>>, BruteForce<Triangles<double>>, Bvh<Triangles<float>>,
                   Bvh<Triangles<double>>, KdTree<Triangles<float>>, KdTree<Triangles<double>>,
                   BspTree<Triangles<float>>, BspTree<Triangles<double>>>;
TYPED_TEST_SUITE(TriangleShape, ShapeTypes);

template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "not refused";
}

TYPED_TEST(TriangleShape, RefusesWhatIsNotFiniteByIndexOrDropsIt) {
  using T = typename TypeParam::Scalar;
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    auto triangles = soup<T>(100, T(0.2), 91);
    triangles[17].b[1] = bad;
    EXPECT_NE(refusal([&] { TypeParam{triangles}; }).find("17"), std::string::npos);
    typename TypeParam::Options options;
    options.non_finite = NonFinite::drop;
    const TypeParam tree(triangles, options);
    EXPECT_EQ(tree.size(), 99u);
    EXPECT_EQ(tree.stats().dropped, 1u);
    const auto& last = triangles[99];
    const auto found = tree.closest_point(last.centroid(), T(1e-3));
    EXPECT_EQ(found.primitive, 99u);  // ids stay those of the input
  }
  Mesh<T> mesh = sphere<T>(1);
  mesh.faces[5][1] = 1000;
  EXPECT_NE(refusal([&] { TypeParam{mesh}; }).find("face 5"), std::string::npos);
  typename TypeParam::Options options;
  options.leaf_size = 0;
  EXPECT_NE(refusal([&] { TypeParam(sphere<T>(1), options); }).find("leaf_size"), std::string::npos);
}

template <class Tree>
concept HasCosts = requires(typename Tree::Options& options) {
  options.step_cost;
};

TYPED_TEST(TriangleShape, RefusesCostsWithoutMeaning) {
  using T = typename TypeParam::Scalar;
  if constexpr (HasCosts<TypeParam>) {
    for (const double cost :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0, 0.0}) {
      typename TypeParam::Options options;
      options.step_cost = cost;
      EXPECT_NE(refusal([&] { TypeParam(sphere<T>(1), options); }).find("step_cost"), std::string::npos);
      if constexpr (requires { options.oblique_cost; }) {
        options = {}, options.oblique_cost = cost;
        EXPECT_NE(refusal([&] { TypeParam(sphere<T>(1), options); }).find("oblique_cost"), std::string::npos);
      }
      if (cost == 0) continue;
      options = {}, options.empty_bonus = cost;
      EXPECT_NE(refusal([&] { TypeParam(sphere<T>(1), options); }).find("empty_bonus"), std::string::npos);
    }
  }
}

// 8000 needles of no area, each across the whole scene: rays must not notice, points do.
TYPED_TEST(TriangleShape, TrianglesOfNoAreaCostRaysNothing) {
  using T = typename TypeParam::Scalar;
  if (std::is_same_v<TypeParam, BruteForce<Triangles<T>>>) GTEST_SKIP() << "too slow";
  const Mesh<T> ball = sphere<T>(4);
  std::vector<Triangle<T>> triangles = triangles_of(ball);
  const std::size_t whole = triangles.size();
  Pcg32 random(151);
  for (int i = 0; i < 8000; ++i) {
    const Vec<T, 3> a = in_cube(random, T(1.5)), b = in_cube(random, T(1.5));
    triangles.push_back(i % 2 ? Triangle<T>{a, b, b} : Triangle<T>{a, a, b});
  }
  const TypeParam tree(triangles), alone(ball);
  EXPECT_EQ(tree.size(), whole);
  EXPECT_EQ(tree.stats().dropped, 8000u);
  EXPECT_EQ(tree.stats().references, alone.stats().references);
  Work with, without;
  for (int i = 0; i < 500; ++i) {
    const Ray<T> ray{in_cube(random, T(2)), in_cube(random, T(1))};
    ASSERT_TRUE(tree.closest_hit(ray, with) == alone.closest_hit(ray, without));
  }
  EXPECT_LT(with.nodes + with.primitives, 2 * (without.nodes + without.primitives));
  EXPECT_EQ(tree.contains({0, 0, 0}), true);
  const auto& needle = triangles.back();
  const auto found = tree.closest_point(needle.a);
  EXPECT_EQ(found.distance2, T(0));
  EXPECT_EQ(found.primitive, triangles.size() - 1);
}

// Moved to where floats are finest, a mesh far away costs what it costs at the origin.
TYPED_TEST(TriangleShape, AMeshFarAwayCostsWhatItCostsAtTheOrigin) {
  using T = typename TypeParam::Scalar;
  if (std::is_same_v<TypeParam, BruteForce<Triangles<T>>>) GTEST_SKIP() << "tests every triangle anyway";
  const auto touched = [](const Vec<T, 3>& centre) {
    const Mesh<T> mesh = sphere<T>(6, centre, T(20));  // 32768 faces, of 0.4
    const TypeParam tree(mesh);
    Work rays, points;
    Pcg32 random(152);
    for (int i = 0; i < 300; ++i) {
      const Vec<T, 3> at = centre + in_cube(random, T(10));
      EXPECT_TRUE(tree.closest_hit({at, in_cube(random, T(1))}, rays));
      (void)tree.closest_point(at, T(1000), points);
    }
    return std::pair(double(rays.nodes + rays.primitives), double(points.nodes + points.primitives));
  };
  const auto [rays, points] = touched({});
  const T far = std::is_same_v<T, float> ? T(1e6) : T(1e14);
  const auto [far_rays, far_points] = touched({far, far * T(4), far / T(2)});
  EXPECT_LT(far_rays, 1.5 * rays);
  EXPECT_LT(far_points, 1.5 * points);
}

TYPED_TEST(TriangleShape, RefusesQueriesWithoutAnswer) {
  using T = typename TypeParam::Scalar;
  const TypeParam tree(sphere<T>(1));
  const T nan = std::numeric_limits<T>::quiet_NaN(), infinity = std::numeric_limits<T>::infinity();
  const Vec<T, 3> x{1, 0, 0};
  for (const Ray<T>& ray : {Ray<T>{{nan, 0, 0}, x}, Ray<T>{{infinity, 0, 0}, x}, Ray<T>{{}, {0, -T(0), 0}},
                            Ray<T>{{}, {nan, 1, 0}}, Ray<T>{{}, {infinity, 1, 0}}, Ray<T>{{}, x, nan, 1},
                            Ray<T>{{}, x, 0, nan}}) {
    EXPECT_THROW((void)tree.closest_hit(ray), InvalidInput);
    EXPECT_THROW((void)tree.any_hit(ray), InvalidInput);
    std::vector<Ray<T>> rays(9, Ray<T>{{}, x});
    rays[6] = ray;
    std::vector<Hit<T>> hits(9);
    EXPECT_NE(refusal([&] { tree.closest_hit(rays, hits, 1); }).find("6"), std::string::npos);
  }
  EXPECT_NO_THROW((void)tree.any_hit({{}, x, -infinity, infinity}));
  EXPECT_THROW((void)tree.closest_point({nan, 0, 0}), InvalidInput);
  EXPECT_THROW((void)tree.closest_point({}, T(-1)), InvalidInput);
  EXPECT_THROW((void)tree.closest_point({}, nan), InvalidInput);
  EXPECT_THROW((void)tree.contains({0, infinity, 0}), InvalidInput);
  EXPECT_THROW((void)tree.slice(3, 0), InvalidInput);
  std::vector<Ray<T>> rays(3, Ray<T>{{}, x});
  std::vector<std::uint8_t> any(2);
  EXPECT_THROW(tree.any_hit(rays, any, 1), InvalidInput);
  any.resize(3);
  EXPECT_THROW(tree.any_hit(rays, any, 0), InvalidInput);
}

TYPED_TEST(TriangleShape, AnswersForNoTriangleAndForOne) {
  using T = typename TypeParam::Scalar;
  const TypeParam none{std::vector<Triangle<T>>{}};
  EXPECT_EQ(none.size(), 0u);
  EXPECT_FALSE(none.closest_hit({{}, {1, 0, 0}}));
  EXPECT_FALSE(none.any_hit({{}, {1, 0, 0}}));
  EXPECT_FALSE(none.closest_point({1, 2, 3}));
  EXPECT_FALSE(none.contains({}));
  EXPECT_TRUE(none.slice(0, 0).empty());
  const TypeParam one{std::vector<Triangle<T>>{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}}};
  EXPECT_EQ(one.closest_hit({{T(0.25), T(0.25), 0}, {0, 0, 1}}).t, T(1));
  EXPECT_EQ(one.closest_point({T(0.25), T(0.25), 3}).distance2, T(4));
  EXPECT_EQ(one.stats().leaves, 1u);
}

TYPED_TEST(TriangleShape, BatchesEqualSingleQueriesOnAnyNumberOfThreads) {
  using T = typename TypeParam::Scalar;
  const TypeParam tree(soup<T>(300, T(0.3), 101));
  Pcg32 random(102);
  std::vector<Ray<T>> rays;
  std::vector<Vec<T, 3>> points;
  for (int i = 0; i < 1500; ++i) {
    rays.push_back({in_cube(random, T(2)), in_cube(random, T(1))});
    points.push_back(in_cube(random, T(2)));
  }
  for (const int threads : {1, 2, 5}) {
    std::vector<Hit<T>> hits(rays.size());
    std::vector<std::uint8_t> any(rays.size()), inside(rays.size());
    std::vector<ClosestPoint<T>> closest(rays.size());
    tree.closest_hit(rays, hits, threads);
    tree.any_hit(rays, any, threads);
    tree.closest_point(points, T(0.5), closest, threads);
    tree.contains(points, inside, threads);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(hits[i] == tree.closest_hit(rays[i]));
      ASSERT_EQ(any[i] != 0, static_cast<bool>(hits[i]));
      const auto single = tree.closest_point(points[i], T(0.5));
      ASSERT_EQ(closest[i].primitive, single.primitive);
      ASSERT_EQ(closest[i].distance2, single.distance2);
      ASSERT_EQ(inside[i] != 0, tree.contains(points[i]));
    }
  }
}

template <class Tree>
class TriangleBuildThreads : public testing::Test {};
using SharedBuilds = testing::Types<KdTree<Triangles<float>>, KdTree<Triangles<double>>,
                                    BspTree<Triangles<float>>, BspTree<Triangles<double>>>;
TYPED_TEST_SUITE(TriangleBuildThreads, SharedBuilds);

TYPED_TEST(TriangleBuildThreads, TheTreeDoesNotDependOnThem) {
  using T = typename TypeParam::Scalar;
  auto triangles = soup<T>(20'000, T(0.02), 103);  // several subtrees' worth
  // Many events of one place, whose order a sort is free to choose.
  for (std::size_t i = 0; i < triangles.size(); i += 2)
    triangles[i].a[2] = triangles[i].b[2] = triangles[i].c[2] = std::round(triangles[i].a[2] * 8) / 8;
  typename TypeParam::Options options;
  const TypeParam alone(triangles, options);
  Pcg32 random(104);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const TypeParam shared(triangles, options);
    const TreeStats a = alone.stats(), b = shared.stats();
    EXPECT_EQ(a.references, b.references);
    EXPECT_EQ(a.inner_nodes, b.inner_nodes);
    EXPECT_EQ(a.oblique_nodes, b.oblique_nodes);
    EXPECT_EQ(a.leaves, b.leaves);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.largest_leaf, b.largest_leaf);
    EXPECT_EQ(a.sah_cost, b.sah_cost);
    EXPECT_EQ(a.bytes, b.bytes);
    const auto cells = alone.slice(2, 0.125), same_cells = shared.slice(2, 0.125);
    ASSERT_EQ(cells.size(), same_cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) ASSERT_EQ(cells[i].outline, same_cells[i].outline);
    for (int i = 0; i < 1000; ++i) {
      const Ray<T> ray{in_cube(random, T(2)), in_cube(random, T(1))};
      Work work, same_work;
      ASSERT_TRUE(alone.closest_hit(ray, work) == shared.closest_hit(ray, same_work));
      ASSERT_EQ(work.nodes, same_work.nodes);
      ASSERT_EQ(work.primitives, same_work.primitives);
    }
  }
  options.threads = 0;
  EXPECT_THROW(TypeParam(triangles, options), InvalidInput);
}

TYPED_TEST(TriangleShape, StatsAreConsistent) {
  using T = typename TypeParam::Scalar;
  const Mesh<T> mesh = sphere<T>(4);
  const TypeParam tree(mesh);
  const TreeStats s = tree.stats();
  EXPECT_EQ(s.primitives, mesh.size());
  EXPECT_EQ(tree.size(), mesh.size());
  EXPECT_EQ(s.leaves, s.inner_nodes + 1);  // every inner node has two children
  EXPECT_GE(s.references, s.primitives);
  EXPECT_LE(s.references, 8 * s.primitives);
  if (std::is_same_v<TypeParam, BspTree<Triangles<T>>>) {
    EXPECT_GT(s.oblique_nodes, 0u);  // planes of either kind
    EXPECT_LT(s.oblique_nodes, s.inner_nodes);
  } else {
    EXPECT_EQ(s.oblique_nodes, 0u);
  }
  EXPECT_EQ(s.bytes, tree.bytes());
  EXPECT_GE(s.bytes, s.primitives * sizeof(Triangle<T>));
  EXPECT_GT(s.sah_cost, 0);
  EXPECT_LE(s.sah_cost, static_cast<double>(mesh.size()));
  EXPECT_GE(s.depth, s.leaves > 1 ? static_cast<std::size_t>(std::log2(double(s.leaves))) : 0);
  Work work;
  (void)tree.closest_hit({{}, {1, T(0.1), T(0.2)}}, work);
  EXPECT_GT(work.primitives, 0u);
}

TYPED_TEST(TriangleShape, DepthAndReferencesAreBoundedWhateverTheInput) {
  using T = typename TypeParam::Scalar;
  std::vector<std::vector<Triangle<T>>> inputs;
  inputs.push_back(std::vector<Triangle<T>>(3000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));  // duplicates
  inputs.push_back(std::vector<Triangle<T>>(3000, {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));  // points
  inputs.emplace_back();                                                                // a geometric series
  for (int i = 0; i < 3000; ++i) {
    const T x = std::ldexp(T(1), -i % 100) * (T(1) + T(i) / T(3000));
    inputs.back().push_back({{x, 0, 0}, {x, x, 0}, {x, 0, x}});
  }
  inputs.push_back(soup<T>(2000, T(3), 111));  // everything overlaps everything
  inputs.emplace_back();                       // a fan of needles through one point
  for (int i = 0; i < 2000; ++i) {
    const T a = T(i) / T(2000) * T(std::numbers::pi);
    inputs.back().push_back({{0, 0, 0}, {std::cos(a), std::sin(a), 0}, {std::cos(a), std::sin(a), T(1e-6)}});
  }
  for (const auto& triangles : inputs) {
    const TypeParam tree(triangles);
    const TreeStats s = tree.stats();
    constexpr bool is_bvh = std::is_same_v<TypeParam, Bvh<Triangles<T>>>;
    EXPECT_LE(double(s.depth), is_bvh ? 64.0 : 8 + 1.3 * std::log2(double(triangles.size())));
    EXPECT_LE(s.references, 8 * triangles.size());
    if (is_bvh) {
      EXPECT_LE(s.largest_leaf, 8u);
    }
    const BruteForce<Triangles<T>> brute(triangles);
    Pcg32 random(112);
    for (int i = 0; i < 20; ++i) {
      const Ray<T> ray{in_cube(random, T(2)), in_cube(random, T(1))};
      EXPECT_TRUE(tree.closest_hit(ray) == brute.closest_hit(ray));
      EXPECT_EQ(tree.closest_point(ray.origin).primitive, brute.closest_point(ray.origin).primitive);
    }
  }
}

double outline_area(const std::vector<geometry::Vec2d>& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto &p = outline[i], &q = outline[(i + 1) % outline.size()];
    twice += p[0] * q[1] - p[1] * q[0];
  }
  return std::abs(twice) / 2;
}

TYPED_TEST(TriangleShape, SlicesOfCellsTileTheBox) {
  using T = typename TypeParam::Scalar;
  const TypeParam tree(soup<T>(500, T(0.3), 121));
  constexpr bool is_bvh = std::is_same_v<TypeParam, Bvh<Triangles<T>>>;
  for (int axis = 0; axis < 3; ++axis) {
    double total = 0;
    for (const SliceCell& cell : tree.slice(axis, 0.123)) {
      EXPECT_LE(cell.depth, tree.stats().depth);
      EXPECT_LE(cell.primitives, tree.stats().largest_leaf);
      EXPECT_GE(cell.outline.size(), 3u);
      total += outline_area(cell.outline);
    }
    const auto extent = tree.bounds().extent();
    const double whole = double(extent[(axis + 1) % 3]) * double(extent[(axis + 2) % 3]);
    EXPECT_GT(total, 0);
    if (!is_bvh) {
      EXPECT_NEAR(total, whole, 1e-5 * whole);
    }
    EXPECT_TRUE(tree.slice(axis, 100).empty());
  }
}

TEST(TriangleWork, TreesTouchFarLessThanBruteForce) {
  const auto mesh = sphere<float>(6);  // 32768 faces
  const auto touched = [&](const auto& tree) {
    Work work;
    Pcg32 random(131);
    for (int i = 0; i < 200; ++i)
      (void)tree.closest_hit({in_cube(random, 0.5f), in_cube(random, 1.0f)}, work);
    return double(work.nodes + work.primitives) / 200;
  };
  EXPECT_LT(touched(Bvh<Triangles<float>>(mesh)), 150);
  EXPECT_LT(touched(KdTree<Triangles<float>>(mesh)), 150);
  EXPECT_LT(touched(BspTree<Triangles<float>>(mesh)), 150);
}

// Slack is measured from the triangles themselves: one of them far away must not blur all the others.
TYPED_TEST(TriangleShape, OneTriangleFarAwayCostsNextToNothing) {
  using T = typename TypeParam::Scalar;
  if (std::is_same_v<TypeParam, BruteForce<Triangles<T>>>) GTEST_SKIP() << "tests every triangle anyway";
  Mesh<T> mesh = sphere<T>(5);  // 8192 faces
  std::vector<Ray<T>> rays;
  Pcg32 random(141);
  for (int i = 0; i < 300; ++i) rays.push_back({in_cube(random, T(0.5)), in_cube(random, T(1))});
  struct Touched {
    double by_rays, by_points;
  };
  const auto touched = [&](const TypeParam& tree) {
    Work ray_work, point_work;
    for (const auto& ray : rays) {
      EXPECT_TRUE(tree.closest_hit(ray, ray_work));
      (void)tree.closest_point(ray.origin, T(10), point_work);
    }
    return Touched{double(ray_work.nodes + ray_work.primitives),
                   double(point_work.nodes + point_work.primitives)};
  };
  const Touched alone = touched(TypeParam(mesh));
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.resize(first + 3);
  mesh.faces.push_back({first, first + 1, first + 2});
  for (const T far : {T(1e2), T(1e5), T(1e8)}) {
    mesh.vertices[first] = {far, far, far};
    mesh.vertices[first + 1] = {far * T(1.5), far, far};
    mesh.vertices[first + 2] = {far, far * T(1.5), far};
    const TypeParam tree(mesh);
    const Touched with = touched(tree);
    EXPECT_LT(with.by_rays, 2 * alone.by_rays) << far;
    EXPECT_LT(with.by_points, 2 * alone.by_points) << far;
    EXPECT_EQ(tree.closest_hit({{}, {T(1.1), T(1.1), T(1)}, T(1.5)}).primitive, mesh.size() - 1) << far;
  }
}

}  // namespace
}  // namespace treeline::accel::test
