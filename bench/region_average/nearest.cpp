// The texel in the middle. Its build is a plain copy of the texture, which builds of tables are held against.
#include "shading/texture/nearest.hpp"
#include "bench/region_average/own_averager.hpp"

namespace treeline::bench::region_average {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "nearest", .family = "texel", .claim = Claim::approximate, .ladder = 0},
     .build = make_own<shading::texture::Nearest>});

}  // namespace
}  // namespace treeline::bench::region_average
