// Our wide bounding volume hierarchy, whose crossings are decided exactly: by the side of the first, and by
// how many there are.
#include "accel/signed_distance/ray_parity.hpp"
#include "bench/inside/sign_index.hpp"

namespace treeline::bench::inside {
namespace {

[[maybe_unused]] const bool first_hit = register_sign<WideTree, accel::FirstHit>(
    {.name = "wide_first_hit", .family = "bvh", .claim = Claim::exact, .ladder = 20});
[[maybe_unused]] const bool parity = register_sign<WideTree, accel::RayParity>(
    {.name = "wide_parity", .family = "bvh", .claim = Claim::exact, .ladder = 30});

}  // namespace
}  // namespace treeline::bench::inside
