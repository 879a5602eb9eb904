// The parts of which builders are made, each by itself: the cost, the sort, clipping, the bound on depth, and
// reinsertion of subtrees.
#include "tests/accel/triangles_builders.hpp"

namespace treeline::accel::test {
namespace {

TEST(TriangleBuilderParts, CostIsThatOfTheFormula) {
  // A cube of side 4 with a leaf of 9 in half of it and a leaf of 2 in an eighth: areas 96, 64 and 24.
  BinaryTree tree;
  tree.nodes = {
      {{{0, 0, 0}, {4, 4, 4}}, 1, 0}, {{{0, 0, 0}, {2, 4, 4}}, 0, 9}, {{{2, 2, 2}, {4, 4, 4}}, 9, 2}};
  tree.references.resize(11);
  BinaryBuildOptions options;
  EXPECT_DOUBLE_EQ(sah_cost(tree, options), (1 * 96 + 2 * 64 + 1 * 24) / 96.0);
  options.block = 1, options.node_cost = 0.5;
  EXPECT_DOUBLE_EQ(sah_cost(tree, options), (0.5 * 96 + 9 * 64 + 2 * 24) / 96.0);
  EXPECT_EQ(binary_depth(tree), 1u);
  EXPECT_EQ(sah_cost({}, options), 0);
}

TEST(TriangleBuilderParts, RadixSortIsTheStableSort) {
  Pcg32 random(1);
  for (const std::size_t n : {0, 1, 2, 1000, 100000}) {
    std::vector<SortItem<std::uint64_t>> items(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint64_t key = std::uint64_t{random.next()} << 32 | (random.next() & 3);
      items[i] = {i % 3 == 0 ? key & 0xff0000ff00000003 : key, static_cast<std::uint32_t>(i)};
    }
    auto expected = items;
    std::stable_sort(expected.begin(), expected.end(),
                     [](const auto& a, const auto& b) { return a.key < b.key; });
    for (const int threads : {1, 3}) {
      auto sorted = items;
      const BuildTasks tasks(threads);
      tasks.run([&] { radix_sort(sorted, tasks); });
      for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(sorted[i].value, expected[i].value);
    }
  }
  const float values[] = {-std::numeric_limits<float>::max(), -1, -1e-45f, 0, 1e-45f, 1, 3e38f};
  for (std::size_t i = 1; i < std::size(values); ++i) EXPECT_LT(sortable(values[i - 1]), sortable(values[i]));
}

TEST(TriangleBuilderParts, ACrossingLiesInItsBox) {
  Pcg32 random(2);
  for (int i = 0; i < 20000; ++i) {
    const float scale = std::ldexp(1.0f, static_cast<int>(random.next() % 240) - 140);
    const auto centre = in_cube(random, i % 2 ? 1000 * scale : 0);
    const auto corner = [&] {
      auto p = in_cube(random, scale);
      if (i % 5 == 0) p[1] *= 1e-30f;  // hardly a slope to divide by
      return p + centre;
    };
    const Triangle<float> t{corner(), corner(), corner()};
    for (int axis = 0; axis < 3; ++axis) {
      const auto box = t.box();
      const float plane =
          i % 7 == 0 ? t.b[axis] : box.low[axis] + random.uniform<float>() * (box.high[axis] - box.low[axis]);
      if (!(box.low[axis] < plane && plane < box.high[axis])) continue;
      Chopper chopper(t);
      chopper.along(axis);
      const auto found = chopper.crossing(plane).lanes().box();
      const Vec<float, 3> corners[] = {t.a, t.b, t.c};
      for (int k = 0; k < 3; ++k) {
        const Vec<float, 3>&p = corners[k], &q = corners[(k + 1) % 3];
        if ((p[axis] <= plane) == (q[axis] <= plane)) continue;
        const long double s =
            (static_cast<long double>(plane) - p[axis]) / (static_cast<long double>(q[axis]) - p[axis]);
        for (int a = 0; a < 3; ++a) {
          const long double x = p[a] + s * (static_cast<long double>(q[a]) - p[a]);
          ASSERT_LE(found.low[a], x) << i << " " << a;
          ASSERT_GE(found.high[a], x) << i << " " << a;
          // And the box is no larger than rounding asks for.
          const float size = std::max({std::abs(t.a[a]), std::abs(t.b[a]), std::abs(t.c[a])});
          const auto [low, high] = std::minmax({t.a[a], t.b[a], t.c[a]});
          ASSERT_GE(found.low[a], low - 2e-6f * size - 1e-37f);
          ASSERT_LE(found.high[a], high + 2e-6f * size + 1e-37f);
        }
      }
    }
  }
}

/// A chain: each inner node has one leaf and the rest.
BinaryTree chain(std::size_t leaves) {
  BinaryTree tree;
  const auto box = [&](std::size_t from, std::size_t to) {
    return Box<float, 3>{{float(from), 0, 0}, {float(to), 1, 1}};
  };
  tree.nodes.push_back({box(0, leaves), 1, 0});
  for (std::size_t i = 0; i + 1 < leaves; ++i) {
    const auto next = static_cast<std::uint32_t>(tree.nodes.size());
    const bool last = i + 2 == leaves;
    tree.nodes.push_back({box(i, i + 1), static_cast<std::uint32_t>(i), 1});
    tree.nodes.push_back({box(i + 1, leaves), last ? static_cast<std::uint32_t>(i + 1) : next + 2, last});
  }
  for (std::size_t i = 0; i < leaves; ++i) tree.references.push_back(static_cast<std::uint32_t>(i));
  return tree;
}

TEST(TriangleBuilderParts, DepthIsBoundAtTheCostOfTheDeepest) {
  for (const std::size_t leaves : {2, 60, 65, 66, 200, 5000}) {
    BinaryTree tree = chain(leaves);
    Soup triangles;
    for (std::size_t i = 0; i < leaves; ++i)
      triangles.push_back({{float(i), 0, 0}, {float(i + 1), 1, 0}, {float(i), 0, 1}});
    EXPECT_EQ(binary_depth(tree), leaves - 1);
    const BinaryTree before = tree;
    limit_depth(tree);
    EXPECT_EQ(tree.nodes.size(), before.nodes.size());
    expect_well_formed(tree, triangles, {}, 1);
    if (leaves <= 60) {
      EXPECT_EQ(sah_cost(tree, {}), sah_cost(before, {}));
    } else if (leaves >= 200) {
      EXPECT_GE(binary_depth(tree), 60u);  // what can stay does
    }
  }
}

/// In halves of the given order.
void halve(const Soup& triangles, BinaryTree& tree, std::uint32_t slot, std::uint32_t first,
           std::uint32_t count) {
  Box<float, 3> box;
  for (std::uint32_t i = first; i < first + count; ++i) box.grow(triangles[tree.references[i]].box());
  if (count <= 2) {
    tree.nodes[slot] = {box, first, count};
    return;
  }
  const auto pair = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes[slot] = {box, pair, 0};
  tree.nodes.resize(tree.nodes.size() + 2);
  halve(triangles, tree, pair, first, count / 2);
  halve(triangles, tree, pair + 1, first + count / 2, count - count / 2);
}

TEST(TriangleBuilderParts, ReinsertionNeverRaisesTheCostAndMendsABadTree) {
  const Soup soups[] = {geometry::triangles_of(sphere<float>(5)), soup<float>(3000, 0.1f, 51),
                        soup<float>(2000, 3.0f, 52), Soup(1000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})};
  for (const Soup& triangles : soups) {
    for (const Builder& builder : builders()) {
      BinaryTree tree = builder.build(triangles, {});
      double before = sah_cost(tree, {});
      const std::size_t references = tree.references.size(), nodes = tree.nodes.size();
      for (int pass = 0; pass < 4; ++pass) {
        reinsert(tree, {.passes = 1, .share = 1});
        const double after = sah_cost(tree, {});
        EXPECT_LE(after, before) << builder.name;
        before = after;
      }
      EXPECT_EQ(tree.nodes.size(), nodes);
      EXPECT_EQ(tree.references.size(), references);
      expect_well_formed(tree, triangles, {}, builder.most_references);
    }
  }
  BinaryTree bad;
  bad.nodes.resize(1);
  for (std::uint32_t i = 0; i < soups[1].size(); ++i) bad.references.push_back(i);
  halve(soups[1], bad, 0, 0, static_cast<std::uint32_t>(soups[1].size()));  // of a random order
  BinaryTree good = bad;
  reinsert(good, {.passes = 10, .share = 1});
  expect_well_formed(good, soups[1], {}, 1);
  EXPECT_LT(sah_cost(good, {}), 0.5 * sah_cost(bad, {}));
}

TEST(TriangleBuilderParts, ReinsertionRefusesOptionsWithoutMeaning) {
  BinaryTree tree = build_sweep(soup<float>(100, 0.3f, 61));
  EXPECT_THROW(reinsert(tree, {.threads = 0}), InvalidInput);
  EXPECT_THROW(reinsert(tree, {.share = 0}), InvalidInput);
  EXPECT_THROW(reinsert(tree, {.passes = -1}), InvalidInput);
  BinaryTree none;
  EXPECT_NO_THROW(reinsert(none));
}

}  // namespace
}  // namespace treeline::accel::test
