// The builders of binary trees over triangles, and what holds of every tree that they make.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "accel/bvh/build_ploc.hpp"
#include "accel/bvh/build_spatial.hpp"
#include "accel/bvh/build_sweep.hpp"
#include "accel/bvh/reinsertion.hpp"
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {

using Soup = std::vector<Triangle<float>>;

struct Builder {
  std::string name;
  double most_references;  // per triangle
  std::function<BinaryTree(const Soup&, const BinaryBuildOptions&)> build;
};

template <class Options>
Options with(const BinaryBuildOptions& common) {
  Options options;
  static_cast<BinaryBuildOptions&>(options) = common;
  return options;
}

inline std::vector<Builder> builders() {
  std::vector<Builder> all{
      {"sweep", 1, [](const Soup& t, const BinaryBuildOptions& o) { return build_sweep(t, o); }},
      {"spatial", 1.5,
       [](const Soup& t, const BinaryBuildOptions& o) {
         SpatialBuildOptions options = with<SpatialBuildOptions>(o);
         options.overlap = 0;  // whenever there is room
         return build_spatial(t, options);
       }},
      {"ploc", 1,
       [](const Soup& t, const BinaryBuildOptions& o) { return build_ploc(t, with<PlocBuildOptions>(o)); }},
  };
  for (const std::size_t i : {1, 2}) {
    const Builder plain = all[i];
    all.push_back({plain.name + " reinserted", plain.most_references,
                   [plain](const Soup& t, const BinaryBuildOptions& o) {
                     BinaryTree tree = plain.build(t, o);
                     reinsert(tree, {.threads = o.threads});
                     return tree;
                   }});
  }
  return all;
}

inline double area(const Box<float, 3>& b) {
  return surface_area(Box<double, 3>{Vec<double, 3>(b.low), Vec<double, 3>(b.high)});
}

inline std::size_t triangles_below(const BinaryTree& tree, std::uint32_t i) {
  const BinaryNode& node = tree.nodes[i];
  return node.count > 0 ? node.count
                        : triangles_below(tree, node.first) + triangles_below(tree, node.first + 1);
}

/// Every point of a fine net over the triangle lies in one of the boxes. Weights are multiples of 1/32, so
/// that the points are exact wherever corners share a coordinate.
inline void expect_covered(const Triangle<float>& triangle, const std::vector<Box<float, 3>>& boxes) {
  constexpr int parts = 32;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      const auto p = (Vec<double, 3>(triangle.a) * double(i) + Vec<double, 3>(triangle.b) * double(j) +
                      Vec<double, 3>(triangle.c) * double(parts - i - j)) *
                     (1.0 / parts);
      const bool covered = std::any_of(boxes.begin(), boxes.end(), [&](const Box<float, 3>& b) {
        return Box<double, 3>{Vec<double, 3>(b.low), Vec<double, 3>(b.high)}.contains(p);
      });
      ASSERT_TRUE(covered) << "point " << i << ", " << j;
    }
}

inline void expect_well_formed(const BinaryTree& tree, const Soup& triangles,
                               const BinaryBuildOptions& options, double most_references) {
  if (triangles.empty()) {
    EXPECT_TRUE(tree.nodes.empty() && tree.references.empty());
    return;
  }
  ASSERT_LE(double(tree.references.size()), most_references * double(triangles.size()));
  ASSERT_LE(binary_depth(tree), binary_max_depth);
  std::vector<int> reached(tree.nodes.size()), referred(tree.references.size());
  std::vector<std::vector<Box<float, 3>>> boxes(triangles.size());  // of the leaves with each
  reached[0] = 1;
  for (const BinaryNode& node : tree.nodes) {
    if (node.count == 0) {
      ASSERT_LT(std::size_t{node.first} + 1, tree.nodes.size());
      for (const std::uint32_t child : {node.first, node.first + 1}) {
        ++reached[child];
        ASSERT_TRUE(node.box.contains(tree.nodes[child].box));
      }
      continue;
    }
    ASSERT_LE(node.count, static_cast<std::uint32_t>(options.largest_leaf));
    ASSERT_LE(std::size_t{node.first} + node.count, tree.references.size());
    std::set<std::uint32_t> own;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      ++referred[i];
      const std::uint32_t id = tree.references[i];
      ASSERT_LT(id, triangles.size());
      ASSERT_TRUE(own.insert(id).second) << "triangle " << id << " twice in a leaf";
      boxes[id].push_back(node.box);
    }
  }
  for (const int times : reached) ASSERT_EQ(times, 1);
  for (const int times : referred) ASSERT_EQ(times, 1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    ASSERT_GE(boxes[i].size(), 1u) << "triangle " << i;
    if (boxes[i].size() == 1)
      ASSERT_TRUE(boxes[i][0].contains(triangles[i].box())) << "triangle " << i;
    else
      ASSERT_NO_FATAL_FAILURE(expect_covered(triangles[i], boxes[i])) << "triangle " << i;
    if (most_references == 1) {
      ASSERT_EQ(boxes[i].size(), 1u) << "triangle " << i;
    }
  }
}

}  // namespace treeline::accel::test
