// Embree in packets of 8 rays.
#include "bench/ray/embree_packet.hpp"

namespace treeline::bench::ray {
namespace {
const bool registered = register_embree_packet<8>();
}
}  // namespace treeline::bench::ray
