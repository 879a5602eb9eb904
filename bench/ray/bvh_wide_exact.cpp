// Our wide bounding volume hierarchy with exact leaves.
#include "bench/ray/wide_index.hpp"

namespace treeline::bench::ray {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh_wide_exact",
              .family = "bvh",
              .claim = Claim::exact,
              .build_knobs = {Knobs{{"builder", "binned"}}, Knobs{{"builder", "spatial"}}},
              .query_knobs = wide_batches(),
              .stress_builds = {0, 1},
              .ladder = 12,
              .quick_builds = 1},
     .build = build_wide<geometry::Exact, accel::Wide>});

}  // namespace
}  // namespace treeline::bench::ray
