// Every triangle tried, by our own brute force: no tree at all, the lowest rung.
#include "accel/brute_force.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "brute",
              .family = "brute",
              .claim = Claim::bounded,  // with the watertight test; see claim_of()
              .build_knobs = {Knobs{{"test", "watertight"}}, Knobs{{"test", "moller_trumbore"}}},
              .stress_builds = {0, 1},  // both ray tests
              .ladder = 0,
              .largest_n = 20'000},
     .build = build_tree<accel::BruteForce>});

}  // namespace
}  // namespace treeline::bench::ray
