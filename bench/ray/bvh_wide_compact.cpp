// Our wide bounding volume hierarchy in half the memory. The knob bits: of the boxes' planes; with 8 there is
// a little less to store, and more boxes that a ray meets. Its peer is Embree with compact = true.
#include "accel/bvh/wide_compact.hpp"

#include "bench/ray/wide_index.hpp"

namespace treeline::bench::ray {
namespace {

std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  return knobs.at("bits") == 8
             ? build_wide<geometry::Watertight, accel::WideCompact<8>>(mesh, knobs, threads)
             : build_wide<geometry::Watertight, accel::WideCompact<16>>(mesh, knobs, threads);
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh_wide_compact",
              .family = "bvh",
              .claim = Claim::bounded,
              .build_knobs = {Knobs{{"builder", "binned"}, {"bits", 16}},
                              Knobs{{"builder", "binned"}, {"bits", 8}}},
              .query_knobs = {Knobs{{"batch", "streams"}}, Knobs{{"batch", "singly"}}},
              .stress_builds = {0, 1},
              .ladder = 10,
              .quick_builds = 1},
     .build = build});

}  // namespace
}  // namespace treeline::bench::ray
