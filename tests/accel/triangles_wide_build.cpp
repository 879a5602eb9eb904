// What the wide tree over triangles is made of: leaves, boxes, slices, whatever the threads that built it.
#include "accel/bvh/wide_triangles.hpp"
#include "tests/accel/triangles_wide.hpp"

namespace treeline::accel::test {
namespace {

using Closed = Bvh<Triangles<float, Watertight>, accel::Wide>;

TEST(WideBuild, TreeDoesNotDependOnThreads) {
  const auto triangles = soup<float>(70000, 0.01f, 71);
  const auto built = [&](int threads) { return build_binned(triangles, {.threads = threads}); };
  const BinaryTree one = built(1);
  const auto lines = wide::Collapse<wide::PlainLayout<8, 8>>(one, triangles, {}, 1).run().lines;
  for (const int threads : {2, 5}) {
    const BinaryTree other = built(threads);
    ASSERT_EQ(one.references, other.references);
    ASSERT_EQ(one.nodes.size(), other.nodes.size());
    for (std::size_t i = 0; i < one.nodes.size(); ++i) {
      ASSERT_EQ(one.nodes[i].box, other.nodes[i].box);
      ASSERT_EQ(one.nodes[i].first, other.nodes[i].first);
      ASSERT_EQ(one.nodes[i].count, other.nodes[i].count);
    }
    const auto same = wide::Collapse<wide::PlainLayout<8, 8>>(other, triangles, {}, threads).run().lines;
    ASSERT_EQ(lines.size(), same.size());
    ASSERT_EQ(std::memcmp(lines.data(), same.data(), lines.size() * sizeof(wide::Line)), 0);
  }
}

TEST(WideBuild, EveryTriangleIsInOneLeafAndEveryBoxEnclosesWhatIsBelow) {
  const auto triangles = soup<float>(20000, 0.05f, 72);
  const BinaryTree tree = build_binned(triangles);
  std::vector<int> seen(triangles.size());
  for (const auto& node : tree.nodes) {
    if (node.count == 0) {
      ASSERT_TRUE(node.box.contains(tree.nodes[node.first].box));
      ASSERT_TRUE(node.box.contains(tree.nodes[node.first + 1].box));
      continue;
    }
    ASSERT_LE(node.count, 8u);
    for (std::uint32_t i = 0; i < node.count; ++i) {
      ++seen[tree.references[node.first + i]];
      ASSERT_TRUE(node.box.contains(triangles[tree.references[node.first + i]].box()));
    }
  }
  for (const int count : seen) ASSERT_EQ(count, 1);
}

TEST(WideBuild, SlicesCoverTheirTriangles) {
  const V centre{1000, 3, -2000};
  const Closed tree(sphere<float>(4, centre, 2.0f));
  for (int axis = 0; axis < 3; ++axis) {
    double left = 1e9, right = -1e9;
    std::size_t triangles = 0;
    for (const SliceCell& cell : tree.slice(axis, double(centre[axis])))
      for (const auto& p : (triangles += cell.primitives, cell.outline))
        left = std::min(left, p[0]), right = std::max(right, p[0]);
    const double middle = double(centre[axis == 0 ? 1 : 0]);
    EXPECT_NEAR(left, middle - 2, 1e-3);
    EXPECT_NEAR(right, middle + 2, 1e-3);
    EXPECT_GT(triangles, 100u);
  }
  EXPECT_THROW((void)tree.slice(3, 0), InvalidInput);
}

}  // namespace
}  // namespace treeline::accel::test
