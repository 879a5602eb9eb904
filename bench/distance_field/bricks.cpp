// Our sparse fields: bricks of samples near the surface. An icosphere of a million triangles at resolution
// 128, CPU seconds of one thread, wide tree and field: 0.27 + 0.60, against 3.1 of OpenVDB 10 (busy machine).
#include "bench/distance_field/sampled.hpp"

namespace treeline::bench::distance_field {
namespace {

using namespace accel::field;

[[maybe_unused]] const bool linear = register_sampled<BrickSamples, Trilinear>("bricks", 1);
[[maybe_unused]] const bool cubic = register_sampled<BrickSamples, Tricubic>("bricks_cubic", 2);

}  // namespace
}  // namespace treeline::bench::distance_field
