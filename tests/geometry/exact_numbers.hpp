// Numbers that are hard on exact predicates: whole ones that degenerate, neighbours in the last place,
// denormals, huge ones, and all of it mixed.
#pragma once

#include "geometry/random.hpp"
#include "geometry/rounding.hpp"
#include "geometry/triangle.hpp"

namespace treeline::test {

using namespace treeline::geometry;

enum class Numbers { uniform, whole, last_place, denormal, huge, mixed };
inline constexpr Numbers all_numbers[] = {Numbers::uniform,  Numbers::whole, Numbers::last_place,
                                          Numbers::denormal, Numbers::huge,  Numbers::mixed};

inline double hard_number(Numbers kind, Pcg32& random) {
  const double small_whole = static_cast<double>(random.below(5)) - 2;
  switch (kind) {
    case Numbers::uniform:
      return random.uniform(-1.0, 1.0);
    case Numbers::whole:
      return small_whole;
    case Numbers::last_place: {
      const double x = small_whole * 0.1;
      return random.below(2) == 0 ? x : std::nextafter(x, random.below(2) == 0 ? 10.0 : -10.0);
    }
    case Numbers::denormal:
      return small_whole * std::ldexp(1.0, -1074 + static_cast<int>(random.below(3)));
    case Numbers::huge:
      return random.below(2) == 0 ? small_whole * 1e150 : random.uniform(-1e150, 1e150);
    default:
      return random.below(5) == 0 ? 0.0
                                  : small_whole * std::ldexp(1.0, static_cast<int>(random.below(500)) - 250);
  }
}
inline Vec3d hard_point(Numbers kind, Pcg32& random) {
  const double x = hard_number(kind, random), y = hard_number(kind, random);
  return {x, y, hard_number(kind, random)};
}
/// Rounded one by one: GCC 12 with -fno-trapping-math leaves out the rounding of whole vectors to float and
/// back.
inline Vec3f hard_float_point(Numbers kind, Pcg32& random) {
  const Vec3d p = hard_point(kind, random);
  return {rounded(static_cast<float>(p[0])), rounded(static_cast<float>(p[1])),
          rounded(static_cast<float>(p[2]))};
}
inline Triangle3d hard_triangle(Numbers kind, Pcg32& random) {
  const Vec3d a = hard_point(kind, random), b = hard_point(kind, random);
  return {a, b, hard_point(kind, random)};
}

}  // namespace treeline::test
