// Our binary trees and brute force: the side of the first hit, by rays in float and votes.
#include "accel/brute_force/triangles.hpp"
#include "accel/bsp_tree/triangles.hpp"
#include "accel/bvh/triangles.hpp"
#include "accel/kd_tree/triangles.hpp"
#include "bench/inside/sign_index.hpp"

namespace treeline::bench::inside {
namespace {

using Triangles = accel::Triangles<float>;

[[maybe_unused]] const bool brute =
    register_sign<accel::BruteForce<Triangles>, accel::FirstHit>({.name = "brute_first_hit",
                                                                  .family = "brute",
                                                                  .claim = Claim::bounded,
                                                                  .ladder = 0,
                                                                  .largest_n = 20'000,
                                                                  .quick_largest_n = 2'000,
                                                                  .scales = false});
[[maybe_unused]] const bool bvh = register_sign<accel::Bvh<Triangles>, accel::FirstHit>(
    {.name = "bvh_first_hit", .family = "bvh", .claim = Claim::bounded, .ladder = 21},
    sizeof(accel::BvhNode<float>));
[[maybe_unused]] const bool kd = register_sign<accel::KdTree<Triangles>, accel::FirstHit>(
    {.name = "kd_first_hit", .family = "kd", .claim = Claim::bounded, .ladder = 22},
    sizeof(accel::KdTriangleNode<float>));
[[maybe_unused]] const bool bsp =
    register_sign<accel::BspTree<Triangles>, accel::FirstHit>({.name = "bsp_first_hit",
                                                               .family = "bsp",
                                                               .claim = Claim::bounded,
                                                               .ladder = 23,
                                                               .largest_n = 2'000'000,
                                                               .quick_largest_n = 20'000},
                                                              sizeof(accel::BspTriangleNode<float>));

}  // namespace
}  // namespace treeline::bench::inside
