// Summed-area tables by what they store. For boxes along the axes their answers are bounded by what the sums
// lose; integers lose nothing of levels.
#include "bench/region_average/own_averager.hpp"
#include "shading/texture/sat_centred.hpp"
#include "shading/texture/sat_double.hpp"
#include "shading/texture/sat_float.hpp"
#include "shading/texture/sat_int64.hpp"
#include "shading/texture/sat_uint32.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;
namespace tolerance = geometry::tolerance;

template <class T>
double of_sums(const TextureFacts& f, double entries) {
  return double(tolerance::table_slack<T>) * f.rows_and_columns * f.absolute_sum * entries;
}
/// Values less a constant: their sums are twice that at most, and each is rounded once.
double of_centred(const TextureFacts& f, double entries) {
  return 2 * of_sums<float>(f, entries) + 2 * double(tolerance::unit_roundoff<float>) * f.largest;
}
double of_levels(const TextureFacts& f, double) {
  if (f.levels) return 0;
  const double step = (f.unit ? 1.0 : f.range) / texture::Levels::top;
  return tolerance::level_slack * step + 2 * double(tolerance::unit_roundoff<float>) * f.largest;
}

template <class Sat>
bool add(const char* name, Claim claim, int ladder, double (*allowed)(const TextureFacts&, double)) {
  return Registry<Method>::instance().add(
      {.info = {.name = name, .family = "sat", .claim = claim, .ladder = ladder},
       .build = make_own<Sat>,
       .boxes_only = true,
       .allowed = allowed});
}

[[maybe_unused]] const bool floats = add<texture::SatFloat>("sat_float", Claim::bounded, 4, of_sums<float>);
[[maybe_unused]] const bool centred = add<texture::SatCentred>("sat_centred", Claim::bounded, 5, of_centred);
[[maybe_unused]] const bool narrow = add<texture::SatUint32>("sat_uint32", Claim::exact, 6, of_levels);
[[maybe_unused]] const bool doubles =
    add<texture::SatDouble>("sat_double", Claim::bounded, 7, of_sums<double>);
[[maybe_unused]] const bool wide = add<texture::SatInt64>("sat_int64", Claim::exact, 8, of_levels);

}  // namespace
}  // namespace treeline::bench::region_average
