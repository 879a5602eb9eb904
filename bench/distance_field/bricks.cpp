// Our sparse fields: bricks of samples near the surface.
#include "bench/distance_field/sampled.hpp"

namespace treeline::bench::distance_field {
namespace {

using namespace accel::field;

[[maybe_unused]] const bool linear = register_sampled<BrickSamples, Trilinear>("bricks", 1);
[[maybe_unused]] const bool cubic = register_sampled<BrickSamples, Tricubic>("bricks_cubic", 2);

}  // namespace
}  // namespace treeline::bench::distance_field
