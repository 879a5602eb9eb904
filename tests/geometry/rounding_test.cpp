// Compiled as users do, at -O3: what is rounded to a float stays rounded, in every loop that a compiler may
// vectorise.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "geometry/random.hpp"
#include "geometry/rounding.hpp"

namespace treeline::geometry {
namespace {

/// By the bits: to nearest, ties to even.
double rounded_by_bits(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  const std::uint64_t half = std::uint64_t{1} << 28, odd = bits >> 29 & 1;
  bits = (bits + half - 1 + odd) & ~((std::uint64_t{1} << 29) - 1);
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

TEST(Rounding, ToFloatAndBackIsNotDropped) {
  Pcg32 random(1);
  std::vector<double> x(1003), alone(x.size()), some(x.size()), lost(x.size()), squares(x.size());
  for (double& value : x) value = random.uniform(-8.0, 8.0);
  for (std::size_t i = 0; i < x.size(); ++i) alone[i] = rounded_to<float>(x[i]);
  for (std::size_t i = 0; i < x.size(); ++i)
    some[i] = x[i] >= 1 && x[i] <= 7 ? rounded_to<float>(x[i]) : x[i];
  for (std::size_t i = 0; i < x.size(); ++i) lost[i] = x[i] - rounded_to<float>(x[i]);
  for (std::size_t i = 0; i < x.size(); ++i) squares[i] = rounded_to<float>(x[i]) * rounded_to<float>(x[i]);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double right = rounded_by_bits(x[i]);
    ASSERT_EQ(alone[i], right);
    ASSERT_EQ(some[i], x[i] >= 1 && x[i] <= 7 ? right : x[i]);
    ASSERT_EQ(lost[i], x[i] - right);
    ASSERT_EQ(squares[i], right * right);
    ASSERT_NE(right, x[i]);  // or this tests nothing
  }
}

}  // namespace
}  // namespace treeline::geometry
