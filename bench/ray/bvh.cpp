// Our bounding volume hierarchy.
#include "accel/bvh.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh",
              .family = "bvh",
              .claim = Claim::bounded,  // with the watertight test; see claim_of()
              .build_knobs = tree_knobs({8, 2, 4}),
              .stress_builds = {0, 3},  // both ray tests
              .ladder = 10},
     .build = build_tree<accel::Bvh>});

}  // namespace
}  // namespace treeline::bench::ray
