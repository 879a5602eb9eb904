// Our KD tree.
#include "accel/kd_tree.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "kd_tree",
              .family = "kd",
              .claim = Claim::bounded,  // with the watertight test; see claim_of()
              .build_knobs = tree_knobs({8, 4}),
              .stress_builds = {0, 2},  // both ray tests
              .ladder = 20,
              // At a million triangles one build takes five to ten seconds.
              .sweep_up_to_n = 500'000,
              .largest_n = 3'000'000},
     .build = build_tree<accel::KdTree>});

}  // namespace
}  // namespace treeline::bench::ray
