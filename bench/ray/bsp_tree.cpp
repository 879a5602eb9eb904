// Our BSP tree.
#include "accel/bsp_tree.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bsp_tree",
              .family = "bsp",
              .claim = Claim::bounded,  // with the watertight test; see claim_of()
              .build_knobs = tree_knobs({8}),
              .stress_builds = {0, 1},  // both ray tests
              .ladder = 30,
              // At a million triangles one build takes five to ten seconds.
              .sweep_up_to_n = 500'000,
              .largest_n = 3'000'000},
     .build = build_tree<accel::BspTree>});

}  // namespace
}  // namespace treeline::bench::ray
