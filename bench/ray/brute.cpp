// Every triangle tried, by our own brute force: no tree at all, the lowest rung. Methods brute, brute_fast.
#include "accel/brute_force.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = register_tree<accel::BruteForce>(
    {.name = "brute", .family = "brute", .ladder = 0, .largest_n = 5'000, .scales = false});

}  // namespace
}  // namespace treeline::bench::ray
