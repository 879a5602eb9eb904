// The wide tree on one instruction set, which this file is compiled for: bit for bit what brute force finds.
// With --digest it prints a hash of all answers instead, so that the instruction sets can be compared.
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <string_view>

#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "instruction_set.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

/// Everything that a tree answers to the queries, in an order that does not depend on the tree.
template <class Tree, class T, int D>
std::uint64_t answers(const Vecs<T, D>& points, std::vector<std::uint64_t>& out) {
  const Tree tree(points);
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  const auto queries = queries_for<T, D>(points);
  geometry::Box<T, D> box;
  for (const auto& p : points) box.grow(p);
  const auto add = [&](const Neighbor<T>& n) {
    out.push_back(std::bit_cast<Bits>(n.distance2)), out.push_back(n.id);
  };
  std::vector<Neighbor<T>> found;
  for (const std::size_t k : {1, 2, 7, 8, 9, 16, 17, 32, 33, 100, 128, 129, 400}) {
    found.assign(queries.size() * k, {});
    tree.nearest(std::span<const geometry::Vec<T, D>>(queries), k, std::span(found), 1);
    for (const auto& n : found) add(n);
    for (const auto& q : queries) {
      found.assign(k, {});
      tree.nearest(q, k, found);
      for (const auto& n : found) add(n);
    }
  }
  for (const auto& q : queries)
    for (const T share : {T(0), T(0.01), T(0.1), T(0.5), T(2)}) {
      const T radius = points.empty() ? share : share * box.extent()[box.widest_axis()];
      tree.within(q, radius, WithinOptions{.sorted = true}, found);
      for (const auto& n : found) add(n);
      out.push_back(tree.count_within(q, radius));
      found.assign(5, {});
      out.push_back(tree.nearest(q, 5, NearestOptions<T>{.max_distance = radius}, found));
      for (const auto& n : found) add(n);
      std::vector<Id> ids;
      const auto half = geometry::Vec<T, D>::filled(radius);
      tree.inside({q - half, q + half}, ids);
      std::sort(ids.begin(), ids.end());
      out.insert(out.end(), ids.begin(), ids.end());
    }
  std::uint64_t hash = 0;
  for (const std::uint64_t x : out) hash = geometry::hash_u64(hash, x);
  return hash;
}

template <class T, int D>
void expect_equal_answers() {
  using P = Points<T, D>;
  for (const auto& cloud : clouds<T, D>()) {
    SCOPED_TRACE(cloud.name);
    std::vector<std::uint64_t> wide, brute;
    answers<Bvh<P, accel::Wide>, T, D>(cloud.points, wide);
    answers<BruteForce<P>, T, D>(cloud.points, brute);
    ASSERT_EQ(wide.size(), brute.size());
    for (std::size_t i = 0; i < wide.size(); ++i) ASSERT_EQ(wide[i], brute[i]) << i;
  }
}

TEST(PointSimd, WideTreeEqualsBruteForceBitForBit) {
  if (!runs_here()) GTEST_SKIP() << "this machine has no " << simd::instruction_set;
  expect_equal_answers<float, 2>();
  expect_equal_answers<float, 3>();
  expect_equal_answers<double, 2>();
  expect_equal_answers<double, 3>();
}

template <class T, int D>
std::uint64_t digest() {
  std::uint64_t hash = 0;
  for (const auto& cloud : clouds<T, D>()) {
    std::vector<std::uint64_t> all;
    hash = geometry::hash_u64(hash, answers<Bvh<Points<T, D>, accel::Wide>, T, D>(cloud.points, all));
  }
  return hash;
}
std::uint64_t digest_of_all() {
  std::uint64_t hash = geometry::hash_u64(digest<float, 2>(), digest<float, 3>());
  hash = geometry::hash_u64(hash, digest<double, 2>());
  return geometry::hash_u64(hash, digest<double, 3>());
}

}  // namespace
}  // namespace treeline::accel::test

int main(int argc, char** argv) {
  using namespace treeline::accel::test;
  if (argc == 2 && std::string_view(argv[1]) == "--digest") {
    if (runs_here()) std::printf("%016llx\n", static_cast<unsigned long long>(digest_of_all()));
    return 0;
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
