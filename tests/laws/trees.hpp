// Every tree, once: a law written for these lists holds for each of them. Adding a tree is one line.
#pragma once

#include <gtest/gtest.h>

#include "accel/brute_force.hpp"
#include "accel/bsp_tree.hpp"
#include "accel/bvh.hpp"
#include "accel/kd_tree.hpp"

namespace treeline::test {

template <class Primitives>
using Trees = testing::Types<accel::BruteForce<Primitives>,  //
                             accel::KdTree<Primitives>,      //
                             accel::BspTree<Primitives>,     //
                             accel::Bvh<Primitives>>;

/// What a tree is built over.
template <class Tree>
struct PrimitivesOf;
template <template <class> class Tree, class P>
struct PrimitivesOf<Tree<P>> {
  using Type = P;
  using Brute = accel::BruteForce<P>;
};

template <class P>
struct PrimitivesOf<accel::Bvh<P, accel::Wide>> {
  using Type = P;
  using Brute = accel::BruteForce<P>;
};

}  // namespace treeline::test
