// Meshes, rays and the list of trees that the tests of triangle trees share.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <vector>

#include "accel/brute_force/triangles.hpp"
#include "accel/bsp_tree/triangles.hpp"
#include "accel/bvh/triangles.hpp"
#include "accel/kd_tree/triangles.hpp"
#include "geometry/random.hpp"

namespace treeline::accel::test {

using geometry::Box;
using geometry::Mesh;
using geometry::MollerTrumbore;
using geometry::Pcg32;
using geometry::Ray;
using geometry::Triangle;
using geometry::Vec;
using geometry::Watertight;

using WatertightTrees =
    testing::Types<Bvh<Triangles<float, Watertight>>, Bvh<Triangles<double, Watertight>>,
                   KdTree<Triangles<float, Watertight>>, KdTree<Triangles<double, Watertight>>,
                   BspTree<Triangles<float, Watertight>>, BspTree<Triangles<double, Watertight>>>;
using AllTrees =
    testing::Types<Bvh<Triangles<float, Watertight>>, Bvh<Triangles<float, MollerTrumbore>>,
                   Bvh<Triangles<double, Watertight>>, Bvh<Triangles<double, MollerTrumbore>>,
                   KdTree<Triangles<float, Watertight>>, KdTree<Triangles<float, MollerTrumbore>>,
                   KdTree<Triangles<double, Watertight>>, KdTree<Triangles<double, MollerTrumbore>>,
                   BspTree<Triangles<float, Watertight>>, BspTree<Triangles<float, MollerTrumbore>>,
                   BspTree<Triangles<double, Watertight>>, BspTree<Triangles<double, MollerTrumbore>>>;

/// The brute force with a tree's primitives.
template <class Tree>
struct BruteOf;
template <template <class> class Tree, class Primitives>
struct BruteOf<Tree<Primitives>> {
  using Type = BruteForce<Primitives>;
};
template <class Tree>
using Brute = typename BruteOf<Tree>::Type;

template <class T>
Vec<T, 3> in_cube(Pcg32& random, T half) {
  return {random.uniform<T>(-half, half), random.uniform<T>(-half, half), random.uniform<T>(-half, half)};
}

/// n triangles of about the given size in the cube [-1, 1]³, moved and scaled.
template <class T>
std::vector<Triangle<T>> soup(std::size_t n, T size, std::uint64_t seed, Vec<T, 3> centre = {},
                              T scale = T(1)) {
  Pcg32 random(seed);
  std::vector<Triangle<T>> triangles;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec<T, 3> at = in_cube(random, T(1));
    const auto corner = [&] { return (at + in_cube(random, size)) * scale + centre; };
    const Vec<T, 3> a = corner(), b = corner(), c = corner();
    triangles.push_back({a, b, c});
  }
  return triangles;
}

/// Closed, oriented outward: an octahedron whose faces are split in four `levels` times, on a sphere.
template <class T>
Mesh<T> sphere(int levels, Vec<T, 3> centre = {}, T radius = T(1)) {
  std::vector<Vec<double, 3>> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<typename Mesh<T>::Face> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                            {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (; levels > 0; --levels) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (fresh) points.push_back(normalized(points[a] + points[b]));
      return it->second;
    };
    std::vector<typename Mesh<T>::Face> finer;
    for (const auto& [a, b, c] : faces) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  Mesh<T> mesh;
  for (const auto& p : points) mesh.vertices.push_back(Vec<T, 3>(p) * radius + centre);
  mesh.faces = std::move(faces);
  return mesh;
}

/// The twelve faces of a box, outward.
template <class T>
void add_box(Mesh<T>& mesh, const Box<T, 3>& box) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? box.high[0] : box.low[0], i & 2 ? box.high[1] : box.low[1],
                             i & 4 ? box.high[2] : box.low[2]});
  static constexpr std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    mesh.faces.push_back({first + q[0], first + q[1], first + q[2]});
    mesh.faces.push_back({first + q[0], first + q[2], first + q[3]});
  }
}

/// Same hit from brute force and from the tree, and any_hit agrees.
template <class Tree>
void expect_same_hits(const Tree& tree, const Brute<Tree>& brute, std::span<const typename Tree::Ray> rays) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto expected = brute.closest_hit(rays[i]), found = tree.closest_hit(rays[i]);
    ASSERT_TRUE(expected == found) << "ray " << i << ": t " << expected.t << " of " << expected.primitive
                                   << ", but t " << found.t << " of " << found.primitive;
    ASSERT_EQ(tree.any_hit(rays[i]), static_cast<bool>(expected)) << "ray " << i;
  }
}

template <class Tree>
void expect_same_closest(const Tree& tree, const Brute<Tree>& brute,
                         std::span<const typename Tree::Point> queries) {
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto expected = brute.closest_point(queries[i]), found = tree.closest_point(queries[i]);
    ASSERT_EQ(expected.distance2, found.distance2) << "query " << i;
    ASSERT_EQ(expected.primitive, found.primitive) << "query " << i;
    ASSERT_EQ(expected.feature, found.feature) << "query " << i;
  }
}

}  // namespace treeline::accel::test
