// Every texel times its share, row by row.
#include "bench/region_average/own_averager.hpp"
#include "shading/texture/brute_force.hpp"

namespace treeline::bench::region_average {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "brute", .family = "brute", .claim = Claim::exact, .ladder = 9},
     .build = make_own<shading::texture::BruteForce>});

}  // namespace
}  // namespace treeline::bench::region_average
