// Laws of every builder of binary trees over triangles, on meshes and on what is meant to break them: each
// triangle is referred to, boxes enclose, depth and references are bounded, and the number of threads does
// not matter.
#include "tests/accel/triangles_builders.hpp"

namespace treeline::accel::test {
namespace {

struct Input {
  std::string name;
  Soup triangles;
};

/// Long thin triangles in all directions.
Soup beams(std::size_t n, std::uint64_t seed) {
  Pcg32 random(seed);
  Soup triangles;
  for (std::size_t i = 0; i < n; ++i) {
    const auto a = in_cube(random, 1.0f), b = in_cube(random, 1.0f), thick = in_cube(random, 0.002f);
    triangles.push_back({a, b, a + thick});
  }
  return triangles;
}

Soup of_mesh(const Mesh<float>& mesh) { return geometry::triangles_of(mesh); }

std::vector<Input> inputs() {
  std::vector<Input> all;
  all.push_back({"none", {}});
  for (const std::size_t n : {1, 2, 8, 9, 17}) all.push_back({std::to_string(n), soup<float>(n, 0.3f, 7)});
  all.push_back({"sphere", of_mesh(sphere<float>(5))});
  all.push_back({"far sphere", of_mesh(sphere<float>(4, {1e4f, -2e5f, 3e3f}))});
  all.push_back({"soup", soup<float>(3000, 0.2f, 8)});
  all.push_back({"everything overlaps", soup<float>(2000, 3.0f, 9)});
  all.push_back({"beams", beams(3000, 10)});
  all.push_back({"duplicates", Soup(3000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})});
  all.push_back({"few of each", {}});
  for (int i = 0; i < 3000; ++i)
    all.back().triangles.push_back(all[5].triangles[static_cast<std::size_t>(i % 7)]);
  all.push_back({"nested", {}});
  for (int i = 1; i <= 3000; ++i) {
    const float r = float(i) / 16;
    all.back().triangles.push_back({{-r, -r, 0}, {2 * r, -r, 0}, {-r, 2 * r, 0}});
  }
  all.push_back({"geometric series", {}});
  for (int i = 0; i < 3000; ++i) {
    const float x = std::ldexp(1.0f, -i % 100) * (1 + float(i) / 3000);
    all.back().triangles.push_back({{x, 0, 0}, {x, x, 0}, {x, 0, x}});
  }
  all.push_back({"growing gaps", {}});  // each nearer to the one before it than to the next
  for (int i = 0; i < 3000; ++i) {
    const float x = float(i) * float(i + 100);
    all.back().triangles.push_back({{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
  }
  all.push_back({"fan", {}});
  for (int i = 0; i < 2000; ++i) {
    const float a = float(i) / 2000 * std::numbers::pi_v<float>, c = std::cos(a), s = std::sin(a);
    all.back().triangles.push_back({{0, 0, 0}, {c, s, 0}, {c, s, 1e-6f}});
  }
  all.push_back({"huge among small", soup<float>(1000, 0.1f, 11)});
  all.back().triangles.push_back({{-1e15f, -1e15f, 0}, {1e15f, -1e15f, 1}, {0, 1e15f, 2}});
  all.push_back({"near overflow", soup<float>(1000, 1e37f, 12, {}, 1e38f)});
  for (auto& t : all.back().triangles)
    for (auto* p : {&t.a, &t.b, &t.c})
      for (int k = 0; k < 3; ++k) (*p)[k] = std::clamp((*p)[k], -3e38f, 3e38f);
  all.push_back({"tiny", soup<float>(1000, 0.2f, 13, {}, 1e-36f)});
  all.push_back({"denormal", soup<float>(1000, 0.2f, 14, {}, 1e-42f)});
  return all;
}

TEST(TriangleBuilders, EveryTreeIsWellFormedWhateverTheInput) {
  BinaryBuildOptions small_leaves, costly_nodes;
  small_leaves.block = 4, small_leaves.largest_leaf = 2;
  costly_nodes.block = 4, costly_nodes.largest_leaf = 13, costly_nodes.node_cost = 0.3;
  for (const Input& input : inputs())
    for (const Builder& builder : builders())
      for (const BinaryBuildOptions& options : {BinaryBuildOptions{}, small_leaves, costly_nodes}) {
        SCOPED_TRACE(input.name + ", " + builder.name + ", leaves of " +
                     std::to_string(options.largest_leaf));
        expect_well_formed(builder.build(input.triangles, options), input.triangles, options,
                           builder.most_references);
      }
}

TEST(TriangleBuilders, ManyDuplicatesEndInABalancedTree) {
  const Soup triangles(200000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (const Builder& builder : builders()) {
    SCOPED_TRACE(builder.name);
    const BinaryTree tree = builder.build(triangles, {});
    EXPECT_LE(binary_depth(tree), 20u);
    EXPECT_LE(tree.nodes.size(), 2 * (triangles.size() / 4));
    EXPECT_EQ(tree.references.size(), triangles.size());
  }
}

TEST(TriangleBuilders, TheTreeDoesNotDependOnThreads) {
  const Soup inputs[] = {of_mesh(sphere<float>(6)), beams(30000, 21), soup<float>(40000, 0.05f, 22)};
  for (const Soup& triangles : inputs)
    for (const Builder& builder : builders()) {
      SCOPED_TRACE(builder.name);
      const BinaryTree one = builder.build(triangles, {});
      for (const int threads : {2, 5}) {
        BinaryBuildOptions options;
        options.threads = threads;
        const BinaryTree more = builder.build(triangles, options);
        ASSERT_EQ(one.nodes.size(), more.nodes.size());
        for (std::size_t i = 0; i < one.nodes.size(); ++i) {
          ASSERT_EQ(one.nodes[i].box, more.nodes[i].box) << "node " << i;
          ASSERT_EQ(one.nodes[i].first, more.nodes[i].first) << "node " << i;
          ASSERT_EQ(one.nodes[i].count, more.nodes[i].count) << "node " << i;
        }
        ASSERT_EQ(one.references, more.references);
      }
    }
}

TEST(TriangleBuilders, GroupsFarApartAreParted) {
  Soup triangles;
  for (int group = 0; group < 8; ++group) {
    const auto part = soup<float>(100, 0.2f, 31 + static_cast<std::uint64_t>(group),
                                  {float(group & 1) * 1000, float(group & 2) * 500, float(group & 4) * 250});
    triangles.insert(triangles.end(), part.begin(), part.end());
  }
  for (const Builder& builder : builders()) {
    SCOPED_TRACE(builder.name);
    const BinaryTree tree = builder.build(triangles, {});
    std::size_t wide = 0;  // nodes with more than one group
    for (const BinaryNode& node : tree.nodes) {
      const auto e = node.box.extent();
      wide += std::max({e[0], e[1], e[2]}) > 100;
    }
    EXPECT_EQ(wide, 7u);
  }
}

TEST(TriangleBuilders, SweepTakesTheCheapestSplitThereIs) {
  BinaryBuildOptions options;
  options.block = 1, options.largest_leaf = 1;
  for (std::uint64_t seed = 41; seed < 61; ++seed) {
    const Soup triangles = soup<float>(40, 0.4f, seed);
    const BinaryTree tree = build_sweep(triangles, options);
    double cheapest = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      Soup sorted = triangles;
      std::sort(sorted.begin(), sorted.end(), [axis](const auto& a, const auto& b) {
        const auto x = a.box(), y = b.box();
        return double(x.low[axis]) + double(x.high[axis]) < double(y.low[axis]) + double(y.high[axis]);
      });
      for (std::size_t left = 1; left < sorted.size(); ++left) {
        Box<float, 3> boxes[2];
        for (std::size_t i = 0; i < sorted.size(); ++i) boxes[i >= left].grow(sorted[i].box());
        cheapest =
            std::min(cheapest, area(boxes[0]) * double(left) + area(boxes[1]) * double(sorted.size() - left));
      }
    }
    double taken = 0;
    for (const std::uint32_t child : {tree.nodes[0].first, tree.nodes[0].first + 1})
      taken += area(tree.nodes[child].box) * double(triangles_below(tree, child));
    EXPECT_NEAR(taken, cheapest, 1e-5 * cheapest) << "seed " << seed;
  }
}

TEST(TriangleBuilders, SpatialSplitsStayWithinTheirCap) {
  const Soup triangles = beams(5000, 71);
  for (const double references : {1.0, 1.01, 1.25, 1.5, 2.0, 4.0}) {
    SpatialBuildOptions options;
    options.references = references;
    const BinaryTree tree = build_spatial(triangles, options);
    EXPECT_LE(double(tree.references.size()), references * double(triangles.size()));
    if (references > 1.2) {
      EXPECT_GT(tree.references.size(), triangles.size());
    }
    expect_well_formed(tree, triangles, options, references);
  }
}

TEST(TriangleBuilders, SpatialSplitsPartThinTrianglesFromTheRest) {
  Soup triangles = soup<float>(20000, 0.02f, 72);
  for (const auto& beam : beams(200, 73)) triangles.push_back(beam);
  const BinaryTree tree = build_spatial(triangles);
  EXPECT_LT(double(tree.references.size()), 1.5 * double(triangles.size()));
  EXPECT_LT(sah_cost(tree, {}), 0.5 * sah_cost(build_sweep(triangles), {}));
}

TEST(TriangleBuilders, RefuseOptionsWithoutMeaning) {
  const Soup triangles = soup<float>(10, 0.3f, 81);
  for (const Builder& builder : builders()) {
    SCOPED_TRACE(builder.name);
    BinaryBuildOptions options;
    options.block = 0;
    EXPECT_THROW((void)builder.build(triangles, options), InvalidInput);
    options = {}, options.largest_leaf = 0;
    EXPECT_THROW((void)builder.build(triangles, options), InvalidInput);
    for (const double cost :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0, 0.0}) {
      options = {}, options.node_cost = cost;
      EXPECT_THROW((void)builder.build(triangles, options), InvalidInput) << cost;
    }
    options = {}, options.threads = 0;
    EXPECT_THROW((void)builder.build(triangles, options), InvalidInput);
  }
  SpatialBuildOptions spatial;
  spatial.references = 0.5;
  EXPECT_THROW((void)build_spatial(triangles, spatial), InvalidInput);
  spatial = {}, spatial.spatial_bins = 1;
  EXPECT_THROW((void)build_spatial(triangles, spatial), InvalidInput);
  PlocBuildOptions ploc;
  ploc.radius = 17;
  EXPECT_THROW((void)build_ploc(triangles, ploc), InvalidInput);
}

}  // namespace
}  // namespace treeline::accel::test
