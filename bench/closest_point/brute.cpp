// Every triangle tried, by our own brute force: no tree at all. Methods brute, brute_double.
#include "accel/brute_force.hpp"

#include "bench/closest_point/tree_index.hpp"

namespace treeline::bench::closest_point {
namespace {

const bool registered = register_tree<accel::BruteForce>(
    {.name = "brute", .family = "brute", .ladder = 10, .largest_n = 5'000, .scales = false});

}  // namespace
}  // namespace treeline::bench::closest_point
