// The elementary functions of batches against those of the C++ library in double.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shading/brdf/batch_beckmann.hpp"
#include "shading/brdf/batch_ggx.hpp"

namespace treeline::shading::brdf {
namespace {

using std::numbers::pi;

/// Largest of error(x) over many x from low to high.
template <class Error>
double worst(double low, double high, Error&& error) {
  double most = 0;
  for (int i = 0; i <= 100'000; ++i) {
    const float x = static_cast<float>(low + (high - low) * i / 100'000);
    most = std::max(most, error(x));
  }
  return most;
}

TEST(BrdfBatch, FunctionsKeepTheirStatedErrors) {
  using namespace batch;
  EXPECT_LE(
      worst(0, 1,
            [](float u) { return std::abs(sine_cosine_of_turns(floats(u)).sine[0] - std::sin(2 * pi * u)); }),
      1.2e-7);
  EXPECT_LE(worst(0, 1,
                  [](float u) {
                    return std::abs(sine_cosine_of_turns(floats(u)).cosine[0] - std::cos(2 * pi * u));
                  }),
            1.2e-7);
  EXPECT_LE(
      worst(0, 87, [](float x) { return std::abs(exp_of_negative(floats(x))[0] * std::exp(double(x)) - 1); }),
      3e-7);
  EXPECT_LE(worst(-120, 120,
                  [](float e) {
                    const float x = std::exp2(e);
                    const double truth = std::log(double(x));
                    return std::abs(double(log_of(floats(x))[0]) - truth) / (1 + std::abs(truth));
                  }),
            1e-7);
  EXPECT_LE(worst(-6, 6,
                  [](float a) {  // towards either end
                    const float x = std::tanh(a);
                    return std::abs(std::erf(double(erf_inverse_of(floats(x))[0])) - double(x)) /
                           (1 - std::abs(double(x)) + 0.1);
                  }),
            3e-6);
  EXPECT_EQ(exp_of_negative(floats(88))[0], 0);
  EXPECT_EQ(exp_of_negative(floats(INFINITY))[0], 0);
  const auto by_exponent = [](auto&& error) {
    return [error](float e) { return error(std::exp2(double(e))); };
  };
  EXPECT_LE(worst(-126, 125, by_exponent([](double x) {
              return std::abs(inverse(floats(float(x)))[0] * double(float(x)) - 1);
            })),
            2e-7);
  EXPECT_LE(worst(-126, 125, by_exponent([](double x) {
              return std::abs(inverse_root(floats(float(x)))[0] * std::sqrt(double(float(x))) - 1);
            })),
            3e-7);
  EXPECT_LE(worst(-126, 125, by_exponent([](double x) {
              return std::abs(root(floats(float(x)))[0] / std::sqrt(double(float(x))) - 1);
            })),
            3e-7);
  EXPECT_EQ(root(Floats{})[0], 0);
}

}  // namespace
}  // namespace treeline::shading::brdf
