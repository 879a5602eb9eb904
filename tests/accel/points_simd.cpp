// The wide tree on one instruction set, which this file is compiled for: bit for bit what brute force finds.
// With
// --digest it prints a hash of all answers instead, so that the instruction sets can be compared.
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <string_view>

#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

bool runs_here() {
#if TREELINE_SIMD == 512
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq");
#elif TREELINE_SIMD == 256
  return __builtin_cpu_supports("avx2");
#elif TREELINE_SIMD == 128
  return __builtin_cpu_supports("sse4.1");
#else
  return true;
#endif
}

/// Everything that a tree answers to the queries, in an order that does not depend on the tree.
template <class Tree, int D>
std::uint64_t answers(const Vecs<float, D>& points, std::vector<std::uint64_t>& out) {
  const Tree tree(points);
  const auto queries = queries_for<float, D>(points);
  geometry::Box<float, D> box;
  for (const auto& p : points) box.grow(p);
  const auto add = [&](const Neighbor<float>& n) {
    out.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(n.distance2)} << 32 | n.id);
  };
  std::vector<Neighbor<float>> found;
  for (const std::size_t k : {1, 2, 7, 8, 9, 16, 17, 32, 33, 100, 128, 129, 400}) {
    found.assign(queries.size() * k, {});
    tree.nearest(std::span<const geometry::Vec<float, D>>(queries), k, std::span(found), 1);
    for (const auto& n : found) add(n);
    for (const auto& q : queries) {
      found.assign(k, {});
      tree.nearest(q, k, found);
      for (const auto& n : found) add(n);
    }
  }
  for (const auto& q : queries)
    for (const float share : {0.0f, 0.01f, 0.1f, 0.5f, 2.0f}) {
      const float radius = points.empty() ? share : share * box.extent()[box.widest_axis()];
      tree.within(q, radius, WithinOptions{.sorted = true}, found);
      for (const auto& n : found) add(n);
      out.push_back(tree.count_within(q, radius));
      found.assign(5, {});
      out.push_back(tree.nearest(q, 5, NearestOptions<float>{.max_distance = radius}, found));
      for (const auto& n : found) add(n);
      std::vector<Id> ids;
      const auto half = geometry::Vec<float, D>::filled(radius);
      tree.inside({q - half, q + half}, ids);
      std::sort(ids.begin(), ids.end());
      out.insert(out.end(), ids.begin(), ids.end());
    }
  std::uint64_t hash = 0;
  for (const std::uint64_t x : out) hash = geometry::hash_u64(hash, x);
  return hash;
}

template <int D>
void expect_equal_answers() {
  using P = Points<float, D>;
  for (const auto& cloud : clouds<float, D>()) {
    SCOPED_TRACE(cloud.name);
    std::vector<std::uint64_t> wide, brute;
    answers<Bvh<P, accel::Wide>, D>(cloud.points, wide);
    answers<BruteForce<P>, D>(cloud.points, brute);
    ASSERT_EQ(wide.size(), brute.size());
    for (std::size_t i = 0; i < wide.size(); ++i) ASSERT_EQ(wide[i], brute[i]) << i;
  }
}

TEST(PointSimd, WideTreeEqualsBruteForceBitForBit) {
  if (!runs_here()) GTEST_SKIP() << "this machine has no " << simd::instruction_set;
  expect_equal_answers<2>();
  expect_equal_answers<3>();
}

template <int D>
std::uint64_t digest() {
  std::uint64_t hash = 0;
  for (const auto& cloud : clouds<float, D>()) {
    std::vector<std::uint64_t> all;
    hash = geometry::hash_u64(hash, answers<Bvh<Points<float, D>, accel::Wide>, D>(cloud.points, all));
  }
  return hash;
}

}  // namespace
}  // namespace treeline::accel::test

int main(int argc, char** argv) {
  using namespace treeline::accel::test;
  if (argc == 2 && std::string_view(argv[1]) == "--digest") {
    if (runs_here())
      std::printf("%016llx\n",
                  static_cast<unsigned long long>(treeline::geometry::hash_u64(digest<2>(), digest<3>())));
    return 0;
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
