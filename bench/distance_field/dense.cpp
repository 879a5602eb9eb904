// Our dense fields: all samples in rows, of which those far from the surface say only that they are.
#include "bench/distance_field/sampled.hpp"

namespace treeline::bench::distance_field {
namespace {

using namespace accel::field;

[[maybe_unused]] const bool linear = register_sampled<DenseSamples, Trilinear>("dense", 1);
[[maybe_unused]] const bool cubic = register_sampled<DenseSamples, Tricubic>("dense_cubic", 2);

}  // namespace
}  // namespace treeline::bench::distance_field
